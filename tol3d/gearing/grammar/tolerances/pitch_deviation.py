"""Pitch deviations of a spur or helical gear's teeth."""

import math
from collections.abc import Iterator, Sequence
from itertools import accumulate, chain
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.errors import GeometryError, InputError, Problem, SceneError
from tol3d.files import Files
from tol3d.gearing.draws.normal_pitch_draw import NormalPitchDraw
from tol3d.gearing.draws.pitch_draw import (
    GivenDraw,
    Pattern,
    PitchDraw,
    PitchLimits,
    RandomWalk,
    RunOutAndRandom,
    tooth_names,
)
from tol3d.gearing.effects import UNIFORM, FlankDeviation, Place
from tol3d.gearing.grammar.tolerances.flank_tolerance import (
    OF_CLASSES,
    FlankToleranceSpec,
    IsoClass,
    RecordSpec,
    Share,
    limits_of_class,
    no_word,
)
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.scene.bases import Length
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.statistics.distributions.base import Stays
from tol3d.strict import Strict, refused
from tol3d.study.system.draw import Draw
from tol3d.units import Of, Quantity

Arcs = Annotated[tuple[Annotated[Quantity, Of("length")], ...], listed("lengths", 3)]


class PitchLimitsSpec(Strict):
    """Limits of pitch deviations, by a class or as they are."""

    iso_class: IsoClass | None = Field(default=None, description="flank tolerance class of ISO 1328-1:2013, 1 to 11")
    single: Length | None = Field(default=None, description="f_p: of the size of each single pitch deviation")
    cumulative: Length | None = Field(
        default=None, description="F_p: of the largest index deviation of a flank side less the smallest"
    )

    @model_validator(mode="after")
    def _refuse_half_limits(self) -> Self:
        given = [name for name in ("iso_class", "single", "cumulative") if getattr(self, name) is not None]
        if given not in (["iso_class"], ["single", "cumulative"]):
            raise refused("", "either iso_class, or single and cumulative", " and ".join(given) or "none of them")
        return self

    def of(self, gear: CylindricalGear) -> PitchLimits:
        """The limits of a gear [mm].

        Raises:
            GeometryError: the class states none for it.
        """
        if self.single is not None and self.cumulative is not None:
            return PitchLimits(self.single.internal, self.cumulative.internal)
        limits = limits_of_class(self.iso_class or 0, gear)
        return PitchLimits(limits.single_pitch, limits.cumulative_pitch)


class FilledSpec(Strict):
    """A pattern round the gear whose size follows from its utilisation of the limits."""

    fill: Annotated[tuple[Share, Share], listed("shares", 2, 2)] = Field(
        description="least and most of the limits that a flank side takes up, uniform in between; 1 reaches one of them"
    )

    @model_validator(mode="after")
    def _refuse_disorder(self) -> Self:
        least, most = self.fill
        if least > most:
            raise refused("fill", "the least share before the most", f"[{least:g}, {most:g}]")
        return self


class RandomWalkSpec(FilledSpec):
    """Single pitches are independent normals on condition that they sum to zero."""

    kind: Literal["random_walk"]

    @property
    def pattern(self) -> Pattern:
        """Pattern of the deviations round the gear."""
        return RandomWalk()


class RunOutAndRandomSpec(FilledSpec):
    """Index deviations are one wave round the gear, of any phase, and independent normals."""

    kind: Literal["run_out_and_random"]
    run_out: float = Field(ge=0.0, le=1.0, description="the wave's part of the variance")

    @property
    def pattern(self) -> Pattern:
        """Pattern of the deviations round the gear."""
        return RunOutAndRandom(self.run_out)


class NormalPitchSpec(Strict):
    """Single pitches are normal with 3 cpk sigma at f_p, sum to zero, and no index deviations spread beyond F_p."""

    kind: Literal["normal"]
    cpk: float = Field(gt=0.0, description="how far the process fills f_p, as ISO 22514-2 has it")


class GivenSpec(Strict):
    """Index deviations of a gear that was measured, from tooth 0 on, in every trial the same."""

    kind: Literal["given"]
    right: Arcs | None = Field(default=None, description="of the right flanks, or of whole teeth")
    left: Arcs | None = Field(default=None, description="of the left flanks")


class PitchRecordSpec(RecordSpec):
    """Pitch deviations written by a measuring centre, positive in its counting direction."""

    deviation: Literal["index", "single"] = Field(
        description="index: F_p, how far each flank lies ahead; single: f_p, from the flank before to this one"
    )

    def index(self, teeth: int, sides: Sequence[str], files: Files) -> dict[str, list[float]]:
        """Index deviations of each side [mm], counter-clockwise from the gear's tooth 0 on, less their mean.

        Raises:
            SceneError: the file lacks some, or single pitch deviations do not sum to zero within their last digits.
        """
        record, found = self.record(teeth, files), dict[str, list[float]]()
        sense = 1.0 if self.counted == "counter_clockwise" else -1.0
        for side, values in record.measured(sides, gaps=False).items():
            index = [value for value in values if value is not None]
            if self.deviation == "single":
                over = math.fsum(index)
                if abs(over) > teeth * record.grain() / 2:
                    flanks = f" over the {side} flanks" if side else ""
                    words = f"expected single pitch deviations that sum to zero{flanks}, got {1e3 * over:g} um"
                    words += "; index deviations are `deviation: index`"
                    raise SceneError(Problem.at(record.table.path, words, path=f"column {self.column!r}"))
                index = [value - over * (k + 1) / teeth for k, value in enumerate(accumulate(index))]
            mean = math.fsum(index) / teeth
            found[side] = [sense * (index[self.placed(tooth, teeth)] - mean) for tooth in range(teeth)]
        return found


