"""Cost of a trial of an exact study, stage by stage, on one core.

    python benchmarks/stages.py [--trials 65536] [--kept 20000] [--rounds 7]

Prints µs of processor time a trial for the draws, the builds, the contact, the stack-up, the whole block of columns and
its statistics, least of several rounds, for the spur and the bevel pair. For the imports see startup.py.

Then ms for so many kept draws of three scenes where one tolerance changes: all drawn, the changed one drawn again (mean
over the contributors that can be half as wide), the values of all measures and those of the first one.
"""

import argparse
import contextlib
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

from rich.console import Console
from rich.table import Table

from tol3d import InputError, load_scene
from tol3d.analyses.response import Response, response_of
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.meshing.seats import turning_gear
from tol3d.gearing.methods.analytic import analytic_values
from tol3d.gearing.model import Backlash
from tol3d.gearing.system import gear_model
from tol3d.simulate import Overrides, simulation_of
from tol3d.study.effects.regressors import regressors
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.tallies.tally import PILOT_TRIALS, Tally, grids_of
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn

SCENES = Path(__file__).resolve().parent.parent / "scenes"
SYSTEMS = ("spur_pair", "bevel_pair")
TO_MS = 1000  # trials whose cost in µs is that of one in ms
REDRAWN = ("bracket_in_box", "door", "spur_pair")


def cost(stage: Callable[[], object], trials: int, rounds: int) -> float:
    """µs of processor time a trial, least of the rounds."""
    stage()
    found = []
    for _ in range(rounds):
        started = time.thread_time()
        stage()
        found.append(time.thread_time() - started)
    return min(found) / trials * 1e6


def stages(scene: Path, trials: int, rounds: int) -> dict[str, float]:
    """Cost of each stage."""
    simulation = simulation_of(load_scene(scene), Overrides(engine="exact", witness=0))
    system, model = simulation.system, gear_model(simulation.system)
    engine, mesh = exact_engine(model), model.meshes[0]
    method = method_of(simulation, materials_of(simulation))
    block = drawn(simulation, 0, trials)
    made, angles = engine.build(block.deviations), block.positions[mesh.name]
    kinds = [measure.kind for measure in model.measures if isinstance(measure.kind, Backlash)]
    turning = frozenset(gear for kind in kinds if (gear := turning_gear(kind, mesh)))
    columns = columns_of(system, method, block)
    grids = grids_of(system, columns_of(system, method, block.part(0, PILOT_TRIALS)))
    measure = model.measures[0]
    reading = kinds[0].reading
    work: dict[str, Callable[[], object]] = {
        "draws": lambda: drawn(simulation, 0, trials),
        "builds": lambda: engine.build(block.deviations),
        "contact, gap and free turn": lambda: engine.read(made, mesh, reading, angles, turning),
        "stack-up": lambda: analytic_values(model, measure, block),
        "all columns, without draws": lambda: columns_of(system, method, block),
        "regressors of the contributors": lambda: regressors(simulation, measure, columns),
        "statistics, regressors included": lambda: Tally.of(simulation, grids, columns),
    }
    return {name: cost(stage, trials, rounds) for name, stage in work.items()}


def redrawn(scene: Path, trials: int, rounds: int) -> dict[str, float]:
    """Cost of kept draws [ms]."""
    response = response_of(simulation_of(load_scene(scene)))
    kept, others = response.kept(trials), [*_halved(response)]
    first = response.of(response.names[0])
    again = [cost(partial(kept.redrawn, other.draws), TO_MS, rounds) for other in others]
    return {
        "contributors that can be half as wide": len(others),
        "all drawn": cost(lambda: others[0].drawn(trials), TO_MS, rounds),
        "one drawn again": sum(again) / len(again),
        "values of all measures": cost(lambda: response.values(kept.deviations, kept.positions), TO_MS, rounds),
        "values of the first measure": cost(lambda: first.values(kept.deviations, kept.positions), TO_MS, rounds),
    }


def _halved(response: Response) -> Iterator[Response]:
    for name in response.slices:
        with contextlib.suppress(InputError):
            yield response.scaled({name: 0.5})


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=65_536)
    parser.add_argument("--kept", type=int, default=20_000)
    parser.add_argument("--rounds", type=int, default=7)
    given = parser.parse_args(arguments)
    found = {name: stages(SCENES / f"{name}.yaml", given.trials, given.rounds) for name in SYSTEMS}
    _print(f"µs of one core a trial, blocks of {given.trials}", found)
    found = {name: redrawn(SCENES / f"{name}.yaml", given.kept, given.rounds) for name in REDRAWN}
    _print(f"ms of one core, {given.kept} draws", found)


def _print(title: str, found: Mapping[str, Mapping[str, float]]) -> None:
    table = Table(title=title)
    table.add_column("stage")
    for name in found:
        table.add_column(name, justify="right")
    for stage in next(iter(found.values())):
        table.add_row(stage, *(f"{costs[stage]:.3f}" for costs in found.values()))
    Console().print(table)


if __name__ == "__main__":
    main()
