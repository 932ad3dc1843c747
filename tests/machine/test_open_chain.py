"""Arms whose links trains turn, against homogeneous matrices and sums worked out here."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from machine.arm_by_hand import (
    AXES,
    DRIVE,
    MASSES,
    POSES,
    STAGE,
    THIN,
    TOOL,
    arm_scene,
    columns_of,
    errors,
    plays,
    system_of,
    tool_by_hand,
)
from machine.housed import Array
from scene_texts import edited, refusal, scene_of

from tol3d import Overrides, load_scene, run_scene
from tol3d.apps.adjustment.compensation import CompensationQuestion, compensation
from tol3d.gearing.machine import chain
from tol3d.gearing.machine.chain import Chain
from tol3d.gearing.machine.closed_form import with_joints
from tol3d.gearing.machine.system import MachineSystem
from tol3d.study.system.closed_form import ClosedForm, Share
from tol3d.study.system.stated import component_slices
from tol3d.study.system.trials import Trials
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

WORST = """
  worst: {kind: worst_position_error, of: link 3.tool, from: base}
  worst of any: {kind: worst_position_error, of: link 3.tool, from: base, flanks: any}
  size home: {kind: position_error, of: link 3.tool, from: base, at: home}
  size up: {kind: position_error, of: link 3.tool, from: base, at: up}"""
SMALL = 24


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> MachineSystem:
    return system_of(arm_scene(measures=errors() + WORST), tmp_path_factory.mktemp("arm"))


@pytest.fixture(scope="module")
def trials(arm: MachineSystem, tmp_path_factory: pytest.TempPathFactory) -> Trials:
    place = tmp_path_factory.mktemp("arm") / "arm.yaml"
    place.write_text(arm_scene(measures=errors() + WORST), "utf-8")
    simulation = simulation_of(load_scene(place), Overrides())
    return drawn(simulation, 0, SMALL)


def answers(system: MachineSystem, trials: Trials, method: str) -> dict[str, Array]:
    found = system.method(method, system.materials(method)).answers(trials, system.measures)
    return {name: values[:, 0] for name, values in found.values.items()}


def turns(system: MachineSystem, trials: Trials, pose: str, sides: Array) -> Array:
    return np.radians(POSES[pose]) + sides / 2 * plays(system, trials, pose)


def sides_of(system: MachineSystem, trials: Trials) -> Array:
    """Joint 1 is vertical: its flank is drawn. Gravity lowers links 2 and 3: about axes that look to -y, below 0."""
    flank = columns_of(system, trials, "flank of joint 1")[:, 0]
    return np.stack([flank, np.full(len(trials), -1.0), np.full(len(trials), -1.0)], axis=1)


def bores(system: MachineSystem, trials: Trials, k: int) -> list[list[tuple[Array, Array]]]:
    """Displacements of both ends of every bore, by trial and joint, along the bore's x and y in the world."""
    found = []
    for row in range(len(trials)):
        its = []
        for joint, (_, z) in enumerate(AXES):
            own = columns_of(system, trials, f"bore {joint + 1}")[row]
            x = np.eye(3)[0] - np.array(z) * z[0]
            x /= np.linalg.norm(x)
            y = np.cross(z, x)
            its.append((own[0] * x + own[1] * y, own[2] * x + own[3] * y))
        found.append(its)
    return found


def loose(rng: np.random.Generator, flanks: int) -> Trials:
    """Trials of three stages that all have play: thicknesses and run-outs in turn, then flanks."""
    found = Trials(rng.normal(0.0, 0.003, (SMALL, 9 + flanks)), {f"stage {k}": np.zeros(SMALL) for k in (1, 2, 3)})
    found.deviations[:, [0, 3, 6]] -= 0.06
    found.deviations[:, 9:] = np.where(rng.random((SMALL, flanks)) < 0.5, -1.0, 1.0)
    return found


