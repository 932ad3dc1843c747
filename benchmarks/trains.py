"""Whole trains: trials/s of the exact engine, from the scene to the run on disk, statistics only.

    python benchmarks/trains.py [--quick] [--rounds N]

A trial is a whole train: all of its meshes brought to contact and read, every measure on both roads. Trials/s are those
of the whole simulation stage (draws, builds, contact, statistics, writing), as summary.json tells them; contacts/s are
those times the contacts of a trial, a mesh at a position each. Each row is a process of its own; medians of the rounds,
their range beside them.
"""

import argparse
import statistics

from rich.console import Console
from rich.table import Table
from studies import SCENES, Study, measured

from tol3d import load_scene
from tol3d.block import positions_in_all
from tol3d.study import Overrides, effective_model

TARGET = 200_000  # trials/s of the shoulder on two workers

TRAINS = {
    "robot shoulder": SCENES / "robot_shoulder.yaml",
    "indexing table": SCENES / "three_stage_train.yaml",
    "split torque": SCENES / "split_train.yaml",
    "robot over its swing": SCENES / "robot_shoulder_swing.yaml",  # 25 positions, each as much as a trial
}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--quick", action="store_true", help="an eighth of the trials")
    arguments = parser.parse_args()
    trials = 500_000 if arguments.quick else 4_000_000
    table = Table(title=f"whole trains, exact engine; wanted: {TARGET:,} trials/s of the shoulder on two workers")
    for name in ("train", "trials", "workers", "trials/s", "range", "contacts/s", "process s", "peak MB"):
        table.add_column(name, justify="left" if name == "train" else "right")
    for train, scene in TRAINS.items():
        contacts = positions_in_all(effective_model(load_scene(scene), Overrides(witness=0)))
        for workers in (1, 2):
            study = Study(train, "exact", trials * workers // contacts, workers)
            found = [measured(study, scene) for _ in range(arguments.rounds)]
            rates = sorted(each.rate for each in found)
            rate = statistics.median(rates)
            table.add_row(
                train,
                f"{study.trials:,}",
                str(workers),
                f"{rate:,.0f}",
                f"{rates[0]:,.0f} … {rates[-1]:,.0f}",
                f"{rate * contacts:,.0f}",
                f"{statistics.median(each.seconds for each in found):.1f}",
                f"{max(each.peak_mb for each in found):.0f}",
            )
    Console(width=130).print(table)


if __name__ == "__main__":
    main()
