"""Tables, pictures, meshes and views of a small run: every number in them against the run or a closed form."""

import math
import re
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import fcl
import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from loose_summaries import typed_measure, typed_run
from matplotlib.image import imread
from of_kind import known, of_kind
from places import SCENES, SPUR_PAIR
from printing import printed, row_of
from rendering import renders
from rich.console import RenderableType
from scene_texts import scene_of
from scipy.stats import norm

from tol3d import load_scene
from tol3d.apps.adjustment.compensation import CompensationQuestion, compensation
from tol3d.apps.adjustment.compensation_table import swing_table
from tol3d.cad.solids import display_mesh
from tol3d.errors import InputError
from tol3d.gearing.shown.display import seated_build
from tol3d.gearing.shown.placed import DISPLAY_DEFLECTION, OPEN_SHARE
from tol3d.gearing.system import gear_model
from tol3d.gears import LEFT, RIGHT, SpurGear, SpurPair
from tol3d.report import (
    check_report,
    comparison_report,
    draw_comparison,
    draw_histogram,
    export_run,
    run_report,
    view_run,
)
from tol3d.report.bars import bars_of
from tol3d.report.canvas import VERMILLION, new_figure
from tol3d.report.chart_figure import charts_figure
from tol3d.report.compare import difference_of, measures_of
from tol3d.report.comparison_picture import comparison_figure
from tol3d.report.drawn_chart import draw_panel
from tol3d.report.export import Exported, file_words
from tol3d.report.measure_charts import curve, histogram
from tol3d.report.page import Heading, Row, Table
from tol3d.report.share_charts import pareto
from tol3d.report.table import Detail
from tol3d.simulate import Overrides, run_scene, simulation_again, simulation_of
from tol3d.study.results.replaying import build_of
from tol3d.study.runs.run import Run

SCENE = """
scene: small pair, 5 $ a piece [cheap]
parts:
  pinion: {kind: spur_gear, teeth: 18, module: 2 mm, face_width: 10 mm, profile_shift: 0.2, bore: 10 mm,
           expansion: 11.5e-6 1/K}
  the wheel: {kind: spur_gear, teeth: 25, module: 2 mm, face_width: 8 mm, profile_shift: 0.1, bore: 12 mm}
tolerances:
  pinion thickness: {kind: tooth_thickness, of: pinion, distribution: {kind: normal, lower: -40 um, upper: -20 um}}
  wheel thickness: {kind: tooth_thickness, of: the wheel, distribution: {kind: uniform, lower: -36 um, upper: -26 um}}
  eccentricity $1: {kind: eccentricity, of: the wheel, distribution: {kind: rayleigh, scale: 5 um}}
  centre distance: {kind: centre_distance, of: gear pair, distribution: {kind: normal, lower: -15 um, upper: 15 um}}
  warm: {kind: temperature, of: pinion, distribution: {kind: uniform, lower: 0 K, upper: 20 K}}
moves:
  gear pair: {kind: mesh, driver: pinion, driven: the wheel, centre_distance: 43.59 mm, working_flank: left}
measures:
  free play: {kind: normal_backlash, of: gear pair, lower_limit: 62 um, upper_limit: 400 um}
  turn of [wheel]: {kind: angular_backlash, of: gear pair}
  shape: {kind: normal_backlash, of: gear pair, over: turn, take: curve, positions: 4}
study: {trials: 24, seed: 5, witness: 6, profile_steps: 60}
published:
  a colleague: {free play: {low_3sigma: 50 um, mean: 71.5 um, high_3sigma: 90 um, contributors: {warm: 3.5}}}
"""
TRIAL = 7
FLOAT32_NOISE = 2e-5  # mm; files keep single precision: 2^-24 of the 44 mm between the axes, in three coordinates
GREEN, RED = (0, 113, 79), (192, 58, 0)  # of the marks at contact and gap


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("report")
    (folder / "small.yaml").write_text(SCENE, encoding="utf-8")
    return run_scene(folder / "small.yaml", out=folder / "small")


# tables -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("width", [80, 120])
def test_run_report_fits_the_width_without_losing_a_word_or_a_number(run: Run, width: int) -> None:
    text = printed(run_report(run.found), width)
    assert max(len(line) for line in text.splitlines()) <= width
    assert "…" not in text
    assert "\x1b" not in text  # plain, since no terminal is there


def one_line(renderable: RenderableType) -> str:
    return " ".join(printed(renderable, 120).split())


def test_the_witness_is_told_below_each_measure_with_what_its_chords_explain(run: Run) -> None:
    text, measures = one_line(run_report(run.found)), run.summary["witness"]["measures"]
    assert list(measures) == list(run.summary["measures"])
    for name, to_text in (("free play", "{:.3f} µm".format), ("shape", "{:.3f} µm".format)):
        largest, chords = (to_text(measures[name][key]) for key in ("max_abs_difference", "expected_at_most"))
        assert (
            f"witness: FCL measured 6 of these trials again: within ±{largest} "
            f"(chord error of its triangles: up to {chords})"
        ) in text
    assert text.count("witness: FCL") == 3


def test_chord_errors_are_spoken_of_only_where_there_are_any(run: Run) -> None:
    without = dict(run.summary)
    without.pop("witness")
    text = one_line(run_report(typed_run(without)))
    assert "chord error" not in text
    assert text.count("3D simulation − analytic, trial by trial") == 2  # no curves
    by_fcl = one_line(run_report(typed_run(without | {"chord_error_um": 0.021})))
    assert by_fcl.count("up to 0.084 µm of normal backlash may be chord error (0.021 µm on each of 4 flanks)") == 2


