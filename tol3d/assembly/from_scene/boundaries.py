"""Datums at their material boundaries: the gauge of virtual condition, and how it shifts the datum frame."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tol3d.assembly.from_scene.contributors import SHIFT_AND_TURN, Effects
from tol3d.assembly.from_scene.datums import DatumFrames
from tol3d.assembly.from_scene.zones import sized_by
from tol3d.assembly.grammar.boundary_checks import earlier_zone, is_square, shifts_alone
from tol3d.assembly.grammar.datums import DatumSpec, Lying
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features.feature_spec import AXES
from tol3d.assembly.model import Axis, Contribution, DatumFrame, Floating, Gauges, Slot
from tol3d.assembly.model.datum_frame import GaugeRoom
from tol3d.assembly.zones import Bonus, SizedBy, ZoneDraw, catalogue, uniform_in
from tol3d.assembly.zones.float_draw import FloatDraw, GaugeShift, Leaning
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.system.plain import PlainContributor

ANY = 1e3
"""mm; a gauge's clearance grows with the size, beyond the drawing's limits too."""

HALF_DIFFERENCE = 0.5 * np.array([[-1.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]])
"""Matrix for (start x, start y, end x, end y)."""


@dataclass(frozen=True)
class Boundary:
    """A datum at a material boundary, as a tolerance of its part names it.

    Args:
        feature: with its part.
        earlier: datums before it, which orient the gauge.
        own: the datum.
    """

    feature: str
    earlier: tuple[DatumSpec, ...]
    own: DatumSpec


def shift_frames(scene: Scene, drawing: Drawing, effects: Effects, frames: DatumFrames) -> None:
    """Add the shift of datum frames by their gauges: one contributor each, common to all features of the frame."""
    for name, boundary in _boundaries(drawing, frames).items():
        if boundary.own.gauge == "random":
            frame = frames.made[name]
            frames.made[name] = replace(frame, shifted_by=(_shift(scene, drawing, effects, frame, boundary),))
    drawn = dict.fromkeys(_named_by_tolerances(drawing, frames))
    for name in dict.fromkeys((*drawn, *frames.made)):
        frame, datums = frames.made[name], frames.specs[name]
        if (gauge := _lying(datums)) is not None and (
            name not in drawn or not shifts_alone(drawing, frame.part, datums)
        ):
            rooms = rooms_of(scene, drawing, frame.part, datums)
            floating = None if gauge == "least" else _floating(effects, frame, datums)
            frames.made[name] = replace(frame, gauges=Gauges(rooms, floating))


def _named_by_tolerances(drawing: Drawing, frames: DatumFrames) -> Iterator[str]:
    """Datum frames in the order of the tolerances."""
    for own in drawing.stated:
        if not isinstance(own, str) and own.spec.named_datums:
            yield frames.named(own.feature.partition(".")[0], own.spec.named_datums)


def _floating(effects: Effects, frame: DatumFrame, datums: Sequence[DatumSpec]) -> Floating:
    """Position of a frame's gauges within their clearances."""
    if _lying(datums) != "random":
        return Floating("centred")
    first = next(k for k, own in enumerate(datums) if own.gauge is not None)
    own, to, then = (
        ", ".join("-".join(each.features) + _least(each) for each in some)
        for some in (
            [each for each in datums if each.gauge is not None],
            datums[:first],
            [each for each in datums[first:] if each.gauge is None],
        )
    )
    draw = FloatDraw(("room",), (*SHIFT_AND_TURN, "start"))
    name = f"shift of {frame.part}.{own}" + (f" to {to}" if to else "") + (f", then {then}" if then else "")
    words = f"of the gauges at the {_boundary(datums)} material boundary of datums"
    return Floating("random", effects.added(PlainContributor(name, "datum_shift", draw, "1", 1.0, words)))


def _lying(datums: Sequence[DatumSpec]) -> Lying | None:
    """Position of the gauges of a frame in their room; None without any."""
    return next((own.gauge for own in datums if own.gauge is not None), None)


def _boundaries(drawing: Drawing, frames: DatumFrames) -> dict[str, Boundary]:
    """By the name of the frame, in the order of the tolerances."""
    found: dict[str, Boundary] = {}
    for own in drawing.stated:
        if isinstance(own, str):
            continue
        datums = own.spec.named_datums
        part = own.feature.partition(".")[0]
        if shifts_alone(drawing, part, datums):
            feature = f"{part}.{datums[-1].features[0]}"
            found.setdefault(frames.named(part, datums), Boundary(feature, datums[:-1], datums[-1]))
    return found


