"""Freedoms that `check` lists: of each datum and each move, worked out by hand."""

from pathlib import Path

import numpy as np
import pytest
from places import SCENES
from scipy.linalg import null_space
from scipy.stats import ortho_group

from tol3d.assembly.placing.nominal_constraints import held_by, in_words, taken
from tol3d.assembly.placing.placer import Asked
from tol3d.assembly.placing.plan import planned
from tol3d.assembly.presenting.tables import drawing_blocks
from tol3d.assembly.system import AssemblySystem
from tol3d.gearing.machine.system import MachineSystem
from tol3d.report.page import Line, page
from tol3d.simulate import Overrides, load, simulation_of

HOLDS = "upper hinge, lower hinge, striker"

MATES = """
scene: parts mated to a base
parts:
  base:
    kind: solid
    features:
      slope: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0.6, 0.8], extent: [50 mm, 50 mm]}}
      top: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [50 mm, 50 mm]}}
      wall: {{kind: plane, at: [0 mm, 10 mm, 0 mm], normal: [0, -1, 0], extent: [50 mm, 50 mm]}}
      pin: {{kind: cylinder, at: [30 mm, 20 mm, 0 mm], axis: [0, 0.6, 0.8], length: 20 mm, diameter: 8 mm}}
      tip: {{kind: point, at: [5 mm, 0 mm, 0 mm]}}
  other:
    kind: solid
    features:
      face: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, -0.6, -0.8], extent: [50 mm, 50 mm]}}
      under: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [50 mm, 50 mm]}}
      bore: {{kind: cylinder, at: [30 mm, 20 mm, 0 mm], axis: [0, 0.6, 0.8], length: 20 mm, diameter: 9 mm, hole: true}}
      roll: {{kind: cylinder, at: [0 mm, 8 mm, 2 mm], axis: [1, 0, 0], length: 20 mm, diameter: 4 mm}}
      tip: {{kind: point, at: [5 mm, 0 mm, 0 mm]}}
      spot: {{kind: point, at: [30 mm, 20 mm, 0 mm]}}
moves:
  set up: {{kind: fix, part: base}}
  mated: {{kind: mate, part: other, relations: [{relations}]}}
measures:
  apart: {{kind: distance, from: base.tip, to: other.spot}}
"""


def drawn(scene: Path) -> AssemblySystem:
    """The assembly of a scene, also that around gears."""
    system = simulation_of(load(scene), Overrides()).system
    found = system.drawn if isinstance(system, MachineSystem) else system
    assert isinstance(found, AssemblySystem)
    return found


def listed(scene: Path, start: str) -> list[tuple[str, ...]]:
    """Rows of the table whose title begins so."""
    shown = page(*drawing_blocks(drawn(scene)))
    titles = [str(own).strip() for own in shown.blocks if isinstance(own, Line) and "cyan" in own.pieces[-1][1]]
    (table,) = (own for title, own in zip(titles, shown.tables, strict=True) if title.startswith(start))
    return [(row.label, *row.cells) for row in table.rows]


