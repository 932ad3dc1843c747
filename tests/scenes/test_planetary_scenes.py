"""The scenes of planetary sets run, none of their trials fails, and they meet the numbers in the files beside them."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from expected import expected
from places import SCENES as FOLDER
from shipped import shipped

from tol3d import Run, load_scene

LONG = re.compile("^reducer")  # a turn of 360 positions, loaded at each
SCENES = [pytest.param(own, marks=pytest.mark.slow) if LONG.match(own) else own for own in shipped("planetary")]
PRINTED = 1e-5  # arcmin; the files give that many digits
SEEN = 1e-5  # arcmin: another machine's bits


def measures_of(scene: str) -> dict[str, dict[str, Any]]:
    return {name: own for name, own in expected(scene).items() if isinstance(own, dict)}


@pytest.mark.parametrize("scene", SCENES)
def test_a_planetary_set_meets_its_expected_numbers(scene: str, run_of: Callable[[str], Run]) -> None:
    summary = run_of(scene).summary
    trials = expected(scene)["trials"]
    assert summary["status"] == dict.fromkeys(summary["status"], 0) | {"ok": trials}
    assert list(measures_of(scene)) == list(load_scene(FOLDER / f"{scene}.yaml").measures)
    for name, own in measures_of(scene).items():
        found = summary["measures"][name]
        for road in ("analytic", "geometric"):
            for moment in ("mean", "sigma"):
                value = found["curve"][road][moment][-1] if found["take"] == "curve" else found[road][moment]
                assert value == pytest.approx(own[road][moment], abs=PRINTED + SEEN), name
            for build in {"nominal", "mean_build"} & own.keys():
                assert found[build][road] == pytest.approx(own[build][road], abs=PRINTED + SEEN), name


@pytest.mark.parametrize("scene", SCENES)
def test_both_roads_of_a_planetary_set_differ_by_nothing_that_is_not_explained(
    scene: str, run_of: Callable[[str], Run]
) -> None:
    summary = run_of(scene).summary
    assert summary["warnings"] == []
    for own in (own for own in summary["measures"].values() if own["take"] != "curve"):
        assert own["agreement"]["explanation"]["faults"] == []
