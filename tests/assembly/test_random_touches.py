"""Touches by random round features: poses against scipy, small displacements against finite poses."""

import numpy as np
import pytest
from assembly.random_touches import KINDS, RandomTouch, random_touch
from numpy.typing import NDArray

from tol3d.assembly.model.statuses import NO_CONTACT, OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors

Array = NDArray[np.float64]

SIGMA = 0.02  # mm


def drawn(made: RandomTouch, seed: int, count: int) -> Array:
    return np.random.default_rng(seed + 10_000).normal(size=(count, made.assembly.width)) * SIGMA


def poses_agree(made: RandomTouch, deviations: Array) -> int:
    """Number of trials compared: the others have no contact, by scipy either."""
    found, count = placing.placed(made.assembly, deviations)["part"], 0
    codes = placing.values(made.assembly, deviations, ["x"])["x"][1]
    for row, pose, code in zip(deviations, found, codes, strict=True):
        expected = made.pose(row)
        if expected is None:
            assert code == NO_CONTACT
            continue
        if np.abs(pose - expected).max() > 1e-9:  # another one of several poses, perhaps: that which grows from nominal
            expected = made.pose(row, steps=200)
            assert expected is not None
        np.testing.assert_allclose(pose, expected, rtol=0.0, atol=1e-9, err_msg=str(made.kinds))
        count += 1
    return count


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_each_contact_alone_is_met_as_scipy_meets_it(kind: str) -> None:
    made = random_touch(KINDS.index(kind), kinds=(kind,))
    assert poses_agree(made, drawn(made, 0, 2)) == 2


@pytest.mark.parametrize("seed", range(16))
def test_random_touches_are_those_of_scipy(seed: int) -> None:
    made = random_touch(seed)
    assert poses_agree(made, drawn(made, seed, 2)) == 2


def test_a_pose_beyond_a_fold_is_not_taken_for_that_which_grows_from_nominal() -> None:
    """Deviations of 1 mm, at which Newton's steps from nominal fall and end on the other side of a fold."""
    made = random_touch(119)
    rows = np.random.default_rng(119).normal(size=(40, made.assembly.width))[[24, 31]]
    found, codes = placing.placed(made.assembly, rows)["part"], placing.values(made.assembly, rows, ["x"])["x"][1]
    assert (codes == OK).all()
    for row, pose in zip(rows, found, strict=True):
        expected = made.pose(row, steps=4)
        assert expected is not None
        np.testing.assert_allclose(pose, expected, rtol=0.0, atol=1e-9)


def test_a_pose_that_no_way_from_nominal_leads_to_is_no_contact() -> None:
    """Followed by shares, Newton's steps may jump over a fold; scipy's way from nominal ends there."""
    made = random_touch(60)
    row = 3.0 * np.random.default_rng(60).normal(size=(40, made.assembly.width))[3]
    assert made.pose(row, steps=10) is None
    assert placing.values(made.assembly, row[None], ["x"])["x"][1].tolist() == [NO_CONTACT]


@pytest.mark.slow
@pytest.mark.parametrize("hundred", range(10))
def test_a_thousand_random_touches_are_those_of_scipy(hundred: int) -> None:
    count = 0
    for seed in range(1000 + 100 * hundred, 1100 + 100 * hundred):
        made = random_touch(seed)
        count += poses_agree(made, drawn(made, seed, 1))
    assert count >= 98


def left_out(made: RandomTouch, deviations: Array, name: str) -> Array:
    """By how much the methods differ at most, at shares of the deviations that fall to a half each (4,)."""
    found = []
    for share in 0.5 ** np.arange(4):
        exact, codes = placing.values(made.assembly, share * deviations, [name])[name]
        assert (codes == OK).all()
        found.append(np.abs(torsors.values(made.assembly, share * deviations, [name])[name] - exact).max())
    return np.array(found)


@pytest.mark.parametrize("seed", range(16))
def test_what_small_displacements_leave_out_is_of_second_order(seed: int) -> None:
    """Halves of the deviations leave quarters: a slope of 2 in logarithms, by what the third order makes of it."""
    made = random_touch(seed)
    deviations = drawn(made, seed, 20)
    for name in made.assembly.measures:
        found = left_out(made, deviations, name)
        if name.startswith("gap"):  # cylinders that cross at 9 deg touch beyond their ends, where their gap is not 0
            assert found[0] < (2e-2 if "cylinder across cylinder" in made.kinds else 1e-3)
        if found[-1] > 1e-10:
            slope = np.polyfit(np.log(0.5 ** np.arange(4)), np.log(found), 1)[0]
            assert slope == pytest.approx(2.0, abs=0.1), (name, made.kinds)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(16))
def test_slopes_are_central_differences_of_finite_poses(seed: int) -> None:
    """Steps of h and 2h, extrapolated: the fourth power is left of 4e-3 mm over lengths of some mm, and rounding."""
    made, step = random_touch(seed), 2e-3
    width, names = made.assembly.width, list(made.assembly.measures)
    found = []
    for size in (step, 2 * step):
        sides = [placing.values(made.assembly, sign * size * np.eye(width), names) for sign in (1.0, -1.0)]
        found.append({name: (sides[0][name][0] - sides[1][name][0]) / (2.0 * size) for name in names})
    for name in names:
        slopes = torsors.slopes(made.assembly, name, *np.zeros((2, width))).coefficients
        central = (4.0 * found[0][name] - found[1][name]) / 3.0
        np.testing.assert_allclose(slopes, central, atol=2e-8, err_msg=f"{name}: {made.kinds}")


def test_a_trial_has_the_same_bits_alone_and_among_others() -> None:
    made = random_touch(3)
    deviations, names = drawn(made, 3, 40), list(made.assembly.measures)
    for method in (placing, torsors):
        together = method.values(made.assembly, deviations, names)
        for k in (0, 17, 39):
            alone = method.values(made.assembly, deviations[k : k + 1], names)
            for name in names:
                assert np.array_equal(np.atleast_2d(alone[name])[:, 0], np.atleast_2d(together[name])[:, k])
