"""`tol3d identify` as a user meets it: what it prints and writes, and one message for each wrong file."""

import csv
import json
import math
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import BinaryIO

import numpy as np
import pytest
from fixtures import Command
from records.rigged import LARGEST, LEAST, PAIR, REFERENCE, scene_in
from scene_texts import scene_of

from tol3d import load_scene, run_scene
from tol3d.apps.records import csv_file
from tol3d.apps.records.findings import Settings
from tol3d.apps.records.from_scene import scene_text
from tol3d.apps.records.identification import identify
from tol3d.apps.records.pair import ARCSEC, RigPair, Side, Specimen, transmission_error
from tol3d.apps.records.rig import Rig, measured, write_readings
from tol3d.apps.records.scene_mesh import SceneMesh
from tol3d.apps.records.summary import IdentifiedSummary
from tol3d.errors import InputError
from tol3d.simulate import simulation_of

SIDES: tuple[Side, ...] = ("drive", "back")
SHORT = Rig(turns=2, samples=90)


def written(folder: Path, rig: Rig = SHORT, specimen: Specimen = REFERENCE, *, wrapped: bool = False) -> list[str]:
    """Arguments of the command for files of a rig."""
    for side in SIDES:
        write_readings(measured(specimen, rig, side), folder / f"{side}.csv", wrapped=wrapped)
    files = ("--drive", str(folder / "drive.csv"), "--back", str(folder / "back.csv"))
    return ["identify", *files, "--scene", str(scene_in(folder))]


