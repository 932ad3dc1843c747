"""Both sides of a rig's measurement to the eccentricities, the play and the backlash over the whole long period."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.records.alignment import Aligned, HiddenShift, aligned, hidden_shift
from tol3d.records.closure import Closing, closures, what_is_open
from tol3d.records.exact_play import Side
from tol3d.records.fit import Fit, Measured, fitted, measured_of, with_drift
from tol3d.records.one_sided import OneSided, one_sided
from tol3d.records.pair import ARCSEC, TURN, RigPair, Specimen
from tol3d.records.prediction import BacklashModel, Extreme, Figure, length_and_phase, quantile_of
from tol3d.records.reading import Pass, Senses, read_side, senses_of
from tol3d.records.refusals import (
    refuse_impossible_backlash,
    refuse_other_gear,
    refuse_too_few_turns,
    refuse_wrong_units,
)
from tol3d.records.spectrum import Spectrum, spectrum_of
from tol3d.records.terms import ECCENTRIC, ENCODERS, Terms

Array = NDArray[np.float64]
Tell = Callable[[str], None]

ENCODER_ERROR: Final = 20 * ARCSEC  # once per turn, that a rig's encoders and couplings may have
ROWS_A_TOOTH: Final = 5.0  # from which on tooth mesh and its second harmonic are fitted along
FAR: Final = 4.0  # standard errors by which another place in the long period must be better
RESET: Final = 1e-3 * ARCSEC  # of a backlash at the start that is zero because encoders were set to zero
SAME_TORQUE: Final = 0.02  # of the largest torque; two levels nearer than that are one


@dataclass(frozen=True)
class Settings:
    """How a measurement is read.

    Args:
        unit: of angles whose column has none.
        j0: backlash at phi1 = 0 [rad], where encoders were set to zero between the sides.
        j0_half_width: of its 95 % interval [rad].
        encoder_error: once per turn, that is believed of either encoder [rad].
        drift: fit a linear drift of each side along.
    """

    unit: str | None = None
    j0: float | None = None
    j0_half_width: float = 0.0
    encoder_error: float = ENCODER_ERROR
    drift: bool = False


@dataclass(frozen=True, eq=False)
class Identified:
    """What was found.

    Args:
        pair: nominal numbers.
        senses: of the encoders.
        passes: as they were aligned, by side.
        read: the same as they were read, by side.
        fit: of both sides together.
        model: the backlash.
        alone: of each side.
        shift: where the back side might lie instead.
        spectrum: of what is left.
        warnings: what may spoil it.
    """

    pair: RigPair
    senses: Senses
    passes: Mapping[Side, tuple[Aligned, ...]]
    read: Mapping[Side, tuple[Pass, ...]]
    fit: Fit
    model: BacklashModel
    alone: Mapping[Side, OneSided]
    shift: HiddenShift | None
    spectrum: Spectrum
    warnings: tuple[str, ...] = ()

    @property
    def specimen(self) -> Specimen:
        """The pair that was found, theta2 counted as the exact geometry counts it."""
        return self.fit.specimen(self.model.constant_part)

    @cached_property
    def figures(self) -> Mapping[str, Figure]:
        """e1, theta1, e2, theta2 [mm, rad]; jc, j0 and the backlash's ends jmin, jmax with their places [rad]."""
        vector, covariance = self.fit.of(ECCENTRIC)
        quantile = self.model.quantile
        found = dict(zip(("e1", "theta1"), length_and_phase(vector[:2], covariance[:2, :2], quantile), strict=True))
        found |= zip(("e2", "theta2"), length_and_phase(vector[2:], covariance[2:, 2:], quantile), strict=True)
        start = np.zeros(1)
        found["jc"] = Figure(self.model.constant_part, self.model.constant_half_width)
        found["j0"] = Figure(float(self.model.backlash(start)[0]), float(self.model.half_width(start)[0]))
        for name, own in (("jmin", self.least), ("jmax", self.largest)):
            found[name], found[f"{name} at"] = own.backlash, own.place
        return found

    @cached_property
    def least(self) -> Extreme:
        """The smallest backlash over the long period."""
        return self.model.extreme(-1)

    @cached_property
    def largest(self) -> Extreme:
        """The largest."""
        return self.model.extreme(+1)

    @cached_property
    def encoders(self) -> Mapping[str, Figure]:
        """Parts common to both sides, once per turn [rad]: of encoder 1 in its own angle, of encoder 2."""
        vector, covariance = self.fit.of(ENCODERS)
        driver, _ = length_and_phase(vector[:2], covariance[:2, :2], self.model.quantile)
        driven, _ = length_and_phase(vector[2:], covariance[2:, 2:], self.model.quantile)
        gain = 1 / self.pair.rate
        return {"encoder 1": Figure(gain * driver.value, gain * driver.half_width), "encoder 2": driven}

    @cached_property
    def closure(self) -> Mapping[Closing, Figure]:
        """Change of transmission errors and of the backlash over the long period [rad], where one is reached."""
        return closures(self.fit, self.specimen, self.passes)

    @property
    def winding(self) -> Figure | None:
        """1/k of B_0(T) = j_0 + T/k [rad/(N m)]; None where torques tell nothing of it."""
        if not self.fit.terms.winding:
            return None
        value, covariance = self.fit.of(("winding",))
        return Figure(2 * float(value[0]), 2 * self.model.quantile * math.sqrt(float(covariance[0, 0])))


