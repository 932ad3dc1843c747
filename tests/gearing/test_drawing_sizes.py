"""The table of `tol3d check` of spans and pins, against gears that are as thick as the limits say."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

import tol3d
from tol3d import check_scene
from tol3d.errors import SceneError
from tol3d.gearing.effects import ToothThickness
from tol3d.gearing.grammar.parts import GearSpec
from tol3d.gearing.grammar.tolerances.gears import ToothThicknessSpec
from tol3d.gearing.model import Contributor
from tol3d.gearing.model.pairs import cylindrical_gear
from tol3d.gearing.presenting.drawing_sizes import drawing_sizes
from tol3d.gears import InternalGear, SpurGear
from tol3d.gears.tooth_measures import OverPins, Span, pins_of, span_of
from tol3d.report.page import Row, Shown, Table
from tol3d.scene import Scene
from tol3d.simulate import load


def _thickens(contributor: Contributor, part: str) -> bool:
    return isinstance(contributor.effect, ToothThickness) and contributor.effect.part == part


@pytest.mark.parametrize("scene", ["spur_pair", "internal_pair"])
def test_check_prints_sizes_nominal_and_at_the_limits(scene: str) -> None:
    model = check_scene(scene).model
    (table,) = (own for own in drawing_sizes(model) if isinstance(own, Table))
    rows = iter(table.rows)
    for part in model.gears:
        gear = part.gear
        assert isinstance(gear, SpurGear | InternalGear)
        (law,) = (own for own in model.contributors if _thickens(own, part.name))
        assert isinstance(law.effect, ToothThickness)
        counted = 1.0 if scene == "spur_pair" else law.effect.turn * 2 * gear.reference_radius
        ends = [0.0, law.distribution.low * counted, law.distribution.high * counted]
        gears = [replace(gear, tooth_thickness_deviation=gear.tooth_thickness_deviation + own) for own in ends]
        span, pins = span_of(gear), pins_of(gear)
        assert span
        assert pins
        for expected in (lambda g: g.tooth_thickness, lambda g: g.tooth_thickness_deviation, span.size, pins.size):
            cells = [own for own in next(rows).cells if isinstance(own, Shown)]
            assert [own.value for own in cells] == pytest.approx([expected(own) for own in gears], abs=1e-9)
            assert [str(own) for own in cells] == [f"{expected(own):.4f}" for own in gears]
        cosine = math.cos(gear.pressure_angle) * (-1 if isinstance(gear, InternalGear) else 1)
        assert span.size(gears[1]) - span.size(gears[0]) == pytest.approx(ends[1] * cosine, abs=1e-12)
    assert next(rows, None) is None


def numbers(row: Row) -> list[float]:
    return [own.value for own in row.cells if isinstance(own, Shown) and own.value is not None]


THIN = {"kind": "uniform", "lower": "-70 um", "upper": "-40 um"}
SPANS = [("spur_pair", "pinion", 4), ("internal_pair", "pinion", 3), ("internal_pair", "ring", 7)]


def said(scene: Scene, part: str, measured: object, law: object) -> Scene:
    """A scene whose tooth thickness of a part is measured otherwise, and has another law."""
    (name,) = (name for name, spec in scene.of(ToothThicknessSpec).items() if spec.of == part)
    return scene.with_({f"tolerances.{name}.measured": measured, f"tolerances.{name}.distribution": law})


@pytest.mark.parametrize(("name", "part", "teeth"), SPANS)
def test_limits_of_a_span_are_those_of_the_gear_s_own_span(name: str, part: str, teeth: int) -> None:
    """A gear as thick as one limit says has a span that is off by that limit, and so it says in `tol3d check`."""
    low, high = (-0.07, -0.04) if part != "ring" else (0.04, 0.07)  # over spaces, which get wider
    law = {"kind": "uniform", "lower": f"{low} mm", "upper": f"{high} mm"}
    model = check_scene(said(load(name), part, {"span": teeth}, law)).model
    gear = next(own.gear for own in model.gears if own.name == part)
    assert isinstance(gear, SpurGear | InternalGear)
    (found,) = (own for own in model.contributors if _thickens(own, part))
    assert isinstance(found.effect, ToothThickness)
    for deviation in (low, high):
        arc = 2 * found.effect.turn * gear.reference_radius * deviation
        moved = replace(gear, tooth_thickness_deviation=gear.tooth_thickness_deviation + arc)
        assert Span(teeth).size(moved) - Span(teeth).size(gear) == pytest.approx(deviation, abs=1e-12)
    (table,) = (own for own in drawing_sizes(model) if isinstance(own, Table))
    row = next(row for row in table.rows if str(row.cells[0]).startswith(f"span W_k over {teeth} "))
    nominal, *ends = numbers(row)
    assert sorted(own - nominal for own in ends) == pytest.approx([low, high], abs=1e-12)


def test_a_span_is_a_deviation_along_the_normals_also_in_planetary_sets() -> None:
    """Bit for bit: of a sun the same, of a ring with the other sign."""
    law, turned = ({"kind": "constant", "value": value} for value in ("-40 um", "40 um"))
    sets = [("sun", 3, law, law), ("ring 1", 9, turned, law)]
    here = there = load("reducer_3k")
    for part, teeth, by_span, by_normal in sets:
        here, there = said(here, part, {"span": teeth}, by_span), said(there, part, "normal", by_normal)
    found = []
    for scene in (here, there):
        response = tol3d.response(scene).of("lost motion")
        found.append(response.values(*response.drawn(20, seed=3)).values)
    np.testing.assert_array_equal(found[0], found[1])


PINS = [("spur_pair", "pinion", 4.2), ("spur_pair", "wheel", 4.2), ("internal_pair", "ring", 2.5)]


@pytest.mark.parametrize(("name", "part", "diameter"), PINS)
def test_limits_over_pins_are_those_of_the_gear_s_own_size(name: str, part: str, diameter: float) -> None:
    """Each trial's gear, made as thick as its draw says, has the size over pins that was drawn: not in proportion."""
    low, high = (-0.09, -0.03) if part != "ring" else (0.03, 0.09)  # between pins, whose spaces get wider
    law = {"kind": "uniform", "lower": f"{low} mm", "upper": f"{high} mm"}
    model = check_scene(said(load(name), part, {"pins": f"{diameter} mm"}, law)).model
    gear = next(own.gear for own in model.gears if own.name == part)
    assert isinstance(gear, SpurGear | InternalGear)
    (found,) = (own for own in model.contributors if _thickens(own, part))
    assert isinstance(found.effect, ToothThickness)
    assert found.effect.turn == 0.5 / gear.reference_radius
    uniforms, pins = np.linspace(0.0, 1.0, 5), OverPins(diameter)
    (arcs,) = found.draw.deviations(uniforms)
    sizes = [pins.size(replace(gear, tooth_thickness_deviation=gear.tooth_thickness_deviation + own)) for own in arcs]
    falls = part == "ring"  # the thinnest teeth have the largest size
    expected = pins.size(gear) + low + (high - low) * (1 - uniforms if falls else uniforms)
    assert sizes == pytest.approx(expected.tolist(), abs=1e-9)
    straight = arcs[0] + (arcs[-1] - arcs[0]) * uniforms
    assert np.abs(arcs - straight).max() > 1e-6
    (table,) = (own for own in drawing_sizes(model) if isinstance(own, Table))
    row = next(row for row in table.rows if str(row.cells[0]).endswith(f"pins of {diameter:g} mm"))
    nominal, *ends = numbers(row)
    assert sorted(own - nominal for own in ends) == pytest.approx([low, high], abs=1e-9)