@pytest.mark.slow  # test_records_page draws the pictures of every commit
def test_it_prints_the_figures_and_writes_the_folder(tol3d: Command, tmp_path: Path) -> None:
    out = tmp_path / "out"
    code, said, err = tol3d(*written(tmp_path, Rig(samples=180, encoder1=6 * ARCSEC), wrapped=True), "--out", str(out))
    assert (code, err) == (0, "")
    assert "least backlash of the long period" in said
    assert "133.9" in said
    assert "the back side alone disagrees" in " ".join(said.split())
    names = {"identified.json", "identified.csv", "identified.yaml", "backlash.csv", "backlash.png", "residual.png"}
    assert {path.name for path in out.iterdir()} == names
    kept = IdentifiedSummary.model_validate_json((out / "identified.json").read_text("utf-8"))
    assert kept.figures["jmin"].value == pytest.approx(LEAST, abs=0.2)
    assert kept.figures["jmax"].unit == "arcsec"
    assert set(kept.closure) == {"drive", "back", "backlash"}
    shown = next(line.split() for line in said.splitlines() if line.startswith("closure of the backlash"))
    assert float(shown[5]) == pytest.approx(kept.closure["backlash"].value, abs=6e-4)
    assert float(shown[6]) == pytest.approx(kept.closure["backlash"].half_width, abs=6e-4)
    with (out / "backlash.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 16 * 72 + 1
    assert min(float(row["predicted [arcsec]"]) for row in rows) == pytest.approx(LEAST, abs=0.3)


@pytest.mark.slow
def test_files_of_others_are_not_replaced(tol3d: Command, tmp_path: Path) -> None:
    """Files of its names without findings of its own beside them are somebody's."""
    arguments, out = written(tmp_path), tmp_path / "out"
    out.mkdir()
    (out / "backlash.csv").write_text("mine", encoding="utf-8")
    code, said, err = tol3d(*arguments, "--out", str(out))
    assert (code, said) == (2, "")
    assert "out: holds backlash.csv, not written by `tol3d identify`" in err
    assert [path.name for path in out.iterdir()] == ["backlash.csv"]
    (out / "identified.json").write_text('{"format": "another"}', encoding="utf-8")
    assert tol3d(*arguments, "--out", str(out))[0] == 2
    (out / "identified.json").write_text('{\n  "format": "tol3d identified 1"\n}', encoding="utf-8")
    assert tol3d(*arguments, "--out", str(out))[0] == 0
    assert (out / "backlash.csv").read_text("utf-8").startswith("phi1 [deg]")


@pytest.mark.parametrize("flank", ["left", "right"])
def test_a_scene_of_constants_is_read_as_the_rig_counts_and_written_back(tmp_path: Path, flank: str) -> None:
    """theta1 = -sigma psi1, theta2 = sigma (psi2 + pi + pi/z2) - j_c/2: there and back again."""
    mesh = SceneMesh.of(simulation_of(load_scene(scene_in(tmp_path, flank))), None).mesh
    found = SceneMesh.of(simulation_of(scene_of(scene_text(REFERENCE, mesh, "again"), tmp_path)), None).specimen()
    assert found.e1 == pytest.approx(REFERENCE.e1, abs=1e-12)
    assert found.normal_backlash == pytest.approx(REFERENCE.normal_backlash, abs=1e-12)
    for angle, own in ((found.theta1, REFERENCE.theta1), (found.theta2, REFERENCE.theta2)):
        assert math.remainder(angle - own, 2 * math.pi) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("flank", ["left", "right"])
def test_the_identified_scene_simulated_lies_over_the_true_curve(tol3d: Command, tmp_path: Path, flank: str) -> None:
    """By tol3d's exact engine, which shares no formula with the rig: within the interval and 0.01 arcsec."""
    arguments = written(tmp_path, Rig(samples=180, encoder1=6 * ARCSEC, encoder2=4 * ARCSEC))
    scene_in(tmp_path, flank)
    assert tol3d(*arguments, "--out", str(tmp_path / "out"))[0] == 0
    run = run_scene(tmp_path / "out" / "identified.yaml", out=tmp_path / "run")
    found = run.found.measures
    half_width = json.loads((tmp_path / "out" / "identified.json").read_text("utf-8"))["figures"]["jmin"]["half_width"]
    for name, true in (("least backlash", LEAST), ("largest backlash", LARGEST)):
        geometric = found[name].geometric
        assert geometric is not None
        assert geometric.mean is not None
        assert 60 * geometric.mean == pytest.approx(true, abs=2 * half_width + 0.01)
    sense = 1 if flank == "left" else -1  # of the driver's azimuth in its own sense of rotation
    for side in SIDES:
        measure = found[f"{side} TE curve"]
        assert measure.curve is not None
        assert measure.curve.geometric is not None
        phi1 = sense * np.radians(np.array(measure.position_deg))
        error = transmission_error(REFERENCE, phi1, side) / ARCSEC
        expected = error - error[0]
        simulated = 60 * np.array(measure.curve.geometric.mean)
        assert np.abs(simulated - expected).max() < 4 * half_width + 0.01


def test_the_mean_build_of_any_scene_is_the_specimen(tmp_path: Path) -> None:
    """-60 um of tooth thickness, all of it on one gear: j_n = 60 um cos 20 deg; no eccentricity in the mean."""
    found = SceneMesh.of(simulation_of(load_scene(scene_in(tmp_path))), None).specimen()
    assert found.normal_backlash == pytest.approx(0.060 * math.cos(math.radians(20)), abs=1e-12)
    assert (found.e1, found.e2) == (0.0, 0.0)
    assert found.pair.centre_distance == pytest.approx(75.0, abs=1e-12)
    assert found.pair.driven_base_radius == pytest.approx(PAIR.driven_base_radius)


def test_the_bundled_scene_means_the_reference_pair() -> None:
    """Its author derived the wheel's direction from the paper's theta2 by himself, to 0.001 deg."""
    found = SceneMesh.of(simulation_of(load_scene("two_sided_te")), None).specimen()
    assert found.e1 == pytest.approx(REFERENCE.e1, abs=1e-12)
    assert found.e2 == pytest.approx(REFERENCE.e2, abs=1e-12)
    assert math.degrees(math.remainder(found.theta1 - REFERENCE.theta1, 2 * math.pi)) == pytest.approx(0.0, abs=1e-9)
    assert math.degrees(math.remainder(found.theta2 - REFERENCE.theta2, 2 * math.pi)) == pytest.approx(0.0, abs=0.001)
    assert found.normal_backlash == pytest.approx(REFERENCE.normal_backlash, abs=1e-8)


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ("bevel_pair", "expected a mesh of two external spur gears, got none"),
        pytest.param(
            "door", "expected a scene whose moves are meshes of gears", marks=pytest.mark.slow
        ),  # its kernels take 10 s to load
    ],
)
def test_a_scene_without_a_spur_pair_is_refused(tol3d: Command, tmp_path: Path, scene: str, words: str) -> None:
    code, _, err = tol3d(*written(tmp_path)[:-1], scene)
    assert code == 2
    assert words in err


# files --------------------------------------------------------------------------------------------


def rows(folder: Path, name: str = "drive") -> list[str]:
    return (folder / f"{name}.csv").read_text("utf-8").splitlines()


