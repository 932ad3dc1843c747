"""Shafts with helical gears as a linear programme over turns and shifts along the axes: no thrust, no load path.

Each mesh lets its gears turn against each other within its play; a gear that slides turns its mate as a screw does its
nut. What is possible within that and the axial plays bounds a turn. Knows teeth, angles and hands of a drawing alone.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog


@dataclass(frozen=True)
class Helical:
    """A helical gear on a shaft; hand 1 right, -1 left; sense -1 where its z goes against the shaft's."""

    shaft: str
    teeth: int
    module: float
    helix: float
    hand: int
    sense: int = 1

    @property
    def radius(self) -> float:
        """Radius of the reference circle [mm]."""
        return self.module * self.teeth / math.cos(self.helix) / 2

    @property
    def lead(self) -> float:
        """Advance of a tooth in a whole turn [mm], negative of a left hand; infinite of a spur gear."""
        return self.hand * 2 * math.pi * self.radius / math.tan(self.helix) if self.helix else math.inf

    def unscrewed(self, turn: Mapping[str, float], shift: Mapping[str, float]) -> float:
        """Turn of its teeth in the plane of its mate's middle, about its own z, by unit turns and shifts of shafts.

        A tooth that lay there before the shift has gone on with the gear; the one that comes is that much behind.
        """
        return self.sense * (turn.get(self.shaft, 0.0) - 2 * math.pi * shift.get(self.shaft, 0.0) / self.lead)


@dataclass(frozen=True)
class Meshing:
    """Two external gears in mesh; both count turns about one direction where their z agree. Play [mm] of the arc."""

    driver: Helical
    driven: Helical
    play: float

    def row(self, unknown: Sequence[tuple[str, str]]) -> np.ndarray:
        """Arc by which the driven teeth lead the driver's, per unknown (what, shaft)."""
        row = []
        for what, shaft in unknown:
            turn, shift = ({shaft: 1.0}, {}) if what == "turn" else ({}, {shaft: 1.0})
            first, last = (gear.unscrewed(turn, shift) * gear.radius for gear in (self.driver, self.driven))
            row.append(last + first)  # external: they turn opposite
        return np.array(row)


def turn_between(
    meshes: Sequence[Meshing],
    held: str,
    read: str,
    axial: Mapping[str, tuple[float, float]],
    rest: Mapping[str, float] | None = None,
) -> tuple[float, float]:
    """Least and largest turn [rad] of a shaft, another one held.

    Args:
        meshes: all that there are.
        held, read: shafts.
        axial: bounds of the shift of each shaft that slides [mm]; others stay.
        rest: arc by which the driven teeth of some meshes stand ahead of the middle, by their driven shafts [mm].
    """
    shafts = dict.fromkeys(gear.shaft for mesh in meshes for gear in (mesh.driver, mesh.driven))
    unknown = [("turn", shaft) for shaft in shafts] + [("shift", shaft) for shaft in axial]
    bounds = [(0.0, 0.0) if shaft == held else (None, None) for shaft in shafts] + list(axial.values())
    rows = np.array([mesh.row(unknown) for mesh in meshes])
    ahead = np.array([(rest or {}).get(mesh.driven.shaft, 0.0) for mesh in meshes])
    half = np.array([mesh.play / 2 for mesh in meshes])
    limits = np.concatenate([half + ahead, half - ahead])
    aim = np.zeros(len(unknown))
    aim[unknown.index(("turn", read))] = 1.0
    scale = 1000.0  # arcs in um: the solver's tolerance is absolute
    found = [
        linprog(sign * aim, np.vstack([rows, -rows]) * scale, limits * scale, bounds=bounds, method="highs")
        for sign in (1.0, -1.0)
    ]
    assert all(own.success for own in found), [own.message for own in found]
    return float(found[0].fun), -float(found[1].fun)