NUMBER = re.compile(r"[-+±]?\d[\d.′″]*")


@pytest.mark.parametrize("width", [30, 40, 60])
def test_no_number_is_cut_in_a_narrow_terminal(run: Run, width: int) -> None:
    for report in (run_report(run.found), check_report(simulation_again(run)), comparison_report([run, run])):
        wide, narrow = printed(report, 300), printed(report, width)
        assert max(len(line) for line in narrow.splitlines()) <= width
        assert "…" not in narrow
        assert set(NUMBER.findall(wide)) <= set(NUMBER.findall(narrow))


@given(
    st.lists(st.lists(st.integers(0, 10**9).map(str), min_size=3, max_size=3), min_size=1, max_size=6),
    st.integers(25, 80),
)
def test_a_sheet_shows_every_cell_once_within_its_width(rows: list[list[str]], width: int) -> None:
    sheet = Table("of", [Heading(f"heading {k}") for k in range(3)], [Row("a label", cells) for cells in rows])
    lines = printed(sheet, width).splitlines()
    assert max(map(len, lines)) <= width
    assert sorted(re.findall(r"\d+", "\n".join(lines))) == sorted([*"012", *(cell for row in rows for cell in row)])


def test_rows_hold_the_statistics_of_the_columns(run: Run) -> None:
    text = printed(run_report(run.found), 120)
    values = {method: run.columns(f"{method}:free play")[f"{method}:free play"] for method in ("analytic", "geometric")}
    means = row_of(text, "mean")
    assert means[1:3] == [f"{values[method].mean():.3f}" for method in ("analytic", "geometric")]
    assert means[3] == "71.5"
    lows = [f"{v.mean() - 3 * v.std(ddof=1):.3f}" for v in values.values()]
    assert row_of(text, "low (−3 sigma)")[1:3] == lows
    assert row_of(text, "smallest")[1:3] == [f"{v.min():.3f}" for v in values.values()]
    below = [f"{100 * np.mean(v < 62):.4g}" for v in values.values()]
    assert row_of(text, "below 62 µm")[2:6:2] == below  # each with its %
    assert float(below[0]) > 0  # the limit lies inside the sample, or this says nothing


def test_a_closed_form_s_share_out_of_limits_is_that_of_a_normal(run: Run) -> None:
    form = run.summary["measures"]["free play"]["analytic_closed_form"]
    expected = 100 * norm.cdf(62, form["mean"], form["sigma"])
    shown, unit = row_of(printed(run_report(run.found), 120), "below 62 µm")[:2]
    assert unit == "%"
    assert float(shown) == pytest.approx(expected, rel=5e-4)  # four digits are shown


def test_lost_motion_is_normal_backlash_over_the_base_radius(run: Run) -> None:
    mean = run.summary["measures"]["free play"]["geometric"]["mean"]
    base_radius = 25 * math.cos(math.radians(20))  # m z cos(alpha) / 2 of 25 teeth, module 2
    minutes, seconds = divmod(math.degrees(mean / 1000 / base_radius) * 3600, 60)
    assert row_of(printed(run_report(run.found), 120), "lost motion, mean")[2] == f"{minutes:.0f}′{seconds:04.1f}″"


def test_contributors_are_sorted_by_the_share_of_the_simulation(run: Run) -> None:
    measure = run.summary["measures"]["free play"]
    text = printed(run_report(run.found), 120)
    names = sorted(measure["contributors"], key=lambda c: -c["geometric_percent"])
    lines = text.split("share [%]")[1].splitlines()[2 : 2 + len(names)]
    for line, contributor in zip(lines, names, strict=True):
        assert line.startswith(contributor["name"])
        assert f"{contributor['geometric_percent']:.1f} ±" in line.replace("-0.0", "0.0")


def test_what_no_contributor_explains_is_told_and_explained(run: Run) -> None:
    measure = run.summary["measures"]["free play"]
    whole = [c | {"analytic_percent": 20.0, "geometric_percent": 20.0} for c in measure["contributors"]]
    partly = [c | {"analytic_percent": 20.0, "geometric_percent": 18.0} for c in measure["contributors"]]
    texts = [
        printed(
            run_report(typed_run(dict(run.summary) | {"measures": {"m": dict(measure) | {"contributors": shares}}})),
            120,
        )
        for shares in (whole, partly)
    ]
    assert "not attributed" not in texts[0]
    assert row_of(texts[1], "not attributed") == ["0.0", "10.0", "–", "–"]  # nobody knows what a colleague left out
    assert "that a linear regression on the contributors does not explain" in texts[1]


def test_no_zero_has_a_sign(run: Run) -> None:
    measure = run.summary["measures"]["free play"]
    shares = [c | {"geometric_percent": -0.01} for c in measure["contributors"]]
    geometric = dict(measure["geometric"]) | {"ppk": -0.0001, "mean": -1e-5}
    measure = dict(measure) | {"contributors": shares, "geometric": geometric, "lower_limit": -0.0}
    text = printed(run_report(typed_run(dict(run.summary) | {"measures": {"free play": measure}})), 120)
    figure = charts_figure([[histogram("free play", typed_measure(measure)), pareto(typed_measure(measure))]])
    signed = re.compile(r"(?<![\d.])-0(\.0*)?(?![\d.])")
    assert not signed.search("\n".join([text, *(label.get_text() for axes in figure.axes for label in axes.texts)]))
    assert "0.000" in row_of(text, "Ppk")


