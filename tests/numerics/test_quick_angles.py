"""Series of cosines, sines and azimuths, against the C library's."""

from typing import Any

import numpy as np

from tol3d.numerics.quick_angles import SLIGHT, azimuth, cos_and_sin, turned_by

COMPILED: Any = cos_and_sin
TURNED: Any = turned_by
AZIMUTH: Any = azimuth


def test_cosine_and_sine_are_those_of_the_library_in_every_quadrant() -> None:
    generator = np.random.default_rng(1)
    quarters = np.arange(-9, 10) * np.pi / 2  # and just beside the seams between them
    seams = [(quarters + np.pi / 4 + aside) for aside in (-1e-12, 0.0, 1e-12)]
    for angle in np.concatenate(
        [quarters, *seams, generator.uniform(-20.0, 20.0, 2000), generator.uniform(-1, 1, 500)]
    ):
        cos, sin = COMPILED.py_func(angle)
        assert abs(cos - np.cos(angle)) < 4e-16 + 1e-16 * abs(angle)
        assert abs(sin - np.sin(angle)) < 4e-16 + 1e-16 * abs(angle)


def test_an_angle_turned_on_is_their_sum_by_either_side_of_the_series_end() -> None:
    generator = np.random.default_rng(2)
    for angle, turn in zip(generator.uniform(-7, 7, 600), generator.uniform(-0.07, 0.07, 600), strict=True):
        cos, sin = TURNED.py_func(np.cos(angle), np.sin(angle), turn)
        assert abs(cos - np.cos(angle + turn)) < 2e-15
        assert abs(sin - np.sin(angle + turn)) < 2e-15


def test_an_azimuth_is_that_of_the_library_near_the_axis_and_far_from_it() -> None:
    generator = np.random.default_rng(3)
    slopes = np.concatenate([generator.uniform(-2 * SLIGHT, 2 * SLIGHT, 400), [0.0, SLIGHT, -SLIGHT, 5.0, -5.0]])
    for slope in slopes:
        for x in (3.0, -3.0, 1e-3):
            assert abs(AZIMUTH(slope * x, x) - np.arctan2(slope * x, x)) < 1e-15