@pytest.mark.parametrize("pose", POSES)
def test_the_tool_is_where_homogeneous_matrices_have_it(arm: MachineSystem, trials: Trials, pose: str) -> None:
    found = answers(arm, trials, "exact")
    turned, ends = turns(arm, trials, pose, sides_of(arm, trials)), bores(arm, trials, 3)
    nominal = tool_by_hand(AXES, TOOL, np.radians(POSES[pose]).tolist())
    for row in range(len(trials)):
        by_hand = tool_by_hand(AXES, TOOL, turned[row].tolist(), ends[row]) - nominal
        assert [found[f"{c} {pose}"][row] for c in "xyz"] == pytest.approx(by_hand, abs=1e-9)


def test_to_first_order_each_joint_moves_the_tool_by_half_its_play_times_its_lever(tmp_path: Path) -> None:
    system = system_of(arm_scene(bores=False, measures=errors()), tmp_path)
    rng = np.random.default_rng(5)
    trials = loose(rng, flanks=1)
    found, exact = answers(system, trials, "analytic"), answers(system, trials, "exact")
    for pose, inputs in POSES.items():
        play = plays(system, trials, pose, "analytic")
        moved = np.zeros((SMALL, 3))
        for k, (at, z) in enumerate(AXES):
            before = [*np.radians(inputs[:k]), *np.zeros(3 - k)]
            o, tip = tool_by_hand(AXES, at, before), tool_by_hand(AXES, TOOL, np.radians(inputs).tolist())
            axis = tool_by_hand(AXES, np.array(at) + np.array(z), before) - o
            moved += np.outer(sides_of(system, trials)[:, k] / 2 * play[:, k], np.cross(axis, tip - o))
        for k, component in enumerate("xyz"):
            assert found[f"{component} {pose}"] == pytest.approx(moved[:, k], abs=1e-12)
            assert exact[f"{component} {pose}"] == pytest.approx(moved[:, k], abs=2e-2)


def test_a_chain_of_other_numbers_is_where_matrices_have_it(tmp_path: Path) -> None:
    rng = np.random.default_rng(8)
    for _ in range(4):
        axes = [(rng.uniform(-300.0, 300.0, 3).round(3), rng.normal(size=3).round(4)) for _ in range(3)]
        axes = [(at, z / np.linalg.norm(z)) for at, z in axes]
        tool, poses = (
            rng.uniform(-400.0, 400.0, 3).round(3).tolist(),
            {pose: rng.uniform(-180, 180, 3).round(2).tolist() for pose in POSES},
        )
        text = arm_scene(axes=axes, tool=tool, poses=poses, bores=False, measures=errors(), masses=(), gravity="")
        system = system_of(text, tmp_path)
        free = loose(rng, flanks=3)
        found = answers(system, free, "exact")
        for pose, inputs in poses.items():
            turned = np.radians(inputs) + free.deviations[:, -3:] / 2 * plays(system, free, pose)
            nominal = tool_by_hand(axes, tool, np.radians(inputs).tolist())
            by_hand = np.array([tool_by_hand(axes, tool, own.tolist()) - nominal for own in turned])
            for k, component in enumerate("xyz"):
                assert found[f"{component} {pose}"] == pytest.approx(by_hand[:, k], abs=1e-6)  # as axes are written


def test_the_worst_is_the_largest_over_poses_and_flanks(arm: MachineSystem, trials: Trials) -> None:
    for method in ("exact", "analytic"):
        found = answers(arm, trials, method)
        assert (found["worst"] == np.maximum(found["size home"], found["size up"])).all()
    found, largest, ends = answers(arm, trials, "exact"), np.zeros(SMALL), bores(arm, trials, 3)
    for pose, inputs in POSES.items():
        nominal = tool_by_hand(AXES, TOOL, np.radians(inputs).tolist())
        for sides in np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T:
            turned = turns(arm, trials, pose, sides[None])
            sizes = [
                np.linalg.norm(tool_by_hand(AXES, TOOL, own.tolist(), ends[row]) - nominal)
                for row, own in enumerate(turned)
            ]
            largest = np.maximum(largest, sizes)
    assert found["worst of any"] == pytest.approx(largest, abs=1e-9)


