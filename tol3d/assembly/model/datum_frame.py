"""Datum frames, from a part's own features, in order."""

from dataclasses import dataclass
from typing import Literal

from tol3d.assembly.model.feature import Contribution
from tol3d.assembly.model.play import Floating
from tol3d.numerics.arrays import Array
from tol3d.numerics.values import Valued

Modifier = Literal["mmc", "lmc"]
"""Maximum or least material condition: the size without bonus."""


@dataclass(frozen=True)
class MaterialBonus:
    """clip(±(size - origin), 0, high - low): a size's departure from its material condition.

    Args:
        low, high: limits of the size on the drawing, as deviations from nominal [mm].
        grows: whether larger sizes add: of a hole at MMC and of a pin at LMC; the origin is then `low`, else `high`.
    """

    low: float
    high: float
    grows: bool


@dataclass(frozen=True)
class GaugeRoom:
    """Allowed shift of a gauge of virtual condition in a datum feature: ±(size - virtual) / 2 at its ends.

    Args:
        feature: the hole, pin, slot or tab, with its part.
        virtual: diameter or width of the gauge [mm].
        grows: True if larger features leave more clearance: holes and slots at their maximum material boundary, pins
            and tabs at the least one, whose gauge they contain.
    """

    feature: str
    virtual: float
    grows: bool


Simulator = Literal["contact", "fitted", "targets", "pattern"]
"""Contact of a later plane, in the orientation left to it: at its outermost corner out of the material, at its centre,
or at its stated points. Of several features: as a pattern."""


@dataclass(frozen=True, eq=False)
class Datum:
    """A datum: a feature, or several as a common datum A-B-C.

    Args:
        features: names; of several the line through their centres counts, of three or more by least squares.
        simulator: how it lies on what holds it; "pattern" of several lays their places on the nominal ones, by least
            squares of what they are off: ends of axes across them, corners of planes along their normals, centres.
        targets: (points, 3) in the frame of the feature [mm], for "targets".
    """

    features: tuple[str, ...]
    simulator: Simulator = "contact"
    targets: Array | None = None


@dataclass(frozen=True, eq=False)
class Gauges:
    """Gauges of virtual condition, all of one piece, in (or on) some datums of a frame, next to each other.

    They move by the freedoms that the datums before them leave: at both ends of a hole or pin and at all corners of a
        slot or tab they lie within +-(size - virtual) / 2 of it.

    Args:
        rooms: one of each feature of these datums, in order.
        floating: their position within the common clearance, which makes the frame; None if each measure decides: the
            frame is then that of the datums regardless of their sizes.
    """

    rooms: tuple[GaugeRoom, ...]
    floating: Floating | None = None


@dataclass(frozen=True, eq=False)
class DatumFrame(Valued):
    """Datums in order: each takes only freedoms left by earlier ones; those taken by none stay the part's.

    What each asks, in this order: a plane, its normal, then its height (with targets, the heights of its points one by
    one); an axis or a common datum, its centre across it, then its direction; a point, its position; a cone, its
    position, then its direction. What is asked but held already is met as nearly as the freedoms left allow: least
    squares over its two or three components. So a second hole turns the frame until its centre lies in the right
    direction from the first, whatever their distance.

    Each turns the part by the least rotation that meets what it asks, about its own centre in the trial where shifts
    are still free (of a common datum the middle of all centres), and shifts it along the nominal directions that it
    holds. The frame's pose is the inverse of that: T_datum_frame(trial) T_datum_frame(nominal)^-1, in the part's frame;
    nominally it is the part's frame itself. The place of the part's origin makes no difference.

    Args:
        name: "part|A|B|C" of its features.
        part: the part.
        datums: primary, secondary, tertiary.
        shifted_by: offset of a gauge from its datum feature, which shifts the frame (3, components), nominally in the
            part's frame.
        gauges: of its datums at their boundary, where these are several, a first, a third one, a slot, or not the last.
    """

    name: str
    part: str
    datums: tuple[Datum, ...]
    shifted_by: tuple[Contribution, ...] = ()
    gauges: Gauges | None = None

    @property
    def regardless(self) -> int:
        """Number of datums, the first ones, that are met regardless of their sizes."""
        return self._on_gauges.index(True) if True in self._on_gauges else len(self.datums)

    @property
    def later(self) -> tuple[Datum, ...]:
        """Datums regardless of size after those on gauges: met as nearly as the room of these lets them."""
        its = zip(self.datums[self.regardless :], self._on_gauges[self.regardless :], strict=True)
        return tuple(own for own, on_gauges in its if not on_gauges)

    @property
    def _on_gauges(self) -> list[bool]:
        at_boundary = {room.feature for room in self.gauges.rooms} if self.gauges is not None else set()
        return [not at_boundary.isdisjoint(datum.features) for datum in self.datums]
