"""Errors of places as arrows in pictures: from where a place lies nominally, with their values and their factor."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.report.body import Arrow, World
from tol3d.report.number import measured_text
from tol3d.report.presenter import Which
from tol3d.report.shown_unit import shown_run
from tol3d.study.runs.run import Run
from tol3d.study.system.outcome import value_column

NO_VALUES: Final[Mapping[str, str]] = {}
TRIAL: Final = re.compile(r"trial-(\d+)(-x.*)?")
WHOLE: Final = 2
"""Points of the line of a whole error; of a component a third one is the place itself."""


def values_of(run: Run, which: Which, label: str, names: Iterable[str]) -> dict[str, str]:
    """Values of measures of a build of a run, of the best method there is, in words; none of curves.

    Args:
        run: whose.
        which: see `Presenter.display`; of a mean build, and of trials that are not kept, there are no values.
        label: of its display.
        names: of the measures; others than the run's are left out.
    """
    shown, trial = shown_run(run.found).measures, TRIAL.fullmatch(label)
    values = dict[str, float | None]()
    for name in names:
        measure = shown.get(name)
        if measure is None or measure.take == "curve":
            continue
        if which == "nominal":
            values[name] = measure.nominal.value(measure.best_method)
        elif trial and run.keeps_trials:
            column = value_column(measure.best_method, name)
            per = 1.0 if run.found.measures[name].unit == measure.unit else 1e-3
            values[name] = per * float(run.columns(column)[column][int(trial[1])])
    return {name: measured_text(own, shown[name].unit) for name, own in values.items() if own is not None}


def with_errors(world: World, values: Mapping[str, str]) -> World:
    """A world with an arrow for each error that is read in it, named by its measure, its value and its factor.

    Where the whole error of a place is read, its components are left out.

    Args:
        world: with lines of measures.
        values: of measures, in words; those without one have no arrow.
    """
    factor, arrows = float(f"{(world.magnify or 1.0) * world.enlarged:.3g}"), dict[str, Arrow]()
    for name, points in errors_of(world, values).items():
        along = world.enlarged * (points[1] - points[0])
        length = float(np.linalg.norm(along))
        if length > 0.0:
            words = f"{name} {values[name]}, arrow × {factor:g}"
            arrows[words] = Arrow(along / length, points[0], length)
    return world if not arrows else replace(world, arrows={**world.arrows, **arrows})


def errors_of(world: World, values: Mapping[str, str]) -> Mapping[str, Array]:
    """Points of the errors that are drawn, by measure: of the first whole one at each place, else of its components."""
    every = [(name, line.points) for name in values for line in world.measured.get(name, ()) if line.is_error]
    whole = dict[tuple[float, ...], str]()
    for name, points in every:
        if len(points) == WHOLE:
            whole.setdefault(_place(points), name)
    return {name: points for name, points in every if whole.get(_place(points), name) == name}


def _place(points: Array) -> tuple[float, ...]:
    return tuple(np.round(points[-1], 6).tolist())