def test_contributors_of_every_joint_and_bore_act(arm: MachineSystem) -> None:
    by_name = {own.name: own for own in arm.measures}
    of_worst = {own.name for own in arm.acting(by_name["worst"])}
    assert of_worst == {own.name for own in arm.contributors}
    assert "pinion 1 thickness" not in {own.name for own in arm.acting(by_name["z home"])}  # a vertical axis
    assert {"pinion 2 thickness", "wheel 3 run-out", "bore 1"} <= {own.name for own in arm.acting(by_name["z home"])}


def test_a_closed_form_adds_up_what_joints_and_bores_do(tmp_path: Path) -> None:
    text = arm_scene(measures="\n  z home: {kind: position_error, of: link 3.tool, from: base, component: z, at: home}")
    place = tmp_path / "arm.yaml"
    place.write_text(text, "utf-8")
    count = 4000
    run = run_scene(place, overrides=Overrides(trials=count), out=tmp_path / "run").summary["measures"]["z home"]
    form, analytic = run["analytic_closed_form"], run["analytic"]
    assert form["mean"] == pytest.approx(analytic["mean"], abs=4 * analytic["sigma"] / math.sqrt(count))
    assert form["sigma"] == pytest.approx(analytic["sigma"], rel=4 / math.sqrt(2 * count))
    geometric = sum(own["geometric_percent"] for own in run["contributors"])
    assert geometric == pytest.approx(100.0, abs=3.0)


def test_a_joint_that_turns_the_other_way_on_one_method_is_told(tmp_path: Path, monkeypatch: Any) -> None:
    from tol3d.assembly.torsors.torsor import cross_matrix

    def turned_back(move: Chain, world: Any) -> Any:
        for joint in move.joints:
            at, z = world.origin(joint.axis), world.axis(joint.axis)
            sign = -1.0 if joint.name == "joint 3" else 1.0
            turned = world.columns.zeros(6)
            turned[:3, joint.column], turned[3:, joint.column] = sign * cross_matrix(at) @ z, sign * z
            world = world.with_part_at(
                joint.part, world.placed(joint.axis) + turned - world.on_body(joint.seat, joint.part)
            )
        return world

    monkeypatch.setattr(chain, "displaced", turned_back)
    place = tmp_path / "arm.yaml"
    place.write_text(arm_scene(measures=errors()), "utf-8")
    run = run_scene(place, overrides=Overrides(trials=400), out=tmp_path / "run").summary
    assert run["measures"]["z home"]["agreement"]["explanation"]["faults"] != []


def test_what_a_jammed_train_carries_is_not_built_and_says_which(tmp_path: Path) -> None:
    text = arm_scene(measures=errors()).replace("lower: -60 um, upper: -30 um", "lower: -40 um, upper: 20 um", 1)
    system = system_of(text, tmp_path)
    trials = drawn(simulation_of(scene_of(text, tmp_path), Overrides()), 0, 400)
    found = system.method("exact", {}).answers(trials, system.measures)
    jams = plays(system, trials, "home")[:, 0] < 0.0
    assert 0 < np.count_nonzero(jams) < 400
    codes = np.array([system.statuses.texts[code] for code in found.status["y home"]])
    assert (codes[jams] == "no build").all()
    assert (codes[~jams] == "ok").all()
    assert (found.details["reason:y home"][jams] == "train of joint 1").all()
    assert np.isnan(found.values["y home"][jams, 0]).all()


