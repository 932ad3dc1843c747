"""Profile shifts: the limits by the gears of the house, the best by trying all on a grid with formulas of its own."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import differential_evolution

from tol3d.apps.design.optimum import Goal, Task, best_shifts
from tol3d.apps.design.shifted_set import Limits, ShiftedSet, made_pair, refuse_interference
from tol3d.apps.design.working_mesh import BasicRack, WorkingMesh
from tol3d.errors import GeometryError
from tol3d.gearing.planetary import CARRIER, CentralMesh, ToothSet, simple, wolfrom
from tol3d.gearing.planetary.model.efficiency import Drive
from tol3d.gears import InternalPair
from tol3d.gears.internal_mesh import InternalMesh

REDUCER = Drive("sun", "ring 2", "ring 1")
BUILT = wolfrom(25, 27, 79, 24, 76)
SETS = (BUILT, wolfrom(15, 18, 51, 16, 49), wolfrom(42, 32, 108, 31, 105), wolfrom(24, 24, 72, 26, 75))


def task(teeth: ToothSet = BUILT, **changes: float) -> Task:
    return replace(Task(teeth, BasicRack(), REDUCER, 3, Limits(), 0.08), **changes)  # type: ignore[arg-type]


@cache
def shifted(teeth: ToothSet, goal: Goal) -> ShiftedSet:
    return best_shifts(task(teeth), goal)


# teeth ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("goal", Goal)
@pytest.mark.parametrize("teeth", SETS)
def test_designed_teeth_are_those_of_the_gears_that_are_made(teeth: ToothSet, goal: Goal) -> None:
    """No backlash, the same paths of contact and tips, no interference by the gears' own rules."""
    own = shifted(teeth, goal)
    refuse_interference(own)
    for mesh in own.meshes:
        pair = made_pair(mesh)
        assert pair.normal_backlash == pytest.approx(0.0, abs=1e-12)
        assert pair.contact_ratio == pytest.approx(mesh.contact_ratio, rel=1e-12)
        assert pair.working_pressure_angle == pytest.approx(mesh.working_angle, rel=1e-12)
        gears = (pair.wheel, pair.pinion) if mesh.mesh.internal else (pair.pinion, pair.wheel)
        assert [gear.tip_thickness for gear in gears] == pytest.approx(mesh.tip_thicknesses, abs=1e-12)
        assert [gear.tip_radius for gear in gears] == pytest.approx(mesh.tip_radii, abs=1e-12)
        assert [gear.root_radius for gear in gears] == pytest.approx(mesh.root_radii, abs=1e-12)


@pytest.mark.parametrize("teeth", SETS)
def test_every_limit_is_kept_by_every_goal(teeth: ToothSet) -> None:
    limits = Limits()
    for goal in Goal:
        own = shifted(teeth, goal)
        assert own.worst(limits, 3).kept > -1e-6
        sun = made_pair(own.meshes[0])
        assert sun.pinion.profile_shift >= 1 - sun.pinion.teeth * math.sin(math.radians(20)) ** 2 / 2 - 1e-6


@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_tips_pass_each_other_by_what_the_gears_say(shift: float) -> None:
    """Crossing tip circles, for tooth differences on both sides of trimming: the ring's arc is the gap."""
    signs = set()
    for teeth in range(26, 37):
        own = WorkingMesh(CentralMesh("ring", 40, teeth, True), BasicRack(), (40 - teeth) / 2, -shift, shift)
        pair = made_pair(own)
        assert isinstance(pair, InternalPair)
        gap = InternalMesh(pair.ring, pair.inner, pair.centre_distance).trimming_gap
        assert own.tip_interference_margin * own.tip_radii[0] == pytest.approx(gap, abs=1e-10)
        signs.add(gap > 0)
    assert signs == {True, False}


def test_no_shift_is_taken_where_none_is_needed() -> None:
    own = best_shifts(task(), Goal.SMALLEST)
    assert own.centre_distance == 26.0
    assert all(shift == 0.0 for shift in own.shifts.values())


