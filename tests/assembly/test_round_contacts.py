"""Balls and pins are no points: 3-2-1, six planes and rests, which would lay them by their middles, refuse them."""

from pathlib import Path

import pytest
from assembly_trials import assembled
from scene_texts import refusal

BALL = "{{kind: sphere, at: [{x} mm, {y} mm, 5 mm], diameter: 10 mm}}"
PLACES = ((-50, -50), (50, -50), (0, 50))


def scene(move: str, feature: str = BALL) -> str:
    balls = "".join(f"      ball {k}: {feature.format(x=x, y=y)}\n" for k, (x, y) in enumerate(PLACES, 1))
    return f"""
scene: a plate on balls
parts:
  table:
    kind: solid
    features:
      top: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [200 mm, 200 mm]}}
      pin: {{kind: point, at: [0 mm, 0 mm, 5 mm]}}
  plate:
    kind: solid
    features:
{balls}moves:
  set up: {{kind: fix, part: table}}
  lay:
    part: plate
{move}measures:
  height: {{kind: point_plane, from: plate.ball 1, to: table.top}}
"""


def contacts(*others: str) -> str:
    return "".join(f"      - {{from: plate.ball {k}, to: table.top}}\n" for k in (1, 2, 3)) + "".join(others)


REST = f"    kind: rest\n    force: {{direction: [0, 0, -1], at: [0 mm, 0 mm, 9 mm]}}\n    contacts:\n{contacts()}"
SIDES = [
    f"      - {{from: plate.ball {k}, to: table.pin, along: {n}}}\n" for k, n in ((1, "[1, 0, 0]"), (2, "[0, 1, 0]"))
]
SIX = f"    kind: six_plane\n    pairs:\n{contacts(*SIDES, SIDES[0].replace('ball 1', 'ball 3'))}"


@pytest.mark.parametrize(
    ("move", "key", "remedy"),
    [
        (REST, "contacts", "name the point of its surface that touches, for a rest has no round contacts"),
        (SIX, "pairs", "take a move of kind touch, or name the point of its surface that touches"),
    ],
    ids=["rest", "six planes"],
)
def test_balls_are_refused_at_each_contact(move: str, key: str, remedy: str, tmp_path: Path) -> None:
    assert refusal(scene(move), tmp_path).splitlines() == [
        f"moves.lay.{key}[{k - 1}].from: expected a point or a plane, got 'plate.ball {k}', which is a sphere: its "
        f"middle would lie there; {remedy}"
        for k in (1, 2, 3)
    ]


def test_a_middle_that_is_meant_is_named_as_a_point_or_located_along_a_direction(tmp_path: Path) -> None:
    """Points on the plane; their places along it by the middle of whatever is named with its direction."""
    points = scene(SIX, "{{kind: point, at: [{x} mm, {y} mm, 0 mm]}}")
    assert assembled(points, tmp_path).nominal["height"] == pytest.approx(0.0, abs=1e-9)
    feet = "      foot {k}: {{kind: point, at: [{x} mm, {y} mm, 0 mm]}}\n"
    added = "".join(feet.format(k=k, x=x, y=y) for k, (x, y) in enumerate(PLACES, 1))
    mixed = scene(SIX).replace("moves:\n", f"{added}moves:\n", 1)
    for k in (1, 2, 3):
        mixed = mixed.replace(f"from: plate.ball {k}, to: table.top", f"from: plate.foot {k}, to: table.top", 1)
    assert assembled(mixed, tmp_path).nominal["height"] == pytest.approx(5.0, abs=1e-9)
