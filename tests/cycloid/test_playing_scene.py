"""Scenes whose bearings have play: where builds of their columns rest, by HiGHS, and what pure play does by hand."""

import re
from dataclasses import replace
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.playing_reducer import PlayingReducer
from places import SCENES
from scene_texts import scene_of

from tol3d import SceneError
from tol3d.gearing.cycloid.first_order.linear_rest import LinearRest
from tol3d.gearing.cycloid.reducer.resting import LinearResting, exact_turning
from tol3d.gearing.cycloid.reducer.trials import RVTrials
from tol3d.study.tallies.tally import Tally, grids_of
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of
from tol3d.study.trials.simulation import Simulation

Array = NDArray[np.float64]

ARCMIN = np.degrees(1.0) * 60
TEXT = (SCENES / "rv_bearing_play.yaml").read_text("utf-8")
MORE = """
  disc holes: {kind: disc_hole, of: disc, each: hole, distribution: {kind: rayleigh, scale: 0.5 um}}
  cranks: {kind: crank_eccentricity, of: crankshaft, each: crank, distribution: {kind: rayleigh, scale: 0.5 um}}
  holes: {kind: carrier_hole, of: carrier, each: hole, distribution: {kind: rayleigh, scale: 0.5 um}}
  phases:
    {kind: crank_phase, of: crankshaft, each: crank, distribution: {kind: normal, lower: -15 arcsec, upper: 15 arcsec}}
"""
BACK = "\n  back: {kind: cycloid_transmission_error, of: reducer, flank: back, over: random}\n\nstudy:"
SMALL = 30.0  # mm, the crank circle's radius


def simulated(tmp_path: Path, text: str) -> Simulation:
    return simulation_of(scene_of(text, tmp_path))


def turned(simulation: Simulation, method: str, trials: int) -> dict[str, Array]:
    """Values of each measure [rad] by a method."""
    own = simulation.system
    return dict(own.method(method, None).answers(drawn(simulation, 0, trials), own.measures).values)


