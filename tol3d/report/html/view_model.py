"""Builds in 3D as two resources: a GLB of every mesh once, and JSON of the poses in which builds have them.

The report embeds both, a server may serve them; `viewer.js` draws them. VTK is not needed.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Final, cast

import numpy as np
import trimesh

from tol3d.errors import Tol3dError
from tol3d.numerics.arrays import Array
from tol3d.report.body import Body, Surface, World
from tol3d.report.presenter import Display

ALIKE: Final = 2e-3
"""Fraction of a part's size: shapes that differ by less are drawn as one, at their best fit."""
GRID: Final = 2.0**-13
"""mm; places of corners are rounded to it, an eighth of a micrometre, so that they pack."""


@dataclass(frozen=True, eq=False)
class State:
    """A build as it is shown at one magnification.

    Args:
        asked: factor of its deviations that was asked for.
        factor: the one with which it is shown; lower where the build does not allow that.
        words: its measures, and notes.
        meshes, poses: of each part, which of the model's meshes, and where (16 numbers, column by column) [mm].
        names: of contacts, gaps and other places (3 numbers) [mm].
        features: places of features (3 numbers) [mm].
        measured: of each measure the lines along which it is read: points (3 numbers each) [mm], and whether they
            lead from where the last one lies nominally.
        values: of measures, in words.
    """

    asked: float
    factor: float
    words: str
    meshes: tuple[int, ...]
    poses: tuple[list[float], ...]
    names: dict[str, list[float]]
    features: dict[str, list[float]] = field(default_factory=dict)
    measured: dict[str, list[tuple[list[list[float]], bool]]] = field(default_factory=dict)
    values: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class ShownBuild:
    """A build by its name, at one magnification or several."""

    name: str
    states: tuple[State, ...]


@dataclass(frozen=True, eq=False)
class ShownPart:
    """A body of the view.

    Args:
        name: its own; the faces of a part that have another colour are a body of their own.
        part: whose body it is.
        colour: "#RRGGBB".
        opacity: from 0 to 1.
        features: of the part, each with its first triangle in the body's meshes and their number.
    """

    name: str
    part: str
    colour: str
    opacity: float
    features: tuple[tuple[str, int, int], ...] = ()


