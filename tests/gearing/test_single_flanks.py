"""Flanks that deviate tooth by tooth: exact engine, stack-up and FCL against dense points of deviated surfaces."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gearing.deviating_pair import BASES, PITCH, SHAPES, TEETH, Builds, dense, drawn, model_of
from numpy.typing import NDArray

from tol3d.gearing.builds.flank_offsets import deviates
from tol3d.gearing.engines import OUT_OF_RANGE
from tol3d.gearing.engines.fcl import FclEngine
from tol3d.gearing.meshing.mesh import Meshing
from tol3d.gearing.model import Reading
from tol3d.gearing.slopes.sensitivity import sensitivities
from tol3d.gearing.stack_up import stack_of
from tol3d.gearing.system import strips_of
from tol3d.study.system.trials import Trials

Array = NDArray[np.float64]

# exact against dense points -------------------------------------------------------------------------------------

BRUTE = 1e-3  # um; dense points lie a um apart: (half of that)^2 over twice a gap of 140 um, and the spline


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_pitches_touch_and_stand_apart_as_dense_points_of_them(seed: int, tmp_path: Path) -> None:
    check_against_points(drawn(PITCH, tmp_path, 3, seed), (0.0,), BRUTE)


@pytest.mark.slow
def test_slopes_and_forms_touch_and_stand_apart_as_dense_points_of_them(tmp_path: Path) -> None:
    """Squares of slopes are left out: (7.5 um/5 mm)^2/2 of a gap of 140 um is 2e-4 um."""
    check_against_points(drawn(SHAPES, tmp_path, 3), (-5.0, 5.0), 1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("tolerances", [PITCH, f"{PITCH}\n{SHAPES}"])
def test_thirty_builds_of_class_7_are_within_a_hundredth_um_of_dense_points(tolerances: str, tmp_path: Path) -> None:
    check_against_points(drawn(tolerances, tmp_path, 30, 3), (-5.0, 5.0), 0.01)


@pytest.mark.slow
def test_coarse_teeth_touch_further_beyond_the_path_of_contact(tmp_path: Path) -> None:
    """Class 9 of module 2: squares of slopes are four times those of class 7."""
    builds = drawn(f"{PITCH}\n{SHAPES}".replace("iso_class: 7", "iso_class: 9"), tmp_path, 12, 5)
    check_against_points(builds, (-5.0, 5.0), 0.04)


def test_a_mesh_deviates_flank_by_flank_if_one_of_many_tolerances_does_so(tmp_path: Path) -> None:
    thin = "kind: tooth_thickness, distribution: {kind: constant, value: -40 um}"
    others = "\n".join(f"  {gear} thickness: {{{thin}, of: {gear}}}" for gear in ("pinion", "wheel"))
    for tolerances, expected in ((others, False), (f"{others}\n{SHAPES}", True), (SHAPES, True)):
        model = model_of(tmp_path, tolerances)
        assert deviates(model, model.meshes[0]) == expected


def test_gears_of_coarse_classes_are_in_range(tmp_path: Path) -> None:
    builds = drawn(f"{PITCH}\n{SHAPES}".replace("iso_class: 7", "iso_class: 8"), tmp_path, 300)
    found = builds.read()
    assert (found.status == 0).all()
    by_theory = stack_of(builds.model, builds.mesh, Reading()).normal_backlash(builds.deviations, builds.angle, None)
    assert 1e3 * np.abs(by_theory - found.gap).max() < 1.0  # 0.2 um at class 7, and more than squares near base circles


def check_against_points(builds: Builds, heights: tuple[float, ...], bound_um: float) -> None:
    found = builds.read()
    assert (found.status == 0).all()
    for row, (driver, driven) in enumerate(zip(builds.angle, found.driven_angle, strict=True)):
        pair = dense(builds, row, heights)
        assert 1e3 * BASES[1] * pair.turn_to_touch(1, driver, driven) == pytest.approx(0.0, abs=bound_um)
        turn = pair.turn_to_touch(-1, driver, driven)
        assert 1e3 * BASES[1] * (turn - found.driven_turn[row]) == pytest.approx(0.0, abs=bound_um)
        assert 1e3 * (pair.gap(-1, driver, driven) - found.gap[row]) == pytest.approx(0.0, abs=bound_um)


EVEN = "{{kind: {kind}, of: {gear}, flanks: each, {more}law: {{kind: given, right: [{zeros}], left: [{zeros}]}}}}"


def test_flanks_without_deviations_are_those_of_gears_without_the_tolerance(tmp_path: Path) -> None:
    """The variant for single flanks, all of them where they should be, against the kernels of gears without."""
    thickness = "  thickness: {kind: tooth_thickness, of: wheel, distribution: {kind: constant, value: 0 um}}"
    zeros = [EVEN.format(kind="pitch_deviation", gear=g, more="", zeros=", ".join(["0 um"] * z)) for g, z in
             zip(("pinion", "wheel"), TEETH, strict=True)]  # fmt: skip
    deviated = drawn(f"  first: {zeros[0]}\n  second: {zeros[1]}\n{thickness}", tmp_path, 200)
    (tmp_path / "plain").mkdir()
    plain = replace(drawn(thickness, tmp_path / "plain", 200), angle=deviated.angle)
    ours, theirs = deviated.read(), plain.read()
    for name in ("gap", "driven_turn", "driver_turn", "driven_angle"):
        arm = 1.0 if name == "gap" else BASES[1]
        assert np.abs(arm * (getattr(ours, name) - getattr(theirs, name))).max() < 1e-12
    assert (ours.status == theirs.status).all()


# both methods, and the witness ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("tolerances", "bound_um"),
    [
        (PITCH, 0.03),  # an edge moves along its own normal: 12 um less 0.08^2/2 of them
        (f"{PITCH}\n{SHAPES}", 0.2),  # what goes with the curvature of forms, near the base circle most
    ],
)
def test_the_stack_up_agrees_trial_by_trial_to_the_second_order(
    tolerances: str, bound_um: float, tmp_path: Path
) -> None:
    builds = drawn(tolerances, tmp_path, 300)
    found, stack = builds.read(), stack_of(builds.model, builds.mesh, Reading())
    assert (found.status == 0).all()
    for turns, values in (
        (None, found.gap),
        ("driven", BASES[1] * found.driven_turn),
        ("driver", BASES[0] * found.driver_turn),
    ):
        off = stack.normal_backlash(builds.deviations, builds.angle, turns) - values  # type: ignore[arg-type]
        assert 1e3 * np.abs(off).max() < bound_um
    assert 1e3 * found.gap.std() > 3.0  # um: what both methods follow


@pytest.mark.slow
@pytest.mark.parametrize("tolerances", [PITCH, f"{PITCH}\n{SHAPES}"])
def test_fcl_on_strips_of_each_flank_sees_what_the_exact_engine_sees_within_chord_errors(
    tolerances: str, tmp_path: Path
) -> None:
    builds = drawn(tolerances, tmp_path, 60)
    fcl, made = FclEngine(builds.model, strips_of(builds.model)), builds.engine.build(builds.deviations)
    seat = Meshing(fcl, builds.model, builds.mesh, made, Reading()).seat(builds.angle)
    off = 1e3 * (seat.non_working.smallest() - builds.read().gap)
    chords = 4e3 * fcl.chord_error
    assert off.min() > -0.02  # um; strips lie inside their teeth
    assert off.max() < chords + 0.02


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tolerances", "bound"),
    [(PITCH, 1e-6), (f"{PITCH}\n{SHAPES}", 5e-3)],  # normals of the engine are those of involutes: off by a slope
)
def test_derivatives_by_every_flank_are_differences_of_the_exact_engine(
    tolerances: str, bound: float, tmp_path: Path
) -> None:
    builds = drawn(tolerances, tmp_path, 4)
    rates = sensitivities(
        builds.model, builds.engine, Trials(builds.deviations, {"pair": builds.angle}), builds.model.measures[0]
    )
    touched = np.flatnonzero(np.abs(rates).max(axis=0) > 0.0)
    assert len(touched) >= 8
    assert 0.9 < np.abs(rates).max() < 1.1
    step = 1e-6  # mm; the bow of a gap over it is 1e-9 of it
    for k in touched:
        aside = np.zeros(builds.deviations.shape[1])
        aside[k] = step
        ends = [builds.read(builds.deviations + sign * aside).gap for sign in (1.0, -1.0)]
        assert (ends[0] - ends[1]) / (2 * step) == pytest.approx(rates[:, k], abs=bound)


def test_flanks_that_stand_out_beyond_the_teeth_that_are_looked_at_are_out_of_range(tmp_path: Path) -> None:
    """A tooth of 1.5 mm too much would touch a pitch before its path of contact."""
    arcs = ", ".join(["1500 um"] + ["0 um"] * 19)
    law = f"law: {{kind: given, right: [{arcs}]}}"
    builds = drawn(f"  pitch: {{kind: pitch_deviation, of: pinion, flanks: right, {law}}}", tmp_path, 3)
    assert (builds.read().status == OUT_OF_RANGE).all()
