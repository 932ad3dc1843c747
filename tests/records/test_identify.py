"""Identification of synthetic measurements, whose truth is known."""

import math
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from records.rigged import LARGEST, LEAST, PAIR, REFERENCE, START, arcsec, ends_of, identified_by, passes, within

from tol3d.apps.records.alignment import hidden_shift
from tol3d.apps.records.bins import BinSums
from tol3d.apps.records.cautions import refuse_other_gear
from tol3d.apps.records.csv_file import Block
from tol3d.apps.records.findings import Identified, Settings
from tol3d.apps.records.identification import identified
from tol3d.apps.records.identified_picture import curve_of
from tol3d.apps.records.pair import ARCSEC, RigPair, Side, Specimen, angular_backlash
from tol3d.apps.records.reading import Pass, Senses, passes_of
from tol3d.apps.records.rig import Rig, measured
from tol3d.errors import InputError

ENCODERS = Rig(samples=180, encoder1=6 * ARCSEC, encoder2=4 * ARCSEC, tooth_mesh=5 * ARCSEC)


def test_the_reference_pair_is_recovered_from_clean_rows() -> None:
    """Nothing errs: what is left is rounding, 1e-16 of 100 rad over arms of 45 mm."""
    found = identified_by(REFERENCE, Rig(turns=4, noise=0.0, samples=180))
    figures = found.figures
    assert figures["e1"].value == pytest.approx(0.018, abs=1e-9)
    assert figures["theta1"].value == pytest.approx(math.radians(40), abs=1e-7)
    assert figures["e2"].value == pytest.approx(0.027, abs=1e-9)
    assert figures["theta2"].value == pytest.approx(math.radians(-65), abs=1e-7)
    assert arcsec(figures["jc"].value) == pytest.approx(274.378, abs=0.001)
    assert arcsec(figures["j0"].value) == pytest.approx(START, abs=0.001)
    assert arcsec(figures["jmin eccentric"].value) == pytest.approx(LEAST, abs=0.001)
    assert arcsec(figures["jmax eccentric"].value) == pytest.approx(LARGEST, abs=0.001)
    assert math.degrees(figures["jmin eccentric at"].value) == pytest.approx(4278.55, abs=0.05)
    assert math.degrees(figures["jmax eccentric at"].value) == pytest.approx(2665.0, abs=0.05)
    assert all(arcsec(own.value) < 1e-4 for own in found.encoders.values())


def test_large_eccentricities_are_not_biased() -> None:
    """First order alone errs by 2.3 arcsec at 50 um (the digest's table); the exact geometry does not."""
    own = Specimen(PAIR, 0.050, 2.0, 0.050, 0.5, 0.15)
    found = identified_by(own, Rig(turns=8, noise=0.0, samples=90))
    least, largest = ends_of(own)
    assert arcsec(found.figures["jmin eccentric"].value) == pytest.approx(arcsec(least), abs=0.002)
    assert arcsec(found.figures["jmax eccentric"].value) == pytest.approx(arcsec(largest), abs=0.002)
    assert found.figures["e1"].value == pytest.approx(0.050, abs=1e-8)


def test_encoder_errors_spoil_one_side_and_not_both() -> None:
    found = identified_by(REFERENCE, ENCODERS)
    assert arcsec(found.figures["jmin eccentric"].value) == pytest.approx(LEAST, abs=1.5)
    assert arcsec(found.figures["jmax eccentric"].value) == pytest.approx(LARGEST, abs=1.5)
    assert arcsec(found.encoders["encoder 1"].value) == pytest.approx(6.0, abs=0.3)
    assert arcsec(found.encoders["encoder 2"].value) == pytest.approx(4.0, abs=0.2)
    for side, own in found.alone.items():
        assert own.disagrees, side
        assert max(abs(arcsec(own.least.backlash.value) - LEAST), abs(arcsec(own.largest.backlash.value) - LARGEST)) > 4
    assert sum("alone disagrees" in text for text in found.warnings) == 2


def test_good_encoders_raise_no_flag() -> None:
    found = identified_by(REFERENCE, Rig(samples=180, seed=4))
    assert found.warnings == ()
    assert not any(own.disagrees for own in found.alone.values())


def test_an_encoder_that_is_too_bad_is_warned_of() -> None:
    bad = replace(ENCODERS, encoder1=40 * ARCSEC)
    texts = identified_by(REFERENCE, bad).warnings
    assert [text for text in texts if "encoder 1 would be wrong by 4" in text]
    assert not [text for text in texts if "encoder 2 would" in text]
    allowed = identified_by(REFERENCE, bad, Settings(encoder_error=60 * ARCSEC)).warnings
    assert not [text for text in allowed if "would be wrong" in text]


