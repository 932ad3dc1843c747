"""Profile shifts of a set within limits: the smallest ones, or those that waste least.

Free are the centre distance and the shift of each step of the planets; the shifts of sun and rings follow from no
backlash. The problem has few variables, smooth objectives and margins: SLSQP from several starts, its answer kept only
where every margin is.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import product
from typing import Final

import numpy as np
from scipy.optimize import minimize, minimize_scalar

from tol3d.apps.design.shifted_set import PLANET_GAP, Limits, Margin, ShiftedSet, least_shift, tip_gap
from tol3d.apps.design.working_mesh import BasicRack, shift_sum
from tol3d.errors import GeometryError
from tol3d.gearing.planetary import Drive, ToothSet, efficiency
from tol3d.numerics.arrays import Array

LEAST_WORKING_ANGLE: Final = math.radians(12)  # below it paths of contact leave the involutes of any usual gear
LARGEST_WORKING_ANGLE: Final = math.radians(32)
KEPT: Final = 1e-7  # modules or less; by so much a margin may fall short, under a nanometre of a gear of module 5
STARTS: Final = (-0.25, 0.25)  # modules, shifts of each step from which programmes start, beside the smallest ones
FTOL: Final = 1e-12
ITERATIONS: Final = 60  # of 330 that ended well on random sets none took 40, nearly all under 20


class Goal(StrEnum):
    """Goals of a choice of profile shifts."""

    SMALLEST = "smallest"
    FORWARD = "forward"
    BACKWARD = "backward"


class LimitsNotKeptError(GeometryError):
    """No shifts keep the limits.

    Args:
        margin: the one that fails in the nearest try.
    """

    def __init__(self, margin: Margin, words: str) -> None:
        super().__init__(words)
        self.margin = margin


@dataclass(frozen=True)
class Task:
    """A set whose shifts are sought.

    Args:
        drive: its input, output and held member.
        centre_distance: stated [mm], or None where it is free.
    """

    teeth: ToothSet
    rack: BasicRack
    drive: Drive
    planets: int
    limits: Limits
    friction: float
    centre_distance: float | None = None

    def efficiency(self, own: ShiftedSet, drive: Drive) -> float:
        """Efficiency in the sense of a drive, with losses by the published formula of each mesh."""
        return efficiency(self.teeth, own.mesh_efficiencies(self.friction), drive)

    def shifted(self, values: Array) -> ShiftedSet:
        """Set at the values of the variables: centre distance over the module, shifts of the planets' steps."""
        return ShiftedSet(self.teeth, self.rack, float(values[0]) * self.rack.module, tuple(map(float, values[1:])))

    @property
    def distances(self) -> tuple[float, float]:
        """Ends of the centre distance [modules] between which working pressure angles are usual.

        Raises:
            GeometryError: no distance, or not the stated one, suits all meshes.
        """
        cos, sums = math.cos(self.rack.pressure_angle), [mesh.tooth_sum / 2 for mesh in self.teeth.meshes]
        low = max(sums) * cos / math.cos(LEAST_WORKING_ANGLE)
        high = min(sums) * cos / math.cos(LARGEST_WORKING_ANGLE)
        if self.centre_distance is not None:
            stated = self.centre_distance / self.rack.module
            if not low <= stated <= high:
                raise GeometryError(self._unreachable(f"{self.centre_distance:g} mm", low, high))
            return stated, stated
        if low > high:
            raise GeometryError(self._unreachable("one centre distance", low, high))
        return low, high

    @property
    def widest_gap(self) -> Margin:
        """The most room that the limits of profile shifts leave between the tips of neighbouring planets.

        Tips are lowest at the least shift without undercut with which that of the sun is within its limit, a convex
        function of the centre distance: the gap is concave, so that its maximum is found.

        Raises:
            GeometryError: no distance, or not the stated one, suits all meshes.
        """
        low, high = self.distances
        gaps = [self._gap(low), self._gap(high)]
        if low < high:
            gaps.append(-float(minimize_scalar(lambda a: -self._gap(a), bounds=(low, high), method="bounded").fun))
        return Margin(PLANET_GAP, max(gaps), self.limits.planet_gap, "mm")

    def _gap(self, distance: float) -> float:
        """Between tips that are as low as can be [mm], at a centre distance [modules]."""
        m, most = self.rack.module, self.limits.shift
        shifts = [max(-most, least_shift(count, self.rack)) for count in self.teeth.steps]
        for mesh in self.teeth.meshes:
            if not mesh.internal:
                shifts[mesh.step] = max(shifts[mesh.step], shift_sum(mesh, self.rack, distance * m) - most)
        tips = [count / 2 + self.rack.addendum + x for count, x in zip(self.teeth.steps, shifts, strict=True)]
        return tip_gap(distance * m, self.planets, max(tips) * m)

    def _unreachable(self, what: str, low: float, high: float) -> str:
        m, sums = self.rack.module, ", ".join(str(mesh.tooth_sum) for mesh in self.teeth.meshes)
        return (
            f"{what} does not suit tooth sums of {sums}: working pressure angles of "
            f"{math.degrees(LEAST_WORKING_ANGLE):g} to {math.degrees(LARGEST_WORKING_ANGLE):g} deg need at least "
            f"{low * m:.4f} mm and at most {high * m:.4f} mm"
        )