@pytest.mark.parametrize(
    ("scene", "move", "rows"),
    [
        (
            "door",
            "hanging",
            [
                ("y, turns x, z", f"primary: door.{HOLDS} on body.{HOLDS}"),
                ("x, turns y", "secondary: door.upper hinge, lower hinge on body.upper hinge, lower hinge"),
                ("z", "tertiary: door.upper hinge on body.upper hinge"),
            ],
        ),
        (
            "cover_on_base",
            "cover on the base",
            [
                ("z, turns x, y", "primary: cover.A1, A2, A3 on base.floor"),
                ("y, turns z", "secondary: cover.B1, B2 on base.back"),
                ("x", "tertiary: cover.C1 on base.left"),
            ],
        ),
        (
            "hole_and_slot",
            "plate on the pins",
            [
                ("z, turns x, y", "coincident: plate.bottom on base.top"),
                ("x, y, turns z", "base.pin 1 in plate.hole, base.pin 2 in plate.slot, within clearance"),
            ],
        ),
        (
            "hole_and_slot",
            "key in its way",
            [
                ("z, turns x, y", "coincident: key.bottom on base.top"),
                ("y, turns z", "key.tab in base.keyway, within clearance"),
                ("x", "left as drawn"),
            ],
        ),
        (
            "two_plates",
            "plate on plate",
            [
                ("z, turns x, y", "coincident: upper.face on lower.face"),
                ("x, y, turns z", "lower.pin 1 in upper.hole 1, lower.pin 2 in upper.hole 2, within clearance"),
            ],
        ),
        (
            "clutch",  # the flat holds the roller along y and against tilts; the ring then stops it along x
            "wedge",
            [
                ("y, turns x", "roller.surface on hub.flat"),
                ("x, turns y", "roller.surface on ring.bore"),
                ("z, turns z", "left as drawn"),
            ],
        ),
        (
            "four_pads",
            "plate on the pads",
            [
                ("x, y", "coincident: plate.middle on table.pin"),
                ("z, turns x, y", "contacts with table.pad 1, pad 2, pad 3, pad 4, pressed on"),
                ("turns z through (0, 0, 0)", "left as drawn"),
            ],
        ),
        (
            "every_assembly_field",
            "spindle in the bore",
            [
                ("x, y, turns x, y", "coaxial: spindle.axis on base.bore 1"),
                ("z", "distance: spindle.shoulder on base.floor"),
                ("turns z through (-40, 0, 0)", "left as drawn"),
            ],
        ),
        ("every_assembly_field", "assembly", [("all six", "cover, sensor, spindle with base")]),
        ("every_assembly_field", "machine", [("all six", "as drawn")]),
        (
            "every_assembly_field",
            "second cover on the gauge",
            [("all six", "fit of second cover.hole 1, hole 2, hole 3")],
        ),
    ],
)
def test_moves_hold(scene: str, move: str, rows: list[tuple[str, str]]) -> None:
    found = listed(SCENES / f"{scene}.yaml", "freedoms that moves hold")
    assert [own[1:] for own in found if own[0] == move] == rows


@pytest.mark.parametrize(
    ("relations", "expected"),
    [
        # a slope of normal (0, 0.6, 0.8) leaves shifts and a turn in itself
        (
            "{kind: coincident, from: other.face, to: base.slope}",
            ["(0, 0.6, 0.8), turns x, (0, 0.8, -0.6)", "x, (0, 0.8, -0.6), turns (0, 0.6, 0.8)"],
        ),
        (
            "{kind: coaxial, from: other.bore, to: base.pin}",
            ["x, (0, 0.8, -0.6), turns x, (0, 0.8, -0.6)", "(0, 0.6, 0.8), turns (0, 0.6, 0.8)"],
        ),
        # a point that is held leaves the turn about it, which a second one takes
        (
            "{kind: coincident, from: other.under, to: base.top}, {kind: coincident, from: other.tip, to: base.tip}",
            ["z, turns x, y", "x, y", "turns z through (5, 0, 0)"],
        ),
        (
            "{kind: coincident, from: other.under, to: base.top}, {kind: coincident, from: other.tip, to: base.tip}, "
            "{kind: coincident, from: other.spot, to: base.pin}",
            ["z, turns x, y", "x, y", "turns z"],
        ),
        # a roll along x on a floor, then against a wall: its shift along x and its turn are left
        (
            "{kind: coincident, from: other.under, to: base.top}, {kind: tangent, from: other.roll, to: base.wall}",
            ["z, turns x, y", "y, turns z", "x"],
        ),
    ],
)
def test_mates_hold(tmp_path: Path, relations: str, expected: list[str]) -> None:
    scene = tmp_path / "mates.yaml"
    scene.write_text(MATES.format(relations=relations), encoding="utf-8")
    found = listed(scene, "freedoms that moves hold")
    assert [own[1] for own in found if own[0] == "mated"] == expected


