"""Loops with displaced features, against an oracle that knows no tree of joints."""

from pathlib import Path

import numpy as np
import pytest
from linkage.linked_bodies import Trial, random_deviations, study_of
from linkage.mechanisms import ALL

LIMIT = 1e-9  # mm; both solvers stop at 1e-11 of some 100 mm and better


LONG = ("stewart", "delta")  # whose closed forms are quicker
NAMES = [pytest.param(name, marks=pytest.mark.slow) if name in LONG else name for name in ALL]


@pytest.mark.parametrize("name", NAMES)
def test_displaced_features_move_all_bodies_as_the_oracle_moves_them(name: str, tmp_path: Path) -> None:
    linkage = ALL[name]()
    study = study_of(linkage, tmp_path)
    rng = np.random.default_rng(5)
    trials: list[Trial] = [({}, {}), *(random_deviations(linkage, rng, 0.05, 5e-4) for _ in range(2))]
    rows = np.stack([study.columns(*own) for own in trials])
    for where in linkage.poses:
        assert np.abs(study.seen(rows, where) - linkage.expected(where, trials)).max() < LIMIT
