"""Reducers known by their data sheets, the same on both methods."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tol3d.gearing.links.stated_link import FreeTurn, LinkTrials, StatedLink
from tol3d.study.system.contributor import Contributor
from tol3d.units import angle_text


@dataclass(frozen=True, kw_only=True)
class Reducer(StatedLink):
    """A reducer between two shafts on one axis, with ratio and backlash from a data sheet.

    Args:
        backlash: angular backlash of the driven shaft [rad], taken in every trial; 0 where a contributor draws it.
    """

    kind: ClassVar[str] = "reducer"
    adds_up: ClassVar[bool] = True

    backlash: float = 0.0

    @property
    def remark(self) -> str:
        """The backlash of every trial."""
        return f"{angle_text(self.backlash)} of play in every trial" if self.backlash else ""

    def exact(self, seen: LinkTrials) -> FreeTurn:
        """The data sheet's maximum, or a contributor's draw."""
        total = np.full(len(seen), self.backlash)
        for contributor in seen.contributors:
            total = total + seen.deviations[contributor.name][:, 0]
        return FreeTurn(total[:, None])

    def ends(self, contributors: Sequence[Contributor]) -> tuple[float, float] | None:
        """Those of the contributor's law."""
        for contributor in contributors:
            return contributor.distribution.low, contributor.distribution.high
        return None
