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
"""What one of each unit is in rad."""
TORQUES: Final[Mapping[str, float]] = {"N m": 1.0, "Nm": 1.0, "N·m": 1.0, "mN m": 1e-3, "mNm": 1e-3, "kN m": 1e3}
"""What one of each unit is in N m."""
LENGTHS: Final[Mapping[str, float]] = {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "nm": 1e-6, "m": 1e3}
"""What one of each unit is in mm."""
UNITS: Final[Mapping[Kind, Mapping[str, float]]] = {"angle": ANGLES, "torque": TORQUES, "length": LENGTHS}
EXAMPLES: Final[Mapping[Kind, str]] = {"angle": "6 arcsec", "torque": "2 N m", "length": "18 um"}

STATED: Final = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([^\d\s].*?)\s*")


def stated(option: str, text: str, kind: Kind) -> float:
    """What an option says with its unit [rad, N m or mm].

    Raises:
        InputError: it says something else.

    >>> stated("--e1", "18 um", "length")
    0.018
    """
    match = STATED.fullmatch(text[:100])
    if match is None or match[2] not in UNITS[kind]:
        raise InputError(
            f'{option}: expected a {kind} with its unit ({", ".join(UNITS[kind])}), such as "{EXAMPLES[kind]}", '
            f"got {text!r}"
        )
    return float(match[1]) * UNITS[kind][match[2]]
