"""The shaft of a ball screw.

A socket for a ball.

A cast link of an arm.

A nut with an ear in which a ball sits.

A rod between two balls.

A ring with ears in which balls sit.

A ring-involute spherical gear.
"""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import Field
from typing_extensions import override

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.assembly.grammar.feature_name import OwnName
from tol3d.cad.solids.numbered_parts import BallScrew, BallSocket, CastLink, Nut, Rod, SphericalGear, ThrustRing
from tol3d.parts.link_ends import Cylinder, Distal, Proximal
from tol3d.scene.bases import Length
from tol3d.scene.vector import Coordinate, Direction, Vector
from tol3d.strict import Strict
from tol3d.units import Of, Quantity


class JournalSpec(Strict):
    """An end that is turned down."""

    diameter: Length = Field(description="of the journal")
    length: Length = Field(description="along z")


class BallScrewSpec(BuilderSpec):
    """A shaft along z without its groove; its part's origin is the middle of its bottom."""

    words: ClassVar[str] = "a ball screw"

    kind: Literal["ball_screw"]
    diameter: Length = Field(description="of the thread")
    length: Length = Field(description="from end to end, along z")
    journal: JournalSpec | None = Field(default=None, description="at either end; default: none")

    @property
    @override
    def shape(self) -> BallScrew:
        journal = None if self.journal is None else (self.journal.diameter.internal, self.journal.length.internal)
        return BallScrew(self.diameter.internal, self.length.internal, journal)


class BallSocketSpec(BuilderSpec):
    """A round housing along z that opens to +z; its part's origin is the centre of its seat."""

    words: ClassVar[str] = "a socket"

    kind: Literal["ball_socket"]
    ball_diameter: Length = Field(description="of the seat")
    mouth: Length | None = Field(
        default=None, description="diameter of the opening; default: as wide as the ball, a hemisphere"
    )
    diameter: Length = Field(description="outside")
    height: Length = Field(description="from the bottom to the centre of the seat, along z")

    @property
    @override
    def shape(self) -> BallSocket:
        mouth = self.ball_diameter if self.mouth is None else self.mouth
        return BallSocket(self.ball_diameter.internal, mouth.internal, self.diameter.internal, self.height.internal)


class RoundSpec(Strict):
    """A pilot or a bore, half of its length on either side of its joint's frame."""

    diameter: Length = Field(description="of the cylinder")
    length: Length = Field(description="from end to end")

    @property
    def cylinder(self) -> Cylinder:
        """By its numbers."""
        return Cylinder(self.diameter.internal, self.length.internal)


class ProximalSpec(Strict):
    """The end of a link that lies on the joint before, a drum about z."""

    level: Coordinate | None = Field(default=None, description="z of its seat, which looks to -z; default: 0 mm")
    diameter: Length = Field(description="of the drum and its seat")
    height: Length = Field(description="of the drum, along z")
    pilot: RoundSpec | None = Field(default=None, description="that centres it, in the seat; default: none")
    hole: Length | None = Field(default=None, description="diameter of an opening in the middle; default: none")


class DistalSpec(Strict):
    """The end of a link that holds the joint after, a drum about that joint's axis."""

    at: Vector = Field(description="the joint's place, in the frame of the part")
    axis: Direction = Field(description="of the joint, out of the drum")
    diameter: Length = Field(description="of the drum")
    depth: Length = Field(description="of the drum, from the joint's place backwards")
    bore: RoundSpec | None = Field(default=None, description="of the joint; default: a flat flange")


class CastLinkSpec(BuilderSpec):
    """A hollow link between the frames of two joints, of which that of the one before is its part's origin."""

    words: ClassVar[str] = "a cast link"

    kind: Literal["cast_link"]
    proximal: ProximalSpec = Field(description="the end on the joint before")
    distal: DistalSpec = Field(description="the end that holds the joint after")
    wall: Length = Field(description="thickness of all walls")
    body: Length | None = Field(
        default=None, description="diameter of the tube between both ends; default: as large as they let it be"
    )

    @property
    @override
    def shape(self) -> CastLink:
        near, far = self.proximal, self.distal
        x, y, z = (own.internal for own in far.at)
        return CastLink(
            Proximal(
                near.diameter.internal,
                near.height.internal,
                0.0 if near.level is None else near.level.internal,
                None if near.pilot is None else near.pilot.cylinder,
                0.0 if near.hole is None else near.hole.internal,
            ),
            Distal(
                (x, y, z),
                far.axis,
                far.diameter.internal,
                far.depth.internal,
                None if far.bore is None else far.bore.cylinder,
            ),
            self.wall.internal,
            None if self.body is None else self.body.internal,
        )


