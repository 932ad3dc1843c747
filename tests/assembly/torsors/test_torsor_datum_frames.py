"""Datum frames on the analytic method, against closed forms and worked levers."""

import math

import numpy as np
import pytest
from assembly.drafts import Draft, coefficients, displacement, frame
from numpy.typing import NDArray

from tol3d.assembly.grammar.measures.gap import GapSpec
from tol3d.assembly.grammar.measures.inspected import InspectedPositionSpec
from tol3d.assembly.model import Assembly, Axis, Datum, Measured, Plane, RoundPlane
from tol3d.assembly.model.datum_frame import Simulator
from tol3d.assembly.torsors.method import values
from tol3d.errors import InputError

Array = NDArray[np.float64]

X, Y, Z = np.eye(3)


def test_a_hole_inspected_on_varying_datums_moves_against_them() -> None:
    """Problem 15: two targets of a side at x = 20 and 180, one of an end at y = 50; a turn moves the hole in x too."""
    draft = Draft()
    draft.part("plate")
    draft.feature("plate.bottom", frame((100, 50, 0), -Z), Plane((200, 100)), deviates=False)
    draft.feature("plate.side", frame((100, 0, 0), -Y, X), Plane((160, 10)))
    draft.feature("plate.end", frame((0, 50, 0), -X), Plane((40, 10)))
    hole = draft.feature("plate.hole", frame((150, 60, 0)), Axis(20))
    side = Datum(("plate.side",), "targets", np.array([[-80, 0, 0], [80, 0, 0]], float))
    name = draft.datum_frame("plate", Datum(("plate.bottom",)), side, Datum(("plate.end",), "fitted"))
    assembly = draft.assembly((), {"position": Measured(InspectedPositionSpec.reads, (hole,), frame=name)})
    b1, b2, c, ex, ey = 0.03, 0.07, 0.02, 0.01, -0.005  # b and c into the material: heights are their opposites
    given = {"plate.side offset": -(b1 + b2) / 2, "plate.side rise x": -(b2 - b1) / 2, "plate.end offset": -c}
    given |= {f"plate.hole {end} {axis}": e for end in ("start", "end") for axis, e in (("x", ex), ("y", ey))}
    dx = ex - c + (60 - 50) / 160 * (b2 - b1)
    dy = ey - 0.1875 * b1 - 0.8125 * b2
    found = values(assembly, draft.trial(given), ["position"])["position"][0]
    assert found == pytest.approx(2.0 * math.hypot(dx, dy), abs=1e-12)
    # P(position > 0.30): of two normals with this covariance, by quadrature over the angle
    variance_x = 0.04**2 + 0.02**2 + 2 * (10 / 160 * 0.03) ** 2
    variance_y = 0.04**2 + (0.1875**2 + 0.8125**2) * 0.03**2
    covariance = 10 / 160 * (0.1875 - 0.8125) * 0.03**2
    across = np.linalg.inv([[variance_x, covariance], [covariance, variance_y]])
    angles = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
    along = np.array([np.cos(angles), np.sin(angles)])
    forms = np.einsum("ik,ij,jk->k", along, across, along)
    expected = float(np.mean(np.exp(-0.5 * 0.15**2 * forms) / forms) * math.sqrt(np.linalg.det(across)))
    assert expected == pytest.approx(0.0049780, abs=1e-7)  # as the paper prints it
    count, rng = 400_000, np.random.default_rng(15)
    targets, deviations = rng.normal(0.0, 0.03, (count, 2)), np.zeros((count, assembly.width))
    for column, drawn in (
        ("plate.side offset", -targets.mean(axis=1)),
        ("plate.side rise x", -(targets[:, 1] - targets[:, 0]) / 2),
        ("plate.end offset", rng.normal(0.0, 0.02, count)),
    ):
        deviations[:, draft.columns.index(column)] = drawn
    for axis in "xy":
        drawn = rng.normal(0.0, 0.04, count)
        for end in ("start", "end"):
            deviations[:, draft.columns.index(f"plate.hole {end} {axis}")] = drawn
    outside = values(assembly, deviations, ["position"])["position"] > 0.30
    assert outside.mean() == pytest.approx(expected, abs=4 * math.sqrt(expected * (1 - expected) / count))


