"""Two plates with pins and holes in a plane, as a text and as arrays: all centres deviate in x and y, all sizes too."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from assembly import plates
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray

Array = NDArray[np.float64]

EDGE = "{kind: point, at: [100 mm, 0 mm, 0 mm]}"
LAW = "{kind: normal, mean: 0 um, sigma: 10 um}"


def pinned_plates(at: Sequence[tuple[float, float]], hole: float, pin: float, floating: str = "{kind: centred}") -> str:
    """Pins of the lower plate at (x, y) and holes of the upper one over them, faces without deviation."""
    features: dict[str, dict[str, str]] = {"lower": {}, "upper": {}}
    tolerances = ""
    for k, (x, y) in enumerate(at):
        features["lower"][f"pin {k}"] = plates.pin((x, y, 4), pin, 8)
        features["upper"][f"hole {k}"] = plates.hole((x, y, 4), hole, 8)
        for name in (f"lower.pin {k}", f"upper.hole {k}"):
            own = name.partition(".")[2]
            for axis, along in (("x", [1, 0, 0]), ("y", [0, 1, 0])):
                tolerances += f"  {own} {axis}: {{kind: plus_minus, of: {name}, along: {along}, distribution: {LAW}}}\n"
            tolerances += f"  {own} size: {{kind: size, of: {name}, distribution: {LAW}}}\n"
    return plates.two_plates(
        features["lower"] | {"edge": EDGE},
        features["upper"] | {"edge": EDGE},
        [(f"hole {k}", f"pin {k}") for k in range(len(at))],
        tolerances,
        """
  slack: {kind: slack, of: together, lower_limit: 0 mm}
  x: {kind: gap, from: lower.edge, to: upper.edge, along: [1, 0, 0]}
  y: {kind: gap, from: lower.edge, to: upper.edge, along: [0, 1, 0]}
  turn: {kind: gap, from: lower.pin 0, to: upper.hole 0, along: [0, 1, 0]}
""",
        names=("lower", "upper"),
        move="together",
        floating=floating,
    )


def made(
    at: Sequence[tuple[float, float]], hole: float, pin: float, folder: Path, floating: str = "{kind: centred}"
) -> Assembled:
    """The scene, ready to be built."""
    return assembled(pinned_plates(at, hole, pin, floating), folder)


def deviations(pins: Array, holes: Array, pin_sizes: Array, hole_sizes: Array) -> Array:
    """Rows in the order of the contributors.

    Args:
        pins, holes: of the centres (trials, pins, 2) [mm].
        pin_sizes, hole_sizes: of the diameters (trials, pins) [mm].
    """
    each = [pins[:, :, 0], pins[:, :, 1], pin_sizes, holes[:, :, 0], holes[:, :, 1], hole_sizes]
    return np.stack(each, axis=2).reshape(len(pins), -1)
