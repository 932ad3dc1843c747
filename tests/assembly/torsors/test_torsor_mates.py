"""Mates on the analytic method, against stacks, levers and poses that Newton finds."""

import math

import numpy as np
import pytest
from assembly.drafts import Draft, Vector, displacement, frame, turned
from numpy.typing import NDArray
from oracles.rigid_parts import Poses, RigidParts, directional

from tol3d.assembly.grammar.measures.inspected import InspectedSizeSpec
from tol3d.assembly.model import Assembly, Axis, Fix, Mate, Measured, Plane, Relation
from tol3d.assembly.torsors.method import slopes, values
from tol3d.errors import InputError

Array = NDArray[np.float64]

X, Y, Z = np.eye(3)


def coefficients(assembly: Assembly, name: str, draft: Draft) -> dict[str, float]:
    """By the names of columns, those that are not 0."""
    found = slopes(assembly, name, np.zeros(assembly.width), np.ones(assembly.width)).coefficients
    return {column: value for column, value in zip(draft.columns, found.tolist(), strict=True) if value}


def test_blocks_in_a_cavity_leave_the_gap_that_their_widths_leave() -> None:
    """Problem 1: all uniform within 0.1; the gap of 0.3 is closed with probability 1/120 (Irwin and Hall)."""
    draft = Draft()
    draft.part("cavity")
    draft.feature("cavity.left", frame((0, 0, 0), X), Plane((20, 20)), deviates=False)
    draft.feature("cavity.right", frame((80.3, 0, 0), -X), Plane((20, 20)))
    moves: list[Fix | Mate] = [Fix("fix", "cavity")]
    before = "cavity.left"
    for k in range(4):
        name = draft.part(f"block {k}", frame((20 * k, 0, 0)))
        draft.feature(f"{name}.left", frame((0, 0, 0), -X), Plane((20, 20)), deviates=False)
        draft.feature(f"{name}.right", frame((20, 0, 0), X), Plane((20, 20)))
        moves.append(Mate(f"lay {name}", name, (Relation("coincident", f"{name}.left", before),)))
        before = f"{name}.right"
    assembly = draft.assembly(moves, {"gap": displacement("cavity.right", X, "block 3.right")})
    found = coefficients(assembly, "gap", draft)
    assert found.pop("cavity.right offset") == pytest.approx(-1.0, abs=1e-12)
    assert found == pytest.approx({f"block {k}.right offset": -1.0 for k in range(4)}, abs=1e-12)
    count = 200_000
    deviations = np.zeros((count, assembly.width))
    faces = ["cavity.right", *(f"block {k}.right" for k in range(4))]
    offsets = [draft.columns.index(f"{name} offset") for name in faces]
    deviations[:, offsets] = np.random.default_rng(2).uniform(-0.1, 0.1, (count, 5))
    closed = values(assembly, deviations, ["gap"])["gap"] < 0.0
    share = 1.0 / math.factorial(5)
    assert closed.mean() == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / count))


def test_a_block_tilts_with_what_it_lies_on() -> None:
    draft = Draft()
    draft.part("base")
    draft.part("block", frame((30, 10, 5)))
    draft.feature("base.top", frame((0, 0, 5), Z, X), Plane((100, 60)))
    draft.feature("block.bottom", frame((0, 0, 0), -Z, X), Plane((40, 40)))
    draft.feature("block.far", (25, 15, 80), deviates=False)
    draft.feature("base.zero", (0, 0, 0), deviates=False)
    moves = (Fix("fix", "base"), Mate("lay", "block", (Relation("coincident", "block.bottom", "base.top"),)))
    measures = {name: displacement("block.far", axis, "base.zero") for name, axis in (("x", X), ("z", Z))}
    assembly = draft.assembly(moves, measures)
    # 1 / 50 per mm of rise along x, at the point's x of 55 over the base's middle; the tilt carries what is 80 higher
    height = coefficients(assembly, "z", draft)
    assert height["base.top offset"] == pytest.approx(1.0)
    assert height["base.top rise x"] == pytest.approx(55 / 50)
    assert height["base.top rise y"] == pytest.approx(25 / 30)
    # the block's own face lifts it; at its middle (30, 10) alone it does not turn the point in height
    assert height["block.bottom offset"] == pytest.approx(1.0)
    assert height["block.bottom rise x"] == pytest.approx(25 / 20)
    assert height["block.bottom rise y"] == pytest.approx(-15 / 20)  # y of a face that looks down is -y
    across = coefficients(assembly, "x", draft)
    assert across["base.top rise x"] == pytest.approx(-80 / 50)
    assert across["block.bottom rise x"] == pytest.approx(-80 / 20)


