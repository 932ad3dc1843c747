"""Where the shafts of a model lie, how they turn with each other, and which of them drive: found from its links.

Shafts make trees; the first shaft of a tree is its root, which lies in the world's origin, its axis z. Where several
links drive one shaft, the first of them places it and the others close parallel ways: a gear of each is turned on its
shaft until the teeth fit, the driven one, or the driver where the driven one is in other meshes too. A mesh has a world
of its own, with its driver's axis at rest as z and the mate at +x.
"""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import GeometryError
from tol3d.model.mesh import Mesh
from tol3d.model.shafts import Carried, Reducer, Shaft

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Turning:
    """An angle that goes with the root of its tree: `offset` [rad] at 0, and turns per turn of the root."""

    offset: float = 0.0
    rate: Fraction = Fraction(1)

    def at(self, root: float) -> float:
        """The angle [rad] at an angle of the root."""
        return self.offset + float(self.rate) * root


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
    """Ways that part at one shaft and meet at another.

    Args:
        driver, driven: the shafts.
        ways: the links of each, one behind the other; there may be parallel ones among them.
    """

    driver: str
    driven: str
    ways: tuple["Way", ...]

    @property
    def name(self) -> str:
        """Its links' names."""
        return " ∥ ".join(" + ".join(element.name for element in way) for way in self.ways)


Way = tuple[Link | Parallel, ...]
"""Links one behind the other."""


@dataclass(frozen=True)
class Drive:
    """A tree of shafts.

    Args:
        root: its first shaft.
        name: of the stream that draws its positions.
        turns: of the root, until all teeth meet again in the same places; a fraction.
        meshes: its meshes' names.
    """

    root: str
    name: str
    turns: Fraction
    meshes: tuple[str, ...]


@dataclass(frozen=True)
class Closing:
    """How the driven gear of a mesh that closes parallel ways lies in it, for another link places its shaft.

    Args:
        azimuth: of its frame at rest in the mesh, in the frame of its axis at rest on its shaft [rad].
        ahead: by which its tooth 0 stands ahead of the one that the mesh counts as such [rad], whole pitches.
        gap: by which the teeth miss each other where neither gear can be turned on its shaft, an arc [mm].
    """

    azimuth: float = 0.0
    ahead: float = 0.0
    gap: float = 0.0


PLACES = Closing()  # a mesh that places the shaft that it drives


