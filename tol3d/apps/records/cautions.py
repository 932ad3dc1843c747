"""Refusals of measurements that cannot be evaluated, and warnings of conditions that may spoil results."""

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from tol3d.apps.records.bins import Bins
from tol3d.apps.records.closure import closures, what_is_open
from tol3d.apps.records.findings import Identified, Settings
from tol3d.apps.records.fit import with_drift
from tol3d.apps.records.pair import ARCSEC, TURN, RigPair
from tol3d.apps.records.reading import Pass
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

ROWS_A_TOOTH: Final = 5.0  # with more, tooth mesh and its second harmonic are told apart from higher orders
LARGEST_CONDITION: Final = 10.0  # of the columns once per turn of either gear and the constant; 19 at one turn of 27/48
OTHER_UNITS: Final = (("radians", "degrees", "deg", math.pi / 180), ("degrees", "radians", "rad", 180 / math.pi))
"""Mistaken units of angles: the unit read, the likely one, its symbol, and the factor that corrects them."""
EXPLAINED: Final = 0.5  # of the scatter; another unit is likely if it leaves less than this
MOST_OF_A_TURN: Final = 0.8 * TURN  # travel below which units are not judged
FEWEST_ROWS: Final = 20  # below which they are not judged
CLOSE_RATIO: Final = 0.1  # of the step to the nearest other ratio; numbers of teeth nearer than that fit


def refuse_wrong_units(one_pass: Pass, pair: RigPair) -> None:
    """Refuse angles in degrees that are stated as radians, or the reverse.

    Raises:
        InputError: the error repeats once per turn only if angles are taken in the other unit.
    """
    as_read = _unexplained(pair, *one_pass.trace)
    for stated, other, unit, scale in OTHER_UNITS:
        phi1, phi2 = (np.unwrap(scale * values) for values in one_pass.raw)
        if np.ptp(phi1) < MOST_OF_A_TURN or len(phi1) < FEWEST_ROWS:
            continue
        sense = float(np.ptp(phi1) * np.ptp(phi2)) and np.sign((phi1[-1] - phi1[0]) * (phi2[-1] - phi2[0]))
        if _unexplained(pair, sense * phi1, phi2) < EXPLAINED * scale * as_read:
            raise InputError(
                f"{one_pass.path}: the angles are read as {stated}, but repeat once per turn only as {other}; give the "
                f"unit in the header (`phi1 [{unit}]`) or by --unit"
            )


def _unexplained(pair: RigPair, phi1: Array, phi2: Array) -> float:
    """Root mean square of the transmission error without its once-per-turn parts [rad]."""
    error = phi2 - pair.rate * phi1
    angles = [phi1, phi2]
    matrix = np.stack([*map(np.sin, angles), *map(np.cos, angles), np.ones_like(phi1)], axis=1)
    residual = error - matrix @ np.linalg.lstsq(matrix, error, rcond=None)[0]
    return float(np.sqrt(np.mean(residual**2)))


def refuse_other_gear(one_pass: Pass, pair: RigPair) -> None:
    """Refuse a measured ratio that is not the scene's.

    Raises:
        InputError: with the ratio that was measured.
    """
    drift = _drift(one_pass.bins)
    nearest = min(abs(z1 / z2 - pair.rate) for z1, z2 in _neighbours(pair))
    if abs(drift) < nearest / 2:
        return
    rate = pair.rate + drift
    like = min(_neighbours(pair, 6), key=lambda teeth: abs(teeth[0] / teeth[1] - rate))
    fits = abs(like[0] / like[1] - rate) < CLOSE_RATIO * nearest
    hint = f"; {like[0]}/{like[1]} teeth would fit" if fits else "; are both columns in one unit?"
    raise InputError(
        f"{one_pass.path}: other gears: the driven gear turns by {rate:.6f} per turn of the driver, expected "
        f"{pair.driver_teeth}/{pair.driven_teeth} = {pair.rate:.6f} by the scene{hint}"
    )


def _drift(bins: Bins) -> float:
    """Slope of the error over the driver's travel [rad/rad]."""
    travel = bins.travel - np.average(bins.travel, weights=bins.rows)
    return float(np.sum(bins.rows * travel * bins.error) / max(np.sum(bins.rows * travel**2), 1e-300))


def _neighbours(pair: RigPair, far: int = 2) -> list[tuple[int, int]]:
    """Numbers of teeth of driver and driven gear that differ from the pair's by at most `far`, of other ratios."""
    near = range(-far, far + 1)
    teeth = [(pair.driver_teeth + k, pair.driven_teeth + n) for k in near for n in near]
    driver, driven = pair.driver_teeth, pair.driven_teeth
    return [(z1, z2) for z1, z2 in teeth if z1 > 2 and z2 > 2 and z1 * driven != z2 * driver]


