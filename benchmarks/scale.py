"""Models of hundreds of parts: what whole commands take, how that grows, and how fast parts are placed.

    python benchmarks/scale.py [--sizes 20x40 100x100 300x200 20x8z 100x100z] [--trials 10000] [--growth] [--placing]

Each size is a stack of so many blocks on 3-2-1, six tolerances a block, and so many measures; with z each block has
four zones, too, and a plate floats on two pins of the last. Whole commands are processes of their own, from the scene
to the run on disk with one picture, beside `spur_pair --no-picture`, which tells how fast the machine is. `--growth`
doubles parts and measures; `--placing` measures the 3D simulation alone, on one core, in blocks as a run cuts them;
`--heights` holds corners against the closed form.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from tol3d import open_run
from tol3d.simulate import Overrides, load, simulation_of
from tol3d.study.results.task import block_trials, materials_of, method_of
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

POINTS: Final = {
    "A1": ("10 mm, 10 mm, {z} mm", "0, 0, -1"),
    "A2": ("90 mm, 10 mm, {z} mm", "0, 0, -1"),
    "A3": ("50 mm, 90 mm, {z} mm", "0, 0, -1"),
    "B1": ("10 mm, 0 mm, {up} mm", "0, -1, 0"),
    "B2": ("90 mm, 0 mm, {up} mm", "0, -1, 0"),
    "C1": ("0 mm, 50 mm, {up} mm", "-1, 0, 0"),
}
"""Locators of a block at the height z, and their normals; sides are touched 5 mm up."""
ALONG: Final = ("0, 0, 1", "1, 0, 0", "0, 1, 0")
SIGMA: Final = 0.01
"""Standard deviation of each locator [mm]."""
GROWTH: Final = (("parts", ((75, 20), (150, 20), (300, 20))), ("measures", ((100, 50), (100, 100), (100, 200))))
COMMAND: Final = """
import resource, sys
from tol3d.cli import main
sys.argv = ["tol3d", *sys.argv[1:]]
try:
    main()
