"""Numbers as a reader wants them: lengths in um, those at an arm's tip in mm, angles in minutes and seconds of arc."""

import math
import re
from collections.abc import Sequence
from typing import Final

from tol3d.report.page import Shown
from tol3d.units import FACTORS, RAD_PER_ARCMIN, angle_text

NOTHING: Final = "–"
UNIT_SIGNS: Final = {"um": "µm", "mm": "mm", "arcmin": "′", "mrad": "mrad", "K": "K", "1": "1", "pins": "pins"}
MICROMETRES: Final = re.compile(r"(?<=[\s\d])um\b")
COUNTED: Final = frozenset(FACTORS["count"])
MANY_UM: Final = 1000.0  # um; from there on a nanometre says nothing
MANY_MM: Final = 100.0  # mm; from there on six digits are too few for a tenth of a um
UM_PER_MM: Final = 1000.0
LEAST_PPM: Final = 0.001  # of a share; how many of a billion builds fail is beyond any law of a tolerance
LEAST_PERCENT: Final = 1000.0  # ppm; smaller shares are given in ppm, as quality people do
ALMOST_ALL: Final = 999_999.0  # ppm


def value_text(value: float | None, unit: str) -> str:
    """A value of a measure, with its unit only where that is part of the notation.

    >>> value_text(53.3966, "um"), value_text(1.42, "arcmin"), value_text(None, "um"), value_text(2.217224, "mm")
    ('53.397', '1′25.2″', '–', '2.2172')
    >>> value_text(5.0, "pins"), value_text(5.27448, "pins")
    ('5', '5.274')
    """
    if value is None:
        return NOTHING
    if unit == "arcmin":
        return angle_text(value * RAD_PER_ARCMIN)
    if unit == "mm":
        return unsigned_zero(f"{value:.4f}")
    if unit in COUNTED:
        return unsigned_zero(f"{round(value, 3):g}")
    return unsigned_zero(f"{value:.3f}" if abs(value) < MANY_UM else f"{value:.1f}")


def value_cell(value: float | None, unit: str) -> Shown:
    """A value of a measure as a cell, in its unit."""
    return Shown(value_text(value, unit), value)


def share_cell(ppm: float | None) -> Shown:
    """A share of all trials as a cell [ppm]."""
    return Shown(share_text(ppm), ppm)


def percent_cell(value: float | None, error: float | None = None) -> Shown:
    """A share in percent as a cell, with its standard error where that is known."""
    text = percent_text(value)
    return Shown(text if error is None else f"{text} ±{error:.1f}", value)


def measured_text(value: float | None, unit: str) -> str:
    """A value with its unit, for sentences: `53.397 µm`."""
    return NOTHING if value is None else with_unit(value_text(value, unit), unit)


def short_text(value: float, unit: str) -> str:
    """A value with its unit and a digit or two less, for pictures.

    >>> short_text(53.3966, "um"), short_text(-0.04, "um"), short_text(1.42, "arcmin"), short_text(2.217224, "mm")
    ('53.4 µm', '0.0 µm', '1′25.2″', '2.217 mm')
    >>> short_text(1.0, "pins"), short_text(1.977, "pins")
    ('1 pin', '2 pins')
    """
    if unit == "arcmin":
        return measured_text(value, unit)
    text = f"{round(value, 1):g}" if unit in COUNTED else f"{value:.3f}" if unit == "mm" else f"{value:.1f}"
    return with_unit(unsigned_zero(text), unit)


def given_text(value: float | None, unit: str) -> str:
    """A value that somebody else gave, with no more digits than it came with.

    >>> given_text(53.0, "um"), given_text(15.000000000000002, "um"), given_text(-0.0, "um")
    ('53', '15', '0')
    >>> given_text(1200.0055, "mm"), given_text(120.0, "mm")
    ('1200.0055', '120')
    """
    if value is None or unit == "arcmin":
        return value_text(value, unit)
    if unit == "mm" and abs(value) >= MANY_MM:
        return value_text(value, unit).rstrip("0").removesuffix(".")
    return unsigned_zero(f"{value:.6g}")


def difference_text(value: float | None, unit: str) -> str:
    """A small difference with its unit: thousandths of a um, of lengths in mm too, hundredths of an arc second.

    >>> difference_text(0.0871, "um"), difference_text(0.002, "arcmin"), difference_text(0.0000871, "mm")
    ('0.087 µm', '0.12″', '0.087 µm')
    """
    if value is None:
        return NOTHING
    if unit == "arcmin":
        return f"{unsigned_zero(f'{60 * value:.2f}')}″"
    if unit == "mm":
        return difference_text(value * UM_PER_MM, "um")
    return f"{unsigned_zero(f'{value:.3f}')} {UNIT_SIGNS.get(unit, unit)}"


def limit_text(limit: float, unit: str) -> str:
    """A limit with its unit: `53 µm`.

    >>> limit_text(53.0, "um"), limit_text(1.42, "arcmin"), limit_text(1.0, "pins"), limit_text(1.5, "pins")
    ('53 µm', '1′25.2″', '1 pin', '1.5 pins')
    """
    return with_unit(given_text(limit, unit), unit)


