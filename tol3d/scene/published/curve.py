"""Published curves, spectra and histograms, and how far two roads of others differ."""

from typing import Self

from pydantic import Field, model_validator

from tol3d.scene.published.figures import Count, Counts, Figure, Figures, Ppm, PpmRange, Quantities
from tol3d.strict import Strict, refused
from tol3d.units import Quantity


def refuse_uneven(figures: Strict, of: str, count: int, place: str = "") -> None:
    """Refuse lists that are not of some length.

    Args:
        figures: whose lists.
        of: the key that has as many values.
        count: how many.
        place: dotted name of the figures below what is validated, with a dot at its end.

    Raises:
        PydanticCustomError: one of them is not.
    """
    for name in type(figures).model_fields:
        values = getattr(figures, name)
        if isinstance(values, list) and not name.endswith("_95") and len(values) != count:
            raise refused(f"{place}{name}", f"{count} values, as {of}", len(values))


class PublishedSpectrum(Strict):
    """Amplitudes of harmonics, half of peak to peak: a list each, as `order`."""

    order: Figures = Field(description="cycles per turn")
    mean: Quantities | None = None
    sigma: Quantities | None = None
    p0_135: Quantities | None = Field(default=None, alias="p0.135", description="0.135 % quantiles")
    p50: Quantities | None = None
    p99_865: Quantities | None = Field(default=None, alias="p99.865")
    max: Quantities | None = None

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        refuse_uneven(self, "order", len(self.order))
        return self


class PublishedCurve(Strict):
    """A curve: a list of each statistic, as the measure's `position_deg`."""

    mean: Quantities | None = None
    sigma: Quantities | None = None
    min: Quantities | None = None
    max: Quantities | None = None
    trials: Count | None = None
    below_limit_ppm: Ppm | None = Field(default=None, description="share below the lower limit at any position [ppm]")
    above_limit_ppm: Ppm | None = None
    failed_ppm: Ppm | None = None
    out_ppm: Ppm | None = None
    out_ppm_95: PpmRange | None = Field(default=None, description="bounds of the true share, 95 % confidence [ppm]")
    ppk: Figure | None = Field(default=None, description="Ppk")
    spectrum: PublishedSpectrum | None = None

    @property
    def is_listed(self) -> bool:
        """Whether it has a statistic at positions."""
        return any(isinstance(getattr(self, name), list) for name in ("mean", "sigma", "min", "max"))


class PublishedHistogram(Strict):
    """Counts over bars of one width."""

    lower_edge: Quantity
    bin_width: Quantity
    counts: Counts

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if not self.bin_width.number > 0.0:
            raise refused("bin_width", "more than 0", self.bin_width)
        return self


class PublishedAgreement(Strict):
    """How far two roads of others differ, trial by trial: simulation less theory."""

    max_abs_difference: Quantity | None = None
    rms_difference: Quantity | None = None
    mean_difference: Quantity | None = None
    compared: Count | None = Field(default=None, description="trials that both have a value of")