Law = Annotated[
    RandomWalkSpec | RunOutAndRandomSpec | NormalPitchSpec | GivenSpec | PitchRecordSpec,
    Field(discriminator="kind", description="how deviations go round the gear, and how far they fill the limits"),
    no_word("a law such as {kind: random_walk, fill: [0.7, 1]}"),
]


class PitchDeviationSpec(FlankToleranceSpec):
    """Index deviations F of the flanks, arcs at the reference circle, positive counter-clockwise about the gear's z.

    Single pitch deviations are their differences from tooth to tooth and sum to zero. The common part of all flanks of
    a side is removed: it is tooth thickness.
    """

    kind: Literal["pitch_deviation"]
    limits: Annotated[PitchLimitsSpec, no_word("limits such as {iso_class: 5}")] | None = Field(
        default=None, description="f_p and F_p: a class, or stated; of every law but what is given"
    )
    law: Law

    @model_validator(mode="after")
    def _refuse_misfits(self) -> Self:
        if not isinstance(self.law, GivenSpec | PitchRecordSpec):
            if self.limits is None:
                raise refused("limits", "limits such as {iso_class: 5}, which the law fills", "none")
            return self
        if self.limits is not None:
            raise refused("limits", f"none beside a law that is {self.law.kind}", "limits")
        if isinstance(self.law, PitchRecordSpec):
            return self
        wanted = {"right": ["right"], "left": ["left"], "each": ["right", "left"], "together": ["right"]}[self.flanks]
        given = [side for side in ("right", "left") if getattr(self.law, side) is not None]
        if given != wanted:
            got = " and ".join(given) or "none"
            raise refused("law", f"{' and '.join(wanted)} for flanks {self.flanks}", got)
        return self

    @override
    def in_numbers(self, draw: Any) -> Self:
        if self.limits is None or self.limits.iso_class is None:
            return self
        limits: PitchLimits = draw.limits
        single, cumulative = OF_CLASSES.like(limits.single), OF_CLASSES.like(limits.cumulative)
        return self.model_copy(update={"limits": PitchLimitsSpec(single=single, cumulative=cumulative)})

    def scaled(self, factor: float, stays: Stays, files: Files) -> Self:
        """See ToleranceEntry: both limits."""
        limits = self.limits
        if stays != "middle" or limits is None or limits.single is None or limits.cumulative is None:
            raise InputError("expected limits that are lengths, single and cumulative")
        both = {"single": limits.single, "cumulative": limits.cumulative}
        wider = {name: own.like(factor * own.internal) for name, own in both.items()}
        return self.model_copy(update={"limits": limits.model_copy(update=wider)})

    @override
    def draw(self, gear: CylindricalGear, files: Files) -> Draw:
        if isinstance(self.law, GivenSpec):
            return self._given(self.law, gear)
        if isinstance(self.law, PitchRecordSpec):
            arcs = self.law.index(gear.teeth, self.sides, files).values()
            names = tooth_names(gear.teeth, self.sides)
            return GivenDraw(names, tuple(chain.from_iterable(arcs)), f"measured in {self.law.file}")
        limits = PitchLimitsSpec.of(self._limits, gear)
        if isinstance(self.law, NormalPitchSpec):
            return NormalPitchDraw(gear.teeth, self.sides, RandomWalk(), limits, (1.0, 1.0), self.law.cpk)
        return PitchDraw(gear.teeth, self.sides, self.law.pattern, limits, self.law.fill)

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Those that its law reads."""
        return self.law.file_names() if isinstance(self.law, PitchRecordSpec) else iter(())

    @property
    def _limits(self) -> PitchLimitsSpec:
        if self.limits is None:
            raise TypeError("a law that fills limits has some")
        return self.limits

    def _given(self, law: GivenSpec, gear: CylindricalGear) -> GivenDraw:
        found: list[float] = []
        for side in self.sides:
            arcs = [arc.internal for arc in getattr(law, side or "right")]
            if len(arcs) != gear.teeth:
                raise GeometryError(f"law.{side or 'right'}: expected {gear.teeth} lengths, got {len(arcs)}")
            mean = math.fsum(arcs) / gear.teeth
            found += [arc - mean for arc in arcs]
        return GivenDraw(tooth_names(gear.teeth, self.sides), tuple(found))

    def effect(self, gear: CylindricalGear, active_roll: float) -> FlankDeviation:
        """A flank that lies F ahead lies F cos(alpha_n) cos(beta) out of its tooth on the left, inside on the right.

        Exact: involutes that are turned by F/r lie r_b cos(beta_b) F/r apart along their normals.
        """
        cosine = math.cos(gear.pressure_angle) * math.cos(gear.helix_angle)
        places = [
            tuple(Place(tooth, flank, -flank * cosine) for flank in self.flanks_of(side))
            for side in self.sides
            for tooth in range(gear.teeth)
        ]
        return FlankDeviation(self.of, UNIFORM, tuple(places))
