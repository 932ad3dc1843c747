"""Where in the room of its gauges a part lies, from its centred pose."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Engage

Array = NDArray[np.float64]

ROUNDS: Final = 12
"""How often a pose is corrected; each time leaves a turn's share, 1e-3 or less, of what it corrects."""
MET: Final = 3e-8
"""Step [mm] after which a trial is done."""
LOST: Final = 1e-6
"""Step [mm] at which it is not found, if that is still left after all rounds."""


@dataclass(frozen=True, eq=False)
class GaugeFloats:
    """Of the move that gauges make.

    Args:
        move: which.
        freedoms: (6, freedoms), orthonormal.
        push: the direction in which the part goes as far as it can (freedoms,); 0 where it does not.
    """

    move: Engage
    freedoms: Array
    push: Array

    def steps(
        self, offsets: Array, clearances: Array, rows: Array, centred: Array, slacks: Array, columns: Array
    ) -> Array:
        """Steps (freedoms, n) from offsets o_k to where the part lies.

        Args:
            offsets, clearances, rows: o_k (cones, 2, n), c_k (cones, n) [mm], B_k (cones, 2, freedoms).
            centred: steps to the centred pose (freedoms, n), or as far as it goes along `push`.
            slacks: of the centred pose (n,) [mm].
            columns: the deviations (width, n).
        """
        floating = self.move.floating
        if floating.kind != "random":
            return centred
        drawn = columns[floating.columns]
        along = np.stack([sum(self.freedoms[r, f] * drawn[r] for r in range(6)) for f in range(len(centred))])
        size = np.sqrt(sum(own * own for own in along))
        along = along / np.where(size > 0.0, size, 1.0)
        way = self._way(offsets, clearances, rows, centred, along)
        share = drawn[6] ** (1.0 / len(centred)) * way
        return np.asarray(centred + np.where((slacks > 0.0) & (size > 0.0), share, 0.0) * along)

    def _way(self, offsets: Array, clearances: Array, rows: Array, centred: Array, along: Array) -> Array:
        """How far the room goes from the centred pose (n,) [mm]."""
        way = np.full(offsets.shape[2], np.inf)
        for own, clearance, row in zip(offsets, clearances, rows, strict=True):
            at = [own[r] + sum(row[r, f] * centred[f] for f in range(len(centred))) for r in (0, 1)]
            gone = [sum(row[r, f] * along[f] for f in range(len(centred))) for r in (0, 1)]
            # |at + t gone| = clearance
            square = gone[0] * gone[0] + gone[1] * gone[1]
            slope = at[0] * gone[0] + at[1] * gone[1]
            room = clearance * clearance - at[0] * at[0] - at[1] * at[1]
            root = np.sqrt(np.maximum(slope * slope + square * room, 0.0))
            away = slope > 0.0
            ahead = np.where(away, room, root - slope) / np.where(
                away, slope + root, np.where(square > 0.0, square, 1.0)
            )
            way = np.where(square > 0.0, np.minimum(way, np.maximum(ahead, 0.0)), way)
        return np.where(np.isfinite(way), way, 0.0)
