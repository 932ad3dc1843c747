"""Measurements that cannot be what they are said to be, each with its reason."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.records.bins import Bins
from tol3d.records.pair import ARCSEC, TURN, RigPair
from tol3d.records.reading import Pass

LARGEST_CONDITION: Final = 10.0  # of the columns once per turn of either gear and the constant; 19 at one turn of 27/48
OTHER_UNITS: Final = (
    ("radians", "degrees", "deg", math.pi / 180),
    ("degrees", "radians", "rad", 180 / math.pi),
)
"""What angles may be read as, what they may be, its unit, and by what they would then have to be multiplied."""
EXPLAINED: Final = 0.5  # of the scatter, by which another unit must fit better
MOST_OF_A_TURN: Final = 0.8 * TURN
FEWEST_ROWS: Final = 20


def refuse_wrong_units(own: Pass, pair: RigPair) -> None:
    """Refuse angles in degrees that are said to be radians, or the other way round.

    Raises:
        InputError: such angles repeat themselves once per turn only in the other unit.
    """
    as_said = _unexplained(pair, *own.trace)
    for said, other, unit, scale in OTHER_UNITS:
        phi1, phi2 = (np.unwrap(scale * values) for values in own.raw)
        if np.ptp(phi1) < MOST_OF_A_TURN or len(phi1) < FEWEST_ROWS:
            continue
        with_it = float(np.ptp(phi1) * np.ptp(phi2)) and np.sign((phi1[-1] - phi1[0]) * (phi2[-1] - phi2[0]))
        if _unexplained(pair, with_it * phi1, phi2) < EXPLAINED * scale * as_said:
            raise InputError(
                f"{own.path}: the angles are read as {said}, but repeat once per turn only as {other}; give the unit "
                f"in the header (`phi1 [{unit}]`) or by --unit"
            )


def _unexplained(pair: RigPair, phi1: Array, phi2: Array) -> float:
    """Root mean square of what once-per-turn parts leave of the transmission error [rad]."""
    wanted = phi2 - pair.rate * phi1
    at = [phi1, phi2]
    matrix = np.stack([*map(np.sin, at), *map(np.cos, at), np.ones_like(phi1)], axis=1)
    left = wanted - matrix @ np.linalg.lstsq(matrix, wanted, rcond=None)[0]
    return float(np.sqrt(np.mean(left**2)))


def refuse_other_gear(own: Pass, pair: RigPair) -> None:
    """Refuse a ratio of the turns that is not the scene's.

    Raises:
        InputError: with the ratio that was measured.
    """
    drift = _drift(own.bins)
    nearest = min(abs(z1 / z2 - pair.rate) for z1, z2 in _neighbours(pair))
    if abs(drift) < nearest / 2:
        return
    rate = pair.rate + drift
    like = min(_neighbours(pair, 6), key=lambda teeth: abs(teeth[0] / teeth[1] - rate))
    fits = abs(like[0] / like[1] - rate) < nearest / 10
    hint = f"; {like[0]}/{like[1]} teeth would fit" if fits else "; are both columns in one unit?"
    raise InputError(
        f"{own.path}: other gears: the driven gear turns by {rate:.6f} per turn of the driver, expected "
        f"{pair.driver_teeth}/{pair.driven_teeth} = {pair.rate:.6f} by the scene{hint}"
    )


def _drift(bins: Bins) -> float:
    """Slope of the error over the driver's travel."""
    travel = bins.travel - np.average(bins.travel, weights=bins.rows)
    return float(np.sum(bins.rows * travel * bins.error) / max(np.sum(bins.rows * travel**2), 1e-300))


def _neighbours(pair: RigPair, far: int = 2) -> list[tuple[int, int]]:
    """Numbers of teeth nearby, of other ratios."""
    near = range(-far, far + 1)
    teeth = [(pair.driver_teeth + k, pair.driven_teeth + n) for k in near for n in near]
    own = pair.driver_teeth, pair.driven_teeth
    return [(z1, z2) for z1, z2 in teeth if z1 > 2 and z2 > 2 and z1 * own[1] != z2 * own[0]]


def condition_of(pair: RigPair, phi1: Array, rows: Array, twice: Sequence[int] = ()) -> float:
    """Condition number of the columns once per turn of either gear, twice per turn of some, and the constant."""
    turns = (phi1, pair.rate * phi1)
    at = [*turns, *(2 * turns[gear - 1] for gear in twice)]
    matrix = np.stack([*map(np.sin, at), *map(np.cos, at), np.ones_like(phi1)], axis=1)
    return float(np.linalg.cond(matrix * np.sqrt(rows)[:, None]))


def refuse_too_few_turns(pair: RigPair, side: str, passes: Sequence[Pass], phi1: Array, rows: Array) -> None:
    """Refuse a side that covers too little to tell driver and driven gear apart.

    Raises:
        InputError: with the condition number and the turns that are needed.
    """
    condition = condition_of(pair, phi1, rows)
    if condition <= LARGEST_CONDITION:
        return
    turned = max(own.travel for own in passes) / TURN
    raise InputError(
        f"{passes[0].path}: the {side} side covers {turned:.2f} turns of the driver: too little to tell the driver's "
        f"part from the driven gear's (condition number {condition:.3g}, expected at most {LARGEST_CONDITION:g}); "
        f"{_needed_turns(pair):g} turns are enough"
    )


def _needed_turns(pair: RigPair) -> float:
    """Whole turns of the driver from which the columns are well told apart."""
    for turns in range(1, pair.long_period_turns + 1):
        phi1 = np.linspace(0.0, TURN * turns, 100 * turns, endpoint=False)
        if condition_of(pair, phi1, np.ones_like(phi1)) <= LARGEST_CONDITION:
            return turns
    return pair.long_period_turns


def refuse_impossible_backlash(pair: RigPair, low: float, high: float, half_width: float, *, given: bool) -> None:
    """Refuse a backlash [rad] below zero or over half a pitch somewhere in the long period.

    Raises:
        InputError: with what that means.
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
