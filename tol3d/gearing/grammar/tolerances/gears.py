"""Tolerances of a gear as a whole, and of its seat on the shaft."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Discriminator, Field, Tag, field_validator, model_validator
from typing_extensions import override

from tol3d.errors import InputError
from tol3d.gearing.effects import AxisOffset, Clocking, Plane, ToothThickness, TurningOffset
from tol3d.gearing.grammar.cylindrical import CylindricalSpec, cylindrical_gear_of
from tol3d.gearing.grammar.parts import (
    ExternalGearSpec,
    GearSpec,
    InternalGearSpec,
    ShaftSpec,
    helix_of,
)
from tol3d.gearing.grammar.tolerances.gearing_tolerance import (
    GearToleranceSpec,
    Meaning,
    Nominal,
    Unit,
    in_direction,
    together,
)
from tol3d.gears import Gear, InternalGear
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.tooth_measures import OverBalls, OverPins, PinScale, Span, ToothMeasure
from tol3d.scene.bases import Length, MoveSpec, PartSpec
from tol3d.scene.direction import RandomOrFixed
from tol3d.scene.entry import Entry
from tol3d.scene.name import Name
from tol3d.statistics.distributions.derived import Scale
from tol3d.statistics.distributions.size_limits import sizes_written
from tol3d.statistics.distributions.unsized import SIZE, UnsizedSpec
from tol3d.strict import Strict, refused
from tol3d.units import Dimension, Quantity


class AlongAxisSpec(GearToleranceSpec):
    """A deviation that moves a gear along its axis, or a shaft with every gear on it."""

    applies_to: ClassVar[tuple[type[Entry], ...]] = (GearSpec, ShaftSpec)

    of: Name = Field(description="the gear, or the shaft with every gear on it")

    @property
    def along(self) -> float:
        """Shift along the gear's or shaft's own +z per deviation."""
        return 1.0

    def meaning(self, nominal: Nominal) -> Meaning:
        """The gear, or each on the shaft, moves along its axis: one that faces backward against its own z."""
        if not isinstance(nominal.scene.parts[self.of], ShaftSpec):
            return Meaning(AxisOffset(self.of, (0.0, 0.0, 1.0), factor=self.along))
        own = nominal.carried_by(self.of)
        return Meaning(together([AxisOffset(g.gear, (0.0, 0.0, float(g.sense)), factor=self.along) for g in own]))


class AxialShiftSpec(AlongAxisSpec):
    """A length along the gear's own +z, or the shaft's.

    It moves no flank of a spur pair with parallel axes; tilted ones feel it. Helical gears open nothing either, they
    screw: their mates turn by tan(beta)/r of it.
    """

    kind: Literal["axial_shift"]


class MountingFaceSpec(AlongAxisSpec):
    """Delta P, a length: the face lies off its true place, and the gear with it along its own +z, or the shaft.

    Each face of the stack (the gear's back, the housing's seat, an end cover) is a contributor of its own.
    """

    kind: Literal["mounting_face"]


class ShimSpec(AlongAxisSpec):
    """The thickness of a shim, a length: constant, or with its own tolerance; behind a gear, or a shaft."""

    kind: Literal["shim"]
    side: Literal["behind", "in_front"] = Field(
        default="behind",
        description="behind the gear it moves it along its own -z, of a bevel gear towards the apex, which closes; "
        "in_front the other way",
    )

    @property
    def along(self) -> float:
        """Behind the gear or shaft it moves it backward."""
        return -1.0 if self.side == "behind" else 1.0

    def meaning(self, nominal: Nominal) -> Meaning:
        """No shim is thinner than nothing."""
        return replace(super().meaning(nominal), least=0.0)


class ClockingSpec(GearToleranceSpec):
    """An angle: the gear is turned on its shaft, positive counter-clockwise about its own z.

    It does not change one mesh's backlash. Where parallel load paths join, it shifts the play of one against that of
    the others.
    """

    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)

    kind: Literal["clocking"]

    def meaning(self, nominal: Nominal) -> Meaning:
        """The gear turns on its shaft."""
        return Meaning(Clocking(self.of))

    @property
    def unit(self) -> Unit:
        """Arc minutes, as backlash at shafts is read."""
        return "arcmin"


class TeethOffAxisSpec(GearToleranceSpec):
    """Teeth whose centre lies off the rotation axis and turns with the gear."""

    displaces: ClassVar[bool] = True

    direction: RandomOrFixed = Field(
        default="random", description="phi, in the gear's frame (x through the middle of tooth 0)"
    )

    def meaning(self, nominal: Nominal) -> Meaning:
        """The gear's centre lies off its axis."""
        return in_direction([TurningOffset(self.of)], self.direction)


