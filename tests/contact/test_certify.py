"""Certificates: 0 where closed forms and HiGHS say that a programme is solved, and off 0 by what is wrong with it."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog

from tol3d.contact.certify import CONDITIONS, certificate

Array = NDArray[np.float64]
PRIMAL, DUAL, BALANCE, COMPLEMENTARITY = range(4)


def padded(own: Array) -> Array:
    """Four components of places (places, d, ...)."""
    return np.concatenate([own, np.zeros((len(own), 4 - own.shape[1], *own.shape[2:]))], axis=1)


@pytest.mark.parametrize("centres", [False, True])
def test_linear_programmes_of_highs_are_certified_by_its_marginals(centres: bool) -> None:
    """Seven one-sided gaps, four unknowns; the goal, or the largest common gap of the first five."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        h, goal = rng.uniform(0.5, 2.0, 7), np.zeros(4) if centres else rng.normal(size=4)
        pull = rng.uniform(0.2, 1.0, 7)
        rows = rng.normal(size=(7, 4))
        rows -= np.outer(pull, pull @ rows) / (pull @ pull)  # some duals balance nothing: it is bounded
        lifted = np.arange(7) < 5
        cost = np.append(-goal, -1.0 if centres else 0.0)
        found = linprog(
            cost, A_ub=np.column_stack([-rows, lifted if centres else 0.0 * lifted]), b_ub=h, method="highs",
            bounds=[(-50, 50)] * 4 + [(None, None) if centres else (0, 0)],
        )  # fmt: skip
        x, slack, z = found.x[:4], found.x[4], -np.asarray(found.ineqlin.marginals)
        if np.abs(x).max() > 49.0:
            continue
        own = certificate(
            padded(h[:, None])[..., None], padded(rows[:, None])[..., None], np.ones(7, np.int64), lifted,
            goal[:, None], x[:, None], np.array([slack]), padded(z[:, None])[..., None],
        )  # fmt: skip
        assert own.max() < 1e-12


def rooms(offsets: Array, clearances: Array) -> tuple[Array, Array]:
    """Discs or balls that a point's offsets have to stay within: h (places, 4, 1), rows (places, 4, dimensions, 1)."""
    places, size = offsets.shape
    h = np.column_stack([clearances, offsets])
    rows = np.zeros((places, 1 + size, size))
    rows[:, 1:] = np.eye(size)
    return padded(h)[..., None], padded(rows)[..., None]


def checked(h: Array, rows: Array, goal: Array, x: Array, slack: float, duals: Array, *, lifted: bool = True) -> Array:
    places, size = len(h), rows.shape[2]
    own = certificate(
        h, rows, np.full(places, 1 + size), np.full(places, lifted), goal[:, None], x[:, None], np.array([slack]),
        padded(duals)[..., None],
    )  # fmt: skip
    return own[:, 0]


def test_two_discs_apart_are_centred_between() -> None:
    """Centres at ±a, radii c: slack c - a in the middle; each place has half of it, along its offset."""
    h, rows = rooms(np.array([[0.3, 0.4], [-0.3, -0.4]]), np.array([0.8, 0.8]))
    duals = 0.5 * np.array([[1.0, -0.6, -0.8], [1.0, 0.6, 0.8]])
    none, still = np.zeros(2), np.zeros(2)
    assert checked(h, rows, none, still, 0.3, duals).max() < 1e-15
    assert checked(h, rows, none, still, 0.3, 0.9 * duals)[BALANCE] == pytest.approx(0.1)
    assert checked(h, rows, none, still, 0.31, duals)[PRIMAL] == pytest.approx(0.01)
    assert checked(h, rows, none, still, 0.29, duals)[COMPLEMENTARITY] == pytest.approx(0.005)
    off = checked(h, rows, none, np.array([0.06, 0.08]), 0.3, duals)
    assert off[PRIMAL] == pytest.approx(0.1)
    assert off[COMPLEMENTARITY] == pytest.approx(0.05)
    longer = duals + np.array([[0.0, -0.06, -0.08], [0.0, 0.06, 0.08]])
    assert checked(h, rows, none, still, 0.3, longer)[DUAL] == pytest.approx(0.1)
    aside = duals + np.array([[0.0, 0.0, 0.1], [0.0, 0.0, 0.0]])
    assert checked(h, rows, none, still, 0.3, aside)[BALANCE] == pytest.approx(0.1)


