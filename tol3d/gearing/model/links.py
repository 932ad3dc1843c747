"""Links between shafts, their load paths, and the trees of shafts."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from tol3d.errors import GeometryError
from tol3d.gearing.links import StatedLink
from tol3d.gearing.shafts import Carried, Mesh, Shaft


@dataclass(frozen=True)
class Link:
    """Link that makes one shaft turn with another: a mesh, or a StatedLink.

    Args:
        name: the move's.
        driver, driven: shafts.
        rate: turns of the driven per turn of the driver, signed; both against the carrier where there is one.
        carrier: the shaft that carries the link round.
    """

    name: str
    driver: str
    driven: str
    rate: Fraction
    carrier: str | None = None

    @property
    def shafts(self) -> tuple[str, str]:
        """Driver and driven."""
        return self.driver, self.driven


@dataclass(frozen=True)
class Parallel:
    """Load paths that divide at one shaft and join at another.

    Args:
        driver, driven: the shafts.
        paths: the links of each in series; some of them may be in parallel again.
    """

    driver: str
    driven: str
    paths: tuple["LoadPath", ...]

    @property
    def name(self) -> str:
        """Its links' names."""
        return " ∥ ".join(" + ".join(element.name for element in path) for path in self.paths)


LoadPath = tuple[Link | Parallel, ...]
"""Links in series."""


def links_between_shafts(
    meshes: Sequence[Mesh], shafts: Sequence[Shaft], stated: Sequence[StatedLink]
) -> tuple[Link, ...]:
    """The meshes and stated links of a model as links of its shafts."""
    carrying = carriers(meshes, shafts)
    return (
        *(Link(own.name, own.driver, own.driven, own.rate, own.carrier) for own in stated),
        *(_link(mesh, carrying) for mesh in meshes),
    )


def carriers(meshes: Sequence[Mesh], shafts: Sequence[Shaft]) -> dict[str, tuple[str, Carried]]:
    """The shaft that carries each gear, and how; a gear that none carries is its own shaft."""
    carrying = {carry.gear: (shaft.name, carry) for shaft in shafts for carry in shaft.carries}
    for gear in (gear for mesh in meshes for gear in (mesh.driver, mesh.driven)):
        carrying.setdefault(gear, (gear, Carried(gear)))
    return carrying


def _link(mesh: Mesh, carrying: Mapping[str, tuple[str, Carried]]) -> Link:
    (driver, first), (driven, second) = carrying[mesh.driver], carrying[mesh.driven]
    return Link(mesh.name, driver, driven, mesh.rate * first.sense * second.sense)


def links_of(path: LoadPath) -> tuple[Link, ...]:
    """Every link of a load path, those in parallel too."""
    found: list[Link] = []
    for element in path:
        found += (
            [element] if isinstance(element, Link) else [link for inner in element.paths for link in links_of(inner)]
        )
    return tuple(found)


def loop_of(links: Sequence[Link]) -> tuple[str, ...]:
    """Shafts that drive each other in a ring, the first of them again at the end; empty where there are none."""
    driver = {link.driven: link.driver for link in links}
    for start in driver:
        path = [start]
        while path[-1] in driver and len(path) <= len(driver):
            path.append(driver[path[-1]])
            if path[-1] == start:
                return tuple(reversed(path))
    return ()


def upstream(driving: Mapping[str, Link], shaft: str) -> tuple[Link, ...]:
    """The links that a shaft's turn depends on, by the first of parallel load paths, those of carriers too.

    A ring of carriers ends where it comes back.
    """
    found: dict[str, Link] = {}
    waiting = [shaft]
    while waiting:
        link = driving.get(waiting.pop())
        if link is not None and link.name not in found:
            found[link.name] = link
            waiting += [link.driver] if link.carrier is None else [link.driver, link.carrier]
    return tuple(found.values())


def onwards(root: str, links: Sequence[Link]) -> Iterator[Link]:
    """The links of a root's tree, each after those that turn its driver and its carrier."""
    waiting, reached = [root], {root}
    while waiting:
        shaft = waiting.pop(0)
        for link in links:
            needed = {link.driver} if link.carrier is None else {link.driver, link.carrier}
            if shaft in needed and needed <= reached and link.driven not in reached:
                yield link
                reached.add(link.driven)
                waiting.append(link.driven)


def back_to_root(driving: Mapping[str, Link], shaft: str) -> tuple[Link, ...]:
    """The links from a shaft back to its root; by the first of parallel load paths."""
    links = []
    while shaft in driving:
        links.append(driving[shaft])
        shaft = links[-1].driver
    return tuple(links)


