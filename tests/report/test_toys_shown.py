"""A system that is no gear is run, shown, compared and exported by the commands: a package offers it, nothing else."""

import json
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
import trimesh
from fixtures import Command
from matplotlib.image import imread
from of_kind import known as known_value
from of_kind import of_kind
from rendering import renders
from schemas import validate
from toys.parabola.showing import SIDE
from toys.registered import TOYS

from tol3d import InputError, Run, check_scene, compare_runs, open_run, replay
from tol3d.report import export_run, view_run
from tol3d.report.page import Table
from tol3d.report.spectrum_table import largest_orders, spectrum_blocks
from tol3d.study.runs.summary.sample import SpectrumSample
from tol3d.study.runs.summary.values import made

pytestmark = pytest.mark.usefixtures("springs")

SPRING = TOYS / "parabola" / "spring.yaml"
ALL = ("--pictures", "all")
HEIGHT = "geometric:height"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("springs")


@pytest.fixture
def run(tol3d: Command, folder: Path) -> Run:
    """A run of the command, once."""
    path = folder / "run"
    if not path.exists():
        code, out, err = tol3d(
            "run", str(SPRING), "--trials", "3000", "--witness", "20", "--out", str(path), "-v", *ALL
        )
        (folder / "printed").write_text(out, "utf-8")
        assert code == 0, err
    return open_run(path)


def test_the_command_prints_its_tables_and_draws_its_pictures(run: Run, folder: Path) -> None:
    printed = (folder / "printed").read_text("utf-8")
    for words in (
        "value of the height of lift",
        "mean of the bow",
        "term: sigma [µm]",
        "witness: CHORDS measured 20 of these trials again",
        "theirs",
        "trials too long",
    ):
        assert words in printed, words
    assert not [word for word in ("gear", "tooth", "backlash", "FCL") if word in printed]
    names = {path.name for path in run.path.iterdir()}
    assert {"histogram.png", "terms.png", "histogram-room.png"} <= names
    assert imread(run.path / "terms.png").shape[:2] == (100, 150)


def test_the_spectrum_of_a_curve_is_printed_by_order(run: Run, folder: Path) -> None:
    profile = run.found.measures["profile"]
    curve = known_value(profile.curve)
    table, _ = spectrum_blocks(profile, curve)
    assert isinstance(table, Table)
    headings = [heading.text for heading in table.headings]
    for sample, word in ((curve.analytic, "analytic"), (known_value(curve.geometric), "3D")):
        own = known_value(sample.spectrum)
        for key, values in (("mean", own.mean), ("p50", own.p50), ("p99.865", own.p99_865)):
            cells = [row.cells[headings.index(f"{word} {key}")] for row in table.rows]
            assert [float(cell) for cell in cells] == pytest.approx(values, abs=6e-4)  # um, of which 3 digits are shown
    assert [row.label for row in table.rows] == ["1", "2", "5"]
    assert "amplitude [µm]" in (folder / "printed").read_text("utf-8")


def test_of_many_orders_the_largest_are_printed() -> None:
    means: list[float | None] = [float(k * 7 % 20) for k in range(20)]
    numbers = [float(k) for k in range(1, 21)]
    same = {"sigma": means, "p0_135": means, "p50": means, "p99_865": means, "max": means}
    own = made(SpectrumSample, order=numbers, mean=means, **same)
    assert [means[k] for k in largest_orders(own)] == [mean for mean in means if mean is not None and mean >= 8.0]


def test_check_tells_of_the_spring(tol3d: Command) -> None:
    code, out, _ = tol3d("check", str(SPRING))
    assert code == 0
    assert "spring spring: a 0.5, b 2, q 3" in out
    assert "3000" not in out


def test_the_command_prints_the_schema_that_its_summary_keeps(tol3d: Command, run: Run) -> None:
    schema = json.loads(tol3d("schema", "--summary")[1])
    validate(json.loads((run.path / "summary.json").read_text("utf-8")), schema)
    scenes = json.loads(tol3d("schema")[1])
    assert "chords" in scenes["$defs"]["Study"]["properties"]["engine"]["enum"]


@pytest.mark.slow
def test_runs_are_compared(tol3d: Command, run: Run, folder: Path) -> None:
    other = folder / "other"
    assert tol3d("run", str(SPRING), "--trials", "1000", "--seed", "3", "--no-picture", "--out", str(other))[0] == 0
    code, out, _ = tol3d("compare", str(run.path), str(other), "--out", str(folder / "compared.png"))
    assert code == 0
    assert (folder / "compared.png").stat().st_size > 10_000
    mean = run.summary["measures"]["height"]["geometric"]["mean"]
    assert f"{mean:.3f}" in out
    assert "room" in out


@pytest.mark.parametrize("fmt", ["stl", "glb", "step"])
def test_a_trial_is_exported_where_it_lifted_to(fmt: str, run: Run, tol3d: Command, tmp_path: Path) -> None:
    code, out, err = tol3d("export", str(run.path), "--trial", "5", "--format", fmt, "--out", str(tmp_path))
    assert code == 0, err
    path = tmp_path / f"trial-5.{fmt}"
    assert out.strip() == str(path)
    if fmt == "stl":
        own = trimesh.load_mesh(path)
        assert own.is_watertight
        assert own.volume == pytest.approx(20.0 * SIDE**2, rel=1e-5)
        assert own.bounds[0, 2] == pytest.approx(1e-3 * run.columns(HEIGHT)[HEIGHT][5], rel=1e-4)
    if fmt == "step":
        (solid,) = (of_kind(cq.Solid, own) for own in cq.importers.importStep(str(path)).solids().vals())
        assert solid.Volume() == pytest.approx(20.0 * SIDE**2, rel=1e-12)
        assert solid.BoundingBox().zmin == pytest.approx(1e-3 * run.columns(HEIGHT)[HEIGHT][5], abs=1e-6)


def test_the_worst_trial_is_exported_and_magnified(run: Run, tmp_path: Path) -> None:
    columns = run.columns("geometric:room", HEIGHT)
    deepest = int(np.nanargmin(columns["geometric:room"]))
    (path,) = export_run(run, "worst", "stl", out=tmp_path).files
    assert path.name == f"trial-{deepest}.stl"
    assert trimesh.load_mesh(path).bounds[0, 2] == pytest.approx(1e-3 * columns[HEIGHT][deepest], rel=1e-4)
    (far,) = export_run(run, "nominal", "stl", out=tmp_path, magnify=3.0).files
    assert trimesh.load_mesh(far).bounds[0, 2] == 0.0


@pytest.mark.slow
@renders
def test_a_trial_is_shown(run: Run, tol3d: Command, tmp_path: Path) -> None:
    picture = tmp_path / "seen.png"
    code, _, err = tol3d("view", str(run.path), "--trial", "5", "--screenshot", str(picture))
    assert code == 0, err
    assert imread(picture).std() > 0.02  # something is drawn
    with pytest.raises(InputError, match="nothing of a spring is shown close up"):
        view_run(run, 5, screenshot=picture, close_up="coil")


def test_in_python_all_of_it_is_there_too(run: Run) -> None:
    told = check_scene(SPRING)
    assert "spring spring: a 0.5, b 2, q 3" in str(told)
    with pytest.raises(InputError, match="expected moves that are meshes or trains of gears"):
        _ = told.model
    again = replay(run, 5)
    assert again.poses["spring"][2, 3] == pytest.approx(1e-3 * run.columns(HEIGHT)[HEIGHT][5])
    assert again.meshes["spring"].is_watertight
    assert "room" in str(compare_runs([run]))
    assert len(run.frame()) == 3000
