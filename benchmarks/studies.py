"""Whole studies: engines, systems, numbers of trials, workers; trials/s, seconds and memory, beside the naive way.

    python benchmarks/studies.py [--quick] [--hundred-million] [--systems NAME …] [--rounds N] [--most TRIALS] [--warm]

Each row is a process of its own, from the scene to the run on disk. Trials/s are those of the whole simulation stage
(draws, builds, contact, both methods, statistics, writing), as in summary.json; seconds are those of the process;
memory is its peak. "Cold" has an empty cache: kernels are compiled and solids built. The naive way turns whole
tessellated gears in FCL, see whole_gears.py; its rate and FCL's are measured in the same run, so that ratios hold on a
noisy machine. Medians of `--rounds` rounds; the range beside them shows how noisy the machine was.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console
from rich.table import Table
from whole_gears import whole_gears_rate

from tol3d import load_scene
from tol3d.gearing.system import gear_model
from tol3d.simulate import Overrides, simulation_of

SCENES = Path(__file__).resolve().parent.parent / "scenes"
HUNDRED_MILLION = 10**8
TRIALS, QUICK_TRIALS = 8_000_000, 1_000_000
WIDTH = 150  # characters
PROGRAM = """
import json, resource, sys
from tol3d.simulate import Execution, Overrides, run_scene
scene, out, engine, trials, workers, keep = sys.argv[1:]
run = run_scene(scene, out=out, overrides=Overrides(trials=int(trials), engine=engine, witness=0),
                execution=Execution(workers=int(workers), keep_trials=keep == "kept"))
peak = max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
print(json.dumps(run.summary["timing"] | {"peak_mb": peak / 1000}))
"""


@dataclass(frozen=True)
class System:
    """A scene of tol3d's, its measures read as `read` says in the words of scenes, or as they are."""

    scene: str
    read: Mapping[str, str] | None = None


SYSTEMS: Mapping[str, System] = {
    "spur pair": System("spur_pair"),
    "bevel pair, mean section, one tooth": System("bevel_pair", {"read_at": "mean_section", "tooth": "driven"}),
    "bevel pair, mean section, all teeth": System("bevel_pair", {"read_at": "mean_section", "tooth": "all"}),
    "bevel pair, whole face, all teeth": System("bevel_pair", {"read_at": "face", "tooth": "all"}),
}


@dataclass(frozen=True)
class TimedStudy:
    """One row of the table."""

    system: str
    engine: str
    trials: int
    workers: int
    keep: str = "statistics"
    cold: bool = False


@dataclass(frozen=True)
class Found:
    """Cost of a study: trials/s of its simulation stage, s of its process, peak MB."""

    rate: float
    seconds: float
    peak_mb: float


def measured(study: TimedStudy, scene: Path) -> Found:
    """Run a study in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ)
        if study.cold:
            environment["TOL3D_CACHE"] = str(Path(folder) / "cache")
        words = [str(scene), str(Path(folder) / "run"), study.engine, str(study.trials), str(study.workers), study.keep]
        started = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, *words], capture_output=True, text=True, check=True, env=environment
        )
        seconds = time.perf_counter() - started
        timing = json.loads(done.stdout.splitlines()[-1])
        return Found(timing["trials_per_s"], seconds, timing["peak_mb"])


def studies_of(system: str, trials: int) -> tuple[TimedStudy, ...]:
    """The rows of a system, `trials` being those of the largest."""
    return (
        TimedStudy(system, "exact", 2000, 1, cold=True),
        TimedStudy(system, "exact", 2000, 1),
        TimedStudy(system, "exact", trials // 4, 1),
        TimedStudy(system, "exact", trials, 2),
        TimedStudy(system, "exact", trials // 2, 2, "kept"),
        TimedStudy(system, "fcl", 2000, 1),
        TimedStudy(system, "analytic", trials // 4, 2),
    )


def asked(given: argparse.Namespace) -> Iterator[TimedStudy]:
    """The rows that the arguments want; of those that are the same the first."""
    trials = QUICK_TRIALS if given.quick else TRIALS
    rows = [study for system in given.systems for study in studies_of(system, trials)]
    if given.hundred_million:
        rows.append(TimedStudy("spur pair", "exact", HUNDRED_MILLION, 2))
    if given.warm:
        rows = [study for study in rows if not study.cold]
    if given.most:
        rows = [replace(study, trials=min(study.trials, given.most)) for study in rows]
    yield from dict.fromkeys(rows)


def scene_of(system: System, folder: Path) -> Path:
    """The file of a system's scene, written to the folder where its measures are read otherwise than in tol3d's."""
    own = SCENES / f"{system.scene}.yaml"
    if system.read is None:
        return own
    scene = load_scene(own).model_dump(mode="json", exclude_unset=True)
    scene["measures"] = {name: {**measure, **system.read} for name, measure in scene["measures"].items()}
    path = folder / f"{'_'.join((system.scene, *system.read.values()))}.yaml"
    path.write_text(json.dumps(scene), encoding="utf-8")  # JSON is YAML too
    return path


def add_row(table: Table, study: TimedStudy, found: Sequence[Found], naive: float) -> None:
    """A row: medians of what was found."""
    rates = sorted(each.rate for each in found)
    rate = statistics.median(rates)
    table.add_row(
        study.system,
        study.engine,
        f"{study.trials:,}",
        str(study.workers),
        study.keep + (", cold" if study.cold else ""),
        f"{rate:,.0f}",
        f"{rates[0]:,.0f} … {rates[-1]:,.0f}",
        f"{rate / naive:,.0f}",
        f"{statistics.median(each.seconds for each in found):.1f}",
        f"{max(each.peak_mb for each in found):.0f}",
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--naive", type=int, default=20, help="trials of the naive way")
    parser.add_argument("--quick", action="store_true", help="an eighth of the trials")
    parser.add_argument("--most", type=int, help="no row has more trials than that")
    parser.add_argument("--systems", nargs="+", choices=SYSTEMS, default=list(SYSTEMS), metavar="NAME")
    parser.add_argument("--warm", action="store_true", help="without the rows that have an empty cache")
    parser.add_argument("--hundred-million", action="store_true", help="a spur study of 10^8 trials too")
    given = parser.parse_args(arguments)
    spur = gear_model(simulation_of(load_scene(SCENES / "spur_pair.yaml"), Overrides(engine="fcl", witness=0)).system)
    naive = statistics.median(whole_gears_rate(spur, given.naive)[0] for _ in range(given.rounds))
    table = Table(title=f"naive way, spur pair: {naive:.1f} trials/s")
    for name in ("system", "engine", "trials", "workers", "keeps", "trials/s", "range", "× naive", "s", "peak MB"):
        table.add_column(name, justify="left" if name in ("system", "engine", "keeps") else "right")
    with tempfile.TemporaryDirectory() as folder:
        for study in asked(given):
            rounds = 1 if study.trials >= HUNDRED_MILLION or study.cold else given.rounds
            scene = scene_of(SYSTEMS[study.system], Path(folder))
            add_row(table, study, [measured(study, scene) for _ in range(rounds)], naive)
    Console(width=WIDTH).print(table)


if __name__ == "__main__":
    main()
