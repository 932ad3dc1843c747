"""What measures of an RV reducer have in common."""

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from tol3d.cycloid.grammar.moves.rv_reducer import RVReducerSpec
from tol3d.scene.direction import FixedAngle, known_word, shape
from tol3d.scene.measure import AngleSpec, MeasureSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference

Over = Annotated[
    Annotated[Literal["random", "turn"], Tag("word")] | FixedAngle, Discriminator(shape), known_word("random", "turn")
]


Reducer = Annotated[Name, Field(description="the RV reducer")]


class CycloidMeasureSpec(MeasureSpec):
    """What is read of one."""

    of: Reducer

    def references(self) -> tuple[Reference, ...]:
        """The reducer."""
        return (Reference(("of",), self.of, (RVReducerSpec,)),)


class OutputAngleSpec(AngleSpec, CycloidMeasureSpec):
    """An angle of the output."""

    of: Reducer