def identify(
    pair: RigPair,
    drive: Sequence[Path],
    back: Sequence[Path],
    settings: Settings,
    tell: Tell = lambda text: None,
) -> Identified:
    """Find eccentricities, play and the backlash over the long period.

    Args:
        pair: nominal numbers, by the scene.
        drive, back: files of either side.
        settings: how they are read.
        tell: callback that gets what goes on, in words.

    Raises:
        InputError: a file cannot be read, or cannot be what it is said to be; with file and row or reason.
    """
    senses = senses_of(drive[0], settings.unit)
    rows = 0

    def progress(more: int) -> None:
        nonlocal rows
        rows += more
        tell(f"{rows} rows")

    files: Mapping[Side, Sequence[Path]] = {"drive": drive, "back": back}
    read: Mapping[Side, tuple[Pass, ...]] = {
        side: tuple(_checked(own, pair) for own in read_side(pair, paths, settings.unit, senses, progress))
        for side, paths in files.items()
    }
    tell("fit")
    return identified(pair, read, senses, settings)


def _checked(own: Pass, pair: RigPair) -> Pass:
    """A pass that is of this pair, in the unit that was said; the rows that show it are not kept on."""
    refuse_wrong_units(own, pair)
    refuse_other_gear(own, pair)
    return own.without_trace()


def identified(pair: RigPair, read: Mapping[Side, tuple[Pass, ...]], senses: Senses, settings: Settings) -> Identified:
    """The same of passes that were read.

    Raises:
        InputError: they cannot be what they are said to be.
    """
    zeroed = settings.j0 is not None
    drive, back = aligned(pair, read["drive"], read["back"], settings.j0)
    passes: Mapping[Side, tuple[Aligned, ...]] = {"drive": drive, "back": back}
    turned = {side: max(own.travel for own in passes_read) / TURN for side, passes_read in read.items()}
    measured = measured_of(pair, passes, turned)
    for side in passes:
        refuse_too_few_turns(pair, side, read[side], measured.points[side].phi1, measured.rows[side])
    _refuse_reset(read, measured, settings)
    fit, model = _fits(measured, _terms(measured, passes, settings), settings)
    shift = None if pair.long_period_turns == 1 else _shift(fit)
    found = Identified(
        pair,
        senses,
        passes,
        read,
        fit,
        model,
        {side: one_sided(side, fit, model) for side in passes},
        shift,
        spectrum_of(fit),
    )
    least, largest = found.figures["jmin"], found.figures["jmax"]
    half_width = max(least.half_width, largest.half_width)
    if model.constant_part < 0.0:
        refuse_impossible_backlash(pair, least.value, largest.value, least.half_width, given=zeroed)
    warnings = _refuse_hidden_shift(found, settings, half_width)
    refuse_impossible_backlash(pair, least.value, largest.value, least.half_width, given=zeroed)
    return replace(found, warnings=(*warnings, *_warnings(found, settings)))