def load_path_between(links: Sequence[Link], first: str, last: str) -> LoadPath:
    """Load path between two shafts of a tree, in order.

    Raises:
        GeometryError: one of them lies inside parallel load paths, or these are not separate.
    """
    up, down = load_path_from_root(links, first), load_path_from_root(links, last)
    if any(link.carrier for link in links_of((*up, *down))):
        return _about_carriers(links, (up, down), (first, last))
    common = _alike([up, down])
    _refuse_incomparable(links, (*up[common:], *down[common:]))
    return (*reversed(up[common:]), *down[common:])


def _about_carriers(links: Sequence[Link], paths: tuple[LoadPath, LoadPath], ends: tuple[str, str]) -> LoadPath:
    """The load path between two shafts where carriers turn: links that turn the last shaft while the first is held."""
    (up, down), (first, last) = paths, ends
    elements = (*(element for element in reversed(up) if element not in down), *down)
    path = tuple(element for element in elements if freed_turn(links, element.driven, last, first))
    _refuse_incomparable(links, path)
    return path


def load_path_from_root(links: Sequence[Link], shaft: str) -> LoadPath:
    """The load path from a tree's root to a shaft, with the links that turn the carriers on it."""
    driving = [link for link in links if link.driven == shaft]
    if not driving:
        return ()
    each = [load_path_from_root(links, link.driver) for link in driving]
    if len(driving) == 1:
        (path,), (link,) = each, driving
        carriers = () if link.carrier is None else load_path_from_root(links, link.carrier)
        return (*path, *(element for element in carriers if element not in path), link)
    common = _alike(each)
    paths = tuple((*path[common:], link) for path, link in zip(each, driving, strict=True))
    inner = [link.name for path in paths for link in links_of(path)]
    if len(set(inner)) < len(inner):
        raise GeometryError(f"the load paths to {shaft!r} share some of their links but not at their beginning")
    return (*each[0][:common], Parallel(links_of(paths[0])[0].driver, shaft, paths))


def turns_of(links: Sequence[Link]) -> dict[str, Fraction]:
    """Turns of each shaft per turn of the first of its tree, signed; by the first of parallel load paths."""
    driving = first_drivers(links)
    turns: dict[str, Fraction] = {}
    for root in dict.fromkeys(link.driver for link in links if link.driver not in driving):
        turns[root] = Fraction(1)
        for link in onwards(root, list(driving.values())):
            turns[link.driven] = driven_turn(link, turns)
    return turns


def first_drivers(links: Sequence[Link]) -> dict[str, Link]:
    """The link that drives each shaft, the first of several."""
    driving: dict[str, Link] = {}
    for link in links:
        driving.setdefault(link.driven, link)
    return driving


def driven_turn(link: Link, turns: Mapping[str, Fraction]) -> Fraction:
    """Turns of a link's driven shaft, those of its driver and its carrier known.

    Willis: against the carrier both turn as if it rested. Source: VDI 2157:2012, 4.1.
    """
    about = Fraction(0) if link.carrier is None else turns[link.carrier]
    return about + link.rate * (turns[link.driver] - about)


def freed_turn(links: Sequence[Link], freed: str, read: str, held: str) -> Fraction:
    """Turn of a shaft that is read per turn that a freed shaft has from its driver's play, another shaft held, signed.

    All shafts of one tree turn; what is held makes its first shaft turn back.
    """
    turns = turns_of(links)
    of_read, of_held = (turned_by(links, freed, shaft) for shaft in (read, held))
    return of_read - of_held * turns[read] / turns[held]


def turned_by(links: Sequence[Link], freed: str, shaft: str) -> Fraction:
    """Turn of a shaft per turn of a freed shaft, the first shaft of their tree at rest."""
    if shaft == freed:
        return Fraction(1)
    link = first_drivers(links).get(shaft)
    if link is None:
        return Fraction(0)
    needed = (link.driver,) if link.carrier is None else (link.driver, link.carrier)
    return driven_turn(link, {own: turned_by(links, freed, own) for own in needed})


def _alike(paths: Sequence[LoadPath]) -> int:
    """Number of elements with which all load paths begin alike."""
    count = 0
    while all(len(path) > count for path in paths) and len({path[count] for path in paths}) == 1:
        count += 1
    return count


def _refuse_incomparable(links: Sequence[Link], path: LoadPath) -> None:
    """A shaft inside parallel load paths is held by the others too, which one load path from the root does not show."""
    used = {link.name for link in links_of(path)}
    for shaft in dict.fromkeys(link.driven for link in links):
        *_, element = (None, *load_path_from_root(links, shaft))
        if isinstance(element, Parallel):
            names = {link.name for link in links_of((element,))}
            if names & used and not names <= used:
                raise GeometryError(f"a shaft inside the parallel load paths {element.name}")


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
