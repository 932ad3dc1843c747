"""Numbers kept beside the scenes, in scenes/*.expected.toml, and runs that meet them."""

import tomllib
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, Final

import numpy as np
import pytest
from places import SCENES

from tol3d import Run

PRINTED: Final = 1e-5  # um, mm or arcmin; the files give that many digits


@cache
def expected(scene: str) -> dict[str, Any]:
    """Expected values of a scene, by measure, and the number of trials."""
    return tomllib.loads((SCENES / f"{scene}.expected.toml").read_text("utf-8"))


def measures_of(scene: str) -> dict[str, dict[str, Any]]:
    """Expected values of its measures."""
    return {name: own for name, own in expected(scene).items() if isinstance(own, dict) and name != "stages"}


def assert_met(
    found: Mapping[str, Any],
    own: Mapping[str, Any],
    geometric: float,
    analytic: float = PRINTED,
    *,
    at: int | slice | Sequence[int] = slice(None),
) -> None:
    """A measure of a run has the numbers that the file beside the scene has of it.

    Args:
        found: of summary.json.
        own: of the file.
        geometric, analytic: how far each method may be off; closed forms as they are printed, shares by 0.01 %.
        at: places of a curve that the file has.
    """
    is_curve = found["take"] == "curve"
    for method, bound in (("analytic", analytic), ("geometric", geometric)):
        moments = (found["curve"] if is_curve else found)[method]
        pairs = [(moments[key], wanted) for key, wanted in own[method].items()]
        pairs += [(found[build][method], own[build][method]) for build in ("nominal", "mean_build") if build in own]
        for value, wanted in pairs:
            seen = np.array(value)[at].tolist() if is_curve else value
            assert seen == pytest.approx(wanted, abs=bound), method
    if "closed_form" in own:
        form = {key: found["analytic_closed_form"][key] for key in own["closed_form"]}
        assert form == pytest.approx(own["closed_form"], abs=PRINTED)
    if "shares" in own:
        shares = {row["name"]: row["analytic_percent"] for row in found["contributors"]}
        assert shares == pytest.approx(own["shares"], abs=0.01)


def assert_all_met(
    run: Run, scene: str, geometric: float, analytic: float = PRINTED, *, at: int | slice = slice(None)
) -> None:
    """All measures of a run of a scene have the numbers of the file beside it, and as many trials as it says are built.

    Args:
        run: on the trials of the file.
        scene: of `scenes/`.
        geometric, analytic, at: as of assert_met.
    """
    summary, trials = run.summary, expected(scene)["trials"]
    assert sum(summary["status"].values()) == trials
    assert summary["status"]["ok"] == expected(scene).get("built", trials)
    assert list(summary["measures"]) == list(measures_of(scene))
    for name, own in measures_of(scene).items():
        assert_met(summary["measures"][name], own, geometric, analytic, at=at)


def assert_closed_forms_are_there(run: Run, scene: str) -> None:
    """Measures of a run have a closed form where the file beside the scene has one, and only there."""
    own = {name for name, measure in run.summary["measures"].items() if "analytic_closed_form" in measure}
    assert own == {name for name, measure in measures_of(scene).items() if "closed_form" in measure}
