"""Drafted scenes: what a file says is data, parts lie on what they touch, and the command says what it wants."""

import math
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import cadquery as cq
import numpy as np
import pytest
import yaml
from fixtures import Command
from foreign_parts import nist_file, slotted_block, solid, step_file
from scene_texts import scene_of

from tol3d.apps.drafting import Draft, scene_from
from tol3d.apps.drafting.drawn_part import distance_entry, enveloped
from tol3d.apps.drafting.entry import Entry, Scene, Wording
from tol3d.apps.drafting.fixture import seat_and_pins, three_two_one
from tol3d.apps.drafting.parts import drafted_parts, read_files
from tol3d.apps.drafting.touching_faces import TOUCHING, largest_bolt, overlap
from tol3d.apps.drafting.words import Names, comment, scalar
from tol3d.assembly.model import Cone
from tol3d.assembly.system import AssemblySystem
from tol3d.cad.step import Meanings, read_step_text
from tol3d.cad.step.datum import DatumTarget
from tol3d.cad.step.found_features import FoundFeature
from tol3d.cad.step.reading import read_step
from tol3d.files import FileContent, read_file
from tol3d.scene import Scene as SceneOfFile
from tol3d.simulate import Overrides, run_scene, simulation_of
from tol3d.study.system.stated import nominal_build
from tol3d.study.trials.draws import drawn

HOSTILE = (
    "*zones",
    "a: b",
    "# no comment",
    "on",
    "'\"{}[]",
    "law: &zones {kind: uniform}",
    "back\\slash",
    "two\nlines",
    "\r\x85\u2028\u2029\x00\x07",
    "𝄞 ⌖",
    "x" * 10_000,
    " ",
    ".x",
    "[1, 2",
    "- item",
    "? key",
    "!!python/object",
    "%TAG",
    "1e3",
    "~",
)


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_any_text_is_one_scalar_and_ends_no_comment(text: str) -> None:
    """Oracle: PyYAML."""
    read = yaml.safe_load(f"a: {scalar(text)}  # {comment(text)}\nb: 2\n")
    assert read == {"a": text, "b": 2}
    assert len(comment(text)) <= 80


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_names_differ_and_hold_what_names_may(text: str) -> None:
    names = Names()
    given = [names.new(text, "part") for _ in range(3)]
    assert len(set(given)) == 3
    for own in given:
        assert 0 < len(own) <= 80
        assert own == own.strip()
        assert own.isprintable()
        assert not set(own) & set("/\\:")


def test_members_of_a_pattern_never_have_a_name_that_is_taken() -> None:
    names = Names()
    assert [names.new("hole 1", ""), names.new("hole", "", 2), names.new("hole 2", "")] == [
        "hole 1", "hole (2) of", "hole 2",
    ]  # fmt: skip
    assert names.new("hole (2) of 1", "") == "hole (2) of 1 (2)"


def test_hostile_names_of_a_file_change_no_line_of_the_scene(tmp_path: Path) -> None:
    """Part 21 writes control characters as \\X2\\000A\\X0\\."""
    content = nist_file("ctc_01")
    evil = "\\X2\\000A\\X0\\}: [law, #1 *zones " + "y" * 10_000
    text = content.content
    for name in ("Position.1", "Position surfacic profile.2", "Perpendicularity.1", "NIST Complex Test Case 1"):
        assert f"'{name}'".encode() in text
        text = text.replace(f"'{name}'".encode(), f"'{evil}'".encode())
    plain, _ = scene_from([content])
    written, drafted = scene_from([FileContent(content.path, text)])
    assert written.count("\n") == plain.count("\n")
    read, wanted = yaml.safe_load(written), yaml.safe_load(plain)
    assert read.keys() == wanted.keys()
    assert [len(read[own]) for own in ("parts", "tolerances", "moves", "measures")] == [
        len(wanted[own]) for own in ("parts", "tolerances", "moves", "measures")
    ]
    assert [own["kind"] for own in read["tolerances"].values()] == [
        own["kind"] for own in wanted["tolerances"].values()
    ]
    assert max(map(len, written.splitlines())) < 600
    assert len(drafted.parts[0].name) <= 80


PLATE = solid(cq.Workplane().box(80, 60, 10).faces(">Z").workplane().rarray(50, 1, 2, 1).hole(8))
LID = solid(cq.Workplane().box(80, 60, 4).faces(">Z").workplane().rarray(50, 1, 2, 1).hole(9))
BLOCK = solid(cq.Workplane().box(20, 20, 20))