def test_a_curve_says_how_many_of_its_positions_are_shown(run: Run) -> None:
    shape = run.summary["measures"]["shape"]
    assert "positions shown" not in printed(run_report(run.found), 120)
    curve = {
        method: own | {key: own[key] * 6 for key in ("mean", "sigma", "min", "max")}
        for method, own in shape["curve"].items()
    }
    long = dict(shape) | {"curve": curve, "position_deg": [float(k) for k in range(30)]}
    text = printed(run_report(typed_run(dict(run.summary) | {"measures": {"shape": long}})), 120)
    shown = [line for line in text.splitlines() if re.match(r" *\d+\.0  ", line)]
    assert len(shown) == 10
    assert "10 of 30 positions shown; all in summary.json" in text


def test_failed_trials_are_told_in_per_cent(run: Run) -> None:
    summary = dict(run.summary) | {"status": {"ok": 21, "interferes": 3, "no contact": 0}}
    for detail in (Detail.SHORT, Detail.MEASURES):
        text = printed(run_report(typed_run(summary), detail), 120)
        assert "trials: 21 assembled, 3 could not be assembled (12.5 %): 3 jammed" in text


def test_report_of_the_analytic_engine_has_no_column_of_a_simulation(run: Run) -> None:
    measures = {
        name: {key: value for key, value in measure.items() if key not in ("geometric", "agreement")}
        for name, measure in run.summary["measures"].items()
        if measure["take"] != "curve"
    }
    for measure in measures.values():
        measure["contributors"] = [c | {"geometric_percent": None} for c in measure["contributors"]]
    text = printed(run_report(typed_run(dict(run.summary) | {"measures": measures, "chord_error_um": None})), 80)
    assert "simulation" not in text
    assert "analytic" in text


AT_EDGE = 0.01  # the warm pinion's pitch is 115 ppm larger: contact begins at a tip edge, where the normal is another


@pytest.mark.parametrize("width", [80, 120])
def test_check_report_fits_and_shows_limits_and_coefficients(run: Run, width: int) -> None:
    simulation = simulation_again(run)
    model = gear_model(simulation.system)
    text = printed(check_report(simulation), width)
    assert max(len(line) for line in text.splitlines()) <= width
    laws, lengths, angles = re.split(r"contributors\n|free play, shape: .*\n|turn of \[wheel\]: .*\n", text)[1:]
    assert row_of(laws, "pinion thickness")[:3] == ["normal", "-40", "-20"]
    sine = math.sin(math.acos(43 * math.cos(math.radians(20)) / 43.59))  # of the working pressure angle
    arm = 25 * math.cos(math.radians(20))  # mm, base radius of the wheel
    expected = {
        "pinion thickness": -math.cos(math.radians(20)),
        "wheel thickness": -math.cos(math.radians(20)),
        "eccentricity $1": 2 * sine,
        "centre distance": 2 * sine,
    }
    for name, coefficient in expected.items():
        unit, analytic, found, _ = row_of(lengths, name)
        assert unit == "µm/µm"
        assert float(analytic) == pytest.approx(coefficient, abs=6e-4)
        assert float(found) == pytest.approx(coefficient, rel=AT_EDGE)
        unit, analytic, found, _ = row_of(angles, name)
        seconds = math.degrees(coefficient / arm / 1000) * 3600
        assert unit == "″/µm"
        assert float(analytic) == pytest.approx(seconds, abs=6e-3)
        assert float(found) == pytest.approx(seconds, rel=AT_EDGE)
    assert "43.5900" in text
    assert f"{of_kind(SpurPair, model.meshes[0].pair).contact_ratio:.4f}" in text


TWO_WAYS = """
scene: two ways
parts:
  in: {kind: shaft, carries: {p1: {}, p2: {at: 20 mm}}}
  out: {kind: shaft, carries: {w1: {}, w2: {at: 20 mm}}}
  p1: {kind: spur_gear, teeth: 20, module: 1 mm, face_width: 9 mm}
  p2: {kind: spur_gear, teeth: 20, module: 1 mm, face_width: 9 mm}
  w1: {kind: spur_gear, teeth: 40, module: 1 mm, face_width: 9 mm}
  w2: {kind: spur_gear, teeth: 40, module: 1 mm, face_width: 9 mm}
tolerances:
  t1: {kind: tooth_thickness, of: p1, distribution: {kind: normal, lower: -40 um, upper: -20 um}}
  t2: {kind: tooth_thickness, of: p2, distribution: {kind: normal, lower: -40 um, upper: -20 um}}
moves:
  m1: {kind: mesh, driver: p1, driven: w1, centre_distance: 30 mm}
  m2: {kind: mesh, driver: p2, driven: w2, centre_distance: 30 mm}
  two: {kind: train, driven: in, output: out}
measures:
  both: {kind: lost_motion, of: two}
  first: {kind: angular_backlash, of: m1}
study: {trials: 10}
"""


def test_check_names_the_measures_whose_shares_no_closed_form_tells(run: Run, tmp_path: Path) -> None:
    text = one_line(check_report(simulation_of(scene_of(TWO_WAYS, tmp_path))))
    assert "no shares of both: the tighter load path counts, which is no sum; run gives the shares of its" in text
    assert "no shares" not in one_line(check_report(simulation_again(run)))


def test_check_says_of_which_measures_the_shares_are_of_one_position() -> None:
    """The centre distance has 50 % of the least backlash of two_sided_te, at a random position 4.4 %."""
    text = one_line(check_report(simulation_of(load_scene(SCENES / "two_sided_te.yaml"))))
    assert " shares of least backlash, largest backlash: of the value at a random position; run gives those of" in text
    plain = one_line(check_report(simulation_of(load_scene(SCENES / "spur_pair.yaml"))))
    assert "shares of" not in plain


