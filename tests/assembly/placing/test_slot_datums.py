"""Slots and tabs as datums: by hand, and against a builder of datum frames that knows linear programmes alone."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import pytest
from assembly.drafts import Draft, displacement, frame
from assembly.placing.rigid_search import solved_pose
from numpy.typing import NDArray
from scipy.linalg import null_space
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from tol3d.assembly.model import Assembly, Axis, Datum, Fix, Plane, Shape, Slot
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.placing.nominal_constraints import held_by_datums, in_words
from tol3d.assembly.torsors import method as torsors
from tol3d.errors import InputError

Array = NDArray[np.float64]

X, Y, Z = np.eye(3)
TIPS = np.array([[0, 0, 0], [100, 0, 0], [0, 100, 0], [0, 0, 100]], float)

SHAPES: dict[str, tuple[Array, Shape]] = {
    "floor": (frame((60, 40, 0), -Z, X), Plane((120, 80))),
    "side": (frame((60, 0, 10), -Y, X), Plane((110, 16))),
    "bore": (frame((20, 25, 10), Z, X), Axis(20.0, 12.0, inner=True)),
    "hole": (frame((95, 60, 10), Z, X), Axis(20.0, 8.0, inner=True)),
    "slot": (frame((100, 25, 10), Y, X), Slot((30.0, 20.0), 8.0)),  # its length along x, towards the bore
    "tab": (frame((40, 70, 10), X, Y), Slot((14.0, 20.0), 6.0, inner=False)),
    "groove": (frame((25, 25, 10), Y, X), Slot((50.0, 20.0), 5.0)),  # across the bore
}


def drawn(names: Sequence[str], shapes: Mapping[str, tuple[Array, Shape]] = SHAPES) -> tuple[Draft, Assembly]:
    """A plate with these features as datums in order, and where four points lie in their frame."""
    draft = Draft()
    draft.part("p")
    for name in shapes:
        draft.feature(f"p.{name}", *shapes[name])
    held = draft.datum_frame("p", *(Datum((f"p.{name}",)) for name in names))
    draft.feature("p.zero", (0, 0, 0), deviates=False)
    measures = {}
    for k, tip in enumerate(TIPS):
        draft.feature(f"p.tip {k}", tip, parent=held, deviates=False)
        for axis, along in zip("xyz", np.eye(3), strict=True):
            measures[f"{k}{axis}"] = displacement(f"p.tip {k}", along, "p.zero")
    return draft, draft.assembly((Fix("fix", "p"),), measures)


def first_order(assembly: Assembly, row: Array) -> Array:
    """Shift and turn (6,) of the frame, by the analytic method."""
    found = torsors.values(assembly, row, list(assembly.measures))
    at = np.array([[found[f"{k}{axis}"][0] for axis in "xyz"] for k in range(4)])
    moved = at - TIPS
    turn = np.array([moved[2, 2] - moved[0, 2], moved[3, 0] - moved[0, 0], moved[1, 1] - moved[0, 1]]) / 100
    return np.array([*moved[0], *turn])


def exactly(assembly: Assembly, row: Array) -> Array:
    """Pose (4, 4) of the frame, by the exact method."""
    read = placing.values(assembly, row, list(assembly.measures))
    assert all((codes == OK).all() for _, codes in read.values())
    at = np.array([[read[f"{k}{axis}"][0][0] for axis in "xyz"] for k in range(4)])
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = (at[1:] - at[0]).T / 100, at[0]
    return found


def angle_about_z(pose: Array) -> float:
    return math.atan2(pose[1, 0], pose[0, 0])


# by hand -----------------------------------------------------------------------------------------------------


def test_a_slot_after_a_plane_and_a_bore_clocks_the_part_by_its_place() -> None:
    """0.2 mm across, 80 mm from the bore, turn the frame by 2.5 mrad; a lean of 0.1 on 15 turns nothing."""
    draft, assembly = drawn(["floor", "bore", "slot"])
    shifted, leans = draft.trial({"p.slot offset": 0.2}), draft.trial({"p.slot rise x": 0.1, "p.slot rise y": -0.05})
    assert first_order(assembly, shifted)[5] == pytest.approx(0.2 / 80, abs=1e-12)
    assert angle_about_z(exactly(assembly, shifted)) == pytest.approx(math.atan(0.2 / 80), abs=1e-12)
    assert first_order(assembly, leans) == pytest.approx(np.zeros(6), abs=1e-12)
    assert exactly(assembly, leans) == pytest.approx(np.eye(4), abs=1e-12)


def test_a_slot_after_a_plane_holds_the_turn_by_its_lean_and_the_shift_by_its_middle() -> None:
    """Its middle, whatever it leans: walls that close in on it from both sides are not shifted by a corner."""
    draft, assembly = drawn(["floor", "slot"])
    row = draft.trial({"p.slot offset": 0.2, "p.slot rise x": 0.1, "p.slot rise y": -0.05})
    found = first_order(assembly, row)
    turn = 0.1 / 15  # about z: +x rises towards +y
    assert found[5] == pytest.approx(turn, abs=1e-12)
    # the middle of the slot, at (100, 25), keeps 0.2 along y and shifts by nothing along x
    assert found[:2] == pytest.approx([25 * turn, 0.2 - 100 * turn], abs=1e-12)


def test_a_slot_across_the_bore_clocks_the_part_by_its_lean() -> None:
    """Its middle lies 5 mm from the bore, its ends 25 from its middle: walls that close in decide by its ends."""
    draft, assembly = drawn(["floor", "bore", "groove"])
    leans, shifted = draft.trial({"p.groove rise x": 0.1}), draft.trial({"p.groove offset": 0.1})
    assert first_order(assembly, leans)[5] == pytest.approx(0.1 / 25, abs=1e-12)
    assert angle_about_z(exactly(assembly, leans)) == pytest.approx(math.atan(0.1 / 25), abs=1e-12)
    assert first_order(assembly, shifted)[5] == pytest.approx(0.0, abs=1e-12)


def test_a_slot_through_which_the_turn_goes_is_held_by_its_place_alone() -> None:
    """A tab whose middle lies as far from a bore as its end from its middle: by its place on both methods."""
    draft = Draft()
    draft.part("p")
    for name in ("floor", "bore"):
        draft.feature(f"p.{name}", *SHAPES[name])
    draft.feature("p.open", frame((50, 25, 10), Y, X), Slot((60.0, 20.0), 8.0))
    held = draft.datum_frame("p", *(Datum((f"p.{name}",)) for name in ("floor", "bore", "open")))
    draft.feature("p.zero", (0, 0, 0), deviates=False)
    draft.feature("p.tip", (120, 25, 0), parent=held, deviates=False)
    assembly = draft.assembly((Fix("fix", "p"),), {"y": displacement("p.tip", Y, "p.zero")})
    row = draft.trial({"p.open offset": 0.03, "p.open rise x": 0.2})
    assert torsors.values(assembly, row, ["y"])["y"][0] == pytest.approx(25 + 0.03 * 100 / 30, abs=1e-12)
    assert placing.values(assembly, row, ["y"])["y"][0][0] == pytest.approx(25 + 0.1, abs=2e-5)


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["floor", "bore", "slot"], ["z, turns x, y", "x, y", "turns z"]),
        (["floor", "slot", "tab"], ["z, turns x, y", "y, turns z", "x"]),
        (["slot", "bore"], ["y, turns x, z", "x, turns y"]),
    ],
)
def test_check_lists_what_a_slot_takes(names: list[str], expected: list[str]) -> None:
    _, assembly = drawn(names)
    (held,) = assembly.datum_frames.values()
    assert [in_words(own) for own in held_by_datums(assembly, held).taken] == expected


def test_a_slot_that_takes_nothing_is_refused() -> None:
    for names in (["floor", "bore", "hole", "slot"], ["floor", "slot", "groove"]):
        _, assembly = drawn(names)
        with pytest.raises(InputError, match="takes no freedom"):
            placing.values(assembly, np.zeros((1, assembly.width)), ["0x"])
        with pytest.raises(InputError, match="takes no freedom"):
            torsors.values(assembly, np.zeros((1, assembly.width)), ["0x"])


# drafts at random --------------------------------------------------------------------------------------------


class Builder:
    """A datum frame to first order: of motions q (6,) of the part that earlier datums leave, the best of each.

    What is best, of the displaced part on its simulators: least squares of what a plane's tilts, an axis's centre and
    tilts lack; of a slot the smallest largest distance of its corners from its nominal median plane.
    """

    def __init__(self) -> None:
        self.q, self.left = np.zeros(6), np.eye(6)
        self.turn, self.shift = np.zeros(3), np.zeros(3)

    def hold(self, rows: Array) -> None:
        self.left = self.left @ null_space(self.acting(rows), rcond=1e-9)

    def acting(self, rows: Array) -> Array:
        found = rows @ self.left
        return np.where(np.abs(found) < 1e-9, 0.0, found)  # rounding is no lever

    def squares(self, rows: Array, off: Array) -> None:
        self.q = self.q - self.left @ np.linalg.lstsq(self.acting(rows), off + rows @ self.q, rcond=1e-9)[0]
        self.hold(rows)

    def closing_in(self, rows: Array, off: Array) -> None:
        acts = null_space(null_space(self.acting(rows), rcond=1e-9).T)  # the motions that matter
        a, b = self.acting(rows) @ acts, off + rows @ self.q
        ones = np.ones((len(rows), 1))
        scale = np.linalg.norm(a, axis=0)
        found = linprog(
            [*np.zeros(a.shape[1]), 1.0],
            np.block([[a / scale, -ones], [-a / scale, -ones]]),
            np.concatenate([-b, b]),
            bounds=[(None, None)] * a.shape[1] + [(0, None)],
        )
        assert found.success
        self.q = self.q + self.left @ acts @ (found.x[:-1] / scale)
        self.hold(rows)

    def turned_about(self, centre: Array) -> None:
        """Let what has turned since the last datum turn about a centre: what is left may shift the part to that."""
        turns = np.hstack([np.zeros((3, 3)), np.eye(3)])
        least = self.q[3:] - turns @ self.left @ np.linalg.pinv(self.acting(turns), rcond=1e-9) @ self.q[3:]
        self.shift = self.shift + np.cross(centre, least - self.turn)
        self.turn = least

    def displaced(self) -> Array:
        """The frame's own motion: the opposite, with the least turn and the shifts to it where nothing asks."""
        self.squares(np.eye(6)[3:], np.zeros(3))
        self.squares(np.eye(6)[:3], -self.shift)
        return -self.q


