"""Measures of features as they lie in their trials, after any move."""

from collections.abc import Mapping

import numpy as np
import pytest
from assembly.placing.built_by_numbers import Columns, assembly, feature, frame, moved_as_a_whole, pair, part, posed
from numpy.typing import NDArray
from of_kind import of_kind
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from tol3d.assembly.grammar.measures.gap import AngleSpec, DistanceSpec, GapSpec, PointPlaneSpec
from tol3d.assembly.grammar.measures.inspected import (
    InspectedFlatnessSpec,
    InspectedOrientationSpec,
    InspectedPositionSpec,
    InspectedSizeSpec,
)
from tol3d.assembly.model import (
    Assembly,
    Axis,
    Datum,
    DatumFrame,
    Feature,
    Fix,
    Locate,
    Mate,
    Measured,
    Move,
    Plane,
    Point,
    Relation,
    RoundPlane,
    Weld,
)
from tol3d.assembly.model.measures import Reading
from tol3d.assembly.model.statuses import NO_CONTACT, OK
from tol3d.assembly.placing.method import placed, values
from tol3d.errors import InputError

Array = NDArray[np.float64]

X, Y, Z = np.eye(3)


def read(made: Assembly, row: Array) -> dict[str, float]:
    """All measures in one trial."""
    return {name: float(found[0]) for name, (found, _) in values(made, row[None], list(made.measures)).items()}


def two_parts(measures: Mapping[str, Measured]) -> tuple[Assembly, Array, tuple[Array, Array]]:
    """Two parts that are fixed askew, with a point, a plane and an axis each; deviations; poses."""
    random = np.random.default_rng(0)
    columns = Columns()
    poses = posed((0.3, -0.4, 0.8), (10, 20, 30)), posed((-0.2, 0.5, 0.1), (60, -10, 45))
    parts = []
    for name, pose in zip("ab", poses, strict=True):
        features = [
            feature(f"{name}.point", Point(), posed(random.normal(size=3), (5, 3, 2)), [columns(count=3)]),
            feature(f"{name}.plane", Plane((40.0, 20.0)), posed(random.normal(size=3), (-5, 3, 7)), [columns(count=3)]),
            feature(f"{name}.axis", Axis(30.0, 8.0), posed(random.normal(size=3), (1, -3, 2)), [columns(count=4)]),
        ]
        parts.append(part(name, features, pose=pose))
    moves: list[Move] = [Fix("a", "a"), Fix("b", "b")]
    return assembly(columns, parts, moves, measures), random.normal(0, 0.5, columns.width), poses


def by_hand(made: Assembly, row: Array, name: str) -> tuple[Array, Array]:
    """Origin and z of a feature in the world."""
    its = made.features[name]
    own = row[its.moved_by[0].columns]
    pose = made.part[its.part].pose @ its.frame
    if isinstance(its.shape, Axis):
        middle, z = np.array([*(own[:2] + own[2:]) / 2, 0]), [*(own[2:] - own[:2]) / its.shape.length, 1]
    elif isinstance(its.shape, Plane):
        a, b = its.shape.extent
        middle, z = np.array([0, 0, own[0]]), [-own[1] / (a / 2), -own[2] / (b / 2), 1]
    else:
        middle, z = own, [0, 0, 1]
    direction = pose[:3, :3] @ z
    return pose[:3, :3] @ middle + pose[:3, 3], direction / np.linalg.norm(direction)


