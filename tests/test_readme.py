"""What the README shows is what runs."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tol3d import load_scene, run_scene

ROOT = Path(__file__).resolve().parent.parent
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


def test_its_python_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    names: dict[str, Any] = {}
    exec(indented_block("import tol3d"), names)
    columns, again = names["columns"], names["again"]
    assert again.geometric["normal backlash"] == np.min(columns["geometric:normal backlash"])


def test_its_scene_runs(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(indented_block("scene: spur pair at the drive end"), "utf-8")
    load_scene(scene)
    assert run_scene(scene, out=tmp_path / "run").summary["status"]["ok"] == 2000


def test_the_table_it_prints_is_the_one_of_the_scene(tmp_path: Path) -> None:
    run = run_scene(ROOT / "scenes" / "spur_pair.yaml", out=tmp_path / "run")
    measure = run.summary["measures"]["normal backlash"]
    for row, key in (("low (−3 sigma)", "low_3sigma"), ("mean", "mean"), ("high (+3 sigma)", "high_3sigma")):
        shown = re.search(rf"^    {re.escape(row)} +([\d.]+) +([\d.]+) +([\d.]+)", README, re.MULTILINE)
        assert shown is not None
        for text, road in zip(shown.groups(), ("analytic_closed_form", "analytic", "geometric"), strict=True):
            # three printed digits; the geometric one may differ by rounding on another machine
            assert float(text) == pytest.approx(measure[road][key], abs=0.0011)
