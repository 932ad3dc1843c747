"""A pair of 20 and 30 teeth whose flanks deviate one by one, and builds of it."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from oracles.deviated_flanks import DeviatedGear, DeviatedPair, active_rolls, parts
from scene_texts import scene_of

from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.model import Mesh, Model, Reading, model_from_scene

Array = NDArray[np.float64]

SCENE = """
scene: teeth
parts:
  pinion: {{kind: spur_gear, teeth: 20, module: 2 mm, face_width: 12 mm}}
  wheel: {{kind: spur_gear, teeth: 30, module: 2 mm, face_width: 10 mm}}
tolerances:
{tolerances}
moves:
  pair: {{kind: mesh, driver: pinion, driven: wheel, centre_distance: 50.2 mm, working_flank: {flank}}}
measures:
  play: {{kind: normal_backlash, of: pair}}
"""
TEETH = (20, 30)
CENTRE_DISTANCE = 50.2  # mm; 20 and 30 teeth of 2 mm stand at 50 mm without play
FACES = (12.0, 10.0)  # mm
COS = math.cos(math.radians(20))
BASES = (20 * COS, 30 * COS)  # mm
TURN = 2 * math.pi

WALK = "limits: {iso_class: 7}, law: {kind: random_walk, fill: [0.7, 1]}"
FREE = "each: tooth, limits: {iso_class: 7}, law: {kind: uniform}"
PITCH = (
    f"  pinion pitch: {{kind: pitch_deviation, of: pinion, flanks: each, {WALK}}}\n"
    "  wheel pitch: {kind: pitch_deviation, of: wheel, flanks: together, limits: {iso_class: 7}, "
    "law: {kind: run_out_and_random, run_out: 0.5, fill: [0.7, 1]}}"
)
SHAPES = "\n".join(
    f"  {gear} {kind}: {{kind: {kind}, of: {gear}, flanks: each, {FREE}{more}}}"
    for gear, waves in (("pinion", ", shape: wave, waves: 1"), ("wheel", ", shape: barrel"))
    for kind, more in (("profile_slope", ""), ("helix_slope", ""), ("profile_form", waves))
)


def model_of(folder: Path, tolerances: str, flank: str = "right") -> Model:
    """The model of its scene with tolerances, lines of it, written into a folder."""
    return model_from_scene(scene_of(SCENE.format(tolerances=tolerances, flank=flank), folder))


def draws(model: Model, count: int, seed: int) -> tuple[Array, Array]:
    """Deviations (count, components) as each tolerance draws them, and angles of the driver over the long period."""
    generator = np.random.default_rng(seed)
    columns = [
        np.stack(np.broadcast_arrays(*own.draw.deviations(*uniforms), np.zeros(count))[:-1], axis=-1)
        for own in model.contributors
        for uniforms in [generator.random((own.draw.uniforms, count))]
    ]
    return np.concatenate(columns, axis=1), generator.uniform(0.0, 3 * TURN, count)


@dataclass(frozen=True)
class Builds:
    """Builds of a scene, with the exact engine's readings at random positions of the long period."""

    model: Model
    deviations: Array
    angle: Array

    @property
    def mesh(self) -> Mesh:
        return self.model.meshes[0]

    @property
    def engine(self) -> ExactEngine:
        return ExactEngine(self.model)

    def read(self, deviations: Array | None = None) -> Any:
        made = self.engine.build(self.deviations if deviations is None else deviations)
        return self.engine.read(made, self.mesh, Reading(), self.angle, frozenset(("pinion", "wheel")))

    def of(self, name: str) -> Array:
        """Components of a contributor (builds, components) [mm]."""
        return self.deviations[:, self.model.component_slices[name]]


def drawn(tolerances: str, folder: Path, count: int, seed: int = 1) -> Builds:
    model = model_of(folder, tolerances)
    return Builds(model, *draws(model, count, seed))


def dense(builds: Builds, row: int, heights: tuple[float, ...] = (0.0,)) -> DeviatedPair:
    """The oracle's gears of a build, from the components as the scene's words have them."""
    names = [own.name for own in builds.model.contributors]

    def component(name: str, tooth: int, flank: int, teeth: int, alike: bool) -> float:
        if name not in names:
            return 0.0
        return float(builds.of(name)[row, tooth + (0 if alike or flank == 1 else teeth)])

    def of_gear(gear: str, teeth: int, face: float, form: Callable[[Array], Array]) -> DeviatedGear:
        own: Any = builds.mesh.gear(gear)
        first = math.sqrt((own.form_radius / own.base_radius) ** 2 - 1)
        active = active_rolls(teeth, sum(TEETH) - teeth, 2.0, CENTRE_DISTANCE)

        def deviation(tooth: int, flank: int, roll: Array, z: float) -> Array:
            part, part_of_form = parts(roll, active)
            ahead = component(f"{gear} pitch", tooth, flank, teeth, gear == "wheel")
            slope = component(f"{gear} profile_slope", tooth, flank, teeth, False)
            helix = component(f"{gear} helix_slope", tooth, flank, teeth, False)
            shape = component(f"{gear} profile_form", tooth, flank, teeth, False)
            return -flank * ahead * COS + slope * part + helix * z / face + shape * form(part_of_form)

        return DeviatedGear(teeth, 2.0, first, deviation)

    pinion = of_gear("pinion", 20, FACES[0], lambda part: 0.5 * np.cos(TURN * part))
    wheel = of_gear("wheel", 30, FACES[1], lambda part: 1 / 3 - 4 * part**2)
    return DeviatedPair(pinion, wheel, CENTRE_DISTANCE, heights)
