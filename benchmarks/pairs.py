"""Cost of a trial of a pair on one core in the exact engine's kernels, by the kind of pair.

    python benchmarks/pairs.py [--trials 20000] [--rounds 9]

Prints million trials a second, least processor time of several rounds: the working flanks brought to contact and the
gap of the others, two contacts, of builds with parallel axes and of builds whose axes lean by up to 0.5 mrad. An
external pair, a helical one and two internal ones have the same numbers of teeth.
"""

import argparse
import math
import time
from collections.abc import Mapping, Sequence

import numpy as np
from rich.console import Console
from rich.table import Table

from tol3d.gearing.builds.build import Build
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.model import Mesh, Model, Reading
from tol3d.gearing.model.model import GearPart
from tol3d.gears import LEFT_HAND, RIGHT, InternalGear, InternalPair, SpurGear, SpurPair
from tol3d.numerics import frames

Pair = SpurPair | InternalPair

ALPHA = math.radians(20)
INNER, WHEEL = SpurGear(27, 1.0, ALPHA, 10.0), SpurGear(79, 1.0, ALPHA, 9.0)
SLANTED = (
    SpurGear(27, 1.0, ALPHA, 10.0, helix_angle=math.radians(20)),
    SpurGear(79, 1.0, ALPHA, 9.0, helix_angle=math.radians(20), hand=LEFT_HAND),
)
RING = InternalGear(79, 1.0, ALPHA, 9.0, addendum=0.8)
PAIRS: Mapping[str, Pair] = {
    "external": SpurPair(INNER, WHEEL, 53.02),
    "external, helical": SpurPair(*SLANTED, 56.42),
    "internal, driving pinion": InternalPair(INNER, RING, 25.98),
    "internal, driving ring": InternalPair(RING, INNER, 25.98),
}
LEANING = 5e-4  # rad
THINNER = 0.06  # mm off each gear's teeth


def built(pair: Pair, trials: int, leaning: float) -> tuple[Model, Build, np.ndarray]:
    """A model that is one mesh, random builds of it, and driver angles [rad]."""
    rng = np.random.default_rng(1)
    mesh = Mesh("mesh", "driver", "driven", pair, RIGHT)
    model = Model("timed", (GearPart("driver", pair.pinion), GearPart("driven", pair.wheel)), (), (), (mesh,), ())
    turn = leaning * rng.uniform(-1.0, 1.0, (trials, 2, 3))
    shafts = np.tile(np.eye(4), (trials, 2, 1, 1))
    if leaning:
        shafts[..., :3, :3] = frames.about_vector(turn.reshape(-1, 3)).reshape(trials, 2, 3, 3)
    shafts[..., :3, 3] = 0.01 * rng.uniform(-1.0, 1.0, (trials, 2, 3))
    shafts[:, 1, :3, 3] += pair.wheel_origin
    radii = np.array([gear.thickness_radius for gear in (pair.pinion, pair.wheel)])
    made = Build(
        world_from_shaft=shafts,
        centre=0.01 * rng.uniform(-1.0, 1.0, (trials, 2, 2)),
        axis_turn=turn,
        flank_turn=-THINNER / (2 * radii) * rng.uniform(0.9, 1.1, (trials, 2)),
        flank_offset=np.zeros((trials, 2)),
        scale=np.ones((trials, 2)),
    )
    return model, made, rng.uniform(0.0, 100.0, trials)


def speed(pair: Pair, trials: int, rounds: int, leaning: float) -> float:
    """Million trials a second."""
    model, made, angles = built(pair, trials, leaning)
    engine, costs = ExactEngine(model), []
    for _ in range(rounds + 1):  # the first of them compiles
        started = time.process_time()
        engine.read(made, model.meshes[0], Reading(), angles)
        costs.append(time.process_time() - started)
    return trials / min(costs) / 1e6


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=20_000)
    parser.add_argument("--rounds", type=int, default=9)
    given = parser.parse_args(arguments)
    table = Table("pair", title="million trials/s, one core")
    for heading in ("parallel axes", "leaning axes"):
        table.add_column(heading, justify="right")
    for name, pair in PAIRS.items():
        rates = (speed(pair, given.trials, given.rounds, leaning) for leaning in (0.0, LEANING))
        table.add_row(name, *(f"{rate:.2f}" for rate in rates))
    Console(width=90).print(table)


if __name__ == "__main__":
    main()
