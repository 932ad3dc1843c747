"""Pages as plain data: what is written as comma-separated values is what the run found, with all its digits."""

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from places import SPUR_PAIR

from tol3d import InputError, Overrides, Run, check_scene, compare_runs, run_scene
from tol3d.report import run_report
from tol3d.report.page import BLANK, Heading, Row, Shown, Table, line, note, page, title


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    out = tmp_path_factory.mktemp("pages") / "run"
    return run_scene(SPUR_PAIR, overrides=Overrides(trials=200, witness=0), out=out)


def rows_of(text: str) -> list[list[str]]:
    return list(csv.reader(io.StringIO(text)))


def test_a_table_is_written_with_all_digits_and_texts_are_quoted_where_they_must_be() -> None:
    third = 1 / 3
    rows = [Row("a, b", [Shown("0.333", third), "left"], unit="um"), Row("  inset", [Shown("–", None), 'a "name"'])]
    written = Table("[µm]", [Heading("x"), Heading("side", words=True)], rows).csv()
    assert rows_of(written) == [
        ["[µm]", "unit", "x", "side"],
        ["a, b", "um", repr(third), "left"],
        ["inset", "", "", 'a "name"'],
    ]
    assert float(rows_of(written)[1][2]) == third


def test_a_page_writes_its_tables_below_their_titles() -> None:
    first, second = (Table("", [Heading("x")], [Row(label, ["1"])]) for label in "ab")
    whole = page(title("one", " · more"), BLANK, first, note("a note"), line("warning", "yellow"), second)
    assert whole.csv() == "one · more\n,x\na,1\n\n,x\nb,1\n"
    assert whole.tables == (first, second)


def test_a_run_s_table_of_a_measure_is_that_of_its_columns(run: Run) -> None:
    columns = {method: f"{method}:normal backlash" for method in ("analytic", "geometric")}
    values = {method: run.columns(column)[column] for method, column in columns.items()}
    text = run_report(run.found).csv().split("normal backlash\n", 1)[1]
    heads, *rows = rows_of(text.split("\n\n", 1)[0])
    found = {row[0]: dict(zip(heads, row, strict=True)) for row in rows}
    for method, heading in (("analytic", "analytic (same trials)"), ("geometric", "3D simulation")):
        assert float(found["mean"][heading]) == pytest.approx(values[method].mean(), rel=1e-12)
        assert float(found["smallest"][heading]) == values[method].min()
        below = next(own for label, own in found.items() if label.startswith("below"))
        assert float(below[heading]) == 1e6 * np.mean(values[method] < 15)
        assert below["unit"] == "ppm"
    assert found["mean"]["unit"] == "um"


def test_reports_of_a_notebook_write_files(run: Run, tmp_path: Path) -> None:
    compared = compare_runs([run])
    assert compared.to_csv(tmp_path / "tables.csv") is None
    assert (tmp_path / "tables.csv").read_text("utf-8") == compared.to_csv()
    assert "teeth z" in str(check_scene(SPUR_PAIR).to_csv())
    with pytest.raises(InputError, match="choose another file"):
        compared.to_csv(tmp_path / "no such folder" / "tables.csv")
