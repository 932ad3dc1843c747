"""docs/planetary.md: what its example prints."""

import re

import pytest
from fixtures import Command
from places import ROOT

from tol3d.cli.console import out_console

PAGE = (ROOT / "docs" / "planetary.md").read_text("utf-8")
WIDTH = 110


def test_the_page_shows_what_its_command_prints(tol3d: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(out_console, "_width", WIDTH)
    monkeypatch.setattr(out_console, "_height", 100)
    code, said, _ = tol3d("design", "3k", "--ratio", "54.72", "--module", "1 mm", "--planets", "4")
    assert code == 0
    (shown,) = re.findall(r"^```text\n(3K sets.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    assert [line.rstrip() for line in said.splitlines() if line.strip()] == [
        line for line in shown.splitlines() if line.strip()
    ]


def test_the_page_s_best_efficiencies_are_found(tol3d: Command) -> None:
    _, said, _ = tol3d("design", "3k", "--ratio", "54.72", "--planets", "4", "--optimise", "forward")
    found = re.search(r"1 +25/27/79/24/76 +54\.72 +[\d.]+ +([\d.]+) +([\d.]+)", said)
    assert found is not None
    assert f"reaches {float(found[1]):.2f} % forward and {float(found[2]):.2f} % backward" in PAGE
