"""Scenes of planetary sets: what is refused, with its numbers, and what becomes of trials."""

import io
import math
from pathlib import Path

import numpy as np
import pytest
from places import SCENES
from rich.console import Console
from scene_texts import Edit, edited, refusal, scene_of, written

from tol3d import Overrides, load_scene, replay, run_scene
from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.from_scene import planetary_system
from tol3d.gearing.planetary.model.set_mesh import SetGear
from tol3d.gearing.planetary.system import PlanetarySystem
from tol3d.gears import InternalGear
from tol3d.report.check import check_report
from tol3d.study.system.stated import mean_build
from tol3d.study.trials.overrides import simulation_of

TEXT = (SCENES / "reducer_3k.yaml").read_text("utf-8")
SHIFTED = ("teeth: 25, module: 1 mm,", "teeth: 25, module: 1 mm, profile_shift: 0.2,")
REFUSED = {
    "three planets": (
        ("planets: 4", "planets: 3"),
        "moves.reducer.planets: 3 identical planets at equal angles do not assemble between sun and ring 1: 104 is not "
        "divisible by 3",
    ),
    "compound planets": (
        ("teeth: 76", "teeth: 74"),
        "moves.reducer.planets: 4 identical planets at equal angles do not assemble between sun and ring 2",
    ),
    "touching planets": (
        ("teeth: 27, module: 1 mm,", "teeth: 27, module: 1 mm, addendum: 5,"),
        "moves.reducer.planets: neighbouring planets touch: expected pins further apart than the tip circle of 'P1', "
        "37.0000 mm, got 36.7696 mm; take fewer planets",
    ),
    "a ring whose tips dig in": (
        ("teeth: 79, module: 1 mm,", "teeth: 79, module: 1 mm, addendum: 1.6,"),
        "moves.reducer.meshes.ring 1: tip interference at centre distance 26 mm: the tip circle of the internal "
        "gear and the root of the inner gear interfere by 0.3500 mm",
    ),
    "planets whose tips dig in": (
        ("teeth: 27, module: 1 mm,", "teeth: 27, module: 1 mm, addendum: 1.5,"),
        "moves.reducer.meshes.sun: the teeth interfere at centre distance 26 mm: ",
    ),
    "a gear that cannot be made": (
        ("teeth: 25, module: 1 mm,", "teeth: 25, module: 1 mm, addendum: 3,"),
        "parts.sun: pointed teeth: the tooth thickness at the tip circle (31.0000 mm) is -2.2447 mm",
    ),
    "no common centre distance": (
        ("teeth: 79", "teeth: 83"),
        "moves.reducer.meshes.ring 1: expected a centre distance of more than 26.3114 mm, which the base circles of "
        "ring 1–P1 need, got 26.0000 mm; the tooth numbers are not coaxial, or state another one",
    ),
    "a small ring": (
        ("teeth: 79", "teeth: 27"),
        "moves.reducer.meshes.ring 1: expected a ring with more teeth than its planets, got 27 and 27",
    ),
    "a spur gear where a ring should be": (
        ("ring 2: {kind: internal_gear", "ring 2: {kind: spur_gear"),
        "moves.reducer.meshes.ring 2: expected an internal_gear, got the spur gear 'ring 2': beside its planets it "
        "would need a centre distance of more than 46.9846 mm, got 26.0000 mm; a ring with 76 teeth round them needs "
        "24.4320 mm",
    ),
    "a clearance of bearings": (
        (
            "  clocking:",
            "  clear: {kind: bearing_clearance, of: P1, distribution: {kind: rayleigh, scale: 4 um}}\n  clocking:",
        ),
        "tolerances.clear.of: expected a gear of one mesh (or the mesh named beside it), got 'P1', which is in none",
    ),
    "interfering teeth": (
        SHIFTED,
        "moves.reducer.meshes.sun: the teeth interfere at the mean build: sun–P1 has a normal backlash of -66.",
    ),
    "another module": (
        ("sun: {kind: spur_gear, teeth: 25, module: 1 mm", "sun: {kind: spur_gear, teeth: 25, module: 1.1 mm"),
        "moves.reducer.meshes.sun: expected gears of the same module, got 1.1 mm and 1 mm",
    ),
    "two roles": (
        ("output: ring 2", "output: sun"),
        "moves.reducer.output: expected another shaft than the one that is input, got 'sun' twice",
    ),
    "no shaft": (
        ("output: ring 2", "output: P1"),
        "moves.reducer.output: expected one of sun, ring 1, ring 2, carrier",
    ),
    "a gear of no planet": (
        ("ring 2: P2}", "ring 2: sun}"),
        "moves.reducer.meshes.ring 2: expected a gear of 'planet': P1, P2, got 'sun'",
    ),
    "another tolerance": (
        ("{kind: eccentricity, of: sun,", "{kind: run_out, of: sun,"),
        "tolerances.sun eccentricity.kind: expected of planetary sets tooth_thickness, eccentricity, "
        "tooth_run_out, clocking, axial_play, "
        "planet_pin, bore_position, got run_out",
    ),
    "single flanks": (
        (
            "  sun eccentricity:",
            "  sun pitch: {kind: pitch_deviation, of: sun, flanks: each, limits: {iso_class: 6}, "
            "law: {kind: random_walk, fill: [0.7, 1]}}\n  sun eccentricity:",
        ),
        "tolerances.sun pitch.kind: expected of planetary sets tooth_thickness, eccentricity, "
        "tooth_run_out, clocking, axial_play, planet_pin, "
        "bore_position, got pitch_deviation",
    ),
    "one mesh": (
        ("meshes: {sun: P1, ring 1: P1, ring 2: P2}", "meshes: {sun: P1}"),
        "moves.reducer.meshes: expected at least 2 entries, got 1",
    ),
    "a gear twice": (("gears: [P1, P2]", "gears: [P1, P2, P1]"), "parts.planet.gears: expected every gear once, got "),
    "another measure": (
        ("lost motion: {kind: planetary_lost_motion, of: reducer}", "lost motion: {kind: lost_motion, of: reducer}"),
        "measures.lost motion.of: expected the name of a train, got 'reducer', which is a planetary set",
    ),
    "a long period": (
        (
            "lost motion: {kind: planetary_lost_motion, of: reducer}",
            "error: {kind: planetary_transmission_error, of: reducer, over: long_period}",
        ),
        "measures.error.over: expected turn, got long_period: the same teeth meet again as they did after 37525 turns "
        "of the planets on their pins",
    ),
    "an idle part": (
        ("  carrier: {kind: planet_carrier}", "  carrier: {kind: planet_carrier}\n  other: {kind: planet_carrier}"),
        "parts.other: 'other' is used by no move; name it in 'reducer' or take it out",
    ),
}


