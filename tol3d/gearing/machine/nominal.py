"""Nominal positions of shafts in their bores, and the centre distances and azimuths that follow."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from tol3d.assembly.model import Assembly
from tol3d.gearing.grammar.moves import GearMeshSpec, MeshSpec
from tol3d.gearing.machine.grammar.bores import ShaftInBoresSpec
from tol3d.gearing.model.brought import Brought, brought_into
from tol3d.gearing.model.from_scene import meshes_of_scene
from tol3d.gearing.model.layout import Layout
from tol3d.gearing.shafts import Mesh
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath
from tol3d.units import Quantity

SAME_PLACE: Final = 1e-6
"""mm; values that a scene states twice agree to within this."""
SAME_DIRECTION: Final = 1e-9
"""Sine of the angle between axes that are parallel."""
AZIMUTH_AS_WRITTEN: Final = 1e-6
"""rad; the same for a redundant azimuth."""
SHORTEST: Final = 1e-3
"""mm; bores that are nearer to each other hold no shaft."""


@dataclass(frozen=True, eq=False)
class Bore:
    """One of the two points through which the axis of a shaft goes.

    Args:
        feature: the bore, with its part.
        end: which end of it, 0 or 1; None for its middle.
        place: nominally, in the world of the parts (3,) [mm].
    """

    feature: str
    end: int | None
    place: Array

    @property
    def words(self) -> str:
        """Name of the point."""
        return self.feature if self.end is None else f"{self.feature} {('start', 'end')[self.end]}"


@dataclass(frozen=True, eq=False)
class HousedShaft:
    """A shaft in its bores.

    Args:
        move: that lays it.
        shaft: its name.
        bores: two points of its axis.
        frame: the frame of the shaft at rest, in the world of the parts (4, 4).
        host: the part that carries the first bore of its train: shafts lie off their places as it sees them.
        lies: its relation to the parts of its bores, in words.
    """

    move: str
    shaft: str
    bores: tuple[Bore, Bore]
    frame: Array
    host: str
    lies: str = "shaft in bores of"

    def along(self, bore: Bore) -> float:
        """Position of a point of the bore along the shaft's z [mm]."""
        return float((bore.place - self.frame[:3, 3]) @ self.frame[:3, 2])


def lines_of(scene: Scene, assembly: Assembly) -> Mapping[str, tuple[str, tuple[Bore, Bore]]]:
    """Move that lays each shaft and the points of its axis, by shaft.

    Raises:
        SceneError: bores that hold no straight shaft.
    """
    return {move.shaft: (name, _line(scene, name, move, assembly)) for name, move in scene.of(ShaftInBoresSpec).items()}


def _line(scene: Scene, name: str, move: ShaftInBoresSpec, assembly: Assembly) -> tuple[Bore, Bore]:
    frames = [assembly.part[assembly.features[own].part].pose @ assembly.features[own].frame for own in move.in_]
    if len(frames) == 1:
        shape = assembly.features[move.in_[0]].shape
        places = shape.ends @ frames[0][:3, :3].T + frames[0][:3, 3]
        return Bore(move.in_[0], 0, places[0]), Bore(move.in_[0], 1, places[1])
    first, last = (Bore(own, None, frame[:3, 3]) for own, frame in zip(move.in_, frames, strict=True))
    here = ("moves", name, "in")
    apart = last.place - first.place
    if np.linalg.norm(apart) < SHORTEST:
        raise scene.refuse(here, "expected bores that lie apart, got two in one place; one bore alone may hold a shaft")
    for bore, frame in zip((first, last), frames, strict=True):
        off = float(np.linalg.norm(np.cross(apart, frame[:3, 2])))
        if off > SAME_PLACE:
            words = f"expected bores on one line, got {bore.feature!r}, whose axis passes the middle of the other bore"
            raise scene.refuse(here, f"{words} at {off:.4g} mm")
    return first, last


@dataclass(frozen=True, eq=False)
class _Axes:
    """Axes of a train's shafts, and those of parts that turn with no shaft: a held ring, a carrier of planets.

    Args:
        layout: of the shafts.
        others: by name, the shaft on whose axis each of the others lies, and its height along that shaft's z [mm].
    """

    layout: Layout
    others: Mapping[str, tuple[str, float]]

    def root(self, name: str) -> str:
        """The first shaft of its train."""
        return self.layout.root_of[self.others.get(name, (name, 0.0))[0]]

    def pose(self, name: str) -> Array:
        """Its frame at rest in the world of its train (4, 4)."""
        shaft, height = self.others.get(name, (name, 0.0))
        world = self.layout.world_from_shaft[shaft]
        along = np.eye(4)
        along[2, 3] = height
        return np.asarray(world @ along) if height else world

    def order(self, name: str) -> tuple[bool, int]:
        """Sort key that finds the first shaft of a train: shafts in the order in which they turn, then the others."""
        return name in self.others, len(self.layout.upstream(name))


