"""Peak memory of runs of growing size: it must not grow with the number of trials.

    python benchmarks/memory.py [--trials 100000 400000 1600000] [--engine analytic]

Each run is a process of its own; the operating system's peak resident size is printed.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

SCENE = Path(__file__).resolve().parent.parent / "scenes" / "spur_pair.yaml"


def peak_megabytes(trials: int, engine: str) -> float:
    """Peak resident size [MB] of `tol3d run` with that many trials."""
    with tempfile.TemporaryDirectory() as folder:
        code = (
            "import sys, resource; from tol3d import run_scene, Overrides\n"
            f"study = Overrides(trials={trials}, engine={engine!r})\n"
            f"run_scene({str(SCENE)!r}, overrides=study, out={folder!r} + '/run')\n"
            "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)"
        )
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return float(done.stdout.split()[-1])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, nargs="+", default=[100_000, 400_000, 1_600_000])
    parser.add_argument("--engine", choices=["analytic", "fcl"], default="analytic")
    arguments = parser.parse_args()
    for trials in arguments.trials:
        peak = peak_megabytes(trials, arguments.engine)
        print(f"{trials:>10} trials, {arguments.engine}: {peak:7.0f} MB at the peak")


if __name__ == "__main__":
    main()
