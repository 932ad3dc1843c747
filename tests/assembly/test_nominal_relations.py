"""Relations that do not meet without deviations are refused where they stand, with how far they miss."""

from collections.abc import Callable
from pathlib import Path

import pytest
from scene_texts import refusal, scene_of

from tol3d.simulate import Overrides, simulation_of

SCENE = """
scene: a cover on two dowels
parts:
  base:
    kind: solid
    features:
      rim: {kind: plane, at: [50 mm, 0 mm, 20 mm], normal: [0, 0, 1], extent: [120 mm, 60 mm]}
      wall: {kind: plane, at: [50 mm, 30 mm, 25 mm], normal: [0, -1, 0], extent: [120 mm, 10 mm]}
      dowel 1: {kind: cylinder, at: [0 mm, 0 mm, 24 mm], axis: [0, 0, 1], length: 8 mm, diameter: 6 mm}
      dowel 2: {kind: cylinder, at: [100 mm, 0 mm, 24 mm], axis: [0, 0, 1], length: 8 mm, diameter: 6 mm}
  cover:
    kind: solid
    placed: {at: [0 mm, 0 mm, 20 mm]}
    features:
      seat: {kind: plane, at: [50 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [120 mm, 60 mm]}
      edge: {kind: plane, at: [50 mm, 30 mm, 5 mm], normal: [0, 1, 0], extent: [120 mm, 10 mm]}
      hole 1: {kind: cylinder, at: [0 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 6 mm, hole: true}
      hole 2: {kind: cylinder, at: [100 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 6 mm, hole: true}
      roll: {kind: cylinder, at: [50 mm, 27 mm, 5 mm], axis: [1, 0, 0], length: 40 mm, diameter: 6 mm}
tolerances:
  dowel: {kind: plus_minus, of: base.dowel 1, along: [1, 0, 0], distribution: {kind: constant, value: 0 mm}}
moves:
  set up: {kind: fix, part: base}
  closed:
    kind: mate
    part: cover
    relations:
      - {kind: coincident, from: cover.seat, to: base.rim}
      - {kind: coaxial, from: cover.hole 1, to: base.dowel 1}
      - {kind: coaxial, from: cover.hole 2, to: base.dowel 2}
measures:
  far: {kind: gap, from: base.dowel 2, to: cover.hole 2, along: [0, 1, 0]}
"""
LAST = "{kind: coaxial, from: cover.hole 2, to: base.dowel 2}"


def pitch(by: float) -> str:
    return SCENE.replace("hole 2: {kind: cylinder, at: [100 mm", f"hole 2: {{kind: cylinder, at: [{100 + by} mm")


WRONG: dict[str, tuple[Callable[[], str], str]] = {
    "another pitch": (
        lambda: pitch(0.5),
        "expected 'cover.hole 2' and 'base.dowel 2' to be coaxial without deviations, got 0.5 mm between them at "
        "(100.5, 0, 20) mm",
    ),
    "a pitch that rounding to a thousandth does not explain": (
        lambda: pitch(0.0025),
        "expected 'cover.hole 2' and 'base.dowel 2' to be coaxial without deviations, got 0.0025 mm between them at (",
    ),
    "a wall that stands elsewhere": (  # it turns the cover flat, and leaves it 2 mm behind its edge
        lambda: SCENE.replace(LAST, "{kind: coincident, from: cover.edge, to: base.wall}").replace(
            "wall: {kind: plane, at: [50 mm, 30 mm", "wall: {kind: plane, at: [50 mm, 32 mm"
        ),
        "expected 'cover.edge' and 'base.wall' to meet without deviations, got 2 mm between them at (",
    ),
    "a slanted bore": (  # 0.02 rad on 5 mm, about its middle
        lambda: SCENE.replace("axis: [0, 0, 1], length: 10 mm, diameter: 6 mm, hole: true}\n      roll", "axis: "
        "[0, 0.02, 1], length: 10 mm, diameter: 6 mm, hole: true}\n      roll"),
        "expected 'cover.hole 2' and 'base.dowel 2' to be coaxial without deviations, got 0.09998 mm between them at "
        "(100, -0.1, 20.001) mm",
    ),
    "a roll that does not lie on it": (
        lambda: SCENE.replace(LAST, "{kind: tangent, from: cover.roll, to: base.wall}").replace(
            "length: 40 mm, diameter: 6 mm", "length: 40 mm, diameter: 5 mm"
        ),
        "expected 'cover.roll' and 'base.wall' to touch without deviations, got 0.5 mm between them at (",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("change", "said"), WRONG.values(), ids=WRONG)
def test_a_relation_that_misses_is_refused_with_how_far_and_where(
    change: Callable[[], str], said: str, tmp_path: Path
) -> None:
    first = refusal(change(), tmp_path).splitlines()[0]
    assert first.startswith(f"moves.closed.relations[2]: {said}")
    assert "mm, as earlier relations leave no freedom to close it; make their places or directions agree" in first


def test_places_that_are_rounded_to_a_thousandth_meet(tmp_path: Path) -> None:
    """0.0007 mm: two numbers that are rounded to 0.001 mm; a cover that a turn brings to its dowels meets too."""
    turned = SCENE.replace("placed: {at: [0 mm, 0 mm, 20 mm]}", "placed: {at: [0 mm, 0 mm, 20 mm], x: [1, 0.1, 0]}")
    assert turned != SCENE
    for text in (SCENE, pitch(0.0007), turned):
        simulation_of(scene_of(text, tmp_path), Overrides())
