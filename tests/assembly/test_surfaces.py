"""Distances of surfaces and directions of their normals, against distances and central differences."""

from dataclasses import replace

import numpy as np
import pytest
from drafts import Draft, frame, turned
from numpy.typing import NDArray
from random_touches import KINDS, RandomTouch, random_touch
from rigid_parts import RigidParts

from tol3d.assembly.grammar.measures.contact import SurfaceGapSpec
from tol3d.assembly.model import Assembly, Axis, Fix, Measured, Point
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors

Array = NDArray[np.float64]

INNER = ("ball in socket", "socket on ball", "ball in bore", "bore on ball", "cylinder in bore", "bore on cylinder")


def fixed(kind: str) -> RandomTouch:
    """A pair of surfaces that touch nominally, both parts where they are drawn."""
    made = random_touch(100 + KINDS.index(kind), kinds=(kind,))
    return replace(made, assembly=replace(made.assembly, moves=(made.assembly.moves[0], Fix("part", "part"))))


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
        assert gap == pytest.approx(sign * lacking.errors(row, pose)[0], abs=1e-9)
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
        (p, a), (q, _) = rigid.on_part("base.hole"), rigid.on_part("part.inner")
        radii = [(own + sum(float(row[each.columns].sum()) for each in assembly.features[name].size_by)) / 2
                 for name, own in (("base.hole", 10.0), ("part.inner", 9.0))]  # fmt: skip
        expected.append(radii[0] - radii[1] - np.linalg.norm(np.cross(a, q - p)))
        assert abs(a @ z - 1.0) < 1e-3
    np.testing.assert_allclose(read(assembly, "gap", deviations), expected, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(torsors.values(assembly, deviations, ["gap"])["gap"], expected, rtol=0.0, atol=2e-3)
    np.testing.assert_allclose(
        torsors.values(assembly, 0.01 * deviations, ["gap"])["gap"],
        read(assembly, "gap", 0.01 * deviations),
        rtol=0.0,
        atol=2e-7,
    )