def changed(folder: Path, lines: list[str], name: str = "drive") -> None:
    (folder / f"{name}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


def with_cell(folder: Path, line: int, column: int, text: str) -> None:
    lines = rows(folder)
    cells = lines[line - 1].split(",")
    cells[column] = text
    lines[line - 1] = ",".join(cells)
    changed(folder, lines)


def missing_column(folder: Path) -> None:
    changed(folder, [line.replace("phi2 [deg]", "angle [deg]") for line in rows(folder)])


def no_unit(folder: Path) -> None:
    changed(folder, ["phi1,phi2", *rows(folder)[1:]])


def unknown_unit(folder: Path) -> None:
    changed(folder, ["phi1 [grad],phi2 [grad]", *rows(folder)[1:]])


def degrees_as_radians(folder: Path) -> None:
    for name in ("drive", "back"):
        changed(folder, ["phi1 [rad],phi2 [rad]", *thinned(rows(folder, name)[1:])], name)


def radians_as_degrees(folder: Path) -> None:
    for name in ("drive", "back"):
        cells = [[math.radians(float(cell)) for cell in line.split(",")] for line in rows(folder, name)[1:]]
        changed(folder, ["phi1 [deg],phi2 [deg]", *(f"{a:.12f},{b:.12f}" for a, b in cells)], name)


def thinned(lines: list[str]) -> list[str]:
    """By interpolation four times as many rows: 1 deg from one to the next."""
    values = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    at = np.linspace(0, len(values) - 1, 4 * len(values) - 3)
    dense = [np.interp(at, np.arange(len(values)), values[:, k]) for k in (0, 1)]
    return [f"{a:.9f},{b:.9f}" for a, b in zip(*dense, strict=True)]


def reversing(folder: Path) -> None:
    lines = rows(folder)
    changed(folder, [*lines[:50], lines[40], *lines[51:]])


def empty(folder: Path) -> None:
    (folder / "drive.csv").write_text("", encoding="utf-8")


def header_only(folder: Path) -> None:
    changed(folder, rows(folder)[:1])


def too_few_cells(folder: Path) -> None:
    lines = rows(folder)
    changed(folder, [*lines[:9], lines[9].split(",")[0], *lines[10:]])


def one_turn(folder: Path) -> None:
    changed(folder, rows(folder)[:91])


def other_gear(folder: Path) -> None:
    pair = RigPair(27, 47, PAIR.driver_base_radius, PAIR.driven_base_radius * 47 / 48, 74.0)
    own = Specimen(pair, 0.018, 0.0, 0.027, 0.0, 0.06)
    write_readings(measured(own, SHORT, "drive"), folder / "drive.csv")


def absent(folder: Path) -> None:
    (folder / "drive.csv").unlink()


def binary(folder: Path) -> None:
    (folder / "drive.csv").write_bytes(bytes(range(128, 256)) * 9)


def pipe(folder: Path) -> None:
    absent(folder)
    os.mkfifo(folder / "drive.csv")


def device(folder: Path) -> None:
    absent(folder)
    (folder / "drive.csv").symlink_to("/dev/zero")


def many_columns(folder: Path) -> None:
    changed(folder, [",".join(f"column {k}" for k in range(6000)), *rows(folder)[1:]])


def long_line(folder: Path) -> None:
    changed(folder, [*rows(folder), "1" * (3 * csv_file.BLOCK_BYTES)])


def counted_rows(folder: Path) -> None:
    head, *others = rows(folder)
    changed(folder, [f"{head},repeat", *(f"{row},{k}" for k, row in enumerate(others))])


def half_a_pass(folder: Path) -> None:
    head, *others = rows(folder)
    changed(folder, [f"{head},repeat", *(f"{row},0.5" for row in others)])


def torque_of_nothing(folder: Path) -> None:
    head, *others = rows(folder)
    changed(folder, [f"{head},torque [N m]", *(f"{row},1e300" for row in others)])


Change = Callable[[Path], None]
SideChange = Callable[[Path, str], None]

WRONG: Mapping[Change, str] = {
    missing_column: "drive.csv: missing column 'phi2': expected `phi2 [deg]` in the header, got 'phi1 [deg]', 'angle",
    no_unit: "drive.csv: column 'phi1' has no unit: expected `phi1 [deg]` in the header or --unit",
    unknown_unit: "drive.csv: column 'phi1': unknown unit 'grad'; expected one of rad, mrad",
    degrees_as_radians: "drive.csv: the angles are read as radians, but repeat once per turn only as degrees",
    radians_as_degrees: "drive.csv: the angles are read as degrees, but repeat once per turn only as radians",
    reversing: "drive.csv:51: the driver turns back by",
    empty: "drive.csv: empty; expected a header such as",
    header_only: "drive.csv: no rows of data below the header",
    too_few_cells: "drive.csv:10: expected 2 cells, as in the header, got 1",
    one_turn: "drive.csv: the drive side covers 0.99 turns of the driver: too little",
    other_gear: "drive.csv: other gears: the driven gear turns by 0.5743",
    absent: "drive.csv: cannot be read (No such file or directory)",
    binary: "drive.csv:1: expected a CSV file in UTF-8, got other bytes",
    pipe: "drive.csv: expected a file, got a pipe or a device",
    device: "drive.csv: expected a file, got a pipe or a device",
    many_columns: "drive.csv: missing column 'phi1': expected `phi1 [deg]` in the header, got 'column 0', 'column 1', ",
    counted_rows: "drive.csv:2: column 'repeat': expected one number for all rows of a pass, got 1",
    half_a_pass: "drive.csv:2: column 'repeat': expected whole numbers from 0, which count passes, got 0.5",
    torque_of_nothing: "drive.csv:2: column 'torque': expected at most 1e9 N m, got 1e+300 N m; check its unit",
    long_line: "drive.csv: cannot be read as CSV: a line is longer than 2 MB",
}


@pytest.mark.parametrize("wrong", WRONG, ids=[change.__name__ for change in WRONG])
def test_a_wrong_file_gets_one_message_and_exit_code_2(tol3d: Command, tmp_path: Path, wrong: Change) -> None:
    arguments = written(tmp_path)
    wrong(tmp_path)
    code, out, err = tol3d(*arguments, "--out", str(tmp_path / "out"))
    assert (code, out) == (2, "")
    assert WRONG[wrong] in err
    assert err.count("\n") == 1
    assert len(err) < 600 + 2 * len(str(tmp_path))
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "words"),
    [("nan", "NaN"), ("", "an empty cell"), ("x", "expected a number, got 'x'"), ("inf", "a finite number, got inf")],
)
def test_a_wrong_cell_is_named_by_its_line(tol3d: Command, tmp_path: Path, text: str, words: str) -> None:
    arguments = written(tmp_path)
    with_cell(tmp_path, 12, 1, text)
    lines = rows(tmp_path)
    changed(tmp_path, ["# rig 7", *lines[:5], "", *lines[5:]])  # a comment and a blank line: two lines further down
    code, _, err = tol3d(*arguments)
    assert code == 2
    assert "drive.csv:14: " in err
    assert words in err