def test_a_shaft_in_a_v_rises_by_its_radius_over_the_sine() -> None:
    """A cylinder in a V of half angle 30 deg: its centre is r / sin 30 deg over the edge; its turn is left as it is."""
    half, radius = math.radians(30.0), 10.0
    draft = Draft()
    draft.part("v")
    draft.part("shaft", frame((0, 0, radius / math.sin(half))))
    for name, side in (("left", 1.0), ("right", -1.0)):
        normal = (0.0, side * math.cos(half), math.sin(half))
        along = np.array([0.0, -side * math.sin(half), math.cos(half)])
        draft.feature(f"v.{name}", frame(30.0 * along, normal, X), Plane((80, 60)))
    draft.feature("v.zero", (0, 0, 0), deviates=False)
    draft.feature("shaft.journal", frame((0, 0, 0), X, Y), Axis(60.0, 2 * radius))
    draft.size("shaft.journal")
    draft.feature("shaft.end", (40, 0, 0), deviates=False)
    relations = tuple(Relation("tangent", "shaft.journal", f"v.{name}") for name in ("left", "right"))
    moves = (Fix("fix", "v"), Mate("lay", "shaft", relations))
    measures = {name: displacement("shaft.end", axis, "v.zero") for name, axis in (("x", X), ("y", Y), ("z", Z))}
    assembly = draft.assembly(moves, measures)
    height, aside = coefficients(assembly, "z", draft), coefficients(assembly, "y", draft)
    assert height["shaft.journal size"] == pytest.approx(0.5 / math.sin(half))
    assert height["v.left offset"] == pytest.approx(height["v.right offset"]) == pytest.approx(0.5 / math.sin(half))
    assert aside["v.left offset"] == pytest.approx(0.5 / math.cos(half))
    assert aside["v.right offset"] == pytest.approx(-0.5 / math.cos(half))
    assert "shaft.journal size" not in aside
    # the axis rises along x with both walls: 40 mm from the middle over the reach of 40
    assert height["v.left rise x"] == pytest.approx(0.5 / math.sin(half))
    assert coefficients(assembly, "x", draft) == pytest.approx({}, abs=1e-12)


def test_a_plate_on_a_cylinder_touches_it_as_the_cylinder_touches_a_plate() -> None:
    draft = Draft()
    draft.part("shaft")
    draft.part("plate", frame((0, 0, 10)))
    draft.feature("shaft.journal", frame((0, 0, 0), X, Y), Axis(60.0, 20.0))
    draft.size("shaft.journal")
    draft.feature("shaft.zero", (0, 0, 0), deviates=False)
    draft.feature("plate.bottom", frame((0, 0, 0), -Z, X), Plane((60, 40)))
    draft.feature("plate.end", (30, 0, 0), deviates=False)
    moves = (Fix("fix", "shaft"), Mate("lay", "plate", (Relation("tangent", "plate.bottom", "shaft.journal"),)))
    assembly = draft.assembly(moves, {"z": displacement("plate.end", Z, "shaft.zero")})
    found = coefficients(assembly, "z", draft)
    # at the end of both: half the size; the axis' own end z (y of its frame is along z); the plate's rise there
    expected = {
        "shaft.journal size": 0.5,
        "shaft.journal end y": 1.0,
        "plate.bottom offset": 1.0,
        "plate.bottom rise x": 1.0,
    }
    assert found == pytest.approx(expected, abs=1e-12)


