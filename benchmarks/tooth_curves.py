"""Curves of teeth that deviate one by one: contacts/s of whole studies of `tooth_deviations` over its long period.

    python benchmarks/tooth_curves.py [--trials 1000] [--rounds 3] [--workers 1 2]

A contact is a position of one side of the teeth, 1152 a side and trial. Each row is a process of its own, from the
scene to the run on disk; contacts/s are those of the whole simulation stage (draws, builds, contact, both methods,
statistics), the median of `--rounds` rounds; asked for are 0.6 million on two cores. Ranges have shares of the
variance: each group of deviations goes once more through the stack-up for them. Several workers need several blocks:
2048 trials of a curve each, 8192 of a range.
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

WIDTH = 110  # characters
ASKED = 0.6e6  # contacts/s on two cores
POSITIONS = 1152  # over three turns of the driver, 16 a tooth
SIDES = ("drive", "back")
KINDS: Mapping[str, tuple[str, ...]] = {
    "pitches": ("pitch_deviation",),
    "pitches, slopes and forms": ("pitch_deviation", "profile_slope", "profile_form", "helix_slope"),
}


def scene_of(folder: Path, kinds: Sequence[str], take: str) -> Path:
    """The pair with some of its tolerances, and transmission errors of both sides."""
    scene: dict[str, Any] = YAML(typ="safe").load((SCENES / "tooth_deviations.yaml").read_text("utf-8"))
    scene["tolerances"] = {name: own for name, own in scene["tolerances"].items() if own["kind"] in kinds}
    error = {"kind": "transmission_error", "of": "gear pair", "take": take, "positions": 384}
    scene["measures"] = {side: {**error, "flank": side} for side in SIDES}
    path = folder / "tooth_curves.yaml"
    path.write_text(json.dumps(scene), "utf-8")  # which is YAML too
    return path


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    given = parser.parse_args(arguments)
    asked = f"asked for: curves of {ASKED / 1e6:g} million contacts/s on two cores"
    table = Table("deviations", "taken", title=f"exact engine; {asked}")
    for heading in ("trials", "workers", "contacts/s"):
        table.add_column(heading, justify="right")
    for name, kinds in KINDS.items():
        for take in ("curve", "range"):
            for workers in given.workers:
                with tempfile.TemporaryDirectory() as folder:
                    scene = scene_of(Path(folder), kinds, take)
                    study = TimedStudy("tooth curves", "exact", given.trials, workers)
                    rates = [measured(study, scene).rate for _ in range(given.rounds)]
                contacts = len(SIDES) * POSITIONS * statistics.median(rates)
                table.add_row(name, take, f"{given.trials:,}", str(workers), f"{contacts:,.0f}")
    Console(width=WIDTH).print(table)


if __name__ == "__main__":
    main()