def limits_text(lower: float | None, upper: float | None, unit: str) -> str:
    """The limits of a measure with their unit.

    >>> limits_text(40.0, 140.0, "um"), limits_text(15.0, None, "um"), limits_text(None, None, "um")
    ('40 to 140 µm', '≥ 15 µm', '–')
    """
    if lower is not None and upper is not None:
        return f"{given_text(lower, unit)} to {limit_text(upper, unit)}"
    given = ((sign, limit) for sign, limit in (("≥", lower), ("≤", upper)) if limit is not None)
    return "".join(f"{sign} {limit_text(limit, unit)}" for sign, limit in given) or NOTHING


def with_unit(text: str, unit: str) -> str:
    """A value's text with its unit behind: nothing for an angle, whose text has its signs; one is singular.

    >>> with_unit("2.2", "mm"), with_unit("1′25.2″", "arcmin"), with_unit("1", "pins"), with_unit("0", "pins")
    ('2.2 mm', '1′25.2″', '1 pin', '0 pins')
    """
    if unit == "arcmin":
        return text
    return f"{text} {unit.removesuffix('s') if unit in COUNTED and text == '1' else UNIT_SIGNS[unit]}"


def signed_units(text: str) -> str:
    """A sentence with the signs of units where it has a scene's words for them.

    >>> signed_units("expected at least 0 um, got down to -5um")
    'expected at least 0 µm, got down to -5µm'
    """
    return MICROMETRES.sub(UNIT_SIGNS["um"], text)


def tip_mm(arcmin: float | None, lever_mm: float | None) -> float | None:
    """Displacement of a point at a lever by a small turn [mm]: the arc, as the paper's section 4 reads it.

    >>> round(tip_mm(1.0, 763.0), 4)
    0.2219
    """
    return None if arcmin is None or lever_mm is None else arcmin * RAD_PER_ARCMIN * lever_mm


def tip_arcmin(mm: float | None, lever_mm: float | None) -> float | None:
    """The small turn that moves a point at a lever so far [arcmin]; None for a point on the axis.

    >>> round(tip_arcmin(0.2219, 763.0), 3)
    1.0
    """
    return None if mm is None or not lever_mm else mm / (RAD_PER_ARCMIN * lever_mm)


def percent_text(value: float | None) -> str:
    """A share in percent, one decimal.

    >>> percent_text(-0.01), percent_text(22.04)
    ('0.0', '22.0')
    """
    return NOTHING if value is None else unsigned_zero(f"{value:.1f}")


def share_text(ppm: float | None) -> str:
    """A share of all trials with its unit: in % from a tenth of a per cent on, else in ppm.

    >>> share_text(306500.0), share_text(2700.0), share_text(999.0), share_text(0.0519), share_text(0.0)
    ('30.65 %', '0.27 %', '999 ppm', '0.0519 ppm', '0')
    >>> share_text(1.66e-20)
    '< 0.001 ppm'
    """
    if not ppm:
        return NOTHING if ppm is None else "0"
    if ppm < LEAST_PPM:
        return f"< {LEAST_PPM} ppm"
    if ppm < LEAST_PERCENT:
        return f"{ppm_text(ppm)} ppm"
    return f"{f'{ppm / 1e4:.4g}' if ppm < ALMOST_ALL else '100'} %"


def bounded_share_text(ppm: float | None, interval: Sequence[float] | None) -> str:
    """A share of all trials with the interval [ppm] that holds the true one with 95 % confidence, where it is known.

    >>> bounded_share_text(0.0, (0.0, 184.3)), bounded_share_text(31000.0, (26000.0, 37000.0))
    ('0 (95 %: 0 to 184 ppm)', '3.1 % (95 %: 2.6 % to 3.7 %)')
    """
    if ppm is None or interval is None:
        return share_text(ppm)
    low, high = map(share_text, interval)
    return f"{share_text(ppm)} (95 %: {low} to {high})"


def counted(count: int, word: str) -> str:
    """Number and noun, whose plural ends in s.

    >>> counted(1, "trial"), counted(2000, "trial")
    ('1 trial', '2000 trials')
    """
    return f"{count} {word}{'' if count == 1 else 's'}"


def degrees_text(angle: float) -> str:
    """An angle [rad] in degrees, four decimals at most.

    >>> degrees_text(0.34906585), degrees_text(0.0)
    ('20', '0')
    """
    return f"{round(math.degrees(angle), 4):g}"


def ppm_text(value: float | None) -> str:
    """Parts per million, three digits at least: `1500`, `0.052`.

    >>> ppm_text(1500.0), ppm_text(0.0519), ppm_text(0.0)
    ('1500', '0.0519', '0')
    """
    if value is None:
        return NOTHING
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def number_text(value: float | None) -> str:
    """A number without a dimension, with seven digits, so that a million ppm is one.

    >>> number_text(5000), number_text(-0.0), number_text(1e6), number_text(None)
    ('5000', '0', '1000000', '–')
    """
    return NOTHING if value is None else unsigned_zero(f"{value:.7g}" if isinstance(value, float) else str(value))


def number_cell(value: float | None) -> Shown:
    """A number without a dimension as a cell."""
    return Shown(number_text(value), value)


def unsigned_zero(text: str) -> str:
    """A number's text without the sign of a zero.

    >>> unsigned_zero("-0.000"), unsigned_zero("-0.001")
    ('0.000', '-0.001')
    """
    return text.removeprefix("-") if not text.strip("-0.") else text
