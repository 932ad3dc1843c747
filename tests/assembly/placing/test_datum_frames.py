"""Datum frames of the same trial."""

from collections.abc import Sequence

import numpy as np
import pytest
from assembly.placing.built_by_numbers import Columns, assembly, feature, frame, part
from assembly.placing.rigid_search import solved_pose
from numpy.typing import NDArray

from tol3d.assembly.grammar.measures.gap import GapSpec
from tol3d.assembly.grammar.measures.inspected import InspectedPositionSpec
from tol3d.assembly.model import Axis, Datum, DatumFrame, Feature, Fix, Measured, Plane, Point, Shape
from tol3d.assembly.placing.method import placed, values
from tol3d.errors import InputError

Array = NDArray[np.float64]


def displacement(features: Sequence[Feature], columns: Columns, datums: Sequence[Datum], row: Array) -> Array:
    """Displacement of the frame of some datums of a part `p` (4, 4): from three of its points, along x, y and z."""
    frame_of = DatumFrame("p|ABC", "p", tuple(datums))
    tips = [(0, 0, 0), (100, 0, 0), (0, 100, 0), (0, 0, 100)]
    carried = [feature(f"p.tip {k}", Point(), frame(tip), (), "p|ABC") for k, tip in enumerate(tips)]
    nothing = feature("p.origin", Point(), frame((0, 0, 0)))
    axes = [(k, axis) for k in range(4) for axis in range(3)]
    gaps = {f"{k}{axis}": Measured(GapSpec.reads, ("p.origin", f"p.tip {k}"), np.eye(3)[axis]) for k, axis in axes}
    made = assembly(columns, [part("p", [*features, *carried, nothing], [frame_of])], [Fix("p", "p")], gaps)
    read = values(made, row[None], list(gaps))
    at = np.array([[read[f"{k}{axis}"][0][0] for axis in range(3)] for k in range(4)])
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = (at[1:] - at[0]).T / 100, at[0]
    return found


def height(plane: Array, deviation: Array, x: float, y: float, reach: tuple[float, float]) -> Array:
    """A point of a plane that deviates by offset and rises, in its part."""
    z = deviation[0] + deviation[1] * x / reach[0] + deviation[2] * y / reach[1]
    return np.asarray(plane[:3, :3] @ (x, y, z) + plane[:3, 3])


FACES = (
    frame((100, 50, 0), (0, 0, -1), (1, 0, 0)),
    frame((100, 0, 20), (0, -1, 0), (1, 0, 0)),
    frame((0, 50, 20), (-1, 0, 0), (0, 1, 0)),
)
EXTENTS = ((200.0, 100.0), (200.0, 40.0), (100.0, 40.0))
CORNERS = ((1, 1), (-1, 1), (-1, -1), (1, -1))


def block(columns: Columns) -> list[Feature]:
    """Bottom, side and end of a block, which deviate."""
    return [
        feature(f"p.{name}", Plane(extent), face, [columns(count=3)])
        for name, face, extent in zip("ABC", FACES, EXTENTS, strict=True)
    ]


@pytest.mark.parametrize("simulator", ["contact", "fitted"])
def test_three_planes_lie_on_their_simulators(simulator: str) -> None:
    """The frame takes simulators to: A flush; B square to A and touching with its outermost corner, or its centre."""
    columns = Columns()
    features = block(columns)
    row = np.random.default_rng(0).normal(0, 1.0, 9)  # far more than tolerances, so that nothing small is left out
    datums = [Datum(("p.A",)), *(Datum((f"p.{name}",), simulator) for name in "BC")]  # type: ignore[arg-type]
    found = displacement(features, columns, datums, row)

    actual = [row[3 * k : 3 * k + 3] for k in range(3)]
    reaches = [(a / 2, b / 2) for a, b in EXTENTS]
    points = [
        np.array([height(FACES[k], actual[k], x * a, y * b, reaches[k]) for x, y in (*CORNERS, (0, 0))])
        for k, (a, b) in enumerate(reaches)
    ]
    in_frame = [(each - found[:3, 3]) @ found[:3, :3] for each in points]
    heights = [(each - face[:3, 3]) @ face[:3, 2] for each, face in zip(in_frame, FACES, strict=True)]
    np.testing.assert_allclose(heights[0], 0, atol=1e-12)
    for k in (1, 2):
        touching = heights[k][:4].max() if simulator == "contact" else heights[k][4]
        assert touching == pytest.approx(0, abs=1e-12)
    along_x = in_frame[1][0] - in_frame[1][1]  # of B: what lies in A's plane is square to it
    tilted = in_frame[1][0] - in_frame[1][3]
    normal = np.cross(along_x, tilted)
    assert normal[0] == pytest.approx(0, abs=1e-9 * abs(normal[1]))
    np.testing.assert_allclose(found[:3, :3].T @ found[:3, :3], np.eye(3), atol=1e-12)


