"""Parts that are mated, fitted or brought into touch."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.feature_name import Use
from tol3d.assembly.grammar.moves.assembly_move import PairSpec, PlacingSpec
from tol3d.assembly.model.move import Acts
from tol3d.assembly.model.moves import STATED_BY, BestFit, Mate, Touch
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction
from tol3d.strict import refused
from tol3d.units import Of, Quantity


class RelationSpec(PairSpec):
    """Relation of one feature to another, as it lies nominally."""

    kind: Literal["coincident", "coaxial", "tangent", "distance"] = Field(
        description="coincident: two planes, a point and a plane, two points, a point and an axis, a cone and a "
        "conical hole; coaxial: two axes; tangent: a cylinder and a plane, at the diameter of the trial; distance: a "
        "plane or a point and a plane"
    )
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
    """Relations in order, each of which fixes remaining freedoms; no other contact is checked.

    Free rotations stay nominal: the smallest rotation, about the middle of the `from` that requires it. A relation that
    is not met nominally, to 0.002 mm at all ends, is refused with the amount.
    """

    words: ClassVar[str] = "a mate"
    acts: ClassVar[Acts] = Mate.acts
    stated_by: ClassVar[str] = f"{STATED_BY}.moves:mated"

    kind: Literal["mate"]
    relations: Annotated[tuple[RelationSpec, ...], listed("relations", 1, 6)] = Field(
        description="held in this order; a later one holds what the earlier ones leave free"
    )

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        return ((("relations", k), pair) for k, pair in enumerate(self.relations))


class FitSpec(PairSpec):
    """Two points that are to coincide."""

    weight: float = Field(default=1.0, gt=0.0, description="of its square, with criterion: squares")
    along: Annotated[tuple[Direction, ...], listed("directions", 1, 3)] = Field(
        default=(), description="directions of the target's part in which it counts; default: all"
    )


class BestFitSpec(PlacingSpec):
    """Points are fitted to their targets as well as possible: least squares, or least largest distance; no scale.

    Freedoms that the points leave stay nominal: the smallest rotation, then the smallest shift of their centroid.
    Points and targets should coincide nominally; at a nominal distance r the relative error of the analytic method is
    r over their distances.
    """

    words: ClassVar[str] = "a best fit"
    acts: ClassVar[Acts] = BestFit.acts
    stated_by: ClassVar[str] = f"{STATED_BY}.moves:fitted"

    kind: Literal["best_fit"]
    pairs: Annotated[tuple[FitSpec, ...], listed("pairs", 3)] = Field(
        description="points that are to coincide, three at least"
    )
    criterion: Literal["squares", "minimax"] = Field(default="squares", description="what is made least")

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        weighted = [k for k, pair in enumerate(self.pairs) if pair.weight != 1.0]
        if self.criterion == "minimax" and weighted:
            raise refused(f"pairs.{weighted[0]}.weight", "none with criterion: minimax, whose residuals count alike",
                          f"{self.pairs[weighted[0]].weight:g}")  # fmt: skip
        return self

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        return ((("pairs", k), pair) for k, pair in enumerate(self.pairs))


SURFACES = ("plane", "cylinder", "sphere", "point")


class TouchSpec(PlacingSpec):
    """Contacts of round features, all at once: surfaces touch by the sizes of the trial; one of each two is round."""

    words: ClassVar[str] = "a touch"
    acts: ClassVar[Acts] = Touch.acts
    stated_by: ClassVar[str] = f"{STATED_BY}.moves:touched"

    kind: Literal["touch"]
    contacts: Annotated[tuple[PairSpec, ...], listed("contacts", 1, 6)] = Field(
        description="pairs of features that touch"
    )
    pressed: Direction | None = Field(
        default=None,
        description="where the part is pressed to, in the frame of the part of the first `to`; contacts do not pull",
    )

    def paired(self) -> Iterator[tuple[KeyPath, PairSpec]]:
        return ((("contacts", k), pair) for k, pair in enumerate(self.contacts))

    def uses(self) -> Iterator[Use]:
        """The features of the contacts."""
        for path, pair in self.paired():
            yield Use((*path, "from"), pair.from_, SURFACES)
            yield Use((*path, "to"), pair.to, SURFACES)