def test_tooth_mesh_shows_in_the_spectrum_and_not_in_the_scatter() -> None:
    found = identified_by(REFERENCE, ENCODERS)
    lines = {line.order: line for line in found.spectrum.lines}
    sides: tuple[Side, ...] = ("drive", "back")
    for side in sides:
        assert arcsec(lines[Fraction(27)].amplitude[side]) == pytest.approx(5.0, abs=0.05)
        assert arcsec(lines[Fraction(1)].amplitude[side]) < 0.01
    # 0.5 arcsec of encoder 2 and 27/48 of 0.5 of encoder 1
    assert arcsec(math.sqrt(found.fit.variance)) == pytest.approx(0.5 * math.hypot(1, 27 / 48), rel=0.02)


@pytest.mark.parametrize(
    ("samples", "orders", "words"),
    [
        (54, (), "2.0 rows a tooth of the driver: too few to tell tooth mesh"),
        (81, (27,), "3.0 rows a tooth of the driver: tooth mesh is fitted once a tooth only"),
        (100, (27, 54), "3.7 rows a tooth of the driver: tooth mesh is fitted once and twice a tooth only"),
        (135, (27, 54), "5.0 rows a tooth of the driver: tooth mesh is fitted once and twice a tooth only"),
        (216, (27, 54), ""),
    ],
)
def test_rows_too_far_apart_for_tooth_mesh_are_warned_of(samples: int, orders: tuple[int, ...], words: str) -> None:
    """Orders that rows tell apart are fitted; up to five rows a tooth, higher ones may be taken for them."""
    found = identified_by(REFERENCE, replace(ENCODERS, turns=4.0, samples=samples, tooth_mesh=5 * ARCSEC))
    assert found.fit.terms.teeth == orders
    assert [words in own for own in found.warnings if "rows a tooth of the driver" in own] == [True] * bool(words)


def test_a_bin_holds_the_means_of_its_rows() -> None:
    """Three rows of one bin, then the same again as gathered ones: means stay, rows double."""
    sums, again = BinSums(PAIR), BinSums(PAIR)
    phi1, error, torque = 0.1 + np.array([0.0, 1e-7, 5e-7]), np.array([1e-5, 2e-5, 6e-5]), np.array([1.0, 2.0, 6.0])
    sums.add(phi1, error, torque)
    for _ in range(2):
        again.add_bins(sums.bins(0.5e-5), 0.2e-5)
    for found, rows in ((sums.bins(0.5e-5), 3), (again.bins(0.2e-5), 6)):
        means = [float(own[0]) for own in (found.phi1, found.travel, found.error, found.torque)]
        assert found.rows.tolist() == [rows]
        assert means == pytest.approx([0.1 + 2e-7, 0.1 + 2e-7, 3.5e-5, 3.0], abs=1e-12)


def test_torques_are_extrapolated_to_none() -> None:
    rig = Rig(samples=180, torques=(1.0, 2.0, 3.0), repeats=3, winding=20 * ARCSEC, turns=4)
    found = identified_by(REFERENCE, rig)
    assert found.winding is not None
    assert arcsec(found.winding.value) == pytest.approx(20.0, abs=3 * arcsec(found.winding.half_width))
    assert arcsec(found.figures["j0"].value) == pytest.approx(START, abs=3 * arcsec(found.figures["j0"].half_width))


def test_one_torque_is_not_extrapolated_and_said_so() -> None:
    found = identified_by(REFERENCE, Rig(samples=180, torques=(2.0,), winding=20 * ARCSEC, turns=4))
    assert found.winding is None
    assert any("winding" in text for text in found.warnings)
    assert arcsec(found.figures["j0"].value) == pytest.approx(START + 40.0, abs=0.5)


def test_sides_are_put_in_one_long_period_by_both_encoders() -> None:
    """The back side began 5 turns further on, with encoders that count within one turn: both together know."""
    found = identified_by(REFERENCE, replace(ENCODERS, start=0.3))
    shifted = _with_back_from(5)
    assert [own.turns for own in shifted.passes["back"]] == [5]
    assert arcsec(shifted.figures["jmin eccentric"].value) == pytest.approx(
        arcsec(found.figures["jmin eccentric"].value), abs=0.2
    )


