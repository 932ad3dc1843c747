"""The scenes of planetary sets run, none of their trials fails, and they meet the numbers in the files beside them."""

import re
from collections.abc import Callable

import pytest
from expected import PRINTED, assert_met, expected, measures_of
from places import SCENES as FOLDER
from shipped import shipped

from tol3d import Run, load_scene

LONG = re.compile("^reducer")  # a turn of 360 positions, loaded at each
SCENES = [pytest.param(own, marks=pytest.mark.slow) if LONG.match(own) else own for own in shipped("planetary")]
SEEN = 1e-5  # arcmin: another machine's bits


@pytest.mark.parametrize("scene", SCENES)
def test_a_planetary_set_meets_its_expected_numbers(scene: str, run_of: Callable[[str], Run]) -> None:
    summary = run_of(scene).summary
    trials = expected(scene)["trials"]
    assert summary["status"] == dict.fromkeys(summary["status"], 0) | {"ok": trials}
    assert list(measures_of(scene)) == list(load_scene(FOLDER / f"{scene}.yaml").measures)
    for name, own in measures_of(scene).items():
        assert_met(summary["measures"][name], own, PRINTED + SEEN, PRINTED + SEEN, at=-1)


@pytest.mark.parametrize("scene", SCENES)
def test_both_methods_of_a_planetary_set_differ_by_nothing_that_is_not_explained(
    scene: str, run_of: Callable[[str], Run]
) -> None:
    summary = run_of(scene).summary
    few = "more trials let more builds follow them"  # of so short a run
    assert [own for own in summary["warnings"] if not own.endswith(few)] == []
    for own in (own for own in summary["measures"].values() if own["take"] != "curve"):
        assert own["agreement"]["explanation"]["faults"] == []
