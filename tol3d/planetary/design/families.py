"""Families of sets in which tooth numbers are sought: every one with a ratio, within teeth and tooth sums allowed."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import GeometryError
from tol3d.planetary.design.torque_balance import Drive
from tol3d.planetary.tooth_set import CARRIER, ToothSet, simple, wolfrom

Counts = NDArray[np.int64]
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


class Family(Protocol):
    """One kind of set, the order in which its teeth are written, and how it is driven."""

    words: ClassVar[str]
    order: ClassVar[str]
    drive: ClassVar[Drive]

    def near(self, ratio: float, tolerance: float, teeth: Teeth) -> tuple[tuple[ToothSet, ...], ToothSet | None]:
        """Sets whose ratio lies within a tolerance of that wished, and of all the nearest.

        Raises:
            GeometryError: more than MOST_SETS.
        """
        ...


@dataclass(frozen=True)
class Wolfrom:
    """3K sets: driven at the sun, ring 1 held, ring 2 the output, the carrier free."""

    words: ClassVar[str] = "3K set"
    order: ClassVar[str] = "S/P1/R1/P2/R2"
    drive: ClassVar[Drive] = Drive("sun", "ring 2", "ring 1")

    def near(self, ratio: float, tolerance: float, teeth: Teeth) -> tuple[tuple[ToothSet, ...], ToothSet | None]:
        """See Family; ratio = z_P1 z_R2 (z_S + z_R1) / (z_S (z_P1 z_R2 - z_P2 z_R1))."""
        found: list[tuple[int, ...]] = []
        nearest, off_nearest = None, np.inf
        for sun in range(teeth.least, teeth.largest):
            counts = self._counts(sun, teeth)
            if not counts.size:
                continue
            planet_1, ring_1, planet_2, ring_2 = counts
            slip = planet_1 * ring_2 - planet_2 * ring_1
            with np.errstate(divide="ignore"):
                off = np.abs(planet_1 * ring_2 * (sun + ring_1) / (sun * slip.astype(np.float64)) - ratio)
            within = np.flatnonzero(off <= tolerance + RATIO_RTOL * abs(ratio))
            _refuse_too_many(len(found) + len(within), self.words, ratio, tolerance)
            found += [(sun, *map(int, counts[:, k])) for k in within]
            best = int(np.argmin(off))
            if off[best] < off_nearest:
                nearest, off_nearest = (sun, *map(int, counts[:, best])), off[best]
        return tuple(wolfrom(*own) for own in found), None if nearest is None else wolfrom(*nearest)

    @staticmethod
    def _counts(sun: int, teeth: Teeth) -> Counts:
        """Teeth of planet 1, ring 1, planet 2, ring 2 beside a sun, (4, sets); none whose ring 2 stands still."""
        d = teeth.sum_difference
        planets = np.arange(teeth.least, teeth.largest)
        more = np.arange(-d, d + 1)
        planet_1, more_1, planet_2, more_2 = np.meshgrid(
            planets[2 * planets + sun - d <= teeth.largest], more, planets, more, indexing="ij", sparse=True
        )
        ring_1 = sun + 2 * planet_1 + more_1
        ring_2 = sun + planet_1 + planet_2 + more_2
        right = (ring_1 <= teeth.largest) & (ring_2 <= teeth.largest) & (abs(more_1 - more_2) <= d)
        right = right & (planet_1 * ring_2 != planet_2 * ring_1)
        every = np.broadcast_arrays(planet_1, ring_1, planet_2, ring_2)
        return np.stack([own[right] for own in every])


@dataclass(frozen=True)
class Simple:
    """Sun, planets, ring: driven at the sun, the ring held, the carrier the output."""

    words: ClassVar[str] = "simple planetary set"
    order: ClassVar[str] = "S/P/R"
    drive: ClassVar[Drive] = Drive("sun", CARRIER, "ring")

    def near(self, ratio: float, tolerance: float, teeth: Teeth) -> tuple[tuple[ToothSet, ...], ToothSet | None]:
        """See Family; ratio = 1 + z_R/z_S."""
        every = sorted(self._every(teeth), key=lambda own: abs(1 + own[2] / own[0] - ratio))
        reach = tolerance + RATIO_RTOL * abs(ratio)
        found = [own for own in every if abs(1 + own[2] / own[0] - ratio) <= reach]
        _refuse_too_many(len(found), self.words, ratio, tolerance)
        return tuple(simple(*own) for own in found), simple(*every[0]) if every else None

    @staticmethod
    def _every(teeth: Teeth) -> Iterator[tuple[int, int, int]]:
        d = teeth.sum_difference
        for sun in range(teeth.least, teeth.largest):
            for planet in range(teeth.least, (teeth.largest - sun + d) // 2 + 1):
                for ring in range(sun + 2 * planet - d, min(sun + 2 * planet + d, teeth.largest) + 1):
                    yield sun, planet, ring


def _refuse_too_many(count: int, words: str, ratio: float, tolerance: float) -> None:
    if count > MOST_SETS:
        raise GeometryError(
            f"ratio: more than {MOST_SETS} {words}s have a ratio within {tolerance:g} of {ratio:g}: expected a smaller "
            "tolerance, or fewer teeth"
        )


FAMILIES: Final[Mapping[str, Family]] = {"3k": Wolfrom(), "simple": Simple()}
"""By their names on the command line."""
