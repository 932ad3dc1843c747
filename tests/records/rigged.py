"""The digest's reference pair, and synthetic measurements of it without files."""

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tol3d.apps.records.csv_file import Block
from tol3d.apps.records.findings import Identified, Settings
from tol3d.apps.records.identification import identified
from tol3d.apps.records.pair import ARCSEC, RigPair, Side, Specimen, angular_backlash
from tol3d.apps.records.reading import Pass, Senses, passes_of
from tol3d.apps.records.rig import Rig, measured

COS = math.cos(math.radians(20))
PAIR = RigPair(27, 48, 27 * COS, 48 * COS, 75.0)
REFERENCE = Specimen(PAIR, 0.018, math.radians(40), 0.027, math.radians(-65), 0.060)
"""z 27/48, m 2, alpha 20 deg, a 75 mm: the pair whose numbers the digest of the paper states."""

LEAST, LARGEST, START = 133.914, 415.027, 267.037
"""Its backlash over the long period and at phi1 = 0 [arcsec], see test_exact_play."""

SCENE = """
scene: reference pair
parts:
  driver: {kind: spur_gear, teeth: 27, module: 2 mm, pressure_angle: 20 deg, face_width: 20 mm}
  driven: {kind: spur_gear, teeth: 48, module: 2 mm, pressure_angle: 20 deg, face_width: 20 mm}
tolerances:
  thinner teeth: {kind: tooth_thickness, of: driven, distribution: {kind: constant, value: -60 um}}
moves:
  pair: {kind: mesh, driver: driver, driven: driven, centre_distance: 75 mm, working_flank: FLANK}
measures:
  backlash: {kind: angular_backlash, of: pair, gear: driven}
study: {trials: 2, seed: 1}
"""


def scene_in(folder: Path, flank: str = "left") -> Path:
    path = folder / "pair.yaml"
    path.write_text(SCENE.replace("FLANK", flank), encoding="utf-8")
    return path


def passes(specimen: Specimen, rig: Rig, side: Side, senses: Senses | None = None) -> tuple[Pass, ...]:
    rows = measured(specimen, rig, side)
    block = Block(0, rows.phi1, rows.phi2, rows.torque, rows.repeat)
    return tuple(passes_of(specimen.pair, Path(f"{side}.csv"), [block], senses or Senses(1, 1)))


def identified_by(specimen: Specimen, rig: Rig, settings: Settings | None = None) -> Identified:
    read: Mapping[Side, tuple[Pass, ...]] = {
        "drive": passes(specimen, rig, "drive"),
        "back": passes(specimen, rig, "back"),
    }
    return identified(specimen.pair, read, Senses(1, 1), settings or Settings())


def arcsec(angle: float) -> float:
    return angle / ARCSEC


def within(found: Identified, truth: Specimen) -> dict[str, bool]:
    """Which of the eccentricities lie inside their 95 % intervals."""
    true = {"e1": truth.e1, "theta1": truth.theta1, "e2": truth.e2, "theta2": truth.theta2, "jc": truth.constant_part}
    inside = {}
    for name, value in true.items():
        own = found.figures[name]
        off = own.value - value
        off = math.remainder(off, 2 * math.pi) if name.startswith("theta") else off
        inside[name] = abs(off) <= own.half_width
    return inside


def ends_of(specimen: Specimen) -> tuple[float, float]:
    """Least and largest backlash over the long period [rad], by first principles on a fine grid."""
    phi1 = np.linspace(0.0, specimen.pair.long_period, 720 * specimen.pair.long_period_turns, endpoint=False)
    backlash = angular_backlash(specimen, phi1)
    return float(backlash.min()), float(backlash.max())
