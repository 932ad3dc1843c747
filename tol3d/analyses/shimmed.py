"""What a study found of a scene with shims of one thickness, and which number of it is called the minimum."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

from tol3d.distributions.base import LOW_PROBABILITY
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.sample import Sample

Minimum = Literal["low_3sigma", "p0.135", "sample_min"]

MINIMUM_WORDS: Final[Mapping[Minimum, str]] = {
    "low_3sigma": "mean − 3 sigma",
    "p0.135": "0.135 % quantile",
    "sample_min": "smallest of the trials",
}
UNMEASURED: Final[Mapping[Minimum, float]] = {"low_3sigma": 1.0, "p0.135": LOW_PROBABILITY, "sample_min": 0.0}
"""The share of builds that interfere, and have no backlash to measure, with which a minimum is still above nothing."""

BELOW_NOTHING: Final = -1e-3  # mm; for a minimum that is less than nothing by an unknown length: a search goes back
UM: Final = 1000.0  # um in a mm
MINIMUM_XTOL: Final = 5e-6  # mm of backlash; half of the 0.01 um that is promised, and what FCL rounds


@dataclass(frozen=True)
class Shimmed:
    """What a study found of a scene with its shims.

    Args:
        thickness: of each shim [mm]; None for the scene as it stands.
        called: which number is called the minimum.
        measure: as summary.json shows it [um, arcmin].
        found: what the 3D simulation found of it.
        trials: how many builds there were.
    """

    thickness: float | None
    called: Minimum
    measure: MeasureSummary
    found: Sample
    trials: int

    @property
    def minimum(self) -> float:
        """The number that is called so [mm]; the smallest of the trials is the deepest jam where any is jammed."""
        minimum = (self.found.value(self.called) or 0.0) / UM
        if self.failed <= UNMEASURED[self.called] * self.trials:
            return minimum
        deepest = self.found.deepest_overlap
        return min(minimum, deepest / UM if self.called == "sample_min" and deepest is not None else BELOW_NOTHING)

    @property
    def failed(self) -> int:
        """Trials without a backlash to measure; its statistics are those of the others."""
        return self.trials - self.found.count

    @property
    def resolution(self) -> float:
        """How well the minimum can be met [mm]: a quantile is known to a bin of the study's histogram."""
        bin_width = self.found.quantile_error / UM if self.called == "p0.135" else 0.0
        return max(MINIMUM_XTOL, bin_width)

    @property
    def sampling_error(self) -> float | None:
        """Standard error of mean - 3 sigma [mm], as of independent mean and sigma; None for another minimum."""
        mean, sigma = self.found.mean_se, self.found.sigma_se
        if self.called != "low_3sigma" or mean is None or sigma is None:
            return None
        return math.hypot(mean, 3 * sigma) / UM
