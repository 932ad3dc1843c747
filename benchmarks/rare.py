"""Cost of a small probability, and coverage of its interval: the spur pair below 15 µm.

    python benchmarks/rare.py [--seeds 100] [--level 14000]

Prints, over so many seeds of importance sampling, how often its interval of 95 % holds 0.0507 ppm, the mean and the
spread of the results, the largest standard error and the builds; then first order, and subset simulation once.
"""

import argparse
import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from rich.console import Console

from tol3d.analyses.rare_events import RareEvent, rare_event
from tol3d.analyses.response import response_of
from tol3d.simulate import load, simulation_of

EXACT: Final = 0.0507e-6
"""By 10^10 draws of a formula of its own, within 0.5 %."""
LIMIT: Final = 15.0  # um


def main(arguments: Sequence[str] | None = None) -> None:
    """Print it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--level", type=int, default=14_000, help="draws of a level of subset simulation")
    asked = parser.parse_args(arguments)
    console, response = Console(width=120), response_of(simulation_of(load("spur_pair"))).of("normal backlash")
    found = [rare_event(response, "low", LIMIT, seed=seed) for seed in range(asked.seeds)]
    ppm = 1e6 * np.array([own.probability for own in found])
    errors = np.array([own.error / own.probability for own in found])
    held = sum(_holds(own) for own in found)
    console.print(f"importance sampling: {held} of {len(found)} intervals hold {1e6 * EXACT:.4f} ppm")
    console.print(f"mean {ppm.mean():.4f} ppm, spread {100 * ppm.std() / ppm.mean():.1f} %")
    console.print(f"standard error {100 * errors.mean():.1f} %, at most {100 * errors.max():.1f} %")
    console.print(f"builds: at most {max(own.evaluations for own in found)}")
    first = found[0].first_order
    console.print(f"first order: {1e6 * first if first else math.nan:.4f} ppm")
    subset = rare_event(response, "low", LIMIT, method="subset", draws=asked.level)
    share = 100 * subset.error / subset.probability if subset.probability else math.nan
    words = f"{1e6 * subset.probability:.4f} ppm, standard error {share:.0f} %, {subset.evaluations} builds"
    console.print(f"subset simulation: {words}")


def _holds(own: RareEvent) -> bool:
    return own.interval[0] <= EXACT <= own.interval[1]


if __name__ == "__main__":
    main()
