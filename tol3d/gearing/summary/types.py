"""Gear entries in summary.json: keys of their measures, descriptions of the measures, and trains."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Final, Literal, Self, get_args

from pydantic import Field, model_validator

from tol3d.gearing.grammar.measures import FEWEST_PROFILE_STEPS, MOST_PROFILE_STEPS
from tol3d.gearing.summary.measure_words import (
    OVER_WORDS,
    QUANTITY_WORDS,
    TAKE_WORDS,
    TRAIN_OVER_WORDS,
    Reading,
    readings_words,
)
from tol3d.strict import refused
from tol3d.study.runs.summary.kinds import SummaryKinds
from tol3d.study.runs.summary.measure import Conversion, MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.runs.summary.values import LEFT_OUT, MOST_ENTRIES, Known, Label, Maybe, Number, Numbers, Section, Unit
from tol3d.units import shown

Over = Literal["random", "at", "turn", "long_period", "swing"]

PRESENTER: Final = "tol3d.gearing.presenting"

FLANKS_OF_A_BACKLASH: Final = 4  # two at the contact, two at the gap; each may miss the true flank by the chord error
FLANKS_THAT_TOUCH: Final = 2
LOST_MOTION_MEANS: Final = (
    "lost motion: the turn of the driven gear that a normal backlash leaves free, j_n over the arm of its flank, "
    "without load; data sheets measure it at ±3 % of the rated torque"
)


class FreeTurn(Section):
    """Free turn from a normal backlash."""

    of: Label = Field(description="the driven gear")
    arcmin_per_um: Number


class BacklashWords(Section):
    """Description of the backlash of a mesh."""

    kind: Literal["normal_backlash", "circumferential_backlash", "angular_backlash"]
    of: Label = Field(description="the mesh")
    gear: Label | None
    reading: Reading
    lost_motion: Maybe[FreeTurn] = LEFT_OUT


class BacklashSummary(BacklashWords, MeasureSummary):
    """The backlash of a mesh; every value is in `unit`."""

    presenter = PRESENTER

    kind: Literal["normal_backlash", "circumferential_backlash", "angular_backlash"]
    over: Over

    @property
    def words(self) -> str:
        """Quantity, gear, mesh and positions: `smallest normal backlash of gear pair over one turn of the driver`."""
        gear = f" of {self.gear} in" if self.kind == "angular_backlash" else " of"
        quantity = TAKE_WORDS[self.take] + QUANTITY_WORDS[self.kind]
        return f"{quantity}{gear} {self.of} {OVER_WORDS[self.over]}{self.reading.words}"

    @property
    def position_word(self) -> str:
        """Positions are those of the driver."""
        return "driver"

    @property
    def position_column(self) -> str | None:
        """The driver's."""
        return f"position:{self.of} [deg]" if self.over == "random" else None

    @property
    def identity(self) -> tuple[str | None, ...]:
        """Kind, gear, and where on the face it is read."""
        return self.kind, self.gear, self.reading.words

    @property
    def conversions(self) -> Sequence[Conversion]:
        """The free turn of the driven gear from a normal backlash."""
        if self.lost_motion is None:
            return ()
        free = self.lost_motion
        return (Conversion("lost motion", free.of, "arcmin", free.arcmin_per_um, LOST_MOTION_MEANS),)

    def chord_words(self, chord_error_um: float) -> str:
        """Words for the possible effect of measuring strips' chords."""
        return _chord_words(chord_error_um, "")


class TransmissionErrorWords(Section):
    """Description of a transmission error."""

    kind: Literal["transmission_error"]
    of: Label = Field(description="the mesh or the train")
    gear: Label = Field(description="the driven gear, or the train's output shaft")
    flank: Literal["drive", "back"]
    reading: None
    readings: Mapping[Label, Reading] = Field(description="of each mesh")


