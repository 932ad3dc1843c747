"""Files of measured flanks: where their values go, what is refused and how, and that runs keep them."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from scene_texts import scene_of

from tol3d import open_run, replay, run_scene
from tol3d.errors import RunError, SceneError
from tol3d.gearing.model import Model, model_from_scene
from tol3d.study.execution.pools import Execution

SCENE = """
scene: teeth
parts:
  pinion:
    {{kind: spur_gear, teeth: 5, module: 2 mm, face_width: 12 mm, pressure_angle: 25 deg, profile_shift: 0.56,
      addendum: 0.8}}
  wheel: {{kind: spur_gear, teeth: 30, module: 2 mm, face_width: 10 mm, pressure_angle: 25 deg}}
tolerances:
  teeth: {{{entry}}}
moves:
  pair: {{kind: mesh, driver: pinion, driven: wheel, centre_distance: 36.1 mm}}
measures:
  play: {{kind: normal_backlash, of: pair}}
study: {{trials: 4, engine: analytic, witness: 0}}
"""
RECORD = "law: {kind: record, file: teeth.csv, column: d"
SLOPE = f"kind: profile_slope, of: pinion, flanks: each, each: tooth, {RECORD}}}"
GEAR = f"kind: profile_slope, of: pinion, flanks: each, each: gear, {RECORD}}}"
PITCH = f"kind: pitch_deviation, of: pinion, flanks: right, {RECORD}, deviation: single}}"
INDEX = f"kind: pitch_deviation, of: pinion, flanks: together, {RECORD}, deviation: index}}"
HEADER = "tooth,flank,d [um]"
ROWS = [f"{k},{side},{k}.{n}" for n, side in enumerate(("right", "left")) for k in range(1, 6)]


def model(folder: Path, entry: str, lines: Sequence[str]) -> Model:
    (folder / "teeth.csv").write_text("\n".join(lines) + "\n", "utf-8")
    return model_from_scene(scene_of(SCENE.format(entry=entry), folder))


def given_um(folder: Path, entry: str, lines: Sequence[str]) -> list[float]:
    (own,) = model(folder, entry, lines).contributors
    return (1e3 * np.array(own.draw.deviations())).tolist()


def test_values_stand_at_their_teeth_whatever_the_order_of_rows(tmp_path: Path) -> None:
    wanted = [1.0, 2.0, 3.0, 4.0, 5.0, 1.1, 2.1, 3.1, 4.1, 5.1]
    assert given_um(tmp_path, SLOPE, [HEADER, *ROWS]) == pytest.approx(wanted)
    assert given_um(tmp_path, SLOPE, [HEADER, *reversed(ROWS)]) == pytest.approx(wanted)
    from_zero = [f"{int(row[0]) - 1}{row[1:]}" for row in ROWS]
    assert given_um(tmp_path, SLOPE, [HEADER, *from_zero]) == pytest.approx(wanted)


@pytest.mark.parametrize("unit", [", unit: mm", ", unit: um"])
def test_the_unit_stands_in_the_header_or_in_the_scene(unit: str, tmp_path: Path) -> None:
    """In mm the largest is 5 um."""
    thousandth = [f"{row[:-3]}{float(row[-3:]) / 1000}" if "mm" in unit else row for row in ROWS]
    entry = SLOPE.replace("column: d", f"column: d{unit}")
    assert max(given_um(tmp_path, entry, ["Tooth,Flank,d", *thousandth])) == pytest.approx(5.1)


def test_clockwise_teeth_run_the_other_way_and_lie_behind(tmp_path: Path) -> None:
    """F of the file: 0, 3, 2, -1, -4 less 0; the file's second tooth is the gear's last, and lies 3 um clockwise."""
    lines = ["tooth,d (µm)", *(f"{k},{value}" for k, value in enumerate((0, 3, 2, -1, -4)))]
    entry = INDEX.replace("column: d", "column: d, counted: clockwise")
    assert given_um(tmp_path, INDEX, lines) == pytest.approx([0, 3, 2, -1, -4])
    assert given_um(tmp_path, entry, lines) == pytest.approx([0, 4, 1, -2, -3])


def test_single_pitches_add_up_from_the_flank_before(tmp_path: Path) -> None:
    """1, 2, -1, -3 and 1 um: F = 1, 3, 2, -1, 0 less their mean, 1; each pitch is what its tooth adds."""
    lines = [HEADER, *(f"{k + 1},right,{value}" for k, value in enumerate((1, 2, -1, -3, 1)))]
    assert given_um(tmp_path, PITCH, lines) == pytest.approx([0, 2, 1, -2, -1])


def test_all_teeth_have_the_mean_of_those_that_were_measured(tmp_path: Path) -> None:
    lines = [HEADER, "1,right,1.0", "2,right,", "4,right,2.5", "3,left,-1"]
    assert given_um(tmp_path, GEAR, lines) == pytest.approx([1.75, -1.0])


@pytest.mark.parametrize(
    ("entry", "lines", "words"),
    [
        (
            SLOPE,
            [HEADER, *ROWS[:3], *ROWS[4:]],
            "teeth.csv: column 'd': expected a row for each of 5 teeth, got none for the right flank of tooth 4",
        ),
        (SLOPE, [HEADER, *ROWS, ROWS[1]], "teeth.csv:12: the right flank of tooth 2 again, as in line 3"),
        (SLOPE, [HEADER, *ROWS[:-1], "5,link,1"], ":11: column 'flank': expected right or left, got 'link'"),
        (SLOPE, [HEADER, *ROWS[:-1], "6,left,1"], "expected a tooth from 1 to 5 of a gear with 5 teeth, got '6'"),
        (SLOPE, [HEADER, *ROWS[:-1], "x,left,1"], "expected the number of a tooth, such as 7, got 'x'"),
        (SLOPE, [HEADER, *ROWS[:-1], "5,left,"], ":11: column 'd [um]': expected a number such as 4.5, got an empty"),
        (SLOPE, [HEADER, *ROWS[:-1], "5,left,nan"], "expected a number such as 4.5, got 'nan'"),
        (SLOPE, [HEADER, *ROWS[:-1], '5,left,"1,5"'], "decimal commas, put semicolons between the cells"),
        (SLOPE, [HEADER, *ROWS[:-1], "5,left,1,5"], ":11: expected 3 cells, as in the header, got 4; where numbers"),
        (SLOPE, [HEADER, *ROWS[:-1], "5,left,5000"], "expected a deviation of at most 1 mm, got '5000'; is its unit"),
        (SLOPE, ["tooth,flank,d", *ROWS], "column 'd': expected its unit, as in 'd [um]', one of mm, um"),
        (SLOPE, ["tooth,flank,d [N]", *ROWS], "got 'N'"),
        (SLOPE, ["tooth,flank,e [um]", *ROWS], ":1: expected one column named 'd' in the header, got 'tooth', 'flank'"),
        (SLOPE, ["tooth,side,d [um]", *ROWS], "expected a column named 'flank' in the header"),
        (SLOPE, ["t,flank,d [um]", *ROWS], "expected a column named 'tooth' in the header"),
        (SLOPE, [], "expected one column named 'd' in the header, got an empty file"),
        (
            SLOPE.replace("column: d", "column: d, unit: mm"),
            [HEADER, *ROWS],
            "expected the unit 'mm' that the scene gives, got 'um'",
        ),
        (GEAR, [HEADER, "1,right,1.0"], "got none for the left flank of tooth 1, 2, 3, 4, 5"),
        (
            PITCH,
            [HEADER, *(f"{k},right,{k}.5" for k in range(1, 6))],
            "single pitch deviations that sum to zero over the right flanks, got 17.5 um; index deviations are",
        ),
        (INDEX, [HEADER, *ROWS[:5]], "expected no column 'flank' beside flanks: together in the header"),
        (SLOPE.replace("column: d", "column: d, unit: deg"), [HEADER], "expected a unit of length such as um, got"),
        (SLOPE.replace("column: d", "column: d, counted: up"), [HEADER], "law.counted"),
        (
            f"{SLOPE}, limits: {{size: 3 um}}",
            [HEADER, *ROWS],
            "limits: expected none beside a law that is record, got limits",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_place(entry: str, lines: Sequence[str], words: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError) as found:
        model(tmp_path, entry, lines)
    assert words in str(found.value)
    assert "\n" not in str(found.value).strip()


def test_a_file_that_is_missing_is_named_at_its_place(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"tolerances\.teeth\.law\.file: .*teeth\.csv"):
        scene_of(SCENE.format(entry=SLOPE), tmp_path)


@pytest.mark.slow
def test_a_run_keeps_the_file_and_replays_without_it(tmp_path: Path) -> None:
    first = model(tmp_path, SLOPE, [HEADER, *ROWS])
    assert len(first.contributors) == 1
    run = run_scene(tmp_path / "scene.yaml", out=tmp_path / "run")
    values = run.columns("analytic:play")["analytic:play"]
    (tmp_path / "teeth.csv").unlink()
    (tmp_path / "scene.yaml").unlink()
    moved = open_run(run.path.rename(tmp_path / "elsewhere"))
    assert len(set(values)) == 4  # positions differ
    assert [replay(moved, trial).analytic["play"] for trial in range(4)] == values.tolist()


def test_another_file_is_another_study(tmp_path: Path) -> None:
    model(tmp_path, SLOPE, [HEADER, *ROWS])
    first = run_scene(tmp_path / "scene.yaml", out=tmp_path / "run")
    model(tmp_path, SLOPE, [HEADER, *ROWS[:-1], "5,left,0.0"])
    with pytest.raises(RunError, match=r"files: teeth\.csv"):
        run_scene(tmp_path / "scene.yaml", out=tmp_path / "run", execution=Execution(resume=True))
    assert first.columns("teeth.left 4 [um]")["teeth.left 4 [um]"].tolist() == pytest.approx([5.1] * 4)


def test_a_measured_sample_is_a_law_of_slopes_too(tmp_path: Path) -> None:
    """`stated` with an empirical distribution names a file as every other tolerance does."""
    (tmp_path / "sample.csv").write_text("s\n1\n2\n3\n", "utf-8")
    law = "law: {kind: stated, distribution: {kind: empirical, file: sample.csv, column: s, unit: um}}"
    entry = f"kind: profile_slope, of: pinion, flanks: each, each: tooth, {law}"
    (own,) = model(tmp_path, entry, []).contributors
    assert own.draw.sigma == pytest.approx(1e-3)  # s of 1, 2, 3 um