@pytest.mark.parametrize("size", [2, 3])
def test_one_room_alone_is_centred_without_a_direction(size: int) -> None:
    """Where one place decides its offset is 0: duals (1, 0, 0) certify, which no multiplier with a direction does."""
    at = np.array([0.02, -0.05, 0.03])[:size]
    h, rows = rooms(at[None], np.array([0.1]))
    assert checked(h, rows, np.zeros(size), -at, 0.1, np.eye(1, 1 + size)).max() < 1e-15
    directed = np.concatenate([[1.0], np.eye(size)[0]])[None]
    assert checked(h, rows, np.zeros(size), -at, 0.1, directed)[BALANCE] == pytest.approx(1.0)


@pytest.mark.parametrize("size", [2, 3])
def test_a_point_is_pushed_to_the_end_of_its_room(size: int) -> None:
    """In a disc and a ball along g: the radius that way; the dual is as long as the goal. Slack is stated, 0.01 mm."""
    goal, at = np.array([0.6, -0.2, 0.3])[:size], np.array([0.02, -0.05, 0.03])[:size]
    way, length = goal / np.linalg.norm(goal), float(np.linalg.norm(goal))
    h, rows = rooms(at[None], np.array([0.1]))
    dual = length * np.concatenate([[1.0], -way])[None]
    assert checked(h, rows, goal, 0.09 * way - at, 0.01, dual).max() < 1e-15
    assert checked(h, rows, goal, 0.1 * way - at, 0.01, dual, lifted=False).max() < 1e-15
    assert checked(h, rows, goal, 0.08 * way - at, 0.01, dual)[COMPLEMENTARITY] == pytest.approx(0.01 * length)
    assert checked(h, rows, goal, 0.09 * way - at, 0.01, 2.0 * dual)[BALANCE] == pytest.approx(np.abs(goal).max())


def test_the_middle_of_a_tetrahedron_is_as_far_from_all_corners() -> None:
    """The least largest distance of four points in space, as d = 4: the radius, a quarter of it by each."""
    corners = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])
    off = np.array([0.4, 0.3, -0.7])
    h, rows = rooms(corners + off, np.zeros(4))
    duals = np.column_stack([np.full(4, 0.25), -0.25 * corners / np.sqrt(3)])
    assert checked(h, rows, np.zeros(3), -off, -np.sqrt(3), duals).max() < 1e-15


def test_trials_are_certified_each_by_itself_and_what_is_beyond_a_place_s_components_does_not_count() -> None:
    rng = np.random.default_rng(5)
    h, rows = rng.normal(size=(5, 4, 6)), rng.normal(size=(5, 4, 3, 6))
    dims, lifted = np.array([1, 2, 3, 4, 1]), np.array([True, False, True, True, False])
    goal, x, slack, duals = (
        rng.normal(size=(3, 6)),
        rng.normal(size=(3, 6)),
        rng.normal(size=6),
        rng.normal(size=(5, 4, 6)),
    )
    goal[:, 3:] = 0.0
    own = certificate(h, rows, dims, lifted, goal, x, slack, duals)
    assert own.shape == (len(CONDITIONS), 6)
    for k, d in enumerate(dims):
        h[k, d:], rows[k, d:], duals[k, d:] = np.nan, np.nan, np.nan
    for i in range(6):
        one = slice(i, i + 1)
        alone = certificate(
            h[..., one], rows[..., one], dims, lifted, goal[:, one], x[:, one], slack[one], duals[..., one]
        )
        np.testing.assert_array_equal(alone[:, 0], own[:, i])
    shared = certificate(h, rows[..., :1], dims, lifted, goal, x, slack, duals)
    np.testing.assert_array_equal(shared[:, 0], own[:, 0])
    assert (shared[PRIMAL, 1:] != own[PRIMAL, 1:]).any()
