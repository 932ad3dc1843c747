"""docs/add_a_mechanism.md as it stands: a mechanism from outside, in under a hundred lines, against its oracles."""

import json
import math
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.integrate
import scipy.stats
from places import ROOT

import tol3d
from tol3d import import_path, kinds
from tol3d.errors import InputError
from tol3d.report import picture
from tol3d.study.runs.run import Run

PAGE = (ROOT / "docs" / "add_a_mechanism.md").read_text("utf-8")
PINS, NOMINAL, SIGMA, SCALE = 6, 20.0, 3.0, 2.0  # um, as the page's scene has them
TRIALS = 2000


def fence(language: str, holding: str) -> str:
    """The one fenced block of a language that holds a text."""
    (block,) = (
        block for block in re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL) if holding in block
    )
    return str(block)


@pytest.fixture(scope="module")
def names(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Any]]:
    """Names that the page's program has when it has run, in a folder with its two files."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "pin_gauge.py").write_text(fence("python", "PIN_GAUGES = Mechanism("), "utf-8")
    (folder / "pin_gauge_commands.py").write_text(fence("python", "def pegs("), "utf-8")
    (folder / "pin_gauge.yaml").write_text(fence("yaml", "kind: pin_gauge"), "utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.syspath_prepend(folder)
        patch.setattr(kinds, "_registered", {})
        found: dict[str, Any] = {"folder": folder}
        exec(fence("python", "tol3d.register"), found)
        yield found
    sys.modules.pop("pin_gauge", None)


@pytest.fixture(scope="module")
def run(names: dict[str, Any]) -> Run:
    found: Run = names["run"]
    return found


def test_the_example_is_under_a_hundred_lines() -> None:
    assert len(fence("python", "PIN_GAUGES = Mechanism(").splitlines()) < 100


def test_its_scene_is_the_oracles() -> None:
    scene = fence("yaml", "kind: pin_gauge")
    assert f"pins: {PINS}," in scene
    assert f"scale: {SCALE:g} um" in scene
    assert f"lower: -{3 * SIGMA:g} um, upper: {3 * SIGMA:g} um" in scene
    assert f"trials: {TRIALS}" in scene
    assert f"radius: 15 mm, gap: {NOMINAL:g} um" in scene


def test_both_methods_are_what_the_columns_say_trial_by_trial(run: Run) -> None:
    """By hand, from the deviations in the run's columns: pins k at 60° k, the peg at (x, y)."""
    frame = run.frame()
    x, y = frame["peg offset.x [um]"].to_numpy(), frame["peg offset.y [um]"].to_numpy()
    first, placed = [], []
    for k in range(PINS):
        pin = frame[f"pin position.pin {k + 1} [um]"].to_numpy()
        cos, sin = math.cos(math.radians(60 * k)), math.sin(math.radians(60 * k))
        first.append(NOMINAL + pin - cos * x - sin * y)
        away = 15_000 + pin
        placed.append(np.hypot(away * cos - x, away * sin - y) - 15_000 + NOMINAL)
    assert frame["analytic:smallest gap"].to_numpy() == pytest.approx(np.min(first, axis=0), abs=1e-8)
    assert frame["geometric:smallest gap"].to_numpy() == pytest.approx(np.min(placed, axis=0), abs=1e-8)


def test_the_methods_differ_by_the_square_of_the_offset_and_no_more(run: Run) -> None:
    """|R u - e| is R - e·u + (e × u)² / 2 R to second order: never less, at most e² / 2 R more."""
    frame = run.frame()
    difference = (frame["geometric:smallest gap"] - frame["analytic:smallest gap"]).to_numpy()
    most = (frame["peg offset.x [um]"] ** 2 + frame["peg offset.y [um]"] ** 2).to_numpy() / (2 * 14_900)
    assert np.all(difference > -1e-8)
    assert np.all(difference < most + 1e-8)
    assert difference.max() > 1e-4
    told = run.summary["measures"]["smallest gap"]["agreement"]["explanation"]
    assert told["second_order_of"] == ["peg offset"]
    assert told["faults"] == []


