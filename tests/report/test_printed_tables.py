"""Printed tables, as printed: every label stands beside the number that it names.

Numbers come from the columns of the trials by NumPy, or from closed forms written out here, never from summary.json.
"""

import io
import math
import re
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.train import involute
from rich.console import Console
from scipy.stats import norm

from tol3d import Overrides, Run, run_scene
from tol3d.report import comparison_report, run_report

Table = Mapping[str, Mapping[str, str]]
"""Cell by label and heading."""
Array = NDArray[np.float64]

DEG = math.pi / 180
WIDE = 240  # characters; no heading is broken
CENTRE_DISTANCE = 45.3  # mm; 45 is that of the reference circles
SCENE = f"""
scene: both limits are passed
parts:
  pinion: {{kind: spur_gear, teeth: 20, module: 2 mm, face_width: 10 mm}}
  wheel: {{kind: spur_gear, teeth: 25, module: 2 mm, face_width: 10 mm}}
tolerances:
  pinion thickness: {{kind: tooth_thickness, of: pinion, distribution: {{kind: normal, lower: -90 um, upper: -30 um}}}}
  wheel thickness: {{kind: tooth_thickness, of: wheel, distribution: {{kind: normal, lower: -36 um, upper: -12 um}}}}
  eccentricity: {{kind: eccentricity, of: wheel, distribution: {{kind: rayleigh, scale: 30 um}}}}
moves: {{pair: {{kind: mesh, driver: pinion, driven: wheel, centre_distance: {CENTRE_DISTANCE} mm}}}}
measures:
  play: {{kind: normal_backlash, of: pair, lower_limit: 250 um, upper_limit: 320 um}}
study: {{trials: 4000, seed: 11, witness: 0}}
"""
THICKNESS = ((-0.060, 0.010), (-0.024, 0.004))  # mm; mean and sigma of both, limits being those of 3 sigma
ECCENTRICITY = 0.030  # mm; of either component
LOWER, UPPER = 250.0, 320.0  # um
METHODS = {"analytic (same trials)": "analytic", "3D simulation": "geometric"}
BY_CLOSED_FORM = "analytic (closed form)"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("printed")
    (folder / "scene.yaml").write_text(SCENE, "utf-8")
    return run_scene(folder / "scene.yaml", out=folder / "run")


@pytest.fixture(scope="module")
def table(run: Run) -> Table:
    console = Console(file=io.StringIO(), width=WIDE)
    console.print(run_report(run.found))
    return table_in(text_of(console), "[µm]")


def text_of(console: Console) -> str:
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def table_in(text: str, corner: str) -> Table:
    """The first table with that word in its upper left corner; cells are two blanks apart at least."""
    lines = text[text.index(f"\n{corner}") + 1 :].splitlines()
    headings = re.split(r" {2,}", lines[0].strip())[1:]
    rows: dict[str, dict[str, str]] = {}
    for line in lines[2:]:
        label, *cells = re.split(r" {2,}", line.strip())
        if len(cells) != len(headings):
            break
        assert label not in rows
        rows[label] = dict(zip(headings, cells, strict=True))
    return rows


def nominal_play() -> float:
    """j = 2 (rb1 + rb2) (inv alpha_w - inv alpha) [um], exact on parallel axes without deviations."""
    working = math.acos(45.0 * math.cos(20 * DEG) / CENTRE_DISTANCE)
    return 1e3 * 2 * 45.0 * math.cos(20 * DEG) * (involute(working) - involute(20 * DEG))


def mean_play() -> float:
    """The same with both thicknesses at their means [um]: an arc s of the reference circle is s cos(alpha)."""
    return nominal_play() - 1e3 * sum(mean for mean, _ in THICKNESS) * math.cos(20 * DEG)


def sigma_of_play() -> float:
    """To first order [um]: thicknesses, and 2 sin(alpha_w) times the eccentricity's part along the centres."""
    sine = math.sqrt(1 - (45.0 * math.cos(20 * DEG) / CENTRE_DISTANCE) ** 2)
    parts = [sigma * math.cos(20 * DEG) for _, sigma in THICKNESS] + [2 * sine * ECCENTRICITY]
    return 1e3 * math.hypot(*parts)


def shown(table: Table, label: str, heading: str) -> float:
    return float(table[label][heading])


STATISTICS: Mapping[str, Callable[[Array], float]] = {
    "low (−3 sigma)": lambda v: float(v.mean() - 3 * v.std(ddof=1)),
    "mean": lambda v: float(v.mean()),
    "high (+3 sigma)": lambda v: float(v.mean() + 3 * v.std(ddof=1)),
    "sigma": lambda v: float(v.std(ddof=1)),
    "0.135 % quantile": lambda v: float(np.quantile(v, 0.00135)),
    "50 % quantile": lambda v: float(np.quantile(v, 0.5)),
    "99.865 % quantile": lambda v: float(np.quantile(v, 0.99865)),
    "smallest": lambda v: float(v.min()),
    "largest": lambda v: float(v.max()),
}
ROUNDING = 0.0006  # um; three digits are printed
BIN = 0.4  # um; quantiles are counted on a grid, and in the tails of 4000 trials neighbours lie a few tenths apart


@pytest.mark.parametrize("heading", METHODS)
@pytest.mark.parametrize("label", STATISTICS)
def test_a_row_holds_what_its_label_says_of_the_column_that_its_heading_names(
    table: Table, run: Run, label: str, heading: str
) -> None:
    column = f"{METHODS[heading]}:play"
    expected = STATISTICS[label](run.columns(column)[column])
    assert shown(table, label, heading) == pytest.approx(expected, abs=BIN if "quantile" in label else ROUNDING)


