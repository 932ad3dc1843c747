"""Regressors of a measure of gears for each contributor that acts on it: the columns for its variance.

A turning offset matters by its direction at the mesh, so it is turned into the world at the trial's position; over a
whole turn only its length matters. Squares represent one-sided effects such as tilts.
"""

from collections.abc import Hashable, Mapping, Sequence, Set
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.links import LinkTrials, StatedLink
from tol3d.gearing.methods.analytic import analytic_values
from tol3d.gearing.model import Contributor, Effect, LinkDeviation, LostMotion, Measure, Mesh, Model, Planar
from tol3d.gearing.play.linked import link_contributors
from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import row_keys
from tol3d.study.system.regressors import is_group, regress_plainly, regress_term
from tol3d.study.system.stated import mean_deviations, stated
from tol3d.study.system.taken import ROWS_AT_ONCE, taken
from tol3d.study.system.trials import Trials

Columns = Mapping[str, NDArray[Any]]


def acting(model: Model, measure: Measure) -> tuple[Contributor, ...]:
    """The contributors that act on a measure: on one of its meshes or other links, or by a shaft that slides."""
    meshes = [model.mesh(backlash.mesh) for _, backlash in measure.kind.backlashes]
    links = {name for _, name in measure.kind.links}
    clocked = meshes if isinstance(measure.kind, LostMotion) and measure.kind.joins else ()
    sliding = measure.kind.sliding
    return tuple(
        contributor
        for contributor in model.contributors
        if _acts(contributor.effect, meshes, links, clocked) or any(map(contributor.effect.slides, sliding))
    )


def _acts(effect: Effect, meshes: Sequence[Mesh], links: Set[str], clocked: Sequence[Mesh]) -> bool:
    return (
        any(effect.acts_in(mesh) for mesh in meshes)
        or any(effect.clocking(mesh) for mesh in clocked)
        or any(effect.acts_on(link) for link in links)
    )


def regressor_key(measure: Measure) -> Hashable:
    """Measures of one key have the same regressors."""
    kind = measure.kind
    read = tuple(replace(backlash, quantity="normal_backlash", gear="") for _, backlash in kind.backlashes)
    return read, tuple(name for _, name in kind.links), kind.sliding, measure.positions, measure.take == "value"


def regress(
    model: Model, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
) -> None:
    """Write contributors' rows (2, trials) from the columns of their components, over each one's sigma."""
    turning = _Turning(_angles(model, measure, columns) if measure.take == "value" else {})
    parts = _parts_in_links(model, measure, columns)
    for contributor in contributors:
        own = rows[contributor.name]
        if contributor.name in parts and isinstance(contributor.effect, LinkDeviation):
            own[...] = 0.0
            own[0] = parts[contributor.name]
            continue
        if is_group(contributor) or _slides_by_its_length(contributor, measure):
            regress_term(own, *_group_term(model, measure, contributor, columns))
            continue
        values = [np.asarray(columns[name], dtype=np.float64) * contributor.per_unit for name in contributor.columns]
        _regress(own, contributor, values, turning)
        if contributor.name in parts:  # of a shaft: across the line of centres it has no effect on a mesh
            own[1] = parts[contributor.name]


def _slides_by_its_length(contributor: Contributor, measure: Measure) -> bool:
    """True of a clearance anywhere round an axis by which a shaft slides, which no component of it tells."""
    return isinstance(contributor.draw, Planar) and any(map(contributor.effect.slides, measure.kind.sliding))


def _parts_in_links(model: Model, measure: Measure, columns: Columns) -> Mapping[str, Array]:
    """Contribution of each contributor in links to a measure (trials,), if its link states it; [its unit]."""
    found: dict[str, Array] = {}
    for factor, name in measure.kind.links if measure.take == "value" else ():
        link, seen = model.link(name), _link_trials(model, measure, name, columns)
        if not link.compares:
            continue
        means = {
            contributor.name: np.array(
                contributor.draw.mean(turning=model.turns_at_random(contributor, measure.positions))
            )
            for contributor in seen.contributors
        }
        parts = _parts(link, seen, means)
        found |= {name: factor * measure.per_internal * part for name, part in parts.items()}
    return found


def _parts(link: StatedLink, seen: LinkTrials, means: Mapping[str, Array]) -> Mapping[str, Array]:
    """Contributions to a link's play; each trial is computed once for all measures and evaluations."""
    by_bores = {own.contributor for own in link.moved}
    names = [name for name in seen.deviations if name not in by_bores]
    if not names:
        return {}
    rows = np.concatenate([seen.angles[:, :1], *seen.deviations.values()], axis=1)
    (about,) = row_keys(np.concatenate([means[name] for name in names])[None])

    def find(new: NDArray[np.intp]) -> Sequence[Array]:
        parts = link.parts(seen.rows(new), means)
        return [*np.stack([parts[name] for name in names], axis=1)]

    every = np.array(link.known_parts(about).of(row_keys(rows), find))
    return {name: every[:, k] for k, name in enumerate(names)}