def system_of(folder: Path, text: str) -> PlanetarySystem:
    return planetary_system(scene_of(text, folder))


@pytest.mark.parametrize(("change", "said"), REFUSED.values(), ids=REFUSED.keys())
def test_what_nobody_can_build_is_refused_with_its_numbers(change: Edit, said: str, tmp_path: Path) -> None:
    assert said in refusal(edited(TEXT[: TEXT.index("published:")], change), tmp_path)


def test_planets_alike_out_of_phase_only_turn_the_output(tmp_path: Path) -> None:
    """Clocking of all planets' P2 by 10 mrad moves the output by 10 mrad z_P2/z_R2 and takes nothing of its play."""
    text = TEXT.replace("lower: -0.33333333 mrad, upper: 0.33333333 mrad", "lower: 9.999 mrad, upper: 10.001 mrad")
    ends = []
    for own in (TEXT, text):
        system = system_of(tmp_path, own)
        assert not list(system.problems())
        deviated = system.deviated(mean_build(system, system.measures[0]))
        ends.append(StackUp(system.own).free(deviated, np.zeros(1), "ring 2", "sun").ends[0])
    np.testing.assert_allclose(ends[1] - ends[0], 0.010 * 24 / 76, rtol=1e-9)


def test_an_eccentric_ring_that_binds_the_planets_at_the_mean_build_is_refused(tmp_path: Path) -> None:
    """90 um off: 31 um of the 35 um of one planet, and 85 um across for the planets beside it."""
    law = "distribution: {kind: uniform, lower: 0 um, upper: 8 um}"
    fixed = "direction: {at: 30 deg}, distribution: {kind: uniform, lower: 89 um, upper: 91 um}"
    text = TEXT.replace(f"of: ring 2, {law}", f"of: ring 2, {fixed}")
    text = text.replace(
        "lost motion: {kind: planetary_lost_motion, of: reducer}",
        "lost motion: {kind: planetary_lost_motion, of: reducer, over: {at: 0 deg}}",
    )
    ((path, said),) = system_of(tmp_path, text).problems()
    assert path == ("moves", "reducer")
    assert said.startswith("the planets bind at the mean build: no turn of planet ")


