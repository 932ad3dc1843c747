"""Tables of a report as files: the numbers of the summary, units in the headings, and no cell that is a formula."""

import csv
import io
import json
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest
from typer.testing import CliRunner

from tol3d import InputError, Run, RunError, load_scene, run_scene
from tol3d.cli import app
from tol3d.notebook import keep_report, write_report
from tol3d.report.page import Heading, Row, Shown, Table
from tol3d.report.table_files import Grid
from tol3d.report.workbook import Sheet, sheet_names, workbook
from tol3d.simulate import Overrides
from tol3d.study.runs.run import open_run

MAIN = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
FORMULAS = ("=1+1", "+1+1", "-1+cmd|'/c calc'!A0", "@SUM(A1)", "\t=1", "\r=1")
HOSTILE = "=HYPERLINK(A1)"

Rows = list[list[str]]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """A spur pair of which one measure has a hostile name."""
    folder = tmp_path_factory.mktemp("tables")
    scene = folder / "scene.yaml"
    text = load_scene("spur_pair").source.read_text("utf-8")
    scene.write_text(text.partition("\npublished:")[0].replace("normal backlash:", f"'{HOSTILE}':"))
    return run_scene(scene, overrides=Overrides(trials=200, witness=0), out=folder / "spur")


def _csv(path: Path) -> dict[str, Rows]:
    return {own.name: [*csv.reader(io.StringIO(own.read_text("utf-8-sig")))] for own in sorted(path.iterdir())}


def _xlsx(path: Path) -> dict[str, Rows]:
    """The sheets of a workbook by their names, read as ECMA-376 says, numbers and texts alike as words."""
    with zipfile.ZipFile(path) as archive:
        book = ElementTree.fromstring(archive.read("xl/workbook.xml"))
        names = [own.attrib["name"] for own in book.iter(f"{MAIN}sheet")]
        found = {}
        for number, name in enumerate(names, 1):
            sheet = ElementTree.fromstring(archive.read(f"xl/worksheets/sheet{number}.xml"))
            assert not [*sheet.iter(f"{MAIN}f")], "no formula"
            found[name] = [["".join(cell.itertext()) for cell in row] for row in sheet.iter(f"{MAIN}row")]
    return found


def _column(rows: Rows, heading: str) -> list[str]:
    place = next(k for k, own in enumerate(rows[0]) if own.partition(" [")[0] == heading)
    return [row[place] for row in rows[1:]]


def test_every_format_has_the_numbers_of_the_summary(run: Run, tmp_path: Path) -> None:
    found = run.found.measures["lost motion"]
    assert found.geometric is not None
    exact = [found.geometric.mean, found.geometric.sigma, found.geometric.p50]
    files = _csv(write_report(run, tmp_path / "tables", format="csv"))
    rows = next(own for name, own in files.items() if name.endswith("lost-motion.csv"))
    by_label = dict(zip(_column(rows, "row"), _column(rows, "3D simulation"), strict=True))
    labels = ("mean", "sigma", "50 % quantile")
    assert [float(by_label[label]) for label in labels] == exact
    assert rows[0][-1] == "3D simulation [arcmin]", "all its rows have one unit"
    told = json.loads(write_report(run, tmp_path / "tables.json", format="json").read_text("utf-8"))
    table = next(own for own in told["tables"] if own["name"] == "lost motion")
    assert [row[-1] for row in table["rows"] if row[0] in labels] == [exact[0], exact[1], exact[2]]
    sheets = _xlsx(write_report(run, tmp_path / "tables.xlsx", format="xlsx"))
    assert next(iter(sheets)) == "verdict"
    assert len(sheets) == len(files) == len(told["tables"])
    values = {row[0]: row[-1] for row in sheets["lost motion"]}
    assert [float(values[label]) for label in labels] == exact
    verdict = files["01-verdict.csv"]
    assert [float(own) for own in _column(verdict, "mean")][1] == exact[0], "a number, its unit apart"


def test_one_unit_of_all_rows_stands_in_the_heading_and_several_in_a_column() -> None:
    headings = [Heading("mean"), Heading("words", words=True), Heading("Ppk", plain=True)]

    def row(unit: str) -> Row:
        return Row("a", (Shown("1.2 µm", 1.23456), "so", Shown("1.0", 1.01)), unit=unit)

    assert Grid.of("t", Table("measure", headings, [row("um"), row("um")])).headings == (
        *("measure", "mean [um]"),
        *("words", "Ppk"),
    )
    several = Grid.of("t", Table("measure", headings, [row("um"), row("arcmin")]))
    assert several.headings == ("measure", "unit", "mean", "words", "Ppk")
    assert several.rows[1] == ("a", "arcmin", 1.23456, "so", 1.01)


def test_rows_of_several_runs_each_have_their_run_and_numbers_not_known_are_empty(run: Run, tmp_path: Path) -> None:
    other = run_scene("spur_pair", overrides=Overrides(trials=100, witness=0), out=tmp_path / "other")
    files = _csv(write_report([run, other], tmp_path / "tables", format="csv"))
    rows = next(own for name, own in files.items() if "lost-motion" in name)
    assert _column(rows, "run") == ["spur", "spur", "other", "other"]
    assert _column(rows, "method") == ["analytic", "3D"] * 2
    assert not any("–" in row for row in rows)


