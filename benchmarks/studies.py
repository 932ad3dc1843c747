"""Whole studies: engines, systems, numbers of trials, workers; trials/s, seconds and memory, beside the naive way.

    python benchmarks/studies.py [--quick] [--hundred-million]

Each row is a process of its own, from the scene to the run on disk. Trials/s are those of the whole simulation stage
(draws, builds, contact, both roads, statistics, writing), as summary.json tells them; seconds are those of the process;
memory is its peak. "Cold" has an empty cache: kernels are compiled and solids built. The naive way turns whole
tessellated gears in FCL, see fcl_speed.py; its rate and FCL's are measured in the same run, so that ratios hold on a
noisy machine. Medians of `--rounds` rounds; the range beside them tells how noisy the machine was.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from fcl_speed import naive_rate
from rich.console import Console
from rich.table import Table

from tol3d import load_scene
from tol3d.study import Overrides, effective_model

SCENES = Path(__file__).resolve().parent.parent / "scenes"
WHOLE_FACE = (
    "kind: normal_backlash, of: bevel pair,",
    "kind: normal_backlash, of: bevel pair, read_at: face, tooth: all,",
)
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
class Study:
    """One row of the table."""

    system: str
    engine: str
    trials: int
    workers: int
    keep: str = "statistics"
    cold: bool = False


@dataclass(frozen=True)
class Found:
    """What a study took: trials/s of its simulation stage, s of its process, peak MB."""

    rate: float
    seconds: float
    peak_mb: float


def measured(study: Study, scene: Path) -> Found:
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


def studies(*, quick: bool, huge: bool) -> Iterator[Study]:
    """The rows."""
    many = 1_000_000 if quick else 8_000_000
    for system in ("spur pair", "bevel pair", "bevel pair, whole face, all teeth"):
        yield Study(system, "exact", 2000, 1, cold=True)
        yield Study(system, "exact", 2000, 1)
        yield Study(system, "exact", many // 4, 1)
        yield Study(system, "exact", many, 2)
        yield Study(system, "exact", many // 2, 2, "kept")
        yield Study(system, "fcl", 2000, 1)
        yield Study(system, "analytic", many // 4, 2)
    if huge:
        yield Study("spur pair", "exact", 10**8, 2)


def scenes_in(folder: Path) -> dict[str, Path]:
    """Scene files of the systems; the whole-face one is the bevel pair read otherwise."""
    bevel = (SCENES / "bevel_pair.yaml").read_text(encoding="utf-8")
    whole = bevel.replace(*WHOLE_FACE).replace("{kind: angular_backlash, of: bevel pair}", WHOLE_FACE_TURN)
    if whole.count("read_at: face") != 2:
        raise SystemExit("bevel_pair.yaml reads otherwise than this benchmark expects")
    (folder / "whole_face.yaml").write_text(whole, encoding="utf-8")
    return {
        "spur pair": SCENES / "spur_pair.yaml",
        "bevel pair": SCENES / "bevel_pair.yaml",
        "bevel pair, whole face, all teeth": folder / "whole_face.yaml",
    }


WHOLE_FACE_TURN = "{kind: angular_backlash, of: bevel pair, read_at: face, tooth: all}"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--naive", type=int, default=20, help="trials of the naive way")
    parser.add_argument("--quick", action="store_true", help="an eighth of the trials")
    parser.add_argument("--hundred-million", action="store_true", help="a spur study of 10^8 trials too")
    arguments = parser.parse_args()
    model = effective_model(load_scene(SCENES / "spur_pair.yaml"), Overrides(engine="fcl", witness=0))
    naive = statistics.median(naive_rate(model, arguments.naive)[0] for _ in range(arguments.rounds))
    table = Table(title=f"naive way, spur pair: {naive:.1f} trials/s")
    for name in (
        "system",
        "engine",
        "trials",
        "workers",
        "keeps",
        "trials/s",
        "range",
        "× naive",
        "process s",
        "peak MB",
    ):
        table.add_column(name, justify="left" if name in ("system", "engine", "keeps") else "right")
    with tempfile.TemporaryDirectory() as folder:
        scenes = scenes_in(Path(folder))
        for study in studies(quick=arguments.quick, huge=arguments.hundred_million):
            rounds = 1 if study.trials >= 10**8 or study.cold else arguments.rounds
            found = [measured(study, scenes[study.system]) for _ in range(rounds)]
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
    Console(width=150).print(table)


if __name__ == "__main__":
    main()