LAST = "joint 3: -45.0 deg"
PLACED = "link 2:\n    kind: solid\n    placed: {at: ["
LINKS = "link 1, link 2, link 3"
WRONG = {
    "five of six": (LAST, "", "poses.up: expected an input of each of the 3 joints, got none of 'joint 3'"),
    "another joint": (
        LAST, "joint 3: 0 deg, joint 4: 0 deg", "expected a joint of joint 1, joint 2, joint 3, got 'joint 4'"
    ),
    "axes apart": (f"{PLACED}50 mm", f"{PLACED}51 mm", "got 'link 2.pilot' 1 mm beside 'link 1.bore'"),
    "no such pose": ("z, at: up", "z, at: upp", "z up.at: expected one of the poses home, up, got 'upp'"),
    "a train twice": (
        "train: drive 3", "train: drive 2", "a train that turns one joint, got 'drive 2', which turns 'joint 2' too"
    ),
    "placed twice": (
        "link 3.pilot], train", "link 2.pilot], train", "another link after each joint, got 'link 2' after two"
    ),
    "masses without gravity": ("\n    gravity: [0, 0, -1]", "", "gravity: expected its direction beside masses"),
    "links before their joints": (
        "between: [base.bore, link 1", "between: [link 2.bore, link 1", "a link that joints before it have placed"
    ),
    "a worst error of no pose": (
        "\nstudy", "\n  w: {kind: worst_position_error, of: link 3.tool, from: base, poses: [upp]}\nstudy",
        "w.poses[0]: expected one of the poses home, up, got 'upp'"
    ),
    "a difference of two poses": (
        "\nstudy", "\n  d: {kind: difference, of: x up, minus: x home}\nstudy",
        "d.minus: expected a measure that is read at 'up', as 'x up' is, got 'x home', which is read at 'home'"
    ),
    "a mass elsewhere": ("- {of: link 2", "- {of: base", f"expected a link of the chain: {LINKS}, got 'base'"),
}  # fmt: skip


@pytest.mark.parametrize(("old", "new", "words"), WRONG.values(), ids=WRONG)
def test_what_is_no_chain_is_refused_in_one_line(old: str, new: str, words: str, tmp_path: Path) -> None:
    said = refusal(edited(arm_scene(measures=errors()), (old, new)), tmp_path)
    assert words in said
    assert "\n" not in said


def test_masses_decide_the_flank(tmp_path: Path) -> None:
    system = system_of(arm_scene(measures=errors(), masses=[*MASSES, (2, 100.0, (-400.0, 0.0, 0.0))]), tmp_path)
    sides = {drive.joint: dict(drive.sides) for drive in system.drives}
    torque = 10.0 * 200.0 + 5.0 * 550.0 + 100.0 * 0.0  # about joint 2 at home: the counterweight hangs above it
    assert torque > 0.0
    assert sides["joint 1"] == {"home": 0, "up": 0}
    assert sides["joint 2"]["home"] == -1
    assert sides["joint 3"]["home"] == 1


def test_a_seat_that_leans_takes_its_link_along(tmp_path: Path) -> None:
    """A flange that rises by 1 mm at 40 mm from its middle lays its link askew by that, and the tool at 750 mm."""
    flange = "flange: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [80 mm, 80 mm]}"
    law = "zone: {width: 80 um}, law: {kind: uniform}"
    text = arm_scene(
        axes=AXES[:1],
        tool=(750.0, 0.0, 200.0),
        poses={"home": (0.0,)},
        masses=(),
        bores=False,
        measures="\n  z home: {kind: position_error, of: link 1.tool, from: base, component: z, at: home}",
    )
    text = text.replace("\n      tool:", f"\n      {flange}\n      tool:")
    text = text.replace("link 1.pilot], train", "link 1.pilot], seat: [flange, pilot], train")
    lean = f"\n  lean: {{kind: perpendicularity, of: link 1.flange, datums: [pilot], {law}}}"
    system = system_of(text.replace("\nmoves:", f"{lean}\nmoves:"), tmp_path)
    place = component_slices(system.drawn)["lean"]
    slopes = system.poses["home"].slopes_of("z home").coefficients[place]
    assert np.abs(slopes) == pytest.approx([750.0 / 40.0, 0.0], abs=1e-9)
    rows = np.zeros((1, max(own.stop for own in component_slices(system).values())))
    rows[0, component_slices(system)["lean"].start] = 0.01
    found = answers(system, Trials(rows, {"stage 1": np.zeros(1)}), "exact")["z home"]
    assert np.abs(found) == pytest.approx([0.01 * 750.0 / 40.0], abs=1e-4)


