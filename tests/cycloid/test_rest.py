"""Cycloid stages at rest: without play first contact; with play HiGHS on gaps and slopes of its own."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from cycloid_rests import drawn, phis_of
from cycloid_stages import CRANK_CIRCLE, PROFILE
from numpy.typing import NDArray
from scipy.optimize import linprog

from tol3d.gearing.cycloid.exact.rest import RestStage
from tol3d.gearing.cycloid.model.stage import Deviated, Play
from tol3d.numerics.programme import NO_ROOM, OK

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SUN_HELD, WINDOW = 1.5, 0.7
STAGE = RestStage(PROFILE, 2, 3, CRANK_CIRCLE, SUN_HELD, WINDOW)
NO_PLAY = Play(np.zeros(()), np.zeros(()), np.zeros(()))


def fitting(deviated: Deviated) -> Deviated:
    """The same with cranks that fit: all alike, in holes without errors or displaced alike."""
    nothing = Deviated.nothing(len(deviated.pins), 40, 2, 3)
    return replace(
        deviated,
        disc_holes=nothing.disc_holes,
        crank_phases=nothing.crank_phases,
        carrier_holes=np.repeat(deviated.carrier_holes[:, :1], 3, axis=1),
        crank_errors=np.repeat(deviated.crank_errors[:, :1], 3, axis=1),
    )


@pytest.mark.slow
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_without_play_it_is_the_first_contact(sense: float) -> None:
    deviated, phis = fitting(drawn(200, 0.002, seed=3)), phis_of(200)
    rest = STAGE.rests(deviated, phis, NO_PLAY, sense)
    first = STAGE.touches(deviated, phis, (sense,))
    assert (rest.status == OK).all()
    np.testing.assert_allclose(rest.turns, first.turns[..., 0], rtol=0, atol=1e-12)  # 1e-10 mm over 85 mm
    np.testing.assert_array_equal(rest.loads.argmax(axis=-1), first.places[..., 0])


@pytest.mark.slow
def test_cranks_that_do_not_fit_find_no_place_without_play() -> None:
    rest = STAGE.rests(drawn(20, 0.002, seed=4), phis_of(20), NO_PLAY, 1.0)
    assert (rest.status == NO_ROOM).all()
    assert np.isnan(rest.turns).all()


class Posed:
    """One build as points and complex numbers, written without the code under test."""

    def __init__(self, deviated: Deviated, trial: int, phi: float, play: tuple[float, float, float]) -> None:
        self.phi, self.disc_play, self.carrier_play, self.crank_play = phi, *play
        at = {name: getattr(deviated, name)[trial] for name in deviated.__dataclass_fields__}
        around, pins = np.exp(2j * np.pi * np.arange(3) / 3), np.exp(2j * np.pi * np.arange(40) / 40)
        flat: Callable[[Array], Complex] = lambda points: points[..., 0] + 1j * points[..., 1]  # noqa: E731
        self.pins = (114.5 + flat(at["pins"])) * pins
        self.radii = 5.0 + at["pin_radii"]
        self.holes = CRANK_CIRCLE * around + flat(at["carrier_holes"]) + flat(at["carrier_offsets"])
        self.bored = CRANK_CIRCLE * around + flat(at["disc_holes"]) - flat(at["disc_offsets"])[:, None]
        throws = np.array([2.2, -2.2])
        self.thrown = (throws + flat(at["crank_errors"])) * np.exp(1j * at["crank_phases"])[:, None]
        self.lobes = at["lobe_pitch"] * 40 / (39 * 114.5), at["lobe_profile"]

    def gaps(self, unknowns: Array, sense: float) -> Array:
        """Gaps of working pins of both discs [um]; unknowns as lengths [um], turns at 100 mm."""
        z = unknowns / 1e3
        found = []
        for disc in range(2):
            x, y, turn = z[1 + 3 * disc : 4 + 3 * disc]
            throw = self.phi + np.pi * disc
            phase = 2 * np.pi * np.arange(40) / 40 - throw
            k = 2.2 * 40 / 114.5
            works = sense * np.sin(phase) / np.sqrt(1 + k * k - 2 * k * np.cos(phase)) > WINDOW
            own = np.exp(1j * (turn / 100 - self.phi / 39 - np.pi * disc / 39))
            seen = (self.pins[works] - 2.2 * np.exp(1j * throw) - x - 1j * y) * np.conj(own)
            u = (2 * np.pi * np.arange(40) / 40 + throw / 39)[works]
            lobe = np.floor(u * 39 / (2 * np.pi)).astype(int) % 39
            seen = seen * np.exp(-1j * self.lobes[0][disc, lobe])
            radius = 114.5 + PROFILE.modification.shift
            for _ in range(8):  # the foot: the tangential distance, by its rate along a nearly straight path
                slope = 1j * (radius * np.exp(1j * u) - 88.0 * np.exp(40j * u))
                bend = -(radius * np.exp(1j * u) - 88.0 * 40 * np.exp(40j * u))
                off = seen - radius * np.exp(1j * u) + 2.2 * np.exp(40j * u)
                u = u + (off * np.conj(slope)).real / (abs(slope) ** 2 - (off * np.conj(bend)).real)
            away = (off * np.conj(-1j * slope / abs(slope))).real
            grinding = 5.0 + PROFILE.modification.offset
            found.append(away + grinding - self.radii[works] - self.lobes[1][disc, lobe])
        return 1e3 * np.concatenate(found)

    def joints(self, unknowns: Array) -> Array:
        """Displacements in the bearings (9, 2) [um], those of discs first."""
        z = unknowns / 1e3
        cranks = np.exp(-1j * self.phi / 39) * CRANK_CIRCLE * np.exp(2j * np.pi * np.arange(3) / 3)
        cranks = cranks + z[7::3] + 1j * z[8::3]
        turns = np.exp(1j * (self.phi + (SUN_HELD * z[0] + z[9::3]) / 100))
        found = []
        for i in range(3):
            for disc in range(2):
                x, y, turn = z[1 + 3 * disc : 4 + 3 * disc]
                centre = 2.2 * np.exp(1j * (self.phi + np.pi * disc)) + x + 1j * y
                hole = centre + np.exp(1j * (turn / 100 - self.phi / 39)) * self.bored[disc, i]
                found.append(hole - cranks[i] - turns[i] * self.thrown[i, disc])
        found.extend(cranks - np.exp(1j * (z[0] / 100 - self.phi / 39)) * self.holes)
        each = 1e3 * np.array(found)
        return np.stack([each.real, each.imag], axis=-1)

    def turned(self, sense: float, fresh: tuple[int, ...] = (0, 3, 9)) -> float:
        """The carrier's turn [rad] by HiGHS: linear programmes with differences for slopes and tangents to circles.

        Args:
            sense: of the torque.
            fresh: steps that take new slopes; later z changes by less than a hundredth of a micrometre, but on a bend.
        """
        z, radial = np.zeros(16), 1e3 / 2 * np.array([self.disc_play] * 6 + [self.carrier_play] * 3)
        eye = np.eye(16)
        tangents = [(b, np.array([np.cos(t), np.sin(t)])) for b in range(9) for t in 2 * np.pi * np.arange(8) / 8]
        bounds = np.full(16, 1000.0)
        bounds[9::3] = 1e5 * self.crank_play
        for step in range(40):
            gaps, joints = self.gaps(z, sense), self.joints(z)
            if step in fresh:
                by_gap = np.stack([self.gaps(z + d, sense) - self.gaps(z - d, sense) for d in eye], axis=-1) / 2
            by_joint = np.stack([self.joints(z + d) - self.joints(z - d) for d in eye], axis=-1) / 2
            near = 1000 * 0.5 ** max(0, step - 8)  # so that idle bodies come to rest
            rows = np.array([direction @ by_joint[b] for b, direction in tangents])
            room = np.array([radial[b] - direction @ joints[b] for b, direction in tangents])
            given = linprog(
                -sense * eye[0], np.concatenate([-by_gap, rows]), np.concatenate([gaps, room]), method="highs",
                bounds=np.stack([np.maximum(-bounds - z, -near), np.minimum(bounds - z, near)], axis=-1),
                options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
            )  # fmt: skip
            assert given.status == 0
            z = z + given.x
            joints = self.joints(z)
            far = np.hypot(joints[:, 0], joints[:, 1])
            tangents.extend((int(b), joints[b] / far[b]) for b in np.flatnonzero(far > radial + 1e-7))
            if abs(given.x[0]) < 1e-6 and (far <= radial + 1e-6).all():
                break
        return float(z[0] / 1e5)


@pytest.mark.slow
@pytest.mark.parametrize("quarter", [0, 1, 2, 3])
def test_with_play_it_is_where_highs_finds_it_on_two_hundred_builds(quarter: int) -> None:
    deviated, phis = drawn(200, 0.002, seed=5), phis_of(200)
    plays = (0.02, 0.015, 1e-5)
    play = Play(np.full((), plays[0]), np.full((), plays[1]), plays[2] * np.array([-1.0, 1.0]))
    sense = (1.0, -1.0)[quarter % 2]
    rest = STAGE.rests(deviated, phis, play, sense)
    assert (rest.status == OK).all()
    expected = [Posed(deviated, trial, phis[trial, 0], plays).turned(sense) for trial in range(quarter, 200, 4)]
    # its loop ends where circles are met to 1e-9 mm, over levers of some 10 mm
    np.testing.assert_allclose(rest.turns[quarter::4, 0], expected, rtol=0, atol=1e-10)


@pytest.mark.slow
def test_loads_balance_the_torque_as_work_says() -> None:
    """A pin that grows takes the carrier back by its load times the growth."""
    deviated, phis = drawn(50, 0.002, seed=6), phis_of(50)
    play = Play(np.full((), 0.02), np.full((), 0.015), np.array([-1e-5, 1e-5]))
    rest = STAGE.rests(deviated, phis, play, 1.0)
    most = rest.loads[:, 0].argmax(axis=-1)
    grown = deviated.pin_radii.copy()
    grown[np.arange(50), most % 40] += 1e-7
    later = STAGE.rests(replace(deviated, pin_radii=grown), phis, play, 1.0)
    # a pin stands for both discs; where it is last to be reached a growth may change which pins carry
    loads = rest.loads[:, 0, :40] + rest.loads[:, 0, 40:]
    expected = -1e-7 * loads[np.arange(50), most % 40]
    off = np.abs((later.turns - rest.turns)[:, 0] / expected - 1.0)
    assert np.quantile(off, 0.9) < 1e-4
    assert np.median(off) < 2e-6  # circles met to 1e-10 mm alone would leave ten times as much


@pytest.mark.slow
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_builds_that_differ_in_a_pin_or_a_lobe_rest_where_each_does_by_itself(sense: float) -> None:
    """Most pins carry nothing and may shrink or grow a little; others then carry, or are those that do."""
    mean = drawn(1, 0.002, seed=8)
    play = Play(np.full((), 0.02), np.full((), 0.015), np.array([-1e-5, 1e-5]))
    changes: list[tuple[str, tuple[int, ...], float]]
    changes = [("pin_radii", (0, pin), by) for pin in range(40) for by in (-0.004, 0.004, 0.03)]
    changes += [("lobe_profile", (0, disc, lobe), 0.004) for disc in range(2) for lobe in range(0, 39, 3)]
    builds = []
    for name, place, by in changes:
        array = getattr(mean, name).copy()
        array[place] += by
        builds.append(replace(mean, **{name: array}))
    every = Deviated(**{name: np.concatenate([getattr(own, name) for own in builds]) for name in mean.__dict__})
    phi = np.full((1, 1), 3.0)
    together = STAGE.rests(every, phi, play, sense, 0.003)
    apart = [STAGE.rests(own, phi, play, sense, 0.003) for own in builds]
    assert (together.status == OK).all()
    turns = np.array([own.turns[0, 0] for own in apart])
    np.testing.assert_allclose(together.turns[:, 0], turns, rtol=0, atol=1e-12)  # 1e-10 mm over 85 mm
    np.testing.assert_allclose(together.loads[:, 0], [own.loads[0, 0] for own in apart], rtol=0, atol=1e-8)
    np.testing.assert_array_equal(together.near[:, 0], [own.near[0, 0] for own in apart])
    at_mean = STAGE.rests(mean, phi, play, sense).turns[0, 0]
    moved = np.abs(turns - at_mean) > 1e-9
    assert 10 < moved.sum() < len(moved) / 2
    # most take over the rest of the one before them: its very bits
    assert (np.diff(together.turns[:, 0]) == 0.0).sum() > len(moved) / 3


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "trial"), [(10, 3213), (11, 6346), (12, 5892), (12, 8677), (12, 9565), (17, 3041)])
def test_a_pin_that_rests_on_the_bend_of_a_hollow_flank_is_no_stall(seed: int, trial: int) -> None:
    """Bodies went to and fro there by 9 um, and the carrier by 0.2 arc seconds, for as many steps as one likes."""
    deviated, phis = drawn(10_000, 0.002, seed), np.random.default_rng(seed).uniform(0, 2 * np.pi * 39, (10_000, 1))
    one = Deviated(**{name: getattr(deviated, name)[[trial]] for name in deviated.__dataclass_fields__})
    phi, plays = phis[[trial]], (0.02, 0.015, 1e-5)
    play = Play(np.full((), plays[0]), np.full((), plays[1]), plays[2] * np.array([-1.0, 1.0]))
    rest = STAGE.rests(one, phi, play, 1.0)
    assert rest.status == OK
    expected = Posed(one, 0, phi[0, 0], plays).turned(1.0, tuple(range(40)))
    assert rest.turns[0, 0] == pytest.approx(
        expected, abs=3e-9
    )  # its steps halve: along a bend it stops a little short


@pytest.mark.slow
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_mirrored_build_rests_at_the_mirrored_angle(sense: float) -> None:
    """Across the x axis: whatever was counter-clockwise is clockwise, pins, lobes and cranks come in turned order."""
    own, phis = drawn(50, 0.002, seed=7), phis_of(50)
    flip, pins, cranks = np.array([1.0, -1.0]), -np.arange(40) % 40, -np.arange(3) % 3
    # a disc's first lobe begins on its throw's ray; the second disc's throw is at half a turn, mirrored at minus that
    lobes = np.stack([38 - np.arange(39), (39 - np.arange(39)) % 39])
    of_discs = np.arange(2)[:, None]
    mirrored = Deviated(
        pins=own.pins[:, pins] * flip,
        pin_radii=own.pin_radii[:, pins],
        lobe_pitch=-own.lobe_pitch[:, of_discs, lobes],
        lobe_profile=own.lobe_profile[:, of_discs, lobes],
        disc_offsets=own.disc_offsets * flip,
        disc_holes=own.disc_holes[:, :, cranks] * flip,
        crank_errors=own.crank_errors[:, cranks] * flip,
        crank_phases=-own.crank_phases[:, cranks],
        carrier_holes=own.carrier_holes[:, cranks] * flip,
        carrier_offsets=own.carrier_offsets * flip,
    )
    disc, carrier = np.random.default_rng(8).uniform(0.01, 0.02, (50, 3, 2)), np.full(3, 0.015)
    free = np.array([-1e-5, 3e-5])
    there = STAGE.rests(own, phis, Play(disc, carrier, free, (0.022, 0.008)), sense)
    back = STAGE.rests(mirrored, -phis, Play(disc[:, cranks], carrier, -free[::-1], (0.022, 0.008)), -sense)
    assert (there.status == OK).all()
    np.testing.assert_allclose(back.turns, -there.turns, rtol=0, atol=2e-12)