HELD_BY_SOME = """
scene: a lid that is held by some of what could hold it
parts:
  base:
    kind: solid
    features:
      top: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [50 mm, 50 mm]}
      pin: {kind: cylinder, at: [10 mm, -5 mm, 4 mm], axis: [0, 0, 1], length: 8 mm, diameter: 6 mm}
      a: {kind: point, at: [20 mm, 0 mm, 0 mm], normal: [0, 0, 1]}
      b: {kind: point, at: [-20 mm, 20 mm, 0 mm], normal: [0, 0, 1]}
      c: {kind: point, at: [-20 mm, -20 mm, 0 mm], normal: [0, 0, 1]}
  lid:
    kind: solid
    features:
      under: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [50 mm, 50 mm]}
      hole: {kind: cylinder, at: [10 mm, -5 mm, 2 mm], axis: [0, 0, 1], length: 4 mm, diameter: 6.2 mm, hole: true}
      a: {kind: point, at: [20 mm, 0 mm, 0 mm]}
      b: {kind: point, at: [-20 mm, 20 mm, 0 mm]}
      c: {kind: point, at: [-20 mm, -20 mm, 0 mm]}
tolerances:
  hole size: {kind: size, of: lid.hole, distribution: {kind: constant, value: 0 mm}}
  pin size: {kind: size, of: base.pin, distribution: {kind: constant, value: 0 mm}}
moves:
  set up: {kind: fix, part: base}
  held: {kind: MOVE}
measures:
  height: {kind: point_plane, from: base.top, to: lid.a}
"""


@pytest.mark.parametrize(
    ("move", "expected"),
    [
        # a pin in a hole: shifts within its clearance, the turn about it as drawn
        (
            "pin_and_hole, part: lid, relations: [{kind: coincident, from: lid.under, to: base.top}], "
            "pairs: [{from: lid.hole, to: base.pin}], float: {kind: centred}",
            ["z, turns x, y", "x, y", "turns z through (10, -5, 0)"],
        ),
        # heights alone are fitted
        (
            "best_fit, part: lid, pairs: [{from: lid.a, to: base.a, along: [[0, 0, 1]]}, "
            "{from: lid.b, to: base.b, along: [[0, 0, 1]]}, {from: lid.c, to: base.c, along: [[0, 0, 1]]}]",
            ["z, turns x, y", "x, y, turns z"],
        ),
        # three points under the weight of a lid
        (
            "rest, part: lid, contacts: [{from: lid.under, to: base.a}, {from: lid.under, to: base.b}, "
            "{from: lid.under, to: base.c}], points_on: fixture, "
            "force: {direction: [0, 0, -1], at: [-5 mm, 0 mm, 0 mm]}",
            ["z, turns x, y", "x, y, turns z"],
        ),
    ],
)
def test_what_holds_some_freedoms_leaves_the_others(tmp_path: Path, move: str, expected: list[str]) -> None:
    scene = tmp_path / "lid.yaml"
    scene.write_text(HELD_BY_SOME.replace("MOVE", move), encoding="utf-8")
    found = listed(scene, "freedoms that moves hold")
    assert [own[1] for own in found if own[0] == "held"] == expected


def test_six_planes_are_listed_one_by_one_where_they_are_no_three_two_one(tmp_path: Path) -> None:
    """One pad of the back wall before the floor: the other one then takes the turn alone."""
    text = (SCENES / "cover_on_base.yaml").read_text("utf-8")
    head, _, rest = text.partition("    kind: three_two_one")
    tail = rest[rest.index("measures:") :]
    to = ["{from: cover.B1, to: base.back}", "{from: cover.A1, to: base.floor}", "{from: cover.A2, to: base.floor}"]
    to += ["{from: cover.A3, to: base.floor}", "{from: cover.B2, to: base.back}", "{from: cover.C1, to: base.left}"]
    scene = tmp_path / "six.yaml"
    scene.write_text(
        f"{head}    kind: six_plane\n    part: cover\n    pairs: [{', '.join(to)}]\n\n{tail}", encoding="utf-8"
    )
    found = listed(scene, "freedoms that moves hold")
    assert [own[1:] for own in found if own[0] == "cover on the base"] == [
        ("y", "contact 1: cover.B1 on base.back"),
        ("z, turns x, y", "contacts 2 to 4: cover.A1, A2, A3 on base.floor"),
        ("turns z", "contact 5: cover.B2 on base.back"),
        ("x", "contact 6: cover.C1 on base.left"),
    ]


