"""Play where parallel load paths join: the intersection of their plays.

The free turn of a shaft on one load path is an interval: from where its driven gear rests on the working flank to where
the other flank touches, links in series added up. Once the path that ends first on either side is known, all is linear
in the play of each mesh and its rest angle; so derivatives are computed like values. Load paths that share links are
compared likewise, walk by walk; each of their loops must have some play, or they bind.
"""

from collections.abc import Callable, Mapping
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model.measure import AnyStage, ParallelStage, Stage
from tol3d.numerics.arrays import Array

FREE: Final = 1e-9  # rad; load paths that overlap by rounding errors do not bind each other

Variable = tuple[Stage, Literal["play", "rest"]]
VariableValues = Callable[[Variable], Array]
"""A stage's own play [rad], or the angle at which its driven gear rests [rad]; (trials, positions).

Of a link that is no mesh the middle of its free turn stands for that angle.
"""

LinearForm = Mapping[Variable, Array]
"""Weights of the stages' plays and rests, each (trials, positions) or a scalar."""

WorkingFlank = Callable[[Stage], int | None]
"""The driven gear's flank that works in a stage; None for a link that is no mesh."""


def value(form: LinearForm, read: VariableValues) -> Array:
    """Value of a linear form [rad], (trials, positions)."""
    return np.asarray(sum(weight * read(variable) for variable, weight in form.items()))


def free_form(stage: ParallelStage, flank: WorkingFlank, read: VariableValues) -> LinearForm:
    """Play of the shaft where load paths join; below 0 they bind each other."""
    low, high = _meeting(stage, flank, read)
    free = _sum(high, _reversed(low))
    if not stage.loops:
        return free
    loops = [form for own in stage.loops for form in _around(own, flank, read)]
    lacking = [value(form, read) for form in loops]
    tightest = np.argmin(lacking, axis=0)
    binds = np.min(lacking, axis=0) < -FREE
    return _chosen([free, *loops], np.where(binds, 1 + tightest, 0))


def _around(loop: tuple[Stage, ...], flank: WorkingFlank, read: VariableValues) -> tuple[LinearForm, LinearForm]:
    """Play of a loop of links in either sense; below 0 it cannot be closed."""
    low, high = _ends_of_path(loop, flank, read)
    return high, _reversed(low)


def _meeting(stage: ParallelStage, flank: WorkingFlank, read: VariableValues) -> tuple[LinearForm, LinearForm]:
    """Both ends of the common play of all load paths."""
    each = [_ends_of_path(path, flank, read) for path in stage.paths]
    lows, highs = [low for low, _ in each], [high for _, high in each]
    return (
        _chosen(lows, np.argmax([value(form, read) for form in lows], axis=0)),
        _chosen(highs, np.argmin([value(form, read) for form in highs], axis=0)),
    )


def _ends_of_path(
    path: tuple[AnyStage, ...], flank: WorkingFlank, read: VariableValues
) -> tuple[LinearForm, LinearForm]:
    low: LinearForm = {}
    high: LinearForm = {}
    for stage in path:
        ends = _ends(stage, flank, read)
        low, high = _sum(low, ends[0]), _sum(high, ends[1])
    return low, high


def _ends(stage: AnyStage, flank: WorkingFlank, read: VariableValues) -> tuple[LinearForm, LinearForm]:
    """Both ends of a stage's play, at the shaft where its load paths join."""
    factor = np.array(stage.sense * stage.factor)
    if isinstance(stage, ParallelStage):
        both = tuple(
            {variable: factor * weight for variable, weight in form.items()} for form in _meeting(stage, flank, read)
        )
        return (both[0], both[1]) if stage.sense > 0 else (both[1], both[0])
    side = flank(stage)
    if side is None:
        half = np.array(stage.factor / 2)
        middle: LinearForm = {(stage, "rest"): factor} if stage.has_middle else {}
        return {**middle, (stage, "play"): -half}, {**middle, (stage, "play"): half}
    # a right flank (1) is left by a turn in the positive sense
    resting: LinearForm = {(stage, "rest"): factor}
    turned: LinearForm = {(stage, "rest"): factor, (stage, "play"): factor * side}
    return (resting, turned) if factor * side > 0.0 else (turned, resting)


def _reversed(form: LinearForm) -> LinearForm:
    return {variable: -weight for variable, weight in form.items()}


def _sum(first: LinearForm, second: LinearForm) -> LinearForm:
    zero = np.array(0.0)
    return {
        variable: np.asarray(first.get(variable, zero) + second.get(variable, zero)) for variable in {**first, **second}
    }


def _chosen(forms: list[LinearForm], which: NDArray[np.intp]) -> LinearForm:
    """Row by row one of several forms."""
    variables = dict.fromkeys(variable for form in forms for variable in form)
    zero = np.array(0.0)
    return {
        variable: np.select([which == k for k in range(len(forms))], [form.get(variable, zero) for form in forms])
        for variable in variables
    }
