"""The table of backlash of planetary sets, of gears in housings and of correlated tolerances."""

import math
from pathlib import Path

import numpy as np
import pytest
from rexs_texts import planetary
from scene_texts import edited, written

import tol3d
from tol3d.apps.drafting.rexs import gearbox_scene_from
from tol3d.gearing.machine.system import MachineSystem
from tol3d.gearing.model.measure import Measure
from tol3d.gearing.planetary.system import PlanetarySystem
from tol3d.gearing.summary.backlash_stages import backlash_stages
from tol3d.gearing.summary.types import BacklashLimits, BacklashOfRun
from tol3d.gearing.system import GearSystem
from tol3d.simulate import Overrides, load, load_text, simulation_of
from tol3d.study.effects.regions import furthest, settled, space_of
from tol3d.study.system.stated import stated

PRINTED = 5e-4  # um
ALPHA = math.radians(20.0)


def involute(angle: float) -> float:
    return math.tan(angle) - angle


def row(rows: list[BacklashLimits], mesh: str, symbol: str = "j_bn", stage: str = "theoretical") -> BacklashLimits:
    (found,) = (own for own in rows if (own.mesh, own.symbol, own.stage) == (mesh, symbol, stage))
    return found


@pytest.mark.parametrize(
    ("mesh", "teeth", "sense", "arcs"),
    [("sun–planet wheel", 17 + 22, 1, (170, 250)), ("ring–planet wheel", 61 - 22, -1, (200, 290))],
)
def test_a_planet_s_meshes_have_the_limits_of_c25_and_of_the_pin(
    mesh: str, teeth: int, sense: int, arcs: tuple[float, float]
) -> None:
    """m 4, 17/22/61, 78 mm js7: without tolerances none; E by c25, and 2 Δr_b (inv α_w - inv α) as the pin moves."""
    simulation = simulation_of(load_text(gearbox_scene_from(planetary().file())[0], Path("scene.yaml")), Overrides())
    assert isinstance(simulation.system, PlanetarySystem)
    rows = [*simulation.system.backlash_limits()]
    base = 4 * teeth * math.cos(ALPHA)  # 2 (r_b1 ± r_b2) [mm]

    def opened(by: float) -> float:
        """Normal backlash by a pin that is so much further out [um]."""
        return sense * 1e3 * base * (involute(math.acos(base / 2 / (78 + by))) - involute(ALPHA))

    ends = sorted((opened(-0.015), opened(0.015)))
    own, working = row(rows, mesh), row(rows, mesh, "j_wt")
    expected = [arcs[k] * math.cos(ALPHA) + ends[k] for k in range(2)]
    assert (own.least_um, own.largest_um) == pytest.approx(expected, abs=PRINTED)
    arcs_working = [own / (base / 2 / 78) for own in expected]
    assert (working.least_um, working.largest_um) == pytest.approx(arcs_working, abs=2 * PRINTED)
    # three sigma of normal laws cut off at three: of both thicknesses and of the pin
    thickness = [40 / 6, 40 / 6] if sense > 0 else [50 / 6, 40 / 6]
    sigma = math.hypot(*(each * math.cos(ALPHA) for each in thickness), (opened(1e-4) - opened(-1e-4)) / 2e-4 * 5e-3)
    assert own.largest_3sigma_um is not None
    assert own.least_3sigma_um is not None
    assert own.largest_3sigma_um - own.least_3sigma_um == pytest.approx(6 * sigma, rel=1e-3)