@pytest.mark.parametrize(("name", "part", "diameter"), [("reducer_3k", "ring 1", 1.65), ("rv_250aii", "sun", 4.3)])
def test_pins_measure_gears_of_sets_and_reducers(name: str, part: str, diameter: float) -> None:
    """As thick in every trial as by the arc that has the drawn size."""
    scene = load(name)
    pins, gear = OverPins(diameter), cylindrical_gear(scene, part)
    arc = pins.thickness(gear, pins.size(gear) - 0.05) - gear.tooth_thickness
    constant = [{"kind": "constant", "value": f"{own!r} mm"} for own in (-0.05, arc)]
    found = []
    for measured, law in zip(({"pins": f"{diameter} mm"}, "arc"), constant, strict=True):
        own = said(scene, part, measured, law)
        response = tol3d.response(own).of(next(iter(own.measures)))
        found.append(response.values(*response.drawn(5, seed=3)).values)
    np.testing.assert_allclose(found[0], found[1], rtol=0, atol=1e-9)


def test_a_nominal_size_that_is_not_the_gear_s_is_warned_of() -> None:
    scene = load("spur_pair").with_({"default_law": {"kind": "uniform"}})
    for size, words in (("52.9 mm", r"expected a nominal size over pins .* got 52.9 mm"), ("", "")):
        made = said(scene, "pinion", {"pins": "4.2 mm"}, f"{size} -0.03/-0.09 mm")
        assert bool(words) == any(
            re.search(words or "nominal size over", own) for own in check_scene(made).model.warnings
        )


