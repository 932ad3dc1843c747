"""Layout of a model's shafts: positions, turning ratios and drivers, derived from its links.

Shafts make trees; the first shaft of a tree is its root, which lies in the world's origin, its axis z. Where several
links drive one shaft, the first of them places it and the others close parallel load paths: a gear of each is turned
on its shaft until the teeth fit, the driven one, or the driver where the driven one is in other meshes too. A mesh has
a world of its own, with its driver's axis at rest as z and the mate at +x.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from tol3d.errors import GeometryError
from tol3d.gearing.links import StatedLink
from tol3d.gearing.model.links import (
    Drive,
    Link,
    LoadPath,
    back_to_root,
    carriers,
    drives_of,
    first_drivers,
    freed_turn,
    links_between_shafts,
    load_path_between,
    onwards,
    periods_of,
    turned_by,
    upstream,
)
from tol3d.gearing.model.networks import network_path
from tol3d.gearing.shafts import Carried, Mesh, Shaft
from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class Turning:
    """An angle that turns with the root of its tree: `offset` [rad] at 0, and turns per turn of the root."""

    offset: float = 0.0
    rate: Fraction = Fraction(1)

    def at(self, root: float) -> float:
        """The angle [rad] at an angle of the root."""
        return self.offset + float(self.rate) * root


RESTS = Turning(0.0, Fraction(0))


@dataclass(frozen=True)
class Closing:
    """Position of the driven gear in a mesh that closes parallel load paths, as another link places its shaft.

    Args:
        azimuth: of its frame at rest in the mesh, in the frame of its axis at rest on its shaft [rad].
        ahead: by which its tooth 0 stands ahead of the one that the mesh counts as such [rad], whole pitches.
        gap: between the teeth if neither gear can be turned on its shaft, an arc [mm].
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
        mesh_turn: how the driver of each mesh turns with its root, in the frame of the mesh; of other links whose play
            depends on the position, against the carrier.
        world_from_shaft: (4, 4), shafts at 0.
        world_from_mesh: (4, 4).
        shaft_from_gear: (4, 4), a gear's axis at rest on its shaft.
        carrying: the shaft that carries each gear, and where.
        closed: meshes that close parallel load paths.
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
        """Position of the driven gear in the mesh."""
        return self.closed.get(mesh, PLACES)

    def behind(self, shaft: str) -> tuple[Link, ...]:
        """The links from a shaft back to its root; the first of parallel load paths."""
        return back_to_root(self.driving, shaft)

    def upstream(self, shaft: str) -> tuple[Link, ...]:
        """The links that a shaft's turn depends on; by the first of parallel load paths."""
        return upstream(self.driving, shaft)

    def load_path(self, first: str, last: str) -> LoadPath:
        """Load path between two shafts of a tree, in order.

        Load paths that divide and join in series and in parallel are compared where they join; others are networks.

        Raises:
            GeometryError: carriers turn in a network, or it has too many walks.
        """
        try:
            for end in (first, last):  # a shaft in the middle of load paths is held by all of them
                load_path_between(self.links, self.root_of[end], end)
            return load_path_between(self.links, first, last)
        except GeometryError:
            return network_path(self.links, first, last)

    def ratio(self, first: str, last: str) -> Fraction:
        """Turns of the first shaft per turn of the last, signed."""
        return self.shaft_turn[first].rate / self.shaft_turn[last].rate

    def turn_by(self, freed: str, read: str) -> Fraction:
        """Turn of a shaft that is read per turn of another one, the first shaft at rest; 0 where it does not matter."""
        return turned_by(self.links, freed, read)

    def freed_turn(self, freed: str, read: str, held: str) -> Fraction:
        """Turn of a shaft that is read per turn that the play of another one's driver frees, a third one held."""
        if any(link.carrier for link in self.links):
            return freed_turn(self.links, freed, read, held)
        return self.ratio(read, freed)


def layout_of(meshes: Sequence[Mesh], shafts: Sequence[Shaft], stated: Sequence[StatedLink]) -> Layout:
    """The layout of a model whose shafts make trees, which model/trains.py sees to."""
    links = links_between_shafts(meshes, shafts, stated)
    driving = first_drivers(links)
    placing = _Placing(carriers(meshes, shafts))
    causes: dict[str, Mesh | StatedLink] = {mesh.name: mesh for mesh in meshes} | {own.name: own for own in stated}
    names = dict.fromkeys([*(link.driver for link in links), *(shaft.name for shaft in shafts)])
    for root in (name for name in names if name not in driving):
        placing.begin(root)
        for link in onwards(root, list(driving.values())):
            placing.go_on(link, causes[link.name])
    closing = tuple(link for link in links if driving[link.driven] is not link)
    busy = Counter(gear for mesh in meshes for gear in (mesh.driver, mesh.driven))
    for link in closing:
        placing.close(link, causes[link.name], busy)
    rates = {name: turning.rate for name, turning in placing.mesh_turn.items()}
    periods = periods_of(meshes, stated, rates)
    return Layout(
        links=links,
        driving=driving,
        closing=closing,
        root_of=placing.root_of,
        shaft_turn=placing.turn,
        mesh_turn=placing.mesh_turn,
        world_from_shaft=placing.world,
        world_from_mesh=placing.world_from_mesh,
        shaft_from_gear=placing.frames,
        carrying=placing.carrying,
        closed=placing.closed,
        drives=tuple(drives_of(links, placing.root_of, periods)),
    )


