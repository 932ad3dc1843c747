"""What somebody else found for a measure: any number that a run's summary has of a sample."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Final, Self

from pydantic import Field, model_validator

from tol3d.scene.name import Name, Remark
from tol3d.strict import Strict, refused
from tol3d.units import Quantity

Percent = Annotated[float, Field(ge=0.0, le=100.0)]
Ppm = Annotated[float, Field(ge=0.0, le=1e6)]

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
    skewness: float | None = None
    kurtosis: float | None = Field(default=None, description="excess kurtosis")
    pp: float | None = Field(default=None, description="Pp")
    ppk: float | None = Field(default=None, description="Ppk")
    below_limit_ppm: Ppm | None = Field(default=None, description="share below the lower limit [ppm]")
    above_limit_ppm: Ppm | None = Field(default=None, description="share above the upper limit [ppm]")
    failed_ppm: Ppm | None = Field(default=None, description="share that could not be assembled [ppm]")
    out_ppm: Ppm | None = Field(default=None, description="share that failed or is out of limits [ppm]")
    contributors: Mapping[Name, Percent] = Field(
        default_factory=dict, description="share of each tolerance [% of the variance]"
    )
    description: Remark = Field(default="", description="what must be known of these numbers, shown below the table")

    def quantities(self) -> dict[str, Quantity]:
        """Every dimensioned number that was given, by its key."""
        return {key: value for key, value in self._given() if isinstance(value, Quantity)}

    def numbers(self) -> dict[str, float]:
        """Every number without a dimension that was given, by its key."""
        return {key: float(value) for key, value in self._given() if isinstance(value, float | int)}

    def _given(self) -> list[tuple[str, object]]:
        return [(field.alias or name, getattr(self, name)) for name, field in type(self).model_fields.items()]

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
