"""Printed reference numbers besides those in the problems' own modules: tails, worst cases, and answers of a toy.

Each number is worked out here before it is compared, and each trap is shown to lie ten standard errors away.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly.test_stack import BLOCKS, GAP, HALF, irwin_hall, stack
from assembly.test_zone_laws import WIDTH, A, B, zoned
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from places import SCENES
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.stats import kstest, norm

from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors
from tol3d.simulate import Overrides, load, simulation_of
from tol3d.statistics.distributions import TruncatedNormal
from tol3d.study.effects.first_order import first_orders
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

METHODS = ("exact", "analytic")
RARE = 1e-6


def share_of(events: NDArray[np.bool_], share: float) -> None:
    """Seen as often as expected, within four standard errors."""
    assert events.mean() == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / len(events)))


# problem 1 ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_tails_of_uniform_blocks_are_those_of_irwin_and_hall_and_not_of_a_normal(tmp_path: Path, method: str) -> None:
    gap = assembled(stack(), tmp_path).drawn(400_000, method)["gap"]
    width = 2 * HALF
    quantile = [
        GAP + width * (brentq(lambda x, p=p: irwin_hall(x, BLOCKS + 1) - p, 0.0, 5.0) - 2.5) for p in (0.00135, 0.99865)
    ]
    assert quantile == pytest.approx([-0.0610262, 0.6610262], abs=5e-8)
    share_of(gap < quantile[0], 0.00135)
    share_of(gap > quantile[1], 0.00135)
    sigma = width * math.sqrt((BLOCKS + 1) / 12)
    assert sigma == pytest.approx(0.1290994, abs=5e-8)
    by_normal = norm.cdf(-GAP / sigma)
    assert by_normal == pytest.approx(0.010068, abs=5e-7)
    assert by_normal - (gap < 0).mean() > 10 * math.sqrt(by_normal / len(gap))


def test_the_worst_case_of_the_blocks_is_all_limits_at_once(tmp_path: Path) -> None:
    made = assembled(stack(), tmp_path)
    (measure,) = made.system.measures
    for own in first_orders(made.simulation, made.system.method("exact", None), [measure])[measure.name].values():
        assert own.ends == pytest.approx((1e3 * (GAP - 5 * HALF), 1e3 * (GAP + 5 * HALF)), abs=1e-6)


def test_a_normal_cut_at_three_sigma_has_less_of_it() -> None:
    assert TruncatedNormal(0.0, 1.0, -3.0, 3.0).sigma == pytest.approx(0.9865784, abs=5e-8)


# problem 2 ---------------------------------------------------------------------------------------------------


def test_a_normal_fit_of_the_linear_clutch_misses_the_share_out_of_limits() -> None:
    """The counted shares, 4406 and 2166 ppm, are held trial by trial by the clutch's own tests."""
    assert 2e6 * norm.sf(0.6 / 0.2192924) == pytest.approx(6218, abs=0.5)


# problem 7 ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_four_pads_are_parallel_to_their_ground_within_the_range_of_four_normals(tmp_path: Path, method: str) -> None:
    """Mean 2.05875 s, against |D| / 2 of their flatness, whose plane may tilt: 0.797885 s."""
    text = (SCENES / "four_pads.yaml").read_text("utf-8")
    pads = [f"table.pad {k}" for k in (1, 2, 3, 4)]
    measures = "".join(f"  {own[6:]}: {{kind: point_plane, from: {own}, to: table.ground}}\n" for own in pads)
    flatness = f"  flatness: {{kind: inspected_flatness, points: [{', '.join(pads)}], normal: [0, 0, 1]}}\n"
    parts, moves = text[: text.index("  plate:\n")], "moves:\n  set up: {kind: fix, part: table}\n"
    tolerances = text[text.index("tolerances:\n") : text.index("moves:\n")]
    made = assembled(f"{parts}{tolerances}{moves}measures:\n{measures}{flatness}", tmp_path)
    found, count, sigma = made.drawn(100_000, method), 100_000, 0.05
    heights = np.stack([found[own[6:]] for own in pads])
    expected = quad(lambda x: 1 - norm.cdf(x) ** 4 - norm.sf(x) ** 4, -9, 9)[0]
    assert expected == pytest.approx(2.05875, abs=5e-6)
    spread = 0.88 * sigma  # standard deviation of the range of four
    assert np.ptp(heights, axis=0).mean() == pytest.approx(expected * sigma, abs=4 * spread / math.sqrt(count))
    flat = sigma * math.sqrt(2 / math.pi)
    assert found["flatness"].mean() == pytest.approx(flat, abs=4 * 0.61 * sigma / math.sqrt(count))


