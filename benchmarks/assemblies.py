"""Whole studies of assemblies on one core: trials/s and peak memory, statistics included.

    python benchmarks/assemblies.py [--trials 2000000] [--rounds 3] [--systems NAME …]

Each row is a process of its own with one worker, from the scene to the run on disk, without its trials kept. Rates are
those of the simulation stage (draws, both roads, statistics), by the clock and by the processor's own time, which
leaves out what others took of a shared machine; the best of several rounds.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

SCENES = Path(__file__).resolve().parent.parent / "scenes"
PROGRAM = """
import json, resource, sys, time
from tol3d.simulate import Execution, Overrides, run_scene
scene, out, trials = sys.argv[1:]
def cpu():
    return sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
run_scene(scene, out=out + "/first", overrides=Overrides(trials=1000), execution=Execution(keep_trials=False))
before = cpu()
run = run_scene(scene, out=out + "/run", overrides=Overrides(trials=int(trials)),
                execution=Execution(keep_trials=False))
used = cpu() - before
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps({"rate": run.summary["timing"]["trials_per_s"], "cpu_rate": int(trials) / used, "mb": peak / 1000}))
"""

CORNERS = ((0, 0), (100, 0), (0, 60))
UNDER, OVER = ("under 1", "under 2", "under 3"), ("over 1", "over 2", "over 3")
SIDES = ("side 1", "side 2", "end")
TOLERANCED = {1: (*OVER, *SIDES), 2: (*UNDER, *OVER, *SIDES), 3: (*UNDER, *SIDES[:2])}  # 20 points
BLOCK = """  block {k}:
    kind: solid
    placed: {{at: [0 mm, 0 mm, {z} mm]}}
    features:
{features}
"""


def stack() -> str:
    """A block on a block on a block, each located 3-2-1 by points with a tolerance of their own: 20 contributors."""
    parts, moves = "", "  machine: {kind: fix, part: block 1}\n"
    for k in (1, 2, 3):
        features = "".join(
            f"      {name} {i}: {{kind: point, at: [{x} mm, {y} mm, {z} mm], normal: {normal}}}\n"
            for name, z, normal in (("under", 0, [0, 0, -1]), ("over", 20, [0, 0, 1]))
            for i, (x, y) in enumerate(CORNERS, 1)
        )
        features += "".join(
            f"      side {i}: {{kind: point, at: [{x} mm, 0 mm, 10 mm], normal: [0, -1, 0]}}\n"
            for i, x in enumerate((10, 90), 1)
        )
        features += "      end: {kind: point, at: [0 mm, 30 mm, 10 mm], normal: [-1, 0, 0]}\n"
        parts += BLOCK.format(k=k, z=20 * (k - 1), features=features)
    tolerances = "".join(
        f"  block {k} {name}: {{kind: plus_minus, of: block {k}.{name}, "
        "distribution: {kind: normal, mean: 0 um, sigma: 10 um}}\n"
        for k, names in TOLERANCED.items()
        for name in names
    )
    for k in (2, 3):
        pairs = [f"{{from: block {k}.under {i}, to: block {k - 1}.over {i}}}" for i in (1, 2, 3)]
        sides = [f"{{from: block {k}.side {i}, to: block {k - 1}.side {i}}}" for i in (1, 2)]
        end = f"{{from: block {k}.end, to: block {k - 1}.end}}"
        moves += (
            f"  lay {k}: {{kind: three_two_one, part: block {k}, primary: [{', '.join(pairs)}], "
            f"secondary: [{', '.join(sides)}], tertiary: [{end}]}}\n"
        )
    return (
        f"scene: three blocks\nparts:\n{parts}tolerances:\n{tolerances}moves:\n{moves}"
        "measures:\n  height: {kind: gap, from: block 1.under 1, to: block 3.over 2, along: [0, 0, 1]}\n"
    )


BORES = ("input", "middle", "output")


def without_housing() -> str:
    """The gears of housed_gears.yaml on axes of their own, with about as many contributors of their own kinds."""
    text = (SCENES / "housed_gears.yaml").read_text("utf-8")
    lines = [line for line in text.splitlines() if "bores apart" not in line]
    parts, tolerances = lines.index("parts:"), lines.index("tolerances:")
    kept = [line for line in lines[parts:tolerances] if ": {kind: shaft" in line or ": {kind: spur_gear" in line]
    random = "direction: random, distribution: {kind: uniform, lower: 5 um, upper: 15 um}"
    bearings = [(f"{name} {end}", name, z) for name in BORES for end, z in (("near", -34), ("far", 34))]
    kept += [f"  {bearing}: {{kind: bearing, shaft: {shaft}, at: {z} mm}}" for bearing, shaft, z in bearings]
    own = [line for line in lines[tolerances:] if "tooth_thickness" in line or ": second wheel, dist" in line]
    own += [f"  {bearing} play: {{kind: bearing_clearance, of: {bearing}, {random}}}" for bearing, _, _ in bearings]
    own += [
        f"  {gear} run: {{kind: eccentricity, of: {gear}, distribution: {{kind: rayleigh, scale: 5 um}}}}"
        for gear in ("first pinion", "first wheel", "second pinion")
    ]
    own += [
        f"  {name}: {{kind: temperature, of: {gear}, distribution: {{kind: normal, mean: 25 K, sigma: 5 K}}}}"
        for name, gear in (("warm pinion", "first pinion"), ("warm wheel", "first wheel"))
    ]
    moves = [
        "  first stage: {kind: mesh, driver: first pinion, driven: first wheel, centre_distance: 52.5 mm}",
        "  second stage: {kind: mesh, driver: second pinion, driven: second wheel, centre_distance: 63 mm}",
        "  gearbox: {kind: train, driven: input, output: output}",
    ]
    measures = [line for line in lines if "kind: normal_backlash" in line or "kind: lost_motion" in line]
    sections = {"parts": kept, "tolerances": own, "moves": moves, "measures": measures}
    return "scene: without housing\n" + "".join(
        f"{name}:\n" + "".join(line + "\n" for line in own) for name, own in sections.items()
    )


def systems(folder: Path) -> dict[str, Path]:
    """Scenes by the names of the rows."""
    blocks = folder / "blocks.yaml"
    blocks.write_text(stack(), encoding="utf-8")
    train = folder / "train.yaml"
    train.write_text(without_housing(), encoding="utf-8")
    return {
        "3-2-1 stack of three blocks, 20 contributors": blocks,
        "door": SCENES / "door.yaml",
        "two plates, two pins": SCENES / "two_plates.yaml",
        "clutch": SCENES / "clutch.yaml",
        "box with discs": SCENES / "box_with_discs.yaml",
        "four pads": SCENES / "four_pads.yaml",
        "gears in a housing": SCENES / "housed_gears.yaml",
        "the same gears without": train,
    }


def measured(scene: Path, trials: int) -> dict[str, float]:
    """Rates and memory of a process of its own."""
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-c", PROGRAM, str(scene), out, str(trials)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return found


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=2_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--systems", nargs="+", metavar="NAME", help="only rows with such a word")
    given = parser.parse_args(arguments)
    table = Table(title=f"{given.trials} trials on one core")
    table.add_column("system", no_wrap=True)
    for heading in ("trials/s", "by the processor's time", "peak MB"):
        table.add_column(heading, justify="right")
    with tempfile.TemporaryDirectory() as folder:
        for name, scene in systems(Path(folder)).items():
            if given.systems and not any(word in name for word in given.systems):
                continue
            found = [measured(scene, given.trials) for _ in range(given.rounds)]
            rates = (max(own[key] for own in found) for key in ("rate", "cpu_rate"))
            table.add_row(name, *(f"{rate:.0f}" for rate in rates), f"{min(own['mb'] for own in found):.0f}")
    Console(width=110).print(table)


if __name__ == "__main__":
    main()
