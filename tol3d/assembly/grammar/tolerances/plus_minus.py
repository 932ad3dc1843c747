"""Lengths with a law: where a feature lies along a direction, its size, and locators of a move."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Final, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.assembly.grammar.datums import Datums, DatumSpec
from tol3d.assembly.grammar.moves.locating import LocatingSpec
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.scene.bases import ToleranceSpec
from tol3d.scene.entry import AboutOne, Contradiction
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.vector import Direction
from tol3d.strict import refused
from tol3d.units import Of, Quantity


class PlusMinusSpec(FeatureTolerance, ToleranceSpec):
    """A dimension with limits: the offset of a feature along a direction, without tilt.

    With `datums` positive is a longer dimension, without them an offset along the normal. An axis needs a direction
    `along`, square to it. A feature may have one dimension along each direction.
    """

    words: ClassVar[str] = "a plus-minus tolerance"

    kind: Literal["plus_minus"]
    along: Direction | None = Field(
        default=None,
        description="in the part's frame; default: away from the first of the datums off which the feature lies "
        "along its normal, and without datums along its normal",
    )
    datums: Datums | None = Field(default=None, description="where the dimension starts; default: the part's frame")

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        return self.datums or ()

    nominal: ClassVar[str] = "position"  # where the feature is drawn


ENVELOPED: Final = ("cylinder", "slot")
"""Kinds of feature whose form an envelope bounds: their surfaces are opposed."""

Deviation = Annotated[Quantity, Of("length")]


class SizeSpec(FeatureTolerance, ToleranceSpec):
    """Deviation of a diameter or width from nominal, positive where it is larger, also of a hole.

    Of a cylinder, a sphere, a slot or a tab; of a cone, of the diameter of every section.
    """

    words: ClassVar[str] = "a size tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("cylinder", "cone", "slot", "sphere")

    kind: Literal["size"]
    limits: Annotated[tuple[Deviation, Deviation], listed("lengths", 2, 2)] | None = Field(
        default=None,
        description="lower and upper on the drawing, as deviations from nominal, from which a bonus counts; default: "
        "those of the distribution",
    )
    envelope: bool | None = Field(
        default=None,
        description="whether the limits bound the form too (ISO: E in a circle), or not (ASME: I in a circle); "
        "default: as the scene's `standard` and `envelope` say",
    )

    nominal: ClassVar[str] = "size"  # the diameter or width

    @override
    def nominal_size(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> Quantity | None:
        part, _, name = self.of.partition(".")
        feature = parts[part].features.get(name)
        drawn: Quantity | None = getattr(feature, "diameter", None) or getattr(feature, "width", None)
        return super().nominal_size(parts, moves) or drawn

    @model_validator(mode="after")
    def _refuse_limits_out_of_order(self) -> Self:
        if self.limits is not None and not self.limits[0].internal < self.limits[1].internal:
            raise refused("limits", "the lower one before the upper one", list(map(str, self.limits)))
        return self


class LocatorSpec(AboutOne, ToleranceSpec):
    """Offset of a locator along its normal; positive lifts the part."""

    words: ClassVar[str] = "a locator's tolerance"
    applies_to: ClassVar[tuple[type[LocatingSpec], ...]] = (LocatingSpec,)

    kind: Literal["locator"]
    of: Name = Field(description="the move")
    pair: str = Field(description="which of its pairs: primary 1 .. 3, secondary 1, 2, tertiary 1, or 1 .. 6")

    nominal: ClassVar[str] = "position"  # where the locator stands

    def contradictions(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> Iterator[Contradiction]:
        """A pair that the move does not have."""
        known = tuple(moves[self.of].pairs_by_name)
        if self.pair not in known:
            yield Contradiction(("pair",), f"one of {', '.join(known)}", repr(self.pair), known)
