"""Gaps of one flank side of a pair at stated poses and turns, with their rates.

For mechanisms that seat gears themselves: no model, mesh move or build is needed. External, internal and bevel pairs
alike.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines.exact.kernels import NO_FLANKS, kernels_of
from tol3d.gears import Flank, GearPair
from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class GearRows:
    """One gear of a pair in some builds.

    Args:
        centre: (rows, 2) [mm], its centre off its axis, in the gear's frame; it turns with it.
        flank_turn: (rows,) [rad], by which flanks are turned out of their teeth: an arc s on the reference circle with
            the radius r is s/(2 r).
        flank_offset: (rows,) [mm], by which they lie outside that, along their normals.
        scale: (rows,), growth.
    """

    centre: Array
    flank_turn: Array
    flank_offset: Array
    scale: Array

    @classmethod
    def nominal(cls, rows: int) -> "GearRows":
        """A gear without deviations."""
        return cls(np.zeros((rows, 2)), np.zeros(rows), np.zeros(rows), np.ones(rows))


@dataclass(frozen=True)
class FlankGap:
    """The smallest gap of one flank side.

    Args:
        value: (rows,) [mm], below 0 where flanks overlap; nan where no faces overlap.
        per_driver, per_driven: (rows,) [mm/rad], its rates by the gears' turns about their own z.
        normal: (rows, 3), unit vector from the driver's flank to the driven's, in the driven shaft's frame. A shift d
            of the driven axis changes the gap by normal d, one of the driver's by as much less.
        point: (rows, 3) [mm], on the driver's flank, in that frame.
        tooth: (rows,), of the driver.
    """

    value: Array
    per_driver: Array
    per_driven: Array
    normal: Array
    point: Array
    tooth: NDArray[np.int64]


def flank_gap(
    pair: GearPair,
    flank: Flank,
    driven_from_driver: Array,
    turns: tuple[Array, Array],
    gears: tuple[GearRows, GearRows] | None = None,
) -> FlankGap:
    """The smallest gap over the candidate tooth pairs of one side.

    Args:
        pair: nominal gears.
        flank: of the driver, right (1) or left (-1); the driven's that it meets follows.
        driven_from_driver: (rows, 4, 4), the driver's shaft in the frame of the driven's, both at rest: z the axis. In
            the frame of the driver's the teeth meet near azimuth 0, see GearPair.
        turns: of driver and driven gear about their own z [rad], each (rows,).
        gears: their deviations; none if not given.
    """
    kernels, rows = kernels_of(pair), len(driven_from_driver)
    own = gears or (GearRows.nominal(rows), GearRows.nominal(rows))
    shafts = np.stack([driven_from_driver, np.broadcast_to(np.eye(4), (rows, 4, 4))], axis=1)
    teeth, wanted = pair.candidate_teeth(turns[0], flank)
    value, vectors = np.empty(wanted.shape), np.empty((*wanted.shape, 3, 3))
    arrays = (
        shafts,
        np.stack([gear.centre for gear in own], axis=1),
        *(np.stack([getattr(g, name) for g in own], axis=1) for name in ("flank_turn", "flank_offset", "scale")),
        *NO_FLANKS,
        *turns,
        teeth,
        wanted,
    )
    kernels.gaps(
        *kernels.numbers,
        np.array([0, 1, flank, 0], dtype=np.int64),
        *(np.require(each, requirements=["C", "W"]) for each in arrays),
        value,
        vectors,
        np.empty(wanted.shape, dtype=bool),
    )
    least = np.where(np.isfinite(value), value, np.inf)
    first = np.argmin(least, axis=1)
    every = np.arange(rows)
    on_driver, on_driven, normal = (vectors[every, first, k] for k in range(3))
    z = np.broadcast_to([0.0, 0.0, 1.0], (rows, 3))
    axis, origin = driven_from_driver[:, :3, 2], driven_from_driver[:, :3, 3]
    found = least[every, first]
    return FlankGap(
        value=np.where(np.isinf(found), np.nan, found),
        per_driver=-_along(np.cross(axis, on_driver - origin), normal),
        per_driven=_along(np.cross(z, on_driven), normal),
        normal=normal,
        point=on_driver,
        tooth=teeth[every, first],
    )


def _along(vectors: Array, normal: Array) -> Array:
    """Products (rows,) of vectors (rows, 3)."""
    return np.asarray((vectors * normal).sum(axis=1))
