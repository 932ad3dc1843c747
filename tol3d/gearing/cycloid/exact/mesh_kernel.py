"""Turns of planets until their flanks touch the sun's, gears as they lie, compiled over trials and positions.

With W from the sun's centre to the planet's, |W| = a', cos alpha' = R/a', R = r_b1 + r_b2, gamma the azimuth of W, a
planet turns until the flank sigma of the sun touches its own by

    r_b2 beta = R gamma + sigma (room - R (inv alpha' - inv alpha_w)),

room half of what thicker teeth take along the line of action less half of the nominal backlash: exact for rigid
involutes on parallel axes. W itself turns with the planet by its eccentricity.
"""

from typing import Any, Final, NamedTuple

import numpy as np

from tol3d.numerics.compiled import kernel
from tol3d.numerics.quick_angles import azimuth, turned_by

ROUNDS: Final = 2
"""Iterations of a planet's turn; each multiplies the error by its eccentricity over its base radius."""


class MeshShape(NamedTuple):
    """Nominal numbers of sun and planet [mm].

    Attributes:
        distance: of their centres.
        base_radii: R.
        wheel_base_radius: r_b2.
        tan: of the working pressure angle.
        ratio: turns of the sun a turn of the planet.
        flank: of the sun, 1 or -1.
    """

    distance: float
    base_radii: float
    wheel_base_radius: float
    tan: float
    ratio: float
    flank: float


@kernel(
    MeshShape,
    arrays="f8[:,:,::1], f8[:,:,::1], f8[:,::1], f8[:,::1], f8[:,::1], f8[::1], f8[:,::1], f8[:,::1]",
)
def planet_turns(
    shape: Any, suns: Any, planets: Any, sun_offset: Any, planet_offset: Any, lies: Any, room: Any, carried: Any,
    turns: Any,
) -> None:  # fmt: skip
    """Turns of one planet beyond where teeth without backlash would have it.

    Args:
        suns, planets: cosine and sine of the gears' nominal turns in the frame of their mesh (trials, positions, 2), or
            (1, positions, 2) that are those of every trial.
        sun_offset, planet_offset: of the gears' centres off their axes, in their own frames (trials, 2) [mm].
        lies: offset of the planet's axis from its place, in the frame of the mesh (trials, 2) [mm].
        room: see above (trials,) [mm].
        carried: turn of the carrier beyond its place (trials, positions), while the sun stands [rad].
        turns: (trials, positions) [rad]; written.
    """
    for i in range(turns.shape[0]):
        row = min(i, suns.shape[0] - 1)
        for p in range(turns.shape[1]):
            c, s = turned_by(suns[row, p, 0], suns[row, p, 1], -carried[i, p])
            out = shape.distance + lies[i, 0] - (c * sun_offset[i, 0] - s * sun_offset[i, 1])
            aside = lies[i, 1] - (s * sun_offset[i, 0] + c * sun_offset[i, 1])
            c, s = turned_by(planets[row, p, 0], planets[row, p, 1], carried[i, p] / shape.ratio)
            off_x = c * planet_offset[i, 0] - s * planet_offset[i, 1]
            off_y = s * planet_offset[i, 0] + c * planet_offset[i, 1]
            turn = 0.0
            for _ in range(ROUNDS):
                x, y = turned_by(off_x, off_y, turn)
                x, y = x + out, y + aside
                tan = np.sqrt(max(x * x + y * y - shape.base_radii * shape.base_radii, 0.0)) / shape.base_radii
                more = tan - shape.tan
                involute = more - azimuth(more, 1.0 + tan * shape.tan)  # inv alpha' - inv alpha_w
                turn = shape.base_radii * azimuth(y, x) + shape.flank * (room[i] - shape.base_radii * involute)
                turn /= shape.wheel_base_radius
            turns[i, p] = turn