def _axes(gears: Scene, brought: Brought) -> _Axes:
    _, layout = meshes_of_scene(gears, brought)
    others = {
        part: (link.link.driver, level)
        for link in brought.links
        for part, level in link.link.levels.items()
        if part not in link.ends
    }
    return _Axes(layout, others)


@dataclass(frozen=True, eq=False)
class Housed:
    """Shafts in bores, and what follows.

    Args:
        scene: the gears of the scene, their meshes with the centre distances and azimuths that follow.
        shafts: those in bores, by their names.
        worlds: by the first shaft of each tree of shafts in bores, where its world lies in that of the parts (4, 4).
    """

    scene: Scene
    shafts: Mapping[str, HousedShaft]
    worlds: Mapping[str, Array]


def housed(scene: Scene, gears: Scene, assembly: Assembly) -> Housed:
    """Lay the shafts into their bores.

    Args:
        scene: all of it.
        gears: its entries that are of gears.
        assembly: its parts, in their nominal poses.

    Raises:
        SceneError: bores that do not fit the meshes on their shafts.
    """
    lines = lines_of(scene, assembly)
    gears = _with_distances(gears, lines)
    brought = brought_into(gears)
    axes = _axes(gears, brought)
    layout = axes.layout
    for shaft, (name, _) in lines.items():
        if shaft not in layout.root_of and shaft not in axes.others:
            words = f"expected a shaft that gears or trains turn, or a part on the axis of one, got {shaft!r}"
            raise scene.refuse(("moves", name, "shaft"), words)
    worlds = dict(_worlds(scene, lines, axes))
    for link in sorted(layout.links, key=lambda link: len(layout.upstream(link.driven))):
        if isinstance(gears.moves.get(link.name), MeshSpec) and {link.driver, link.driven} <= lines.keys():
            meshes, layout = meshes_of_scene(gears, brought)
            mesh = next(own for own in meshes if own.name == link.name)
            gears = _with_azimuth(gears, mesh, lines[link.driven][1], worlds[layout.root_of[link.driver]], layout)
    axes = _axes(gears, brought)
    shafts = {}
    for shaft, (move, bores) in lines.items():
        root = axes.root(shaft)
        first = min((line for line in lines if axes.root(line) == root), key=axes.order)
        host = assembly.features[lines[first][1][0].feature].part
        shafts[shaft] = HousedShaft(move, shaft, bores, worlds[root] @ axes.pose(shaft), host)
    for own in shafts.values():
        _refuse_misfit(scene, own)
    return Housed(gears, shafts, worlds)


def _shaft_of(scene: Scene, gear: str) -> str:
    """The shaft that carries a gear; itself where none does."""
    found = (name for name, part in scene.parts.items() if gear in getattr(part, "carries", {}))
    return next(found, gear)


def _direction(bores: tuple[Bore, Bore]) -> Array:
    apart = bores[1].place - bores[0].place
    return np.asarray(apart / np.linalg.norm(apart))


def _with_distances(gears: Scene, lines: Mapping[str, tuple[str, tuple[Bore, Bore]]]) -> Scene:
    """The scene whose meshes have the centre distances of their bores."""
    for name, move in gears.of(GearMeshSpec).items():
        shafts = [_shaft_of(gears, gear) for gear in move.gears]
        if not any(shaft in lines for shaft in shafts):
            continue
        if not isinstance(move, MeshSpec):
            words = f"expected a mesh on parallel axes of a shaft in bores, got {move.words}: the place of a bevel "
            raise gears.refuse(("moves", name), f"{words}gear along its axis is unknown")
        if outside := [shaft for shaft in shafts if shaft not in lines]:
            inside = next(shaft for shaft in shafts if shaft in lines)
            words = f"expected both shafts in bores, got {outside[0]!r} in none, while {inside!r} lies in bores"
            raise gears.refuse(("moves", name), f"{words}; add a move of kind shaft_in_bores for it")
        (_, first), (_, second) = (lines[shaft] for shaft in shafts)
        along = _direction(first)
        lean = float(np.linalg.norm(np.cross(along, _direction(second))))
        if lean > SAME_DIRECTION:
            words = f"expected parallel bores of {shafts[0]!r} and {shafts[1]!r}, got axes at {1e3 * lean:.4g} mrad"
            raise gears.refuse(("moves", name), words)
        if move.housing is not None:
            words = f"expected none, for both shafts lie in bores, which grow with their parts; got {move.housing!r}"
            raise gears.refuse(("moves", name, "housing"), words)
        apart = second[0].place - first[0].place
        distance = float(np.linalg.norm(apart - along * (apart @ along)))
        said = None if move.centre_distance is None else move.centre_distance.internal
        _refuse_other(gears, ("moves", name, "centre_distance"), said, distance, SAME_PLACE, "mm")
        gears = _with_move(gears, name, move.model_copy(update={"centre_distance": Quantity(distance, "mm")}))
    return gears


