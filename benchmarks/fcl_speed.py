"""How fast the geometric road is, and how much faster than the obvious program.

    python benchmarks/fcl_speed.py [--trials 2000] [--naive 20]

Prints trials/s on one core for the spur pair at the default mesh (draws, builds, contact, normal backlash), the
same with every measure of the scene, and beside it the naive way: both whole tessellated gears as one
BVH each in FCL, the wheel turned by secant steps on the distance until the teeth touch on one side, then on the
other. Both in one run on the same trials, so that the ratio holds on a noisy machine; medians of several rounds.
Then the bevel pair at its own mesh, for each way of reading its normal backlash.
"""

import argparse
import math
import os
import statistics
import time
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import fcl
import numpy as np

from tol3d import load_scene
from tol3d.block import drawn_block, simulate_block
from tol3d.build import build
from tol3d.engines.fcl import FclEngine
from tol3d.model import Model, Reading
from tol3d.simulate import Overrides, effective_model, strips_of
from tol3d.solids import display_mesh

SCENES = Path(__file__).resolve().parent.parent / "scenes"
ROUNDS = 5
NAIVE_DEFLECTION = 0.001  # mm; as fine as whole gears can be tessellated in reasonable time
NAIVE_XTOL = 1e-4  # mm; the naive way stops this near to contact


def strips_rate(model: Model, trials: int) -> float:
    """Trials/s from seed to columns."""
    engine = FclEngine(model, strips_of(model))
    simulate_block(model, engine, drawn_block(model, 1, 0, 50))  # first use builds the BVHs
    started = time.perf_counter()
    simulate_block(model, engine, drawn_block(model, 1, 0, trials))
    return trials / (time.perf_counter() - started)


class NaiveGears:
    """Whole gears in FCL."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._mesh = model.meshes[0]
        self._objects = []
        self.triangles = 0
        for name in (self._mesh.driver, self._mesh.driven):
            shown = display_mesh(model.gear(name).gear, NAIVE_DEFLECTION)
            bvh = fcl.BVHModel()
            bvh.beginModel(len(shown.vertices), len(shown.triangles))
            bvh.addSubModel(shown.vertices, shown.triangles)
            bvh.endModel()
            self.triangles += len(shown.triangles)
            self._objects.append(fcl.CollisionObject(bvh, fcl.Transform()))

    def distance(self, made: object, driver_angle: float, driven_angle: float) -> float:
        """Distance of the gears at their turns [mm]."""
        for k, (name, angle) in enumerate(((self._mesh.driver, driver_angle), (self._mesh.driven, driven_angle))):
            pose = made.world_from_gear(self._model.gear_index[name], np.array([angle]))[0]  # type: ignore[attr-defined]
            self._objects[k].setTransform(fcl.Transform(pose[:3, :3].copy(), pose[:3, 3].copy()))
        return float(fcl.distance(*self._objects, fcl.DistanceRequest(), fcl.DistanceResult()))

    def free_turn(self, made: object, driver_angle: float) -> float:
        """Turn of the driven gear from contact to contact [rad], without the thickness deviations' turn."""
        pair = self._mesh.pair
        radius = pair.wheel.base_radius
        middle = float(pair.driven_angle(np.array([driver_angle]))[0])
        ends = []
        for sense in (1.0, -1.0):
            angle = middle
            for _ in range(30):
                gap = self.distance(made, driver_angle, angle)
                angle += sense * 0.9 * gap / radius
                if gap < NAIVE_XTOL:
                    break
            ends.append(angle)
        return ends[0] - ends[1]


def naive_rate(model: Model, trials: int) -> tuple[float, int]:
    """Trials/s of whole gears, and how many triangles they have."""
    thinner = replace(
        model,
        gears=tuple(replace(g, gear=replace(g.gear, tooth_thickness_deviation=-0.0265)) for g in model.gears),
    )
    gears = NaiveGears(thinner)
    block = drawn_block(thinner, 1, 0, trials)
    made = build(thinner, block.deviations)
    started = time.perf_counter()
    for row in range(trials):
        gears.free_turn(made.rows(np.array([row])), float(block.random_angle[thinner.meshes[0].name][row]))
    return trials / (time.perf_counter() - started), gears.triangles


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=2000)
    parser.add_argument("--naive", type=int, default=20)
    arguments = parser.parse_args()
    measure_spur_pair(arguments.trials, arguments.naive)
    measure_bevel_pair(arguments.trials)


def measure_spur_pair(trials: int, naive_trials: int) -> None:
    """The strips beside whole gears."""
    model = effective_model(load_scene(SCENES / "spur_pair.yaml"), Overrides())
    normal_only = replace(model, measures=model.measures[:1])
    rates = {"normal backlash": [], "every measure": []}
    naive = []
    triangles = 0
    for _ in range(ROUNDS):
        rates["normal backlash"].append(strips_rate(normal_only, trials))
        rates["every measure"].append(strips_rate(model, trials))
        rate, triangles = naive_rate(model, naive_trials)
        naive.append(rate)
    slow = statistics.median(naive)
    steps = model.study.profile_steps
    print(f"{model.name}: {steps} steps a flank, one core, medians of {ROUNDS} rounds")
    for what, found in rates.items():
        median = statistics.median(found)
        spread = f"{min(found):.0f} ... {max(found):.0f}"
        print(f"  strips, {what:16} {median:8.0f} trials/s  ({spread})   {median / slow:7.0f} x naive")
    print(f"  naive, whole gears        {slow:8.2f} trials/s  ({triangles} triangles, {NAIVE_DEFLECTION} mm)")
    assert math.isfinite(slow)


def measure_bevel_pair(trials: int) -> None:
    """Each way of reading, and all measures of the scene."""
    model = effective_model(load_scene(SCENES / "bevel_pair.yaml"), Overrides())
    measure = model.measures[0]
    readings = {
        "mean section, one tooth": measure.kind.reading,
        "mean section, all teeth": Reading("section", "section", "all"),
        "face contact, one tooth": Reading("face", "section", "driven"),
        "whole face, all teeth": Reading("face", "face", "all"),
    }
    print(f"{model.name}: {model.study.profile_steps} steps a flank, one core, medians of {ROUNDS} rounds")
    models = {
        what: replace(model, measures=(replace(measure, kind=replace(measure.kind, reading=reading)),))
        for what, reading in readings.items()
    } | {"every measure": model}
    for what, read in models.items():
        found = [strips_rate(read, trials) for _ in range(ROUNDS)]
        spread = f"{min(found):.0f} ... {max(found):.0f}"
        print(f"  strips, {what:24} {statistics.median(found):8.0f} trials/s  ({spread})")


if __name__ == "__main__":
    main()
