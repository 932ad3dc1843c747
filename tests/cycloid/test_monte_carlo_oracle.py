"""Plain Monte Carlo of the published example, by an independent oracle; known figures beside it."""

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.cycloid_monte_carlo import units

Array = NDArray[np.float64]

UNITS = 200_000
BLOCKS = 20
LOW, HIGH = 0.00135, 0.99865
ROUNDING = 0.05  # '' half of the last digit given


def half_range(values: Array) -> float:
    low, high = np.quantile(values, [LOW, HIGH])
    return float(high - low) / 2


def standard_error(values: Array) -> float:
    """Standard error of the half-range of all values, from the scatter of blocks of them."""
    blocks = [half_range(block) for block in np.split(values, BLOCKS)]
    return float(np.std(blocks, ddof=1)) / BLOCKS**0.5


@pytest.mark.slow
@pytest.mark.parametrize("displaced", [False, True], ids=["radius", "once per turn"])
def test_known_figures_come_out_within_their_sampling_error(displaced: bool) -> None:
    """Theirs came of a number of units that is not known; as many as ours are assumed, so both scatter alike."""
    drawn = units(UNITS, 1, displaced_circle=displaced)
    found = {
        False: {
            37.2: drawn.first,
            38.4: drawn.first + drawn.carrier,
            35.8: drawn.both,
            36.8: drawn.both + drawn.carrier,
        },
        True: {41.4: drawn.first, 42.3: drawn.first + drawn.carrier},
    }
    for known, values in found[displaced].items():
        assert half_range(values) == pytest.approx(known, abs=4 * 2**0.5 * standard_error(values) + ROUNDING)
        assert 4 * 2**0.5 * standard_error(values) < 2.0


@pytest.mark.slow
def test_the_smallest_of_all_working_pins_shifts_the_mean() -> None:
    """A normal law's standard error stands for both; that of sigma is sigma / sqrt(2 n)."""
    first = units(UNITS, 2).first
    error = 12.1 / UNITS**0.5
    assert first.mean() == pytest.approx(-7.3, abs=4 * error + ROUNDING)
    assert first.std() == pytest.approx(12.1, abs=4 * error + ROUNDING)
