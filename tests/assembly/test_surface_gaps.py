"""Gaps of surfaces are the least ones over the length that both have: held to searches on both surfaces."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly.drafts import Draft, frame, turned
from assembly_trials import assembled
from numpy.typing import NDArray
from oracles.rigid_parts import RigidParts

from tol3d.assembly.grammar.measures.gap import SurfaceGapSpec
from tol3d.assembly.model import Assembly, Axis, Fix, Measured, Plane, RoundPlane, Shape
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors

Array = NDArray[np.float64]

METHODS = ("exact", "analytic")
POSE = turned((0.4, -0.3, 0.9), (310, -140, 75))  # of both parts, askew and far away

LEANING_PIN = """
scene: leaning pin in a hole
parts:
  base:
    kind: solid
    features:
      A: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [40 mm, 40 mm]}
      pin: {kind: cylinder, at: [0 mm, 0 mm, 10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 10 mm}
  cover:
    kind: solid
    features:
      hole: {kind: cylinder, at: [0 mm, 0 mm, 10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 10.5 mm, hole: true}
tolerances:
  lean: {kind: perpendicularity, of: base.pin, zone: {diameter: 0.6 mm}, law: {kind: uniform}, datums: [A]}
moves: {a: {kind: fix, part: base}, b: {kind: fix, part: cover}}
measures: {gap: {kind: surface_gap, from: cover.hole, to: base.pin, lower_limit: 0 mm}}
study: {trials: 4000, seed: 1}
"""


@pytest.mark.parametrize("method", METHODS)
def test_a_pin_that_leans_overlaps_its_hole_at_an_end(method: str, tmp_path: Path) -> None:
    """An end lies anywhere in a disc of 0.3 mm, in which it overlaps beyond 0.25 mm; at 0.3 mm by 50 um."""
    count, share = 4000, 1.0 - (0.25 / 0.3) ** 2
    gaps = assembled(LEANING_PIN, tmp_path).drawn(count, method)["gap"]
    assert np.mean(gaps < 0.0) == pytest.approx(share, abs=4.0 * math.sqrt(share * (1.0 - share) / count))
    # (r/0.3)^2 is even, and beyond 1 - 8/4000 in all but 3 of 10 000 seeds
    assert -0.05 - 1e-9 <= gaps.min() <= 0.25 - 0.3 * math.sqrt(1.0 - 8 / count)
    assert 0.2 < gaps.max() <= 0.25


def fixed(start: tuple[Array, Shape], end: tuple[Array, Shape]) -> Assembly:
    """Two features of two parts that stay where they are drawn, both far away and askew."""
    draft = Draft()
    draft.part("base", POSE @ turned((0.2, 0.1, -0.4), (20, 10, -30)))
    draft.part("part", POSE @ turned((-0.3, 0.5, 0.2), (-15, 25, 8)))
    for part, (place, shape) in zip(("base", "part"), (start, end), strict=True):
        draft.feature(f"{part}.own", np.linalg.inv(draft.poses[part]) @ POSE @ place, shape)
        if isinstance(shape, Axis):
            draft.size(f"{part}.own")
    names = ("base.own", "part.own")
    measures = {"gap": Measured(SurfaceGapSpec.reads, names), "swapped": Measured(SurfaceGapSpec.reads, names[::-1])}
    return draft.assembly((Fix("a", "base"), Fix("b", "part")), measures)


def read(assembly: Assembly, deviations: Array, name: str = "gap") -> dict[str, Array]:
    return {
        "exact": placing.values(assembly, deviations, [name])[name][0],
        "analytic": torsors.values(assembly, deviations, [name])[name],
    }


def lies(assembly: Assembly, row: Array, name: str) -> tuple[Array, Array, float, float]:
    """Middle and z in the world, half the length and the radius of a cylinder; the last two 0 of a plane."""
    rigid, poses = RigidParts(assembly, row, {}), {name: assembly.part[name].pose for name in ("base", "part")}
    shape, z = assembly.features[name].shape, rigid.z(name, poses)
    if not isinstance(shape, Axis):
        return rigid.origin(name, poses), z, 0.0, 0.0
    along = rigid.on_part(name)[1] @ assembly.features[name].frame[:3, 2]
    return rigid.origin(name, poses), z, shape.length / 2 / float(along), rigid.size(name) / 2


def surface(middle: Array, z: Array, half: float, radius: float) -> Array:
    """Points all over a cylinder, its rims included."""
    sides = frame((0, 0, 0), z)[:3, :2]
    turns = np.linspace(0.0, 2 * np.pi, 1440, endpoint=False)  # between them a circle lies r 2.4e-6 deeper
    rings = sides @ (radius * np.array([np.cos(turns), np.sin(turns)]))
    steps = np.linspace(-half, half, 161)
    return np.asarray((middle + steps[:, None, None] * z + rings.T[None]).reshape(-1, 3))


@pytest.mark.parametrize("pin_first", [False, True])
def test_a_pin_in_a_hole_against_all_points_of_its_surface(pin_first: bool) -> None:
    """From the axes it is that at the pin's rim but for the square of its lean; lengths differ, middles are apart."""
    pin, hole = (frame((1.0, -0.2, 9.0)), Axis(26.0, 10.0)), (frame((1.1, 0.0, 2.0)), Axis(17.0, 11.2, inner=True))
    assembly = fixed(*((pin, hole) if pin_first else (hole, pin)))
    names = ("base.own", "part.own") if pin_first else ("part.own", "base.own")
    deviations = 0.04 + 0.12 * np.random.default_rng(5).normal(size=(12, assembly.width))
    found, swapped = read(assembly, deviations), read(assembly, deviations, "swapped")
    spread = []
    for k, row in enumerate(deviations):
        (q, b, half, radius), (p, a, reach, room) = (lies(assembly, row, name) for name in names)
        points = surface(q, b, half, radius) - p
        points = points[np.abs(points @ a) <= reach]
        least = room - np.linalg.norm(np.cross(points, a), axis=1).max()
        second = float(np.linalg.norm(np.cross(a, b))) ** 2
        # the rim lies back by r/2, and its place along the hole is off by r, each times the lean squared;
        # rings of the search are 0.16 mm apart
        assert found["exact"][k] == pytest.approx(least, abs=1.5 * radius * second + 0.17 * math.sqrt(second) + 2e-5)
        assert abs(found["exact"][k] - found["analytic"][k]) < 60.0 * second
        middle = room - radius - float(np.linalg.norm(np.cross(q - p, a)))
        spread.append(abs(middle - least))
    np.testing.assert_allclose(swapped["exact"], found["exact"], rtol=0.0, atol=1e-12)
    assert max(spread) > 0.1  # mm; what the middle alone would hide


def test_from_axes_at_the_rim_and_in_a_section() -> None:
    """A pin of 10 mm that leans by 0.3 mm on 10: -50.0 um from its axis, -47.7 at its rim, -52.3 in a flat section."""
    assembly = fixed((frame((0, 0, 0)), Axis(20.0, 10.5, inner=True)), (frame((0, 0, 0)), Axis(20.0, 10.0)))
    row = np.zeros(assembly.width)
    name = assembly.features["part.own"].moved_by[0]
    row[name.columns] = [-0.3, 0.0, 0.3, 0.0]
    q, b, half, radius = lies(assembly, row, "part.own")
    p, a, _, room = lies(assembly, row, "base.own")
    rim = room - np.linalg.norm(np.cross(surface(q, b, half, radius) - p, a), axis=1).max()
    lean = math.atan(0.03)
    assert rim == pytest.approx(-0.0477, abs=6e-5)
    assert rim == pytest.approx(0.25 - 0.3 + radius * (1.0 - math.cos(lean)), abs=2e-5)
    assert 0.25 - 0.3 + radius * (1.0 - 1.0 / math.cos(lean)) == pytest.approx(-0.0523, abs=6e-5)
    found = read(assembly, row[None])
    assert found["exact"][0] == pytest.approx(-0.05, abs=1e-12)
    assert found["analytic"][0] == pytest.approx(-0.05, abs=1e-12)


@pytest.mark.parametrize("plane", [Plane((9.0, 30.0)), RoundPlane(4.5)], ids=["narrow", "round"])
def test_a_cylinder_over_a_plane_counts_over_the_plane(plane: Plane | RoundPlane) -> None:
    """The plane has 9 mm of the 34 mm; against all points of the cylinder whose feet are within them."""
    cylinder = frame((6.0, 2.0, 8.0), (1, 0, 0)), Axis(34.0, 12.0)
    assembly = fixed((frame((0, 0, 0), (0, 0, 1), (1, 0, 0)), plane), cylinder)
    deviations = 0.01 + 0.03 * np.random.default_rng(8).normal(size=(12, assembly.width))
    found, swapped = read(assembly, deviations), read(assembly, deviations, "swapped")
    for k, row in enumerate(deviations):
        (q, b, half, radius), (p, n, _, _) = (lies(assembly, row, name) for name in ("part.own", "base.own"))
        points = surface(q, b, half, radius) - p
        x = assembly.part["base"].pose[:3, :3] @ assembly.features["base.own"].frame[:3, 0]
        x -= (x @ n) * n
        x /= np.linalg.norm(x)
        aside = np.column_stack([points @ x, points @ np.cross(n, x)])
        is_over = (aside**2).sum(axis=1) <= 4.5**2 if isinstance(plane, RoundPlane) else np.abs(aside[:, 0]) <= 4.5
        least = float((points @ n)[is_over].min())
        slope = abs(float(n @ b))
        turned_by = np.linalg.norm([n - POSE[:3, 2], b - POSE[:3, 0]])  # of both, from places 14 mm apart
        # rings are 0.21 mm apart; the lowest line of a ring lies ahead of its middle by r times the slope
        assert found["exact"][k] == pytest.approx(least, abs=0.22 * slope + radius * slope**2 + 2e-5)
        assert found["analytic"][k] == pytest.approx(found["exact"][k], abs=14.0 * float(turned_by) ** 2)
    np.testing.assert_allclose(swapped["exact"], found["exact"], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(swapped["analytic"], found["analytic"], rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(("lean", "size"), [(0.0, 5.0), (0.5, 5.0), (90.0, 5.0)])
def test_a_cylinder_on_a_plane_stands_on_its_rim(lean: float, size: float) -> None:
    """One drawn at an angle: its lowest point is on the rim of its lower end, wherever a middle is."""
    angle = math.radians(lean)
    axis = np.array([math.sin(angle), 0.0, math.cos(angle)])
    cylinder = frame((3.0, 1.0, 25.0), axis), Axis(20.0, 2 * size)
    assembly = fixed((frame((0, 0, 0), (0, 0, 1), (1, 0, 0)), Plane((80.0, 80.0))), cylinder)
    rows = 0.02 * np.random.default_rng(9).normal(size=(8, assembly.width))
    found = read(assembly, rows)
    for k, row in enumerate(rows):
        (q, b, half, radius), (p, n, _, _) = (lies(assembly, row, name) for name in ("part.own", "base.own"))
        lowest = float(((surface(q, b, half, radius) - p) @ n).min())
        assert found["exact"][k] == pytest.approx(lowest, abs=2e-5)
        assert found["analytic"][k] == pytest.approx(found["exact"][k], abs=3e-4)


def test_posts_that_lean_towards_each_other_are_nearest_at_an_end() -> None:
    """Their axes meet 2.6 m above them: once the gap of surfaces was told from there, as an overlap by both radii."""
    angle = math.radians(0.5)
    axis = np.array([-math.sin(angle), 0.0, math.cos(angle)])
    assembly = fixed((frame((0, 0, 0)), Axis(20.0, 8.0)), (frame((20.0, 0, 3.0), axis), Axis(30.0, 6.0)))
    expected = (20.0 - 7.0 * math.tan(angle)) * math.cos(angle) - 4.0 - 3.0  # from the top of the first, 7 mm higher
    found = read(assembly, np.zeros((1, assembly.width)))
    assert found["exact"][0] == pytest.approx(expected, abs=1e-9)
    assert found["analytic"][0] == pytest.approx(expected, abs=1e-9)
    rows = 0.02 * np.random.default_rng(2).normal(size=(20, assembly.width))
    both = read(assembly, rows)
    np.testing.assert_allclose(both["analytic"], both["exact"], rtol=0.0, atol=2e-4)
    for gap, row in zip(both["exact"], rows, strict=True):
        (p, a, reach, own), (q, b, half, other) = (lies(assembly, row, name) for name in ("base.own", "part.own"))
        here, there = p + np.outer(np.linspace(-reach, reach, 401), a), q + np.outer(np.linspace(-half, half, 401), b)
        apart = np.linalg.norm(here[:, None] - there[None], axis=2).min()
        assert gap == pytest.approx(float(apart) - own - other, abs=2e-4)
