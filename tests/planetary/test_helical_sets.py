"""Planetary sets of helical gears: closed forms, their transverse spur sets, searched screw flanks, what is refused."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helical_places import least_placed_lag
from numpy.typing import NDArray
from planetary_sets import free_by_highs, pitch_rows, random_deviations, reducer_3k
from printing import printed, row_of

from tol3d import load_scene, run_scene
from tol3d.cad.solids import measuring_strips
from tol3d.errors import SceneError
from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.exact.flank_gaps import flank_gaps
from tol3d.gearing.planetary.exact.shown import placed_gears, shown_set
from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.from_scene import planetary_system
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.model.set_mesh import SetGear
from tol3d.gearing.planetary.presenting.tables import blocks
from tol3d.gearing.planetary.sections import mesh_efficiencies
from tol3d.gearing.planetary.system import PlanetarySystem
from tol3d.gearing.planetary.witness import StripGaps
from tol3d.report.page import page

Array = NDArray[np.float64]

ALPHA = math.radians(20.0)
CLOSED = 1e-9  # rad; thinned teeth move their contacts by nothing, so that closed forms are exact
SIMPLE = """\
scene: helical set
parts:
  sun: {kind: helical_gear, teeth: 24, module: 1.5 mm, helix_angle: %(beta)s deg, hand: %(sun)s, face_width: 14 mm}
  planet gear: {kind: helical_gear, teeth: 21, module: 1.5 mm, helix_angle: %(beta)s deg, hand: %(planet)s,
    face_width: 12 mm, bore: 8 mm}
  ring: {kind: internal_gear, teeth: 66, module: 1.5 mm, helix_angle: %(ring beta)s deg, hand: %(ring)s,
    face_width: 13 mm, addendum: 0.9}
  planet: {kind: planet, gears: [planet gear]}
  carrier: {kind: planet_carrier}
tolerances:
  sun thinning: {kind: tooth_thickness, of: sun, distribution: {kind: constant, value: -60 um}}
  planet thinning: {kind: tooth_thickness, of: planet gear, measured: normal,
    distribution: {kind: constant, value: -50 um}}
  ring thinning: {kind: tooth_thickness, of: ring, measured: {balls: 2.6 mm},
    distribution: {kind: constant, value: 90 um}}
moves:
  set: {kind: planetary, planet: planet, planets: 3, carrier: carrier, meshes: {sun: planet gear, ring: planet gear},
    held: ring, input: sun, output: carrier, friction: 0.06}
measures:
  lost motion: {kind: planetary_lost_motion, of: set}
  TE: {kind: planetary_transmission_error, of: set, take: range, positions: 24}
