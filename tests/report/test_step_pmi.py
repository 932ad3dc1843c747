"""The tables of what a STEP file says of tolerances, as printed and as written."""

import csv
import io
from pathlib import Path

import pytest
from fixtures import Command
from nist import FILES, step_bytes, step_text
from printing import printed

from tol3d.cad.step import read_step_text
from tol3d.report.step_tables import pmi_report


def rows(model: str) -> list[list[str]]:
    return list(csv.reader(io.StringIO(pmi_report(step_text(model)).csv())))


def test_every_entity_has_its_row() -> None:
    for model in FILES:
        text, written = step_text(model), rows(model)
        places = [cell for row in written for cell in row[1:4] if cell.startswith("#")]
        ids = [*(each.id for each in text.tolerances), *(each.id for each in text.dimensions)]
        assert all(f"#{each}" in places for each in ids)
        assert sum(row[:1] == ["letter"] for row in written) == 1


def test_a_row_has_frame_place_faces_and_meaning() -> None:
    (row,) = (each for each in rows("FTC-10") if "Position.6" in each)
    assert row == [
        "⌖ | ⌀1.2 | A | B | C",
        "mm",
        "Position.6",
        "#19020",
        "4 holes or pins",
        "#9315+#9274, #9215+#9174, #9415+#9374, #9474+#9515",
        "approximately",
        "inspected_position",
        "#19001 locates the feature: this one only limits what is inspected",
    ]


def test_limits_are_written_whole_in_mm() -> None:
    (row,) = (each for each in rows("STC-06") if "#8621" in each)
    assert row[:2] == ["⌀0.8125 ±0.02", "in"]
    assert [float(each) for each in row[5:7]] == pytest.approx([0.7925 * 25.4, 0.8325 * 25.4], rel=1e-12)


def test_a_file_without_tolerances_says_so() -> None:
    text = "ISO-10303-21;HEADER;FILE_SCHEMA(('AP214'));ENDSEC;DATA;#1=A();ENDSEC;END-ISO-10303-21;"
    assert "plain.stp has no datums" in printed(pmi_report(read_step_text(text.encode(), "plain.stp")))


def test_names_of_the_file_cannot_break_the_table() -> None:
    hostile = step_bytes("CTC-01").replace(b"'Position.1'", rb"'\X2\000A001B\X0\[red]" + b"x" * 10_000 + b"'")
    report = pmi_report(read_step_text(hostile, "x.stp"))
    assert "\x1b" not in printed(report)
    (row,) = (each for each in csv.reader(io.StringIO(report.csv())) if "#21" in each)
    assert row[2].startswith("··[red]xxx")
    assert len(row[2]) == 80


def test_the_command_prints_and_writes(tmp_path: Path, tol3d: Command) -> None:
    model, table = tmp_path / "model.stp", tmp_path / "table.csv"
    model.write_bytes(step_bytes("CTC-01"))
    code, out, _ = tol3d("pmi", str(model), "--csv", str(table))
    assert code == 0
    assert "Tolerances · 6: 6 said" in out
    assert table.read_text("utf-8") == pmi_report(step_text("CTC-01")).csv()


def test_a_damaged_file_is_refused_in_one_line(tmp_path: Path, tol3d: Command) -> None:
    model = tmp_path / "model.stp"
    model.write_bytes(step_bytes("CTC-01")[:-200])
    code, _, err = tol3d("pmi", str(model))
    assert code == 2
    assert "model.stp" in err
    assert len(err.strip().splitlines()) <= 2  # one sentence, wrapped where the terminal ends
