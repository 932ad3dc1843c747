"""The page of features: equal ones together, every feature counted, and no more rows than a page has."""

import re
from pathlib import Path

import cadquery as cq
import pytest
from fixtures import Command
from foreign_parts import nist_file, slotted_block, socket, solid, step_file
from printing import printed
from rich.status import Status

from tol3d.cad.step.reading import StepFile, read_step
from tol3d.cli import console
from tol3d.report.page import Page
from tol3d.report.step_tables import MOST_PARTS, MOST_ROWS, features_page


def rows_of(page: Page) -> list[tuple[str, ...]]:
    """Rows of all its tables: label and cells as CSV has them."""
    return [tuple(line.split(",")) for line in page.csv().splitlines() if re.match(r"[a-z_]+_\d+,", line)]


def counted(row: tuple[str, ...]) -> int:
    return int(row[1].split()[0]) if row[1] else 1


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> StepFile:
    """Eleven products: two asymmetric ones, and boxes."""
    boxes = {f"box {k}": solid(cq.Workplane().box(4 + k, 5, 6)) for k in range(9)}
    folder = tmp_path_factory.mktemp("many")
    return read_step(step_file({"block": slotted_block(), "socket": socket(), **boxes}, folder / "many.step"))


def test_equal_features_are_one_row_and_holes_come_first(many: StepFile) -> None:
    rows = rows_of(features_page(many))
    block = rows[: next(k for k, row in enumerate(rows) if row[2] == "socket")]
    assert block[0][2] == "hole"
    assert block[1][2] == "pin"
    assert [counted(row) for row in block if row[2] == "round"] == []  # a product of many has four rows
    assert len(block) == 4


def test_every_feature_is_in_a_row_or_counted_as_left_out() -> None:
    for model in ("ftc_10", "ctc_01"):
        file = read_step(nist_file(model))
        page = features_page(file)
        rows = rows_of(page)
        assert len(rows) <= MOST_ROWS
        left = re.search(r"(\d+) more features; --all", printed(page, 200)) or (0, 0)
        assert sum(map(counted, rows)) + int(left[1]) == len(file.parts[0].features)


def test_a_page_has_a_bound_and_says_what_it_leaves_out(many: StepFile) -> None:
    page = features_page(many)
    assert len(rows_of(page)) <= 4 * MOST_PARTS
    assert re.search(
        r"3 more products, \d+ more features, 11 parts as they stand in the file; --all", printed(page, 200)
    )


def test_the_command_prints_a_page_or_all_and_says_what_it_does(
    tmp_path: Path, tol3d: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    status = console.err_console.status

    def noted(words: str) -> Status:
        told.append(words)
        return status(words)

    monkeypatch.setattr(console.err_console, "status", noted)
    path = tmp_path / "block.step"
    step_file({"block": slotted_block()}, path)
    _, page, _ = tol3d("features", str(path))
    _, whole, _ = tol3d("features", str(path), "--all")
    assert "near:" not in page
    assert "near:" in whole
    assert len(page.splitlines()) < 25 < len(whole.splitlines())
    assert told == ["reading block.step"] * 2
    assert tol3d("new", "--from", str(path), "--out", str(tmp_path / "scene.yaml"))[0] == 0
    assert tol3d("check", str(tmp_path / "scene.yaml"))[0] == 0
    assert told[2:] == ["reading block.step", "reading the scene"]
