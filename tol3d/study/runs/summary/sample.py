"""Statistics of a measure's trials by either method, in the measure's unit."""

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field

from tol3d.strict import refused
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.runs.summary.values import (
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

PpkBy = Literal["quantiles", "share out of limits", "mean and sigma"]


class Methods(Section):
    """A value of both methods for one build; of a curve at each position; null if it cannot be assembled."""

    analytic: Known | KnownNumbers
    geometric: Known | KnownNumbers


class LimitShares(Section):
    """Shares of all trials that are out of limits or failed [ppm]."""

    trials: Annotated[Count, Shows("trials", "number", given=True)]
    below_limit_ppm: Annotated[Ppm | None, Shows("below the lower limit", "share", given=True)]
    above_limit_ppm: Annotated[Ppm | None, Shows("above the upper limit", "share", given=True)]
    failed_ppm: Annotated[Ppm | None, Shows("failed", "share", given=True)]
    out_ppm: Annotated[Ppm | None, Shows("out in all", "share", given=True)] = Field(
        description="failed or out of limits, of all trials"
    )
    out_ppm_95: Annotated[PpmRange | None, Shows("out in all, 95 %", "share range", given=True)] = Field(
        description="bounds of the true share, 95 % confidence"
    )


class Sample(LimitShares):
    """One method's sample of a measure, in its unit.

    Fields with columns are the rows of its table, from above; those that are `given` have one where others gave them.
    """

    count: Annotated[Count, Shows("trials with a value", "number", given=True)] = Field(
        description="trials with a value"
    )
    low_3sigma: Annotated[Known, Shows("low (−3 sigma)")]
    mean: Annotated[Known, Shows("mean")]
    high_3sigma: Annotated[Known, Shows("high (+3 sigma)")]
    sigma: Annotated[NotNegative | None, Shows("sigma", "spread")]
    p0_135: Annotated[Known, Shows("0.135 % quantile")] = Field(
        validation_alias="p0.135", description="0.135 % quantile"
    )
    p50: Annotated[Known, Shows("50 % quantile")]
    p99_865: Annotated[Known, Shows("99.865 % quantile")] = Field(validation_alias="p99.865")
    sample_min: Annotated[Known, Shows("smallest")]
    sample_max: Annotated[Known, Shows("largest")]
    pp: Annotated[Known, Shows("Pp", ".3f", seldom=True)]
    ppk: Annotated[Known, Shows("Ppk", ".3f", seldom=True)]
    mean_se: Annotated[Known, Shows("standard error of the mean", "spread", given=True)] = Field(
        description="standard error of the mean"
    )
    sigma_se: Annotated[Known, Shows("standard error of sigma", "spread", given=True)]
    quantile_error: Annotated[NotNegative, Shows("grid of the quantiles", "spread", given=True)] = Field(
        description="width of a bin of the grid that quantiles are read from, not their sampling error"
    )
    deepest_overlap: Annotated[Known, Shows("deepest overlap", given=True)]
    skewness: Annotated[Known, Shows("skewness", "number", given=True)]
    kurtosis: Annotated[Known, Shows("excess kurtosis", "number", given=True)] = Field(description="excess kurtosis")
    outside_grid: Annotated[Count, Shows("trials outside the grid of quantiles", "number", given=True)]
    below_limit_ppm_95: Annotated[PpmRange | None, Shows("below the lower limit, 95 %", "share range", given=True)] = (
        Field(description="bounds of the true share, 95 % confidence")
    )
    above_limit_ppm_95: Annotated[PpmRange | None, Shows("above the upper limit, 95 %", "share range", given=True)]
    mean_95: Annotated[Maybe[KnownRange], Shows("mean, 95 %", "value range", given=True)] = Field(
        default=LEFT_OUT, description="bounds of the true mean, 95 %, by Student's t"
    )
    sigma_95: Annotated[Maybe[KnownRange], Shows("sigma, 95 %", "spread range", given=True)] = LEFT_OUT
    p0_135_95: Annotated[Maybe[KnownRange], Shows("0.135 % quantile, 95 %", "value range", given=True)] = Field(
        default=LEFT_OUT, validation_alias="p0.135_95", description="bounds of the true quantile, 95 % confidence"
    )
    p99_865_95: Annotated[Maybe[KnownRange], Shows("99.865 % quantile, 95 %", "value range", given=True)] = Field(
        default=LEFT_OUT, validation_alias="p99.865_95"
    )
    error_by: Literal["sample", "replicates"]
    ppk_95: Annotated[Maybe[KnownRange], Shows("Ppk, 95 %", "number range", given=True)] = Field(
        default=LEFT_OUT, description="bounds of the true Ppk, 95 % confidence"
    )
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
