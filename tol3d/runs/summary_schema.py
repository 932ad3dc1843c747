"""What summary.json holds, key by key: the one place that says so. `tol3d schema --summary` prints it as JSON Schema.

A run's summary is held against it when it is written, so a key that is not here is a warning that fails the tests, and
when it is read, for a stranger may have made the file: numbers are finite and bounded, names and sentences hold no
control characters. A NEW KEY of summary.json is one line in the class of its place here; a key that is not in every
summary gets the default LEFT_OUT, and may then be missing, but not be null. What is made of the values elsewhere
(lengths of lists, a seed that stands twice) is compared in `refuse_contradictions`.
"""

import json
import unicodedata
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, ValidationError, model_validator

from tol3d.errors import RunError
from tol3d.strict import Strict, refused
from tol3d.units import shown

LARGEST = 1e15  # of any unit; keeps arithmetic and pictures finite, and a nanometre at 1e9 m is no reading
MOST_TRIALS = 10**10  # as in scenes
MOST_SEED = 2**63 - 1
MOST_ENTRIES = 100_000  # measures, contributors, positions of a curve, warnings ... of one kind
LONGEST_LABEL = 10_000  # characters; a link of parallel load paths names every mesh in it
LONGEST_SENTENCE = 100_000
UNSAFE = frozenset(("Cc", "Cf", "Cs", "Zl", "Zp"))  # Unicode categories that move a terminal's cursor or hide text
LEFT_OUT: Any = None  # default of a key that is not in every summary


def _plain(text: str) -> str:
    if any(unicodedata.category(sign) in UNSAFE for sign in text):
        raise refused("", "text without control or invisible characters", shown(text))
    return text


Label = Annotated[str, Field(min_length=1, max_length=LONGEST_LABEL), AfterValidator(_plain)]
Sentence = Annotated[str, Field(max_length=LONGEST_SENTENCE), AfterValidator(_plain)]
Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Known = Number | None  # null where a study cannot tell it, such as the sigma of one trial
NotNegative = Annotated[float, Field(ge=0.0, le=LARGEST)]
Count = Annotated[int, Field(ge=0, le=MOST_TRIALS)]
Positive = Annotated[int, Field(ge=1, le=MOST_TRIALS)]
Ppm = Annotated[float, Field(ge=0.0, le=1e6 * (1 + 1e-9))]
PpmRange = Annotated[list[Ppm], Field(min_length=2, max_length=2)]
Numbers = Annotated[list[Number], Field(max_length=MOST_ENTRIES)]
KnownNumbers = Annotated[list[Known], Field(max_length=MOST_ENTRIES)]
Engine = Literal["exact", "fcl", "analytic"]
Unit = Literal["um", "mm", "arcmin"]


class StudySummary(Strict):
    """The study that was run: the scene's, or what was said instead of it."""

    trials: Positive
    seed: int = Field(ge=0, le=MOST_SEED)
    sampler: Literal["monte_carlo", "sobol", "latin_hypercube"]
    replicates: int = Field(ge=1, le=1000)
    until: list[Annotated[list[Label | Known], Field(min_length=3, max_length=3)]] = Field(
        description="measure, and standard errors of mean and sigma [mm or rad] at which automatic trials stop"
    )
    engine: Engine
    witness: int = Field(ge=0, le=1_000_000)
    profile_steps: int = Field(ge=8, le=2000)


class Reading(Strict):
    """Where on the face, and at which teeth, contact and gap of a mesh are read."""

    contact: Literal["face", "section"]
    gap: Literal["face", "section"]
    teeth: Literal["all", "driver", "driven"]


class FreeTurn(Strict):
    """What a normal backlash leaves free."""

    of: Label = Field(description="the driven gear")
    arcmin_per_um: Number


class Roads(Strict):
    """A value of both roads of one build; of a curve at each position; null where it does not seat."""

    analytic: Known | KnownNumbers
    geometric: Known | KnownNumbers


class Sample(Strict):
    """One road's sample of a measure, in its unit."""

    count: Count = Field(description="trials with a value")
    trials: Count
    mean: Known
    sigma: NotNegative | None
    low_3sigma: Known
    high_3sigma: Known
    sample_min: Known
    sample_max: Known
    p0_135: Known = Field(alias="p0.135", description="0.135 % quantile")
    p50: Known
    p99_865: Known = Field(alias="p99.865")
    quantile_error: NotNegative = Field(description="width of a bin of the grid that quantiles are read from")
    outside_grid: Count
    below_limit_ppm: Ppm | None
    below_limit_ppm_95: PpmRange | None = Field(description="bounds of the true share, 95 % confidence")
    above_limit_ppm: Ppm | None
    above_limit_ppm_95: PpmRange | None
    failed_ppm: Ppm | None
    out_ppm: Ppm | None = Field(description="failed or out of limits, of all trials")
    out_ppm_95: PpmRange | None
    deepest_overlap: Known
    mean_se: Known = Field(description="standard error of the mean")
    sigma_se: Known
    error_by: Literal["sample", "replicates"]
    skewness: Known
    kurtosis: Known = Field(description="excess kurtosis")
    pp: Known
    ppk: Known
    ppk_by: Literal["share out of limits", "mean and sigma"]