finally:
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000, file=sys.stderr)
"""


def stack(parts: int, measures: int, *, zones: bool = False) -> str:
    """YAML of a stack; its measures read blocks from the top down, in three directions in turn."""
    return "\n".join(
        [
            f"scene: {parts} blocks",
            "parts:",
            *(line for k in range(parts) for line in _block(k, zones=zones)),
            *(_plate(parts) if zones else ()),
            "tolerances:",
            *(line for k in range(parts) for line in _tolerances(k, zones=zones)),
            *(_plates_tolerances(parts) if zones else ()),
            "moves:",
            "  machine: {kind: fix, part: block 0}",
            *(line for k in range(1, parts) for line in _move(k)),
            *(_floating(parts) if zones else ()),
            "measures:",
            *(_measure(k, parts, zones=zones) for k in range(measures)),
            "",
        ]
    )


def _block(k: int, *, zones: bool) -> Iterable[str]:
    z = 10 * k
    yield f"  block {k}:"
    yield "    kind: solid"
    yield "    features:"
    for name, (at, normal) in POINTS.items():
        yield f"      {name}: {{kind: point, at: [{at.format(z=z, up=z + 5)}], normal: [{normal}]}}"
    yield f"      corner: {{kind: point, at: [100 mm, 100 mm, {z + 10} mm], normal: [0, 0, 1]}}"
    for name, at, normal, extent in (
        ("top", f"50 mm, 50 mm, {z + 10} mm", "0, 0, 1", "100 mm, 100 mm"),
        ("back", f"50 mm, 0 mm, {z + 15} mm", "0, 1, 0", "100 mm, 10 mm"),
        ("left", f"0 mm, 50 mm, {z + 15} mm", "1, 0, 0", "100 mm, 10 mm"),
    ):
        along = ", along: [0, 1, 0]" if name == "left" else ""
        yield f"      {name}: {{kind: plane, at: [{at}], normal: [{normal}], extent: [{extent}]{along}}}"
    if zones:
        yield f"      bottom: {{kind: plane, at: [50 mm, 50 mm, {z} mm], normal: [0, 0, -1], extent: [100 mm, 100 mm]}}"
        yield _round("hole", 50, z + 5, 20, hole=True)


def _round(name: str, x: int, z: int, diameter: float, *, hole: bool) -> str:
    at = f"[{x} mm, 50 mm, {z} mm]"
    kind = ", hole: true" if hole else ""
    return f"      {name}: {{kind: cylinder, at: {at}, axis: [0, 0, 1], length: 10 mm, diameter: {diameter} mm{kind}}}"


def _plate(parts: int) -> Iterable[str]:
    """Two pins on the last block, and the plate over them."""
    z = 10 * parts
    yield _round("pin 1", 20, z + 5, 9.8, hole=False)
    yield _round("pin 2", 80, z + 5, 9.8, hole=False)
    yield "  plate:"
    yield "    kind: solid"
    yield "    features:"
    yield _round("hole 1", 20, z + 5, 10, hole=True)
    yield _round("hole 2", 80, z + 5, 10, hole=True)
    yield f"      under: {{kind: plane, at: [50 mm, 50 mm, {z} mm], normal: [0, 0, -1], extent: [100 mm, 100 mm]}}"
    yield f"      corner: {{kind: point, at: [100 mm, 100 mm, {z} mm], normal: [0, 0, 1]}}"


def _tolerances(k: int, *, zones: bool) -> Iterable[str]:
    for name in POINTS:
        law = f"{{kind: normal, mean: 0 mm, sigma: {SIGMA} mm}}"
        yield f"  {k} {name}: {{kind: plus_minus, of: block {k}.{name}, distribution: {law}}}"
    if zones:
        uniform = "law: {kind: uniform}"
        yield f"  {k} top: {{kind: profile, of: block {k}.top, zone: {{width: 0.05 mm}}, {uniform}, datums: [bottom]}}"
        yield (
            f"  {k} back: {{kind: perpendicularity, of: block {k}.back, zone: {{width: 0.02 mm}}, {uniform}, "
            "datums: [bottom]}"
        )
        yield f"  {k} hole: {_position(f'block {k}.hole', 'datums: [bottom, back, left]')}"
        yield f"  {k} size: {_size(f'block {k}.hole')}"


def _plates_tolerances(parts: int) -> Iterable[str]:
    last = f"block {parts - 1}"
    for k in (1, 2):
        yield f"  pin {k}: {_position(f'{last}.pin {k}', 'datums: [bottom, back, left]')}"
        yield f"  hole {k}: {_position(f'plate.hole {k}')}"
        yield f"  size of pin {k}: {_size(f'{last}.pin {k}')}"
        yield f"  size of hole {k}: {_size(f'plate.hole {k}')}"


def _position(feature: str, datums: str = "") -> str:
    to = f", {datums}" if datums else ""
    return f"{{kind: position, of: {feature}, zone: {{diameter: 0.1 mm}}, law: {{kind: uniform}}{to}}}"


def _size(feature: str) -> str:
    return f"{{kind: size, of: {feature}, distribution: {{kind: normal, lower: 0 mm, upper: 0.03 mm}}}}"


def _move(k: int) -> Iterable[str]:
    def pairs(names: str, face: str) -> str:
        return ", ".join(f"{{from: block {k}.{name}, to: block {k - 1}.{face}}}" for name in names.split())

    yield f"  lay {k}:"
    yield "    kind: three_two_one"
    yield f"    part: block {k}"
    yield f"    primary: [{pairs('A1 A2 A3', 'top')}]"
    yield f"    secondary: [{pairs('B1 B2', 'back')}]"
    yield f"    tertiary: [{pairs('C1', 'left')}]"


def _floating(parts: int) -> Iterable[str]:
    last = f"block {parts - 1}"
    pairs = ", ".join(f"{{from: plate.hole {k}, to: {last}.pin {k}, over: from}}" for k in (1, 2))
    yield "  float:"
    yield "    kind: pattern"
    yield "    part: plate"
    yield f"    relations: [{{kind: coincident, from: plate.under, to: {last}.top}}]"
    yield f"    pairs: [{pairs}]"
    yield "    float: {kind: random}"


def _measure(k: int, parts: int, *, zones: bool) -> str:
    top = parts - 1 - k % max(1, parts - 1)
    read = f"block {top}.corner"
    if zones:
        read = "plate.corner" if k == 0 else f"block {top}.hole" if k % 3 == 1 else read
    limits = "lower_limit: -100 mm, upper_limit: 4000 mm"
    return f"  m{k}: {{kind: gap, from: block 0.corner, to: {read}, along: [{ALONG[k % 3]}], {limits}}}"


# whole commands -----------------------------------------------------------------------------------


def command(*arguments: str, folder: Path) -> tuple[float, float]:
    """Wall time [s] and peak memory [MB] of a command of tol3d's."""
    started = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", COMMAND, *arguments], capture_output=True, text=True, cwd=folder, env=os.environ
    )
    seconds = time.perf_counter() - started
    if done.returncode:
        raise SystemExit(
            f"tol3d {' '.join(arguments)}: exit {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}"
        )
    return seconds, float(done.stderr.split()[-1])


def sized(name: str, folder: Path) -> Path:
    """The scene of a size such as 20x40, or 20x40z with zones."""
    parts, measures = (int(own) for own in name.rstrip("z").split("x"))
    path = folder / f"{name}.yaml"
    path.write_text(stack(parts, measures, zones=name.endswith("z")), "utf-8")
    return path


