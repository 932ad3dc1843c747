"""The obvious way to a backlash: whole tessellated gears as one BVH each in FCL, turned until they touch."""

import time
from dataclasses import replace

import fcl
import numpy as np

from tol3d.cad.solids import display_mesh
from tol3d.gearing.builds.build import Build, build
from tol3d.gearing.model import Model
from tol3d.gearing.system import GearSystem
from tol3d.study.system.stated import mean_deviations, nominal_build
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

DEFLECTION = 0.001  # mm; as fine as whole gears can be tessellated in reasonable time
GAP_XTOL = 1e-4  # mm; where the secant steps stop: each contact is found with at most this much gap left
STEP = 0.9  # of the gap a step turns: the gap falls tenfold each time and never closes
MOST_STEPS = 30


def with_mean_thickness(model: Model) -> Model:
    """The model with its gears as thick as they are in the mean: whole gears cannot be thinned trial by trial."""
    made = build(model, mean_deviations(model, model.measures[0].positions))
    turns = {name: float(made.flank_turn[0, seat]) for (_, name), seat in model.seat_index.items()}
    return replace(model, gears=tuple(replace(g, gear=g.gear.perturbed(turns[g.name], 1.0)) for g in model.gears))


class WholeGears:
    """Both gears of a model's first mesh in FCL.

    Args:
        triangles: of both.
        chord_error: largest distance [mm] of a triangle from its flank, of both gears together.
    """

    def __init__(self, model: Model, deflection: float = DEFLECTION) -> None:
        mesh = model.meshes[0]
        self._pair = mesh.pair
        self._seats = [model.seat_index[mesh.name, name] for name in (mesh.driver, mesh.driven)]
        self._objects: list[fcl.CollisionObject] = []
        self.triangles = 0
        self.chord_error = 0.0
        for name in (mesh.driver, mesh.driven):
            shown = display_mesh(model.gear(name).gear, deflection)
            bvh = fcl.BVHModel()
            bvh.beginModel(len(shown.vertices), len(shown.triangles))
            bvh.addSubModel(shown.vertices, shown.triangles)
            bvh.endModel()
            self.triangles += len(shown.triangles)
            self.chord_error += shown.chord_error
            self._objects.append(fcl.CollisionObject(bvh, fcl.Transform()))

    def distance(self, made: Build, driver_angle: float, driven_angle: float) -> float:
        """Distance [mm] of the gears of one build at their turns [rad]."""
        for placed, seat, angle in zip(self._objects, self._seats, (driver_angle, driven_angle), strict=True):
            pose = made.world_from_gear(seat, np.array([angle]))[0]
            placed.setTransform(fcl.Transform(pose[:3, :3].copy(), pose[:3, 3].copy()))
        return float(fcl.distance(*self._objects, fcl.DistanceRequest(), fcl.DistanceResult()))

    def free_turn(self, made: Build, driver_angle: float) -> float:
        """Turn of the driven gear from contact to contact [rad] in one build, too small by two GAP_XTOL at most."""
        radius = self._pair.wheel.base_radius
        middle = float(self._pair.driven_angle(np.array([driver_angle]))[0])
        ends = []
        for sense in (1.0, -1.0):
            angle = middle
            for _ in range(MOST_STEPS):
                gap = self.distance(made, driver_angle, angle)
                angle += sense * STEP * gap / radius
                if gap < GAP_XTOL:
                    break
            ends.append(angle)
        return ends[0] - ends[1]


def nominal_free_turn(gears: WholeGears, model: Model) -> float:
    """Free turn [rad] of the driven gear without deviations, the driver at 0."""
    return gears.free_turn(build(model, nominal_build(model).deviations), 0.0)


def whole_gears_rate(model: Model, trials: int, deflection: float = DEFLECTION) -> tuple[float, int]:
    """Trials/s of whole gears, and how many triangles they have."""
    model = with_mean_thickness(model)
    gears = WholeGears(model, deflection)
    own = drawn(Simulation(GearSystem(model), Study()), 0, trials)
    made = build(model, own.deviations)
    angles = own.positions[model.meshes[0].name]
    started = time.perf_counter()
    for row in range(trials):
        gears.free_turn(made.rows(np.array([row])), float(angles[row]))
    return trials / (time.perf_counter() - started), gears.triangles
