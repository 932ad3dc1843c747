"""Identification from both sides of a rig's measurement: eccentricities, play and backlash over the long period."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from tol3d.apps.records.alignment import Aligned, HiddenShift, Pool, hidden_shift
from tol3d.apps.records.cautions import (
    LARGEST_CONDITION,
    cautions,
    condition_of,
    refuse_hidden_shift,
    refuse_impossible_backlash,
    refuse_other_gear,
    refuse_too_few_turns,
    refuse_wrong_units,
)
from tol3d.apps.records.findings import Identified, Settings
from tol3d.apps.records.fit import Fit, Measured, fitted, measured_of
from tol3d.apps.records.pair import ARCSEC, TURN, RigPair, Side
from tol3d.apps.records.prediction import BacklashModel, one_sided, quantile_of
from tol3d.apps.records.reading import Pass, Senses, read_side, senses_of
from tol3d.apps.records.spectrum import spectrum_of
from tol3d.apps.records.terms import ECCENTRIC, ENCODERS, Terms
from tol3d.apps.records.whole_backlash import ToothPart, tooth_part, whole_backlash
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

Tell = Callable[[str], None]

RESET: Final = 1e-3 * ARCSEC  # of a backlash at the start that is zero because encoders were set to zero
FAR: Final = 6.0  # standard deviations of a row, within which two of them are alike
SAME_TORQUE: Final = 0.02  # of the largest torque; two levels nearer than that are one


def identify(
    pair: RigPair, drive: Sequence[Path], back: Sequence[Path], settings: Settings, tell: Tell = lambda text: None
) -> Identified:
    """Find eccentricities, play and the backlash over the long period.

    Args:
        pair: nominal numbers, by the scene.
        drive, back: files of either side.
        settings: for reading them.
        tell: callback that gets the current activity, in words.

    Raises:
        InputError: a file cannot be read, or cannot be what its name states; with file and row or reason.
    """
    senses = senses_of(drive[0], settings.unit)
    rows = 0

    def progress(more: int) -> None:
        nonlocal rows
        rows += more
        tell(f"{rows} rows")

    files: Mapping[Side, Sequence[Path]] = {"drive": drive, "back": back}
    read: Mapping[Side, Iterable[Pass]] = {
        side: (_checked(own, pair) for own in read_side(pair, paths, settings.unit, senses, progress))
        for side, paths in files.items()
    }
    return identified(pair, read, senses, settings)


def _checked(own: Pass, pair: RigPair) -> Pass:
    """A pass of this pair, in the stated unit."""
    refuse_wrong_units(own, pair)
    refuse_other_gear(own, pair)
    return own


def identified(pair: RigPair, sides: Mapping[Side, Iterable[Pass]], senses: Senses, settings: Settings) -> Identified:
    """The same for passes, each of which is read when its turn comes.

    Raises:
        InputError: they cannot be what they are said to be.
    """
    zeroed = settings.j0 is not None
    pool = Pool(pair, settings.j0)
    pool.add("drive", sides["drive"])
    pool.add("back", sides["back"])
    read, passes = pool.read, pool.aligned
    turned = {side: max(own.travel for own in passes_read) / TURN for side, passes_read in read.items()}
    measured = measured_of(pair, pool.bins, turned)
    for side in passes:
        refuse_too_few_turns(pair, side, read[side], measured.points[side].phi1, measured.rows[side])
    _refuse_reset(read, settings, RESET)
    fit, model, teeth = _fits(measured, _terms(measured, passes, settings), settings)
    _refuse_reset(read, settings, FAR * math.sqrt(fit.variance))
    shift = None if pair.long_period_turns == 1 else _shift(fit)
    found = Identified(
        pair,
        senses,
        passes,
        read,
        fit,
        model,
        teeth,
        whole_backlash(fit, model, teeth),
        {side: one_sided(side, fit, model) for side in passes},
        shift,
        spectrum_of(fit),
    )
    least, largest = found.least.backlash, found.largest.backlash
    half_width = max(least.half_width, largest.half_width)
    if model.constant_part < 0.0:
        refuse_impossible_backlash(pair, least.value, largest.value, least.half_width, given=zeroed)
    warnings = refuse_hidden_shift(found, settings, half_width)
    refuse_impossible_backlash(pair, least.value, largest.value, least.half_width, given=zeroed)
    return replace(found, warnings=(*warnings, *cautions(found, settings)))


def _terms(measured: Measured, passes: Mapping[Side, tuple[Aligned, ...]], settings: Settings) -> Terms:
    every = [own.torques for each in passes.values() for own in each]
    known = [torques for torques in every if torques is not None]
    ends = [end for torques in known for end in torques]
    wound = len(known) == len(every) and max(ends) - min(ends) > SAME_TORQUE * max(ends)
    sides = [(measured.points[side].phi1, measured.rows[side]) for side in measured.points]
    twice, teeth = told_apart_twice(measured.pair, sides), told_apart_teeth(measured.pair, sides)
    return Terms(twice=twice, winding=wound, drift=settings.drift, teeth=teeth)


def told_apart_twice(pair: RigPair, sides: Sequence[tuple[Array, Array]]) -> tuple[int, ...]:
    """Encoders whose part twice per turn the places and rows of each side tell from those once per turn."""
    every: tuple[tuple[int, ...], ...] = ((1, 2), (1,), (2,))
    for encoders in every:
        if all(condition_of(pair, phi1, rows, encoders) <= LARGEST_CONDITION for phi1, rows in sides):
            return encoders
    return ()


def told_apart_teeth(pair: RigPair, sides: Sequence[tuple[Array, Array]]) -> tuple[int, ...]:
    """Orders of tooth mesh that the places and rows of each side tell from the other columns.

    Three rows at the same places of each tooth tell the first one alone, which two do not; rows at other places of
    other teeth tell both, however few.
    """
    z1 = pair.driver_teeth
    every: tuple[tuple[int, ...], ...] = ((z1, 2 * z1), (z1,))
    for orders in every:
        if all(condition_of(pair, phi1, rows, teeth=orders) <= LARGEST_CONDITION for phi1, rows in sides):
            return orders
    return ()


def _fits(measured: Measured, terms: Terms, settings: Settings) -> tuple[Fit, BacklashModel, ToothPart]:
    """The joint fit, the backlash of the eccentricities by it, and the additional effect of teeth."""
    pair = measured.pair
    fit = fitted(measured, terms, constant_part=settings.j0)
    quantile, teeth = quantile_of(fit.freedom), tooth_part(fit)
    offset = float(fit.of(("offset",))[0][0])
    if settings.j0 is None:
        vector, covariance = fit.of((*ECCENTRIC, "constant part"))
        return fit, BacklashModel(pair, vector[:4], offset, float(vector[4]), covariance, quantile), teeth
    vector, own = fit.of(ECCENTRIC)
    ahead, variance = teeth.start  # of what was measured at the start teeth have their part
    covariance = np.zeros((5, 5))
    covariance[:4, :4], covariance[4, 4] = own, (settings.j0_half_width / quantile) ** 2 + variance
    model = BacklashModel(pair, vector, offset, settings.j0, covariance, quantile, settings.j0_half_width)
    return fit, model.starting_with(settings.j0 - ahead), teeth


# what cannot be -----------------------------------------------------------------------------------


def _refuse_reset(read: Mapping[Side, tuple[Pass, ...]], settings: Settings, nothing: float) -> None:
    """Refuse sides that begin at one angle of the driver, to within `nothing` [rad], and without any more backlash."""
    if settings.j0 is not None:
        return
    (drive, at), (back, there) = read["drive"][0].first, read["back"][0].first
    if abs(at - there) < nothing and abs(back - drive) < nothing:
        raise InputError(
            f"{read['back'][0].path}: both sides begin at the same angles, without any backlash: the encoders were set "
            "to zero between the sides. Then the backlash at phi1 = 0 is not in the data: give it by --j0, or measure "
            "both sides without setting them to zero"
        )


def _shift(fit: Fit) -> HiddenShift:
    """Alternative position of the back side, from each side's part of the driven gear's turn."""
    eccentric, encoder = fit.of(ECCENTRIC)[0], fit.of(ENCODERS)[0]
    alpha, arm = fit.measured.pair.working_angle, fit.measured.pair.driven_base_radius
    own, common = complex(eccentric[2], eccentric[3]) / arm, complex(encoder[2], encoder[3])
    return hidden_shift(
        fit.measured.pair, own * complex(np.exp(-1j * alpha)) + common, own * complex(np.exp(1j * alpha)) + common
    )
