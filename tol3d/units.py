"""Numbers with their units, as a user writes them: `2.5 mm`, `-19 um`, `20 deg`, `11.5e-6 1/K`.

The grammar is strict on purpose: one number, a blank or none, one unit of the table below. Inside tol3d
lengths are mm, angles rad, temperature differences K, expansion coefficients 1/K, forces N, masses kg. What is counted
has its own word for a unit: `3 pins`, `1 pin`. Angles are read as they are printed too: `20°`, `1′25.2″`.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from functools import lru_cache
from typing import Any, Final, Literal

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticCustomError, core_schema

Dimension = Literal["length", "angle", "temperature", "expansion", "force", "stiffness", "mass", "count"]

ARCMIN: Final = 10800 / math.pi  # in a radian
RAD_PER_ARCMIN: Final = math.pi / 10800

FACTORS: Final[dict[Dimension, dict[str, float]]] = {
    "length": {"mm": 1.0, "um": 1e-3, "nm": 1e-6, "m": 1e3, "cm": 10.0, "in": 25.4},
    "angle": {
        "rad": 1.0,
        "mrad": 1e-3,
        "urad": 1e-6,
        "deg": math.pi / 180,
        "arcmin": RAD_PER_ARCMIN,
        "arcsec": math.pi / 648000,
    },
    "temperature": {"K": 1.0},
    "expansion": {"1/K": 1.0, "/K": 1.0, "um/m/K": 1e-6, "ppm/K": 1e-6},
    "force": {"N": 1.0, "kN": 1e3, "mN": 1e-3},
    "stiffness": {"N/mm": 1.0, "N/um": 1e3, "N/m": 1e-3},
    "mass": {"kg": 1.0, "g": 1e-3, "t": 1e3},
    "count": {"pins": 1.0, "pin": 1.0},
}
"""Value of one of each unit in mm, rad, K, 1/K, N, N/mm or kg; counts are plain numbers."""

EXAMPLES: Final[dict[Dimension, str]] = {
    "length": "4.5 um",
    "angle": "20 deg",
    "temperature": "20 K",
    "expansion": "11.5e-6 1/K",
    "force": "60 N",
    "stiffness": "1500 N/mm",
    "mass": "30 kg",
    "count": "3 pins",
}
DIMENSION_WORDS: Final[dict[Dimension, str]] = {
    "length": "length",
    "angle": "angle",
    "temperature": "temperature difference",
    "expansion": "expansion coefficient",
    "force": "force",
    "stiffness": "stiffness",
    "mass": "mass",
    "count": "count",
}
LARGEST: Final[dict[Dimension, float]] = {
    "length": 1e6,
    "angle": 1e4,
    "temperature": 1e4,
    "expansion": 1.0,
    "force": 1e9,
    "stiffness": 1e9,
    "mass": 1e9,
    "count": 1e6,
}
"""Largest quantity in a scene [mm, rad, K, 1/K, N, N/mm, kg, 1]: a kilometre, 1600 turns; products stay finite."""
LEAST_POSITIVE: Final = 1e-9  # mm or rad; a hundredth of an atom, a micrometre at a kilometre
ABSOLUTE_ZERO: Final = -293.15  # K from 20 degC, from which temperatures count
MICRO_SIGNS: Final = str.maketrans({"µ": "u", "μ": "u"})
PRINTED_SIGNS: Final = MICRO_SIGNS | str.maketrans({"−": "-"})  # also the minus of pictures
NUMBER: Final = r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"  # YAML 1.2 core schema, 10.3.2
NUMBER_UNIT: Final = re.compile(rf"\s*({NUMBER})(?:\s+|(?=[^\s\d.,+-]))(\S+)\s*")
_WHOLE, _UNSIGNED = r"[0-9]+", r"[0-9]+(?:\.[0-9]*)?"
SEXAGESIMAL: Final = (  # the last number may have decimals; ' and " as plain keyboards and terminals have them
    rf"[+-]?(?:{_UNSIGNED}\s*°|(?:{_WHOLE}\s*°\s*)?{_UNSIGNED}\s*[′']"
    rf"|(?:{_WHOLE}\s*°\s*)?(?:{_WHOLE}\s*[′']\s*)?{_UNSIGNED}\s*(?:″|\"|''))"
)
ANGLE: Final = re.compile(rf"\s*{SEXAGESIMAL}\s*")
ANGLE_PARTS: Final = re.compile(rf"({_UNSIGNED})\s*(°|″|\"|''|[′'])")
ANGLE_UNITS: Final = {"°": "deg", "′": "arcmin", "'": "arcmin", "″": "arcsec", '"': "arcsec", "''": "arcsec"}
DECIMAL_COMMA: Final = re.compile(r"\s*([+-]?\d+),(\d+(?:[eE][+-]?\d+)?)\s*(\S*)\s*")
COMMA_SEPARATES: Final = "write decimals with a point: a comma starts a new entry"
BARE_NUMBER: Final = re.compile(rf"\s*{NUMBER}\s*")
WRITTEN_DIGITS: Final = 10  # of what is computed and written for users
KEPT: Final = 4096  # texts of quantities that are parsed once and kept
LONGEST_TEXT: Final = 100  # characters of a quantity; seventeen digits and a unit are far shorter
RESOLVED: Final = 1e-9
"""mm or rad; methods promise to resolve no less: flanks at angles of many turns are rounded to some 1e-10 mm."""
UNITS: Final[dict[str, Dimension]] = {unit: dimension for dimension, table in FACTORS.items() for unit in table}


@dataclass(frozen=True)
class Quantity:
    """A number and its unit as the user wrote them.

    >>> Quantity.parse("-19 um").internal
    -0.019
    """

    number: float
    unit: str

    @property
    def dimension(self) -> Dimension:
        """Dimension of the unit."""
        return UNITS[self.unit]

    @property
    def internal(self) -> float:
        """The value in mm, rad, K, 1/K, N, N/mm or kg."""
        return self.number * FACTORS[self.dimension][self.unit]

    def like(self, internal: float) -> "Quantity":
        """A value in mm, rad, K ... in the unit of this one, to as many digits as anybody writes.

        >>> str(Quantity.parse("20 um").like(0.0123456))
        '12.3456 um'
        """
        return Quantity(float(f"{internal / FACTORS[self.dimension][self.unit]:.{WRITTEN_DIGITS}g}"), self.unit)

    def __str__(self) -> str:
        """Number and unit, with the fewest digits that give the same number back."""
        short = f"{self.number:g}"
        return f"{short if float(short) == self.number else repr(self.number)} {self.unit}"

    @classmethod
    def parse(cls, text: object) -> "Quantity":
        """Read `number unit`.

        Raises:
            ValueError: a bare number, an unknown unit or anything else; the text tells which.
        """
        if isinstance(text, Quantity):
            return text
        if isinstance(text, bool) or not isinstance(text, str | int | float):
            raise ValueError(f"got {shown(text)}")
        if isinstance(text, int | float) or BARE_NUMBER.fullmatch(text[:LONGEST_TEXT]):
            raise ValueError(f"got {shown(text)}, a bare number without its unit")
        return _parsed(text) if len(text) <= LONGEST_TEXT else _parsed.__wrapped__(text)  # no long text is kept

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return _quantity_schema(())

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return _json_schema(*FACTORS)


@lru_cache(maxsize=KEPT)
def _parsed(text: str) -> Quantity:
    """See Quantity.parse; kept, because scenes repeat the same few lengths."""
    plain = text.translate(PRINTED_SIGNS)
    match = NUMBER_UNIT.fullmatch(plain) if len(text) <= LONGEST_TEXT else None
    if len(text) <= LONGEST_TEXT and ANGLE.fullmatch(plain):
        parts = [Quantity(float(number), ANGLE_UNITS[sign]) for number, sign in ANGLE_PARTS.findall(plain)]
        smallest = FACTORS["angle"][parts[-1].unit]
        total = sum(part.number * round(FACTORS["angle"][part.unit] / smallest) for part in parts)
        return Quantity(-total if plain.lstrip().startswith("-") else total, parts[-1].unit)
    if match is None:
        comma = DECIMAL_COMMA.fullmatch(text[:LONGEST_TEXT])
        advice = f", with a decimal comma: write {comma[1]}.{comma[2]} {comma[3]}".rstrip() if comma else ""
        raise ValueError(f"got {shown(text)}{advice}")
    number, unit = float(match[1]), match[2]
    if unit not in UNITS:
        raise ValueError(f"got {shown(text)}: unknown unit {text.strip().removeprefix(match[1]).strip()!r}")
    quantity = Quantity(number, unit)
    if not math.isfinite(number) or not math.isfinite(quantity.internal):
        raise ValueError(f"got {shown(text)}: too large a number")
    return quantity


def summed(terms: Iterable[tuple[int, Quantity]]) -> Quantity:
    """The sum of multiples of quantities, by decimals as one writes them: in their unit, in the base unit of several.

    >>> str(summed([(1, Quantity(0.1, "mm")), (2, Quantity(0.1, "mm"))]))
    '0.3 mm'
    """
    several = [(times, Decimal(repr(quantity.number)), quantity) for times, quantity in terms]
    units = dict.fromkeys(quantity.unit for _, _, quantity in several)
    if len(units) == 1:
        return Quantity(float(sum(times * number for times, number, _ in several)), *units)
    table = FACTORS[several[0][2].dimension]
    total = sum(times * number * Decimal(repr(table[quantity.unit])) for times, number, quantity in several)
    return Quantity(float(total), next(iter(table)))


@dataclass(frozen=True)
class Of:
    """Marks a Quantity field with the dimensions it accepts: `Annotated[Quantity, Of("length")]`."""

    dimensions: tuple[Dimension, ...]

    def __init__(self, *dimensions: Dimension) -> None:
        object.__setattr__(self, "dimensions", dimensions)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return _quantity_schema(self.dimensions)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return _json_schema(*self.dimensions)


@dataclass(frozen=True)
class Positive:
    """Marks a Quantity field that must be more than zero: `Annotated[Quantity, Of("length"), Positive()]`."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return core_schema.no_info_after_validator_function(self._checked, handler(source))

    def _checked(self, quantity: Quantity) -> Quantity:
        if 0.0 < quantity.internal < LEAST_POSITIVE and quantity.dimension in ("length", "angle"):
            raise _value_refused(f"at least {LEAST_POSITIVE:g} {_base_unit(quantity.dimension)}", quantity)
        if not quantity.number > 0.0:
            raise _value_refused(f"a {quantity.dimension} of more than zero", quantity)
        return quantity


