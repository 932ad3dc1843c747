"""Reducers per second: free turns of placed gears, of first-order gaps, whole studies, and scenes by each method.

    python benchmarks/planetary.py [--trials 200000] [--rounds 3] [--workers 2]
    python benchmarks/planetary.py --methods 200 [--rounds 3]

By the clock and by the processor's own time, least of several rounds. A train of `reducer_3k` has 24 flanks; both ends
of the output's turn are two linear programmes over six turns. The study draws 45 deviations, goes both methods of both
lost motions, and takes its statistics; errors over a turn are counted by themselves, in positions a second.

`--methods` prints another table and nothing else: all measures of scenes with reducers, so many trials of each, by the
analytic and by the exact method, each apart, by one thread. Trials a second are those of the processor's own time; each
round has trials of its own, for a machine knows builds again. Compare them with those of another tree, run in turn.
"""

import argparse
import resource
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from tol3d import Overrides, load_scene, run_scene
from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.from_scene import planetary_system
from tol3d.study.execution.pools import Execution
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

POSITIONS = 360
REDUCERS = ("rv_250aii", "reducer_3k", "robot_arm")
SCENE = Path(__file__).resolve().parent.parent / "scenes" / "reducer_3k.yaml"


def least(rounds: int, what: Callable[[], object]) -> tuple[float, float]:
    """Seconds by the clock and of the processor."""
    what()  # compiles
    found = []
    for _ in range(rounds):
        clock, used = time.perf_counter(), sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
        what()
        spent = sum(resource.getrusage(resource.RUSAGE_SELF)[:2]) - used
        found.append((time.perf_counter() - clock, spent))
    return min(clock for clock, _ in found), min(used for _, used in found)


def methods_table(trials: int, rounds: int) -> Table:
    """Trials a second of scenes by each method, without draws and statistics; the quickest of some rounds."""
    table = Table(title=f"all measures of {trials} trials, one thread: trials a second of the processor")
    for heading in ("scene", "analytic", "exact"):
        table.add_column(heading, justify="left" if heading == "scene" else "right", no_wrap=True)
    for name in REDUCERS:
        simulation = simulation_of(load_scene(SCENE.with_name(f"{name}.yaml")), Overrides(trials=trials))
        system, rates = simulation.system, []
        for kind in ("analytic", "exact"):
            method = system.method(kind, system.materials(kind))
            method.answers(drawn(simulation, 0, 1), system.measures)  # compiles
            spent = []
            for part in range(1, rounds + 1):
                own = drawn(simulation, part * trials, trials)
                began = time.process_time()
                method.answers(own, system.measures)
                spent.append(time.process_time() - began)
            rates.append(f"{trials / min(spent):,.0f}")
        table.add_row(name, *rates)
    return table


def lost_motions_alone(scene: str) -> str:
    """A scene without its transmission errors and published columns."""
    first, last = scene.index("  transmission error:"), scene.index("\nstudy:")
    return scene[:first] + scene[last : scene.index("published:")]


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=200_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--methods", type=int, help="trials of scenes by each method, and nothing else")
    given = parser.parse_args(arguments)
    if given.methods:
        Console().print(methods_table(given.methods, given.rounds))
        return
    scene = load_scene(SCENE)
    system = planetary_system(scene)
    trials = drawn(simulation_of(scene, Overrides(trials=given.trials)), 0, given.trials)
    deviated, turns = system.deviated(trials), trials.positions[system.own.name]
    table = Table(title=f"{given.trials} trials of reducer_3k: trains a second")
    for heading in ("what", "workers", "by the clock", "of a processor"):
        table.add_column(heading, justify="left" if heading == "what" else "right", no_wrap=True)
    own = system.own
    for name, turning in (("programme, first order", StackUp(own)), ("programme, placed gears", Contact(own))):
        clock, used = least(given.rounds, lambda: turning.free(deviated, turns, own.output, own.input))  # noqa: B023
        table.add_row(name, "1", f"{given.trials / clock:,.0f}", f"{given.trials / used:,.0f}")

    count = max(1, given.trials // POSITIONS)
    around, some = np.arange(POSITIONS) / POSITIONS, system.deviated(trials.part(0, count))
    for name, method in (
        ("a turn's positions, first order", StackUp(own)),
        ("the same, placed", Contact(own)),
    ):
        clock, used = least(given.rounds, lambda: method.followed(some, around, own.output, own.input, 0))  # noqa: B023
        table.add_row(name, "1", f"{count * POSITIONS / clock:,.0f}", f"{count * POSITIONS / used:,.0f}")

    def study() -> None:
        with tempfile.TemporaryDirectory() as out:
            execution = Execution(workers=given.workers, keep_trials=False)
            alone = Path(out) / "scene.yaml"
            alone.write_text(lost_motions_alone(SCENE.read_text("utf-8")), "utf-8")
            run_scene(alone, out=Path(out) / "run", overrides=Overrides(trials=given.trials), execution=execution)

    clock, used = least(given.rounds, study)
    table.add_row(
        "whole study, both methods", str(given.workers), f"{given.trials / clock:,.0f}", f"{given.trials / used:,.0f}"
    )
    Console().print(table)


if __name__ == "__main__":
    np.seterr(all="raise", under="ignore")
    main()
