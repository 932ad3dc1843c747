"""Joints of a loop: the features that each keeps together, and its play."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.assembly.grammar.feature_name import FeatureName, part_of
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction
from tol3d.statistics.distributions import StatedDistribution
from tol3d.strict import Strict, refused
from tol3d.units import Of, Positive, Quantity, refuse_dimension

Length = Annotated[Quantity, Of("length"), Positive()]
AXES = ("axis", "cylinder")


class CentredFloatSpec(Strict):
    """Float in the middle of the clearance."""

    kind: Literal["centred"]


class RandomFloatSpec(Strict):
    """Anywhere in the clearance, anew in each trial."""

    kind: Literal["random"]


class TowardFloatSpec(Strict):
    """Float at the end of the clearance."""

    kind: Literal["toward"]
    along: Direction = Field(description="direction of the part after, in the frame of the joint's first feature")


BallFloat = Annotated[CentredFloatSpec | RandomFloatSpec | TowardFloatSpec, Field(discriminator="kind")]
AxisFloat = Annotated[CentredFloatSpec | RandomFloatSpec, Field(discriminator="kind")]


class ClearanceSpec(Strict):
    """Room between a ball and its socket."""

    words: ClassVar[str] = "a clearance"

    diameter: Annotated[Quantity, Of("length")] = Field(description="nominal diametral clearance in the socket")
    distribution: StatedDistribution | None = Field(default=None, description="the law of its deviation")
    floating: BallFloat = Field(alias="float", description="position of the part after in it")

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        _refuse_unfit(self.diameter, self.distribution)
        return self


class PlaySpec(Strict):
    """Room between a pin and its bore: both ends lie anywhere in it."""

    words: ClassVar[str] = "a play"

    diameter: Annotated[Quantity, Of("length")] = Field(description="nominal diametral clearance in the bore")
    length: Length = Field(description="between the two ends, evenly about the middle of the joint's first feature")
    distribution: StatedDistribution | None = Field(default=None, description="the law of the diameter's deviation")
    floating: AxisFloat = Field(alias="float", description="position of the part after in it")

    @model_validator(mode="after")
    def _refuse_nonsense(self) -> Self:
        _refuse_unfit(self.diameter, self.distribution)
        return self


def _refuse_unfit(diameter: Quantity, law: StatedDistribution | None) -> None:
    if diameter.internal < 0.0:
        raise refused("diameter", "a clearance of 0 or more", str(diameter))
    for field, quantity in law.quantities().items() if law is not None else ():
        refuse_dimension(quantity, ("length",), f"distribution.{field}")


class JointSpec(Strict):
    """Two features that are kept together."""

    words: ClassVar[str] = "a joint"
    feature_kinds: ClassVar[tuple[str, ...]] = ()

    between: Annotated[tuple[FeatureName, ...], listed("features", 2, 2)] = Field(
        description="of the part before and of the part after; as they are `placed` its inputs are 0"
    )

    @property
    def room(self) -> ClearanceSpec | PlaySpec | None:
        """Its play, if it has any."""
        return None

    @property
    def features(self) -> Iterator[tuple[KeyPath, FeatureName]]:
        """All that it names, with their fields."""
        return ((("between", k), name) for k, name in enumerate(self.between))

    @model_validator(mode="after")
    def _refuse_one_part(self) -> Self:
        first, last = (part_of(name) for name in self.between)
        if first == last:
            raise refused("between", "features of two parts", f"two of {first!r}")
        return self


class BallSpec(JointSpec):
    """Two points that are one; all turns are free."""

    kind: Literal["ball"]
    clearance: ClearanceSpec | None = Field(default=None, description="between ball and socket; default: none")

    @property
    @override
    def room(self) -> ClearanceSpec | None:
        return self.clearance


class _AxialSpec(JointSpec):
    """Two axes on one line."""

    feature_kinds: ClassVar[tuple[str, ...]] = AXES

    play: PlaySpec | None = Field(default=None, description="between pin and bore; default: none")

    @property
    @override
    def room(self) -> PlaySpec | None:
        return self.play


class RevoluteSpec(_AxialSpec):
    """The part after turns about the axis; it does not go along it."""

    kind: Literal["revolute"]


class PrismaticSpec(_AxialSpec):
    """The part after goes along the axis; it does not turn."""

    kind: Literal["prismatic"]


class CylindricalSpec(_AxialSpec):
    """The part after goes along the axis and turns about it."""

    kind: Literal["cylindrical"]


class ScrewSpec(_AxialSpec):
    """The part after goes along the axis as it turns about it."""

    kind: Literal["screw"]
    lead: Annotated[Quantity, Of("length")] = Field(
        description="a turn; positive: counter-clockwise about z of the first axis goes along z"
    )

    @model_validator(mode="after")
    def _refuse_no_lead(self) -> Self:
        if self.lead.internal == 0.0:
            raise refused("lead", "a length other than 0", str(self.lead))
        return self


class UniversalSpec(JointSpec):
    """Two axes that cross at right angles (Cardan's joint): each of the parts turns about its own."""

    kind: Literal["universal"]
    feature_kinds: ClassVar[tuple[str, ...]] = AXES


class SwingSpec(JointSpec):
    """Constant velocity: the part after tilts any way about the middle, without spin about z of the first feature."""

    kind: Literal["swing"]


class RollingSpec(JointSpec):
    """Two spherical gears: the one after tilts (1 + r1 / r2) times as far as its carrier, the same way, no spin."""

    kind: Literal["rolling"]
    feature_kinds: ClassVar[tuple[str, ...]] = ("sphere",)
    carrier: str = Field(description="the part on which the gear after sits, or a feature of it, such as ring.seat")

    @property
    @override
    def features(self) -> Iterator[tuple[KeyPath, FeatureName]]:
        yield from super().features
        if "." in self.carrier:
            yield ("carrier",), self.carrier


JointUnion = Annotated[
    BallSpec | RevoluteSpec | PrismaticSpec | CylindricalSpec | ScrewSpec | UniversalSpec | SwingSpec | RollingSpec,
    Field(discriminator="kind"),
]
