"""The drive of two spherical gears by its closed formulas: two nuts push a ring that swings about a centre.

Source: Pan, Wen, "Planetary transmission type of spherical gear and its driving mechanisms", J. National University of
Defense Technology 26(3), 2004, 93-98; with its slips of signs put right.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RADIUS, ROD, HALF = 80.0, 260.0, np.radians(30.0)  # mm, mm, half of the angle between both rods

TABLE = (
    # tilt, azimuth [deg], travels of both nuts [cm]
    (10, 0, 0.694664, -0.694552),
    (10, 30, 0.0, -1.202857),
    (10, 60, -0.694552, -1.388901),
    (10, 90, -1.202857, -1.202857),
    (20, 10, 0.936346, -1.756921),
    (20, 20, 0.475264, -2.093394),
    (20, 40, -0.474994, -2.567197),
    (20, 80, -2.093393, -2.567198),
    (40, 25, 0.448693, -4.167083),
    (40, 45, -1.326412, -4.904151),
    (40, 75, -3.602451, -4.904151),
)
"""Table 1 as printed: -0.694552 stands twice for -0.694522."""
MISPRINT, MEANT = -0.694552, -0.694522


def travels(tilt: float, azimuth: float) -> Array:
    """Travels of both nuts (2,) [mm], for a tilt towards an azimuth [rad]."""
    s = np.array([np.sin(HALF - azimuth), -np.sin(HALF + azimuth)])
    return np.asarray(RADIUS * np.sin(tilt) * s + ROD - np.sqrt(ROD**2 - (RADIUS * (1 - np.cos(tilt)) * s) ** 2))


def rates(tilt: float, azimuth: float) -> Array:
    """Rates of both travels [mm/rad]: by the tilt, then by the azimuth (2, 2)."""
    s = np.array([np.sin(HALF - azimuth), -np.sin(HALF + azimuth)])
    by_azimuth = np.array([-np.cos(HALF - azimuth), -np.cos(HALF + azimuth)])
    off = RADIUS * (1 - np.cos(tilt)) * s
    root = np.sqrt(ROD**2 - off**2)
    first = RADIUS * np.cos(tilt) * s + off * RADIUS * np.sin(tilt) * s / root
    second = (RADIUS * np.sin(tilt) + off * RADIUS * (1 - np.cos(tilt)) / root) * by_azimuth
    return np.stack([first, second])
