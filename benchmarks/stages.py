"""Cost of a trial of an exact study, stage by stage, on one core.

    python benchmarks/stages.py [--trials 65536] [--rounds 7]

Prints µs of processor time a trial for the draws, the builds, the contact, the stack-up, the whole block of columns and
its statistics, least of several rounds, for the spur and the bevel pair. For the imports see startup.py.
"""

import argparse
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

from tol3d import load_scene
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.meshing.backlash import turning_gear
from tol3d.gearing.methods.analytic import analytic_values
from tol3d.gearing.model import Backlash
from tol3d.gearing.system import gear_model
from tol3d.simulate import Overrides, simulation_of
from tol3d.study.columns import columns_of
from tol3d.study.draws import drawn
from tol3d.study.regressors import regressors
from tol3d.study.tally import PILOT_TRIALS, Tally, grids_of
from tol3d.study.task import materials_of, method_of

SCENES = Path(__file__).resolve().parent.parent / "scenes"
SYSTEMS = ("spur_pair", "bevel_pair")


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


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=65_536)
    parser.add_argument("--rounds", type=int, default=7)
    given = parser.parse_args(arguments)
    found = {name: stages(SCENES / f"{name}.yaml", given.trials, given.rounds) for name in SYSTEMS}
    table = Table(title=f"µs of one core a trial, blocks of {given.trials}")
    table.add_column("stage")
    for name in found:
        table.add_column(name, justify="right")
    for stage in found["spur_pair"]:
        table.add_row(stage, *(f"{costs[stage]:.3f}" for costs in found.values()))
    Console().print(table)


if __name__ == "__main__":
    main()
