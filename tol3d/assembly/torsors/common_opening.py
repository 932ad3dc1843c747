"""The largest circle in several discs, as terms: alone, at the best turn of the discs, and as some of them grow."""

from dataclasses import dataclass

import numpy as np

from tol3d.assembly.torsors.terms import Form
from tol3d.contact.openings import LEAST, least_in_rooms, least_over_turns, opening
from tol3d.numerics.arrays import Array, Places


@dataclass(frozen=True, eq=False)
class CommonOpening:
    """The diameter of the largest circle that lies in all discs.

    Args:
        forms: (discs * 3, columns): x, y and radius of each disc.
    """

    forms: Array
    form: Form = "largest inscribed circle"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (discs * 3, trials)."""
        return -2.0 * opening(read[::3], read[1::3], read[2::3]).outside[None]


@dataclass(frozen=True, eq=False)
class TurnedOpening:
    """The diameter of the largest circle in all discs, with the best common turn of their centres; concave in that.

    Args:
        forms: as of CommonOpening.
        arms: how the centres move with the turn (discs, 2) [mm].
    """

    forms: Array
    arms: Array
    form: Form = "largest inscribed circle"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (discs * 3, trials)."""
        x, y, radii = read[::3], read[1::3], read[2::3]
        by_x, by_y = -self.arms.T[..., None]

        def turned(trials: Places, turn: Array) -> Array:
            found = opening(x[:, trials] + by_x * turn, y[:, trials] + by_y * turn, radii[:, trials])
            return np.stack([turn, found.outside, found.slope(by_x + 0.0 * turn, by_y + 0.0 * turn)])

        off = np.maximum(np.abs(x), np.abs(y)).max(axis=0)
        reach = float(np.sqrt((self.arms**2).sum(axis=1)).max()) or 1.0
        return -2.0 * least_over_turns(turned, 0.25 * off / reach + LEAST)[None]


@dataclass(frozen=True, eq=False)
class LeastInRoom:
    """Twice the least by which discs about places grow until all discs have a point in common.

    Where the room is empty: what they need in its middle.

    Args:
        forms: (discs * 3, columns): x, y and radius, of the places, then of the room.
        places: how many of them are places.
    """

    forms: Array
    places: int
    form: Form = "least in a room"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (discs * 3, trials)."""
        x, y, radii = read[::3], read[1::3], read[2::3]
        least = least_in_rooms(x, y, radii, self.places)
        own = slice(0, self.places)
        far = np.hypot(x[own] - x[self.places :].mean(axis=0), y[own] - y[self.places :].mean(axis=0)) - radii[own]
        return 2.0 * np.where(np.isnan(least), far.max(axis=0), least)[None]
