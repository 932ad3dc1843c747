"""An arm of three joints with spur stages, and where its tool is by homogeneous matrices of our own."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from machine.housed import Array
from scene_texts import scene_of

from tol3d import Overrides
from tol3d.gearing.machine.system import MachineSystem
from tol3d.study.system.stated import component_slices
from tol3d.study.system.trials import Trials
from tol3d.study.trials.overrides import simulation_of

STAGE = """
  pinion {k}: {{kind: spur_gear, teeth: 19, module: 1 mm, face_width: 10 mm}}
  wheel {k}: {{kind: spur_gear, teeth: 57, module: 1 mm, face_width: 8 mm}}"""
THIN = """
  pinion {k} thickness:
    {{kind: tooth_thickness, of: pinion {k}, distribution: {{kind: normal, lower: -60 um, upper: -30 um}}}}
  wheel {k} run-out: {{kind: eccentricity, of: wheel {k}, distribution: {{kind: rayleigh, scale: 5 um}}}}"""
DRIVE = """
  stage {k}: {{kind: mesh, driver: pinion {k}, driven: wheel {k}, centre_distance: 38 mm, working_flank: either}}
  drive {k}: {{kind: train, driven: pinion {k}, output: wheel {k}}}"""
BORES = """
  bore {k}: {{kind: position, of: {of}, zone: {{diameter: 50 um}}, law: {{kind: uniform}}, {datums}}}"""
POSES = {"home": (0.0, 0.0, 0.0), "up": (30.0, 70.0, -45.0)}
AXES = (
    ((0.0, 0.0, 200.0), (0.0, 0.0, 1.0)),
    ((50.0, 0.0, 300.0), (0.0, -1.0, 0.0)),
    ((450.0, 20.0, 330.0), (0.0, -0.6, 0.8)),
)
"""Points and directions of the three axes in the world at inputs 0."""
TOOL = (750.0, -10.0, 320.0)
MASSES = ((1, 10.0, (200.0, 0.0, 0.0)), (2, 5.0, (150.0, 0.0, 0.0)))
"""Links by their places, kg, and where."""


def vector(numbers: Any, unit: str = " mm") -> str:
    """As scenes write it."""
    return "[" + ", ".join(f"{number:.9g}{unit}" for number in numbers) + "]"


def arm_scene(
    *,
    axes: Sequence[tuple[Any, Any]] = AXES,
    tool: Sequence[float] = TOOL,
    poses: Mapping[str, Sequence[float]] = POSES,
    masses: Sequence[tuple[int, float, Any]] = MASSES,
    bores: bool = True,
    measures: str,
    gravity: str = "\n    gravity: [0, 0, -1]",
) -> str:
    """An arm whose links lie at inputs 0 with their axes in the world as stated, their frames turned as the world's."""
    parts, tolerances, moves, joints = "", "", "\n  stand: {kind: fix, part: base}", ""
    for k, (at, z) in enumerate(axes):
        before = np.zeros(3) if k == 0 else np.array(axes[k - 1][0])
        host = "base" if k == 0 else f"link {k}"
        bore, pilot = (
            f"{{kind: cylinder, at: {vector(there)}, axis: {vector(z, '')}, length: 20 mm, diameter: 60 mm{hole}}}"
            for there, hole in ((np.array(at) - before, ", hole: true"), (np.zeros(3), ""))
        )
        if k == 0:
            parts += f"\n  base: {{kind: solid, features: {{bore: {bore}}}}}"
        else:
            parts += f"\n      bore: {bore}"
        parts += (
            f"\n  link {k + 1}:\n    kind: solid\n    placed: {{at: {vector(at)}}}\n    features:\n      pilot: {pilot}"
        )
        if bores:
            tolerances += BORES.format(k=k + 1, of=f"{host}.bore", datums="" if k == 0 else "datums: [pilot]")
        tolerances += THIN.format(k=k + 1)
        moves += DRIVE.format(k=k + 1)
        joints += f"\n      joint {k + 1}: {{between: [{host}.bore, link {k + 1}.pilot], train: drive {k + 1}}}"
    last = np.array(axes[-1][0])
    parts += f"\n      tool: {{kind: point, at: {vector(np.array(tool) - last)}}}"
    parts += "".join(STAGE.format(k=k + 1) for k in range(len(axes)))
    named = "".join(
        f"\n      {pose}: {{" + ", ".join(f"joint {k + 1}: {own} deg" for k, own in enumerate(inputs)) + "}"
        for pose, inputs in poses.items()
    )
    its = "".join(f"\n      - {{of: link {k + 1}, mass: {mass} kg, at: {vector(at)}}}" for k, mass, at in masses)
    own = f"\n    masses:{its}" if masses else ""
    chain = f"\n  arm:\n    kind: open_chain\n    joints:{joints}\n    poses:{named}{gravity}{own}"
    said = f"scene: arm\nparts:{parts}\ntolerances:{tolerances}\nmoves:{moves}{chain}\nmeasures:{measures}"
    return f"{said}\nstudy: {{trials: 400, seed: 3}}\n"


