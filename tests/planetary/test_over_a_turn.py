"""Transmission error over a turn of the output: position after position as by itself, its slopes, its harmonics."""

import math
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from places import SCENES
from planetary_sets import ARCMIN, PAIRS, flexible, free_by_highs, pitch_rows, random_deviations, random_set, reducer_3k
from scene_texts import edited, refusal

from tol3d import Overrides, load_scene
from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.exact.contact_kernel import LOOSE
from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.from_scene import planetary_system
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.study.system.plain import PlainMeasure
from tol3d.study.system.positions import Positions
from tol3d.study.system.spectrum import Spectrum
from tol3d.study.system.taken import taken
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

TURNS = np.array([0.0, 0.013, 0.31, 0.32, 0.8])
EITHER = ((0, "lower"), (1, "upper"))


def test_ends_at_positions_are_those_of_a_general_solver() -> None:
    """Random sets of every kind against scipy's HiGHS on gaps worked out anew; 1e-9 rad is what HiGHS keeps."""
    rng = np.random.default_rng(2)
    for _ in range(8):
        own = random_set(rng)
        deviated = random_deviations(own, 1, rng)
        for end, _ in EITHER:
            found = StackUp(own).followed(deviated, TURNS, own.output, own.input, end)
            for place, turns in enumerate(TURNS):
                ends = free_by_highs(own, pitch_rows(own, deviated, 0, turns), own.output, own.input)
                if ends is None:
                    assert found.status[0] == 1
                else:
                    assert found.ends[0, place] == pytest.approx(ends[end], abs=1e-9)


@pytest.mark.parametrize("own", [reducer_3k(), flexible(), flexible(springs=PAIRS), flexible(0.01)])
def test_a_position_that_goes_on_from_another_is_the_same_as_alone(own: PlanetarySet) -> None:
    """Both methods; placed gears within twice 1e-11 rad, at which their turns stand still."""
    deviated = random_deviations(own, 12, np.random.default_rng(5))
    for method, within in ((StackUp(own), 1e-14), (Contact(own), 2e-11)):
        for end, _ in EITHER:
            curves = method.followed(deviated, TURNS, own.output, own.input, end)
            for place, turns in enumerate(TURNS):
                alone = method.free(deviated, np.full(12, turns), own.output, own.input)
                np.testing.assert_allclose(curves.ends[:, place], alone.ends[:, end], rtol=0, atol=within)


