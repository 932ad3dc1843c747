"""The solver that both methods call, certified: tied grids, and what either method asks of it for kept assemblies."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from assembly.test_tied_patterns import tied
from kept_assemblies import made
from numpy.typing import NDArray

from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors
from tol3d.contact.certify import certificate
from tol3d.contact.cones import climbed
from tol3d.contact.programme import Programme, least_growth
from tol3d.contact.rooms import new_rooms, started

Array = NDArray[np.float64]
CLOSE = 5e-6
"""mm, and parts of 1: residuals of a certificate as multipliers of tied places balance (seen: 2e-6)."""


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


@pytest.mark.parametrize(
    "seeds", [range(20), pytest.param(range(20, 400), marks=pytest.mark.slow)], ids=["few", "many"]
)
def test_tied_grids_are_certified(seeds: range) -> None:
    """Ranks that lack, empty rooms and all: multipliers below HELD are left out by rounds."""
    for seed in seeds:
        whole = tied(np.random.default_rng(seed))
        offsets, clearances, rows = (own[seen_by(whole[2])] for own in whole)
        programme = Programme.of(len(rows), rows.shape[2], 1)
        place, only = (offsets[..., None], clearances[:, None], rows[..., None]), np.arange(1)
        programme.solve(*place)
        own = own_duals_certify(programme, place, None, only)
        assert programme.found[0]
        assert own.max() < CLOSE, (seed, own[:, 0])
        programme.steps[:] += 1e-3
        assert own_duals_certify(programme, place, None, only).max() > 1e-7  # another step is not


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
        assert own_duals_certify(programme, place, goal[:, going], going).max() < CLOSE
        others += int(np.count_nonzero(before.any(axis=0) & (before != (programme.rounds[:, going] == -1)).any(axis=0)))
        offsets = offsets + np.einsum("kcfn,fn->kcn", rows, programme.steps) + rng.normal(0.0, 0.004, offsets.shape)
    assert (programme.steps[:, :5] == 0.0).all()
    assert 20 < others < 200


def test_the_least_growth_is_the_distance_from_a_point_to_a_disc() -> None:
    """A disc about the point, beside one that nothing moves; another disc holds the first in all but 40 trials."""
    rng, count = np.random.default_rng(11), 200
    point, centre, beside, other = rng.normal([[[0.0]], [[0.0]], [[0.0]], [[5.0]]], 1.0, (4, 2, count))
    own, still, room, wide = rng.uniform(0.1, 0.8, (4, count))
    off, lying, apart = (np.hypot(*each) for each in (point - centre, beside, centre - other))
    closed, asked = np.arange(count) < 40, np.arange(count) != 50
    wide = np.where(closed, 0.7 * (apart - room), 100.0 + wide)
    offsets = np.array([point, beside, centre, other])
    rows = np.zeros((4, 2, 2))
    rows[[0, 2, 3]] = way = rng.normal(size=(2, 2))
    least, steps, empty = least_growth(offsets, np.array([own, still, room, wide]), rows, 2, asked)
    np.testing.assert_array_equal(empty, closed)
    expected = np.maximum(np.maximum(off - room, 0.0) - own, lying - still)
    some = asked & ~closed
    np.testing.assert_allclose(least[some], expected[some], rtol=0, atol=1e-10)  # GAP of 100 mm
    between = centre + (room + 0.15 * (apart - room)) / apart * (other - centre)
    np.testing.assert_allclose((-way @ steps)[:, empty], between[:, empty], rtol=0, atol=1e-9)
    assert not steps[:, 50].any()


def test_what_nothing_holds_stays_where_a_dual_without_direction_says_it_may() -> None:
    """A pin alone decides, in the middle of its hole; its bolt is in two holes that are wider.

    Interior points would move the bolt at each pose anew, within what is left to it.
    """
    rows = np.zeros((3, 2, 5, 1))
    rows[0, 0, 0, 0] = rows[0, 1, 1, 0] = rows[1, 0, 2, 0] = rows[1, 1, 3, 0] = rows[2, 0, 4, 0] = 1.0
    place = np.array([[0.02, -0.05], [0.1, 0.07], [0.3, 0.0]])[..., None], np.array([[0.1], [0.5], [0.4]]), rows
    programme, moved = Programme.of(3, 5, 1), list[Array]()
    for _ in range(4):
        programme.solve(*place, parts=2)
        assert programme.slack[0] == pytest.approx(0.1, abs=1e-11)
        assert own_duals_certify(programme, place, None, np.arange(1)).max() < CLOSE
        moved.append(programme.steps.copy())
        place = place[0] + np.einsum("kcfn,fn->kcn", rows, programme.steps), *place[1:]
    assert np.abs(moved[0][:2, 0] + [0.02, -0.05]).max() < 1e-11
    assert np.abs(moved[0][2:]).max() > 1e-3
    assert np.abs(moved[1:]).max() < 1e-11


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


@pytest.mark.parametrize("case", ["pins 0", "gauges 12", "lean 0", "later datum 1", "bolts 0", "inspected 2"])
def test_what_kept_assemblies_ask_is_certified(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every first round and push that either method asks for; rounds leave out multipliers below HELD."""
    read, solve = list[Array](), Programme.solve

    def certified_too(programme: Programme, *place: Array, **asked: Any) -> None:
        solve(programme, *place, **asked)
        mask = asked.get("asked", np.ones(len(programme.slack), dtype=bool))
        trials = asked.get("trials", np.flatnonzero(mask))
        if "trials" not in asked:
            place = tuple(own[..., trials] if own.shape[-1] > 1 else own for own in place)
        if len(trials):
            read.append(own_duals_certify(programme, place, asked.get("goal"), trials))

    monkeypatch.setattr(Programme, "solve", certified_too)
    family, _, k = case.rpartition(" ")
    assembly, rows = made(family, int(k), tmp_path)
    for values in (placing.values, torsors.values):
        read.clear()
        values(assembly, rows, list(assembly.measures))
        assert sum(own.shape[1] for own in read) >= len(rows), values.__module__
        for own in read:
            assert own.max(initial=0.0) < CLOSE, (values.__module__, own.max(axis=1))
