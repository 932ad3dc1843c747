"""Deviations of the shape of a gear's single flanks: slopes and forms, each drawn for itself.

Evaluation ranges: limits on a flank between which slopes and forms count.

ISO 1328-1:2013 finds the mean line of a trace in an evaluation range, and takes the slope deviation from it between the
ends of the flank, to which it is extrapolated: f_Halpha from the profile control diameter to the tip diameter, f_Hbeta
over the whole face width. The form deviation counts within the evaluation range. The profile's is the first 95 % of the
length of roll from the control diameter, which is where the active profile begins if no drawing says otherwise, to the
tip; older editions have 92 %, for slopes too. The standard itself was not available.
"""

import math
from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Final, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.errors import GeometryError, InputError
from tol3d.files import Files
from tol3d.gearing.draws.pitch_draw import GivenDraw, tooth_names
from tol3d.gearing.effects import FORM, HELIX, SLOPE, FlankDeviation, Place
from tol3d.gearing.grammar.parts import SpurGearSpec
from tol3d.gearing.grammar.tolerances.flank_tolerance import (
    OF_CLASSES,
    FlankToleranceSpec,
    IsoClass,
    RecordSpec,
    limits_of_class,
    no_word,
)
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.iso1328 import FlankTolerances
from tol3d.scene.bases import Length, scaled_law
from tol3d.scene.entry import Entry
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.statistics.distributions import Distribution, Normal, StatedDistribution, Uniform
from tol3d.statistics.distributions.base import Stays
from tol3d.statistics.distributions.drawn import restated
from tol3d.strict import Strict, refused
from tol3d.study.system.draw import Draw, Each, Scalar
from tol3d.units import Of, Quantity, refuse_dimension

FORM_SHARE: Final = 0.95
"""Fraction of the length of roll from control to tip diameter in which the form of a profile counts."""

AT_END: Final = 1e-6  # mm; of a diameter or a height that is written with some digits: so far beyond is at the end

Range = Annotated[tuple[Annotated[Quantity, Of("length")], ...], listed("lengths", 2, 2)]


@dataclass(frozen=True)
class Part:
    """A part of a flank, along the profile or along the face.

    Args:
        begin, end: of it [rad of roll, or mm].
        least, most: of the whole flank.
    """

    begin: float
    end: float
    least: float
    most: float

    @property
    def slope(self) -> tuple[float, float]:
        """Coefficients of 1 and u over the whole flank that give u over this part, -1/2 and 1/2 at its ends."""
        length = self.end - self.begin
        return (self.least + self.most - self.begin - self.end) / (2 * length), (self.most - self.least) / length

    @property
    def barrel(self) -> tuple[float, float, float]:
        """Coefficients of 1, u and 1/3 - 4 u^2 over the whole flank that give 1/3 - 4 u^2 over this part."""
        level, times = self.slope
        return (1 - times**2) / 3 - 4 * level**2, -8 * times * level, times**2


def profile_part(diameters: Range | None, gear: CylindricalGear, active_roll: float, share: float) -> Part:
    """The part of a profile between two diameters; or a share of that from the active profile's begin to the tip.

    Raises:
        GeometryError: the diameters do not lie on the involute, the first below the second.
    """
    least, most = gear.form_roll, gear.tip_roll
    if diameters is None:
        return Part(active_roll, active_roll + share * (most - active_roll), least, most)
    inner, outer = (diameter.internal for diameter in diameters)
    ends = (2 * gear.form_radius, 2 * gear.tip_radius)[:: gear.iso_sign]
    if not ends[0] - AT_END <= inner < outer <= ends[1] + AT_END:
        first, last = ("where the involute begins", "its tip")[:: gear.iso_sign]
        raise GeometryError(
            f"range: expected two diameters from {ends[0]:.4f} mm, {first}, to {ends[1]:.4f} mm, {last}, "
            f"got {inner:g} mm and {outer:g} mm"
        )
    begin, end = (gear.roll_at(min(max(own, ends[0]), ends[1]) / 2) for own in (inner, outer)[:: gear.iso_sign])
    return Part(begin, end, least, most)


