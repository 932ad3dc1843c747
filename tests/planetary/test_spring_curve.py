"""Springs of flexible carriers against torques: breakaway, the region of low stiffness, loops by friction."""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from places import ROOT
from planetary_sets import (
    ARCMIN,
    CLEARANCE,
    KAPPA,
    R_R2,
    R_S,
    flexible,
    pitch_rows,
    random_deviations,
    reducer_3k,
    thinned,
)
from scipy.optimize import linprog

from tol3d.errors import InputError
from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.hysteresis import hysteresis
from tol3d.gearing.planetary.hysteresis_picture import draw_curve
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.spring_curve import LeafSpring, breakaway, turns_under

Array = NDArray[np.float64]

STANDING = (("ring 1",), ("ring 2",))


def test_torques_below_the_breakaway_turn_nothing_and_beyond_it_the_spring_gives_way() -> None:
    """T0 = Q0 rS (1 - kappa)/(4 (1 + kappa)); from there on theta = 4 (1 + kappa)/(1 - kappa) (T/T0 - 1) Q0/(k rS)."""
    c, force, stiffness = CLEARANCE, 100.0, 500.0
    breaking = force * R_S * (1 - KAPPA) / (4 * (1 + KAPPA))
    shares = np.array([-1.02, -0.999, -0.5, 0.5, 0.999, 1.01, 1.02])
    found = turns_under(flexible(), thinned(c, c, c), shares * breaking, "sun", LeafSpring(force, stiffness))
    beyond = np.sign(shares) * np.maximum(np.abs(shares) - 1.0, 0.0) * force / stiffness
    np.testing.assert_allclose(found, 4 * (1 + KAPPA) / (1 - KAPPA) * beyond / R_S, rtol=0, atol=1e-8)


def test_a_torque_far_beyond_crosses_the_dead_band_of_the_rigid_set() -> None:
    c = CLEARANCE
    far = turns_under(flexible(), thinned(c, c, c), np.array([-1e5, 1e5]), "sun", LeafSpring(100.0, 50.0))
    rigid = StackUp(reducer_3k()).free(thinned(c, c, c), np.zeros(1), "sun", "ring 2").ends[0]
    assert far[1] - far[0] == pytest.approx(rigid[1] - rigid[0], abs=1e-8)


def test_springs_that_cannot_push_are_refused() -> None:
    with pytest.raises(InputError, match="one spring, got 0"):
        turns_under(reducer_3k(), thinned(0.03, 0.03, 0.03), np.zeros(1), "sun", LeafSpring(1.0, 1.0))
    with pytest.raises(InputError, match="jams before its spring pushes"):
        turns_under(flexible(), thinned(-0.03, 0.03, 0.03), np.zeros(1), "sun", LeafSpring(1.0, 1.0))


def loop_of(share: float) -> Array:
    """Torques there and back, up to a share of the breakaway torque of 1."""
    up = np.linspace(0.0, share, 61)
    return np.concatenate([up, up[-2::-1], -up[1:], -up[-2::-1], up[1:]])


def test_friction_opens_a_loop_between_two_breakaway_torques() -> None:
    """S gives way from (Q0 + F) on, comes back from (Q0 - F) on; theta = 4 (1 + kappa)(S0 - S)/((1 - kappa) rS).

    Played back from the two lines by hand: outside them the displacement follows one of them, between them it stays.
    """
    force, stiffness, friction = 100.0, 4000.0, 20.0
    gain = 4 * (1 + KAPPA) / ((1 - KAPPA) * R_S)  # rad a mm of the sun
    torques = loop_of(1.5) * force / gain
    found = turns_under(flexible(), thinned(*3 * (CLEARANCE,)), torques, "sun", LeafSpring(force, stiffness, friction))
    given, way = [], 0.0
    for torque in torques:
        load = abs(torque) * gain
        way = max(way, (load - force - friction) / stiffness)
        way = max(0.0, min(way, (load - force + friction) / stiffness))
        given.append(np.sign(torque) * gain * way)
    assert gain * 0.007 < max(given) < gain * CLEARANCE / 2  # well beyond, on the first of the spring's lines
    np.testing.assert_allclose(found, given, rtol=0, atol=1e-8)
    out, back = (
        np.searchsorted(torques[:61], 1.1 * force / gain),
        120 - np.searchsorted(torques[:61], 1.1 * force / gain),
    )
    assert found[out] == pytest.approx(0.0, abs=1e-9)
    assert found[back] == pytest.approx(gain * 0.3 * force / stiffness, rel=0.1)