study: {trials: 4, seed: 1}
"""
RIGHT: dict[str, Any] = {"beta": 20, "ring beta": 20, "sun": "left", "planet": "right", "ring": "right"}


@pytest.fixture
def system(tmp_path: Path) -> PlanetarySystem:
    """Sun 24, planets 21, ring 66 at 20 deg."""
    (path := tmp_path / "set.yaml").write_text(SIMPLE % RIGHT)
    return planetary_system(load_scene(path))


def helical(own: PlanetarySet, beta: float) -> PlanetarySet:
    """The set with helices [rad], its gears further from each other by as much as their circles are larger."""

    def leaning(gear: SetGear) -> SetGear:
        return replace(gear, helix_angle=beta)

    apart = own.centre_distance / math.cos(beta)
    meshes = tuple(
        replace(mesh, central=leaning(mesh.central), planet=leaning(mesh.planet), centre_distance=apart)
        for mesh in own.meshes
    )
    return replace(own, meshes=meshes, gears=tuple(leaning(gear) for gear in own.gears))


def transverse(own: PlanetarySet) -> PlanetarySet:
    """The spur set of the transverse sections: its module, pressure angle, and heights and shifts in its modules."""

    def section(gear: SetGear) -> SetGear:
        cos = math.cos(gear.helix_angle)
        return SetGear(
            gear.name, gear.teeth, gear.module / cos, math.atan(math.tan(gear.pressure_angle) / cos),
            gear.profile_shift * cos, gear.addendum * cos, gear.is_ring,
        )  # fmt: skip

    meshes = tuple(replace(mesh, central=section(mesh.central), planet=section(mesh.planet)) for mesh in own.meshes)
    return replace(own, meshes=meshes, gears=tuple(section(gear) for gear in own.gears))


def play(method: StackUp | Contact, deviated: Deviated, turns: Array) -> Array:
    """Free turn of the output [rad], (trials,)."""
    own = method.own
    free = method.free(deviated, turns, own.output, own.opposite(own.output))
    assert (free.status == 0).all()
    return np.asarray(free.ends[:, 1] - free.ends[:, 0])


def test_lost_motion_at_the_carrier_is_its_closed_form(system: PlanetarySystem, tmp_path: Path) -> None:
    """(j_bn of the sun's mesh and of the ring's)/((r_bS + r_bR) cos beta_b), j_bn = -E_sn cos alpha_n each."""
    ring, planet = system.made["ring"], system.made["planet gear"]
    half = ring.module * ring.teeth / 2 / math.cos(math.radians(20.0))
    transverse_angle = math.atan(math.tan(ALPHA) / math.cos(math.radians(20.0)))
    lean = math.asin(math.sin(math.radians(20.0)) * math.cos(ALPHA))
    bases = half * math.cos(transverse_angle) * (1 + 24 / 66)
    # K06's formula: dM/dE_sn = -cos alpha_t/(sin alpha_Kt cos beta) of the ring's size between balls, here inverted
    balls = 2.6
    eta = math.pi / 66 - ring.base_half_angle - balls / (2 * half * math.cos(transverse_angle) * math.cos(lean))
    angle = _inverse_involute(eta)
    nominal = 2 * half * math.cos(transverse_angle) / math.cos(angle) - balls
    wider = _inverse_involute_of(nominal + 0.09 + balls, 2 * half * math.cos(transverse_angle))
    of_ring = -2 * (half * math.cos(math.radians(20.0))) * (wider - eta)
    backlash = -math.cos(ALPHA) * ((-0.06 - 0.05 / math.cos(ALPHA)) + (of_ring - 0.05 / math.cos(ALPHA)))
    expected = backlash / (bases * math.cos(lean))
    (path := tmp_path / "closed.yaml").write_text(SIMPLE % RIGHT)
    found = run_scene(path, out=tmp_path / "run")
    measured = found.found.measures["lost motion"]
    assert planet.helix_angle == pytest.approx(math.radians(20.0))
    for method in (measured.geometric, measured.analytic):
        assert method is not None
        assert math.radians((method.mean or 0.0) / 60) == pytest.approx(expected, abs=CLOSED)


def _involute(angle: float) -> float:
    return math.tan(angle) - angle


def _inverse_involute(value: float) -> float:
    low, high = 0.0, 1.2
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if _involute(middle) < value else (low, middle)
    return low


def _inverse_involute_of(centres: float, base_diameter: float) -> float:
    return _involute(math.acos(base_diameter / centres))


@pytest.mark.parametrize("beta", [0.1, 0.35])
def test_a_set_turns_as_freely_as_the_spur_set_of_its_transverse_sections(beta: float) -> None:
    """With teeth that are thinner by 1/cos beta there, an arc of the normal section; both methods, all deviations."""
    own, rng = helical(reducer_3k(), beta), np.random.default_rng(5)
    deviated, turns = random_deviations(own, 20, rng), rng.uniform(0, 30, 20)
    wider = replace(
        deviated,
        central_thickness=deviated.central_thickness / math.cos(beta),
        planet_thickness=deviated.planet_thickness / math.cos(beta),
    )
    for kind in (StackUp, Contact):
        found, expected = play(kind(own), deviated, turns), play(kind(transverse(own)), wider, turns)
        assert np.abs(found - expected).max() < 1e-12
    assert [mesh.normal_backlash for mesh in own.meshes] == pytest.approx([0.0] * 3, abs=1e-12)


def test_a_helix_that_vanishes_leaves_the_spur_set() -> None:
    own, rng = reducer_3k(), np.random.default_rng(6)
    deviated, turns = random_deviations(own, 20, rng), rng.uniform(0, 30, 20)
    for kind in (StackUp, Contact):
        found, expected = play(kind(helical(own, 1e-9)), deviated, turns), play(kind(own), deviated, turns)
        assert np.abs(found - expected).max() < 1e-12


def test_first_order_plays_are_those_of_a_linear_programme_at_the_pitch_circles() -> None:
    """Written anew in the tests for spur sets, and solved by scipy's HiGHS, from the transverse spur set."""
    own, rng = helical(reducer_3k(), 0.3), np.random.default_rng(7)
    deviated, turns = random_deviations(own, 6, rng), rng.uniform(0, 30, 6)
    found = play(StackUp(own), deviated, turns)
    section = transverse(own)
    for trial in range(6):
        # pitch_rows has thickness as arcs at a pressure angle of 20 deg, which the section's is not
        gear = section.meshes[0].central
        factor = math.cos(gear.pressure_angle) / math.cos(ALPHA) / math.cos(0.3)
        thick = replace(
            deviated,
            central_thickness=deviated.central_thickness * factor,
            planet_thickness=deviated.planet_thickness * factor,
        )
        ends = free_by_highs(section, pitch_rows(section, thick, trial, float(turns[trial])), own.output, own.input)
        assert found[trial] == pytest.approx(ends[1] - ends[0], abs=1e-10)


