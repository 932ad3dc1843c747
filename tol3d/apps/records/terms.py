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

from tol3d.apps.records.pair import RigPair, Side
from tol3d.numerics.arrays import Array

ECCENTRIC = ("x1", "y1", "x2", "y2")  # e cos(theta), e sin(theta) of driver and driven gear [mm]
CONSTANTS = ("offset", "constant part")  # of both sides; of the back side more than that [rad]
ENCODERS = ("sin phi1", "cos phi1", "sin phi2", "cos phi2")  # [rad]
TWICE = ("sin 2 phi1", "cos 2 phi1", "sin 2 phi2", "cos 2 phi2")  # [rad]
WINDING = ("winding",)  # [rad/(N m)]
DRIFTS = ("drift drive", "drift back")  # [rad per rad of the driver]


@dataclass(frozen=True)
class Terms:
    """Columns of a fit besides eccentricities and constants.

    Args:
        sides: drive, back or both; one alone has no constant part of its own.
        encoders: the encoders' part once per turn.
        twice: which encoders' part twice per turn, where rows tell it from the others: 1, 2 or both.
        winding: of the shafts under torque, opposite on the two sides.
        drift: linear along each side.
        teeth: orders of the driver that each side has for itself, those of tooth mesh.
    """

    sides: tuple[Side, ...] = ("drive", "back")
    encoders: bool = True
    twice: tuple[int, ...] = ()
    winding: bool = False
    drift: bool = False
    teeth: tuple[int, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        both = len(self.sides) == 2
        names = [*ECCENTRIC, *(CONSTANTS if both else CONSTANTS[:1])]
        names += ENCODERS if self.encoders else ()
        names += [name for encoder in self.twice for name in encoder_names(encoder, 2)]
        names += WINDING if self.winding else ()
        names += [name for name in DRIFTS if self.drift and name.removeprefix("drift ") in self.sides]
        return (*names, *self.tooth_columns)

    @property
    def tooth_columns(self) -> tuple[str, ...]:
        """Names of those of tooth mesh, the last ones."""
        return tuple(name for side in self.sides for order in self.teeth for name in tooth_names(side, order))

    def index(self, names: Sequence[str]) -> NDArray[np.intp]:
        """Places of columns."""
        every = self.names
        return np.array([every.index(name) for name in names], dtype=np.intp)


def encoder_names(encoder: int, order: int) -> tuple[str, str]:
    """Names of the columns of one encoder's part once (order 1) or twice (2) per turn."""
    sin, cos = (ENCODERS, TWICE)[order - 1][2 * encoder - 2 : 2 * encoder]
    return sin, cos


def tooth_names(side: Side, order: int) -> tuple[str, str]:
    """Names of the columns of one order of tooth mesh on one side."""
    return f"{side} sin {order}", f"{side} cos {order}"


@dataclass(frozen=True, eq=False)
class Points:
    """Points at which one side was measured: arrays (n,) of phi1, phi2, travel [rad] and torque [N m]."""

    phi1: Array
    phi2: Array
    travel: Array
    torque: Array


def columns(pair: RigPair, terms: Terms, side: Side, at: Points) -> Array:
    """Columns (n, terms) of one side [rad per unit of each term]."""
    found = np.zeros((len(at.phi1), len(terms.names)))
    place = {name: index for index, name in enumerate(terms.names)}
    sense = 1.0 if side == "drive" else -1.0
    for gear in (1, 2):
        eccentric, common = order_columns(pair, side, gear, 1, at)
        found[:, [place[name] for name in ECCENTRIC[2 * gear - 2 : 2 * gear]]] = eccentric
        if terms.encoders:
            found[:, [place[name] for name in encoder_names(gear, 1)]] = common
        if gear in terms.twice:
            found[:, [place[name] for name in encoder_names(gear, 2)]] = order_columns(pair, side, gear, 2, at)[1]
    found[:, place["offset"]] = 1.0
    if side == "back" and "constant part" in place:
        found[:, place["constant part"]] = 1.0
    if terms.winding:
        found[:, place["winding"]] = -sense * at.torque
    if terms.drift:
        found[:, place[f"drift {side}"]] = at.travel
    for order in terms.teeth:
        sin, cos = tooth_names(side, order)
        found[:, place[sin]], found[:, place[cos]] = np.sin(order * at.phi1), np.cos(order * at.phi1)
    return found


def difference_columns(pair: RigPair, terms: Terms, phi1: Array, phi2: Array) -> Array:
    """Columns (n, terms) of the backlash as it is measured, back less drive, without torque or drift."""
    at = Points(phi1, phi2, np.zeros_like(phi1), np.zeros_like(phi1))
    return columns(pair, terms, "back", at) - columns(pair, terms, "drive", at)


def order_columns(pair: RigPair, side: Side, gear: int, order: int, at: Points) -> tuple[Array, Array]:
    """Sine and cosine of one order of a gear's turn, (n, 2) each.

    Returns:
        As an eccentricity has them at order 1, ahead of or behind the working angle [rad/mm]; as both sides share them
        [rad].
    """
    sense = 1.0 if side == "drive" else -1.0
    turn, ahead = (at.phi1, sense) if gear == 1 else (at.phi2, -sense)
    own, common = order * turn + ahead * pair.working_angle, order * turn
    eccentric = np.stack([np.sin(own), np.cos(own)], axis=1) / pair.driven_base_radius
    return eccentric, np.stack([np.sin(common), np.cos(common)], axis=1)


def backlash_columns(pair: RigPair, phi1: Array, phi2: Array) -> Array:
    """Columns (n, 5) of the backlash [rad] by x1, y1, x2, y2 [mm] and the constant part [rad].

    j = 2 sin(alpha)/r_b2 [e2 cos(phi2 + theta2) - e1 cos(phi1 + theta1)] + j_c.
    """
    steep = 2 * np.sin(pair.working_angle) / pair.driven_base_radius
    parts = (-np.cos(phi1), np.sin(phi1), np.cos(phi2), -np.sin(phi2))
    return np.stack([*(steep * part for part in parts), np.ones_like(phi1)], axis=1)