def face_part(heights: Range | None, gear: CylindricalGear) -> Part:
    """The part of a face between two heights over its lower end, or the whole face [mm].

    Raises:
        GeometryError: the heights do not lie on the face, the first below the second.
    """
    half = gear.face_width / 2
    if heights is None:
        return Part(-half, half, -half, half)
    lower, upper = (height.internal for height in heights)
    if not -AT_END <= lower < upper <= 2 * half + AT_END:
        raise GeometryError(
            f"range: expected two heights from 0 mm, the lower end of the face, to {2 * half:g} mm, its upper end, got "
            f"{lower:g} mm and {upper:g} mm"
        )
    return Part(lower - half, upper - half, -half, half)


Lengths = Annotated[tuple[Annotated[Quantity, Of("length")], ...], listed("lengths", 1)]


class ShapeLimitsSpec(Strict):
    """The largest size of a deviation, by a class or as it is."""

    iso_class: IsoClass | None = Field(default=None, description="flank tolerance class of ISO 1328-1:2013, 1 to 11")
    size: Length | None = Field(default=None, description="the largest size of a deviation")

    @model_validator(mode="after")
    def _refuse_both(self) -> Self:
        if (self.iso_class is None) == (self.size is None):
            raise refused("", "either iso_class or size", "neither" if self.size is None else "both")
        return self


class UniformShapeSpec(Strict):
    """All deviations within the limits are equally likely."""

    kind: Literal["uniform"]


class NormalShapeSpec(Strict):
    """Normal about no deviation, 3 cpk sigma at the limits, which draws may exceed."""

    kind: Literal["normal"]
    cpk: float = Field(gt=0.0, description="how far the process fills the limits, as ISO 22514-2 has it")


class StatedShapeSpec(Strict):
    """A stated law; no limits beside it."""

    kind: Literal["stated"]
    distribution: StatedDistribution = Field(description="the law of one flank's deviation, a length")

    @model_validator(mode="after")
    def _refuse_other_dimensions(self) -> Self:
        for field, quantity in self.distribution.quantities().items():
            refuse_dimension(quantity, ("length",), f"distribution.{field}")
        return self


class GivenShapeSpec(Strict):
    """Deviations of a gear that was measured, from tooth 0 on, in every trial the same."""

    kind: Literal["given"]
    right: Lengths | None = Field(default=None, description="of the right flanks, or of whole teeth")
    left: Lengths | None = Field(default=None, description="of the left flanks")


ShapeLaw = Annotated[
    UniformShapeSpec | NormalShapeSpec | StatedShapeSpec | GivenShapeSpec | RecordSpec,
    Field(
        discriminator="kind",
        description="how deviations fill the limits: uniform or normal; or stated, given, or measured in a record",
    ),
    no_word("a law such as {kind: uniform}"),
]


