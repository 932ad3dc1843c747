"""A build of gears as it is shown and exported: single pairs each in its own world, trains in one."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from typing import Final

import numpy as np

from tol3d.errors import InputError
from tol3d.gearing.meshing.mesh import MeshSeat
from tol3d.gearing.model import LostMotion
from tol3d.gearing.presenting.whole_trains import WholeTrain, gear_body, whole_trains
from tol3d.gearing.shown.display import SeatedBuild, Side, seated_mesh, seats_turned, shows_shafts
from tol3d.gearing.shown.placed import SeatedMesh
from tol3d.numerics.arrays import Array
from tol3d.report.body import MeasuredLine, World
from tol3d.report.motion import Frame, Look, Mark, Motion, Shot, around, corner
from tol3d.report.presenter import Panel, View
from tol3d.scene.name import LONGEST_NAME
from tol3d.scene.nearest import hint

Seats = Mapping[str, MeshSeat]

TURN, SWING = "turn", "swing"
SWING_FRAMES, PITCH_FRAMES, MOST_TURN_FRAMES = 16, 24, 120
FRAMES_A_TOOTH: Final = 4  # of a train's first gear, which would seem to run backwards with fewer than 2
CONTACT: Final = "contact"
COLOURS: Final = {CONTACT: "#B0127B"}
DRIVER_COLOUR, DRIVEN_COLOUR = "#4682B4", "#E69F00"
TEETH_HIGH: Final = 2.9  # modules from the contact to the upper edge of the picture
MOST_CLOSE_UPS: Final = 3


def motions(build: SeatedBuild) -> tuple[str, ...]:
    """Names of the motions of a build; none of one without meshes that are shown."""
    return (TURN, SWING) if build.meshes else ()


def motion(build: SeatedBuild, name: str, frames: int | None) -> Motion:
    """The driver of a pair turns by one pitch, the first shaft of a train once; or all swing, those held.

    Args:
        build: at rest.
        name: of the motion.
        frames: how many; None: as many as suit it.
    """
    world = _world(build)
    shown = _shown(build, world)
    driver, train = shown.meshes[0].driver.gear, shows_shafts(build.model)
    if name == SWING:
        states = tuple(_swung(shown, frames or SWING_FRAMES))
    else:
        suits = min(FRAMES_A_TOOTH * driver.teeth, MOST_TURN_FRAMES) if train else PITCH_FRAMES
        states = tuple(_turned(shown, 2 * math.pi if train else driver.angular_pitch, frames or suits))
    made = tuple(_frame(state, states[0], name) for state in states)
    left_out = [mesh.mesh.name for mesh in build.meshes if mesh not in shown.meshes]
    notes = (f"shown is {world.name}, not {', '.join(left_out)}",) if left_out else ()
    return Motion(world, made, tuple(_shots(shown, world)), COLOURS, back=name == SWING, notes=notes)


def _world(build: SeatedBuild) -> World:
    """The first train with a mesh, or the first pair."""
    for train in whole_trains(build):
        if any(mesh.driver.name in train.shaft_of for mesh in build.meshes):
            return train.world
    return _pair(build.meshes[0])


def _shown(build: SeatedBuild, world: World) -> SeatedBuild:
    """The build with the meshes of that world alone."""
    names = {body.name for body in world.bodies}
    if not shows_shafts(build.model):
        return replace(build, meshes=build.meshes[:1])
    return replace(build, meshes=tuple(mesh for mesh in build.meshes if mesh.driver.name in names))


# states -------------------------------------------------------------------------------------------


def _turned(build: SeatedBuild, way: float, frames: int) -> Iterator[SeatedBuild]:
    """The drivers turn by so much [rad], counter-clockwise, the last frame one short of it: it is as the first."""
    for beyond in np.linspace(0.0, way, frames, endpoint=False).tolist():
        yield _with(build, _seats(build, beyond, "drive"))


def _swung(build: SeatedBuild, frames: int) -> Iterator[SeatedBuild]:
    """From the drive side of all backlashes to their back side, evenly; contacts are marked at both ends."""
    drive, back = (_seats(build, 0.0, side) for side in ("drive", "back"))
    yield _with(build, drive)
    for share in np.linspace(0.0, 1.0, frames)[1:-1].tolist():
        yield _with(build, {name: _between(drive[name], back[name], share) for name in drive}, touching=False)
    yield _with(build, back)


def _seats(build: SeatedBuild, beyond: float, side: Side) -> Seats:
    return seats_turned(build.seen, {mesh.mesh.name: mesh.driver_angle for mesh in build.meshes}, beyond, side)


def _between(drive: MeshSeat, back: MeshSeat, share: float) -> MeshSeat:
    driver, driven = (
        (1 - share) * one + share * other
        for one, other in ((drive.driver_angle, back.driver_angle), (drive.driven_angle, back.driven_angle))
    )
    return replace(drive, driver_angle=driver, driven_angle=driven)


def _with(build: SeatedBuild, seats: Seats, *, touching: bool = True) -> SeatedBuild:
    """The build with its meshes at other turns; without points of contact where none touches."""
    moved = (seated_mesh(build.seen, mesh.mesh, seats[mesh.mesh.name], 0) for mesh in build.meshes)
    nowhere = np.full(3, np.nan)
    return replace(build, meshes=tuple(own if touching else replace(own, contact=nowhere) for own in moved))


# frames -------------------------------------------------------------------------------------------


def _frame(moved: SeatedBuild, first: SeatedBuild, name: str) -> Frame:
    """A state, its numbers counted from the first."""
    poses = {body.name: body.world_from_part for body in _world(moved).bodies}
    marks = tuple(
        Mark(CONTACT, _point(moved, mesh, mesh.contact), (mesh.driver.name, mesh.driven.name))
        for mesh in moved.meshes
        if np.isfinite(mesh.contact).all()
    )
    driver = math.degrees(moved.meshes[0].driver_angle - first.meshes[0].driver_angle)
    driven = math.degrees(moved.meshes[-1].driven_angle - first.meshes[-1].driven_angle)
    names = moved.meshes[0].driver.name, moved.meshes[-1].driven.name
    if name == TURN:
        return Frame(f"{names[0]} {driver:.2f}°, {names[1]} {driven:.3f}°", poses, marks)
    return Frame(f"{names[0]} held, {names[1]} {60 * driven:.2f} arcmin", poses, marks)


def _place(build: SeatedBuild, mesh: SeatedMesh) -> Array:
    """Pose of a mesh's world in the displayed one, (4, 4)."""
    return build.model.layout.world_from_mesh[mesh.mesh.name] if shows_shafts(build.model) else np.eye(4)


