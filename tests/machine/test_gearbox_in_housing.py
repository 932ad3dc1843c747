"""scenes/gearbox_in_housing.yaml by hand: backlashes and gaps from its drawing, trial by trial and in their moments."""

import math
from pathlib import Path

import numpy as np
import pytest
from machine.box_by_hand import FIRST, SECOND, Box, Stage, by_involutes, centre, laid, own_draws, to_first_order
from machine.housed import gearbox_of, values
from numpy.typing import NDArray
from places import SCENES

from tol3d import Overrides, Run, run_scene

Array = NDArray[np.float64]

SCENE = SCENES / "gearbox_in_housing.yaml"
BOX = Box.read(SCENE)
STAGES = {"first normal backlash": FIRST, "second normal backlash": SECOND}
TRIALS = 5_000


def correlation(one: Array, other: Array) -> float:
    """Pearson's r."""
    return float(np.corrcoef(one, other)[0, 1])


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """With more trials than the scene asks for."""
    out = tmp_path_factory.mktemp("box") / "run"
    return run_scene(SCENE, overrides=Overrides(trials=TRIALS, seed=5, witness=0), out=out)


@pytest.mark.parametrize("measure", STAGES)
def test_backlashes_follow_from_the_columns_of_the_run(measure: str, run: Run) -> None:
    """The analytic method is the same sum; the exact one is within a hundredth of a um of involutes that lean."""
    columns = run.columns()
    summed, rolled = (1000 * own(BOX, columns, STAGES[measure]) for own in (to_first_order, by_involutes))
    np.testing.assert_allclose(columns[f"analytic:{measure}"], summed, rtol=0, atol=1e-6)
    np.testing.assert_allclose(columns[f"geometric:{measure}"], rolled, rtol=0, atol=0.015)
    assert np.ptp(summed) > 50


@pytest.mark.parametrize("stage", [FIRST, SECOND], ids=lambda own: own.name)
def test_parallel_shafts_and_warm_gears_have_the_involute_s_backlash(stage: Stage, tmp_path: Path) -> None:
    """Both bores of each shaft lie off alike, nothing is eccentric: ISO 21771 to the exact engine's end."""
    system = gearbox_of(SCENE.read_text("utf-8"), tmp_path)
    draws = np.random.default_rng(3)
    count = 40
    own: dict[str, Array] = {}
    for shaft in ("input", "middle", "output"):
        aside = {way: draws.uniform(-0.01, 0.01, count) for way in "xy"}
        for position in (f"{shaft} bore position", f"cover {shaft} bore position"):
            own |= {f"{position}.{end} {way}": aside[way] for end in ("start", "end") for way in "xy"}
    for gear in (FIRST.driver, FIRST.driven, SECOND.driver, SECOND.driven):
        own[f"{gear} tooth thickness"] = draws.uniform(-0.08, -0.03, count)
    own |= {"housing temperature": draws.uniform(-20, 40, count), "gear temperature": draws.uniform(-20, 60, count)}
    name = next(name for name, each in STAGES.items() if each is stage)
    found = 1000 * values(system, "exact", own, np.full(count, 0.4))[name]
    columns = {key: np.zeros(count) for key in own_draws(BOX, 1, 0)}
    for key, each in own.items():
        columns |= {f"{key} [K]": each} if "temperature" in key else {f"{key} [um]": 1000 * each}
    np.testing.assert_allclose(found, 1000 * by_involutes(BOX, columns, stage), rtol=0, atol=1e-6)


def test_mean_sigma_and_correlation_of_both_backlashes_are_those_of_other_draws(run: Run) -> None:
    """100 000 builds of the same drawing, drawn and assembled without the program."""
    count = 100_000
    columns = own_draws(BOX, count, 11)
    drawn = {name: 1000 * to_first_order(BOX, columns, stage) for name, stage in STAGES.items()}
    found = run.columns()
    apart = 1 / TRIALS + 1 / count
    for name, own in drawn.items():
        for method in ("analytic", "geometric"):
            summary = run.summary["measures"][name][method]
            bent = 0.05 if method == "geometric" else 0.0  # of second order: what is warm bends the involute
            assert summary["mean"] == pytest.approx(own.mean(), abs=4 * own.std() * math.sqrt(apart) + bent)
            assert summary["sigma"] == pytest.approx(own.std(), rel=4 * math.sqrt(apart / 2) + bent / own.std())
        form = run.summary["measures"][name]["analytic_closed_form"]
        assert form["mean"] == pytest.approx(own.mean(), abs=4 * own.std() / math.sqrt(count))
        assert form["sigma"] == pytest.approx(own.std(), rel=4 / math.sqrt(2 * count) + 5e-4)
    expected = correlation(*drawn.values())
    assert expected > 0.2  # warmth, which both share, outweighs the bores of the middle shaft
    both = correlation(*(found[f"geometric:{name}"] for name in STAGES))
    assert both == pytest.approx(expected, abs=4 * (1 - expected**2) * math.sqrt(apart))


