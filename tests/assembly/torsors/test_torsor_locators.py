"""Six contacts on the analytic method, against lever arms and against poses that Newton finds."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import pytest
from assembly.drafts import Draft, Vector, coefficients, displacement, frame, moved_as_a_whole, turned
from numpy.typing import NDArray
from oracles.rigid_parts import RigidParts, directional

from tol3d.assembly.grammar.measures.gap import GapSpec
from tol3d.assembly.model import Assembly, Fix, Locate, Measured, Move, Pair, Weld
from tol3d.assembly.torsors.method import values
from tol3d.errors import InputError

Array = NDArray[np.float64]
Side = Literal["part", "fixture"]

X, Y, Z = np.eye(3)
NEST = [((20, 15, 0), Z), ((180, 15, 0), Z), ((100, 90, 0), Z), ((30, 0, 25), Y), ((170, 0, 25), Y), ((0, 50, 20), X)]
"""Points and normals of a 3-2-1 nest, mm."""


@dataclass
class Nest:
    draft: Draft
    assembly: Assembly
    locators: list[int]


def nest(points_on: Side, at: Vector, contacts: Sequence[tuple[Vector, Array]] = NEST) -> Nest:
    """A block on locators of a nest that deviate along their normals; measured is the displacement of a point."""
    draft = Draft()
    draft.part("nest")
    draft.part("block")
    pairs = []
    for k, (point, normal) in enumerate(contacts):
        moving = draft.feature(f"block.point {k}", point, deviates=False)
        target = draft.feature(f"nest.point {k}", point, deviates=False)
        pairs.append(Pair(moving, target, normal, (draft.contribution(f"locator {k}", [""]),)))
    draft.feature("nest.zero", (0, 0, 0), deviates=False)
    draft.feature("block.target", at, deviates=False)
    measures = {
        name: displacement("block.target", axis, "nest.zero") for name, axis in zip("xyz", np.eye(3), strict=True)
    }
    moves = (Fix("fix", "nest"), Locate("nest move", "block", tuple(pairs), points_on))
    return Nest(draft, draft.assembly(moves, measures), [draft.columns.index(f"locator {k}") for k in range(6)])


@pytest.mark.parametrize("points_on", ["part", "fixture"])
def test_a_block_in_a_3_2_1_nest_follows_its_lever_arms(points_on: Side) -> None:
    """The plane on three points turns it, two points on a side its azimuth; what lies higher shifts by the tilt."""
    x, y, z = at = np.array([200.0, 100.0, 40.0])
    found = nest(points_on, at)
    # height over the three points: a + b x + c y, rows over their deviations
    a, b, c = np.linalg.inv(np.array([[1, *point[:2]] for point, _ in NEST[:3]]))
    d4, d5, d6 = np.eye(6)[3:]
    about_x, about_y = np.pad(c, (0, 3)), np.pad(-b, (0, 3))
    about_z = (d5 - d4) / 140.0
    expected = {
        "x": d6 + (50.0 - y) * about_z + (z - 20.0) * about_y,
        "y": d4 + (x - 30.0) * about_z + (25.0 - z) * about_x,
        "z": np.pad(a + b * x + c * y, (0, 3)),
    }
    np.testing.assert_allclose(expected["y"], [0.1, 0.1, -0.2, -3 / 14, 17 / 14, 0.0], atol=1e-12)  # the paper's row
    for name, row in expected.items():
        np.testing.assert_allclose(coefficients(found.assembly, name)[found.locators], row, atol=1e-12)
    one_shot = np.array([[2.0, -1.5, 3.0, 1.2, -2.0, 0.8]])
    shot = values(found.assembly, one_shot, ["x", "y", "z"])
    for name, row, nominal in zip("xyz", expected.values(), at, strict=True):
        np.testing.assert_allclose(shot[name], nominal + one_shot @ row, atol=1e-12)
    np.testing.assert_allclose(shot["x"] - x, 2.380357, atol=5e-7)  # as printed


def test_a_door_on_its_hinges_has_the_coefficients_of_its_levers() -> None:
    hinge_1, hinge_2, striker = (0, 0, 700), (0, 0, 300), (950, 0, 500)
    contacts = [(hinge_1, X), (hinge_1, Y), (hinge_1, Z), (hinge_2, X), (hinge_2, Y), (striker, Y)]
    # a door turned about y by the hinges' x over their distance, about z by the striker over its radius
    by_lever = {
        (1000, 0, 800): {
            "x": [1.25, 0, 0, -0.25, 0, 0],
            "y": [0, 0.5 + 0.3 - 1 / 19 - 9 / 380, 0, 0, -0.75 - 1 / 38, 20 / 19],
        },
        (1000, 0, 200): {"x": [-0.25, 0, 0, 1.25, 0, 0], "y": [0, -0.75 - 1 / 38, 0, 0, 0.75 - 1 / 38, 20 / 19]},
        (600, 0, 1000): {"z": [-1.5, 0, 1, 1.5, 0, 0]},
    }
    for at, rows in by_lever.items():
        found = nest("part", at, contacts)
        for name, row in rows.items():
            np.testing.assert_allclose(coefficients(found.assembly, name)[found.locators], row, atol=1e-12)


def test_the_taper_of_a_door_is_no_root_sum_square_of_its_gaps() -> None:
    """Problem 12: both gaps share the hinges and vary with the body at the measured point; taper in one trial."""
    hinge_1, hinge_2, striker = (0, 0, 700), (0, 0, 300), (950, 0, 500)
    contacts = [(hinge_1, X), (hinge_1, Y), (hinge_1, Z), (hinge_2, X), (hinge_2, Y), (striker, Y)]
    found = nest("part", (1000, 0, 800), contacts)
    draft = found.draft
    for name, at in (("upper", (1000, 0, 800)), ("lower", (1000, 0, 200))):
        draft.feature(f"block.{name}", at, deviates=False)
        draft.feature(f"nest.{name}", at)
    gaps = [Measured(GapSpec.reads, (f"nest.{name}", f"block.{name}"), X) for name in ("upper", "lower")]
    measures = {"gap": gaps[0], "taper": replace(gaps[0], minus=gaps[1])}
    assembly = draft.assembly(found.assembly.moves, measures)
    sigmas = np.zeros(assembly.width)
    sigmas[found.locators] = 0.25, 0.20, 0.30, 0.25, 0.20, 0.15
    for name in ("upper", "lower"):
        sigmas[draft.columns.index(f"nest.{name} x")] = 0.30
    gap, taper = (float(np.linalg.norm(coefficients(assembly, name) * sigmas)) for name in ("gap", "taper"))
    assert gap == pytest.approx(math.sqrt((1.25**2 + 0.25**2) * 0.25**2 + 0.30**2), abs=1e-12)
    assert taper == pytest.approx(math.sqrt(2 * (1.5 * 0.25) ** 2 + 2 * 0.30**2), abs=1e-12)
    count = 100_000
    deviations = np.random.default_rng(12).normal(size=(count, assembly.width)) * sigmas
    beyond = np.abs(values(assembly, deviations, ["taper"])["taper"]) > 1.0
    share = math.erfc(1.0 / taper / math.sqrt(2.0))
    assert share == pytest.approx(0.140907, abs=1e-6)  # as the paper prints it
    assert beyond.mean() == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / count))


def test_locators_that_leave_a_freedom_are_refused_by_its_name() -> None:
    sides = [(point, Y) for point, _ in NEST[3:]]
    with pytest.raises(InputError, match=r"nest move: its contacts leave block free: shift along x; expected six"):
        values(nest("part", (0, 0, 0), [*NEST[:3], *sides]).assembly, np.zeros((1, 6)), ["x"])
    hub = [((0, 0, 0), X), ((0, 0, 9), X), ((0, 0, 0), Y), ((0, 0, 9), Y), ((0, 0, 0), Z), ((0, 0, 9), Z)]
    with pytest.raises(InputError, match=r"leave block free: turn about z through \(0, 0, 0\)"):
        values(nest("part", (5, 0, 0), hub).assembly, np.zeros((1, 6)), ["x"])


# poses found by Newton -------------------------------------------------------------------------------


def chain(seed: int, points_on: Side) -> Assembly:
    """Two parts on six planes each, the second on the first; all poses and directions are random."""
    rng = np.random.default_rng(seed)
    draft = Draft()
    for name in "abc":
        draft.part(name, turned(rng.normal(size=3), rng.normal(size=3) * 100.0))
    draft.feature("a.zero", (0, 0, 0), deviates=False)
    draft.feature("c.target", frame(rng.normal(size=3) * 50.0, rng.normal(size=3)))
    moves: list[Move] = [Fix("fix", "a")]
    for target, moving in ("ab", "bc"):
        pairs = []
        for k, (beside, along) in enumerate(NEST):  # in the world, somewhat beside those of a nest
            normal, point = along + 0.2 * rng.normal(size=3), beside + 10.0 * rng.normal(size=3)
            normal /= np.linalg.norm(normal)
            other = point + np.cross(normal, rng.normal(size=3)) * 10.0  # origins lie aside of each other
            for part, at in ((moving, point), (target, other)):
                pose = draft.poses[part]
                draft.feature(
                    f"{part}.{target}{moving}{k}", frame((at - pose[:3, 3]) @ pose[:3, :3], rng.normal(size=3))
                )
            side = draft.poses[target if points_on == "part" else moving]
            pairs.append(
                Pair(
                    f"{moving}.{target}{moving}{k}",
                    f"{target}.{target}{moving}{k}",
                    normal @ side[:3, :3],
                    (draft.contribution(f"locator {moving}{k}", [""]),),
                )
            )
        moves.append(Locate(f"place {moving}", moving, tuple(pairs), points_on))
    measures = dict(zip("xyz", [displacement("c.target", axis, "a.zero") for axis in np.eye(3)], strict=True))
    return draft.assembly(moves, measures)


@pytest.mark.parametrize("points_on", ["part", "fixture"])
def test_slopes_of_six_planes_are_those_of_poses_that_newton_finds(points_on: Side) -> None:
    """Central differences of the solved poses; features, locators and turns of what lies below all act."""
    for seed in range(2):
        own = chain(seed, points_on)

        def measured(deviations: Array, own: Assembly = own) -> Array:
            parts = RigidParts(own, deviations, {})
            poses = parts.poses()
            return (parts.origin("c.target", poses) - parts.origin("a.zero", poses)) @ poses["a"][:3, :3]

        found = np.array([coefficients(own, name) for name in "xyz"])
        for direction in np.random.default_rng(seed).normal(size=(12, own.width)):
            # an error of (1e-3 / 100)^2 or so by the third order, of 1e-12 / 1e-3 by Newton
            expected = directional(measured, direction)
            np.testing.assert_allclose(found @ direction, expected, atol=1e-8 * np.abs(found).sum())


def test_values_are_linear_in_the_deviations_and_do_not_see_where_the_assembly_stands() -> None:
    own = chain(7, "part")
    rng = np.random.default_rng(0)
    deviations = rng.normal(size=(5, own.width)) * 0.1
    nominal = values(own, np.zeros((1, own.width)), ["x"])["x"]
    once, thrice = (values(own, factor * deviations, ["x"])["x"] - nominal for factor in (1.0, 3.0))
    np.testing.assert_allclose(thrice, 3.0 * once, rtol=1e-12)
    elsewhere = moved_as_a_whole(own, turned((0.4, -1.1, 0.7), (300.0, -80.0, 900.0)))
    for name in "xyz":
        np.testing.assert_allclose(
            coefficients(elsewhere, name), coefficients(own, name), atol=1e-10 * np.abs(coefficients(own, name)).max()
        )


def test_a_trial_has_the_same_bits_alone_as_among_many() -> None:
    own = chain(3, "part")
    deviations = np.random.default_rng(1).normal(size=(9000, own.width)) * 0.1
    together = values(own, deviations, ["x", "z"])
    for trial in (0, 4095, 4096, 8999):
        alone = values(own, deviations[trial : trial + 1], ["z"])
        assert alone["z"][0] == together["z"][trial]


def test_a_body_of_welded_parts_is_placed_by_features_of_any_of_them() -> None:
    """A block welded to another one and carried by it: what locates the other one moves it by the same levers."""
    found = nest("part", (200, 100, 40))
    draft = found.draft
    draft.part("top", turned((0.0, 0.0, 0.3), (20.0, 10.0, 30.0)))
    to_top = np.linalg.inv(draft.poses["top"])
    draft.feature("top.target", (to_top @ [200, 100, 40, 1])[:3], deviates=False)
    contacts = []
    for k, (point, normal) in enumerate(NEST):
        at_top = draft.feature(f"top.point {k}", (to_top @ [*point, 1])[:3], deviates=False)
        contacts.append(Pair(at_top, f"nest.point {k}", normal, (draft.contribution(f"again {k}", [""]),)))
    moves = (
        *found.assembly.moves,
        Fix("top stays", "top"),
        Weld("weld", "block", ("top",)),
        Locate("again", "block", tuple(contacts)),
    )
    measures = {
        "block": Measured(GapSpec.reads, ("nest.zero", "block.target"), Y),
        "top": Measured(GapSpec.reads, ("nest.zero", "top.target"), Y),
        "block first": Measured(GapSpec.reads, ("nest.zero", "block.target"), Y, after=1),
    }
    assembly = draft.assembly(moves, measures)
    first = coefficients(assembly, "block first")
    again = [draft.columns.index(f"again {k}") for k in range(6)]
    np.testing.assert_allclose(first[found.locators], [0.1, 0.1, -0.2, -3 / 14, 17 / 14, 0.0], atol=1e-12)
    assert not first[again].any()
    # the body's second pose is that of its locators alone; the block lies in it as its first pose left it
    np.testing.assert_allclose(coefficients(assembly, "top")[again], first[found.locators], atol=1e-12)
    np.testing.assert_allclose(coefficients(assembly, "top")[found.locators], 0.0, atol=1e-12)
    np.testing.assert_allclose(coefficients(assembly, "block")[again], first[found.locators], atol=1e-12)
    np.testing.assert_allclose(coefficients(assembly, "block")[found.locators], first[found.locators], atol=1e-12)


def test_a_part_rides_on_the_deviation_of_its_own_features_with_the_opposite_sign() -> None:
    """A bump on the part and one on the target lift it alike; a positive z of a part's foot points down."""
    draft = Draft()
    draft.part("base")
    draft.part("lid")
    pairs = []
    for k, (point, normal) in enumerate(NEST):
        moving = draft.feature(f"lid.point {k}", frame(point, -normal))  # out of the part's material
        target = draft.feature(f"base.point {k}", frame(point, normal))
        pairs.append(Pair(moving, target, normal))
    draft.feature("lid.target", (100, 40, 0), deviates=False)
    moves = (Fix("fix", "base"), Locate("lay", "lid", tuple(pairs)))
    draft.feature("base.zero", (0, 0, 0), deviates=False)
    assembly = draft.assembly(moves, {"height": displacement("lid.target", Z, "base.zero")})
    rows = coefficients(assembly, "height")
    weights = np.linalg.solve([[20, 180, 100], [15, 15, 90], [1, 1, 1]], [100, 40, 1])
    for k, weight in enumerate(weights):
        for part in ("lid", "base"):
            assert rows[draft.columns.index(f"{part}.point {k} z")] == pytest.approx(weight, abs=1e-12)