def _point(build: SeatedBuild, mesh: SeatedMesh, point: Array) -> Array:
    place = _place(build, mesh)
    return np.asarray(place[:3, :3] @ point + place[:3, 3])


def _shots(build: SeatedBuild, world: World) -> Iterator[Shot]:
    """Teeth in mesh, then the whole pair; of a train the train, then the teeth of its meshes."""
    if not shows_shafts(build.model):
        yield _teeth(build, build.meshes[0])
        towards = build.meshes[0].mesh.pair.view_from_world.T
        yield _whole(world, towards[:, 2], towards[:, 1])
        return
    yield whole_train(world)
    for mesh in build.meshes[:MOST_CLOSE_UPS]:
        yield _teeth(build, mesh)


def whole_train(world: World) -> Shot:
    """All of a train, from a corner: the first of its shots."""
    return _whole(world, *corner(np.array(world.up)))


def _whole(world: World, towards: Array, up: Array) -> Shot:
    points = np.concatenate([body.mesh[0] for body in world.bodies])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    return Shot("whole", (around(points, middle, towards, up),))


def _teeth(build: SeatedBuild, mesh: SeatedMesh) -> Shot:
    seen = _place(build, mesh)[:3, :3] @ mesh.mesh.pair.view_from_world.T
    look = Look(_point(build, mesh, mesh.contact), TEETH_HIGH * mesh.driver.gear.module, seen[:, 2], seen[:, 1])
    return Shot(mesh.mesh.name, (look,), (mesh.driver.name, mesh.driven.name))


DRIVER_COLOUR, DRIVEN_COLOUR = "#4682B4", "#E69F00"
PANELS: Final = "tol3d.gearing.presenting.panels"  # it loads pyvista, which files do not need


