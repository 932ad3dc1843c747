"""Random pairs that can be built, with thinner teeth and nothing else: their scenes, and their backlash in closed form.

The formulas stand in every handbook and are written out here, from the numbers of the scene alone.
"""

import math
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from tol3d import Scene, load_scene
from tol3d.errors import InputError
from tol3d.gearing.model import Model, model_from_scene

MOST_TRIES = 500


@dataclass(frozen=True)
class ThinnedPair:
    """Two gears whose teeth are thinner by arcs at the reference circle; of a bevel pair in the middle of each face.

    Args:
        teeth, shifts, faces, thinner: of driver and driven; the last two in mm.
        module, alpha: [mm, rad].
        sigma: shaft angle [rad] of a bevel pair; None for a spur pair.
        centre_distance: [mm] of a spur pair.
    """

    teeth: tuple[int, int]
    shifts: tuple[float, float]
    faces: tuple[float, float]
    thinner: tuple[float, float]
    module: float
    alpha: float
    sigma: float | None = None
    centre_distance: float = 0.0

    @property
    def pitch_angle(self) -> float:
        """delta_1 [rad]: tan delta_1 = sin Sigma / (z2/z1 + cos Sigma)."""
        assert self.sigma is not None, "a spur pair has no pitch angle"
        return math.atan2(math.sin(self.sigma), self.teeth[1] / self.teeth[0] + math.cos(self.sigma))

    @property
    def outer(self) -> float:
        """R_e [mm]."""
        return self.module * self.teeth[0] / (2 * math.sin(self.pitch_angle))

    @cached_property
    def turn(self) -> float:
        """Free turn of the driven gear times the sine of its base cone, or its base radius on a spur pair [rad; mm]."""
        if self.sigma is None:
            bases = [self.module * z * math.cos(self.alpha) / 2 for z in self.teeth]
            working = math.acos(sum(bases) / self.centre_distance)
            opened = 2 * sum(bases) * (math.tan(working) - working - math.tan(self.alpha) + self.alpha)
            thicker = 2 * sum(self.shifts) * self.module * math.tan(self.alpha) - sum(self.thinner)
            return opened - thicker * math.cos(self.alpha)
        middles = [self.outer - face / 2 for face in self.faces]
        return math.cos(self.alpha) * sum(e / middle for e, middle in zip(self.thinner, middles, strict=True))

    @property
    def normal_backlash(self) -> float:
        """j_bn [mm], of a bevel pair in the middle of the common face, the great circle's chord off the flank."""
        return self.turn if self.sigma is None else (self.outer - min(self.faces) / 2) * math.sin(self.turn)

    @property
    def driven_turn(self) -> float:
        """Angular backlash [rad] of the driven gear, the driver held."""
        if self.sigma is None:
            return self.turn / (self.module * self.teeth[1] * math.cos(self.alpha) / 2)
        return self.turn / (math.sin(self.sigma - self.pitch_angle) * math.cos(self.alpha))

    def text(self, measures: str) -> str:
        """A scene with these measures, lines of a mapping: gears `driver` and `driven`, mesh `pair`, train `train`."""
        kind, mesh = ("bevel", f"bevel_mesh, shaft_angle: {self.sigma!r} rad") if self.sigma else ("spur", "mesh")
        if not self.sigma:
            mesh += f", centre_distance: {self.centre_distance!r} mm"
        lines = ["scene: thinner teeth", "parts:"]
        names = ("driver", "driven")
        for name, z, x, face in zip(names, self.teeth, self.shifts, self.faces, strict=True):
            numbers = f"teeth: {z}, module: {self.module!r} mm, pressure_angle: {self.alpha!r} rad"
            lines.append(f"  {name}: {{kind: {kind}_gear, {numbers}, face_width: {face!r} mm, profile_shift: {x!r}}}")
        lines.append("tolerances:")
        for name, thinner in zip(names, self.thinner, strict=True):
            law = f"{{kind: constant, value: {-thinner!r} mm}}"
            lines.append(f"  {name} teeth: {{kind: tooth_thickness, of: {name}, distribution: {law}}}")
        lines += ["moves:", f"  pair: {{kind: {mesh}, driver: driver, driven: driven}}"]
        lines += ["  train: {kind: train, driven: driver, output: driven}", "measures:", measures]
        return "\n".join(lines)

    def scene(self, measures: str) -> Scene:
        """That scene, read."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "thinner teeth.yaml"
            path.write_text(self.text(measures), encoding="utf-8")
            return load_scene(path)

    def model(self, measures: str) -> Model:
        """Its model."""
        return model_from_scene(self.scene(measures))


def random_pair(kind: str, seed: int) -> ThinnedPair:
    """One that can be built: 8 to 60 teeth, alpha 14.5 to 25 deg; bevel pairs at 50 to 120 deg with shifts that cancel,
    spur pairs with any shifts, at up to a tenth of a module more than they need."""
    rng = np.random.default_rng(seed)
    for _ in range(MOST_TRIES):
        found = _drawn(kind, rng)
        try:
            found.model("  play: {kind: normal_backlash, of: pair}")
        except InputError:
            continue
        return found
    raise AssertionError(f"none of {MOST_TRIES} pairs of seed {seed} can be built")


def _drawn(kind: str, rng: np.random.Generator) -> ThinnedPair:
    drawn_teeth = rng.integers(8, 61, 2)
    teeth = (int(drawn_teeth[0]), int(drawn_teeth[1]))
    module = round(float(np.exp(rng.uniform(math.log(0.5), math.log(10.0)))), 2)
    alpha = math.radians(round(float(rng.uniform(14.5, 25.0)), 1))
    thinner = _two(module * rng.uniform(0.0, 0.03, 2))
    if kind == "bevel":
        shift = round(float(rng.uniform(-0.6, 0.6)), 2)
        drawn = ThinnedPair(
            teeth, (shift, -shift), (1.0, 1.0), thinner, module, alpha, math.radians(rng.uniform(50, 120))
        )
        faces = _two(drawn.outer * rng.uniform(0.05, 0.33, 2))
        return ThinnedPair(teeth, drawn.shifts, faces, thinner, module, alpha, drawn.sigma)
    shifts = _two([round(float(x), 2) for x in rng.uniform(-0.5, 0.8, 2)])
    working = _tight_angle(sum(teeth), sum(shifts), alpha)
    distance = module * sum(teeth) * math.cos(alpha) / (2 * math.cos(working)) + module * float(rng.uniform(0.0, 0.1))
    faces = _two(module * rng.uniform(3.0, 15.0, 2))
    return ThinnedPair(teeth, shifts, faces, thinner, module, alpha, None, distance)


def _two(values: Iterable[float]) -> tuple[float, float]:
    first, second = values
    return float(first), float(second)


def _tight_angle(teeth: int, shift: float, alpha: float) -> float:
    """alpha_w [rad] without play, inv alpha_w = inv alpha + 2 x tan alpha / z, by bisection."""
    wanted = math.tan(alpha) - alpha + 2 * shift * math.tan(alpha) / teeth
    low, high = 0.0, 1.4
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if math.tan(middle) - middle < wanted else (low, middle)
    return (low + high) / 2
