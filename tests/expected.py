"""Numbers kept beside the scenes, in scenes/*.expected.toml, and runs that meet them."""

import tomllib
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, Final

import numpy as np
import pytest
from places import SCENES

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
