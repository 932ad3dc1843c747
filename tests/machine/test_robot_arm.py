"""The six-axis arm that comes along: its levers, its joints against their own scenes, and its expected numbers."""

import re
from itertools import pairwise

import numpy as np
import pytest
from machine.housed import Array
from places import SCENES

from tol3d import Overrides, load_scene
from tol3d.gearing.cycloid.system import RVSystem
from tol3d.gearing.machine.system import MachineSystem
from tol3d.gearing.planetary.system import PlanetarySystem
from tol3d.study.system.stated import component_slices
from tol3d.study.system.trials import Trials
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of
from tol3d.study.trials.simulation import Simulation

DH = ((150, -90, 450), (700, 0, 0), (100, -90, 0), (0, 90, 700), (0, -90, 0), (0, 0, 100))
"""a [mm], alpha [deg], d [mm]; as its head says."""
POSES = {
    "home": (0, -90, 0, 0, 0, 0),
    "front": (0, -45, 45, 0, 0, 0),
    "far": (0, 0, -81.87, 0, 0, 0),
    "table": (0, -60, 60, 0, 90, 0),
    "side": (90, -30, 0, -90, 45, 0),
}
FEW = 6


@pytest.fixture(scope="module")
def arm() -> Simulation:
    return simulation_of(load_scene("robot_arm"), Overrides())


@pytest.fixture(scope="module")
def system(arm: Simulation) -> MachineSystem:
    assert isinstance(arm.system, MachineSystem)
    return arm.system


def frames(inputs: tuple[float, ...]) -> list[Array]:
    """Denavit-Hartenberg frames 0 to 6 in the world."""
    found = [np.eye(4)]
    for (a, alpha, d), theta in zip(DH, np.radians(inputs), strict=True):
        c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(np.radians(alpha)), np.sin(np.radians(alpha))
        step = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
        found.append(found[-1] @ np.array(step))
    return found


@pytest.mark.parametrize("pose", POSES)
def test_links_lie_nominally_where_denavit_and_hartenberg_have_them(system: MachineSystem, pose: str) -> None:
    its = frames(POSES[pose])
    placed = {part.name: part.pose for part in system.poses[pose].assembly.parts}
    for k in range(6):  # a link's frame is that of its joint, turned by the input
        turned = its[k].copy()
        angle = np.radians(POSES[pose][k])
        turned[:3, :2] = turned[:3, :2] @ np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        assert placed[f"link {k + 1}"] == pytest.approx(turned, abs=1e-9)


def test_levers_at_far_are_those_of_the_drawing(system: MachineSystem) -> None:
    levers = [system.lever_of("flange size at far", drive) for drive in system.drives[:3]]
    assert levers == pytest.approx([1656.1, 1506.2, 806.2], abs=0.1)


@pytest.mark.parametrize("pose", POSES)
def test_joints_move_the_flange_by_half_their_plays_times_their_levers(system: MachineSystem, pose: str) -> None:
    its = frames(POSES[pose])
    for drive, frame in zip(system.drives, its, strict=False):
        lever = np.cross(frame[:3, 2], its[6][:3, 3] - frame[:3, 3])
        found = [system.lever_of(f"flange {component} at {pose}", drive) for component in "xyz"]
        assert found == pytest.approx(np.abs(lever), abs=1e-6)


def test_gravity_lays_each_joint_on_the_flank_that_it_loads(system: MachineSystem) -> None:
    """Masses in the middle of the links and at the flange; a torque about an axis is z . (arm x gravity)."""
    masses = (30.0, 20.0, 10.0, 5.0, 2.0, 10.0)
    for pose, inputs in POSES.items():
        its = frames(inputs)
        middles = [(first[:3, 3] + last[:3, 3]) / 2 for first, last in pairwise(its[:6])]
        middles.append(its[6][:3, 3])
        for k, drive in enumerate(system.drives):
            at, z = its[k][:3, 3], its[k][:3, 2]
            torque = sum(
                mass * float(z @ np.cross(middle - at, [0.0, 0.0, -1.0]))
                for mass, middle in zip(masses[k:], middles[k:], strict=True)
            )
            assert drive.sides[pose] == (0 if abs(torque) < 1e-6 else np.sign(torque)), (pose, drive.joint)
    assert {drive.sides["home"] for drive in system.drives[:1]} == {0}


@pytest.mark.slow
@pytest.mark.parametrize("joint", ["joint 1", "joint 3", "joint 4"])
def test_a_joint_alone_is_its_own_scene(arm: Simulation, system: MachineSystem, joint: str) -> None:
    scene = "reducer_3k" if joint == "joint 4" else "rv_bearing_play"
    alone = simulation_of(load_scene(SCENES / f"{scene}.yaml"), Overrides()).system
    assert isinstance(alone, RVSystem | PlanetarySystem)
    drive = next(own for own in system.drives if own.joint == joint)
    trials, number = drawn(arm, 0, FEW), joint.rpartition(" ")[2]
    slices, its = component_slices(system), component_slices(alone)
    own = np.zeros((FEW, max(each.stop for each in its.values())))
    for name, place in its.items():
        named = next(each for each in (f"{name} {number}", name, _numbered(name, number)) if each in slices)
        own[:, place] = trials.deviations[:, slices[named]]
    measure = next(each for each in alone.measures if each.name == "lost motion")
    for reading in {each.name: each for each in drive.readings.values()}.values():
        angle = float(reading.name.rpartition(" ")[2])
        seen = Trials(own, {alone.own.name: np.full(FEW, angle / (2 * np.pi) % float(alone.own.period))})
        for method in ("exact", "analytic"):
            answers = alone.method(method, alone.materials(method)).answers(seen, (measure,))
            by_itself = answers.values["lost motion"][:, 0]
            gears = system.gears.method(method, {}).answers(system.gear_trials(trials, np.zeros((FEW, 0))), (reading,))
            assert gears.values[reading.name][:, 0] == pytest.approx(by_itself, abs=1e-12)


def _numbered(name: str, number: str) -> str:
    """`sun thinning` as the arm has it: `sun 4 thinning`."""
    return re.sub(r"^(\S+)", rf"\1 {number}", name)
