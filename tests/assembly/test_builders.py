"""Builders in scenes: what docs/builders.md says of them, what is refused, and the stacks of the scene by hand."""

import math
from pathlib import Path
from typing import Any, get_args

import pytest
from guides import words
from places import ROOT, SCENES
from scene_texts import edited, refusal, refusal_at

from tol3d import load_scene, run_scene
from tol3d.assembly.grammar.builders import BuilderUnion
from tol3d.cad.solids.cad import solid_of
from tol3d.cad.solids.numbered_parts import Housing
from tol3d.simulate import Overrides
from tol3d.strict import Strict

PAGE = (ROOT / "docs" / "builders.md").read_text("utf-8")
TEXT = (SCENES / "machined_parts.yaml").read_text("utf-8")
KINDS: dict[str, type[Strict]] = {
    get_args(spec.model_fields["kind"].annotation)[0]: spec for spec in get_args(get_args(BuilderUnion)[0])
}
BY_DIMENSIONS = {
    ("machined_parts", "base"): "plate",
    ("machined_parts", "housing"): "housing",
    ("machined_parts", "cover"): "cover",
    ("machined_parts", "block"): "block",
    ("machined_parts", "bracket"): "bracket",
    ("spherical_drive", "rod 1"): "rod",
    ("spherical_drive", "nut 1"): "nut",
    ("spherical_drive", "screw 1"): "ball_screw",
    ("spherical_drive", "ring"): "thrust_ring",
    ("stewart", "foot 1"): "ball_socket",
    ("robot_arm", "link 1"): "cast_link",
}
GEARS = {"gear 1": "tooth", "gear 2": "space"}


def rows(head: str) -> dict[str, list[str]]:
    """Rows of a table of the page, by the first cell."""
    table = PAGE[PAGE.index(f"| {head} |") :].split("\n\n")[0].splitlines()[2:]
    cells = [[cell.strip() for cell in row.strip("|").split("|")] for row in table]
    return {row[0].strip("`"): row[1:] for row in cells}


def test_the_page_has_a_row_with_every_field_of_every_builder() -> None:
    table = rows("builder")
    assert set(table) == set(KINDS) - {"file"} == {*BY_DIMENSIONS.values(), "spherical_gear"}
    for kind, (dimensions, *_) in table.items():
        known = set(KINDS[kind].model_fields) - {"kind"}
        within = {"face", "spigot", "at", "length", "width", "height", "diameter", "depth", "angle"}
        within |= {"axis", "bore", "hole", "level", "pilot"}
        assert known <= words(dimensions)
        assert words(dimensions) <= known | within


def shape_in(scene: str, part: str) -> Any:
    """Builder of a part of a scene."""
    built: Any = load_scene(SCENES / f"{scene}.yaml").parts[part]
    return built.builder.shape


def named(kind: str) -> set[str]:
    """The faces that the page says a builder's solids have."""
    said = rows("builder")[kind][2]
    said = rows("builder")["plate"][2] if said == "as the plate" else said
    said = said.replace(" or ", ",").replace("with a journal ", ",").replace("of ring k", "")
    cells = {name.split(" (")[0].strip() for name in said.replace(";", ",").split(",")}
    return {name for name in cells if name and not name.startswith("round")}


@pytest.mark.parametrize(("scene", "part"), BY_DIMENSIONS)
def test_the_page_names_the_faces_that_the_solid_has(scene: str, part: str) -> None:
    """Those of holes, slots, pins, bores, bosses and ears aside."""
    shape = shape_in(scene, part)
    own = [one.name for field in ("holes", "slots", "pins", "bores", "bosses") for one in getattr(shape, field, ())]
    own += [f"{name}{end}" for name, _ in getattr(shape, "ears", ()) for end in ("", " left", " right", " end")]
    kept = ("front", "back", "bottom")
    plain = {face for face in solid_of(shape).faces if not face.startswith(tuple(own)) or face in kept}
    plain = {"side 1 and so on behind each ear" if face.startswith("side ") else face for face in plain}
    assert named(BY_DIMENSIONS[scene, part]) == plain


