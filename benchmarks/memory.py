"""Peak memory of runs of growing size: it must not grow with the number of trials.

    python benchmarks/memory.py [--trials 100000 400000 1600000] [--engine exact] [--scenes spur_pair door …]

Each run is a process of its own; the operating system's peak resident size is printed.
"""

import argparse
from collections.abc import Sequence

from studies import SCENES, TimedStudy, measured


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, nargs="+", default=[100_000, 400_000, 1_600_000])
    parser.add_argument("--engine", choices=["exact", "analytic", "fcl"], default="exact")
    parser.add_argument("--scenes", nargs="+", default=["spur_pair", "door", "two_plates"])
    given = parser.parse_args(arguments)
    for scene in given.scenes:
        for trials in given.trials:
            peak = measured(TimedStudy(scene, given.engine, trials, 1, "kept"), SCENES / f"{scene}.yaml").peak_mb
            print(f"{scene:>12}, {trials:>10} trials, {given.engine}: {peak:7.0f} MB at the peak")


if __name__ == "__main__":
    main()
