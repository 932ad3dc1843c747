"""Deviations of a trial, read off the names of a run's columns."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SIZES = {"um": 1e-3, "mrad": 1e-3, "arcmin": np.radians(1 / 60), "arcsec": np.radians(1 / 3600)}
"""Size of the units of columns [mm or rad]."""


@dataclass(frozen=True)
class DrawnColumns:
    """One trial of a run's columns."""

    columns: Mapping[str, Array]
    trial: int

    def all(self, name: str, *of: str) -> Array:
        """Components of a tolerance (of,) [mm or rad]; 0 of one that the scene has not."""
        for unit, size in SIZES.items():
            names = [f"{name}.{own} [{unit}]" if own else f"{name} [{unit}]" for own in of]
            if names[0] in self.columns:
                return size * np.array([self.columns[own][self.trial] for own in names])
        return np.zeros(len(of))

    def one(self, name: str) -> float:
        """The deviation of a tolerance that has but one."""
        return float(self.all(name, "")[0])

    def plane(self, name: str, *of: str) -> Complex:
        """Displacements in the plane, x + iy."""
        x, y = (self.all(name, *(f"{own} {axis}".strip() for own in of)) for axis in "xy")
        return np.asarray(x + 1j * y)

    def at(self, move: str) -> float:
        """Nominal position of the output of a move [rad]."""
        return float(np.radians(self.columns[f"position:{move} [deg]"][self.trial]))
