"""Three values along x, y and z: lengths with their units, or a direction in plain numbers."""

from math import frexp, ldexp
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field

from tol3d.strict import refused
from tol3d.units import COMMA_SEPARATES, Of, Quantity, shown

AXES = 3  # x, y, z
LEAST, MOST = 1e-3, 1e3  # of a direction's largest number; others are scaled, as the square of 1e155 is no number

Coordinate = Annotated[Quantity, Of("length")]


def three(expected: str) -> BeforeValidator:
    """Mark of a field of three items, each checked by itself afterwards.

    Args:
        expected: allowed values, for the message.
    """

    def checked(value: Any) -> tuple[Any, ...]:
        if isinstance(value, list | tuple) and len(value) == AXES:
            return tuple(value)
        got = f"a list of {len(value)}" if isinstance(value, list | tuple) and value else shown(value)
        commas = isinstance(value, list | tuple) and len(value) > AXES
        raise refused("", expected, f"{got}; {COMMA_SEPARATES}" if commas else got)

    return BeforeValidator(checked)


def _pointing(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    if not any(direction):
        raise refused("", "a direction with a number other than 0", "zeros only")
    largest = max(map(abs, direction))
    if LEAST <= largest <= MOST:
        return direction
    _, exponent = frexp(largest)
    x, y, z = (ldexp(number, -exponent) for number in direction)  # exact: powers of two
    return x, y, z


Vector = Annotated[tuple[Coordinate, Coordinate, Coordinate], three("three lengths, such as [0 mm, 12 mm, 5 mm]")]
"""A point, or the way to one."""

Direction = Annotated[
    tuple[float, float, float],
    AfterValidator(_pointing),
    three("three numbers, such as [0, -1, 0]"),
    Field(json_schema_extra={"contains": {"not": {"const": 0}}}),
]
"""Direction of something; its length is ignored."""
