"""Presentation of many measures and contributors: the worst and the largest, all others counted, and whole in files.

Eighteen tolerances with sigmas of 1 to 18 um add up in each of 24 gaps, whose limits are further and further off.
"""

import csv
import io
import math
import random
from pathlib import Path

import pytest
from fixtures import Command
from printing import printed, row_of

from tol3d import Run, load_scene, run_scene
from tol3d.cli.studies import pictured
from tol3d.report import check_report, run_report
from tol3d.report.heading import MOST_CONTRIBUTORS, MOST_MEASURES, WORST_FIRST
from tol3d.report.page import Line, Page, Table, some
from tol3d.report.table import Detail
from tol3d.simulate import simulation_of
from tol3d.study.results.summary import _named

TOLERANCES, MEASURES = 18, 24
SQUARES = sum(k**2 for k in range(1, TOLERANCES + 1))
REST = sum(k**2 for k in range(1, TOLERANCES - MOST_CONTRIBUTORS + 1)) / SQUARES
SIGMA = math.sqrt(SQUARES)  # um


def text() -> str:
    order, limits = list(range(TOLERANCES)), list(range(MEASURES))
    random.Random(3).shuffle(order)
    random.Random(4).shuffle(limits)
    sigma = "{kind: plus_minus, of: base.right, distribution: {kind: normal, mean: 0 um, sigma: %d um}}"
    gap = "{kind: gap, from: base.left, to: base.right, along: [0, 0, 1], upper_limit: %d um}"
    return "\n".join(
        [
            "scene: many\nstudy: {trials: 1000, seed: 2}\nparts:\n  base:\n    kind: solid\n    features:",
            "      left: {kind: point, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1]}",
            "      right: {kind: point, at: [9 mm, 0 mm, 0 mm], normal: [0, 0, 1]}",
            "moves:\n  table: {kind: fix, part: base}\ntolerances:",
            *(f"  t{k}: {sigma % (k + 1)}" for k in order),
            "measures:",
            *(f"  m{k}: {gap % (60 + 3 * k)}" for k in limits),
        ]
    )


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("many") / "many.yaml"
    path.write_text(text(), "utf-8")
    return path


@pytest.fixture(scope="module")
def run(scene: Path) -> Run:
    return run_scene(scene, out=scene.parent / "run")


@pytest.fixture(scope="module")
def checked(scene: Path) -> Page:
    return check_report(simulation_of(load_scene(scene)))


def table_of(page: Page, title: str) -> Table:
    """The table below a title."""
    titles = [str(block).strip() if isinstance(block, Line) else "" for block in page.blocks]
    following = page.blocks[titles.index(title) :]
    return next(block for block in following if isinstance(block, Table))


def test_check_has_the_worst_measures_and_counts_the_others(checked: Page) -> None:
    table = table_of(checked, "measures")
    worst = [f"m{k}" for k in range(MOST_MEASURES)]
    assert [row.label for row in table.rows] == worst
    assert table.shown.rows[-1].label == f"and {MEASURES - MOST_MEASURES} more"
    titles = [str(block).strip() for block in checked.blocks if isinstance(block, Line)]
    assert [own.partition(":")[0] for own in titles if own.endswith("change by each deviation")] == worst


def test_check_has_the_largest_contributors_of_a_measure_and_the_share_of_the_others(checked: Page) -> None:
    table = table_of(checked, "m0: change by each deviation")
    assert [row.label for row in table.rows] == [f"t{k}" for k in reversed(range(3, TOLERANCES))]
    assert table.rows[0].cells[3] == f"{100 * TOLERANCES**2 / SQUARES:.1f}"
    rest = table.shown.rows[-1]
    assert (rest.label, rest.cells[3], rest.cells[4]) == ("and 3 more", f"{100 * REST:.1f}", f"{100 * REST:.1f}")


