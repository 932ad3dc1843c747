"""Statistics of a measure's trials by either method, in the measure's unit."""

from collections.abc import Mapping
from typing import Literal

from pydantic import Field

from tol3d.runs.summary.values import (
    LEFT_OUT,
    Count,
    Known,
    KnownNumbers,
    KnownRange,
    Label,
    Maybe,
    Method,
    NotNegative,
    Number,
    Numbers,
    Ppm,
    PpmRange,
    Section,
)
from tol3d.strict import refused

PpkBy = Literal["quantiles", "share out of limits", "mean and sigma"]


class Methods(Section):
    """A value of both methods for one build; of a curve at each position; null if it cannot be assembled."""

    analytic: Known | KnownNumbers
    geometric: Known | KnownNumbers


class LimitShares(Section):
    """Shares of all trials that are out of limits or failed [ppm]."""

    trials: Count
    below_limit_ppm: Ppm | None
    above_limit_ppm: Ppm | None
    failed_ppm: Ppm | None
    out_ppm: Ppm | None = Field(description="failed or out of limits, of all trials")
    out_ppm_95: PpmRange | None = Field(description="bounds of the true share, 95 % confidence")


class Sample(LimitShares):
    """One method's sample of a measure, in its unit."""

    count: Count = Field(description="trials with a value")
    mean: Known
    sigma: NotNegative | None
    low_3sigma: Known
    high_3sigma: Known
    sample_min: Known
    sample_max: Known
    p0_135: Known = Field(validation_alias="p0.135", description="0.135 % quantile")
    p50: Known
    p99_865: Known = Field(validation_alias="p99.865")
    p0_135_95: Maybe[KnownRange] = Field(
        default=LEFT_OUT, validation_alias="p0.135_95", description="bounds of the true quantile, 95 % confidence"
    )
    p99_865_95: Maybe[KnownRange] = Field(default=LEFT_OUT, validation_alias="p99.865_95")
    quantile_error: NotNegative = Field(
        description="width of a bin of the grid that quantiles are read from, not their sampling error"
    )
    outside_grid: Count
    below_limit_ppm_95: PpmRange | None = Field(description="bounds of the true share, 95 % confidence")
    above_limit_ppm_95: PpmRange | None
    deepest_overlap: Known
    mean_se: Known = Field(description="standard error of the mean")
    sigma_se: Known
    mean_95: Maybe[KnownRange] = Field(default=LEFT_OUT, description="bounds of the true mean, 95 %, by Student's t")
    sigma_95: Maybe[KnownRange] = LEFT_OUT
    error_by: Literal["sample", "replicates"]
    skewness: Known
    kurtosis: Known = Field(description="excess kurtosis")
    pp: Known
    ppk: Known
    ppk_95: Maybe[KnownRange] = Field(default=LEFT_OUT, description="bounds of the true Ppk, 95 % confidence")
    ppk_by: PpkBy
    ppk_reason: Maybe[Label] = Field(default=LEFT_OUT, description="why by that; mean and sigma need no reason")
    pooled: Maybe[Mapping[Label, Known]] = Field(
        default=LEFT_OUT, description="statistics that the measure names besides, in its unit"
    )


class Normal(Section):
    """The closed form of a measure: mean and sigma of the stack-up."""

    mean: Number
    sigma: NotNegative
    low_3sigma: Number
    high_3sigma: Number


class Histogram(Section):
    """Counts of both methods over the same bars; empty where no trial has a value."""

    lower_edge: Maybe[Number] = LEFT_OUT
    bin_width: Maybe[NotNegative] = LEFT_OUT
    counts: Maybe[Mapping[Method, list[Count]]] = LEFT_OUT


class SpectrumSample(Section):
    """One method's amplitudes of harmonics, half of peak to peak, pooled over the trials: a list each, as `order`."""

    order: Numbers = Field(description="cycles per turn of the shaft whose positions the curve is over")
    mean: KnownNumbers = Field(description="of the trials' amplitudes, not the amplitude of the mean curve")
    sigma: KnownNumbers
    p0_135: KnownNumbers = Field(validation_alias="p0.135", description="0.135 % quantile")
    p50: KnownNumbers
    p99_865: KnownNumbers = Field(validation_alias="p99.865")
    max: KnownNumbers

    def refuse_uneven(self) -> None:
        """Refuse lists that are not as long as `order`.

        Raises:
            PydanticCustomError: one of them is not.
        """
        lists = (self.mean, self.sigma, self.p0_135, self.p50, self.p99_865, self.max)
        if any(len(values) != len(self.order) for values in lists):
            raise refused("curve.spectrum", f"{len(self.order)} values each, as orders", "another number")


class CurveSample(LimitShares):
    """One method's curves: statistics at each position, and shares of the trials with any position out of limits."""

    mean: KnownNumbers
    sigma: KnownNumbers
    min: KnownNumbers
    max: KnownNumbers
    ppk: Maybe[Known] = Field(default=LEFT_OUT, description="of the lowest and the highest value of each trial")
    ppk_95: Maybe[KnownRange] = LEFT_OUT
    ppk_by: Maybe[PpkBy] = LEFT_OUT
    ppk_reason: Maybe[Label] = LEFT_OUT
    spectrum: Maybe[SpectrumSample] = LEFT_OUT


class CurveMethods(Section):
    """The curves of both methods."""

    analytic: CurveSample
    geometric: Maybe[CurveSample] = LEFT_OUT

    @property
    def by_method(self) -> Mapping[Method, CurveSample]:
        """The curves of each method that there is."""
        return {"analytic": self.analytic, **({"geometric": self.geometric} if self.geometric else {})}