@dataclass(frozen=True, eq=False)
class Layout:
    """All of it; mappings by name.

    Args:
        links: in the order of the moves.
        driving: the link that drives each shaft, the first of several; none for roots.
        closing: the others of several.
        root_of: the root of each shaft's tree.
        shaft_turn: how each shaft turns with its root.
        mesh_turn: how the driver of each mesh turns with its root, in the frame of the mesh.
        world_from_shaft: (4, 4), shafts at 0.
        world_from_mesh: (4, 4).
        shaft_from_gear: (4, 4), a gear's axis at rest on its shaft.
        carrying: the shaft that carries each gear, and where.
        closed: meshes that close parallel ways.
        drives: the trees.
    """

    links: tuple[Link, ...]
    driving: Mapping[str, Link]
    closing: tuple[Link, ...]
    root_of: Mapping[str, str]
    shaft_turn: Mapping[str, Turning]
    mesh_turn: Mapping[str, Turning]
    world_from_shaft: Mapping[str, Array]
    world_from_mesh: Mapping[str, Array]
    shaft_from_gear: Mapping[str, Array]
    carrying: Mapping[str, tuple[str, Carried]]
    closed: Mapping[str, Closing]
    drives: tuple[Drive, ...]

    def seating(self, mesh: str) -> Closing:
        """How the driven gear of a mesh lies in it."""
        return self.closed.get(mesh, PLACES)

    def drive_of(self, mesh: str) -> Drive:
        """The tree that a mesh belongs to."""
        return next(drive for drive in self.drives if mesh in drive.meshes)

    def behind(self, shaft: str) -> tuple[Link, ...]:
        """The links from a shaft back to its root."""
        links = []
        while shaft in self.driving:
            links.append(self.driving[shaft])
            shaft = links[-1].driver
        return tuple(links)

    def between(self, first: str, last: str) -> tuple[Link, ...]:
        """The links between two shafts of a tree, in the order of the way; the first of parallel ways."""
        up, down = self.behind(first), self.behind(last)
        common = set(up) & set(down)
        return (*(link for link in up if link not in common), *reversed([link for link in down if link not in common]))

    def way(self, first: str, last: str) -> Way:
        """What lies between two shafts of a tree, in the order of the way.

        Raises:
            GeometryError: one of them lies in the midst of parallel ways, or these are not apart.
        """
        up, down = self._from_root(first), self._from_root(last)
        common = 0
        while common < min(len(up), len(down)) and up[common] == down[common]:
            common += 1
        self._refuse_midst(up[common:], down[common:])
        return (*reversed(up[common:]), *down[common:])

    def _from_root(self, shaft: str) -> Way:
        """The way from a tree's root to a shaft."""
        driving = [link for link in self.links if link.driven == shaft]
        if not driving:
            return ()
        if len(driving) == 1:
            return (*self._from_root(driving[0].driver), driving[0])
        each = [self._from_root(link.driver) for link in driving]
        common = 0
        while all(len(way) > common for way in each) and len({way[common] for way in each}) == 1:
            common += 1
        ways = tuple((*way[common:], link) for way, link in zip(each, driving, strict=True))
        inner = [link.name for way in ways for link in links_of(way)]
        if len(set(inner)) < len(inner):
            raise GeometryError(f"the ways to {shaft!r} share some of their links but not at their beginning")
        first = links_of(ways[0])[0].driver
        return (*each[0][:common], Parallel(first, shaft, ways))

    def _refuse_midst(self, *parts: Way) -> None:
        """A shaft in the midst of parallel ways is held by the others too, which a way from the root does not show."""
        used = {link.name for way in parts for link in links_of(way)}
        for link in self.closing:
            loop = self._from_root(link.driven)[-1]
            names = {inner.name for inner in links_of((loop,))}
            if names & used and not names <= used:
                raise GeometryError(f"a shaft in the midst of the parallel ways {loop.name}")

    def ratio(self, first: str, last: str) -> Fraction:
        """Turns of the first shaft per turn of the last, signed."""
        return self.shaft_turn[first].rate / self.shaft_turn[last].rate


def layout_of(meshes: Sequence[Mesh], shafts: Sequence[Shaft], reducers: Sequence[Reducer]) -> Layout:
    """The layout of a model whose shafts make trees, which model/trains.py sees to."""
    carrying = _carrying(meshes, shafts)
    links = all_links(meshes, shafts, reducers)
    driving: dict[str, Link] = {}
    for link in links:
        driving.setdefault(link.driven, link)
    closing = tuple(link for link in links if driving[link.driven] is not link)
    frames = {gear: _shaft_from_gear(own) for gear, (_, own) in carrying.items()}
    turn: dict[str, Turning] = {}
    world: dict[str, Array] = {}
    root_of: dict[str, str] = {}
    mesh_turn: dict[str, Turning] = {}
    world_from_mesh: dict[str, Array] = {}
    by_name: dict[str, Mesh | Reducer] = {mesh.name: mesh for mesh in meshes} | {r.name: r for r in reducers}
    names = dict.fromkeys([*(link.driver for link in links), *(s.name for s in shafts)])
    for root in (name for name in names if name not in driving):
        turn[root], world[root], root_of[root] = Turning(), np.eye(4), root
        for link in _onwards(root, list(driving.values())):
            root_of[link.driven] = root
            cause = by_name[link.name]
            if isinstance(cause, Mesh):
                (_, driver), (_, driven) = carrying[cause.driver], carrying[cause.driven]
                mesh_turn[cause.name] = _of_driver(cause, driver, turn[link.driver])
                turn[link.driven] = _of_driven(cause, driven, mesh_turn[cause.name])
                pose = world[link.driver] @ frames[cause.driver] @ _about_z(cause.azimuth)
                world_from_mesh[cause.name] = pose
                world[link.driven] = pose @ _wheel_in_mesh(cause) @ np.linalg.inv(frames[cause.driven])
            else:
                before = turn[link.driver]
                turn[link.driven] = Turning(before.offset * float(link.rate), before.rate * link.rate)
                world[link.driven] = world[link.driver] @ _along_z(cause.offset)
    closed: dict[str, Closing] = {}
    busy = Counter(gear for mesh in meshes for gear in (mesh.driver, mesh.driven))
    for link in closing:
        cause = by_name[link.name]
        if isinstance(cause, Mesh):
            pose = world[link.driver] @ frames[cause.driver] @ _about_z(cause.azimuth)
            world_from_mesh[cause.name] = pose
            azimuth = _turn_between(world[link.driven] @ frames[cause.driven], pose @ _wheel_in_mesh(cause))
            (first, driver), (last, driven) = carrying[cause.driver], carrying[cause.driven]
            clocked = _clocked(cause, (driver, turn[first]), (driven, turn[last]), azimuth, busy)
            carrying[cause.driver], carrying[cause.driven] = (first, clocked[0]), (last, clocked[1])
            mesh_turn[cause.name] = _of_driver(cause, clocked[0], turn[first])
            closed[cause.name] = clocked[2]
    return Layout(
        links=links,
        driving=driving,
        closing=closing,
        root_of=root_of,
        shaft_turn=turn,
        mesh_turn=mesh_turn,
        world_from_shaft=world,
        world_from_mesh=world_from_mesh,
        shaft_from_gear=frames,
        carrying=carrying,
        closed=closed,
        drives=tuple(_drives(meshes, links, root_of, mesh_turn)),
    )


