"""A train: what is driven, what is moved by it, and which way it is loaded."""

from collections.abc import Iterator
from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.gearing.grammar.moves.ratio import Ratio
from tol3d.gearing.grammar.parts.shaft_reference import ShaftReference
from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.vector import Direction
from tol3d.strict import refused


class TrainSpec(MoveSpec):
    """A train from the shaft that the motor turns to its output, over the meshes and other links of the scene."""

    words: ClassVar[str] = "a train"

    kind: Literal["train"]
    driven: Name = Field(description="the shaft, or the gear that is its own, that the motor turns")
    output: Name = Field(description="the shaft, or the gear that is its own, at the end")
    held: Name | None = Field(
        default=None, description="the shaft that is held while lost motion is read; the driven one if not given"
    )
    ratio: Ratio | None = Field(
        default=None,
        description="turns of driven per turn of output, checked if given; below zero: they turn opposite ways",
    )
    gravity: Direction | None = Field(
        default=None,
        description="its direction [x, y, z] in the world, the frame of the driven shaft at 0; it loads the arms on "
        "the output",
    )
    turns: Literal["counter_clockwise", "clockwise"] = Field(
        default="counter_clockwise",
        description="the motor's sense about its z, which decides the working flanks where there is no gravity",
    )

    @model_validator(mode="after")
    def _refuse_one_shaft(self) -> Self:
        if self.driven == self.output:
            raise refused("output", "another shaft than the driven one", repr(self.output))
        return self

    def references(self) -> tuple[Reference, ...]:
        """Its shafts."""
        return tuple(self._shafts())

    def _shafts(self) -> Iterator[Reference]:
        for field in ("driven", "output", "held"):
            if (shaft := getattr(self, field)) is not None:
                yield ShaftReference((field,), shaft)
