"""Whole trains: trials/s of the exact engine, from the scene to the run on disk, statistics only.

    python benchmarks/trains.py [--quick] [--rounds N] [--trains NAME …] [--contacts N]

A trial is a whole train: all of its meshes brought to contact and read, every measure by both methods. Trials/s are
of the whole simulation stage (draws, builds, contact, statistics, writing), as in summary.json; contacts/s are
those times the contacts of a trial, a mesh at a position each. Each row is a process of its own; medians of the rounds,
their range beside them.
"""

import argparse
import statistics
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table
from studies import SCENES, TimedStudy, measured

from tol3d import load_scene
from tol3d.simulate import Overrides, simulation_of
from tol3d.study.results.task import contacts_of

TARGET = 200_000  # trials/s of the shoulder on two workers
CONTACTS, QUICK_CONTACTS = 4_000_000, 500_000  # of each worker
WIDTH = 130  # characters

TRAINS: Mapping[str, Path] = {
    "robot shoulder": SCENES / "robot_shoulder.yaml",
    "indexing table": SCENES / "three_stage_train.yaml",
    "split torque": SCENES / "split_train.yaml",
    "robot over its swing": SCENES / "robot_shoulder_swing.yaml",  # 25 positions, each as much as a trial
}


def add_rows(table: Table, train: str, contacts: int, rounds: int) -> None:
    """A train on one worker and on two, each with that many contacts."""
    scene = TRAINS[train]
    of_a_trial = contacts_of(simulation_of(load_scene(scene), Overrides(witness=0)))
    for workers in (1, 2):
        study = TimedStudy(train, "exact", contacts * workers // of_a_trial, workers)
        found = [measured(study, scene) for _ in range(rounds)]
        rates = sorted(each.rate for each in found)
        rate = statistics.median(rates)
        table.add_row(
            train,
            f"{study.trials:,}",
            str(workers),
            f"{rate:,.0f}",
            f"{rates[0]:,.0f} … {rates[-1]:,.0f}",
            f"{rate * of_a_trial:,.0f}",
            f"{statistics.median(each.seconds for each in found):.1f}",
            f"{max(each.peak_mb for each in found):.0f}",
        )


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--quick", action="store_true", help="an eighth of the trials")
    parser.add_argument("--trains", nargs="+", choices=TRAINS, default=list(TRAINS), metavar="NAME")
    parser.add_argument("--contacts", type=int, help="of each worker, instead of millions")
    given = parser.parse_args(arguments)
    contacts = given.contacts or (QUICK_CONTACTS if given.quick else CONTACTS)
    table = Table(title=f"whole trains, exact engine; wanted: {TARGET:,} trials/s of the shoulder on two workers")
    for name in ("train", "trials", "workers", "trials/s", "range", "contacts/s", "process s", "peak MB"):
        table.add_column(name, justify="left" if name == "train" else "right")
    for train in given.trains:
        add_rows(table, train, contacts, given.rounds)
    Console(width=WIDTH).print(table)


if __name__ == "__main__":
    main()
