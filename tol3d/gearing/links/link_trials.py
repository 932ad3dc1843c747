"""What a link sees of some trials."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.system.contributor import Contributor

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinkTrials:
    """Deviations of a link and the positions of its driver, trial on axis 0.

    Args:
        contributors: those whose deviations are the link's, in the scene's order.
        deviations: of each by name, (trials, components) [mm, rad, K].
        angles: of the driver's shaft against the link's carrier [rad], (trials, positions); 0 of a link whose play does
            not depend on them.
    """

    contributors: Sequence[Contributor]
    deviations: Mapping[str, Array]
    angles: Array

    def __len__(self) -> int:
        """How many trials."""
        return len(self.angles)

    def part(self, first: int, last: int) -> "LinkTrials":
        """Trials from one to before another."""
        deviations = {name: own[first:last] for name, own in self.deviations.items()}
        return LinkTrials(self.contributors, deviations, self.angles[first:last])

    def rows(self, places: NDArray[np.intp]) -> "LinkTrials":
        """Some trials."""
        deviations = {name: own[places] for name, own in self.deviations.items()}
        return LinkTrials(self.contributors, deviations, self.angles[places])

    def of(self, kind: str) -> Array:
        """Components (trials, components) of the contributors of a kind, added up; 0 where there is none."""
        own = [self.deviations[each.name] for each in self.contributors if each.kind == kind]
        return np.asarray(sum(own, np.zeros((len(self), 1))))
