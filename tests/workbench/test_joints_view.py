"""Joints and paths in the 3D view: parts stand as a user sets them, and errors of the build are drawn there."""

import math
from typing import Any

import numpy as np
import pytest
from machine.arm_by_hand import AXES, TOOL, arm_scene, tool_by_hand
from scene_texts import scene_of

from tol3d import Overrides
from tol3d.apps.workbench.builds import Row, build_view, stands
from tol3d.errors import InputError
from tol3d.simulate import load, simulation_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation

MEASURES = """
  off at home: {kind: position_error, of: link 3.tool, from: base, at: home}
  off up: {kind: position_error, of: link 3.tool, from: base, at: up}
  up along z: {kind: position_error, of: link 3.tool, from: base, component: z, at: up}
  worst: {kind: worst_position_error, of: link 3.tool, from: base}
  play: {kind: lost_motion, of: drive 1}"""
JOINTS = ("joint 1", "joint 2", "joint 3")
PLAY = 2e-3
"""mm; the tool lies off by as much as the play of nominal teeth lets it."""


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Simulation:
    scene = scene_of(arm_scene(measures=MEASURES), tmp_path_factory.mktemp("arm"))
    return simulation_of(load(scene), Overrides(trials=4, witness=0))


def _row(simulation: Simulation) -> Row:
    found = drawn(simulation, 3, 1)
    return Row(found.deviations[0], {name: own[0] for name, own in found.positions.items()})


def _tool_at(angles: tuple[float, ...]) -> np.ndarray:
    """Place of the tool at inputs in degrees (3,) [mm]."""
    return tool_by_hand(AXES, TOOL, [math.radians(own) for own in angles])


def _states(simulation: Simulation, **how: Any) -> dict[str, list[dict[str, Any]]]:
    """States of each build, by its name, with what is told of the view."""
    told = build_view(simulation, {"trial": _row(simulation)}, **how)[1]
    assert told["refused"] == {}
    return {build["name"]: build["states"] for build in told["builds"]} | {"told": [told]}


@pytest.mark.parametrize("angles", [(0.0, 0.0, 0.0), (30.0, 70.0, -45.0), (-110.0, 12.5, 160.0), (180.0, -95.0, 33.0)])
def test_the_tool_is_drawn_where_the_inputs_of_joints_place_it(arm: Simulation, angles: tuple[float, ...]) -> None:
    found = _states(arm, standing=dict(zip(JOINTS, angles, strict=True)), measure="off up", factors=(1.0,))
    assert found["told"][0]["worlds"] == ["as set"]
    np.testing.assert_allclose(found["nominal"][0]["features"]["link 3.tool"], _tool_at(angles), rtol=0, atol=PLAY)
    ((start, end), is_error) = found["trial"][0]["measured"]["off up"][0]
    assert is_error
    np.testing.assert_allclose(start, _tool_at(angles), rtol=0, atol=1e-5)
    assert end == found["trial"][0]["features"]["link 3.tool"]


def test_a_body_moves_with_its_joint(arm: Simulation) -> None:
    """A quarter more about the first axis, which is z, turns all links about it, and the base stays."""

    def middles(angle: float) -> dict[str, np.ndarray]:
        model, told = build_view(arm, {}, standing={"joint 1": angle})
        (state,) = told["builds"][0]["states"]
        found = {}
        for part, mesh, pose in zip(told["parts"], state["meshes"], state["poses"], strict=True):
            middle = [*np.ptp(model.surfaces[mesh][0], axis=0) / 2 + model.surfaces[mesh][0].min(axis=0), 1.0]
            found[part["part"]] = (np.reshape(pose, (4, 4)).T @ middle)[:3]
        return found

    before, after = middles(-20.0), middles(70.0)
    assert [*before] == ["base", "link 1", "link 2", "link 3"]
    for name, (x, y, z) in before.items():
        wanted = [x, y, z] if name == "base" else [-y, x, z]
        np.testing.assert_allclose(after[name], wanted, rtol=0, atol=12.0)  # boxes of symbols lie along the axes


@pytest.mark.parametrize(("measure", "own"), [("off up", "up"), ("up along z", "up"), ("off at home", "home")])
def test_an_error_as_the_joints_stand_is_that_of_a_pose_that_stands_so(arm: Simulation, measure: str, own: str) -> None:
    inputs = {each["name"]: each["poses"][own] for each in stands(arm.system)}
    assert [*inputs] == [*JOINTS]
    as_set = _states(arm, standing=inputs, measure=measure, factors=(1.0,))["trial"][0]
    stated = _states(arm, measure=measure, world=own, factors=(1.0,))["trial"][0]
    assert as_set["values"][measure] == f"{stated['values'][measure]}, as it stands"
    np.testing.assert_allclose(as_set["measured"][measure][0][0], stated["measured"][measure][0][0], rtol=0, atol=1e-5)


