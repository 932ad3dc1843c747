"""Neglected terms of a reducer's analytic method cover its difference from the exact one."""

import numpy as np
import pytest
from places import SCENES

from tol3d import Overrides, load_scene
from tol3d.gearing.cycloid.system import RVSystem
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of


@pytest.mark.slow
def test_bounds_cover_the_methods_differences_at_one_position() -> None:
    """But for a few hundredths of an arc second of third order; 15618 has a pin at the very edge of the window."""
    study = simulation_of(load_scene(SCENES / "rv_250aii.yaml"), Overrides())
    system = study.system
    assert isinstance(system, RVSystem)
    for name in ("transmission error", "lost motion"):
        measure = next(own for own in system.measures if own.name == name)
        for first, count in ((0, 300), (15618, 1)):
            trials = drawn(study, first, count)
            exact, analytic = (
                system.method(each, None).answers(trials, (measure,)).values[name][:, 0]
                for each in ("exact", "analytic")
            )
            off = np.abs(exact - analytic) * measure.per_internal
            (bound,) = system.neglected(measure, trials).values()
            assert np.mean(off <= 1.3 * bound + 0.05 / 60) > 0.99
