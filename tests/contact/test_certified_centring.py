"""Centring of both methods, certified: tied grids, and what kept assemblies ask of it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from assembly.test_tied_patterns import tied
from kept_assemblies import found, made
from numpy.typing import NDArray
from thinned import thinned

from tol3d.assembly.torsors import centring
from tol3d.contact.certify import certificate
from tol3d.contact.cones import climbed
from tol3d.contact.programme import Programme
from tol3d.contact.rooms import new_rooms, started

Array = NDArray[np.float64]
NO_DIRECTION = 1e-6, 1e-8, 1e-10
"""Lengths of offsets over clearances below which they have no direction: duals by any of them certify."""
ROUNDING = 1e-9
"""mm; the same of offsets that are rounding of poses."""
NOTHING = 1e-9
"""Multiplier, of 1 in all, that is 0."""
CLOSE = {"exact": 5e-6, "analytic": 5e-5}
"""mm, and parts of 1: residuals of a certificate as multipliers of tied places balance (seen: 2e-6 and 1.7e-5)."""


def certified(
    offsets: Array, clearances: Array, rows: Array, counts: NDArray[np.bool_], steps: Array, multipliers: Array
) -> Array:
    """A certificate that steps (freedoms, n) have the largest slack of the places that count (4, n).

    Multipliers of places (places, n) are duals along their offsets; the dual of an offset of length 0 has the
    components that balance best.
    """
    at = offsets + np.einsum("krfn,fn->krn", np.broadcast_to(rows, (*rows.shape[:3], steps.shape[1])), steps)
    lengths = np.hypot(at[:, 0], at[:, 1])
    slack = np.where(counts, clearances - lengths, np.inf).min(axis=0)
    h, whole = np.zeros((len(at), 4, len(slack))), np.zeros((len(at), 4, *rows.shape[2:]))
    h[:, 0], h[:, 1:3], whole[:, 1:3] = np.where(counts, clearances, 1e3), offsets * counts[:, None], rows
    whole = np.where(counts[:, None, None], whole, 0.0)
    every, none = np.ones(len(at), dtype=bool), np.zeros((len(steps), 1))
    stated = h, whole, np.full(len(at), 3), every, none, steps, slack
    own = counts * multipliers
    found = [certificate(*stated, _duals(at, clearances, rows, own, least)) for least in NO_DIRECTION]
    return np.stack(found)[np.argmin([each.max(axis=0) for each in found], axis=0), :, np.arange(len(slack))].T


def _duals(at: Array, clearances: Array, rows: Array, multipliers: Array, least: float) -> Array:
    lengths = np.hypot(at[:, 0], at[:, 1])
    pointed = lengths > least * np.abs(clearances) + ROUNDING
    duals = np.zeros((len(at), 4, lengths.shape[1]))
    duals[:, 0] = np.where(multipliers > NOTHING, multipliers, 0.0)
    duals[:, 1:3] = -duals[:, :1] * np.where(
        pointed, at.swapaxes(0, 1) / np.where(pointed, lengths, 1.0), 0.0
    ).swapaxes(0, 1)
    for i, open_here in enumerate((~pointed & (duals[:, 0] > 0.0)).T):
        if open_here.any():
            own = rows[..., min(i, rows.shape[3] - 1)]
            left = np.einsum("krf,kr->f", own, duals[:, 1:3, i])
            through = own[open_here].reshape(-1, own.shape[2])
            duals[open_here, 1:3, i] = -np.linalg.lstsq(through.T, left, rcond=None)[0].reshape(-1, 2)
    return duals


def own_duals_certify(
    programme: Programme, place: tuple[Array, ...], goal: Array | None, trials: NDArray[np.int64]
) -> Array:
    """A certificate by the duals that a programme tells of its first round, or of its push (4, trials found)."""
    offsets, clearances, rows = place
    decided = programme.rounds[:, trials] == (1 if goal is None else -1)
    some = programme.found[trials] & decided.any(axis=0)
    h, whole = np.zeros((len(rows), 4, len(trials))), np.zeros((len(rows), 4, *rows.shape[2:]))
    h[:, 0], h[:, 1:3], whole[:, 1:3] = clearances, offsets, rows
    duals = np.zeros(h.shape)
    duals[:, :3] = np.where(decided[:, None], programme.duals[..., trials], 0.0)
    steps = programme.steps[:, trials]
    slack = programme.slack[trials] if goal is None else np.zeros(len(trials))
    seen, aim = seen_by(rows), np.zeros((len(steps), 1)) if goal is None else goal
    whole, aim = (np.broadcast_to(own, (*own.shape[:-1], len(trials)))[..., some] for own in (whole, aim))
    dims, lifted = np.full(len(rows), 3)[seen], np.full(int(seen.sum()), goal is None)
    return certificate(
        h[seen][..., some], whole[seen], dims, lifted, aim, steps[:, some], slack[some], duals[seen][..., some]
    )


def seen_by(rows: Array) -> NDArray[np.bool_]:
    """Places that some freedom changes (places,)."""
    return np.asarray(np.abs(rows).reshape(len(rows), -1).max(axis=1, initial=0.0) > 1e-6)


def by_kernel(offsets: Array, clearances: Array, rows: Array) -> tuple[Array, Array]:
    """Steps (freedoms, 1) and the first round's multipliers (places, 1) by the exact method."""
    programme = Programme.of(len(rows), rows.shape[2], 1)
    programme.solve(offsets, clearances, rows[..., None])
    assert programme.found[0]
    return programme.steps, programme.multipliers


