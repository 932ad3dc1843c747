"""Convergence of the samplers, and truth of the standard errors that they state: makes docs/convergence.png.

    python benchmarks/convergence.py [--studies 100] [--largest 65536] [--out docs/convergence.png]

The spur pair's normal backlash by the analytic method, linear in the deviations: its closed form gives the true
mean and sigma. Many studies of each size, each from a seed of its own; the rms of their errors stands beside the rms of
the standard errors that the studies state of themselves. Three minutes on one core.
"""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, NullFormatter
from numpy.typing import NDArray

from tol3d import load_scene
from tol3d.gearing.methods.analytic import analytic_values
from tol3d.gearing.model import Measure, Model, Positions, model_from_scene
from tol3d.gearing.stack_up import closed_form
from tol3d.gearing.system import GearSystem
from tol3d.report.canvas import BLACK, BLUE, GREY, ORANGE, new_figure, plain_axes, save_figure
from tol3d.statistics.estimates import Moments
from tol3d.statistics.samplers.replicates import REPLICATES, SamplerKind
from tol3d.study.tallies.replicated import Replicated, rows_of_replicates
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

Array = NDArray[np.float64]

ROOT = Path(__file__).resolve().parent.parent
SCENE = ROOT / "scenes" / "spur_pair.yaml"
SMALLEST, LARGEST = 2**6, 2**16  # trials of a study; the sizes between are powers of two
FITTED_FROM = 2**9  # trials; the order is that of the sizes from there on
FIXED = Positions("at", 1, 1, 0.3)  # rad; any angle would do
COLOURS: Mapping[SamplerKind, str] = {"monte_carlo": GREY, "latin_hypercube": ORANGE, "sobol": BLUE}
WORDS: Mapping[SamplerKind, str] = {
    "monte_carlo": "Monte Carlo",
    "latin_hypercube": "Latin hypercube",
    "sobol": "scrambled Sobol'",
}
MARKERS: Mapping[SamplerKind, str] = {"monte_carlo": "o", "latin_hypercube": "s", "sobol": "D"}


@dataclass(frozen=True)
class Curve:
    """One statistic by one sampler over sizes of studies [um]: rms error, and rms of the standard errors they state."""

    sizes: tuple[int, ...]
    errors: Array
    stated: Array

    @property
    def order(self) -> float:
        """p of error ~ N^-p."""
        sizes = np.asarray(self.sizes)
        fitted = sizes >= FITTED_FROM
        return -float(np.polyfit(np.log(sizes[fitted]), np.log(self.errors[fitted]), 1)[0])


def study(model: Model, measure: Measure, sampler: SamplerKind, size: int, seed: int) -> Array:
    """Mean, sigma and the standard errors that one study states of them [um]."""
    parts = 1 if sampler == "monte_carlo" else REPLICATES
    own = Study(trials=size, seed=seed, sampler=sampler, replicates=parts)
    trials = drawn(Simulation(GearSystem(model), own), 0, size)
    values = analytic_values(model, measure, trials)[:, 0] * measure.per_internal
    moments = Moments.of(values)
    rows = rows_of_replicates(own, 0, size)
    errors = Replicated.of(values, rows, None, None) if rows else moments
    return np.array([moments.mean, moments.sigma, errors.mean_se, errors.sigma_se])


def sizes_to(largest: int) -> tuple[int, ...]:
    """Sizes of studies: powers of two from SMALLEST to the largest."""
    return tuple(2**k for k in range(SMALLEST.bit_length() - 1, largest.bit_length()))


def curves(
    model: Model, measure: Measure, sampler: SamplerKind, studies: int, sizes: tuple[int, ...]
) -> tuple[Curve, Curve]:
    """Curves of the mean and of sigma."""
    form = closed_form(model, measure)
    if form is None:
        raise SystemExit(f"{measure.name}: has no closed form to compare with")
    truth = np.array([form.mean, form.sigma]) * measure.per_internal
    found = np.array([[study(model, measure, sampler, size, seed) for seed in range(studies)] for size in sizes])
    errors = np.sqrt(np.mean((found[:, :, :2] - truth) ** 2, axis=1))
    stated = np.sqrt(np.mean(found[:, :, 2:] ** 2, axis=1))
    return Curve(sizes, errors[:, 0], stated[:, 0]), Curve(sizes, errors[:, 1], stated[:, 1])