@pytest.mark.parametrize(("part", "pole"), GEARS.items())
def test_the_page_names_the_faces_that_a_spherical_gear_has(part: str, pole: str) -> None:
    found = set(solid_of(shape_in("spherical_drive", part)).faces)
    said = rows("builder")["spherical_gear"][2]
    assert "the same with outer; root k behind it, root 0 before ring 1" in said
    rings = 6 if pole == "tooth" else 7
    of_ring = {f"{side} {own}" for side in ("inner", "outer") for own in ("flank", "fillet", "radial")} | {"tip"}
    for own in of_ring:
        assert f"ring k {own}" in said or own.startswith("outer")
    expected = {f"ring {k} {own}" for k in range(1, rings + 1) for own in of_ring}
    expected |= {f"root {k}" for k in range(0 if pole == "tooth" else 1, rings + 1)} | {"bottom"}
    ends = {"pole tip", "pole flank", "pole fillet", "pole radial"} if pole == "tooth" else {"pole root"}
    expected |= ends | (set() if pole == "tooth" else {"bore", "bore floor"})
    assert found == expected
    assert ends | {"bottom", "bore", "bore floor"} <= named("spherical_gear")


def test_a_housing_that_opens_at_its_front_has_the_faces_that_the_page_says() -> None:
    top, front = (
        set(solid_of(Housing((0.0, 0.0, 0.0), (90.0, 80.0, 70.0), 5.0, 5.0, opening=side)).faces)
        for side in ("top", "front")
    )
    assert "inside top and inside bottom instead of front, inside front and inside back" in " ".join(PAGE.split())
    assert front - top == {"top", "inside top", "inside bottom"}
    assert top - front == {"front", "inside front", "inside back"}


WRONG = {
    "hole outside the plate": (
        "screw 1: {at: [-120 mm, -60 mm], diameter: 9 mm}",
        "screw 1: {at: [-120 mm, -66 mm], diameter: 9 mm}",
        "15: parts.base.builder.holes.screw 1: hole 'screw 1' (diameter 9 mm at [-120, -66] mm) leaves the top: along "
        "y it reaches from -70.5 mm to -61.5 mm, the top from -70 mm to 70 mm",
    ),
    "holes that overlap": (
        "screw 2: {at: [120 mm, -60 mm], diameter: 9 mm}",
        "screw 2: {at: [-115 mm, -60 mm], diameter: 9 mm}",
        "16: parts.base.builder.holes.screw 2: hole 'screw 1' (diameter 9 mm at [-120, -60] mm) and hole 'screw 2' "
        "(diameter 9 mm at [-115, -60] mm) overlap, or leave no wall between them",
    ),
    "bore that leaves its wall": (
        "input:      {wall: front, at: [-22 mm, 2 mm]",
        "input:      {wall: front, at: [-40 mm, 2 mm]",
        "parts.housing.builder.bores.input: bore 'input' (diameter 22 mm at [-40, 2] mm of the front) leaves the "
        "front: along x it reaches from -51 mm to -29 mm, the front from -45 mm to 45 mm",
    ),
    "thick walls": (
        "walls: 10 mm",
        "walls: 45 mm",
        "parts.housing.builder: walls of 45 mm leave nothing inside a housing of 90 mm along z",
    ),
    "no unit": ("thickness: 16 mm ", "thickness: 16 ", "parts.base.builder.thickness: expected a length"),
    "no such face": (
        "thread: {face: right,",
        "thread: {face: east,",
        "parts.block.builder.holes.thread.face: expected one of top",
    ),
    "unknown dimension": ("fillet: 6 mm", "filet: 6 mm", 'did you mean "fillet"?'),
    "unknown builder": ("kind: bracket ", "kind: angle ", "parts.bracket.builder"),
    "a dotted name": ("keyway: {face", "key.way: {face", "expected a name without ."),
    "builder of a part like another": (
        "    placed: {at: [35 mm, -20 mm, 56 mm]}\n",
        "    like: block\n    placed: {at: [35 mm, -20 mm, 56 mm]}\n",
        "parts.bracket",
    ),
}


