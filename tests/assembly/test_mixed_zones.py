"""Orientation zones of another shape than the location zone of their axis: round and flat, and two flat ones."""

from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from scipy.optimize import linprog

from tol3d.assembly.zones import Confined, Zone, ZoneDraw, catalogue, normal_in, uniform_in
from tol3d.errors import InputError, SceneError
from tol3d.study.effects.first_order import first_orders
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

T, T_O, LENGTH = 0.2, 0.06, 20.0
TURNED = (0.6, 0.8)
BLOCK = """scene: block with a bore
parts:
  block:
    kind: solid
    features:
      floor: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}
      bore: {kind: cylinder, at: [10 mm, 5 mm, 10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 8 mm, hole: true}
      low: {kind: point, at: [0 mm, 0 mm, 0 mm]}
tolerances:
  place: {kind: position, of: block.bore, zone: {ZONE}, law: {kind: LAW}, datums: [floor]MODIFIER}
  upright: {kind: perpendicularity, of: block.bore, zone: {LEAN}, datums: [floor]}
  size: {kind: size, of: block.bore, distribution: {kind: uniform, lower: 0 mm, upper: 0.1 mm}}
moves:
  bench: {kind: fix, part: block}
measures:
  x: {kind: gap, from: block.low, to: block.bore, along: [1, 0, 0]}
  off: {kind: inspected_position, of: block.bore, datums: [floor]}
  lean: {kind: inspected_orientation, of: block.bore, datums: [floor]}
  lean x: {kind: inspected_orientation, of: block.bore, datums: [floor], direction: [1, 0, 0]}
  diameter: {kind: inspected_size, of: block.bore}
"""
ROUND, ALONG_X = "diameter: 0.2 mm", "width: 0.2 mm, along: [1, 0, 0]"
LEANS = {"round": "diameter: 0.06 mm", "x": "width: 0.06 mm, along: [1, 0, 0]", "t": "width: 0.06 mm, along: [3, 4, 0]"}


def block(zone: str, lean: str, law: str = "uniform", modifier: str = "") -> str:
    text = BLOCK.replace("ZONE", zone).replace("LEAN", LEANS[lean]).replace("LAW", law)
    return text.replace("MODIFIER", f", modifier: {modifier}" if modifier else "")


def ends(made: Assembled, count: int) -> tuple[Array, Array]:
    """Displacements of both ends (count, 2), from the contributor and its matrix."""
    own, columns = next(each for each in made.slices if each[0].name == "place")
    assert isinstance(own.draw, ZoneDraw)
    found = drawn(made.simulation, 0, count).deviations[:, columns] @ own.draw.matrix.T
    return found[:, :2], found[:, 2:]


@pytest.mark.parametrize("law", ["uniform", "normal"])
@pytest.mark.parametrize(("zone", "lean"), [(ROUND, "x"), (ROUND, "t"), (ALONG_X, "round"), (ALONG_X, "t")])
def test_draws_stay_inside_both_zones_and_reach_them(zone: str, lean: str, law: str, tmp_path: Path) -> None:
    """By the drawing alone: both ends in the location zone, the leaning axis moved into the orientation zone."""
    start, end = ends(assembled(block(zone, lean, law), tmp_path), 20_000)
    apart = end - start
    located = [np.hypot(*own.T) if zone == ROUND else np.abs(own[:, 0]) for own in (start, end)]
    turned = {"round": np.hypot(*apart.T), "x": np.abs(apart[:, 0]), "t": np.abs(apart @ np.array(TURNED))}[lean]
    assert max(own.max() for own in located) <= 0.5 * T * (1 + 1e-12)
    assert turned.max() <= T_O * (1 + 1e-12)
    if law == "uniform":
        assert max(own.max() for own in located) > 0.97 * 0.5 * T
        assert turned.max() > 0.97 * T_O


@pytest.mark.parametrize(("zone", "lean"), [(ROUND, "x"), (ALONG_X, "round"), (ALONG_X, "t")])
def test_both_methods_and_the_closed_form_agree(zone: str, lean: str, tmp_path: Path) -> None:
    made = assembled(block(zone, lean), tmp_path)
    measure = next(own for own in made.system.measures if own.name == "x")
    form = made.system.closed_form(measure)
    assert form is not None
    exact, analytic = (made.drawn(4000, method) for method in ("exact", "analytic"))
    for name, values in exact.items():
        assert values == pytest.approx(analytic[name], abs=2e-6), name
    apart = np.subtract(*ends(made, 4000))
    assert exact["lean"] == pytest.approx(np.hypot(*apart.T), abs=1e-6)
    assert exact["lean x"] == pytest.approx(np.abs(apart[:, 0]), abs=1e-6)
    assert exact["x"].std() == pytest.approx(form.sigma, rel=5 / np.sqrt(8000))
    reach = first_orders(made.simulation, None, [measure])["x"]["analytic"].ends
    assert reach == pytest.approx((9_900, 10_100), abs=1e-6)


