"""FCL as the witness of assemblies: round gaps and clearances, against closed forms and the exact method."""

from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from fixtures import Command
from places import SCENES
from scene_texts import written

from tol3d import Overrides, run_scene
from tol3d.assembly.model.statuses import OVERLAP
from tol3d.assembly.system import AssemblySystem
from tol3d.assembly.witness import FclWitness
from tol3d.simulate import load, simulation_of
from tol3d.study.system.stated import stated
from tol3d.study.trials.draws import drawn

ROUND = """
scene: round surfaces
parts:
  table:
    kind: solid
    features:
      top: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [100 mm, 100 mm]}
      rod: {kind: cylinder, at: [0 mm, 0 mm, 6 mm], axis: [1, 0, 0], length: 40 mm, diameter: 8 mm}
      bore: {kind: cylinder, at: [0 mm, 30 mm, 6 mm], axis: [1, 0, 0], length: 40 mm, diameter: 8 mm, hole: true}
  tool:
    kind: solid
    placed: {at: [0 mm, 0 mm, 20 mm]}
    features:
      seat: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [40 mm, 40 mm]}
      ball: {kind: sphere, at: [3 mm, 1 mm, -2 mm], diameter: 6 mm}
      tip: {kind: point, at: [0 mm, 2 mm, -3 mm]}
      across: {kind: cylinder, at: [0 mm, 0 mm, 1 mm], axis: [0, 1, 0], length: 30 mm, diameter: 5 mm}
      along: {kind: cylinder, at: [0 mm, 2 mm, 1 mm], axis: [1, 0, 0], length: 30 mm, diameter: 5 mm}
      pin: {kind: cylinder, at: [0 mm, 30 mm, -14 mm], axis: [1, 0, 0], length: 30 mm, diameter: 7 mm}
tolerances:
  height: {kind: profile, of: tool.seat, zone: {width: 0.4 mm}, law: {kind: uniform}}
  rod size: {kind: size, of: table.rod, distribution: {kind: uniform, lower: -0.1 mm, upper: 0.1 mm}}
  ball size: {kind: size, of: tool.ball, distribution: {kind: uniform, lower: -0.1 mm, upper: 0.1 mm}}
moves:
  set up: {kind: fix, part: table}
  tool down:
    kind: mate
    part: tool
    relations: [{kind: distance, from: tool.seat, to: table.top, distance: 20 mm}]
measures:
  ball to plane: {kind: surface_gap, from: tool.ball, to: table.top}
  plane to cylinder: {kind: surface_gap, from: table.top, to: tool.across}
  ball to rod: {kind: surface_gap, from: tool.ball, to: table.rod}
  point to rod: {kind: surface_gap, from: tool.tip, to: table.rod}
  rods across: {kind: surface_gap, from: table.rod, to: tool.across}
  rods along: {kind: surface_gap, from: table.rod, to: tool.along}
  pin in bore: {kind: surface_gap, from: table.bore, to: tool.pin}
  tilt: {kind: angle, from: table.top, to: tool.seat}
study: {trials: 200, seed: 2, witness: 40}
"""


@pytest.fixture(scope="module")
def surfaces(tmp_path_factory: pytest.TempPathFactory) -> Assembled:
    return assembled(ROUND, tmp_path_factory.mktemp("surfaces"))


def witness_of(system: AssemblySystem) -> FclWitness:
    made = system.method("fcl", system.materials("fcl"))
    assert isinstance(made, FclWitness)
    return made


def test_gaps_of_round_surfaces_follow_by_hand(surfaces: Assembled) -> None:
    """Without tilt, at an offset o and with sizes larger by s of the rod and b of the ball."""
    offset, s, b = rows = np.random.default_rng(4).uniform(-0.1, 0.1, (3, 60))
    deviations = np.zeros((60, 5))
    deviations[:, [0, 3, 4]] = rows.T
    system = surfaces.system
    found = witness_of(system).answers(stated(system, deviations), system.measures[:6]).values
    up = 20.0 + offset  # of the seat over the top
    by_hand = {
        "ball to plane": up - 2.0 - 3.0 - b / 2,
        "plane to cylinder": up + 1.0 - 2.5,
        "ball to rod": np.hypot(1.0, up - 2.0 - 6.0) - 4.0 - s / 2 - 3.0 - b / 2,
        "point to rod": np.hypot(2.0, up - 3.0 - 6.0) - 4.0 - s / 2,
        "rods across": up + 1.0 - 6.0 - 4.0 - s / 2 - 2.5,
        "rods along": np.hypot(2.0, up + 1.0 - 6.0) - 4.0 - s / 2 - 2.5,
    }
    for name, own in by_hand.items():
        assert found[name][:, 0] == pytest.approx(own, abs=1e-6), name


def test_surfaces_that_overlap_have_a_gap_below_0(surfaces: Assembled) -> None:
    system = surfaces.system
    deviations = np.zeros((1, 5))
    deviations[0, 0] = -8.5  # the rods across are nominally 8.5 mm apart
    deviations[0, 3] = 2.0
    read = witness_of(system).answers(stated(system, deviations), system.measures[4:5]).values["rods across"]
    assert read[0, 0] == pytest.approx(-1.0, abs=1e-6)


