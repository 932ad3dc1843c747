"""A wall that slants in a 3-2-1: contacts are along its own normal, so that a lifted part slides aside."""

from pathlib import Path

import pytest
from assembly_trials import assembled, point

FLOOR, WALL, STOP = ((10, 10), (110, 10), (60, 70)), (10, 110), 40.0
LIFT, SLANT = 0.1, 0.3


def scene(points_on: str) -> str:
    """A cover on points of a base, lifted by the three on its floor; its wall leans by SLANT."""
    normals: dict[str, list[float]] = {"a": [0, 0, 1], "b": [0, 1, SLANT], "c": [1, 0, 0]}
    places: dict[str, tuple[float, ...]] = {f"a{k}": (*at, 0) for k, at in enumerate(FLOOR, 1)}
    places |= {f"b{k}": (x, 0, 3) for k, x in enumerate(WALL, 1)} | {"c1": (0, STOP, 3)}
    base = "".join(f"      {name}: {point(at, normals[name[0]])}\n" for name, at in places.items())
    out = "".join(f"      {name}: {point(at, [-n for n in normals[name[0]]])}\n" for name, at in places.items())
    pairs = {name: f"{{from: cover.{name}, to: base.{name}}}" for name in places}
    groups = {"primary": "a", "secondary": "b", "tertiary": "c"}
    named = "".join(
        f"    {group}: [{', '.join(pair for name, pair in pairs.items() if name[0] == letter)}]\n"
        for group, letter in groups.items()
    )
    lifts = "".join(
        f"  lift {k}: {{kind: locator, of: lay, pair: primary {k}, "
        f"distribution: {{kind: constant, value: {LIFT} mm}}}}\n"
        for k in (1, 2, 3)
    )
    return f"""
scene: a slanted wall
parts:
  base: {{kind: solid, features: {{zero: {point((50, 30, 0))}}}}}
  table:
    kind: solid
    features:
{base.replace("cover", "table")}
  cover:
    kind: solid
    features:
      zero: {point((50, 30, 0))}
{out}
tolerances:
{lifts}
moves:
  still: {{kind: fix, part: base}}
  set: {{kind: fix, part: table}}
  lay:
    kind: three_two_one
    part: cover
    points_on: {points_on}
{named.replace("base.", "table.")}
measures:
  x: {{kind: gap, from: base.zero, to: cover.zero, along: [1, 0, 0]}}
  y: {{kind: gap, from: base.zero, to: cover.zero, along: [0, 1, 0]}}
  z: {{kind: gap, from: base.zero, to: cover.zero, along: [0, 0, 1]}}
"""


@pytest.mark.parametrize("points_on", ["part", "fixture"])
@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_part_that_is_lifted_slides_aside_along_a_slanted_wall(tmp_path: Path, points_on: str, method: str) -> None:
    """The wall is touched still: (0, 1, s) . (0, y, lift) = 0; nothing turns, so that this is exact."""
    found = assembled(scene(points_on), tmp_path).drawn(1, method)
    assert found["z"][0] == pytest.approx(LIFT, abs=1e-12)
    assert found["y"][0] == pytest.approx(-SLANT * LIFT, abs=1e-12)
    assert found["x"][0] == pytest.approx(0.0, abs=1e-12)