def drafted(folder: Path, shapes: dict[str, cq.Shape]) -> str:
    """The scene of parts that stand where they are modelled, in one assembly."""
    return scene_from([step_file(shapes, folder / "all.step")])[0]


def test_holes_in_line_are_bolted_and_faces_that_touch_are_laid_on_each_other(tmp_path: Path) -> None:
    text = drafted(tmp_path, {"plate": PLATE, "lid": LID.translate(cq.Vector(0, 0, 7))})
    read = yaml.safe_load(text)
    (move,) = (own for own in read["moves"].values() if own["kind"] != "fix")
    assert move["kind"] == "pattern"
    assert [own["kind"] for own in move["relations"]] == ["coincident"]
    assert len(move["pairs"]) == 2
    assert {own["bolt"]["diameter"] for own in move["pairs"]} == {
        "7.2 mm"
    }  # 8 mm less a tenth, for no position says it
    simulation_of(scene_of(text, tmp_path), Overrides())


@pytest.mark.parametrize(
    ("limits", "positions", "expected"),
    [((8.9, 9.2), (0.2, 0.3), 8.6), ((9.1, 9.4), (0.3,), 8.7), (None, (0.3,), 8.7), ((8.9, 9.2), (), 8.01)],
)
def test_a_bolt_goes_through_the_hole_at_its_smallest_less_its_largest_position(
    limits: tuple[float, float] | None, positions: tuple[float, ...], expected: float
) -> None:
    """A hole drawn at 9 mm with other limits: 8.9 less 0.3 mm; limits above 9 mm are not believed; a tenth without."""
    hole = FoundFeature((4,), "hole", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), radius=4.5)
    ends = {"features": [hole], "kind": ("diameter",), "limits": limits}
    other = ends | {"features": [replace(hole, faces=(5,))], "limits": (1.0, 2.0)}
    zones = [
        (
            SimpleNamespace(kind="position", magnitude=SimpleNamespace(value=own), feature=hole),
            SimpleNamespace(how="said"),
        )
        for own in positions
    ]
    drawing = SimpleNamespace(tolerances=zones, dimensions=[SimpleNamespace(**own) for own in (ends, other)])
    assert largest_bolt(SimpleNamespace(drawing=drawing), hole) == pytest.approx(expected)  # type: ignore[arg-type]


def test_a_cone_is_laid_in_its_seat(tmp_path: Path) -> None:
    """A plug stands in a block where it meets the hole; its turn about the axis stays as drawn."""
    cone = cq.Solid.makeCone(10, 6, 12, cq.Vector(0, 0, 10), cq.Vector(0, 0, -1))
    block = solid(cq.Workplane().box(40, 40, 20).cut(cq.Workplane(cone)))
    plug = solid(cq.Workplane(cq.Solid.makeCone(11, 7, 12, cq.Vector(0, 0, 13), cq.Vector(0, 0, -1))))
    text = drafted(tmp_path, {"block": block, "plug": plug})
    read = yaml.safe_load(text)
    (move,) = (own for own in read["moves"].values() if own["kind"] != "fix")
    assert (move["kind"], [own["kind"] for own in move["relations"]]) == ("mate", ["coincident"])
    system = simulation_of(scene_of(text, tmp_path), Overrides()).system
    assert isinstance(system, AssemblySystem)
    assert sum(isinstance(own.shape, Cone) for own in system.assembly.features.values()) == 2


@pytest.mark.slow
def test_a_gap_is_measured_between_the_nearest_parallel_faces(tmp_path: Path) -> None:
    """A block 20 mm wide whose underside stands 3 mm over the plate's top at z = 5."""
    text = drafted(tmp_path, {"plate": PLATE, "block": BLOCK.translate(cq.Vector(0, 0, 18))})
    simulation = simulation_of(scene_of(text, tmp_path), Overrides())
    system = simulation.system
    method = system.method("exact", system.materials("exact"))
    values = method.answers(nominal_build(system), system.measures).values
    (gap,) = (float(own[0, 0]) for own in values.values())
    assert gap == pytest.approx(3.0, abs=1e-9)


