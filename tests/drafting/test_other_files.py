"""Assemblies whose parts stand in other files, as Open CASCADE writes them: read from their own folder alone."""

import contextlib
import re
import shutil
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
import yaml
from assembly_trials import assembled
from cadquery.occ_impl.assembly import toCAF
from fixtures import Command
from foreign_parts import solid
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs

from tol3d.apps.drafting import scene_from
from tol3d.apps.drafting.other_files import MOST_FILES, with_other_files
from tol3d.cad.step import StepError
from tol3d.cad.step.reading import read_step
from tol3d.files import FileContent, read_file


def parted(folder: Path) -> Path:
    """A plate with two ⌀6.4 holes at (1, 2, 3), and a sub-assembly at z = 5 of two ⌀6 bolts, one turned by 90° about x.

    Three files: all.stp, part_plate.stp and part_bolt.stp.
    """
    bolt = solid(cq.Workplane().circle(3).extrude(20))
    plate = solid(cq.Workplane().box(60, 40, 10).faces(">Z").workplane().pushPoints([(-10, 0), (15, 5)]).hole(6.4))
    whole = cq.Assembly(name="all")
    whole.add(plate, name="plate", loc=cq.Location(cq.Vector(1, 2, 3)))
    bolts = cq.Assembly(name="bolts", loc=cq.Location(cq.Vector(0, 0, 5)))
    bolts.add(bolt, name="bolt", loc=cq.Location(cq.Vector(-9, 2, -12)))
    bolts.add(bolt, name="other bolt", loc=cq.Location(cq.Vector(16, 40, -2), cq.Vector(1, 0, 0), 90))
    whole.add(bolts)
    writer = STEPCAFControl_Writer()
    with contextlib.chdir(folder):  # names are those of the prefix
        assert writer.Transfer(toCAF(whole)[1], STEPControl_AsIs, "part_")
        writer.Write("all.stp")
    return folder / "all.stp"


def renamed(path: Path, old: str, new: str) -> FileContent:
    """An assembly that names another file."""
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    return read_file(path)


def test_parts_in_other_files_stand_where_the_assembly_places_them(tmp_path: Path) -> None:
    """Two bolts of one file, alike; each at its own pose, the product of those of both assemblies."""
    path = parted(tmp_path)
    text, drafted = scene_from([read_file(path)])
    scene = yaml.safe_load(text)
    assert {name: own["file"] for name, own in scene["parts"].items()} == {
        "plate": "part_plate.stp", "bolt 1": "part_bolt.stp", "bolt 2": "part_bolt.stp",
    }  # fmt: skip
    assert scene["scene"] == "all"
    assert scene["parts"]["bolt 2"]["like"] == "bolt 1"
    poses = {name: own["placed"] for name, own in scene["parts"].items()}
    assert poses["plate"]["at"] == ["1 mm", "2 mm", "3 mm"]
    assert poses["bolt 1"]["at"] == ["-9 mm", "2 mm", "-7 mm"]
    assert poses["bolt 2"]["at"] == ["16 mm", "40 mm", "3 mm"]
    np.testing.assert_allclose(poses["bolt 2"]["z"], [0, -1, 0], atol=1e-12)
    assert {own.file.name for own in drafted.files} == {"all.stp", "part_plate.stp", "part_bolt.stp"}
    (move,) = (own for own in scene["moves"].values() if own["part"] == "bolt 1")
    assert move["relations"] == [{"kind": "coaxial", "from": "bolt 1.pin 1", "to": "plate.hole 1"}]
    assembled(text, tmp_path)


def test_a_part_that_is_given_twice_stands_once(tmp_path: Path) -> None:
    path = parted(tmp_path)
    both, _ = scene_from([read_file(path), read_file(tmp_path / "part_plate.stp")])
    alone, _ = scene_from([read_file(path)])
    assert both == alone