@pytest.mark.parametrize(
    ("place", "simulator", "mean", "sigma"),
    [("BC", "fitted", 0.0, 0.0158), ("BC", "contact", 0.0125, 0.0185), ("CB", "contact", 0.0250, 0.0194)],
)
def test_a_tilted_plane_in_a_flat_zone_shifts_its_frame_by_its_simulator(
    place: str, simulator: str, mean: float, sigma: float
) -> None:
    """Zone of 0.1: half its width w uniform in |w| + |rise x| + |rise y| <= 0.05; A and the third are perfect."""
    random = np.random.default_rng(1)
    drawn = random.uniform(-0.05, 0.05, (120_000, 3))
    drawn = drawn[np.abs(drawn).sum(axis=1) <= 0.05]
    columns = Columns()
    moved = columns(count=3)
    features = [
        feature("p.A", Plane(EXTENTS[0]), FACES[0]),
        feature("p.B", Plane(EXTENTS[1]), FACES[1], [moved]),
        feature("p.C", Plane(EXTENTS[2]), FACES[2]),
        feature("p.origin", Point(), frame((0, 0, 0))),
        # beside the middle of B, where a turn about z does not shift it: B is then seen from there
        feature("p.tip", Point(), frame((100, 0, 20)), (), "p|ABC"),
    ]
    order = [Datum(("p.A",)), *(Datum((f"p.{name}",), simulator) for name in place)]  # type: ignore[arg-type]
    tip = Measured(GapSpec.reads, ("p.origin", "p.tip"), np.array([0.0, -1.0, 0.0]))
    made = assembly(
        columns, [part("p", features, [DatumFrame("p|ABC", "p", tuple(order))])], [Fix("p", "p")], {"tip": tip}
    )
    shift, _ = values(made, drawn, ["tip"])["tip"]
    error = sigma / np.sqrt(len(drawn))
    # published to half a unit of its last digit, and four standard errors
    assert shift.mean() == pytest.approx(mean, abs=5e-5 + 4 * error)
    assert shift.std() == pytest.approx(sigma, abs=5e-5 + 4 * error)


def test_position_in_a_frame_of_targets_as_by_plane_geometry() -> None:
    """Perfect primary, side on two targets, end on one: the frame is drawn with a line through two points."""
    columns = Columns()
    # heights at the targets, positive into the material: offset and rise of the plane through them
    through = np.array([[-0.5, -0.5], [0.5 * 100 / 80, -0.5 * 100 / 80], [0.0, 0.0]])
    features = [
        feature("p.A", Plane(EXTENTS[0]), FACES[0]),
        feature("p.B", Plane(EXTENTS[1]), FACES[1], [columns(through)]),
        feature("p.C", Plane(EXTENTS[2]), FACES[2], [columns(np.array([[-1.0], [0], [0]]))]),
        feature("p.hole", Point(), frame((150, 60, 0)), [columns(np.eye(3)[:, :2])]),
    ]
    datums = (
        Datum(("p.A",)),
        Datum(("p.B",), "targets", np.array([[-80.0, 0, 0], [80.0, 0, 0]])),
        Datum(("p.C",), "targets", np.array([[0.0, 0, 0]])),
    )
    position = Measured(InspectedPositionSpec.reads, ("p.hole",), np.array([0.0, 0, 1]), "p|ABC")
    made = assembly(columns, [part("p", features, [DatumFrame("p|ABC", "p", datums)])], (), {"position": position})
    rows = np.random.default_rng(2).normal(0, 1.0, (100, 5)) * (0.3, 0.3, 0.2, 0.4, 0.4)
    found, codes = values(made, rows, ["position"])["position"]

    b1, b2, c, ex, ey = rows.T
    first, second = np.stack([np.full(100, 20.0), b1], 1), np.stack([np.full(100, 180.0), b2], 1)
    along = (second - first) / np.linalg.norm(second - first, axis=1)[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], 1)
    hole, end = np.stack([150 + ex, 60 + ey], 1), np.stack([c, np.full(100, 50.0)], 1)
    x, y = np.sum((hole - end) * along, axis=1), np.sum((hole - first) * across, axis=1)
    np.testing.assert_array_equal(codes, 0)
    np.testing.assert_allclose(found, 2 * np.hypot(x - 150, y - 60), atol=1e-12)


