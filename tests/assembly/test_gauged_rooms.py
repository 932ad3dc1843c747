"""Datum frames on gauges in a common room: positions against linear programmes, and both methods against each other."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from assembly.drafts import Draft, displacement, frame
from numpy.typing import NDArray
from scipy.optimize import linprog

from tol3d.assembly.grammar.measures.inspected import InspectedPositionSpec
from tol3d.assembly.model import Assembly, Axis, Datum, Fix, Floating, Gauges, Measured, Plane, Shape, Slot
from tol3d.assembly.model.datum_frame import GaugeRoom
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors

Array = NDArray[np.float64]

X, Y, Z = np.eye(3)

SHAPES: dict[str, tuple[Array, Shape, float]] = {
    "floor": (frame((60, 40, 0), -Z, X), Plane((120, 80)), 0.0),
    "bore": (frame((20, 25, 10), Z, X), Axis(20.0, 12.0, inner=True), 12.0),
    "pin": (frame((95, 60, 10), Z, X), Axis(24.0, 8.0), 8.0),
    "slot": (frame((100, 25, 10), Y, X), Slot((30.0, 20.0), 8.0), 8.0),
    "tab": (frame((40, 70, 10), X, Y), Slot((14.0, 20.0), 6.0, inner=False), 6.0),
}
FRAMES = [
    (["floor"], ["bore", "pin"]),
    (["floor"], ["slot"]),
    (["floor"], ["bore", "slot"]),
    (["floor", "bore"], ["pin"]),
    (["floor", "bore"], ["slot"]),
    ([], ["bore"]),
    ([], ["bore", "pin"]),
    ([], ["slot", "tab"]),
    (["bore"], ["slot"]),
    (["floor"], ["bore-pin"]),
    ([], ["pin-bore-slot"]),
]
MEASURED: dict[str, tuple[Array, Shape]] = {
    "hole": (frame((70, 45, 10), Z, X), Axis(20.0)),
    "skew": (frame((70, 10, 10), (1, 0, 2), Y), Axis(10.0)),
    "face": (frame((120, 40, 10), X, Y), Plane((60.0, 20.0))),
}
ROOM = 0.08  # mm: of each gauge, nominally


def gauged(
    kept: Sequence[str], at: Sequence[str], floating: Floating | None, room: float = ROOM
) -> tuple[Draft, Assembly]:
    draft = Draft()
    draft.part("p")
    for name, (where, shape, size) in SHAPES.items():
        draft.feature(f"p.{name}", where, shape)
        if size:
            draft.size(f"p.{name}")
    held = draft.datum_frame("p", *(datum(name) for name in (*kept, *at)))
    rooms = []
    for name in "-".join(at).split("-"):
        inner = is_inner(name)
        rooms.append(GaugeRoom(f"p.{name}", SHAPES[name][2] + (-2 * room if inner else 2 * room), inner))
    draft.datum_frames[held] = replace(draft.datum_frames[held], gauges=Gauges(tuple(rooms), floating))
    draft.feature("p.zero", (0, 0, 0), deviates=False)
    draft.feature("p.tip", (110, 70, 30), parent=held, deviates=False)
    measures = {f"tip {n}": displacement("p.tip", along, "p.zero") for n, along in zip("xyz", np.eye(3), strict=True)}
    for name, (where, shape) in MEASURED.items():
        draft.feature(f"p.{name}", where, shape)
        if floating is None:
            measures[name] = Measured(InspectedPositionSpec.reads, (f"p.{name}",), frame=held, over_gauges=True)
    return draft, draft.assembly((Fix("fix", "p"),), measures)


def datum(words: str) -> Datum:
    """A feature, or several as a pattern: bore-pin."""
    names = tuple(f"p.{own}" for own in words.split("-"))
    return Datum(names, "pattern" if len(names) > 1 else "contact")


def is_inner(name: str) -> bool:
    return bool(getattr(SHAPES[name][1], "inner", False))


def ends(name: str, own: dict[str, float]) -> list[tuple[Array, Array, Array]]:
    """Ends of a feature: place, the directions that count, and the offset along these."""
    where, shape = SHAPES[name][:2] if name in SHAPES else MEASURED[name]
    (x, y, z, at), moved = where[:3, :4].T, [own[f"p.{name} {c}"] for c in shape.components]
    if isinstance(shape, Axis):
        return [
            (at + side * shape.length / 2 * z, np.array([x, y]), np.array(moved[2 * k : 2 * k + 2]))
            for k, side in enumerate((-1, 1))
        ]
    assert isinstance(shape, Plane)
    (a, b), (w, rx, ry) = shape.reach, moved
    corners = [(s, t) for s in (1, -1) for t in (1, -1)]
    return [(at + s * a * x + t * b * y, z[None], np.array([w + s * rx + t * ry])) for s, t in corners]


def rows_of(end: tuple[Array, Array, Array]) -> Array:
    return np.array([[*own, *np.cross(end[0], own)] for own in end[1]])


def least(kept: Sequence[str], at: Sequence[str], measured: str, own: dict[str, float]) -> float:
    """Twice the least largest distance of the ends, by linear programmes over the motions (6,) of the part."""
    start, free = np.zeros(6), np.eye(6)
    for name in kept:  # a floor flat on its gauge, a bore with its middle in its place: the least turn, then the shift
        where, shape, _ = SHAPES[name]
        (x, y, z, place), moved = where[:3, :4].T, [own[f"p.{name} {c}"] for c in shape.components]
        turns = np.array([[0, 0, 0, *x], [0, 0, 0, *y]])
        shifts = np.array([[*d, *np.cross(place, d)] for d in (x, y, z)])
        if isinstance(shape, Axis):
            slopes = np.array([moved[1] - moved[3], moved[2] - moved[0]]) / shape.length
            held, off = shifts[:2], np.array([(moved[0] + moved[2]) / 2, (moved[1] + moved[3]) / 2, 0.0])
        else:
            assert isinstance(shape, Plane)
            slopes = np.array([moved[2] / shape.reach[1], -moved[1] / shape.reach[0]])
            held, off = shifts[2:], np.array([0.0, 0.0, moved[0]])
        start = start - free @ solved_by(turns @ free, slopes + turns @ start)
        free = without(free, turns)
        pure = without(free, np.eye(6)[3:])
        start = start - pure @ solved_by(shifts @ pure, off + shifts @ start)
        free = without(free, held)
    at = "-".join(at).split("-")
    seen = np.concatenate([rows_of(end) for name in at for end in ends(name, own)]) @ free
    _, sizes, right = np.linalg.svd(seen)
    rank = int((sizes > 1e-6).sum())
    free, other = free @ right[:rank].T, free @ right[rank:].T
    # what no gauge sees turns least, and then shifts the middle of the gauges' ends least
    middle = np.mean([end[0] for name in at for end in ends(name, own)], axis=0)
    for rows in (np.eye(6)[3:], np.array([[*d, *np.cross(middle, d)] for d in np.eye(3)])):
        free = free - other @ solved_by(rows @ other, rows @ free)
        other = without(other, rows)

    cones = []  # |b + a u| <= clearance + weight t
    for name in at:
        sign = 1 if is_inner(name) else -1
        cones += [(end, ROOM + sign * own[f"p.{name} size"] / 2, 0.0) for end in ends(name, own)]
    cones += [(end, 0.0, 1.0) for end in ends(measured, own)]
    given = [(rows_of(end) @ free, end[2] + rows_of(end) @ start, clear, t) for end, clear, t in cones]
    return 2 * smallest(given)


def solved_by(acts: Array, asked: Array) -> Array:
    """The least amounts that do what is asked, as far as they can."""
    return np.asarray(np.linalg.pinv(np.where(np.abs(acts) < 1e-9, 0.0, acts), rcond=1e-9) @ asked)


def without(free: Array, rows: Array) -> Array:
    """Those of the motions (6, k) on which rows (n, 6) do not act."""
    acts = np.where(np.abs(rows @ free) < 1e-9, 0.0, rows @ free)
    return np.asarray(free @ np.linalg.svd(acts)[2][np.linalg.matrix_rank(acts, tol=1e-9) :].T)


def smallest(cones: Sequence[tuple[Array, Array, float, float]]) -> float:
    """The least t >= 0 with |b + a u| <= c + w t of all cones (a, b, c, w): linear programmes with ever more cuts."""
    cuts, limits = [], []

    def cut(cone: tuple[Array, Array, float, float], direction: Array) -> None:
        a, b, clear, weight = cone
        cuts.append([*(direction @ a), -weight])
        limits.append(clear - direction @ b)

    for cone in cones:
        for angle in np.arange(8) * np.pi / 4:
            cut(cone, np.array([np.cos(angle), np.sin(angle)])[: len(cone[1])])
    free = cones[0][0].shape[1]
    for _ in range(100):
        bounds = [(-1.0, 1.0)] * free + [(0.0, None)]
        found = linprog([*np.zeros(free), 1.0], np.array(cuts), limits, bounds=bounds)
        assert found.success
        over = [np.linalg.norm(b + a @ found.x[:-1]) - c - w * found.x[-1] for a, b, c, w in cones]
        if max(over) < 1e-9:
            break
        for cone, own in zip(cones, over, strict=True):
            if own > 0:
                off = cone[1] + cone[0] @ found.x[:-1]
                cut(cone, off / np.linalg.norm(off))
    return float(found.x[-1])


@pytest.mark.slow
@pytest.mark.parametrize(("kept", "at"), FRAMES, ids=lambda own: "|".join(own) or "none")
def test_positions_over_the_room_as_linear_programmes_find_them(kept: list[str], at: list[str]) -> None:
    draft, assembly = gauged(kept, at, None)
    rng = np.random.default_rng(len(kept) * 7 + len("".join(at)))
    row = rng.normal(0.0, 0.012, (1, assembly.width))
    for name in MEASURED:
        linear = torsors.values(assembly, row, [name])[name]
        exact, codes = placing.values(assembly, row, [name])[name]
        assert (codes == OK).all()
        expected = least(kept, at, name, dict(zip(draft.columns, row[0], strict=True)))
        assert linear[0] == pytest.approx(expected, abs=5e-7)  # programmes miss their cuts by 1e-7
        assert exact[0] == pytest.approx(expected, abs=1e-3)  # slopes of 0.02 / 7 on 0.2 mm, of second order


@pytest.mark.parametrize(("kept", "at"), FRAMES, ids=lambda own: "|".join(own) or "none")
@pytest.mark.parametrize("kind", ["centred", "random"])
def test_both_methods_differ_by_second_order(kept: list[str], at: list[str], kind: str) -> None:
    """A tenth of the deviations and of the room leaves a hundredth; a random float multiplies it sweep by sweep."""
    _, bare = gauged(kept, at, None)
    drawn_of, off = slice(bare.width, bare.width + 7), np.random.default_rng(5).normal(0.0, 0.01, (12, bare.width))
    rng = np.random.default_rng(6)
    rays = rng.uniform(-1.0, 1.0, (12, 7))
    left = []
    for factor in (0.1, 0.01):
        floating = Floating("random", drawn_of) if kind == "random" else Floating("centred")
        _, assembly = gauged(kept, at, floating, factor * ROOM)
        assembly = replace(assembly, width=bare.width + 7)
        rows = np.hstack([factor * off, rays])
        largest = 0.0
        for name in ("tip x", "tip y", "tip z"):
            exact, codes = placing.values(assembly, rows, [name])[name]
            assert (codes == OK).all()
            linear = torsors.values(assembly, rows, [name])[name]
            largest = max(largest, float(np.abs(exact - linear).max()))
        left.append(largest)
    assert left[0] < (2e-4 if kind == "random" else 5e-5)  # a turn of 0.02 / 10 on 0.02 mm
    assert left[1] < 1.5e-2 * left[0] + 1e-9


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_gauges_are_uniform_in_their_room(method: str) -> None:
    """Two gauges of unequal clearance, one feature off: mean, sigma and correlation of the tip against rejection."""
    count = 2000
    _, bare = gauged(["floor"], ["bore", "pin"], None)
    floating = Floating("random", slice(bare.width, bare.width + 7))
    draft, assembly = gauged(["floor"], ["bore", "pin"], floating)
    assembly = replace(assembly, width=bare.width + 7)
    off = {"p.bore size": 0.04, "p.pin size": 0.02, "p.bore start x": 0.03, "p.bore end x": 0.03}
    rows = np.tile([off.get(name, 0.0) for name in draft.columns] + 7 * [0.0], (count, 1))
    rng = np.random.default_rng(11)
    rows[:, -7:] = rng.uniform(-1.0, 1.0, (count, 7))
    names = ["tip x", "tip y"]
    if method == "exact":
        found = [placing.values(assembly, rows, [name])[name][0] for name in names]
    else:
        found = [torsors.values(assembly, rows, names)[name] for name in names]
    half = np.array([0.25, 0.25, 0.006])
    x, y, turn = rng.uniform(-half, half, (2_000_000, 3)).T  # of the part about the corner of its floor
    bore = np.hypot(x - 25 * turn + 0.03, y + 20 * turn) <= ROOM + 0.02
    room = bore & (np.hypot(x - 60 * turn, y + 95 * turn) <= ROOM - 0.01)
    x, y, turn = x[room], y[room], turn[room]
    assert np.abs(turn).max() < 0.9 * half[2]
    expected = -(x - 70 * turn), -(y + 110 * turn)  # the tip stays with the gauges
    found = [own - nominal for own, nominal in zip(found, (110.0, 70.0), strict=True)]
    for own, its in zip(found, expected, strict=True):
        error = its.std() * 4 * np.sqrt(1 / count + 1 / len(its))
        assert own.mean() == pytest.approx(its.mean(), abs=error + 2e-4)  # turns of 2e-3 on 0.1 mm
        assert own.std() == pytest.approx(its.std(), abs=error / np.sqrt(2))
    correlation = np.corrcoef(*expected)[0, 1]
    assert np.corrcoef(found[0], found[1])[0, 1] == pytest.approx(
        correlation, abs=4 * (1 - correlation**2) / np.sqrt(count) + 0.01
    )