@pytest.mark.slow
def test_check_marks_coefficients_on_which_geometry_and_stack_up_disagree() -> None:
    text = printed(check_report(simulation_of(load_scene(SCENES / "bevel_pair.yaml"))), 80)
    # by an exact solver 0.5311 and 0.4358 where the stack-up has their mean, and nothing for axes that pass each other
    for name, cells in {
        "shaft angle": ["µm/µm", "+0.684", "+0.685", "11.7"],
        "axes offset": ["µm/µm", "+0.484", "≠", "+0.004", "4.7"],
        "driver back face": ["µm/µm", "+0.484", "≠", "+0.436", "2.1"],
        "driven back face": ["µm/µm", "+0.484", "≠", "+0.530", "2.1"],
    }.items():
        assert row_of(text.split("normal backlash: ")[1], name) == cells
    assert "the geometry disagrees by more than 5 %" in " ".join(text.split())


def test_coefficients_of_tilts_differ_below_and_above_the_mean(run: Run, tmp_path: Path) -> None:
    tilts = "  {0}: {{kind: {0}, of: gear pair, distribution: {{kind: uniform, lower: -9 um, upper: 9 um}}}}\n"
    assert "a tilt closes" not in printed(check_report(simulation_again(run)), 120)
    scene = tmp_path / "tilted.yaml"
    words = tilts.format("axis_in_plane") + tilts.format("axis_out_of_plane")
    scene.write_text(SCENE.replace("moves:\n", f"{words}moves:\n"), encoding="utf-8")
    text = printed(check_report(simulation_of(load_scene(scene))), 120)
    assert "axis_in_plane, axis_out_of_plane: a tilt closes the gap whichever way it goes" in text
    lost = math.sin(math.acos(43 * math.cos(math.radians(20)) / 43.59))  # half the face on both flanks, per face width
    for cell in row_of(text.split("free play, shape: ")[1], "axis_in_plane")[1:3]:
        assert [float(slope) for slope in cell.split("/")] == pytest.approx([lost, -lost], abs=6e-4)


def test_comparison_gives_the_largest_and_rms_difference_of_the_columns(run: Run) -> None:
    columns = run.columns("analytic:free play", "geometric:free play")
    difference = columns["geometric:free play"] - columns["analytic:free play"]
    text = printed(comparison_report([run]), 80)
    assert max(len(line) for line in text.splitlines()) <= 80
    line = next(line for line in text.splitlines() if " 3D " in line).split()
    assert line[-2:] == [f"{np.abs(difference).max():.3f}", f"{np.sqrt(np.mean(difference**2)):.3f}"]


