"""Datums regardless of size after ones at their boundary: the limits of the room, brute force, and both methods."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from assembly.drafts import Draft, displacement, frame
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from tol3d.assembly.grammar.measures.inspected import InspectedPositionSpec
from tol3d.assembly.model import Assembly, Axis, Datum, Fix, Floating, Gauges, Measured, Plane, RoundPlane, Shape, Slot
from tol3d.assembly.model.datum_frame import GaugeRoom
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors

Array = NDArray[np.float64]

X, Y, Z = np.eye(3)

SHAPES: dict[str, tuple[Array, Shape, float]] = {
    "floor": (frame((60, 40, 0), -Z, X), Plane((120, 80)), 0.0),
    "side": (frame((0, 40, 10), -X, Y), Plane((80, 20)), 0.0),
    "disc": (frame((0, 40, 10), -X, Y), RoundPlane(10.0), 0.0),
    "bore": (frame((20, 25, 10), Z, X), Axis(20.0, 12.0, inner=True), 12.0),
    "pin": (frame((95, 60, 10), Z, X), Axis(24.0, 8.0), 8.0),
    "slot": (frame((100, 25, 10), Y, X), Slot((30.0, 20.0), 8.0), 8.0),
    "tab": (frame((40, 70, 10), X, Y), Slot((14.0, 20.0), 6.0, inner=False), 6.0),
}
SIDE_AT = np.array([[20.0, 3.0, 0.0], [-20.0, 5.0, 0.0]])
FRAMES = ["floor|bore*|side", "floor|bore*|slot", "floor|bore*|pin", "floor|slot*|bore", "floor|slot*|side"]
FRAMES += ["floor|bore*|side at", "floor|bore*|disc", "bore*|side"]
"""With a star: on a gauge."""
TIP = np.array([110.0, 70.0, 30.0])


def datum(words: str) -> Datum:
    name, _, at = words.rstrip("*").partition(" ")
    return Datum((f"p.{name}",), "targets", SIDE_AT) if at else Datum((f"p.{name}",))


def plate(words: str, room: float, floating: Floating | None, width: int = 0) -> tuple[Draft, Assembly]:
    """A plate whose datums with a star are on gauges, with some room of each nominally."""
    draft = Draft()
    draft.part("p")
    for name, (where, shape, size) in SHAPES.items():
        draft.feature(f"p.{name}", where, shape)
        if size:
            draft.size(f"p.{name}")
    names = words.split("|")
    held = draft.datum_frame("p", *map(datum, names))
    rooms = []
    for name in (own[:-1] for own in names if own.endswith("*")):
        inner = bool(getattr(SHAPES[name][1], "inner", False))
        rooms.append(GaugeRoom(f"p.{name}", SHAPES[name][2] + (-2 * room if inner else 2 * room), inner))
    if room < np.inf:
        gauges = Gauges(tuple(rooms), floating)
        draft.datum_frames[held] = replace(draft.datum_frames[held], gauges=gauges)
    draft.feature("p.zero", (0, 0, 0), deviates=False)
    draft.feature("p.tip", TIP, parent=held, deviates=False)
    draft.feature("p.hole", frame((70, 45, 10), Z, X), Axis(20.0))
    measures = {n: displacement("p.tip", along, "p.zero") for n, along in zip("xyz", np.eye(3), strict=True)}
    if floating is None:
        measures = {"hole": Measured(InspectedPositionSpec.reads, ("p.hole",), frame=held, over_gauges=True)}
    made = draft.assembly((Fix("fix", "p"),), measures)
    return draft, replace(made, width=made.width + width)


def read(assembly: Assembly, rows: Array) -> dict[str, Array]:
    found = placing.values(assembly, rows, list(assembly.measures))
    assert all((codes == OK).all() for _, codes in found.values())
    linear = torsors.values(assembly, rows, list(assembly.measures))
    return {
        "exact": np.stack([own for own, _ in found.values()], axis=-1),
        "analytic": np.stack([linear[name] for name in found], axis=-1),
    }


def trials(draft: Draft, words: str, rows: Array) -> Array:
    """Trials in which the floor lies flat and gauged datums do not lean, of their nominal sizes."""
    gauged = [own[:-1] for own in words.split("|") if own.endswith("*")]
    for k, name in enumerate(draft.columns):
        own, _, component = name.removeprefix("p.").partition(" ")
        if own == "floor" or component == "size" or (own in gauged and "rise" in component):
            rows[:, k] = 0.0
        elif own in gauged and component.startswith("end"):
            rows[:, k] = rows[:, draft.columns.index(name.replace("end", "start"))]
    return rows


@pytest.mark.parametrize("words", FRAMES)
def test_without_room_a_frame_is_that_regardless_of_all_sizes(words: str) -> None:
    """The gauge of a hole that it just takes holds its place; what is left of it counts by levers of up to ten."""
    draft, assembly = plate(words, 1e-8, Floating("centred"))
    rows = trials(draft, words, np.random.default_rng(3).normal(0.0, 0.01, (6, assembly.width)))
    _, plain = plate(words, np.inf, Floating("centred"))
    for method, own in read(assembly, rows).items():
        np.testing.assert_allclose(own, read(plain, rows)[method], atol=2e-7, rtol=0)


# by hand: the part lies at (x, y) and turns by t about z; a place p is displaced by (x - t p_y, y + t p_x) ----------

ROOM = 0.02
Motions = tuple[Array, Array, Array]


def on_side(own: dict[str, Array]) -> Motions:
    """The side's lean stops the turn; then its outermost corner goes to the wall x = 0, as far as the bore may."""
    turn = -own["side rise x"] / 40  # 40 mm from its middle it lies that much farther out, along -x
    wanted = own["side offset"] + np.abs(own["side rise y"]) + 40 * turn
    bore_x, bore_y = own["bore start x"] - 25 * turn, own["bore start y"] + 20 * turn
    return np.clip(wanted + bore_x, -ROOM, ROOM) - bore_x, -bore_y, turn


