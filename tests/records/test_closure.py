"""Closure after the long period: what drifts or slips shows there, and noise does not."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from records.rigged import PAIR, REFERENCE, arcsec, identified_by

from tol3d.apps.records.csv_file import Block
from tol3d.apps.records.findings import Identified, Settings
from tol3d.apps.records.identification import identified
from tol3d.apps.records.pair import ARCSEC, RigPair, Side, Specimen
from tol3d.apps.records.reading import Pass, Senses, passes_of
from tol3d.apps.records.rig import Rig, measured

RUN = Rig(samples=360, encoder1=6 * ARCSEC, encoder2=4 * ARCSEC, tooth_mesh=3 * ARCSEC)
SIGMA = 0.5 * math.hypot(1, 27 / 48)  # arcsec of a row, by both encoders
ROWS = 90  # a quarter turn


def slipped(specimen: Specimen, rig: Rig, at: float, by: float) -> Identified:
    """The driven encoder of the back side jumps by so many arcsec after so many turns."""

    def passes(side: Side) -> tuple[Pass, ...]:
        rows = measured(specimen, rig, side)
        jump = np.where(rows.phi1 > at * 2 * math.pi, by * ARCSEC, 0.0) if side == "back" else 0.0
        block = Block(0, rows.phi1, rows.phi2 + jump, None, None)
        return tuple(passes_of(specimen.pair, Path(f"{side}.csv"), [block], Senses(1, 1)))

    return identified(specimen.pair, {"drive": passes("drive"), "back": passes("back")}, Senses(1, 1), Settings())


def test_a_run_of_the_long_period_closes_within_its_interval() -> None:
    """Two means of 90 rows a side: 1.96 sigma sqrt(2/90), for the backlash that of two sides.

    The scatter is that of 45 pairs of places, or of 126 steps in the median: known to 11 %; three times that.
    """
    for turns in (16.0, 18.0):
        found = identified_by(REFERENCE, replace(RUN, turns=turns))
        assert set(found.closure) == {"drive", "back", "backlash"}
        for name, own in found.closure.items():
            expected = 1.96 * SIGMA * math.sqrt(2 / ROWS) * (math.sqrt(2) if name == "backlash" else 1.0)
            assert arcsec(own.half_width) == pytest.approx(expected, rel=0.33), name
            assert abs(own.value) < 1.6 * own.half_width, name
        assert not [text for text in found.warnings if "close" in text]


def test_a_shorter_run_has_no_closure() -> None:
    found = identified_by(REFERENCE, replace(RUN, turns=15.0))
    assert found.closure == {}


@pytest.mark.parametrize(("turns", "expected"), [(16.0, 4.8 * 15.75 / 16), (20.0, 4.8 * 16 / 20)])
def test_a_drift_shows_in_the_sides_and_not_in_the_backlash(turns: float, expected: float) -> None:
    """4.8 arcsec over the run, alike on both sides: that of 16 turns ends a quarter turn before the period's end."""
    rig = replace(RUN, turns=turns, drift=4.8 * ARCSEC)
    found = identified_by(REFERENCE, rig)
    for side in ("drive", "back"):
        own = found.closure[side]
        assert arcsec(own.value) == pytest.approx(expected, abs=0.05 + 1.6 * arcsec(own.half_width))
        assert any(f"the {side} side does not close" in text for text in found.warnings)
    assert abs(found.closure["backlash"].value) < 1.6 * found.closure["backlash"].half_width
    along = identified_by(REFERENCE, rig, Settings(drift=True))
    assert arcsec(along.closure["drive"].value) == pytest.approx(expected, abs=0.05 + 1.6 * 0.2)
    assert not [text for text in along.warnings if "close" in text]


@pytest.mark.parametrize("turns", [16.0, 17.0])
def test_an_encoder_that_slips_shows_in_its_side_and_in_the_backlash(turns: float) -> None:
    found = slipped(REFERENCE, replace(RUN, turns=turns, noise=0.1 * ARCSEC), 7.3, 5.0)
    # of a step what parts once and twice per turn take, where they bridge the end; and of the half-widths
    takes, wide = (0.25, 0.25) if turns > 16.0 else (0.3, 0.45)
    assert arcsec(found.closure["back"].value) == pytest.approx(5.0, abs=takes)
    assert abs(arcsec(found.closure["drive"].value)) < 0.25
    assert arcsec(found.closure["backlash"].value) == pytest.approx(5.0, abs=takes)
    texts = [text for text in found.warnings if "does not close" in text]
    assert "the back side does not close: after the long period of 16 turns it has changed by" in texts[0]
    assert texts[1].startswith("the backlash does not close")
    assert all(arcsec(own.half_width) < wide for own in found.closure.values())  # a single slip widens none


def test_teeth_that_deviate_do_not_open_a_run_that_goes_on_after_the_long_period() -> None:
    """The same teeth meet at the same places: a wave of 20 arcsec at the 2.5th order of the driver cancels."""

    def passes(side: Side) -> tuple[Pass, ...]:
        rows = measured(REFERENCE, replace(RUN, turns=16.5), side)
        wave = 20 * ARCSEC * np.sin(2.5 * rows.phi1 + 1.0)
        block = Block(0, rows.phi1, rows.phi2 + wave, None, None)
        return tuple(passes_of(PAIR, Path(f"{side}.csv"), [block], Senses(1, 1)))

    found = identified(PAIR, {"drive": passes("drive"), "back": passes("back")}, Senses(1, 1), Settings())
    for name, own in found.closure.items():
        assert abs(arcsec(own.value)) < 4 * SIGMA * math.sqrt(4 / ROWS), name
        assert arcsec(own.half_width) < 3 * SIGMA * math.sqrt(4 / ROWS), name


def test_of_a_short_long_period_a_slip_shows_whole_where_the_run_goes_on() -> None:
    """z 20/40: two turns; the fit takes nothing of it, for the same places are compared."""
    pair = RigPair(20, 40, 20 * math.cos(math.radians(20)), 40 * math.cos(math.radians(20)), 60.0)
    own = Specimen(pair, 0.01, 1.0, 0.02, -2.0, 0.06)
    found = slipped(own, replace(RUN, turns=3.0, noise=0.1 * ARCSEC, tooth_mesh=0.0), 1.1, 2.0)
    assert arcsec(found.closure["back"].value) == pytest.approx(2.0, abs=0.1)


@pytest.mark.slow
def test_closures_lie_inside_their_intervals_in_95_of_100_cases() -> None:
    """150 data sets: 133 to 149 of each; a binomial of 150 and 0.95 leaves that in one case of 500."""
    inside = {"drive": 0, "back": 0, "backlash": 0}
    for seed in range(150):
        found = identified_by(REFERENCE, replace(RUN, turns=16.0 + seed % 3, samples=216, seed=seed))
        for name, own in found.closure.items():
            inside[name] += abs(own.value) <= own.half_width
    assert all(133 <= count <= 149 for count in inside.values()), inside
