"""Measures on the analytic method, against closed forms and finite poses."""

import math
import pickle
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from assembly.drafts import Draft, displacement, frame, turned
from numpy.typing import NDArray
from oracles.rigid_parts import Poses, RigidParts, directional
from scipy.optimize import linprog

from tol3d.assembly.grammar.measures.gap import AngleSpec, DistanceSpec, GapSpec, PointPlaneSpec
from tol3d.assembly.grammar.measures.inspected import (
    InspectedFlatnessSpec,
    InspectedOrientationSpec,
    InspectedPositionSpec,
    InspectedSizeSpec,
)
from tol3d.assembly.model import Assembly, Axis, Datum, Fix, Locate, Measured, Move, Pair, Plane, RoundPlane
from tol3d.assembly.torsors.first_order import first_order
from tol3d.assembly.torsors.method import slopes, values
from tol3d.errors import InputError

Array = NDArray[np.float64]

X, Y, Z = np.eye(3)


def one(draft: Draft, measured: Measured, **given: float) -> float:
    """A measure of a single part in one trial; columns by their names, "_" for " ", of the feature "part.feature"."""
    assembly = draft.assembly((), {"value": measured})
    trial = draft.trial({f"part.feature {name.replace('_', ' ')}": value for name, value in given.items()})
    return float(values(assembly, trial, ["value"])["value"][0])


# between parts --------------------------------------------------------------------------------------


def lid_on_base() -> tuple[Draft, tuple[Move, ...]]:
    """Two parts turned at random, one on six planes of the other, all of it deviating."""
    rng = np.random.default_rng(21)
    draft = Draft()
    for name in ("base", "lid"):
        draft.part(name, turned(rng.normal(size=3), 80.0 * rng.normal(size=3)))
    contacts = [((20, 15, 0), Z), ((180, 15, 0), Z), ((100, 90, 0), Z)]
    contacts += [((30, 0, 25), Y), ((170, 0, 25), Y), ((0, 50, 20), X)]
    pairs = []
    for k, (point, normal) in enumerate(contacts):
        for part in ("lid", "base"):
            draft.feature(f"{part}.{k}", np.linalg.inv(draft.poses[part]) @ frame(point, rng.normal(size=3)))
        pairs.append(Pair(f"lid.{k}", f"base.{k}", normal @ draft.poses["base"][:3, :3]))
    for part, at in (("lid", (90, 40, 30)), ("base", (60, -20, 55))):
        own = np.linalg.inv(draft.poses[part])
        draft.feature(f"{part}.point", own @ frame(at, rng.normal(size=3)))
        draft.feature(f"{part}.plane", own @ frame(np.array(at) + 20.0, rng.normal(size=3)), Plane((40, 30)))
        draft.feature(f"{part}.axis", own @ frame(np.array(at) - 20.0, rng.normal(size=3)), Axis(50.0, 12.0))
    return draft, (Fix("fix", "base"), Locate("lay", "lid", tuple(pairs)))


def unit(vector: Array) -> Array:
    return vector / np.linalg.norm(vector)


ALONG = unit(np.array([0.3, -0.5, 0.8]))
EXACT: dict[str, tuple[Measured, Callable[[RigidParts, Poses], float]]] = {
    "distance": (
        Measured(DistanceSpec.reads, ("base.point", "lid.axis")),
        lambda parts, poses: float(np.linalg.norm(parts.origin("lid.axis", poses) - parts.origin("base.point", poses))),
    ),
    "gap": (
        Measured(GapSpec.reads, ("base.axis", "lid.plane"), ALONG),
        lambda parts, poses: float(
            (parts.origin("lid.plane", poses) - parts.origin("base.axis", poses)) @ poses["base"][:3, :3] @ ALONG
        ),
    ),
    "gap along a direction of the part that moves": (
        Measured(GapSpec.reads, ("lid.point", "base.axis"), ALONG),
        lambda parts, poses: float(
            (parts.origin("base.axis", poses) - parts.origin("lid.point", poses)) @ poses["lid"][:3, :3] @ ALONG
        ),
    ),
    "point over a plane": (
        Measured(PointPlaneSpec.reads, ("base.point", "lid.plane")),
        lambda parts, poses: float(
            (parts.origin("base.point", poses) - parts.origin("lid.plane", poses)) @ parts.z("lid.plane", poses)
        ),
    ),
    "angle": (
        Measured(AngleSpec.reads, ("base.axis", "lid.plane")),
        lambda parts, poses: math.acos(float(parts.z("base.axis", poses) @ parts.z("lid.plane", poses))),
    ),
    "signed angle": (
        Measured(AngleSpec.reads, ("lid.axis", "base.plane"), ALONG),
        lambda parts, poses: math.atan2(
            poses["lid"][:3, :3] @ ALONG @ np.cross(parts.z("lid.axis", poses), parts.z("base.plane", poses)),
            float(parts.z("lid.axis", poses) @ parts.z("base.plane", poses)),
        ),
    ),
    "size": (Measured(InspectedSizeSpec.reads, ("lid.axis",)), lambda parts, poses: parts.size("lid.axis")),
    "difference": (
        Measured(
            GapSpec.reads, ("base.point", "lid.point"), X, minus=Measured(GapSpec.reads, ("base.point", "lid.axis"), Y)
        ),
        lambda parts, poses: float(
            (parts.origin("lid.point", poses) - parts.origin("base.point", poses)) @ poses["base"][:3, 0]
            - (parts.origin("lid.axis", poses) - parts.origin("base.point", poses)) @ poses["base"][:3, 1]
        ),
    ),
}