def on_slot(own: dict[str, Array]) -> Motions:
    """A blade along x: the slot's lean stops the turn if the bore goes up or down far enough, else its middle does."""
    turn = -own["slot rise x"] / 15
    aside = own["bore start y"] - own["slot offset"] - 80 * turn
    near = np.clip(aside, -ROOM, ROOM)
    turn = np.where(near == aside, turn, (own["bore start y"] - own["slot offset"] - near) / 80)
    return 25 * turn - own["bore start x"], near - own["bore start y"] - 20 * turn, turn


def on_pin(own: dict[str, Array]) -> Motions:
    """A sleeve closes about the pin: it holds its centre if the bore goes that far along the line, else the turn."""
    way = np.array([75.0, 35.0]) / np.hypot(75, 35)
    off = [own[f"bore start {c}"] - (own[f"pin start {c}"] + own[f"pin end {c}"]) / 2 for c in "xy"]
    along, across = way[0] * off[0] + way[1] * off[1], way[0] * off[1] - way[1] * off[0]
    turn, near = across / np.hypot(75, 35), np.clip(along, -ROOM, ROOM)
    return (near * way[0] - own["bore start x"] + 25 * turn, near * way[1] - own["bore start y"] - 20 * turn, turn)


@pytest.mark.parametrize(("words", "by_hand"), [("side", on_side), ("slot", on_slot), ("pin", on_pin)])
def test_a_later_datum_is_as_near_as_the_bore_lets_it(words: str, by_hand: Callable[..., Motions]) -> None:
    """About a thousand builds in all, in many of which the bore meets its gauge; else it is in mid chord."""
    draft, assembly = plate(f"floor|bore*|{words}", ROOM, Floating("centred"))
    rows = np.random.default_rng(4).normal(0.0, 0.02, (330, assembly.width))
    rows = trials(draft, f"floor|bore*|{words}", rows)
    own = {name.removeprefix("p."): column for name, column in zip(draft.columns, rows.T, strict=True)}
    x, y, turn = by_hand(own)
    bore = np.hypot(own["bore start x"] + x - 25 * turn, own["bore start y"] + y + 20 * turn)
    assert 0.1 < (bore > ROOM - 1e-9).mean() < 0.9
    expected = TIP[:2] - np.stack([x - TIP[1] * turn, y + TIP[0] * turn], axis=-1)
    for method, within in (("analytic", 1e-6), ("exact", 1e-3)):  # turns of 2e-3 on 0.1 mm
        np.testing.assert_allclose(read(assembly, rows)[method][:, :2], expected, atol=within, rtol=0)