def bracket(simulator: Simulator) -> tuple[Draft, Assembly]:
    """A plate whose three sides deviate; A of 100 x 60, B of 100 x 20, C of 60 x 20; their frame is read at a point."""
    draft = Draft()
    draft.part("block")
    draft.feature("block.a", frame((50, 30, 0), -Z, X), Plane((100, 60)))
    draft.feature("block.b", frame((50, 0, 10), -Y, X), Plane((100, 20)))
    draft.feature("block.c", frame((0, 30, 10), -X, Y), Plane((60, 20)))
    targets = {"block.b": [[-50, 0, 0], [50, 0, 0]], "block.c": [[0, 0, 0]]}
    datums = [Datum((name,), simulator, np.array(points, float)) for name, points in targets.items()]
    name = draft.datum_frame("block", Datum(("block.a",)), *datums)
    draft.feature("block.zero", (0, 0, 0), deviates=False)
    draft.feature("block.far", (100, 60, 20), parent=name, deviates=False)
    measures = dict(zip("xyz", [displacement("block.far", axis, "block.zero") for axis in np.eye(3)], strict=True))
    return draft, draft.assembly((), measures)


def test_fitted_datums_take_a_normal_then_a_height_each_what_is_left() -> None:
    """Worked by hand: A turns about x and y and lifts, B turns about z and shifts along y, C shifts along x.

    Normals point down, to -y and to -x: an offset moves the frame so. The turn of A carries the middles of B and C.
    """
    draft, assembly = bracket("fitted")
    rng = np.random.default_rng(5)
    given = dict(zip(draft.columns, rng.normal(size=len(draft.columns)), strict=True))
    # z of A is the opposite of its height; its x runs along x, its y along -y
    slope_x, slope_y = -given["block.a rise x"] / 50.0, given["block.a rise y"] / 30.0
    slope_b = -given["block.b rise x"] / 50.0  # of y of B along x
    turn = np.array([slope_y, -slope_x, slope_b])
    # displacement of a point: shift + turn x point; the shift is such that heights are met at the middles of the faces
    shift = np.zeros(3)
    shift[2] = -given["block.a offset"] - np.cross(turn, [50, 30, 0])[2]
    shift[1] = -given["block.b offset"] - np.cross(turn, [50, 0, 10])[1]
    shift[0] = -given["block.c offset"] - np.cross(turn, [0, 30, 10])[0]
    expected = np.array([100, 60, 20]) + shift + np.cross(turn, [100, 60, 20])
    found = values(assembly, draft.trial(given), ["x", "y", "z"])
    np.testing.assert_allclose([found[axis][0] for axis in "xyz"], expected, atol=1e-12)


def test_a_plane_that_is_held_in_its_orientation_touches_by_its_outermost_corner() -> None:
    """Uniform in a zone of 0.1: of a secondary the turn about one direction is left, of a tertiary none.

    The rise of each is the largest amount of two or four corners; means 0.0125 and 0.0250, sigmas 0.0185 and 0.0194.
    """
    draft, assembly = bracket("contact")
    rng = np.random.default_rng(11)
    count = 200_000
    sides = rng.dirichlet(np.ones(4), size=2 * count)[:, :3] * rng.choice([-1, 1], size=(2 * count, 3)) * 0.05
    deviations = np.zeros((count, assembly.width))
    for name, rows in (("b", sides[:count]), ("c", sides[count:])):
        first = draft.columns.index(f"block.{name} offset")
        deviations[:, first : first + 3] = rows
    found = values(assembly, deviations, ["x", "y"])
    (b_offset, b_rise_x, b_rise_y), (c_offset, c_rise_x, c_rise_y) = sides[:count].T, sides[count:].T
    # B turns the frame by the slope of its y along x, and lifts it by its corner that stands out in its height
    turn, height = -b_rise_x / 50.0, b_offset + np.abs(b_rise_y)
    np.testing.assert_allclose(found["y"], 60.0 - height + 50.0 * turn, atol=1e-12)
    # the slope of x of C along y would be met by a turn of its opposite; less that turn it tilts
    tilt = c_rise_x / 30.0 - turn
    middle = c_offset + np.abs(tilt) * 30.0 + np.abs(c_rise_y)
    np.testing.assert_allclose(found["x"], 100.0 - middle - 30.0 * turn, atol=1e-12)
    tertiary = c_offset + np.abs(c_rise_x) + np.abs(c_rise_y)  # of a frame that does not turn
    for own, mean, sigma in ((height, 0.0125, 0.0185), (tertiary, 0.0250, 0.0194)):
        assert own.mean() == pytest.approx(mean, abs=4 * sigma / math.sqrt(count))
        assert own.std() == pytest.approx(sigma, abs=1e-4)  # 3 standard errors and what was left out by rounding