@pytest.mark.parametrize("name", EXACT)
def test_slopes_between_parts_are_those_of_finite_poses(name: str) -> None:
    draft, moves = lid_on_base()
    draft.size("lid.axis")
    measured, exact = EXACT[name]
    assembly = draft.assembly(moves, {name: measured})

    def read(deviations: Array) -> float:
        parts = RigidParts(assembly, deviations, {})
        return exact(parts, parts.poses())

    found = slopes(assembly, name, *np.zeros((2, assembly.width)))
    assert found.nominal == pytest.approx(read(np.zeros(assembly.width)), abs=1e-10)
    assert found.bends == ()
    for direction in np.random.default_rng(0).normal(size=(3, assembly.width)):
        expected = directional(read, direction)
        assert found.coefficients @ direction == pytest.approx(expected, abs=1e-8 * np.abs(found.coefficients).sum())


def test_points_that_nominally_coincide_are_as_far_apart_as_their_displacements() -> None:
    """No slope at 0: the length of the displacements, of which 0.3 of nominal distance is a part."""
    draft = Draft()
    draft.part("part")
    draft.feature("part.feature", (5, 5, 5))
    draft.feature("part.zero", (5, 5, 5), deviates=False)
    draft.feature("part.beside", (5.3, 5, 5), deviates=False)
    measured = Measured(DistanceSpec.reads, ("part.zero", "part.feature"))
    assert one(draft, measured, x=0.03, y=-0.04) == pytest.approx(0.05, abs=1e-15)
    assert one(draft, Measured(DistanceSpec.reads, ("part.beside", "part.feature")), y=0.4) == pytest.approx(
        0.5, abs=1e-15
    )


def test_axes_that_are_nominally_parallel_make_the_angle_of_their_tilts() -> None:
    draft = Draft()
    draft.part("part")
    draft.feature("part.feature", frame((0, 0, 0), Z, X), Axis(40.0))
    draft.feature("part.up", frame((30, 0, 0), Z), Axis(40.0), deviates=False)
    draft.feature("part.down", frame((30, 0, 0), -Z), Axis(40.0), deviates=False)
    tilt = math.hypot(0.3, 0.4) / 40.0
    for name, expected in (("up", tilt), ("down", math.pi - tilt)):
        found = one(draft, Measured(AngleSpec.reads, (f"part.{name}", "part.feature")), end_x=0.3, end_y=0.4)
        assert found == pytest.approx(expected, abs=1e-15)


# inspected ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("shape", "given", "position", "orientation"),
    [
        # height at a corner: offset and both rises; range over the corners: twice the rises
        (Plane((100.0, 60.0)), {"offset": -0.02, "rise_x": 0.01, "rise_y": -0.03}, 2 * 0.06, 2 * 0.04),
        # the rises are those of x and y; over the rim they add as a vector
        (RoundPlane(40.0), {"offset": 0.02, "rise_x": 0.03, "rise_y": -0.04}, 2 * 0.07, 2 * 0.05),
        (
            Axis(40.0),
            {"start_x": 0.03, "start_y": 0.04, "end_x": -0.06, "end_y": 0.08},
            2 * 0.1,
            math.hypot(0.09, 0.04),
        ),
    ],
)
def test_positions_are_twice_the_largest_distance_and_orientations_ranges(
    shape: Plane | RoundPlane | Axis, given: dict[str, float], position: float, orientation: float
) -> None:
    draft = Draft()
    draft.part("part")
    draft.feature("part.feature", frame((7, -4, 20), (1, 2, 3)), shape)
    assert one(draft, Measured(InspectedPositionSpec.reads, ("part.feature",)), **given) == pytest.approx(
        position, abs=1e-13
    )
    assert one(draft, Measured(InspectedOrientationSpec.reads, ("part.feature",)), **given) == pytest.approx(
        orientation, abs=1e-13
    )