def test_measures_between_two_parts() -> None:
    about = np.array([2.0, -1, 0.5]) / np.linalg.norm([2.0, -1, 0.5])
    measures = {
        "distance": Measured(DistanceSpec.reads, ("a.point", "b.axis")),
        "gap": Measured(GapSpec.reads, ("a.point", "b.axis"), about),
        "height": Measured(PointPlaneSpec.reads, ("b.point", "a.plane")),
        "angle": Measured(AngleSpec.reads, ("a.plane", "b.axis")),
        "signed": Measured(AngleSpec.reads, ("a.plane", "b.axis"), about),
    }
    measures["difference"] = Measured(GapSpec.reads, ("a.point", "b.axis"), about, minus=measures["angle"])
    made, row, (pose, _) = two_parts(measures)
    found = read(made, row)
    a, z_a = by_hand(made, row, "a.plane")
    b, z_b = by_hand(made, row, "b.axis")
    point, start = (by_hand(made, row, name)[0] for name in ("b.point", "a.point"))
    normal = pose[:3, :3] @ about
    assert found["distance"] == pytest.approx(np.linalg.norm(b - start), abs=1e-12)
    assert found["gap"] == pytest.approx((b - start) @ normal, abs=1e-12)
    assert found["height"] == pytest.approx((point - a) @ z_a, abs=1e-12)
    assert found["angle"] == pytest.approx(np.arccos(z_a @ z_b), abs=1e-13)
    assert found["signed"] == pytest.approx(np.arctan2(normal @ np.cross(z_a, z_b), z_a @ z_b), abs=1e-13)
    assert found["difference"] == pytest.approx(found["gap"] - found["angle"], abs=1e-15)


def test_where_an_assembly_lies_changes_no_measure() -> None:
    measures = {
        spec.reads.name: Measured(spec.reads, ("a.point", "b.plane"), direction)
        for spec, direction in ((DistanceSpec, None), (GapSpec, Y), (PointPlaneSpec, None), (AngleSpec, X))
    }
    made, row, _ = two_parts(measures)
    elsewhere = read(moved_as_a_whole(made, posed((1.2, 0.3, -2.0), (500, 20, -70))), row)
    assert elsewhere == pytest.approx(read(made, row), abs=1e-12)


KINDS: tuple[Reading, ...] = (InspectedPositionSpec.reads, InspectedOrientationSpec.reads)


def inspected(shape: Axis | Plane | RoundPlane | Point, size: int) -> tuple[Assembly, Array]:
    """A feature on a plate whose bottom tilts, measured in the frame of that bottom and in the part's."""
    columns = Columns()
    at = posed((0.2, 0.1, -0.3), (30, 20, 10))
    features = [
        feature("p.A", Plane((100.0, 60.0)), frame((0, 0, 0), (0, 0, -1), (1, 0, 0)), [columns(count=3)]),
        feature("p.it", shape, at, [columns(count=size)]),
    ]
    both = {"": "", " in A": "p|A"}
    measures = {
        f"{kind.name}{words}": Measured(kind, ("p.it",), None, name) for kind in KINDS for words, name in both.items()
    }
    measures["across"] = Measured(InspectedPositionSpec.reads, ("p.it",), X)
    plate = part("p", features, [DatumFrame("p|A", "p", (Datum(("p.A",)),))])
    return assembly(columns, [plate], (), measures), at


def frame_of(row: Array) -> Array:
    """Frame of the tilted bottom (4, 4): least rotation from its nominal normal, and the place of its middle."""
    normal = np.array([0, 0, -1.0]) - np.array([row[1] / 50, -row[2] / 30, 0])
    normal /= np.linalg.norm(normal)
    axis = np.cross((0, 0, -1), normal)
    angle = np.arcsin(np.linalg.norm(axis))
    found = np.eye(4)
    found[:3, :3] = Rotation.from_rotvec(axis / np.linalg.norm(axis) * angle).as_matrix()
    found[:3, 3] = 0, 0, -row[0]
    return found