def test_targets_take_heights_at_points() -> None:
    """Two targets at the ends of B and one at the middle of C: lever arms as of locators."""
    draft, assembly = bracket("targets")
    given = {"block.b offset": 0.03, "block.b rise x": 0.01, "block.b rise y": 0.5, "block.c offset": 0.02}
    found = values(assembly, draft.trial(given), ["x", "y", "z"])
    # heights of B at its ends x = -50 and +50 are 0.03 -+ 0.01; its rise along y is not seen
    at_0, at_100 = -0.02, -0.04
    assert found["y"][0] == pytest.approx(60.0 + at_100, abs=1e-12)
    assert found["x"][0] == pytest.approx(100.0 - 0.02 - (at_100 - at_0) / 100.0 * (60.0 - 30.0), abs=1e-12)
    assert found["z"][0] == 20.0


def test_a_pattern_of_two_holes_is_a_line_through_both_centres() -> None:
    """Common datum after a face: across at the middle, then the azimuth; nothing decides along the line."""
    draft = Draft()
    draft.part("plate")
    face = draft.feature("plate.a", frame((0, 0, 0)), RoundPlane(90.0), deviates=False)
    holes = [draft.feature(f"plate.hole {k}", frame((x, 40, 5)), Axis(10)) for k, x in enumerate((20, 120))]
    name = draft.datum_frame("plate", Datum((face,)), Datum(tuple(holes)))
    draft.feature("plate.zero", (0, 0, 0), deviates=False)
    draft.feature("plate.far", (120, 90, 0), parent=name, deviates=False)
    assembly = draft.assembly(
        (), {a: Measured(GapSpec.reads, ("plate.zero", "plate.far"), n) for a, n in (("x", X), ("y", Y))}
    )
    given = {"plate.hole 0 start y": 0.02, "plate.hole 0 end y": 0.04, "plate.hole 1 end y": 0.02}
    given |= {"plate.hole 1 start x": 7.0, "plate.hole 1 end x": 7.0}
    found = values(assembly, draft.trial(given), ["x", "y"])
    turn = (0.01 - 0.03) / 100.0
    assert found["y"][0] == pytest.approx(90.0 + 0.01, abs=1e-12)
    # along the line the frame stays: the middle between the holes, 50 mm below the point, does not shift in x
    assert found["x"][0] == pytest.approx(120.0 - turn * 50.0, abs=1e-12)


def test_a_second_hole_turns_the_frame_whatever_its_distance() -> None:
    draft = Draft()
    draft.part("plate")
    face = draft.feature("plate.a", frame((0, 0, 0)), RoundPlane(90.0), deviates=False)
    holes = [draft.feature(f"plate.hole {k}", frame((x, 40, 5)), Axis(10)) for k, x in enumerate((20, 120))]
    name = draft.datum_frame("plate", Datum((face,)), *(Datum((hole,)) for hole in holes))
    slot = draft.feature("plate.slot", frame((20, 140, 5)), Axis(10))
    assembly = draft.assembly((), {"slot": Measured(InspectedPositionSpec.reads, (slot,), frame=name)})
    given = {"plate.hole 1 start y": 0.05, "plate.hole 1 end y": 0.05, "plate.hole 1 start x": 3.0}
    given |= {"plate.hole 1 end x": 3.0, "plate.hole 0 start y": 0.01, "plate.hole 0 end y": 0.01}
    turn = (0.05 - 0.01) / 100.0
    expected = 2.0 * math.hypot(turn * 100.0, -0.01)  # the slot stays, the frame turns by this about hole 0 and shifts
    assert values(assembly, draft.trial(given), ["slot"])["slot"][0] == pytest.approx(expected, abs=1e-12)
    assert not coefficients(assembly, "slot").any()  # central: a largest length that is nil at the mean


def test_a_datum_that_takes_nothing_is_refused() -> None:
    draft = Draft()
    draft.part("plate")
    for name, height in (("a", 0), ("b", 20)):
        draft.feature(f"plate.{name}", frame((0, 0, height)), Plane((40, 30)))
    draft.datum_frame("plate", Datum(("plate.a",)), Datum(("plate.b",)))
    measured = Measured(InspectedPositionSpec.reads, ("plate.a",), frame="plate|a|b")
    with pytest.raises(InputError, match=r"datum frame plate\|a\|b: plate\.b takes no freedom"):
        values(draft.assembly((), {"position": measured}), np.zeros((1, 6)), ["position"])