def errors(last: int = 3) -> str:
    """Measures of the tool in all poses, along each axis."""
    return "".join(
        f"\n  {component} {pose}: {{kind: position_error, of: link {last}.tool, from: base, "
        f"component: {component}, at: {pose}}}"
        for pose in POSES
        for component in "xyz"
    )


def system_of(text: str, folder: Path) -> MachineSystem:
    """The machine that a scene means."""
    system = simulation_of(scene_of(text, folder), Overrides()).system
    assert isinstance(system, MachineSystem)
    return system


def plays(system: MachineSystem, trials: Trials, pose: str, method: str = "exact") -> Array:
    """Lost motions of all drives at a pose (trials, joints) [rad], by the gears alone."""
    readings = [drive.readings[pose] for drive in system.drives]
    own = system.gears.method(method, {}).answers(system.gear_trials(trials, np.zeros((len(trials), 0))), readings)
    return np.stack([own.values[reading.name][:, 0] for reading in readings], axis=1)


def rotation(axis: Any, angle: float) -> Array:
    """(3, 3), by Rodrigues' formula."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    found: Array = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
    return found


def about(at: Any, axis: Any, angle: float) -> Array:
    """A turn about a line in the world (4, 4)."""
    made = np.eye(4)
    made[:3, :3] = rotation(axis, angle)
    made[:3, 3] = np.array(at) - made[:3, :3] @ np.array(at)
    return made


def leaned(start: Any, end: Any) -> Array:
    """The least rotation from one direction to another (3, 3)."""
    axis = np.cross(start, end)
    size = float(np.linalg.norm(axis))
    return np.eye(3) if size < 1e-15 else rotation(axis, math.atan2(size, float(np.dot(start, end))))


def tool_by_hand(
    axes: Sequence[tuple[Any, Any]],
    tool: Any,
    turns: Sequence[float],
    ends: Sequence[tuple[Array, Array]] | None = None,
) -> Array:
    """The tool's place (3,), every joint turned by so much from inputs 0.

    Args:
        axes, tool: at inputs 0.
        turns: of the joints [rad].
        ends: by joint, how far both ends of its bore are displaced in the world at inputs 0 (3,) [mm].
    """
    pose = np.eye(4)  # of what the next joint is on, against where that is at inputs 0
    for k, (at, axis) in enumerate(axes):
        z = np.array(axis) / np.linalg.norm(axis)
        start, end = (np.zeros(3), np.zeros(3)) if ends is None else ends[k]
        middle, lean = (start + end) / 2, leaned(z, z + (end - start) / 20.0)
        seated = np.eye(4)  # the pilot's line goes onto the bore's as it lies
        seated[:3, :3] = lean
        seated[:3, 3] = np.array(at) + middle - lean @ np.array(at)
        pose = pose @ seated @ about(at, z, turns[k])
    found: Array = (pose @ [*tool, 1.0])[:3]
    return found


def columns_of(system: MachineSystem, trials: Trials, name: str) -> Array:
    """Deviations (trials, components) of a contributor [mm]."""
    found: Array = trials.deviations[:, component_slices(system)[name]]
    return found
