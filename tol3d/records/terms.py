"""The first-order transmission error of both sides, as columns of a linear fit.

    drive  r_b2 TE = e1 sin(phi1 + alpha + theta1) + e2 sin(phi2 - alpha + theta2)
    back   r_b2 TE = e1 sin(phi1 - alpha + theta1) + e2 sin(phi2 + alpha + theta2)

and on both sides, alike, the encoders' part once per turn of either shaft: the difference of the sides is free of it.
alpha is the working pressure angle. Source: see pair.py, equations 3 to 5.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.records.exact_play import Side
from tol3d.records.pair import RigPair

Array = NDArray[np.float64]

ECCENTRIC = ("x1", "y1", "x2", "y2")  # e cos(theta), e sin(theta) of driver and driven gear [mm]
CONSTANTS = ("offset", "constant part")  # of both sides; of the back side more than that [rad]
ENCODERS = ("sin phi1", "cos phi1", "sin phi2", "cos phi2")  # [rad]
WINDING = ("winding",)  # [rad/(N m)]
DRIFTS = ("drift drive", "drift back")  # [rad per rad of the driver]


@dataclass(frozen=True)
class Terms:
    """Which columns a fit has besides eccentricities and constants.

    Args:
        sides: drive, back or both; one alone has no constant part of its own.
        encoders: the encoders' part once per turn.
        winding: of the shafts under torque, opposite on the two sides.
        drift: linear along each side.
        teeth: orders of the driver that each side has for itself, those of tooth mesh.
    """

    sides: tuple[Side, ...] = ("drive", "back")
    encoders: bool = True
    winding: bool = False
    drift: bool = False
    teeth: tuple[int, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Of the columns."""
        both = len(self.sides) == 2
        names = [*ECCENTRIC, *(CONSTANTS if both else CONSTANTS[:1])]
        names += ENCODERS if self.encoders else ()
        names += WINDING if self.winding else ()
        names += [name for name in DRIFTS if self.drift and name.removeprefix("drift ") in self.sides]
        names += [name for side in self.sides for order in self.teeth for name in tooth_names(side, order)]
        return tuple(names)

    def index(self, names: Sequence[str]) -> NDArray[np.intp]:
        """Places of columns."""
        every = self.names
        return np.array([every.index(name) for name in names], dtype=np.intp)


def tooth_names(side: Side, order: int) -> tuple[str, str]:
    """Of the columns of one order of tooth mesh on one side."""
    return f"{side} sin {order}", f"{side} cos {order}"


@dataclass(frozen=True, eq=False)
class Points:
    """Where one side was measured: arrays (n,) of phi1, phi2, travel [rad] and torque [N m]."""

    phi1: Array
    phi2: Array
    travel: Array
    torque: Array


def columns(pair: RigPair, terms: Terms, side: Side, at: Points) -> Array:
    """Columns (n, terms) of one side [rad per unit of each term]."""
    found = np.zeros((len(at.phi1), len(terms.names)))
    place = {name: index for index, name in enumerate(terms.names)}
    sense = 1.0 if side == "drive" else -1.0
    alpha, arm = pair.working_angle, pair.driven_base_radius
    first, second = at.phi1 + sense * alpha, at.phi2 - sense * alpha
    for name, values in zip(ECCENTRIC, (np.sin(first), np.cos(first), np.sin(second), np.cos(second)), strict=True):
        found[:, place[name]] = values / arm
    found[:, place["offset"]] = 1.0
    if side == "back" and "constant part" in place:
        found[:, place["constant part"]] = 1.0
    if terms.encoders:
        own = (np.sin(at.phi1), np.cos(at.phi1), np.sin(at.phi2), np.cos(at.phi2))
        found[:, place[ENCODERS[0]] : place[ENCODERS[-1]] + 1] = np.stack(own, axis=1)
    if terms.winding:
        found[:, place["winding"]] = -sense * at.torque
    if terms.drift:
        found[:, place[f"drift {side}"]] = at.travel
    for order in terms.teeth:
        sin, cos = tooth_names(side, order)
        found[:, place[sin]], found[:, place[cos]] = np.sin(order * at.phi1), np.cos(order * at.phi1)
    return found


def backlash_columns(pair: RigPair, phi1: Array, phi2: Array) -> Array:
    """Columns (n, 5) of the backlash [rad] by x1, y1, x2, y2 [mm] and the constant part [rad].

    j = 2 sin(alpha)/r_b2 [e2 cos(phi2 + theta2) - e1 cos(phi1 + theta1)] + j_c.
    """
    steep = 2 * np.sin(pair.working_angle) / pair.driven_base_radius
    parts = (-np.cos(phi1), np.sin(phi1), np.cos(phi2), -np.sin(phi2))
    return np.stack([*(steep * part for part in parts), np.ones_like(phi1)], axis=1)
