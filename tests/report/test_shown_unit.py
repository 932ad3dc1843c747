"""Lengths of assemblies over 1 mm are shown in mm, with their limits; their spread in um, as its label says."""

import re
from collections.abc import Iterator
from pathlib import Path
from types import NoneType
from typing import Any, get_args, get_origin

import pytest
from scene_texts import scene_of

from tol3d import Run, run_scene
from tol3d.assembly.summary_types import AssemblyMeasureSummary
from tol3d.report.check import check_report
from tol3d.report.histogram import histogram_figure
from tol3d.report.sheet import as_text
from tol3d.report.shown_unit import BUILDS, LENGTHS, shown_run
from tol3d.report.table import Detail, run_report
from tol3d.simulate import Overrides, simulation_of
from tol3d.study.runs.summary.agreement import Witnessed
from tol3d.study.runs.summary.values import Section

MIDDLE, SIGMA = 40.22, 0.01  # mm
SCENE = f"""
scene: a post and a step
parts:
  base:
    kind: solid
    features:
      floor: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [20 mm, 20 mm]}}
      post: {{kind: plane, at: [0 mm, 0 mm, {MIDDLE} mm], normal: [0, 0, 1], extent: [20 mm, 20 mm]}}
      step: {{kind: plane, at: [30 mm, 0 mm, 0.99 mm], normal: [0, 0, 1], extent: [20 mm, 20 mm]}}
tolerances:
  post: {{kind: plus_minus, of: base.post, distribution: {{kind: normal, mean: 0 mm, sigma: {SIGMA} mm}}}}
  step: {{kind: plus_minus, of: base.step, distribution: {{kind: normal, mean: 0 mm, sigma: {SIGMA} mm}}}}
moves:
  fix: {{kind: fix, part: base}}
measures:
  height: {{kind: gap, from: base.floor, to: base.post, along: [0, 0, 1], lower_limit: 40.2 mm, upper_limit: 40230 um}}
  ledge: {{kind: gap, from: base.floor, to: base.step, along: [0, 0, 1], upper_limit: 1.2 mm}}
published:
  drawing office: {{height: {{mean: 40219.5 um, sigma: 9.5 um, sigma_se: 0.2 um}}}}
study: {{trials: 2000, seed: 3}}
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("long")
    (folder / "post.yaml").write_text(SCENE, encoding="utf-8")
    return run_scene(folder / "post.yaml", out=folder / "run")


def rows(text: str, title: str) -> dict[str, list[str]]:
    """Cells of the table below a title, by their labels."""
    lines = text.split(f"\n{title}\n", 1)[1].split("\n\nshare")[0].splitlines()
    cells = (re.split(r" {2,}", own.strip()) for own in lines)
    return {label: values for label, *values in cells}


def test_a_long_length_is_shown_in_mm_and_a_short_one_in_um(run: Run) -> None:
    found = run.found.measures["height"]
    assert found.unit == "um"
    assert found.nominal.analytic == pytest.approx(1e3 * MIDDLE, abs=1e-6)
    text = as_text(run_report(run.found, Detail.MEASURES), 200)
    long, short = rows(text, "height"), rows(text, "ledge")
    assert found.geometric is not None
    assert "[mm]" in long
    assert "[µm]" in short
    assert long["nominal build"][-2:] == ["40.2200", "–"]
    assert long["mean"][-2:] == [f"{found.geometric.mean / 1e3:.4f}", "40.2195"]  # type: ignore[operator]
    assert long["sigma [µm]"][-2:] == [f"{found.geometric.sigma:.3f}", "9.5"]
    assert long["standard error of sigma [µm]"][-1] == "0.2"
    assert {"below 40.2 mm", "above 40.23 mm"} <= long.keys()
    assert short["nominal build"][-1] == "990.000"
    assert "sigma" in short
    assert "lower limit 40.2 mm, upper limit 40.23 mm" in text
    assert re.search(r"height +NOT OK +40\.22\d mm +40\.1\d+ mm +40\.2\d+ mm +40\.2 to 40\.23 mm", text)
    assert re.search(r"ledge +OK +9\d\d\.\d µm +9\d\d\.\d µm +10\d\d\.\d µm +≤ 1200 µm", text)


def test_a_picture_has_the_unit_and_the_numbers_of_the_table(run: Run) -> None:
    axes = histogram_figure(run.found).axes
    labels = {own.get_xlabel(): own.get_xlim() for own in axes if own.get_xlabel()}
    low, high = labels["height [mm]"]
    assert MIDDLE - 0.06 < low < MIDDLE - 3 * SIGMA
    assert MIDDLE + 3 * SIGMA < high < MIDDLE + 0.06
    assert 900 < labels["ledge [µm]"][0] < 990


def test_check_shows_it_alike(tmp_path: Path) -> None:
    text = as_text(
        check_report(
            simulation_of(
                scene_of(SCENE.replace("lower_limit: 40.2 mm", "lower_limit: 40.225 mm"), tmp_path), Overrides()
            )
        ),
        200,
    )
    assert re.search(r"height +gap +40.225 to 40.23 mm +40.2200 +40.2200 +40.2200 +40.2200 +mm", text)
    assert re.search(r"ledge +gap +≤ 1200 µm +990.000 +990.000 +990.000 +990.000 +µm", text)
    assert "height: nominal 40.2200 mm is outside its limits 40.225 to 40.23 mm" in text
    assert "sigma 10.000 µm by RSS" in text
    assert re.search(r"height.*\n\s+unit.*\n.*\n\s*post +µm/µm +1 ", text)


def test_lengths_alone_are_converted_and_all_of_them(run: Run) -> None:
    """Every number of the classes of a measure is one or is named here as none; each by a thousand."""
    none = {
        *(
            "trials",
            "count",
            "counts",
            "outside_grid",
            "compared",
            "skewness",
            "kurtosis",
            "pp",
            "ppk",
            "ppk_95",
            "status",
        ),
        *("reasons", "chord_error_um", "mesh_error_um", "law_sigmas_um", "position_deg", "curve", "largest_trial"),
        *("below_limit_ppm", "above_limit_ppm", "failed_ppm", "out_ppm", "trial_of_the_largest", "standard_errors"),
        *("below_limit_ppm_95", "above_limit_ppm_95", "out_ppm_95", "percent", "largest_percent"),
        *("analytic_percent", "geometric_percent", "geometric_percent_se", "high_low_mean_percent"),
        "explained_percent",
    }
    named = {name for kind in (AssemblyMeasureSummary, Witnessed) for name in numbers(kind)}
    assert named - none == LENGTHS
    assert not none & (LENGTHS | BUILDS)
    before, after = run.found.measures["height"], shown_run(run.found).measures["height"]
    assert before.geometric is not None
    assert after.geometric is not None
    for key in ("mean", "sigma", "p0.135", "mean_se", "sample_max"):
        assert after.geometric.value(key) == before.geometric.value(key) / 1e3  # type: ignore[operator]
    assert after.geometric.ppk == before.geometric.ppk
    assert after.limits == pytest.approx((40.2, 40.23), abs=1e-12)
    assert after.published["drawing office"].value("sigma") == pytest.approx(0.0095)
    assert shown_run(run.found).measures["ledge"] is run.found.measures["ledge"]


def numbers(kind: type[Section]) -> Iterator[str]:
    """Names of the numbers of a class of a summary, and of those in it; but of builds and what others published."""
    for name, field in kind.model_fields.items():
        if name in BUILDS or name == "published":
            continue
        inner = [own for own in within(field.annotation) if isinstance(own, type)]
        sections = [own for own in inner if issubclass(own, Section)]
        for own in sections if name != "curve" else ():
            yield from numbers(own)
        if not sections and any(own in (int, float) for own in inner):
            yield name


def within(annotation: Any) -> Iterator[Any]:
    """The types that an annotation is made of."""
    if get_origin(annotation) is None:
        yield from () if annotation is NoneType else (annotation,)
    for own in get_args(annotation):
        yield from within(own)
