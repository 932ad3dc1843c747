"""What may spoil findings: sides that may lie elsewhere, rows off the curve, encoders and drifts beyond belief."""

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from tol3d.errors import InputError
from tol3d.records.closure import closures, what_is_open
from tol3d.records.findings import Identified, Settings
from tol3d.records.fit import with_drift
from tol3d.records.pair import ARCSEC, TURN

STRAY: Final = 12.0  # standard deviations, as the median has them; one row in 10^33 of white noise
MAD: Final = 1.4826  # standard deviation of normal values over their median magnitude
LEAST_STRAY: Final = 0.01 * ARCSEC  # under which rounding of rows that do not scatter may lie
FAR: Final = 4.0  # standard errors by which another place in the long period must be better


def refuse_hidden_shift(found: Identified, settings: Settings, half_width: float) -> tuple[str, ...]:
    """Refuse a back side that lies elsewhere in the long period; warn where that cannot be told from an encoder."""
    shift = found.shift
    if shift is None or shift.turns == 0 or shift.moved < half_width:
        return ()
    error = found.encoders["encoder 2"].half_width / found.model.quantile
    if shift.own - shift.least < FAR * error:
        return ()
    text = (
        f"the sides may lie {shift.turns} whole turns of the driver apart in the long period: as they stand the driven "
        f"shaft's encoder would be wrong by {shift.own / ARCSEC:.1f}″ once per turn, with the back side that much "
        f"further on by {shift.least / ARCSEC:.1f}″, and the backlash would change by up to {shift.moved / ARCSEC:.1f}″"
    )
    if shift.own > settings.encoder_error:
        raise InputError(
            f"{found.read['back'][0].path}: {text}. Count the driver's turns on between the sides, or mark both zeros; "
            "if the encoder is that bad, or pitches of the driven gear deviate by that much once per turn, say so: "
            f'--encoder-error "{math.ceil(shift.own / ARCSEC)} arcsec"'
        )
    return (text,)


def cautions(found: Identified, settings: Settings) -> tuple[str, ...]:
    """All but the place of the back side, in words."""
    words = []
    for side, own in found.alone.items():
        if own.disagrees:
            words.append(
                f"the {side} side alone disagrees with both together by {own.apart:.0f} standard errors: it reads the "
                "encoders' once-per-turn error as eccentricity; use the joint fit"
            )
    for name in ("1", "2"):
        if found.figures[f"e{name}"].value < found.figures[f"e{name}"].half_width:
            words.append(f"e{name} is not told from zero, and theta{name} not known")
    for name, part in found.encoders.items():
        if part.value - part.half_width > settings.encoder_error:
            words.append(
                f"{name} would be wrong by {part.value / ARCSEC:.1f}″ once per turn, more than is believed of it "
                f"({settings.encoder_error / ARCSEC:g}″, --encoder-error): do both sides share its zero? Pitches "
                "that deviate once per turn look alike"
            )
    words += _teeth_warnings(found)
    if found.fit.low_orders > 1.0:
        words.append(
            f"what is left at low orders is {found.fit.low_orders:.1f} times as strong as white noise, "
            "pitches aside (drift, oval shafts, run-out of bearings); intervals are wider for it"
        )
    words += [*_stray_rows(found), *_torque_warnings(found), *_drift_warnings(found, settings)]
    return (*words, *_closure_warnings(found, settings))


def _teeth_warnings(found: Identified) -> Iterator[str]:
    """What deviating pitches do to eccentricities, where orders beside theirs show any."""
    wide = [1e3 * found.model.quantile * found.fit.hidden_eccentricity(gear) for gear in (1, 2)]
    if any(wide):
        yield (
            "pitches of the teeth deviate; once per turn that looks like an eccentricity, in 95 of 100 cases of up to "
            f"{wide[0]:.2g} µm at the driver and {wide[1]:.2g} µm at the driven gear, by the orders beside that of one "
            "turn; intervals have that part"
        )


def _stray_rows(found: Identified) -> Iterator[str]:
    """Rows far beside all others of their side, with their place."""
    for side, left in found.fit.residual.items():
        rows, at = found.fit.measured.rows[side], found.fit.measured.points[side].phi1
        scaled = np.abs(left) * np.sqrt(rows)
        scatter = MAD * float(np.median(scaled))
        worst = int(np.argmax(scaled))
        if scaled[worst] > STRAY * scatter and abs(left[worst]) > LEAST_STRAY:
            all_in_all = rows[worst] * left[worst] / ARCSEC
            yield (
                f"the {side} side has a row at phi1 = {math.degrees(at[worst]):.2f}°, or several, {all_in_all:.0f}″ in "
                f"all beside a curve off which rows scatter by {scatter / ARCSEC:.2g}″: a wrong row, a count that was "
                "lost, or a file that was cut off"
            )


def _closure_warnings(found: Identified, settings: Settings) -> tuple[str, ...]:
    """Of what a linear drift, where one is fitted along, does not explain."""
    if not settings.drift:
        return tuple(what_is_open(found.closure, found.fit))
    return tuple(what_is_open(closures(found.fit, found.specimen, found.passes, but_drift=True), found.fit))


def _torque_warnings(found: Identified) -> tuple[str, ...]:
    torques = [own.torques for each in found.passes.values() for own in each]
    if found.fit.terms.winding or not any(torques):
        return ()
    return (
        "all rows have one torque, or some files none: the backlash is that under load, with the shafts' winding T/k "
        "in it; measure at two torques to extrapolate to none",
    )


def _drift_warnings(found: Identified, settings: Settings) -> tuple[str, ...]:
    if settings.drift:
        return ()
    fit, words = found.fit, []
    values, errors = with_drift(fit)
    for side, value, error in zip(fit.terms.sides, values, errors, strict=True):
        over = abs(float(value)) * TURN * fit.measured.turned[side]
        if abs(value) > FAR * error and over > found.least.backlash.half_width:
            words.append(
                f"the {side} side drifts by {over / ARCSEC:.2f}″ while it is measured; --drift fits that along"
            )
    return tuple(words)