class Normal(Strict):
    """The closed form of a measure: mean and sigma of the stack-up."""

    mean: Number
    sigma: NotNegative
    low_3sigma: Number
    high_3sigma: Number


class Histogram(Strict):
    """Counts of both roads over the same bars; empty where no trial has a value."""

    lower_edge: Number = LEFT_OUT
    bin_width: NotNegative = LEFT_OUT
    counts: Mapping[Literal["analytic", "geometric"], list[Count]] = LEFT_OUT


class LinearPart(Strict):
    """What a contributor adds to the difference of the roads."""

    contributor: Label
    percent: Number = Field(description="of its own effect")
    standard_errors: Number
    by: Sentence


class Explanation(Strict):
    """What explains the difference of the roads, in the measure's unit."""

    undecided: Sentence
    faults: list[Sentence]
    linear: list[LinearPart]
    largest_percent: Number
    neglected: Mapping[Label, Number]
    second_order_rms: Known
    second_order_mean: Known
    second_order_of: list[Label]
    left_rms: Known
    mean_left: Known
    mean_allowed: Known
    largest_trial: Count | None = Field(description="the trial with the largest difference")


class Agreement(Strict):
    """3D simulation - analytic, trial by trial, in the measure's unit."""

    max_abs_difference: Known
    rms_difference: Known
    mean_difference: Known
    compared: Count
    explanation: Explanation | None = LEFT_OUT


class ContributorShare(Strict):
    """Shares of the variance of a measure [%]."""

    name: Label
    analytic_percent: Known
    geometric_percent: Known
    geometric_percent_se: Known = Field(description="one standard error")
    high_low_mean_percent: Known


class CurveSample(Strict):
    """One road's curves: statistics at each position, and shares of the trials with any position out of limits."""

    mean: KnownNumbers
    sigma: KnownNumbers
    min: KnownNumbers
    max: KnownNumbers
    trials: Count
    below_limit_ppm: Ppm | None
    above_limit_ppm: Ppm | None
    failed_ppm: Ppm | None
    out_ppm: Ppm | None
    out_ppm_95: PpmRange | None


class CurveRoads(Strict):
    """The curves of both roads."""

    analytic: CurveSample
    geometric: CurveSample = LEFT_OUT


class PublishedColumn(Strict):
    """What somebody else found for a measure, in its unit."""

    low_3sigma: Number = LEFT_OUT
    mean: Number = LEFT_OUT
    high_3sigma: Number = LEFT_OUT
    sigma: Number = LEFT_OUT
    contributors: Mapping[Label, Number] = LEFT_OUT
    description: Sentence = LEFT_OUT


