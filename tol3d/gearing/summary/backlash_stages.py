"""Backlash of each mesh as gear drawings state it: what thickness and centre distance leave, then all else, then heat.

Arithmetical limits are those of the worst build found, statistical ones mean ∓ 3 sigma of the analytic method, each by
the tolerances up to its stage alone. The stages are those of DIN 3967.
Correlations that a scene states count in the statistical limits.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, get_args

import numpy as np

from tol3d.gearing.model import Backlash, Measure, Model
from tol3d.gearing.model.model import gear_contributor
from tol3d.gearing.shafts import Mesh
from tol3d.gearing.summary.types import BACKLASH_SYMBOLS, BacklashLimits
from tol3d.gears.cylindrical_pair import Backlashes, CylindricalPair
from tol3d.study.effects.worst_case import WorstBuild
from tol3d.study.effects.worst_cases import worst_cases
from tol3d.study.runs.summary.values import made
from tol3d.study.system.closed_form import ClosedForm
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import INDEPENDENT, Block, Copula
from tol3d.study.system.method import ANALYTIC_METHOD, Method
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC
from tol3d.study.system.positions import AT_RANDOM
from tol3d.study.system.stated import component_slices
from tol3d.study.system.system import System
from tol3d.study.system.trials import Trials
from tol3d.study.trials.correlated import closed_form_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

Stage = Literal["theoretical", "acceptance", "operating"]
STAGES: Final[tuple[Stage, ...]] = get_args(Stage)

CENTRE_DISTANCE: Final = "centre_distance"
THICKNESS: Final = "tooth_thickness"
OPERATING: Final = frozenset({"temperature"})
DRAWS: Final = 16_384
"""Of stages whose moments have no closed form: 3 sigma to 0.6 %."""


SystemOf = Callable[[Model], System]
Only = Callable[[Sequence[Contributor], Measure], System]
"""A system with some of its contributors alone, those left out being nominal, and one measure."""


@dataclass(frozen=True)
class Staged:
    """A system whose contributors are taken stage by stage.

    Args:
        system: with all of them.
        only: makes that of some.
        engine: for arithmetical limits; the analytic method if that is its name.
        distances: names of contributors that decide centre distances.
        copula: which contributors are correlated.
        closed_form: moments of a measure, with its covariances; None where they are drawn, see DRAWS.
    """

    system: System
    only: Only
    engine: str
    distances: frozenset[str]
    copula: Copula = INDEPENDENT
    closed_form: Callable[[Simulation, Measure], ClosedForm | None] = closed_form_of


def backlash_stages(
    model: Model, system_of: SystemOf, engine: str, copula: Copula = INDEPENDENT
) -> list[BacklashLimits]:
    """Limits of the backlash of meshes on parallel axes in which thickness or centre distance has a tolerance.

    Args:
        model: of the gears.
        system_of: makes the system of another model, with fewer tolerances.
        engine: for arithmetical limits; the analytic method if that is its name.
        copula: which contributors are correlated.
    """

    def only(kept: Sequence[Contributor], measure: Measure) -> System:
        return system_of(replace(model, contributors=tuple(map(gear_contributor, kept)), measures=(measure,)))

    distances = frozenset(own.name for own in model.contributors if own.kind == CENTRE_DISTANCE)
    return limits_of_meshes(model.meshes, Staged(system_of(model), only, engine, distances, copula))


def limits_of_meshes(meshes: Sequence[Mesh], staged: Staged) -> list[BacklashLimits]:
    """Limits of the backlash of meshes on parallel axes in a system."""
    found = list[BacklashLimits]()
    for mesh in meshes:
        if isinstance(mesh.pair, CylindricalPair):
            measure = Measure(mesh.name, Backlash("normal_backlash", mesh.name, mesh.driven), AT_RANDOM, "value")
            for stage, kept in _stages(staged, measure):
                found += _rows(mesh.name, stage, _limits(staged, kept, measure, mesh.pair))
    return found


def _rows(mesh: str, stage: Stage, limits: Sequence[Backlashes | None]) -> Iterator[BacklashLimits]:
    keys = ("least_um", "largest_um", "least_3sigma_um", "largest_3sigma_um")
    for place, symbol in enumerate(BACKLASH_SYMBOLS):
        sizes = {key: None if own is None else 1e3 * own[place] for key, own in zip(keys, limits, strict=True)}
        known = {key: own if own is not None and math.isfinite(own) else None for key, own in sizes.items()}
        yield made(BacklashLimits, mesh=mesh, stage=stage, symbol=symbol, **known)


def _stages(staged: Staged, measure: Measure) -> Iterator[tuple[Stage, Sequence[Contributor]]]:
    """Contributors of each stage that has some of its own, and of those before it."""
    by_stage: dict[Stage, list[Contributor]] = {stage: [] for stage in STAGES}
    for own in staged.system.acting(measure):
        by_stage[_stage(own, staged)].append(own)
    kept = list[Contributor]()
    for stage, added in by_stage.items() if by_stage["theoretical"] else ():
        if added:
            kept += added
            yield stage, tuple(kept)


def _stage(contributor: Contributor, staged: Staged) -> Stage:
    if contributor.kind == THICKNESS or contributor.name in staged.distances:
        return "theoretical"
    return "operating" if contributor.kind in OPERATING else "acceptance"


def _limits(
    staged: Staged, kept: Sequence[Contributor], measure: Measure, pair: CylindricalPair
) -> list[Backlashes | None]:
    """Least and largest, arithmetically and statistically."""
    copula = _of(staged.copula, frozenset(own.name for own in kept))
    simulation = Simulation(staged.only(kept, measure), Study(engine=staged.engine), copula=copula)
    system = simulation.system
    method = None if staged.engine == ANALYTIC_METHOD else system.method(staged.engine, None)
    theory = system.method(ANALYTIC_METHOD, system.materials(ANALYTIC_METHOD))
    worst = worst_cases(simulation, method, [measure])[measure.name].get(ANALYTIC if method is None else GEOMETRIC)
    ends = (worst.low, worst.high) if worst is not None else (None, None)
    least, largest = (None if own is None else own.value / measure.per_internal for own in ends)
    form = staged.closed_form(simulation, measure)
    if form is not None:
        mean, sigma = form.mean, form.sigma
    else:
        values = theory.answers(drawn(simulation, 0, DRAWS), (measure,)).values[measure.name]
        mean, sigma = float(np.mean(values)), float(np.std(values))
    low = mean - 3 * sigma if least is None else max(mean - 3 * sigma, least)
    high = mean + 3 * sigma if largest is None else min(mean + 3 * sigma, largest)
    further = _Further(system, method or theory, measure, pair, staged.distances)
    arithmetical = [
        None if own is None or size is None else pair.from_normal(size, further.of(own))
        for own, size in zip(ends, (least, largest), strict=True)
    ]
    return [*arithmetical, pair.from_normal(low), pair.from_normal(high)]


def _of(copula: Copula, names: frozenset[str]) -> Copula:
    """Correlations of some contributors with each other."""
    blocks = list[Block]()
    for block in copula.blocks:
        places = [k for k, name in enumerate(block.names) if name in names]
        if len(places) > 1:
            matrix = tuple(tuple(block.matrix[i][j] for j in places) for i in places)
            blocks.append(Block(tuple(block.names[k] for k in places), matrix))
    return Copula(tuple(blocks))


@dataclass(frozen=True)
class _Further:
    """Reads how much further apart the axes of a pair are in a build."""

    system: System
    method: Method
    measure: Measure
    pair: CylindricalPair
    distances: frozenset[str]

    def of(self, build: WorstBuild) -> float:
        """Distance [mm] by which the axes would be further apart in a build whose backlash is by that alone."""
        slices = component_slices(self.system)
        columns = [slices[own.name] for own in self.system.contributors if own.name in self.distances]
        if not columns:
            return 0.0
        deviations = np.zeros((1, len(build.deviations)))
        for own in columns:
            deviations[0, own] = build.deviations[own]
        values = self.method.answers(Trials(deviations, build.positions), (self.measure,)).values
        return self.pair.further_with(float(values[self.measure.name][0, 0]))