@dataclass(frozen=True, eq=False)
class GearDisplay:
    """A build of gears; see `tol3d.report.presenter.Display`."""

    build: SeatedBuild

    @property
    def label(self) -> str:
        """Label, such as "trial-17" or "nominal"."""
        return self.build.label

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes for the user."""
        return self.build.notes

    @cached_property
    def trains(self) -> tuple[WholeTrain, ...]:
        """The trees of its shafts; none of a build of single pairs."""
        return whole_trains(self.build)

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """A world a tree of shafts, or where there are only single pairs a world a mesh."""
        trains = [(train.world, _measured(self.build, train)) for train in self.trains]
        found = trains or [(_pair(own), _gaps(self.build, (own,))) for own in self.build.meshes]
        return tuple(replace(world, measured=lines, magnify=self.build.magnify) for world, lines in found)

    @property
    def motions(self) -> tuple[str, ...]:
        """See `tol3d.report.motion.Movable`."""
        return motions(self.build)

    def motion(self, name: str, frames: int | None) -> Motion:
        """See `tol3d.report.motion.Movable`."""
        return motion(self.build, name, frames)

    def view(self, close_up: str | None) -> View:
        """The teeth of one mesh, the whole pair, a close-up of the gap; of a train, the train before the teeth.

        Args:
            close_up: the mesh that is shown close up, and with it the train of the same first shaft; None: the
                first.
        """
        asked = self._asked(close_up)
        trains = sorted(self.trains, key=lambda train: asked is not None and asked.mesh.driver not in train.shaft_of)
        shown = trains[0] if trains else None
        close = asked or self._first(shown)
        panels: tuple[Panel, ...] = import_module(PANELS).panels_of(self.build, shown, close)
        return View(panels, tuple(self._left_out(trains, close)))

    def _asked(self, mesh: str | None) -> SeatedMesh | None:
        """The mesh of that name; None where none was asked for.

        Raises:
            InputError: the build shows no such mesh.
        """
        if mesh is None:
            return None
        by_name = {seated.mesh.name: seated for seated in self.build.meshes}
        if mesh not in by_name:
            raise InputError(f"--mesh: no mesh {mesh[:LONGEST_NAME]!r} is shown of this run{hint(mesh, by_name)}")
        return by_name[mesh]

    def _first(self, train: WholeTrain | None) -> SeatedMesh | None:
        """The first mesh, of a train its first; None for a train without any."""
        meshes = self.build.meshes
        return next((seated for seated in meshes if train is None or seated.mesh.driver in train.shaft_of), None)

    def _left_out(self, trains: list[WholeTrain], close: SeatedMesh | None) -> Iterator[str]:
        """Notes on all that the window does not show."""
        others = [seated.mesh.name for seated in self.build.meshes if seated is not close]
        if close and others:
            what = "close up" if trains else "shown"
            yield f"{what} is {close.mesh.name}, not {', '.join(others)} (choose with --mesh)"
        if len(trains) > 1:
            others = [train.root for train in trains[1:]]
            yield f"shown are the shafts downstream of {trains[0].root}, not those of {', '.join(others)}"


def _measured(build: SeatedBuild, train: WholeTrain) -> Mapping[str, tuple[MeasuredLine, ...]]:
    """Lines of measures on a train: tips of arms, gaps of the others."""
    found = dict(_gaps(build, [own for own in build.meshes if own.driver.name in train.shaft_of]))
    for measure in build.model.measures:
        tip = measure.kind.tip if isinstance(measure.kind, LostMotion) else None
        place = train.points.get(f"{tip.point} of {tip.arm}") if tip else None
        if place is not None:
            found[measure.name] = (MeasuredLine(place[None]),)
    return found


def _gaps(build: SeatedBuild, meshes: Sequence[SeatedMesh]) -> Mapping[str, tuple[MeasuredLine, ...]]:
    """Lines across the gaps that each measure reads or adds up."""
    gaps = {own.mesh.name: np.stack([_point(build, own, end) for end in own.gap]) for own in meshes}
    found = dict[str, tuple[MeasuredLine, ...]]()
    for measure in build.model.measures:
        read = [gaps[own.mesh] for _, own in measure.kind.backlashes if own.mesh in gaps]
        if lines := tuple(MeasuredLine(own) for own in read if np.isfinite(own).all()):
            found[measure.name] = lines
    return found


def _pair(seated: SeatedMesh) -> World:
    """A mesh's gears, with the contact on the working flank and the gap of the other one named."""
    parts = ((seated.driver, DRIVER_COLOUR), (seated.driven, DRIVEN_COLOUR))
    bodies = tuple(gear_body(part, colour) for part, colour in parts)
    marks = {"contact": seated.contact, seated.gap_words: seated.gap.mean(axis=0)}
    known = {name: place for name, place in marks.items() if np.isfinite(place).all()}
    return World(seated.mesh.name, bodies, one_file=False, marks=known)