def row_of(point: Array, direction: Array) -> Array:
    return np.array([*direction, *np.cross(point, direction)])


def built(names: Sequence[str], shapes: Mapping[str, tuple[Array, Shape]], deviations: dict[str, Array]) -> Array:
    """The frame's motion (6,)."""
    builder = Builder()
    for k, name in enumerate(names):
        at, shape = shapes[name]
        (x, y, z, origin), moved = at[:3, :4].T, deviations[name]
        tilts = np.array([[*np.zeros(3), *x], [*np.zeros(3), *y]])
        if isinstance(shape, Axis):
            middle, lean = (moved[:2] + moved[2:]) / 2, (moved[2:] - moved[:2]) / shape.length
            builder.squares(np.array([row_of(origin, x), row_of(origin, y)]), middle)
            builder.squares(tilts, np.array([-lean[1], lean[0]]))
            builder.turned_about(origin)
            continue
        assert isinstance(shape, Plane)
        a, b = shape.reach
        ends = [(sx, sy) for sx in (1, -1) for sy in (1, -1)]
        corners = np.array([row_of(origin + sx * a * x + sy * b * y, z) for sx, sy in ends])
        heights = np.array([moved @ (1, sx, sy) for sx, sy in ends])
        if isinstance(shape, Slot):
            builder.closing_in(corners, heights)
            builder.turned_about(origin)
            continue
        builder.squares(tilts, np.array([moved[2] / b, -moved[1] / a]))
        height = row_of(origin, z)[None]
        if np.abs(height @ builder.left).max(initial=0.0) > 1e-9:
            outermost = (heights + corners @ builder.q - height @ builder.q).max() if k else moved[0]
            builder.squares(height, np.array([outermost]))
        builder.turned_about(origin)
    return builder.displaced()