@pytest.fixture(scope="module")
def four(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    """The scene of four blocks of one product on a plate, 20 mm apart, and its folder."""
    folder = tmp_path_factory.mktemp("four")
    made = cq.Assembly(name="all")
    made.add(PLATE, name="plate")
    for k in range(4):
        place = cq.Location(cq.Vector(21 * k - 31, 1.0 * k, 15), cq.Vector(0, 0, 1), 90 * k)
        made.add(BLOCK, name=f"block {k}", loc=place)
    path = folder / "all.step"
    made.export(str(path), exportType="STEP")
    return scene_from([read_file(path)])[0], folder


def columns(text: str, folder: Path) -> dict[str, np.ndarray]:
    """The columns of 64 trials of a scene."""
    (folder / "scene.yaml").write_text(text, encoding="utf-8")
    out = folder / f"run {len(list(folder.iterdir()))}"
    return run_scene(folder / "scene.yaml", overrides=Overrides(trials=64), out=out).columns()


def test_a_product_that_is_used_four_times_is_four_parts_with_draws_of_their_own(four: tuple[str, Path]) -> None:
    text, folder = four
    parts = yaml.safe_load(text)["parts"]
    assert [own.get("like") for own in parts.values()] == [None, None, "block 0", "block 0", "block 0"]
    found = columns(text, folder)
    tilts = [values for name, values in found.items() if re.match(r"block 0 plane 1\b.*rise x", name)]
    assert len(tilts) == 4
    assert np.max(np.abs(np.corrcoef(tilts) - np.eye(4))) < 4 / math.sqrt(64)


def test_a_drafted_assembly_has_the_columns_of_its_parts_placed_by_hand_bit_by_bit(four: tuple[str, Path]) -> None:
    text, folder = four
    scene = yaml.safe_load(text)
    file = read_step(read_file(folder / "all.step"))
    for own in scene["parts"].values():
        use = file.use(own.pop("use"))
        own["product"] = file.part(None, use.path).name
        (x, y, z), axis, across = use.frame
        own["placed"] = {"at": [f"{x!r} mm", f"{y!r} mm", f"{z!r} mm"], "z": list(axis), "x": list(across)}
    typed, found = columns(yaml.safe_dump(scene, sort_keys=False), folder), columns(text, folder)
    assert typed.keys() == found.keys()
    for name, values in found.items():
        assert np.array_equal(values, typed[name]), name


def names_of(written: str, folder: Path) -> list[str]:
    """Names of the parts of a scene drafted from the text of a file."""
    path = folder / "kit.step"
    path.write_text(written, encoding="utf-8")
    return [part.name for part in drafted_parts(read_files({path.name: read_file(path)}), Names())]


def test_parts_have_the_names_of_their_products_numbered_where_those_of_their_uses_say_nothing(
    four: tuple[str, Path], tmp_path: Path
) -> None:
    """One plate and four blocks of one product, by names of uses and of products."""
    text = (four[1] / "all.step").read_text("utf-8")
    uses = re.compile(r"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\('[^']*',)'[^']*'")
    assert names_of(text, tmp_path) == ["plate", "block 0", "block 1", "block 2", "block 3"]
    for word in ("Next assembly relationship", "=>[0:1:1:2]", "", "NAUO7", "3"):
        assert names_of(uses.sub(rf"\1'{word}'", text), tmp_path) == ["plate", *(f"block 0 {k}" for k in (1, 2, 3, 4))]
    generic = uses.sub(r"\1'x'", text)  # one name of uses of two products
    for product in ("UNIDENTIFIED_PRODUCT", "Open CASCADE STEP translator 7.9 1.2", "(Unsaved)"):
        nameless = re.sub(r"PRODUCT\('[^']*','[^']*'", f"PRODUCT('{product}','NONE'", generic)
        assert names_of(nameless, tmp_path) == ["kit 1", *(f"kit 2 {k}" for k in (1, 2, 3, 4))]
    numbered = re.sub(r"PRODUCT\('[^']*','plate'", "PRODUCT('4711-0815','NONE'", generic)
    assert names_of(numbered, tmp_path)[0] == "4711-0815"
    long = re.sub(r"'plate'", "'Housing, machined, rear axle of the.2nd stage'", generic)
    assert names_of(long, tmp_path)[0] == "Housing"
    shared = re.sub(r"PRODUCT\('[^']*','[^']*'", "PRODUCT('a','01_02-rear_wheel_bearing_M6'", generic)
    assert names_of(shared, tmp_path) == [f"wheel_bearing {k}" for k in range(1, 6)]


def test_parts_that_nothing_places_are_told_in_a_line_and_measured_from_the_part_that_holds_the_others(
    tmp_path: Path,
) -> None:
    """A plate, seven blocks apart from all, and two that stand on each other beside them."""
    shapes = {f"block {'abcdefg'[k]}": BLOCK.translate(cq.Vector(300 + 50 * k, 7 * k, 40 * k)) for k in range(7)}
    shapes |= {"lower": BLOCK.translate(cq.Vector(-200, 0, 0)), "upper": BLOCK.translate(cq.Vector(-193, 3, 20))}
    text, drafted = scene_from([step_file({**shapes, "plate": PLATE}, tmp_path / "apart.step")])
    alone, first = list(drafted.notes())
    assert alone.startswith(
        "block a, block b, block c, block d, block e, block f and 1 more: no contact with another part, fixed"
    )
    assert first.startswith("lower: no contact with a part placed before, fixed there")
    scene = yaml.safe_load(text)
    assert next(own["part"] for own in scene["moves"].values()) == "plate"
    assert scene["measures"]


@pytest.fixture
def two(tmp_path: Path) -> tuple[Path, Path]:
    """Files of two parts, in folders of their own."""
    for name, shape in (("base", PLATE), ("top", BLOCK)):
        (tmp_path / name).mkdir()
        step_file({name: shape}, tmp_path / name / f"{name}.step")
    return tmp_path / "base" / "base.step", tmp_path / "top" / "top.step"


def test_the_command_seats_a_part_and_copies_files_beside_the_scene(
    two: tuple[Path, Path], tmp_path: Path, tol3d: Command
) -> None:
    out = tmp_path / "made" / "scene.yaml"
    first = tol3d("new", "--from", *map(str, two), "--seat", "top.A", "--on", "base.A", "--out", str(out))
    assert first[0] == 2
    assert "--seat: expected a flat face of 'top'" in first[2]
    faces = [find_plane(two[1], (0, 0, -10)), find_plane(two[0], (0, 0, 5))]
    code, _, err = tol3d(
        "new", "--from", *map(str, two), "--seat", f"top.#{faces[0]}", "--on", f"base.#{faces[1]}", "--out", str(out)
    )
    assert code == 0, err
    assert {own.name for own in out.parent.iterdir()} == {"base.step", "top.step", "scene.yaml"}
    read = yaml.safe_load(out.read_text(encoding="utf-8"))
    assert read["parts"]["top"]["placed"]["at"] == ["0 mm", "0 mm", "15 mm"]
    assert tol3d("check", str(out))[0] == 0
    code, _, err = tol3d("new", "--from", *map(str, two), "--out", str(out))
    assert code == 2
    assert "is there already" in err


def find_plane(path: Path, at: tuple[float, float, float]) -> int:
    """The number of the face of a file whose middle lies there."""
    for part in read_step(read_file(path)).parts:
        for own in part.features:
            if own.kind == "plane" and np.allclose(own.at, at, atol=1e-9):
                return own.faces[0]
    raise AssertionError(at)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("spur_pair", "--from", "a.step"), "got both"),
        (("--from", "a.step", "--seat", "a.A"), "--seat: expected an --on for each, got 1 and 0"),
        (("--seat", "a.A", "--on", "b.B"), "--seat: expected --from"),
        (("--inspect",), "--inspect: expected --from"),
        (("spur_pair", "train"), "expected one kind of system, got 2"),
        (("--from", "none.step"), "none.step"),
    ],
)
def test_wrong_words_are_told(words: tuple[str, ...], said: str, tol3d: Command) -> None:
    code, _, err = tol3d("new", *words)
    assert code == 2
    assert said in re.sub(r"\s+", " ", err)


