"""Duration of `tol3d run spur_pair`, cold and warm, and cost of its imports.

    python benchmarks/startup.py [--runs 5] [--cold] [--ways NAME …] [--packages NAME …]

The cost of a package is the time of its own modules, as `python -X importtime` gives it, in the process of a plain run;
the picture's process is not in it, for it loads beside the study. Below stand packages that have no place on that path,
each with what it would cost. Measured on two cores with nothing else running (2000 trials, exact, 20 of them measured
again by FCL, with the picture): 2.2 s warm, 11.7 s cold. Imports, in ms:

                          the picture in the same process    in one of its own
    matplotlib and its own                            430                    -
    pandas and its own (pyarrow asked it)             190                    -
    joblib and its own                                 40                    -
    all                                              1330                  870
    whole command [s]                                 2.8                  2.2
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path

RUN = ("-m", "tol3d.cli", "run", "spur_pair")
LINE = re.compile(r"import time:\s+(\d+) \|\s+(\d+) \| +(\S+)")
SHOWN = 16
WAYS: Mapping[str, tuple[str, ...]] = {
    "as it is": (),
    "without the witness": ("--witness", "0"),
    "without the picture": ("--no-picture",),
    "without both": ("--witness", "0", "--no-picture"),
    "--engine analytic, without the picture": ("--engine", "analytic", "--no-picture"),
    "--engine fcl": ("--engine", "fcl"),
}
LEFT_OUT = ("scipy.stats", "pint", "matplotlib.figure", "cadquery", "pyvista", "trimesh", "distributed", "pandas")


def seconds(arguments: tuple[str, ...], cache: str | None = None) -> float:
    """Wall time of a command [s], in a folder of its own; `cache` is where strips and kernels are kept."""
    environment = os.environ | ({"TOL3D_CACHE": cache} if cache else {})
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        subprocess.run([sys.executable, *arguments], check=True, capture_output=True, cwd=folder, env=environment)
        return time.perf_counter() - started


def imports(arguments: tuple[str, ...]) -> list[tuple[str, int]]:
    """Modules that a command imports, each with its own time [us]."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-X", "importtime", *arguments]
        done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=folder)
    return [(found[3], int(found[1])) for line in done.stderr.splitlines() if (found := LINE.match(line))]


def print_walls(runs: int, ways: Sequence[str]) -> None:
    """Warm wall times, smallest and median."""
    for way in ways:
        taken = sorted(seconds((*RUN, *WAYS[way])) for _ in range(runs))
        print(f"  {way:40} {taken[0]:5.2f} s   (median {taken[runs // 2]:.2f} s)")
    print(f"  {'tol3d --help':40} {min(seconds(('-m', 'tol3d.cli', '--help')) for _ in range(runs)):5.2f} s")


def print_imports(packages: Sequence[str]) -> None:
    """Print the cost of a plain run's imports, by package, and that of other packages."""
    found = imports((*RUN, "--witness", "0", "--no-picture"))
    own: Counter[str] = Counter()
    for module, us in found:
        own[module.partition(".")[0]] += us
    print(f"imports of a plain run: {sum(own.values()) / 1000:.0f} ms in {len(found)} modules")
    for package, us in own.most_common(SHOWN):
        print(f"  {package:24} {us / 1000:7.1f} ms")
    rest = sum(us for _, us in own.most_common()[SHOWN:])
    print(f"  {f'{len(own) - SHOWN} others':24} {rest / 1000:7.1f} ms")
    loaded = {module for module, _ in found}
    print("not on that path:")
    for package in packages:
        if find_spec(package.partition(".")[0]) is None:
            print(f"  {package:24}   not installed")
            continue
        cost = sum(us for _, us in imports(("-c", f"import {package}")))
        print(f"  {package:24} {cost / 1000:7.1f} ms{'   (LOADED)' if package in loaded else ''}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=5, help="warm runs, of which the quickest counts")
    parser.add_argument("--cold", action="store_true", help="also once without anything in the cache")
    parser.add_argument("--ways", nargs="+", choices=WAYS, default=list(WAYS), metavar="NAME")
    parser.add_argument("--packages", nargs="+", default=list(LEFT_OUT), metavar="NAME")
    given = parser.parse_args(arguments)
    print(f"{os.cpu_count()} cores, Python {sys.version.split()[0]}, {Path(sys.executable)}")
    if given.cold:
        with tempfile.TemporaryDirectory() as cache:
            print(f"tol3d run spur_pair, cold: CAD, strips and kernels made, {seconds(RUN, cache):.1f} s")
            print(f"  the second time {seconds(RUN, cache):.2f} s")
    seconds(RUN)
    print("tol3d run spur_pair, warm:")
    print_walls(given.runs, given.ways)
    print_imports(given.packages)


if __name__ == "__main__":
    main()