@pytest.mark.slow
@pytest.mark.parametrize("count", [30, 200])
def test_builds_of_a_scene_rest_where_highs_finds_them(count: int, tmp_path: Path) -> None:
    """Each build in turn with the torque back and on, by both methods."""
    made = simulated(tmp_path, TEXT.replace("\nmoves:", f"{MORE}\nmoves:").replace("\nstudy:", BACK))
    method, trials = made.system.method("exact", None), drawn(made, 0, count)
    columns = columns_of(made.system, method, trials)
    for sense, measure in ((-1, "transmission error"), (1, "back")):
        own = np.arange(count)[(1 - sense) // 2 :: 2]
        expected = np.array([PlayingReducer(columns, trial).turned(sense) for trial in own])
        exact, analytic = (columns[f"{method}:{measure}"][own] / ARCMIN for method in ("geometric", "analytic"))
        # teeth are met at the middle of a bearing and along a straight line from there: (5 um)^2 / 63 mm of a planet
        np.testing.assert_allclose(exact, expected, rtol=0, atol=1e-9)
        assert np.abs(analytic - expected).max() < 5e-6  # an arc second: pins near the window's edge


def cranks_turned_by_hand(disc: float | None, carrier: float = 0.0) -> str:
    """A scene whose cranks are the input and stand, its carrier true, with plays alike [um] or none."""
    left_out = "sun|planet|play in|# diametral|carrier.hole|main bearing"
    lines = [line for line in TEXT.splitlines() if not re.search(left_out, line)]
    text = "\n".join(lines).replace("radius: 63 mm", f"radius: {SMALL} mm")
    if disc is None:
        return text
    law = "{kind: bearing_play, of: %s, each: hole, distribution: {kind: constant, value: %.12f um}}"
    plays = f"  play of discs: {law % ('disc', disc)}\n  play of carrier: {law % ('carrier', carrier)}\n"
    return text.replace("\nmoves:", f"{plays}\nmoves:")


@pytest.mark.parametrize(
    ("method", "within"),  # the analytic one leaves a bearing without play a nanometre on the radius
    [("analytic", 2 * 2e-6 / SMALL + 1e-8), pytest.param("exact", 1e-11, marks=pytest.mark.slow)],
    ids=["analytic", "exact"],
)
def test_equal_play_turns_the_carrier_by_itself_over_the_cranks_circle_either_way(
    method: str, within: float, tmp_path: Path
) -> None:
    """By hand, with cranks that stand and no error of holes.

    A pin at the lever L that carries the torque M takes M/L, which three bearings at R share alike, and each takes a
    third of M/R along the circle. Where L is 2 R or more none of the six forces' sums turns round: bearing i carries
    (1/R + 2 n.t_i / L) / 3 >= 0 along its tangent t_i. So all clearances c = (disc + carrier) / 2 lie along the circle,
    the disc stays in the middle, and the carrier turns on from first contact by the angle whose chord is c: all levers
    of working pins are above 0.7 * 85.8 mm = 2 * 30.03 mm.
    """
    first = turned(simulated(tmp_path, cranks_turned_by_hand(None)), method, 40)
    for disc, carrier in ((0.0, 0.0), (10.0, 5.0), (0.0, 8.0)):
        found = turned(simulated(tmp_path, cranks_turned_by_hand(disc, carrier)), method, 40)
        more = 2 * np.arcsin((disc + carrier) / 2 * 1e-3 / (2 * SMALL))
        for name, times in (("transmission error", -1), ("lost motion", 2)):
            np.testing.assert_allclose(found[name] - first[name], times * more, rtol=0, atol=within)


def test_forces_of_trials_are_read_again_and_those_of_other_builds_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Deviations that are read again from columns differ by rounding; builds of slopes by a millionth of a micrometre.

    Rates are those of a reducer that knows nothing yet.
    """
    made = simulated(tmp_path, TEXT)
    system, turns = made.system, np.linspace(0.0, 0.7, 20)
    assert isinstance(system, RVTrials)
    own, deviated, solved = system.own, system.deviated(drawn(made, 0, 20)), []
    rests = LinearRest.rests

    def counted(*given: Any) -> Any:
        solved.append(len(given[2]))
        return rests(*given)

    monkeypatch.setattr(LinearRest, "rests", counted)
    LinearResting(own).turned(deviated[:12], turns[:12, None], 1)
    for build, count in ((deviated.plus(deviated, 4e-16), [8]), (deviated.plus(deviated, 1e-6), [20])):
        expected = LinearResting(replace(own)).rates(build, turns, 1)
        solved.clear()
        found = LinearResting(own).rates(build, turns, 1)
        assert solved == count
        for at in ("stage.pins", "disc_play", "sun_thickness", "stage.carrier_holes"):
            one, other = (np.asarray(attrgetter(at)(rates)) for rates in (found, expected))
            assert np.abs(other).max() > 1e-4
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_more_play_in_any_bearing_is_no_less_lost_motion(tmp_path: Path) -> None:
    """Feasible places stay feasible; a step of 4 um in one of nine bearings."""
    made = simulated(tmp_path, TEXT)
    own, before = made.system, drawn(made, 0, 100)
    columns = [
        k for k, name in enumerate(n for one in own.contributors for n in one.columns) if name.startswith("play")
    ]
    assert len(columns) == 9
    for method in ("exact", "analytic"):
        less, sums = own.method(method, None).answers(before, own.measures).values["lost motion"], []
        for column in columns:
            before.deviations[:, column] += 4e-3
            more = own.method(method, None).answers(before, own.measures).values["lost motion"]
            before.deviations[:, column] -= 4e-3
            assert (more - less).min() > -1e-9
            sums.append((more - less).mean())
        assert min(sums) > 1e-7  # none of them counts for nothing


def test_a_negative_mean_play_is_refused_with_what_would_do(tmp_path: Path) -> None:
    with pytest.raises(SceneError) as caught:
        simulated(tmp_path, TEXT.replace("lower: 0 um, upper: 10 um", "lower: -12 um, upper: 2 um"))
    assert "tolerances.play in the carrier.distribution: expected a mean clearance of at least 0 um, got -5 um" in str(
        caught.value
    )


def test_draws_below_zero_of_every_bearing_are_counted_and_count_as_no_play(tmp_path: Path) -> None:
    made = simulated(tmp_path, TEXT.replace("lower: 0 um, upper: 10 um", "lower: -1 um, upper: 9 um"))
    trials = drawn(made, 0, 200)
    columns = columns_of(made.system, None, trials)
    tally = Tally.of(made, grids_of(made.system, columns), columns)
    below = np.stack([columns[f"play in the carrier.hole {k} [um]"] < 0 for k in (1, 2, 3)])
    assert tally.unphysical["play in the discs"] == 0
    assert tally.unphysical["play in the carrier"] == below.any(axis=0).sum() > below[0].sum()
    known = turned(made, "analytic", 200)["lost motion"]
    trials.deviations[:, -3:] = np.maximum(trials.deviations[:, -3:], 0.0)  # the carrier's play comes last
    without = made.system.method("analytic", None).answers(trials, made.system.measures).values["lost motion"]
    np.testing.assert_array_equal(known, without)


@pytest.mark.slow
def test_cranks_that_do_not_fit_are_failed_and_counted_as_that(tmp_path: Path) -> None:
    """Holes off by some 2 um each in bearings of 1 um: no place in most builds. Without play at all bearings give."""
    tight = re.sub("lower: (5|0) um, upper: (15|10) um", "lower: 0.5 um, upper: 1.5 um", TEXT)
    holes = "  holes: {kind: carrier_hole, of: carrier, each: hole, distribution: {kind: rayleigh, scale: 2 um}}\n"
    made = simulated(tmp_path, tight.replace("\nmoves:", f"{holes}\nmoves:"))
    answers = made.system.method("exact", None).answers(drawn(made, 0, 200), made.system.measures)
    for name, status in answers.status.items():
        failed = made.system.statuses.texts.index("cranks do not fit")
        assert set(status) == {0, failed}
        assert 100 < (status == failed).sum() < 200
        np.testing.assert_array_equal(np.isnan(answers.values[name][:, 0]), status == failed)


@pytest.mark.slow
@pytest.mark.parametrize("sense", [1, -1])
def test_no_build_is_lost_where_cranks_stand_at_round_angles(tmp_path: Path, sense: int) -> None:
    """Rows of throws along the axes then nearly depend on each other; idle bodies go to and fro for long."""
    made, turns = simulated(tmp_path, TEXT), np.tile(np.arange(8) / 8, (1000, 1))
    own = made.system
    assert isinstance(own, RVTrials)
    found = exact_turning(own.own).turned(own.deviated(drawn(made, 0, 1000)), turns, sense)
    assert found.codes is not None
    assert (found.codes == 0).all()
    assert np.isfinite(found.turns).all()
