"""Cosine and sine together, against those of the C library."""

from typing import Any

import numpy as np

from tol3d.numerics.quick_waves import cos_and_sin

COMPILED: Any = cos_and_sin


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
