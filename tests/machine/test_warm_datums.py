"""A warm housing grows evenly, whatever the datums to which its bores are toleranced and however its part is drawn."""

import math
from pathlib import Path

import numpy as np
import pytest
from machine.housed import gearbox_of, values
from numpy.typing import NDArray
from oracles.train import involute
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

APART, ALPHA = 61.0, 23e-6
PRESSURE = math.radians(20)
BASE = 60 * math.cos(PRESSURE)  # sum of the base radii, m (z1 + z2) / 2 cos(alpha)
FRAMES = (
    *("P1, P2, P3", "P1, Pi, P3", "P1, H1", "P1, H1, H2", "P1, H1, P3", "H1, P1", "H1, P2", "H1, H2", "Hx, P1"),
    *("P1, Hx", "P1, Q1, Q2", "P1, P2, Q1", "P2, Hx, Q2", "Pi, P1, P2", "Q1, Q2, Q3", "H1-H2", "P1, H1-H2", "H1-Q1"),
    *("P1, Q1-Q2", "a, P1", "P1, {feature: P2, simulator: fitted}, P3"),
)


def backlash(apart: float) -> float:
    """Normal backlash of unshifted gears without deviations, by the involute function (ISO 21771)."""
    return 2 * BASE * (involute(math.acos(BASE / apart)) - involute(PRESSURE))


def scene(datums: str) -> str:
    """A housing whose part is drawn askew in its own frame."""
    turn, origin = Rotation.from_rotvec([0.7, -1.1, 0.4]).as_matrix(), np.array([31.0, -17.0, 44.0])

    def place(*point: float) -> str:
        return ", ".join(f"{x:.17g} mm" for x in turn @ np.array(point) + origin)

    def way(*direction: float) -> str:
        return ", ".join(f"{x:.17g}" for x in turn @ np.array(direction))

    planes = {
        "P1": ((10, 5, -40), (0, 0, -1)),
        "P2": ((5, -70, 3), (0, -1, 0)),
        "P3": ((-80, 4, 2), (-1, 0, 0)),
        "Pi": ((-60, -60, 2), (-1, -1.7, 0)),
    }
    second = (APART * math.cos(1.2), APART * math.sin(1.2))
    holes = {
        "H1": ((-50, 30, -10), (0, 0, 1)),
        "H2": ((70, -45, -20), (0, 0, 1)),
        "Hx": ((20, -30, 15), (1, 0, 0)),
        "a": ((0, 0, -30), (0, 0, 1)),
        "a2": ((0, 0, 30), (0, 0, 1)),
        "b": ((*second, -30), (0, 0, 1)),
        "b2": ((*second, 30), (0, 0, 1)),
    }
    points = {"Q1": (-70, 10, 5), "Q2": (60, 20, -5), "Q3": (0, -60, 30)}
    features = "".join(
        f"      {name}: {{kind: plane, at: [{place(*at)}], normal: [{way(*normal)}], extent: [80 mm, 60 mm]}}\n"
        for name, (at, normal) in planes.items()
    )
    features += "".join(
        f"      {name}: {{kind: cylinder, at: [{place(*at)}], axis: [{way(*axis)}], length: 12 mm, diameter: 9 mm, "
        "hole: true}\n"
        for name, (at, axis) in holes.items()
    )
    features += "".join(f"      {name}: {{kind: point, at: [{place(*at)}]}}\n" for name, at in points.items())
    zone = "zone: {diameter: 20 um}, law: {kind: uniform}"
    return f"""scene: warm
parts:
  housing:
    kind: solid
    expansion: {ALPHA} 1/K
    features:
{features}  g: {{kind: spur_gear, teeth: 20, module: 2 mm, face_width: 16 mm}}
  w: {{kind: spur_gear, teeth: 40, module: 2 mm, face_width: 14 mm}}
tolerances:
  near: {{kind: position, of: housing.b, datums: [{datums}], {zone}}}
  far: {{kind: position, of: housing.b2, datums: [{datums}], {zone}}}
  T: {{kind: temperature, of: housing, distribution: {{kind: normal, mean: 10 K, sigma: 5 K}}}}
moves:
  base: {{kind: fix, part: housing}}
  la: {{kind: shaft_in_bores, shaft: g, in: [housing.a, housing.a2]}}
  lb: {{kind: shaft_in_bores, shaft: w, in: [housing.b2, housing.b]}}
  mesh: {{kind: mesh, driver: g, driven: w}}
measures:
  j: {{kind: normal_backlash, of: mesh}}
  d: {{kind: distance, from: housing.Q1, to: housing.Hx}}
"""


@pytest.mark.parametrize("datums", FRAMES)
def test_axes_move_apart_and_nothing_else(datums: str, tmp_path: Path) -> None:
    system = gearbox_of(scene(datums), tmp_path)
    kelvin = np.array([0.0, 40.0, -60.0])
    found = {method: values(system, method, {"T": kelvin}, np.full(3, 0.3)) for method in ("exact", "analytic")}
    np.testing.assert_allclose(found["exact"]["j"], [backlash(APART * (1 + ALPHA * t)) for t in kelvin], atol=1e-8)
    slope = 2 * math.sqrt(1 - (BASE / APART) ** 2) * APART * ALPHA
    np.testing.assert_allclose(found["analytic"]["j"], backlash(APART) + slope * kelvin, atol=1e-8)
    away = math.dist((-70, 10, 5), (20, -30, 15))
    for method in found:
        np.testing.assert_allclose(found[method]["d"], away * (1 + ALPHA * kelvin), rtol=0, atol=1e-9)
