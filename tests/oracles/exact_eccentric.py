"""Normal backlash of a parallel-axis spur pair with eccentric gears, in closed form.

A gear that turns with its centre off the axis is, at any instant, an ordinary gear about its own centre:
j = 2 (r_b1 + r_b2)(inv alpha_w' - inv alpha) - (sum of tooth thicknesses - pi m) cos alpha,
cos alpha_w' = (r_b1 + r_b2)/|C2 - C1|. Source: ISO 21771-1:2024, 5.6, at the centres' distance.
"""

import numpy as np

from oracles.involute_gear import InvoluteGear
from tol3d.gears.flank import Flank

TURN_ROUNDS = 6  # the wheel's turn moves its centre by e2 j/r, 1e-5 of it; each round gains that factor
AZIMUTH_ROUNDS = 6  # of e/a each, 1e-2 for the smallest gears: 1e-12 of 0.1 mm


def normal_backlash(
    pinion: InvoluteGear,
    wheel: InvoluteGear,
    thickness: np.ndarray,
    axis: np.ndarray,
    centres: tuple[np.ndarray, np.ndarray],
    driver_angle: np.ndarray,
    working_flank: Flank,
) -> np.ndarray:
    """j_n [mm], (n,), with the wheel turned onto the working flank.

    Args:
        thickness: (n,) [mm], sum of both gears' thickness deviations.
        axis: (n, 2) [mm], from the pinion's axis to the wheel's.
        centres: (n, 2) of the pinion and of the wheel [mm], each in its gear's frame.
        driver_angle: (n,) [rad].
        working_flank: sigma of the pinion's.
    """
    alpha, base = pinion.pressure_angle, pinion.base_radius + wheel.base_radius
    arcs = [gear.thickness(gear.reference_radius) for gear in (pinion, wheel)]
    nominal = arcs[0] + arcs[1] - np.pi * pinion.module
    ratio = pinion.teeth / wheel.teeth
    free = np.zeros_like(driver_angle)
    for _ in range(TURN_ROUNDS):
        line = axis.copy()
        azimuth = np.zeros_like(driver_angle)
        for _ in range(AZIMUTH_ROUNDS):  # the azimuth of the line of centres and the wheel's turn depend on each other
            wheel_angle = azimuth + np.pi + wheel.pitch / 2 - ratio * (driver_angle - azimuth)
            wheel_angle = wheel_angle - working_flank * free / (2 * wheel.base_radius)
            line = axis + turned(centres[1], wheel_angle) - turned(centres[0], driver_angle)
            azimuth = np.arctan2(line[:, 1], line[:, 0])
        working = np.arccos(base / np.hypot(line[:, 0], line[:, 1]))
        lean = (np.tan(working) - working) - (np.tan(alpha) - alpha)
        free = 2 * base * lean - (nominal + thickness) * np.cos(alpha)
    return free


def turned(vectors: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Plane vectors (n, 2) turned by angles (n,)."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([cos * vectors[:, 0] - sin * vectors[:, 1], sin * vectors[:, 0] + cos * vectors[:, 1]], axis=1)
