"""Vocabulary of springs in scenes."""

from collections.abc import Iterator, Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.scene.bases import Length, LengthLimit, MeasureSpec, MoveSpec, PartSpec, Take, ToleranceSpec
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name
from tol3d.scene.options import StudyOptions
from tol3d.scene.place import KeyPath
from tol3d.scene.published import PublishedFigures
from tol3d.scene.published.figures import Percent
from tol3d.scene.schema import Scene
from tol3d.strict import Strict
from tol3d.units import Dimension, Of, Quantity


class PublishedTerm(Strict):
    """Published figures of a term."""

    mean: Annotated[Quantity, Of("length")] | None = None
    sigma: Length | None = None
    share_percent: Percent | None = None


class PublishedTerms(PublishedFigures):
    """Published figures of the terms of heights."""

    terms: Mapping[Name, Mapping[Name, PublishedTerm]] = Field(default_factory=dict, description="measure, term")

    def problems(self, scene: Scene) -> Iterator[tuple[KeyPath, str]]:
        for name in self.terms:
            if name not in scene.of(HeightSpec):
                yield ("terms", name), f"expected the name of a height, got {name!r}"


class SpringSpec(PartSpec):
    """A spring; its characteristic a [1], b [1/mm], q [1/mm] in a file."""

    words: ClassVar[str] = "a spring"

    kind: Literal["spring"]
    length: Length
    characteristic: str = Field(description="CSV file")

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        yield ("characteristic",), self.characteristic


class SpringToleranceSpec(ToleranceSpec):
    """A tolerance of a spring."""

    of: Name

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("of",), self.of, (SpringSpec,)),)


class AbscissaSpec(SpringToleranceSpec):
    """x: lifts by a x + b x^2."""

    kind: Literal["abscissa"]


class OffsetSpec(SpringToleranceSpec):
    """Lifts by itself; by 5 % more, which the theory leaves out."""

    kind: Literal["offset"]


class RippleSpec(SpringToleranceSpec):
    """Each coil's own: the sum t, weighted, lifts by t + q t^2."""

    kind: Literal["ripple"]
    each: Literal["coil"] = "coil"
    coils: int = Field(default=40, ge=1)


class WaveSpec(SpringToleranceSpec):
    """w: lifts by w sin of the position."""

    kind: Literal["wave"]


class LiftSpec(MoveSpec):
    """A spring lifts."""

    words: ClassVar[str] = "a lift"

    kind: Literal["lift"]
    spring: Name

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("spring",), self.spring, (SpringSpec,)),)


class LiftMeasureSpec(MeasureSpec):
    """A measure of a lift."""

    dimension: ClassVar[Dimension] = "length"

    lower_limit: LengthLimit | None = None
    upper_limit: LengthLimit | None = None

    @property
    def gives_curve(self) -> bool:
        return False

    @property
    def several_positions(self) -> bool:
        return False

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("of",), self.of, (LiftSpec,)),)


class HeightSpec(LiftMeasureSpec):
    """Lift of the spring: at rest, at a random position, or over a turn."""

    kind: Literal["height"]
    at: Literal["rest", "random", "turn"] = "rest"
    take: Take = "value"
    orders: tuple[int, ...] = Field(default=(), strict=False, description="harmonics of a curve")

    @property
    def gives_curve(self) -> bool:
        return self.take == "curve"

    @property
    def several_positions(self) -> bool:
        return self.at == "turn"


class RoomSpec(LiftMeasureSpec):
    """Rest of a room that the spring lifts into; less than nothing is too long."""

    kind: Literal["room"]
    room: Annotated[Quantity, Of("length")]
    lost_beyond: Length = Field(description="|x| of which nothing is known")


class SpringOptions(StudyOptions):
    """Fineness of the chords that measure."""

    knots: int = Field(default=120, ge=2)
