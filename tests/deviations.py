"""Standard deviations of the measures of a scene by its exact method, of builds that can all be assembled."""

from pathlib import Path

import numpy as np
from scene_texts import scene_of

from tol3d.simulate import Overrides, simulation_of
from tol3d.study.trials.draws import drawn


def deviating(text: str, folder: Path) -> dict[str, float]:
    """Standard deviation of each measure, exactly [mm]."""
    simulation = simulation_of(scene_of(text, folder), Overrides())
    method = simulation.system.method("exact", simulation.system.materials("exact"))
    answers = method.answers(drawn(simulation, 0, 64), simulation.system.measures)
    assert all((codes == 0).all() for codes in answers.status.values())
    return {name: float(np.std(values)) for name, values in answers.values.items()}