def test_position_out_of_tolerance_as_often_as_by_quadrature() -> None:
    """P(distance > 0.15) = 0.0049780 in the trial's own frame; in the machine's 0.000884, 5.6 times less."""
    columns = Columns()
    through = np.array([[-0.5, -0.5], [0.5 * 100 / 80, -0.5 * 100 / 80], [0.0, 0.0]])
    features = [
        feature("p.A", Plane(EXTENTS[0]), FACES[0]),
        feature("p.B", Plane(EXTENTS[1]), FACES[1], [columns(through)]),
        feature("p.C", Plane(EXTENTS[2]), FACES[2], [columns(np.array([[-1.0], [0], [0]]))]),
        feature("p.hole", Point(), frame((150, 60, 0)), [columns(np.eye(3)[:, :2])]),
    ]
    datums = (Datum(("p.A",)), Datum(("p.B",), "fitted"), Datum(("p.C",), "fitted"))
    position = Measured(InspectedPositionSpec.reads, ("p.hole",), np.array([0.0, 0, 1]), "p|ABC")
    made = assembly(columns, [part("p", features, [DatumFrame("p|ABC", "p", datums)])], (), {"position": position})
    n = 200_000
    rows = np.random.default_rng(3).normal(0, 1.0, (n, 5)) * (0.03, 0.03, 0.02, 0.04, 0.04)
    found, _ = values(made, rows, ["position"])["position"]
    # exact turns: 0.004947 +- 0.000035; four standard errors of this sample
    assert np.mean(found > 0.30) == pytest.approx(0.00496, abs=4 * np.sqrt(0.005 / n))


AXES: tuple[tuple[str, Shape, Array], ...] = (
    ("A", Plane((200.0, 100.0)), FACES[0]),
    ("B", Axis(20.0, 10.0), frame((30, 20, 10), (0, 0, 1), (1, 0, 0))),
    ("C", Axis(20.0, 10.0), frame((170, 60, 10), (0, 0, 1), (1, 0, 0))),
)


def ends(at: Array, deviation: Array, length: float) -> tuple[Array, Array]:
    """Ends of an axis that deviates, in its part."""
    start, end = ([*deviation[:2], -length / 2], [*deviation[2:], length / 2])
    return at[:3, :3] @ start + at[:3, 3], at[:3, :3] @ end + at[:3, 3]


def test_a_plane_and_two_holes() -> None:
    """The second hole's centre comes to the nominal direction from the first."""
    columns = Columns()
    features = [feature(f"p.{n}", s, at, [columns(count=len(s.components))]) for n, s, at in AXES]
    row = np.random.default_rng(4).normal(0, 0.5, 11)
    found = displacement(features, columns, [Datum((f"p.{name}",)) for name in "ABC"], row)
    flat = [height(FACES[0], row[:3], x, y, (100, 50)) for x, y in ((100, 50), (-100, 50), (-100, -50))]
    first, second = (
        np.mean(ends(at, each, 20.0), axis=0) for (_, _, at), each in zip(AXES[1:], (row[3:7], row[7:11]), strict=True)
    )

    def lacking(turn: Array, shift: Array) -> Array:
        """The inverse of the displacement takes the part's features to their nominal places."""
        seen = np.array([*flat, first, second]) @ turn.T + shift
        line, nominal = seen[4] - seen[3], np.array([140.0, 40.0])
        return np.array([*seen[:3, 2], *(seen[3, :2] - (30, 20)), (line[0] * nominal[1] - line[1] * nominal[0]) / 140])

    np.testing.assert_allclose(np.linalg.inv(found), solved_pose(lacking, np.eye(4)), atol=2e-11)