def test_a_point_is_inspected_in_space_or_across_a_direction() -> None:
    draft = Draft()
    draft.part("part")
    draft.feature("part.feature", frame((7, -4, 20), Z, X))
    given = {"x": 0.02, "y": -0.03, "z": 0.06}
    assert one(draft, Measured(InspectedPositionSpec.reads, ("part.feature",)), **given) == pytest.approx(
        2 * 0.07, abs=1e-15
    )
    across = Measured(InspectedPositionSpec.reads, ("part.feature",), Y)
    assert one(draft, across, **given) == pytest.approx(2 * math.hypot(0.02, 0.06), abs=1e-15)


def test_what_is_toleranced_to_a_datum_frame_is_inspected_in_it_without_its_deviation() -> None:
    draft = Draft()
    draft.part("part")
    draft.feature("part.a", frame((0, 0, 0), -Z), Plane((90, 70)))
    draft.feature("part.bore", frame((10, 20, 5), Z), Axis(10.0))
    name = draft.datum_frame("part", Datum(("part.a",)), Datum(("part.bore",)))
    draft.feature("part.feature", frame((60, 30, 8), (0, 1, 1)), Axis(30.0), parent=name)
    measured = Measured(InspectedPositionSpec.reads, ("part.feature",), frame=name)
    assembly = draft.assembly(
        (), {"value": measured, "in the part": Measured(InspectedPositionSpec.reads, ("part.feature",))}
    )
    rng = np.random.default_rng(3)
    trials = rng.normal(size=(20, assembly.width)) * 0.1
    own = trials[:, draft.columns.index("part.feature start x") :][:, :4]
    expected = 2 * np.maximum(np.hypot(own[:, 0], own[:, 1]), np.hypot(own[:, 2], own[:, 3]))
    found = values(assembly, trials, ["value", "in the part"])
    np.testing.assert_allclose(found["value"], expected, atol=1e-12)
    assert np.abs(found["in the part"] - expected).min() > 1e-3


@pytest.mark.parametrize(
    "places",
    [
        [(-100, -60), (100, -60), (100, 60), (-100, 60)],  # problem 7: half the double difference
        [(0, 0), (50, 0), (100, 0), (0, 40), (50, 40), (100, 40), (30, 90)],  # three in a line, and a mean row
        [(0, 0), (80, 0), (80, 0), (20, 60), (40, 20)],  # two at one place, one inside
    ],
)
def test_flatness_is_the_least_width_between_parallel_planes(places: list[tuple[float, float]]) -> None:
    """Against a linear programme: t such that all heights are within a plane and one t above it."""
    draft = Draft()
    draft.part("part", turned((0.3, 0.1, -0.8), (5, 6, 7)))
    normal = np.array([0.0, -0.6, 0.8])
    base = frame((10, 0, 0), normal)
    names = tuple(draft.feature(f"part.{k}", base @ frame((x, y, 0))) for k, (x, y) in enumerate(places))
    assembly = draft.assembly((), {"flatness": Measured(InspectedFlatnessSpec.reads, names, normal)})
    heights = np.random.default_rng(4).normal(size=(25, len(places))) * 0.05
    deviations = np.zeros((25, assembly.width))
    deviations[:, 2::3] = heights
    found = values(assembly, deviations, ["flatness"])["flatness"]
    rows = np.array([[1.0, x, y] for x, y in places])
    nil, ones = np.zeros((len(places), 1)), np.ones((len(places), 1))
    for own, value in zip(heights, found, strict=True):
        sides = np.block([[rows, nil], [-rows, -ones]])
        best = linprog([0, 0, 0, 1], sides, np.concatenate([own, -own]), bounds=[(None, None)] * 4)
        assert value == pytest.approx(best.fun, abs=1e-9)
    if len(places) == 4:
        np.testing.assert_allclose(found, np.abs(heights @ [1, -1, 1, -1]) / 2, atol=1e-13)