def draw(axes: Axes, title: str, by_sampler: Mapping[SamplerKind, Curve]) -> None:
    """Errors of the three samplers over the number of trials, both in powers."""
    plain_axes(axes)
    axes.set_xscale("log", base=2)
    axes.set_yscale("log")
    for sampler, curve in by_sampler.items():
        colour = COLOURS[sampler]
        label = f"{WORDS[sampler]}, order {curve.order:.2f}"
        axes.plot(curve.sizes, curve.errors, color=colour, linewidth=1.8, label=label)
        (stated,) = axes.plot(curve.sizes, curve.stated, linestyle="none", marker=MARKERS[sampler])
        stated.set(markerfacecolor="white", markeredgecolor=colour, markersize=5.5, markeredgewidth=1.3)
    axes.set_title(title, loc="left", fontsize=11, fontweight="bold")
    ticks = next(iter(by_sampler.values())).sizes[::2]
    axes.set_xticks(ticks, [f"{size:,}".replace(",", " ") for size in ticks])
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, position: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.minorticks_off()
    axes.legend(fontsize=9, frameon=False, loc="lower left")


def print_curves(what: str, by_sampler: Mapping[SamplerKind, Curve]) -> None:
    """Order and last error of each sampler, and how the stated standard errors lie to the true ones."""
    for sampler, curve in by_sampler.items():
        ratio = curve.stated / curve.errors
        print(
            f"{what:33} {WORDS[sampler]:17} order {curve.order:.2f}  "
            f"at {curve.sizes[-1]}: {curve.errors[-1]:.5f} um  stated/true {ratio.min():.2f} … {ratio.max():.2f}"
        )


def legend_handles(studies: int) -> list[Line2D]:
    """Handles of lines and marks, whatever their colour."""
    true = Line2D([], [], color=BLACK, linewidth=1.8, label=f"true error: rms over {studies} studies")
    stated = Line2D([], [], color=BLACK, linestyle="none", marker="o", markerfacecolor="white", markersize=5.5)
    stated.set(markeredgewidth=1.3, label="standard error that the studies state of themselves")
    return [true, stated]


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the studies and draw them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--studies", type=int, default=100, help="studies of each size by each sampler")
    parser.add_argument("--largest", type=int, default=LARGEST, help=f"trials of the largest, over {FITTED_FROM}")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "convergence.png")
    given = parser.parse_args(arguments)
    model = model_from_scene(load_scene(SCENE))
    at_random = model.measures[0]
    figure = new_figure(11.0, 8.6)
    grid = figure.subplots(2, 2, sharex=True, sharey="row")
    places = {"driver at one position": replace(at_random, positions=FIXED), "driver at random positions": at_random}
    for row, (place, measure) in zip(grid, places.items(), strict=True):
        sizes = sizes_to(given.largest)
        found = {sampler: curves(model, measure, sampler, given.studies, sizes) for sampler in COLOURS}
        for axes, k, word in ((row[0], 0, "mean"), (row[1], 1, "sigma")):
            by_sampler = {sampler: both[k] for sampler, both in found.items()}
            draw(axes, f"{word}, {place}", by_sampler)
            print_curves(f"{word:5} {place}", by_sampler)
        row[0].set_ylabel("error [µm]", fontsize=10)
    for axes in grid[1]:
        axes.set_xlabel("trials in all", fontsize=10)
    figure.legend(
        handles=legend_handles(given.studies), loc="outside lower center", ncols=2, fontsize=9.5, frameon=False
    )
    figure.suptitle(
        "Spur pair, normal backlash: how mean and sigma converge "
        f"({REPLICATES} replicates of Sobol' points and Latin hypercubes)\n",
        x=0.012,
        ha="left",
        fontsize=12,
        fontweight="bold",
    )
    save_figure(figure, given.out)


if __name__ == "__main__":
    main()
