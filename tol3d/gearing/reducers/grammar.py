"""Measures of reducers as scenes write them: at one position of the output, or over a turn of it."""

from typing import Annotated, Any, ClassVar, Final, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.scene.bases import MeasureSpec, Take
from tol3d.strict import refused

Flank = Annotated[
    Literal["drive", "back"], Field(description="drive: the load resists the output; back: it drives it on")
]
HarmonicOrder = Annotated[
    int | None, Field(ge=1, description="of the harmonic: cycles a turn of the output; default: 1")
]
ONE_POSITION: Final = "value"


class FreeTurnSpec(MeasureSpec):
    """A free turn of a shaft, read at one position."""

    gives_curve: ClassVar[bool] = False
    several_positions: ClassVar[bool] = False


class OverTurnSpec(MeasureSpec):
    """A measure that may be read over a turn.

    A kind adds `over`, `take`, `positions`, and the `order` of a harmonic and `orders` of a curve where it has them.
    """

    takes: ClassVar[str] = "min, max, range, harmonic or curve"
    usual: ClassVar[Take] = "range"

    @model_validator(mode="after")
    def _refuse_unfit(self) -> Self:
        """Refuse values and orders that the positions do not have."""
        own: Any = self
        if own.take is not None and (own.take == ONE_POSITION) == self.several_positions:
            fitting = f"{self.takes} over a turn" if self.several_positions else "value at one position"
            raise refused("take", fitting, own.take)
        order, orders = getattr(own, "order", None), getattr(own, "orders", None)
        if order is not None and own.take != "harmonic":
            raise refused("order", f"none beside take: {self.taken}; only a harmonic has an order", order)
        if orders is not None and own.take != "curve":
            raise refused("orders", f"none beside take: {self.taken}; only a curve has orders", list(orders))
        for field, given in (("order", (order or 1,)), ("orders", orders or ())):
            if given and max(given) > (highest := (own.positions - 1) // 2):
                raise refused(field, f"at most {highest}, which {own.positions} positions resolve", max(given))
        return self

    @property
    def taken(self) -> Take:
        """Value taken over the positions."""
        own: Any = self
        found: Take = own.take or (self.usual if self.several_positions else ONE_POSITION)
        return found

    @property
    @override
    def gives_curve(self) -> bool:
        return self.taken == "curve"

    @property
    def several_positions(self) -> bool:
        """See MeasureEntry: over any turn."""
        own: Any = self
        return own.over in ("turn", "long_period")
