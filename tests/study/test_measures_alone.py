"""A value depends on no other measure: in every bundled scene each measure alone equals itself among all."""

from collections.abc import Mapping

import numpy as np
import pytest
from numpy.typing import NDArray
from places import SCENES

from tol3d.scene import Scene
from tol3d.scene.bases import MeasureEntry
from tol3d.simulate import load, simulation_of
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

COUNT = 6
CHEAP = ("bevel_pair", "box_with_discs", "cover_on_base", "door", "every_bevel_field", "four_pads")
"""Scenes of the default suite, of some 2 s together but for kernels; the others are slow."""
DEAR = ("robot_arm", "stewart")
"""Scenes of dozens of measures, each of which is built alone."""
ROUNDING = 1e-9
"""Of the largest value of a measure: sums of other order, such as of joints that a measure does not depend on."""


def read(scene: Scene, names: Mapping[str, MeasureEntry]) -> dict[tuple[str, str], Array]:
    """Values of measures by both methods, in a scene that has them alone."""
    study = scene.study.model_copy(update={"witness": 0})
    simulation = simulation_of(scene.model_copy(update={"measures": dict(names), "published": {}, "study": study}))
    system, trials = simulation.system, drawn(simulation, 0, COUNT)
    found = dict[tuple[str, str], Array]()
    for method in ("exact", "analytic"):
        if method in system.methods:
            answers = system.method(method, system.materials(method)).answers(trials, system.measures)
            found |= {(method, name): values for name, values in answers.values.items()}
    return found


def with_its_own(scene: Scene, name: str) -> dict[str, MeasureEntry]:
    """A measure, with the two of which it is the difference."""
    spec = scene.measures[name]
    others = [getattr(spec, key, None) for key in ("of", "minus")] if spec.kind == "difference" else []
    found = {name: spec}
    for other in others:
        found |= with_its_own(scene, str(other))
    return found


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name in CHEAP else pytest.mark.nightly if name in DEAR else pytest.mark.slow)
        for name in sorted(own.stem for own in SCENES.glob("*.yaml"))
    ],
)
def test_each_measure_alone_is_itself_among_all(name: str) -> None:
    scene = load(SCENES / f"{name}.yaml")
    every = read(scene, scene.measures)
    for own in scene.measures if len(scene.measures) > 1 else ():
        for key, values in read(scene, with_its_own(scene, own)).items():
            size = float(np.nanmax(np.abs(every[key]), initial=1e-300))
            np.testing.assert_allclose(values, every[key], rtol=0.0, atol=ROUNDING * size, err_msg=f"{key}")