ORDERS = [
    ["floor", "bore", "slot"],
    ["floor", "bore", "groove"],
    ["floor", "bore", "tab"],
    ["floor", "hole", "slot"],
    ["floor", "bore", "hole"],
    ["floor", "bore", "side"],
    ["floor", "side", "tab"],
    ["floor", "side", "bore"],
    ["floor", "slot", "tab"],
    ["floor", "tab", "bore"],
    ["floor", "slot"],
    ["slot", "floor", "tab"],
    ["slot", "tab", "floor"],
    ["slot", "bore"],
    ["bore", "slot"],
    ["bore", "groove", "floor"],
    ["bore", "floor", "tab"],
    ["bore", "hole", "floor"],
]


@pytest.mark.parametrize("names", ORDERS, ids="|".join)
def test_random_drafts_lie_as_an_independent_builder_lays_them(names: list[str]) -> None:
    """The analytic method to rounding; the exact one to second order: slopes up to 0.03 / 5 squared, over 100 mm."""
    rng = np.random.default_rng(len("".join(names)))
    for _ in range(4):
        shapes = anywhere(rng)
        draft, assembly = drawn(names, shapes)
        row = rng.normal(0.0, 0.01, (1, assembly.width))
        own = dict(zip(draft.columns, row[0], strict=True))
        moved = {n: np.array([own[f"p.{n} {c}"] for c in SHAPES[n][1].components]) for n in names}
        expected = built(names, shapes, moved)
        found = first_order(assembly, row)
        np.testing.assert_allclose(found[:3], expected[:3], atol=1e-9)
        np.testing.assert_allclose(found[3:], expected[3:], atol=1e-11)
        pose = exactly(assembly, row)
        turn = np.array([pose[2, 1] - pose[1, 2], pose[0, 2] - pose[2, 0], pose[1, 0] - pose[0, 1]]) / 2
        np.testing.assert_allclose(turn, expected[3:], atol=4e-5)
        np.testing.assert_allclose(pose[:3, 3], expected[:3], atol=4e-3)