@pytest.mark.parametrize(
    ("name", "part", "pins", "words"),
    [
        ("spur_pair", "pinion", "2 mm", r"measured.pins: pins of 2 mm touch no involute .* thicker ones; .* mm does"),
        ("spur_pair", "pinion", "9 mm", "measured.pins: pins of 9 mm .*cho"),
        ("bevel_pair", "driver", "3 mm", "expected arc or normal, got pins: 'driver' is a bevel gear"),
    ],
)
def test_pins_that_touch_no_flank_are_refused(name: str, part: str, pins: str, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        check_scene(said(load(name), part, {"pins": pins}, THIN))


@pytest.mark.parametrize(
    ("measured", "words"),
    [
        ({}, "either a span such as {span: 4}, or {pins: 3.5 mm}, got neither"),
        ({"span": 4, "pins": "4.2 mm"}, "either a span such as .* got span and pins"),
        ({"pins": "4.2 deg"}, r"measured.pins: expected a length"),
        ({"balls": "4.2 deg"}, "measured.balls: expected a length"),
        ("balls", "got balls"),
    ],
)
def test_a_measure_that_is_none_is_refused_in_a_line(measured: object, words: str) -> None:
    with pytest.raises(SceneError, match=words) as refused:
        said(load("spur_pair"), "pinion", measured, THIN)
    assert str(refused.value).count("\n") == 0


@pytest.mark.parametrize("name", ["rv_250aii", "reducer_3k"])
def test_gears_of_sets_and_first_stages_are_in_the_table(name: str) -> None:
    scene = load(name)
    gears = {part for part, spec in scene.parts.items() if isinstance(spec, GearSpec)}
    tables = [own for own in check_scene(scene).page.blocks if isinstance(own, Table)]
    sizes = next(own for own in tables if own.corner == "[mm]")
    assert {row.label for row in sizes.rows if row.label} == gears
    for row in sizes.rows:
        nominal, thinnest, thickest = numbers(row)
        grows = -1 if "between" in str(row.cells[0]) or "spaces" in str(row.cells[0]) else 1
        assert grows * thinnest < grows * thickest <= grows * nominal


@pytest.mark.parametrize(
    ("name", "part", "teeth", "words"),
    [
        ("spur_pair", "pinion", 9, "over 9 teeth touch .* outside the involute .* expected "),
        ("reducer_3k", "sun", 12, "outside the involute"),
        ("bevel_pair", "driver", 3, "expected arc or normal, got a span: 'driver' is a bevel gear"),
    ],
)
def test_a_span_that_touches_no_flank_is_refused(name: str, part: str, teeth: int, words: str) -> None:
    with pytest.raises(SceneError, match=words) as refused:
        check_scene(said(load(name), part, {"span": teeth}, THIN))
    assert "measured" in str(refused.value)


def test_bevel_gears_have_their_arc_alone() -> None:
    (table,) = (own for own in drawing_sizes(check_scene("bevel_pair").model) if isinstance(own, Table))
    assert [row.cells[0] for row in table.rows] == ["arc, mean section"] * 2