def test_too_many_rows_are_refused(tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert csv_file.MOST_ROWS == 10**8
    monkeypatch.setattr(csv_file, "MOST_ROWS", 100)
    code, _, err = tol3d(*written(tmp_path))
    assert code == 2
    assert "drive.csv: more than 1e+02 rows" in err


def test_other_gears_are_named(tol3d: Command, tmp_path: Path) -> None:
    arguments = written(tmp_path)
    other_gear(tmp_path)
    assert "expected 27/48 = 0.562500 by the scene; 27/47 teeth would fit" in tol3d(*arguments)[2]


@pytest.mark.parametrize("option", [("--j0", "267"), ("--encoder-error", "20 um"), ("--mesh", "other")])
def test_a_wrong_option_gets_one_message(tol3d: Command, tmp_path: Path, option: tuple[str, str]) -> None:
    code, _, err = tol3d(*written(tmp_path), *option)
    assert code == 2
    assert f"{option[0]}: expected" in err
    assert f"got '{option[1]}'" in err


@pytest.mark.slow
def test_degrees_are_told_from_radians_in_dense_files_too(tmp_path: Path) -> None:
    """90 000 rows over four turns, so that one block of a file is less than a turn."""
    written(tmp_path, Rig(turns=4, samples=22_500))
    for name in ("drive", "back"):
        changed(tmp_path, ["phi1 [rad],phi2 [rad]", *rows(tmp_path, name)[1:]], name)
    with pytest.raises(InputError, match="read as radians, but repeat once per turn only as degrees"):
        identify(PAIR, [tmp_path / "drive.csv"], [tmp_path / "back.csv"], Settings())


def test_an_interrupted_command_says_so_and_leaves_nothing_half_written(
    tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    arguments, out = written(tmp_path), tmp_path / "out"

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as own:
        own.setattr("tol3d.apps.records.reading.blocks_of", interrupted)
        assert tol3d(*arguments, "--out", str(out)) == (130, "", "stopped\n")
    assert not out.exists()
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def half_written(stream: BinaryIO, *_: object, **__: object) -> None:
        stream.write(b"phi1 [deg],phi2 [deg]\n0,")
        raise KeyboardInterrupt

    monkeypatch.setattr(np, "savetxt", half_written)
    assert tol3d("rig", arguments[-1], "--turns", "1", "--out", str(out)) == (130, "", "stopped\n")
    assert list(out.iterdir()) == []
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == before


# the same angles in other words ---------------------------------------------------------------------


def figures(folder: Path) -> dict[str, float]:
    found = identify(PAIR, [folder / "drive.csv"], [folder / "back.csv"], Settings())
    return {name: own.value for name, own in found.figures.items()}


def semicolons(folder: Path, name: str) -> None:
    lines = [line.replace(",", ";").replace(".", ",") for line in rows(folder, name)[1:]]
    changed(folder, ["phi1 [deg];phi2 [deg]", *lines], name)


def in_turns(folder: Path, name: str) -> None:
    cells = [[float(cell) / 360 for cell in line.split(",")] for line in rows(folder, name)[1:]]
    changed(folder, ["note,PHI2 (rev),phi1 [rev]", *(f"a,{b:.15f},{a:.15f}" for a, b in cells)], name)


def within_one_turn(folder: Path, name: str) -> None:
    cells = [[float(cell) % 360 for cell in line.split(",")] for line in rows(folder, name)[1:]]
    changed(folder, ["phi1 [deg],phi2 [deg]", *(f"{a:.12f},{b:.12f}" for a, b in cells)], name)


def the_other_way(folder: Path, name: str) -> None:
    cells = [[float(cell) for cell in line.split(",")] for line in rows(folder, name)[1:]]
    changed(folder, ["phi1 [deg],phi2 [deg]", *(f"{-a:.12f},{b:.12f}" for a, b in cells)], name)


def backwards(folder: Path, name: str) -> None:
    """The back side measured turning back."""
    lines = rows(folder, name)
    changed(folder, [lines[0], *(reversed(lines[1:]) if name == "back" else lines[1:])], name)


def test_blocks_of_a_file_add_up_and_a_standstill_before_the_run_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Blocks of 20 rows of single-turn encoders, turning backward, after 60 rows in which nothing turns."""
    written(tmp_path)
    plain = figures(tmp_path)
    for name in ("drive", "back"):
        within_one_turn(tmp_path, name)
        lines = rows(tmp_path, name)
        cells = [[360 - float(cell) for cell in line.split(",")] for line in lines[1:]]
        still = [cells[0]] * 60 if name == "drive" else []
        changed(tmp_path, [lines[0], *(f"{a:.12f},{b:.12f}" for a, b in [*still, *cells])], name)
    monkeypatch.setattr(csv_file, "BLOCK_BYTES", 600)
    found = figures(tmp_path)
    assert found["jmin"] == pytest.approx(plain["jmin"], abs=0.3 * ARCSEC)  # the first row counts sixty times
    assert found["e2"] == pytest.approx(plain["e2"], abs=1e-4)
    changed(tmp_path, rows(tmp_path)[:50])
    with pytest.raises(InputError, match="the driver does not turn"):
        figures(tmp_path)


@pytest.mark.parametrize("start", [-1e-4, -0.6, 0.0, 1e-4])
def test_single_turn_encoders_that_begin_just_below_zero_have_it_in_the_first_row(tmp_path: Path, start: float) -> None:
    """359.9999 deg and then 1: phi1 = 0 is the zero that is passed, not the one a turn before, where j is 227.5."""
    written(tmp_path, Rig(turns=2, samples=180, noise=0.0, start=math.radians(start)), wrapped=True)
    assert figures(tmp_path)["j0"] / ARCSEC == pytest.approx(267.037, abs=0.001)


@pytest.mark.parametrize("other", [semicolons, in_turns, within_one_turn, the_other_way, backwards])
def test_the_same_angles_otherwise_written_give_the_same(tmp_path: Path, other: SideChange) -> None:
    written(tmp_path)
    plain = figures(tmp_path)
    for name in ("drive", "back"):
        other(tmp_path, name)
    assert figures(tmp_path) == pytest.approx(plain, abs=1e-9, rel=1e-6)
