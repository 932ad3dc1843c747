"""A part that is laid where its points fit best."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.moves.placing_move import PairSpec, PlacingSpec
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction
from tol3d.strict import refused


class FitSpec(PairSpec):
    """Two points that are to coincide."""

    weight: float = Field(default=1.0, gt=0.0, description="of its square, with criterion: squares")
    along: Annotated[tuple[Direction, ...], listed("directions", 1, 3)] = Field(
        default=(), description="directions of the target's part in which it counts; all if not given"
    )


class BestFitSpec(PlacingSpec):
    """Points are brought together as well as may be: least squares, or least largest distance; no scale."""

    words: ClassVar[str] = "a best fit"

    kind: Literal["best_fit"]
    pairs: Annotated[tuple[FitSpec, ...], listed("pairs", 3)]
    criterion: Literal["squares", "minimax"] = Field(default="squares", description="what is made least")

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        weighted = [k for k, pair in enumerate(self.pairs) if pair.weight != 1.0]
        if self.criterion == "minimax" and weighted:
            raise refused(f"pairs.{weighted[0]}.weight", "none with criterion: minimax, whose residuals count alike",
                          f"{self.pairs[weighted[0]].weight:g}")  # fmt: skip
        return self

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        """See PlacingSpec."""
        return ((("pairs", k), pair) for k, pair in enumerate(self.pairs))
