"""Cycloid reducers per minute: exact first contact of two discs with forty pins over a turn of the output.

    python benchmarks/cycloid.py [--units 1000] [--angles 200] [--rounds 2] [--threads 2]
    python benchmarks/cycloid.py --memory 1000 20000 100000

By the clock and by the processor's own time of a core, least of several rounds; the clock also counts what others do on
the machine. `--memory`: peak memory of whole studies of `rv_250aii`, a range over 200 positions and two more measures,
by one worker, each in a process of its own; it must not grow with trials.

Errors are those of an RV-250AII: every pin and lobe, discs, cranks and carrier. `near`: pins within 2 um of contact are
counted. Blocks of 500 units are drawn before the clock runs and go to threads, as the kernel holds no lock; the last
column is the largest memory of the process.
"""

import argparse
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from rich.console import Console
from rich.table import Table

from tol3d.gearing.cycloid.exact.contact import (
    BOTH,
    AsMade,
    bearings,
    contact_shape,
    first_contact,
    linkage,
    pin_centres,
)
from tol3d.gearing.cycloid.model.profile import DiscProfile, Modification

BLOCK = 500  # units
PROFILE = DiscProfile(40, 114.5, 5.0, 2.2, Modification(-0.02, -0.02 * math.sqrt(1 - (2.2 * 40 / 114.5) ** 2)))
WINDOW, SUN_HELD = 0.7, 1.5


def block(seed: int, units: int) -> AsMade:
    """Reducers with errors on everything."""
    rng = np.random.default_rng(seed)

    def drawn(sd: float, *sizes: int) -> np.ndarray:
        return sd * rng.standard_normal((units, *sizes))

    made = linkage(bearings(
        2.2, 60.0, drawn(0.002, 2, 2), drawn(0.001, 2, 3, 2), drawn(0.0007, 3, 2, 2), drawn(1e-5, 3),
        drawn(0.001, 3, 2), drawn(0.0008, 2),
    ))  # fmt: skip
    pins = pin_centres(114.5, drawn(0.006, 1, 2) + drawn(0.0003, 40, 2))
    return AsMade(made, pins, 5 + drawn(0.0005, 40), drawn(0.0033, 2, 39), drawn(0.0002, 2, 39))


def memory(trials: int) -> tuple[float, float]:
    """Peak memory [MB] and processor's time [s] of a study of `rv_250aii` by one worker."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["-m", "tol3d.cli", "run", "rv_250aii", "--trials", str(trials), "--workers", "1", "--no-trials"]
        study = subprocess.Popen(
            [sys.executable, *words, "--out", f"{folder}/run"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        _, status, used = os.wait4(study.pid, 0)
    if os.waitstatus_to_exitcode(status):
        raise RuntimeError(f"a study of {trials} trials failed")
    return used.ru_maxrss / 1024, used.ru_utime + used.ru_stime


def memory_table(trials: Sequence[int]) -> Table:
    """Peak memory over the number of trials."""
    table = Table(title="Whole studies of rv_250aii")
    for heading in ("trials", "MB", "processor s"):
        table.add_column(heading, justify="right")
    for count in trials:
        most, used = memory(count)
        table.add_row(f"{count:,}", f"{most:,.0f}", f"{used:,.0f}")
    return table


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--units", type=int, default=1000)
    parser.add_argument("--angles", type=int, default=200)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--memory", type=int, nargs="+", help="trials of whole studies, and nothing else")
    given = parser.parse_args(arguments)
    if given.memory:
        Console().print(memory_table(given.memory))
        return
    blocks = [block(seed, min(BLOCK, given.units - seed * BLOCK)) for seed in range(-(-given.units // BLOCK))]
    angles = np.arange(given.angles) * (2 * np.pi * PROFILE.lobes / given.angles)
    table = Table(title=f"Units a minute: {given.units} x {given.angles} crank angles x 2 discs x {PROFILE.pins} pins")
    for heading in ("what", "threads", "a minute", "a minute of a core", "us a position", "MB"):
        table.add_column(heading, justify="left" if heading == "what" else "right")
    for name, senses, deflection in (
        ("one sense", BOTH[:1], -1.0),
        ("both senses", BOTH, -1.0),
        ("both, near", BOTH, 0.002),
    ):
        shape = contact_shape(PROFILE, WINDOW, SUN_HELD, deflection)

        def turn(made: AsMade, shape=shape, senses=senses) -> float:  # type: ignore[no-untyped-def]
            phis = np.broadcast_to(angles, (len(made.pins), given.angles))
            return float(first_contact(shape, made, phis, senses).turns.max())

        turn(block(0, 1))  # compiles
        found = []
        for _ in range(given.rounds):
            clock, used = time.perf_counter(), time.process_time()
            with ThreadPoolExecutor(given.threads) as pool:
                list(pool.map(turn, blocks))
            found.append((time.perf_counter() - clock, time.process_time() - used))
        clock, used = min(each[0] for each in found), min(each[1] for each in found)
        table.add_row(
            name,
            str(given.threads),
            f"{given.units / clock * 60:,.0f}",
            f"{given.units / used * 60:,.0f}",
            f"{used / given.units / given.angles * 1e6:.1f}",
            f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:,.0f}",
        )
    Console().print(table)


if __name__ == "__main__":
    np.seterr(all="raise", under="ignore")
    main()
