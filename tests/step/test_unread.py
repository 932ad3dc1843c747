"""No face refuses a file: what cannot be read or triangulated is listed, and its neighbours live."""

import gzip
import re
from pathlib import Path

import cadquery as cq
import pytest
from foreign_parts import slotted_block, solid, step_file
from printing import printed

from tol3d.assembly.clearances.faces import solid_mesh
from tol3d.cad.step import reading
from tol3d.cad.step.found_features import FoundFeature
from tol3d.cad.step.reading import StepPart, read_step
from tol3d.cad.step.selectors import Selector, selected
from tol3d.cad.step.step_shape import StepShape
from tol3d.errors import GeometryError, InputError
from tol3d.files import FileContent
from tol3d.numerics.cache_folder import FOLDER_VARIABLE
from tol3d.report.step_tables import features_report

CYLINDER = "worker.BRepAdaptor_Surface(face).GetType() == worker.GeomAbs_Cylinder"
SPOILT = """
from tol3d.cad.step import worker
own = worker.{name}
def spoilt({arguments}):
    {what}
    return own({arguments})
worker.{name} = spoilt
worker.main()
"""


@pytest.fixture
def fresh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cache of its own, empty."""
    folder = tmp_path / "cache"
    folder.mkdir(mode=0o700)
    monkeypatch.setenv(FOLDER_VARIABLE, str(folder))


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> FileContent:
    return step_file({"block": slotted_block()}, tmp_path_factory.mktemp("block") / "block.step")


def spoilt(monkeypatch: pytest.MonkeyPatch, content: FileContent, name: str, arguments: str, what: str) -> StepPart:
    """A part read by a process of which one function fails."""
    monkeypatch.setattr(reading, "PROGRAM", SPOILT.format(name=name, arguments=arguments, what=what))
    return read_step(content).part(None)


def listed(part: StepPart, *, unread: bool) -> dict[tuple[int, ...], FoundFeature]:
    return {own.faces: own for own in part.features if (own.kind == "unread") is unread}


@pytest.mark.usefixtures("fresh")
def test_faces_on_which_open_cascade_throws_are_listed_and_the_others_are_as_they_were(
    block: FileContent, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its six cylinders: a pin, a hole, and four rounded edges."""
    whole = {own.faces: own for own in read_step(block).part(None).features}
    changed = FileContent(block.path, block.content.replace(b"FILE_NAME('", b"FILE_NAME('x"))
    throws = f"if {CYLINDER}: raise RuntimeError('no')"
    part = spoilt(monkeypatch, changed, "_middle", "face, surface, bounds", throws)
    round_ones = {faces: own for faces, own in whole.items() if own.kind in ("pin", "hole", "round")}
    assert listed(part, unread=True).keys() == round_ones.keys()
    assert {*part.unread} == {face for faces in round_ones for face in faces}
    assert listed(part, unread=False) == {faces: own for faces, own in whole.items() if faces not in round_ones}
    words = printed(features_report(part.file))
    assert "cannot be read: Open CASCADE fails on it (RuntimeError)" in words
    assert "and 2 more faces cannot be read" in words
    with pytest.raises(InputError, match="expected a hole, found none there"):
        selected(part, Selector(kind="hole"))
    with pytest.raises(GeometryError, match="a clearance would miss its faces that cannot be triangulated: #"):
        solid_mesh(StepShape.of(changed, None, None), 0.1)


@pytest.mark.usefixtures("fresh")
def test_faces_that_open_cascade_leaves_out_are_listed(block: FileContent, monkeypatch: pytest.MonkeyPatch) -> None:
    face = "worker.TopoDS.Face_s(shape)"
    none = f"if shape.ShapeType() == worker.TopAbs_FACE and {CYLINDER.replace('(face)', f'({face})')}: return 0"
    part = spoilt(monkeypatch, block, "Transferred._id", "self, shape", none)
    assert len(listed(part, unread=True)) == 6
    assert set(part.unread.values()) == {"Open CASCADE makes no face of it"}
    assert {own.kind for own in listed(part, unread=False).values()} == {"plane"}
    assert not {*part.mesh().faces.tolist()} & {*part.unread}


@pytest.mark.usefixtures("fresh")
def test_a_face_without_triangles_has_its_numbers_and_is_selected_by_its_place(
    block: FileContent, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = read_step(block).part(None)
    changed = FileContent(block.path, block.content.replace(b"FILE_NAME('", b"FILE_NAME('y"))
    part = spoilt(monkeypatch, changed, "triangles_of", "face", f"if {CYLINDER}: return None")
    assert not part.unread
    assert len(part.bare) == 6
    for own, before in zip(part.features, whole.features, strict=True):
        assert (own.kind, own.at, own.radius, own.extent) == (before.kind, before.at, before.radius, before.extent)
    (rounded, *_) = (own for own in part.features if own.kind == "round")
    assert selected(part, Selector(kind="round", near=rounded.on, within=1e-3)) == (rounded,)
    assert re.search(r"cannot triangulate #\d+, #\d+, #\d+, #\d+, …", printed(features_report(part.file)))
    flat = {face for own in part.features if own.kind == "plane" for face in own.faces}
    assert set(part.mesh().faces.tolist()) == flat


@pytest.mark.usefixtures("fresh")
def test_a_process_that_dies_over_triangles_leaves_the_features(
    block: FileContent, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = read_step(block).part(None)
    changed = FileContent(block.path, block.content.replace(b"FILE_NAME('", b"FILE_NAME('z"))
    part = spoilt(monkeypatch, changed, "Transferred.mesh", "self, deflection", "import os; os.abort()")
    assert [own.faces for own in part.features] == [own.faces for own in whole.features]
    assert part.bare == part.body.faces
    with pytest.raises(InputError, match="SIGABRT"):
        part.mesh()


@pytest.mark.usefixtures("fresh")
def test_a_solid_that_open_cascade_splits_is_one(tmp_path: Path) -> None:
    """Two boxes that do not touch, in one closed shell: 12 faces of one solid."""
    shapes = {"a": solid(cq.Workplane().box(4, 6, 8)), "b": solid(cq.Workplane().box(3, 5, 7).translate((20, 2, 1)))}
    text = step_file(shapes, tmp_path / "two.step").content.decode()
    (first, second) = re.findall(r"CLOSED_SHELL\('',\(([^)]*)\)\)", text)
    joined = re.sub(re.escape(first), lambda found: f"{first},{second}", text, count=1)
    content = FileContent(tmp_path / "joined.step", joined.encode())
    part = next(own for own in read_step(content).parts if own.name == "a")
    assert len(part.body.solids) == 1
    assert len(part.features) == 12
    assert sum(own.area for own in part.features) == pytest.approx(2 * (24 + 32 + 48) + 2 * (15 + 21 + 35), abs=1e-9)


def test_numbers_have_any_length() -> None:
    """52 characters in one number of a washer ⌀20/⌀10 × 2."""
    path = Path(__file__).with_name("washer_long_number.step.gz")
    part = read_step(FileContent(path.with_suffix(""), gzip.decompress(path.read_bytes()))).part(None)
    found = {own.kind: own for own in part.features}
    assert sorted(own.kind for own in part.features) == ["hole", "pin", "plane", "plane"]
    assert (2 * found["pin"].radius, 2 * found["hole"].radius) == pytest.approx((20.0, 10.0), abs=1e-9)
    assert (found["pin"].length, found["hole"].length) == pytest.approx((2.0, 2.0), abs=1e-9)