def test_a_second_pin_turns_the_part_by_the_direction_from_the_first() -> None:
    """Face, pin, pin: the second takes the turn alone, and its distance from the first counts for nothing."""
    draft = Draft()
    draft.part("base")
    draft.part("lid")
    relations = []
    for name, at in (("1", (10, 20, 0)), ("2", (110, 20, 0))):
        draft.feature(f"base.hole {name}", frame(at), Axis(8.0))
        draft.feature(f"lid.pin {name}", frame(at), Axis(8.0))
        relations.append(Relation("coaxial", f"lid.pin {name}", f"base.hole {name}"))
    draft.feature("base.top", frame((60, 20, 0), Z, X), Plane((100, 50)), deviates=False)
    draft.feature("lid.bottom", frame((60, 20, 0), -Z, X), Plane((100, 50)), deviates=False)
    draft.feature("base.zero", (0, 0, 0), deviates=False)
    draft.feature("lid.far", (210, 70, 0), deviates=False)
    moves = (Fix("fix", "base"), Mate("lay", "lid", (Relation("coincident", "lid.bottom", "base.top"), *relations)))
    measures = {name: displacement("lid.far", axis, "base.zero") for name, axis in (("x", X), ("y", Y))}
    assembly = draft.assembly(moves, measures)
    along, across = coefficients(assembly, "x", draft), coefficients(assembly, "y", draft)
    # a centre is half of start and end; turn = (second - first) / 100 in y; the point lies 200 and 50 from the first
    assert across == pytest.approx(
        {
            f"{name} {k} {end} y": sign * weight / 2
            for name, sign in (("base.hole", 1.0), ("lid.pin", -1.0))
            for k, weight in ((1, 1 - 2.0), (2, 2.0))
            for end in ("start", "end")
        },
        abs=1e-12,
    )
    assert along["base.hole 1 start x"] == pytest.approx(0.5)
    assert along["base.hole 2 start y"] == pytest.approx(-0.5 * 50 / 100)
    assert abs(along.get("base.hole 2 start x", 0.0)) < 1e-12


def test_slopes_of_mates_are_those_of_poses_that_newton_finds() -> None:
    """An axis on an axis, a plane's height, a point's height; then on that a plane, an axis on a point, a distance."""
    rng = np.random.default_rng(4)
    draft = Draft()
    for name in "abc":
        draft.part(name, turned(rng.normal(size=3), 50.0 * rng.normal(size=3)))

    def at(part: str, point: Vector, z: Vector) -> Array:
        """A frame that is stated in the world, in a part's."""
        return np.asarray(np.linalg.inv(draft.poses[part]) @ frame(point, z))

    skew = np.array([0.1, 0.2, 1.0])
    draft.feature("a.hole", at("a", (0, 0, 0), skew), Axis(40.0))
    draft.feature("b.pin", at("b", 10.0 * skew, skew), Axis(30.0))
    draft.feature("a.top", at("a", (50, 0, 30), skew), Plane((80, 60)))
    draft.feature("b.bottom", at("b", np.array([50, 0, 30]) + np.cross(skew, [5, 30, 1]), -skew), Plane((30, 50)))
    draft.feature("a.stop", at("a", (90, 0, 50), Y), Plane((30, 40)))
    draft.feature("b.tip", at("b", (80, 3.0, 40), Y))
    draft.feature("b.top", at("b", (0, 0, 80), (0.1, 0, 1)), Plane((60, 60)))
    draft.feature("c.bottom", at("c", (20, 10, 78), (-0.1, 0, -1)), Plane((60, 60)))
    draft.feature("b.axis", at("b", (0, 0, 80), (0.1, 0, 1)), Axis(20.0))
    draft.feature("c.ball", at("c", np.array([0.0, 0, 80]) + 20.0 * np.array([0.1, 0, 1]), Z))
    draft.feature("b.side", at("b", (0, 50, 80), (0.3, -1, 0)), Plane((60, 60)))
    draft.feature("c.foot", at("c", (30, 59, 80), Z))
    draft.feature("c.far", at("c", (70, -50, 120), (1, 1, 1)), Axis(10.0))
    draft.feature("a.zero", (0, 0, 0), deviates=False)
    lie = (Relation("coaxial", "b.pin", "a.hole"), Relation("coincident", "b.bottom", "a.top"))
    stop = Relation("distance", "b.tip", "a.stop", 3.0)
    on_top = (Relation("coincident", "c.bottom", "b.top"), Relation("coincident", "c.ball", "b.axis"))
    foot = Relation("distance", "c.foot", "b.side", 0.0)
    moves = (Fix("fix", "a"), Mate("lay b", "b", (*lie, stop)), Mate("lay c", "c", (*on_top, foot)))
    measures = dict(zip("xyz", [displacement("c.far", axis, "a.zero") for axis in np.eye(3)], strict=True))
    assembly = draft.assembly(moves, measures)
    # distances as they are nominally
    nominal = values(assembly, np.zeros((1, assembly.width)), ["x", "y", "z"])

    def height(parts: RigidParts, poses: Poses, point: str, plane: str) -> float:
        return float(parts.z(plane, poses) @ (parts.origin(point, poses) - parts.origin(plane, poses)))

    def across(parts: RigidParts, poses: Poses, feature: str) -> Array:
        """Two directions across a feature's z."""
        z = parts.z(feature, poses)
        return np.array([np.cross(z, X), np.cross(z, Y)])

    def lay_b(parts: RigidParts, poses: Poses) -> list[float]:
        apart = parts.origin("b.pin", poses) - parts.origin("a.hole", poses)
        sides = across(parts, poses, "a.hole")
        own = [*(sides @ apart), *(100.0 * sides @ parts.z("b.pin", poses))]
        return [*own, height(parts, poses, "b.bottom", "a.top"), height(parts, poses, "b.tip", "a.stop") - 3.0]

    def lay_c(parts: RigidParts, poses: Poses) -> list[float]:
        apart = parts.origin("c.ball", poses) - parts.origin("b.axis", poses)
        normal = 100.0 * across(parts, poses, "b.top") @ parts.z("c.bottom", poses)
        sides = across(parts, poses, "b.axis") @ apart
        return [*normal, height(parts, poses, "c.bottom", "b.top"), *sides, height(parts, poses, "c.foot", "b.side")]

    def measured(deviations: Array) -> Array:
        parts = RigidParts(assembly, deviations, {"lay b": lay_b, "lay c": lay_c})
        poses = parts.poses()
        return (parts.origin("c.far", poses) - parts.origin("a.zero", poses)) @ poses["a"][:3, :3]

    np.testing.assert_allclose([nominal[name][0] for name in "xyz"], measured(np.zeros(assembly.width)), atol=1e-9)
    own = np.array([slopes(assembly, name, *np.zeros((2, assembly.width))).coefficients for name in "xyz"])
    for direction in rng.normal(size=(12, assembly.width)):
        np.testing.assert_allclose(own @ direction, directional(measured, direction), atol=1e-7 * np.abs(own).sum())