def condition_of(
    pair: RigPair, phi1: Array, rows: Array, twice: Sequence[int] = (), teeth: Sequence[int] = ()
) -> float:
    """Condition number of the fit's columns: once per turn of either gear, further orders, and the constant.

    Args:
        pair: nominal numbers.
        phi1: angles of the driver (n,) [rad].
        rows: number of rows at each (n,).
        twice: gears (1 driver, 2 driven) with twice per turn, too.
        teeth: further orders of the driver, those of tooth mesh.
    """
    turns = (phi1, pair.rate * phi1)
    angles = [*turns, *(2 * turns[gear - 1] for gear in twice), *(order * phi1 for order in teeth)]
    matrix = np.stack([*map(np.sin, angles), *map(np.cos, angles), np.ones_like(phi1)], axis=1)
    return float(np.linalg.cond(matrix * np.sqrt(rows)[:, None]))


def refuse_too_few_turns(pair: RigPair, side: str, passes: Sequence[Pass], phi1: Array, rows: Array) -> None:
    """Refuse a side whose travel is too short to tell driver and driven gear apart.

    Raises:
        InputError: with the condition number and the turns that are needed.
    """
    condition = condition_of(pair, phi1, rows)
    if condition <= LARGEST_CONDITION:
        return
    turned = max(one_pass.travel for one_pass in passes) / TURN
    raise InputError(
        f"{passes[0].path}: the {side} side covers {turned:.2f} turns of the driver: too little to tell the driver's "
        f"part from the driven gear's (condition number {condition:.3g}, expected at most {LARGEST_CONDITION:g}); "
        f"{_needed_turns(pair):g} turns are enough"
    )


def _needed_turns(pair: RigPair) -> float:
    """Least number of whole turns of the driver for an acceptable condition number."""
    for turns in range(1, pair.long_period_turns + 1):
        phi1 = np.linspace(0.0, TURN * turns, 100 * turns, endpoint=False)
        if condition_of(pair, phi1, np.ones_like(phi1)) <= LARGEST_CONDITION:
            return turns
    return pair.long_period_turns


def refuse_impossible_backlash(pair: RigPair, low: float, high: float, half_width: float, *, given: bool) -> None:
    """Refuse a backlash [rad] below zero or over half a pitch somewhere in the long period.

    Raises:
        InputError: with the backlash and likely causes.
    """
    if low >= -half_width and high < pair.driven_pitch / 2:
        return
    text = f"{low / ARCSEC:.1f}″ … {high / ARCSEC:.1f}″"
    if given:
        raise InputError(
            f"--j0: with it the backlash would be {text} over the long period; expected 0 to half a pitch "
            f"({pair.driven_pitch / 2 / ARCSEC:.0f}″)"
        )
    raise InputError(
        f"the backlash would be {text} over the long period, expected 0 to half a pitch "
        f"({pair.driven_pitch / 2 / ARCSEC:.0f}″): the encoders were set to zero between the sides (then the backlash "
        "at phi1 = 0 must be given: --j0), the sides are not of one place in the long period, or drive and back are "
        "interchanged"
    )


STRAY: Final = 12.0  # standard deviations, estimated by the median; one row in 3e32 of white noise
MAD: Final = 1.4826  # standard deviation of normal values over their median magnitude
LEAST_STRAY: Final = 0.01 * ARCSEC  # under which rounding of rows that do not scatter may lie
FAR: Final = 4.0  # standard errors by which another place in the long period must be better


def refuse_hidden_shift(identified: Identified, settings: Settings, half_width: float) -> tuple[str, ...]:
    """Refuse a back side that lies elsewhere in the long period; a warning if an encoder may be as wrong instead.

    Raises:
        InputError: the driven shaft's encoder would be wrong by more than is believed of it.
    """
    shift = identified.shift
    if shift is None or shift.turns == 0 or shift.moved < half_width:
        return ()
    error = identified.encoders["encoder 2"].half_width / identified.model.quantile
    if shift.own - shift.least < FAR * error:
        return ()
    text = (
        f"the sides may lie {shift.turns} whole turns of the driver apart in the long period: as they stand the driven "
        f"shaft's encoder would be wrong by {shift.own / ARCSEC:.1f}″ once per turn, with the back side that much "
        f"further on by {shift.least / ARCSEC:.1f}″, and the backlash would change by up to {shift.moved / ARCSEC:.1f}″"
    )
    if shift.own > settings.encoder_error:
        raise InputError(
            f"{identified.read['back'][0].path}: {text}. Count the driver's turns on between the sides, or mark both "
            "zeros; if the encoder is that bad, or pitches of the driven gear deviate by that much once per turn, say "
            f'so: --encoder-error "{math.ceil(shift.own / ARCSEC)} arcsec"'
        )
    return (text,)


