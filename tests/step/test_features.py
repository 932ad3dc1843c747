"""Features of foreign parts: numbers known in closed form, and those that the text of NIST's files has."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from foreign_parts import (
    TURNED,
    halved_plate,
    inch_file,
    moved,
    nist_file,
    rotated,
    slotted_block,
    socket,
    step_file,
    turned,
)
from nist import references

from tol3d.assembly.grammar.features import ConeSpec
from tol3d.assembly.grammar.features.selector import SelectorSpec
from tol3d.assembly.model import Cone
from tol3d.assembly.picking.step_picks import face_of, with_numbers
from tol3d.cad.step.found_features import FoundFeature
from tol3d.cad.step.reading import StepFile, StepPart, read_step
from tol3d.cad.step.selectors import Selector, line_of, selected
from tol3d.errors import InputError
from tol3d.files import FileContent

EXACT = 1e-9  # mm; what the text of a file is written to, and rounding


@pytest.fixture(scope="module")
def solids(tmp_path_factory: pytest.TempPathFactory) -> StepFile:
    """All small solids in one file, which is read once."""
    shapes = {"halved": halved_plate(), "block": slotted_block(), "socket": socket(), "turned": turned(halved_plate())}
    return read_step(step_file(shapes, tmp_path_factory.mktemp("solids") / "solids.step"))


def of(part: StepPart, kind: str) -> list[FoundFeature]:
    return [own for own in part.features if own.kind == kind]


def test_a_hole_in_halves_is_one_hole(solids: StepFile) -> None:
    (hole,) = of(solids.part("halved"), "hole")
    assert len(hole.faces) == 2
    assert 2 * hole.radius == pytest.approx(12.0, abs=EXACT)
    assert hole.length == pytest.approx(10.0, abs=EXACT)
    assert hole.at == pytest.approx((0.0, 3.0, 0.0), abs=EXACT)
    assert hole.direction == pytest.approx((0.0, 0.0, 1.0), abs=EXACT)
    assert hole.turn == pytest.approx(2 * math.pi, abs=1e-9)


def test_coplanar_faces_are_one_plane(solids: StepFile) -> None:
    (top,) = [own for own in of(solids.part("halved"), "plane") if own.direction == (0.0, 0.0, 1.0)]
    assert len(top.faces) == 2
    assert top.extent == pytest.approx((60.0, 40.0), abs=EXACT)
    assert top.at == pytest.approx((0.0, 0.0, 5.0), abs=EXACT)
    assert top.area == pytest.approx(60 * 40 - math.pi * 36, abs=1e-6)


def test_an_interrupted_plane_is_one_and_its_sides_are_not(solids: StepFile) -> None:
    planes = of(solids.part("block"), "plane")
    (top,) = [own for own in planes if own.direction == (0.0, 0.0, 1.0) and own.at[2] > 9 and not own.radius]
    assert len(top.faces) == 2
    assert top.extent == pytest.approx((40.0, 30.0), abs=EXACT)
    walls = [own for own in planes if abs(own.direction[0]) == 1.0 and abs(own.at[0]) < 5]
    assert sorted(own.at[0] for own in walls) == pytest.approx([-3.0, 3.0], abs=EXACT)
    assert sorted(own.direction[0] for own in walls) == [-1.0, 1.0]


def test_pin_hole_and_rounded_edges_are_told_apart(solids: StepFile) -> None:
    block = solids.part("block")
    (pin,), (hole,) = of(block, "pin"), of(block, "hole")
    assert (2 * pin.radius, *pin.at, pin.length) == pytest.approx((5.0, -12.0, 0.0, 14.5, 9.0), abs=EXACT)
    assert (2 * hole.radius, *hole.at, hole.length) == pytest.approx((8.0, 13.0, 0.0, 2.5, 15.0), abs=EXACT)
    edges = of(block, "round")
    assert len(edges) == 4
    assert not of(block, "fillet")
    for own in edges:
        assert (own.radius, own.turn, own.length) == pytest.approx((4.0, math.pi / 2, 20.0), abs=EXACT)
    (bottom,) = [own for own in of(block, "plane") if own.radius and own.direction[2] > 0 and own.at[2] < 0]
    assert (bottom.radius, *bottom.at) == pytest.approx((4.0, 13.0, 0.0, -5.0), abs=EXACT)


def test_a_seat_and_a_cone(solids: StepFile) -> None:
    part = solids.part("socket")
    (seat,), (cone,) = of(part, "socket"), of(part, "cone")
    assert (2 * seat.radius, *seat.at) == pytest.approx((20.0, 0.0, 0.0, 15.0), abs=EXACT)
    assert (2 * cone.radius, 2 * cone.minor_radius, cone.length) == pytest.approx((12.0, 6.0, 8.0), abs=EXACT)
    assert cone.half_angle == pytest.approx(math.atan(3 / 8), abs=1e-12)
    assert cone.at == pytest.approx((0.0, 0.0, -11.0), abs=EXACT)
    (made,) = with_numbers(SelectorSpec(kind="cone"), [face_of(cone)]).members("cone").values()
    assert isinstance(made, ConeSpec)
    assert made.shape == Cone(8.0, inner=True, diameters=(12.0, 6.0))


def test_a_turned_part_has_the_same_features_elsewhere(solids: StepFile) -> None:
    (hole,) = of(solids.part("turned"), "hole")
    assert 2 * hole.radius == pytest.approx(12.0, abs=EXACT)
    assert hole.length == pytest.approx(10.0, abs=EXACT)
    assert hole.at == pytest.approx(moved((0.0, 3.0, 0.0)), abs=EXACT)
    axis = rotated((0.0, 0.0, 1.0), TURNED[1], math.radians(TURNED[2]))
    assert abs(np.dot(axis, hole.direction)) == pytest.approx(1.0, abs=1e-12)


def test_inches_become_millimetres(tmp_path: Path) -> None:
    (part,) = read_step(inch_file(halved_plate(), tmp_path / "inch.step")).parts
    assert part.body.unit == 25.4
    (hole,) = of(part, "hole")
    assert (2 * hole.radius, *hole.at, hole.length) == pytest.approx((12.0, 0.0, 3.0, 0.0, 10.0), abs=1e-7)


def test_triangles_enclose_the_volume(solids: StepFile) -> None:
    mesh = solids.part("block").mesh()
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    volume = float((a * np.cross(b, c)).sum()) / 6
    solid = 40 * 30 * 20 - (4 - math.pi) * 16 * 20 - 6 * 30 * 6 + math.pi * (2.5**2 * 9 - 4**2 * 15)
    turns = 2 * math.pi * (4 + 2.5 + 4) * 20  # mm²; round faces, each at most the chord error off
    assert abs(volume - solid) < turns * mesh.chord_error
    edges = np.sort(np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]]))
    assert set(np.unique(edges, axis=0, return_counts=True)[1].tolist()) == {2}


# selectors -------------------------------------------------------------------------------------------


def test_each_line_to_paste_means_its_feature(solids: StepFile) -> None:
    for part in solids.parts:
        for own in part.features:
            assert selected(part, pasted(line_of(own))) == (own,)


def pasted(line: str) -> Selector:
    """A selector of its line, by a crude expression."""
    kind = re.search(r"kind: ([a-z ]+)", line)
    size = re.search(r"diameter: (\S+) mm", line)
    near = re.search(r"near: \[(\S+) mm, (\S+) mm, (\S+) mm\]", line)
    assert kind
    assert near
    x, y, z = map(float, near.groups())
    return Selector(kind=kind[1], diameter=float(size[1]) if size else None, near=(x, y, z))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("selector", "field", "words"),
    [
        (Selector(kind="hole", diameter=7.0), "diameter", "expected a diameter of 7 mm, found none"),
        (Selector(kind="ball"), "kind", "expected a ball, found none there"),
        (Selector(kind="round"), "", "expected exactly 1 feature, found 4"),
        (Selector(kind="round", count=3), "count", "expected exactly 3 features, found 4"),
        (Selector(kind="round", near=(0.0, 0.0, 0.0)), "near", "at least twice as far"),
        (Selector(kind="pin", near=(0.0, 0.0, 0.0), within=1.0), "within", "expected it within 1 mm"),
        (Selector(face=1), "face", "got #1 of something else"),
        (Selector(name="datum A"), "face", "expected the name of a face"),
    ],
)
def test_what_means_no_feature_is_refused_with_lines_to_paste(
    solids: StepFile, selector: Selector, field: str, words: str
) -> None:
    with pytest.raises(InputError, match=re.escape(words)) as error:
        selected(solids.part("block"), selector)
    assert vars(error.value)["field"] == field
    assert field in ("face", "kind") or "{kind: " in str(error.value)


def test_several_features_come_by_their_places(solids: StepFile) -> None:
    found = selected(solids.part("block"), Selector(kind="round", count=4))
    assert [own.at[:2] for own in found] == sorted(own.at[:2] for own in found)


def test_a_face_is_the_whole_feature_and_faces_are_these_alone(solids: StepFile) -> None:
    part = solids.part("halved")
    (top,) = [own for own in of(part, "plane") if own.direction == (0.0, 0.0, 1.0)]
    assert selected(part, Selector(face=top.faces[1])) == (top,)
    (half,) = selected(part, Selector(faces=top.faces[:1]))
    assert half.extent == pytest.approx((30.0, 40.0), abs=EXACT)


def test_a_product_must_be_said_where_there_are_several(solids: StepFile) -> None:
    with pytest.raises(InputError, match=r"expected a product, for solids\.step has 4: 'halved', "):
        solids.part(None)
    with pytest.raises(InputError, match="got 'plate', none of that name"):
        solids.part("plate")


# NIST's models ---------------------------------------------------------------------------------------

MODELS = ("ftc_10", "ctc_01", "ctc_05", "ftc_07", "stc_06", "stc_07")


def instances(content: FileContent) -> dict[int, str]:
    """The body of each instance on one line: an oracle that shares no code with what reads the file."""
    text = content.content.decode("latin-1").replace("\r", "").replace("\n", " ")
    return {int(number): re.sub(r"\s+", "", body) for number, body in re.findall(r"#(\d+)\s*=\s*(.*?);", text)}


def numbers_of(body: str) -> list[float]:
    return [float(own) for own in re.findall(r"(?<![#\w'])-?\d+\.\d*(?:E[-+]?\d+)?", body)]


@pytest.mark.parametrize("model", MODELS)
def test_each_face_has_the_surface_that_the_text_gives_its_number(model: str) -> None:
    content = nist_file(model)
    bodies, found = instances(content), read_step(content)
    unit = 25.4 if model in ("ctc_05", "ftc_07", "stc_07") else 1.0
    (part,) = found.parts
    faces = {number for number, body in bodies.items() if body.startswith("ADVANCED_FACE(")}
    assert set(part.shell.faces) == faces == part.body.faces | part.body.loose
    (shell,) = [body for body in bodies.values() if body.startswith("CLOSED_SHELL(")]
    assert part.body.faces == set(references(shell))
    compared = 0
    for number in sorted(faces):
        surface = bodies[references(bodies[number])[-1]]
        face = part.shell.faces[number]
        words = {"PLANE": "plane", "CYLINDRICAL_SURFACE": "cylinder", "SPHERICAL_SURFACE": "sphere"}
        kind = words.get(surface.partition("(")[0])
        if kind is None:
            continue
        assert face.kind == kind
        placement = bodies[references(surface)[0]]
        place = [unit * own for own in numbers_of(bodies[references(placement)[0]])]
        assert face.at == pytest.approx(place, abs=1e-9)
        if kind != "plane":
            assert face.radius == pytest.approx(unit * numbers_of(surface)[-1], abs=1e-9)
        compared += 1
    assert compared > 100


@pytest.mark.parametrize("model", MODELS)
def test_every_face_of_a_solid_is_of_one_feature(model: str) -> None:
    (part,) = read_step(nist_file(model)).parts
    own = [number for feature in part.features if not feature.loose for number in feature.faces]
    assert sorted(own) == sorted(part.body.faces)
    beside = [number for feature in part.features for number in (feature.repeated + feature.faces * feature.loose)]
    assert sorted(beside) == sorted(part.body.loose)


def test_loose_faces_of_ftc_10_repeat_those_of_its_solid() -> None:
    (part,) = read_step(nist_file("ftc_10")).parts
    by_face = {number: own for own in part.features for number in own.repeated}
    assert len(by_face) == 14
    for number, own in by_face.items():
        assert selected(part, Selector(face=number)) == (own,)


@pytest.mark.parametrize("model", MODELS)
def test_normals_of_planes_point_out_of_the_triangles(model: str) -> None:
    (part,) = read_step(nist_file(model)).parts
    mesh = part.mesh()
    for own in part.features:
        if own.kind == "plane" and not own.loose:
            a, b, c = np.moveaxis(mesh.corners(own.faces), 1, 0)
            area = np.cross(b - a, c - a).sum(axis=0) / 2
            assert area @ np.array(own.direction) == pytest.approx(own.area, rel=2e-2)


@pytest.mark.parametrize("model", MODELS)
def test_datums_and_tolerances_select_what_the_text_joins_to_them(model: str) -> None:
    """Names and letters mean features of just the faces that they are joined to, and whole holes."""
    (part,) = read_step(nist_file(model)).parts
    owner = {number: own for own in part.features for number in (*own.faces, *own.repeated)}
    assert {own.name for own in part.named if own.what == "datum"} == set(DATUMS[model])
    for each in part.named:
        if not each.name or any(own.loose for own in map(owner.get, each.faces) if own):
            continue
        found = _meant(part, each.what, each.name)
        same = [own for own in part.named if (own.what == "datum") == (each.what == "datum") and own.name == each.name]
        wanted = {face for own in same for face in own.faces}
        flat = {face for own in found if own.kind == "plane" for face in own.faces}
        assert flat == {face for face in wanted if owner[face].kind == "plane" and face not in owner[face].repeated} | {
            face for own in found if own.kind == "plane" and wanted & {*own.repeated} for face in own.faces
        }
        assert {own.faces for own in found if own.kind != "plane"} == {
            owner[face].faces for face in wanted if owner[face].kind != "plane"
        }


DATUMS = {
    "ftc_10": "ABCDEFGHJKL",
    "ctc_01": "ABC",
    "ctc_05": "AB",
    "ftc_07": "ABCDE",
    "stc_06": "ABCDEF",
    "stc_07": "ABCDE",
}
"""Letters of each model that are on faces."""


def _meant(part: StepPart, what: str, name: str) -> tuple[FoundFeature, ...]:
    """All features that a letter or a name means, however many there are."""
    by = Selector(datum=name) if what == "datum" else Selector(pmi=name)
    try:
        return selected(part, by)
    except InputError as error:
        found = re.search(r"expected exactly 1 feature, found (\d+)", str(error))
    assert found
    return selected(part, replace(by, count=int(found[1])))


def test_the_bores_of_ftc_10_by_name_and_by_frame() -> None:
    (part,) = read_step(nist_file("ftc_10")).parts
    by_name = selected(part, Selector(pmi="Position.2", count=2))
    assert [2 * own.radius for own in by_name] == [6.0, 6.0]
    frame = Selector(tolerance="position", value=0.65, datums="A|B|C", count=2)
    assert selected(part, frame) == by_name
    (seat,) = selected(part, Selector(datum="A"))
    assert seat.faces == (11986,)
    (middle,) = selected(part, Selector(datum="D"))
    assert set(middle.faces) == {404, 633, 792}


@pytest.mark.parametrize(
    ("point", "expected"),
    [
        ((14.0, 7.0, 31.0), 5.0),  # beside it: 3, 4 across
        ((11.0, 3.0, 52.0), 12.0),  # 12 beyond the end at z = 40
        ((14.0, 7.0, 16.0), math.sqrt(41.0)),  # 3, 4 across, 4 before the start at z = 20
    ],
)
def test_the_distance_of_a_point_from_an_axis_is_that_from_its_stretch(
    point: tuple[float, float, float], expected: float
) -> None:
    """An axis of 20 mm about (11, 3, 30), far from the origin."""
    own = FoundFeature((1,), "pin", (11.0, 3.0, 30.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), extent=(20.0, 0.0), radius=4.0)
    assert own.axis_distance(np.array(point)) == pytest.approx(expected, abs=1e-12)
