"""Trials and columns of a model of gears, without a scene's study around them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d import Scene
from tol3d.gearing.engines import Engine
from tol3d.gearing.methods.geometric import GeometricMethod
from tol3d.gearing.model import Measure as GearMeasure
from tol3d.gearing.model import Model
from tol3d.gearing.stack_up import closed_form
from tol3d.gearing.system import GearSystem, gear_model
from tol3d.simulate import Overrides, load, simulation_of
from tol3d.study.system.closed_form import ClosedForm
from tol3d.study.system.measure import Measure
from tol3d.study.system.trials import Trials
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study


def simulated(model: Model, **study: Any) -> Simulation:
    """A model with a study of it."""
    return Simulation(GearSystem(model), replace(Study(options={"profile_steps": model.profile_steps}), **study))


def model_of_scene(scene: Scene | Path | str, overrides: Overrides = Overrides()) -> Model:  # noqa: B008
    """Model that a run simulates, refused where a run refuses it."""
    return gear_model(simulation_of(load(scene), overrides).system)


def drawn_trials(model: Model, seed: int, first: int, count: int, **study: Any) -> Trials:
    """Trials first ... first + count - 1 as the seed draws them."""
    return drawn(simulated(model, seed=seed, **study), first, count)


def gear_columns(
    model: Model, engine: Engine | None, trials: Trials, measures: Sequence[Measure] | None = None
) -> Mapping[str, NDArray[Any]]:
    """All columns of some trials, by an engine and the stack-up."""
    method = None if engine is None else GeometricMethod(model, engine)
    return columns_of(GearSystem(model), method, trials, measures)


def first_shafts_at(model: Model, angle: float, count: int) -> Mapping[str, NDArray[np.float64]]:
    """Driver angles [rad] (count,) by mesh, of shafts that all stand alike."""
    return {mesh.name: np.full(count, angle) for mesh in model.meshes}


def measure_of(model: Model, name: str) -> GearMeasure:
    """A measure by its name."""
    return next(measure for measure in model.measures if measure.name == name)


def form_of(model: Model, name: str) -> ClosedForm:
    """Closed form of a measure, which must have one."""
    form = closed_form(model, measure_of(model, name))
    assert form is not None
    return form