@pytest.mark.parametrize(
    ("shape", "size"), [(Axis(40.0), 4), (Plane((30.0, 20.0)), 3), (RoundPlane(15.0), 3), (Point(), 3)]
)
def test_inspected_features(shape: Axis | Plane | RoundPlane | Point, size: int) -> None:
    made, at = inspected(shape, size)
    row = np.random.default_rng(1).normal(0, 0.2, made.width)
    found, own = read(made, row), row[3:]
    if isinstance(shape, Axis):
        nominal = np.array([[0, 0, -20.0], [0, 0, 20]])
        actual = np.array([[*own[:2], -20], [*own[2:], 20]])
    elif isinstance(shape, Point):
        nominal, actual = np.zeros((1, 3)), own[None]
    else:
        rim = 15 * np.array([[1, 0], [0, 1], [-1, 0], [0, -1.0]])
        corners = np.array([[15, 10], [15, -10], [-15, 10], [-15, -10.0]])
        flat = rim if isinstance(shape, RoundPlane) else corners
        reach = (15, 15) if isinstance(shape, RoundPlane) else (15, 10)
        nominal = np.column_stack([flat, np.zeros(len(flat))])
        actual = np.column_stack([flat, own[0] + flat @ (own[1:] / reach)])
    for words, displaced in (("", np.eye(4)), (" in A", frame_of(row))):
        there = actual @ at[:3, :3].T + at[:3, 3]
        seen = (there - displaced[:3, 3]) @ displaced[:3, :3]
        apart = (seen - nominal @ at[:3, :3].T - at[:3, 3]) @ at[:3, :3]
        heights = seen @ at[:3, :3]
        if isinstance(shape, Axis):
            position, orientation = np.hypot(*apart[:, :2].T).max(), np.hypot(*(heights[1] - heights[0])[:2])
        elif isinstance(shape, Point):
            position, orientation = np.linalg.norm(apart[0]), 0.0
        elif isinstance(shape, Plane):
            position, orientation = np.abs(apart[:, 2]).max(), np.ptp(heights[:, 2])
        else:  # heights of a rim are a cosine about the middle's
            waves = [np.hypot(z[0] - z[2], z[1] - z[3]) / 2 for z in (apart[:, 2], heights[:, 2])]
            position, orientation = abs(apart[:, 2].mean()) + waves[0], 2 * waves[1]
        assert found[f"position{words}"] == pytest.approx(2 * position, abs=1e-11)
        assert found[f"orientation{words}"] == pytest.approx(orientation, abs=1e-11)
    if not isinstance(shape, RoundPlane):
        aside = (actual - nominal) @ at[:3, :3].T
        assert found["across"] == pytest.approx(2 * np.hypot(aside[:, 1], aside[:, 2]).max(), abs=1e-12)


def test_size_is_nominal_size_and_its_deviations() -> None:
    columns = Columns()
    bore = Feature("p.bore", "p", Axis(10.0, 20.0, inner=True), np.eye(4), size_by=(columns(np.ones((1, 1))),))
    made = assembly(columns, [part("p", [bore])], (), {"size": Measured(InspectedSizeSpec.reads, ("p.bore",))})
    found, _ = values(made, np.array([[0.02], [-0.01]]), ["size"])["size"]
    np.testing.assert_allclose(found, [20.02, 19.99], atol=1e-14)


def flat_points(points: Array) -> Assembly:
    """Points of a part that deviate, and their flatness."""
    columns = Columns()
    features = [feature(f"p.{k}", Point(), frame(point), [columns(count=3)]) for k, point in enumerate(points)]
    flat = Measured(InspectedFlatnessSpec.reads, tuple(f"p.{k}" for k in range(len(points))), Z)
    return assembly(columns, [part("p", features)], (), {"flat": flat})


def test_flatness_of_four_pads_is_half_of_what_they_lack() -> None:
    """|h1 - h2 + h3 - h4| / 2, times the cosine of the tilt; P(> 0.1) = 2 Phi(-2) for pads of sigma 0.05."""
    pads = np.array([[-100, -60, 0], [100, -60, 0], [100, 60, 0], [-100, 60, 0]], dtype=float)
    made, n = flat_points(pads), 100_000
    heights = np.random.default_rng(2).normal(0, 0.05, (n, 4))
    rows = np.zeros((n, 12))
    rows[:, 2::3] = heights
    flat, _ = values(made, rows, ["flat"])["flat"]
    # planes tilt by less than 0.3 / 60 here: their cosine takes 1.3e-5 of it
    np.testing.assert_allclose(flat, np.abs(heights @ (1, -1, 1, -1)) / 2, rtol=2e-5, atol=1e-12)
    assert np.mean(flat > 0.1) == pytest.approx(0.0455003, abs=4 * np.sqrt(0.0455 / n))