@pytest.mark.slow
def test_a_part_without_a_drawing_runs_too(two: tuple[Path, Path], tmp_path: Path, tol3d: Command) -> None:
    out = tmp_path / "base" / "scene.yaml"
    assert tol3d("new", "--from", str(two[0]), "--out", str(out))[0] == 0
    code, _, err = tol3d("run", str(out), "--trials", "16", "--out", str(tmp_path / "run"), "--no-picture")
    assert code == 0, err


def test_a_tolerance_that_cannot_be_read_is_listed_and_counts() -> None:
    """Its magnitude is another tolerance: the sums stay those of the file."""
    content = nist_file("ctc_01")
    place = content.content.index(b"#22=")
    end = content.content.index(b";", place)
    broken = re.sub(rb",#\d+,", b",#26,", content.content[place:end], count=1)
    text, _ = scene_from([FileContent(content.path, content.content[:place] + broken + content.content[end:])])
    assert re.search(r"^# Of the 6 tolerances in \S+ 5 are said, 0 approximately, 1 left out\.$", text, re.MULTILINE)
    assert re.search(r"^#   #22: ", text, re.MULTILINE)


def test_datum_targets_without_a_place_are_asked_for_by_name() -> None:
    """Datum B of CTC-01 by three targets, of which the file says nothing but that they are points."""
    content = nist_file("ctc_01")
    text = read_step_text(content.content, "a")
    target = DatumTarget(1, "1", "point", text.datums[1].features[0], None, ())
    targets = tuple(replace(target, number=number) for number in ("1", "2", "3"))
    datums = [replace(own, features=(), targets=targets) if own.letter == "B" else own for own in text.datums]
    (file,) = read_files({"block.step": content})
    changed = replace(text, datums=tuple(datums))
    own = replace(file, text=changed, meanings=Meanings(changed, file.meanings.surfaces))
    lines = list(Draft([own], [], []).targets_told(own))
    assert lines[-1] == (
        "#   - {feature: B, simulator: targets, targets: [[? mm, ? mm, ? mm], [? mm, ? mm, ? mm], [? mm, ? mm, ? mm]]}"
        "  # B1 point, B2 point, B3 point"
    )
    assert len(lines) == 3
    assert not list(Draft([file], [], []).targets_told(file))