@pytest.mark.slow
def test_trials_that_bind_keep_their_rows(tmp_path: Path) -> None:
    """Pins that lie 60 um off at random bind some planets of most trials, and a column says by how much."""
    path = written(TEXT.replace("lower: -6 um, upper: 6 um", "lower: -60 um, upper: 60 um"), tmp_path)
    run = run_scene(path, overrides=Overrides(trials=100), out=tmp_path / "run")
    counts = run.summary["measures"]["lost motion"]["status"]
    assert counts["ok"] + counts["interferes"] == 100
    assert counts["interferes"] > 33
    own = run.summary["measures"]["lost motion"]
    assert own["geometric"]["mean"] > 0.0
    frame = run.frame()
    jammed = np.asarray(frame["status:lost motion"]) == "interferes"
    assert jammed.sum() == counts["interferes"]
    lacking = np.asarray(frame["lost motion: overlap [um]"])
    assert (lacking[jammed] > 0.0).all()
    assert (lacking[~jammed] == 0.0).all()


@pytest.mark.slow
def test_a_trial_replayed_alone_has_its_bits(tmp_path: Path) -> None:
    run = run_scene(SCENES / "reducer_3k.yaml", overrides=Overrides(trials=64), out=tmp_path / "run")
    row = run.frame()
    for trial in (0, 41):
        seen = replay(run, trial)
        column = seen.simulation.system.method("exact", None).answers(seen.trials, seen.simulation.system.measures)
        value = column.values["lost motion"][0, 0] * seen.simulation.system.measures[0].per_internal
        assert float(np.asarray(row["geometric:lost motion"])[trial]) == pytest.approx(value, rel=0, abs=0)


def test_a_check_shows_slopes_of_planets_with_their_sign_and_what_they_are_of() -> None:
    """At the mean build all planets are met alike, each by itself half the time; a ring's thinning is one number."""
    scene = load_scene(SCENES / "reducer_3k.yaml")
    console = Console(file=io.StringIO(), width=200)
    console.print(check_report(simulation_of(scene, Overrides(engine="analytic"))))
    assert isinstance(console.file, io.StringIO)
    rows = [" ".join(line.split()) for line in console.file.getvalue().splitlines()]
    assert "P1 thinning ′/µm -0.04814 each" in rows
    assert "ring 1 thinning ′/µm -0.09092" in rows
    assert any(row.startswith("each: of every single deviation, such as one per planet") for row in rows)


def test_the_cost_of_a_trial_is_a_contact_for_each_mesh_of_each_planet_at_each_position() -> None:
    """Four planets of three meshes; measures of one curve, of 360 positions and the turn's end, cost one."""
    system = planetary_system(load_scene(SCENES / "reducer_3k.yaml"))
    own = {measure.name: measure for measure in system.measures}
    curve = own["transmission error"]
    assert system.cost([own["lost motion"]]) == 4 * 3
    assert system.cost([own["lost motion"], own["lost motion of the input"]]) == 2 * 4 * 3
    same = next(measure for name, measure in own.items() if name != curve.name and measure.take == "harmonic")
    assert system.cost([curve, same]) == system.cost([curve]) == 361 * 4 * 3


def test_a_shifted_gear_of_a_set_has_the_tips_of_the_gear_that_is_made() -> None:
    """Tip radius of a ring m (z/2 - h_a* - x): a positive shift goes towards the tip, which is inwards."""
    alpha = math.radians(20.0)
    ring = SetGear("ring", 80, 2.0, alpha, profile_shift=0.3, addendum=0.8, is_ring=True)
    sun = SetGear("sun", 30, 2.0, alpha, profile_shift=0.3)
    assert ring.tip_radius == pytest.approx(80.0 - 1.6 - 0.6)
    assert ring.tip_radius == InternalGear(80, 2.0, alpha, 10.0, profile_shift=0.3, addendum=0.8).tip_radius
    assert sun.tip_radius == pytest.approx(30.0 + 2.0 + 0.6)