def cautions(identified: Identified, settings: Settings) -> tuple[str, ...]:
    """All warnings but that of the back side's place in the long period."""
    words = []
    for side, one_sided in identified.alone.items():
        if one_sided.disagrees:
            words.append(
                f"the {side} side alone disagrees with both together by {one_sided.apart:.0f} standard errors: it "
                "reads the encoders' once-per-turn error as eccentricity; use the joint fit"
            )
    for name in ("1", "2"):
        if identified.figures[f"e{name}"].value < identified.figures[f"e{name}"].half_width:
            words.append(f"e{name} is not told from zero, and theta{name} not known")
    for name, amplitude in identified.encoders.items():
        if amplitude.value - amplitude.half_width > settings.encoder_error:
            words.append(
                f"{name} would be wrong by {amplitude.value / ARCSEC:.1f}″ once per turn, more than is believed of it "
                f"({settings.encoder_error / ARCSEC:g}″, --encoder-error): do both sides share its zero? Pitches "
                "that deviate once per turn look alike"
            )
    words += [*_sparse_rows(identified), *_teeth_warnings(identified)]
    if identified.fit.low_orders > 1.0:
        words.append(
            f"what is left at low orders is {identified.fit.low_orders:.1f} times as strong as white noise, "
            "pitches aside (drift, oval shafts, run-out of bearings); intervals are wider for it"
        )
    words += [*_stray_rows(identified), *_torque_warnings(identified), *_drift_warnings(identified, settings)]
    return (*words, *_closure_warnings(identified, settings))


def _sparse_rows(identified: Identified) -> Iterator[str]:
    """A warning if rows are too far apart for the relevant orders of tooth mesh."""
    measured, orders = identified.fit.measured, len(identified.fit.terms.teeth)
    per_tooth = {  # steps from row to row: one fewer than rows in each pass
        side: (measured.count([side]) - len(passes)) / (measured.pair.driver_teeth * measured.turned[side])
        for side, passes in identified.passes.items()
    }
    side = min(per_tooth, key=per_tooth.__getitem__)
    if orders == 2 and round(per_tooth[side], 1) > ROWS_A_TOOTH:
        return
    if orders:
        yield (
            f"the {side} side has {per_tooth[side]:.1f} rows a tooth of the driver: tooth mesh is fitted "
            f"{'once' if orders == 1 else 'once and twice'} a tooth only, and what it has of higher orders may be "
            "taken for that: j_min, j_max and j_0 may lie off by as much on both sides together; measure more than "
            f"{ROWS_A_TOOTH:g} rows a tooth, at places of a tooth that change from turn to turn"
        )
        return
    yield (
        f"the {side} side has {per_tooth[side]:.1f} rows a tooth of the driver: too few to tell tooth mesh, which "
        "j_min, j_max and j_0 and their intervals therefore leave out: each may lie off by what it is on both sides "
        f"together; measure more than {ROWS_A_TOOTH:g} rows a tooth"
    )


def _teeth_warnings(identified: Identified) -> Iterator[str]:
    """A warning of the effect of deviating pitches on eccentricities, if orders beside theirs show any."""
    widths_um = [1e3 * identified.model.quantile * identified.fit.hidden_eccentricity(gear) for gear in (1, 2)]
    if any(widths_um):
        yield (
            "pitches of the teeth deviate; once per turn that looks like an eccentricity, in 95 of 100 cases of up to "
            f"{widths_um[0]:.2g} µm at the driver and {widths_um[1]:.2g} µm at the driven gear, by the orders beside "
            "that of one turn; intervals have that part"
        )


def _stray_rows(identified: Identified) -> Iterator[str]:
    """Warnings of rows far off all others of their side, with their angle."""
    for side, residual in identified.fit.residual.items():
        rows, phi1 = identified.fit.measured.rows[side], identified.fit.measured.points[side].phi1
        scaled = np.abs(residual) * np.sqrt(rows)
        scatter = MAD * float(np.median(scaled))
        worst = int(np.argmax(scaled))
        if scaled[worst] > STRAY * scatter and abs(residual[worst]) > LEAST_STRAY:
            total = rows[worst] * residual[worst] / ARCSEC
            yield (
                f"the {side} side has a row at phi1 = {math.degrees(phi1[worst]):.2f}°, or several, {total:.0f}″ in "
                f"all beside a curve off which rows scatter by {scatter / ARCSEC:.2g}″: a wrong row, a count that was "
                "lost, or a file that was cut off"
            )


def _closure_warnings(identified: Identified, settings: Settings) -> tuple[str, ...]:
    """Warnings of closure errors, less the linear drift if one is fitted along."""
    if not settings.drift:
        return tuple(what_is_open(identified.closure, identified.fit))
    return tuple(
        what_is_open(closures(identified.fit, identified.specimen, identified.passes, but_drift=True), identified.fit)
    )


def _torque_warnings(identified: Identified) -> tuple[str, ...]:
    torques = [one_pass.torques for passes in identified.passes.values() for one_pass in passes]
    if identified.fit.terms.winding or not any(torques):
        return ()
    return (
        "all rows have one torque, or some files none: the backlash is that under load, with the shafts' winding T/k "
        "in it; measure at two torques to extrapolate to none",
    )


def _drift_warnings(identified: Identified, settings: Settings) -> tuple[str, ...]:
    if settings.drift:
        return ()
    fit, words = identified.fit, []
    values, errors = with_drift(fit)
    for side, value, error in zip(fit.terms.sides, values, errors, strict=True):
        over = abs(float(value)) * TURN * fit.measured.turned[side]
        if abs(value) > FAR * error and over > identified.least.backlash.half_width:
            words.append(
                f"the {side} side drifts by {over / ARCSEC:.2f}″ while it is measured; --drift fits that along"
            )
    return tuple(words)