class EccentricitySpec(TeethOffAxisSpec):
    """e, a length: the teeth's centre lies off the rotation axis by e (cos phi, sin phi) and turns with the gear."""

    kind: Literal["eccentricity"]


class RunOutSpec(GearToleranceSpec):
    """S, a length: the shaft displaces the gears that it carries by S (cos phi, sin phi) and turns with them."""

    displaces: ClassVar[bool] = True
    applies_to: ClassVar[tuple[type[Entry], ...]] = (GearSpec, ShaftSpec)

    kind: Literal["run_out"]
    of: Name = Field(description="the gear on the shaft, or the shaft with every gear on it")
    direction: RandomOrFixed = Field(
        default="random", description="phi, in the gear's frame (x through the middle of tooth 0), or in the shaft's"
    )

    def meaning(self, nominal: Nominal) -> Meaning:
        """Displacement of every gear on a shaft alike; the direction is counted on the shaft."""
        if not isinstance(nominal.scene.parts[self.of], ShaftSpec):
            return in_direction([TurningOffset(self.of)], self.direction)
        offsets = [TurningOffset(own.gear, Plane(-own.phase, own.backward)) for own in nominal.carried_by(self.of)]
        return in_direction(offsets, self.direction)


class MeasuredOverSpec(Strict):
    """`{span: 4}`, `{pins: 3.5 mm}` or `{balls: 3.5 mm}`: how teeth of a cylindrical gear are measured.

    Pins and balls of the same diameter give the same size, except over an odd number of helical teeth.
    """

    span: int | None = Field(default=None, ge=1, description="over so many teeth, of a ring over so many spaces")
    pins: Length | None = Field(
        default=None, description="diameter of two pins, over which it is measured, in a ring between them"
    )
    balls: Length | None = Field(default=None, description="diameter of two balls in one transverse plane, likewise")

    @model_validator(mode="after")
    def _refuse_other_than_one(self) -> Self:
        given = [name for name in ("span", "pins", "balls") if getattr(self, name) is not None]
        if len(given) != 1:
            raise refused("", "either a span such as {span: 4}, or {pins: 3.5 mm}", " and ".join(given) or "neither")
        return self

    @property
    def measure(self) -> ToothMeasure:
        """Measure of it on any gear."""
        if self.balls is not None:
            return OverBalls(self.balls.internal)
        return Span(self.span or 0) if self.pins is None else OverPins(self.pins.internal)

    @property
    def key(self) -> str:
        """The word under which it is stated."""
        return next(name for name in ("span", "pins", "balls") if getattr(self, name) is not None)


def _measured_shape(value: object) -> str:
    """The tag of how a thickness is measured, for pydantic's Discriminator."""
    return "word" if isinstance(value, str) else "over"


Measured = Annotated[
    Annotated[Literal["arc", "normal"], Tag("word")] | Annotated[MeasuredOverSpec, Tag("over")],
    Discriminator(_measured_shape),
]