def test_datums_take_what_earlier_ones_leave() -> None:
    found = listed(SCENES / "every_assembly_field.yaml", "datum frames")
    assert found == [
        ("base: floor", "floor: z, turns x, y", "x, y, turns z"),
        ("base: floor, back fitted", "floor: z, turns x, y; back: y, turns z", "x"),
        ("base: floor, back", "floor: z, turns x, y; back: y, turns z", "x"),
        ("base: back", "back: y, turns x, z", "x, z, turns y"),
        ("base: floor, back at 10 0 5; 110 0 5, left", "floor: z, turns x, y; back: y, turns z; left: x", "none"),
        ("base: floor, back, left", "floor: z, turns x, y; back: y, turns z; left: x", "none"),
        ("base: bore 1-bore 2", "bore 1-bore 2: y, z, turns y, z", "x, turns x"),
        ("base: bore 1", "bore 1: x, y, turns x, y", "z, turns z"),
        ("spindle: axis", "axis: x, y, turns x, y", "z, turns z"),
    ]
    (housing,) = listed(SCENES / "housed_gears.yaml", "datum frames")
    assert housing[1:] == ("wall: z, turns x, y; input bore: x, y", "turns z through (0, 0, 0)")


@pytest.mark.parametrize("scene", ["door", "hole_and_slot", "box_with_discs", "four_pads", "every_assembly_field"])
def test_what_is_taken_and_left_is_six(scene: str) -> None:
    assembly = drawn(SCENES / f"{scene}.yaml").assembly
    for plan in planned(assembly).moves:
        if plan.move.parts:  # a weld places none
            found = held_by(assembly, plan)
            assert sum(own.count for own in found.taken) + found.left.count == 6


@pytest.mark.parametrize("scene", ["door", "hole_and_slot", "box_with_discs", "four_pads", "every_assembly_field"])
def test_rows_about_another_point_are_those_of_arms_from_there(scene: str) -> None:
    """(p - q) x n = p x n - q x n: what a move asks of each motion, about q and about 0."""
    assembly, there = drawn(SCENES / f"{scene}.yaml").assembly, np.array([30.0, -80.0, 10.0])
    for plan in planned(assembly).moves:
        if plan.move.parts:  # a weld places none
            for own, moved in zip(plan.asked(assembly, np.zeros(3)), plan.asked(assembly, there), strict=True):
                turns = own.rows[:, 3:] - np.cross(there, own.rows[:, :3])
                assert moved.rows == pytest.approx(np.hstack([own.rows[:, :3], turns]), abs=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_directions_are_those_of_the_null_space_whatever_the_point_that_motions_are_about(seed: int) -> None:
    """Contacts of random points: shifts of the null space alone, and directions of all its turns, by scipy."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 6))
    normals, points = ortho_group.rvs(3, random_state=rng)[rng.integers(0, 3, count)], rng.uniform(-50, 50, (count, 3))
    free = null_space(np.hstack([normals, np.cross(points, normals) / 50]))
    directions, sizes, _ = np.linalg.svd(free[3:])
    turns = directions[:, : int(np.sum(sizes > 1e-9))]
    shifts = null_space(normals)
    for middle in (np.zeros(3), np.array([30.0, -80.0, 10.0])):
        rows = np.hstack([normals, np.cross(points - middle, normals)])
        found = taken([Asked(str(k), row[None]) for k, row in enumerate(rows)], middle, 50.0)
        assert found.left.turns.T @ found.left.turns == pytest.approx(turns @ turns.T, abs=1e-9)
        assert found.left.shifts.T @ found.left.shifts == pytest.approx(shifts @ shifts.T, abs=1e-9)
        assert sum(own.count for own in found.taken) == 6 - free.shape[1]


def test_words_of_directions_that_are_no_axes() -> None:
    """A plane across (0.6, 0, 0.8) holds y and one more; one across (1, 1, 1)/sqrt(3) holds no axis."""
    tilted = np.array([(0.6, 0.0, 0.8)])
    found = taken([Asked("plane", np.hstack([tilted, np.zeros((1, 3))]))], np.zeros(3), 1.0)
    assert in_words(found.left) == "y, (0.8, 0, -0.6), turns x, y, z"
    diagonal = np.ones((1, 3)) / np.sqrt(3)
    found = taken([Asked("plane", np.hstack([diagonal, np.zeros((1, 3))]))], np.zeros(3), 1.0)
    assert in_words(found.left) == "all across (0.5774, 0.5774, 0.5774), turns x, y, z"
