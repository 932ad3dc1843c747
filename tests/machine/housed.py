"""Scenes of gears in a housing, and the same gears without one, for tests."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scene_texts import scene_of

from tol3d import Overrides
from tol3d.gearing.machine.system import MachineSystem
from tol3d.study.system.system import System
from tol3d.study.system.trials import Trials
from tol3d.study.trials.overrides import simulation_of

Array = NDArray[np.float64]

GEARS = """
  pinion: {kind: spur_gear, teeth: 20, module: 2.5 mm, face_width: 20 mm, expansion: 11.5e-6 1/K}
  wheel: {kind: spur_gear, teeth: 40, module: 2.5 mm, face_width: 18 mm, expansion: 11.5e-6 1/K}"""
SHAFTS = """
  first shaft: {kind: shaft, carries: {pinion: {at: 4 mm}}}
  last shaft: {kind: shaft, carries: {wheel: {at: 6 mm}}}"""
FOUR_BORES = """
      bore 1: {kind: cylinder, at: [0 mm, 0 mm, -30 mm], axis: [0, 0, 1], length: 9 mm, diameter: 9 mm, hole: true}
      bore 1b: {kind: cylinder, at: [0 mm, 0 mm, 30 mm], axis: [0, 0, 1], length: 9 mm, diameter: 9 mm, hole: true}
      bore 2: {kind: cylinder, at: [60.1 mm, 45 mm, -30 mm], axis: [0, 0, 1], length: 9 mm, diameter: 9 mm, hole: true}
      bore 2b: {kind: cylinder, at: [60.1 mm, 45 mm, 30 mm], axis: [0, 0, -1], length: 9 mm, diameter: 9 mm, hole: true}
      floor: {kind: plane, at: [0 mm, 0 mm, -40 mm], normal: [0, 0, -1], extent: [200 mm, 100 mm]}
      side: {kind: plane, at: [0 mm, -50 mm, 0 mm], normal: [0, -1, 0], extent: [200 mm, 80 mm]}
      front: {kind: plane, at: [-60 mm, 0 mm, 0 mm], normal: [-1, 0, 0], extent: [100 mm, 80 mm]}"""
LAID = """
  first in bores: {kind: shaft_in_bores, shaft: first shaft, in: [housing.bore 1, housing.bore 1b]}
  last in bores: {kind: shaft_in_bores, shaft: last shaft, in: [housing.bore 2, housing.bore 2b]}
  stage: {kind: mesh, driver: pinion, driven: wheel}"""
BACKLASH = """
  backlash: {kind: normal_backlash, of: stage}"""
ALONG = (60.1 / math.hypot(60.1, 45.0), 45.0 / math.hypot(60.1, 45.0))
"""From the first axis to the second one."""
APART = math.hypot(60.1, 45.0)


def housed_scene(
    *,
    tolerances: str,
    features: str = FOUR_BORES,
    parts: str = SHAFTS + GEARS,
    moves: str = LAID,
    measures: str = BACKLASH,
    placed: str = "{}",
    fixed: str = "\n  base: {kind: fix, part: housing}",
    more: str = "",
) -> str:
    """Two gears in a housing with four bores, 30 mm to both sides of the middle of the housing."""
    return f"""scene: housed
parts:
  housing:
    kind: solid
    expansion: 23e-6 1/K
    placed: {placed}
    features:{features}{parts}{more}
tolerances:{tolerances or " {}"}
moves:{fixed}{moves}
measures:{measures}
"""


def plain_scene(*, tolerances: str, parts: str = SHAFTS + GEARS, mesh: str = "", measures: str = BACKLASH) -> str:
    """The same gears on axes as far apart, without a housing; the driven one lies at +x."""
    return f"""scene: plain
parts:{parts}
tolerances:{tolerances}
moves:
  stage: {{kind: mesh, driver: pinion, driven: wheel, centre_distance: {APART!r} mm{mesh}}}
measures:{measures}
"""


def system_of(text: str, folder: Path) -> Any:
    """System of a scene."""
    return simulation_of(scene_of(text, folder), Overrides()).system


def gearbox_of(text: str, folder: Path) -> MachineSystem:
    """System of a scene of gears in a housing."""
    found = system_of(text, folder)
    assert isinstance(found, MachineSystem)
    return found


def values(system: System, method: str, deviations: Mapping[str, Array], turns: Array) -> dict[str, Array]:
    """Measures (trials,) [mm, rad] of builds; deviations (trials,) by column without unit, all others 0."""
    columns = [column.rpartition(" ")[0] for own in system.contributors for column in own.columns]
    assert set(deviations) <= set(columns), columns
    rows = np.zeros((len(turns), len(columns)))
    for name, own in deviations.items():
        rows[:, columns.index(name)] = own
    trials = Trials(rows, system.positions(dict.fromkeys(system.streams, turns)))
    found = system.method(method, system.materials(method)).answers(trials, list(system.measures))
    for name, codes in found.status.items():
        assert not np.any(codes), name
    return {name: own[:, 0] for name, own in found.values.items()}
