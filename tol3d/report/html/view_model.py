"""Builds in 3D as two resources: a GLB of every mesh once, and JSON of the poses in which builds have them.

The report embeds both, a server may serve them; `viewer.js` draws them. VTK is not needed.
"""

import base64
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Final, cast

import numpy as np
import trimesh

from tol3d.errors import Tol3dError
from tol3d.numerics.arrays import Array
from tol3d.report.body import Body, Surface, World
from tol3d.report.error_arrows import errors_of
from tol3d.report.motion import motion_of
from tol3d.report.presenter import Display

ALIKE: Final = 2e-3
"""Fraction of a part's size: shapes that differ by less are drawn as one, at their best fit."""
STILL: Final = 1e-9
"""mm, and of rotations; a part that moves less stands still."""
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
        enlarged: how many times as long as they are lines of errors are drawn.
        errors: names of the measures whose errors pictures have.
        motion: what its parts go through, if they move.
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
    enlarged: float = 1.0
    errors: tuple[str, ...] = ()
    motion: "ShownMotion | None" = None


@dataclass(frozen=True, eq=False)
class Stop:
    """A pose of a motion in which measures are read: numbers of its frames; lines and errors as in a State."""

    frames: tuple[int, ...]
    measured: dict[str, list[tuple[list[list[float]], bool]]]
    errors: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class ShownMotion:
    """Poses that parts go through, from where they stand in a state.

    Args:
        words: factors that are not those of the state.
        moved: indices of the parts that move.
        frames: by frame and part the first three rows of the motion (4, 4) in the world, as the base64 of little-endian
            doubles, which keeps every digit.
        captions: of the frames.
        stops: by their names.
        back: True if it goes back the way it came.
    """

    words: str
    moved: tuple[int, ...]
    frames: str
    captions: tuple[str, ...]
    stops: dict[str, Stop]
    back: bool


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
        motion: the motion of displays that is told too; None: none.
        frames: of it; None: as many as suit it.
    """

    wanted: str = ""
    surfaces: list[Surface] = field(default_factory=list)
    parts: tuple[ShownPart, ...] = ()
    builds: list[ShownBuild] = field(default_factory=list)
    world: World | None = None
    motion: str | None = None
    frames: int | None = None
    _of_parts: dict[str, list[int]] = field(default_factory=dict, init=False)

    def kept(self, motion: str | None = None) -> "ViewModel":
        """The same meshes for other builds, which share them as they are added, and may have a motion."""
        world = self.world.name if self.world else self.wanted
        found = ViewModel(world, self.surfaces, self.parts, motion=motion)
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
            wholes = [body for body in world.drawn for _ in body.pieces]
            alike = {id(body): "" for bodies in world.within.values() for body in bodies}  # many are
            placed = [self._place(piece, alike.get(id(piece), piece.name)) for _, piece in pieces]
            shown, parts = shown or world, parts or tuple(_part(name, piece) for name, piece in pieces)
            poses = tuple(_pose(piece, on) for (_, piece), (_, on) in zip(pieces, placed, strict=True))
            names = {label: _place(place) for label, place in {**world.points, **world.marks}.items()}
            features = {label: _place(own.frame[:3, 3]) for label, own in world.features.items()}
            meshes = tuple(mesh for mesh, _ in placed)
            factor = asked if world.magnify is None else world.magnify
            read = values or {}
            state = State(asked, factor, words, meshes, poses, names, features, _lines(world), read, world.enlarged)
            motion = self._motion(display, wholes, read)
            states.append(replace(state, errors=tuple(errors_of(world, read)), motion=motion))
            if factor < asked:
                break
        if not states:
            raise Tol3dError(f"{name}: there is nothing to show in 3D")
        self.world, self.parts = shown, parts
        self.builds.append(ShownBuild(name, tuple(states)))

    def _motion(self, display: Display, bodies: Sequence[Body], values: Mapping[str, str]) -> ShownMotion | None:
        """The motion that is told, of the bodies of pieces."""
        if self.motion is None:
            return None
        own = motion_of(display, self.motion, self.frames)
        moves = np.array(
            [[frame.poses[body.name] @ np.linalg.inv(body.world_from_part) for body in bodies] for frame in own.frames]
        )
        moved = np.flatnonzero(np.abs(moves - np.eye(4)).max(axis=(0, 2, 3)) > STILL)
        worlds = {world.name: world for world in display.worlds}
        names = dict.fromkeys(frame.stop for frame in own.frames if frame.stop in worlds)
        read, stops = _once([worlds[name] for name in names]), dict[str, Stop]()
        for world in read:
            at = tuple(k for k, frame in enumerate(own.frames) if frame.stop == world.name)
            stops[world.name] = Stop(at, _lines(world), tuple(errors_of(world, values)))
        numbers = base64.b64encode(np.ascontiguousarray(moves[:, moved, :3], dtype="<f8").tobytes()).decode()
        captions = tuple(frame.caption for frame in own.frames)
        return ShownMotion("; ".join(own.notes), tuple(moved.tolist()), numbers, captions, stops, own.back)

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
    """Triangles of a body as pages have it, then those of its details."""
    surface = (body.coarse or body.surface)()
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


def _once(worlds: Sequence[World]) -> Sequence[World]:
    """Worlds with each measure in the one alone in which its lines are longest: that is where it is largest."""
    lengths = [
        {
            name: sum(float(np.linalg.norm(own.points[-1] - own.points[0])) for own in lines)
            for name, lines in its.items()
        }
        for its in (world.measured for world in worlds)
    ]
    most = {name: max(own.get(name, -1.0) for own in lengths) for its in lengths for name in its}
    return [
        replace(world, measured={name: own for name, own in world.measured.items() if its[name] == most[name]})
        for world, its in zip(worlds, lengths, strict=True)
    ]


def _lines(world: World) -> dict[str, list[tuple[list[list[float]], bool]]]:
    """Lines of the measures of a world."""
    return {
        label: [([_place(point) for point in line.points], line.is_error) for line in lines]
        for label, lines in world.measured.items()
    }


def _place(numbers: Array) -> list[float]:
    return [float(f"{own:.9g}") for own in numbers]


def _pose(body: Body, on_part: Array) -> list[float]:
    """Matrix of a body's mesh that lies so on it, with the growth in it; column by column."""
    grown = np.array(body.world_from_part, dtype=np.float64)
    grown[:3, :3] *= body.scale
    pose = grown @ on_part
    return [float(f"{value:.12g}") for value in pose.T.ravel()]
