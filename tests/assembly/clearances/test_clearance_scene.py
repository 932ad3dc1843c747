"""Clearances in scenes: both methods, by hand and trial by trial; what is refused; what else a run says of them."""

import sys
from pathlib import Path
from subprocess import run

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from fixtures import Command
from numpy.typing import NDArray
from places import SCENES
from scene_texts import Edit, edited, refusal

from tol3d.assembly.model.statuses import OK, OVERLAP
from tol3d.assembly.system import AssemblySystem, ClearanceSystem
from tol3d.study.system.stated import stated
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

LID = (SCENES / "lid_by_a_wall.yaml").read_text("utf-8")
BLOCKS = """
scene: two blocks
parts:
  lower:
    kind: solid
    builder: {kind: plate, length: 100 mm, width: 60 mm, thickness: 10 mm}
    features:
      top: {kind: plane, at: [0 mm, 0 mm, 10 mm], normal: [0, 0, 1], extent: [100 mm, 60 mm]}
  upper:
    kind: solid
    placed: {at: [5 mm, 3 mm, 10.5 mm]}
    builder: {kind: plate, length: 40 mm, width: 20 mm, thickness: 5 mm}
    features:
      bottom: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [40 mm, 20 mm]}
tolerances:
  upper face:
    {kind: profile, of: upper.bottom, zone: {width: 0.4 mm}, law: {kind: uniform}}
moves:
  table: {kind: fix, part: lower}
  upper on lower:
    kind: mate
    part: upper
    relations: [{kind: distance, from: upper.bottom, to: lower.top, distance: 0.5 mm}]
measures:
  apart: {kind: clearance, from: lower, to: upper}
study: {trials: 100, seed: 1}
"""


@pytest.fixture(scope="module")
def blocks(tmp_path_factory: pytest.TempPathFactory) -> Assembled:
    return assembled(BLOCKS, tmp_path_factory.mktemp("blocks"))


def answers(made: Assembled, deviations: Array, method: str) -> tuple[Array, NDArray[np.int8]]:
    system = made.system
    found = system.method(method, system.materials(method)).answers(stated(system, deviations), system.measures)
    count = len(deviations)
    return found.values["apart"][:, 0], found.status.get("apart", np.zeros(count, dtype=np.int8))


def test_plates_over_each_other_are_apart_by_their_lowest_corner(blocks: Assembled) -> None:
    """The face is offset and tilted by the deviations, and the plate that carries it by as much to the other side."""
    rng = np.random.default_rng(2)
    deviations = rng.uniform(-0.05, 0.05, (50, 3))  # offset, rises at x = 20 and y = 10
    offset, rise_x, rise_y = deviations.T
    lowest = 0.5 + offset - np.abs(rise_x) - np.abs(rise_y)
    linear, _ = answers(blocks, deviations, "analytic")
    assert linear == pytest.approx(lowest, abs=1e-9)
    exact, codes = answers(blocks, deviations, "exact")
    assert (codes == OK).all()
    # a tilt of 0.05/10 to each side shortens heights and lowers a face 10.5 mm high by less than its square times them
    assert exact == pytest.approx(lowest, abs=2 * (0.05 / 10) ** 2)


def test_both_methods_differ_by_what_is_of_second_order(tmp_path: Path) -> None:
    made = assembled(LID, tmp_path)
    trials = drawn(made.simulation, 0, 100)

    def difference(factor: float) -> float:
        exact, linear = (made.values(trials.scaled(factor), method)["lid to wall"] for method in ("exact", "analytic"))
        return float(np.abs(exact - linear).max())

    assert difference(1.0) < 3e-4
    assert difference(1.0) / difference(0.5) == pytest.approx(4.0, rel=0.3)  # terms of third order beside them
    assert difference(0.0) < 1e-9


def test_plates_that_overlap_have_the_status_and_no_value(blocks: Assembled) -> None:
    deviations = np.array([[-0.4, 0.0, 0.0], [-0.6, 0.0, 0.0], [0.0, 0.51, 0.0]])
    exact, codes = answers(blocks, deviations, "exact")
    assert codes.tolist() == [OK, OVERLAP, OVERLAP]
    assert np.isnan(exact).tolist() == [False, True, True]
    linear, _ = answers(blocks, deviations, "analytic")
    assert linear == pytest.approx([0.1, -0.1, -0.01], abs=1e-9)


