"""The least growth of cones about some offsets at which these and a room of gauges have a place in common.

A growth w is enough where |p_e + P_e q| <= w + r_e of the offsets and the cones of the room have a common q. Their
largest common slack is concave in w and grows with it: Newton's steps from below, by the share of the offsets in its
multipliers, never pass the least w.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.contact.programme import Programme
from tol3d.numerics.arrays import Array

Mask = NDArray[np.bool_]

STEPS: Final = 60
"""Newton steps at most; in practice 2 to 8."""
SHORT: Final = 1e-12
"""Step [mm] at which they are done."""
FREE: Final = 1e-9
"""Share of the ends below which the clearance alone decides: it is empty."""
SPARE: Final = 1e-11
"""Clearance [mm] that what is least at the limit of a room leaves to what is asked next, more than rounding."""
UNSEEN: Final = 1e-6
"""Change of an end's offset per unit freedom that counts as none."""


def least_growth(
    offsets: Array,
    radii: Array,
    rows: Array,
    its: Array,
    room: Array,
    its_rows: Array,
    trials_asked: Mask | None = None,
) -> tuple[Array, Array]:
    """The least w (n,) [mm], NaN where the room is empty, and the steps to it (freedoms, n).

    Args:
        offsets: p_e (ends, 2, n) [mm].
        radii: r_e (ends, n) [mm].
        rows: P_e (ends, 2, freedoms).
        its: offsets of the room (cones, 2, n) [mm].
        room: its clearances (cones, n) [mm].
        its_rows: their change (cones, 2, freedoms).
        trials_asked: for which trials (n,); all by default.
    """
    ends, trials = len(offsets), offsets.shape[2]
    if not rows.shape[2]:
        return (np.sqrt((offsets * offsets).sum(axis=1)) - radii).max(axis=0), np.zeros((0, trials))
    every_row, every = np.concatenate([rows, its_rows])[..., None], np.concatenate([offsets, its])
    clearances = np.concatenate([np.zeros((ends, trials)), room])
    still = np.abs(rows).max(axis=(1, 2)) < UNSEEN
    nearest = np.sqrt((offsets * offsets).sum(axis=1)) * still[:, None]
    least, programme = (nearest - radii).max(axis=0), Programme.of(len(every), rows.shape[2], trials)
    asked = np.ones(trials, bool) if trials_asked is None else trials_asked
    for _ in range(STEPS):
        clearances[:ends] = radii + least
        programme.solve(every, clearances, every_row, asked=asked)
        share = np.asarray(sum(programme.multipliers[:ends]))
        short = np.where(programme.slack < 0.0, -programme.slack, 0.0)
        empty = asked & (~programme.found | ((short > SHORT) & ~(share > FREE)))
        least = np.where(empty, np.nan, least)
        grown = short / np.where(share > FREE, share, 1.0)
        least = np.where(asked & ~empty, least + grown, least)
        asked = asked & ~empty & (grown > SHORT)
        if not asked.any():
            break
    return least, np.where(np.isfinite(least), programme.steps, 0.0)


def centred(offsets: Array, clearances: Array, rows: Array, asked: Mask) -> tuple[Array, Array]:
    """Steps (freedoms, n) to the middle of a room, and its least slack there (n,) [mm], negative where it is empty.

    Args:
        offsets: o_k (cones, 2, n) [mm].
        clearances: c_k (cones, n) [mm].
        rows: B_k (cones, 2, freedoms).
        asked: for which trials (n,).
    """
    programme = Programme.of(len(rows), rows.shape[2], clearances.shape[1])
    programme.solve(offsets, clearances, rows[..., None], asked=asked)
    return programme.steps, programme.slack
