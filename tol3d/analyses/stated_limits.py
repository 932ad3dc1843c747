"""Other limits of measures as a user states them, such as `normal backlash=10 um..40 um`: values are counted anew."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, is_dataclass, replace
from typing import Any, Final

from tol3d.analyses.response import Response
from tol3d.errors import InputError
from tol3d.statistics.distributions.drawn import limits_written
from tol3d.study.system.measure import Measure
from tol3d.units import UNITS, Quantity, expectation

FIELDS: Final = ("lower_limit", "upper_limit")
NONE: Final = "none"
"""Word for no limit."""
EXAMPLES: Final = "10 um..40 um, 10 um.. of the lower one alone, none..40 um without a lower one, ±20 um"


@dataclass(frozen=True)
class OtherLimits:
    """Other limits of a measure.

    Args:
        measure: its name.
        stated: the changed ones as they were stated; None for no limit.
    """

    measure: str
    stated: Mapping[str, Quantity | None]

    def on(self, measure: Measure) -> Measure:
        """The measure with them.

        Raises:
            InputError: a lower one that is not below the upper one, or a kind of measure that cannot be changed.
        """
        known = {field: getattr(measure, field) for field in FIELDS}
        if not is_dataclass(measure) or not known.keys() <= measure.__dataclass_fields__.keys():
            raise InputError(f"{self.measure}: expected a measure with limits of its own; change them in the scene")
        internal = {field: None if own is None else own.internal for field, own in self.stated.items()}
        lower, upper = ({**known, **internal}[field] for field in FIELDS)
        if lower is not None and upper is not None and not lower < upper:
            per = measure.per_internal
            ends = f"{per * lower:g} {measure.unit} and {per * upper:g} {measure.unit}"
            raise InputError(f"{self.measure}: expected a lower limit below the upper one, got {ends}")
        other: Any = measure
        made: Measure = replace(other, **internal)
        return made


def limits_of_text(response: Response, text: str) -> OtherLimits:
    """Limits by `--limits MEASURE=LOW..HIGH`; a side that is left out stays as it is in the scene.

    Raises:
        InputError: no such measure, or no such limits of it.
    """
    name, sign, value = (own.strip() for own in text.rpartition("="))
    if not (sign and name and value):
        raise InputError(f"--limits: expected MEASURE=LOW..HIGH, such as {EXAMPLES}, got {text!r}")
    measure = response.of(name).measures[0]
    try:
        return OtherLimits(name, _stated(measure, value, changeable(response, measure)))
    except (InputError, ValueError) as error:
        raise InputError(f"--limits {text!r}: {error}") from None


def _stated(measure: Measure, value: str, sides: Sequence[str]) -> Mapping[str, Quantity | None]:
    """The changed limits.

    Raises:
        InputError, ValueError: they cannot be.
    """
    found: dict[str, Quantity | None] = {}
    dimension = UNITS[measure.unit]
    pair = limits_written(value)
    if pair is not None:
        found = dict(zip(FIELDS, pair, strict=True))
    else:
        low, dots, high = (own.strip() for own in value.partition(".."))
        if not dots or not (low or high):
            raise ValueError(f"expected limits such as {EXAMPLES}, got {value!r}")
        try:
            found = {
                field: None if own == NONE else Quantity.parse(own)
                for field, own in zip(FIELDS, (low, high), strict=True)
                if own
            }
        except ValueError as error:
            raise ValueError(f"expected {expectation(dimension)}, or {NONE}, {error}") from None
    for field, quantity in found.items():
        if quantity is not None and quantity.dimension != dimension:
            raise ValueError(f"expected {expectation(dimension)}, got {quantity}")
        if field not in sides:
            raise ValueError(f"expected no {field.replace('_', ' ')}, which the other end of its curve has")
    return found


def changeable(response: Response, measure: Measure) -> Sequence[str]:
    """The limits that a measure may have: of a curve the lowest value has the lower one, the highest the upper one."""
    if measure.name not in response.curves:
        return FIELDS
    return ("lower_limit",) if measure.take == "min" else ("upper_limit",)


def limited(measures: Sequence[Measure], limits: Sequence[OtherLimits]) -> tuple[Measure, ...]:
    """Measures with other limits, where they are stated.

    Raises:
        InputError: limits that cannot be; two of one measure.
    """
    names = [own.measure for own in limits]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{name}: expected its limits once, got them {names.count(name)} times")
    by_name = {own.measure: own for own in limits}
    return tuple(by_name[own.name].on(own) if own.name in by_name else own for own in measures)
