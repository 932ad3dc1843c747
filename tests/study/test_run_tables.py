"""The tables beside summary.json: contributors by measures, as a spreadsheet reads them."""

import csv
from pathlib import Path

import pytest

from tol3d import Overrides, Run, run_scene


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run_scene("cover_on_base", out=tmp_path_factory.mktemp("tables") / "run")


def rows_of(path: Path) -> list[list[str]]:
    with path.open(newline="") as file:
        return list(csv.reader(file))


def test_each_share_of_the_summary_stands_in_its_row_and_column_of_the_matrix_and_no_other_does(run: Run) -> None:
    head, *rows = rows_of(run.path / "contributors.csv")
    assert head[:2] == ["share of the variance [%]", "contributor"]
    keys = {"3D simulation": "geometric", "analytic": "analytic", "high-low-mean": "high_low_mean"}
    found = {
        (words, name, measure): float(cell)
        for words, name, *cells in rows
        for measure, cell in zip(head[2:], cells, strict=True)
        if cell
    }
    expected = {
        (words, share["name"], measure): share[f"{key}_percent"]
        for measure, own in run.summary["measures"].items()
        for share in own["contributors"]
        for words, key in keys.items()
        if share[f"{key}_percent"] is not None
    }
    assert found == expected
    assert len({measure for _, _, measure in expected}) > 1
    assert len(rows) * (len(head) - 2) > len(expected)  # some act on some measures only: their cells are empty


def test_no_name_of_a_scene_is_a_formula_in_the_tables_of_its_run(run: Run, tmp_path: Path) -> None:
    scene, text = tmp_path / "scene.yaml", (run.path / "scene.yaml").read_text("utf-8")
    scene.write_text(text.replace("  hole offset:", "  '=1+1':").replace("  flush:", "  '@flush':"), "utf-8")
    hostile = run_scene(scene, overrides=Overrides(trials=20), out=tmp_path / "run")
    assert {*hostile.summary["measures"]} == {"=1+1", "@flush"}
    for name in ("contributors.csv", "correlations.csv"):
        cells = {cell for row in rows_of(hostile.path / name) for cell in row}
        assert {"'=1+1", "'@flush"} <= cells
        assert not [cell for cell in cells if cell.startswith(("=", "@"))]
