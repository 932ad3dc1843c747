"""The scenes of planetary sets run, none of their trials fails, and they meet the numbers in the files beside them."""

import re
from collections.abc import Callable

import pytest
from expected import PRINTED, assert_all_met
from shipped import shipped

from tol3d import Run

LONG = re.compile("^reducer")  # a turn of 360 positions, loaded at each
SCENES = [pytest.param(own, marks=pytest.mark.slow) if LONG.match(own) else own for own in shipped("planetary")]
SEEN = 1e-5  # arcmin: another machine's bits


@pytest.mark.parametrize("scene", SCENES)
def test_a_planetary_set_meets_its_expected_numbers(scene: str, run_of: Callable[[str], Run]) -> None:
    assert_all_met(run_of(scene), scene, PRINTED + SEEN, PRINTED + SEEN, at=-1)


@pytest.mark.parametrize("scene", SCENES)
def test_both_methods_of_a_planetary_set_differ_by_nothing_that_is_not_explained(
    scene: str, run_of: Callable[[str], Run]
) -> None:
    summary = run_of(scene).summary
    few = "more trials let more builds follow them"  # of so short a run
    assert [own for own in summary["warnings"] if not own.endswith(few)] == []
    for own in (own for own in summary["measures"].values() if own["take"] != "curve"):
        assert own["agreement"]["explanation"]["faults"] == []
