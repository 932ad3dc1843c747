"""Spectra of curves: amplitudes of harmonics, trial by trial, pooled over the trials; a measure asks for its own."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final, Self

import numpy as np

from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.study.system.positions import Positions

WHOLE_TURNS: Final = ("turn", "long_period")

AT_ONCE: Final = 2**20  # trials x positions; their transforms take 8 MB


@dataclass(frozen=True)
class Spectrum:
    """Harmonics of a curve over whole turns. Their amplitudes pool; a mean curve has smaller ones, for phases differ.

    Args:
        orders: cycles per turn of the shaft whose positions the curve is over, ascending; fractions where the positions
            span several turns.
    """

    orders: tuple[Fraction, ...]

    @classmethod
    def over(cls, positions: Positions, orders: Sequence[Fraction | int] = ()) -> Self:
        """Spectrum of those orders of curves over some positions; of all that they resolve if none are given.

        Raises:
            InputError: the positions are not whole turns, or cannot resolve an order.
        """
        if positions.over not in WHOLE_TURNS:
            raise InputError(f"a spectrum: expected a curve over whole turns, got one over {positions.over}")
        turns, highest = positions.turns, (positions.count - 1) // 2
        wanted = sorted({Fraction(order) for order in orders}) or [Fraction(k + 1, turns) for k in range(highest)]
        for order in wanted:
            cycles = order * turns
            if cycles.denominator != 1 or not 1 <= cycles <= highest:
                raise InputError(
                    f"a spectrum: expected orders of whole cycles in {turns} turns, at most {Fraction(highest, turns)} "
                    f"of them a turn at {positions.count} positions, got {order}"
                )
        return cls(tuple(wanted))

    def amplitudes(self, positions: Positions, curves: Array) -> Array:
        """Amplitude of each order in each trial, half of peak to peak, in the curves' unit.

        The coefficients of a discrete Fourier transform of evenly spaced samples: exact for a curve without cycles
        beyond half the number of samples. A turn's last position, where the first would come again, is left out.

        Args:
            positions: of the curves.
            curves: (trials, positions).

        Returns:
            (trials, orders).
        """
        count = positions.count
        cycles = [int(order * positions.turns) for order in self.orders]
        found, rows = np.empty((len(curves), len(cycles))), max(AT_ONCE // count, 1)
        for start in range(0, len(curves), rows):
            part = np.fft.rfft(curves[start : start + rows, :count], axis=1)
            found[start : start + rows] = 2 / count * np.abs(part[:, cycles])
        return found