@pytest.mark.parametrize(("old", "new", "message"), WRONG.values(), ids=WRONG.keys())
def test_a_wrong_builder_is_refused_where_it_stands(old: str, new: str, message: str, tmp_path: Path) -> None:
    said = refusal_at(edited(TEXT, (old, new)), tmp_path)
    assert message in said
    assert "\n" not in said


WRONG_LINKAGES = {
    "ears that overlap": (
        "        D: {angle: 60 deg}",
        "        D: {angle: 110 deg}",
        "parts.ring.builder.ears.B: ears 'D' and 'B' of the ring overlap or meet: they are 10 deg apart, and 19.7",
    ),
    "no ears": (
        "      ears:\n        B: {angle: 120 deg}\n        D: {angle: 60 deg}\n",
        "      ears: {}\n",
        "parts.ring.builder.ears: ",
    ),
    "thick rod": (
        "length: 260 mm, diameter: 8 mm, ball_diameter: 16 mm}\n    features:\n      bottom: {kind: sphere, face: "
        "{name: bottom ball}}\n      top: {kind: sphere, face: {name: top ball}}",
        "length: 260 mm, diameter: 18 mm, ball_diameter: 16 mm}\n    features:\n      bottom: {kind: sphere, face: "
        "{name: bottom ball}}\n      top: {kind: sphere, face: {name: top ball}}",
        "parts.rod 2.builder: a rod of 18 mm is not thinner than its balls of 16 mm",
    ),
    "no ring of teeth": ("reach: 95 deg", "reach: 10 deg", "no ring of teeth ends within a reach of 10 deg"),
    "two teeth": ("teeth: 25, module", "teeth: 2, module", "gear 1.builder.teeth: expected a number of at least 3"),
    "another pole": ("pole: tooth", "pole: flank", "parts.gear 1.builder.pole: expected tooth or space"),
    "a place off its seat": (
        "at: [32 mm, 0 mm, 24 mm]",
        "at: [32 mm, 0 mm, 25 mm]",
        "parts.nut 1.features.A.at: expected what the face of the solid has, [32 mm, 0 mm, 24 mm]",
    ),
}


@pytest.mark.parametrize(("old", "new", "message"), WRONG_LINKAGES.values(), ids=WRONG_LINKAGES.keys())
def test_a_wrong_part_of_a_linkage_is_refused_where_it_stands(old: str, new: str, message: str, tmp_path: Path) -> None:
    said = refusal(edited((SCENES / "spherical_drive.yaml").read_text("utf-8"), (old, new)), tmp_path)
    assert message in said
    assert "\n" not in said


@pytest.mark.slow
def test_the_stacks_of_heights_follow_by_hand(tmp_path: Path) -> None:
    """Base, housing and cover (or block and bracket): 20, 12 and 9 um in series; the step has no base in it."""
    count = 20_000
    found = run_scene(SCENES / "machined_parts.yaml", overrides=Overrides(trials=count), out=tmp_path / "run").summary
    height = math.sqrt(20**2 + 12**2 + 9**2)
    by_hand = {
        "top of cover": ((16 + 70 + 8) * 1e3, height),
        "top of bracket": ((16 + 40 + 60) * 1e3, height),
        "step": (22e3, math.sqrt(2 * (12**2 + 9**2))),
    }
    for name, (mean, sigma) in by_hand.items():
        closed = found["measures"][name]["analytic_closed_form"]
        assert (closed["mean"], closed["sigma"]) == pytest.approx((mean, sigma), rel=1e-9)
        for method in ("analytic", "geometric"):
            own = found["measures"][name][method]
            assert own["mean"] == pytest.approx(mean, abs=4 * sigma / math.sqrt(count))
            assert own["sigma"] == pytest.approx(sigma, rel=4 / math.sqrt(2 * count))