def test_an_axis_then_a_plane_then_a_hole() -> None:
    columns = Columns()
    features = [feature(f"p.{n}", s, at, [columns(count=len(s.components))]) for n, s, at in AXES]
    row = np.random.default_rng(5).normal(0, 0.5, 11)
    found = displacement(features, columns, [Datum((f"p.{name}",), "fitted") for name in "BAC"], row)
    middle = height(FACES[0], row[:3], 0, 0, (100, 50))
    (start, end), other = ends(AXES[1][2], row[3:7], 20.0), np.mean(ends(AXES[2][2], row[7:11], 20.0), axis=0)

    def lacking(turn: Array, shift: Array) -> Array:
        seen = np.array([start, end, other, middle]) @ turn.T + shift
        line, nominal = seen[2] - (seen[0] + seen[1]) / 2, np.array([140.0, 40.0])
        across = (line[0] * nominal[1] - line[1] * nominal[0]) / 140
        return np.array([*(seen[0, :2] - (30, 20)), *(seen[1, :2] - (30, 20)), across, seen[3, 2]])

    np.testing.assert_allclose(np.linalg.inv(found), solved_pose(lacking, np.eye(4)), atol=2e-11)


def test_a_common_datum_is_the_line_through_two_centres() -> None:
    """For two bearing seats, the line through their middles comes to the nominal one, its middle stays there."""
    columns = Columns()
    seats = [
        feature(f"p.{name}", Axis(20.0), frame((x, 0, 0), (1, 0, 0)), [columns(count=4)])
        for name, x in (("A", 10.0), ("B", 110.0))
    ]
    row = np.random.default_rng(6).normal(0, 0.5, 8)
    found = displacement(seats, columns, [Datum(("p.A", "p.B"))], row)
    centres = np.array(
        [np.mean(ends(each.frame, row[4 * k : 4 * k + 4], 20.0), axis=0) for k, each in enumerate(seats)]
    )
    seen = (centres - found[:3, 3]) @ found[:3, :3]
    np.testing.assert_allclose(seen[1, 1:] - seen[0, 1:], 0, atol=1e-12)
    np.testing.assert_allclose(seen.mean(axis=0)[1:], 0, atol=1e-12)
    # what nothing takes: no turn about the line by the least rotation, no shift along it of the middle
    turn = (centres[1] - centres[0]) / np.linalg.norm(centres[1] - centres[0])
    assert turn[0] == pytest.approx((np.trace(found[:3, :3]) - 1) / 2, abs=1e-12)  # the cosine of both angles
    assert seen.mean(axis=0)[0] == pytest.approx(60, abs=1e-12)


def test_a_datum_that_takes_nothing_is_refused() -> None:
    columns = Columns()
    features = [*block(columns), feature("p.top", Plane(EXTENTS[0]), frame((100, 50, 40)))]
    with pytest.raises(InputError, match="top takes no freedom"):
        displacement(features, columns, [Datum((f"p.{name}",)) for name in ("A", "B", "top")], np.zeros(9))


def test_targets_of_a_primary_plane_that_lie_on_a_line_are_refused() -> None:
    columns = Columns()
    targets = np.array([[-80.0, -10, 0], [0, 0, 0], [80, 10, 0]])
    with pytest.raises(InputError, match=r"targets of its primary datum p\.A lie on a line"):
        displacement(block(columns), columns, [Datum(("p.A",), "targets", targets)], np.zeros(9))


def test_poses_do_not_need_measures() -> None:
    made = assembly(Columns(), [part("p", [])], [Fix("p", "p")])
    np.testing.assert_array_equal(placed(made, np.zeros((2, 0)))["p"], np.broadcast_to(np.eye(4), (2, 4, 4)))
