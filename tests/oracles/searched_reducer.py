"""An RV reducer from the columns of a run alone: discs among pins by search, planets on the sun by the line of action.

What each column does is read off its name here, and shares nothing with what drew it.
"""

import cmath
import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from oracles.placed_discs import PlacedDiscs

Array = NDArray[np.float64]
Read = Callable[[str], float]

TEETH = (21, 42)
MODULE, PRESSURE_ANGLE = 2.0, math.radians(20)
CRANK_CIRCLE, PINS, LOBES = 63.0, 40, 39
GROUND = (114.48, 5.0 - 0.012795, 0.0)  # circle and radius that the discs are ground for


class LedDiscs(PlacedDiscs):
    """Discs whose cranks lead by an angle."""

    lead = 0.0

    def pose(self, disc: int, phi: float, turn: float) -> tuple[complex, float]:
        phases = self.own["crank_phases"]
        self.own["crank_phases"] = phases + self.lead
        try:
            return super().pose(disc, phi, turn)
        finally:
            self.own["crank_phases"] = phases


def deviations(of: Read) -> dict[str, Array]:
    """Fields of PlacedDiscs from columns [mm]."""
    discs = range(1, 3)
    along = [of(f"pin pitch.pin {pin}") for pin in range(1, PINS + 1)]
    lobes = {
        name: np.array([[of(f"disc {name}.disc {disc} lobe {lobe}") for lobe in range(1, LOBES + 1)] for disc in discs])
        for name in ("pitch", "profile")
    }
    throws = np.array([[of(f"crank run-out.disc {disc} {axis}") for axis in "xy"] for disc in discs])
    return {
        "pins": np.stack([np.full(PINS, of("pin circle")), along], axis=-1),
        "pin_radii": np.zeros(PINS),
        "lobe_pitch": lobes["pitch"],
        "lobe_profile": lobes["profile"],
        "disc_offsets": np.array([[of(f"disc run-out.disc {disc} {axis}") for axis in "xy"] for disc in discs]),
        "disc_holes": np.zeros((2, 3, 2)),
        "crank_errors": np.broadcast_to(throws, (3, 2, 2)),
        "crank_phases": np.zeros(3),
        "carrier_holes": np.tile([of("carrier holes.x"), of("carrier holes.y")], (3, 1)),
        "carrier_offsets": np.array([of("main bearing run-out.x"), of("main bearing run-out.y")]),
    }


def lead(of: Read, position: float, sense: int) -> float:
    """Lead of cranks on planets that roll on the standing sun, beyond teeth without backlash [rad].

    Carriers that go back turn planets forwards. A planet's tooth that pushes the sun's clockwise does so along
    (-sin alpha, -cos alpha) of the frame in which the planet lies on x: what moves the planet against it opens the gap.
    """
    sun_turned = (1 + TEETH[1] / TEETH[0] * PINS) * position
    axis = complex(of("carrier holes.x"), of("carrier holes.y"))
    axis += complex(of("main bearing run-out.x"), of("main bearing run-out.y"))
    allowed = []
    for planet in range(3):
        arm = position + 2 * math.pi * planet / 3
        sun = sun_turned - arm
        turned = math.pi + math.pi / TEETH[1] - TEETH[0] / TEETH[1] * sun
        own = complex(*(of(f"planet run-out.planet {planet + 1} {axis}") for axis in "xy"))
        moved = axis * cmath.exp(1j * (position - arm)) + own * cmath.exp(1j * turned)
        moved -= complex(of("sun run-out.x"), of("sun run-out.y")) * cmath.exp(1j * sun)
        backlash = -(of("sun thinning") + of(f"planet thinning.planet {planet + 1}"))  # measured along the normal
        opened = moved.imag * math.cos(PRESSURE_ANGLE)
        opened -= sense * (moved.real * math.sin(PRESSURE_ANGLE) + backlash / 2)
        allowed.append(opened / (MODULE * TEETH[1] * math.cos(PRESSURE_ANGLE) / 2))
    return min(allowed) if sense < 0 else max(allowed)


def output_turn(of: Read, position: float, sense: int) -> tuple[float, int, int]:
    """Turn [rad] of the output, and disc and pin that touch, counted from 1; the sun stands.

    Args:
        of: a column of one trial, by its name without its unit [mm].
        position: nominal angle of the output [rad].
        sense: of the load that turns it.
    """
    build = LedDiscs((PINS, 114.5, 5.0, 2.2, CRANK_CIRCLE), GROUND, 1 + TEETH[0] / TEETH[1], deviations(of))
    build.lead = lead(of, position, sense)
    turn, place = build.first(-LOBES * position, sense, 0.7)
    return turn, place // PINS + 1, place % PINS + 1