def test_a_mesh_loses_more_by_the_lean_of_its_normals() -> None:
    """1/cos beta_b of the loss of the spur set of its transverse section."""
    own = helical(reducer_3k(), 0.3)
    found, expected = (mesh_efficiencies(each, 0.08, "equal shares") for each in (own, transverse(own)))
    lean = math.asin(math.sin(0.3) * math.cos(ALPHA))
    for name, own_efficiency in found.items():
        assert 1 - own_efficiency == pytest.approx((1 - expected[name]) / math.cos(lean), rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("end", [0, 1])
def test_seated_sets_touch_and_overlap_nowhere_by_a_search_of_their_screw_flanks(
    system: PlanetarySystem, end: int
) -> None:
    """All flanks of all meshes of a set with deviations, at the end of the carrier's free turn."""
    own, rng = system.own, np.random.default_rng(8)
    deviated = random_deviations(own, 1, rng, size=2.0)
    turns = float(rng.uniform(0.0, 5.0))
    free, reached = Contact(own).seated(deviated, np.array([turns]), own.output, own.opposite(own.output))
    assert free.status[0] == 0
    gears = placed_gears(own, system.made, deviated, turns, reached[0, end])
    apart = []
    for planet in range(own.planets):
        driver = gears[len(own.meshes) + planet]
        for place in range(len(own.meshes)):
            driven = gears[place]
            for side in (1, -1):
                apart.append(least_placed_lag(driver, driven, side))
    assert min(apart) > -1e-6
    assert sum(abs(each) < 1e-6 for each in apart) >= own.planets + 1  # each planet stops, and the carrier by one


@pytest.mark.slow
def test_gaps_of_strips_are_those_of_the_involutes_within_both_chord_errors(system: PlanetarySystem) -> None:
    own, rng = system.own, np.random.default_rng(4)
    strips = {name: measuring_strips(gear, 96) for name, gear in system.made.items()}
    limits = np.array([strips[m.central.name].chord_error + strips[m.planet.name].chord_error for m in own.meshes])
    shown = shown_set(own, system.made, random_deviations(own, 1, rng, size=2.0), 3.3)
    assert shown.status == 0
    exact = np.array([gap.value for gap in flank_gaps(own, shown.gears)]).reshape(own.planets, -1, 2)
    found = StripGaps(own, strips).gaps(shown.gears) * own.meshes[0].central.base_helix_cosine
    assert (np.abs(found - exact) < limits[:, None] + 1e-6).all()


@pytest.mark.slow
def test_the_witness_of_a_run_agrees(tmp_path: Path) -> None:
    (path := tmp_path / "set.yaml").write_text((SIMPLE % RIGHT).replace("trials: 4", "trials: 4, witness: 2"))
    run = run_scene(path, out=tmp_path / "run")
    assert run.found.witness is not None
    found = run.found.witness.measures["lost motion"]
    assert found.compared == 2
    assert (found.max_abs_difference or 0.0) < found.expected_at_most


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (
            {"sun": "right"},
            "meshes.sun: external helical gears on parallel axes need opposite hands, got right and rig",
        ),
        ({"ring": "left"}, "meshes.ring: a helical gear and its ring need the same hand, got left and right"),
        ({"ring beta": 19}, "meshes.ring: gears on parallel axes need the same helix_angle, got 19 deg and 20 deg"),
        ({"ring beta": 0}, "meshes.ring: gears on parallel axes need the same helix_angle, got 0 deg and 20 deg"),
    ],
)
def test_gears_that_do_not_mesh_are_refused(changed: dict[str, Any], words: str, tmp_path: Path) -> None:
    (path := tmp_path / "set.yaml").write_text(SIMPLE % {**RIGHT, **changed})
    with pytest.raises(SceneError, match=words):
        planetary_system(load_scene(path))


