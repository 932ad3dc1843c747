"""Families of sets in which tooth numbers are sought: every one with a ratio, within teeth and tooth sums allowed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import GeometryError
from tol3d.gearing.planetary import CARRIER, Drive, ToothSet, compound, simple, wolfrom
from tol3d.numerics.arrays import Array, Places

RATIO_RTOL: Final = 1e-12  # a ratio at the very end of its tolerance counts, however its decimals are rounded
MOST_SETS: Final = 20_000  # with one ratio; they are judged one by one


@dataclass(frozen=True)
class Teeth:
    """Numbers of teeth allowed.

    Args:
        least: of sun and planets.
        largest: of rings.
        sum_difference: of the tooth sums of any two meshes.
    """

    least: int = 12
    largest: int = 150
    sum_difference: int = 2


@dataclass(frozen=True)
class Family:
    """One kind of set.

    Args:
        words: its name.
        order: in which its teeth are written.
        drive: its input, output and held member.
        made: the set of such teeth.
        beside: teeth of the other gears of each set with a sun, (gears, sets) in that order; ratios, (sets,).
    """

    words: str
    order: str
    drive: Drive
    made: Callable[..., ToothSet]
    beside: Callable[[int, Teeth], tuple[Places, Array]]

    def near(self, ratio: float, tolerance: float, teeth: Teeth) -> tuple[tuple[ToothSet, ...], ToothSet | None]:
        """Sets whose ratio lies within a tolerance of that wished, and of all the nearest.

        Raises:
            GeometryError: more than MOST_SETS.
        """
        found: list[tuple[int, ...]] = []
        nearest, least = None, np.inf
        for sun in range(teeth.least, teeth.largest):
            counts, ratios = self.beside(sun, teeth)
            if not ratios.size:
                continue
            off = np.abs(ratios - ratio)
            within = np.flatnonzero(off <= tolerance + RATIO_RTOL * abs(ratio))
            self._refuse_too_many(len(found) + len(within), ratio, tolerance)
            found += [(sun, *map(int, counts[:, k])) for k in within]
            best = int(np.argmin(off))
            if off[best] < least:
                nearest, least = (sun, *map(int, counts[:, best])), off[best]
        return tuple(self.made(*own) for own in found), None if nearest is None else self.made(*nearest)

    def _refuse_too_many(self, count: int, ratio: float, tolerance: float) -> None:
        if count > MOST_SETS:
            raise GeometryError(
                f"ratio: more than {MOST_SETS} {self.words}s have a ratio within {tolerance:g} of {ratio:g}: expected "
                "a smaller tolerance, or fewer teeth"
            )


def _beside_3k(sun: int, teeth: Teeth) -> tuple[Places, Array]:
    """Ratio z_P1 z_R2 (z_S + z_R1) / (z_S (z_P1 z_R2 - z_P2 z_R1)); none whose ring 2 stands still."""
    d = teeth.sum_difference
    planets, more = np.arange(teeth.least, teeth.largest), np.arange(-d, d + 1)
    first = planets[2 * planets + sun - d <= teeth.largest]
    planet_1, more_1, planet_2, more_2 = np.meshgrid(first, more, planets, more, indexing="ij", sparse=True)
    ring_1, ring_2 = sun + 2 * planet_1 + more_1, sun + planet_1 + planet_2 + more_2
    right = (ring_1 <= teeth.largest) & (ring_2 <= teeth.largest) & (abs(more_1 - more_2) <= d)
    right = right & (planet_1 * ring_2 != planet_2 * ring_1)
    counts = _chosen(right, planet_1, ring_1, planet_2, ring_2)
    planet_1, ring_1, planet_2, ring_2 = counts
    slip = (planet_1 * ring_2 - planet_2 * ring_1).astype(np.float64)
    return counts, planet_1 * ring_2 * (sun + ring_1) / (sun * slip)


def _beside_simple(sun: int, teeth: Teeth) -> tuple[Places, Array]:
    """Ratio 1 + z_R/z_S."""
    d = teeth.sum_difference
    planets, more = np.arange(teeth.least, teeth.largest), np.arange(-d, d + 1)
    planet, more_1 = np.meshgrid(planets, more, indexing="ij", sparse=True)
    ring = sun + 2 * planet + more_1
    counts = _chosen(ring <= teeth.largest, planet, ring)
    return counts, 1 + counts[1] / sun


def _beside_compound(sun: int, teeth: Teeth) -> tuple[Places, Array]:
    """Ratio 1 + z_R z_P1/(z_S z_P2)."""
    d = teeth.sum_difference
    planets, more = np.arange(teeth.least, teeth.largest), np.arange(-d, d + 1)
    planet_1, planet_2, more_2 = np.meshgrid(planets, planets, more, indexing="ij", sparse=True)
    ring = sun + planet_1 + planet_2 + more_2
    counts = _chosen(ring <= teeth.largest, planet_1, planet_2, ring)
    return counts, 1 + counts[2] * counts[0] / (sun * counts[1])


def _chosen(right: NDArray[np.bool_], *counts: Places) -> Places:
    """Valid places of a grid, (gears, sets)."""
    return np.stack([broadcast_array[right] for broadcast_array in np.broadcast_arrays(*counts)])


WOLFROM: Final = Family("3K set", "S/P1/R1/P2/R2", Drive("sun", "ring 2", "ring 1"), wolfrom, _beside_3k)
"""Driven at the sun, ring 1 held, ring 2 the output, the carrier free."""
SIMPLE: Final = Family("simple planetary set", "S/P/R", Drive("sun", CARRIER, "ring"), simple, _beside_simple)
"""Driven at the sun, the ring held, the carrier the output."""
COMPOUND: Final = Family(
    "compound planetary set", "S/P1/P2/R", Drive("sun", CARRIER, "ring"), compound, _beside_compound
)
"""A sun on step 1 of the planets, a ring on step 2; driven as a simple set."""
FAMILIES: Final[Mapping[str, Family]] = {"3k": WOLFROM, "simple": SIMPLE, "compound": COMPOUND}
"""Families by their names on the command line."""