def all_links(meshes: Sequence[Mesh], shafts: Sequence[Shaft], reducers: Sequence[Reducer]) -> tuple[Link, ...]:
    """The reducers and meshes of a model as links of its shafts."""
    carrying = _carrying(meshes, shafts)
    return (
        *(Link(r.name, r.driver, r.driven, 1 / r.ratio) for r in reducers),
        *(_link(mesh, carrying) for mesh in meshes),
    )


def _carrying(meshes: Sequence[Mesh], shafts: Sequence[Shaft]) -> dict[str, tuple[str, Carried]]:
    carrying = {own.gear: (shaft.name, own) for shaft in shafts for own in shaft.carries}
    for gear in (gear for mesh in meshes for gear in (mesh.driver, mesh.driven)):
        carrying.setdefault(gear, (gear, Carried(gear)))
    return carrying


def links_of(way: Way) -> tuple[Link, ...]:
    """Every link of a way, those of parallel ones too."""
    found: list[Link] = []
    for element in way:
        found += (
            [element] if isinstance(element, Link) else [link for inner in element.ways for link in links_of(inner)]
        )
    return tuple(found)


def misfit(layout: Layout, mesh: Mesh) -> tuple[float, float]:
    """By how much a mesh would put the shaft that it drives elsewhere than it lies: [mm], and the axes' angle [rad]."""
    shaft, _ = layout.carrying[mesh.driven]
    frame = layout.shaft_from_gear[mesh.driven]
    there = layout.world_from_mesh[mesh.name] @ _wheel_in_mesh(mesh) @ np.linalg.inv(frame)
    here = layout.world_from_shaft[shaft]
    axes = float(np.linalg.norm(np.cross(there[:3, 2], here[:3, 2])))
    return float(np.linalg.norm(there[:3, 3] - here[:3, 3])), axes if there[:3, 2] @ here[:3, 2] > 0.0 else np.pi


def loop_of(links: Sequence[Link]) -> tuple[str, ...]:
    """Shafts that drive each other in a ring, the first of them again at the end; empty where there are none."""
    driver = {link.driven: link.driver for link in links}
    for start in driver:
        way = [start]
        while way[-1] in driver and len(way) <= len(driver):
            way.append(driver[way[-1]])
            if way[-1] == start:
                return tuple(reversed(way))
    return ()


def _onwards(root: str, links: Sequence[Link]) -> Iterator[Link]:
    """The links of a root's tree, each behind the one that drives it."""
    waiting = [root]
    while waiting:
        shaft = waiting.pop(0)
        for link in links:
            if link.driver == shaft:
                yield link
                waiting.append(link.driven)


