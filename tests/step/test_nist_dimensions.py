"""Dimensions of six NIST models against expressions over the raw text."""

import math
import re

import pytest
from nist import FILES, bodies, references, starting, step_text

from tol3d.cad.step import Dimension

COUNTS = {"CTC-01": 12, "FTC-07": 17, "FTC-10": 26, "STC-06": 17, "STC-07": 45, "CTC-05": 6}
FACTORS = {"in": 25.4, "mm": 1.0, "deg": math.pi / 180}


def crude_measure(model: str, identifier: int) -> tuple[float, str]:
    """Number and unit of a measure."""
    body = bodies(model)[identifier]
    number = re.search(r"MEASURE\(([^()]+)\),#(\d+)", body)
    assert number is not None
    unit = bodies(model)[int(number.group(2))].upper()
    return float(number.group(1)), "in" if "'INCH'" in unit else "deg" if "'DEGREE'" in unit else "mm"


def crude_items(model: str, identifier: int) -> dict[str, tuple[float, str]]:
    """The named values that represent a dimension."""
    found = {}
    for body in starting(model, r"DIMENSIONAL_CHARACTERISTIC_REPRESENTATION\(").values():
        dimension, representation = references(body)
        if dimension == identifier:
            for item in references(re.sub(r",#\d+\)$", "", bodies(model)[representation])):
                name = re.search(
                    r"(?:REPRESENTATION_ITEM\(|MEASURE_REPRESENTATION_ITEM\()'([^']*)'", bodies(model)[item]
                )
                if name and "MEASURE" in bodies(model)[item]:
                    found[name.group(1)] = crude_measure(model, item)
    return found


def crude_deviations(model: str, identifier: int) -> list[tuple[float, str]]:
    """Lower and upper deviation of a dimension."""
    for body in starting(model, r"PLUS_MINUS_TOLERANCE\(").values():
        values, dimension = references(body)
        if dimension == identifier and "TOLERANCE_VALUE(" in bodies(model)[values]:
            return [crude_measure(model, each) for each in references(bodies(model)[values])]
    return []


@pytest.mark.parametrize("model", FILES)
def test_every_dimension_of_the_text_is_read(model: str) -> None:
    crude = set(starting(model, r"(DIMENSIONAL_SIZE|DIMENSIONAL_LOCATION|DIRECTED_DIM\w+|ANGULAR_LOCATION)\w*\("))
    assert {each.id for each in step_text(model).dimensions} == crude
    assert len(crude) == COUNTS[model]


@pytest.mark.parametrize("model", FILES)
def test_values_are_those_of_the_text_each_by_its_own_unit(model: str) -> None:
    for each in step_text(model).dimensions:
        crude = crude_items(model, each.id)
        read = {"nominal value": each.nominal, "lower limit": each.least, "upper limit": each.most}
        stated = {name: (found.written, found.unit.name) for name, found in read.items() if found is not None}
        assert stated == crude
        deviations = [found for found in (each.minus, each.plus) if found is not None]
        assert [(found.written, found.unit.name) for found in deviations] == crude_deviations(model, each.id)
        for found in (*read.values(), *deviations):
            if found is not None:
                assert found.value == pytest.approx(found.written * FACTORS[found.unit.name], rel=1e-12)


@pytest.mark.parametrize("model", FILES)
def test_a_dimension_without_a_value_is_remarked_upon(model: str) -> None:
    remarked = {each.id for each in step_text(model).remarks if each.why == "states no value"}
    silent = {each.id for each in step_text(model).dimensions if not crude_items(model, each.id)}
    assert remarked == silent
    assert len(silent) == (4 if model == "CTC-01" else 0)


def dimension(model: str, identifier: int) -> Dimension:
    return next(each for each in step_text(model).dimensions if each.id == identifier)


def test_inches_of_a_file_in_mm_are_converted() -> None:
    hole = dimension("STC-06", 8621)  # geometry in mm, PMI in inches
    assert str(hole) == "⌀0.8125 ±0.02"
    assert hole.limits == pytest.approx((20.1295, 21.1455), abs=1e-12)


def test_limits_with_a_nominal_stay_as_they_are() -> None:
    radius = dimension("FTC-07", 16188)  # XCAF gives 0.017 to 0.022
    assert str(radius) == "R0.012–0.022"
    assert radius.limits == pytest.approx((0.3048, 0.5588), abs=1e-12)


def test_a_fit_is_its_code() -> None:
    hole = dimension("FTC-10", 20119)
    assert hole.fit is not None
    assert (hole.fit.code, hole.fit.zone, hole.limits) == ("G6", "hole", None)


def test_basic_and_reference_dimensions_are_told_apart() -> None:
    roles = {model: [str(each) for each in step_text(model).dimensions if each.role != "toleranced"] for model in FILES}
    assert roles["CTC-05"] == ["[1.25]", "[1.25]", "[2]", "[2]"]
    assert roles["STC-06"] == ["(SR0.5)"]
    assert sum(map(len, roles.values())) == 5


def test_an_angle_is_in_rad_and_printed_in_degrees() -> None:
    angle = dimension("CTC-01", 33)
    assert str(angle) == "60° ±0.5"
    assert angle.limits == pytest.approx((59.5 * math.pi / 180, 60.5 * math.pi / 180), rel=1e-12)


def test_a_location_has_its_two_features_in_order() -> None:
    depth = dimension("STC-07", 16317)
    assert depth.directed
    assert [each.id for each in depth.features] == [14060, 14333]
    assert not depth.is_size
