"""Backlash of each mesh as gear drawings state it: what thickness and centre distance leave, then all else, then heat.

Arithmetical limits are those of the worst build found, statistical ones mean ∓ 3 sigma of the analytic method, each by
the tolerances up to its stage alone. The stages are those of DIN 3967.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Final, Literal, get_args

import numpy as np

from tol3d.gearing.methods.analytic import analytic_values
from tol3d.gearing.methods.regressors import acting
from tol3d.gearing.model import Backlash, Contributor, Measure, Model
from tol3d.gearing.model.model import gear_contributor
from tol3d.gearing.stack_up import closed_form
from tol3d.gearing.summary.types import BACKLASH_SYMBOLS, BacklashLimits
from tol3d.gears.cylindrical_pair import Backlashes, CylindricalPair
from tol3d.study.effects.worst_case import WorstBuild
from tol3d.study.effects.worst_cases import worst_cases
from tol3d.study.runs.summary.values import made
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC
from tol3d.study.system.positions import AT_RANDOM
from tol3d.study.system.stated import component_slices
from tol3d.study.system.system import System
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

Stage = Literal["theoretical", "acceptance", "operating"]
STAGES: Final[tuple[Stage, ...]] = get_args(Stage)

CENTRE_DISTANCE: Final = "centre_distance"
THEORETICAL: Final = frozenset({"tooth_thickness", CENTRE_DISTANCE})
OPERATING: Final = frozenset({"temperature"})
BY_BORES: Final = "shaft_in_bores"
"""Kind of contributors that stand for the bores of a shaft, of which a model of gears knows no tolerance."""
DRAWS: Final = 16_384
"""Of stages whose moments have no closed form: 3 sigma to 0.6 %."""


SystemOf = Callable[[Model], System]


def backlash_stages(model: Model, system_of: SystemOf, engine: str) -> list[BacklashLimits]:
    """Limits of the backlash of meshes on parallel axes in which thickness or centre distance has a tolerance.

    None of gears in a housing, whose centre distance the bores decide.

    Args:
        model: of the gears.
        system_of: makes the system of another model, with fewer tolerances.
        engine: for arithmetical limits; the analytic method if that is its name.
    """
    found = list[BacklashLimits]()
    for mesh in model.meshes:
        if isinstance(mesh.pair, CylindricalPair):
            measure = Measure(mesh.name, Backlash("normal_backlash", mesh.name, mesh.driven), AT_RANDOM, "value")
            for stage, own in _stages(model, measure):
                found += _rows(mesh.name, stage, _limits(own, measure, mesh.pair, system_of, engine))
    return found


def _rows(mesh: str, stage: Stage, limits: Sequence[Backlashes | None]) -> Iterator[BacklashLimits]:
    keys = ("least_um", "largest_um", "least_3sigma_um", "largest_3sigma_um")
    for place, symbol in enumerate(BACKLASH_SYMBOLS):
        sizes = {key: None if own is None else 1e3 * own[place] for key, own in zip(keys, limits, strict=True)}
        known = {key: own if own is not None and math.isfinite(own) else None for key, own in sizes.items()}
        yield made(BacklashLimits, mesh=mesh, stage=stage, symbol=symbol, **known)


def _stages(model: Model, measure: Measure) -> Iterator[tuple[Stage, Model]]:
    """Models with the contributors of each stage that has some of its own, and of those before it."""
    by_stage: dict[Stage, list[Contributor]] = {stage: [] for stage in STAGES}
    every = acting(model, measure)
    if any(own.kind == BY_BORES for own in every):
        return
    for own in every:
        by_stage[_stage(own)].append(own)
    kept = list[Contributor]()
    for stage, added in by_stage.items() if by_stage["theoretical"] else ():
        if added:
            kept += added
            yield stage, replace(model, contributors=tuple(kept), measures=(measure,))


def _stage(contributor: Contributor) -> Stage:
    if contributor.kind in THEORETICAL:
        return "theoretical"
    return "operating" if contributor.kind in OPERATING else "acceptance"


def _limits(
    model: Model, measure: Measure, pair: CylindricalPair, system_of: SystemOf, engine: str
) -> list[Backlashes | None]:
    """Least and largest, arithmetically and statistically."""
    simulation = Simulation(system_of(model), Study(engine=engine))
    method = None if engine == ANALYTIC_METHOD else simulation.system.method(engine, None)
    worst = worst_cases(simulation, method, [measure])[measure.name].get(ANALYTIC if method is None else GEOMETRIC)
    ends = (worst.low, worst.high) if worst is not None else (None, None)
    least, largest = (None if own is None else own.value / measure.per_internal for own in ends)
    form = closed_form(model, measure)
    if form is not None:
        mean, sigma = form.mean, form.sigma
    else:
        values = analytic_values(model, measure, drawn(simulation, 0, DRAWS))
        mean, sigma = float(np.mean(values)), float(np.std(values))
    low = mean - 3 * sigma if least is None else max(mean - 3 * sigma, least)
    high = mean + 3 * sigma if largest is None else min(mean + 3 * sigma, largest)
    arithmetical = [
        None if own is None or size is None else pair.from_normal(size, _further(simulation.system, own))
        for own, size in zip(ends, (least, largest), strict=True)
    ]
    return [*arithmetical, pair.from_normal(low), pair.from_normal(high)]


def _further(system: System, build: WorstBuild) -> float:
    """Sum of the deviations of the centre distance in a build [mm]."""
    slices = component_slices(system)
    own = (slices[each.name] for each in system.contributors if gear_contributor(each).kind == CENTRE_DISTANCE)
    return float(sum(build.deviations[columns].sum() for columns in own))
