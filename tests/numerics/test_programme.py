"""The compiled programme against HiGHS and against all vertices, on rows of no mechanism."""

from itertools import combinations, product

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog

from tol3d.numerics.programme import NO_ROOM, OK, first_basis, ranges

Array = NDArray[np.float64]


def ends_of(rows: Array, lower: Array, upper: Array, objective: Array) -> tuple[Array, NDArray[np.int8], Array]:
    """Ends, status and shortfall of trials (trials, rows)."""
    basis = first_basis(rows)
    count = len(lower)
    ends, status = np.empty((count, 2)), np.empty(count, np.int8)
    decided, lacking = np.empty(count, np.int64), np.empty(count)
    wanted = np.stack([-objective, objective])
    ranges(rows, lower, upper, objective, wanted, basis, ends, status, decided, lacking)
    return ends, status, lacking


def highs(rows: Array, lower: Array, upper: Array, objective: Array) -> tuple[float, float] | None:
    both = np.vstack([rows, -rows]), np.concatenate([upper, -lower])
    found = [linprog(s * objective, A_ub=both[0], b_ub=both[1], bounds=(None, None)) for s in (1.0, -1.0)]
    return None if found[0].status == 2 else (found[0].fun, -found[1].fun)


def vertices(rows: Array, lower: Array, upper: Array, objective: Array) -> tuple[float, float]:
    """By every choice of rows that are met."""
    values = []
    for chosen in combinations(range(len(rows)), rows.shape[1]):
        own = rows[list(chosen)]
        if abs(np.linalg.det(own)) < 1e-9:
            continue
        for sides in product((lower, upper), repeat=len(chosen)):
            x = np.linalg.solve(own, [side[r] for side, r in zip(sides, chosen, strict=True)])
            if (rows @ x <= upper + 1e-10).all() and (rows @ x >= lower - 1e-10).all():
                values.append(float(objective @ x))
    return min(values), max(values)


def random_rows(rng: np.random.Generator, unknowns: int, rows: int) -> Array:
    """Sparse, as those of meshes are: up to three turns a row."""
    found = np.zeros((rows, unknowns))
    for row in found:
        row[rng.choice(unknowns, min(3, unknowns), replace=False)] = rng.uniform(3, 40, min(3, unknowns))
    found *= rng.choice([-1, 1], found.shape)
    found[:unknowns] += np.diag(rng.uniform(5, 20, unknowns))  # so that everything is held
    return found


@pytest.mark.parametrize("seed", range(6))
def test_ends_are_those_of_highs_and_rows_without_room_are_found(seed: int) -> None:
    rng = np.random.default_rng(seed)
    unknowns = int(rng.integers(2, 9))
    rows = random_rows(rng, unknowns, unknowns + int(rng.integers(1, 12)))
    trials = 12
    middle = rng.normal(0, 0.02, (trials, len(rows)))
    room = rng.uniform(0.01, 0.05, (trials, len(rows)))
    lower, upper = middle - room, middle + room
    objective = np.eye(unknowns)[0]
    ends, status, lacking = ends_of(rows, lower, upper, objective)
    for i in range(trials):
        wanted = highs(rows, lower[i], upper[i], objective)
        if wanted is None:
            assert status[i] == NO_ROOM
            assert lacking[i] > 0.0
            wider = ends_of(rows, lower[i : i + 1] - 0.99 * lacking[i], upper[i : i + 1] + 0.99 * lacking[i], objective)
            assert wider[1][0] == NO_ROOM  # the loop that is named lacks all of that
        else:
            assert status[i] == OK
            np.testing.assert_allclose(ends[i], wanted, rtol=0, atol=1e-9)


def test_ends_are_those_of_all_vertices() -> None:
    rng = np.random.default_rng(3)
    for _ in range(40):
        unknowns = int(rng.integers(1, 4))
        rows = random_rows(rng, unknowns, unknowns + int(rng.integers(0, 4)))
        lower, upper = -rng.uniform(0.0, 0.05, (1, len(rows))), rng.uniform(0.0, 0.05, (1, len(rows)))
        objective = np.eye(unknowns)[0]
        ends, status, _ = ends_of(rows, lower, upper, objective)
        assert status[0] == OK
        np.testing.assert_allclose(ends[0], vertices(rows, lower[0], upper[0], objective), rtol=0, atol=1e-12)


def test_a_trial_has_the_same_bits_alone_and_among_others() -> None:
    rng = np.random.default_rng(5)
    rows = random_rows(rng, 5, 14)
    lower, upper = -rng.uniform(0.01, 0.05, (200, 14)), rng.uniform(0.01, 0.05, (200, 14))
    objective = np.eye(5)[0]
    together, _, _ = ends_of(rows, lower, upper, objective)
    for i in (0, 17, 199):
        alone, _, _ = ends_of(rows, lower[i : i + 1], upper[i : i + 1], objective)
        assert alone[0].tobytes() == together[i].tobytes()


def test_equal_gaps_end_though_many_rows_tie() -> None:
    """A cube about 0 with every row thrice: ties of the entering and of the leaving row."""
    rows = np.repeat(np.eye(4), 3, axis=0)
    rows[:, 0] += 1.0
    ends, status, _ = ends_of(rows, np.full((1, 12), -1.0), np.full((1, 12), 1.0), np.eye(4)[0])
    assert status[0] == OK
    np.testing.assert_allclose(ends[0], [-0.5, 0.5], rtol=0, atol=1e-15)


def test_the_first_basis_spans_what_the_rows_span() -> None:
    rng = np.random.default_rng(8)
    rows = random_rows(rng, 6, 15)
    assert abs(np.linalg.det(rows[first_basis(rows)])) > 1.0
    assert len(first_basis(np.outer(np.arange(1.0, 5.0), [1.0, 2.0, 3.0]))) == 1