def test_the_rows_are_told_apart_by_more_than_they_may_be_off(run: Run) -> None:
    """Swapped labels or headings fail above: any two statistics, and both means, are further apart than that."""
    methods = [run.columns(f"{method}:play")[f"{method}:play"] for method in METHODS.values()]
    for values in methods:
        numbers = sorted(statistic(values) for label, statistic in STATISTICS.items() if label not in ("sigma", "mean"))
        assert min(np.diff(numbers)) > 2 * BIN
    assert abs(methods[0].mean() - methods[1].mean()) > 2 * ROUNDING
    assert abs(methods[0].std() - methods[1].std()) > 2 * ROUNDING


def test_the_closed_form_is_that_of_the_drawing(table: Table) -> None:
    mean, sigma = mean_play(), sigma_of_play()
    for label, expected in (
        ("mean", mean),
        ("sigma", sigma),
        ("low (−3 sigma)", mean - 3 * sigma),
        ("high (+3 sigma)", mean + 3 * sigma),
    ):
        assert shown(table, label, BY_CLOSED_FORM) == pytest.approx(expected, abs=ROUNDING)


def test_the_nominal_build_and_the_one_at_all_means_stand_in_their_rows(table: Table) -> None:
    """An eccentricity at all its means is none; 79 um lie between the two rows."""
    for heading in METHODS:
        assert shown(table, "nominal build", heading) == pytest.approx(nominal_play(), abs=ROUNDING)
        assert shown(table, "build at all means", heading) == pytest.approx(mean_play(), abs=ROUNDING)


def share(cell: str, label: str) -> float:
    """A printed share of trials: ppm, or per cent."""
    number = float(cell.removesuffix("%").replace(" ", ""))
    return number / 100 if "%" in cell or "[%]" in label else number * 1e-6


def labelled(table: Table, word: str) -> str:
    return next(label for label in table if label.startswith(word))


@pytest.mark.parametrize("heading", METHODS)
def test_what_lies_below_and_above_the_limits_is_counted(table: Table, run: Run, heading: str) -> None:
    column = f"{METHODS[heading]}:play"
    values = run.columns(column)[column]
    counted = {"below": np.mean(values < LOWER), "above": np.mean(values > UPPER)}
    assert 0.01 < counted["below"] < counted["above"] / 2  # swapped labels would be seen
    for word, expected in counted.items():
        label = labelled(table, word)
        assert share(table[label][heading], label) == pytest.approx(expected, rel=0.005)  # three digits are printed


def test_the_closed_form_s_share_beyond_each_limit_is_that_of_a_normal(table: Table) -> None:
    mean, sigma = mean_play(), sigma_of_play()
    for word, expected in (("below", norm.cdf(LOWER, mean, sigma)), ("above", norm.sf(UPPER, mean, sigma))):
        label = labelled(table, word)
        assert share(table[label][BY_CLOSED_FORM], label) == pytest.approx(expected, rel=0.005)


def test_the_shift_of_a_mean_has_its_sign(run: Run, tmp_path: Path) -> None:
    """10 um further apart is 2 sin(alpha_w) times that more backlash, 6.8 um and more, with the same draws."""
    text = SCENE.replace(f"centre_distance: {CENTRE_DISTANCE} mm", f"centre_distance: {CENTRE_DISTANCE + 0.01} mm")
    (tmp_path / "scene.yaml").write_text(text, "utf-8")
    wider = run_scene(tmp_path / "scene.yaml", overrides=Overrides(), out=tmp_path / "wider")
    working = math.acos(45.0 * math.cos(20 * DEG) / CENTRE_DISTANCE)
    expected = 1e3 * 2 * math.sin(working) * 0.01
    for runs, sign in (([run, wider], 1), ([wider, run], -1)):
        console = Console(file=io.StringIO(), width=WIDE)
        console.print(comparison_report(runs))
        lines = [line.split() for line in text_of(console).splitlines() if re.search(r" (3D|analytic) +\d+ ", line)]
        shifts = [float(line[-1].replace("−", "-")) for line in lines]
        half = len(shifts) // 2
        assert half >= 2
        assert shifts[:half] == [0.0] * half
        # 0.1 %: the slope at the new distance is another
        assert [sign * shift for shift in shifts[half:]] == pytest.approx([expected] * half, rel=2e-3, abs=ROUNDING)


def test_what_is_out_of_limits_is_compared_where_one_run_has_some(run: Run, tmp_path: Path) -> None:
    """Runs of the same measure, with limits and without."""
    (tmp_path / "scene.yaml").write_text(SCENE.replace(", lower_limit: 250 um, upper_limit: 320 um", ""), "utf-8")
    free = run_scene(tmp_path / "scene.yaml", overrides=Overrides(trials=20, engine="analytic"), out=tmp_path / "free")
    for runs, told in (([run, free], True), ([free, run], True), ([free], False)):
        console = Console(file=io.StringIO(), width=WIDE)
        console.print(comparison_report(runs))
        (headings,) = (line for line in text_of(console).splitlines() if line.lstrip().startswith("run [µm]"))
        assert ("out of limits" in headings) == told
        head, *verdicts = text_of(console).splitlines()[: 1 + len(runs)]
        assert head.startswith("verdict · accepted: 0.27 %") == told
        shown = ["NOT OK" if own is run else "no limits" for own in runs]  # 5 % and more of its trials are out
        assert not told or [line.rpartition(": ")[2] for line in verdicts] == shown