@pytest.mark.parametrize("name", FORMULAS)
def test_a_name_that_begins_like_a_formula_is_text(name: str) -> None:
    grid = Grid.of("t", Table(name, [Heading(name)], [Row(name, (name,))]))
    for row in csv.reader(io.StringIO(grid.csv())):
        for cell in row:
            assert not cell.startswith(("=", "+", "-", "@", "\t", "\r"))
            assert cell.lstrip("'\t\r") == name.strip()
    assert Grid.of("t", Table("x", [Heading("y")], [Row("−3", ("-0.5 µm",))])).csv().endswith("−3,-0.5 µm\n")


def test_a_hostile_measure_is_text_in_every_file(run: Run, tmp_path: Path) -> None:
    for rows in _csv(write_report(run, tmp_path / "tables", format="csv")).values():
        assert not [cell for row in rows for cell in row if cell.startswith(("=", "+", "@"))]
    sheets = _xlsx(write_report(run, tmp_path / "tables.xlsx", format="xlsx"))
    assert HOSTILE in [row[0] for row in sheets["verdict"]]


def test_sheets_have_names_that_spreadsheets_take_and_signs_that_xml_takes() -> None:
    names = sheet_names(["a/b:c", "A b c", "x" * 50, "x" * 50, "", "'q'", "\u202e[]"])
    assert len({own.casefold() for own in names}) == len(names)
    assert all(0 < len(own) <= 31 and not set("[]:*?/\\") & set(own) for own in names)
    packed = workbook([Sheet("</t>", ["\x00<&\"'"], [["\u202e"], [float("nan")], ["x" * 40_000]])])
    with zipfile.ZipFile(io.BytesIO(packed)) as archive:
        sheet = ElementTree.fromstring(archive.read("xl/worksheets/sheet1.xml"))
    texts = ["".join(own.itertext()) for own in sheet.iter(f"{MAIN}t")]
    assert texts == ["\\u0000<&\"'", "\\u202e", "x" * 32_767]
    assert packed == workbook([Sheet("</t>", ["\x00<&\"'"], [["\u202e"], [float("nan")], ["x" * 40_000]])])


def test_what_is_there_stays_without_force(run: Run, tmp_path: Path) -> None:
    tables = write_report(run, tmp_path / "tables", format="csv")
    with pytest.raises(InputError, match="expected the name of a new folder, there is one already; --force"):
        write_report(run, tables, format="csv")
    (tables / "99-old.csv").write_text("of an older report")
    write_report(run, tables, format="csv", force=True)
    assert not (tables / "99-old.csv").exists()
    (tables / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match=r"holds what is no table of a report \(notes.txt\)"):
        write_report(run, tables, format="csv", force=True)
    page = tmp_path / "page.json"
    page.write_text("mine")
    with pytest.raises(InputError, match="there is one already; --force replaces it"):
        write_report(run, page, format="json")
    with pytest.raises(RunError, match="expected a run's folder"):
        write_report(tmp_path / "none", page, format="json")
    with pytest.raises(InputError, match="this is a folder"):
        write_report(run, tmp_path, force=True)
    with pytest.raises(InputError, match="this is a file"):
        write_report(run, page, format="csv")


def test_a_run_keeps_its_report_and_one_of_somebody_else_stays(run: Run, tmp_path: Path) -> None:
    own = run_scene("cover_on_base", overrides=Overrides(trials=20), out=tmp_path / "own")
    (own.path / "report.html").write_text("mine")
    with pytest.raises(RunError, match="this file is not the run's own; move it elsewhere"):
        keep_report(own)
    (own.path / "report.html").unlink()
    path = keep_report(own)
    assert path == own.path / "report.html"
    assert "report.html" in open_run(own.path).manifest.sums
    assert not open_run(own.path).manifest.foreign()
    keep_report(open_run(own.path))


def test_the_commands_write_reports(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    ended = CliRunner().invoke(app, ["run", "door", "--trials", "20", "-q", "--no-picture", "--report"])
    assert ended.exit_code == 0
    assert (tmp_path / "runs" / "door" / "report.html").is_file()
    for word, name in (("csv", "report-csv"), ("xlsx", "report.xlsx"), ("json", "report.json")):
        ended = CliRunner().invoke(app, ["report", "runs/door", "--format", word])
        assert (ended.exit_code, ended.output.strip()) == (0, str(tmp_path / name))
        assert (tmp_path / name).exists()
    ended = CliRunner().invoke(app, ["report", "runs/door", "--no-3d"])
    page = tmp_path / "report.html"
    assert ended.stdout.strip() == str(page)
    assert ended.stderr.strip().endswith(f"any browser opens it, also without a network: {page.as_uri()}")
    ended = CliRunner().invoke(app, ["report", "runs/door", "--format", "csv", "--no-3d"])
    assert str(ended.exception) == "--no-3d: is of the page; leave it out with --format csv"
