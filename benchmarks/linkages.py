"""Closed loops a second: the kernel alone, a method that reads one pose, and a path of many poses.

    python benchmarks/linkages.py [--trials 20000] [--rounds 3] [--poses 2000] [--along 50] [--scene spherical_drive]

By the clock and by the processor's own time of one core, least of several rounds. The kernel gets what the exact method
hands it for one pose: frames of all joints, the nominal pose and the inputs of each trial. A method makes frames of
deviations and reads the measure. A path is read in all its poses in a few trials; making its system, which looks for
the nominal pose of each, is timed by itself; a read is one pose of one trial.
"""

import argparse
import re
import resource
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from rich.console import Console
from rich.table import Table

from tol3d import Overrides, load_scene
from tol3d.assembly.linkage.closing import loops_closed
from tol3d.study.system.measure import Measure
from tol3d.study.system.trials import Trials
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

SCENES = Path(__file__).resolve().parent.parent / "scenes"
POSES = 14
"""Place of the poses that are found among the kernel's arguments."""
STEPS = re.compile(r"(path: \[[^\]]*\], steps: )\d+")


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


def kernel_calls(answering: Callable[[], object]) -> list[tuple[Any, ...]]:
    """Arguments that the method hands the kernel as it answers."""
    found = list[tuple[Any, ...]]()

    def noted(*arguments: Any) -> None:
        found.append(arguments)
        loops_closed(*arguments)

    with patch("tol3d.assembly.linkage.loop.loops_closed", noted):
        answering()
    return found


def closing(calls: Sequence[tuple[Any, ...]]) -> None:
    """The kernel alone, block by block."""
    for call in calls:
        loops_closed(*call)


def with_poses(scene: Path, poses: int, folder: Path) -> Path:
    """The scene with so many poses on each of its paths, in a folder."""
    found = folder / scene.name
    found.write_text(STEPS.sub(rf"\g<1>{poses - 1}", scene.read_text("utf-8")), "utf-8")
    return found


def over_paths(measures: Sequence[Measure]) -> Sequence[Measure]:
    """Those that are read over a path."""
    return [own for own in measures if own.take != "value"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=20_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--poses", type=int, default=2000, help="of each path")
    parser.add_argument("--along", type=int, default=50, help="trials that are read over a path")
    parser.add_argument("--scene", default="spherical_drive")
    given = parser.parse_args(arguments)
    path = SCENES / f"{given.scene}.yaml"
    simulation = simulation_of(load_scene(path), Overrides(trials=given.trials))
    system, trials = simulation.system, drawn(simulation, 0, given.trials)
    table = Table(title=f"{given.scene}: a second by the clock, and of the processor")
    for heading in ("what", "of", "clock", "processor"):
        table.add_column(heading, justify="left" if heading == "what" else "right", no_wrap=True)

    def row(what: str, of: str, count: int, spent: tuple[float, float]) -> None:
        table.add_row(what, of, *(f"{count / seconds:,.0f}" for seconds in spent))

    methods = {name: system.method(name, system.materials(name)) for name in ("exact", "analytic")}
    for measure in [own for own in system.measures if own.take == "value"]:
        made = methods["exact"]
        calls = kernel_calls(lambda: made.answers(trials, [measure]))  # noqa: B023
        count = sum(len(call[POSES]) for call in calls)
        row(f"kernel, {measure.name}", "loops", count, least(given.rounds, lambda: closing(calls)))  # noqa: B023
        for name, method in methods.items():
            spent = least(given.rounds, lambda: method.answers(trials, [measure]))  # noqa: B023
            row(f"{name} method, {measure.name}", "trials", given.trials, spent)

    with tempfile.TemporaryDirectory() as folder:
        scene = load_scene(with_poses(path, given.poses, Path(folder)))
        clock, used = time.perf_counter(), sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
        along = simulation_of(scene, Overrides(trials=given.along))
        used = sum(resource.getrusage(resource.RUSAGE_SELF)[:2]) - used
        row(f"system of paths of {given.poses} poses", "poses", given.poses, (time.perf_counter() - clock, used))
        few: Trials = drawn(along, 0, given.along)
        for measure in over_paths(along.system.measures)[:1]:
            for name in methods:
                method = along.system.method(name, along.system.materials(name))
                spent = least(1, lambda: method.answers(few, [measure]))  # noqa: B023
                row(f"{name} method, {measure.name}", "reads", given.poses * given.along, spent)
    Console().print(table)


if __name__ == "__main__":
    np.seterr(all="raise", under="ignore")
    main()
