"""The numbers that quickstart.md quotes: those that its commands give."""

import re
from pathlib import Path

import pytest
from fixtures import Command
from places import ROOT

from tol3d import open_run

PAGE = " ".join((ROOT / "docs" / "quickstart.md").read_text("utf-8").split())


@pytest.mark.slow
def test_the_page_quotes_what_its_commands_give(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tol3d: Command
) -> None:
    monkeypatch.chdir(tmp_path)
    assert tol3d("new", "spur_pair")[0] == 0
    code, printed, _ = tol3d("run", "spur_pair.yaml", "--no-picture")
    assert code == 0
    assert "verdict: OK" in printed
    summary = open_run(Path("runs/spur_pair")).summary
    measure = summary["measures"]["normal backlash"]
    found = measure["geometric"]
    assert f"builds the pair {summary['trials']} times" in PAGE
    assert f"limits of {measure['lower_limit']:.0f} µm and {measure['upper_limit']:.0f} µm" in PAGE
    ends = f"{found['low_3sigma']:.1f} µm to {found['high_3sigma']:.1f} µm"
    assert f"mean {found['mean']:.1f} µm, mean ∓ 3 sigma {ends}" in PAGE
    first, *_ = sorted(measure["contributors"], key=lambda own: -own["geometric_percent"])
    assert first["name"] == "centre distance"
    assert first["geometric_percent"] == pytest.approx(100 / 3, abs=2.0)  # "a third"
    assert f"at most {measure['agreement']['max_abs_difference']:.3f} µm: `tol3d run spur_pair.yaml -v`" in PAGE

    asked = re.search(r'tol3d what-if spur_pair.yaml --set "([^"]+)"', PAGE)
    assert asked is not None
    code, printed, _ = tol3d("what-if", "spur_pair.yaml", "--set", asked[1])
    before, after = re.findall(r"^sigma +([\d.]+) +([\d.]+) ", printed, re.MULTILINE)[0]
    assert f"sigma of the normal backlash falls from {float(before):.1f} µm to {float(after):.1f} µm." in PAGE