def test_relations_that_take_nothing_or_make_no_sense_are_refused() -> None:
    draft = Draft()
    draft.part("base")
    draft.part("lid")
    for part in ("base", "lid"):
        draft.feature(f"{part}.face", frame((0, 0, 0), Z if part == "base" else -Z), Plane((9, 9)))
        draft.feature(f"{part}.again", frame((30, 0, 0), Z if part == "base" else -Z), Plane((9, 9)))
        draft.feature(f"{part}.axis", frame((0, 0, 0), X), Axis(10.0))
    face = Relation("coincident", "lid.face", "base.face")
    again = Relation("coincident", "lid.again", "base.again")
    for relations, message in (
        ((face, again), "lay: coincident of lid.again and base.again takes no freedom"),
        ((Relation("coaxial", "lid.face", "base.axis"),), "coaxial of lid.face and base.axis: not of a plane"),
        ((Relation("tangent", "lid.axis", "base.face"),), "lay: lid.axis has no diameter; expected one"),
    ):
        moves = (Fix("fix", "base"), Mate("lay", "lid", relations))
        assembly = draft.assembly(moves, {"size": Measured(InspectedSizeSpec.reads, ("lid.axis",))})
        with pytest.raises(InputError, match=message):
            values(assembly, np.zeros((1, assembly.width)), ["size"])


def test_what_nothing_holds_stays_by_the_least_turn_and_about_the_middle_of_the_feature() -> None:
    """A pin in a hole that tilts about x: the lid does not turn about the pin, whose middle does not slide along it."""
    draft = Draft()
    draft.part("base")
    draft.part("lid", frame((70, 20, 9)))  # its origin lies off the pin
    draft.feature("base.hole", frame((10, 20, 0), Z, X), Axis(40.0))
    draft.feature("lid.pin", frame((-60, 0, -9), Z, X), Axis(40.0), deviates=False)
    draft.feature("base.zero", (0, 0, 0), deviates=False)
    draft.feature("lid.origin", (0, 0, 0), deviates=False)
    draft.feature("lid.far", (30, 40, 50), deviates=False)
    moves = (Fix("fix", "base"), Mate("lay", "lid", (Relation("coaxial", "lid.pin", "base.hole"),)))
    measures = {
        f"{point} {name}": displacement(f"lid.{point}", axis, "base.zero")
        for point in ("origin", "far")
        for name, axis in (("x", X), ("y", Y), ("z", Z))
    }
    assembly = draft.assembly(moves, measures)
    tilt = 0.4 / 40.0  # of the hole, about x and about -y, by its end alone; its middle shifts by half
    given = draft.trial({"base.hole end y": -0.4, "base.hole end x": 0.4})
    found = values(assembly, given, list(measures))
    turn = np.array([tilt, tilt, 0.0])
    middle = np.array([0.2, -0.2, 0.0])
    for point, at in (("origin", np.zeros(3)), ("far", np.array([30.0, 40, 50]))):
        shift = middle + np.cross(turn, at + np.array([60, 0, 9]))
        expected = at + np.array([70, 20, 9]) + shift
        np.testing.assert_allclose([found[f"{point} {name}"][0] for name in "xyz"], expected, atol=1e-12)


