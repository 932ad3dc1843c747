"""First contact of deviated cycloid discs, found by moving them: no lever, normal or derivative is known here.

Each disc is laid on its cranks by least squares of the misfits, turned with the carrier, and every pin's distance from
its outline is searched for; the turn is a root of that distance.
"""

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, least_squares

from oracles.rolling_disc import Outline, distance

Complex = NDArray[np.complex128]
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Disc:
    """One disc on its cranks, nothing nominal left out: holes and throws as they are made [mm], complex.

    Args:
        outline: of the disc about the middle of its profile, as it was ground.
        clock: turn of the outline on the disc [rad].
        holes: centres of the crank holes, seen from the middle of the profile.
        throws: of the cranks, at crank angle 0.
        pitch: turn of each lobe about the middle [rad].
        material: on each lobe [mm].
    """

    outline: object
    clock: float
    holes: Complex
    throws: Complex
    pitch: Array
    material: Array


@dataclass(frozen=True)
class Stage:
    """Pins (centres and radii), carrier holes as they are made, and how far cranks turn along with the carrier."""

    pins: Complex
    radii: Array
    carrier_holes: Complex
    rolling: float
    lobes: int


def laid(holes: Complex, at: Complex, centre: complex, angle: float) -> tuple[complex, float]:
    """Centre and angle of a disc whose holes come closest to where cranks have them, from a first guess."""

    def misfit(x: Array) -> Array:
        off = x[0] + 1j * x[1] + np.exp(1j * x[2]) * holes - at
        return np.concatenate([off.real, off.imag])

    found = least_squares(misfit, [centre.real, centre.imag, angle], x_scale=[1.0, 1.0, 0.01], xtol=1e-15, ftol=1e-15)
    return complex(found.x[0], found.x[1]), float(found.x[2])


def gap(stage: Stage, disc: Disc, pin: int, crank: float, turn: float) -> float:
    """Distance of one pin's surface from a disc while the carrier is turned by `turn` beyond its place [mm]."""
    carrier = -crank / stage.lobes + turn
    thrown = cmath.exp(1j * (crank + stage.rolling * turn))
    at = cmath.exp(1j * carrier) * stage.carrier_holes + thrown * disc.throws
    centre, angle = laid(disc.holes, at, complex(np.mean(thrown * disc.throws)), carrier)
    place = (stage.pins[pin] - centre) * cmath.exp(-1j * (angle + disc.clock))
    near = 2 * math.pi * pin / len(stage.pins) - carrier - disc.clock
    lobe = int(near // (2 * math.pi / stage.lobes)) % stage.lobes
    outline = Outline(disc.outline, disc.pitch[lobe])
    return distance(outline, place, near, 0.01) - float(stage.radii[pin]) - float(disc.material[lobe])


def first_turn(stage: Stage, discs: Sequence[Disc], crank: float, working: Sequence[tuple[int, int]]) -> float:
    """The smallest turn [rad] at which any of some (disc, pin) touches, between a milliradian back and forth."""
    return min(
        float(brentq(lambda turn, d=disc, p=pin: gap(stage, discs[d], p, crank, turn), -1e-3, 1e-3, xtol=1e-13))
        for disc, pin in working
    )
