"""Relations that are not met nominally: the freedoms left by earlier ones do not bring both features together."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.assembly.model import Assembly, Feature, Relation
from tol3d.assembly.model.cone_seat import cone_seat
from tol3d.assembly.placing.method import features_placed
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


def _missing(own: Relation, moving: Feature, target: Feature, pose: Array, its: Array) -> tuple[float, Array]:
    """The largest distance of a feature's ends from their places by a relation, and that end (3,) [mm]."""
    ends = moving.shape.ends @ pose[:3, :3].T + pose[:3, 3]
    normal, off = its[:3, 2], ends - its[:3, 3]
    surfaces, sign = (moving.shape.surface, target.shape.surface), float(np.sign(pose[:3, 2] @ normal))
    if surfaces[1] == "point":
        missing = np.linalg.norm(off, axis=1)
    elif own.kind == "coincident" and (seat := cone_seat(moving.shape, target.shape, sign)):
        missing = np.linalg.norm(off - np.outer(seat.height + sign * moving.shape.ends[:, 2], normal), axis=1)
    elif surfaces[1] != "plane" and surfaces[0] != "plane":
        missing = np.linalg.norm(off - np.outer(off @ normal, normal), axis=1)
    elif surfaces[1] != "plane":  # a plane on a cylinder
        ends = target.shape.ends @ its[:3, :3].T + its[:3, 3]
        missing = np.abs((ends - pose[:3, 3]) @ pose[:3, 2] - (target.shape.nominal_size or 0.0) / 2)
    else:
        asked = (moving.shape.nominal_size or 0.0) / 2 if own.kind == "tangent" else own.distance
        missing = np.abs(off @ normal - asked)
    worst = int(np.argmax(missing))
    return float(missing[worst]), ends[worst]