@dataclass(eq=False)
class ViewModel:
    """Builds that are shown together, gathered one by one.

    Args:
        wanted: name of the world that is shown; "" for that with the most bodies.
        surfaces: triangles of every mesh once, vertices (n, 3) [mm] and triangles (m, 3).
        parts: bodies of every build.
        builds: in the order in which they were added.
        world: the one that is shown; None before any build.
    """

    wanted: str = ""
    surfaces: list[Surface] = field(default_factory=list)
    parts: tuple[ShownPart, ...] = ()
    builds: list[ShownBuild] = field(default_factory=list)
    world: World | None = None
    _of_parts: dict[str, list[int]] = field(default_factory=dict, init=False)

    def kept(self) -> "ViewModel":
        """The same meshes for other builds, which share them as they are added."""
        found = ViewModel(self.world.name if self.world else self.wanted, self.surfaces, self.parts)
        found._of_parts = self._of_parts
        return found

    def add(
        self, name: str, displays: Iterable[tuple[float, Display, str]], values: Mapping[str, str] | None = None
    ) -> None:
        """Add a build.

        Args:
            name: of the build.
            displays: of the build at each factor of its deviations that was asked for, the least first, with its words;
                none is taken after one that the build does not allow. Of the first the world that
                is wanted is shown, of the others that of its name.
            values: of measures, in words.

        Raises:
            Tol3dError: it has no bodies in that world; or `displays` raises it.
        """
        states, shown, parts = list[State](), self.world, self.parts
        for asked, display, words in displays:
            world = _world_of(display, shown.name if shown else self.wanted)
            if world is None:
                continue
            pieces = [(body.name, piece) for body in world.bodies for piece in body.pieces]
            pieces += [(name, body) for name, bodies in world.within.items() for body in bodies]
            alike = {id(body): "" for bodies in world.within.values() for body in bodies}  # many are
            placed = [self._place(piece, alike.get(id(piece), piece.name)) for _, piece in pieces]
            shown, parts = shown or world, parts or tuple(_part(name, piece) for name, piece in pieces)
            poses = tuple(_pose(piece, on) for (_, piece), (_, on) in zip(pieces, placed, strict=True))
            names = {label: _place(place) for label, place in {**world.points, **world.marks}.items()}
            features = {label: _place(own.frame[:3, 3]) for label, own in world.features.items()}
            measured = {
                label: [([_place(point) for point in line.points], line.is_error) for line in lines]
                for label, lines in world.measured.items()
            }
            meshes = tuple(mesh for mesh, _ in placed)
            factor = asked if world.magnify is None else world.magnify
            states.append(State(asked, factor, words, meshes, poses, names, features, measured, values or {}))
            if factor < asked:
                break
        if not states:
            raise Tol3dError(f"{name}: there is nothing to show in 3D")
        self.world, self.parts = shown, parts
        self.builds.append(ShownBuild(name, tuple(states)))

    def _place(self, body: Body, like: str) -> tuple[int, Array]:
        """Index of a body's mesh, or of one that another body of the same key has, and its pose on the part (4, 4)."""
        vertices, triangles = _surface(body)
        for mesh in self._of_parts.setdefault(like, []):
            known, alike = self.surfaces[mesh]
            if known.shape == vertices.shape and np.array_equal(alike, triangles):
                pose = laid_on(known, vertices)
                left = vertices - (known @ pose[:3, :3].T + pose[:3, 3])
                if float(np.abs(left).max()) <= ALIKE * float(np.ptp(vertices, axis=0).max()):
                    return mesh, pose
        self._of_parts[like].append(len(self.surfaces))
        self.surfaces.append((np.round(np.asarray(vertices, dtype=np.float64) / GRID) * GRID, triangles))
        return len(self.surfaces) - 1, np.eye(4)

    def glb(self, first: int = 0) -> bytes:
        """The meshes `mesh-0`, `mesh-1`, ... from a number on as a GLB [mm], written the same way every time."""
        scene = trimesh.Scene()
        for number, (vertices, triangles) in enumerate(self.surfaces[first:], first):
            mesh = trimesh.Trimesh(vertices, triangles, process=False)
            scene.add_geometry(mesh, node_name=f"mesh-{number}", geom_name=f"mesh-{number}")
        return cast(bytes, scene.export(file_type="glb"))

    def told(self) -> dict[str, Any]:
        """The bodies and the builds, for JSON.

        They are `world`, `up`, `parts` (ShownPart) and `builds` (ShownBuild); and of `features` the part, the frame
        (16 numbers, column by column) and the reach (3 numbers) [mm], as they lie in the first build.
        """
        assert self.world is not None, "there is a build"
        return {
            "world": self.world.name,
            "up": list(self.world.up),
            "features": {
                name: {"part": own.part, "frame": _place(own.frame.T.ravel()), "reach": _place(own.reach)}
                for name, own in self.world.features.items()
            },
            "parts": [asdict(part) for part in self.parts],
            "builds": [asdict(build) for build in self.builds],
        }

    def undeviated(self) -> tuple["ViewModel", tuple[str, ...]]:
        """The same with every body nominal, and names of the bodies that differ from their build."""
        nominal = self.builds[0].states[0].meshes
        deviate = {
            k
            for build in self.builds
            for state in build.states
            for k, mesh in enumerate(state.meshes)
            if mesh != nominal[k]
        }
        places = tuple(range(len(nominal)))
        kept = [
            replace(build, states=tuple(replace(state, meshes=places) for state in build.states))
            for build in self.builds
        ]
        fewer = replace(self, surfaces=[self.surfaces[mesh] for mesh in nominal], builds=kept)
        return fewer, tuple(self.parts[k].name for k in sorted(deviate))

    def remeshed(self, surfaces: Sequence[Surface]) -> "ViewModel":
        """The same with other triangles, which are no longer those of features."""
        parts = tuple(replace(part, features=()) for part in self.parts)
        return replace(self, surfaces=[*surfaces], parts=parts)


def laid_on(points: Array, others: Array) -> Array:
    """The pose (4, 4) that lays points (n, 3) best on others, by least squares (Kabsch 1976)."""
    middle, there = points.mean(axis=0), others.mean(axis=0)
    left, _, right = np.linalg.svd((points - middle).T @ (others - there))
    turn = (left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right).T
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn, there - turn @ middle
    return pose


def _world_of(display: Display, name: str) -> World | None:
    """The world of that name, or without one that with the most bodies."""
    worlds = [world for world in display.worlds if world.bodies and name in ("", world.name)]
    return max(worlds, key=lambda own: len(own.bodies), default=None)


def _surface(body: Body) -> Surface:
    """Triangles of a body, then those of its details."""
    surface = body.surface()
    if body.details is None:
        return surface
    (vertices, triangles), (more, further) = surface, body.details()
    return np.vstack([vertices, more]), np.vstack([triangles, further + len(vertices)])


def _part(part: str, piece: Body) -> ShownPart:
    """A piece of a part; its features have its last triangles."""
    found, end = list[tuple[str, int, int]](), 0
    if piece.features is not None:
        counts = piece.features()
        end = len(_surface(piece)[1]) - sum(counts.values())
        for name, count in counts.items():
            found.append((name, end, count))
            end += count
    return ShownPart(piece.name, part, piece.colour, piece.opacity, tuple(found))


def _place(numbers: Array) -> list[float]:
    return [float(f"{own:.9g}") for own in numbers]


def _pose(body: Body, on_part: Array) -> list[float]:
    """Matrix of a body's mesh that lies so on it, with the growth in it; column by column."""
    grown = np.array(body.world_from_part, dtype=np.float64)
    grown[:3, :3] *= body.scale
    pose = grown @ on_part
    return [float(f"{value:.12g}") for value in pose.T.ravel()]