def smallest_of_normals(count: int) -> tuple[float, float]:
    """Mean and sigma of the smallest of as many independent standard normals, by an integral."""
    law = scipy.stats.norm

    def moment(power: int) -> float:
        found, _ = scipy.integrate.quad(lambda z: z**power * count * law.pdf(z) * law.sf(z) ** (count - 1), -10, 10)
        return float(found)

    return moment(1), math.sqrt(moment(2) - moment(1) ** 2)


def test_the_smallest_of_six_pins_has_the_mean_and_sigma_of_that_order_statistic(
    names: dict[str, Any], tmp_path: Path
) -> None:
    """Without the peg's offset; four standard errors."""
    text = fence("yaml", "kind: pin_gauge")
    law = f"{{kind: rayleigh, scale: {SCALE:g} um}}"
    assert text.count(law) == 1
    path = tmp_path / "centred.yaml"
    path.write_text(text.replace(law, "{kind: constant, value: 0 um}"), "utf-8")
    found = tol3d.run_scene(path, out=tmp_path / "run").summary["measures"]["smallest gap"]
    mean, sigma = (SIGMA * moment for moment in smallest_of_normals(PINS))
    for method in ("analytic", "geometric"):
        assert found[method]["mean"] == pytest.approx(NOMINAL + mean, abs=4 * sigma / math.sqrt(TRIALS))
        assert found[method]["sigma"] == pytest.approx(sigma, rel=4 / math.sqrt(TRIALS))


TWO_GAUGES = """\
scene: two gauges
parts:
  small: {kind: pin_gauge, pins: 3, radius: 8 mm, gap: 30 um}
  large: {kind: pin_gauge, pins: 5, radius: 25 mm, gap: 12 um}
  bare: {kind: pin_gauge, pins: 4, radius: 10 mm, gap: 7 um}
tolerances:
  pins of small: {kind: pin_place, of: small, distribution: {kind: uniform, lower: -9 um, upper: 4 um}}
  more of small: {kind: pin_place, of: small, distribution: {kind: normal, lower: -3 um, upper: 3 um}}
  pins of large: {kind: pin_place, of: large, distribution: {kind: normal, lower: -6 um, upper: 6 um}}
  offset of large: {kind: peg_offset, of: large, distribution: {kind: rayleigh, scale: 2 um}}
moves:
  into small: {kind: peg_among_pins, gauge: small}
  into large: {kind: peg_among_pins, gauge: large}
  into bare: {kind: peg_among_pins, gauge: bare}
measures:
  large gap: {kind: smallest_gap, of: into large}
  small gap: {kind: smallest_gap, of: into small}
  bare gap: {kind: smallest_gap, of: into bare}
study: {trials: 300, seed: 4}
"""


def test_gauges_of_one_scene_have_their_own_sizes_and_tolerances(names: dict[str, Any], tmp_path: Path) -> None:
    """By hand from the columns, as above; a gauge without tolerances has its nominal gap in every trial."""
    scene = tmp_path / "two.yaml"
    scene.write_text(TWO_GAUGES, "utf-8")
    run = tol3d.run_scene(scene, out=tmp_path / "run")
    frame = run.frame()
    x, y = frame["offset of large.x [um]"].to_numpy(), frame["offset of large.y [um]"].to_numpy()
    large, placed = [], []
    for k in range(5):
        pin = frame[f"pins of large.pin {k + 1} [um]"].to_numpy()
        cos, sin = math.cos(math.radians(72 * k)), math.sin(math.radians(72 * k))
        large.append(12 + pin - cos * x - sin * y)
        placed.append(np.hypot((25_000 + pin) * cos - x, (25_000 + pin) * sin - y) - 25_000 + 12)
    small = [30 + frame[f"pins of small.pin {k} [um]"] + frame[f"more of small.pin {k} [um]"] for k in (1, 2, 3)]
    assert frame["analytic:large gap"].to_numpy() == pytest.approx(np.min(large, axis=0), abs=1e-8)
    assert frame["geometric:large gap"].to_numpy() == pytest.approx(np.min(placed, axis=0), abs=1e-8)
    for method in ("analytic", "geometric"):
        assert frame[f"{method}:small gap"].to_numpy() == pytest.approx(np.min(small, axis=0), abs=1e-8)
        assert frame[f"{method}:bare gap"].to_numpy() == pytest.approx(7.0, abs=1e-8)
    shares = {name: [own.name for own in found.contributors] for name, found in run.found.measures.items()}
    assert shares == {
        "large gap": ["pins of large", "offset of large"],
        "small gap": ["pins of small", "more of small"],
        "bare gap": [],
    }
    assert "bare gap" in str(tol3d.check_scene(scene))


