"""Regressors of a backlash by contributors that move bores: each of their components, over its sigma."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.torsors import method as torsors
from tol3d.assembly.zones import ZoneDraw
from tol3d.gearing.effects import Effect, LinkDeviation
from tol3d.gearing.grammar.tolerances.gearing_tolerance import together
from tol3d.gearing.machine.joined import Joined, is_hidden
from tol3d.gearing.methods.regressors import slopes_by_bores
from tol3d.gearing.model.measure import Measure
from tol3d.gearing.system import GearSystem
from tol3d.numerics.arrays import Array
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.regressors import is_group, regress_plainly, regress_term
from tol3d.study.system.stated import component_slices
from tol3d.study.system.system import Columns


def with_displacements(system: Joined, measure: Measure, columns: Columns) -> Columns:
    """Columns with those of the displacements of bores, where a measure reads a link whose parts lie in some.

    Args:
        system: whose.
        measure: of its gears.
        columns: of the trials.
    """
    if not any(system.link_shafts[name] for _, name in measure.kind.links):
        return columns
    own = [contributor for contributor in system.drawn.contributors if not is_hidden(contributor)]
    deviations = np.zeros((len(next(iter(columns.values()))), system.drawn.assembly.width))
    slices = component_slices(system.drawn)
    for each in own:
        deviations[:, slices[each.name]] = _values(each, columns)
    read = torsors.values(system.bores.assembly, deviations, system.bores.lateral_names)
    displaced = system.bores.to_first_order(read)
    names = [(name, displacement.per_unit) for displacement in system.displacements for name in displacement.columns]
    return {**columns, **{name: displaced[:, k] / unit for k, (name, unit) in enumerate(names)}}


def parts_by_links(
    system: Joined, measure: Measure, contributors: Sequence[Contributor], columns: Columns
) -> Mapping[str, Array]:
    """Effects on a measure of contributors that displace bores of a link's parts (trials,), by name, in its unit.

    By the contacts that the link meets in each trial; effects on meshes of the load path, by its slopes at the
    means, are included.

    Args:
        system: the machine.
        measure: of its gears.
        contributors: of the assembly.
        columns: of the trials, those of the displacements too.
    """
    places = {own.name: 2 * k for k, own in enumerate(system.displacements)}
    slopes: dict[int, Array] = {}
    for factor, name in measure.kind.links if measure.take == "value" else ():
        for point, by in slopes_by_bores(system.gears.model, measure, name, columns).items():
            own = factor * measure.per_internal * by
            slopes[places[point]] = slopes[places[point]] + own if places[point] in slopes else own
    if not slopes:
        return {}
    meshes = measure.per_internal * _without_links(system).bore_slopes(measure)
    slices, found = component_slices(system.drawn), dict[str, Array]()
    for contributor in contributors:
        off = _values(contributor, columns) - np.array(contributor.draw.mean(turning=False))
        displaced = off @ system.displacing[:, slices[contributor.name]].T
        if displaced[:, [row + k for row in slopes for k in range(2)]].any():
            through = (np.einsum("ij,ij->i", by, displaced[:, row : row + 2]) for row, by in slopes.items())
            found[contributor.name] = np.asarray(sum(through, displaced @ meshes))
    return found


def _values(contributor: Contributor, columns: Columns) -> Array:
    """Its components (trials, components) [mm, rad, K]."""
    return (
        np.stack([np.asarray(columns[name], dtype=np.float64) for name in contributor.columns], axis=-1)
        * contributor.per_unit
    )


def _without_links(system: Joined) -> Joined:
    """The same, its bores moving nothing of its links."""
    model, names = system.gears.model, {displacement.name for displacement in system.displacements}
    contributors = (
        replace(contributor, effect=together(_of_meshes(contributor.effect)))
        if contributor.name in names
        else contributor
        for contributor in model.contributors
    )
    links = tuple(replace(link, moved=()) for link in model.links)
    return replace(system, gears=GearSystem(replace(model, contributors=tuple(contributors), links=links)))


def _of_meshes(effect: Effect) -> list[Effect]:
    return [single for single in effect.singles if not isinstance(single, LinkDeviation)]


def regress_bores(
    contributors: Sequence[Contributor],
    columns: Columns,
    rows: Mapping[str, Array],
    squared: Mapping[str, NDArray[np.bool_]],
    slopes: Callable[[], Mapping[str, Array]],
) -> None:
    """Write contributors' rows (regressors, trials), see System.regress.

    Args:
        contributors: that move bores.
        columns: of the trials.
        rows: by contributor.
        squared: by contributor, which components displace bores to both sides of their mean alike.
        slopes: of the measure by each component of a contributor; asked for groups only.
    """
    for contributor in contributors:
        values = [np.asarray(columns[name], dtype=np.float64) * contributor.per_unit for name in contributor.columns]
        if is_group(contributor):
            mine = slopes()[contributor.name]
            term = sum((slope * value for slope, value in zip(mine, values, strict=True)), np.zeros(len(values[0])))
            regress_term(rows[contributor.name], term, contributor.draw.sigma * float(np.sqrt((mine * mine).sum())))
        elif isinstance(contributor.draw, ZoneDraw) and len(values) > 1:
            moments = zip(contributor.draw.mean_vector, contributor.draw.sigmas, squared[contributor.name], strict=True)
            for row, value, (mean, sigma, bent) in zip(rows[contributor.name], values, moments, strict=True):
                np.multiply(value - mean if bent else value, 1.0 / (sigma or 1.0), out=row)
                if bent:
                    np.square(row, out=row)
        else:
            regress_plainly(rows[contributor.name], contributor, values)