@pytest.mark.slow
def test_measures_of_one_name_over_other_positions_are_compared_apart(run: Run) -> None:
    play = run.summary["measures"]["free play"]
    whole = {key: own for key, own in run.summary.items() if key != "joint"}  # which is of all its measures
    other = replace(run, summary=whole | {"measures": {"free play": play | {"over": "turn", "take": "min"}}})
    assert [m.take for m in measures_of([run, other]) if m.name == "free play"] == ["value", "min"]
    apart = printed(comparison_report([run, other]), 120)
    assert "\nnormal backlash of gear pair at a random position" in apart
    assert "\nsmallest normal backlash of gear pair over one turn" in apart
    assert apart.count("shift") == printed(comparison_report([run, run]), 120).count("shift") - 3  # nothing is shared
    rows = [len(comparison_figure(runs).axes) // 3 for runs in ([run, other], [run, run])]
    assert rows == [4, 3]


@pytest.mark.slow
def test_an_error_that_jumps_over_the_swing_has_no_mean_in_the_comparison(tmp_path: Path) -> None:
    scene = SCENES / "robot_shoulder_swing.yaml"
    swing = run_scene(scene, overrides=Overrides(trials=4, witness=0), out=tmp_path / "swing")
    errors = [name for name, measure in swing.summary["measures"].items() if measure["kind"] == "tip_error"]
    text = printed(comparison_report([swing]), 160)
    assert (
        len(errors)
        == text.count("no row: it is 0 with the load on one side and jumps where the load changes side")
        == 1
    )
    others = len(swing.summary["measures"]) - len(errors)
    assert [text.count(f" {method} ") for method in ("analytic   ", "3D   ")] == [others, others]
    for name in errors:
        below = text.split(f"\n{name}\n")[1].split("\n\n")[0]
        assert len(below.splitlines()) == 2


@pytest.mark.slow
def test_legends_of_a_comparison_lie_below_the_axes_and_hide_nothing(run: Run) -> None:
    figure = comparison_figure([run, run, run])
    figure.canvas.draw()
    rows = figure.axes[::3]
    assert len(rows) == 3
    for axes, below in zip(rows, [*rows[1:], None], strict=True):
        legend = known(axes.get_legend()).get_window_extent()
        assert legend.y1 <= axes.xaxis.label.get_window_extent().y0
        assert legend.y0 >= (below.title.get_window_extent().y1 if below else 0)
        assert (legend.x0 >= 0, legend.x1 <= known(figure.axes[1].get_tightbbox()).x0) == (True, True)


@pytest.mark.slow
def test_flanks_of_a_swing_with_several_changes_of_side_are_told_at_the_first(tmp_path: Path) -> None:
    scene = tmp_path / "swing.yaml"
    text = (SCENES / "robot_shoulder_swing.yaml").read_text("utf-8")
    for end, label in (("60", "spur pair: flank of the driver "), ("180", "of the driver at the first of 2 changes ")):
        scene.write_text(re.sub(r"start: -60 deg, end: 60 deg", f"start: -{end} deg, end: {end} deg", text), "utf-8")
        found = compensation(load_scene(scene), CompensationQuestion(None, 2, 4))
        lines = printed(swing_table([found]), 120).splitlines()
        assert sum(label in line for line in lines) == (1 if end == "60" else 2)


def test_comparing_nothing_is_refused() -> None:
    with pytest.raises(InputError, match="at least one run"):
        comparison_report([])


# pictures -----------------------------------------------------------------------------------------


@given(st.lists(st.integers(0, 10**6), min_size=1, max_size=64), st.floats(1e-3, 1e3))
def test_bars_hold_every_trial_once(counts: list[int], width: float) -> None:
    histogram = {"lower_edge": -3.0, "bin_width": width, "counts": {"analytic": counts}}
    bars = bars_of(typed_measure({"histogram": histogram}))["analytic"]
    held = float(np.sum(bars.density * np.diff(bars.edges)))
    assert held == pytest.approx(100.0 if sum(counts) else 0.0)
    first = np.flatnonzero(counts)[0] if sum(counts) else 0  # merging moves no count outside its bar
    merged = np.flatnonzero(bars.density)[0] if sum(counts) else 0
    assert bars.edges[merged] <= -3.0 + width * (first + 1e-9) < bars.edges[merged + 1]


def pixels_of(picture: Path, colour: tuple[int, ...], apart: int = 12) -> int:
    pixels = np.round(255 * imread(picture)[..., :3]).astype(int)
    return int(np.count_nonzero(np.abs(pixels - colour).max(axis=-1) <= apart))


def test_histogram_shows_what_is_out_of_limits_in_its_colour(run: Run, tmp_path: Path) -> None:
    """Moving the lower limit above the mean colours half of the bars; the line alone has far fewer pixels."""
    counted = {}
    colour = tuple(int(VERMILLION[k : k + 2], 16) for k in (1, 3, 5))
    for limit in (0.0, run.summary["measures"]["free play"]["geometric"]["mean"]):
        measure = dict(run.summary["measures"]["free play"]) | {"lower_limit": limit}
        draw_histogram(typed_run(dict(run.summary) | {"measures": {"free play": measure}}), tmp_path / f"{limit}.png")
        # bars are drawn with some white let through
        counted[limit] = pixels_of(tmp_path / f"{limit}.png", tuple(round(0.85 * c + 0.15 * 255) for c in colour))
    low, high = counted.values()
    assert high > 20 * max(low, 100)


def test_every_kind_of_measure_is_drawn(run: Run, tmp_path: Path) -> None:
    """Three rows: two histograms and a curve, in a picture as tall as they need."""
    draw_histogram(run.found, tmp_path / "all.png")
    one = dict([*run.summary["measures"].items()][:1])
    draw_histogram(typed_run(dict(run.summary) | {"measures": one}), tmp_path / "one.png")
    every, single = (imread(tmp_path / name) for name in ("all.png", "one.png"))
    assert every.shape[1] == single.shape[1]
    assert every.shape[0] > 2 * single.shape[0]
    assert (every[..., :3].std(axis=(1, 2)) > 0).mean() > 0.8  # rows of pixels with ink


def without_seats(run: Run, positions: set[int]) -> dict[str, Any]:
    """The curve of the run as if no trial had seated at some positions."""
    shape = run.summary["measures"]["shape"]
    own = shape["curve"]["geometric"]
    lost = {
        key: [None if k in positions else value for k, value in enumerate(own[key])]
        for key in ("mean", "sigma", "min", "max")
    }
    return dict(shape) | {"curve": dict(shape["curve"]) | {"geometric": dict(own) | lost}}


def test_a_curve_is_drawn_where_trials_seated_and_open_where_none_did(run: Run, tmp_path: Path) -> None:
    measure = without_seats(run, {1, 3})
    chart = curve("shape", typed_measure(measure))
    axes = new_figure(6, 4).add_subplot()
    draw_panel(axes, chart, chart.panels[0])
    (mean,) = (line for line in axes.lines if line.get_label() == "3D simulation, mean")
    assert np.isnan(mean.get_ydata()).tolist() == [False, True, False, True, False]
    draw_histogram(typed_run(dict(run.summary) | {"measures": {"shape": measure}}), tmp_path / "some.png")
    printed(run_report(typed_run(dict(run.summary) | {"measures": {"shape": measure}})), 80)


def test_a_curve_without_any_seated_trial_says_so(run: Run, tmp_path: Path) -> None:
    measure = without_seats(run, {0, 1, 2, 3, 4})
    measure["curve"]["analytic"] |= {key: [None] * 5 for key in ("mean", "sigma", "min", "max")}
    (axes,) = charts_figure([[curve("shape", typed_measure(measure))]]).axes
    assert "no trial gave a value" in [text.get_text() for text in axes.texts]
    draw_histogram(typed_run(dict(run.summary) | {"measures": {"shape": measure}}), tmp_path / "none.png")


@pytest.mark.slow
def test_signs_that_no_font_has_are_no_warning(run: Run, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        draw_histogram(typed_run(dict(run.summary) | {"scene": "歯車 🦷"}), tmp_path / "emoji.png")


def test_a_picture_of_another_format_is_refused(run: Run, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"ending in \.png"):
        draw_histogram(run.found, tmp_path / "histogram.docx")


@pytest.mark.slow
def test_a_picture_in_a_missing_folder_is_refused(run: Run, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        draw_comparison([run], tmp_path / "missing" / "c.png")


def test_difference_is_that_of_the_columns_at_their_positions(run: Run) -> None:
    found = known(difference_of(run, "free play"))
    names = ("analytic:free play", "geometric:free play", "position:gear pair [deg]")
    analytic, geometric, position = run.columns(*names).values()
    np.testing.assert_array_equal(found.values, geometric - analytic)
    np.testing.assert_array_equal(found.at, position % 360)
    assert found.largest == np.abs(geometric - analytic).max()
    assert float(np.sum(found.bars.density * np.diff(found.bars.edges))) == pytest.approx(100.0)


def test_comparison_of_two_runs_is_drawn(run: Run, tmp_path: Path) -> None:
    draw_comparison([run, run], tmp_path / "c.png")
    assert imread(tmp_path / "c.png")[..., :3].std() > 0.05


@pytest.mark.slow
def test_a_run_loads_neither_cad_nor_meshes_nor_views(run: Run, tmp_path: Path) -> None:
    """Its strips are cached by the fixture; the picture and the table are made too."""
    program = (
        "import json, sys; from pathlib import Path; from tol3d.simulate import run_scene, Overrides, Watch\n"
        "from tol3d.report import draw_histogram, run_report\n"
        "from tol3d.study.runs.summary.text import typed\n"
        "found = lambda summary: typed(json.loads(json.dumps(summary)), ValueError)\n"
        f"run = run_scene({str(run.path.parent / 'small.yaml')!r}, out=sys.argv[1], overrides=Overrides(trials=2),\n"
        "    watch=Watch(finisher=lambda place, summary: draw_histogram(found(summary), place / 'h.png')))\n"
        "run_report(run.found)\n"
        "print(sorted({'trimesh', 'pyvista', 'vtk', 'cadquery', 'matplotlib.pyplot'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program, str(tmp_path / "r")], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "[]"


# meshes -------------------------------------------------------------------------------------------


def flank_triangles(mesh: trimesh.Trimesh, axis: tuple[float, float], side: int) -> fcl.CollisionObject:
    """Triangles of right (+1) or left flanks, told by their normals alone: right ones look against the azimuth."""
    outward = mesh.triangles_center[:, :2] - axis
    around = np.stack([-outward[:, 1], outward[:, 0]], axis=1) / np.linalg.norm(outward, axis=1, keepdims=True)
    facing = (mesh.face_normals[:, :2] * around).sum(axis=1)
    chosen = mesh.faces[(-side * facing > 0.5)]
    hierarchy = fcl.BVHModel()
    hierarchy.beginModel(len(mesh.vertices), len(chosen))
    hierarchy.addSubModel(np.asarray(mesh.vertices), np.asarray(chosen))
    hierarchy.endModel()
    return fcl.CollisionObject(hierarchy, fcl.Transform())


def distance(first: fcl.CollisionObject, second: fcl.CollisionObject) -> float:
    return float(fcl.distance(first, second, fcl.DistanceRequest(), fcl.DistanceResult()))


def loaded(exported: Exported, fmt: str) -> list[trimesh.Trimesh]:
    """The exported pinion and wheel in mm."""
    if fmt == "glb":
        scene = trimesh.load_scene(exported.files[0])
        return [scene.geometry[name].copy().apply_transform(scene.graph[name][0]).apply_scale(1000)
                for name in ("pinion", "the wheel")]  # fmt: skip
    return [trimesh.load_mesh(path) for path in exported.files]


@pytest.mark.parametrize("fmt", ["glb", "ply", "stl"])
def test_exported_trial_is_the_trial_that_ran(run: Run, tmp_path: Path, fmt: str) -> None:
    """Working flanks touch and non-working ones are as far apart as the trial's column says.

    Both within the chord errors of the display meshes and of the measuring strips, two flanks each, at the
    contact and at the gap; the meshes are told apart and measured without a pose of ours.
    """
    pinion, wheel = loaded(export_run(run, TRIAL, fmt, out=tmp_path), fmt)
    assert pinion.is_watertight
    assert wheel.is_watertight
    model = gear_model(simulation_again(run).system)
    shown = sum(display_mesh(part.gear, DISPLAY_DEFLECTION).chord_error for part in model.gears)
    measured = 2 * run.summary["chord_error_um"] / 1000
    axis = tuple(wheel.bounding_box.centroid[:2])
    sides = {side: distance(flank_triangles(pinion, (0, 0), side), flank_triangles(wheel, axis, side))
             for side in (RIGHT, LEFT)}  # fmt: skip
    column = run.columns("geometric:free play")["geometric:free play"][TRIAL] / 1000
    assert sides[LEFT] == pytest.approx(0.0, abs=shown + measured + FLOAT32_NOISE)
    assert sides[RIGHT] == pytest.approx(column, abs=shown + measured + FLOAT32_NOISE)
    assert column > 10 * (shown + measured + FLOAT32_NOISE)


def test_step_holds_the_perturbed_solids(run: Run, tmp_path: Path) -> None:
    """Their volumes are those of the gears' exact sections, thickness deviation and growth included."""
    cadquery = pytest.importorskip("cadquery")
    exported = export_run(run, TRIAL, "step", out=tmp_path)
    solids = cadquery.importers.importStep(str(exported.files[0])).solids().vals()
    seated = seated_build(*build_of(run, TRIAL)).meshes[0]
    for solid, part in zip(solids, (seated.driver, seated.driven), strict=True):
        gear, nominal = of_kind(SpurGear, part.perturbed), of_kind(SpurGear, part.gear)
        exact = (gear.transverse_area - math.pi * gear.bore**2 / 4) * gear.face_width
        plain = (nominal.transverse_area - math.pi * gear.bore**2 / 4) * gear.face_width
        assert solid.Volume() == pytest.approx(exact, rel=1e-6)
        assert abs(exact - plain) > 1e-5 * exact  # so that the deviation shows in it


def test_parts_of_like_names_are_exported_to_files_of_their_own(run: Run, tmp_path: Path) -> None:
    scene = tmp_path / "like.yaml"
    scene.write_text(SCENE.replace("the wheel", "Gear_1").replace("pinion", "gear 1"), encoding="utf-8")
    like = run_scene(scene, out=tmp_path / "like", overrides=Overrides(trials=2, engine="analytic"))
    files = export_run(like, 0, "stl", out=tmp_path).files
    assert [path.name for path in files] == ["trial-0-gear_1.stl", "trial-0-Gear_1_2.stl"]
    teeth = [trimesh.load_mesh(path).bounding_box.extents[2] for path in files]
    assert teeth == pytest.approx([10.0, 8.0], rel=1e-3)  # their face widths


@given(st.lists(st.sampled_from(["a b", "a_b", "A_B", "a_b_2", "a?b", "c"]), unique=True))
def test_file_words_all_differ_even_if_case_does_not_count(names: list[str]) -> None:
    words = file_words(names)
    assert list(words) == names
    assert len({word.casefold() for word in words.values()}) == len(names)


def test_step_is_not_magnified(run: Run, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="leave out --magnify"):
        export_run(run, TRIAL, "step", magnify=2, out=tmp_path)


def test_magnified_gap_grows_along_the_stack_up(run: Run) -> None:
    """j(X) = j(0) + X (j(1) - j(0)), to second order: squares of 20 um times X over the gears' 20 mm, times X^2."""
    factor = 8.0
    nominal = gear_model(simulation_again(run).system).meshes[0].pair.normal_backlash
    plain, magnified = (seated_build(*build_of(run, TRIAL), magnify=x).meshes[0] for x in (1.0, factor))
    expected = nominal + factor * (plain.gap_value - nominal)
    second_order = 4 * (factor * 0.020) ** 2 / 20
    assert magnified.gap_value == pytest.approx(expected, abs=second_order)
    assert magnified.gap_value > 2 * plain.gap_value
    np.testing.assert_allclose(  # the driver stays where it was, but for its centre's offset
        magnified.driver.world_from_gear[:3, :3], plain.driver.world_from_gear[:3, :3], atol=1e-12
    )


@pytest.mark.slow
def test_magnification_is_capped_where_the_gap_would_leave_its_space_or_a_tip_would_fold(run: Run) -> None:
    assembly = seated_build(*build_of(run, TRIAL), magnify=1e4)
    seated = assembly.meshes[0]
    widest = OPEN_SHARE * seated.driver.gear.base_pitch
    assert 1 < assembly.magnify < 1e4
    assert seated.gap_value <= widest
    assert all(part.unfolded for part in (seated.driver, seated.driven))
    wanted = 1.03 * assembly.magnify  # 1e4 in 2^16 steps is within 1.2 %, three digits within 1 %
    assert seated_build(*build_of(run, TRIAL), magnify=wanted).magnify < wanted
    assert f"magnified {assembly.magnify:g} times, not 10000" in assembly.notes[0]
    assert seated.tip_clearance > 0


def test_a_magnified_tip_keeps_its_points_in_their_order(run: Run) -> None:
    """Told by azimuths alone: corners that pass the points between them would fold the tip."""
    for magnify, whole in (
        (1.0, True),
        (seated_build(*build_of(run, TRIAL), magnify=1e4).magnify, True),
        (60.0, False),
    ):
        part = seated_build(*build_of(run, TRIAL)).meshes[0].driver
        part = replace(part, flank_turn=magnify * part.flank_turn)
        display = display_mesh(part.gear, DISPLAY_DEFLECTION)
        moved = display.thickened(part.flank_turn)
        tip = np.abs(np.hypot(*display.vertices[:, :2].T) - of_kind(SpurGear, part.gear).tip_radius) < 1e-6
        tip &= np.abs(display.vertices[:, 2] - display.vertices[:, 2].max()) < 1e-6
        tip &= np.abs(np.arctan2(display.vertices[:, 1], display.vertices[:, 0])) < math.pi / part.gear.teeth  # tooth 0
        before, after = (np.arctan2(shape[tip, 1], shape[tip, 0]) for shape in (display.vertices, moved))
        assert bool((np.diff(after[np.argsort(before)]) >= 0).all()) is whole
        assert part.unfolded is whole


def test_no_magnification_at_all_is_the_nominal_build(run: Run) -> None:
    """Only the driver's position differs: nominal builds have the same backlash at any."""
    none, nominal = seated_build(*build_of(run, TRIAL), magnify=0.0), seated_build(*build_of(run, "nominal"))
    assert none.meshes[0].gap_value == pytest.approx(nominal.meshes[0].gap_value, abs=1e-8)  # mm; where steps end
    assert none.label == f"trial-{TRIAL}-x0"


def test_worst_is_the_trial_nearest_to_a_limit(run: Run) -> None:
    values = run.columns("geometric:free play")["geometric:free play"]
    assert seated_build(*build_of(run, "worst")).label == f"trial-{np.argmin(values)}"


def test_marks_lie_on_both_gears(run: Run) -> None:
    """Contact and gap ends are on the meshes' surfaces, within their chord errors."""
    seated = seated_build(*build_of(run, TRIAL)).meshes[0]
    within = 2e-3 * run.summary["chord_error_um"] + 2 * DISPLAY_DEFLECTION
    surfaces = []
    for part in (seated.driver, seated.driven):
        vertices, triangles = part.mesh()
        hierarchy = fcl.BVHModel()
        hierarchy.beginModel(len(vertices), len(triangles))
        hierarchy.addSubModel(vertices, triangles)
        hierarchy.endModel()
        surfaces.append(fcl.CollisionObject(hierarchy, fcl.Transform()))
    radius = 0.01
    for point, outwards, surface in (
        (seated.contact, seated.normal, surfaces[0]),
        (seated.contact, -seated.normal, surfaces[1]),
        (seated.gap[0], seated.gap[1] - seated.gap[0], surfaces[0]),
        (seated.gap[1], seated.gap[0] - seated.gap[1], surfaces[1]),
    ):
        # a ball that rests on the surface at the point: off by `lift` it is that far away
        lift = 0.02
        centre = point + (radius + lift) * outwards / np.linalg.norm(outwards)
        ball = fcl.CollisionObject(fcl.Sphere(radius), fcl.Transform(centre))
        assert distance(surface, ball) == pytest.approx(lift, abs=within)
    assert np.linalg.norm(seated.gap[1] - seated.gap[0]) == pytest.approx(seated.gap_value, abs=1e-9)


@pytest.mark.parametrize(
    ("which", "fmt", "message"),
    [(24, "glb", "expected 0 to 23"), ("best", "glb", "got 'best'"), (0, "obj", "expected one of stl, ply, glb, step")],
)
def test_what_is_not_there_is_refused_in_words(run: Run, tmp_path: Path, which: str, fmt: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        export_run(run, which, fmt, out=tmp_path)


def test_magnify_must_be_a_number(run: Run) -> None:
    with pytest.raises(InputError, match="at least 0"):
        seated_build(*build_of(run, TRIAL), magnify=math.nan)


def test_export_where_nothing_can_be_written_is_refused(run: Run, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="choose another folder"):
        export_run(run, TRIAL, "stl", out=tmp_path / "file")


# view ---------------------------------------------------------------------------------------------


@pytest.mark.slow
@renders
def test_view_marks_contact_and_gap_and_keeps_quiet(
    run: Run, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "view.png"
    notes = view_run(run, TRIAL, screenshot=picture, magnify=5)
    assert any("magnified 5 times" in note for note in notes)
    assert capfd.readouterr().err == ""
    assert pixels_of(picture, GREEN, apart=20) > 2000  # the contact's label alone is 80 x 25 pixels
    assert pixels_of(picture, RED, apart=20) > 2000
    assert pixels_of(picture, (255, 255, 255), apart=24) > 10_000  # one looks through the gap, and round the gears


def test_a_window_without_a_display_is_refused(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    if sys.platform != "linux":
        pytest.skip("only X needs DISPLAY")
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(InputError, match="--screenshot"):
        view_run(run, TRIAL)


def test_perturbed_gear_is_the_mesh_turned_flank_by_flank(run: Run) -> None:
    """A gear made with its deviation and growth has the flanks of the display mesh that was only turned and scaled."""
    part = seated_build(*build_of(run, TRIAL)).meshes[0].driver
    at_origin = replace(part, world_from_gear=np.eye(4))
    vertices, _ = at_origin.mesh()
    gear = of_kind(SpurGear, part.perturbed)
    display = display_mesh(part.gear, DISPLAY_DEFLECTION)
    radius = np.hypot(vertices[:, 0], vertices[:, 1])
    on_flank = (display.side == RIGHT) & (radius > gear.form_radius + 1e-6)
    rolls = np.sqrt(np.maximum((radius[on_flank] / gear.base_radius) ** 2 - 1, 0))
    exact = gear.flank_points(rolls, RIGHT)
    azimuth = np.arctan2(vertices[on_flank, 1], vertices[on_flank, 0]) - np.arctan2(exact[:, 1], exact[:, 0])
    off = np.abs((azimuth + gear.angular_pitch / 2) % gear.angular_pitch - gear.angular_pitch / 2)
    assert on_flank.sum() > 500
    assert (off * radius[on_flank]).max() < 1e-5  # mm; the CAD spline is true to 0.01 um


def test_the_process_that_draws_pictures_loads_no_runs_and_no_models() -> None:
    code = "import sys, tol3d.report.histogram_process as _; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    heavy = {"pyarrow", "tol3d.study.runs.run", "tol3d.gearing.model", "scipy", "cadquery"}
    assert sorted(heavy.intersection(loaded)) == []


def test_runs_of_one_seed_say_which_contributors_are_called_otherwise(tmp_path: Path) -> None:
    renamed = tmp_path / "renamed.yaml"
    renamed.write_text(SPUR_PAIR.read_text("utf-8").replace("reducer run-out:", "run-out of the reducer:"), "utf-8")
    few = Overrides(trials=200, engine="analytic", witness=0)
    runs = [run_scene(scene, overrides=few, out=tmp_path / scene.stem) for scene in (SPUR_PAIR, renamed)]
    said = " ".join(printed(comparison_report(runs), 200).split())
    assert "only in the first run: reducer run-out; only in the second: run-out of the reducer. Draws go by" in said
    assert "Draws go by" not in printed(comparison_report(runs[:1] * 2), 200)
