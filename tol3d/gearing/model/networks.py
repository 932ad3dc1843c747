"""Load paths that divide and join in any way: all walks between two shafts, and all loops.

Each link lets its driven shaft deviate by an interval from its driver's ratio. Angles counted in turns of one shaft,
these are bounds of differences, and the play of one shaft while another is held is the shortest of all walks between
them, if no loop is shorter than 0: the dual of the linear programme. There are few links, so walks and loops are listed
once. Source: Cormen et al., Introduction to Algorithms, 3rd ed. (2009), 24.4.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from tol3d.errors import GeometryError
from tol3d.gearing.model.links import Link, LoadPath, Parallel

MOST_WALKS: Final = 2000  # each is compared in every trial; a drive has a dozen

Walk = tuple[tuple[Link, int], ...]
"""Links in series, with 1 if traversed from driver to driven and -1 if traversed backwards."""


@dataclass(frozen=True)
class Network(Parallel):
    """Load paths between two shafts that share links or go back through some.

    Args:
        walks: from `driver` to `driven`, over no shaft twice; `paths` has their links.
        loops: walks from a shaft back to itself.
    """

    walks: tuple[Walk, ...] = ()
    loops: tuple[Walk, ...] = ()

    @property
    def name(self) -> str:
        """Its links' names, each once."""
        return " ∥ ".join(dict.fromkeys(link.name for path in self.paths for link in path))


def network_path(links: Sequence[Link], first: str, last: str) -> LoadPath:
    """Load path between two shafts: links in series, and networks where there are several walks.

    Raises:
        GeometryError: carriers turn in it, or there are too many walks.
    """
    walks = tuple(_walks(links, first, last, frozenset((first,))))
    used = dict.fromkeys(link for walk in walks for link, _ in walk)
    if any(link.carrier for link in used):
        raise GeometryError("carriers turn in its parallel load paths")
    every = [_shafts(first, walk) for walk in walks]
    common = [shaft for shaft in every[0] if all(shaft in own for own in every)]
    found: list[Link | Parallel] = []
    for one, other in pairwise(common):
        pieces = tuple(dict.fromkeys(_between(first, walk, one, other) for walk in walks))
        if len(pieces) == 1:
            found += [link for link, _ in pieces[0]]
        else:
            paths = tuple(tuple(link for link, _ in piece) for piece in pieces)
            own = tuple(dict.fromkeys(link for path in paths for link in path))
            found.append(Network(one, other, paths, pieces, tuple(_loops(own))))
    return tuple(found)


def _walks(links: Sequence[Link], at: str, last: str, seen: frozenset[str]) -> Iterator[Walk]:
    """All walks to a shaft over none that was seen, in the order of the links.

    Raises:
        GeometryError: there are too many of them.
    """
    if at == last:
        yield ()
        return
    count = 0
    for link in links:
        ends = (link.driven, 1) if link.driver == at else (link.driver, -1) if link.driven == at else None
        if ends is None or ends[0] in seen:
            continue
        for rest in _walks(links, ends[0], last, seen | {ends[0]}):
            count += 1
            if count > MOST_WALKS:
                raise GeometryError(f"more than {MOST_WALKS} load paths lead to {last!r}")
            yield ((link, ends[1]), *rest)


def _loops(links: Sequence[Link]) -> Iterator[Walk]:
    """All loops, each once, begun with its first link."""
    for k, link in enumerate(links):
        for rest in _walks(links[k + 1 :], link.driven, link.driver, frozenset((link.driven,))):
            yield ((link, 1), *rest)


def _shafts(first: str, walk: Walk) -> list[str]:
    """The shafts of a walk, in its order."""
    return [first, *(link.driven if sense > 0 else link.driver for link, sense in walk)]


def _between(first: str, walk: Walk, one: str, other: str) -> Walk:
    shafts = _shafts(first, walk)
    return walk[shafts.index(one) : shafts.index(other)]