@pytest.mark.slow
def test_a_part_with_three_planes_as_datums_lies_on_six_pads(tmp_path: Path) -> None:
    """Pads at 0.4 of each face's extents: the part stands where it is drawn, and a higher pad turns it by its lever."""
    content = step_file({"block": BLOCK}, tmp_path / "block.step")
    (part,) = drafted_parts(read_files({"block.step": content}), Names())
    wanted = ((0, 0, -10), (0, -10, 0), (-10, 0, 0))
    frame = []
    for letter, at in zip("ABC", wanted, strict=True):
        (own,) = (each for each in part.features.part.features if np.allclose(each.at, at))
        frame.append(part.features.add([own], letter))
    (top,) = (each for each in part.features.part.features if np.allclose(each.at, (0, 0, 10)))
    entries = three_two_one(part, frame, "fixture", "laid", "set up")
    words = f"{{kind: gap, from: fixture.A3, to: {part.of(part.features.name(top))}, along: [0, 0, 1]}}"
    measure = Entry("measures", "height", [Wording((words,))])
    text, _ = Scene(["scene: block"], "{kind: normal}", [part.entry(), *entries, measure]).written()
    higher = "{kind: locator, of: laid, pair: primary 1, distribution: {kind: constant, value: 0.08 mm}}"
    text += f"tolerances:\n  pad: {higher}\n"
    simulation = simulation_of(scene_file(text, tmp_path), Overrides())
    system = simulation.system
    method = system.method("exact", system.materials("exact"))
    values = method.answers(drawn(simulation, 0, 1), system.measures).values["height"]
    nominal = method.answers(nominal_build(system), system.measures).values["height"]
    assert nominal[0, 0] == pytest.approx(20.0, abs=1e-9)
    # pads of A at (-8, -8), (8, -8) and (0, 8) in its plane; the first one 0.08 higher lifts the middle by a quarter
    assert values[0, 0] - 20.0 == pytest.approx(0.02, abs=1e-3)


@pytest.mark.slow
def test_a_slot_as_second_datum_closes_on_a_blade(tmp_path: Path) -> None:
    """Walls at x = -3 and 3 mm that lie 0.03 mm to the right: the block goes 0.03 mm to the left."""
    content = step_file({"block": slotted_block()}, tmp_path / "block.step")
    (part,) = drafted_parts(read_files({"block.step": content}), Names())
    known = part.features.part.features

    def plane(x: float, normal: tuple[float, float, float]) -> FoundFeature:
        flat = (own for own in known if own.kind == "plane" and np.allclose(own.direction, normal))
        return min(flat, key=lambda own: abs(own.at[0] - x) + abs(own.at[2] - 8.0) * (x != 0.0))

    under = part.features.add([plane(0.0, (0, 0, -1))], "A")
    slot = part.features.slot([plane(-3.0, (1, 0, 0)), plane(3.0, (-1, 0, 0))], "B")
    side = part.features.add([plane(0.0, (0, -1, 0))], "C")
    entries = seat_and_pins(part, [under, slot, side], "fixture", "laid", "set up")
    words = f"{{kind: gap, from: fixture.for A, to: {part.of(under.name)}, along: [1, 0, 0]}}"
    text, _ = Scene(
        ["scene: block"], "{kind: normal}", [part.entry(), *entries, Entry("measures", "x", [Wording((words,))])]
    ).written()
    aside = "along: [1, 0, 0], distribution: {kind: constant, value: 0.03 mm}"
    text += f"tolerances:\n  aside: {{kind: plus_minus, of: {part.of(slot.name)}, {aside}}}\n"
    assert "holds nothing" not in text
    simulation = simulation_of(scene_file(text, tmp_path), Overrides())
    for name in ("exact", "analytic"):
        method = simulation.system.method(name, simulation.system.materials(name))
        values = method.answers(drawn(simulation, 0, 1), simulation.system.measures).values["x"]
        assert values[0, 0] == pytest.approx(-0.03, abs=1e-9)


