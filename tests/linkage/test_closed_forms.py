"""Linkages against formulas of their own, nominally and with deviations."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkage.linked_bodies import Array, Study, random_deviations, study_of
from linkage.mechanisms import CRANK, FOUR, GUIDE, ROD, delta, four_bar, four_bar_points, rssr, slider_crank, stewart
from oracles.closed_loops import pose
from scipy.optimize import brentq, root
from scipy.spatial.transform import Rotation

LIMIT = 1e-10  # mm


def test_a_slider_crank_with_its_guide_off_the_plane(tmp_path: Path) -> None:
    """Crank pin at r (-sin a, cos a), slider on the line (x, 15, 8): x by Pythagoras; stated throw and guide too."""
    linkage = slider_crank()
    study = study_of(linkage, tmp_path, ["crank.pin", "frame.guide"])
    throw, high = 0.3, np.array([0.07, -0.11, 0.07, -0.11])  # x and y of the guide's ends are its -z and y
    rows = np.stack(
        [
            study.columns({}, {}),
            study.columns({"crank.pin": np.array([0.0, throw, 0.0]), "frame.guide": high}, {"angle": 0.02}),
        ]
    )
    frame = linkage.feature("frame.guide").frame
    moved = GUIDE + frame[:3, :3] @ np.array([high[0], high[1], 0.0])
    for where, inputs in linkage.poses.items():
        found = study.seen(rows, where)[:, 2] - [10.0, 4.0, -3.0]
        for k, (off, r, guide) in enumerate(((0.0, CRANK, GUIDE), (0.02, CRANK + throw, moved))):
            angle = inputs["angle"] + off
            x, y = -r * np.sin(angle), r * np.cos(angle)
            along = x + np.sqrt(ROD**2 - (y - guide[1]) ** 2 - guide[2] ** 2)
            assert found[k] == pytest.approx([along, guide[1], guide[2]], abs=LIMIT)


def test_a_four_bar_by_the_cosine_rule(tmp_path: Path) -> None:
    linkage = four_bar(1.1)
    study = study_of(linkage, tmp_path, [])
    for where, inputs in linkage.poses.items():
        first, last = four_bar_points(1.1 + inputs["angle"])
        crank, coupler, rocker = study.seen(study.columns({}, {})[None], where)[0]
        turned = inputs["angle"]
        assert crank == pytest.approx(pose([0, 0, turned], [0, 0, 0])[:3, :3] @ [9.0, 20.0, 6.0], abs=LIMIT)
        for found, ends, drawn, own, start in (
            (coupler, last - first, np.subtract(*four_bar_points(1.1)[::-1]), None, first),
            (
                rocker,
                last - [FOUR["ground"], 0],
                four_bar_points(1.1)[1] - [FOUR["ground"], 0],
                [5.0, 30.0, 2.0],
                [FOUR["ground"], 0],
            ),
        ):
            local = np.append(drawn / 2, 0.0) + np.array([3.0, 8.0, -5.0]) if own is None else np.array(own)
            spin = np.arctan2(ends[1], ends[0]) - np.arctan2(drawn[1], drawn[0])
            want = pose([0, 0, spin], [*start, 0.0]) @ np.append(local, 1.0)
            assert found == pytest.approx(want[:3], abs=LIMIT)


def test_an_rssr_by_one_equation(tmp_path: Path) -> None:
    """The rod's length fixes the rocker's angle: a root in one unknown, about where it is drawn."""
    linkage = rssr()
    study = study_of(linkage, tmp_path, [])
    b, c = linkage.feature("crank.B").frame[:3, 3], linkage.feature("rocker.C").frame[:3, 3]
    pivot, axis = linkage.parts["rocker"].placed[:3, 3], linkage.feature("rocker.D").frame[:3, 2]
    length = np.linalg.norm(linkage.feature("rod.C").frame[:3, 3])
    for where, inputs in linkage.poses.items():
        start = pose([0, 0, inputs["angle"]], [0, 0, 0])[:3, :3] @ b

        def short(turn: float, start: Array = start) -> float:
            end = pivot + pose(turn * axis, [0, 0, 0])[:3, :3] @ c
            return float(np.linalg.norm(end - start) - length)

        turn = brentq(short, -0.8, 0.8, xtol=1e-15)
        want = pivot + pose(turn * axis, [0, 0, 0])[:3, :3] @ [5.0, 30.0, 2.0]
        assert study.seen(study.columns({}, {})[None], where)[0, 1] == pytest.approx(want, abs=LIMIT)


def three_spheres(centres: Array, radius: float) -> Array:
    """The lower of the two points (3,) at one distance from three places."""
    a, b, c = centres
    x = (b - a) / np.linalg.norm(b - a)
    z = np.cross(x, c - a)
    z /= np.linalg.norm(z)
    y = np.cross(z, x)
    d, i, j = x @ (b - a), x @ (c - a), y @ (c - a)
    p = d / 2
    q = (i * i + j * j) / (2 * j) - i / j * p
    high = np.sqrt(radius**2 - p * p - q * q)
    return min((a + p * x + q * y + sign * high * z for sign in (-1.0, 1.0)), key=lambda own: own[2])


def test_a_delta_as_three_spheres_meet(tmp_path: Path) -> None:
    """Both rods of an arm are parallel: the platform never turns, and its centre lies 200 mm from three places."""
    linkage = delta()
    study = study_of(linkage, tmp_path, [])
    for where, inputs in linkage.poses.items():
        centres = []
        for k in range(3):
            out = np.array([np.cos(2 * np.pi * k / 3), np.sin(2 * np.pi * k / 3), 0.0])
            side = np.cross([0, 0, 1], out)
            arm = 90.0 * (np.cos(np.radians(60)) * out - np.sin(np.radians(60)) * np.array([0, 0, 1.0]))
            turned = Rotation.from_rotvec(inputs[f"angle {k}"] * side).as_matrix() @ arm
            centres.append(100.0 * out + turned - 40.0 * out)
        centre = three_spheres(np.array(centres), 200.0)
        want = [centre + own for own in ([3.0, 5.0, -4.0], [-20.0, 8.0, 2.0], [1.0, 15.0, 7.0])]
        assert study.seen(study.columns({}, {})[None], where)[0] == pytest.approx(np.array(want), abs=LIMIT)


# the Stewart platform -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def platform(tmp_path_factory: pytest.TempPathFactory) -> Study:
    names = [*(f"piston {k}.ball" for k in range(6)), *(f"platform.ball {k}" for k in range(6))]
    return study_of(stewart(3), tmp_path_factory.mktemp("stewart"), names)


def ends(study: Study) -> tuple[Array, Array, Array]:
    """Feet and balls of the platform as drawn (6, 3), and the platform's pose (4, 4)."""
    own = study.linkage
    feet = np.array([own.feature(f"frame.foot {k}").frame[:3, 3] for k in range(6)])
    balls = np.array([own.feature(f"platform.ball {k}").frame[:3, 3] for k in range(6)])
    return feet, balls, own.parts["platform"].placed