def test_a_ball_before_a_plane_or_an_axis_leaves_it_the_turns_alone() -> None:
    """The directions of planes come first, for axes the place across; the rest of the other is asked."""
    draft = Draft()
    draft.part("base")
    draft.part("lid")
    for part, z in (("base", Z), ("lid", -Z)):
        draft.feature(f"{part}.ball", (0, 0, 0))
        draft.feature(f"{part}.face", frame((50, 0, 0), z, X), Plane((100, 60)))
        draft.feature(f"{part}.axis", frame((0, 0, 50), Z, X), Axis(40.0))
    draft.feature("base.zero", (0, 0, 0), deviates=False)
    draft.feature("lid.far", (50, 0, 20), deviates=False)
    ball = Relation("coincident", "lid.ball", "base.ball")
    measures = {name: displacement("lid.far", axis, "base.zero") for name, axis in (("x", X), ("y", Y), ("z", Z))}
    for relation, given, expected in (
        # the face tilts the lid about the ball, and its offset is not met
        (Relation("coincident", "lid.face", "base.face"), {"face offset": 0.3, "face rise x": 0.1}, (-0.04, 0.0, 0.1)),
        # the middle of an axis 50 over the ball turns the lid by its place, and its direction is not met
        (Relation("coaxial", "lid.axis", "base.axis"), {"axis end y": 0.2}, (0.0, 0.1 * 20 / 50, 0.0)),
    ):
        assembly = draft.assembly((Fix("fix", "base"), Mate("lay", "lid", (ball, relation))), measures)
        trial = draft.trial({f"base.{name}": value for name, value in given.items()})
        found = values(assembly, trial, ["x", "y", "z"])
        np.testing.assert_allclose([found[name][0] for name in "xyz"], np.array([50, 0, 20]) + expected, atol=1e-12)


def test_parts_that_are_drawn_beside_where_their_mates_lay_them_are_laid_there() -> None:
    """Lifted by 0.1, tilted by 1e-3 and shifted nominally: laid to the second order, that is 1e-6 times the arm."""
    draft = Draft()
    draft.part("base")
    draft.part("lid", turned((1e-3, -2e-3, 1e-3), (0.2, -0.1, 0.1)))
    for part, z in (("base", Z), ("lid", -Z)):
        draft.feature(f"{part}.face", frame((50, 0, 0), z, X), Plane((100, 60)), deviates=False)
        for k, x in enumerate((10, 90)):
            draft.feature(f"{part}.{k}", frame((x, 0, 0), Z), Axis(40.0), deviates=False)
    draft.feature("base.zero", (0, 0, 0), deviates=False)
    draft.feature("lid.far", (50, 30, 20), deviates=False)
    draft.contribution("none", [""])
    relations = [Relation("coincident", "lid.face", "base.face")]
    relations += [Relation("coaxial", f"lid.{k}", f"base.{k}") for k in range(2)]
    measures = {name: displacement("lid.far", axis, "base.zero") for name, axis in (("x", X), ("y", Y), ("z", Z))}
    assembly = draft.assembly((Fix("fix", "base"), Mate("lay", "lid", tuple(relations))), measures)
    found = values(assembly, np.zeros((1, 1)), ["x", "y", "z"])
    np.testing.assert_allclose([found[name][0] for name in "xyz"], [50, 30, 20], atol=5e-4)
    before = slopes(draft.assembly((), measures), "z", np.zeros(1), np.zeros(1)).nominal
    assert abs(before - 20) > 0.05