def _terms(measured: Measured, passes: Mapping[Side, tuple[Aligned, ...]], settings: Settings) -> Terms:
    z1 = measured.pair.driver_teeth
    dense = all(measured.count([side]) > ROWS_A_TOOTH * z1 * measured.turned[side] for side in passes)
    every = [own.torques for each in passes.values() for own in each]
    known = [torques for torques in every if torques is not None]
    ends = [end for torques in known for end in torques]
    wound = len(known) == len(every) and max(ends) - min(ends) > SAME_TORQUE * max(ends)
    return Terms(winding=wound, drift=settings.drift, teeth=(z1, 2 * z1) if dense else ())


def _fits(measured: Measured, terms: Terms, settings: Settings) -> tuple[Fit, BacklashModel]:
    """The joint fit and the backlash by it."""
    pair = measured.pair
    fit = fitted(measured, terms, constant_part=settings.j0)
    quantile = quantile_of(fit.freedom)
    offset = float(fit.of(("offset",))[0][0])
    if settings.j0 is None:
        vector, covariance = fit.of((*ECCENTRIC, "constant part"))
        return fit, BacklashModel(pair, vector[:4], offset, float(vector[4]), covariance, quantile)
    vector, own = fit.of(ECCENTRIC)
    covariance = np.zeros((5, 5))
    covariance[:4, :4], covariance[4, 4] = own, (settings.j0_half_width / quantile) ** 2
    model = BacklashModel(pair, vector, offset, settings.j0, covariance, quantile, settings.j0_half_width)
    return fit, model.starting_with(settings.j0)


# what cannot be -----------------------------------------------------------------------------------


def _refuse_reset(read: Mapping[Side, tuple[Pass, ...]], measured: Measured, settings: Settings) -> None:
    """Refuse sides that begin at one angle of the driver without any backlash between them."""
    if settings.j0 is not None:
        return
    (drive, at), (back, there) = read["drive"][0].first, read["back"][0].first
    if abs(at - there) < RESET and abs(back - drive) < RESET:
        raise InputError(
            f"{read['back'][0].path}: both sides begin at the same angles, without any backlash: the encoders were set "
            "to zero between the sides. Then the backlash at phi1 = 0 is not in the data: give it by --j0, or measure "
            "both sides without setting them to zero"
        )


def _shift(fit: Fit) -> HiddenShift:
    """Where the back side might lie instead, by each side's part of the driven gear's turn."""
    eccentric, encoder = fit.of(ECCENTRIC)[0], fit.of(ENCODERS)[0]
    alpha, arm = fit.measured.pair.working_angle, fit.measured.pair.driven_base_radius
    own, common = complex(eccentric[2], eccentric[3]) / arm, complex(encoder[2], encoder[3])
    return hidden_shift(
        fit.measured.pair, own * complex(np.exp(-1j * alpha)) + common, own * complex(np.exp(1j * alpha)) + common
    )


def _refuse_hidden_shift(found: Identified, settings: Settings, half_width: float) -> tuple[str, ...]:
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
            f'if the encoder is that bad, say so: --encoder-error "{math.ceil(shift.own / ARCSEC)} arcsec"'
        )
    return (text,)


# what may spoil it --------------------------------------------------------------------------------


def _warnings(found: Identified, settings: Settings) -> tuple[str, ...]:
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
                f"({settings.encoder_error / ARCSEC:g}″, --encoder-error): do both sides share its zero? Pitches that "
                "deviate once per turn on one flank otherwise than on the other look alike"
            )
    if found.fit.low_orders > 1.0:
        words.append(
            f"what is left at low orders is {found.fit.low_orders:.1f} times as strong as white noise (drift, "
            "cumulative pitch, oval shafts, run-out of bearings); intervals are wider for it"
        )
    return (*words, *_torque_warnings(found), *_drift_warnings(found, settings), *_closure_warnings(found, settings))


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