def test_points_that_are_drawn_off_their_plane_have_a_flatness_nominally() -> None:
    draft = Draft()
    draft.part("part")
    places = [(-50, -30, 0.02), (50, -30, 0), (50, 30, 0), (-50, 30, 0)]
    names = tuple(draft.feature(f"part.{k}", place) for k, place in enumerate(places))
    assembly = draft.assembly((), {"flatness": Measured(InspectedFlatnessSpec.reads, names, Z)})
    found = values(assembly, draft.trial({"part.2 z": 0.06}), ["flatness"])["flatness"][0]
    assert found == pytest.approx((0.02 + 0.06) / 2, abs=1e-15)


def test_a_direction_is_fixed_in_a_datum_frame_of_the_trial() -> None:
    """A face tilts the frame by 0.1 / 50; what lies 40 across the direction is seen so much longer."""
    draft = Draft()
    draft.part("part")
    draft.feature("part.a", frame((0, 0, 0), Z, X), Plane((100, 60)))
    name = draft.datum_frame("part", Datum(("part.a",)))
    draft.feature("part.zero", (0, 0, 0), deviates=False)
    draft.feature("part.far", (40, 0, 30), deviates=False)
    gaps = {"in it": Measured(GapSpec.reads, ("part.zero", "part.far"), Z, frame=name)}
    gaps["in the part"] = Measured(GapSpec.reads, ("part.zero", "part.far"), Z)
    assembly = draft.assembly((), gaps)
    found = values(assembly, draft.trial({"part.a rise x": 0.1}), list(gaps))
    assert found["in it"][0] == pytest.approx(30.0 - 40 * 0.1 / 50, abs=1e-12)
    assert found["in the part"][0] == 30.0


def test_contributions_to_a_feature_add_up_though_they_share_columns() -> None:
    draft = Draft()
    draft.part("part")
    draft.feature("part.feature", (5, 0, 0))
    draft.feature("part.zero", (0, 0, 0), deviates=False)
    own = draft.features["part.feature"]
    draft.features["part.feature"] = replace(own, moved_by=(*own.moved_by, *own.moved_by))
    assert one(draft, displacement("part.feature", Z, "part.zero"), z=0.25) == 0.5


def test_flatness_of_too_many_points_is_refused() -> None:
    draft = Draft()
    draft.part("part")
    names = tuple(draft.feature(f"part.{k}", (k, k * k, 0)) for k in range(21))
    with pytest.raises(InputError, match="flatness of 21 points; expected 20 at most"):
        first_order(draft.assembly((), {"flatness": Measured(InspectedFlatnessSpec.reads, names, Z)}))


# slopes ---------------------------------------------------------------------------------------------


def test_slopes_say_what_is_not_linear_and_by_which_vectors() -> None:
    """Position of a point across z: columns x and y act as 2 |(x, y)|, z not at all."""
    draft = Draft()
    draft.part("part")
    draft.feature("part.feature", frame((7, -4, 20), Z, X))
    draft.feature("part.zero", (0, 0, 0), deviates=False)
    one = Measured(InspectedPositionSpec.reads, ("part.feature",), Z)
    shift = displacement("part.feature", X, "part.zero")
    assembly = draft.assembly((), {"difference": replace(one, minus=shift), "one": one})
    means, sigmas = np.array([0.3, 0.0, 0.0]), np.array([0.1, 0.4, 0.2])
    found = slopes(assembly, "difference", means, sigmas)
    assert found.bent == (0, 1)
    assert found.nominal == pytest.approx(-7.0)
    assert found.at_means == pytest.approx(0.6 - 7.3)
    # mean slopes from one sigma below to one above: x by 2 less 1 of the difference, y by the symmetry not
    np.testing.assert_allclose(found.coefficients, [2.0 - 1.0, 0.0, 0.0], atol=1e-12)
    (bend,) = found.bends
    assert bend.form == "largest length"
    assert bend.vectors is not None
    trials = np.random.default_rng(5).normal(size=(9, 3))
    lengths = np.linalg.norm(bend.vectors[0, :, :3] @ trials.T + bend.vectors[0, :, 3:], axis=0)
    np.testing.assert_allclose(bend.weights[0] * lengths, values(assembly, trials, ["one"])["one"], atol=1e-13)


