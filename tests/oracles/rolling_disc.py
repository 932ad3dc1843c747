"""A disc on its crank among pins, placed step by step: no epitrochoid, normal or lever is known here."""

import cmath
import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

Complex = NDArray[np.complex128]


def pin_in_disc(pins: int, circle: float, eccentricity: float, pin: int, crank: float) -> complex:
    """Centre of a pin in the frame of a disc whose centre is at the crank's end and that has turned back by 1/lobes."""
    standing = circle * cmath.exp(2j * math.pi * pin / pins)
    return (standing - eccentricity * cmath.exp(1j * crank)) * cmath.exp(1j * crank / (pins - 1))


def swept(pins: int, circle: float, eccentricity: float, steps: int) -> Complex:
    """Centres of all pins in the disc's frame at crank angles over one turn, (pins, steps)."""
    return np.array(
        [
            [pin_in_disc(pins, circle, eccentricity, pin, 2 * math.pi * step / steps) for step in range(steps)]
            for pin in range(pins)
        ]
    )


def distance(outline: "Outline", place: complex, near: float, reach: float) -> float:
    """Least distance of a place from the outline at parameters within `reach` of `near`."""
    coarse = np.linspace(near - reach, near + reach, 201)
    middle = coarse[np.argmin(np.abs(outline(coarse) - place))]
    step = reach / 100
    found = minimize_scalar(
        lambda u: abs(outline(np.array([u]))[0] - place) ** 2, bounds=(middle - step, middle + step), method="bounded",
        options={"xatol": 1e-14},
    )  # fmt: skip
    return math.sqrt(found.fun)


class Outline:
    """A curve given by its points (n, 2) at parameters, as complex numbers."""

    def __init__(self, points: object, turned: float = 0.0) -> None:
        self._points, self._turned = points, turned

    def __call__(self, u: NDArray[np.float64]) -> Complex:
        x, y = self._points(u).T  # type: ignore[operator]
        return (x + 1j * y) * cmath.exp(1j * self._turned)