def hung(feet: Array, balls: Array, lengths: Array, start: Array) -> Array:
    """The platform's pose (4, 4) by the lengths of its legs alone, from a pose near by."""

    def off(q: Array) -> Array:
        at = (balls @ (pose(q[:3], [0, 0, 0])[:3, :3] @ start[:3, :3]).T) + start[:3, 3] + 100 * q[3:]
        return np.asarray(np.linalg.norm(at - feet, axis=1) - lengths)

    found = root(off, np.zeros(6), tol=1e-14)
    for _ in range(2):  # polished, for root stops where rounding of its own differences lets it
        steps = np.eye(6) * 1e-6
        rates = np.array([(off(found.x + own) - off(found.x - own)) / 2e-6 for own in steps]).T
        found.x = found.x - np.linalg.solve(rates, off(found.x))
    assert np.abs(off(found.x)).max() < 1e-11
    where = pose(found.x[:3], [0, 0, 0]) @ start
    where[:3, 3] = start[:3, 3] + 100 * found.x[3:]
    return np.asarray(where)


@pytest.mark.parametrize("count", [50, pytest.param(1000, marks=pytest.mark.slow)])
def test_random_stewart_platforms_hang_where_scipy_finds_them(platform: Study, count: int) -> None:
    """Displaced balls at both ends of each leg, and legs that are off.

    A piston's ball that is off across the leg makes it longer and turns it: only its distance from the foot counts.
    """
    feet, balls, start = ends(platform)
    rng = np.random.default_rng(count)
    far = list(platform.linkage.poses)[1]
    values = platform.linkage.poses[far]
    long = np.array([np.linalg.norm(platform.linkage.feature(f"piston {k}.ball").frame[:3, 3]) for k in range(6)])
    alongs = np.array([platform.linkage.feature(f"piston {k}.ball").frame[:3, 3] for k in range(6)]) / long[:, None]
    nominal = hung(feet, balls, long + np.array(list(values.values())), start)
    rows, expected = [], []
    for _ in range(count):
        low, high = rng.normal(size=(2, 6, 3)) * 0.2
        zeros = {name: 0.2 * rng.normal() for name in platform.linkage.inputs}
        deviations = {f"piston {k}.ball": low[k] for k in range(6)} | {f"platform.ball {k}": high[k] for k in range(6)}
        rows.append(platform.columns(deviations, zeros))
        slid = np.array([values[name] + zeros[name] for name in values])
        lengths = np.linalg.norm((long + slid)[:, None] * alongs + low, axis=1)
        where = hung(feet, balls + high, lengths, nominal)
        expected.append(
            [
                (where @ np.append(platform.linkage.feature(own).frame[:3, 3], 1.0))[:3]
                for own in platform.linkage.probes
            ]
        )
    assert np.abs(platform.seen(np.stack(rows), far) - np.array(expected)).max() < LIMIT