def test_trials_are_read_as_the_exact_method_reads_them(surfaces: Assembled) -> None:
    trials = drawn(surfaces.simulation, 0, 100)
    system = surfaces.system
    witness, exact = witness_of(system), surfaces.values(trials)
    read = [own for own in system.measures if witness.reads(own)]
    assert [own.name for own in read] == [own.name for own in system.measures[:6]]
    found = witness.answers(trials, read).values
    for own in read:
        assert found[own.name][:, 0] == pytest.approx(exact[own.name], abs=1e-6), own.name
        assert witness.bounds(own) == pytest.approx((0.0, 0.01))


def test_a_run_has_what_the_witness_read_and_leaves_out_what_it_cannot(tmp_path: Path) -> None:
    path = written(ROUND, tmp_path)
    summary = run_scene(path, out=tmp_path / "run").summary
    assert summary["warnings"] == ["tilt: no tolerance was seen to act on it in 16 builds"]
    found = summary["witness"]
    assert (found["engine"], found["trials"], found["status_differences"]) == ("fcl", 40, 0)
    assert len(found["measures"]) == 6
    for own in found["measures"].values():
        assert own["compared"] == 40
        assert own["max_abs_difference"] < own["allowance"]


PIN = """
scene: a pin beside a post
parts:
  base:
    kind: solid
    builder:
      kind: plate
      length: 60 mm
      width: 60 mm
      thickness: 10 mm
      pins: {post: {at: [0 mm, 0 mm], diameter: 12 mm, height: 30 mm}}
    features:
      top: {kind: plane, at: [0 mm, 0 mm, 10 mm], normal: [0, 0, 1], extent: [60 mm, 60 mm]}
      side: {kind: plane, at: [30 mm, 0 mm, 5 mm], normal: [1, 0, 0], extent: [60 mm, 10 mm], along: [0, 1, 0]}
  cap:
    kind: solid
    placed: {at: [0 mm, 0 mm, 15 mm]}
    builder:
      kind: plate
      length: 40 mm
      width: 40 mm
      thickness: 8 mm
      holes: {hole: {at: [0 mm, 0 mm], diameter: 12.4 mm}}
    features:
      side: {kind: plane, at: [20 mm, 0 mm, 4 mm], normal: [1, 0, 0], extent: [40 mm, 8 mm], along: [0, 1, 0]}
      facing: {kind: plane, at: [-20 mm, 0 mm, 4 mm], normal: [-1, 0, 0], extent: [40 mm, 8 mm], along: [0, 1, 0]}
tolerances:
  off: {kind: profile, of: base.side, zone: {width: 0.06 mm}, law: {kind: uniform}}
moves:
  table: {kind: fix, part: base}
  cap over the post:
    kind: mate
    part: cap
    relations: [{kind: distance, from: cap.facing, to: base.side, distance: -50 mm}]
measures:
  cap to base: {kind: clearance, from: cap, to: base, chord_error: 4 um}
study: {trials: 100, seed: 1, witness: 30}
"""


@pytest.mark.slow
def test_a_clearance_is_witnessed_by_meshes_of_half_the_step(tmp_path: Path) -> None:
    path = written(PIN, tmp_path)
    summary = run_scene(path, out=tmp_path / "run").summary
    own = summary["witness"]["measures"]["cap to base"]
    assert summary["witness"]["chord_error_um"] <= 1.0
    assert 0.0 < own["max_abs_difference"] <= own["expected_at_most"] <= 5.0
    assert summary["warnings"] == []


@pytest.mark.parametrize(("scene", "has_one"), [("box_with_discs", True), ("cover_on_base", False)])
def test_a_scene_has_a_witness_where_fcl_reads_something(scene: str, has_one: bool) -> None:
    methods = simulation_of(load(SCENES / f"{scene}.yaml")).system.methods
    assert ("fcl" in methods) == has_one


def test_a_scene_without_one_is_refused_the_option(tol3d: Command) -> None:
    code, _, err = tol3d("run", "cover_on_base", "--witness", "5")
    assert code == 2
    assert "--witness (in Python Overrides.witness): expected none, for this scene has no witness, got 5" in err


def test_overlap_is_the_same_status_by_both(tmp_path: Path) -> None:
    made = assembled(PIN, tmp_path)
    system = made.system
    trials = stated(system, np.array([[0.3, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    both = [system.method(name, system.materials(name)).answers(trials, system.measures) for name in ("exact", "fcl")]
    for found in both:
        assert found.status["cap to base"].tolist() == [OVERLAP, 0]


def test_the_engine_is_exact_or_analytic(tol3d: Command) -> None:
    code, _, err = tol3d("run", "box_with_discs", "--engine", "fcl")
    assert code == 2
    assert "expected exact or analytic, got 'fcl'; these are the engines of this scene" in err


def test_overrides_of_the_witness_are_kept(tmp_path: Path) -> None:
    path = written(ROUND, tmp_path)
    assert "witness" not in run_scene(path, overrides=Overrides(witness=0), out=tmp_path / "run").summary
