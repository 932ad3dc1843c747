"""Motions of a part and its bolts within clearances, solved for many trials and followed from pose to pose."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.contact.rooms import rooms_solved
from tol3d.numerics.arrays import Array, Places

ALL: Final = 1 << 40
"""Rounds of centring: as many as there are."""
STEPS: Final = 60
"""Newton steps of a growth at most; in practice 2 to 8."""
SHORT: Final = 1e-12
"""Step [mm] at which they are done."""
FREE: Final = 1e-9
"""Share of what grows in the slack's multipliers, below which the room alone decides: it is empty."""
UNSEEN: Final = 1e-6
"""Change of an offset per unit freedom that counts as none."""
SPARE: Final = 1e-11
"""Clearance [mm] that a least growth leaves to what is asked next at the limit of its room, more than rounding."""


@dataclass(frozen=True, eq=False)
class Programme:
    """Solutions of trials, from pose to pose: each begins with the places that decided at the trial's pose before.

    Args:
        steps: q (unknowns, n) [mm]; NaN where it is not found.
        slack: the least one of the centred q (n,) [mm].
        tightest: a place that has it (n,).
        left: number of the part's freedoms that the first round leaves open, or the push (n,).
        found: trials whose q is found (n,).
        duals: z_k = m (1, -u) of the places that decided, u along their offset; of one that decides alone, without a
            direction, a shorter u (places, 3, n). Those of a round balance, and sum to 1 in their first component.
        rounds: in which one they decided, from 1; of a push and what is centred after it from -1 down; 0 for none
            (places, n).
    """

    steps: Array
    slack: Array
    tightest: Places
    left: Places
    found: NDArray[np.bool_]
    duals: Array
    rounds: Places

    @classmethod
    def of(cls, places: int, unknowns: int, trials: int) -> "Programme":
        """Nothing solved yet, without steps and slack."""
        none = np.zeros(trials, dtype=np.int64)
        return cls(
            np.zeros((unknowns, trials)), np.zeros(trials), none, none.copy(), np.ones(trials, dtype=np.bool_),
            np.zeros((places, 3, trials)), np.zeros((places, trials), dtype=np.int64),
        )  # fmt: skip

    def copied(self) -> "Programme":
        """The same in arrays of its own."""
        return Programme(*(own.copy() for own in vars(self).values()))

    def solve(
        self, offsets: Array, clearances: Array, rows: Array, *, goal: Array | None = None, parts: int | None = None,
        asked: NDArray[np.bool_] | None = None, trials: Places | None = None, rounds: int = ALL,
    ) -> None:  # fmt: skip
        """Change all arrays to those of some trials' next pose.

        Args:
            offsets: o_k (places, 2, trials) [mm]; this and all others of these trials alone, or of all where some are
                asked for by a mask.
            clearances: c_k (places, trials) [mm].
            rows: B_k (places, 2, unknowns, trials), or (…, 1) where trials share them.
            goal: direction of the unknowns in which they go to the limit (unknowns, trials) or (unknowns, 1); 0 by
                default, for the centred pose.
            parts: number of the first unknowns that are the part's; all by default. The others are centred as long as
                those move.
            asked: mask of the trials; all by default. The others are left.
            trials: or their numbers.
            rounds: of centring, at most.
        """
        unknowns, goal = rows.shape[2], np.zeros((rows.shape[2], 1)) if goal is None else goal
        if asked is not None and not asked.all():
            trials, every = np.flatnonzero(asked), (offsets, clearances, rows, goal)
            offsets, clearances, rows, goal = (
                np.take(own, trials, axis=-1) if own.shape[-1] == len(asked) else own for own in every
            )
        rooms_solved(
            np.arange(len(self.slack)) if trials is None else trials, np.ascontiguousarray(offsets),
            np.ascontiguousarray(clearances), np.ascontiguousarray(rows), np.ascontiguousarray(goal),
            unknowns if parts is None else parts, rounds, self.steps, self.slack, self.tightest, self.left, self.found,
            self.duals, self.rounds,
        )  # fmt: skip

    @property
    def multipliers(self) -> Array:
        """Shares of the places in the first round's slack, which sum to 1 (places, n)."""
        return np.where(self.rounds == 1, self.duals[:, 0], 0.0)


def least_growth(
    offsets: Array, clearances: Array, rows: Array, grown: int, asked: NDArray[np.bool_] | None = None,
    rounds: int = ALL,
) -> tuple[Array, Array, NDArray[np.bool_]]:  # fmt: skip
    """The least w (n,) [mm] by which the first clearances grow until all places are open at once, and steps to there.

    The largest common slack is concave in w and grows with it: Newton's steps from below, by the share of what grows in
    its multipliers, never pass the least w. Where the others have no place in common, told last (n,), steps are to
    where they lack least.

    Args:
        offsets: o_k (places, 2, n) [mm].
        clearances: c_k (places, n) [mm], of either sign.
        rows: B_k (places, 2, unknowns).
        grown: number of the places that grow, the first.
        asked: mask of the trials; all by default. The others are left.
        rounds: of centring, at most, which settle what the places that decide w leave open of the steps.
    """
    trials, seen = offsets.shape[2], np.abs(rows).max(axis=(1, 2), initial=0.0) > UNSEEN
    lacking = np.sqrt((offsets * offsets).sum(axis=1)) - clearances
    least = np.where(seen[:grown, None], -clearances[:grown], lacking[:grown]).max(axis=0)
    empty = lacking[grown:][~seen[grown:]].max(axis=0, initial=-np.inf) > SHORT
    offsets, limits, its_rows, own = offsets[seen], clearances[seen], rows[seen][..., None], int(seen[:grown].sum())
    programme = Programme.of(len(offsets), rows.shape[2], trials)
    going = np.flatnonzero(np.full(trials, seen.any()) if asked is None else asked & seen.any())
    for _ in range(STEPS):
        if not len(going):
            break
        wider = limits[:, going]
        wider[:own] += least[going]
        programme.solve(offsets[..., going], wider, its_rows, trials=going, rounds=rounds)
        share, short = programme.multipliers[:own, going].sum(axis=0), -programme.slack[going]
        grows = share > FREE
        empty[going] |= ~programme.found[going] | (~grows & (short > SHORT))
        step = np.where(grows & (short > 0.0), short / np.where(grows, share, 1.0), 0.0)
        least[going] += step
        going = going[step > SHORT]
    return least, np.where(programme.found, programme.steps, 0.0), empty
