"""Tooth thickness by limits of the measured size itself, as shops type them: a span W_k, a size over pins M_dK."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from scene_texts import edited, refusal_at, scene_of, written
from scipy.optimize import brentq

import tol3d
from tol3d import InputError, check_scene
from tol3d.analyses.kept_changes import in_numbers, scene_with
from tol3d.analyses.response import Response, response_of
from tol3d.analyses.stated_changes import Change, change_of
from tol3d.analyses.stated_sizes import nominals_of
from tol3d.report.check import drawn_limits
from tol3d.report.page import Table
from tol3d.scene import Scene
from tol3d.scene.load import scene_of_text
from tol3d.simulate import Overrides, load, simulation_of
from tol3d.statistics.distributions.drawn import typed_sizes

PAIR = """
scene: limits as shops type them
default_law: {kind: normal, sigmas: 3}
parts:
  pinion: {kind: spur_gear, teeth: 24, module: 2 mm, face_width: 18 mm, profile_shift: 0.1}
  wheel: {kind: spur_gear, teeth: 36, module: 2 mm, face_width: 16 mm}
tolerances:
  pinion thickness: {kind: tooth_thickness, of: pinion, measured: {span: 3}, distribution: 15.489 / 15.517 mm}
  wheel thickness:
    kind: tooth_thickness
    of: wheel
    measured: {pins: 3.5 mm}
    distribution: {limits: 76.87/76.93 mm, law: {kind: uniform}}  # over pins
moves:
  gears: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 60.4 mm}
measures:
  normal backlash: {kind: normal_backlash, of: gears}
