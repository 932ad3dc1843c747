"""Flank tolerances of ISO 1328-1:2013: values worked out by hand, rounding, ranges."""

import itertools
from decimal import ROUND_HALF_UP, Decimal, localcontext
from typing import Any

import pytest

from tol3d.errors import GeometryError
from tol3d.gears.iso1328 import flank_tolerances, rounded


@pytest.mark.parametrize(
    ("tolerance_class", "teeth", "module", "face", "expected"),
    [
        # d 120: f_p 6.32 q, F_p 20.3649 q, f_Ha 5.32 q, f_fa 6.65 q, f_Hb 6.4647 q, q = sqrt 2
        (6, 40, 3.0, 30.0, (9.0, 29.0, 7.5, 9.5, 9.0)),
        # d 275, q = 1: 6.275, 23.4207, 5.275, 6.375, 6.3944
        (5, 110, 2.5, 20.0, (6.5, 23.0, 5.5, 6.5, 6.5)),
        # d 40, q = 1/4: 1.46, 4.2397, 1.21, 1.525, 1.3822
        (1, 20, 2.0, 12.0, (1.5, 4.2, 1.2, 1.5, 1.4)),
        # the same, q = 8: 46.72, 135.67, 38.72, 48.8, 44.23
        (11, 20, 2.0, 12.0, (47.0, 136.0, 39.0, 49.0, 44.0)),
    ],
)
def test_limits_of_a_class_are_those_worked_out_by_hand(
    tolerance_class: int, teeth: int, module: float, face: float, expected: tuple[float, ...]
) -> None:
    found = flank_tolerances(tolerance_class, teeth, module, face)
    own = (found.single_pitch, found.cumulative_pitch, found.profile_slope, found.profile_form, found.helix_slope)
    assert [1e3 * value for value in own] == pytest.approx(expected, abs=1e-9)


def test_limits_are_rounded_to_1_um_above_10_to_half_above_5_and_to_a_tenth_below() -> None:
    pairs = {12.49: 12.0, 12.5: 13.0, 10.4: 10.0, 10.0: 10.0, 7.3: 7.5, 7.2: 7.0, 5.0: 5.0, 4.96: 5.0, 4.94: 4.9}
    assert [rounded(value) for value in pairs] == pytest.approx(list(pairs.values()), abs=1e-12)


def test_limits_are_those_of_exact_decimals() -> None:
    """Decimals of 40 digits, of which those within 1e-30 of a half are one: 5.25 um of class 3, module 10."""
    modules = ("0.5", "0.9", "1", "1.25", "2", "3", "4.5", "6", "7", "10", "14", "22", "30", "50", "70")
    halves = 0
    faces = ("4", "16", "36", "100")
    for tolerance_class, z, m, b in itertools.product(range(1, 12), (11, 20, 25, 57), modules, faces):
        found = flank_tolerances(tolerance_class, z, float(m), float(b))
        own = (found.single_pitch, found.cumulative_pitch, found.profile_slope, found.profile_form, found.helix_slope)
        with localcontext(prec=40):
            module, face = Decimal(m), Decimal(b)
            d, q = z * module, Decimal(2) ** ((tolerance_class - 5) // 2)
            q = q * Decimal(2).sqrt() if tolerance_class % 2 == 0 else q
            exact = [
                (d / 1000 + 2 * module / 5 + 5) * q,
                (d / 500 + Decimal("0.55") * d.sqrt() + Decimal("0.7") * module + 12) * q,
                (2 * module / 5 + d / 1000 + 4) * q,
                (Decimal("0.55") * module + 5) * q,
                (Decimal("0.05") * d.sqrt() + Decimal("0.35") * face.sqrt() + 4) * q,
            ]
            for value, limit in zip(exact, own, strict=True):
                step = Decimal("1") if value > 10 else Decimal("0.5") if value >= 5 else Decimal("0.1")
                steps = (value / step).quantize(Decimal("1e-30"))
                halves += steps % 1 == Decimal("0.5")
                rounded_up = steps.quantize(Decimal(1), rounding=ROUND_HALF_UP) * step
                assert 1e3 * limit == pytest.approx(float(rounded_up), abs=1e-9), (tolerance_class, z, m, b, value)
    assert halves > 200


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"teeth": 4, "module": 2.0}, "teeth of 5 to 1000, got 4"),
        ({"module": 0.4}, "module of 0.5 to 70 mm, got 0.4 mm"),
        ({"face_width": 3.9}, "face width of 4 to 1200 mm, got 3.9 mm"),
        ({"tolerance_class": 12}, "class of 1 to 11, got 12"),
        ({"teeth": 8, "module": 0.5}, "reference diameter of 5 to 15000 mm, got 4 mm"),
    ],
)
def test_gears_outside_the_ranges_have_no_class(changed: dict[str, Any], words: str) -> None:
    numbers: dict[str, Any] = {"tolerance_class": 6, "teeth": 20, "module": 2.0, "face_width": 12.0} | changed
    with pytest.raises(GeometryError, match=words):
        flank_tolerances(**numbers)
