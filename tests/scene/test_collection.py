"""The scenes that tol3d brings along: listed in a line each, copied with the files that they name."""

from pathlib import Path

import pytest
from fixtures import Command
from places import SCENES
from ruamel.yaml import YAML

from tol3d.scene.bundled import scene_path


def test_every_scene_has_a_line_with_its_name_and_description(tol3d: Command) -> None:
    code, out, err = tol3d("scenes")
    assert code == 0
    lines = dict(line.split(maxsplit=1) for line in out.splitlines())
    files = {path.stem: YAML(typ="safe").load(path) for path in SCENES.glob("*.yaml")}
    assert lines == {name: f"{data['scene']}: {data['description']}" for name, data in files.items()}
    assert "--copy NAME" in err


def test_a_copy_has_its_files_and_runs(tol3d: Command, tmp_path: Path) -> None:
    code, out, _ = tol3d("scenes", "--copy", "every_field", "--out", str(tmp_path / "mine"))
    assert code == 0
    copies = [tmp_path / "mine" / name for name in ("every_field.yaml", "wheel_thickness.csv")]
    assert out.splitlines() == [str(path) for path in copies]
    for path in copies:
        assert path.read_bytes() == (SCENES / path.name).read_bytes()
    study = ("--trials", "20", "--engine", "analytic", "--no-picture")
    assert tol3d("run", str(copies[0]), *study, "--out", str(tmp_path / "run"))[0] == 0


@pytest.mark.parametrize("there", ["every_field.yaml", "wheel_thickness.csv"])
def test_a_copy_overwrites_nothing(tol3d: Command, tmp_path: Path, there: str) -> None:
    (tmp_path / there).write_text("mine", "utf-8")
    code, _, err = tol3d("scenes", "--copy", "every_field", "--out", str(tmp_path))
    assert code == 2
    assert f"{tmp_path / there}: is there already" in err
    assert [path.name for path in tmp_path.iterdir()] == [there]
    assert (tmp_path / there).read_text("utf-8") == "mine"


def test_an_unknown_scene_is_refused_with_the_nearest(tol3d: Command, tmp_path: Path) -> None:
    code, _, err = tol3d("scenes", "--copy", "spur_pear", "--out", str(tmp_path))
    assert code == 2
    assert 'did you mean "spur_pair"?' in err


def test_a_file_of_ones_own_comes_before_the_scene_of_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert scene_path("spur_pair").samefile(SCENES / "spur_pair.yaml")
    (tmp_path / "spur_pair").mkdir()  # such as that of its runs
    assert scene_path("spur_pair").samefile(SCENES / "spur_pair.yaml")
    (tmp_path / "bevel_pair").write_text("mine", "utf-8")
    assert scene_path("bevel_pair") == Path("bevel_pair")


def test_a_gearbox_is_copied_by_its_whole_name(tol3d: Command, tmp_path: Path) -> None:
    name = "planetary_stage.rexs"
    code, out, _ = tol3d("scenes", "--copy", name, "--out", str(tmp_path))
    assert (code, out.split()) == (0, [str(tmp_path / name)])
    assert (tmp_path / name).read_bytes() == (SCENES / name).read_bytes()
    code, _, err = tol3d("scenes", "--copy", "planetary_stage", "--out", str(tmp_path))
    assert code == 2
    assert name in err
