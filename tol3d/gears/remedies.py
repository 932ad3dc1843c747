"""Changes of one size that make two external gears run together, which interfere or lose contact as they are.

Each is tried before it is proposed: the gears are made and the pair refused or not, so that who follows the proposal
has a pair that is accepted. Numbers are rounded as they are said.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

from tol3d.errors import GeometryError
from tol3d.gears.involute import involute
from tol3d.gears.spur_pair import SpurPair

STEP = 0.02  # modules; of addenda and shifts that are tried
FURTHEST_ADDENDUM = 0.6  # modules; by which an addendum is changed at most
FURTHEST_SHIFT = 1.0  # modules; the same of a profile shift
FREE = 1e-3  # mm; a nominal backlash so far below 0 is one of rounded sizes
DIGITS = 4  # of a module, and of a centre distance [mm], as they are said
GRAIN = 1e4  # to one; the same


def remedy(pair: SpurPair) -> str:
    """A change that would do, as the end of a sentence: an addendum, a profile shift or a centre distance.

    Pairs whose teeth leave room are proposed first; "" if nothing that is tried would do.
    """
    least = min(pair.normal_backlash, 0.0)
    for free in dict.fromkeys((-FREE, least - FREE)):
        for words, tried in changes(pair):
            if runs(tried, free):
                return f"; {words} would do"
    return ""


def runs(pair: SpurPair | None, least: float) -> bool:
    """True if a pair is accepted and its nominal backlash is not below the least one [mm]."""
    if pair is None:
        return False
    try:
        pair.refuse_interference()
    except GeometryError:
        return False
    return pair.normal_backlash >= least


def changes(pair: SpurPair) -> Iterator[tuple[str, SpurPair | None]]:
    """Changes of a pair from small ones to large ones, in words, each with the pair they give; None if they give none.

    Addenda of either gear and of both; shifts of either gear that keep the sum; shifts that free the pair of backlash
    at its centre distance, and the distance that does so, both also with other addenda.
    """
    pinion, wheel = pair.pinion, pair.wheel
    yield from addenda(pair, "")
    for shift in steps(FURTHEST_SHIFT):
        first, second = (round(gear.profile_shift + way * shift, DIGITS) for gear, way in ((pinion, 1), (wheel, -1)))
        words = f"profile_shift {first:g} of the driver and {second:g} of the driven gear"
        yield words, made(pair, first=first, second=second)
    missing = missing_shift(pair)
    for share in (0.5, 1.0, 0.0):
        first = round(pinion.profile_shift + share * missing, DIGITS)
        second = round(wheel.profile_shift + (1 - share) * missing, DIGITS)
        words = f"profile_shift {first:g} of the driver and {second:g} of the driven gear"
        shifted = made(pair, first=first, second=second)
        yield words, shifted
        if shifted is not None:
            yield from addenda(shifted, f"{words} with ")
    apart = pair.zero_backlash_centre_distance
    if math.isfinite(apart):
        apart = math.ceil(GRAIN * apart) / GRAIN
        words = f"a centre distance of {apart:g} mm"
        moved = made(pair, apart=apart)
        yield words, moved
        if moved is not None:
            yield from addenda(moved, f"{words} with ")


def addenda(pair: SpurPair, before: str) -> Iterator[tuple[str, SpurPair | None]]:
    """Other addenda of the driven gear, the driver and both, the smallest change first."""
    for change in steps(FURTHEST_ADDENDUM):
        own, other = (round(gear.addendum + change, DIGITS) for gear in (pair.pinion, pair.wheel))
        yield f"{before}addendum {other:g} of the driven gear", made(pair, wheel_addendum=other)
        yield f"{before}addendum {own:g} of the driver", made(pair, addendum=own)
        words = f"addendum {own:g} of both gears" if own == other else f"addendum {own:g} and {other:g}"
        yield f"{before}{words}", made(pair, addendum=own, wheel_addendum=other)


def steps(furthest: float) -> Iterator[float]:
    """Changes [modules] to either side, the smallest first, less before more."""
    for k in range(1, round(furthest / STEP) + 1):
        yield from (-k * STEP, k * STEP)


def made(
    pair: SpurPair,
    first: float | None = None,
    second: float | None = None,
    addendum: float | None = None,
    wheel_addendum: float | None = None,
    apart: float | None = None,
) -> SpurPair | None:
    """The pair with other profile shifts, addenda or another centre distance [mm]; None if there is none such."""
    pinion, wheel = pair.pinion, pair.wheel
    try:
        return SpurPair(
            replace(
                pinion,
                profile_shift=pinion.profile_shift if first is None else first,
                addendum=pinion.addendum if addendum is None else addendum,
            ),
            replace(
                wheel,
                profile_shift=wheel.profile_shift if second is None else second,
                addendum=wheel.addendum if wheel_addendum is None else wheel_addendum,
            ),
            pair.centre_distance if apart is None else apart,
        )
    except GeometryError:
        return None


def missing_shift(pair: SpurPair) -> float:
    """Change of the sum of profile shifts that frees the pair of backlash at its centre distance, rounded down.

    inv alpha_wt = inv alpha_t + 2 tan alpha_n (x1 + x2)/(z1 + z2) + what thickness deviations add.
    """
    pinion = pair.pinion
    open_by = involute(pair.working_pressure_angle) - pair.zero_backlash_involute
    missing = open_by * (pinion.teeth + pair.wheel.teeth) / (2 * math.tan(pinion.pressure_angle))
    return math.floor(GRAIN * missing) / GRAIN
