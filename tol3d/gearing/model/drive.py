"""Trees of shafts as their positions are drawn: until all stands as before."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from tol3d.gearing.links import StatedLink
from tol3d.gearing.model.links import Link
from tol3d.gearing.model.mesh import Mesh


@dataclass(frozen=True)
class Drive:
    """A tree of shafts.

    Args:
        root: its first shaft.
        name: of the stream that draws its positions.
        turns: of the root, until all teeth meet again in the same places; a fraction.
        moves: its meshes' names, then those of its other links whose play depends on the position.
    """

    root: str
    name: str
    turns: Fraction
    moves: tuple[str, ...]


def periods_of(
    meshes: Sequence[Mesh], stated: Sequence[StatedLink], rates: Mapping[str, Fraction]
) -> Mapping[str, Fraction]:
    """Turns of the root after which each mesh, and each other link with positions, stands as before.

    Args:
        meshes, stated: of all trees.
        rates: turns of the driver of each per turn of the root; against the carrier where there is one.
    """
    periods = {mesh.name: mesh.pair.long_period_turns / abs(rates[mesh.name]) for mesh in meshes}
    for own in stated:
        if own.turns is not None and rates[own.name]:
            periods[own.name] = own.turns / abs(rates[own.name])
    return periods


def drives_of(links: Sequence[Link], root_of: Mapping[str, str], periods: Mapping[str, Fraction]) -> Iterator[Drive]:
    """The trees of which anything depends on the position."""
    for root in dict.fromkeys(root_of.values()):
        own_links = [link for link in links if root_of[link.driver] == root]
        names = {link.name for link in own_links}
        own = {name: period for name, period in periods.items() if name in names}
        if own:
            name = own_links[0].name if len(own_links) == 1 else root
            yield Drive(root, name, least_common(list(own.values())), tuple(own))


def least_common(periods: Sequence[Fraction]) -> Fraction:
    """The least common multiple of fractions."""
    numerators = math.lcm(*(period.numerator for period in periods))
    return Fraction(numerators, math.gcd(*(period.denominator for period in periods)))
