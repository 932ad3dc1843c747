"""Cone programmes: forces of the points found balance the objective and the gaps, which proves them farthest."""

import numpy as np
import pytest
from numpy.typing import NDArray

from tol3d.numerics.cone_programme import PRICE, SHARE, ConeProgramme, Solved, solve_cone_programme

Array = NDArray[np.float64]
UNKNOWNS, ROWS, CONES = 9, 12, 5


def programmes(trials: int, spread: float) -> ConeProgramme:
    """Random ones: in a room of straight gaps, with few slopes in each row, and round gaps off by a spread [mm]."""
    random = np.random.default_rng(12)
    rows = random.normal(size=(trials, ROWS, UNKNOWNS)) * (random.random((trials, ROWS, UNKNOWNS)) < 0.4)
    boxed = np.concatenate([np.eye(UNKNOWNS)[:-1], -np.eye(UNKNOWNS)[:-1]])
    rows = np.concatenate([rows, np.broadcast_to(boxed, (trials, *boxed.shape))], axis=1)
    rows[:, :, -1] = 0.0
    planes = random.normal(size=(trials, CONES, 2, UNKNOWNS))
    planes[..., -1] = 0.0
    return ConeProgramme(
        rows,
        random.uniform(0.01, 0.2, size=rows.shape[:2]),
        planes,
        spread * random.normal(size=(trials, CONES, 2)),
        random.uniform(0.005, 0.05, size=(trials, CONES)),
    )


def unbalanced(given: ConeProgramme, found: Solved, sense: float) -> Array:
    """Objective less forces (trials, unknowns); in the last unknown these add up to PRICE with the widening."""
    y = found.y
    moved = given.off + np.einsum("tckn,tn->tck", given.planes, y)
    reach = given.radii + y[:, -1:]
    left = reach**2 - (moved**2).sum(axis=-1)
    assert (left > 0.0).all()
    assert found.gaps == pytest.approx(given.gaps + np.einsum("trn,tn->tr", given.rows, y) + y[:, -1:], abs=1e-12)
    assert found.straight * found.gaps == pytest.approx(SHARE, rel=1e-9)
    assert found.round == pytest.approx(2 * SHARE * moved / left[..., None], rel=1e-3, abs=1e-6)
    pushed = np.einsum("tr,trn->tn", found.straight, given.rows) - np.einsum("tck,tckn->tn", found.round, given.planes)
    pushed[:, 0] += sense
    pushed[:, -1] += found.straight.sum(axis=1) + (2 * SHARE * reach / left).sum(axis=1) + SHARE / y[:, -1] - PRICE
    return pushed


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_forces_balance_where_the_coordinate_is_farthest(sense: float) -> None:
    given = programmes(200, 0.01)
    found = solve_cone_programme(given, sense)
    assert np.abs(unbalanced(given, found, sense)[:, :-1]).max() < 1e-3
    assert (found.y[:, -1] < 1e-5).mean() > 0.5  # of most there is room without widening


def test_builds_that_are_far_from_fitting_balance_too() -> None:
    """Overlaps of 1 mm in room of 0.01, where a gap has six digits."""
    given = programmes(300, 1.0)
    found = solve_cone_programme(given, 1.0)
    assert (found.y[:, -1] > 0.05).all()
    assert np.abs(unbalanced(given, found, 1.0)).max() < 1e-4 * PRICE


def test_a_trial_has_the_same_bits_alone() -> None:
    given = programmes(30, 0.02)
    together = solve_cone_programme(given, -1.0)
    for i in range(0, 30, 7):
        alone = solve_cone_programme(ConeProgramme(*(own[i : i + 1] for own in vars(given).values())), -1.0)
        assert alone.y[0].tobytes() == together.y[i].tobytes()
        assert alone.round[0].tobytes() == together.round[i].tobytes()