def test_the_loop_loses_what_friction_takes() -> None:
    """Around once, the torque's work is F times the way of the planets: there and back in both senses, 4 F (S0 - S)."""
    force, stiffness, friction = 100.0, 4000.0, 20.0
    gain = 4 * (1 + KAPPA) / ((1 - KAPPA) * R_S)
    path = loop_of(1.5) * force / gain
    found = turns_under(flexible(), thinned(*3 * (CLEARANCE,)), path, "sun", LeafSpring(force, stiffness, friction))
    once = slice(60, None)  # from the first peak to the next
    work = float(np.sum((path[once][1:] + path[once][:-1]) / 2 * np.diff(found[once])))
    way = (1.5 * force - force - friction) / stiffness
    assert work == pytest.approx(4 * friction * way, rel=1e-9)


@dataclass(frozen=True)
class AllContacts:
    """Torque, spring, friction and all flanks of the digest's rows together, by HiGHS.

    Args:
        matrix, upper: of all flanks, in um; unknowns are 1e3 times free turns, displacement, and its way back and on.
        sun: place of its turn.
    """

    matrix: Array
    upper: Array
    sun: int

    @classmethod
    def of(cls, own: PlanetarySet, deviated: Deviated, turns: float) -> "AllContacts":
        found = pitch_rows(own, deviated, 0, turns)
        column = np.concatenate(
            [[-own.springs[0].sense(k) * mesh.sense for mesh in own.meshes] for k in range(own.planets)]
        )
        free = [place for place in range(found.rows.shape[1]) if own.shafts[place : place + 1] not in STANDING]
        rows = np.column_stack([found.rows[:, free], column, np.zeros((len(column), 2))])
        upper = 1e3 * np.concatenate([found.upper, -found.lower])
        return cls(np.vstack([rows, -rows]), upper, free.index(own.shafts.index("sun")))

    def solve_lp(self, price: dict[int, float], before: float, at: float | None = None) -> Array:
        """Unknowns [rad, mm] with the largest work, of displacements that were `before`, or are held."""
        count = self.matrix.shape[1]
        objective, moved = np.zeros(count), np.zeros((1, count))
        for place, own in price.items():
            objective[place] = -own
        moved[0, -3:] = 1.0, 1.0, -1.0
        bounds: list[tuple[float | None, float | None]] = [(None, None)] * (count - 2) + [(0.0, None)] * 2
        if at is not None:
            bounds[-3] = (1e3 * at, 1e3 * at)
        solved = linprog(
            objective, A_ub=self.matrix, b_ub=self.upper, A_eq=moved, b_eq=[1e3 * before], bounds=bounds, method="highs"
        )
        assert solved.status == 0
        return np.asarray(solved.x) / 1e3

    def step(self, torque: float, spring: LeafSpring, closed: float, before: float) -> tuple[float, float]:
        """Turn of the sun and displacement: where the work's rates there make no other place better."""
        low, high = closed - 0.1, closed
        for _ in range(34):
            middle = (low + high) / 2
            force = spring.force - spring.stiffness * (middle - closed)
            price = {self.sun: torque, -3: force, -2: -spring.friction, -1: -spring.friction}
            low, high = (middle, high) if self.solve_lp(price, before)[-3] > middle else (low, middle)
        found = self.solve_lp({self.sun: torque}, before, at=low)
        return float(found[self.sun]), low


@pytest.mark.parametrize("seed", range(3))
def test_the_loop_is_that_of_all_contacts_and_the_spring_together(seed: int) -> None:
    """Unequal gaps, eccentric gears: step by step the largest work of 24 flanks, torque, spring and friction."""
    own, spring = flexible(), LeafSpring(100.0, 900.0, 15.0)
    deviated = random_deviations(own, 1, np.random.default_rng(seed))
    contacts = AllContacts.of(own, deviated, 0.3)
    torques = np.array([6.0, 25.0, 45.0, 33.0, 12.0, -8.0, -40.0, -25.0])
    turns = turns_under(own, deviated, torques, "sun", spring, 0.3)
    closed = at = float(contacts.solve_lp({-3: 1.0}, 0.0)[-3])
    for torque, turn in zip(torques, turns, strict=True):
        wanted, at = contacts.step(torque, spring, closed, at)
        assert turn == pytest.approx(wanted, abs=1e-7)


@pytest.mark.parametrize("seed", range(4))
def test_breakaway_torques_part_what_stays_from_what_turns(seed: int) -> None:
    own = flexible()
    deviated, spring = random_deviations(own, 1, np.random.default_rng(seed)), LeafSpring(100.0, 900.0, 15.0)
    ends = np.array(breakaway(own, deviated, "sun", spring))
    assert ends[0] < 0.0 < ends[1]
    for sense, end in enumerate(ends):
        found = turns_under(own, deviated, end * np.array([1e-3, 0.999, 1.001, 1.01]), "sun", spring)
        assert found[1] == pytest.approx(found[0], abs=1e-12)
        assert (found[3] - found[2]) * (2 * sense - 1) > 1e-4
    breaking = (spring.force + spring.friction) * R_S * (1 - KAPPA) / (4 * (1 + KAPPA))
    np.testing.assert_allclose(ends, [-breaking, breaking], rtol=1e-7)  # bends are found to 1e-9 rad of 0.1 rad


