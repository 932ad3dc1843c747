"""An RV-250AII with play at rest, by HiGHS from the columns of a run, sharing no code with tol3d.

Parts are points in the plane as complex numbers, where they stand nominally when the output has made its turn; planets
are involutes about displaced centres. Eccentricities turn with planets; the sun's points where it would nominally.
"""

from collections.abc import Mapping
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from oracles.drawn_columns import DrawnColumns

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

PINS, LOBES, CIRCLE, PIN_RADIUS, ECCENTRICITY = 40, 39, 114.5, 5.0, 2.2
SHIFT, OFFSET = -0.02, -0.012795
CRANKS, CRANK_CIRCLE, SUN_HELD, WINDOW = 3, 63.0, 1.5, 0.7
BASES = 21 * np.cos(np.radians(20)), 42 * np.cos(np.radians(20))  # radii, of module 2 mm
ARM = 100.0  # mm; turns count as lengths there


def involute(angle: Array) -> Array:
    return np.tan(angle) - angle


class PlayingReducer:
    """One trial of scenes/rv_bearing_play.yaml, whatever other tolerances of these names it has."""

    def __init__(self, columns: Mapping[str, Array], trial: int) -> None:
        drawn = DrawnColumns(columns, trial)
        turn = drawn.at("reducer")
        self.phi, self.chi = -LOBES * turn, turn
        self.around = np.exp(2j * np.pi * np.arange(CRANKS) / CRANKS)
        pins = drawn.all("pin pitch", *(f"pin {j + 1}" for j in range(PINS)))
        self.pins = (CIRCLE + drawn.one("pin circle") + 1j * pins) * np.exp(2j * np.pi * np.arange(PINS) / PINS)
        discs = ("disc 1", "disc 2")
        lobes = [[f"{disc} lobe {k + 1}" for k in range(LOBES)] for disc in discs]
        self.lobe_pitch = np.stack([drawn.all("disc pitch", *own) for own in lobes])
        self.lobe_profile = np.stack([drawn.all("disc profile", *own) for own in lobes])
        each = [[f"{disc} hole {k + 1}" for k in range(CRANKS)] for disc in discs]
        bored = np.stack([drawn.plane("disc holes", *own) for own in each])
        self.bored = CRANK_CIRCLE * self.around + bored - drawn.plane("disc run-out", *discs)[:, None]
        thrown = np.stack([drawn.plane("cranks", *(f"crank {i + 1} {disc}" for disc in discs)) for i in range(CRANKS)])
        self.thrown = ECCENTRICITY * np.array([1.0, -1.0]) + thrown + drawn.plane("crank run-out", *discs)
        holes = drawn.plane("holes", *(f"hole {i + 1}" for i in range(CRANKS)))
        self.off = holes + drawn.plane("carrier holes", "") + drawn.plane("main bearing run-out", "")
        plays = np.stack([drawn.all("play in the discs", *own) for own in each]).T.ravel()
        carrier = drawn.all("play in the carrier", *(f"hole {i + 1}" for i in range(CRANKS)))
        self.radial = 1e3 * np.maximum(np.concatenate([plays, carrier]), 0.0) / 2  # um
        planets = [f"planet {i + 1}" for i in range(CRANKS)]
        thicker = drawn.one("sun thinning") + drawn.all("planet thinning", *planets)
        sun = (LOBES + 1) * 42 / 21 * turn - 2 * np.pi * np.arange(CRANKS) / CRANKS
        planet = -sun * 21 / 42 + np.pi + np.pi / 42  # a space of its teeth faces the sun
        self.off_planets = drawn.plane("planet run-out", *planets) * np.exp(1j * planet)
        self.off_sun = drawn.plane("sun run-out", "") * np.exp(1j * sun)
        self.thicker, self.phases = thicker, drawn.all("phases", *(f"crank {i + 1}" for i in range(CRANKS)))

    def flanks(self, z: Array) -> Array:
        """Room of each planet's teeth (2 cranks,), back and ahead [um at the arm]."""
        lies = self.joined(z)[-CRANKS:] / 1e3 * np.exp(-1j * self.chi) + self.off
        turned = z[9::3] / 1e3 / ARM - self.phases
        apart = CRANK_CIRCLE + self.off_planets * np.exp(1j * turned) - self.off_sun + lies * np.conj(self.around)
        alpha, bases = np.arccos(sum(BASES) / abs(apart)), sum(BASES)
        room = bases * (involute(alpha) - involute(np.radians(20.0))) - self.thicker / 2
        turned = turned - bases * np.angle(apart) / BASES[1]
        return 1e3 * ARM * np.concatenate([turned + room / BASES[1], room / BASES[1] - turned])

    def joined(self, z: Array) -> Complex:
        """Displacements in the bearings (9,) [um], crank by crank those of discs, then the carrier's."""
        at = z / 1e3
        axes = np.exp(1j * self.chi) * CRANK_CIRCLE * self.around + at[7::3] + 1j * at[8::3]
        throws = np.exp(1j * (self.phi + (SUN_HELD * at[0] + at[9::3]) / ARM))[:, None] * self.thrown
        centres = ECCENTRICITY * np.exp(1j * self.phi) * np.array([1, -1]) + at[1:7:3] + 1j * at[2:7:3]
        holes = centres[:, None] + np.exp(1j * (self.chi + at[3:7:3] / ARM))[:, None] * self.bored
        bored = np.exp(1j * (self.chi + at[0] / ARM)) * (CRANK_CIRCLE * self.around + self.off)
        off = np.concatenate([(holes.T - axes[:, None] - throws).ravel(), axes - bored])
        return np.asarray(1e3 * off, dtype=np.complex128)

    def gaps(self, z: Array, works: NDArray[np.bool_]) -> Array:
        """Gaps of working pins of both discs [um]."""
        at, azimuths = z / 1e3, 2 * np.pi * np.arange(PINS) / PINS
        found: list[Array] = []
        for disc in range(2):
            x, y, turn = at[1 + 3 * disc : 4 + 3 * disc]
            throw, own = self.phi + np.pi * disc, works[disc]
            seen = self.pins[own] - ECCENTRICITY * np.exp(1j * throw) - x - 1j * y
            u = (azimuths + throw / LOBES)[own]
            lobe = np.floor(u * LOBES / (2 * np.pi)).astype(int) % LOBES
            pitch = self.lobe_pitch[disc, lobe] * PINS / (LOBES * CIRCLE)
            seen = seen * np.exp(-1j * (self.chi + turn / ARM - np.pi * disc / LOBES + pitch))
            for _ in range(8):
                round_, wave = (CIRCLE + SHIFT) * np.exp(1j * u), ECCENTRICITY * np.exp(1j * PINS * u)
                slope, bend = 1j * (round_ - PINS * wave), -(round_ - PINS * PINS * wave)
                off = seen - round_ + wave
                u = u + (off * np.conj(slope)).real / (abs(slope) ** 2 - (off * np.conj(bend)).real)
            away = (off * np.conj(-1j * slope / abs(slope))).real
            found.append(away + OFFSET - self.lobe_profile[disc, lobe])
        return 1e3 * np.concatenate(found)

    def working(self, sense: float) -> NDArray[np.bool_]:
        """Which pins work (2, pins), where the planet that holds first has the cranks."""
        room = self.flanks(np.zeros(16))
        held = max(-room[:CRANKS]) if sense > 0 else min(room[CRANKS:])
        phi = self.phi + held / 1e3 / ARM * LOBES / (LOBES + SUN_HELD)
        phase = 2 * np.pi * np.arange(PINS) / PINS - phi - np.pi * np.arange(2)[:, None]
        k = ECCENTRICITY * PINS / CIRCLE
        return np.asarray(sense * np.sin(phase) / np.sqrt(1 + k * k - 2 * k * np.cos(phase)) > WINDOW)

    @cached_property
    def _eight(self) -> list[tuple[int, complex]]:
        return [(b, complex(np.exp(1j * t))) for b in range(len(self.radial)) for t in 2 * np.pi * np.arange(8) / 8]

    def turned(self, sense: float, fresh: tuple[int, ...] = (0, 2, 5, 10)) -> float:
        """The output's turn [rad]: linear programmes with differences for slopes and tangents to circles.

        Args:
            sense: of the torque.
            fresh: steps that take new slopes of pins and planets.
        """
        z, eye, works, tangents = np.zeros(16), np.eye(16), self.working(sense), list(self._eight)

        def straight(at: Array) -> Array:
            return np.concatenate([self.gaps(at, works), self.flanks(at)])

        for step in range(60):
            if step in fresh:
                by_gap = np.stack([straight(z + d) - straight(z - d) for d in eye], axis=-1) / 2
                by_joint = np.stack([self.joined(z + d) - self.joined(z - d) for d in eye], axis=-1) / 2
            joints, across = self.joined(z), np.array([np.conj(direction) for _, direction in tangents])
            at = [b for b, _ in tangents]
            near = 1000 * 0.4 ** max(0, step - 4)  # so that idle bodies come to rest
            given = linprog(
                -sense * eye[0],
                np.concatenate([-by_gap, (across[:, None] * by_joint[at]).real]),
                np.concatenate([straight(z), self.radial[at] - (across * joints[at]).real]),
                bounds=np.stack([np.maximum(-2000 - z, -near), np.minimum(2000 - z, near)], axis=-1),
                method="highs",
                options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
            )
            assert given.status == 0
            z = z + given.x
            joints = self.joined(z)
            far = abs(joints)
            tangents.extend((int(b), complex(joints[b] / far[b])) for b in np.flatnonzero(far > self.radial + 1e-7))
            if abs(given.x[0]) < 1e-6 and (far <= self.radial + 1e-6).all() and straight(z).min() > -1e-6:
                break
        return float(z[0] / 1e3 / ARM)
