"""One tooth in its space: both of its flanks are looked at, and no other tooth's.

A flank is in action between the start and the end of the path of contact, where the mate's tip and its own end it (ISO
21771, active flank). Beyond, a neighbour carries, and the tip edge that is nearest there gives no backlash.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.gears.flank import LEFT, RIGHT, Flank
from tol3d.gears.pair import GearPair
from tol3d.numerics.arrays import Array

Owner = Literal["driver", "driven"]

ROUNDING = 1e-9  # pitches; a flank that so nearly ends where it is looked at does not end there


def driver_teeth_at_one_tooth(
    driver_angle: Array, angular_pitch: float, flank: Flank, owner: Owner
) -> NDArray[np.int64]:
    """The driver's tooth that touches, with that flank, the one tooth (or is it), (rows, 1).

    The one tooth is the owner's nearest to the line of centres, which the driver sees at azimuth 0. A driven
    tooth stands in a space of the driver: the space's right wall is the right flank of the tooth above it.

    >>> driver_teeth_at_one_tooth(np.array([0.1]), 1.0, RIGHT, "driver").tolist()
    [[0]]
    >>> [driver_teeth_at_one_tooth(np.array([0.1]), 1.0, flank, "driven").tolist() for flank in (1, -1)]
    [[[0]], [[-1]]]
    """
    place = driver_angle / angular_pitch
    above = 1 if flank == RIGHT else 0
    tooth = -np.round(place) if owner == "driver" else above - np.round(place + 0.5)
    return np.asarray(tooth.astype(np.int64)[:, None])


def one_tooth_acts(pair: GearPair, driver_angle: Array, owner: Owner) -> NDArray[np.bool_]:
    """True where both flanks of the one tooth are on the nominal path of contact, (rows,), at driver angles [rad]."""
    pitch = pair.pinion.angular_pitch
    lowest, highest = pair.active_azimuths
    acts = np.ones(len(driver_angle), dtype=bool)
    for flank in (RIGHT, LEFT):
        teeth = driver_teeth_at_one_tooth(driver_angle, pitch, flank, owner)[:, 0]
        azimuth = flank * (driver_angle + pitch * teeth)
        acts &= (lowest - ROUNDING * pitch <= azimuth) & (azimuth <= highest + ROUNDING * pitch)
    return acts


def one_tooth_share(pair: GearPair, owner: Owner) -> float:
    """Share of all positions, 0 to 1, at which they are.

    As the driver turns by a pitch, the flanks of its own tooth next to the line of centres stand at azimuths, times
    sigma, of f and -f, f from -1/2 to 1/2 of a pitch; those of the driven tooth are met at f and 1 - f, f from 0 to 1.
    """
    lowest, highest = (azimuth / pair.pinion.angular_pitch for azimuth in pair.active_azimuths)
    together, first, last = (0.0, -0.5, 0.5) if owner == "driver" else (1.0, 0.0, 1.0)
    begin, end = max(first, lowest, together - highest), min(last, highest, together - lowest)
    return min(1.0, max(0.0, end - begin + ROUNDING))