def anywhere(rng: np.random.Generator) -> dict[str, tuple[Array, Shape]]:
    """The same features, the slot and the tab elsewhere and of other lengths, the whole turned somehow."""
    away, turn = rng.uniform(-20.0, 20.0, (2, 2)), np.eye(4)
    turn[:3, :3] = Rotation.from_quat(rng.normal(size=4)).as_matrix()
    length = rng.uniform(10.0, 60.0, 2)
    changed: dict[str, tuple[Array, Shape]] = {
        "slot": (frame((100 + away[0, 0], 25 + away[0, 1], 10), Y, X), Slot((length[0], 20.0), 8.0)),
        "tab": (frame((40 + away[1, 0], 70 + away[1, 1], 10), X, Y), Slot((length[1], 20.0), 6.0, inner=False)),
    }
    return {name: (turn @ at, shape) for name, (at, shape) in {**SHAPES, **changed}.items()}


def test_a_plane_a_bore_and_a_slot_by_finite_poses() -> None:
    """Half a millimetre on everything: the floor flat, the bore's centre and the slot's middle in their places."""
    draft, assembly = drawn(["floor", "bore", "slot"])
    row = np.random.default_rng(7).normal(0.0, 0.5, (1, assembly.width))
    own = dict(zip(draft.columns, row[0], strict=True))

    def heights(name: str, places: Sequence[tuple[float, float]]) -> list[Array]:
        """Points of a plane at shares of its reaches, in the part."""
        at, shape = SHAPES[name]
        assert isinstance(shape, Plane)
        w, rx, ry = (own[f"p.{name} {c}"] for c in shape.components)
        a, b = shape.reach
        return [at[:3, :3] @ (x * a, y * b, w + rx * x + ry * y) + at[:3, 3] for x, y in places]

    floor = heights("floor", [(1, 1), (-1, 1), (-1, -1)])
    middle = heights("slot", [(0, 0)])[0]
    centre = np.array([20, 25, 10]) + [
        (own[f"p.bore start {c}"] + own[f"p.bore end {c}"]) / 2 if c else 0.0 for c in ("x", "y", "")
    ]

    def lacking(turn: Array, shift: Array) -> Array:
        seen = np.array([*floor, centre, middle]) @ turn.T + shift
        return np.array([*seen[:3, 2], *(seen[3, :2] - (20, 25)), seen[4, 1] - 25])

    found = np.linalg.inv(exactly(assembly, row))
    np.testing.assert_allclose(found, solved_pose(lacking, np.eye(4)), atol=2e-11)
