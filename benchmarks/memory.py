"""Peak memory of runs of growing size: it must not grow with the number of trials.

    python benchmarks/memory.py [--trials 100000 400000 1600000] [--engine exact]

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
    given = parser.parse_args(arguments)
    for trials in given.trials:
        peak = measured(TimedStudy("spur pair", given.engine, trials, 1, "kept"), SCENES / "spur_pair.yaml").peak_mb
        print(f"{trials:>10} trials, {given.engine}: {peak:7.0f} MB at the peak")


if __name__ == "__main__":
    main()