def best_shifts(task: Task, goal: Goal) -> ShiftedSet:
    """The set with its shifts.

    Raises:
        GeometryError: no centre distance suits all meshes.
        LimitsNotKeptError: no shifts were found that keep the limits.
    """
    widest = task.widest_gap
    if widest.kept < -KEPT:
        raise LimitsNotKeptError(widest, f"{widest.words}, and no profile shifts give more")
    smallest = _smallest(task)
    if goal is Goal.SMALLEST:
        return task.shifted(smallest)
    drive = task.drive if goal is Goal.FORWARD else task.drive.reversed
    found = [
        _solved(task, start, lambda values: -task.efficiency(task.shifted(values), drive))
        for start in (smallest, *_starts(task))
    ]
    kept = [values for values in found if _kept(task, values) >= -KEPT]
    return max((task.shifted(values) for values in (smallest, *kept)), key=lambda own: task.efficiency(own, drive))


def _smallest(task: Task) -> Array:
    """Least sum of squares of all shifts: none at all where tooth sums are alike and the teeth allow it."""
    low, high = task.distances
    middle = float(np.median([mesh.tooth_sum / 2 for mesh in task.teeth.meshes]))
    plain = np.array([min(max(middle, low), high), *[0.0] * len(task.teeth.steps)])
    if max(map(abs, task.shifted(plain).shifts.values())) < KEPT and _kept(task, plain) >= -KEPT:
        return plain
    tries = []
    for start in (plain, *_starts(task)):
        values = _solved(task, start, lambda values: sum(x * x for x in task.shifted(values).shifts.values()))
        if _kept(task, values) >= -KEPT:
            return values
        tries.append(values)
    nearest = task.shifted(max(tries, key=lambda values: _kept(task, values)))
    worst = nearest.worst(task.limits, task.planets)
    words = f"no profile shifts were found that keep the limits; the nearest fail by {worst.words}"
    raise LimitsNotKeptError(worst, words)


def _starts(task: Task) -> Iterator[Array]:
    low, high = task.distances
    for shifts in product(STARTS, repeat=len(task.teeth.steps)):
        yield np.array([low + 0.5 * (high - low), *shifts])


def _solved(task: Task, start: Array, objective: Callable[[Array], float]) -> Array:
    low, high = task.distances
    most = task.limits.shift
    bounds = [(low, high), *[(-most, most)] * len(task.teeth.steps)]
    margins = {"type": "ineq", "fun": lambda values: _margins(task, values)}
    found = minimize(
        objective,
        start,
        method="SLSQP",
        bounds=bounds,
        constraints=margins,
        options={"ftol": FTOL, "maxiter": ITERATIONS},
    )
    return np.clip(np.asarray(found.x, dtype=np.float64), [b[0] for b in bounds], [b[1] for b in bounds])


def _margins(task: Task, values: Array) -> Array:
    own = task.shifted(values)
    return np.array([margin.kept for margin in own.margins(task.limits, task.planets)])


def _kept(task: Task, values: Array) -> float:
    """Smallest margin of all limits; negative if one is not kept."""
    return task.shifted(values).worst(task.limits, task.planets).kept