@pytest.mark.parametrize("seed", range(5))
def test_flatness_is_the_least_width_over_all_directions(seed: int) -> None:
    random = np.random.default_rng(seed)
    points = np.column_stack([random.uniform(-50, 50, (6, 2)), np.zeros(6)])
    offsets = random.normal(0, 0.3, (6, 3))
    found = read(flat_points(points), offsets.ravel())["flat"]
    actual = points + offsets

    def width(slopes: Array) -> float:
        return float(np.ptp(actual @ [*slopes, 1.0]) / np.sqrt(1 + slopes @ slopes))

    starts = random.normal(0, 0.01, (30, 2))
    tight = {"xatol": 1e-13, "fatol": 1e-13, "maxiter": 4000, "maxfev": 4000}
    searched = min(minimize(width, each, method="Nelder-Mead", options=tight).fun for each in starts)
    assert found == pytest.approx(searched, abs=1e-9)
    assert found <= searched + 1e-12


def subassembly(after: int) -> Assembly:
    """A lid on a box, welded; the box then goes into a nest; the lid's tip is read from the nest."""
    columns = Columns()
    nest = (
        ((20, 15, 0), Z),
        ((180, 15, 0), Z),
        ((100, 90, 0), Z),
        ((30, 0, 25), Y),
        ((170, 0, 25), Y),
        ((0, 50, 20), X),
    )
    ground = [feature(f"nest.{k}", Point(), frame(at), [columns(count=3)]) for k, (at, _) in enumerate(nest)]
    ground.append(feature("nest.origin", Point(), frame((0, 0, 0))))
    face = Plane((200.0, 100.0))
    # the third locator rides on the lid
    box = [feature(f"box.{k}", Point(), frame(at)) for k, (at, _) in enumerate(nest) if k != 2]
    box += [feature("box.top", face, frame((100, 50, 40)), [columns(count=3)])]
    lid = [
        feature("lid.2", Point(), frame((100, 90, 0)), [columns(count=3)]),
        feature("lid.under", face, frame((100, 50, 40), (0, 0, -1), X), [columns(count=3)]),
        feature("lid.tip", Point(), frame((150, 70, 60))),
    ]
    pairs = tuple(pair(f"{'lid' if k == 2 else 'box'}.{k}", f"nest.{k}", normal) for k, (_, normal) in enumerate(nest))
    moves: list[Move] = [
        Fix("nest", "nest"),
        Fix("box", "box"),
        Mate("close", "lid", (Relation("coincident", "lid.under", "box.top"),)),
        Weld("weld", "box", ("lid",)),
        Locate("load", "box", pairs),
    ]
    height = Measured(GapSpec.reads, ("nest.origin", "lid.tip"), Z, after=after)
    return assembly(columns, [part("nest", ground), part("box", box), part("lid", lid)], moves, {"tip": height})


