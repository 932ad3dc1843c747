"""Trials of three hundred random assemblies, kept since before their solvers were changed; see kept_assemblies."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from kept_assemblies import CASES, Built, Found, found, kept, made, tolerance_of

from tol3d.assembly.model.statuses import STATUSES

LONG = "every move", "bolts"
"""Families of which no case is of the default; of each other one it is, of `chain` one with a weld too."""


def cases() -> Iterator[Any]:
    for family, k in CASES:
        quick = (k == 1 and family not in LONG) or (family, k) == ("chain", 3)
        yield pytest.param(f"{family} {k}", marks=() if quick else pytest.mark.slow)


@pytest.fixture(scope="module", params=cases())
def case(request: pytest.FixtureRequest) -> str:
    """Family and index."""
    return str(request.param)


@pytest.fixture(scope="module")
def built(case: str, tmp_path_factory: pytest.TempPathFactory) -> Built:
    """An assembly and its trials."""
    family, _, k = case.rpartition(" ")
    return made(family, int(k), tmp_path_factory.mktemp("kept"))


@pytest.fixture(scope="module")
def together(built: Built) -> Found:
    """All of its trials at once."""
    return found(*built)


def test_trials_are_those_kept(case: str, together: Found) -> None:
    own = kept()[case]
    assert together.deviations == pytest.approx(own.deviations, rel=1e-9, abs=1e-9)  # else its draws are others
    np.testing.assert_array_equal(together.codes, own.codes)
    np.testing.assert_allclose(together.exact, own.exact, rtol=0, atol=tolerance_of(case))
    np.testing.assert_allclose(together.analytic, own.analytic, rtol=0, atol=tolerance_of(case))


def test_each_trial_alone_has_the_bits_that_it_has_among_all(built: Built, together: Found) -> None:
    assembly, rows = built
    for k in range(len(rows)):
        alone = found(assembly, rows[k : k + 1])
        np.testing.assert_array_equal(alone.codes[:, 0], together.codes[:, k])
        np.testing.assert_array_equal(alone.exact[:, 0], together.exact[:, k])
        np.testing.assert_array_equal(alone.analytic[:, 0], together.analytic[:, k])


def test_bolts_go_far_to_nominal_holes_that_meet_at_once(tmp_path: Path) -> None:
    """Drawn askew and far away: the cover rests after one step, its bolts have yet to go from where they are drawn."""
    assembly, rows = made("bolts", 1, tmp_path)
    rows[:, :14] = 0.0  # all but how the cover floats
    own = found(assembly, rows)
    assert not own.codes.any()
    np.testing.assert_allclose(own.exact, own.analytic, atol=5e-3)  # second order of 0.4 mm over 80 mm and its lean
    assert np.ptp(own.exact[1]) > 0.1


def test_what_is_kept_has_builds_of_every_status() -> None:
    every = kept()
    assert list(every) == [" ".join(map(str, own)) for own in CASES]
    codes = np.concatenate([own.codes.ravel() for own in every.values()])
    assert (np.bincount(codes, minlength=len(STATUSES.texts)) >= 20).all()
    assert np.mean([own.commit == "ed08464c" for own in every.values()]) > 0.75
