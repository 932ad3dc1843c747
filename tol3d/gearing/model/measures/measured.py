"""From what a scene writes of a measure to the measure."""

from dataclasses import replace
from functools import singledispatch

from tol3d.gearing.model.measure import Measure
from tol3d.gearing.model.model import Model
from tol3d.gearing.model.readings import refuse_idle_teeth
from tol3d.scene import Scene
from tol3d.scene.measure import MeasureEntry


def measure_of(scene: Scene, name: str, model: Model) -> Measure:
    """A measure of a scene on its model, which has all but its measures.

    Raises:
        SceneError: a shaft or an arm that is not on the train, a swing without a load, one tooth that is out of action.
    """
    spec = scene.measures[name]
    measure = measured(spec, scene, name, model)
    refuse_idle_teeth(scene, ("measures", name, "tooth"), measure, model)
    return replace(
        measure,
        lower_limit=None if spec.lower_limit is None else spec.lower_limit.internal,
        upper_limit=None if spec.upper_limit is None else spec.upper_limit.internal,
    )


@singledispatch
def measured(spec: MeasureEntry, scene: Scene, name: str, model: Model) -> Measure:
    """A measure without its limits; each kind registers how it is made.

    Args:
        spec: what the scene writes of it.
        scene, name: where.
        model: what it is read on, without measures yet.

    Raises:
        SceneError: it cannot be read there.
    """
    raise TypeError(f"measures/ has no function for {type(spec).__name__}")