def refuse_dimension(quantity: Quantity, expected: tuple[Dimension, ...], field: str = "") -> None:
    """Raise unless the quantity has one of the expected dimensions.

    Args:
        quantity: the given one.
        expected: allowed dimensions.
        field: dotted name of the field within the one that is validated; "" is that one itself.

    Raises:
        PydanticCustomError: "wrong_dimension", for a pydantic validator to pass on.
    """
    if quantity.dimension not in expected:
        raise PydanticCustomError(
            "wrong_dimension",
            "got {got}, which is {came}",
            {
                "got": repr(str(quantity)),
                "came": _with_article(quantity.dimension),
                "expected": expected,
                "field": field,
            },
        )


def expectation(*dimensions: Dimension) -> str:
    """Expected value of such a field, for messages.

    >>> expectation("length")
    'a length with its unit, such as "4.5 um"'
    """
    return " or ".join(f'{_with_article(d)} with its unit, such as "{EXAMPLES[d]}"' for d in dimensions)


def shown(value: object) -> str:
    """A received value, short and printable, for messages."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "keys with values" if value else "an empty mapping"
    if isinstance(value, list | tuple):
        return "a list" if value else "an empty list"
    text = repr(value[:LONGEST_TEXT]) if isinstance(value, str) else str(value)
    return text if len(text) <= 60 else text[:57] + "…"


def _with_article(dimension: Dimension) -> str:
    return f"{'an' if dimension[0] in 'ae' else 'a'} {DIMENSION_WORDS[dimension]}"


def _quantity_schema(dimensions: tuple[Dimension, ...]) -> core_schema.CoreSchema:
    def quantity_or_error(text: object) -> Quantity:
        try:
            quantity = Quantity.parse(text)
        except ValueError as error:
            raise PydanticCustomError("quantity", "{reason}", {"reason": str(error), "expected": dimensions}) from None
        if dimensions:
            refuse_dimension(quantity, dimensions)
        if abs(quantity.internal) > LARGEST[quantity.dimension]:
            largest = f"{LARGEST[quantity.dimension]:g} {_base_unit(quantity.dimension)}"
            raise _value_refused(f"a number from -{largest} to {largest}", quantity)
        return quantity

    return core_schema.no_info_plain_validator_function(
        quantity_or_error, serialization=core_schema.plain_serializer_function_ser_schema(str)
    )


def _base_unit(dimension: Dimension) -> str:
    """Unit of internal values, such as mm or rad."""
    return next(iter(FACTORS[dimension]))


def _value_refused(expected: str, quantity: Quantity) -> PydanticCustomError:
    return PydanticCustomError(
        "value_refused", "expected {expected}, got {got}", {"expected": expected, "got": repr(str(quantity))}
    )


def _json_schema(*dimensions: Dimension) -> dict[str, Any]:
    named = [re.sub("^u", "[uµμ]", re.escape(unit)) for dimension in dimensions for unit in FACTORS[dimension]]
    angles = [rf"^\s*{SEXAGESIMAL}\s*$"] if "angle" in dimensions else []
    units, without_digit = "|".join(named), "|".join(unit for unit in named if not unit[0].isdigit())
    return {
        "type": "string",
        "title": " or ".join(dimensions),
        "pattern": "|".join([rf"^\s*{NUMBER}(\s+({units})|({without_digit}))\s*$", *angles]).replace("[+-]", "[+−-]"),
        "examples": [EXAMPLES[dimension] for dimension in dimensions],
    }


def angle_text(angle: float) -> str:
    """An angle [rad] in degrees, minutes and seconds of arc, to a tenth of a second.

    >>> angle_text(math.radians(1 / 60 + 25.2 / 3600)), angle_text(math.radians(-7.0192))
    ('1′25.2″', '-7°01′09.1″')
    """
    seconds = round(abs(angle) * 648000 / math.pi, 1)
    minutes, rest = divmod(seconds, 60)
    degrees, minutes = divmod(int(minutes), 60)
    sign = "-" if angle < 0 and seconds > 0 else ""
    if degrees:
        return f"{sign}{degrees}°{minutes:02}′{rest:04.1f}″"
    return f"{sign}{minutes}′{rest:04.1f}″" if minutes else f"{sign}{rest:.1f}″"
