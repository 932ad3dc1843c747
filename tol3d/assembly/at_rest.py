"""An assembly without deviations, as both methods have it: kept by its value, so that a scene read again finds it.

What both methods make of nominal geometry depends on the assembly alone, not on the laws of its contributors. A scene
of which a tolerance was edited has the same assembly, unless the tolerance's width is part of a matrix or of a gauge.
Relations that are not met nominally are found here too.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

import numpy as np

from tol3d.assembly.model import Assembly, Feature, Relation
from tol3d.assembly.model.cone_seat import cone_seat
from tol3d.assembly.placing import method as placing
from tol3d.assembly.placing.method import features_placed
from tol3d.assembly.placing.poses import Codes
from tol3d.assembly.torsors import method as torsors
from tol3d.numerics.arrays import Array

MEETS: Final = 2e-3
"""mm; largest gap of features that meet nominally: numbers rounded to a thousandth miss by as much."""


@dataclass(frozen=True)
class Miss:
    """A relation that is not met.

    Args:
        move: its move.
        number: of the relation in it, from 0.
        relation: the relation.
        amount: by how much, at the end of the moving feature where that is most [mm].
        at: that end, in the world (3,) [mm].
    """

    move: str
    number: int
    relation: Relation
    amount: float
    at: tuple[float, float, float]

    @property
    def sentence(self) -> str:
        """Expected and actual relation, in a sentence."""
        own = self.relation
        kinds = {"coincident": "meet", "coaxial": "be coaxial", "tangent": "touch", "distance": "lie so"}
        place = ", ".join(f"{round(value, 4) + 0.0:g}" for value in self.at)
        return (
            f"expected {own.moving!r} and {own.target!r} to {kinds[own.kind]} without deviations, got "
            f"{self.amount:.4g} mm between them at ({place}) mm, as earlier relations leave no freedom to close it; "
            "make their places or directions agree, or constrain only the freedoms left"
        )


def misses(assembly: Assembly) -> Iterator[Miss]:
    """Relations of all moves that are not met within MEETS, with parts placed without deviations."""
    rest = np.zeros((1, assembly.width))
    for index, move in enumerate(assembly.moves):
        relations: tuple[Relation, ...] = getattr(move, "relations", ())
        if not relations:
            continue
        frames = features_placed(assembly, rest, index)
        for k, own in enumerate(relations):
            moving, target = (assembly.features[name] for name in (own.moving, own.target))
            amount, at = _missing(own, moving, target, frames[own.moving][0], frames[own.target][0])
            if amount > MEETS:  # not where a move failed: NaN
                yield Miss(move.name, k, own, amount, (float(at[0]), float(at[1]), float(at[2])))


def _missing(relation: Relation, moving: Feature, target: Feature, pose: Array, its: Array) -> tuple[float, Array]:
    """The largest distance of a feature's ends from their places by a relation, and that end (3,) [mm]."""
    ends = moving.shape.ends @ pose[:3, :3].T + pose[:3, 3]
    normal, off = its[:3, 2], ends - its[:3, 3]
    surfaces, sign = (moving.shape.surface, target.shape.surface), float(np.sign(pose[:3, 2] @ normal))
    if surfaces[1] == "point":
        missing = np.linalg.norm(off, axis=1)
    elif relation.kind == "coincident" and (seat := cone_seat(moving.shape, target.shape, sign)):
        missing = np.linalg.norm(off - np.outer(seat.height + sign * moving.shape.ends[:, 2], normal), axis=1)
    elif surfaces[1] != "plane" and surfaces[0] != "plane":
        missing = np.linalg.norm(off - np.outer(off @ normal, normal), axis=1)
    elif surfaces[1] != "plane":  # a plane on a cylinder
        ends = target.shape.ends @ its[:3, :3].T + its[:3, 3]
        missing = np.abs((ends - pose[:3, 3]) @ pose[:3, 2] - (target.shape.nominal_size or 0.0) / 2)
    else:
        asked = (moving.shape.nominal_size or 0.0) / 2 if relation.kind == "tangent" else relation.distance
        missing = np.abs(off @ normal - asked)
    worst = int(np.argmax(missing))
    return float(missing[worst]), ends[worst]


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
