"""A cycloid stage without bearing play, and the deviations of its parts in some trials, for both methods."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from tol3d.gearing.cycloid.model.profile import DiscProfile
from tol3d.numerics.arrays import Array, Places, TrialArrays
from tol3d.numerics.plane import evenly


@dataclass(frozen=True)
class Deviated(TrialArrays):
    """Deviations from nominal (trials, ...), counter-clockwise and outwards positive.

    Args:
        pins: of their centres, outwards and counter-clockwise (trials, pins, 2) [mm].
        pin_radii: (trials, pins) [mm].
        lobe_pitch: arc by which a lobe lies counter-clockwise of its place (trials, discs, lobes) [mm]; its best flank
            moves by K of it along the normal.
        lobe_profile: material along the normal (trials, discs, lobes) [mm].
        disc_offsets: of a disc's profile from its crank holes, in the disc's frame (trials, discs, 2) [mm].
        disc_holes: of the discs' crank holes in the same frame (trials, discs, cranks, 2) [mm].
        crank_errors: of the throws, in the crank's frame (trials, cranks, discs, 2) [mm].
        crank_phases: of the cranks (trials, cranks) [rad].
        carrier_holes: of the carrier's crank holes in its frame (trials, cranks, 2) [mm].
        carrier_offsets: of the carrier by its main bearing, in its frame (trials, 2) [mm].
    """

    pins: Array
    pin_radii: Array
    lobe_pitch: Array
    lobe_profile: Array
    disc_offsets: Array
    disc_holes: Array
    crank_errors: Array
    crank_phases: Array
    carrier_holes: Array
    carrier_offsets: Array

    @classmethod
    def nothing(cls, trials: int, pins: int, discs: int, cranks: int) -> "Deviated":
        """No deviations."""
        return cls(
            np.zeros((trials, pins, 2)),
            np.zeros((trials, pins)),
            np.zeros((trials, discs, pins - 1)),
            np.zeros((trials, discs, pins - 1)),
            np.zeros((trials, discs, 2)),
            np.zeros((trials, discs, cranks, 2)),
            np.zeros((trials, cranks, discs, 2)),
            np.zeros((trials, cranks)),
            np.zeros((trials, cranks, 2)),
            np.zeros((trials, 2)),
        )


@dataclass(frozen=True)
class CycloidStage:
    """A cycloid stage: discs, cranks and carrier without bearing play.

    Args:
        crank_circle: radius of the circle of crank axes [mm].
        rolling: turns rho of the cranks in space per turn of the carrier beyond its place, 1 + sun teeth over planet
            teeth while the sun stands and 0 while the cranks do.
        window: pins work whose nominal lever is more than this share of the pitch radius; others stop nothing, and may
            lie in the disc by some micrometres where clearance is small.
    """

    profile: DiscProfile
    discs: int
    cranks: int
    crank_circle: float
    rolling: float
    window: float

    @classmethod
    def of(cls, own: Any) -> Self:
        """Stage of a reducer, or of another method."""
        return cls(own.profile, own.discs, own.cranks, own.crank_circle, own.rolling, own.window)

    @property
    def throws(self) -> Array:
        """Phase of each disc on a crank (discs,) [rad]."""
        return evenly(self.discs)


@dataclass(frozen=True)
class Play:
    """Play of the discs and cranks of a stage.

    Args:
        disc: diametral clearance of each throw in its disc (trials, cranks, discs) [mm], or what broadcasts to it.
        carrier: the same of each crank in the carrier (trials, cranks) [mm].
        crank: least and most turn that the first stage leaves each crank in the middle of its bearing (trials,
            positions, cranks, 2) [rad], or what broadcasts to it.
        leaving: change of both for a crank that lies off by 1 mm round the carrier, and outwards [rad/mm]:
            flanks lean, so that outwards there is more room either way.
    """

    disc: Array
    carrier: Array
    crank: Array
    leaving: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Touching:
    """Pins that stop the carrier, and the carrier's turns there.

    Args:
        turns: the carrier's beyond -phi / Zc (trials, positions) [rad], counter-clockwise, of the exact method by sense
            on a further axis; NaN where no contact was found.
        places: the pin that touches, disc times pins + pin, in the same shape; -1 for none.
        near: working pins that have a gap of at most the stated deflection then; None where none was stated.
    """

    turns: Array
    places: Places
    near: Places | None = None
