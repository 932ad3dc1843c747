"""Which face of its part's solid a feature is."""

from typing import Literal, Self

from pydantic import Field, model_validator

from tol3d.scene.name import Name
from tol3d.scene.vector import Vector
from tol3d.strict import Strict, refused

FaceKind = Literal["plane", "cylinder", "cone", "sphere"]


class FaceSpec(Strict):
    """A face by its name, or the nearest one to a point."""

    name: Name | None = Field(default=None, description="of the face, as the builder has it")
    near: Vector | None = Field(
        default=None, description="a point in the frame of the part that no other such face is as near to"
    )
    kind: FaceKind | None = Field(default=None, description="what it is; whatever the feature may be if not given")

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if (self.name is None) == (self.near is None):
            raise refused("", "either a name or a point `near` it", "neither" if self.name is None else "both")
        return self