class _Placing:
    """Collects positions and turning ratios of shafts and meshes, link by link from the roots."""

    def __init__(self, carrying: dict[str, tuple[str, Carried]]) -> None:
        self.carrying = carrying
        self.frames = {gear: _shaft_from_gear(own) for gear, (_, own) in carrying.items()}
        self.root_of: dict[str, str] = {}
        self.turn: dict[str, Turning] = {}
        self.world: dict[str, Array] = {}
        self.mesh_turn: dict[str, Turning] = {}
        self.world_from_mesh: dict[str, Array] = {}
        self.closed: dict[str, Closing] = {}

    def begin(self, root: str) -> None:
        """A root lies in the origin."""
        self.root_of[root], self.turn[root], self.world[root] = root, Turning(), np.eye(4)

    def go_on(self, link: Link, cause: Mesh | StatedLink) -> None:
        """A link places the shaft that it drives."""
        self.root_of[link.driven] = self.root_of[link.driver]
        if isinstance(cause, StatedLink):
            before, about = self._against_carrier(link, cause)
            turned = Turning(before.offset * float(link.rate), before.rate * link.rate)
            self.turn[link.driven] = Turning(about.offset + turned.offset, about.rate + turned.rate)
            self.world[link.driven] = self.world[link.driver] @ cause.driver_from_driven
            return
        (_, driver), (_, driven) = self.carrying[cause.driver], self.carrying[cause.driven]
        self.mesh_turn[cause.name] = _of_driver(cause, driver, self.turn[link.driver])
        self.turn[link.driven] = _of_driven(cause, driven, self.mesh_turn[cause.name])
        pose = self._place_mesh(link, cause)
        self.world[link.driven] = pose @ _wheel_in_mesh(cause) @ np.linalg.inv(self.frames[cause.driven])

    def _against_carrier(self, link: Link, cause: StatedLink) -> tuple[Turning, Turning]:
        """Turning of a link's driver against its carrier, and that of the carrier."""
        about = RESTS if link.carrier is None else self.turn[link.carrier]
        driver = self.turn[link.driver]
        before = Turning(driver.offset - about.offset, driver.rate - about.rate)
        if cause.turns is not None:
            self.mesh_turn[cause.name] = before
        return before, about

    def close(self, link: Link, cause: Mesh | StatedLink, busy: Mapping[str, int]) -> None:
        """A link finds the shaft that it drives in its place, and has the teeth fit there; see _clocked."""
        if isinstance(cause, StatedLink):
            self._against_carrier(link, cause)
            return
        pose = self._place_mesh(link, cause)
        azimuth = _turn_between(self.world[link.driven] @ self.frames[cause.driven], pose @ _wheel_in_mesh(cause))
        (first, driver), (last, driven) = self.carrying[cause.driver], self.carrying[cause.driven]
        clocked = _clocked(cause, (driver, self.turn[first]), (driven, self.turn[last]), azimuth, busy)
        self.carrying[cause.driver], self.carrying[cause.driven] = (first, clocked[0]), (last, clocked[1])
        self.mesh_turn[cause.name] = _of_driver(cause, clocked[0], self.turn[first])
        self.closed[cause.name] = clocked[2]

    def _place_mesh(self, link: Link, mesh: Mesh) -> Array:
        pose = self.world[link.driver] @ self.frames[mesh.driver] @ _about_z(mesh.azimuth)
        self.world_from_mesh[mesh.name] = pose
        return np.asarray(pose)


def misfit(layout: Layout, mesh: Mesh) -> tuple[Array, float]:
    """Offset (3,) of a driven shaft from its place by a mesh, in its frame [mm], and the axes' angle [rad]."""
    shaft, _ = layout.carrying[mesh.driven]
    frame = layout.shaft_from_gear[mesh.driven]
    there = layout.world_from_mesh[mesh.name] @ _wheel_in_mesh(mesh) @ np.linalg.inv(frame)
    here = layout.world_from_shaft[shaft]
    axes = float(np.linalg.norm(np.cross(there[:3, 2], here[:3, 2])))
    off = layout.world_from_mesh[mesh.name][:3, :3].T @ (there[:3, 3] - here[:3, 3])
    return off, axes if there[:3, 2] @ here[:3, 2] > 0.0 else np.pi


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
    """Driver and driven gear of a mesh that closes parallel load paths, turned on their shafts until the teeth fit.

    Args:
        mesh: that mesh.
        driver, driven: how they sit as written, and how their shafts turn.
        azimuth: see Closing.
        busy: number of meshes of each gear; one that is in several fits the others already.
    """
    (first, turning), (last, turned) = driver, driven
    stated = _of_driver(mesh, first, turning).offset
    stands = last.sense * turned.offset + last.phase - azimuth
    ahead = stands - float(mesh.pair.driven_angle(np.array([stated]))[0])
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
