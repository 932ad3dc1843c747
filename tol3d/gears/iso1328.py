"""Flank tolerances of cylindrical gears by their ISO 1328-1:2013 class.

Source: ISO 1328-1:2013, Formulae (5) to (8) and (10) in 5.3, the ranges of clause 1, the step factor of 5.2.2 and the
rounding of 5.2.3, as several published calculators that cite them state them alike; the standard itself was not at
hand. One of those leaves out the term 0.001 d of the profile slope, three have it, and so has this one. All of these
come from formulas: none of them needs a table. Lengths in the formulas are mm, results um.
"""

import math
from dataclasses import dataclass
from typing import Final

from tol3d.errors import GeometryError
from tol3d.statistics.standards import half_up

UM: Final = 1e-3  # mm
CLASSES: Final = (1, 11)
TEETH: Final = (5, 1000)
DIAMETER: Final = (5.0, 15000.0)  # mm, of the reference circle
MODULE: Final = (0.5, 70.0)  # mm
FACE_WIDTH: Final = (4.0, 1200.0)  # mm
HELIX_ANGLE: Final = (0.0, 45.0)  # deg


@dataclass(frozen=True)
class FlankTolerances:
    """Limits of one gear's flanks [mm].

    Args:
        single_pitch: f_pT, of the size of every single pitch deviation.
        cumulative_pitch: F_pT, of the largest index deviation of a flank side less the smallest.
        profile_slope: f_HalphaT, of the size of every profile slope deviation.
        profile_form: f_falphaT, of every profile form deviation, from peak to valley.
        helix_slope: f_HbetaT, of the size of every helix slope deviation.
    """

    single_pitch: float
    cumulative_pitch: float
    profile_slope: float
    profile_form: float
    helix_slope: float


def flank_tolerances(
    tolerance_class: int, teeth: int, module: float, face_width: float, helix_angle: float = 0.0
) -> FlankTolerances:
    """Limits of a spur or helical gear of a flank tolerance class, rounded as the standard has it.

    f_pT = (0.001 d + 0.4 m + 5) q, F_pT = (0.002 d + 0.55 sqrt d + 0.7 m + 12) q, f_HalphaT = (0.4 m + 0.001 d + 4) q,
    f_falphaT = (0.55 m + 5) q, f_HbetaT = (0.05 sqrt d + 0.35 sqrt b + 4) q, with q = sqrt(2)^(class - 5).

    Args:
        tolerance_class: A, 1 to 11.
        teeth: z, 5 to 1000.
        module: m [mm], 0.5 to 70, the normal module; the reference diameter d = m z/cos(beta) is 5 to 15 000 mm.
        face_width: b [mm], 4 to 1200.
        helix_angle: beta [rad], up to 45 deg.

    Raises:
        GeometryError: the gear lies outside the ranges, beyond which the standard forbids to extrapolate.

    >>> wheel = flank_tolerances(6, teeth=40, module=3.0, face_width=30.0)  # 8.94 and 28.80 um before rounding
    >>> round(wheel.single_pitch, 6), round(wheel.cumulative_pitch, 6)
    (0.009, 0.029)
    """
    diameter = module * teeth / math.cos(helix_angle)
    for words, value, (low, high), unit in (
        ("class", tolerance_class, CLASSES, ""),
        ("teeth", teeth, TEETH, ""),
        ("reference diameter", diameter, DIAMETER, " mm"),
        ("module", module, MODULE, " mm"),
        ("face width", face_width, FACE_WIDTH, " mm"),
        ("helix angle", math.degrees(helix_angle), HELIX_ANGLE, " deg"),
    ):
        if not low <= value <= high:
            raise GeometryError(
                f"ISO 1328-1:2013 knows flanks of a {words} of {low:g} to {high:g}{unit}, got {value:g}{unit}; "
                "state the limits themselves"
            )
    step = math.sqrt(2.0) ** (tolerance_class - 5)
    return FlankTolerances(
        single_pitch=rounded((0.001 * diameter + 0.4 * module + 5) * step) * UM,
        cumulative_pitch=rounded((0.002 * diameter + 0.55 * math.sqrt(diameter) + 0.7 * module + 12) * step) * UM,
        profile_slope=rounded((0.4 * module + 0.001 * diameter + 4) * step) * UM,
        profile_form=rounded((0.55 * module + 5) * step) * UM,
        helix_slope=rounded((0.05 * math.sqrt(diameter) + 0.35 * math.sqrt(face_width) + 4) * step) * UM,
    )


def rounded(value: float) -> float:
    """A tolerance [um] by 5.2.3: to 1 um above 10, to 0.5 um from 5 to 10, to 0.1 um below 5; halves go up.

    >>> rounded(12.5), rounded(7.3), rounded(4.96), rounded(4.94)
    (13.0, 7.5, 5.0, 4.9)
    """
    grain = 1.0 if value > 10.0 else 0.5 if value >= 5.0 else 0.1
    return half_up(value, grain)
