"""Numbers with units as options for rigs have them: angles, in turns too, torques and lengths."""

import math
import re
from collections.abc import Mapping
from typing import Final, Literal

from tol3d.errors import InputError
from tol3d.units import LONGEST_TEXT, shown

Kind = Literal["angle", "torque", "length"]

ANGLES: Final[Mapping[str, float]] = {
    "rad": 1.0,
    "mrad": 1e-3,
    "urad": 1e-6,
    "deg": math.pi / 180,
    "°": math.pi / 180,
    "arcmin": math.pi / 10800,
    "arcsec": math.pi / 648000,
    "rev": 2 * math.pi,
}
"""One of each unit in rad."""
TORQUES: Final[Mapping[str, float]] = {"N m": 1.0, "Nm": 1.0, "N·m": 1.0, "mN m": 1e-3, "mNm": 1e-3, "kN m": 1e3}
"""One of each unit in N m."""
LENGTHS: Final[Mapping[str, float]] = {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "nm": 1e-6, "m": 1e3}
"""One of each unit in mm."""
UNITS: Final[Mapping[Kind, Mapping[str, float]]] = {"angle": ANGLES, "torque": TORQUES, "length": LENGTHS}
EXAMPLES: Final[Mapping[Kind, str]] = {"angle": "6 arcsec", "torque": "2 N m", "length": "18 um"}

MOST_NUMBERS: Final = 20  # of one option
PLAIN: Final = re.compile(r"\d{1,5}\.?\d{0,9}|\.\d{1,9}")
STATED: Final = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([^\d\s].*?)\s*")


def stated(option: str, text: str, kind: Kind, least: float = -math.inf) -> float:
    """Value of an option with its unit [rad, N m or mm].

    Raises:
        InputError: no finite number with a unit of that kind, or less than the least.

    >>> round(stated("--e1", "18 um", "length"), 9)
    0.018
    """
    match = STATED.fullmatch(text) if len(text) <= LONGEST_TEXT else None
    value = float(match[1]) * UNITS[kind].get(match[2], math.nan) if match else math.nan
    if not math.isfinite(value):
        article, units = "an" if kind == "angle" else "a", ", ".join(UNITS[kind])
        raise InputError(
            f"{option}: expected {article} {kind} with its unit ({units}), such as "
            f'"{EXAMPLES[kind]}", got {shown(text)}'
        )
    if value < least:
        raise InputError(f"{option}: expected {least:g} or more, got {shown(text)}")
    return value


def numbers(option: str, text: str) -> tuple[float, ...]:
    """Numbers from 0.1 to 10000 between commas, each once, in rising order.

    Raises:
        InputError: another number, more than MOST_NUMBERS of them, or another text.

    >>> numbers("--turns", "4, 2,16")
    (2.0, 4.0, 16.0)
    """
    cells = [cell.strip() for cell in text.split(",")]
    if len(cells) > MOST_NUMBERS or not all(PLAIN.fullmatch(cell) and 0.1 <= float(cell) <= 1e4 for cell in cells):
        raise InputError(f"{option}: expected numbers from 0.1 to 10000 between commas, such as 2,4,16, got {text!r}")
    return tuple(sorted(set(map(float, cells))))
