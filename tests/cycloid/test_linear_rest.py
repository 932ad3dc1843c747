"""The analytic method of a rest, solved otherwise: closed forms of play, and the turns of the exact method."""

import numpy as np
import pytest
from cycloid_rests import drawn, phis_of
from cycloid_stages import CRANK_CIRCLE, PROFILE
from numpy.typing import NDArray
from rv_250 import rv_250

from tol3d.gearing.cycloid.exact.rest import RestStage
from tol3d.gearing.cycloid.first_order.linear_rest import LinearRest
from tol3d.gearing.cycloid.model.stage import Deviated, Play

Array = NDArray[np.float64]

SUN_HELD, WINDOW = 1.5, 0.7
LINEAR = LinearRest(PROFILE, 2, 3, CRANK_CIRCLE, SUN_HELD, WINDOW)
ARCSEC = np.degrees(1.0) * 3600
LEAVING = (0.022, 0.008)  # a planet of 42 mm base radius and 20 degrees


def play(disc: float, carrier: float, crank: float = 1e-5) -> Play:
    """Alike at all bearings."""
    return Play(np.full((), disc), np.full((), carrier), crank * np.array([-1.0, 1.0]), LEAVING)


@pytest.mark.slow
@pytest.mark.parametrize("sense", [1, -1])
def test_both_methods_of_a_rest_differ_by_second_order(sense: int) -> None:
    """With everything at half its size, the modification too, they differ by a quarter."""
    rms = []
    for size in (1.0, 0.5):
        profile, sizes = rv_250(0.02 * size), (2, 3, CRANK_CIRCLE, SUN_HELD, WINDOW)
        deviated, phis, own = drawn(300, 0.002 * size, seed=5), phis_of(300), play(0.02 * size, 0.015 * size)
        rest = RestStage(profile, *sizes).rests(deviated, phis, own, float(sense))
        assert (rest.status == 0).all()
        found = LinearRest(profile, *sizes).rests(deviated, phis[:, 0], own, 1 if sense > 0 else -1)
        apart = ARCSEC * (found.turns - rest.turns[:, 0])
        assert np.abs(apart).max() < 1.0  # of a turn of some 38 arc seconds
        rms.append(float(np.sqrt((apart**2).mean())))
    assert rms[0] < 0.1
    assert rms[1] < 0.35 * rms[0]


def test_forces_are_what_the_turn_changes_by_as_gaps_open() -> None:
    """Differences of the turn by each kind of deviation, of some trials."""
    deviated, phis = drawn(20, 0.002, seed=8), phis_of(20)[:, 0]
    before = LINEAR.rests(deviated, phis, play(0.02, 0.015), 1)
    step = 1e-6
    wider = LINEAR.rests(deviated, phis, play(0.02 + step, 0.015), 1).turns - before.turns
    assert wider == pytest.approx(step * before.disc_play.sum(axis=(1, 2)), rel=0.02)
    wider = LINEAR.rests(deviated, phis, play(0.02, 0.015 + step), 1).turns - before.turns
    assert wider == pytest.approx(step * before.carrier_play.sum(axis=1), rel=0.02)
    grown = Deviated(**{name: getattr(deviated, name).copy() for name in deviated.__dataclass_fields__})
    grown.pin_radii[...] -= step
    wider = LINEAR.rests(grown, phis, play(0.02, 0.015), 1).turns - before.turns
    assert wider == pytest.approx(step * before.pins.sum(axis=(1, 2)), rel=0.02)