@pytest.mark.parametrize("values", [(0.0, 1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 2.0), (math.nan, 1.0, 0.0)])
def test_leaf_springs_without_a_meaning_are_refused(values: tuple[float, float, float]) -> None:
    with pytest.raises(InputError, match="expected"):
        LeafSpring(*values)


# there and back -------------------------------------------------------------------------------------------------


def test_a_loop_says_what_is_left_without_torque_and_what_a_rigid_carrier_leaves() -> None:
    """Gaps alike in all planets: 2 |D|/rR2 at the output, D = c_c - kappa c_b - (1 - kappa)(c_a + c_b)/2."""
    own, gaps = flexible(), (0.02, 0.03, 0.035)
    loop = hysteresis(own, thinned(*gaps), "ring 2", LeafSpring(60.0, 4000.0, 9.0), 900.0, steps=30)
    off = gaps[2] - KAPPA * gaps[1] - (1 - KAPPA) * (gaps[0] + gaps[1]) / 2
    assert loop.lost_motion == pytest.approx(2 * abs(off) / R_R2, abs=1e-9)
    rigid = 2 * (gaps[0] * (1 - KAPPA) / 2 + gaps[1] * (1 + KAPPA) / 2 + gaps[2]) / R_R2
    assert loop.rigid is not None
    assert loop.rigid[1] - loop.rigid[0] == pytest.approx(rigid, abs=1e-9)
    assert loop.torques[[0, 30, 60, 90, 120, 150]].tolist() == [0.0, 900.0, 0.0, -900.0, 0.0, 900.0]
    rows = [line.split(",") for line in loop.csv().splitlines()]
    assert rows[0] == ["torque [N mm]", "turn [arcmin]"]
    np.testing.assert_allclose(np.array(rows[1:], float), np.stack([loop.torques, loop.turns / ARCMIN], axis=1))


def test_a_spring_makes_room_where_pins_of_a_rigid_carrier_would_jam(tmp_path: Path) -> None:
    """Planets are off their places by 0.04 mm against the sense of the spring: it has 0.04 mm farther to go."""
    own, off, spring = flexible(), thinned(*3 * (CLEARANCE,)), LeafSpring(60.0, 500.0)
    off.pins[0, :, 1] = [-0.04, 0.04, -0.04, 0.04]
    loop = hysteresis(own, off, "sun", spring, 15.0)
    assert loop.rigid is None
    there = hysteresis(own, thinned(*3 * (CLEARANCE,)), "sun", spring, 15.0)
    np.testing.assert_allclose(loop.turns, there.turns, rtol=0, atol=1e-8)
    draw_curve(loop.curve, tmp_path / "loop.png")


WRONG = {
    "another shaft": ({"shaft": "carrier"}, "expected 'sun' or 'ring 2', got 'carrier'"),
    "no peak": ({"peak": 0.0}, "peak: expected more than 0 N mm, got 0.0"),
    "no steps": ({"steps": 0}, "steps: expected 1 or more, got 0"),
    "two trials": ({"deviated": thinned(0.03, 0.03, 0.03, 2)}, "deviations of one trial, got those of 2"),
}


@pytest.mark.parametrize(("change", "said"), WRONG.values(), ids=WRONG.keys())
def test_loops_without_a_meaning_are_refused(change: dict[str, Any], said: str) -> None:
    given: dict[str, Any] = {"own": flexible(), "deviated": thinned(0.03, 0.03, 0.03), "shaft": "sun", "peak": 1.0}
    with pytest.raises(InputError, match=said):
        hysteresis(**(given | {"spring": LeafSpring(60.0, 1.0)} | change))


def test_the_page_s_program_draws_what_the_page_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (ROOT / "docs" / "planetary.md").read_text("utf-8")
    (program,) = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(compile(program, "docs/planetary.md", "exec"), names)
    loop = names["loop"]
    assert f"yields at {loop.breakaway[1]:.0f} N mm. Below this the output turns freely" in page
    assert f"turns freely by {loop.lost_motion / ARCMIN:.2f}′" in page
    assert f"the {(loop.rigid[1] - loop.rigid[0]) / ARCMIN:.2f}′ that a rigid carrier would leave" in page
    assert (tmp_path / "torque_curve.csv").read_text("utf-8") == loop.csv()
    assert (tmp_path / "torque_curve.png").stat().st_size > 10_000