def test_the_legs_of_stewart_platforms_by_their_places(tmp_path: Path) -> None:
    """Random platforms: where the legs' lengths are those of a place and a turn, the platform lies there."""
    rng = np.random.default_rng(2)
    for seed in range(3):
        linkage = stewart(10 + seed)
        feet = np.array([linkage.feature(f"frame.foot {k}").frame[:3, 3] for k in range(6)])
        balls = np.array([linkage.feature(f"platform.ball {k}").frame[:3, 3] for k in range(6)])
        drawn = linkage.parts["platform"].placed
        there = drawn @ pose(rng.uniform(-0.15, 0.15, 3), rng.uniform(-15, 15, 3))
        lengths = [np.linalg.norm(balls @ own[:3, :3].T + own[:3, 3] - feet, axis=1) for own in (drawn, there)]
        poses = {"there": dict(zip(linkage.inputs, (lengths[1] - lengths[0]).tolist(), strict=True))}
        study = study_of(replace(linkage, poses=poses), tmp_path, [])
        want = [(there @ np.append(linkage.feature(own).frame[:3, 3], 1.0))[:3] for own in linkage.probes]
        assert study.seen(study.columns({}, {})[None], "there")[0] == pytest.approx(np.array(want), abs=LIMIT)


def test_random_deviations_displace_what_they_should() -> None:
    """The oracle is no constant: deviations of 0.1 mm move its probes by some 0.1 mm."""
    linkage = rssr()
    rng = np.random.default_rng(1)
    nominal, off = linkage.expected("on", [({}, {}), random_deviations(linkage, rng, 0.1, 1e-3)])
    assert 0.01 < np.abs(off - nominal).max() < 1.0