def test_the_smallest_shifts_of_free_sums_are_by_least_squares() -> None:
    """At the distance found the sums are fixed: no other division of them is smaller, by the normal equations."""
    loose = Limits(0.0, 0.0, -1.0, 0.0, 5.0)
    own = best_shifts(replace(task(wolfrom(40, 34, 107, 32, 106)), limits=loose), Goal.SMALLEST)
    sums = [mesh.central_shift + mesh.planet_shift for mesh in own.meshes]
    over = np.array([[1, 0], [0, 1], [-1, 0], [-1, 0], [0, -1]])  # planets, sun, rings
    rest = np.array([0, 0, *sums])
    best, *_ = np.linalg.lstsq(over.astype(float), -rest, rcond=None)
    assert own.planet_shifts == pytest.approx(best, abs=1e-5)


# the best ------------------------------------------------------------------------------------------------


def grid(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Efficiency forward of every kept point of a grid over distance and both shifts, by closed forms over arrays."""
    alpha, mu = math.radians(20), 0.08
    distance = np.linspace(24.978, 28.8, points)[:, None, None]
    shifts = {0: np.linspace(-1, 1, points)[None, :, None], 1: np.linspace(-1, 1, points)[None, None, :]}
    working = np.arccos(26 * math.cos(alpha) / distance)

    def inv(angle: np.ndarray | float) -> np.ndarray:
        return np.asarray(np.tan(angle) - angle)

    kept = np.ones((points,) * 3, dtype=bool)
    losses = []
    for z, z_p, step, s in ((25, 27, 0, 1), (79, 27, 0, -1), (76, 24, 1, -1)):
        x_p = shifts[step]
        x = s * 52 * (inv(working) - inv(alpha)) / (2 * math.tan(alpha)) - x_p
        tip, tip_p = z / 2 + s * (1 + x), z_p / 2 + 1 + x_p
        root, root_p = z / 2 - s * (1.25 - x), z_p / 2 - 1.25 + x_p
        base, base_p = z / 2 * math.cos(alpha), z_p / 2 * math.cos(alpha)
        at_tip, at_tip_p = np.arccos(np.minimum(base / tip, 1)), np.arccos(np.minimum(base_p / tip_p, 1))
        first = s * z / (2 * math.pi) * (np.tan(at_tip) - np.tan(working))
        second = z_p / (2 * math.pi) * (np.tan(at_tip_p) - np.tan(working))
        losses.append(mu * math.pi * (1 / z_p + s / z) * (first**2 + second**2 - first - second + 1))
        thick = 2 * tip * ((math.pi / 2 + 2 * x * math.tan(alpha)) / z + s * (inv(alpha) - inv(at_tip)))
        thick_p = 2 * tip_p * ((math.pi / 2 + 2 * x_p * math.tan(alpha)) / z_p + inv(alpha) - inv(at_tip_p))
        clear = distance - tip - root_p if s > 0 else tip - distance - root_p
        clear_p = distance - tip_p - root if s > 0 else root - distance - tip_p
        along = np.sqrt(distance**2 - (26 * math.cos(alpha)) ** 2)
        reach, reach_p = np.sqrt(np.maximum(tip**2 - base**2, 0)), np.sqrt(tip_p**2 - base_p**2)
        form_p = np.maximum(0, np.sqrt(np.maximum((root_p + 0.38) ** 2 - base_p**2, 0)) - 0.38)
        if s > 0:
            form = np.maximum(0, np.sqrt(np.maximum((root + 0.38) ** 2 - base**2, 0)) - 0.38)
            off, off_p = along - reach_p - form, along - reach - form_p
        else:
            form = np.sqrt(np.maximum((root - 0.38) ** 2 - base**2, 0)) + 0.38
            off, off_p = form - along - reach_p, reach - along - form_p
        kept &= (thick >= 0.2) & (thick_p >= 0.2) & (clear >= 0.15) & (clear_p >= 0.15) & (off >= 0) & (off_p >= 0)
        kept &= (first + second >= 1.2) & (abs(x) <= 1) & (x_p >= 1 - z_p * math.sin(alpha) ** 2 / 2)
        kept &= (s < 0) | (x >= 1 - z * math.sin(alpha) ** 2 / 2)
    a, b, c = (1 - loss for loss in losses)
    i1, i2 = 79 / 25, 79 * 24 / (76 * 27)
    forward = (1 + a * b * i1) * (1 - i2) / ((1 + i1) * (1 - b * c * i2))
    backward = (1 + i1) * a * (b * c - i2) / (c * (a * b + i1) * (1 - i2))
    return np.where(kept, forward, -np.inf), np.where(kept, backward, -np.inf)


def test_no_point_of_a_grid_is_better_than_the_best_shifts() -> None:
    """Nor is the best far above the grid's: steps of 0.03 modules cost less than half a percent here."""
    for goal, values in zip((Goal.FORWARD, Goal.BACKWARD), grid(65), strict=True):
        own = task()
        drive = REDUCER if goal is Goal.FORWARD else REDUCER.reversed
        best = own.efficiency(shifted(BUILT, goal), drive)
        assert values.max() <= best + 1e-9
        assert values.max() > best - 0.005


@pytest.mark.slow
@pytest.mark.parametrize("teeth", SETS)
def test_a_search_of_another_kind_finds_nothing_better(teeth: ToothSet) -> None:
    """Differential evolution under the same limits."""
    own = task(teeth)

    def wasted(values: np.ndarray) -> float:
        failed = -sum(min(margin.kept, 0.0) for margin in own.shifted(values).margins(own.limits, own.planets))
        return 1.0 + failed if failed > 0 else 1.0 - own.efficiency(own.shifted(values), REDUCER)

    bounds = [own.distances, (-1.0, 1.0), (-1.0, 1.0)]
    found = differential_evolution(wasted, bounds, maxiter=60, popsize=12, seed=1, tol=1e-10, polish=False)
    best = 1.0 - own.efficiency(shifted(teeth, Goal.FORWARD), REDUCER)
    assert best <= found.fun + 1e-7
    assert best > found.fun - 1e-3


@pytest.mark.parametrize("teeth", SETS)
def test_each_goal_is_best_at_what_it_is_for(teeth: ToothSet) -> None:
    own = task(teeth)
    found = {goal: shifted(teeth, goal) for goal in Goal}
    forward = {goal: own.efficiency(each, REDUCER) for goal, each in found.items()}
    backward = {goal: own.efficiency(each, REDUCER.reversed) for goal, each in found.items()}
    assert forward[Goal.FORWARD] >= max(forward.values()) - 1e-7
    assert backward[Goal.BACKWARD] >= max(backward.values()) - 1e-7
    assert forward[Goal.FORWARD] > forward[Goal.SMALLEST]


def test_a_stated_centre_distance_is_kept() -> None:
    own = best_shifts(task(centre_distance=26.4), Goal.FORWARD)
    assert own.centre_distance == pytest.approx(26.4, abs=1e-12)
    assert shifted(BUILT, Goal.FORWARD).centre_distance > 26.4


def test_modules_scale_everything_but_what_is_stated_in_millimetres() -> None:
    twice = replace(task(), rack=BasicRack(module=2.0), limits=Limits(planet_gap=1.0))
    own, small = best_shifts(twice, Goal.FORWARD), shifted(BUILT, Goal.FORWARD)
    assert own.centre_distance == pytest.approx(2 * small.centre_distance, rel=1e-6)
    assert own.planet_shifts == pytest.approx(small.planet_shifts, abs=1e-3)


def test_simple_sets_have_a_best_too() -> None:
    own = Task(simple(20, 25, 70), BasicRack(), Drive("sun", CARRIER, "ring"), 3, Limits(), 0.08)
    plain, best = best_shifts(own, Goal.SMALLEST), best_shifts(own, Goal.FORWARD)
    assert own.efficiency(best, own.drive) > own.efficiency(plain, own.drive)
    refuse_interference(best)


# refusals ------------------------------------------------------------------------------------------------


def test_limits_that_no_shift_keeps_are_said_with_their_numbers() -> None:
    with pytest.raises(
        GeometryError,
        match=r"no profile shifts were found that keep the limits; the nearest fail by .*, at least .* needed",
    ):
        best_shifts(replace(task(), limits=Limits(contact_ratio=2.5)), Goal.SMALLEST)


def test_gears_that_interfere_are_refused_by_their_mesh() -> None:
    """Without the limits a sun of 12 teeth is undercut where its planet touches."""
    teeth = wolfrom(12, 20, 52, 18, 50)
    with pytest.raises(GeometryError, match="mesh of sun: undercut reaches the flank in use"):
        refuse_interference(ShiftedSet(teeth, BasicRack(), 16.0, (0.0, 0.0)))