# problem 9 ---------------------------------------------------------------------------------------------------


def beyond(tilt: float) -> float:
    """P(hypot(alpha, beta) > tilt) of a uniform face: density (3/2) (1 - y - z) of both over their largest."""
    most = WIDTH / B, WIDTH / A

    def inside(angle: float) -> float:
        """The integral over the radius in the diamond, up to the ellipse."""
        c, s = math.cos(angle), math.sin(angle)
        r = min(1 / (c + s), tilt / math.hypot(most[0] * c, most[1] * s))
        return 6 * (r**2 / 2 - (c + s) * r**3 / 3)

    return 1 - float(quad(inside, 0, math.pi / 2, limit=200)[0])


@pytest.mark.parametrize("method", METHODS)
def test_the_tail_of_a_uniform_face_s_tilt(tmp_path: Path, method: str) -> None:
    found = zoned(tmp_path, "{kind: uniform}").drawn(200_000, method)
    tilt = np.hypot(found["about x"], found["about y"])
    for share, printed in ((0.05, 1.0644e-3), (0.0027, 1.4359e-3)):
        limit = brentq(lambda t, share=share: beyond(t) - share, 1e-5, WIDTH / B)
        assert limit == pytest.approx(printed, abs=3e-7)  # found by trials, to that
        share_of(tilt > limit, share)


# problem 10 --------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("sigma", "share", "error"), [(30, 5.483e-4, 0.052e-4), (20, 3.3e-5, 0.13e-5)])
def test_two_plates_of_better_diameters(tmp_path: Path, method: str, sigma: int, share: float, error: float) -> None:
    path = tmp_path / "plates.yaml"
    text = (SCENES / "two_plates.yaml").read_text("utf-8")
    assert text.count("sigma: 60 um") == 4
    path.write_text(text.replace("sigma: 60 um", f"sigma: {sigma} um"), "utf-8")
    plates, count, seen = Assembled(simulation_of(load(path), Overrides())), 600_000, 0
    for first in range(0, count, 50_000):
        rows = drawn(plates.simulation, first, 50_000).deviations
        seen += int((slack_of(plates, rows, method) < 0).sum())
    assert seen / count == pytest.approx(share, abs=4 * math.hypot(error, math.sqrt(share / count)))


def slack_of(made: Assembled, rows: Array, method: str) -> Array:
    if method == "analytic":
        return torsors.values(made.system.assembly, rows, ["slack"])["slack"]
    return placing.values(made.system.assembly, rows, ["slack"])["slack"][0]


# problem 13 --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", [pytest.param("exact", marks=pytest.mark.slow), "analytic"])
def test_a_float_is_a_share_of_the_clearance_of_its_own_trial(tmp_path: Path, method: str) -> None:
    """Squares of shares of the disc are uniform, shares of the slot too; of mean clearances some would lie outside."""
    text = (SCENES / "hole_and_slot.yaml").read_text("utf-8")
    measures = "".join(
        f"  {name} {axis}: {{kind: gap, from: base.{pin}, to: plate.{own}, along: {along}}}\n"
        for name, pin, own in (("hole", "pin 1", "hole"), ("slot", "pin 2", "slot"))
        for axis, along in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
    )
    made = assembled(text[: text.index("measures:\n")] + f"measures:\n{measures}", tmp_path)
    count = 20_000
    trials = drawn(made.simulation, 0, count)
    found = made.values(trials, method)
    sizes = {own.name: trials.deviations[:, places][:, 0] for own, places in made.slices if own.kind == "size"}
    first = (0.10 + sizes["hole size"] - sizes["pin 1 size"]) / 2
    second = (0.06 + sizes["slot size"] - sizes["pin 2 size"]) / 2
    assert np.ptp(first) > 0.02
    disc, across = np.hypot(found["hole x"], found["hole y"]) / first, found["slot y"] / second
    assert disc.max() < 1 + 1e-5
    assert np.abs(across).max() < 1 + 2e-3  # the slot turns by 1e-3 with the plate, which lies off along it by 0.06
    assert kstest(disc**2, "uniform").pvalue > RARE
    assert kstest((across + 1) / 2, "uniform").pvalue > RARE
    assert (disc * first > first.mean()).mean() > 0.03  # which a room of mean clearances does not have