class MeasureSummary(Strict):
    """One measure; every value is in `unit`."""

    kind: Literal[
        "normal_backlash",
        "circumferential_backlash",
        "angular_backlash",
        "lost_motion",
        "tip_displacement",
        "tip_error",
    ]
    of: Label = Field(description="the mesh or the train")
    gear: Label | None
    reading: Reading | None
    readings: Mapping[Label, Reading] = Field(default=LEFT_OUT, description="of each mesh of a train")
    shaft: Label = LEFT_OUT
    held: Label = LEFT_OUT
    arm: Label | None = None
    point: Label | None = None
    lever_mm: Known = None
    load_changes_deg: Numbers = LEFT_OUT
    over: Literal["random", "at", "turn", "long_period", "swing"]
    take: Literal["value", "min", "max", "range", "curve"]
    unit: Unit
    lost_motion: FreeTurn = LEFT_OUT
    lower_limit: Known
    upper_limit: Known
    status: Mapping[Label, Count] = Field(description="how many trials ended how")
    nominal: Roads
    mean_build: Roads
    analytic: Sample = LEFT_OUT
    analytic_closed_form: Normal = LEFT_OUT
    histogram: Histogram = LEFT_OUT
    geometric: Sample = LEFT_OUT
    agreement: Agreement = LEFT_OUT
    position_deg: Numbers = LEFT_OUT
    curve: CurveRoads = LEFT_OUT
    contributors: list[ContributorShare]
    published: Mapping[Label, PublishedColumn]

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        of_train = self.kind in ("lost_motion", "tip_displacement", "tip_error")
        said = self.model_fields_set
        if of_train and not {"shaft", "held", "arm", "point", "lever_mm", "load_changes_deg"} <= said:
            raise refused("kind", "shaft, held, arm, point, lever_mm and load_changes_deg beside it", self.kind)
        if (self.kind.endswith("backlash")) != (self.reading is not None):
            raise refused("reading", "one of a backlash, null of a train's measure", self.kind)
        needed = {"curve", "position_deg"} if self.take == "curve" else {"analytic", "histogram"}
        if not needed <= said:
            raise refused("take", f"{' and '.join(sorted(needed))} beside it", self.take)
        if self.take == "curve":
            self._refuse_uneven_curves()
        elif self.histogram is not None:
            self._refuse_uneven_histogram(self.histogram)
        if (self.agreement is None) != (self.geometric is None):
            raise refused("agreement", "one where there is a 3D simulation", "one of the two")
        return self

    def _refuse_uneven_curves(self) -> None:
        count = len(self.position_deg)
        for road in (self.curve.analytic, self.curve.geometric):
            lists = (road.mean, road.sigma, road.min, road.max) if road is not None else ()
            if any(len(values) != count for values in lists):
                raise refused("curve", f"{count} values each, as positions", "another number")
        for build in (self.nominal, self.mean_build):
            for value in (build.analytic, build.geometric):
                if value is not None and not (isinstance(value, list) and len(value) == count):
                    raise refused("nominal", f"{count} values each, as positions, or null", "something else")

    def _refuse_uneven_histogram(self, histogram: Histogram) -> None:
        said = histogram.model_fields_set
        if said and len(said) < len(Histogram.model_fields):
            raise refused("histogram", "lower_edge, bin_width and counts", ", ".join(sorted(said)))
        if said and (len({len(counts) for counts in histogram.counts.values()}) != 1 or not histogram.bin_width > 0.0):
            raise refused("histogram", "as many bars of both roads, wider than 0", "something else")
        if said and not any(len(counts) for counts in histogram.counts.values()):
            raise refused("histogram.counts", "at least one bar", "none")
        for build in (self.nominal, self.mean_build):
            if isinstance(build.analytic, list) or isinstance(build.geometric, list):
                raise refused("nominal", "a number of each road, or null", "a list")


class Ends(Strict):
    """What a road, or somebody else, found of a train's stage or of their sum [arcmin]."""

    low_3sigma: Known = LEFT_OUT
    mean: Known = LEFT_OUT
    high_3sigma: Known = LEFT_OUT
    sigma: Known = LEFT_OUT
    sample_min: Known = LEFT_OUT
    sample_max: Known = LEFT_OUT
    share_percent: Known = LEFT_OUT


class StageRoads(Strict):
    """What both roads found of a stage."""

    analytic: Ends
    geometric: Ends = LEFT_OUT


class Stage(Strict):
    """A link of a train."""

    link: Label
    kind: Literal["mesh", "bevel_mesh", "reducer", "parallel"]
    driver: Label
    driven: Label
    gears: Annotated[list[Label], Field(min_length=2, max_length=2)] | None
    teeth: Annotated[list[Annotated[int, Field(ge=1, le=10_000)]], Field(min_length=2, max_length=2)] | None
    ratio: Number
    working_flank: Literal["left", "right"] | None
    ways: int = Field(default=LEFT_OUT, ge=2, le=MOST_ENTRIES, description="of parallel load paths")
    factor: Number = Field(description="turn of the shaft that is read per turn of the driven shaft")
    roads: StageRoads
    published: Mapping[Label, Ends]


class Sums(Strict):
    """Sums of the stages' ends at the shaft that is read [arcmin]."""

    analytic: Ends
    geometric: Ends = LEFT_OUT
    published: Mapping[Label, Ends]


class TrainSummary(Strict):
    """A train and its stages."""

    driven: Label
    held: Label
    output: Label
    ratio: Number
    shaft: Label
    measure: Label = Field(description="whose stages these are")
    unit: Unit
    lever_mm: Known
    point: Label | None
    stages: Annotated[list[Stage], Field(min_length=1)]
    sums: Sums


class Witnessed(Strict):
    """FCL - engine of one measure, in its unit."""

    max_abs_difference: Known
    mean_difference: Known
    rms_difference: Known
    trial_of_the_largest: Count | None
    compared: Count
    expected_at_most: NotNegative = Field(description="what chord errors explain")
    allowance: NotNegative = Field(description="what else FCL may be off")


