"""A plate with four holes and four pads, each in two segments, drawn in any coordinates."""

from collections.abc import Mapping

import numpy as np
from assembly_trials import Assembled
from numpy.typing import NDArray

Array = NDArray[np.float64]

HOLES = [f"plate.hole {k}" for k in range(1, 5)]


def plate(
    law: str = "uniform",
    lower: str = "zone: {diameter: 0.1 mm}, datums: [A]",
    upper: str = "{diameter: 0.3 mm}",
    datums: str = "[A, B, C]",
    turn: Array | None = None,
    at: Array | None = None,
    more: str = "",
) -> str:
    """A plate with four holes, and four pads on top, drawn in any coordinates."""
    turn, at = np.eye(3) if turn is None else turn, np.zeros(3) if at is None else at

    def place(*point: float) -> str:
        return "[" + ", ".join(f"{own!r} mm" for own in (turn @ point + at).tolist()) + "]"

    def way(*direction: float) -> str:
        return str((turn @ direction).tolist())

    def plane(point: tuple[float, ...], normal: tuple[float, ...], extent: str, along: tuple[float, ...]) -> str:
        return f"{{kind: plane, at: {place(*point)}, normal: {way(*normal)}, extent: {extent}, along: {way(*along)}}}"

    grid = f"rows: 2, columns: 2, pitch: [40 mm, 20 mm], along: {way(1, 0, 0)}, across: {way(0, 1, 0)}"
    hole = f"kind: cylinder, at: {place(-20, -10, 5)}, axis: {way(0, 0, 1)}, length: 10 mm, diameter: 8 mm, hole: true"
    pad = plane((-20, -10, 12), (0, 0, 1), "[6 mm, 4 mm]", (1, 0, 0))[:-1]
    holes = ", ".join(HOLES)
    return f"""scene: plate
parts:
  plate:
    kind: solid
    features:
      A: {plane((0, 0, 0), (0, 0, -1), "[100 mm, 60 mm]", (1, 0, 0))}
      B: {plane((0, -30, 5), (0, -1, 0), "[100 mm, 10 mm]", (1, 0, 0))}
      C: {plane((-50, 0, 5), (-1, 0, 0), "[60 mm, 10 mm]", (0, 1, 0))}
      edge: {{kind: point, at: {place(50, 0, 10)}, normal: {way(1, 0, 0)}}}
      hole: {{{hole}, pattern: {{{grid}}}}}
      pad: {pad}, pattern: {{{grid}}}}}
tolerances:
  A: {{kind: profile, of: plate.A, zone: {{width: 0.05 mm}}, law: {{kind: uniform}}}}
  holes:
    kind: position
    of: plate.hole
    zone: {upper}
    law: {{kind: {law}}}
    datums: {datums}
    lower_segment: {{{lower}}}
  pads:
    kind: profile
    of: plate.pad
    zone: {{width: 0.2 mm}}
    law: {{kind: {law}}}
    datums: [A, B, C]
    lower_segment: {{zone: {{width: 0.05 mm}}}}
{more}moves:
  bench: {{kind: fix, part: plate}}
measures:
  x: {{kind: gap, from: plate.hole 1, to: plate.edge, along: {way(1, 0, 0)}}}
  pad: {{kind: gap, from: plate.A, to: plate.pad 3, along: {way(0, 0, 1)}}}
  upper: {{kind: inspected_position, of: plate.hole 2, datums: [A, B, C]}}
  lower: {{kind: inspected_pattern, of: [{holes}], free: shift_and_turn, datums: [A]}}
"""


def columns(made: Assembled) -> Mapping[str, slice]:
    return {own.name: where for own, where in made.slices}