def commands_table(sizes: Sequence[str], trials: Sequence[int], folder: Path) -> Table:
    """Whole commands by size."""
    table = Table(title="Whole commands: wall time and peak memory")
    for heading in ("parts x measures", "trials", "run [s]", "MB", "trials' part [s]", "findings [s]", "check [s]"):
        table.add_column(heading, justify="right")
    command("run", "spur_pair", "--no-picture", "--out", "warm", folder=folder)
    reference, memory = command("run", "spur_pair", "--no-picture", "--out", "reference", folder=folder)
    table.add_row("spur_pair", "2000", f"{reference:.1f}", f"{memory:.0f}", "", "", "")
    for name in sizes:
        scene = sized(name, folder)
        checked, _ = command("check", str(scene), folder=folder)
        for count in trials:
            out = folder / f"{name}-{count}"
            taken, memory = command("run", str(scene), "--trials", str(count), "--out", str(out), folder=folder)
            timing = json.loads((out / "summary.json").read_text("utf-8"))["timing"]
            cells = (taken, memory, timing["simulate_s"], timing["findings_s"], checked)
            table.add_row(name, str(count), *(f"{own:.0f}" if own > 50 else f"{own:.1f}" for own in cells))
    return table


def growth_table(trials: int, folder: Path) -> Table:
    """Whole commands of twice as much beside once as much."""
    table = Table(title=f"t(2N) / t(N), whole commands of {trials} trials without pictures")
    for heading in ("what doubles", "parts x measures", "s", "ratio"):
        table.add_column(heading, justify="right")
    for what, sizes in GROWTH:
        before = None
        for parts, measures in sizes:
            name = f"{parts}x{measures}"
            arguments = ("run", str(sized(name, folder)), "--no-picture", "--trials", str(trials))
            taken, _ = command(*arguments, "--out", str(folder / f"growth-{name}"), folder=folder)
            table.add_row(what, name, f"{taken:.1f}", f"{taken / before:.2f}" if before else "")
            before = taken
    return table


# parts --------------------------------------------------------------------------------------------


def placing_table(sizes: Sequence[str], rounds: int, folder: Path) -> Table:
    """Placements a second of one core, of `Method.answers`."""
    table = Table(title="Placing alone: part placements a second and core, best of several rounds")
    for heading in ("parts x measures", "block", "million/s", "file to system [s]"):
        table.add_column(heading, justify="right")
    for name in sizes:
        started = time.perf_counter()
        simulation = simulation_of(load(sized(name, folder)), Overrides())
        taken = time.perf_counter() - started
        method, trials = method_of(simulation, materials_of(simulation)), block_trials(simulation)
        assert method is not None
        block, measures = drawn(simulation, 0, trials), simulation.system.measures
        method.answers(block.part(0, 64), measures)  # what is found once
        times = []
        for _ in range(rounds):
            started = time.perf_counter()
            method.answers(block, measures)
            times.append(time.perf_counter() - started)
        parts = int(name.split("x")[0])
        table.add_row(name, str(trials), f"{parts * trials / min(times) / 1e6:.2f}", f"{taken:.1f}")
    return table


def slopes_of_heights(parts: int) -> Array:
    """Change of the last corner's height with each locator (parts - 1, 3), by small rotations, block by block.

    A block's A1, A2, A3 lift and tilt it: over (x, y) by (1, x, y) . inverse of their rows. What lies on a tilted block
    tilts with it, and stands over the same (x, y): each block's part in the corner's height is its own at (100, 100).
    """
    rows = np.array([[1.0, 10.0, 10.0], [1.0, 90.0, 10.0], [1.0, 50.0, 90.0]])
    return np.tile(np.array([1.0, 100.0, 100.0]) @ np.linalg.inv(rows), (parts - 1, 1))


def heights_table(sizes: Sequence[str], trials: int, folder: Path) -> Table:
    """Sigma of the height of the last block's corner: run, analytic and by hand, in sampling errors."""
    table = Table(title=f"Height of the last corner, {trials} trials: sigma [um]")
    for heading in ("parts", "run", "analytic", "by hand", "(run - by hand) / error"):
        table.add_column(heading, justify="right")
    for name in sizes:
        parts = int(name.split("x")[0])
        out = folder / f"heights-{name}"
        arguments = ("run", str(sized(name, folder)), "--no-picture", "--trials", str(trials))
        command(*arguments, "--out", str(out), folder=folder)
        found = open_run(out).summary["measures"]["m0"]
        expected = 1000 * SIGMA * float(np.sqrt((slopes_of_heights(parts) ** 2).sum()))
        measured, exact = found["geometric"]["sigma"], found["analytic_closed_form"]["sigma"]
        off = (measured - expected) / (expected / np.sqrt(2 * trials))
        table.add_row(str(parts), f"{measured:.3f}", f"{exact:.3f}", f"{expected:.3f}", f"{off:.1f}")
    return table


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", nargs="*", default=["20x40", "100x100", "300x200", "20x8z", "100x100z"])
    parser.add_argument("--trials", type=int, nargs="+", default=[10_000])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--growth", action="store_true")
    parser.add_argument("--placing", action="store_true")
    parser.add_argument("--heights", action="store_true")
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if given.placing:
            Console().print(placing_table(("20x20", "100x20", "300x20", "300x200"), given.rounds, folder))
        if given.growth:
            Console().print(growth_table(given.trials[0], folder))
        if given.heights:
            Console().print(heights_table(("2x1", "20x1", "300x1"), given.trials[0], folder))
        if not (given.placing or given.growth or given.heights):
            Console().print(commands_table(given.sizes, given.trials, folder))


if __name__ == "__main__":
    main()
