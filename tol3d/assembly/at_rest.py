"""An assembly without deviations, as both methods have it: kept by its value, so that a scene read again finds it.

What both methods make of nominal geometry depends on the assembly alone, not on the laws of its contributors. A scene
of which a tolerance was edited has the same assembly, unless the tolerance's width is part of a matrix or of a gauge.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

import numpy as np

from tol3d.assembly.model import Assembly
from tol3d.assembly.nominal_relations import Miss, misses
from tol3d.assembly.placing import method as placing
from tol3d.assembly.placing.poses import Codes
from tol3d.assembly.torsors import method as torsors
from tol3d.numerics.arrays import Array

KEPT: Final = 256
"""Assemblies that are kept: two of each pose, as drawn and as settled."""
LARGEST: Final = 2000
"""Features of the largest that is kept, about 10 kB each."""


@dataclass(frozen=True, eq=False)
class AtRest:
    """An assembly without deviations.

    Args:
        assembly: of the assemblies that are equal, the one that is kept with what the methods know of it.
    """

    assembly: Assembly

    @cached_property
    def _rest(self) -> Array:
        return np.zeros((1, self.assembly.width))

    @cached_property
    def poses(self) -> Mapping[str, Array]:
        """Poses of parts as moves place them, in the world (4, 4); parts that cannot be placed are left out."""
        found = placing.placed(self.assembly, self._rest)
        return {name: np.asarray(pose[0]) for name, pose in found.items() if np.isfinite(pose[0]).all()}

    @cached_property
    def misses(self) -> tuple[Miss, ...]:
        """Relations that are not met."""
        return tuple(misses(self.assembly))

    @cached_property
    def exact(self) -> Mapping[str, tuple[Array, Codes]]:
        """Values and codes (1,) of all measures by the exact method; clearances of solids are not among them."""
        return placing.values(self.assembly, self._rest, list(self.assembly.measures))

    @cached_property
    def linear(self) -> Mapping[str, Array]:
        """Values (1,) of all measures by the analytic method."""
        return torsors.values(self.assembly, self._rest, list(self.assembly.measures))


def at_rest(assembly: Assembly) -> AtRest:
    """An assembly without deviations; of equal assemblies, that which was asked for before.

    Its properties raise InputError as both methods do, see `placing.method.values` and `torsors.method.values`.
    """
    return AtRest(assembly) if len(assembly.features) > LARGEST else _kept(assembly)


@lru_cache(maxsize=KEPT)
def _kept(assembly: Assembly) -> AtRest:
    return AtRest(assembly)
