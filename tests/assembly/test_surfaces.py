"""Distances of surfaces and directions of their normals, against distances and central differences."""

from dataclasses import replace

import numpy as np
import pytest
from assembly.drafts import Draft, frame, turned
from assembly.random_touches import KINDS, TWO, RandomTouch, random_touch
from numpy.typing import NDArray
from oracles.rigid_parts import RigidParts
from scipy.optimize import lsq_linear

from tol3d.assembly.grammar.measures.gap import SurfaceGapSpec
from tol3d.assembly.model import Assembly, Axis, Fix, Measured, Plane, Point, RoundPlane
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors

Array = NDArray[np.float64]

INNER = ("ball in socket", "socket on ball", "ball in bore", "bore on ball", "cylinder in bore", "bore on cylinder")


def fixed(kind: str) -> RandomTouch:
    """A pair of surfaces that touch nominally, both parts where they are drawn."""
    made = random_touch(100 + KINDS.index(kind), kinds=(kind,))
    return replace(made, assembly=replace(made.assembly, moves=(made.assembly.moves[0], Fix("part", "part"))))


def least_of_lines(made: RandomTouch, row: Array) -> float:
    """Least gap of a cylinder over the length that both surfaces have [mm].

    At points of its axis, dense between the ends of that length; of cylinders outside each other from the two points of
    their axes that are nearest, by bounded least squares.
    """
    contact, rigid = made.touch.contacts[0], RigidParts(made.assembly, row, {})
    poses = {name: made.assembly.part[name].pose for name in ("base", "part")}
    held = ("base.plane", "part.plane", "base.bore", "part.bore")
    names = sorted((contact.moving, contact.target), key=lambda own: not own.startswith(held))
    (p, a), (q, b) = ((rigid.origin(name, poses), rigid.z(name, poses)) for name in names)
    features = [made.assembly.features[name] for name in names]
    # an axis that leans passes through its ends, at the heights that they have when it does not
    reach, half = (0.5 * own.shape.length / float(rigid.on_part(own.name)[1] @ own.frame[:3, 2])
                   if isinstance(own.shape, Axis) else 0.0 for own in features)  # fmt: skip
    radii = [made.radius(name, row) for name in names]
    other = features[0].shape
    if not isinstance(other, Axis):
        assert isinstance(other, (Plane, RoundPlane))
        x = np.cross(poses[features[0].part][:3, :3] @ features[0].frame[:3, 1], a)
        x, y = x / np.linalg.norm(x), np.cross(a, x / np.linalg.norm(x))
        places = np.linspace(-half, half, 200_001)
        aside = np.array([(q - p + np.outer(places, b)) @ side for side in (x, y)])
        if isinstance(other, RoundPlane):
            is_over = np.hypot(*aside) <= other.radius
        else:
            is_over = (np.abs(aside) <= np.reshape(other.reach, (2, 1))).all(axis=0)
        heights = a @ (q - p) + places * (a @ b)
        return float(heights[is_over if is_over.any() else ...].min()) - radii[1] * float(
            np.linalg.norm(np.cross(a, b))
        )
    if not other.inner:  # outside each other
        bounds = ([-half, -reach], [half, reach])
        nearest = lsq_linear(np.column_stack([b, -a]), p - q, bounds, method="bvls", tol=1e-14)
        return float(np.linalg.norm(nearest.fun)) - sum(radii)
    middle, step = float(a @ (q - p)), float(a @ b)
    feet = sorted(((-reach - middle) / step, (reach - middle) / step))
    low, high = sorted((max(-half, feet[0]), min(half, feet[1])))
    places = q - p + np.outer(np.linspace(low, high, 2001), b)
    return radii[0] - radii[1] - float(np.linalg.norm(np.cross(places, a), axis=1).max())


def read(assembly: Assembly, name: str, deviations: Array) -> Array:
    values, codes = placing.values(assembly, deviations, [name])[name]
    assert (codes == OK).all()
    return values