def by_torsors(offsets: Array, clearances: Array, rows: Array) -> tuple[Array, Array]:
    """The same by the analytic method's."""
    counts, closed = seen_by(rows)[:, None], np.zeros((rows.shape[2], rows.shape[2], 1))
    return centring.largest_slack(offsets, clearances, rows[..., None], counts, closed)


@pytest.mark.parametrize(
    "seeds", [range(20), pytest.param(range(20, 400), marks=pytest.mark.slow)], ids=["few", "many"]
)
@pytest.mark.parametrize("solve", [by_kernel, by_torsors])
def test_tied_grids_are_certified(solve: Callable[..., tuple[Array, Array]], seeds: range) -> None:
    """Ranks that lack, empty rooms and all: multipliers below HELD are left out by the exact method's rounds."""
    for seed in seeds:
        offsets, clearances, rows = tied(np.random.default_rng(seed))
        place = offsets[..., None], clearances[:, None]
        steps, multipliers = solve(*place, rows)
        own = certified(*place, rows[..., None], seen_by(rows)[:, None], steps, multipliers)
        assert own.max() < CLOSE["exact" if solve is by_kernel else "analytic"], (seed, own[:, 0])
        off = certified(*place, rows[..., None], seen_by(rows)[:, None], steps + 1e-3, multipliers)
        assert off.max() > 1e-7  # another step is not


def test_a_push_goes_on_from_the_places_that_decided_at_the_pose_before_or_from_the_middle() -> None:
    """As one from the middle, to rounding: at poses nearby, and at one where other places decide; trials by number."""
    rng, count = np.random.default_rng(7), 60
    at = rng.uniform(-1.0, 1.0, (5, 2))
    rows = np.zeros((5, 2, 3, 1))
    rows[:, 0, 0, 0] = rows[:, 1, 1, 0] = 1.0
    rows[:, 0, 2, 0], rows[:, 1, 2, 0] = -at[:, 1], at[:, 0]
    goal, clearances = rng.normal(size=(3, count)), rng.uniform(0.1, 0.2, (5, count))
    offsets = rng.normal(0.0, 0.02, (5, 2, count))
    programme, going, others = Programme.of(5, 3, count), np.arange(5, count), 0
    for _ in range(5):
        before = programme.rounds[:, going] == -1
        place = offsets[..., going], clearances[:, going], np.repeat(rows, len(going), axis=3)
        programme.solve(*place, goal=goal[:, going], trials=going)
        anew = Programme.of(5, 3, count)
        anew.solve(offsets, clearances, rows, goal=goal, asked=np.arange(count) >= 5)
        assert programme.found.all()
        np.testing.assert_allclose(programme.steps, anew.steps, rtol=0, atol=1e-9)
        assert own_duals_certify(programme, place, goal[:, going], going).max() < CLOSE["exact"]
        others += int(np.count_nonzero(before.any(axis=0) & (before != (programme.rounds[:, going] == -1)).any(axis=0)))
        offsets = offsets + np.einsum("kcfn,fn->kcn", rows, programme.steps) + rng.normal(0.0, 0.004, offsets.shape)
    assert (programme.steps[:, :5] == 0.0).all()
    assert 20 < others < 200


