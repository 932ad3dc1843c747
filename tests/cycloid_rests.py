"""Random builds of a cycloid stage whose bodies rest under a torque."""

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.cycloid.model.stage import Deviated

Array = NDArray[np.float64]


def drawn(trials: int, scale: float, seed: int) -> Deviated:
    """Deviations of everything, of some size [mm]; phases of the cranks by a hundredth of it [rad]."""
    rng = np.random.default_rng(seed)
    nothing = Deviated.nothing(trials, 40, 2, 3)
    sizes = {name: scale / 100 if name == "crank_phases" else scale for name in nothing.__dataclass_fields__}
    return Deviated(**{name: size * rng.standard_normal(getattr(nothing, name).shape) for name, size in sizes.items()})


def phis_of(trials: int) -> Array:
    """A random crank angle each."""
    return np.random.default_rng(trials).uniform(0, 2 * np.pi * 39, (trials, 1))
