"""Springs of flexible carriers in scenes: torques by closed forms, the region of low stiffness, what is refused."""

from pathlib import Path

import numpy as np
import pytest
from places import SCENES
from planetary_sets import ARCMIN, R_R2, R_S, flexible, thinned
from scene_texts import edited, refusal, written

from tol3d import Overrides, load_scene, run_scene
from tol3d.gearing.planetary.from_scene import planetary_system
from tol3d.gearing.planetary.spring_curve import displaced_ends
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

FLEXIBLE = SCENES / "reducer_3k_flexible.yaml"
TEXT = FLEXIBLE.read_text("utf-8")
KAPPA = 24 / 27
FORCE, STIFFNESS, FRICTION = 60.0, 1500.0, 9.0  # of the scene


def test_the_scene_says_the_breakaway_torque_and_the_stiffness_of_the_closed_form() -> None:
    """T0 = Q0 rS (1 - k)/(4 (1 + k)) at the sun, Q0 + F in the place of Q0, and the ratio times that at ring 2.

    The planets' displacement goes with the sun's turn as T0 with Q0, so the spring's own stiffness counts (T0/Q0)².
    """
    system = planetary_system(load_scene(FLEXIBLE))
    spring = system.summaries["reducer"].spring
    assert spring is not None
    arm = R_S * (1 - KAPPA) / (4 * (1 + KAPPA))
    at_sun = (FORCE + FRICTION) * arm
    assert spring.breakaway_n_mm == pytest.approx({"sun": at_sun, "ring 2": 54.72 * at_sun}, rel=1e-9)
    expected = {"sun": STIFFNESS * arm**2 * ARCMIN, "ring 2": STIFFNESS * (54.72 * arm) ** 2 * ARCMIN}
    assert spring.low_stiffness_n_mm_per_arcmin == pytest.approx(expected, rel=1e-9)


def test_the_kept_curve_is_a_loop_that_gives_way_at_the_breakaway_and_stops_within_the_dead_band() -> None:
    system = planetary_system(load_scene(FLEXIBLE))
    spring = system.summaries["reducer"].spring
    assert spring is not None
    curve, breakaway = spring.curve, spring.breakaway_n_mm["ring 2"]
    torques, turns = np.array(curve.torque_n_mm), np.array(curve.turn_arcmin)
    assert curve.breakaway_n_mm == pytest.approx([-breakaway, breakaway], rel=1e-9)
    assert curve.rigid_arcmin == pytest.approx([-13.47822 / 2, 13.47822 / 2], abs=1e-5)
    first = len(torques) // 5 + 1
    held = np.abs(torques[:first]) < breakaway
    np.testing.assert_allclose(turns[:first][held], 0.0, atol=1e-9)
    step = spring.low_stiffness_n_mm_per_arcmin["ring 2"]
    rising = (torques[:first] > breakaway) & (turns[:first] < 6.3)
    np.testing.assert_allclose(turns[:first][rising], (torques[:first][rising] - breakaway) / step, rtol=1e-6)
    assert np.abs(turns).max() < 13.47822 / 2


def low_stiffness(path: Path, trials: int) -> np.ndarray:
    """By theory [arcmin]."""
    scene = load_scene(path)
    system = planetary_system(scene)
    (own,) = (own for own in system.measures if own.name == "turn against the spring")
    found = columns_of(system, None, drawn(simulation_of(scene, Overrides(trials=trials)), 0, trials), (own,))
    return np.asarray(found[f"{ANALYTIC_METHOD}:{own.name}"])


def test_the_region_of_low_stiffness_is_what_displaced_planets_leave_at_most_less_what_the_spring_leaves() -> None:
    """Against the same ends as functions of the displacement, piece by piece: largest and smallest of all of them."""
    scene = load_scene(FLEXIBLE)
    system = planetary_system(scene)
    found = low_stiffness(FLEXIBLE, 12)
    simulation = simulation_of(scene, Overrides(trials=12))
    for trial, width in enumerate(found):
        trials = drawn(simulation, trial, 1)
        turns = float(trials.positions["reducer"][0])
        ends = displaced_ends(system.own, system.deviated(trials), "ring 2", turns)
        most = ends.high.values.max() - ends.low.values.min()
        left = ends.high.values[-1] - ends.low.values[-1]
        assert width * ARCMIN == pytest.approx(most - left, abs=1e-9)


def test_with_gaps_alike_it_is_the_dead_band_of_the_rigid_carrier(tmp_path: Path) -> None:
    """4 c/rR2: nothing is left by the spring, and contacts stop the planets where a rigid carrier would have them."""
    text = TEXT[: TEXT.index("tolerances:")] + "tolerances:\n" + "\n".join(
        f"  {gear} thinning: {{kind: tooth_thickness, of: {gear}, distribution: {{kind: constant, value: -60 um}}}}"
        for gear in ("sun", "ring 1", "ring 2")
    ) + "\n\n" + TEXT[TEXT.index("moves:") :]  # fmt: skip
    path = written(text, tmp_path)
    np.testing.assert_allclose(low_stiffness(path, 3), 4 * 0.03 / R_R2 / ARCMIN, rtol=1e-9)
    assert displaced_ends(flexible(), thinned(0.03, 0.03, 0.03), "ring 2").high.values[-1] == pytest.approx(
        0.0, abs=1e-9
    )


def test_the_picture_of_the_torque_curve_lies_beside_the_run(tmp_path: Path) -> None:
    from tol3d.gearing.planetary.presenting import PRESENTER

    run = run_scene(FLEXIBLE, overrides=Overrides(trials=8, engine="analytic"), out=tmp_path / "run")
    (draw,) = PRESENTER.pictures(run.found).values()
    draw(tmp_path / "curve.png")
    assert (tmp_path / "curve.png").stat().st_size > 10_000


REFUSED = {
    "a stiffness alone": ("force: 60 N, ", "", "parts.carrier.stiffness: expected a force of the spring beside it"),
    "more friction than force": (
        "friction: 9 N",
        "friction: 60 N",
        "parts.carrier.friction: expected less than the force",
    ),
    "two springs": (
        "springs: one, force",
        "springs: each, force",
        "parts.carrier.force: expected none beside springs: each",
    ),
    "an adjustment": (
        "springs: one, force",
        "springs: one, adjustment: 0.01 mm, force",
        "parts.carrier.force: expected none beside an adjustment",
    ),
    "a length for a force": (
        "force: 60 N",
        "force: 60 mm",
        "parts.carrier.force: expected a force with its unit, such as",
    ),
    "a rigid carrier": (
        TEXT[TEXT.index("  carrier:  #") : TEXT.index("\n\ntolerances:")],
        "  carrier: {kind: planet_carrier}",
        "measures.turn against the spring.of: expected a set on a flexible carrier whose springs press, got 'reducer'",
    ),
}


@pytest.mark.parametrize(("old", "new", "said"), REFUSED.values(), ids=REFUSED.keys())
def test_springs_that_mean_nothing_are_refused(old: str, new: str, said: str, tmp_path: Path) -> None:
    assert said in refusal(edited(TEXT, (old, new)), tmp_path)
