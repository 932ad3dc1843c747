"""Mean, standard deviation and shares of a backlash in a housing, without drawing anything.

Where no axis leans, or the middle of the faces is read, a backlash is linear in the displacements of the bores, and
these in the tolerances of the housing. Where axes lean, what they take is no sum: mean and variance are integrated over
the laws of all contributors that lean gears, those of the bores among them, as for bearings (see
gearing/stack_up/leaning.py).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from tol3d.assembly.moments import moments_of
from tol3d.gearing.machine.joined import Joined
from tol3d.gearing.model import Contributor as GearContributor
from tol3d.gearing.model import Measure as GearMeasure
from tol3d.gearing.model import Model
from tol3d.gearing.stack_up import closed_form as closed_form_of_gears
from tol3d.gearing.stack_up import reference_form, stack_of
from tol3d.gearing.stack_up.closed_form import factored_stacks, sliding_coefficients
from tol3d.gearing.stack_up.leaning import change_of, shares_by_net
from tol3d.numerics.arrays import Array
from tol3d.study.system.closed_form import ClosedForm, Share
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.dependent import reads_of
from tol3d.study.system.stated import component_slices

LEVEL: Final = 1e-12
"""Difference of the displacements of both ends of an axis per mm, rad or K that is rounding."""


def closed_form(system: Joined, measure: GearMeasure, *, at_one_position: bool = False) -> ClosedForm | None:
    """Moments of a backlash.

    None of extremes over a turn, where load paths are compared, and where what displaces bores is no sum itself: a
    plane that touches with its outermost corner, a part that rests; or reads sizes and leans gears.

    Args:
        system: whose.
        measure: of its gears.
        at_one_position: of a measure that takes an extreme or a curve, that of its value at one position.
    """
    model = system.gears.model
    leaning = _leaning(model, measure)
    group = [
        contributor
        for contributor in system.contributors
        if contributor.name in leaning or contributor.name in _moving(system)
    ]
    net = bool(leaning & _leaning_bores(system))
    if system.bends(measure) or (net and any(reads_of(own) for own in group)):
        return None
    if sliding_coefficients(model, measure) is None:
        return None
    drawn = tuple(
        drawn_by_gear for drawn_by_gear in system.drawn_by_gears if not (net and drawn_by_gear.name in leaning)
    )
    plain = replace(model, contributors=drawn)
    form = reference_form(plain, measure) if at_one_position else closed_form_of_gears(plain, measure)
    if form is None:
        return None
    both = {contributor.name for contributor in system.drawn.contributors} & {own.name for own in drawn}
    direct = {share.name: share.coefficient for share in form.shares if share.name in both}
    shares = [share for share in form.shares if share.name not in both]
    shares += _by_net(system, measure, group, direct) if net else _linear(system, measure, direct)
    together = tuple(_merged(system.contributors, shares))
    return replace(
        form,
        mean=form.nominal + sum(share.mean for share in together),
        sigma=float(np.sqrt(max(0.0, sum(share.variance for share in together)))),
        shares=together,
        leaning=form.leaning | (frozenset(own.name for own in group) if net else frozenset()),
    )


def with_joints(form: ClosedForm, joints: Sequence[tuple[float, ClosedForm]], order: Sequence[str]) -> ClosedForm:
    """Moments of a part's measure, with the turns by trains.

    Contributors of two trains, or of a train and the part, are added up where they are; their common part of the
    variance is that of coefficients added up, as long as each acts by one coefficient.

    Args:
        form: of the part, its joints in the middle of their plays.
        joints: movement of the measure by each lost motion, and the moments of that.
        order: of the contributors.
    """
    shares: dict[str, Share] = {share.name: share for share in form.shares}
    for factor, own in joints:
        for share in own.shares:
            added = Share(share.name, factor * share.coefficient, factor * share.mean, factor**2 * share.variance)
            shares[share.name] = _together(shares[share.name], added) if share.name in shares else added
    together = tuple(shares[name] for name in order if name in shares)
    nominal = form.nominal + sum(factor * own.nominal for factor, own in joints)
    sigma = float(np.sqrt(sum(share.variance for share in together)))
    leaning = form.leaning.union(*(own.leaning for _, own in joints))
    return replace(
        form,
        nominal=nominal,
        mean=nominal + sum(share.mean for share in together),
        sigma=sigma,
        shares=together,
        leaning=leaning,
    )


def _together(first: Share, second: Share) -> Share:
    """Combined effect of one contributor that acts twice, by one coefficient each: sigma is that of the sum."""
    sigmas = [np.sign(own.coefficient) * np.sqrt(own.variance) for own in (first, second)]
    return Share(first.name, first.coefficient + second.coefficient, first.mean + second.mean, float(sum(sigmas)) ** 2)


def _leaning(model: Model, measure: GearMeasure) -> set[str]:
    """Contributors of the gears, displacements of the bores too, that lean a gear where its lean counts."""
    stacks = [stack_of(model, model.mesh(own.mesh), own.reading) for _, own in measure.kind.backlashes]
    return {term.contributor.name for stack in stacks for term in stack.terms if term.leans}


def _leaning_bores(system: Joined) -> set[str]:
    """The displacements of the bores of shafts that contributors of the assembly lean."""
    ends = system.displacing.reshape(len(system.bores.shafts), 2, 2, system.displacing.shape[1])
    first, last = (ends[:, k] for k in range(2))
    leans = (np.abs(last - first) > LEVEL).any(axis=(1, 2))
    return {own.name for own, lean in zip(system.displacements, np.repeat(leans, 2), strict=True) if lean}


def _moving(system: Joined) -> set[str]:
    """Contributors of the assembly that move bores."""
    slices = component_slices(system.drawn)
    return {
        contributor.name
        for contributor in system.drawn.contributors
        if system.displacing[:, slices[contributor.name]].any()
    }


def _linear(system: Joined, measure: GearMeasure, direct: Mapping[str, float]) -> list[Share]:
    """Shares of contributors to the bores, if a backlash is linear in them; `direct` is their effect on the gears."""
    slopes = np.asarray(system.bore_slopes(measure) @ system.displacing)
    slices = component_slices(system.drawn)
    found = []
    for own in system.drawn.contributors:
        coefficients = slopes[slices[own.name]] + direct.get(own.name, 0.0)
        mean, covariance = moments_of(own)
        size = float(coefficients[0]) if len(coefficients) == 1 else float(np.sqrt(coefficients @ coefficients))
        if coefficients.any():
            variance = float(coefficients @ covariance @ coefficients)
            found.append(Share(own.name, size, float(coefficients @ mean), variance))
    return found


def _by_net(
    system: Joined, measure: GearMeasure, group: Sequence[Contributor], direct: Mapping[str, float]
) -> list[Share]:
    """Shares of a group that leans gears; `direct` is what those do to the gears that do more than move bores."""
    stacks, slid = factored_stacks(model := system.gears.model, measure), sliding_coefficients(model, measure) or {}
    bores = system.displacements
    slices = component_slices(system.drawn)
    displaced: dict[tuple[str, int], Array] = {}
    nothing = np.zeros((1, 4 * len(system.bores.shafts)))

    def displacement(name: str, own: Array) -> Array:
        """Displacement of the bores (points, shafts * 4); computed once per array."""
        key = name, id(own)
        if key not in displaced:
            displaced[key] = own @ system.displacing[:, slices[name]].T
        return displaced[key]

    def change(deviations: Mapping[str, Array]) -> Array:
        moved = sum((displacement(name, own) for name, own in deviations.items() if name in slices), nothing)
        by_bores = {own.name: np.asarray(moved)[:, 2 * k : 2 * k + 2] for k, own in enumerate(bores)}
        others = {name: own for name, own in deviations.items() if name not in slices}
        linear = sum(slope * deviations[name][:, 0] for name, slope in direct.items() if name in deviations)
        return change_of(stacks, by_bores | others, slid) + linear

    return shares_by_net(change, group)


def _merged(contributors: Sequence[Contributor | GearContributor], shares: Sequence[Share]) -> list[Share]:
    """One share per contributor, in their order: its effect on the gears plus that by the bores."""
    found = []
    for contributor in contributors:
        own = [share for share in shares if share.name == contributor.name]
        if own:
            sums = (sum(getattr(share, key) for share in own) for key in ("coefficient", "mean", "variance"))
            found.append(Share(contributor.name, *sums))
    return found
