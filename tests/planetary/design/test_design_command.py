"""`tol3d design` as a user meets it."""

import csv
import math
import re
from pathlib import Path

import pytest
from fixtures import Command

from tol3d import run_scene

PAPER = ("design", "3k", "--ratio", "54.72", "--module", "1 mm", "--planets", "4")


def words(said: str) -> str:
    return " ".join(said.split())


def test_it_prints_the_set_of_the_paper(tol3d: Command) -> None:
    code, said, err = tol3d(*PAPER)
    assert (code, err) == (0, "")
    assert "25/27/79/24/76 54.72 26.0000 85.163 82.856 7.770" in words(said)
    assert "E, published formula 0.69265 0.97524 0.97470" in words(said)
    assert "left out by assembly: 43 sets of that ratio" in words(said)
    assert "the published E is too large for ring 1 and ring 2" in words(said)


def test_shifts_for_efficiency_and_the_table_as_csv(tol3d: Command, tmp_path: Path) -> None:
    out = tmp_path / "sets.csv"
    code, said, _ = tol3d(*PAPER, "--optimise", "forward", "--out", str(out))
    assert code == 0
    assert str(out) in said.replace("\n", "") + _
    (row,) = csv.DictReader(out.read_text("utf-8").splitlines())
    assert row["S/P1/R1/P2/R2"] == "25/27/79/24/76"
    assert float(row["forward [%]"]) > 89.0
    assert float(row["x R1"]) == pytest.approx(-1.0, abs=1e-6)


def test_a_set_that_locks_itself_is_said_to(tol3d: Command) -> None:
    code, said, _ = tol3d("design", "3k", "--ratio", "1000")
    assert code == 0
    assert "20.503 locks itself" in words(said)


def test_sets_turn_backwards_and_simple_ones_are_found(tol3d: Command) -> None:
    assert "-100" in tol3d("design", "3k", "--ratio", "-100", "--most", "2")[1]
    code, said, _ = tol3d("design", "simple", "--ratio", "4.5", "--detail", "2")
    assert code == 0
    assert "candidate 2:" in said


THIN = -0.04  # mm along the normal, every tooth


@pytest.mark.parametrize(
    ("wish", "free"),
    [
        # all gaps alike, c = 0.04 mm along the normal on either side of each tooth: 4 c / r_R2 by base radii
        (PAPER[1:], 4 * 0.04 / (38 * math.cos(math.radians(20)))),
        ((*PAPER[1:], "--optimise", "forward"), 4 * 0.04 / (38 * math.cos(math.radians(20)))),
        # carrier over a held ring and a standing sun: both gaps, 2 c each way, over the sum of base radii
        (("simple", "--ratio", "4.5"), 2 * (0.04 + 0.04) / ((12 + 42) / 2 * math.cos(math.radians(20)))),
        # 12/24/12/48: gaps of the sun's mesh are seen by the ring's in the ratio of the planets' steps, 1/2
        (
            ("compound", "--ratio", "9", "--tolerance", "0"),
            2 * 0.04 * (1 + 1 / 2) / ((24 + 6 / 2) * math.cos(math.radians(20))),
        ),
    ],
)
def test_a_candidate_is_a_scene_that_runs(tol3d: Command, tmp_path: Path, wish: tuple[str, ...], free: float) -> None:
    """With all teeth thinned alike the lost motion is the closed form, whatever the profile shifts."""
    code, said, err = tol3d("design", *wish, "--scene", "1")
    assert (code, err) == (0, "")
    alike = re.sub(r"distribution: \{.*?\}", f"distribution: {{kind: constant, value: {THIN} mm}}", said)
    (tmp_path / "set.yaml").write_text(alike.replace("trials: 20000", "trials: 20"), encoding="utf-8")
    run = run_scene(tmp_path / "set.yaml", out=tmp_path / "run")
    found = run.summary["measures"]["lost motion"]
    for method in ("analytic", "geometric"):
        assert found[method]["mean"] == pytest.approx(math.degrees(free) * 60, abs=2e-4)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("--ratio", "54.72", "--planets", "8"), "86 is not divisible by 8"),
        (("--ratio", "54.72", "--planets", "4", "--detail", "2"), "--detail: expected a candidate from 1 to 1, got 2"),
        (("--ratio", "54.72", "--planets", "4", "--scene", "2"), "--scene: expected a candidate from 1 to 1, got 2"),
        (("--ratio", "54.72", "--module", "1"), "--module: expected a length with its unit"),
        (("--ratio", "54.72", "--module", "0 mm"), "module: expected more than 0 mm, got 0 mm"),
        (("--ratio", "54.72", "--pressure-angle", "60 deg"), "pressure angle: expected 5 to 45 deg, got 60 deg"),
        (("--ratio", "nan"), "ratio: expected a number other than 0"),
        (("--ratio", "0"), "ratio: expected a number other than 0"),
    ],
)
def test_wrong_wishes_get_one_message(tol3d: Command, arguments: tuple[str, ...], expected: str) -> None:
    code, said, err = tol3d("design", "3k", *arguments)
    assert (code, said) == (2, "")
    assert expected in words(err)
