"""Variants of a scene: numbers of it that take several values, on a grid or as a Latin hypercube.

`FIELD=10um,20um` lists values, `FIELD=17..25:2` counts from end to end, `FIELD=10um..30um` is a range to draw from.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from itertools import product
from typing import Final

import numpy as np

from tol3d.errors import InputError
from tol3d.scene.including import INCLUDE
from tol3d.scene.schema import StudySpec
from tol3d.units import FACTORS, Quantity

Number = int | float | Quantity
Point = Mapping[str, Number]
"""The value of each field in a variant."""

MOST_VARIANTS: Final = 2000
DIGITS: Final = 6
"""Digits of drawn numbers, as people write them."""
STEP_ROUNDING: Final = 1e-9
WHOLE: Final = re.compile(r"[+-]?\d+")
FORMS: Final = 'values such as "10um,20um", "17..25:2" or "10um..30um"'
WORDS: Final = ("scene", "description", "published", INCLUDE)


@dataclass(frozen=True)
class Variable:
    """A number of the scene that takes several values.

    Args:
        field: its name, as messages show it.
        values: all of them; empty of a range.
        span: both ends of a range to draw from; None of values.
    """

    field: str
    values: tuple[Number, ...] = ()
    span: tuple[Number, Number] | None = None

    @property
    def unit(self) -> str:
        """Unit of its numbers; "" if they have none."""
        first = self.values[0] if self.values else self.span[0] if self.span else 0
        return first.unit if isinstance(first, Quantity) else ""


def variable_of(text: str) -> Variable:
    """A variable as it is given on the command line, `FIELD=…`.

    Raises:
        InputError: it is none, or of a field that says how the scene is simulated, not what it is.
    """
    field, equals, given = text.rpartition("=")
    if not equals or not field.strip():
        raise InputError(f"--vary: expected FIELD={FORMS}, got {text!r}")
    return variable(field.strip(), given)


def variable(field: str, given: str | Sequence[str | float | Quantity]) -> Variable:
    """A variable of a field: values as text, or a sequence of them.

    Raises:
        InputError: see variable_of.
    """
    _refuse_senseless(field)
    if not isinstance(given, str):
        return Variable(field, _alike(field, [_number(field, own) for own in given]))
    ends, _, step = given.partition(":")
    if ".." not in ends:
        return Variable(field, _alike(field, [_number(field, own) for own in given.split(",")]))
    low, _, high = ends.partition("..")
    unit = _unit_of(high)
    first, last = _alike(
        field, [_number(field, low if _unit_of(low) or not unit else low + unit), _number(field, high)]
    )
    if not _plain(first) < _plain(last):
        raise InputError(f"{field}: expected a range from the less to the more, got {given!r}")
    if not step:
        return Variable(field, span=(first, last))
    return Variable(
        field, _counted(field, first, last, _number(field, step if _unit_of(step) or not unit else step + unit))
    )


def grid_of(variables: Sequence[Variable]) -> list[Point]:
    """Every value of each with every one of the others; the last varies first.

    Raises:
        InputError: a range without a step, the same field twice, or too many variants.
    """
    _refuse_same(variables)
    for own in variables:
        if own.span is not None:
            words = "expected a step behind it for a grid, such as 10um..30um:5um; or draw with --latin-hypercube N"
            raise InputError(f"{own.field}: {words}")
    _refuse_many(math.prod(len(own.values) for own in variables))
    fields = [own.field for own in variables]
    return [dict(zip(fields, values, strict=True)) for values in product(*(own.values for own in variables))]


def hypercube_of(variables: Sequence[Variable], count: int, seed: int) -> list[Point]:
    """A Latin hypercube: of each range as many equal parts as variants, each with one of them.

    Raises:
        InputError: a variable that is no range, the same field twice, or too many variants.
    """
    _refuse_same(variables)
    _refuse_many(count)
    generator = np.random.default_rng(seed)
    columns = {}
    for own in variables:
        if own.span is None:
            raise InputError(f"{own.field}: expected a range such as 10um..30um for a Latin hypercube, got values")
        places = (generator.permutation(count) + generator.random(count)) / count
        columns[own.field] = [_between(*own.span, float(place)) for place in places]
    return [{field: values[k] for field, values in columns.items()} for k in range(count)]


def plain_number(number: Number) -> float:
    """A number in its own unit."""
    return number.number if isinstance(number, Quantity) else float(number)


def _refuse_senseless(field: str) -> None:
    top, _, rest = field.partition(".")
    if top in WORDS:
        raise InputError(f"{field}: expected a number of parts, tolerances, moves or measures")
    if top == "study" and rest.partition(".")[0] in StudySpec.model_fields:
        words = "it says how a scene is simulated, and all variants are simulated alike; use the command's options"
        raise InputError(f"{field}: expected a number of the scene, for {words}")


def _number(field: str, given: str | float | Quantity) -> Number:
    if isinstance(given, Quantity):
        return given
    if not isinstance(given, str):
        item = getattr(given, "item", None)
        found = item() if callable(item) else given
        if isinstance(found, int | float) and not isinstance(found, bool) and math.isfinite(found):
            return found
        raise InputError(f"{field}: expected {FORMS}, got {given!r}")
    text = given.strip()
    if WHOLE.fullmatch(text):
        return int(text)
    try:
        number = float(text)
    except ValueError:
        try:
            return Quantity.parse(text)
        except ValueError as error:
            raise InputError(f"{field}: expected {FORMS}, {error}") from None
    if not math.isfinite(number):
        raise InputError(f"{field}: expected {FORMS}, got {text!r}")
    return number


def _unit_of(text: str) -> str:
    try:
        return Quantity.parse(text).unit
    except ValueError:
        return ""


def _alike(field: str, numbers: Sequence[Number]) -> tuple[Number, ...]:
    """All of them in the unit of the first one."""
    first = numbers[0] if numbers else None
    if first is None:
        raise InputError(f"{field}: expected {FORMS}, got nothing")
    found: list[Number] = []
    for own in numbers:
        if isinstance(own, Quantity) != isinstance(first, Quantity):
            raise InputError(f"{field}: expected numbers of one unit, got {first} and {own}")
        if isinstance(own, Quantity) and isinstance(first, Quantity):
            if own.dimension != first.dimension:
                raise InputError(f"{field}: expected numbers of one dimension, got {first} and {own}")
            own = _in_unit(own, first.unit)
        found.append(own)
    return tuple(found)


def _in_unit(quantity: Quantity, unit: str) -> Quantity:
    if quantity.unit == unit:
        return quantity
    table = FACTORS[quantity.dimension]
    return Quantity(
        float(Decimal(repr(quantity.number)) * Decimal(repr(table[quantity.unit])) / Decimal(repr(table[unit]))), unit
    )


def _counted(field: str, first: Number, last: Number, step: Number) -> tuple[Number, ...]:
    """From the first to the last one, which is left out where the steps do not meet it."""
    (_, step) = _alike(field, [first, step])
    size = _plain(step)
    if not size > 0.0:
        raise InputError(f"{field}: expected a step of more than 0, got {step}")
    count = int((_plain(last) - _plain(first)) / size + STEP_ROUNDING) + 1
    _refuse_many(count)
    begin, by = (Decimal(repr(plain_number(own))) for own in (first, step))
    return tuple(_like(first, begin + k * by, whole=isinstance(step, int)) for k in range(count))


def _like(first: Number, value: Decimal, *, whole: bool) -> Number:
    if isinstance(first, Quantity):
        return Quantity(float(value), first.unit)
    return int(value) if isinstance(first, int) and whole else float(value)


def _between(first: Number, last: Number, place: float) -> Number:
    low, high = plain_number(first), plain_number(last)
    if isinstance(first, int) and isinstance(last, int):
        return first + min(int(place * (last - first + 1)), last - first)
    drawn = float(f"{low + place * (high - low):.{DIGITS}g}")
    return Quantity(drawn, first.unit) if isinstance(first, Quantity) else drawn


def _plain(number: Number) -> float:
    return number.internal if isinstance(number, Quantity) else float(number)


def _refuse_same(variables: Sequence[Variable]) -> None:
    if not variables:
        raise InputError(f"expected a number to vary, FIELD={FORMS}, got none")
    fields = [own.field for own in variables]
    for field in fields:
        if fields.count(field) > 1:
            raise InputError(f"{field}: expected each field once, got it twice")


def _refuse_many(count: int) -> None:
    if count > MOST_VARIANTS:
        raise InputError(f"expected at most {MOST_VARIANTS} variants, got {count}; draw with --latin-hypercube N")