def test_missing_files_are_listed_and_the_rest_is_drafted(tmp_path: Path) -> None:
    path = parted(tmp_path)
    (tmp_path / "part_bolt.stp").unlink()
    text, drafted = scene_from([read_file(path)])
    assert list(yaml.safe_load(text)["parts"]) == ["plate"]
    told = [
        "bolts/bolt: part_bolt.stp: No such file or directory",
        "bolts/bolt_2: part_bolt.stp: No such file or directory",
    ]
    assert list(drafted.notes())[:2] == told
    assert all(f"#   {line}" in text for line in told)
    (tmp_path / "part_plate.stp").unlink()
    with pytest.raises(
        StepError, match=r"^all.stp: its parts stand in files that are not in its folder: part_bolt.stp, p"
    ):
        scene_from([read_file(path)])


@pytest.mark.parametrize(
    "name",
    [
        "../part_plate.stp",
        "/etc/hostname",
        "parts/../../part_plate.stp",
        "C:plate.stp",
        "https://a.example/p.stp",
        "..",
    ],
)
def test_names_that_lead_out_of_the_folder_are_refused(name: str, tmp_path: Path) -> None:
    folder = tmp_path / "inner"
    folder.mkdir()
    path = parted(folder)
    shutil.copy(folder / "part_plate.stp", tmp_path)
    with pytest.raises(StepError, match="expected the name of a file in its own folder") as raised:
        scene_from([renamed(path, "part_plate.stp", name)])
    assert str(raised.value).count("\n") == 0
    assert repr(name) in str(raised.value)


def test_a_link_out_of_the_folder_is_not_followed(tmp_path: Path) -> None:
    folder = tmp_path / "inner"
    folder.mkdir()
    path = parted(folder)
    shutil.move(folder / "part_plate.stp", tmp_path / "secret.stp")
    (folder / "part_plate.stp").symlink_to(tmp_path / "secret.stp")
    _, missing = with_other_files([read_file(path)])
    assert list(missing) == ["part_plate.stp"]
    assert "a link that leads out of" in missing["part_plate.stp"]


def test_parts_in_files_of_one_product_name_have_those_of_the_assembly(tmp_path: Path) -> None:
    path = parted(tmp_path)
    for name in ("plate", "bolt"):
        file = tmp_path / f"part_{name}.stp"
        file.write_text(re.sub(r"PRODUCT\('[^']*','[^']*'", "PRODUCT('MASTER','MASTER'", file.read_text()))
    text, _ = scene_from([read_file(path)])
    assert list(yaml.safe_load(text)["parts"]) == ["plate", "bolt 1", "bolt 2"]


@pytest.mark.parametrize(
    "name", ["sub/bolts/part_bolt.stp", r"sub\\bolts\\part_bolt.stp", "./sub/./bolts/part_bolt.stp"]
)
def test_a_part_in_a_folder_below_is_drafted_as_one_beside_the_assembly(name: str, tmp_path: Path) -> None:
    path, folder = parted(tmp_path), tmp_path / "sub" / "bolts"
    plain, _ = scene_from([read_file(path)])
    folder.mkdir(parents=True)
    shutil.move(tmp_path / "part_bolt.stp", folder)
    below, _ = scene_from([renamed(path, "part_bolt.stp", name)])
    assert below == plain.replace("file: part_bolt.stp", 'file: "sub/bolts/part_bolt.stp"')
    both, _ = scene_from([read_file(path), read_file(folder / "part_bolt.stp")])
    assert both == below