def scene_file(text: str, folder: Path) -> SceneOfFile:
    """A scene as a file, which is read."""
    return scene_of(text, folder)


@pytest.mark.parametrize(
    ("notes", "kind", "expected"),
    [
        (("envelope requirement",), "cylinder", ", envelope: true"),
        (("independency",), "slot", ", envelope: false"),
        (("statistical",), "cylinder", ""),
        (("envelope requirement",), "sphere", ""),  # of which a scene has none
    ],
)
def test_the_word_of_a_file_on_the_envelope_of_a_size_is_said(notes: tuple[str, ...], kind: str, expected: str) -> None:
    (given,) = (own for own in read_step_text(nist_file("ctc_01").content, "a").dimensions if own.id == 122)
    assert enveloped(replace(given, notes=notes), SimpleNamespace(kind=kind)) == expected  # type: ignore[arg-type]


def test_faces_overlap_by_the_box_that_both_share() -> None:
    """8 x 3 mm in directions that lean by 30 deg: one face from 0 to 12 by 0 to 5, one from 4 to 30 by 2 to 40."""
    x, normal = np.array([math.cos(0.5), 0.0, math.sin(0.5)]), np.array([-math.sin(0.5), 0.0, math.cos(0.5)])
    y = np.cross(normal, x)

    def corners(x_range: tuple[float, float], y_range: tuple[float, float]) -> np.ndarray:
        return np.array([a * x + b * y + 7.0 * normal for a in x_range for b in y_range])

    first = corners((0.0, 12.0), (0.0, 5.0))
    assert overlap(first, corners((4.0, 30.0), (2.0, 40.0)), x, normal) == pytest.approx(24.0, abs=11.1 * TOUCHING)
    assert overlap(first, corners((3.0, 5.0), (1.0, 2.0)), x, normal) == pytest.approx(2.0, abs=3.1 * TOUCHING)
    for beside in (corners((12.5, 30.0), (2.0, 4.0)), corners((4.0, 8.0), (-9.0, -0.5))):
        assert overlap(first, beside, x, normal) == 0.0


def test_a_distance_of_unequal_limits_deviates_by_both_from_what_is_drawn() -> None:
    """Drawn at 20 mm, from 19.93 to 20.02 mm: -0.07 and +0.02 mm, along the direction of the face it starts at."""
    faces = [
        FoundFeature((k,), "plane", at, (0.0, 0.0, -1.0), (1.0, 0.0, 0.0))
        for k, at in enumerate(((5.0, 2.0, 3.0), (9.0, 0.0, 23.0)))
    ]
    entries = list[Entry]()
    drawing = SimpleNamespace(
        datums={}, located={}, entries=entries, spread="uniform", reasons={}, of=lambda name: f"part.{name}",
        names=SimpleNamespace(new=lambda *names: names[0]),
        features=SimpleNamespace(named=lambda own: None, name=lambda own: f"face {own.faces[0]}"),
    )  # fmt: skip
    dimension = SimpleNamespace(id=7, limits=(19.93, 20.02), name="", nominal=None, least=None, most=None)
    distance_entry(drawing, dimension, *faces)  # type: ignore[arg-type]
    (entry,) = entries
    said = yaml.safe_load(entry.wordings[0].lines[0])
    assert said["of"] == "part.face 1"
    lower, upper = (float(said["distribution"][key].split()[0]) for key in ("lower", "upper"))
    assert (lower, upper) == pytest.approx((-0.07, 0.02), abs=1e-9)