def test_what_check_leaves_out_is_in_its_file(tol3d: Command, scene: Path, tmp_path: Path) -> None:
    code, out, _ = tol3d("check", str(scene), "--out", str(tmp_path / "all.csv"))
    assert code == 0
    assert "check --out FILE.csv writes all of it" in out
    pieces = (tmp_path / "all.csv").read_text("utf-8").split("\n\n")
    tables = {piece.partition("\n")[0]: list(csv.reader(io.StringIO(piece.partition("\n")[2]))) for piece in pieces}
    assert {row[0] for row in tables["measures"][1:]} == {f"m{k}" for k in range(MEASURES)}
    for k in range(MEASURES):
        rows = {row[0]: row for row in tables[f"m{k}: change by each deviation"][1:]}
        shares = {name: float(row[4]) for name, row in rows.items()}
        expected = {f"t{n}": 100 * (n + 1) ** 2 / SQUARES for n in range(TOLERANCES)}
        assert shares == pytest.approx(expected, rel=1e-6)


def test_a_run_has_the_worst_measures_and_the_verdict_of_all(run: Run) -> None:
    words = printed(run_report(run.found, Detail.SHORT), 200)
    shown = [line.split()[0] for line in words.splitlines() if line.startswith("m") and "µm" in line]
    named = [line.split() for line in words.partition("largest contributors")[2].splitlines() if line.startswith("m")]
    (share,) = {
        own["geometric_percent"]
        for measure in run.summary["measures"].values()
        for own in measure["contributors"]
        if own["name"] == f"t{TOLERANCES - 1}"
    }
    assert named == [[f"m{k}", f"t{TOLERANCES - 1}", f"{share:.0f}", "%"] for k in range(MOST_MEASURES)]
    assert shown == [f"m{k}" for k in range(MOST_MEASURES)]
    assert f"and {MEASURES - MOST_MEASURES} more, all in summary.json" in words
    verdicts = words.partition(f"all {MEASURES} measures: ")[2].partition("\n")[0]
    assert sum(int(part.split()[0]) for part in verdicts.split(", ")) == MEASURES


def test_the_table_of_a_measure_has_its_largest_contributors_and_the_share_of_the_others(run: Run) -> None:
    words = printed(run_report(run.found), 200)
    assert words.count("and 3 more") == MOST_MEASURES
    assert row_of(words, "and 3 more")[0] == f"{100 * REST:.1f}"
    assert row_of(words, "t17")[0] == f"{100 * TOLERANCES**2 / SQUARES:.1f}"


def test_a_run_of_many_measures_says_which_are_in_its_picture(run: Run) -> None:
    assert pictured(run, "worst") == ""  # none was drawn
    (run.path / "histogram.png").touch()
    four = "m0, m1, m2, m3; --pictures all: each"
    assert pictured(run, "worst") == f"histogram.png shows the 4 worst of 24 measures {WORST_FIRST}: {four}"
    assert pictured(run, "all") == ""


def test_seconds_of_a_run_add_up_to_all_of_them(tol3d: Command, scene: Path, tmp_path: Path) -> None:
    out = tol3d("run", str(scene), "--trials", "40", "--no-picture", "-v", "--out", str(tmp_path / "run"))[1]
    whole, _, parts = out.replace("\n", " ").partition("time: ")[2].partition(" in all: ")
    seconds = [
        float(word.split()[0]) for word in parts.partition("what to change")[0].partition(" run:")[0].split(", ")
    ]
    assert len(seconds) == 6
    assert float(whole.split()[0]) == pytest.approx(sum(seconds), abs=0.051 * (1 + len(seconds)))


def test_texts_of_many_are_counted() -> None:
    assert some(["a"] * 20) == ["a"] * 20
    assert some(["a"] * 25, ", all there") == ["a"] * 20 + ["and 5 more, all there"]


def test_a_warning_names_six_measures_and_counts_the_others() -> None:
    names = [f"m{k}" for k in range(MEASURES)]
    assert _named(names) == "m0, m1, m2, m3, m4, m5 and 18 more measures"
    assert _named(names[:6]) == "m0, m1, m2, m3, m4, m5"
