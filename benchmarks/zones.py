"""Cost of a drawn component of a tolerance zone on one core.

    python benchmarks/zones.py [--trials 65536] [--rounds 7]

Prints millions of components a second, least time of several rounds, of every zone by both laws: as stated, with the
orientation refined to half, and with widths of each trial's own, as a bonus makes them. Uniforms are drawn before.
"""

import argparse
import time
from collections.abc import Callable, Sequence

import numpy as np
from rich.console import Console
from rich.table import Table

from tol3d.assembly.zones import Confined, Zone, catalogue, normal_in, uniform_in

WIDTH = 0.1  # mm
LAWS: dict[str, Callable[[Zone], Confined]] = {"uniform": uniform_in, "normal": normal_in}
ZONES: dict[str, Zone] = {
    "rectangle": catalogue.rectangle(WIDTH),
    "rectangle, refined": catalogue.rectangle(WIDTH, WIDTH / 2),
    "round face": catalogue.round_face(WIDTH),
    "round face, refined": catalogue.round_face(WIDTH, WIDTH / 2),
    "rectangle's orientation": catalogue.rectangle_orientation(WIDTH),
    "axis": catalogue.axis(WIDTH),
    "axis, refined": catalogue.axis(WIDTH, WIDTH / 2),
    "axis at a section": catalogue.axis_section(WIDTH),
    "flat axis": catalogue.flat_axis(WIDTH, (1.0, 0.0)),
    "flat axis, refined": catalogue.flat_axis(WIDTH, (1.0, 0.0), WIDTH / 2),
    "point in a sphere": catalogue.point_in_sphere(WIDTH),
    "point between planes": catalogue.point_between_planes(WIDTH),
}


def speed(draw: Confined, trials: int, rounds: int, *, varied: bool) -> float:
    """Millions of components a second."""
    rng = np.random.default_rng(1)
    uniforms = rng.random((draw.uniforms, trials))
    widths = WIDTH * (1.0 + rng.random(trials))
    costs = []
    for _ in range(rounds + 1):  # the first of them makes tables
        started = time.thread_time()
        if varied:
            draw.deviations_in(widths, None, *uniforms)
        else:
            draw.deviations(*uniforms)
        costs.append(time.thread_time() - started)
    return trials * len(draw.components) / min(costs) / 1e6


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=65_536)
    parser.add_argument("--rounds", type=int, default=7)
    given = parser.parse_args(arguments)
    table = Table(title=f"millions of components a second on one core, blocks of {given.trials}")
    table.add_column("zone", no_wrap=True)
    for law in LAWS:
        for heading in (law, f"{law}, own widths"):
            table.add_column(heading, justify="right")
    for name, zone in ZONES.items():
        found = [
            speed(law(zone), given.trials, given.rounds, varied=varied)
            for law in LAWS.values()
            for varied in (False, True)
        ]
        table.add_row(name, *(f"{own:.1f}" for own in found))
    Console().print(table)


if __name__ == "__main__":
    main()