def test_an_error_is_drawn_as_many_times_as_large_as_the_number_tells(arm: Simulation) -> None:
    """Turns of joints too, also beyond what their teeth have room for."""
    states = _states(arm, standing={"joint 2": 40.0}, measure="off up")["trial"]
    assert [state["factor"] for state in states] == [1.0, 10.0, 100.0]
    (plain, _), *larger = (state["measured"]["off up"][0] for state in states)
    along = np.subtract(plain[1], plain[0])
    for (points, _), factor in zip(larger, (10.0, 100.0), strict=True):
        turned = 2e-3 * factor * float(np.linalg.norm(factor * along))  # links turn, and their arcs are no lines
        np.testing.assert_allclose(np.subtract(points[1], points[0]), factor * along, rtol=0, atol=turned)
    value, unit = states[0]["values"]["off up"].removesuffix(", as it stands").split(" ")
    assert float(value) * {"µm": 1e-3, "mm": 1.0}[unit] == pytest.approx(float(np.linalg.norm(along)), rel=1e-3)
    assert len({state["values"]["off up"] for state in states}) == 1, "the value is the build's own"


def test_the_largest_error_is_drawn_in_the_pose_in_which_it_is_largest(arm: Simulation) -> None:
    values = {
        name: _states(arm, measure=name, factors=(1.0,))["trial"][0]["values"][name]
        for name in ("off at home", "off up")
    }
    found = _states(arm, measure="worst", factors=(1.0,))
    largest = max(values, key=lambda name: float(values[name].split(" ")[0]))
    assert found["told"][0]["world"] == {"off at home": "home", "off up": "up"}[largest]
    assert found["told"][0]["measured"]
    assert found["trial"][0]["values"]["worst"] == values[largest]


def test_poses_are_magnified_beyond_what_teeth_allow_and_gears_are_not(arm: Simulation) -> None:
    gears = build_view(arm, {})[1]["worlds"][-1]
    (_, large), wheel = (
        _states(arm, measure="off up", world=world, factors=(1.0, 100.0))["trial"] for world in ("up", gears)
    )
    assert large["factor"] == 100.0
    assert large["words"] == "trial; deviations magnified 100 times"
    assert wheel[-1]["factor"] < 100.0
    assert f"magnified {wheel[-1]['factor']:g} times, not 100" in wheel[-1]["words"]


@pytest.mark.parametrize(
    ("standing", "message"),
    [
        ({"joint 4": 1.0}, "expected one of joint 1, joint 2, joint 3, got 'joint 4'"),
        ({"joint 1": 181.0}, "joint 1: expected -180 to 180, got 181"),
        ({"joint 1": float("nan")}, "joint 1: expected -180 to 180, got nan"),
    ],
)
def test_inputs_that_no_joint_has_are_refused(arm: Simulation, standing: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        build_view(arm, {}, standing=standing)


def test_a_scene_without_joints_has_none() -> None:
    door = simulation_of(load("door"), Overrides(trials=4, witness=0))
    assert stands(door.system) == []
    with pytest.raises(InputError, match="expected one of no joints, got 'joint 1'"):
        build_view(door, {}, standing={"joint 1": 1.0})


def test_a_linkage_goes_along_its_path() -> None:
    """The crank points to the slider, stands up, and points away: 24 steps of half a turn, of a crank of 40 mm."""
    crank = simulation_of(load("slider_crank"), Overrides(trials=4, witness=0))
    assert [(own["name"], own["low"], own["high"], own["unit"]) for own in stands(crank.system)] == [
        ("turn", 0, 24, ""),
        ("poses", 0, 2, ""),
    ]
    assert stands(crank.system)[1]["poses"] == {"far": 0, "up": 1, "near": 2}
    face, at = "slider.face", dict[int, Any]()
    for step in (0, 5, 12, 24):
        found = _states(crank, standing={"turn": step}, measure="worst place", factors=(1.0,))
        at[step] = found["nominal"][0]["features"]
        ((start, end), is_error) = found["trial"][0]["measured"]["worst place"][0]
        assert is_error
        np.testing.assert_allclose(start, at[step][face], rtol=0, atol=1e-5)
        assert end == found["trial"][0]["features"][face]
    for step, pose in ((0, "far"), (12, "up"), (24, "near")):
        stated = _states(crank, world=pose, factors=(1.0,))["nominal"][0]["features"]
        np.testing.assert_allclose([at[step][name] for name in stated], [*stated.values()], rtol=0, atol=1e-5)
    for step in at:
        angle = math.pi * step / 24
        wanted = 40.0 * math.cos(angle), 40.0 * math.sin(angle), 0.0
        np.testing.assert_allclose(at[step]["crank.pin"], wanted, rtol=0, atol=1e-5)


def test_a_linkage_stands_in_poses_in_which_nothing_is_read() -> None:
    """The platform's centre where the pose states it; no measure is read aside."""
    platform = simulation_of(load("stewart"), Overrides(trials=4, witness=0))
    (poses,) = (own["poses"] for own in stands(platform.system) if own["poses"])
    assert [*poses] == ["home", "aside", "leaning"]
    found = _states(platform, standing={"poses": poses["aside"]}, measure="place at home", factors=(1.0,))
    np.testing.assert_allclose(found["nominal"][0]["features"]["platform.centre"], (60, 20, 280), rtol=0, atol=1e-5)
    assert found["trial"][0]["values"]["place at home"].endswith(", as it stands")