def _refuse_other(scene: Scene, path: KeyPath, said: float | None, follows: float, tolerance: float, unit: str) -> None:
    if said is not None and abs(said - follows) > tolerance:
        words = f"expected {follows:.9g} {unit}, as the bores lie, got {said:.9g} {unit}"
        raise scene.refuse(path, f"{words}; take it out, for it follows")


def _with_move(scene: Scene, name: str, move: Any) -> Scene:
    """The scene with another move; messages keep their places."""
    return scene.model_copy(update={"moves": {**scene.moves, name: move}})


def _worlds(
    scene: Scene, lines: Mapping[str, tuple[str, tuple[Bore, Bore]]], axes: _Axes
) -> Iterator[tuple[str, Array]]:
    """Pose of each train's world, by its first shaft: from the first of its shafts that lies in bores."""
    found: set[str] = set()
    for shaft in sorted(lines, key=axes.order):
        root = axes.root(shaft)
        if root not in found:
            found.add(root)
            move, bores = lines[shaft]
            spec = scene.of(ShaftInBoresSpec)[move]
            frame = _frame(bores, 0.0 if spec.at is None else spec.at.internal)
            yield root, frame @ np.linalg.inv(axes.pose(shaft))


def _frame(bores: tuple[Bore, Bore], at: float) -> Array:
    """z from the first point to the other one, the origin at a place along it from the middle of the first bore."""
    z = _direction(bores)
    wish = np.eye(3)[0] if abs(z[0]) < 0.9 else np.eye(3)[1]
    x = wish - z * (wish @ z)
    x /= np.linalg.norm(x)
    middle = bores[0].place if bores[0].end is None else (bores[0].place + bores[1].place) / 2
    made = np.eye(4)
    made[:3, 0], made[:3, 1], made[:3, 2], made[:3, 3] = x, np.cross(z, x), z, middle + at * z
    return made


def _with_azimuth(gears: Scene, mesh: Mesh, bores: tuple[Bore, Bore], world: Array, layout: Layout) -> Scene:
    """The scene whose mesh looks towards the bores of the shaft that it drives."""
    move = gears.moves[mesh.name]
    assert isinstance(move, GearMeshSpec)
    shaft, _ = layout.carrying[mesh.driver]
    frame = world @ layout.world_from_shaft[shaft] @ layout.shaft_from_gear[mesh.driver]
    x, y, _ = frame[:3, :3].T @ (bores[0].place - frame[:3, 3])
    follows = math.atan2(y, x) - math.atan2(*mesh.pair.wheel_origin[1::-1])
    if "azimuth" in move.model_fields_set:
        off = math.remainder(move.azimuth.internal - follows, 2 * math.pi)
        said = math.degrees(follows + off)
        tolerance = math.degrees(AZIMUTH_AS_WRITTEN)
        _refuse_other(gears, ("moves", mesh.name, "azimuth"), said, math.degrees(follows), tolerance, "deg")
    azimuth = Quantity(math.degrees(follows), "deg")
    return _with_move(gears, mesh.name, move.model_copy(update={"azimuth": azimuth}))


def _refuse_misfit(scene: Scene, housed_shaft: HousedShaft) -> None:
    """Refuse a shaft that is placed by links other than meshes between housed shafts, or stated elsewhere along z."""
    for bore in housed_shaft.bores:
        x, y, _ = housed_shaft.frame[:3, :3].T @ (bore.place - housed_shaft.frame[:3, 3])
        if math.hypot(x, y) > SAME_PLACE:
            words = f"expected bores on the axis on which its train puts {housed_shaft.shaft!r}, got {bore.feature!r}"
            raise scene.refuse(("moves", housed_shaft.move, "in"), f"{words}, {math.hypot(x, y):.4g} mm beside it")
    spec = scene.of(ShaftInBoresSpec)[housed_shaft.move]
    if spec.at is not None:
        first, last = housed_shaft.bores
        middle = first.place if first.end is None else (first.place + last.place) / 2
        along = float((housed_shaft.frame[:3, 3] - middle) @ _direction(housed_shaft.bores))
        _refuse_other(scene, ("moves", housed_shaft.move, "at"), spec.at.internal, along, SAME_PLACE, "mm")