class TransmissionErrorSummary(TransmissionErrorWords, MeasureSummary):
    """The transmission error of a mesh or a train; every value is in `unit`."""

    presenter = PRESENTER

    kind: Literal["transmission_error"]
    over: Literal["turn", "long_period"]

    @property
    def words(self) -> str:
        """Quantity, flank, mesh or train, and positions: `range of transmission error of gear pair, drive flank, …`."""
        quantity = f"{TAKE_WORDS[self.take]}transmission error of {self.of}, {self.flank} flank"
        return f"{quantity}, {OVER_WORDS[self.over]}{readings_words(self.readings)}"

    @property
    def position_word(self) -> str:
        """Positions are those of the driver."""
        return "driver"

    @property
    def identity(self) -> tuple[str | None, ...]:
        """Kind, gear, flank, and where on the faces it is read."""
        return self.kind, self.gear, self.flank, readings_words(self.readings)

    def chord_words(self, chord_error_um: float) -> str:
        """Words for the possible effect of measuring strips' chords."""
        whole = FLANKS_THAT_TOUCH * chord_error_um
        return (
            f"up to {whole:.3f} µm along the line of action in each mesh may be chord error ({chord_error_um:.3f} µm "
            f"on each of {FLANKS_THAT_TOUCH} flanks)"
        )


class TrainMeasureWords(Section):
    """Description of a train's lost motion, or of its effect on the tip of an arm."""

    kind: Literal["lost_motion", "tip_displacement", "tip_error"]
    of: Label = Field(description="the train")
    gear: None
    reading: None
    readings: Mapping[Label, Reading] = Field(description="of each mesh")
    shaft: Label = Field(description="that is read")
    held: Label = Field(description="the shaft that is held")
    arm: Label | None
    point: Label | None
    lever_mm: Known
    load_changes_deg: Numbers


class TrainMeasureSummary(TrainMeasureWords, MeasureSummary):
    """The lost motion of a train, or its effect on the tip of an arm; every value is in `unit`."""

    presenter = PRESENTER

    kind: Literal["lost_motion", "tip_displacement", "tip_error"]
    over: Over

    @property
    def words(self) -> str:
        """Quantity, shafts or point, and positions: `lost motion of flange, motor held, without load, at random`."""
        return f"{self._quantity}, {TRAIN_OVER_WORDS[self.over]}{readings_words(self.readings)}"

    @property
    def _quantity(self) -> str:
        if self.kind == "lost_motion":
            return f"lost motion of {self.shaft}, {self.held} held, without load"
        word = "error" if self.kind == "tip_error" else "displacement"
        return f"{word} of {self.point} of {self.arm} by the lost motion"

    @property
    def position_word(self) -> str:
        """Positions are those of the driver, of an error those of the output."""
        return "output" if self.kind == "tip_error" else "driver"

    @property
    def jumps(self) -> bool:
        """A curve of an error is 0 with the load on one side."""
        return (self.kind, self.take) == ("tip_error", "curve")

    @property
    def jumps_deg(self) -> Sequence[float]:
        """Positions at which the load changes sides."""
        return self.load_changes_deg

    @property
    def jump_words(self) -> str:
        """Words for these positions."""
        return "the load changes sides"

    @property
    def identity(self) -> tuple[str | None, ...]:
        """Kind, point or shaft, and where on the faces it is read."""
        return self.kind, self.point or self.shaft, readings_words(self.readings)

    def chord_words(self, chord_error_um: float) -> str:
        """Words for the possible effect of measuring strips' chords."""
        return _chord_words(chord_error_um, " in each mesh")


def _chord_words(chord_error_um: float, whose: str) -> str:
    whole = FLANKS_OF_A_BACKLASH * chord_error_um
    return (
        f"up to {whole:.3f} µm of normal backlash{whose} may be chord error ({chord_error_um:.3f} µm on each of "
        f"{FLANKS_OF_A_BACKLASH} flanks)"
    )


# trains -------------------------------------------------------------------------------------------