def slopes_by_bores(model: Model, measure: Measure, link: str, columns: Columns) -> Mapping[str, Array]:
    """Change of a link's play by each displacement of the bores of its parts [rad/mm], by contributor (trials, 2)."""
    own = model.link(link)
    return own.slopes_by_bores(_link_trials(model, measure, link, columns)) if own.moved else {}


def _link_trials(model: Model, measure: Measure, link: str, columns: Columns) -> LinkTrials:
    own = link_contributors(model, link)
    deviations = {
        each.name: np.stack([np.asarray(columns[key], dtype=np.float64) for key in each.columns], axis=-1)
        * each.per_unit
        for each in own
    }
    return LinkTrials(own, deviations, _link_angles(model, measure, link, columns))


def _link_angles(model: Model, measure: Measure, link: str, columns: Columns) -> Array:
    """Angle of a link's driver [rad], (trials, 1); 0 for a link whose play does not depend on it."""
    if position_column(link) not in columns:
        return np.zeros((len(next(iter(columns.values()))), 1))
    angles = np.radians(np.asarray(columns[position_column(link)], dtype=np.float64))[:, None]
    fixed = model.driver_angles(measure, link)
    return angles if fixed is None else np.full_like(angles, fixed[0])


def _group_term(model: Model, measure: Measure, contributor: Contributor, columns: Columns) -> tuple[Array, float]:
    """Effect of a group of many components on a measure by the stack-up (trials,) [mm or rad], and its size.

    All others are at their means. For a curve, the effect at the first position.
    """
    means = mean_deviations(model, measure.positions)
    own = [np.asarray(columns[name], dtype=np.float64) * contributor.per_unit for name in contributor.columns]
    deviations = np.repeat(means, len(own[0]), axis=0)
    deviations[:, model.component_slices[contributor.name]] = np.stack(own, axis=-1)
    positions = {name: np.zeros(len(deviations)) for name in stated(model, means).positions}
    for name in positions:
        if (column := position_column(name)) in columns:
            positions[name] = np.radians(np.asarray(columns[column], dtype=np.float64))
    trials = Trials(deviations, positions)
    at_once = max(1, ROWS_AT_ONCE // measure.positions.in_a_trial)
    found = np.concatenate(
        [
            values[:, 0] if measure.take == "curve" else taken(measure, values)
            for first in range(0, len(trials), at_once)
            for values in [analytic_values(model, measure, trials.part(first, first + at_once))]
        ]
    )
    meshes = [model.mesh(own.mesh) for _, own in measure.kind.backlashes] if measure.kind.is_angle else []
    arm = meshes[0].pair.wheel.base_radius if meshes else 1.0
    return found, contributor.draw.sigma / arm


def _angles(model: Model, measure: Measure, columns: Columns) -> Mapping[str, Array]:
    """Angles of the gears of a measure's meshes, each in the first of them [rad], (trials,)."""
    angles: dict[str, Array] = {}
    for _, backlash in measure.kind.backlashes:
        mesh = model.mesh(backlash.mesh)
        driver = np.radians(np.asarray(columns[position_column(mesh.name)], dtype=np.float64))
        if (fixed := model.driver_angles(measure, mesh.name)) is not None:
            driver = np.full_like(driver, fixed[0])
        angles.setdefault(mesh.driver, driver)
        angles.setdefault(mesh.driven, mesh.pair.driven_angle(driver))
    return angles


def position_column(mesh: str) -> str:
    """Name of the column with the random driver position of a mesh, or another link."""
    return f"position:{mesh} [deg]"


class _Turning:
    """Cosines and sines of gears' turns, each computed once."""

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
    """Effect of a contributor on the gears that are read; of a shaft on the first of them, for they turn alike."""
    effects = contributor.effect.singles
    return next((effect for effect in effects if effect.turns_with in turning), effects[0])


def _regress(rows: Array, contributor: Contributor, values: Sequence[Array], turning: _Turning) -> None:
    """Write a contributor's two rows (2, trials) from the columns of its components."""
    effect = _acting_effect(contributor, turning)
    if not isinstance(contributor.draw, Planar) or effect.turns_with is None:
        regress_plainly(rows, contributor, values)
        return
    law = contributor.distribution
    per_spread = 1.0 / (law.sigma or 1.0)
    x, y = values
    if effect.turns_with in turning:
        cos, sin = turning[effect.turns_with]
        y = -y if effect.mirrored else y
        np.multiply(cos * x - sin * y, per_spread, out=rows[0])
        np.multiply(sin * x + cos * y, per_spread, out=rows[1])
    else:
        np.multiply(np.sqrt(x * x + y * y) - law.mean, per_spread, out=rows[0])
        np.square(rows[0], out=rows[1])
