"""Whole studies of assemblies on one core: trials/s and peak memory, statistics included.

    python benchmarks/assemblies.py [--trials 2000000] [--rounds 3] [--systems NAME …]

Each row is a process of its own with one worker, from the scene to the run on disk, without its trials kept. Rates are
those of the simulation stage (draws, both methods, statistics), by the clock and by the processor's own time, which
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

IN_HOUSING = 74
"""Drawn components of gearbox_in_housing.yaml."""
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


def without_housing(components: int) -> str:
    """The gears of gearbox_in_housing.yaml on axes of their own, with as many drawn components, of their own kinds.

    Six bearings have 12, thicknesses 4, temperatures 2; the others are eccentricities, two each.
    """
    lines = (SCENES / "gearbox_in_housing.yaml").read_text("utf-8").splitlines()
    parts, tolerances = lines.index("parts:"), lines.index("tolerances:")
    own = [": {kind: " + kind for kind in ("shaft", "bearing", "spur_gear")]
    kept = [line for line in lines[parts:tolerances] if any(kind in line for kind in own)]
    gears = [line.split(":")[0].strip() for line in kept if "spur_gear" in line]
    drawn = [line for line in lines[tolerances:] if "bearing_clearance" in line or "tooth_thickness" in line]
    drawn += [
        f"  warm {gear}: {{kind: temperature, of: {gear}, distribution: {{kind: normal, mean: 25 K, sigma: 5 K}}}}"
        for gear in gears[:2]
    ]
    drawn += [
        f"  eccentricity {k}: {{kind: eccentricity, of: {gears[k % len(gears)]}, "
        "distribution: {kind: rayleigh, scale: 2 um}}"
        for k in range((components - 18) // 2)
    ]
    moves = [
        "  first stage: {kind: mesh, driver: first pinion, driven: first wheel, centre_distance: 60 mm}",
        "  second stage: {kind: mesh, driver: second pinion, driven: second wheel, centre_distance: 76 mm}",
        "  gearbox: {kind: train, driven: input, output: output}",
    ]
    measures = [line for line in lines if "kind: normal_backlash" in line or "kind: lost_motion" in line]
    sections = {"parts": kept, "tolerances": drawn, "moves": moves, "measures": measures}
    return "scene: without housing\n" + "".join(
        f"{name}:\n" + "".join(line + "\n" for line in own) for name, own in sections.items()
    )


def systems(folder: Path) -> dict[str, Path]:
    """Scenes by the names of the rows."""
    blocks = folder / "blocks.yaml"
    blocks.write_text(stack(), encoding="utf-8")
    train = folder / "train.yaml"
    train.write_text(without_housing(IN_HOUSING), encoding="utf-8")
    return {
        "3-2-1 stack of three blocks, 20 contributors": blocks,
        "door": SCENES / "door.yaml",
        "two plates, two pins": SCENES / "two_plates.yaml",
        "clutch": SCENES / "clutch.yaml",
        "box with discs": SCENES / "box_with_discs.yaml",
        "four pads": SCENES / "four_pads.yaml",
        "gearbox in its housing": SCENES / "gearbox_in_housing.yaml",
        "the same gears without, as many components": train,
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