class Ends(Section):
    """Ends of a train's stage, or of their sum, by a method or as published [arcmin]."""

    low_3sigma: Maybe[Known] = LEFT_OUT
    mean: Maybe[Known] = LEFT_OUT
    high_3sigma: Maybe[Known] = LEFT_OUT
    sigma: Maybe[Known] = LEFT_OUT
    sample_min: Maybe[Known] = LEFT_OUT
    sample_max: Maybe[Known] = LEFT_OUT
    share_percent: Maybe[Known] = LEFT_OUT


class StageMethods(Section):
    """Results of both methods for a stage."""

    analytic: Ends
    geometric: Maybe[Ends] = LEFT_OUT

    def by(self, method: str) -> Ends:
        """Result of a method; the analytic one if there is no 3D simulation."""
        return self.geometric if method == "geometric" and self.geometric is not None else self.analytic


class StageSummary(Section):
    """A link of a train."""

    link: Label
    kind: Label = Field(
        description="mesh, internal_mesh, bevel_mesh, parallel, or the kind of another link, such as reducer"
    )
    driver: Label
    driven: Label
    gears: Annotated[list[Label], Field(min_length=2, max_length=2)] | None
    teeth: Annotated[list[Annotated[int, Field(ge=1, le=10_000)]], Field(min_length=2, max_length=2)] | None
    ratio: Number
    working_flank: Literal["left", "right"] | None
    ways: Maybe[Annotated[int, Field(ge=2, le=MOST_ENTRIES, description="of parallel load paths")]] = LEFT_OUT
    factor: Number = Field(description="turn of the shaft that is read per turn of the driven shaft")
    methods: StageMethods
    published: Mapping[Label, Ends]


class Sums(Section):
    """Sums of the stages' ends at the shaft that is read [arcmin]."""

    analytic: Ends
    geometric: Maybe[Ends] = LEFT_OUT
    published: Mapping[Label, Ends]


class TrainSummary(Section):
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
    stages: Annotated[list[StageSummary], Field(min_length=1)]
    sums: Sums


BacklashSymbol = Literal["j_bn", "j_wt", "j_t", "j_r"]
BACKLASH_SYMBOLS: Final[tuple[BacklashSymbol, ...]] = get_args(BacklashSymbol)


class BacklashLimits(Section):
    """Limits of a mesh's backlash by the tolerances of a stage and those before it."""

    mesh: Label
    stage: Annotated[Literal["theoretical", "acceptance", "operating"], Shows("stage", "words")]
    symbol: Annotated[BacklashSymbol, Shows("", "words")] = Field(
        description="normal, on the working circles, on the reference circles, radial"
    )
    least_um: Annotated[Known, Shows("least [µm]", ".1f")] = Field(description="of the worst builds that were found")
    largest_um: Annotated[Known, Shows("largest [µm]", ".1f")]
    least_3sigma_um: Annotated[Known, Shows("mean − 3 σ [µm]", ".1f")] = Field(
        description="no further than the worst builds"
    )
    largest_3sigma_um: Annotated[Known, Shows("mean + 3 σ [µm]", ".1f")]


class BacklashOfRun(RunSummary):
    """The backlash of meshes of a run."""

    backlash: Maybe[list[BacklashLimits]] = LEFT_OUT


class TrainsOfRun(BacklashOfRun):
    """The trains and the backlash of meshes of a run."""

    trains: Maybe[Mapping[Label, TrainSummary]] = LEFT_OUT

    @model_validator(mode="after")
    def _refuse_trains_of_nothing(self) -> Self:
        for name, train in (self.trains or {}).items():
            if train.measure not in self.measures:
                raise refused(f"trains.{name}.measure", "a measure of the run", shown(train.measure))
        return self


class ProfileSteps(Section):
    """Resolution of flank measurement."""

    profile_steps: Maybe[Annotated[int, Field(ge=FEWEST_PROFILE_STEPS, le=MOST_PROFILE_STEPS)]] = LEFT_OUT


SUMMARY_KINDS: Final = SummaryKinds(
    (BacklashSummary, TransmissionErrorSummary, TrainMeasureSummary), (TrainsOfRun,), options=(ProfileSteps,)
)