def test_a_datum_that_is_touched_by_its_corner_bends_what_is_measured_from_it() -> None:
    """A secondary's height is its offset and the amount of its rise; a mean decides which side acts."""
    draft = Draft()
    draft.part("part")
    draft.feature("part.a", frame((0, 0, 0), -Z), Plane((90, 70)), deviates=False)
    draft.feature("part.feature", frame((0, 0, 10), -Y, X), Plane((80, 20)))
    name = draft.datum_frame("part", Datum(("part.a",)), Datum(("part.feature",)))
    draft.feature("part.zero", (0, 0, 0), deviates=False)
    draft.feature("part.far", (0, 50, 0), parent=name, deviates=False)
    assembly = draft.assembly((), {"y": displacement("part.far", Y, "part.zero")})
    rise = draft.columns.index("part.feature rise y")
    for mean, expected in ((0.2, -1.0), (-0.2, 1.0), (0.0, 0.0), (0.05, -0.5)):
        found = slopes(assembly, "y", mean * np.eye(assembly.width)[rise], np.full(assembly.width, 0.1))
        assert found.coefficients[rise] == pytest.approx(expected, abs=1e-12)
        assert rise in found.bent


def test_a_position_in_a_datum_frame_that_is_touched_by_a_corner_bends_twice() -> None:
    """The frame's height is its offset and the amount of a rise; a fixed point is as far off, twice that is read."""
    draft = Draft()
    draft.part("part")
    draft.feature("part.a", frame((0, 0, 0), -Z), Plane((90, 70)), deviates=False)
    draft.feature("part.feature", frame((0, 0, 10), -Y, X), Plane((80, 20)))
    name = draft.datum_frame("part", Datum(("part.a",)), Datum(("part.feature",)))
    draft.feature("part.far", (0, 50, 0), deviates=False)
    measured = Measured(InspectedPositionSpec.reads, ("part.far",), frame=name)
    for offset, rise in ((0.02, 0.03), (0.02, -0.03), (-0.05, 0.03), (-0.01, -0.03)):
        expected = 2 * abs(offset + abs(rise))
        assert one(draft, measured, offset=offset, rise_y=rise) == pytest.approx(expected, abs=1e-15)
    assembly = draft.assembly((), {"position": measured})
    found = slopes(assembly, "position", np.zeros(assembly.width), np.full(assembly.width, 0.1))
    columns = [draft.columns.index(f"part.feature {name}") for name in ("offset", "rise y")]
    inner, outer = found.bends
    assert (inner.columns, inner.weights.tolist(), outer.weights.tolist()) == ((columns[1],), [0.0], [2.0])
    assert outer.vectors is None
    assert set(columns) <= set(outer.columns)


def test_first_orders_pickle_and_keep_their_bits() -> None:
    draft, moves = lid_on_base()
    measures = {name: measured for name, (measured, _) in EXACT.items()}
    own = first_order(draft.assembly(moves, measures))
    copied = pickle.loads(pickle.dumps(own))
    trials = np.random.default_rng(0).normal(size=(10, own.width)) * 0.1
    for name, found in own.values(trials, list(measures)).items():
        np.testing.assert_array_equal(copied.values(trials, [name])[name], found)


def test_an_assembly_without_deviations_has_its_nominal_values() -> None:
    """Also no trials, no measures, and a distance from a point to itself."""
    draft = Draft()
    draft.part("part")
    draft.feature("part.a", (0, 0, 0), deviates=False)
    draft.feature("part.b", (3, 4, 0), Axis(10.0, 5.0), deviates=False)
    measures = {"distance": ("part.a", "part.b"), "none": ("part.a", "part.a")}
    own = first_order(draft.assembly((), {name: Measured(DistanceSpec.reads, of) for name, of in measures.items()}))
    found = own.values(np.zeros((2, 0)), ["distance", "none"])
    np.testing.assert_array_equal([found["distance"], found["none"]], [[5.0, 5.0], [0.0, 0.0]])
    assert own.values(np.zeros((2, 0)), []) == {}
    assert len(own.values(np.zeros((0, 0)), ["none"])["none"]) == 0
    assert own.slopes("none", np.zeros(0), np.zeros(0)).bends == ()


def test_a_measure_after_a_move_sees_the_parts_as_it_left_them() -> None:
    draft, moves = lid_on_base()
    last = Measured(GapSpec.reads, ("base.point", "lid.point"), X)
    before = Measured(GapSpec.reads, ("base.point", "lid.point"), X, after=0)
    assembly: Assembly = draft.assembly(moves, {"last": last, "before": before, "no move": last})
    found = {name: slopes(assembly, name, *np.zeros((2, assembly.width))).coefficients for name in ("last", "before")}
    locators = [draft.columns.index(f"lid.{k} x") for k in range(6)]
    assert np.abs(found["last"][locators]).max() > 0.1
    assert not found["before"][locators].any()
    own = draft.columns.index("lid.point x")
    assert found["last"][own] == pytest.approx(found["before"][own], abs=1e-12)
