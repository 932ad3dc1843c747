"""Problem 15's plate: a hole in a datum frame whose datums deviate themselves, and its moments by hand."""

import numpy as np
from assembly_trials import point

SIGMAS = {"b1": 0.03, "b2": 0.03, "c": 0.02, "ex": 0.04, "ey": 0.04}

# datums are points whose deviations into the material are positive here: along +y and +x
PLATE = """
scene: a plate on its datums
parts:
  plate:
    kind: solid
    features:
      floor: {{kind: plane, at: [100 mm, 50 mm, 0 mm], normal: [0, 0, -1], extent: [200 mm, 100 mm]}}
      b1: {b1}
      b2: {b2}
      c: {c}
      hole: {{kind: axis, at: [150 mm, 60 mm, 0 mm], axis: [0, 0, 1], length: 10 mm}}
tolerances:
  b1 off: {{kind: plus_minus, of: plate.b1, along: [0, 1, 0], distribution: {laws[b1]}}}
  b2 off: {{kind: plus_minus, of: plate.b2, along: [0, 1, 0], distribution: {laws[b2]}}}
  c off: {{kind: plus_minus, of: plate.c, along: [1, 0, 0], distribution: {laws[c]}}}
  hole x: {{kind: plus_minus, of: plate.hole, along: [1, 0, 0], distribution: {laws[ex]}}}
  hole y: {{kind: plus_minus, of: plate.hole, along: [0, 1, 0], distribution: {laws[ey]}}}
moves:
  machine: {{kind: fix, part: plate}}
measures:
  position: {{kind: inspected_position, of: plate.hole, datums: [floor, b1-b2, c], upper_limit: 0.3 mm}}
  in the machine: {{kind: inspected_position, of: plate.hole}}
"""


def plate(laws: dict[str, str]) -> str:
    places = {"b1": (20, 0, 0), "b2": (180, 0, 0), "c": (0, 50, 0)}
    return PLATE.format(laws=laws, **{name: point(at) for name, at in places.items()})


def covariance() -> np.ndarray:
    """Covariance of dx and dy [mm^2]: dx = ex - c + (60 - 50)/160 (b2 - b1), dy = ey - 0.1875 b1 - 0.8125 b2."""
    rows = np.array([[-1 / 16, 1 / 16, -1, 1, 0], [-0.1875, -0.8125, 0, 0, 1]])
    return np.asarray(rows @ np.diag(np.square(list(SIGMAS.values()))) @ rows.T)
