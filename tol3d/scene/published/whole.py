"""Published figures beside those of single measures: yields, correlations, numbers of trials, durations."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any, Self

from pydantic import Field, model_validator

from tol3d.scene.name import Name, Remark
from tol3d.scene.nearest import hint
from tol3d.scene.place import KeyPath
from tol3d.scene.published.figures import (
    Correlation,
    Count,
    NotNegative,
    Ppm,
    PpmRange,
    PublishedCorrelation,
)
from tol3d.strict import Strict, refused

Problem = tuple[KeyPath, str]


class PublishedFigures(Strict):
    """Keys of a published column beside the measures: sections of summary.json by the same keys, without methods.

    A mechanism declares a subclass with its sections: fields of plain numbers, of quantities (in summary.json lengths
    are in um, angles in arcmin), of `Strict` classes, and of mappings and lists of these; none is required.
    """

    def problems(self, scene: Any) -> Iterator[Problem]:
        """Conflicts with the rest of the scene, such as unknown names: place within the column, and message."""
        return iter(())

    @staticmethod
    def strangers(section: str, names: Iterable[str], known: Collection[str], expected: str) -> Iterator[Problem]:
        """Problems of names in a section that the scene does not have.

        Args:
            section: its key.
            names: those in it.
            known: those of the scene.
            expected: what a name should be, for the message.
        """
        for name in names:
            if name not in known:
                yield (section, name), f"expected {expected}, got {name!r}{hint(name, known)}"


class PublishedYield(Strict):
    """Fraction of trials within all limits."""

    trials: Count | None = Field(default=None, description="number of trials, failed ones included")
    within: Count | None = Field(default=None, description="number of trials within all limits")
    yield_ppm: Ppm | None = Field(default=None, description="fraction of all trials within all limits [ppm]")
    yield_ppm_95: PpmRange | None = Field(default=None, description="95 % confidence interval of that fraction [ppm]")

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if self.trials is not None and self.within is not None and self.within > self.trials:
            raise refused("within", f"at most the {self.trials} trials", self.within)
        return self


class PublishedJoint(Strict):
    """Joint results of measures."""

    yields: PublishedYield | None = Field(default=None, description="trials within all limits")
    correlations: Mapping[Name, Mapping[Name, Correlation]] = Field(
        default_factory=dict, description="Pearson's r by both measures, each pair once"
    )
    description: Remark = Field(default="", description="remark on these numbers")

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        for first, others in self.correlations.items():
            for second, correlation in others.items():
                place = f"correlations.{first}.{second}"
                if first == second:
                    raise refused(f"correlations.{first}", "another measure", repr(str(second)))
                if first in self.correlations.get(second, {}):
                    raise refused(place, "each pair once", "it both ways")
                if isinstance(correlation, PublishedCorrelation):
                    bounds = correlation.r_low_95, correlation.r, correlation.r_high_95
                    values = [value for value in bounds if value is not None]
                    if values != sorted(values):
                        raise refused(place, "r_low_95, r and r_high_95 in rising order", str(values))
        return self


class PublishedStudy(Strict):
    """Settings of the published study."""

    trials: Count | None = Field(default=None, description="number of trials")
    seed: Count | None = Field(default=None, description="seed of the draws")
    replicates: Count | None = Field(default=None, description="number of replicates")
    witness: Count | None = Field(default=None, description="number of trials measured again by another engine")


class PublishedTiming(Strict):
    """Published durations."""

    setup_s: NotNegative | None = Field(default=None, description="time to set up [s]")
    simulate_s: NotNegative | None = Field(default=None, description="time of the trials [s]")
    first_block_s: NotNegative | None = Field(default=None, description="time of the first block [s]")
    trials_per_s: NotNegative | None = Field(default=None, description="trials per second")
    resumed_trials: Count | None = Field(default=None, description="number of trials from a resumed run")
    workers: Count | None = Field(default=None, description="number of processes")
    peak_memory_mb: NotNegative | None = Field(default=None, description="peak memory [MB]")


class PublishedWhole(PublishedFigures):
    """Published figures that runs of every mechanism have."""

    seed: Count | None = Field(default=None, description="seed of the draws")
    trials: Count | None = Field(default=None, description="number of trials")
    chord_error_um: NotNegative | None = Field(default=None, description="error of facets at curved faces [um]")
    status: Mapping[Name, Count] = Field(default_factory=dict, description="number of trials by status")
    joint: PublishedJoint | None = Field(default=None, description="joint results of measures")
    study: PublishedStudy | None = Field(default=None, description="settings of the study")
    timing: PublishedTiming | None = Field(default=None, description="durations")

    def problems(self, scene: Any) -> Iterator[Problem]:
        """Correlations of unknown measures, and of measures that take a curve."""
        correlations = self.joint.correlations if self.joint else {}
        for first, others in correlations.items():
            path: KeyPath = ("joint", "correlations", first)
            for place, name in [(path, first), *(((*path, second), second) for second in others)]:
                if (measure := scene.measures.get(name)) is None:
                    yield place, f"expected the name of a measure, got {name!r}{hint(name, scene.measures)}"
                elif measure.gives_curve:
                    yield place, f"expected a measure of one value a trial, got {name!r}, which takes a curve"