def _link(mesh: Mesh, carrying: Mapping[str, tuple[str, Carried]]) -> Link:
    (driver, first), (driven, second) = carrying[mesh.driver], carrying[mesh.driven]
    return Link(mesh.name, driver, driven, mesh.rate * first.sense * second.sense)


def _of_driver(mesh: Mesh, own: Carried, shaft: Turning) -> Turning:
    """A mesh counts its driver's turn from the line of centres."""
    return Turning(own.sense * shaft.offset + own.phase - mesh.azimuth, own.sense * shaft.rate)


def _of_driven(mesh: Mesh, own: Carried, driver: Turning) -> Turning:
    angle = float(mesh.pair.driven_angle(np.array([driver.offset]))[0])
    return Turning(own.sense * (angle - own.phase), own.sense * mesh.rate * driver.rate)


def _clocked(
    mesh: Mesh,
    driver: tuple[Carried, Turning],
    driven: tuple[Carried, Turning],
    azimuth: float,
    busy: Mapping[str, int],
) -> tuple[Carried, Carried, Closing]:
    """Driver and driven gear of a mesh that closes parallel ways, turned on their shafts until the teeth fit.

    Args:
        mesh: that mesh.
        driver, driven: how they sit as written, and how their shafts turn.
        azimuth: see Closing.
        busy: in how many meshes each gear is; one that is in several fits the others already.
    """
    (first, turning), (last, turned) = driver, driven
    told = _of_driver(mesh, first, turning).offset
    stands = last.sense * turned.offset + last.phase - azimuth
    ahead = stands - float(mesh.pair.driven_angle(np.array([told]))[0])
    if busy[mesh.driven] == 1:
        return first, replace(last, phase=last.phase - ahead), Closing(azimuth)
    pitch = mesh.pair.wheel.angular_pitch
    whole = round(ahead / pitch) * pitch
    rest = ahead - whole
    if busy[mesh.driver] == 1:
        return replace(first, phase=first.phase + rest / float(mesh.rate)), last, Closing(azimuth, whole)
    return first, last, Closing(azimuth, whole, abs(rest) * mesh.pair.working_radii[1])


def _turn_between(first: Array, second: Array) -> float:
    """Azimuth of the second frame's x axis in the first one [rad], their z axes the same."""
    turn = first[:3, :3].T @ second[:3, :3]
    return math.atan2(turn[1, 0], turn[0, 0])


def _drives(
    meshes: Sequence[Mesh], links: Sequence[Link], root_of: Mapping[str, str], mesh_turn: Mapping[str, Turning]
) -> Iterator[Drive]:
    for root in dict.fromkeys(root_of.values()):
        own_links = [link for link in links if root_of[link.driver] == root]
        own = [mesh for mesh in meshes if any(link.name == mesh.name for link in own_links)]
        if own:
            periods = [mesh.pair.long_period_turns / abs(mesh_turn[mesh.name].rate) for mesh in own]
            name = own_links[0].name if len(own_links) == 1 else root
            yield Drive(root, name, _least_common(periods), tuple(mesh.name for mesh in own))


def _least_common(periods: Sequence[Fraction]) -> Fraction:
    """The least common multiple of fractions."""
    numerators = math.lcm(*(period.numerator for period in periods))
    return Fraction(numerators, math.gcd(*(period.denominator for period in periods)))


def _shaft_from_gear(own: Carried) -> Array:
    pose = _along_z(own.at)
    if own.backward:
        pose[:3, :3] = np.diag([1.0, -1.0, -1.0])
    return pose


def _wheel_in_mesh(mesh: Mesh) -> Array:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = mesh.pair.world_from_wheel, mesh.pair.wheel_origin
    return pose


def _along_z(offset: float) -> Array:
    pose = np.eye(4)
    pose[2, 3] = offset
    return pose


def _about_z(angle: float) -> Array:
    pose = np.eye(4)
    cos, sin = math.cos(angle), math.sin(angle)
    pose[:2, :2] = [[cos, -sin], [sin, cos]]
    return pose
