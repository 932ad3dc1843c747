"""Direction of a deviation: a word, or `{at: angle}`. Positions of the driver are stated the same way."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from tol3d.scene.nearest import nearest
from tol3d.strict import Strict, refused
from tol3d.units import Of, Quantity, shown


class At(Strict):
    """A fixed angle."""

    at: Annotated[Quantity, Of("angle")] = Field(description="angle, counter-clockwise about +z")


FixedAngle = Annotated[At, Tag("at")]


def shape(value: Any) -> str:
    """The tag of a word-or-angle field's value, for pydantic's Discriminator."""
    return "at" if isinstance(value, dict | At) else "word"


def known_word(*words: str) -> BeforeValidator:
    """Mark of a field that takes one of some words, or `{at: angle}`."""

    def checked(value: Any) -> Any:
        if isinstance(value, dict | At) or value in words:
            return value
        near = nearest(value, words) if isinstance(value, str) else ""
        raise refused("", f"{', '.join(words)} or {{at: 30 deg}}", shown(value) + near)

    return BeforeValidator(checked)


RandomOrFixed = Annotated[
    Annotated[Literal["random"], Tag("word")] | FixedAngle, Discriminator(shape), known_word("random")
]
"""Uniform over the circle, or at an angle: where an offset points that turns with its part, or where a shaft stands."""