def test_the_distance_of_the_pins_follows_from_the_circles_of_the_transverse_section(system: PlanetarySystem) -> None:
    assert system.own.centre_distance == pytest.approx(1.5 * 45 / 2 / math.cos(math.radians(20.0)), rel=1e-14)


def test_the_check_shows_each_gear_and_mesh_as_it_shows_those_of_pairs(system: PlanetarySystem) -> None:
    """Circles, p_x = pi m_n/sin beta, eps_beta = b/p_x, and eps_alpha by the rolls to both tips in the section."""
    beta = math.radians(20.0)
    text = printed(page(*blocks(system, system.contributors)))
    circles = [1.5 * teeth / math.cos(beta) + tips for teeth, tips in ((24, 3.0), (66, -2.7), (21, 3.0))]
    assert row_of(text, "tip diameter d_a [mm]") == [f"{own:.4f}" for own in circles]
    assert row_of(text, "helix angle β [°], hand") == ["20,", "left", "20,", "right", "20,", "right"]
    pitch = math.pi * 1.5 / math.sin(beta)
    assert row_of(text, "axial pitch p_x [mm]")[:1] == [f"{pitch:.4f},"]
    assert row_of(text, "overlap ratio ε_β") == [f"{12 / pitch:.4f}"] * 2
    angle = math.atan(math.tan(ALPHA) / math.cos(beta))

    def roll(teeth: int, tips: float) -> float:
        return math.tan(math.acos(1.5 * teeth * math.cos(angle) / (1.5 * teeth + tips * math.cos(beta))))

    # at the reference circles, where the working angle is that of the teeth
    outside = 24 * (roll(24, 3.0) - math.tan(angle)) + 21 * (roll(21, 3.0) - math.tan(angle))
    inside = 21 * (roll(21, 3.0) - math.tan(angle)) - 66 * (roll(66, -2.7) - math.tan(angle))
    ratios = [outside / (2 * math.pi), inside / (2 * math.pi)]
    assert row_of(text, "contact ratio ε_α") == [f"{own:.4f}" for own in ratios]
    assert row_of(text, "total contact ratio ε_γ") == [f"{own + 12 / pitch:.4f}" for own in ratios]