def rooms_of(scene: Scene, drawing: Drawing, part: str, datums: tuple[DatumSpec, ...]) -> tuple[GaugeRoom, ...]:
    """Datum shift allowed to each gauge of the datums at their boundary."""
    found = []
    for k, name in ((k, name) for k, own in enumerate(datums) if own.gauge is not None for name in own.features):
        feature = f"{part}.{name}"
        shape, (virtual, grows) = drawing.kind(feature).shape, _virtual(scene, drawing, feature, datums, k)
        assert isinstance(shape, Axis | Slot)
        nominal = shape.width if isinstance(shape, Slot) else shape.diameter or 0.0
        found.append(GaugeRoom(feature, nominal + virtual, grows))
    return tuple(found)


def _least(datum: DatumSpec) -> str:
    return " lmb" if datum.lmb is not None else ""


def _boundary(datums: Sequence[DatumSpec]) -> str:
    """The boundaries of the gauges of a frame, in words."""
    words = {"mmc": "maximum", "lmc": "least"}
    return " or ".join(dict.fromkeys(words[own.boundary] for own in datums if own.gauge is not None))


def room_of(scene: Scene, drawing: Drawing, of: str, datums: tuple[DatumSpec, ...]) -> GaugeRoom | None:
    """Datum shift allowed to the gauge of the last datum, for a position along it; None unless it shifts alone."""
    part = part_of(of)
    if not shifts_alone(drawing, part, datums):
        return None
    boundary = Boundary(f"{part}.{datums[-1].features[0]}", datums[:-1], datums[-1])
    measured = drawing.kind(of)
    if measured.kind not in AXES or not is_square(*_axes(drawing, boundary.feature, of)):
        return None
    return rooms_of(scene, drawing, part, datums)[0]


def _axes(drawing: Drawing, *features: str) -> tuple[Array, Array]:
    first, second = (drawing.kind(own).frame[:3, 2] for own in features)
    return first, second


def _virtual(scene: Scene, drawing: Drawing, feature: str, datums: Sequence[DatumSpec], k: int) -> tuple[float, bool]:
    """Virtual condition of a feature of a datum, as a deviation from nominal [mm], and whether larger ones leave room.

    At the maximum material boundary a hole holds its gauge, and a pin is held by it; at the least one the gauge lies
    inside the material: a hole lies within its gauge, and a pin holds it. Features that may be farther off at this
    size, by a bonus from the other condition, have all of it in their gauge.
    """
    boundary = datums[k].boundary
    bonus = sized_by(scene, drawing, feature, boundary).bonus
    tolerance, modifier = earlier_zone(drawing, feature, datums, k) or (0.0, None)
    tolerance += bonus.most if modifier not in (None, boundary) else 0.0
    return bonus.low - tolerance if bonus.grows else bonus.high + tolerance, bonus.grows


def _shift(scene: Scene, drawing: Drawing, effects: Effects, frame: DatumFrame, boundary: Boundary) -> Contribution:
    draw = _room(scene, drawing, effects, boundary)
    to = ", ".join(name for datum in boundary.earlier for name in datum.features)
    name = f"shift of {boundary.feature}{_least(boundary.own)} to {to}"
    columns = slice(effects.width, effects.width + len(draw.components))
    words = f"of the gauge at the {_boundary((boundary.own,))} material boundary of a datum"
    effects.contributors.append(PlainContributor(name, "datum_shift", draw, description=words))
    effects.width = columns.stop
    across = drawing.kind(boundary.feature).frame[:3, :2]
    return Contribution(name, columns, across)


def _room(scene: Scene, drawing: Drawing, effects: Effects, boundary: Boundary) -> GaugeShift:
    sized = sized_by(scene, drawing, boundary.feature, boundary.own.boundary)
    virtual, grows = _virtual(
        scene, drawing, boundary.feature, (*boundary.earlier, boundary.own), len(boundary.earlier)
    )
    bonus = Bonus(virtual if grows else virtual - ANY, virtual + ANY if grows else virtual, grows=grows)
    zone = catalogue.point_in_disc(0.0)
    draws = {own.name: own.draw for own in effects.contributors}
    leaning = []
    for own in effects.moved_by.get(boundary.feature, ()):
        matrix, draw = HALF_DIFFERENCE @ own.matrix, draws[own.contributor]
        if isinstance(draw, ZoneDraw) and _tilts(matrix, draw):
            leaning.append(Leaning(own.contributor, draw, tuple(tuple(row) for row in matrix.tolist())))
    return GaugeShift(zone, uniform_in(zone), SizedBy(sized.name, sized.law, bonus), tuple(leaning))


def _tilts(matrix: Array, draw: ZoneDraw) -> bool:
    """True if a contributor ever displaces the ends of the datum feature from each other."""
    return bool((matrix @ draw.covariance @ matrix.T).any() or (matrix @ draw.mean_vector).any())