@pytest.mark.parametrize("mesh", ["first stage", "second stage"])
def test_gears_in_a_housing_have_the_limits_of_their_bores(mesh: str) -> None:
    """No build by 3D is beyond them, with bores, bearings and teeth at their ends; some lie near them."""
    simulation = simulation_of(load("housed_gears"))
    system = simulation.system
    assert isinstance(system, MachineSystem)
    rows = [*system.backlash_limits()]
    theoretical, operating = row(rows, mesh), row(rows, mesh, stage="operating")
    (thin, *_) = [own for own in backlash_stages(system.gears.model, GearSystem, "exact") if own.mesh == mesh]
    assert theoretical.least_um is not None
    assert thin.least_um is not None
    assert theoretical.least_um < thin.least_um - 5  # bores of 20 and 25 um: the gears alone do not know them
    (measure,) = (own for own in system.measures if isinstance(own, Measure) and own.name.startswith(mesh.split()[0]))
    draws = {own.name: own.draw for own in system.contributors}
    space = space_of(system, measure, draws, system.acting(measure))
    generator = np.random.default_rng(5)
    towards = generator.normal(size=(400, len(space.mean)))
    builds = settled(space, furthest(space, np.repeat(space.mean[None], 400, axis=0), towards)).deviations
    method = system.method("exact", system.materials("exact"))
    values = 1e3 * method.answers(stated(system, builds), (measure,)).values[measure.name][:, 0]
    assert operating.least_um is not None
    assert operating.largest_um is not None
    assert operating.least_um - 0.05 < values.min() < operating.least_um + 25
    assert operating.largest_um - 25 < values.max() < operating.largest_um + 0.05


PAIR = """
scene: two thicknesses that vary together
parts:
  a: {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 20 mm}
  b: {kind: spur_gear, teeth: 41, module: 2 mm, face_width: 20 mm}
tolerances:
  a thickness: {kind: tooth_thickness, of: a, distribution: {kind: normal, lower: -84 um, upper: -54 um}}
  b thickness: {kind: tooth_thickness, of: b, distribution: {kind: normal, lower: -110 um, upper: -70 um}}
  distance: {kind: centre_distance, of: pair, distribution: {kind: normal, lower: -12 um, upper: 12 um}}
correlations:
  - {between: [b thickness, a thickness], rho: 0.6}
moves: {pair: {kind: mesh, driver: a, driven: b, centre_distance: 61.1 mm}}
measures: {backlash: {kind: normal_backlash, of: pair}}
study: {trials: 100, seed: 1}
"""


@pytest.mark.parametrize("rho", [0.6, -0.6, 0.0])
def test_three_sigma_know_correlations(rho: float, tmp_path: Path) -> None:
    """Sigma of three normal laws, ±3 sigma wide: 5, 20/3 and 4 um, the first two correlated."""
    text = (
        edited(PAIR, ("rho: 0.6", f"rho: {rho}"))
        if rho
        else PAIR.replace("correlations:\n  - {between: [b thickness, a thickness], rho: 0.6}\n", "")
    )
    simulation = simulation_of(load(written(text, tmp_path)))
    assert isinstance(simulation.system, GearSystem)
    own = row([*simulation.system.backlash_limits("analytic", simulation.copula)], "pair")
    slope = 2 * math.sin(math.acos(61 * math.cos(ALPHA) / 61.1))
    teeth = 5**2 + (20 / 3) ** 2 + 2 * rho * 5 * 20 / 3
    sigma = math.sqrt(teeth * math.cos(ALPHA) ** 2 + (slope * 4) ** 2)
    assert own.largest_3sigma_um is not None
    assert own.least_3sigma_um is not None
    assert own.largest_3sigma_um - own.least_3sigma_um == pytest.approx(6 * sigma, rel=1e-4)


@pytest.mark.parametrize("scene", ["housed_gears", "every_planetary_field"])
def test_a_run_of_a_machine_and_of_a_set_has_the_table_of_its_check(scene: str, tmp_path: Path) -> None:
    found = tol3d.run_scene(scene, overrides=Overrides(trials=40), out=tmp_path / "run").found
    simulation = simulation_of(load(scene))
    system = simulation.system
    assert isinstance(system, MachineSystem | PlanetarySystem)
    assert isinstance(found, BacklashOfRun)
    assert found.backlash
    assert found.backlash == [*system.backlash_limits(simulation.copula)]