def test_compensation_of_an_arm_is_that_of_its_gears(tmp_path: Path) -> None:
    found = []
    gears = f"parts:{STAGE.format(k=2)}\ntolerances:{THIN.format(k=2)}\nmoves:{DRIVE.format(k=2)}"
    measures = "measures:\n  lost: {kind: lost_motion, of: drive 2}"
    alone = f"scene: gears\n{gears}\n{measures}\nstudy: {{trials: 40, seed: 3}}\n"
    for text in (arm_scene(measures=errors()), alone):
        question = CompensationQuestion(train="drive 2", robots=40)
        found.append(compensation(scene_of(text, tmp_path), question).corrections["geometric"])
    assert found[0] == found[1]
    assert found[0].motor == pytest.approx(3 * 5.4, abs=0.6)  # 45 um of 28.5 mm cos 20 deg, thrice at the motor


def test_a_difference_is_read_in_the_pose_of_both(tmp_path: Path) -> None:
    more = "\n  d: {kind: difference, of: x up, minus: z up}"
    system = system_of(arm_scene(bores=False, measures=errors() + more), tmp_path)
    trials = loose(np.random.default_rng(6), flanks=1)
    for method in ("exact", "analytic"):
        found = answers(system, trials, method)
        assert found["d"] == pytest.approx(found["x up"] - found["z up"], abs=1e-9)
        assert np.abs(found["d"]).max() > 0.1


WITHOUT_TRAINS = """
scene: arm without trains
parts:
  base: {kind: solid, features: {bore: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 60 mm}}}
  link 1:
    kind: solid
    features:
      pilot: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 30 mm}
      bore: {kind: axis, at: [50 mm, 0 mm, 400 mm], axis: [0, 1, 0], length: 50 mm}
  link 2:
    kind: solid
    placed: {at: [50 mm, 0 mm, 400 mm], z: [0, 1, 0], x: [1, 0, 0]}
    features:
      pilot: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 30 mm}
      flange: {kind: plane, at: [500 mm, 0 mm, 0 mm], normal: [1, 0, 0], extent: [60 mm, 60 mm]}
tolerances:
  base off:
    kind: plus_minus
    of: base.bore
    along: [1, 0, 0]
    distribution: {kind: uniform, lower: -50 um, upper: 90 um}
  link off:
    kind: plus_minus
    of: link 1.bore
    along: [1, 0, 0]
    distribution: {kind: uniform, lower: -20 um, upper: 70 um}
moves:
  stand: {kind: fix, part: base}
  arm:
    kind: open_chain
    joints:
      j1: {between: [base.bore, link 1.pilot]}
      j2: {between: [link 1.bore, link 2.pilot]}
    poses:
      home: {j1: 0 deg, j2: 0 deg}
      side: {j1: 100 deg, j2: -70 deg}
      back: {j1: -150 deg, j2: 40 deg}
measures:
  worst: {kind: worst_position_error, of: link 2.flange, from: base}
"""


def test_the_worst_of_an_arm_without_trains_is_the_largest_over_poses(tmp_path: Path) -> None:
    """A bore off by b, and one off by l on a link that stands at an angle: the size of b + l turned by that angle."""
    system = system_of(WITHOUT_TRAINS, tmp_path)
    slices, rng = component_slices(system), np.random.default_rng(5)
    base, link = rng.uniform(-0.05, 0.09, SMALL), rng.uniform(-0.02, 0.07, SMALL)
    deviations = np.zeros((SMALL, 2))
    deviations[:, slices["base off"]], deviations[:, slices["link off"]] = base[:, None], link[:, None]
    cosines = np.cos(np.radians([0.0, 100.0, -150.0]))[:, None]
    sizes = np.sqrt(base**2 + link**2 + 2.0 * base * link * cosines).max(axis=0)
    for method in ("exact", "analytic"):
        assert answers(system, Trials(deviations, {}), method)["worst"] == pytest.approx(sizes, abs=1e-9), method


