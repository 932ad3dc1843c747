"""What a study found of a scene with shims of one thickness, and which number of it is called the minimum."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal

from tol3d.distributions.base import LOW_PROBABILITY

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
        found: the measure, as summary.json shows it [um, arcmin].
        trials: how many builds there were.
    """

    thickness: float | None
    called: Minimum
    found: Mapping[str, Any]
    trials: int

    @property
    def minimum(self) -> float:
        """The number that is called so [mm]; the smallest of the trials is the deepest jam where any is jammed."""
        minimum = float(self.found["geometric"][self.called]) / UM
        if self.failed <= UNMEASURED[self.called] * self.trials:
            return minimum
        deepest = self.found["geometric"]["deepest_overlap"]
        return min(minimum, deepest / UM if self.called == "sample_min" and deepest is not None else BELOW_NOTHING)

    @property
    def failed(self) -> int:
        """Trials without a backlash to measure; its statistics are those of the others."""
        return self.trials - int(self.found["geometric"]["count"])

    @property
    def resolution(self) -> float:
        """How well the minimum can be met [mm]: a quantile is known to a bin of the study's histogram."""
        bin_width = self.found["geometric"]["quantile_error"] / UM if self.called == "p0.135" else 0.0
        return max(MINIMUM_XTOL, float(bin_width))

    @property
    def sampling_error(self) -> float | None:
        """Standard error of mean - 3 sigma [mm], as of independent mean and sigma; None for another minimum."""
        errors = [self.found["geometric"].get(key) for key in ("mean_se", "sigma_se")]
        if self.called != "low_3sigma" or None in errors:
            return None
        return math.hypot(errors[0], 3 * errors[1]) / UM
