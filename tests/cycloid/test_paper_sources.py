"""Contributors of scenes as sources of the published formula."""

import pytest
from rv_250 import TOLERANCES

from tol3d.gearing.cycloid.reducer.formula import RUN_OUTS, SOURCES, PaperSources, sigma_of


def test_standard_deviations_scale_back_to_the_tolerances_that_they_came_of() -> None:
    drawn = [(f"own {source}", effect, sigma_of(source, TOLERANCES[source])) for effect, source in SOURCES.items()]
    found = PaperSources.of([*drawn, ("lapped pins", "pin radius", 0.001)])
    assert dict(found.tolerances) == pytest.approx(TOLERANCES, rel=1e-14)
    assert found.left_out == ("lapped pins",)


def test_two_contributors_to_one_source_add_up_by_squares() -> None:
    found = PaperSources.of([("a", "disc offset", 0.003), ("b", "disc offset", 0.004)])
    assert "disc run-out" in RUN_OUTS
    assert dict(found.tolerances) == pytest.approx({"disc run-out": 6 * 0.005})
