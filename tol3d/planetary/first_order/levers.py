"""Bound on the change of a shaft's play for a small error of every gap.

Of a planet's rows any two leave its own turn out: a relation between shafts, and springs. As many of them as there are
unknowns decide where a shaft stops, whichever contacts hold it; so the worst such choice bounds what gaps may do.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.planetary.model.planetary_set import PlanetarySet

INDEPENDENT: Final = 1e-9  # of relations in mm a turn; those of less decide nothing
ALIKE: Final = 12  # decimals; planets that stand alike have the same relations


def play_bound(own: PlanetarySet, shaft: str, errors: Sequence[float]) -> float:
    """Largest change of a shaft's end [rad] where each gap of a mesh is off by up to an error.

    Args:
        shaft: the input or the output; the other one stands.
        errors: of each mesh [mm].
    """
    relations, amounts = (np.array(each) for each in zip(*_relations(own, shaft, errors), strict=True))
    _, first = np.unique(np.round(np.column_stack([relations, amounts]), ALIKE), axis=0, return_index=True)
    relations, amounts = relations[first], amounts[first]
    turn = np.zeros(relations.shape[1])
    turn[_coordinates(own, shaft).index(own.shafts.index(shaft))] = 1.0
    worst = 0.0
    for chosen in combinations(range(len(relations)), relations.shape[1]):
        basis = relations[list(chosen)]
        if abs(np.linalg.det(basis)) > INDEPENDENT:
            worst = max(worst, float(np.abs(np.linalg.solve(basis.T, turn)) @ amounts[list(chosen)]))
    return worst


def _coordinates(own: PlanetarySet, shaft: str) -> list[int]:
    """Unknowns that are no planet's."""
    planets = range(len(own.shafts), len(own.shafts) + own.planets)
    return [place for place in own.unknowns(own.opposite(shaft)) if place not in planets]


def _relations(own: PlanetarySet, shaft: str, errors: Sequence[float]) -> Iterator[tuple[Array, float]]:
    """Each with its largest error [mm a mm of the planet's base radius]; springs that are set are exact."""
    coordinates, count = _coordinates(own, shaft), len(own.meshes)
    for planet in range(own.planets):
        rows = own.all_rows[planet * count : (planet + 1) * count]
        radii = rows[:, len(own.shafts) + planet]
        for one, other in combinations(range(count), 2):
            relation = rows[one] / radii[one] - rows[other] / radii[other]
            yield relation[coordinates], errors[one] / radii[one] + errors[other] / radii[other]
    for spring, its in zip(own.springs, own.all_rows[own.planets * count :], strict=True):
        if not spring.pushes:
            yield its[coordinates], 0.0