study: {trials: 200, seed: 4}
"""
SPAN, PINS = "pinion thickness", "wheel thickness"
ALPHA = math.radians(20)
INVOLUTE = math.tan(ALPHA) - ALPHA
NOMINAL_SPAN = 2 * math.cos(ALPHA) * (math.pi * 2.5 + 24 * INVOLUTE) + 2 * 0.1 * 2 * math.sin(ALPHA)
"""W_k = m cos α (π (k - ½) + z inv α) + 2 x m sin α [mm]; ISO 21771-1."""


def over_pins(arc: float) -> float:
    """M of the wheel [mm] whose teeth have an arc: inv α_K = (s + D/cos α)/d + inv α - π/z."""
    wanted = arc / 72 + 3.5 / (72 * math.cos(ALPHA)) + INVOLUTE - math.pi / 36
    angle = brentq(lambda own: math.tan(own) - own - wanted, 0.1, 1.0, xtol=1e-14)
    return float(72 * math.cos(ALPHA) / math.cos(angle) + 3.5)


def arc_over_pins(size: float) -> float:
    """The arc at which the size over pins has a value."""
    return float(brentq(lambda arc: over_pins(arc) - size, 2.5, 3.5, xtol=1e-13))


def responses(scene: Scene) -> Response:
    return response_of(simulation_of(scene), analytic=True)


def change(scene: Scene, text: str) -> Change:
    simulation = simulation_of(scene)
    return change_of(response_of(simulation, analytic=True), text, nominals=nominals_of(scene, simulation.lines))


def test_limits_of_a_span_and_over_pins_are_deviations_from_the_gear_s_own(tmp_path: Path) -> None:
    laws = {own.name: own.distribution for own in check_scene(written(PAIR, tmp_path)).model.contributors}
    expected = [own - NOMINAL_SPAN for own in (15.489, 15.517)]
    assert (laws[SPAN].low, laws[SPAN].high) == pytest.approx(expected, abs=1e-12)
    arcs = [arc_over_pins(own) - math.pi for own in (76.87, 76.93)]
    assert (laws[PINS].low, laws[PINS].high) == pytest.approx(arcs, abs=1e-9)
    assert max(expected) < 0.0
    assert max(arcs) < 0.0


def test_check_shows_them_as_typed_beside_their_deviations(tmp_path: Path) -> None:
    (table,) = (own for own in drawn_limits(scene_of(PAIR, tmp_path)) if isinstance(own, Table))
    rows = {row.label: tuple(str(cell) for cell in row.cells) for row in table.rows}
    ends = [[own - NOMINAL_SPAN for own in (15.489, 15.517)], [own - over_pins(math.pi) for own in (76.87, 76.93)]]
    told = [[f"{round(1e3 * own, 3):g} µm" for own in pair] for pair in ends]
    assert rows == {
        SPAN: ("15.489 / 15.517 mm", *told[0], "normal"),
        PINS: ("76.87/76.93 mm", *told[1], "uniform"),
    }


@pytest.mark.parametrize(
    ("part", "measured", "size"),
    [("pinion", "{span: 3}", 15.489), ("ring", "{span: 7}", 0.0), ("ring", "{balls: 2.5 mm}", 0.0)],
)
def test_sizes_and_deviations_of_the_same_limits_draw_the_same(part: str, measured: str, size: float) -> None:
    """Also of a ring, whose sizes over spaces and between balls grow as its teeth get thinner."""
    scene = load("internal_pair")
    (name,) = (
        own for own, spec in scene.tolerances.items() if getattr(spec, "of", "") == part and "thick" in spec.kind
    )
    kind, number = measured.strip("{}").split(": ")
    over = {kind: int(number) if kind == "span" else number}
    sign = 1 if part == "ring" else -1
    law = {"kind": "uniform"}
    deviations = scene.with_(
        {
            f"tolerances.{name}.measured": over,
            f"tolerances.{name}.distribution": {
                "limits": "+0.07/+0.04 mm" if sign > 0 else "-0.04/-0.07 mm",
                "law": law,
            },
        }
    )
    lines = simulation_of(deviations).lines
    nominal = nominals_of(deviations, lines)[name]
    ends = sorted(nominal + sign * own for own in (0.04, 0.07))
    text = f"{ends[0]:.12f} / {ends[1]:.12f} mm"
    typed = deviations.with_({f"tolerances.{name}.distribution": {"limits": text, "law": law}})
    found = [
        own.values(*own.drawn(20, seed=3)).values for own in (tol3d.response(each) for each in (deviations, typed))
    ]
    np.testing.assert_allclose(found[0], found[1], atol=1e-7)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("15.489 / 15.517", "21.39 / 21.42", "nominal span over 3 teeth of 15.5697 mm, got 21.39 / 21.42 mm, which is "
         "near the span over 4 teeth, 21.4740 mm; look at k"),
        ("15.489 / 15.517", "3.57 / 3.58", "near the span over 1 teeth, 3.7612 mm; look at k"),
        ("15.489 / 15.517", "17.5 / 17.6", "got 17.5 / 17.6 mm; look at teeth, module and profile shift"),
        ("76.87/76.93", "80.5/80.6", "nominal size over pins of 3.5 mm of 76.9927 mm, got 80.5/80.6 mm; look at teeth"),
        ("76.87/76.93", "60/61", "expected a size over pins of 3.5 mm of at least 71.1579 mm, got 60.5000 mm"),
        ("15.489 / 15.517", "15.517 / 15.517", "expected two different limits"),
        ("15.489 / 15.517 mm", "[15.489 mm, 15.517 mm]", "as deviations they are -0.08073/-0.05273 mm, as limits "
         "of the size 15.489 / 15.517 mm"),
        ("measured: {span: 3}", "measured: normal", "expected beside limits of a size what is measured, measured: "
         "{span: 3} (nominal 15.5697 mm), {pins: …} or {balls: …}, got measured: normal (limits of a deviation have"),
        ("    measured: {pins: 3.5 mm}\n", "", "measured: {span: …}, {pins: …} or {balls: …}, got measured: arc"),
        ("{pins: 3.5 mm}", "{pins: 1 mm}", "pins of 1 mm touch no involute of this gear: choose thicker ones"),
    ],
)  # fmt: skip
def test_sizes_that_cannot_be_are_refused_in_one_line(tmp_path: Path, old: str, new: str, words: str) -> None:
    told = refusal_at(edited(PAIR, (old, new)), tmp_path)
    assert words in told
    assert "\n" not in told


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("15.489 / 15.517", "15.6 / 15.62", "thicker ones in every build; sizes of a drawing are smaller than the "
         "nominal 15.5697 mm: look at k, pins, x and teeth"),
        ("76.87/76.93", "76.93/76.87", "expected the lower limit of the size first, got 76.93/76.87 mm; read as 76.87 "
         "mm to 76.93 mm"),
    ],
)  # fmt: skip
def test_sizes_on_the_wrong_side_and_reversed_ones_are_warned_of(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    (warning,) = simulation_of(load(written(edited(PAIR, (old, new)), tmp_path)), Overrides()).warnings
    assert words in warning
    assert not simulation_of(scene_of(PAIR, tmp_path)).warnings


@pytest.mark.parametrize("words", ["10/30 um", "23.3 .. 23.4 mm", "1 mm … 2 mm"])
def test_sizes_of_what_has_no_measured_size_are_refused(tmp_path: Path, words: str) -> None:
    centre = f"tolerances:\n  centre: {{kind: centre_distance, of: gears, distribution: {words}}}"
    told = refusal_at(edited(PAIR, ("tolerances:", centre)), tmp_path)
    assert "tolerances.centre.distribution: expected a tooth_thickness of a cylindrical gear, measured: {span" in told
    assert "(limits of a deviation have signs, as in +0.12/0 mm), got another deviation" in told


def test_what_ifs_read_sizes_and_keep_the_typed_words(tmp_path: Path) -> None:
    """Twice as narrow about the middle, in the order and with the digits of the file."""
    scene = scene_of(PAIR, tmp_path)
    law = responses(scene).drawn_by(PINS).distribution
    changes = [change(scene, f"{SPAN}=15.45/15.47 mm"), Change(PINS, factor=0.5)]
    kept = scene_with(responses(scene), scene, changes)
    assert "measured: {span: 3}, distribution: 15.45 / 15.47 mm}" in kept.text
    assert "distribution: {limits: 76.885/76.915 mm, law: {kind: uniform}}  # over pins" in kept.text
    assert in_numbers(scene, kept) == {}
    again = scene_of_text(scene.source, kept.text.encode(), scene.grammar, files=scene.files)
    found = {own.name: own.distribution for own in simulation_of(again).system.contributors}
    assert (found[SPAN].low, found[SPAN].high) == pytest.approx(
        [own - NOMINAL_SPAN for own in (15.45, 15.47)], abs=1e-10
    )
    assert found[PINS].high - found[PINS].low == pytest.approx((law.high - law.low) / 2, rel=1e-3)
    over = change(scene, f"{PINS}=76.80 / 76.84 mm")
    assert over.limits == pytest.approx([arc_over_pins(own) - math.pi for own in (76.80, 76.84)], abs=1e-9)


def test_a_span_that_deviations_state_takes_sizes_too_and_stays_as_it_is_written(tmp_path: Path) -> None:
    scene = scene_of(edited(PAIR, ("15.489 / 15.517 mm", "-52.7/-80.7 um")), tmp_path)
    kept = scene_with(responses(scene), scene, [change(scene, f"{SPAN}=15.52/15.47 mm")])
    ends = re.findall(r"measured: {span: 3}, distribution: (\S+)/(\S+) um}", kept.text)
    assert np.array(ends, float) == pytest.approx(1e3 * (np.array([[15.52, 15.47]]) - NOMINAL_SPAN), abs=1e-6)
    with pytest.raises(InputError, match="no size such as a span is measured here, got '1 / 2 mm'"):
        change_of(responses(scene), f"{SPAN}=1 / 2 mm")


def test_dumped_scenes_have_the_typed_words(tmp_path: Path) -> None:
    scene = scene_of(PAIR, tmp_path)
    text = scene.model_copy(update={"description": "made in Python"}).dump()
    again = scene_of(text, tmp_path)
    assert again.tolerances == scene.tolerances
    drawn = [own.distribution.drawn for own in again.distributed.values()]
    assert [typed_sizes(own) for own in drawn] == ["15.489 / 15.517 mm", "76.87/76.93 mm"]