def test_a_welded_body_moves_as_one_on_features_of_all_its_parts() -> None:
    made = subassembly(-1)
    row = np.random.default_rng(6).normal(0, 0.3, made.width)
    poses = {name: each[0] for name, each in placed(made, row[None]).items()}
    closed = subassembly(2)
    before = read(closed, row)["tip"]
    alone = assembly(Columns(), closed.parts, closed.moves[:3])
    lid = placed(Assembly(alone.parts, alone.moves, {}, made.width), row[None])["lid"][0]
    np.testing.assert_allclose(np.linalg.inv(poses["box"]) @ poses["lid"], lid, atol=1e-12)
    assert before == pytest.approx(float(lid[2] @ (150, 70, 60, 1)), abs=1e-12)
    assert read(made, row)["tip"] == pytest.approx(float(poses["lid"][2] @ (150, 70, 60, 1)), abs=1e-12)
    for each in of_kind(Locate, made.moves[-1]).pairs:
        moving, target = made.features[each.moving], made.features[each.target]
        own = row[moving.moved_by[0].columns] if moving.moved_by else np.zeros(3)
        reached = (poses[moving.part] @ [*(moving.frame[:3, 3] + moving.frame[:3, :3] @ own), 1.0])[:3]
        asked = target.frame[:3, 3] + target.frame[:3, :3] @ row[target.moved_by[0].columns]
        assert each.normal @ (reached - asked) == pytest.approx(0, abs=1e-12)


def test_a_measure_fails_with_the_moves_that_placed_what_it_reads_and_no_others() -> None:
    """Two arms swing to walls; a third part stands on the second arm."""
    columns = Columns()
    base: list[Feature] = [feature("base.floor", Plane((400.0, 100.0)), frame((100, 40, 0)))]
    parts, moves = [], list[Move]([Fix("base", "base")])
    for name, x in (("one", 20.0), ("two", 220.0)):
        base.append(feature(f"base.pin {name}", Axis(20.0), frame((x, 30, 0))))
        base.append(
            feature(f"base.wall {name}", Plane((50.0, 50.0)), frame((x, 70, 0), Y), [columns(np.eye(3)[:, :1])])
        )
        arm = [
            feature(f"{name}.under", Plane((50.0, 50.0)), frame((x + 30, 40, 0), -Z)),
            feature(f"{name}.hole", Axis(20.0), frame((x, 30, 0))),
            feature(f"{name}.tip", Point(), frame((x + 30, 70, 0))),
        ]
        relations = (
            Relation("coincident", f"{name}.under", "base.floor"),
            Relation("coaxial", f"{name}.hole", f"base.pin {name}"),
            Relation("coincident", f"{name}.tip", f"base.wall {name}"),
        )
        parts.append(part(name, arm))
        moves.append(Mate(name, name, relations))
    rider = [feature("rider.foot", Point(), frame((250, 70, 0)), [columns(count=3)])]
    parts.append(part("rider", rider))
    moves.append(Mate("ride", "rider", (Relation("coincident", "rider.foot", "two.tip"),)))
    measures = {
        name: Measured(GapSpec.reads, ("base.floor", f"{name}.{at}"), Y)
        for name, at in (("one", "tip"), ("two", "tip"), ("rider", "foot"))
    }
    measures["both"] = Measured(GapSpec.reads, ("one.tip", "rider.foot"), Y)
    measures["own"] = Measured(InspectedPositionSpec.reads, ("rider.foot",))
    made = assembly(columns, [part("base", base), *parts], moves, measures)
    rows = np.zeros((3, columns.width))
    rows[1, 0], rows[2, 1] = 40.0, 40.0  # the first wall too far, the second
    codes = {name: list(each) for name, (_, each) in values(made, rows, list(measures)).items()}
    assert codes["one"] == [OK, NO_CONTACT, OK]
    assert codes["two"] == [OK, OK, NO_CONTACT]
    assert codes["rider"] == [OK, OK, NO_CONTACT]
    assert codes["both"] == [OK, NO_CONTACT, NO_CONTACT]
    assert codes["own"] == [OK, OK, OK]


def test_a_measure_of_a_part_that_no_move_places_is_refused() -> None:
    made, _, _ = two_parts({"gap": Measured(GapSpec.reads, ("a.point", "b.point"), X)})
    loose = assembly(Columns(), made.parts, made.moves[:1], made.measures)
    with pytest.raises(InputError, match=r"measures\.gap: b is not placed"):
        values(loose, np.zeros((1, made.width)), ["gap"])