def test_a_chain_on_a_chain_is_one_chain(tmp_path: Path) -> None:
    """The last joint as a chain of its own, which has another pose and lacks the first: it stands in its own first."""
    whole = arm_scene(measures=errors(), bores=False)
    hand = "joint 3: {between: [link 2.bore, link 3.pilot], train: drive 3}"
    apart = whole.replace(f"\n      {hand}", "").replace(", joint 3: 0.0 deg", "").replace(", joint 3: -45.0 deg", "")
    last = "\n      - {of: link 3, mass: 5.0 kg, at: [150 mm, 0 mm, 0 mm]}"
    assert last in apart
    own = f"\n  hand:\n    kind: open_chain\n    joints: {{{hand}}}\n    gravity: [0, 0, -1]\n    masses:{last}"
    poses = "\n    poses: {shut: {joint 3: 0 deg}, up: {joint 3: -45 deg}}"
    apart = apart.replace(last, "").replace("\nmeasures:", f"{own}{poses}\nmeasures:")
    systems = [system_of(text, tmp_path) for text in (whole, apart)]
    trials = loose(np.random.default_rng(7), flanks=1)
    for method in ("exact", "analytic"):
        one, two = (answers(system, trials, method) for system in systems)
        for name in one:
            assert two[name] == pytest.approx(one[name], abs=1e-9), name


@pytest.mark.slow
def test_fcl_witnesses_a_tool_as_far_as_it_does_its_trains(tmp_path: Path) -> None:
    place = tmp_path / "arm.yaml"
    place.write_text(arm_scene(measures=errors() + WORST), "utf-8")
    run = run_scene(place, overrides=Overrides(trials=40, witness=6), out=tmp_path / "run").summary
    assert [own for own in run["warnings"] if "witness" in own] == []
    assert run["witness"]["measures"].keys() == run["measures"].keys()


def test_a_contributor_of_two_trains_and_the_part_acts_by_the_sum_of_all() -> None:
    """By hand: `wall` by 1.5 - 0.5 (2) + 2 (0.3) = 1.1, of means 3 - 0.5 (-4) + 2 (0.7) = 6.4 and sigma 0.2 each."""
    part = ClosedForm(10.0, 13.0, 0.3, (Share("wall", 1.5, 3.0, 0.09),))
    first = ClosedForm(1.0, 0.0, 0.0, (Share("wall", 2.0, -4.0, 0.16), Share("gear", 1.0, 3.0, 0.25)))
    last = ClosedForm(
        -2.0, 0.0, 0.0, (Share("wall", 0.3, 0.7, 0.0036), Share("shim", -1.0, 0.5, 0.01)), frozenset({"shim"})
    )
    found = with_joints(part, [(-0.5, first), (2.0, last)], ["shim", "gear", "wall"])
    assert [own.name for own in found.shares] == ["shim", "gear", "wall"]
    by_hand = {"shim": (-2.0, 1.0, 0.04), "gear": (-0.5, -1.5, 0.0625), "wall": (1.1, 6.4, (1.1 * 0.2) ** 2)}
    for own in found.shares:
        assert (own.coefficient, own.mean, own.variance) == pytest.approx(by_hand[own.name], rel=1e-12)
    assert found.nominal == pytest.approx(10.0 - 0.5 - 4.0)
    assert found.mean == pytest.approx(5.5 + 1.0 - 1.5 + 6.4)
    assert found.sigma == pytest.approx(math.sqrt(0.04 + 0.0625 + 0.22**2))
    assert found.leaning == {"shim"}