class NutSpec(BuilderSpec):
    """A cylinder along z with an ear at +x; its part's origin is the middle of its bottom."""

    words: ClassVar[str] = "a nut"

    kind: Literal["nut"]
    diameter: Length = Field(description="outside")
    length: Length = Field(description="along z")
    bore: Length = Field(description="diameter; the thread is not cut")
    reach: Length = Field(description="from the axis to the centre of the seat, which is in the top of the ear")
    ear_width: Length = Field(description="along y")
    ball_diameter: Length = Field(description="of the seat")

    @property
    @override
    def shape(self) -> Nut:
        return Nut(
            self.diameter.internal,
            self.length.internal,
            self.bore.internal,
            self.reach.internal,
            self.ear_width.internal,
            self.ball_diameter.internal,
        )


class RodSpec(BuilderSpec):
    """A round rod along z; its part's origin is the centre of its bottom ball."""

    words: ClassVar[str] = "a rod"

    kind: Literal["rod"]
    length: Length = Field(description="between the centres of both balls, along z")
    diameter: Length = Field(description="of the rod")
    ball_diameter: Length = Field(description="of both balls")

    @property
    @override
    def shape(self) -> Rod:
        return Rod(self.length.internal, self.diameter.internal, self.ball_diameter.internal)


class EarSpec(Strict):
    """An ear with a seat in its bottom."""

    angle: Annotated[Quantity, Of("angle")] = Field(description="of its middle, from +x towards +y")


class ThrustRingSpec(BuilderSpec):
    """A ring about z; its part's origin is the middle of its bottom, in whose plane the balls' centres lie."""

    words: ClassVar[str] = "a thrust ring"

    kind: Literal["thrust_ring"]
    inner_diameter: Length = Field(description="of its bore")
    outer_diameter: Length = Field(description="without the ears")
    thickness: Length = Field(description="along z, of the ears as well")
    radius: Length = Field(description="of the circle on which the centres of the seats lie")
    ear_width: Length = Field(description="of all ears")
    ball_diameter: Length = Field(description="of all seats")
    ears: Mapping[OwnName, EarSpec] = Field(min_length=1, description="by name, all alike")

    @property
    @override
    def shape(self) -> ThrustRing:
        return ThrustRing(
            self.inner_diameter.internal,
            self.outer_diameter.internal,
            self.thickness.internal,
            self.radius.internal,
            self.ear_width.internal,
            self.ball_diameter.internal,
            tuple((name, ear.angle.internal) for name, ear in self.ears.items()),
        )


Angle = Annotated[Quantity, Of("angle")]
USUAL_PRESSURE_ANGLE = math.radians(20)


class BlindBoreSpec(Strict):
    """A hole from the bottom along z."""

    diameter: Length = Field(description="of the bore")
    depth: Length = Field(description="from the bottom")


class SphericalGearSpec(BuilderSpec):
    """The profile of a spur gear turned about its pole at +z; its part's origin is its centre."""

    words: ClassVar[str] = "a spherical gear"

    kind: Literal["spherical_gear"]
    teeth: int = Field(ge=3, description="of the spur gear; half of them would be rings all the way round")
    module: Length = Field(description="by which the pitch sphere has a diameter of module times teeth")
    pole: Literal["tooth", "space"] = Field(description="what is at the pole; two gears mesh if it differs")
    reach: Angle = Field(description="from the pole to the edge of its flat bottom; what rings end before it are there")
    pressure_angle: Angle | None = Field(default=None, description="default: 20 deg")
    thinned: Length | None = Field(
        default=None,
        description="by how much a tooth is thinner than half the pitch, on the pitch sphere; default: not at all",
    )
    bore: BlindBoreSpec | None = Field(default=None, description="default: none")

    @property
    @override
    def shape(self) -> SphericalGear:
        return SphericalGear(
            self.teeth,
            self.module.internal,
            USUAL_PRESSURE_ANGLE if self.pressure_angle is None else self.pressure_angle.internal,
            self.reach.internal,
            self.pole == "tooth",
            0.0 if self.thinned is None else self.thinned.internal,
            None if self.bore is None else (self.bore.diameter.internal, self.bore.depth.internal),
        )
