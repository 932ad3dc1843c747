"""Efficiency of a set by the friction of its meshes: from equilibrium of its torques, and as published for 3K sets.

In each mesh power flows in the carrier's frame from the gear that drives it to the other, less the loss: with the
external torque T_k of a central gear and u_k its turn per turn of the planet, the planet receives the torque
T_k u_k eta_k where the central gear drives and T_k u_k / eta_k where the planet does. The planet turns steadily, so
these add up to 0; the set stands, so all external torques do. Members that are neither input, output nor held carry no
torque. Which gear drives each mesh follows from the torques themselves: every combination is tried, and one that
contradicts its own torques is dropped.

The closed form, ring 1 held and the carrier free: Wang, Yang, Du, Chen: Design of 3K planetary gear reducers with no
backlash, China Mechanical Engineering 2024(1), doi 10.3969/j.issn.1004-132X.2024.01.003, by the power in the meshes
seen from the carrier. Which gear drives each mesh is taken as it is in a set that does not lock itself: where the
backward one is 0 or less, its size has no meaning.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Literal, NamedTuple

import numpy as np

from tol3d.gearing.planetary.model.tooth_set import ToothSet

Sharing = Literal["formula", "equal shares"]


def sliding_factor(epsilon_1: float, epsilon_2: float) -> float:
    """E = epsilon_1^2 + epsilon_2^2 - epsilon_1 - epsilon_2 + 1 of the parts of a path of contact.

    Twice the mean distance of contact from the pitch point in base pitches, where pairs in contact share the load
    alike; exact with both parts in 0 to 1 and their sum in 1 to 2, beyond that too large. Source: Wang, Yang, Du, Chen,
    China Mechanical Engineering 2024(1).

    >>> sliding_factor(0.5, 0.5)
    0.5
    """
    return epsilon_1**2 + epsilon_2**2 - epsilon_1 - epsilon_2 + 1


def shared_sliding_factor(epsilon_1: float, epsilon_2: float) -> float:
    """The same for any path of contact of at least one base pitch: pairs in contact carry alike.

    Pairs stand at s + k, k any integer; between the phases at which one enters, leaves or passes the pitch point their
    number is constant and the sum of ``|s + k|`` linear, so its mean is that in the middle.

    >>> round(shared_sliding_factor(0.5, 0.7), 12) == round(sliding_factor(0.5, 0.7), 12)
    True
    """
    phases = sorted({0.0, 1.0, epsilon_1 % 1.0, -epsilon_2 % 1.0})
    total = 0.0
    for low, high in pairwise(phases):
        middle = (low + high) / 2
        first = math.ceil(-epsilon_2 - middle)
        places = [middle + k for k in range(first, math.floor(epsilon_1 - middle) + 1)]
        if places:
            total += (high - low) * sum(map(abs, places)) / len(places)
    return 2 * total


@dataclass(frozen=True)
class Drive:
    """Members of a set that are input, output and held."""

    input: str
    output: str
    held: str

    @property
    def reversed(self) -> "Drive":
        """Driven at the output."""
        return Drive(self.output, self.input, self.held)

    def ratio(self, teeth: ToothSet) -> float:
        """Speed of the input over that of the output."""
        return float(teeth.ratio(self.input, self.output, self.held))


@dataclass(frozen=True)
class Balance:
    """A set in equilibrium.

    Args:
        torques: external ones of each member over the input's.
        driven_by_centre: of each central gear, whether it drives its mesh in the carrier's frame.
        efficiency: power taken from the output over that given to the input; at most 0 where the output must be driven
            too: the set locks itself.
    """

    torques: Mapping[str, float]
    driven_by_centre: Mapping[str, bool]
    efficiency: float


def balances(teeth: ToothSet, efficiencies: Mapping[str, float], drive: Drive) -> tuple[Balance, ...]:
    """Every equilibrium, the most efficient first; a set that locks itself backwards has a jammed one forwards too.

    Args:
        efficiencies: of each mesh, by its central gear.
    """
    return tuple(sorted(_equilibria(teeth, efficiencies, drive), key=lambda own: -own.efficiency))


def efficiency(teeth: ToothSet, efficiencies: Mapping[str, float], drive: Drive) -> float:
    """Efficiency of the set in one sense; at most 0 if it is self-locking."""
    found = balances(teeth, efficiencies, drive)
    return found[0].efficiency


def _equilibria(teeth: ToothSet, efficiencies: Mapping[str, float], drive: Drive) -> Iterator[Balance]:
    loaded = (drive.input, drive.output, drive.held)
    central = [mesh.central for mesh in teeth.meshes if mesh.central in loaded]
    planet_speed = 1 / (teeth.turn(drive.input) - teeth.turn(drive.held))  # with the input turning by 1
    output_speed = float((teeth.turn(drive.output) - teeth.turn(drive.held)) * planet_speed)
    for driving in product((True, False), repeat=len(central)):
        by_centre = dict(zip(central, driving, strict=True))
        torques = _torques(teeth, efficiencies, drive, by_centre)
        if torques is None:
            continue
        powers = {name: torques[name] * float(teeth.turn(name) * planet_speed) for name in central}
        if all(power == 0.0 or (power > 0.0) == by_centre[name] for name, power in powers.items()):
            own = {name: by_centre[name] for name in central if powers[name] != 0.0}
            yield Balance(torques, own, -torques[drive.output] * output_speed)


def _torques(
    teeth: ToothSet, efficiencies: Mapping[str, float], drive: Drive, by_centre: Mapping[str, bool]
) -> Mapping[str, float] | None:
    """External torques with 1 at the input; None where none are in equilibrium."""

    def arm(member: str) -> float:
        """Torque on the planet of one of that member."""
        if member not in by_centre:
            return 0.0  # the carrier
        kept = efficiencies[member] if by_centre[member] else 1 / efficiencies[member]
        return float(teeth.turn(member)) * kept

    unknown = (drive.output, drive.held)
    sums = np.array([[1.0, 1.0], [arm(name) for name in unknown]])
    if np.linalg.det(sums) == 0.0:
        return None
    solved = np.linalg.solve(sums, [-1.0, -arm(drive.input)])
    return {drive.input: 1.0, **dict(zip(unknown, map(float, solved), strict=True))}


class Efficiencies(NamedTuple):
    """Efficiencies of a set, driven at the sun and driven at ring 2."""

    forward: float
    backward: float


class MeshEfficiencies(NamedTuple):
    """Efficiencies of the meshes a (sun), b (ring 1), c (ring 2)."""

    a: float
    b: float
    c: float


def inner_ratios(teeth: ToothSet) -> tuple[float, float]:
    """I1 = z_R1/z_S and I2 = z_R1 z_P2/(z_R2 z_P1) of a 3K set."""
    sun, ring_1, ring_2 = teeth.meshes
    return ring_1.teeth / sun.teeth, ring_1.teeth * ring_2.planet_teeth / (ring_2.teeth * ring_1.planet_teeth)


def published_efficiencies(teeth: ToothSet, meshes: MeshEfficiencies) -> Efficiencies:
    """Forward and backward.

    >>> from tol3d.gearing.planetary.model.tooth_set import wolfrom
    >>> own = published_efficiencies(wolfrom(25, 27, 79, 24, 76), MeshEfficiencies(0.99, 0.995, 0.993))
    >>> round(own.forward, 7), round(own.backward, 7)
    (0.8631271, 0.8430985)
    """
    i1, i2 = inner_ratios(teeth)
    a, b, c = meshes
    if i2 < 1:
        forward = (1 + a * b * i1) * (1 - i2) / ((1 + i1) * (1 - b * c * i2))
        backward = (1 + i1) * a * (b * c - i2) / (c * (a * b + i1) * (1 - i2))
    else:
        forward = (i2 - 1) * (i1 * a * c + b * c) / ((i2 - b * c) * (1 + i1))
        backward = (i2 * c - 1 / b) * (1 + i1) / ((i1 / a + 1 / b) * (i2 - 1))
    return Efficiencies(forward, backward)
