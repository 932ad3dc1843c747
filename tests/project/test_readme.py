"""The README is short, and shows what runs."""

import re
from pathlib import Path

import pytest
from fixtures import Command
from places import ROOT
from scene_texts import written

from tol3d import load_scene, open_run, run_scene
from tol3d.report import run_report
from tol3d.report.sheet import as_text

README = (ROOT / "README.md").read_text("utf-8")


def indented_block(first_line: str) -> str:
    """The indented block of the README that begins with a line."""
    start = README.index(f"    {first_line}")
    lines = README[start:].splitlines()
    count = next(k for k, line in enumerate(lines) if line and not line.startswith("    "))
    return "\n".join(line[4:] for line in lines[:count])


def test_the_two_commands_stand_at_the_top() -> None:
    top = README[:2000]
    assert "python3 -m venv .venv && .venv/bin/pip install -e . && .venv/bin/tol3d run scenes/spur_pair.yaml" in top
    assert 'python3 -m venv .venv && .venv/bin/pip install -e ".[test]" && .venv/bin/pytest' in top


MOST_LINES = 80


def test_it_is_short() -> None:
    assert len(README.splitlines()) <= MOST_LINES


def test_its_scene_runs(tmp_path: Path) -> None:
    scene = written(indented_block("scene: spur pair at the drive end"), tmp_path)
    load_scene(scene)
    assert run_scene(scene, out=tmp_path / "run").summary["status"]["ok"] == 2000


NUMBER = re.compile(r"\d+(?:\.\d+)?")
WIDTH = 80  # characters of the README's block


def differs(shown: str, printed: str) -> bool:
    """True if two lines differ in a word, or in a number by more than one of its last digit.

    Rounding may do that much on another machine, whose geometric columns have other last bits.
    """
    if NUMBER.sub("#", shown) != NUMBER.sub("#", printed):
        return True
    for mine, its in zip(NUMBER.findall(shown), NUMBER.findall(printed), strict=True):
        digits = len(mine.partition(".")[2])
        if digits != len(its.partition(".")[2]) or abs(float(mine) - float(its)) > 1.001 * 10**-digits:
            return True
    return False


@pytest.fixture
def first_command(tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Output of README's first command, line by line, at the width of its block; its run is tmp_path / "run"."""
    command = re.search(r"\.venv/bin/tol3d (run scenes/\S+)\n", README)
    assert command is not None
    monkeypatch.chdir(ROOT)
    monkeypatch.setenv("COLUMNS", str(WIDTH))
    code, out, _ = tol3d(*command[1].split(), "--out", str(tmp_path / "run"), "--no-picture")
    assert code == 0
    return [line.rstrip() for line in out.splitlines()]


def test_the_block_it_shows_is_what_its_first_command_prints(first_command: list[str]) -> None:
    """Line by line, in their order; the README may leave out lines. What is told of time and place is not shown there.

    Where this fails because the tables have changed, paste what the command prints at a width of 80 characters.
    """
    printed = iter(first_command)
    block = [line.rstrip() for line in indented_block("spur pair at the drive end · ").splitlines() if line.strip()]
    assert any(line.startswith("normal backlash  OK") for line in block)
    for line in block:
        found = next((other for other in printed if not differs(line, other)), None)
        assert found is not None, f"README shows, but its first command does not print next: {line!r}"


def test_its_first_screen_has_the_verdict_first_and_thirty_lines(first_command: list[str]) -> None:
    assert len(first_command) <= 30
    assert any(line.startswith("verdict: OK") for line in first_command[:5])


@pytest.mark.usefixtures("first_command")
def test_the_manual_explains_every_row_and_column_of_the_first_table(tmp_path: Path) -> None:
    """Labels of the rows and of our own columns, as -v prints them; no label that is not."""
    printed = as_text(run_report(open_run(tmp_path / "run").found), 120).splitlines()
    manual = (ROOT / "docs" / "manual.md").read_text("utf-8")
    explained = {
        head: set(re.findall(r"`([^`]+)`", "".join(re.findall(r"^\| (`[^|]*) \|", table, re.MULTILINE))))
        for head, table in re.findall(r"^\| (column|row) \|.*\n\|---.*\n((?:\|.*\n)+)", manual, re.MULTILINE)
    }
    start = next(k for k, line in enumerate(printed) if line.startswith("[µm]"))
    end = next(k for k, line in enumerate(printed) if k > start and line.startswith(" "))
    head, *rows = (re.split(r"  +", line) for line in printed[start:end] if line and set(line) != {"─"})
    ours = {column for column in head[1:] if not column.startswith("paper")}
    assert explained == {"column": ours, "row": {row[0] for row in rows} - {"mean", "sigma", "smallest", "largest"}}
