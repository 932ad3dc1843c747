"""Quantities: the grammar, the table of factors, and how they are written back."""

import math
import re

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter

from tol3d import units
from tol3d.units import FACTORS, LONGEST_TEXT, UNITS, Quantity, angle_text

PINT_NAMES = {"/K": "1/K", "um/m/K": "um/m/K", "ppm/K": "ppm/K", "pins": "dimensionless", "pin": "dimensionless"}
INNER = {
    "length": "mm",
    "angle": "rad",
    "temperature": "K",
    "expansion": "1/K",
    "force": "N",
    "stiffness": "N/mm",
    "mass": "kg",
    "count": "dimensionless",
}

quantities = st.builds(Quantity, st.floats(allow_nan=False, allow_infinity=False, width=32), st.sampled_from([*UNITS]))


@pytest.fixture(scope="module")
def registry() -> "pint.UnitRegistry[float]":
    """It takes a fifth of a second to be read."""
    return pint.UnitRegistry()


@pytest.mark.parametrize(("dimension", "unit"), [(d, unit) for d, table in FACTORS.items() for unit in table])
def test_factors_are_those_of_pint(dimension: str, unit: str, registry: "pint.UnitRegistry[float]") -> None:
    factor = registry.Quantity(1.0, PINT_NAMES.get(unit, unit)).to(INNER[dimension]).magnitude
    assert Quantity(1.0, unit).internal == pytest.approx(factor, rel=1e-15)  # one rounding of the quotient


def test_each_unit_belongs_to_one_dimension() -> None:
    assert len(UNITS) == sum(len(table) for table in FACTORS.values())


@pytest.mark.parametrize(
    ("text", "internal"),
    [
        ("2.5 mm", 2.5),
        ("-19 um", -0.019),
        ("1e-3 mm", 0.001),
        ("  +.5E+1   mm ", 5.0),
        ("4. um", 0.004),
        ("7 µm", 0.007),  # U+00B5, the micro sign
        ("7 μm", 0.007),  # U+03BC, the Greek letter
        ("180 deg", math.pi),
        ("11.5e-6 1/K", 11.5e-6),
        ("11.5 um/m/K", 11.5e-6),
        ("105mm", 105.0),
        ("-1e-3mm", -0.001),
        ("20deg", math.pi / 9),
        ("1e-5/K", 1e-5),
        ("−3 mm", -3.0),  # U+2212, as pictures have it
        ("20°", math.pi / 9),
        ("1′25.2″", 85.2 * math.pi / 648000),
        ("-7°01′09.1″", -(7 * 3600 + 69.1) * math.pi / 648000),
        ("7° 1' 9.1\"", (7 * 3600 + 69.1) * math.pi / 648000),
        ("2°30'", math.pi / 72),
        ("4.134 in", 105.0036),  # an inch is 25.4 mm since 1959
    ],
)
def test_number_blank_unit_is_read(text: str, internal: float) -> None:
    assert Quantity.parse(text).internal == pytest.approx(internal, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("2.5", "a bare number without its unit"),
        (2.5, "a bare number without its unit"),
        (True, "got true"),
        (None, "got nothing"),
        ([1], "got a list"),
        ("2.5.1mm", "got '2.5.1mm'"),
        ("1e-5 1 /K", "got '1e-5 1 /K'"),
        ("2,5 mm", "got '2,5 mm', with a decimal comma: write 2.5 mm"),
        ("-105,0mm", "with a decimal comma: write -105.0 mm"),
        ("1,000.5 mm", "got '1,000.5 mm'"),
        ("mm", "got 'mm'"),
        ("1 mm 2", "got '1 mm 2'"),
        ("1_000 mm", "got '1_000 mm'"),
        ("nan mm", "got 'nan mm'"),
        (".inf mm", "got '.inf mm'"),
        ("1e400 mm", "too large"),
        ("1e308 m", "too large"),  # finite as written, not in mm
        ("٣ mm", "got '٣ mm'"),  # digits of other scripts are no YAML numbers
        ("3 furlong", "unknown unit 'furlong'"),
        ("3 MM", "unknown unit 'MM'"),
    ],
)
def test_anything_else_is_refused_with_a_reason(text: object, words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        Quantity.parse(text)


@given(quantities)
def test_writing_is_the_inverse_of_reading(quantity: Quantity) -> None:
    assert Quantity.parse(str(quantity)) == quantity


@given(
    st.text(max_size=20)
    | quantities.map(str)
    | st.from_regex(r"[-+.0-9e]{1,6} ?[muµdegK/1]{1,4}|[-−+]?([0-9.]{1,3} ?[°′'\"″]{1,2} ?){1,3}", fullmatch=True)
)
def test_the_json_schema_pattern_accepts_exactly_what_is_read(text: str) -> None:
    pattern = TypeAdapter(Quantity).json_schema()["pattern"]
    try:
        read = math.isfinite(Quantity.parse(text).internal)
    except ValueError as error:
        read = "too large" in str(error)
    assert (re.search(pattern, text.rstrip("\n")) is not None) == read


@pytest.mark.parametrize("text", ["1" * 10**6, "1" * 10**6 + " mm", " " * 10**6, "1" + " " * 10**6])
def test_a_megabyte_of_digits_is_refused_without_looking_at_all_of_it(
    text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A pattern that goes back and forth over a megabyte takes hours: none sees more than a quantity may be long."""
    seen: list[int] = []

    class Watched:
        def __init__(self, pattern: re.Pattern[str]) -> None:
            self._pattern = pattern

        def fullmatch(self, looked_at: str) -> re.Match[str] | None:
            seen.append(len(looked_at))
            return self._pattern.fullmatch(looked_at)

    for name in ("NUMBER_UNIT", "BARE_NUMBER"):
        monkeypatch.setattr(units, name, Watched(getattr(units, name)))
    units._parsed.cache_clear()  # each text is read once
    Quantity.parse("1 mm")
    assert len(seen) == 2  # both patterns are watched
    with pytest.raises(ValueError, match="got"):
        Quantity.parse(text)
    assert max(seen) <= LONGEST_TEXT


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0, "0.0″"), (59.94, "59.9″"), (59.96, "1′00.0″"), (85.2, "1′25.2″"), (-85.2, "-1′25.2″"), (-0.01, "0.0″")],
)
def test_angles_are_written_in_minutes_and_seconds_of_arc(seconds: float, text: str) -> None:
    assert angle_text(math.radians(seconds / 3600)) == text
