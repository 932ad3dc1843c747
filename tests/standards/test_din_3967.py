"""Series of tooth thickness and fields of centre distance, against rows of the tables and the standard's example."""

import pytest

from tol3d.errors import InputError
from tol3d.statistics.standards.din_3967 import centre_distance, series, thickness

UPPER = """
10 | 100 85 70 58 48 40 33 22 10 5 0
50 | 135 110 95 75 65 54 44 30 14 7 0
125 | 180 150 125 105 85 70 60 40 19 9 0
280 | 250 200 170 140 115 95 80 56 26 12 0
560 | 330 280 230 190 155 130 110 75 35 17 0
1000 | 450 370 310 260 210 175 145 100 48 22 0
1600 | 600 500 420 340 290 240 200 135 64 30 0
2500 | 820 680 560 460 390 320 270 180 85 41 0
4000 | 1100 920 760 620 520 430 360 250 115 56 0
6300 | 1500 1250 1020 840 700 580 480 330 155 75 0
10000 | 2000 1650 1350 1150 940 780 640 450 210 100 0
"""
"""Upper end of the diameters [mm], and -E_sns of a to h [um]: the rows of a public transcription."""
WIDTH = """
10 | 3 5 8 12 20 30 50 80 130 200
50 | 5 8 12 20 30 50 80 130 200 300
125 | 6 10 16 25 40 60 100 160 250 400
280 | 8 12 20 30 50 80 130 200 300 500
560 | 10 16 25 40 60 100 160 250 400 600
1000 | 12 20 30 50 80 130 200 300 500 800
1600 | 16 25 40 60 100 160 250 400 600 1000
2500 | 20 30 50 80 130 200 300 500 800 1300
4000 | 25 40 60 100 160 250 400 600 1000 1600
6300 | 30 50 80 130 200 300 500 800 1300 2000
10000 | 40 60 100 160 250 400 600 1000 1600 2400
"""
"""The same, and T_sn of 21 to 30 [um]."""


def rows(table: str) -> list[tuple[float, list[int]]]:
    """Ends of the ranges [mm] and what stands in them."""
    halves = (line.split("|") for line in table.strip().splitlines())
    return [(float(end), [int(own) for own in cells.split()]) for end, cells in halves]


def test_every_cell_of_both_tables() -> None:
    """Limits belong to the range that they end: just above one the next begins."""
    letters = ("a", "ab", "b", "bc", "c", "cd", "d", "e", "f", "g", "h")
    before = 0.0
    for (end, uppers), (_, widths) in zip(rows(UPPER), rows(WIDTH), strict=True):
        for diameter in (end, before + 1e-6):
            for letter, upper in zip(letters, uppers, strict=True):
                assert thickness(f"{letter}21", diameter).upper == -upper
            for number, width in zip(range(21, 31), widths, strict=True):
                found = thickness(f"cd{number}", diameter)
                assert found.upper - found.lower == width
        before = end


def test_the_example_of_the_standard_in_each_spelling() -> None:
    for text in ("27cd", "27 cd", "cd27", "cd 27"):
        assert series(text) == ("cd", 27)
        assert thickness(text, 100.0) == (-170, -70)


@pytest.mark.parametrize(("distance", "half"), [(61.8, 15.0), (200.0, 23.0)])
def test_a_centre_distance_has_half_the_grade_to_either_side(distance: float, half: float) -> None:
    assert centre_distance("js7", distance) == (-half, half)


@pytest.mark.parametrize("text", ["7", "k7", "js4", "js12", "JS7", ""])
def test_no_field(text: str) -> None:
    with pytest.raises(InputError, match="expected js5 to js11"):
        centre_distance(text, 61.8)


@pytest.mark.parametrize("text", ["cd", "25", "cd20", "cd31", "ce25", "CD25", "25cd25", "-25"])
def test_no_series(text: str) -> None:
    with pytest.raises(InputError, match="as in cd25"):
        thickness(text, 100.0)


def test_no_gear_is_larger_than_the_tables() -> None:
    with pytest.raises(InputError, match="at most 10000 mm, got 10001 mm"):
        thickness("cd25", 10001.0)
