"""Parts of a cycloid stage as dimensions of their solids, in the frames of their builders; strips of a disc."""

import math
from dataclasses import dataclass
from typing import ClassVar

from tol3d.cad.solids import BuiltShape, FaceStrip, SweptShape, face_strips
from tol3d.gearing.cycloid.model.profile import DiscProfile

CAD = "tol3d.gearing.cycloid.model.shapes_cad"


@dataclass(frozen=True)
class DiscHoles:
    """Holes through a disc: bearing holes and windows on one circle about its axis, and its bore.

    Args:
        cranks: number of bearing holes, at equal angles, the first on +x; windows lie midway between them.
        circle_radius: of the centres of bearing holes and windows [mm].
        crank_diameter: of the bearing holes [mm].
        window_diameter: of the windows that the carrier's posts pass [mm]; 0 for none.
        bore_diameter: of the bore about the disc's axis [mm]; 0 for none.
    """

    cranks: int
    circle_radius: float
    crank_diameter: float
    window_diameter: float = 0.0
    bore_diameter: float = 0.0


@dataclass(frozen=True)
class CycloidDisc(SweptShape):
    """A cycloid disc about z, its middle z = 0, its first crank hole on +x.

    Args:
        width: along z [mm].
        profile: of its lobes.
        holes: through it.
        clocking: turn of the lobes against the holes, counter-clockwise [rad]; at 0 a root lies on +x.
    """

    builder: ClassVar[str] = f"{CAD}:disc"

    profile: DiscProfile
    holes: DiscHoles
    clocking: float = 0.0


@dataclass(frozen=True)
class PinRing(SweptShape):
    """The housing ring about z, its middle z = 0, with a half-hole for each pin, the first on +x. Lengths in mm.

    Args:
        width: along z.
        pins: number of half-holes.
        pin_circle_radius: of the circle of the pins' centres.
        pin_radius: of the half-holes.
        bore_radius: of the lands between the half-holes.
        outer_radius: of the rim.
    """

    builder: ClassVar[str] = f"{CAD}:ring"

    pins: int
    pin_circle_radius: float
    pin_radius: float
    bore_radius: float
    outer_radius: float


@dataclass(frozen=True)
class RingPin(BuiltShape):
    """A round pin about z, its middle z = 0, chamfered at its ends. Lengths in mm."""

    builder: ClassVar[str] = f"{CAD}:pin"

    radius: float
    length: float


@dataclass(frozen=True)
class CrankSection:
    """A cylinder of a crankshaft.

    Args:
        diameter, length: [mm].
        offset: of its axis from the shaft's [mm].
        azimuth: of that offset [rad].
    """

    diameter: float
    length: float
    offset: float = 0.0
    azimuth: float = 0.0

    @property
    def at(self) -> tuple[float, float]:
        """Place of its axis, x and y [mm]."""
        return self.offset * math.cos(self.azimuth), self.offset * math.sin(self.azimuth)


@dataclass(frozen=True)
class Crankshaft(BuiltShape):
    """A crankshaft about z; its lowest eccentric points along +x.

    Args:
        sections: from its lower end upwards.
        start: z of its lower end [mm].
    """

    builder: ClassVar[str] = f"{CAD}:crank"

    sections: tuple[CrankSection, ...]
    start: float


@dataclass(frozen=True)
class Carrier(BuiltShape):
    """Two flanges about z, one above and one below z = 0, joined by posts midway between the cranks. Lengths in mm.

    Args:
        cranks: number of holes for cranks, the first on +x, and of posts.
        circle_radius: of the axes of holes and posts.
        hole_diameter, post_diameter, bore_diameter: 0 for no bore; without posts (0) it is the lower flange alone.
        flange_diameter, flange_width: of either flange.
        between: distance of the flanges' inner faces.
    """

    builder: ClassVar[str] = f"{CAD}:carrier_of"

    cranks: int
    circle_radius: float
    hole_diameter: float
    post_diameter: float
    bore_diameter: float
    flange_diameter: float
    flange_width: float
    between: float


RIGHT_FLANK, LEFT_FLANK = "lobe 0 right flank", "lobe 0 left flank"


@dataclass(frozen=True, eq=False)
class LobeStrips:
    """Both flanks of lobe 0 in the disc's frame, clocking included; other lobes are the same, turned by lobe pitches.

    Args:
        right, left: strips; their parameter is the u of the profile that the disc is ground for.
    """

    right: FaceStrip
    left: FaceStrip

    @property
    def chord_error(self) -> float:
        """Chord error of either shape [mm]."""
        return self.right.chord_error


def lobe_strips(disc: CycloidDisc, steps: int) -> LobeStrips:
    """Strips of a disc with that many steps per flank; from the cache, or from its solid, built for it."""
    return LobeStrips(*face_strips(disc, (RIGHT_FLANK, LEFT_FLANK), steps))