def test_its_run_opens_again_and_any_trial_is_replayed(run: Run) -> None:
    again = tol3d.open_run(run.path)
    worst = again.worst("smallest gap")
    column = "geometric:smallest gap"
    assert worst == np.argmin(again.columns(column)[column])


@pytest.fixture(scope="module")
def command(names: dict[str, Any]) -> Callable[..., str]:
    """`tol3d ARGUMENTS` in a process that finds the mechanism as an installed package's; what it prints."""
    info = names["folder"] / "pin_gauge-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: pin_gauge\nVersion: 1.0\n", "utf-8")
    points = tomllib.loads(fence("toml", "pin_gauge:PIN_GAUGES"))["project"]["entry-points"]
    lines = [
        f"[{group}]\n" + "\n".join(f"{name} = {path}" for name, path in own.items()) for group, own in points.items()
    ]
    (info / "entry_points.txt").write_text("\n".join(lines), "utf-8")

    def printed(*arguments: str) -> str:
        done = subprocess.run(
            [sys.executable, "-m", "tol3d.cli", *arguments],
            cwd=names["folder"],
            env=os.environ | {"PYTHONPATH": str(names["folder"]), "COLUMNS": "120", "PYTHONUTF8": "1"},
            capture_output=True,
            encoding="utf-8",
            timeout=300,  # s; a guard against hanging, not a claim
        )
        assert done.returncode == 0, done.stdout + done.stderr
        assert "Warning" not in done.stderr
        return done.stdout

    return printed


@pytest.mark.slow
def test_its_own_command_is_one_of_tol3d(command: Callable[..., str]) -> None:
    assert command("pegs", "pin_gauge.yaml", "--play", "0.25") == "gauge: 29.500 mm\n"
    assert re.search(r"│ schema .*│ pegs +List the diameters of the pegs that", command("--help"), re.DOTALL)


@pytest.mark.slow
def test_the_command_runs_shows_and_compares_it(names: dict[str, Any], command: Callable[..., str]) -> None:
    """Installed, it is as any other: the tables hold what the run from Python found."""
    printed = command("run", "pin_gauge.yaml", "-v", "--out", "runs/again", "--workers", "2")
    sample = names["run"].summary["measures"]["smallest gap"]["geometric"]
    row = next(line for line in printed.splitlines() if line.startswith("mean "))
    assert float(row.split()[-1]) == round(sample["mean"], 3)
    assert re.search(r"^smallest gap .*OK ", printed, re.MULTILINE)
    assert (names["folder"] / "runs" / "again" / "histogram.png").stat().st_size > 0
    checked = [" ".join(line.split()) for line in command("check", "pin_gauge.yaml").splitlines()]
    assert checked[0] == "peg among pins"
    assert f"pin position pin_place normal, each of {PINS} 0 {SIGMA:g} µm –" in checked
    assert "smallest gap smallest_gap ≥ 5 µm 20.000 20.000 20.000 20.000 µm" in checked
    # inwards each pin is the smallest gap, outwards it is not: a half on the average
    assert "pin position µm/µm 0.5 each 0.5 each" in checked
    schema = json.loads(command("schema", "--summary"))
    assert "smallest_gap" in json.dumps(schema)
    assert f"{sample['sigma']:.3f}" in command("compare", "runs/again", "runs/pin_gauge", "--out", "compared.png")


def test_a_run_without_a_presenter_has_no_further_pictures_and_no_builds_to_show(run: Run, tmp_path: Path) -> None:
    """Its own items are named by its mechanism, and no other presenter takes its place."""
    assert picture.system_files(run.found) == {}
    with pytest.raises(InputError, match="nothing to show in 3D: the mechanism 'pin gauges' has no presenter; its"):
        tol3d.export_trial(run, 0, out=tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_its_entry_point_is_in_the_group_that_is_asked_for() -> None:
    (points,) = tomllib.loads(fence("toml", "pin_gauge:PIN_GAUGES"))["project"]["entry-points"].items()
    assert points == (import_path.GROUP, {"pin_gauges": "pin_gauge:PIN_GAUGES"})