def test_a_bonus_widens_the_location_alone(tmp_path: Path) -> None:
    made = assembled(block(ROUND, "x", modifier="mmc"), tmp_path)
    found = made.drawn(10_000, "analytic")
    start, end = ends(made, 10_000)
    room = T + found["diameter"] - 8.0
    assert (found["off"] <= room + 1e-9).all()
    assert (found["off"] / room).max() > 0.98
    assert 0.97 * T_O < np.abs(end - start)[:, 0].max() <= T_O * (1 + 1e-12)


def test_of_two_flat_zones_the_one_along_it_is_refined(tmp_path: Path) -> None:
    text = block(ALONG_X, "x")
    other = "  beside: {kind: position, of: block.bore, zone: {width: 0.1 mm, along: [0, 1, 0]}, law: {kind: uniform}, "
    made = assembled(text.replace("  upright:", f"{other}datums: [floor]}}\n  upright:", 1), tmp_path)
    draws = {own.name: own.draw for own, _ in made.slices}
    assert isinstance(draws["place"], Confined)
    assert isinstance(draws["beside"], Confined)
    assert (draws["place"].zone.orientation, draws["beside"].zone.orientation) == (T_O, None)


def test_a_lean_along_the_axis_is_none(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"lean x\.direction: expected a direction across the axis"):
        assembled(block(ROUND, "x").replace("direction: [1, 0, 0]", "direction: [0, 0, 1]"), tmp_path)


def test_two_flat_zones_are_independent_of_each_other() -> None:
    """Start and end of an unrefined flat zone, and a point between two planes t_o apart: moments and a programme."""
    zone = catalogue.flat_axis_along(T, (1.0, 0.0), TURNED, T_O)
    for law in (uniform_in, normal_in):
        own, plain, line = law(zone), law(catalogue.flat_axis(T, (1.0, 0.0))), law(catalogue.point_between_planes(T_O))
        assert own.covariance[:2, :2] == pytest.approx(plain.covariance)
        assert own.covariance[2, 2] == pytest.approx(line.covariance[0, 0])
        assert np.abs(own.covariance[2, :2]).max() == 0.0
        uniforms = np.random.default_rng(1).random((own.uniforms, 1000))
        points = np.stack(own.deviations(*uniforms), axis=1)
        assert zone.inside(points).all()
        start, end = (points @ zone.matrix.T)[:, :2], (points @ zone.matrix.T)[:, 2:]
        assert start[:, 0] == pytest.approx(points[:, 0])
        assert 0.5 * (end - start) @ np.array(TURNED) == pytest.approx(points[:, 2])  # the lean along its own zone
        assert start + end == pytest.approx(np.stack([points[:, 0] + points[:, 1], 0.0 * points[:, 0]], axis=1))
    for gradient in np.random.default_rng(2).standard_normal((5, 3)):
        rows = np.vstack([np.eye(3), -np.eye(3)])
        limits = np.tile([T / 2, T / 2, T_O / 2], 2)
        program = linprog(-gradient, A_ub=rows, b_ub=limits, bounds=(None, None))
        assert zone.support(gradient) == pytest.approx(-program.fun, rel=1e-6)
    with pytest.raises(InputError, match="two directions apart"):
        catalogue.flat_axis_along(T, TURNED, TURNED, T_O)


def test_a_flat_refinement_as_wide_as_the_zone_is_none() -> None:
    """By the law `normal` the middle comes first, and then the lean is that of a round zone."""
    flat, plain = (normal_in(own) for own in (catalogue.axis_along(T, (1.0, 0.0), T), catalogue.axis(T)))
    assert flat.covariance == pytest.approx(plain.covariance, rel=1e-3)
    both: tuple[Zone, Zone] = (catalogue.axis_along(T, (1.0, 0.0), T), catalogue.axis(T))
    assert uniform_in(both[0]).covariance == pytest.approx(uniform_in(both[1]).covariance, abs=1e-9)
