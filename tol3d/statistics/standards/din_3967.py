"""DIN 3967: tooth thickness by a series such as cd25, whose letters give the upper allowance and number the tolerance.

Both are arcs of the normal section at the reference cylinder. The standard was not at hand: the tables are a public
transcription, of which columns cd and 25 agree with a second one, and the standard's own example, 27cd at 100 mm, with
both. DIN 3964 gives centre distances the fields js5 to js11 of ISO 286.
"""

import re
from typing import Final

from tol3d.errors import InputError
from tol3d.statistics.standards import iso_286
from tol3d.statistics.standards.iso_286 import Limits

DIAMETERS: Final = (10, 50, 125, 280, 560, 1000, 1600, 2500, 4000, 6300, 10000)
"""Upper ends of the ranges of reference diameters, of which each has its end [mm]."""
ALLOWANCES: Final = {
    "a": (100, 135, 180, 250, 330, 450, 600, 820, 1100, 1500, 2000),
    "ab": (85, 110, 150, 200, 280, 370, 500, 680, 920, 1250, 1650),
    "b": (70, 95, 125, 170, 230, 310, 420, 560, 760, 1020, 1350),
    "bc": (58, 75, 105, 140, 190, 260, 340, 460, 620, 840, 1150),
    "c": (48, 65, 85, 115, 155, 210, 290, 390, 520, 700, 940),
    "cd": (40, 54, 70, 95, 130, 175, 240, 320, 430, 580, 780),
    "d": (33, 44, 60, 80, 110, 145, 200, 270, 360, 480, 640),
    "e": (22, 30, 40, 56, 75, 100, 135, 180, 250, 330, 450),
    "f": (10, 14, 19, 26, 35, 48, 64, 85, 115, 155, 210),
    "g": (5, 7, 9, 12, 17, 22, 30, 41, 56, 75, 100),
    "h": (0,) * 11,
}
"""-E_sns by letters and range [um]."""
TOLERANCES: Final = {
    21: (3, 5, 6, 8, 10, 12, 16, 20, 25, 30, 40),
    22: (5, 8, 10, 12, 16, 20, 25, 30, 40, 50, 60),
    23: (8, 12, 16, 20, 25, 30, 40, 50, 60, 80, 100),
    24: (12, 20, 25, 30, 40, 50, 60, 80, 100, 130, 160),
    25: (20, 30, 40, 50, 60, 80, 100, 130, 160, 200, 250),
    26: (30, 50, 60, 80, 100, 130, 160, 200, 250, 300, 400),
    27: (50, 80, 100, 130, 160, 200, 250, 300, 400, 500, 600),
    28: (80, 130, 160, 200, 250, 300, 400, 500, 600, 800, 1000),
    29: (130, 200, 250, 300, 400, 500, 600, 800, 1000, 1300, 1600),
    30: (200, 300, 400, 500, 600, 800, 1000, 1300, 1600, 2000, 2400),
}
"""T_sn by number and range [um]."""
SERIES: Final = re.compile(r"\s*(?:(?P<letters>[a-z]+)\s*(?P<number>\d+)|(?P<other>\d+)\s*(?P<behind>[a-z]+))\s*")
FIELD: Final = re.compile(r"\s*js\s*(?P<grade>[5-9]|10|11)\s*")


def series(text: str) -> tuple[str, int]:
    """Letters and number of a series; drawings write them in either order.

    >>> series("cd25"), series("25 cd")
    (('cd', 25), ('cd', 25))

    Raises:
        InputError: it is none.
    """
    match = SERIES.fullmatch(text)
    letters, number = (
        (match["letters"] or match["behind"], int(match["number"] or match["other"])) if match else ("", 0)
    )
    if letters not in ALLOWANCES or number not in TOLERANCES:
        raise InputError(f"expected {', '.join(ALLOWANCES)} and 21 to 30, as in cd25, got {text!r}")
    return letters, number


def thickness(text: str, diameter: float) -> Limits:
    """Lower and upper allowance E_sni and E_sns of a series [um].

    >>> thickness("27cd", 100.0)
    Limits(lower=-170, upper=-70)

    Args:
        text: letters and number.
        diameter: of the reference circle [mm].

    Raises:
        InputError: no series, or a diameter beyond the tables.
    """
    letters, number = series(text)
    place = next((place for place, end in enumerate(DIAMETERS) if diameter <= end), None)
    if place is None:
        raise InputError(f"expected a reference diameter of at most {DIAMETERS[-1]} mm, got {diameter:g} mm")
    upper = -ALLOWANCES[letters][place]
    return Limits(upper - TOLERANCES[number][place], upper)


def field(text: str) -> str:
    """A field of DIN 3964, as ISO 286 writes it.

    Raises:
        InputError: it is none; a number alone is a class of axes too.
    """
    match = FIELD.fullmatch(text)
    if match is None:
        raise InputError(f"expected js5 to js11, got {text!r}")
    return f"js{match['grade']}"


def centre_distance(text: str, distance: float) -> Limits:
    """Lower and upper allowance A_ai and A_ae of a field of DIN 3964 [um].

    >>> centre_distance("js7", 61.8)
    Limits(lower=-15.0, upper=15.0)

    Args:
        text: the field.
        distance: the nominal centre distance [mm].

    Raises:
        InputError: no field, or a distance that ISO 286 has no grades for.
    """
    return iso_286.limits(field(text), distance)