def _with_back_from(turns: int) -> Identified:
    rig = replace(ENCODERS, start=0.3)
    drive = passes(REFERENCE, rig, "drive")
    further = passes(REFERENCE, replace(rig, start=0.3 + 2 * math.pi * turns), "back")
    own = further[0]
    lost = 2 * math.pi * turns
    # phi1 counts from less by whole turns, phi2 is as it was: its errors are larger by z1/z2 of that
    bins = replace(
        own.bins, phi1=np.mod(own.bins.phi1 - lost, PAIR.long_period), error=own.bins.error + PAIR.rate * lost
    )
    return identified(PAIR, {"drive": drive, "back": (replace(own, bins=bins, ends=None),)}, Senses(1, 1), Settings())


@pytest.mark.parametrize(
    "turns", [pytest.param(own, marks=() if own in (1, 7) else pytest.mark.slow) for own in range(1, 16)]
)
def test_a_hidden_shift_by_whole_turns_is_found(turns: int) -> None:
    with pytest.raises(InputError, match=rf"may lie {turns} whole turns of the driver apart"):
        identified_by(REFERENCE, replace(ENCODERS, hidden_turns=turns))


@pytest.mark.parametrize("turns", [1, 5])
def test_a_hidden_shift_that_an_encoder_may_explain_is_warned_of(turns: int) -> None:
    """At e2 = 1.5 um a shift is as good as an encoder's error of some seconds; it moves the backlash by seconds."""
    own = replace(REFERENCE, e2=0.0015)
    found = identified_by(own, replace(ENCODERS, encoder1=0.0, encoder2=0.0, hidden_turns=turns))
    assert any(f"may lie {turns} whole turns of the driver apart" in text for text in found.warnings)
    assert not any("may lie" in text for text in identified_by(own, replace(ENCODERS, encoder2=0.0)).warnings)


