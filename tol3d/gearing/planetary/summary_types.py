"""Keys of summary.json for planetary sets, besides those of every run."""

from collections.abc import Mapping
from typing import Final, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.gearing.summary.types import BacklashOfRun
from tol3d.strict import refused
from tol3d.study.runs.summary.kinds import SummaryKinds
from tol3d.study.runs.summary.measure import OutputMeasureSummary
from tol3d.study.runs.summary.values import LEFT_OUT, Label, Maybe, Number, Numbers, Section


class PlanetaryMeasureSummary(OutputMeasureSummary):
    """A measure of a planetary set."""

    kind: Literal["planetary_lost_motion", "planetary_low_stiffness", "planetary_transmission_error"]
    shaft: Label = Field(description="the shaft that turns")

    @property
    def words(self) -> str:
        """See MeasureSummary.

        >>> made = PlanetaryMeasureSummary.model_construct
        >>> made(kind="planetary_lost_motion", of="reducer", shaft="ring 2", take="value").words
        'lost motion of ring 2, reducer'
        >>> made(kind="planetary_transmission_error", of="reducer", shaft="ring 2", take="harmonic", order=1).words
        'order 1, peak to peak, of the transmission error of ring 2, reducer'
        """
        if self.kind == "planetary_low_stiffness":
            return f"turn of {self.shaft} against springs alone, {self.of}"
        return f"{self.quantity} of {self.shaft}, {self.of}"

    @property
    @override
    def identity(self) -> tuple[str | None, ...]:
        return *super().identity, self.shaft


class EfficiencySummary(Section):
    """Efficiency of a set [%]; at most 0 if it is self-locking."""

    forward_percent: Number = Field(description="driven at the input")
    backward_percent: Number = Field(description="driven at the output")


class TorqueCurve(Section):
    """A shaft turned to a peak of torque, to the same backwards, and to the peak again; the opposite shaft stands."""

    shaft: Label
    torque_n_mm: Numbers
    turn_arcmin: Numbers
    breakaway_n_mm: Numbers = Field(description="torques from which it turns, clockwise and counter-clockwise")
    rigid_arcmin: Numbers | None = Field(description="ends of its dead band with a rigid carrier; null where that jams")

    @model_validator(mode="after")
    def _refuse_uneven(self) -> Self:
        if len(self.torque_n_mm) != len(self.turn_arcmin) or len(self.breakaway_n_mm) != 2:
            raise refused("torque_n_mm", "a turn for each torque, and two breakaway torques", "others")
        if self.rigid_arcmin is not None and len(self.rigid_arcmin) != 2:
            raise refused("rigid_arcmin", "two ends", len(self.rigid_arcmin))
        return self


class SpringSummary(Section):
    """Data of the spring of a flexible carrier, in the build with all deviations at their means."""

    force_n: Number = Field(description="against the displacement of each planet, where contacts stop it")
    stiffness_n_per_mm: Number
    friction_n: Number
    breakaway_n_mm: Mapping[Label, Number] = Field(description="torque from which a shaft turns against it, by shaft")
    low_stiffness_n_mm_per_arcmin: Mapping[Label, Number] = Field(
        description="stiffness with which a shaft turns from there on, by shaft"
    )
    curve: TorqueCurve


class PlanetarySetSummary(Section):
    """A planetary set, power lost to the friction of its teeth, and data of the spring of its carrier."""

    input: Label
    output: Label
    held: Label
    ratio: Number = Field(description="turns of the input a turn of the output")
    friction: Maybe[Number] = Field(default=LEFT_OUT, description="coefficient of friction of the teeth")
    meshes_percent: Maybe[Mapping[Label, Number]] = Field(
        default=LEFT_OUT, description="efficiency of each mesh, by its central gear [%]"
    )
    efficiency: Maybe[EfficiencySummary] = Field(
        default=LEFT_OUT, description="by equilibrium of torques; pairs of teeth in contact carry alike"
    )
    efficiency_by_formula: Maybe[EfficiencySummary] = Field(
        default=LEFT_OUT, description="of a 3K set by the closed form of Wang, Yang, Du and Chen"
    )
    spring: Maybe[SpringSummary] = LEFT_OUT


class PlanetaryOfRun(BacklashOfRun):
    """The backlash of meshes, and the planetary sets of a run with a stated friction or spring."""

    planetary_sets: Maybe[Mapping[Label, PlanetarySetSummary]] = LEFT_OUT


SUMMARY_KINDS: Final = SummaryKinds((PlanetaryMeasureSummary,), (PlanetaryOfRun,))
