"""First contact of discs by search: poses by least squares over the cranks, gaps by distances to dense outlines."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, least_squares

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SAMPLES = 4001  # of the outline about a pin's place; a parabola through the nearest three takes it from there
REACH = 0.02  # rad of the outline's parameter on either side


class PlacedDiscs:
    """One build: pins, discs of two throws, cranks and carrier, each with its deviations in fields named alike.

    Args:
        numbers: pins Zp, circle rp, pin radius r, eccentricity a, crank circle R.
        ground: what the disc is ground for: circle, pin radius, and rotation of its flanks.
        rolling: turns of the cranks per turn of the carrier beyond its place.
        own: deviations of one trial by name.
    """

    def __init__(
        self, numbers: tuple[int, float, float, float, float], ground: tuple[float, float, float], rolling: float,
        own: dict[str, Array],
    ) -> None:  # fmt: skip
        self.pins, self.circle, self.radius, self.eccentricity, self.crank_circle = numbers
        self.ground, self.rolling, self.own = ground, rolling, own
        self.discs, self.cranks = own["crank_errors"].shape[1], own["crank_errors"].shape[0]

    def pose(self, disc: int, phi: float, turn: float) -> tuple[complex, float]:
        """Centre of the disc's profile and turn of its holes: throws and holes as near to each other as they come."""
        chi, crank = -phi / (self.pins - 1) + turn, phi + self.rolling * turn
        around = self.crank_circle * np.exp(2j * math.pi * np.arange(self.cranks) / self.cranks)
        axes = np.exp(1j * chi) * (around + _complex(self.own["carrier_holes"]) + _complex(self.own["carrier_offsets"]))
        throw = self.eccentricity * np.exp(2j * math.pi * disc / self.discs) + _complex(
            self.own["crank_errors"][:, disc]
        )
        ends = axes + np.exp(1j * (crank + self.own["crank_phases"])) * throw
        holes = around + _complex(self.own["disc_holes"][disc])

        def apart(pose: Array) -> Array:
            off = complex(pose[0], pose[1]) + np.exp(1j * pose[2]) * holes - ends
            return np.concatenate([off.real, off.imag])

        x, y, psi = least_squares(apart, [0.0, 0.0, chi], xtol=1e-15, ftol=1e-15, gtol=1e-15, x_scale=[1, 1, 1e-2]).x
        offset = complex(_complex(self.own["disc_offsets"][disc]))
        return complex(x, y) + complex(np.exp(1j * psi)) * offset, float(psi)

    def gap(self, disc: int, pin: int, phi: float, turn: float) -> float:
        """Between a pin and the lobe that is at its place."""
        centre, psi = self.pose(disc, phi, turn)
        outwards, along = self.own["pins"][pin]
        azimuth = 2 * math.pi * pin / self.pins
        place = (self.circle + outwards + 1j * along) * np.exp(1j * azimuth)
        throw = 2 * math.pi * disc / self.discs
        u = azimuth + (phi + throw) / (self.pins - 1)
        lobe = math.floor(u * (self.pins - 1) / (2 * math.pi)) % (self.pins - 1)
        side = math.copysign(1.0, math.sin((self.pins - 1) * u))
        turned = self.own["lobe_pitch"][disc, lobe] * self.pins / self.circle / (self.pins - 1)
        turned += side * self.ground[2] - throw / (self.pins - 1) + psi
        seen = (place - centre) * np.exp(-1j * turned)
        near = np.linspace(u - REACH, u + REACH, SAMPLES)
        squares = np.abs(self._path(near) - seen) ** 2
        k = int(np.clip(np.argmin(squares), 1, SAMPLES - 2))
        a, b, c = squares[k - 1 : k + 2].tolist()
        least = b - (c - a) ** 2 / (8 * (a - 2 * b + c))
        inside = np.exp(-1j * u) * (seen - self._path(near[k : k + 1])[0])
        # the path is left by microns: signed by the side on which the pin lies
        normal = np.exp(-1j * u) * self._normal(near[k])
        off = math.copysign(math.sqrt(max(least, 0.0)), (inside * np.conj(normal)).real)
        thick = self.radius + self.own["pin_radii"][pin] + self.own["lobe_profile"][disc, lobe]
        return float(off + self.ground[1] - thick)

    def first(self, phi: float, sense: int, window: float) -> tuple[float, int]:
        """The carrier's turn where the first working pin touches, and disc times pins + that pin."""
        found = []
        for disc in range(self.discs):
            phase = 2 * math.pi * np.arange(self.pins) / self.pins - phi - 2 * math.pi * disc / self.discs
            k = self.eccentricity * self.pins / self.circle
            lever = np.sin(phase) / np.sqrt(1 + k * k - 2 * k * np.cos(phase))
            for pin in np.flatnonzero(sense * lever > window):

                def gap(turn: float, disc: int = disc, pin: int = int(pin)) -> float:
                    return self.gap(disc, pin, phi, turn)

                found.append((float(brentq(gap, -2e-3, 2e-3, xtol=1e-12)), disc * self.pins + int(pin)))
        return min(found, key=lambda each: sense * each[0])

    def _path(self, u: Array) -> Complex:
        return np.asarray(self.ground[0] * np.exp(1j * u) - self.eccentricity * np.exp(1j * self.pins * u))

    def _normal(self, u: float) -> complex:
        step = 1e-6
        ahead, behind = self._path(np.array([u + step, u - step]))
        return complex((ahead - behind) / abs(ahead - behind) / 1j)


def _complex(points: Array) -> Complex:
    return np.asarray(points[..., 0] + 1j * points[..., 1])
