"""Where the errors of discs, cranks and carrier put a disc: kinematics of three cranks without bearing play.

Complex numbers stand for points of the plane [mm]; the pin ring's axis is the origin, angles count counter-clockwise.
The carrier has turned by chi = -phi / Zc + delta; every crank by phi + rho delta in space, and its phase error. The
axis of crank i lies where the carrier's hole is, displaced with the carrier by its main bearing's inner ring:

    A_i = e^(i chi) (m + H_i),   H_i = R e^(2 pi i / cranks) + hole error,

its throw for disc d is turned with the crank: e^(i phi) E_id, E_id = e^(i beta_i) (a e^(i throw_d) + crank error). A
disc has its holes at h_id = R e^(2 pi i / cranks) + hole error - o_d in the frame of its profile's centre, with o_d
the profile's offset from the holes. So a crank's eccentricity goes round with phi, a disc's with its own turn psi_d,
the carrier's holes and its main bearing's inner ring with chi.

Three cranks without play hold a disc in six coordinates, three too many. The bearings are alike and give alike: the
disc lies where the squares of the distances between its holes' centres and the cranks' throws are least. That is exact
in finite geometry: with bars for means over the cranks,

    e^(i psi_d) = unit of sum_i (A_i + e^(i phi) E_id - mean) conj(h_id - mean)
                = unit of e^(i chi) S_d + e^(i phi) Q_d,
    centre_d = e^(i chi) (m + mean H) + e^(i phi) mean E_d - e^(i psi_d) mean h_d.

An eccentricity common to the cranks so moves the disc; differences turn it, by their mean tangential part over R.

The profile of disc d is turned against its holes by -throw_d / Zc so that its lobes mesh; its nominal turn is chi,
too. Pin j stands at the parameter 2 pi j / Zp + (phi + throw_d) / Zc of it, but for errors.

Errors of lobes: the pitch error p of lobe k turns the whole lobe about the disc's axis by p K / (a Zc),
counter-clockwise positive, so that its best flank moves p K along the normal. The profile error f moves its surface by
f along the normal, outwards positive. The disc's surface so is piecewise, with steps at the roots, where a pin has no
lever: as large as the difference of two profile errors there, and of second order in pitch errors. A pin touches the
lobe on which its foot lies. The rotation of a modified profile turns right and left flanks apart, with a corner at root
and tip.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CENTRE: Final = slice(0, 2)  # of the carrier's holes, in the carrier's frame
THROW: Final = slice(2, 4)  # mean of the cranks' throws, in the cranks' frame
HOLES: Final = slice(4, 6)  # mean of the disc's holes, in its profile's frame
CARRIER_TURN: Final = slice(6, 8)  # S
CRANK_TURN: Final = slice(8, 10)  # Q


def throws(discs: int) -> Array:
    """Directions of the throws of a crank for its discs (discs,) [rad], evenly around."""
    return 2 * np.pi * np.arange(discs) / discs


@dataclass(frozen=True)
class Bearings:
    """Centres of what bearings join [mm].

    Attributes:
        holes: of the carrier, in its frame, its main bearing's displacement in it (trials, cranks, 2).
        thrown: throws, in the crank's frame, its phase error in them (trials, cranks, discs, 2).
        bored: holes of the discs, in the frame of the profile's centre (trials, discs, cranks, 2).
    """

    holes: Array
    thrown: Array
    bored: Array


def bearings(
    eccentricity: float,
    crank_circle: float,
    disc_offsets: Array,
    disc_holes: Array,
    crank_errors: Array,
    crank_phases: Array,
    carrier_holes: Array,
    carrier_offsets: Array,
) -> Bearings:
    """Where errors put what bearings join.

    Args:
        eccentricity: a [mm].
        crank_circle: radius R of the circle of the cranks' axes [mm].
        disc_offsets: of profiles from crank holes, in the disc's frame (trials, discs, 2) [mm].
        disc_holes: errors of the discs' holes in the same frame (trials, discs, cranks, 2) [mm].
        crank_errors: eccentricity errors in the crank's frame (trials, cranks, discs, 2) [mm].
        crank_phases: of the cranks (trials, cranks) [rad].
        carrier_holes: errors of the carrier's holes in its frame (trials, cranks, 2) [mm].
        carrier_offsets: by its main bearing, in its frame (trials, 2) [mm].
    """
    cranks, discs = crank_errors.shape[1:3]
    around = 2 * np.pi * np.arange(cranks) / cranks
    nominal = crank_circle * np.stack([np.cos(around), np.sin(around)], axis=-1)
    directions = throws(discs)
    own = eccentricity * np.stack([np.cos(directions), np.sin(directions)], axis=-1) + crank_errors
    cos_b, sin_b = np.cos(crank_phases)[..., None], np.sin(crank_phases)[..., None]
    x, y = own[..., 0], own[..., 1]
    return Bearings(
        nominal + carrier_holes + carrier_offsets[:, None],
        np.stack([cos_b * x - sin_b * y, sin_b * x + cos_b * y], axis=-1),
        nominal + disc_holes - disc_offsets[:, :, None],
    )


def linkage(joined: Bearings) -> Array:
    """What a disc's pose is made of where bearings have no play, (trials, discs, 10) [mm, mm2]: see CENTRE, THROW..."""
    trials, _, discs = joined.thrown.shape[:3]
    middle = _mean(joined.holes)
    found = np.empty((trials, discs, 10))
    for disc in range(discs):
        thrown, bored = joined.thrown[:, :, disc], joined.bored[:, disc]
        middle_thrown, middle_bored = _mean(thrown), _mean(bored)
        across = bored - middle_bored[:, None]
        found[:, disc, CENTRE] = middle
        found[:, disc, THROW] = middle_thrown
        found[:, disc, HOLES] = middle_bored
        found[:, disc, CARRIER_TURN] = _turned(joined.holes - middle[:, None], across)
        found[:, disc, CRANK_TURN] = _turned(thrown - middle_thrown[:, None], across)
    return found


def _mean(points: Array) -> Array:
    """Over cranks, (trials, 2) of (trials, cranks, 2), in their order."""
    total = points[:, 0]
    for crank in range(1, points.shape[1]):
        total = total + points[:, crank]
    return np.asarray(total / points.shape[1])


def _turned(points: Array, others: Array) -> Array:
    """Sum over cranks of points times conjugates of others, (trials, 2) of (trials, cranks, 2)."""
    x, y, u, v = points[..., 0], points[..., 1], others[..., 0], others[..., 1]
    return np.asarray(_mean(np.stack([x * u + y * v, y * u - x * v], axis=-1)) * points.shape[1])