def test_where_the_cover_lies_follows_from_the_columns_of_the_run(run: Run) -> None:
    """Walls at their middles, which lie in the plane y = 0 of both dowels, so that a turn does not count."""
    columns = run.columns()
    shift = 1000 * centre(columns, "dowel 1 seat")[:, 0]
    offset = {name: columns[f"{name} profile.offset [um]"] for name in ("inside", "outside", "spigot", "edge")}
    warm = 1 + 23e-6 * columns["housing temperature [K]"]
    far, near = (BOX.place(f"{part}.output bore") for part in ("cover", "housing"))
    aside = centre(columns, "cover output bore position") + laid(BOX, columns).moved(far)
    expected = {
        "cover gap": 200 * warm - offset["inside"] - offset["spigot"] - shift,
        "cover edge": offset["edge"] - offset["outside"] + shift,
        "output bores aside": 1000 * (aside - centre(columns, "output bore position"))[:, 1],
    }
    assert (far - near)[1] == 0.0
    for name, own in expected.items():
        np.testing.assert_allclose(columns[f"analytic:{name}"], own, rtol=0, atol=1e-6, err_msg=name)
        np.testing.assert_allclose(columns[f"geometric:{name}"], own, rtol=0, atol=0.15, err_msg=name)


def test_the_moments_of_the_cover_s_gap_by_hand(run: Run) -> None:
    """A face's height is uniform in an octahedron: variance (t/2)^2 / 10. Dowel 1: both ends in a disc of 5 um."""
    seat = 5**2 / 8
    by_hand = {
        "cover gap": (200 * (1 + 23e-6 * 15), math.sqrt(2 * 50**2 / 10 + seat)),
        "cover edge": (0.0, math.sqrt(2 * 100**2 / 10 + seat)),
    }
    for name, (mean, sigma) in by_hand.items():
        own = run.summary["measures"][name]
        form = own["analytic_closed_form"]
        assert (form["mean"], form["sigma"]) == pytest.approx((mean, sigma), abs=1e-3)
        for method in ("analytic", "geometric"):
            assert own[method]["mean"] == pytest.approx(mean, abs=4 * sigma / math.sqrt(TRIALS))
            assert own[method]["sigma"] == pytest.approx(sigma, rel=4 / math.sqrt(2 * TRIALS))


def test_a_dowel_hole_that_stands_upright_lets_the_output_bores_meet(tmp_path: Path) -> None:
    """A lean over 14 mm of hole counts 13 mm above its middle; a perpendicularity of 5 um takes most of it."""
    drawn = SCENE.read_text("utf-8")
    line = "{kind: perpendicularity, of: housing.dowel hole 2, datums: [rim], zone: {diameter: 5 um}}"
    upright = drawn.replace("\ntolerances:\n", f"\ntolerances:\n  dowel hole 2 upright: {line}\n")
    lever = (BOX.place("cover.output bore") - BOX.place("housing.dowel 1"))[0] / 224
    others = 2 * 10**2 / 8 + (lever**2 + (1 - lever) ** 2) * 5**2 / 8
    # half the difference of both ends: of two points of a disc of 10 um; in a disc of 2.5 um, where the lens of what is
    # left for their middle shrinks by up to 0.3
    for text, half, within in ((drawn, 10**2 / 8, 1e-6), (upright, 2.5**2 / 4, 0.01)):
        system = gearbox_of(text, tmp_path)
        form = system.closed_form(next(own for own in system.measures if own.name == "output bores aside"))
        assert form is not None
        sigma = math.sqrt(others + (lever * 13 / 14) ** 2 * 4 * half)
        assert 1000 * form.sigma == pytest.approx(sigma, rel=within)


def test_a_run_names_the_laws_of_the_zones_that_move_a_gear(run: Run) -> None:
    """Both bores of all shafts and the dowels; not the walls."""
    laws = run.summary["measures"]["first normal backlash"]["laws"]
    assert set(laws.values()) == {"uniform in its zone"}
    assert {"input bore position", "cover output bore position", "dowel 2 seat"} <= set(laws)
    assert not {"inside profile", "edge profile"} & set(laws)
