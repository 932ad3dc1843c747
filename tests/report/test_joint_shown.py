"""Yield and correlations as they are printed, and as they stand in CSV."""

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from printing import printed
from toys.registered import TOYS

from tol3d import Overrides, Run, run_scene
from tol3d.report import comparison_report, run_report
from tol3d.report.joint import MOST_PAIRS, correlation_blocks, yield_lines
from tol3d.report.page import Table, page
from tol3d.report.table import Detail

pytestmark = pytest.mark.usefixtures("springs")

SPRING = TOYS / "parabola" / "spring.yaml"
TRIALS = 4000
SCALARS = ("height", "anywhere", "highest", "room")


@pytest.fixture(scope="module")
def run(springs: None, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run_scene(SPRING, overrides=Overrides(trials=TRIALS), out=tmp_path_factory.mktemp("joint") / "run")


def correlation_table(run: Run) -> Table:
    """The table of correlations by the labels of its rows."""
    (table,) = (block for block in correlation_blocks(run.found) if isinstance(block, Table))
    return table


def test_the_yield_is_a_line_below_the_verdict_of_every_run(run: Run) -> None:
    within = {method: own["within"] for method, own in run.summary["joint"]["yields"].items()}
    shares = {method: f"{100 * count / TRIALS:.2f} %" for method, count in within.items()}
    low, high = (f"{bound / 1e4:.2f} %" for bound in run.summary["joint"]["yields"]["geometric"]["yield_ppm_95"])
    expected = (
        f" yield: {shares['geometric']} of all trials are within all limits ({low} to {high}, 95 % confidence); "
        f"analytic {shares['analytic']}"
    )
    for detail in Detail:
        assert expected in map(str.rstrip, printed(run_report(run.found, detail), 160).splitlines())


def test_correlations_are_printed_with_the_tables_of_every_measure(run: Run) -> None:
    columns = run.columns()
    values = {}
    for method in ("analytic", "geometric"):
        for name in SCALARS:
            values[method, name] = np.array(columns[f"{method}:{name}"])
            if method == "geometric":
                values[method, name][columns[f"status:{name}"] != "ok"] = np.nan
    rows = {row.label: row for row in correlation_table(run).rows}
    assert len(rows) == 6
    for label, row in rows.items():
        pair = label.split(" · ")
        x, y = (values["geometric", name] for name in pair)
        both = ~np.isnan(x) & ~np.isnan(y)
        r = np.corrcoef(x[both], y[both])[0, 1]
        theory = np.corrcoef(values["analytic", pair[0]], values["analytic", pair[1]])[0, 1]
        assert (row.cells[0], row.cells[2], row.cells[3]) == (f"{r:.3f}", str(np.count_nonzero(both)), f"{theory:.3f}")
    sizes = [abs(float(row.cells[0])) for row in rows.values()]
    assert sizes == sorted(sizes, reverse=True)
    shown = {detail: printed(run_report(run.found, detail)) for detail in Detail}
    assert [" · room" in shown[detail] for detail in Detail] == [False, False, True]
    head = printed(page(*correlation_blocks(run.found))).splitlines()[2]
    assert " ".join(head.split()) == "measures 3D simulation 95 % interval trials analytic"


def test_numbers_of_the_table_have_all_digits_in_csv(run: Run) -> None:
    own = run.summary["joint"]["correlations"]["geometric"]
    found = {row["measures"]: row for row in csv.DictReader(io.StringIO(correlation_table(run).csv()))}
    assert float(found["height · anywhere"]["3D simulation"]) == own["r"][0][1]
    assert int(found["height · room"]["trials"]) == own["trials"][0][3]
    rows = {row["method"]: row for row in csv.DictReader(io.StringIO(comparison_report([run]).tables[-1].csv()))}
    for method, heading in (("analytic", "analytic"), ("geometric", "3D simulation")):
        joint = run.summary["joint"]["yields"][method]
        assert float(rows[heading]["yield"]) == joint["yield_ppm"] / 1e4
        assert float(rows[heading]["from"]) == joint["yield_ppm_95"][0] / 1e4
        assert (rows[heading]["unit"], rows[heading]["measures with limits"]) == ("%", "4")


def test_what_is_noise_is_not_printed(run: Run) -> None:
    """With 100 trials |r| up to tanh(1.96 / sqrt(97)) = 0.1965 is noise, at most a screenful of the rest is shown."""
    joint = run.found.joint
    assert joint is not None
    assert joint.correlations is not None
    whole = joint.correlations["geometric"]
    size = 8
    r = np.full((size, size), 0.196)
    r[0, 1:], r[1, 2:] = -0.197, 0.9

    def shown(values: np.ndarray) -> list[str]:
        own = whole.model_copy(
            update={"r": values.tolist(), "r_low_95": None, "r_high_95": None, "trials": [[100] * size] * size}
        )
        names = [f"m{k}" for k in range(size)]
        both = {"geometric": own, "analytic": own}
        other = run.found.model_copy(
            update={"joint": joint.model_copy(update={"correlated": names, "correlations": both})}
        )
        return [row.label for b in correlation_blocks(other) if isinstance(b, Table) for row in b.rows]

    assert shown(r) == [f"m1 · m{k}" for k in range(2, 8)] + [f"m0 · m{k}" for k in range(1, 7)]
    assert len(shown(r)) == MOST_PAIRS < 13
    assert shown(np.full((size, size), 0.196)) == []


def test_with_fewer_than_two_limits_nothing_is_printed(tmp_path: Path) -> None:
    text = SPRING.read_text("utf-8").replace(", lower_limit: -60 um, upper_limit: 90 um", "")
    text = text.replace(", upper_limit: 100 um", "")
    assert text.count("_limit:") == 1
    scene = tmp_path / "spring.yaml"
    scene.write_text(text, "utf-8")
    (tmp_path / "spring.csv").write_text((TOYS / "parabola" / "spring.csv").read_text("utf-8"), "utf-8")
    run = run_scene(scene, overrides=Overrides(trials=300), out=tmp_path / "run")
    assert run.found.joint is not None
    assert yield_lines(run.found) == correlation_blocks(run.found) == []
    before = run.found.model_copy(update={"joint": None})
    assert yield_lines(before) == correlation_blocks(before) == []
