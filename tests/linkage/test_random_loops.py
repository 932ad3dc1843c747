"""Loops of joints of any kinds at random places, against the oracle and road against road."""

from pathlib import Path

import numpy as np
import pytest
from linkage.linked_bodies import Linkage, Trial, random_deviations, study_of
from linkage.random_loops import FREEDOMS, open_chain, random_loop

LIMIT = 1e-9  # mm


def assert_as_the_oracle(linkage: Linkage, folder: Path, seed: int = 0) -> None:
    study = study_of(linkage, folder)
    rng = np.random.default_rng(seed)
    trials: list[Trial] = [({}, {}), *(random_deviations(linkage, rng, 0.01, 1e-4) for _ in range(2))]
    rows = np.stack([study.columns(*own) for own in trials])
    for where in linkage.poses:
        assert np.abs(study.seen(rows, where) - linkage.expected(where, trials)).max() < LIMIT


def assert_second_order(linkage: Linkage, folder: Path) -> None:
    """Halving all deviations quarters the rms difference of the roads, within what a third order makes of 20 trials."""
    study = study_of(linkage, folder)
    rng = np.random.default_rng(3)
    rows = np.stack([study.columns(*random_deviations(linkage, rng, 0.02, 2e-4)) for _ in range(20)])
    for where in linkage.poses:
        off = [study.seen(f * rows, where) - study.seen(f * rows, where, "analytic") for f in (1.0, 0.5)]
        whole, half = (float(np.sqrt(np.mean(own**2))) for own in off)
        assert whole > 1e-9
        assert half / whole == pytest.approx(0.25, abs=0.01)


def test_a_row_of_every_kind_of_joint_lies_where_its_inputs_say(tmp_path: Path) -> None:
    assert_as_the_oracle(open_chain(), tmp_path)


@pytest.mark.parametrize("kind", [own for own in FREEDOMS if own != "ball"])
def test_every_kind_of_joint_shuts_a_loop(kind: str, tmp_path: Path) -> None:
    """A loop that it alone can shut: with others of as many freedoms, and the input before it."""
    count = {1: 7, 2: 4}[FREEDOMS[kind]]
    kinds = ["revolute", *[kind] * (count - 1)]
    if kind == "prismatic":  # three slides, then turns
        kinds = ["revolute", "prismatic", "revolute", "prismatic", "revolute", "revolute", "prismatic"]
    assert_as_the_oracle(random_loop(20, kinds, given=0), tmp_path)


@pytest.mark.parametrize("seed", [*range(8), *(pytest.param(k, marks=pytest.mark.slow) for k in range(8, 60))])
def test_random_loops_are_as_the_oracle_has_them(seed: int, tmp_path: Path) -> None:
    assert_as_the_oracle(random_loop(seed, two=seed % 2 == 1), tmp_path, seed)


@pytest.mark.parametrize("seed", [*range(4), *(pytest.param(k, marks=pytest.mark.slow) for k in range(4, 60))])
def test_the_roads_of_random_loops_differ_by_second_order(seed: int, tmp_path: Path) -> None:
    assert_second_order(random_loop(100 + seed, two=seed % 2 == 0), tmp_path)
