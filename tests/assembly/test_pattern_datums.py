"""Patterns of features as one datum: against lines through two centres, numpy's least squares, and what is refused."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from assembly.drafts import Draft, displacement, frame
from assembly_trials import assembled
from numpy.typing import NDArray
from scene_texts import refusal

from tol3d.assembly.model import Assembly, Axis, Datum, Fix, Plane
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors

Array = NDArray[np.float64]

X, Y, Z = np.eye(3)
PLACES = np.array([[10.0, 10.0], [90.0, 12.0], [50.0, 70.0], [30.0, 50.0]])
LENGTHS = (10.0, 16.0, 10.0, 12.0)
DEPTHS = (5.0, 8.0, 5.0, 2.0)
TIP = (110.0, 70.0, 30.0)
FLOOR = Datum(("p.floor",))


def holes(count: int) -> Datum:
    return Datum(tuple(f"p.h{k}" for k in range(count)), "pattern")


def plate(*datums: Datum) -> tuple[Draft, Assembly]:
    """A plate with four holes of several lengths and depths, and a point that a frame carries."""
    draft = Draft()
    draft.part("p")
    draft.feature("p.floor", frame((60, 40, 0), -Z, X), Plane((120, 80)))
    draft.feature("p.step", frame((60, 40, 7), -Z, X), Plane((30, 80)))
    draft.feature("p.side", frame((60, 0, 10), -Y, X), Plane((120, 20)))
    for k, ((x, y), length, depth) in enumerate(zip(PLACES, LENGTHS, DEPTHS, strict=True)):
        draft.feature(f"p.h{k}", frame((x, y, depth), Z, X), Axis(length, 8.0, inner=True))
    held = draft.datum_frame("p", *datums)
    draft.feature("p.zero", (0, 0, 0), deviates=False)
    draft.feature("p.tip", TIP, parent=held, deviates=False)
    measures = {name: displacement("p.tip", along, "p.zero") for name, along in zip("xyz", np.eye(3), strict=True)}
    return draft, draft.assembly((Fix("fix", "p"),), measures)


def tip(assembly: Assembly, rows: Array) -> tuple[Array, Array]:
    """The point (n, 3) [mm] by the exact and the analytic method."""
    exact, linear = placing.values(assembly, rows, ["x", "y", "z"]), torsors.values(assembly, rows, ["x", "y", "z"])
    return np.stack([exact[n][0] for n in "xyz"], axis=1), np.stack([linear[n] for n in "xyz"], axis=1)


def off(draft: Draft, row: Array, count: int) -> Array:
    """Offsets of the centres of holes (count, 2) [mm]."""
    own = dict(zip(draft.columns, row, strict=True))
    return np.array([[(own[f"p.h{k} start {c}"] + own[f"p.h{k} end {c}"]) / 2 for c in "xy"] for k in range(count)])


def with_floor_still(draft: Draft, rows: Array) -> Array:
    rows[:, [k for k, name in enumerate(draft.columns) if "floor" in name]] = 0.0
    return rows


def carried(start: Array, end: Array) -> Array:
    """Place of the tip (2,) after the rotation and shift of least squares from places to places (Kabsch 1976)."""
    a, b = start - start.mean(axis=0), end - end.mean(axis=0)
    left, _, right = np.linalg.svd(a.T @ b)
    turn = (left @ np.diag([1.0, np.linalg.det(left @ right)]) @ right).T
    return np.asarray(end.mean(axis=0) + turn @ (np.array(TIP[:2]) - start.mean(axis=0)))


def test_two_holes_lie_on_the_line_through_their_centres_about_their_middle() -> None:
    draft, assembly = plate(FLOOR, holes(2))
    rows = with_floor_still(draft, np.random.default_rng(1).normal(0.0, 0.05, (5, assembly.width)))
    exact, linear = tip(assembly, rows)
    for row, own, first in zip(rows, exact, linear, strict=True):
        places = PLACES[:2] + off(draft, row, 2)
        angle = np.arctan2(*(places[1] - places[0])[::-1]) - np.arctan2(*(PLACES[1] - PLACES[0])[::-1])
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        expected = places.mean(axis=0) + turn @ (np.array(TIP[:2]) - PLACES[:2].mean(axis=0))
        assert own[:2] == pytest.approx(expected, abs=1e-10)
        assert first[:2] == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("count", [3, 4])
def test_several_holes_lie_by_least_squares_of_their_centres_whatever_they_lean(count: int) -> None:
    draft, assembly = plate(FLOOR, holes(count))
    rows = with_floor_still(draft, np.random.default_rng(count).normal(0.0, 0.05, (5, assembly.width)))
    exact, linear = tip(assembly, rows)
    for row, own, first in zip(rows, exact, linear, strict=True):
        moved = off(draft, row, count)
        assert own[:2] == pytest.approx(carried(PLACES[:count], PLACES[:count] + moved), abs=1e-10)
        design = np.array([[*e, e @ (-y, x)] for x, y in PLACES[:count] for e in np.eye(2)])
        x, y, turn = np.linalg.lstsq(design, moved.ravel(), rcond=None)[0]
        shift = np.array([x - turn * TIP[1], y + turn * TIP[0]])
        assert first[:2] - TIP[:2] == pytest.approx(shift, abs=1e-12)


def test_holes_alone_are_upright_by_least_squares_of_their_ends() -> None:
    """To first order: of both ends of each hole, in five motions."""
    draft, assembly = plate(holes(4))
    row = np.random.default_rng(5).normal(0.0, 0.05, (1, assembly.width))
    own = dict(zip(draft.columns, row[0], strict=True))
    design, values = [], []
    for k, ((x, y), length, depth) in enumerate(zip(PLACES, LENGTHS, DEPTHS, strict=True)):
        for end, side in (("start", -1), ("end", 1)):
            at = np.array([x, y, depth + side * length / 2])
            for c, along in (("x", X), ("y", Y)):
                design.append([*along[:2], *np.cross(at, along)])
                values.append(own[f"p.h{k} {end} {c}"])
    shift_x, shift_y, *turn = np.linalg.lstsq(np.array(design), np.array(values), rcond=None)[0]
    expected = np.array([shift_x, shift_y, 0.0]) + np.cross(turn, TIP)
    assert (tip(assembly, row)[1][0] - TIP)[:2] == pytest.approx(expected[:2], abs=1e-12)


def test_planes_are_one_by_least_squares_of_their_corners() -> None:
    """A floor and a smaller step below it, both with offsets alone: heights weigh by numbers of corners, four each."""
    draft, assembly = plate(Datum(("p.floor", "p.step"), "pattern"), holes(2))
    row = np.zeros((1, assembly.width))
    row[0, draft.columns.index("p.floor offset")] = -0.02  # z is down: up by 0.02
    row[0, draft.columns.index("p.step offset")] = 0.04
    exact, linear = tip(assembly, row)
    assert exact[0, 2] - TIP[2] == pytest.approx(-0.01, abs=1e-12)
    assert linear[0, 2] - TIP[2] == pytest.approx(-0.01, abs=1e-12)


FRAMES: Sequence[Sequence[Datum]] = [
    [FLOOR, holes(4)],
    [holes(4)],
    [holes(3), FLOOR],
    [FLOOR, Datum(("p.side",)), holes(2)],
    [Datum(("p.floor", "p.side"), "pattern"), Datum(("p.h0",))],
]


@pytest.mark.parametrize("datums", FRAMES, ids=lambda own: "|".join("-".join(each.features) for each in own))
def test_both_methods_differ_by_second_order(datums: Sequence[Datum]) -> None:
    """A tenth of the deviations leaves a hundredth."""
    _, assembly = plate(*datums)
    rows = np.random.default_rng(6).normal(0.0, 0.02, (20, assembly.width))
    far = [np.abs(np.subtract(*tip(assembly, factor * rows))).max() for factor in (1.0, 0.1)]
    assert far[0] < 5e-3
    assert far[1] == pytest.approx(far[0] / 100, rel=0.1)


def test_the_order_of_a_pattern_makes_no_difference() -> None:
    _, assembly = plate(FLOOR, holes(4))
    _, other = plate(FLOOR, Datum(tuple(f"p.h{k}" for k in (2, 0, 3, 1)), "pattern"))
    rows = np.random.default_rng(7).normal(0.0, 0.05, (5, assembly.width))
    for own, its in zip(tip(assembly, rows), tip(other, rows), strict=True):
        np.testing.assert_allclose(its, own, atol=1e-10, rtol=0)


# in scenes ---------------------------------------------------------------------------------------------------

SCENE = """scene: plate on its holes
parts:
  plate:
    kind: solid
    features:
      A: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}
      hole:
        kind: cylinder
        at: [-20 mm, -10 mm, 5 mm]
        axis: [0, 0, 1]
        length: 10 mm
        diameter: 8 mm
        hole: true
        pattern: {rows: 2, columns: 2, pitch: [40 mm, 20 mm]}
      bore: {kind: cylinder, at: [0 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 20 mm, hole: true}
tolerances:
  holes: {kind: position, of: plate.hole, zone: {diameter: 0.3 mm}, datums: [A], law: &zones {kind: uniform}}
  hole size: {kind: size, of: plate.hole, distribution: {kind: uniform, lower: 0 mm, upper: 0.1 mm}}
  bore: {kind: position, of: plate.bore, zone: {diameter: 0.1 mm}, law: *zones, datums: [A, DRAWN]}
moves:
  bench: {kind: fix, part: plate}
measures:
  off: {kind: inspected_position, of: plate.bore, datums: [A, READ], upper_limit: 0.1 mm}
"""
ALL = "hole 1-hole 2-hole 3-hole 4"


@pytest.mark.parametrize(
    ("drawn", "read", "modifier"),
    [
        ("simulator: pattern", "simulator: pattern", ""),
        ("mmb: random", "mmb: least", ""),
        ("lmb: random", "lmb: least", ""),
        ("lmb: random", "lmb: least", "modifier: mmc, "),  # holes of LMC size may be farther off, and have a gauge
    ],
)
def test_what_lies_to_a_pattern_is_inspected_within_its_zone(
    drawn: str, read: str, modifier: str, tmp_path: Path
) -> None:
    text = SCENE.replace("DRAWN", f"{{feature: {ALL}, {drawn}}}").replace("READ", f"{{feature: {ALL}, {read}}}")
    made = assembled(text.replace("of: plate.hole, zone", f"of: plate.hole, {modifier}zone"), tmp_path)
    for method in ("exact", "analytic"):
        values = made.drawn(2000, method)["off"]
        assert 0.9 * 0.1 < values.max() <= 0.1 + 1e-6


def test_a_datum_without_a_zone_of_its_own_has_a_gauge_of_its_mmc_size(tmp_path: Path) -> None:
    """A pin of 8 mm leaves a hole of 8 + s half of s: a bore that is d aside is inspected at 2 max(0, |d| - s/2)."""
    text = SCENE.replace("        pattern: {rows: 2, columns: 2, pitch: [40 mm, 20 mm]}\n", "")
    text = text.replace("[-20 mm, -10 mm, 5 mm]", "[-40 mm, 0 mm, 5 mm]")
    start, end = text.index("  holes: "), text.index("  hole size: ")
    text = text[:start] + text[end:]
    zone = text[text.index("  bore: {kind: position") : text.index("moves:")]
    law = "distribution: {kind: uniform, lower: -0.1 mm, upper: 0.1 mm}"
    text = text.replace(zone, f"  aside: {{kind: plus_minus, of: plate.bore, along: [1, 0, 0], {law}}}\n")
    read = "  size: {kind: inspected_size, of: plate.hole}\n"
    read += "  x: {kind: gap, from: plate.hole, to: plate.bore, along: [1, 0, 0]}\n"
    text = text.replace("READ", "{feature: hole, mmb: least}").replace("  off: ", f"{read}  off: ")
    made = assembled(text, tmp_path)
    for method in ("exact", "analytic"):
        found = made.drawn(500, method)
        wanted = 2 * np.maximum(0.0, np.abs(found["x"] - 40) - (found["size"] - 8) / 2)
        np.testing.assert_allclose(found["off"], wanted, atol=1e-6, rtol=0)
        assert wanted.max() > 0.15


@pytest.mark.parametrize(
    ("datum", "words"),
    [
        (
            "{feature: hole 1, simulator: pattern}",
            "expected two to ten features as one datum, such as hole 1-hole 2, got",
        ),
        ("{feature: hole 1-hole 1, simulator: pattern}", "expected each feature once, got hole 1-hole 1"),
        ("{feature: hole 1-bore, mmb: random}", "expected a tolerance of the size of 'plate.bore'"),
        (ALL, "beside each other they are a pattern, write {feature: hole 1-hole 2-hole 3-hole 4, simulator: pattern}"),
    ],
)
def test_what_is_no_pattern_is_refused(datum: str, words: str, tmp_path: Path) -> None:
    text = SCENE.replace("DRAWN", datum).replace("READ", datum.replace("random", "least"))
    assert words in refusal(text, tmp_path)