def test_files_are_named_from_the_folder_of_the_one_that_names_them_and_copied_into_the_same(
    tmp_path: Path, tol3d: Command
) -> None:
    """The bolts of the assembly are a sub-assembly of a plate and two bolts, whose bolts lie in a folder below it."""
    whole, sub = tmp_path / "from", tmp_path / "from" / "sub"
    (sub / "bolts").mkdir(parents=True)
    path = parted(whole)
    shutil.move(whole / "part_bolt.stp", sub / "bolts")
    shutil.copy(path, sub)
    renamed(sub / "all.stp", "part_bolt.stp", "bolts/part_bolt.stp")
    renamed(sub / "all.stp", "part_plate.stp", "../part_plate.stp")
    renamed(path, "part_bolt.stp", "sub/all.stp")
    tol3d("new", "--from", str(path), "--out", str(tmp_path / "to" / "draft.yaml"))
    made = {own.relative_to(tmp_path / "to").as_posix() for own in (tmp_path / "to").rglob("*.stp")}
    assert made == {"all.stp", "part_plate.stp", "sub/all.stp", "sub/bolts/part_bolt.stp"}
    text = (tmp_path / "to" / "draft.yaml").read_text()
    assert [own["file"] for own in yaml.safe_load(text)["parts"].values()] == [
        "part_plate.stp", *["part_plate.stp", "sub/bolts/part_bolt.stp", "sub/bolts/part_bolt.stp"] * 2,
    ]  # fmt: skip
    assembled(text, tmp_path / "to")
    shutil.move(whole / "part_plate.stp", tmp_path / "part_plate.stp")
    renamed(sub / "all.stp", "../part_plate.stp", "../../part_plate.stp")
    with pytest.raises(StepError, match=r"stands in '../../part_plate.stp': expected the name of a file in its own"):
        scene_from([read_file(path)])
    renamed(sub / "all.stp", "../../part_plate.stp", "plate.stp")
    (sub / "plate.stp").symlink_to(tmp_path / "part_plate.stp")
    _, missing = with_other_files([read_file(path)])
    assert "a link that leads out of" in missing["sub/plate.stp"]


def test_assemblies_that_hold_each_other_are_refused(tmp_path: Path) -> None:
    path = parted(tmp_path)
    (tmp_path / "second.stp").write_text(path.read_text().replace("part_bolt.stp", "all.stp"))
    with pytest.raises(StepError, match=r"its assembly holds itself \(all.stp → second.stp → all.stp\)"):
        scene_from([renamed(path, "part_plate.stp", "second.stp")])
    with pytest.raises(StepError, match=r"its assembly holds itself \(all.stp → all.stp\)"):
        scene_from([renamed(path, "second.stp", "all.stp")])


def test_empty_assemblies_of_empty_assemblies_end(tmp_path: Path) -> None:
    """Forty files, each of which uses the next one three times: 3^40 of nothing."""
    text = parted(tmp_path).read_text()
    for k in range(40):
        below = text.replace("part_plate.stp", f"level {k + 1}.stp").replace("part_bolt.stp", f"level {k + 1}.stp")
        (tmp_path / f"level {k}.stp").write_text(below)
    with pytest.raises(StepError, match="expected at most 200 parts in a scene"):
        scene_from([read_file(tmp_path / "level 0.stp")])


def test_too_many_files_are_refused(tmp_path: Path) -> None:
    path = parted(tmp_path)
    text = path.read_text()
    for k in range(MOST_FILES):
        (tmp_path / f"level {k}.stp").write_text(text.replace("part_plate.stp", f"level {k + 1}.stp"))
    with pytest.raises(StepError, match=f"expected parts in at most {MOST_FILES} files"):
        with_other_files([read_file(tmp_path / "level 0.stp")])


def test_a_scene_that_takes_such_a_part_from_the_assembly_is_told_its_file(tmp_path: Path) -> None:
    file = read_step(read_file(parted(tmp_path)))
    with pytest.raises(StepError, match=r"got 'plate', which stands in 'part_plate.stp'"):
        file.use("plate")


def test_the_page_of_features_tells_the_files_and_new_copies_them(tol3d: Command, tmp_path: Path) -> None:
    (tmp_path / "from").mkdir()
    path = parted(tmp_path / "from")
    told = " ".join(tol3d("features", str(path))[1].split())
    assert "3 parts stand in other files: 'part_plate.stp', 'part_bolt.stp' (2 ×)" in told
    tol3d("new", "--from", str(path), "--out", str(tmp_path / "to" / "draft.yaml"))
    assert {own.name for own in (tmp_path / "to").iterdir()} == {
        "draft.yaml", "all.stp", "part_plate.stp", "part_bolt.stp",
    }  # fmt: skip