@pytest.mark.parametrize("kind", KINDS)
def test_gaps_and_angles(kind: str) -> None:
    made, touching = fixed(kind), random_touch(100 + KINDS.index(kind), kinds=(kind,))
    made = RandomTouch(replace(touching.assembly, moves=made.assembly.moves), touching.kinds)
    deviations = np.random.default_rng(1).normal(size=(5, made.assembly.width)) * 0.05
    gaps, angles = (read(made.assembly, name, deviations) for name in ("gap 0", "angle 0"))
    pose, sign = made.assembly.part["part"].pose, -1.0 if kind in INNER else 1.0
    contact = touching.touch.contacts[0]
    for row, gap, angle in zip(deviations, gaps, angles, strict=True):
        lacking = RandomTouch(touching.assembly, touching.kinds)
        expected = least_of_lines(lacking, row) if kind in TWO else sign * lacking.errors(row, pose)[0]
        # over a plane from points 0.15 um apart, and of a plane drawn, not tilted, over lines with slopes of some 1e-2
        assert gap == pytest.approx(expected, abs=5e-6 if "plane" in kind else 1e-8 if kind in TWO else 1e-9)
        normal = np.empty(3)
        for k, step in enumerate(1e-4 * np.eye(3)):
            sides = []
            for way in (1.0, -1.0):
                moved = pose.copy()
                moved[:3, 3] += way * step
                sides.append(lacking.errors(row, moved)[0])
            normal[k] = (sides[0] - sides[1]) / 2e-4
        plane = RigidParts(touching.assembly, row, {}).z("base.side", {"base": touching.assembly.part["base"].pose})
        assert angle == pytest.approx(float(np.arccos(normal @ plane)), abs=1e-7), contact


@pytest.mark.parametrize("kind", KINDS)
def test_small_displacements_leave_out_the_second_order(kind: str) -> None:
    made = fixed(kind)
    deviations = np.random.default_rng(2).normal(size=(20, made.assembly.width)) * 0.05
    for name in ("gap 0", "angle 0"):
        whole, tenth = (
            np.abs(read(made.assembly, name, own) - torsors.values(made.assembly, own, [name])[name]).max()
            for own in (deviations, 0.1 * deviations)
        )
        assert whole < 5e-2
        assert tenth < 1.3e-2 * whole + 1e-11


@pytest.mark.parametrize("inner", ["pin", "ball"])
def test_what_lies_in_the_middle_of_its_hole(inner: str) -> None:
    """No side is the near one nominally: the gap is the clearance less how far the middles are apart."""
    draft = Draft()
    draft.part("base", turned((0.3, 0.2, 0.5), (20, 10, 0)))
    draft.part("part", draft.poses["base"])
    draft.feature("base.hole", frame((5, 0, 0), (1, 0, 2)), Axis(20.0, 10.0, inner=True))
    draft.feature("part.inner", frame((5, 0, 0), (1, 0, 2)), Axis(30.0, 9.0) if inner == "pin" else Point(9.0))
    for name in ("base.hole", "part.inner"):
        draft.size(name)
    moves = (Fix("base fixed", "base"), Fix("part fixed", "part"))
    assembly = draft.assembly(moves, {"gap": Measured(SurfaceGapSpec.reads, ("base.hole", "part.inner"))})
    deviations = np.random.default_rng(3).normal(size=(200, assembly.width)) * 0.05
    z = np.array([1.0, 0.0, 2.0]) / np.sqrt(5.0)
    expected = []
    for row in deviations:
        rigid = RigidParts(assembly, row, {})
        (p, a), (q, b) = rigid.on_part("base.hole"), rigid.on_part("part.inner")
        radii = [(own + sum(float(row[each.columns].sum()) for each in assembly.features[name].size_by)) / 2
                 for name, own in (("base.hole", 10.0), ("part.inner", 9.0))]  # fmt: skip
        ends = [step / (a @ z) for step in (-10.0, 10.0)]  # of the hole, for the pin is longer
        apart = [q - p + (end - (q - p) @ a) / (a @ b) * b for end in ends] if inner == "pin" else [q - p]
        expected.append(radii[0] - radii[1] - max(np.linalg.norm(np.cross(a, own)) for own in apart))
        assert abs(a @ z - 1.0) < 1e-3
    np.testing.assert_allclose(read(assembly, "gap", deviations), expected, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(torsors.values(assembly, deviations, ["gap"])["gap"], expected, rtol=0.0, atol=2e-3)
    np.testing.assert_allclose(
        torsors.values(assembly, 0.01 * deviations, ["gap"])["gap"],
        read(assembly, "gap", 0.01 * deviations),
        rtol=0.0,
        atol=2e-7,
    )
