"""Torques of a planetary set with losses in its meshes, from equilibrium alone.

In each mesh power flows in the carrier's frame from the gear that drives it to the other, less the loss: with the
external torque T_k of a central gear and u_k its turn per turn of the planet, the planet receives the torque
T_k u_k eta_k where the central gear drives and T_k u_k / eta_k where the planet does. The planet turns steadily, so
these add up to 0; the set stands, so all external torques do. Members that are neither input, output nor held carry no
torque. Which gear drives each mesh follows from the torques themselves: every combination is tried, and one that
contradicts its own torques is dropped.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from tol3d.planetary.tooth_set import ToothSet


@dataclass(frozen=True)
class Drive:
    """Which members of a set are input, output and held."""

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
        teeth: of the set.
        efficiencies: of each mesh, by its central gear.
        drive: input, output, held.
    """
    return tuple(sorted(_equilibria(teeth, efficiencies, drive), key=lambda own: -own.efficiency))


def efficiency(teeth: ToothSet, efficiencies: Mapping[str, float], drive: Drive) -> float:
    """Of the set in one sense; at most 0 where it locks itself."""
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
