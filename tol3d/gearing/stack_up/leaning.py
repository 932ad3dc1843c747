"""Shares of contributors that both tilt and shift the axis of a spur gear, as the bearings of a shaft do.

The loss by a tilt, `Stack.lost`, is no sum, so that mean and variance are integrated over the laws of all contributors
of one group: those that tilt the same gears. The rule is one net of fixed points, no trials: no seed or number of
trials is in it. Each contributor has its own part of the variance (first-order Sobol' index); joint parts are shared in
the ratio of total less first-order index, equally if two act together. Source: Saltelli et al., Comput. Phys. Commun.
181 (2010), table 2 (the estimators of both indices).
"""

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial
from itertools import islice

import numpy as np

from tol3d.gearing.model import Contributor
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gears import GearPair
from tol3d.numerics.arrays import Array
from tol3d.statistics.samplers.sobol import Sobol
from tol3d.statistics.samplers.stream import Stream
from tol3d.study.system.closed_form import Share
from tol3d.study.system.contributor import Contributor as AnyContributor

Change = Callable[[Mapping[str, Array]], Array]

NET_POINTS = 2**16
"""Errors seen: of sigma 1e-5 with two bearings, 3e-4 with four normal laws; of a mean 1e-4 sigma with few contributors,
5e-4 sigma where 14 of them lean a gear, which is what as many random points have."""


def leaning_groups(stacks: Sequence[Stack[GearPair]]) -> tuple[tuple[Contributor, ...], ...]:
    """Contributors that lean gears, those together that lean the same gear pairs."""
    groups: list[dict[str, Contributor]] = []
    for stack in stacks:
        own = {term.contributor.name: term.contributor for term in stack.terms if term.leans}
        if own:
            touched = [group for group in groups if group.keys() & own.keys()]
            groups = [group for group in groups if group not in touched]
            groups.append({name: each for group in [*touched, own] for name, each in group.items()})
    return tuple(tuple(group.values()) for group in groups)


def leaning_shares(
    parts: Sequence[tuple[float, Stack[GearPair]]], group: Sequence[Contributor], slid: Mapping[str, float]
) -> list[Share]:
    """The shares of a group in a sum of stack-ups; the coefficient of each is its mean slope.

    Args:
        parts: each stack-up with the change of the measure by its normal backlash.
        group: contributors whose deviations rest in the world.
        slid: change of the measure per deviation by shafts that slide, by contributor.
    """
    return shares_by_net(partial(change_of, parts, slid=slid), group)


def shares_by_net(change: Change, group: Sequence[AnyContributor]) -> list[Share]:
    """The shares of a group in a measure that is no sum of their single effects.

    Args:
        change: of the measure (points,), by the deviations (points, components) of the group, by name.
        group: contributors whose deviations rest in the world.
    """
    first, second = (_deviations(group, half) for half in _net(2 * sum(c.draw.uniforms for c in group)))
    value, other = change(first), change(second)
    mean, variance = float(value.mean()), float(value.var())
    alone, involved = np.zeros(len(group)), np.zeros(len(group))
    for k, contributor in enumerate(group):
        name = contributor.name
        alike = change({**second, name: first[name]})
        alone[k] = float(np.mean((value - mean) * (alike - other)))
        changed = change({**first, name: second[name]})
        involved[k] = float(np.mean((value - changed) ** 2)) / 2
    together = np.maximum(involved - alone, 0.0)
    weights = together / together.sum() if together.any() else np.full(len(group), 1 / len(group))
    variances = alone + (variance - alone.sum()) * weights
    return [
        Share(contributor.name, _mean_slope(first[contributor.name], value), mean / len(group), float(own))
        for contributor, own in zip(group, variances, strict=True)
    ]


def change_of(
    parts: Sequence[tuple[float, Stack[GearPair]]], deviations: Mapping[str, Array], slid: Mapping[str, float]
) -> Array:
    """Change of a measure (points,) by the deviations (points, components) of some contributors alone."""
    total = np.zeros(len(next(iter(deviations.values()))))
    at_rest = (np.zeros(1), np.zeros(1))
    for factor, stack in parts:
        in_plane, across = np.zeros(len(total)), np.zeros(len(total))
        for term in (term for term in stack.terms if term.contributor.name in deviations):
            own = deviations[term.contributor.name]
            if term.tilts is None:
                total += factor * term.change(own, at_rest)
            else:
                in_plane += own @ term.tilts[0]
                across += own @ term.tilts[1]
        total -= factor * stack.lost(in_plane, across)
    for name in slid.keys() & deviations.keys():
        total += slid[name] * deviations[name][:, 0]
    return total


@lru_cache(maxsize=2)
def _net(dimensions: int) -> tuple[Array, Array]:
    """Two halves of one net in the unit cube, (dimensions / 2, points) each."""
    net = Sobol(0, NET_POINTS, dimensions)
    points = np.stack([net.uniforms(Stream("lean", str(k), k), 0, NET_POINTS) for k in range(dimensions)])
    points.flags.writeable = False
    return points[: dimensions // 2], points[dimensions // 2 :]


def _deviations(group: Sequence[AnyContributor], uniforms: Array) -> Mapping[str, Array]:
    """Deviations (points, components) of each of a group."""
    streams = iter(uniforms)
    draws = ((each.name, each.draw.deviations(*islice(streams, each.draw.uniforms))) for each in group)
    return {name: np.stack(own, axis=1) for name, own in draws}


def _mean_slope(own: Array, value: Array) -> float:
    """Slope of the straight line through a value over a deviation (points, components), the length of several."""
    spread = own - own.mean(axis=0)
    squares = (spread**2).sum(axis=0)
    slopes = (spread * (value - value.mean())[:, None]).sum(axis=0) / np.where(squares > 0.0, squares, 1.0)
    return float(slopes[0]) if len(slopes) == 1 else float(np.hypot.reduce(slopes))
