"""Curves over a long period: contacts/s of whole studies of `two_sided_te`, and the memory of ranges over long curves.

    python benchmarks/curves.py [--trials 10000] [--positions 72] [--long 640] [--rounds 3] [--workers 1 2]
    python benchmarks/curves.py --memory 1000 100000 [--long 640] [--workers 2]

A contact is a position of one side of the teeth. Each row is a process of its own, from the scene to the run on disk;
contacts/s are those of the whole simulation stage (draws, builds, contact, both methods, statistics), the median of
`--rounds` rounds; asked for are 1.7 million on two cores. Ranges go over `--long` positions a turn, 10 240 in the long
period: curves of all trials would show in the memory, which is that of the process and all of its threads. `--memory`
measures nothing but these, once for each number of trials: it must be the same for all of them. 10^5 trials are 2 x
10^9 contacts, a quarter of an hour on a core.
"""

import argparse
import json
import statistics
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from ruamel.yaml import YAML
from studies import SCENES, TimedStudy, measured

WIDTH = 120  # characters
LONG_PERIOD = 16  # turns of the driver, 27 and 48 teeth
ERROR: Mapping[str, Any] = {"kind": "transmission_error", "of": "gear pair", "over": "long_period"}
PLAY: Mapping[str, Any] = {"kind": "angular_backlash", "of": "gear pair", "over": "long_period"}

ROWS: Mapping[str, tuple[int, Mapping[str, Mapping[str, Any]]]] = {
    "curves of both sides": (2, {side: {**ERROR, "flank": side, "take": "curve"} for side in ("drive", "back")}),
    "curve of the drive side": (1, {"drive": {**ERROR, "take": "curve"}}),
    "ranges of both sides": (2, {side: {**ERROR, "flank": side, "take": "range"} for side in ("drive", "back")}),
    "curve of the angular backlash": (1, {"play": {**PLAY, "take": "curve"}}),
}
"""Measurements: number of sides, and the measures."""

ASKED = 1.7e6  # contacts/s on two cores
LONG = "ranges of both sides, long"


def scene_of(folder: Path, measures: Mapping[str, Mapping[str, Any]], positions: int) -> Path:
    """The pair with other measures, at so many positions a turn of the driver."""
    scene: dict[str, Any] = YAML(typ="safe").load((SCENES / "two_sided_te.yaml").read_text("utf-8"))
    scene["measures"] = {name: {**measure, "positions": positions} for name, measure in measures.items()}
    path = folder / "curves.yaml"
    path.write_text(json.dumps(scene), "utf-8")  # which is YAML too
    return path


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=10_000)
    parser.add_argument("--positions", type=int, default=72)
    parser.add_argument("--long", type=int, default=640)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--memory", type=int, nargs="+", help="trials of ranges over long curves, and nothing else")
    given = parser.parse_args(arguments)
    table = Table(
        "measures", title=f"exact engine; asked for: curves of {ASKED / 1e6:g} million contacts/s on two cores"
    )
    for heading in ("positions", "trials", "workers", "contacts/s", "peak MB"):
        table.add_column(heading, justify="right")
    sides, measures = ROWS["ranges of both sides"]
    long = [(LONG, sides, measures, given.long, trials) for trials in given.memory or [given.trials]]
    short = [(name, own, asked, given.positions, given.trials) for name, (own, asked) in ROWS.items()]
    for name, sides, measures, positions, trials in long if given.memory else [*short, *long]:
        for workers in given.workers:
            with tempfile.TemporaryDirectory() as folder:
                scene = scene_of(Path(folder), measures, positions)
                study = TimedStudy("curves", "exact", trials, workers)
                found = [measured(study, scene) for _ in range(1 if given.memory else given.rounds)]
            contacts = sides * positions * LONG_PERIOD * statistics.median(each.rate for each in found)
            cells = (positions * LONG_PERIOD, trials, workers, round(contacts), round(found[-1].peak_mb))
            table.add_row(name, *(f"{cell:,}" for cell in cells))
    Console(width=WIDTH).print(table)


if __name__ == "__main__":
    main()
