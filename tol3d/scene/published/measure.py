"""What somebody else found for a measure: any number that a run's summary has of one."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Final, Self

from pydantic import Field, model_validator

from tol3d.scene.name import Name, Remark
from tol3d.scene.published.curve import PublishedAgreement, PublishedCurve, PublishedHistogram, refuse_uneven
from tol3d.scene.published.figures import Count, Figure, Figures, Ppm, PpmRange, PublishedShare, Range, Share
from tol3d.strict import Strict, refused
from tol3d.units import Quantity

ORDERED: Final = (("low_3sigma", "mean", "high_3sigma"), ("sample_min", "p0.135", "p50", "p99.865", "sample_max"))
"""Keys of which each is at least the one before."""
POSITIVE: Final = ("sigma", "mean_se", "sigma_se")


class PublishedMeasure(Strict):
    """What somebody else found for a measure, in its dimension; contributors in percent of the variance."""

    low_3sigma: Quantity | None = Field(default=None, description="mean - 3 sigma, or the lower end at 99.7 %")
    mean: Quantity | None = None
    high_3sigma: Quantity | None = Field(default=None, description="mean + 3 sigma, or the upper end at 99.7 %")
    sigma: Quantity | None = Field(default=None, description="standard deviation")
    sample_min: Quantity | None = Field(default=None, description="smallest of the trials")
    sample_max: Quantity | None = Field(default=None, description="largest of the trials")
    p0_135: Quantity | None = Field(default=None, alias="p0.135", description="0.135 % quantile")
    p50: Quantity | None = Field(default=None, description="median")
    p99_865: Quantity | None = Field(default=None, alias="p99.865", description="99.865 % quantile")
    mean_se: Quantity | None = Field(default=None, description="standard error of the mean")
    sigma_se: Quantity | None = Field(default=None, description="standard error of sigma")
    mean_95: Range | None = Field(default=None, description="bounds of the true mean, 95 % confidence")
    sigma_95: Range | None = None
    contributors: Mapping[Name, Share] = Field(
        default_factory=dict, description="share of each tolerance [% of the variance]"
    )
    description: Remark = Field(default="", description="what must be known of these numbers, shown below the table")
    skewness: Figure | None = None
    kurtosis: Figure | None = Field(default=None, description="excess kurtosis")
    pp: Figure | None = Field(default=None, description="Pp")
    ppk: Figure | None = Field(default=None, description="Ppk")
    below_limit_ppm: Ppm | None = Field(default=None, description="share below the lower limit [ppm]")
    above_limit_ppm: Ppm | None = Field(default=None, description="share above the upper limit [ppm]")
    failed_ppm: Ppm | None = Field(default=None, description="share that could not be assembled [ppm]")
    out_ppm: Ppm | None = Field(default=None, description="share that failed or is out of limits [ppm]")

    count: Count | None = Field(default=None, description="trials with a value")
    trials: Count | None = Field(default=None, description="all of them, failed ones too")
    status: Mapping[Name, Count] = Field(default_factory=dict, description="how many trials ended how")
    nominal: Quantity | None = Field(default=None, description="of the build without deviations")
    mean_build: Quantity | None = Field(default=None, description="of the build with all deviations at their means")
    below_limit_ppm_95: PpmRange | None = Field(default=None, description="bounds of the true share, 95 % confidence")
    above_limit_ppm_95: PpmRange | None = None
    out_ppm_95: PpmRange | None = None
    quantile_error: Quantity | None = Field(default=None, description="how finely quantiles were read")
    outside_grid: Count | None = None
    deepest_overlap: Quantity | None = None
    pooled: Mapping[Name, Quantity] = Field(
        default_factory=dict, description="statistics that the measure names besides"
    )
    histogram: PublishedHistogram | None = None
    agreement: PublishedAgreement | None = None
    position_deg: Figures | None = Field(default=None, description="where the curve was read [deg]")
    curve: PublishedCurve | None = None

    @property
    def internal(self) -> dict[str, float]:
        """The dimensioned numbers of its sample by their keys [mm or rad]."""
        return {key: quantity.internal for key, quantity in self.quantities().items()}

    def quantities(self) -> dict[str, Quantity]:
        """The dimensioned numbers of its sample, by their keys."""
        given = ((field.alias or name, getattr(self, name)) for name, field in type(self).model_fields.items())
        return {key: value for key, value in given if isinstance(value, Quantity)}

    @property
    def percents(self) -> dict[str, float]:
        """Shares of the variance [%], by contributor."""
        shares = {
            str(name): own.percent if isinstance(own, PublishedShare) else own
            for name, own in self.contributors.items()
        }
        return {name: share for name, share in shares.items() if share is not None}

    @model_validator(mode="after")
    def _refuse_disorder(self) -> Self:
        given = self.quantities()
        for key in POSITIVE:
            if key in given and not given[key].internal > 0.0:
                raise refused(key, "more than 0", given[key])
        for keys in ORDERED:
            known = [(key, given[key]) for key in keys if key in given]
            for (low, below), (high, above) in pairwise(known):
                if below.dimension == above.dimension and not below.internal <= above.internal:
                    raise refused(low, f"at most {high} ({above})", below)
        return self

    @model_validator(mode="after")
    def _refuse_uneven_curves(self) -> Self:
        if self.curve and self.curve.is_listed:
            if self.position_deg is None:
                raise refused("position_deg", "the positions of the curve, such as [0, 90, 180, 270]", "none")
            refuse_uneven(self.curve, "position_deg", len(self.position_deg), "curve.")
        return self