class FlankShapeSpec(FlankToleranceSpec):
    """A deviation of the shape of single flanks of a spur or helical gear.

    Of a helical gear it is stated in the transverse section, along the tangent of the base circle.
    """

    each: Literal["tooth", "gear"] = Field(
        description="tooth: every tooth has a deviation of its own; gear: all teeth of the gear have the same"
    )
    limits: Annotated[ShapeLimitsSpec, no_word("limits such as {iso_class: 7}")] | None = Field(
        default=None, description="of a law that is uniform or normal"
    )
    law: ShapeLaw

    @model_validator(mode="after")
    def _refuse_misfits(self) -> Self:
        fills = isinstance(self.law, UniformShapeSpec | NormalShapeSpec)
        if fills and self.limits is None:
            raise refused("limits", "limits such as {iso_class: 7}, which the law fills", "none")
        if not fills and self.limits is not None:
            raise refused("limits", f"none beside a law that is {self.law.kind}", "limits")
        if isinstance(self.law, GivenShapeSpec):
            wanted = {"right": ["right"], "left": ["left"], "each": ["right", "left"], "together": ["right"]}
            given = [side for side in ("right", "left") if getattr(self.law, side) is not None]
            if given != wanted[self.flanks]:
                expected = f"{' and '.join(wanted[self.flanks])} for flanks {self.flanks}"
                raise refused("law", expected, " and ".join(given) or "none")
        return self

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Those that its law reads."""
        if isinstance(self.law, RecordSpec):
            yield from self.law.file_names()
        if isinstance(self.law, StatedShapeSpec):
            yield from ((("law", "distribution", field), name) for field, name in self.law.distribution.file_names())

    @override
    def in_numbers(self, draw: Any) -> Self:
        if self.limits is None or self.limits.iso_class is None:
            return self
        return self.model_copy(update={"limits": ShapeLimitsSpec(size=OF_CLASSES.like(draw.distribution.high))})

    @override
    def with_law(self, law: Distribution) -> Self:
        if not isinstance(self.law, StatedShapeSpec):
            return super().with_law(law)
        stated = self.law.model_copy(update={"distribution": restated(self.law.distribution, law)})
        return self.model_copy(update={"law": stated})

    def scaled(self, factor: float, stays: Stays, files: Files) -> Self:
        """See ToleranceEntry: the limit, or the stated law."""
        if isinstance(self.law, StatedShapeSpec):
            law = self.law.model_copy(update={"distribution": scaled_law(self.law.distribution, factor, stays, files)})
            return self.model_copy(update={"law": law})
        if stays != "middle" or self.limits is None or self.limits.size is None:
            raise InputError("expected a limit that is a length, size")
        size = self.limits.size.like(factor * self.limits.size.internal)
        return self.model_copy(update={"limits": self.limits.model_copy(update={"size": size})})

    @abstractmethod
    def of_class(self, limits: FlankTolerances) -> float:
        """The limit that a class states for this deviation [mm]."""

    def _names(self, gear: CylindricalGear) -> tuple[str, ...]:
        return tooth_names(gear.teeth, self.sides) if self.each == "tooth" else self.sides

    @override
    def draw(self, gear: CylindricalGear, files: Files) -> Draw:
        names = self._names(gear)
        if isinstance(self.law, GivenShapeSpec):
            return self._given(self.law, names)
        if isinstance(self.law, RecordSpec):
            return self._measured(self.law, gear.teeth, files)
        law = self._distribution(gear, files)
        return Scalar(law) if names == ("",) else Each(law, names)

    def _distribution(self, gear: CylindricalGear, files: Files) -> Distribution:
        if isinstance(self.law, StatedShapeSpec):
            return self.law.distribution.resolve(files)
        if self.limits is None:
            raise TypeError("a law that fills limits has some")
        size = self.limits.size.internal if self.limits.size else 0.0
        if self.limits.iso_class:
            size = self.of_class(limits_of_class(self.limits.iso_class, gear))
        if isinstance(self.law, NormalShapeSpec):
            return Normal(0.0, size / (3 * self.law.cpk), (-size, size))
        return Uniform(-size, size)

    def _given(self, law: GivenShapeSpec, names: tuple[str, ...]) -> GivenDraw:
        found: list[float] = []
        count = len(names) // len(self.sides)
        for side in self.sides:
            lengths = getattr(law, side or "right")
            if len(lengths) != count:
                raise GeometryError(f"law.{side or 'right'}: expected {count} lengths, got {len(lengths)}")
            found += [length.internal for length in lengths]
        return GivenDraw(names, tuple(found))

    def _measured(self, law: RecordSpec, teeth: int, files: Files) -> GivenDraw:
        """Measured values of each tooth, or their mean for all teeth."""
        found: list[float] = []
        for values in law.record(teeth, files).measured(self.sides, gaps=self.each == "gear").values():
            own = [value for value in values if value is not None]
            if self.each == "gear":
                found.append(math.fsum(own) / len(own))
            else:
                found += [own[law.placed(tooth, teeth)] for tooth in range(teeth)]
        names = tooth_names(teeth, self.sides) if self.each == "tooth" else self.sides
        return GivenDraw(names, tuple(found), f"measured in {law.file}")

    def places(self, gear: CylindricalGear) -> tuple[tuple[Place, ...], ...]:
        """The flanks that each of its components moves, by cos(beta_b) of it along their normals."""
        teeth, cosine = range(gear.teeth), gear.base_helix_cosine
        groups = [[tooth] for tooth in teeth] if self.each == "tooth" else [list(teeth)]
        return tuple(
            tuple(Place(tooth, flank, cosine) for tooth in group for flank in self.flanks_of(side))
            for side in self.sides
            for group in groups
        )


class ProfileSlopeSpec(FlankShapeSpec):
    """f_Halpha, a length: offset of the flank at its tip less that at the start of its active profile.

    Positive adds material at the tip. Linear in the roll over the whole involute, 0 in the middle between both, or of a
    range that is stated.
    """

    kind: Literal["profile_slope"]
    range: Range | None = Field(
        default=None, description="diameters it counts between; by default from the active profile's begin to the tip"
    )

    @override
    def of_class(self, limits: FlankTolerances) -> float:
        return limits.profile_slope

    @override
    def effect(self, gear: CylindricalGear, active_roll: float) -> FlankDeviation:
        mix = profile_part(self.range, gear, active_roll, 1.0).slope
        return FlankDeviation(self.of, SLOPE, self.places(gear), mix=mix)


class ProfileFormSpec(FlankShapeSpec):
    """f_falpha, a length from peak to valley of a stated shape over the whole involute; negative turns it inside out.

    With u from -1/2 to 1/2 over the evaluation range, in the roll: a barrel is 1/3 - 4 u^2 of it, waves are
    cos(2 pi waves u)/2. Both go on beyond the range. Of spur gears only: contact lines of helical ones run across the
    profile, along which forms were not derived.
    """

    applies_to: ClassVar[tuple[type[Entry], ...]] = (SpurGearSpec,)

    kind: Literal["profile_form"]
    shape: Literal["barrel", "wave"] = Field(description="a barrel, or cosine waves")
    waves: int | None = Field(default=None, ge=1, le=20, description="of a wave: how many there are over the range")
    range: Range | None = Field(
        default=None,
        description="diameters it counts between; by default from the active begin 95 % of the way to the tip",
    )

    @model_validator(mode="after")
    def _refuse_stray_waves(self) -> Self:
        if (self.shape == "wave") != (self.waves is not None):
            expected, got = ("a number of waves", "none") if self.shape == "wave" else ("none of a barrel", "waves")
            raise refused("waves", expected, got)
        return self

    @override
    def of_class(self, limits: FlankTolerances) -> float:
        return limits.profile_form

    @override
    def effect(self, gear: CylindricalGear, active_roll: float) -> FlankDeviation:
        part, places = profile_part(self.range, gear, active_roll, FORM_SHARE), self.places(gear)
        if self.waves is None:
            return FlankDeviation(self.of, FORM, places, mix=part.barrel)
        return FlankDeviation(self.of, FORM, places, float(self.waves), span=(part.begin, part.end))


class HelixSlopeSpec(FlankShapeSpec):
    """f_Hbeta, a length: offset of the flank at the upper end of its face less that at the lower end.

    Positive adds material at the upper end. Linear in the gear's z over the whole face width, 0 in its middle, or in
    that of a range that is stated.
    """

    kind: Literal["helix_slope"]
    range: Range | None = Field(
        default=None, description="heights over the lower end of the face it counts between; by default the whole face"
    )

    @override
    def of_class(self, limits: FlankTolerances) -> float:
        return limits.helix_slope

    @override
    def effect(self, gear: CylindricalGear, active_roll: float) -> FlankDeviation:
        level, times = face_part(self.range, gear).slope
        return FlankDeviation(self.of, HELIX, self.places(gear), mix=(level, 0.0, 0.0, times))
