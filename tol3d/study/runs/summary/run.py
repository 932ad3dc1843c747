"""The whole of summary.json: the findings of a run of a scene.

Joint results of the measures of a run: the share of trials within all limits, and correlations of measures.
"""

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.strict import refused
from tol3d.study.runs.summary.agreement import WitnessSummary
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.values import (
    LEFT_OUT,
    MOST_ENTRIES,
    MOST_SEED,
    Count,
    Known,
    Label,
    Maybe,
    Method,
    NotNegative,
    Positive,
    Ppm,
    PpmRange,
    Section,
    Sentence,
    Sha256,
)
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.outcome import SEATED, Meaning

MOST_CORRELATED = 1000  # measures; a matrix of a million numbers

Names = Annotated[list[Label], Field(max_length=MOST_CORRELATED)]
R = Annotated[float, Field(ge=-1.0, le=1.0)]
Row = Annotated[list[R | None], Field(max_length=MOST_CORRELATED)]
Matrix = Annotated[list[Row], Field(max_length=MOST_CORRELATED)]
CountRow = Annotated[list[Count], Field(max_length=MOST_CORRELATED)]
CountMatrix = Annotated[list[CountRow], Field(max_length=MOST_CORRELATED)]


class JointYield(Section):
    """One method's trials in which every measure that has a limit is valid and within its limits."""

    trials: Count = Field(description="all of them, failed ones too")
    within: Count
    yield_ppm: Ppm | None = Field(description="share of all trials")
    yield_ppm_95: PpmRange | None = Field(
        description="bounds of the true share, 95 % confidence; null for fewer than two replicates"
    )

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if self.within > self.trials:
            raise refused("within", f"at most the {self.trials} trials", self.within)
        return self


class Correlations(Section):
    """One method's correlations, each over the trials that have both values; rows and columns as `correlated`."""

    r: Matrix = Field(description="Pearson's; null where a measure does not vary or fewer than two trials have both")
    r_low_95: Matrix | None = Field(description="bounds of the true correlation, 95 % confidence, by Fisher's artanh r")
    r_high_95: Matrix | None = Field(description="null where trials are not independent")
    trials: CountMatrix = Field(description="number with both values; on the diagonal, with one")


class Joint(Section):
    """Joint results of measures."""

    limited: Annotated[list[Label], Field(max_length=MOST_ENTRIES)] = Field(description="measures that have a limit")
    yields: Maybe[Mapping[Method, JointYield]] = LEFT_OUT
    correlated: Names = Field(description="the measures of the matrices, in the order of their rows and columns")
    correlated_of: Maybe[Count] = Field(
        default=LEFT_OUT, description="number of measures with correlations in correlations.csv, if that is more"
    )
    correlations: Maybe[Mapping[Method, Correlations]] = LEFT_OUT

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if bool(self.limited) != bool(self.yields):
            raise refused("yields", "a yield where measures have limits, else none", "otherwise")
        if bool(self.correlated) != bool(self.correlations):
            raise refused("correlations", "matrices where measures are correlated, else none", "otherwise")
        size = len(self.correlated)
        for method, own in (self.correlations or {}).items():
            for key in ("r", "r_low_95", "r_high_95", "trials"):
                matrix = own[key]
                if matrix is not None and [len(row) for row in matrix] != [size] * size:
                    raise refused(f"correlations.{method}.{key}", f"{size} rows of {size}, as correlated", "others")
        return self


class MechanismSummary(Section):
    """The mechanism that made a run: without it the run cannot be opened."""

    name: Label
    module: Label = Field(description="the Python module of its system")
    beside: Maybe[Annotated[list[Label], Field(min_length=1, max_length=MOST_ENTRIES)]] = Field(
        default=LEFT_OUT, description="names of other mechanisms that added to it"
    )


class StudySummary(Section):
    """The study that was run: the scene's, with its overrides."""

    trials: Positive
    seed: int = Field(ge=0, le=MOST_SEED)
    sampler: Literal["monte_carlo", "sobol", "latin_hypercube"]
    replicates: int = Field(ge=1, le=1000)
    until: list[Annotated[list[Label | Known], Field(min_length=3, max_length=3)]] = Field(
        description="measure, and standard errors of mean and sigma [mm or rad] at which automatic trials stop"
    )
    engine: Label
    witness: int = Field(ge=0, le=1_000_000)
    ppk_by: Maybe[Literal["quantiles", "sigma"]] = Field(default=LEFT_OUT, description="requested basis of Ppk")
    accept_ppk: Maybe[Annotated[float, Field(gt=0.0, le=10.0)]] = Field(
        default=LEFT_OUT, description="Ppk that is asked of measures"
    )