@pytest.mark.parametrize("at", [[(0.02, -0.05)], [(0.02, -0.05), (0.02, -0.05)]], ids=["one", "two alike"])
def test_interior_points_have_full_duals_where_an_offset_is_0(at: list[tuple[float, float]]) -> None:
    """A pin in one hole, or in both ends of an upright one: its multiplier has no direction, its dual certifies."""
    offsets, clearances = np.array(at), np.full(len(at), 0.1)
    rows, q, none = np.repeat(np.eye(2)[None], len(at), axis=0), np.zeros(2), np.zeros(0)
    _, used, y, z, step, _, inner = new_rooms(len(at), 2)
    used[:] = True
    started((offsets, clearances, rows), q, used, y, z, len(at), 1, 1.0)
    assert climbed((y, z, rows, used), 2, 1, False, none, step, inner)
    h, whole = np.zeros((len(at), 4, 1)), np.zeros((len(at), 4, 2, 1))
    h[:, 0, 0], h[:, 1:3, 0], whole[:, 1:3, :, 0] = clearances, offsets, rows
    duals = np.zeros((len(at), 4, 1))
    duals[:, :3, 0] = z
    slack = np.array([0.1 - np.hypot(*(offsets[0] + step[:2]))])
    assert slack[0] == pytest.approx(0.1, abs=1e-11)
    stated = h, whole, np.full(len(at), 3), np.ones(len(at), dtype=bool), np.zeros((2, 1)), step[:2, None], slack
    assert certificate(*stated, duals).max() < 1e-8
    duals[:, 1, 0] = -duals[:, 0, 0]
    assert certificate(*stated, duals)[2, 0] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    "case", thinned(["pins 0", "gauges 12", "lean 0", "later datum 1", "bolts 0", "inspected 2"], 2)
)
def test_what_kept_assemblies_ask_is_certified(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every programme of the first round that either method solves as arrays; rounds leave out multipliers below HELD.

    Not all: of bolts and holes that tie exactly, the analytic method's multipliers stay 2e-9 at places without a
    direction, and what it tells of duals does not certify (up to 2e-4).
    """
    read: dict[str, list[Array]] = {"exact": [], "analytic": []}
    by_torsors_too, solve = centring.largest_slack, Programme.solve

    def by_rounds(*arrays: Any) -> tuple[Array, Array]:
        steps, multipliers = by_torsors_too(*arrays)
        offsets, clearances, rows, counts, _ = arrays
        read["analytic"].append(certified(offsets, clearances, rows, counts, steps, multipliers))
        return steps, multipliers

    def certified_too(programme: Programme, *place: Array, **asked: Any) -> None:
        solve(programme, *place, **asked)
        mask = asked.get("asked", np.ones(len(programme.slack), dtype=bool))
        trials = asked.get("trials", np.flatnonzero(mask))
        if "trials" not in asked:
            place = tuple(own[..., trials] if own.shape[-1] > 1 else own for own in place)
        read["exact"].append(own_duals_certify(programme, place, asked.get("goal"), trials))

    monkeypatch.setattr(centring, "largest_slack", by_rounds)
    monkeypatch.setattr(Programme, "solve", certified_too)
    family, _, k = case.rpartition(" ")
    found(*made(family, int(k), tmp_path))
    assert sum(map(len, read.values())) > 3
    for method, rounds in read.items():
        for own in rounds:
            assert own.max() < CLOSE[method], own.max(axis=1)