def test_an_overlap_counts_as_below_the_limit(tmp_path: Path, tol3d: Command) -> None:
    text = BLOCKS.replace("width: 0.4 mm", "width: 1.4 mm").replace("to: upper}", "to: upper, lower_limit: 0 mm}")
    (tmp_path / "scene.yaml").write_text(text, "utf-8")
    code, out, err = tol3d("run", str(tmp_path / "scene.yaml"), "-v", "--no-picture", "--out", str(tmp_path / "run"))
    assert code == 0, err
    assert "a build that is overlapping is below every lower limit" in " ".join(out.split())
    assert "clearance from lower to upper, within 2 um by their meshes" in out


def test_the_scene_reads_the_same_on_both_methods_trial_by_trial(tmp_path: Path) -> None:
    made = assembled(LID, tmp_path)
    assert isinstance(made.system, ClearanceSystem)
    trials = drawn(made.simulation, 0, 400)
    exact, linear = made.values(trials, "exact"), made.values(trials, "analytic")
    for name in exact:
        assert exact[name] == pytest.approx(linear[name], abs=3e-4)


def test_its_chord_error_is_stated_and_met(tmp_path: Path) -> None:
    made = assembled(LID, tmp_path)
    told = made.system.describe(made.system.measures[0])
    assert told["chord_error_um"] == 1.0
    assert told["mesh_error_um"] <= 1.0
    assert made.system.chord_bound(made.system.measures[0], 0.0) == pytest.approx(1.0)
    assert made.system.chord_bound(made.system.measures[1], 1.0) == 0.0


@pytest.mark.slow
def test_scenes_without_a_clearance_load_no_fcl() -> None:
    words = (
        "import sys; from tol3d.simulate import load, simulation_of; "
        f"made = simulation_of(load({str(SCENES / 'cover_on_base.yaml')!r})); "
        "print(type(made.system).__name__, 'fcl' in sys.modules, 'cadquery' in sys.modules)"
    )
    ended = run((sys.executable, "-c", words), capture_output=True, text=True, check=True)
    assert ended.stdout.split() == [AssemblySystem.__name__, "False", "False"]


CLEAR = "apart: {kind: clearance, from: lower, to: upper}"
WRONG: dict[str, tuple[tuple[str, str], str]] = {
    "unknown part": (
        (CLEAR, "apart: {kind: clearance, from: lowr, to: upper}"),
        "measures.apart.from: expected the name of a solid part, got 'lowr', which is not in the scene; "
        'did you mean "lower"?',
    ),
    "a feature": (
        (CLEAR, "apart: {kind: clearance, from: lower.top, to: upper}"),
        "measures.apart.from: expected the name of a solid part, got 'lower.top', which is not in the scene",
    ),
    "a part twice": (
        (CLEAR, "apart: {kind: clearance, from: lower, to: lower}"),
        "measures.apart.to: expected another part, got 'lower'",
    ),
    "no solid": (
        ("    builder: {kind: plate, length: 40 mm, width: 20 mm, thickness: 5 mm}\n", ""),
        "measures.apart.to: expected a part with a solid, got 'upper', which is stated by its features alone; "
        "give it a builder, such as {kind: plate, ...}, or measure a gap of its features",
    ),
    "no chord error": (
        (CLEAR, "apart: {kind: clearance, from: lower, to: upper, chord_error: 0 um}"),
        "measures.apart.chord_error: expected a length of more than zero, got '0 um'",
    ),
    "parts on each other": (
        ("distance: 0.5 mm", "distance: 0 mm"),
        "measures.apart: expected parts that are apart nominally, got 'lower' and 'upper', which touch or overlap as "
        "they are placed; the clearance of parts that lie on each other is 0: measure a gap of their features where "
        "they are apart, or a clearance to another part",
    ),
    "one in the other": (
        ("distance: 0.5 mm", "distance: -6 mm"),
        "measures.apart: expected parts that are apart nominally, got 'lower' and 'upper', which touch or overlap as",
    ),
    "nearer than the chord error": (
        ("distance: 0.5 mm", "distance: 1.5 um"),
        "measures.apart: expected parts that are apart nominally, got 'lower' and 'upper', 1.5 um apart by meshes that "
        "may be 2 um off; state a smaller chord_error",
    ),
    "before it is placed": (
        (CLEAR, "apart: {kind: clearance, from: lower, to: upper, after: table}"),
        "measures.apart.after: expected a move by which 'upper' is placed, got 'table'; name a later one",
    ),
}


@pytest.mark.parametrize(("edit", "said"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_said(edit: Edit, said: str, tmp_path: Path) -> None:
    assert said in refusal(edited(BLOCKS, edit), tmp_path)