class WitnessSummary(Strict):
    """What FCL found of some trials."""

    engine: Literal["fcl"]
    trials: Count
    chord_error_um: NotNegative
    profile_steps: int = Field(ge=8, le=2000)
    measures: Mapping[Label, Witnessed]
    status_differences: Count


class Blocks(Strict):
    """How trials are cut into files, and whether those are kept."""

    trials: int = Field(ge=1, le=2**20)
    kept: bool


class Timing(Strict):
    """How long it took, on how many workers."""

    setup_s: NotNegative
    simulate_s: NotNegative
    first_block_s: NotNegative
    trials_per_s: NotNegative
    resumed_trials: Count
    workers: Count
    peak_memory_mb: NotNegative | None


class RunSummary(Strict):
    """summary.json: what a run of a scene found. Lengths um, of a tip mm; angles arcmin; shares ppm or %."""

    scene: Label
    seed: int = Field(ge=0, le=MOST_SEED)
    trials: Positive
    engine: Engine
    study: StudySummary
    status: Mapping[Label, Count] = Field(description="how many trials ended how")
    chord_error_um: NotNegative | None
    measures: Annotated[Mapping[Label, MeasureSummary], Field(min_length=1, max_length=MOST_ENTRIES)]
    trains: Mapping[Label, TrainSummary]
    warnings: list[Sentence]
    witness: WitnessSummary = LEFT_OUT
    blocks: Blocks
    files: Mapping[Label, Sha256] = Field(description="SHA-256 of the scene and of every file that it names")
    timing: Timing
    versions: Mapping[Label, Sentence] = Field(description="of what decides a result's last bit")

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
        simulated = self.engine != "analytic"
        for name, measure in self.measures.items():
            road = measure.curve.geometric if measure.take == "curve" else measure.geometric
            if (road is not None) != simulated:
                raise refused(f"measures.{name}", f"geometric as the engine is {self.engine}", "otherwise")
        for name, train in self.trains.items():
            if train.measure not in self.measures:
                raise refused(f"trains.{name}.measure", "a measure of the run", shown(train.measure))
        return self


def summary_of(content: bytes, path: Path) -> dict[str, Any]:
    """The summary of a run from its file, which a stranger may have made.

    Raises:
        RunError: it is not a summary as this version writes them.
    """
    try:
        found = json.loads(content, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise RunError(f"{path}: cannot be read ({_printable(str(error))})") from None
    if not isinstance(found, dict):
        raise RunError(f"{path}: expected the summary of a tol3d run, got {shown(found)}")
    refuse_summary(
        found, lambda place, words: RunError(f"{path}: {place}: {words}; it is damaged, or of another tol3d")
    )
    return found


def written(summary: Mapping[str, Any]) -> str:
    """The text of a summary; what the schema does not know is warned of, for a long study is not lost by a fault."""
    text = json.dumps(summary, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    try:
        refuse_summary(json.loads(text), lambda place, words: RunError(f"{place}: {words}"))
    except RunError as error:
        warnings.warn(f"a fault of tol3d: {SUMMARY_FILE}: {error}; {WHERE}", SchemaWarning, stacklevel=2)
    return text


SUMMARY_FILE = "summary.json"
WHERE = f"its keys are written down in {__name__.replace('.', '/')}.py, one line each in the class of their place"


class SchemaWarning(UserWarning):
    """A summary is written that its own schema does not know; the tests take it for an error."""


def refuse_summary(summary: Mapping[str, Any], fault: Callable[[str, str], Exception]) -> None:
    """Raise the fault of a place and what is wrong there, unless a summary is as the schema says."""
    try:
        RunSummary.model_validate(summary)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
    else:
        return
    context = first.get("ctx", {})
    extra = context.get("key") if first["type"] == "unknown_key" else context.get("field")
    place = ".".join(str(key) for key in (*first["loc"], *([extra] if extra else [])))
    got = "" if first["type"] == "value_refused" else f", got {shown(first['input'])}"
    raise fault(_printable(place or "the whole"), _printable(f"{first['msg']}{got}"))


def _refuse_constant(word: str) -> None:
    raise ValueError(f"{word} is no number of JSON")


def _printable(text: str) -> str:
    """A short text in which a stranger's characters do nothing."""
    safe = "".join(sign if unicodedata.category(sign) not in UNSAFE else "?" for sign in text)
    return safe if len(safe) <= 400 else safe[:399] + "…"