class ToothThicknessSpec(GearToleranceSpec):
    """E_s, a length: positive is thicker, half on each flank.

    `arc` counts it on the reference circle, of a bevel gear in the middle of the face; `normal` along the normals
    of the flanks, which is 1/cos(alpha) as much; `{span: 4}` by the span over so many teeth, which grows by what the
    tooth grows along its normals, and that of a ring, over spaces, shrinks by it; `{pins: 3.5 mm}` by the size over
    two pins or balls, of which the arc of each trial is the exact inverse. A bevel tooth is thinned in
    proportion along its face (the flank is turned), or by the same normal offset everywhere; on a spur gear that is
    the same. `{din_3967: cd25}` as its distribution is the arc's limits of a cylindrical gear; `23.349 / 23.386 mm`
    are limits of the measured size itself, of a span, pins or balls.
    """

    kind: Literal["tooth_thickness"]
    measured: Measured = Field(
        default="arc", description="along the reference circle or the normals, by the span over teeth, or over pins"
    )
    along_face: Literal["proportional", "constant"] = Field(
        default="proportional", description="how a bevel tooth's deviation goes along the face"
    )

    @field_validator("measured", mode="before")
    @classmethod
    def _refuse_other_words(cls, value: object) -> object:
        if isinstance(value, str) and value not in ("arc", "normal"):
            raise refused("", "arc, normal, a span such as {span: 4}, or {pins: 3.5 mm}", value)
        return value

    @override
    def size(self, standard: str, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> float | None:
        gear = parts.get(self.of)
        if standard == SIZE and isinstance(gear, CylindricalSpec):
            drawn = cylindrical_gear_of(gear)
            if isinstance(self.distribution, UnsizedSpec) and self.over is None:
                raise InputError(self._unmeasured(drawn, self.distribution.word))
            return None if self.over is None else self.over.size(drawn)
        if standard != "din_3967" or self.measured != "arc":
            return None
        if not isinstance(gear, ExternalGearSpec | InternalGearSpec):
            return None
        return gear.teeth * gear.module.internal / math.cos(helix_of(gear)[0])

    def _unmeasured(self, gear: CylindricalGear, sizes: str) -> str:
        """Sentence for limits of a size of which nothing says how it is measured, with the span that they are near."""
        one, other = sizes_written(sizes) or (Quantity(0.0, "mm"),) * 2
        span = Span.nearest(gear, (one.internal + other.internal) / 2)
        usual = 1 < span.teeth <= gear.teeth / 4
        own = f"{{span: {span.teeth}}} (nominal {span.size(gear):.4f} mm)" if usual else "{span: …}"
        return (
            f"expected beside limits of a size what is measured, measured: {own}, {{pins: …}} or "
            f"{{balls: …}}, got measured: {self.measured} (limits of a deviation have signs, as in -0.03/-0.06 mm)"
        )

    def meaning(self, nominal: Nominal) -> Meaning:
        """Half the deviation on each flank: an arc s/2 is (s/2) cos(alpha) along the normal, or a turn of s/(2 r)."""
        gear = nominal.mesh_of(self.of).gear(self.of)
        half = 0.5 * self.sign_in(ring=isinstance(gear, InternalGear))
        if self.along_face == "constant":
            cosine = gear.section_arm / gear.thickness_radius
            turn, offset = 0.0, half if self.is_normal else half * cosine
        else:
            turn, offset = half / (gear.section_arm if self.is_normal else gear.thickness_radius), 0.0
        return Meaning(ToothThickness(self.of, turn, offset, self.over), scale=self.scale_of(gear))

    @property
    def over(self) -> ToothMeasure | None:
        """Measured quantity, if it is not a thickness."""
        return self.measured.measure if isinstance(self.measured, MeasuredOverSpec) else None

    @property
    def nominal(self) -> str:
        """See ToleranceEntry: the allowances of the thickness, or what is measured."""
        if isinstance(self.over, Span):
            return "W_k"
        return "E_sns and E_sni" if self.over is None else ""  # over pins: the arc is no multiple of it

    @property
    def is_normal(self) -> bool:
        """True if its size is that along the normals of the flanks."""
        return self.measured == "normal" or isinstance(self.over, Span)

    def sign_in(self, *, ring: bool) -> float:
        """-1 if the measured quantity grows as the teeth get thinner: the span of a ring, over its spaces."""
        return -1.0 if ring and isinstance(self.over, Span) else 1.0

    def scale_of(self, gear: Gear) -> Scale | None:
        """From what is measured to the arc, where the two are not in proportion."""
        over = self.over
        return PinScale(gear, over) if isinstance(over, OverPins) and isinstance(gear, CylindricalGear) else None
