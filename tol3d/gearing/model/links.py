"""Links: what makes shafts turn with each other, and the load paths that they make."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from tol3d.errors import GeometryError
from tol3d.gearing.model.mesh import Mesh
from tol3d.gearing.model.shafts import Carried, Reducer, Shaft


@dataclass(frozen=True)
class Link:
    """What makes one shaft turn with another: a mesh or a reducer.

    `rate` is turns of the driven shaft per turn of the driver's, signed.
    """

    name: str
    driver: str
    driven: str
    rate: Fraction


@dataclass(frozen=True)
class Parallel:
    """Load paths that part at one shaft and join at another.

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
    meshes: Sequence[Mesh], shafts: Sequence[Shaft], reducers: Sequence[Reducer]
) -> tuple[Link, ...]:
    """The reducers and meshes of a model as links of its shafts."""
    carrying = carriers(meshes, shafts)
    return (
        *(Link(r.name, r.driver, r.driven, 1 / r.ratio) for r in reducers),
        *(_link(mesh, carrying) for mesh in meshes),
    )


def carriers(meshes: Sequence[Mesh], shafts: Sequence[Shaft]) -> dict[str, tuple[str, Carried]]:
    """The shaft that carries each gear, and how; a gear that none carries is its own shaft."""
    carrying = {own.gear: (shaft.name, own) for shaft in shafts for own in shaft.carries}
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


def onwards(root: str, links: Sequence[Link]) -> Iterator[Link]:
    """The links of a root's tree, each after the one that drives it."""
    waiting = [root]
    while waiting:
        shaft = waiting.pop(0)
        for link in links:
            if link.driver == shaft:
                yield link
                waiting.append(link.driven)


def back_to_root(driving: Mapping[str, Link], shaft: str) -> tuple[Link, ...]:
    """The links from a shaft back to its root; by the first of parallel load paths."""
    links = []
    while shaft in driving:
        links.append(driving[shaft])
        shaft = links[-1].driver
    return tuple(links)


def load_path_between(links: Sequence[Link], first: str, last: str) -> LoadPath:
    """What lies between two shafts of a tree, in the order of the load path.

    Raises:
        GeometryError: one of them lies inside parallel load paths, or these are not apart.
    """
    up, down = load_path_from_root(links, first), load_path_from_root(links, last)
    common = _alike([up, down])
    _refuse_midst(links, (*up[common:], *down[common:]))
    return (*reversed(up[common:]), *down[common:])


def load_path_from_root(links: Sequence[Link], shaft: str) -> LoadPath:
    """The load path from a tree's root to a shaft."""
    driving = [link for link in links if link.driven == shaft]
    if not driving:
        return ()
    each = [load_path_from_root(links, link.driver) for link in driving]
    if len(driving) == 1:
        return (*each[0], driving[0])
    common = _alike(each)
    paths = tuple((*path[common:], link) for path, link in zip(each, driving, strict=True))
    inner = [link.name for path in paths for link in links_of(path)]
    if len(set(inner)) < len(inner):
        raise GeometryError(f"the load paths to {shaft!r} share some of their links but not at their beginning")
    return (*each[0][:common], Parallel(links_of(paths[0])[0].driver, shaft, paths))


def _alike(paths: Sequence[LoadPath]) -> int:
    """With how many elements all load paths begin alike."""
    count = 0
    while all(len(path) > count for path in paths) and len({path[count] for path in paths}) == 1:
        count += 1
    return count


def _refuse_midst(links: Sequence[Link], path: LoadPath) -> None:
    """A shaft inside parallel load paths is held by the others too, which one load path from the root does not show."""
    used = {link.name for link in links_of(path)}
    for shaft in dict.fromkeys(link.driven for link in links):
        *_, element = (None, *load_path_from_root(links, shaft))
        if isinstance(element, Parallel):
            names = {link.name for link in links_of((element,))}
            if names & used and not names <= used:
                raise GeometryError(f"a shaft inside the parallel load paths {element.name}")
