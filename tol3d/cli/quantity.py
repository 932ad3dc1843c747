"""Numbers with units as rigs have them: angles in turns too, torques, stiffnesses."""

import math
import re
from collections.abc import Mapping
from typing import Final, Literal

from tol3d.errors import InputError

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

MOST_NUMBERS: Final = 20
PLAIN: Final = re.compile(r"\d{1,5}\.?\d{0,9}|\.\d{1,9}")
STATED: Final = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([^\d\s].*?)\s*")


def stated(option: str, text: str, kind: Kind) -> float:
    """Value of an option with its unit [rad, N m or mm].

    Raises:
        InputError: it is something else.

    >>> round(stated("--e1", "18 um", "length"), 9)
    0.018
    """
    match = STATED.fullmatch(text[:100])
    if match is None or match[2] not in UNITS[kind]:
        article, units = "an" if kind == "angle" else "a", ", ".join(UNITS[kind])
        raise InputError(
            f'{option}: expected {article} {kind} with its unit ({units}), such as "{EXAMPLES[kind]}", got {text!r}'
        )
    return float(match[1]) * UNITS[kind][match[2]]


def numbers(option: str, text: str) -> tuple[float, ...]:
    """Positive numbers between commas, as an option gives them, in rising order.

    Raises:
        InputError: it says something else.

    >>> numbers("--turns", "4, 2,16")
    (2.0, 4.0, 16.0)
    """
    cells = [cell.strip() for cell in text.split(",")]
    if len(cells) > MOST_NUMBERS or not all(PLAIN.fullmatch(cell) and 0.1 <= float(cell) <= 1e4 for cell in cells):
        raise InputError(f"{option}: expected numbers from 0.1 to 10000 between commas, such as 2,4,16, got {text!r}")
    return tuple(sorted(set(map(float, cells))))
