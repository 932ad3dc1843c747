"""Measures of a machine, besides those of its gears and of its parts."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from tol3d.system.plain import PlainMeasure


@dataclass(frozen=True, kw_only=True)
class WorstMeasure(PlainMeasure):
    """The largest of an error in several poses.

    Args:
        sizes: pose and measure of the assembly that is the size there, in order; scenes have no such measure.
        any_flank: whether joints lie on the flanks that make it largest, not on those that their loads choose.
    """

    sizes: tuple[tuple[str, str], ...]
    any_flank: bool = False

    @property
    def longest(self) -> int:
        """Letters of the longest pose."""
        return max(len(pose) for pose, _ in self.sizes)

    def combinations(self, joints: Sequence[str]) -> Iterator[Mapping[str, float] | None]:
        """The ends of their plays at which joints are read; None for those that their loads choose."""
        if not self.any_flank:
            yield None
            return
        for sides in product((-1.0, 1.0), repeat=len(joints)):
            yield dict(zip(joints, sides, strict=True))
