"""Speed of the geometric method by FCL, and its ratio to the obvious program.

    python benchmarks/fcl_speed.py [--trials 2000] [--naive 20] [--rounds 5]

Prints trials/s on one core for the spur pair at the default mesh (draws, builds, contact, normal backlash), the
same with every measure of the scene, and beside it the naive way, see whole_gears.py: the wheel turned by secant steps
on the distance of both whole gears until the teeth touch on one side, then on the other. Both in one run on the same
trials, so that the ratio holds on a noisy machine; medians of several rounds. Then the bevel pair at its own mesh, for
each way of reading its normal backlash.
"""

import argparse
import os
import statistics
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

from whole_gears import DEFLECTION, whole_gears_rate

from tol3d import load_scene
from tol3d.gearing.model import Backlash, Model, Reading
from tol3d.gearing.system import GearSystem, gear_model
from tol3d.simulate import simulation_of
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

SCENES = Path(__file__).resolve().parent.parent / "scenes"
WARM_UP_TRIALS = 50  # the first use builds the BVHs

READINGS: Mapping[str, Reading] = {
    "mean section, one tooth": Reading("section", "section", "driven"),
    "mean section, all teeth": Reading("section", "section", "all"),
    "face contact, one tooth": Reading("face", "section", "driven"),
    "whole face, all teeth": Reading("face", "face", "all"),
}


def strips_rate(model: Model, trials: int) -> float:
    """Trials/s from seed to columns."""
    simulation = Simulation(GearSystem(model), Study(engine="fcl"))
    system, method = simulation.system, method_of(simulation, materials_of(simulation))
    columns_of(system, method, drawn(simulation, 0, WARM_UP_TRIALS))
    started = time.perf_counter()
    columns_of(system, method, drawn(simulation, 0, trials))
    return trials / (time.perf_counter() - started)


def with_one_measure(model: Model, reading: Reading | None = None) -> Model:
    """The model with its first measure only, a backlash, read as it says or otherwise."""
    measure = model.measures[0]
    if not isinstance(measure.kind, Backlash):
        raise SystemExit(f"{model.name}: its first measure is no backlash, as this benchmark expects")
    kind = replace(measure.kind, reading=reading or measure.kind.reading)
    return replace(model, measures=(replace(measure, kind=kind),))


def row(what: str, rates: Sequence[float]) -> str:
    """A line of the table, without its end."""
    spread = f"{min(rates):.0f} ... {max(rates):.0f}"
    return f"  strips, {what:24} {statistics.median(rates):8.0f} trials/s  ({spread})"


def print_spur_pair(trials: int, naive_trials: int, rounds: int, deflection: float) -> None:
    """The strips beside whole gears."""
    model = gear_model(simulation_of(load_scene(SCENES / "spur_pair.yaml")).system)
    models = {"normal backlash": with_one_measure(model), "every measure": model}
    rates: dict[str, list[float]] = {what: [] for what in models}
    naive: list[float] = []
    triangles = 0
    for _ in range(rounds):
        for what, read in models.items():
            rates[what].append(strips_rate(read, trials))
        rate, triangles = whole_gears_rate(model, naive_trials, deflection)
        naive.append(rate)
    slow = statistics.median(naive)
    print(f"{model.name}: {model.profile_steps} steps a flank, one core, medians of {rounds} rounds")
    for what, found in rates.items():
        print(f"{row(what, found)}   {statistics.median(found) / slow:7.0f} x naive")
    print(f"  naive, whole gears               {slow:8.2f} trials/s  ({triangles} triangles, {deflection} mm)")


def print_bevel_pair(trials: int, rounds: int) -> None:
    """Each way of reading, and all measures of the scene."""
    model = gear_model(simulation_of(load_scene(SCENES / "bevel_pair.yaml")).system)
    print(f"{model.name}: {model.profile_steps} steps a flank, one core, medians of {rounds} rounds")
    models = {what: with_one_measure(model, reading) for what, reading in READINGS.items()} | {"every measure": model}
    for what, read in models.items():
        print(row(what, [strips_rate(read, trials) for _ in range(rounds)]))


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=2000)
    parser.add_argument("--naive", type=int, default=20, help="trials of the naive way")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--deflection", type=float, default=DEFLECTION, help="of the whole gears [mm]")
    given = parser.parse_args(arguments)
    print_spur_pair(given.trials, given.naive, given.rounds, given.deflection)
    print_bevel_pair(given.trials, given.rounds)


if __name__ == "__main__":
    main()