@pytest.mark.parametrize("own", [reducer_3k(), flexible(springs=PAIRS)])
def test_planets_that_are_left_out_would_not_have_stopped_a_shaft(
    own: PlanetarySet, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Centres ten times as far off as elsewhere, in steps of the output in which planets change that stop it."""
    deviated = random_deviations(own, 12, np.random.default_rng(9))
    deviated.central_offset[...] *= 10.0
    deviated.planet_offset[...] *= 10.0
    deviated.central_thickness[...] -= 0.5
    found = []
    for loose in (LOOSE, 1e12):  # mm a mm: none is left out then
        monkeypatch.setattr("tol3d.gearing.planetary.exact.contact.LOOSE", loose)
        found.append(Contact(own).followed(deviated, np.arange(40) / 40, own.output, own.input, 0).ends)
    np.testing.assert_allclose(found[0], found[1], rtol=0, atol=2e-11)
    assert np.ptp(found[0]) > 1e-3


@pytest.mark.parametrize(("solver", "within"), [(StackUp, 1e-14), (Contact, 2e-11)])
def test_a_position_at_which_the_set_jams_spoils_no_other(solver: type[StackUp] | type[Contact], within: float) -> None:
    """Placed gears within twice 1e-11 rad, as above."""
    own = reducer_3k()
    deviated = random_deviations(own, 1, np.random.default_rng(5))
    deviated.central_offset[:, 2] = [[0.07, 0.0]]  # an eccentric output ring
    turns = np.linspace(0.0, 0.08, 60)  # one turn of it against the carrier
    found = solver(own).followed(deviated, turns, own.output, own.input, 0)
    alone = [solver(own).free(deviated, np.array([turn]), own.output, own.input) for turn in turns]
    jams = np.array([each.status[0] == 1 for each in alone])
    assert 5 < jams.sum() < 55
    assert found.status[0] == 1
    assert found.lacking[0] == pytest.approx(max(each.lacking[0] for each in alone), rel=1e-9)
    ends = np.array([each.ends[0, 0] for each in alone])
    np.testing.assert_allclose(found.ends[0, ~jams], ends[~jams], rtol=0, atol=within)
    assert not found.ends[0, jams].any()


@pytest.mark.parametrize("own", [reducer_3k(), flexible()])
def test_slopes_are_differences_of_the_sum(own: PlanetarySet) -> None:
    """The programme is linear until other contacts are met: 1 nm and 1e-7 rad to either side change none of them."""
    rng = np.random.default_rng(8)
    deviated = random_deviations(own, 2, rng)
    coefficients = rng.normal(size=(2, len(TURNS)))
    method = StackUp(own)

    def summed(deviated: Deviated) -> np.ndarray:
        ends = method.followed(deviated, TURNS, own.output, own.input, 0).ends
        return np.asarray((coefficients * ends).sum(axis=1))

    slopes = method.slopes(deviated, TURNS, own.output, own.input, 0, lambda _: coefficients)
    for field in fields(Deviated):
        array, found = getattr(deviated, field.name), getattr(slopes, field.name)
        step = 1e-7 if "clocking" in field.name else 1e-6
        for place in np.ndindex(array.shape[1:]):
            sums = []
            for sense in (1.0, -1.0):
                moved = array.copy()
                moved[(slice(None), *place)] += sense * step
                sums.append(summed(replace(deviated, **{field.name: moved})))
            np.testing.assert_allclose(
                found[(slice(None), *place)], (sums[0] - sums[1]) / (2 * step), rtol=1e-6, atol=1e-9
            )


def test_a_harmonic_is_read_from_peak_to_peak() -> None:
    positions = Positions("turn", 1, 90)
    angles = np.array(positions.fixed)
    curves = np.stack([a * np.cos(2 * angles + 0.4) + np.sin(3 * angles) + 7.0 for a in (0.25, 1.5)])
    own = PlainMeasure("sine", "any", positions=positions, take="harmonic", spectrum=Spectrum.over(positions, (2,)))
    np.testing.assert_allclose(taken(own, curves), [0.5, 3.0], rtol=1e-12)


def test_what_comes_once_a_turn_of_the_output_is_how_the_rings_face_each_other() -> None:
    """Ring 2 turns once against ring 1 in a turn of the output: with one of them eccentric nothing comes so slowly.

    Seen from the carrier ring 1 turns 13.15 times meanwhile, ring 2 12.15 times; each alone gives its own orders.
    """
    own, positions = reducer_3k(), Positions("turn", 1, 1440)
    turns = np.array(positions.fixed) / (2 * math.pi)
    deviated = Deviated.nothing(own, 3)
    deviated.central_thickness[...] = -0.07
    deviated.central_offset[0, 1] = deviated.central_offset[1, 2] = [0.008, 0.0]
    deviated.central_offset[2, 1:] = [[0.008, 0.0], [0.008, 0.0]]
    ends = StackUp(own).followed(deviated, turns, own.output, own.input, 0).ends / ARCMIN
    first = 2 * Spectrum.over(positions, (1,)).amplitudes(positions, ends)[:, 0]
    assert first[2] > 0.3
    assert (first[:2] < 0.1 * first[2]).all()


TEXT = (SCENES / "reducer_3k.yaml").read_text("utf-8")
ERROR = "take: harmonic, order: 1, positions: 360"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            "take: range, order: 1, positions: 360",
            "order: expected none beside take: range; only a harmonic has an order",
        ),
        (
            "take: harmonic, order: 180, positions: 360",
            "order: expected at most 179, which 360 positions resolve, got 180",
        ),
    ],
)
def test_orders_that_mean_nothing_are_refused(change: str, said: str, tmp_path: Path) -> None:
    assert said in refusal(edited(TEXT, (ERROR, change)), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "lost"), [("reducer_3k", 0.0212), ("reducer_3k_flexible", 0.0285)])
def test_what_360_positions_leave_out_of_a_turn_is_what_the_page_says(scene: str, lost: float) -> None:
    """Mean range of 400 trials, against 5760 positions; 0.003 is some times its own sampling error."""
    system = planetary_system(load_scene(SCENES / f"{scene}.yaml"))
    deviated = system.deviated(
        drawn(simulation_of(load_scene(SCENES / f"{scene}.yaml"), Overrides(trials=400)), 0, 400)
    )
    turns = np.arange(5761) / 5760
    ends = StackUp(system.own).followed(deviated, turns, "ring 2", "sun", 0).ends
    assert 1 - np.ptp(ends[:, ::16], axis=1).mean() / np.ptp(ends, axis=1).mean() == pytest.approx(lost, abs=0.003)
