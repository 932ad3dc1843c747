"""What a measure sees of each contributor that acts on it: the columns that shares of the variance are regressed on.

A turning offset matters by where it points at the mesh, so it is turned into the world at the trial's
position; over a whole turn only its length matters. Squares catch one-sided effects such as tilts.
"""

from collections.abc import Mapping, Sequence, Set
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import (
    Backlash,
    Contributor,
    Effect,
    Measure,
    Mesh,
    Model,
    Planar,
    Positions,
)
from tol3d.gearing.stack_up import reference_form
from tol3d.study.block import Columns, position_column

Array = NDArray[np.float64]

FEATURES_EACH = 2  # columns a contributor: value and square, or the two components of a vector
MOST_REGRESSED = 128
"""Contributors of a measure that are regressed on: the sums of products of all pairs of their features go with their
square, and with more of them shares of the variance sink below the errors of any number of trials."""


def acting(model: Model, measure: Measure) -> tuple[Contributor, ...]:
    """The contributors that act on a measure: on one of its meshes, or one of its reducers."""
    meshes = [model.mesh(backlash.mesh) for _, backlash in measure.kind.backlashes]
    reducers = {name for _, name in measure.kind.reducers}
    clocked = () if measure.kind.adds_up else meshes
    return tuple(
        contributor for contributor in model.contributors if _acts(contributor.effect, meshes, reducers, clocked)
    )


def _acts(effect: Effect, meshes: Sequence[Mesh], reducers: Set[str], clocked: Sequence[Mesh]) -> bool:
    return (
        any(effect.acts_in(mesh) for mesh in meshes)
        or any(effect.clocking(mesh) for mesh in clocked)
        or any(effect.play_of(reducer) for reducer in reducers)
    )


def regressed(model: Model, measure: Measure) -> tuple[Contributor, ...]:
    """The contributors whose shares are told: all that act on a measure, or the largest MOST_REGRESSED of them.

    What counts there is the variance by the stack-up; where it has no closed form, the scene's order.
    """
    contributors = acting(model, measure)
    return contributors if len(contributors) <= MOST_REGRESSED else _largest(_Itself(model), _Itself(measure))


class _Itself:
    """A thing as a key: itself, not its like."""

    def __init__(self, thing: Any) -> None:
        self.thing = thing

    def __hash__(self) -> int:
        return id(self.thing)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Itself) and other.thing is self.thing


@lru_cache(maxsize=64)
def _largest(model: _Itself, measure: _Itself) -> tuple[Contributor, ...]:
    """The largest contributors of a measure, in the scene's order; each block asks for them anew."""
    contributors = acting(model.thing, measure.thing)
    form = reference_form(model.thing, measure.thing)
    variance = {share.name: share.variance for share in form.shares} if form else {}
    largest = sorted(contributors, key=lambda contributor: -variance.get(contributor.name, 0.0))[:MOST_REGRESSED]
    names = {contributor.name for contributor in largest}
    return tuple(contributor for contributor in contributors if contributor.name in names)


def feature_groups(model: Model, measure: Measure) -> Mapping[str, slice]:
    """Which feature columns of a measure belong to each contributor that is regressed on."""
    return {
        contributor.name: slice(FEATURES_EACH * k, FEATURES_EACH * (k + 1))
        for k, contributor in enumerate(regressed(model, measure))
    }


def features(model: Model, measure: Measure, columns: Columns) -> Array:
    """Features of a block for one measure, a row each, (2 x regressed contributors, trials), over each one's sigma."""
    contributors, groups = regressed(model, measure), feature_groups(model, measure)
    turning = _Turning(_angles(model, measure, columns) if measure.take == "value" else {})
    trials = len(next(iter(columns.values())))
    rows = np.empty((FEATURES_EACH * len(contributors), trials))
    for contributor, own in zip(contributors, groups.values(), strict=True):
        values = [np.asarray(columns[name], dtype=np.float64) * contributor.per_unit for name in contributor.columns]
        _fill(rows[own], contributor, values, turning)
    return rows


def _angles(model: Model, measure: Measure, columns: Columns) -> Mapping[str, Array]:
    """Where the gears of a measure's meshes stand, each in the first of them [rad], (trials,)."""
    angles: dict[str, Array] = {}
    for _, backlash in measure.kind.backlashes:
        mesh = model.mesh(backlash.mesh)
        driver = np.radians(np.asarray(columns[position_column(mesh)], dtype=np.float64))
        if (fixed := model.driver_angles(measure, mesh.name)) is not None:
            driver = np.full_like(driver, fixed[0])
        angles.setdefault(mesh.driver, driver)
        angles.setdefault(mesh.driven, mesh.pair.driven_angle(driver))
    return angles


FeatureKey = tuple[tuple[Backlash, ...], tuple[str, ...], Positions, bool]


def feature_key(measure: Measure) -> FeatureKey:
    """Measures of one key have the same features."""
    kind = measure.kind
    read = tuple(replace(backlash, quantity="normal_backlash", gear="") for _, backlash in kind.backlashes)
    return read, tuple(name for _, name in kind.reducers), measure.positions, measure.take == "value"


class _Turning:
    """Cosines and sines of gears' turns, each worked out once."""

    def __init__(self, angles: Mapping[str, Array]) -> None:
        self._angles = angles
        self._known: dict[str, tuple[Array, Array]] = {}

    def __contains__(self, part: str | None) -> bool:
        return part in self._angles

    def __getitem__(self, part: str) -> tuple[Array, Array]:
        if part not in self._known:
            self._known[part] = (np.cos(self._angles[part]), np.sin(self._angles[part]))
        return self._known[part]


def _acting_effect(contributor: Contributor, turning: _Turning) -> Effect:
    """What a contributor does to the gears that are read; of a shaft to the first of them, for they turn alike."""
    effects = contributor.effect.singles
    return next((effect for effect in effects if effect.turns_with in turning), effects[0])


def _fill(rows: Array, contributor: Contributor, values: Sequence[Array], turning: _Turning) -> None:
    """Write a contributor's two rows (2, trials) from the columns of its components."""
    law, effect = contributor.distribution, _acting_effect(contributor, turning)
    per_spread = 1.0 / (law.sigma or 1.0)
    if not isinstance(contributor.draw, Planar):
        np.multiply(values[0] - law.mean, per_spread, out=rows[0])
        np.square(rows[0], out=rows[1])
        return
    x, y = values
    if effect.turns_with is None:
        np.multiply(x, per_spread, out=rows[0])
        np.multiply(y, per_spread, out=rows[1])
    elif effect.turns_with in turning:
        cos, sin = turning[effect.turns_with]
        y = -y if effect.mirrored else y
        np.multiply(cos * x - sin * y, per_spread, out=rows[0])
        np.multiply(sin * x + cos * y, per_spread, out=rows[1])
    else:
        np.multiply(np.sqrt(x * x + y * y) - law.mean, per_spread, out=rows[0])
        np.square(rows[0], out=rows[1])
