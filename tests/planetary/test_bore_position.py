"""Bores of a carrier by position tolerance: the law's moments, what they do to the lost motion, what is refused."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from places import SCENES
from scene_texts import scene_of

from tol3d import Overrides, SceneError
from tol3d.gearing.planetary.from_scene import planetary_system
from tol3d.gearing.planetary.system import PlanetarySystem
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.trials import Trials
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

TEXT = (SCENES / "reducer_3k.yaml").read_text("utf-8")
TEXT = TEXT[: TEXT.index("published:")]
START, END = TEXT.index("tolerances:"), TEXT.index("moves:")
TRIALS = 20_000
DIAMETER = 0.012  # mm


def reducer_of(
    folder: Path, law: str, planets: int = 4, zone: str = "{diameter: 12 um}"
) -> tuple[PlanetarySystem, Trials]:
    """The reducer with thinned teeth, and its bores alone toleranced."""
    thinned = "\n".join(
        f"  {gear} thinning: {{kind: tooth_thickness, of: {gear}, distribution: {{kind: constant, value: -40 um}}}}"
        for gear in ("sun", "P1", "P2", "ring 1", "ring 2")
    )
    bores = f"  bores: {{kind: bore_position, of: carrier, zone: {zone}, law: {law}}}"
    text = f"{TEXT[:START]}tolerances:\n{thinned}\n{bores}\n\n{TEXT[END:]}".replace("planets: 4", f"planets: {planets}")
    scene = scene_of(text, folder)
    return planetary_system(scene), drawn(simulation_of(scene, Overrides(trials=TRIALS)), 0, TRIALS)


def lost(system: PlanetarySystem, trials: Trials) -> np.ndarray:
    """[rad]"""
    (own,) = (own for own in system.measures if own.name == "lost motion")
    found = columns_of(system, None, trials, (own,))[f"{ANALYTIC_METHOD}:{own.name}"]
    return np.asarray(found) / own.per_internal


def pins(system: PlanetarySystem, trials: Trials) -> np.ndarray:
    return np.asarray(system.deviated(trials).pins)


def test_a_uniform_law_fills_the_zone_of_each_bore_by_itself(tmp_path: Path) -> None:
    """A disc of diameter t: each coordinate has the variance t²/16, four planets are independent; 5 sigma of 20 000."""
    found = pins(*reducer_of(tmp_path, "{kind: uniform}")).reshape(TRIALS, -1)
    assert np.hypot(found[:, ::2], found[:, 1::2]).max() <= DIAMETER / 2
    np.testing.assert_allclose(found.var(axis=0), DIAMETER**2 / 16, rtol=5 * math.sqrt(1 / TRIALS))
    off = np.corrcoef(found.T) - np.eye(8)
    assert np.abs(off).max() < 5 / math.sqrt(TRIALS)
    np.testing.assert_allclose(found.mean(axis=0), 0.0, atol=5 * DIAMETER / 4 / math.sqrt(TRIALS))


def test_a_normal_law_has_three_sigma_at_the_edge_and_stays_inside(tmp_path: Path) -> None:
    """Two normals of t/6 on condition that both lie in the disc: E r² = 2 s² (1 - 4.5 e/(1 - e)), e = exp(-9/2)."""
    found = pins(*reducer_of(tmp_path, "{kind: normal}"))
    squares = (found * found).sum(axis=2)
    assert np.sqrt(squares).max() <= DIAMETER / 2
    tail = math.exp(-4.5)
    expected = 2 * (DIAMETER / 6) ** 2 * (1 - 4.5 * tail / (1 - tail))
    assert squares.mean() == pytest.approx(expected, rel=5 / math.sqrt(4 * TRIALS))


def test_bores_on_a_ring_lie_at_its_edge_at_phases_of_their_own(tmp_path: Path) -> None:
    found = pins(*reducer_of(tmp_path, "{kind: ring}"))
    assert np.hypot(found[..., 0], found[..., 1]) == pytest.approx(np.full(found.shape[:2], DIAMETER / 2), rel=1e-12)
    across = np.corrcoef(found.reshape(TRIALS, -1).T) - np.eye(8)
    assert np.abs(across).max() < 5 / math.sqrt(TRIALS)


def test_a_process_is_judged_by_the_zone_and_not_cut(tmp_path: Path) -> None:
    """Normals of 4 um in a disc of 6 um radius: exp(-36/32) of the bores lie outside, and keep their trials."""
    system, trials = reducer_of(tmp_path, "{kind: process, distribution: {kind: normal, mean: 0 um, sigma: 4 um}}")
    draw: Any = system.contributors[-1].draw
    found = pins(system, trials)
    outside = np.hypot(found[..., 0], found[..., 1]) > DIAMETER / 2
    assert outside.mean() == pytest.approx(math.exp(-36 / 32), abs=5 * 0.5 / math.sqrt(4 * TRIALS))
    counted = draw.beyond(*found.reshape(TRIALS, -1).T)
    np.testing.assert_array_equal(counted, outside.any(axis=1))


def test_what_one_bore_does_to_the_lost_motion_is_its_closed_form(tmp_path: Path) -> None:
    """For a planet: 2/rR2 (c_a (1-k)/2 + c_b (1+k)/2 + c_c); r outwards adds tan(a) r to c_a, takes it of c_b and c_c.

    So the lost motion falls by 2 (1 + k) tan(a)/rR2 a millimetre, its variance is that squared times t²/16; across, a
    bore does nothing.
    """
    system, trials = reducer_of(tmp_path, "{kind: uniform}", planets=1)
    slope = 2 * (1 + 24 / 27) * math.tan(math.radians(20)) / 38.0
    found = lost(system, trials)
    off = pins(system, trials)[:, 0]
    np.testing.assert_allclose(found - found.mean(), -slope * (off[:, 0] - off[:, 0].mean()), rtol=0, atol=1e-12)
    assert found.var() == pytest.approx(slope**2 * DIAMETER**2 / 16, rel=5 / math.sqrt(TRIALS))


def test_both_ends_reach_as_far_as_the_zones_along_the_slopes(tmp_path: Path) -> None:
    """A measure of slopes 3 and 4 of two bores' radial coordinates: 3/5 and 4/5 of 6 um each, both ways."""
    system, _ = reducer_of(tmp_path, "{kind: uniform}")
    draw = system.contributors[-1].draw
    slopes = np.array([3.0, 0, 4.0, 0, 0, 0, 0, 0])
    ends = draw.ends(lambda rows: np.asarray(rows @ slopes), turning=False)
    np.testing.assert_allclose(ends[0][[0, 2]], [0.6 * DIAMETER / 2, 0.8 * DIAMETER / 2], rtol=1e-9)
    np.testing.assert_allclose(ends[1], -ends[0], atol=1e-15)


@pytest.mark.parametrize(
    ("law", "zone", "said"),
    [
        ("uniform", "{diameter: 12 um}", "tolerances.bores.law: expected a law such as {kind: uniform}"),
        ("{kind: uniform}", "{width: 12 um}", 'tolerances.bores.zone.width: unknown key "width"'),
    ],
)
def test_zones_without_a_law_or_a_diameter_are_refused(law: str, zone: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError) as caught:
        reducer_of(tmp_path, law, zone=zone)
    assert said in str(caught.value)
