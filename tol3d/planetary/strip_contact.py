"""Sets that are seated by the gaps that FCL finds: the programme goes on with them until nothing moves."""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.programme import OK, STALLED, ranges
from tol3d.planetary.deviated import Deviated
from tol3d.planetary.free import Followed, Free
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.shown import Made, placed_gears
from tol3d.planetary.strip_gaps import StripGaps

Array = NDArray[np.float64]

LAST_MOVE: Final = 1e-4  # mm along the base circles; slopes are known to some thousandths, so 1e-7 mm are left
MOST_STEPS: Final = 25


@dataclass(frozen=True, eq=False)
class StripContact:
    """How far shafts turn by FCL's gaps, with slopes of the first order; see Contact.

    Args:
        own: the set.
        made: its gears by name, nominal.
        engine: their gaps.
    """

    own: PlanetarySet
    made: Made
    engine: StripGaps

    def free(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> Free:
        """How far a shaft turns while another one and the held one stand, at turns (trials,) of the output."""
        found = Free.of(len(turns))
        for trial, own in enumerate(_each(deviated)):
            for end in (0, 1):
                begun = np.zeros(self.own.all_rows.shape[1])
                at, status, row, lacking = self._seated(own, float(turns[trial]), (shaft, stands, end), begun)
                found.ends[trial, end] = at[self.own.shafts.index(shaft)]
                found.status[trial], found.row[trial], found.lacking[trial] = status, row, lacking
                if status != OK:
                    found.ends[trial] = np.nan
                    break
        return found

    def followed(self, deviated: Deviated, turns: Array, shaft: str, stands: str, end: int) -> Followed:
        """The lower (0) or upper (1) end of that at turns (positions,) of the output that all trials share."""
        found = Followed.of(len(deviated.pins), len(turns))
        found.status[:], found.row[:], found.lacking[:] = OK, -1, 0.0
        for trial, own in enumerate(_each(deviated)):
            at = np.zeros(self.own.all_rows.shape[1])
            for position, turn in enumerate(turns.tolist()):
                at, status, row, lacking = self._seated(own, turn, (shaft, stands, end), at)
                if status == OK:
                    found.ends[trial, position] = at[self.own.shafts.index(shaft)]
                else:
                    found.ends[trial] = 0.0
                    found.status[trial], found.row[trial], found.lacking[trial] = status, row, lacking
                    break
        return found

    def _seated(
        self, deviated: Deviated, turns: float, asked: tuple[str, str, int], begun_at: Array
    ) -> tuple[Array, int, int, float]:
        """Turns [rad] and displacements by springs [mm] at an end, what became of the set, and where it lacks room.

        Args:
            deviated: of one trial.
            turns: of the output.
            asked: which shaft turns, which one stands, and to which end.
            begun_at: turns and displacements to begin with.
        """
        own, (shaft, stands, end) = self.own, asked
        at = begun_at.copy()
        unknowns = list(own.unknowns(stands))
        rows, wanted, begun = own.rows(stands), own.wanted(stands, shaft), own.begun(stands)
        of_springs = slice(len(at) - len(own.springs), None)
        arms = np.abs(own.all_rows[:, unknowns]).max(axis=0)
        readouts = np.eye(len(unknowns))
        for _ in range(MOST_STEPS):
            gaps = self.engine.gaps(placed_gears(own, self.made, deviated, turns, at))
            least, most = (push - at[of_springs] for push in own.pushed)
            lower = np.concatenate([-gaps[..., 0].ravel(), least])[None]
            upper = np.concatenate([gaps[..., 1].ravel(), most])[None]
            step = np.empty(len(unknowns))
            for place, readout in enumerate(readouts):
                free = Free.of(1)
                ranges(rows, lower, upper, readout, wanted, begun, free.ends, free.status, free.row, free.lacking)
                if free.status[0] != OK:
                    return at, int(free.status[0]), int(free.row[0]), float(free.lacking[0])
                step[place] = free.ends[0, end]
            at[unknowns] += step
            if (np.abs(step) * arms).max() < LAST_MOVE:
                return at, OK, -1, 0.0
        return at, STALLED, -1, 0.0


def _each(deviated: Deviated) -> Iterator[Deviated]:
    """The trials one by one."""
    for trial in range(len(deviated.pins)):
        yield Deviated(*(getattr(deviated, own.name)[trial : trial + 1] for own in fields(deviated)))
