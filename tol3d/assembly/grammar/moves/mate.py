"""A part that is mated: relations in order, each takes the freedoms that are left."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.moves.placing_move import PairSpec, PlacingSpec
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.strict import refused
from tol3d.units import Of, Quantity


class RelationSpec(PairSpec):
    """What one feature is to the other."""

    kind: Literal["coincident", "coaxial", "tangent", "distance"]
    distance: Annotated[Quantity, Of("length")] | None = Field(
        default=None, description="along the target's normal, for kind: distance"
    )

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if self.kind == "distance" and self.distance is None:
            raise refused("distance", "a length, such as 2 mm", "none")
        if self.kind != "distance" and self.distance is not None:
            raise refused("distance", f"none for {self.kind}", self.distance)
        return self


class MateSpec(PlacingSpec):
    """Relations in order; no contact is checked."""

    words: ClassVar[str] = "a mate"

    kind: Literal["mate"]
    relations: Annotated[tuple[RelationSpec, ...], listed("relations", 1, 6)]

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        """See PlacingSpec."""
        return ((("relations", k), pair) for k, pair in enumerate(self.relations))
