"""Run-out and radial composite deviations of teeth, by the names that ISO 1328-2 and gear drawings have for them."""

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Final, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.errors import GeometryError, InputError
from tol3d.files import Files
from tol3d.gearing.draws.pitch_draw import tooth_names
from tol3d.gearing.effects import UNIFORM, FlankDeviation, Place
from tol3d.gearing.grammar.parts import BevelGearSpec, GearSpec, HelicalGearSpec, SpurGearSpec, helix_of
from tol3d.gearing.grammar.tolerances.flank_shape import NormalShapeSpec, UniformShapeSpec
from tol3d.gearing.grammar.tolerances.flank_tolerance import OF_CLASSES, FlankToleranceSpec, no_word
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning, Nominal
from tol3d.gearing.grammar.tolerances.gears import TeethOffAxisSpec
from tol3d.gears import LEFT, RIGHT, Gear
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.pair import SAME_LENGTH
from tol3d.gears.tooth_measures import SAME_NOMINAL
from tol3d.scene.bases import Length, MoveSpec, PartSpec
from tol3d.scene.entry import Contradiction, Entry
from tol3d.scene.place import KeyPath
from tol3d.statistics.distributions import Distribution, Normal, Uniform
from tol3d.statistics.distributions.base import Stays
from tol3d.statistics.distributions.derived import Proportion, Scale
from tol3d.statistics.standards import iso_1328_2
from tol3d.strict import Strict, refused
from tol3d.study.system.draw import Draw, Each
from tol3d.units import Quantity

GRADE: Final = "iso_1328_2"
"""The key of limits by a grade."""
UM: Final = 1e-3  # mm
ECCENTRICITY: Final = Proportion(0.5, "run-out")
"""Teeth whose centre lies off the axis by e run out by 2 e."""


class ToothRunOutSpec(TeethOffAxisSpec):
    """F_r, a length: run-out of the teeth, all of it by an eccentricity of half of it.

    What pitch, form and thickness of single teeth add to a measured run-out is left out: state these beside it. Of a
    drawing with radial composite deviations F_r is F_i'' - f_i''. The run-out of a shaft, with every gear on it, is
    `run_out`.
    """

    kind: Literal["tooth_run_out"]

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """A grade is of a cylindrical gear, and of this one."""
        drawn, gear = self.distribution.drawn, parts[self.of]
        if not isinstance(drawn, dict) or GRADE not in drawn or not isinstance(gear, GearSpec):
            return
        path: KeyPath = ("distribution", GRADE)
        if isinstance(gear, BevelGearSpec):
            words = f"{self.of!r}, a bevel gear, whose ISO 17485 is not in tol3d"
            yield Contradiction(path, "a cylindrical gear, or the limits themselves, as in 0/+30 um", words)
            return
        beta, _ = helix_of(gear)
        module = gear.module.internal
        own = {"module": (module, SAME_LENGTH * module), "of": (module * gear.teeth / math.cos(beta), SAME_NOMINAL)}
        for key, (size, apart) in own.items():
            if not math.isclose(Quantity.parse(drawn[key]).internal, size, rel_tol=0.0, abs_tol=apart):
                yield Contradiction(("distribution", key), f"{size:g} mm, as {self.of!r} has it", repr(str(drawn[key])))

    @override
    def scale_of(self, gear: Gear) -> Scale:
        return ECCENTRICITY

    def meaning(self, nominal: Nominal) -> Meaning:
        """The gear's centre lies off its axis by half of the run-out."""
        own = super().meaning(nominal)
        return Meaning(own.effect, own.planar, own.azimuth, scale=ECCENTRICITY)


class CompositeLimitsSpec(Strict):
    """f_i'', by a grade or as it is."""

    grade: int | None = Field(default=None, description="of ISO 1328-2:1997, 4 to 12")
    size: Length | None = Field(default=None, description="f_i'' itself")

    @model_validator(mode="after")
    def _refuse_both(self) -> Self:
        if (self.grade is None) == (self.size is None):
            raise refused("", "either grade or size", "neither" if self.size is None else "both")
        return self

    def of(self, gear: CylindricalGear) -> float:
        """That of a gear [mm].

        Raises:
            GeometryError: the grade has none for it.
        """
        if self.size is not None:
            return self.size.internal
        try:
            return iso_1328_2.tolerance("f_i''", self.grade or 0, gear.module, gear.reference_diameter) * UM
        except InputError as error:
            raise GeometryError(f"limits.grade: {error}") from None


class ToothToToothSpec(FlankToleranceSpec):
    """f_i'', a length: the tooth-to-tooth part of the radial composite deviation, all of it by the teeth's thickness.

    Each tooth by itself pushes a master gear without backlash out by up to f_i''/2, or lets it in: both its flanks are
    offset by sin(alpha) as much along their normals. So no two neighbours differ by more than f_i''. What form and
    pitch add to a measured f_i'' is left out. Uniform, or normal with 3 cpk sigma at f_i''/2.
    """

    applies_to: ClassVar[tuple[type[Entry], ...]] = (SpurGearSpec, HelicalGearSpec)

    kind: Literal["tooth_to_tooth"]
    flanks: Literal["together"] = Field(default="together", description="together: both flanks of a tooth alike")
    limits: Annotated[CompositeLimitsSpec, no_word("limits such as {grade: 7} or {size: 14 um}")] = Field(
        description="f_i'' of the gear, by a grade or stated"
    )
    law: Annotated[
        UniformShapeSpec | NormalShapeSpec,
        Field(discriminator="kind", description="how teeth fill the limits"),
        no_word("a law such as {kind: uniform}"),
    ]

    def draw(self, gear: CylindricalGear, files: Files) -> Draw:
        """See FlankToleranceSpec: how far each tooth pushes a master gear out."""
        half = self.limits.of(gear) / 2
        own: Distribution = Uniform(-half, half)
        if isinstance(self.law, NormalShapeSpec):
            own = Normal(0.0, half / (3 * self.law.cpk), (-half, half))
        return Each(own, tooth_names(gear.teeth, self.sides))

    def effect(self, gear: CylindricalGear, active_roll: float) -> FlankDeviation:
        """See FlankToleranceSpec: both flanks that are offset by d push a master gear out by d/sin(alpha_n)."""
        out = math.sin(gear.pressure_angle)
        teeth = range(gear.teeth)
        places = tuple(tuple(Place(tooth, flank, out) for flank in (RIGHT, LEFT)) for tooth in teeth)
        return FlankDeviation(self.of, UNIFORM, places)

    @override
    def in_numbers(self, draw: Any) -> Self:
        if self.limits.size is not None:
            return self
        size = OF_CLASSES.like(2.0 * draw.distribution.high)
        return self.model_copy(update={"limits": CompositeLimitsSpec(size=size)})

    def scaled(self, factor: float, stays: Stays, files: Files) -> Self:
        """See ToleranceEntry: the limit."""
        if stays != "middle" or self.limits.size is None:
            raise InputError("expected a limit that is a length, size")
        wider = self.limits.model_copy(update={"size": self.limits.size.like(factor * self.limits.size.internal)})
        return self.model_copy(update={"limits": wider})
