"""Two plates with pins and holes in a plane, as a text and as arrays: all centres deviate in x and y, all sizes too."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray

Array = NDArray[np.float64]

LAW = "{kind: normal, mean: 0 um, sigma: 10 um}"


def plates(at: Sequence[tuple[float, float]], hole: float, pin: float, floating: str = "{kind: centred}") -> str:
    """Pins of the lower plate at (x, y) and holes of the upper one over them, faces without deviation."""
    features: dict[str, str] = {"lower": "", "upper": ""}
    tolerances = ""
    for k, (x, y) in enumerate(at):
        for part, name, size, extra in (("lower", "pin", pin, ""), ("upper", "hole", hole, ", hole: true")):
            features[part] += (
                f"      {name} {k}: {{kind: cylinder, at: [{x} mm, {y} mm, 4 mm], axis: [0, 0, 1], length: 8 mm, "
                f"diameter: {size} mm{extra}}}\n"
            )
            for axis, along in (("x", [1, 0, 0]), ("y", [0, 1, 0])):
                tolerances += (
                    f"  {name} {k} {axis}: {{kind: plus_minus, of: {part}.{name} {k}, along: {along}, "
                    f"distribution: {LAW}}}\n"
                )
            tolerances += f"  {name} {k} size: {{kind: size, of: {part}.{name} {k}, distribution: {LAW}}}\n"
    pairs = "".join(f"      - {{from: upper.hole {k}, to: lower.pin {k}}}\n" for k in range(len(at)))
    face = "{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, %d], extent: [200 mm, 200 mm]}"
    return f"""
scene: plates with pins
parts:
  lower:
    kind: solid
    features:
      face: {face % 1}
      edge: {{kind: point, at: [100 mm, 0 mm, 0 mm]}}
{features["lower"]}
  upper:
    kind: solid
    features:
      face: {face % -1}
      edge: {{kind: point, at: [100 mm, 0 mm, 0 mm]}}
{features["upper"]}
tolerances:
{tolerances}
moves:
  table: {{kind: fix, part: lower}}
  together:
    kind: pattern
    part: upper
    relations: [{{kind: coincident, from: upper.face, to: lower.face}}]
    pairs:
{pairs}
    float: {floating}
measures:
  slack: {{kind: slack, of: together, lower_limit: 0 mm}}
  x: {{kind: gap, from: lower.edge, to: upper.edge, along: [1, 0, 0]}}
  y: {{kind: gap, from: lower.edge, to: upper.edge, along: [0, 1, 0]}}
  turn: {{kind: gap, from: lower.pin 0, to: upper.hole 0, along: [0, 1, 0]}}
"""


def made(
    at: Sequence[tuple[float, float]], hole: float, pin: float, folder: Path, floating: str = "{kind: centred}"
) -> Assembled:
    """The scene, ready to be built."""
    return assembled(plates(at, hole, pin, floating), folder)


def deviations(pins: Array, holes: Array, pin_sizes: Array, hole_sizes: Array) -> Array:
    """Rows in the order of the contributors.

    Args:
        pins, holes: of the centres (trials, pins, 2) [mm].
        pin_sizes, hole_sizes: of the diameters (trials, pins) [mm].
    """
    each = [pins[:, :, 0], pins[:, :, 1], pin_sizes, holes[:, :, 0], holes[:, :, 1], hole_sizes]
    return np.stack(each, axis=2).reshape(len(pins), -1)
