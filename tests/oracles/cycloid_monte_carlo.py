"""The transmission error of a cycloid stage by plain Monte Carlo, on its own: the RV-250AII of the published example.

The turn of a disc is the smallest gap / lever over pins with a lever of more than 0.7 of the largest, all to first
order. What the example leaves open is taken so: a linear tolerance is three standard deviations; a run-out is an
eccentricity, six standard deviations of either component; the pin circle's radius is off alike at all pins, or the
whole circle is displaced by a normal length in a random direction ("once per turn"); carrier hole and main bearing each
add one component over the pitch radius.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PINS, LOBES, ECCENTRICITY, CIRCLE = 40, 39, 2.2, 114.5  # RV-250AII [mm]
ROLLING = ECCENTRICITY * LOBES
K = ECCENTRICITY * PINS / CIRCLE
WINDOW = 0.7
CLEARANCE = 20.0  # um off the pin circle that the disc is ground for, its pins grown so that none is left at best
SECONDS = np.degrees(1.0) * 3.6  # '' mm/um


@dataclass(frozen=True)
class Drawn:
    """Drawn deviations of units [um], complex in the frame of disc or crank; by disc where a list."""

    crank: Array
    radial: Array
    tangential: Array
    discs: list[NDArray[np.complex128]]
    cranks: list[NDArray[np.complex128]]
    pitch: list[Array]
    profile: list[Array]


@dataclass(frozen=True)
class Units:
    """Turns [arc second] of the first disc and of both, without the carrier's part, which stands by itself."""

    first: Array
    both: Array
    carrier: Array
    drawn: Drawn


def units(count: int, seed: int, *, displaced_circle: bool = False) -> Units:
    """Units at one random position each."""
    rng = np.random.default_rng(seed)
    at = 2 * np.pi * np.arange(PINS) / PINS
    crank = rng.uniform(0.0, 2 * np.pi * LOBES, count)
    radial, tangential = _pins(rng, count, at, displaced_circle)
    own = Drawn(
        crank,
        radial,
        tangential,
        [_plane(rng, count, 12.0) for _ in range(2)],
        [_plane(rng, count, 4.0) for _ in range(2)],
        [rng.normal(0.0, 10.0 / 3, (count, LOBES)) for _ in range(2)],
        [rng.normal(0.0, 0.5 / 3, (count, LOBES)) for _ in range(2)],
    )
    first, second = (_disc_turn(own, at, disc) for disc in range(2))
    carrier = rng.normal(0.0, np.hypot(5.0, 5.0) / 6, count) / ROLLING * SECONDS
    return Units(first, np.minimum(first, second), carrier, own)


def _disc_turn(own: Drawn, at: Array, disc: int) -> Array:
    """Turn of one disc [arc second]: the second has its throw opposite and its lobes half a pitch on."""
    crank, clock = own.crank, np.pi * disc / LOBES
    eccentric = own.discs[disc] * np.exp(-1j * crank / LOBES) + own.cranks[disc] * np.exp(1j * crank)
    lobe = np.floor((at + (crank / LOBES)[:, None] + clock) * LOBES / (2 * np.pi)).astype(int) % LOBES
    pitch, profile = (np.take_along_axis(each[disc], lobe, axis=1) for each in (own.pitch, own.profile))
    return _turn(at, crank + np.pi * disc, own.radial, own.tangential - pitch, eccentric, profile)


def _pins(rng: np.random.Generator, count: int, at: Array, displaced_circle: bool) -> tuple[Array, Array]:
    """Deviations of the pins outwards and counter-clockwise [um]."""
    size = rng.normal(0.0, 17.5 / 3, (count, 1))
    radial, tangential = np.repeat(size, PINS, axis=1), rng.normal(0.0, 0.1 / 3, (count, PINS))
    if displaced_circle:
        towards = rng.uniform(0.0, 2 * np.pi, (count, 1))
        radial, tangential = size * np.cos(at - towards), tangential - size * np.sin(at - towards)
    return radial, tangential


def _plane(rng: np.random.Generator, count: int, run_out: float) -> NDArray[np.complex128]:
    return rng.normal(0.0, run_out / 6, count) + 1j * rng.normal(0.0, run_out / 6, count)


def _turn(
    at: Array, crank: Array, radial: Array, tangential: Array, disc: NDArray[np.complex128], material: Array
) -> Array:
    """Turn of one disc [arc second] until its first working pin touches."""
    phase = at - crank[:, None]
    apart = np.abs(1 - K * np.exp(1j * phase))
    outwards, across = (1 - K * np.cos(phase)) / apart, K * np.sin(phase) / apart
    gap = CLEARANCE * (outwards - np.sqrt(1 - K * K)) - material
    gap += outwards * radial + across * tangential
    normal = np.exp(1j * at) * (outwards + 1j * across)
    gap -= (np.conj(disc)[:, None] * normal).real
    lever = ROLLING * np.sin(phase) / apart
    working = lever > WINDOW * ROLLING
    turn: Array = np.min(np.where(working, gap / np.where(working, lever, 1.0), np.inf), axis=1) * SECONDS
    return turn