def test_rows_at_any_distance_give_the_same() -> None:
    """One row in four, at random, other ones on either side."""
    random = np.random.default_rng(3)

    def thinned(side: Side) -> tuple[Pass, ...]:
        rows = measured(REFERENCE, replace(ENCODERS, samples=720, tooth_mesh=0.0), side)
        kept = np.sort(random.choice(len(rows.phi1), len(rows.phi1) // 4, replace=False))
        block = Block(0, rows.phi1[kept], rows.phi2[kept], None, None)
        return tuple(passes_of(PAIR, Path(f"{side}.csv"), [block], Senses(1, 1)))

    found = identified(PAIR, {"drive": thinned("drive"), "back": thinned("back")}, Senses(1, 1), Settings())
    assert arcsec(found.figures["jmin eccentric"].value) == pytest.approx(LEAST, abs=0.2)
    assert arcsec(found.figures["jmax eccentric"].value) == pytest.approx(LARGEST, abs=0.2)


def test_encoders_set_to_zero_between_the_sides_are_refused() -> None:
    with pytest.raises(InputError, match=r"set to zero between the sides.*--j0"):
        identified_by(REFERENCE, Rig(samples=180, zeroed=True))


def test_encoders_that_were_set_to_zero_and_then_read_with_noise_are_refused_too() -> None:
    """With the least backlash at the start nothing else shows it: what is left of it is above zero everywhere."""
    rig = Rig(samples=180, zeroed=True, start=math.radians(4278.55))
    read: dict[Side, tuple[Pass, ...]] = {}
    offsets: tuple[tuple[Side, float], ...] = (("drive", 0.0), ("back", 0.4 * ARCSEC))
    for side, off in offsets:
        rows = measured(REFERENCE, rig, side)
        block = Block(0, rows.phi1 - off, rows.phi2 + off, None, None)
        read[side] = tuple(passes_of(PAIR, Path(f"{side}.csv"), [block], Senses(1, 1)))
    with pytest.raises(InputError, match=r"back.csv: both sides begin at the same angles.*--j0"):
        identified(PAIR, read, Senses(1, 1), Settings())


def test_a_row_that_is_wrong_is_warned_of_with_its_place() -> None:
    """The last row of a file that was cut off within a number: 0.5 deg less of phi2."""
    rows = measured(REFERENCE, ENCODERS, "drive")
    phi2 = rows.phi2.copy()
    phi2[-1] -= math.radians(0.5)
    drive = tuple(passes_of(PAIR, Path("drive.csv"), [Block(0, rows.phi1, phi2, None, None)], Senses(1, 1)))
    found = identified(PAIR, {"drive": drive, "back": passes(REFERENCE, ENCODERS, "back")}, Senses(1, 1), Settings())
    text = next(text for text in found.warnings if "a file that was cut off" in text)
    at = math.degrees(rows.phi1[-1])
    assert text.startswith(f"the drive side has a row at phi1 = {at:.2f}°")
    assert float(text.split("several, ")[1].split("″")[0]) == pytest.approx(-1800, abs=10)
    assert not [text for text in identified_by(REFERENCE, ENCODERS).warnings if "cut off" in text]


def test_repeats_are_pooled_by_torque_and_count_as_rows() -> None:
    """Nine passes at three torques: a third of one pass's intervals where the winding is not fitted; no more bins."""
    rig = replace(ENCODERS, turns=4.0, noise=0.8 * ARCSEC)
    one, nine = identified_by(REFERENCE, rig), identified_by(REFERENCE, replace(rig, repeats=9))
    for name in ("e1", "theta1", "e2", "theta2", "jmin eccentric", "jmax eccentric"):
        ratio = one.figures[name].half_width / nine.figures[name].half_width
        assert ratio == pytest.approx(3.0, rel=0.1), name
        assert abs(nine.figures[name].value - one.figures[name].value) < 2 * one.figures[name].half_width
    assert arcsec(nine.figures["jmin eccentric"].value) == pytest.approx(
        LEAST, abs=2 * arcsec(nine.figures["jmin eccentric"].half_width)
    )
    wound = replace(rig, repeats=9, torques=(1.0, 2.0, 3.0), winding=20 * ARCSEC)
    found = identified_by(REFERENCE, wound)
    assert found.winding is not None
    assert arcsec(found.winding.value) == pytest.approx(20.0, abs=2 * arcsec(found.winding.half_width))
    bins = 4 * 27 * 32  # of the turns that were measured
    sides: tuple[Side, ...] = ("drive", "back")
    for side in sides:
        assert nine.fit.measured.count([side]) == 9 * 4 * 180
        assert len(nine.fit.measured.rows[side]) <= bins
        assert len(found.fit.measured.rows[side]) <= 3 * bins
        assert [own.rows for own in nine.read[side]] == 9 * [4 * 180]


def test_a_given_backlash_at_the_start_stands_in() -> None:
    found = identified_by(
        REFERENCE, Rig(samples=180, zeroed=True), Settings(j0=START * ARCSEC, j0_half_width=0.2 * ARCSEC)
    )
    assert arcsec(found.figures["j0"].value) == pytest.approx(START, abs=1e-6)
    assert arcsec(found.figures["jmin eccentric"].value) == pytest.approx(LEAST, abs=0.2)
    assert arcsec(found.figures["jmin eccentric"].half_width) > 0.2


def test_one_turn_is_refused_and_two_are_enough() -> None:
    with pytest.raises(InputError, match=r"covers 1.00 turns .*condition number 19.*2 turns are enough"):
        identified_by(REFERENCE, Rig(turns=1))
    found = identified_by(REFERENCE, Rig(turns=2))
    assert arcsec(found.figures["jmin eccentric"].value) == pytest.approx(LEAST, abs=0.64)


def test_a_backlash_below_zero_is_refused() -> None:
    """Drive and back interchanged: the backlash comes out negative."""
    read: Mapping[Side, tuple[Pass, ...]] = {
        "drive": passes(REFERENCE, Rig(samples=180), "back"),
        "back": passes(REFERENCE, Rig(samples=180), "drive"),
    }
    with pytest.raises(InputError, match=r"the backlash would be -41\d.*interchanged"):
        identified(PAIR, read, Senses(1, 1), Settings())


def test_drift_is_seen_and_fitted_along() -> None:
    rig = Rig(turns=8, samples=180, drift=3 * ARCSEC)
    assert any("drifts by 3." in text for text in identified_by(REFERENCE, rig).warnings)
    found = identified_by(REFERENCE, rig, Settings(drift=True))
    assert not any("drifts" in text or "alone disagrees" in text for text in found.warnings)
    assert all(within(found, REFERENCE)[name] for name in ("e1", "theta1", "e2", "theta2"))


def test_either_side_alone_fits_a_drift_along_too_and_encoders_are_flagged_beside_it() -> None:
    """Alone each side is wrong by the encoders, 4 arcsec or more, not by the drift; r_b2 6 arcsec are 1.3 um."""
    found = identified_by(REFERENCE, replace(ENCODERS, drift=5 * ARCSEC), Settings(drift=True))
    still = identified_by(REFERENCE, ENCODERS)
    assert sum("alone disagrees" in text for text in found.warnings) == 2
    for side, own in found.alone.items():
        assert own.disagrees, side
        for name in ("e1", "e2"):
            assert own.figures[name].value == pytest.approx(still.alone[side].figures[name].value, abs=2e-5)


def test_the_measured_curve_lies_over_the_true_one() -> None:
    """Means of rows about each of 1152 positions: 10 rows a side, 0.57 arcsec each, five standard errors."""
    curve = curve_of(identified_by(REFERENCE, Rig(encoder1=6 * ARCSEC, encoder2=4 * ARCSEC)))
    true = angular_backlash(REFERENCE, curve.phi1)
    assert np.abs(curve.predicted - true).max() < 0.1 * ARCSEC
    assert np.abs(curve.measured - true).max() < 5 * 0.57 * math.sqrt(2 / 10) * ARCSEC


@pytest.mark.slow
@pytest.mark.parametrize(("turns", "tooth_mesh"), [(16.0, 5 * ARCSEC), (3.0, 0.0)])
def test_intervals_hold_the_truth_in_95_of_100_cases(turns: int, tooth_mesh: float) -> None:
    """200 data sets: 90 to 98 % of each figure; a binomial of 200 and 0.95 leaves that in one case of 700."""
    random = np.random.default_rng(14)
    inside: dict[str, int] = {}
    for seed in range(200):
        e1, e2 = random.uniform(0.005, 0.03, 2)
        theta1, theta2 = random.uniform(-math.pi, math.pi, 2)
        own = Specimen(PAIR, e1, theta1, e2, theta2, 0.08)
        rig = replace(ENCODERS, turns=turns, samples=216, tooth_mesh=tooth_mesh, resolution=0.2 * ARCSEC, seed=seed)
        found = identified_by(own, rig)
        least, largest = ends_of(own)
        held = within(found, own)
        held["jmin eccentric"] = (
            abs(found.figures["jmin eccentric"].value - least) <= found.figures["jmin eccentric"].half_width
        )
        held["jmax eccentric"] = (
            abs(found.figures["jmax eccentric"].value - largest) <= found.figures["jmax eccentric"].half_width
        )
        for name, own_held in held.items():
            inside[name] = inside.get(name, 0) + own_held
    assert all(180 <= count <= 196 for count in inside.values()), inside


def test_a_pair_without_a_long_period_is_identified() -> None:
    """z 20/40: both gears' parts repeat after two turns, and stay apart."""
    pair = RigPair(20, 40, 20 * math.cos(math.radians(20)), 40 * math.cos(math.radians(20)), 60.0)
    own = Specimen(pair, 0.01, 1.0, 0.02, -2.0, 0.06)
    found = identified_by(own, Rig(turns=4))
    assert all(within(found, own)[name] for name in ("e1", "e2"))


def test_a_hidden_shift_moves_the_backlash_by_the_chord_of_its_turn() -> None:
    """The back side's part b turned by psi = 2 pi n z1/z2 lies 2 |b| sin(psi/2) off, and the backlash with it."""
    alpha, turns = PAIR.working_angle, 5
    eccentric = 0.003 * np.exp(0.7j)
    turn = np.exp(2j * math.pi * PAIR.rate * turns)
    shift = hidden_shift(PAIR, eccentric * np.exp(-1j * alpha), turn * eccentric * np.exp(1j * alpha))
    assert shift.turns == turns
    assert shift.least == pytest.approx(0.0, abs=1e-15)
    assert shift.moved == pytest.approx(2 * 0.003 * abs(math.sin(math.pi * PAIR.rate * turns)), rel=1e-9)


@pytest.mark.parametrize("sign", [-1, 1])
def test_gears_of_the_next_ratio_are_other_gears(sign: int) -> None:
    """The nearest pair of another ratio up to two teeth off is refused, and a third of the way to it is not."""
    ratios = {(27 + k) / (48 + n) for k in range(-2, 3) for n in range(-2, 3)} - {27 / 48}
    nearest = min(abs(ratio - 27 / 48) for ratio in ratios)
    own = passes(REFERENCE, Rig(samples=90, turns=4), "drive")[0]

    def drifting(drift: float) -> Pass:
        bins = own.bins
        return replace(own, bins=replace(bins, error=bins.error + sign * drift * bins.travel))

    refuse_other_gear(drifting(nearest / 3), PAIR)
    with pytest.raises(InputError, match="other gears: the driven gear turns by"):
        refuse_other_gear(drifting(nearest), PAIR)
