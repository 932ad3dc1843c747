"""The spherical involute by rolling a plane on a cone step by step: an ODE that knows only the rolling.

The plane touches the cone along one of its lines and turns about that line; nothing in it slips. Unit sphere.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from oracles.brute_force import zoomed_minimum

ODE = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}
TABLE = 4001  # places of a spline through the rolled line, 0.8 mrad apart: to the fourth power 4e-13
FLANK_IN_USE = 0.9  # of the pressure angle; the line turns back on the base cone, at that angle off the pitch plane
GRID = (201, 9)  # points, zooms: 100^9 times finer than the range, down to the spacing of doubles
CUT_AWAY = 1e-10  # rad; a flank this far inside the endless rack's has been undercut
POLAR_XTOL = 1e-10  # rad


def drawn_directions(base_angle: float, rolls: np.ndarray, sense: int = 1) -> np.ndarray:
    """Directions of the line that began on the cone at azimuth 0 after the plane has rolled, (n, 3).

    Args:
        base_angle: between axis and cone [rad].
        rolls: turns of the touching line about the axis [rad], ascending from 0.
        sense: +1 rolls counter-clockwise about z, -1 clockwise.
    """

    def turning(roll: float, direction: np.ndarray) -> np.ndarray:
        azimuth = sense * roll
        touching = [math.sin(base_angle) * math.cos(azimuth), math.sin(base_angle) * math.sin(azimuth)]
        # the plane's normal leans over by cos(base) for each radian of azimuth
        return sense * math.cos(base_angle) * np.cross([*touching, math.cos(base_angle)], direction)

    start = [math.sin(base_angle), 0.0, math.cos(base_angle)]
    return solve_ivp(turning, (0.0, float(rolls[-1])), start, t_eval=rolls, **ODE).y.T


class CrownRack:
    """A crown gear, its flanks drawn on a base cone of 90 deg less the pressure angle, that cuts a bevel gear.

    The gear's pitch cone rolls on the crown gear's pitch plane. Gear frame as ever; the flank here is the one on the
    high-azimuth side, and azimuths count from where it crosses the pitch cone.
    """

    def __init__(self, pitch_angle: float, pressure_angle: float, depth: float = math.inf) -> None:
        """`depth` [rad]: where the crown gear's flank ends below its pitch plane (infinite: nowhere)."""
        self._pitch_angle, self._pressure_angle, self._depth = pitch_angle, pressure_angle, depth
        base = math.pi / 2 - pressure_angle
        x, y, z = drawn_directions(base, np.linspace(0.0, 0.97 * math.pi / math.sin(base), TABLE)).T
        polar = np.arctan2(np.hypot(x, y), z)
        self._gained = CubicSpline(polar, np.unwrap(np.arctan2(y, x)))

    def flank_azimuth(self, polar: float) -> float:
        """Azimuth [rad] of the flank that is left at a polar angle.

        A place of the gear at world azimuth w lies at a depth below the pitch plane and at a crown azimuth. The
        crown gear's flank passes it when the crown gear has turned by that azimuth less the flank's own at that
        depth, and the gear by 1/sin(pitch angle) times as much. The smallest azimuth of all is left.
        """
        sin, cos = math.sin(self._pitch_angle), math.cos(self._pitch_angle)

        def cut_azimuth(world: np.ndarray) -> np.ndarray:
            x, y, z = math.sin(polar) * np.cos(world), math.sin(polar) * np.sin(world), math.cos(polar)
            along, below = x * sin + z * cos, z * sin - x * cos
            crown, below = np.arctan2(y, along), np.arctan2(below, np.hypot(along, y))
            inside = (below <= self._depth + 1e-14) & (np.abs(below) < FLANK_IN_USE * self._pressure_angle)
            flank = self._gained(math.pi / 2 + np.where(inside, below, 0.0)) - self._gained(math.pi / 2)
            return np.where(inside, world - (crown - flank) / sin, np.inf)

        if math.isinf(self._depth):
            # the plane of action touches the base cone at this azimuth; beyond it lies the flank's other branch
            base = math.asin(sin * math.cos(self._pressure_angle))
            touching = math.acos(math.tan(base) * cos / sin)
            low, high = -touching, math.pi / 2 - touching
        else:
            # out to where the gear's place is as deep as the corner
            high = math.acos(min(1.0, (math.cos(polar) * sin - math.sin(self._depth)) / (math.sin(polar) * cos)))
            low = -high
        return float(zoomed_minimum(cut_azimuth, np.array([low]), np.array([high]), GRID)[0])

    def undercut_angle(self, tip_angle: float) -> float:
        """Largest polar angle [rad] at which the corner has cut below the flank that an endless rack would leave."""
        endless = CrownRack(self._pitch_angle, self._pressure_angle)
        low, high = math.asin(math.sin(self._pitch_angle) * math.cos(self._pressure_angle)), tip_angle
        while high - low > POLAR_XTOL:
            middle = (low + high) / 2
            cut = self.flank_azimuth(middle) < endless.flank_azimuth(middle) - CUT_AWAY
            low, high = (middle, high) if cut else (low, middle)
        return low