def test_what_a_later_datum_leaves_is_floated_in() -> None:
    """Along the wall the bore has the chord of its room left, uniformly: as far as its gauge at that place."""
    random = 400
    draft, bare = plate("floor|bore*|side", ROOM, Floating("centred"))
    drawn = Floating("random", slice(bare.width, bare.width + 7))
    _, assembly = plate("floor|bore*|side", ROOM, drawn, 7)
    rng = np.random.default_rng(5)
    rows = trials(draft, "floor|bore*|side", rng.normal(0.0, 0.005, (random, bare.width)))
    rays = rng.uniform(-1.0, 1.0, (random, 7))
    still = read(bare, rows)
    for method, found in read(assembly, np.hstack([rows, rays])).items():
        np.testing.assert_allclose(found[:, 0], still[method][:, 0], atol=1e-5, rtol=0)
        own = {name.removeprefix("p."): column for name, column in zip(draft.columns, rows.T, strict=True)}
        x, _, turn = on_side(own)
        chord = np.sqrt(np.maximum(ROOM**2 - (own["bore start x"] + x - 25 * turn) ** 2, 0.0))
        off = found[:, 1] - still[method][:, 1]
        share = off[chord > 1e-4] / chord[chord > 1e-4]
        assert np.abs(share).max() <= 1.0 + 1e-3
        assert np.sort(np.abs(share)) == pytest.approx(np.linspace(0, 1, len(share)), abs=1.7 / np.sqrt(len(share)))
        assert 0.4 < (share > 0).mean() < 0.6


def test_what_is_inspected_takes_its_least_in_what_is_left() -> None:
    """By a search along the chord: the ends of a hole to where it lies nominally."""
    draft, assembly = plate("floor|bore*|side", ROOM, None)
    rows = trials(draft, "floor|bore*|side", np.random.default_rng(6).normal(0.0, 0.02, (12, assembly.width)))
    found = read(assembly, rows)
    for k, row in enumerate(rows):
        own = {name.removeprefix("p."): column for name, column in zip(draft.columns, row[:, None], strict=True)}
        x, y, turn = (float(each[0]) for each in on_side(own))
        chord = np.sqrt(max(ROOM**2 - (own["bore start x"][0] + x - 25 * turn) ** 2, 0.0))

        def worst(aside: float, x: float = x, y: float = y, turn: float = turn, own: dict[str, Array] = own) -> float:
            off_x = [own[f"hole {end} x"][0] + x - 45 * turn for end in ("start", "end")]
            off_y = [own[f"hole {end} y"][0] + y + aside + 70 * turn for end in ("start", "end")]
            return float(2 * np.hypot(off_x, off_y).max())

        least = minimize_scalar(worst, bounds=(-chord, chord), method="bounded", options={"xatol": 1e-10})
        expected = min(float(least.fun), worst(chord), worst(-chord))
        assert found["analytic"][k, 0] == pytest.approx(expected, abs=2e-6)
        assert found["exact"][k, 0] == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("words", FRAMES)
def test_both_methods_differ_by_second_order(words: str) -> None:
    """A tenth of the deviations and of the room leaves a hundredth."""
    left = []
    _, bare = plate(words, 0.08, Floating("centred"))
    rng = np.random.default_rng(7)
    off, rays = (rng.normal(0.0, 0.01, (12, bare.width)), rng.uniform(-1.0, 1.0, (12, 7)))
    for factor in (1.0, 0.1):
        drawn = Floating("random", slice(bare.width, bare.width + 7))
        _, assembly = plate(words, 0.08 * factor, drawn, 7)
        found = read(assembly, np.hstack([factor * off, rays]))
        left.append(np.abs(found["exact"] - found["analytic"]).max())
    assert left[0] < 5e-3
    assert left[1] < 1.5e-2 * left[0] + 1e-9