class Blocks(Section):
    """Division of trials into files, and whether those are kept."""

    trials: int = Field(ge=1, le=2**20)
    kept: bool


class Timing(Section):
    """Duration, and number of workers."""

    setup_s: NotNegative
    simulate_s: NotNegative
    first_block_s: NotNegative
    findings_s: Maybe[NotNegative] = Field(default=LEFT_OUT, description="statistics after the trials")
    pictures_s: Maybe[NotNegative] = Field(default=LEFT_OUT, description="pictures, where they are drawn")
    trials_per_s: NotNegative
    resumed_trials: Count
    workers: Count
    peak_memory_mb: NotNegative | None


class Findings(Section):
    """Findings of a study, whoever ran it."""

    scene: Label
    mechanism: Maybe[MechanismSummary] = LEFT_OUT
    seed: int = Field(ge=0, le=MOST_SEED)
    trials: Positive
    engine: Label
    study: StudySummary
    status: Mapping[Label, Count] = Field(description="number of trials by status")
    statuses: Mapping[Label, Meaning] = Field(
        description="of each status: values count; less than nothing of what is measured; nothing is known but that"
    )
    status_words: Maybe[Mapping[Label, Label]] = Field(
        default=LEFT_OUT, description="adjective of trials of a status, if its own text is none"
    )
    chord_error_um: NotNegative | None
    measures: Annotated[Mapping[Label, MeasureSummary], Field(min_length=1, max_length=MOST_ENTRIES)]
    joint: Maybe[Joint] = LEFT_OUT
    published: Maybe[Mapping[Label, Section]] = Field(
        default=LEFT_OUT, description="published figures beside measures, by column and by the keys of this file"
    )
    warnings: list[Sentence]
    witness: Maybe[WitnessSummary] = LEFT_OUT


class RunSummary(Findings):
    """summary.json: the findings of a run of a scene. Lengths um, of a tip mm; angles arcmin; shares ppm or %."""

    presenters: ClassVar[Mapping[str, str]] = {}
    """Import path of the presenter of each mechanism's systems."""

    blocks: Blocks
    files: Mapping[Label, Sha256] = Field(description="SHA-256 of the scene and of every file that it names")
    timing: Timing
    versions: Mapping[Label, Sentence] = Field(description="of packages that decide a result's last bit")

    @property
    def methods(self) -> tuple[Method, ...]:
        """The methods that measured it."""
        return ("analytic",) if self.engine == ANALYTIC_METHOD else ("analytic", "geometric")

    @property
    def lacking(self) -> frozenset[str]:
        """Statuses of trials that lack what is measured, such as parts that overlap."""
        return frozenset(text for text, meaning in self.statuses.items() if meaning == "lacking")

    def state(self, status: str) -> str:
        """State of trials with a status, in words: `assembled`, or the system's words for another status."""
        return "assembled" if status == SEATED else (self.status_words or {}).get(status, status)

    @property
    def best_method(self) -> Method:
        """The method by which it is shown."""
        return self.methods[-1]

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        study = self.study
        for name, here, there in (("seed", self.seed, study.seed), ("engine", self.engine, study.engine)):
            if here != there:
                raise refused(f"study.{name}", f"{here}, as it says for the run", there)
        if self.trials > study.trials or (self.trials != study.trials and not study.until):
            raise refused("study.trials", f"{self.trials}, as it says for the run", study.trials)
        if sum(self.status.values()) != self.trials:
            raise refused("status", f"{self.trials} trials in all", sum(self.status.values()))
        if "scene.yaml" not in self.files:
            raise refused("files", "scene.yaml among them", "none of that name")
        simulated = self.engine != ANALYTIC_METHOD
        for name, measure in self.measures.items():
            method = measure.curve.geometric if measure.curve and measure.take == "curve" else measure.geometric
            if (method is not None) != simulated:
                raise refused(f"measures.{name}", f"geometric as the engine is {self.engine}", "otherwise")
        if self.joint:
            self._refuse_another_joint(self.joint)
        return self

    def _refuse_another_joint(self, joint: Joint) -> None:
        for key, names in (("limited", joint.limited), ("correlated", joint.correlated)):
            if unknown := sorted(set(names) - set(self.measures)):
                raise refused(f"joint.{key}", "names of measures", unknown[0])
        for key, by_method in (("yields", joint.yields), ("correlations", joint.correlations)):
            if by_method is not None and set(by_method) != set(self.methods):
                raise refused(f"joint.{key}", f"those of {' and '.join(self.methods)}", ", ".join(by_method) or "none")
