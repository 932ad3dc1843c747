"""Trains of an arm as pictures show them within its links: each behind the joint that it turns, undeviated.

A scene does not tell where in a link a train lies: it is drawn on the axis of its joint, behind the bore, its input at
the back and, where shafts cross, towards the joint before.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import takewhile
from typing import Final

import numpy as np

from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.presenting.shown_assembly import Placed
from tol3d.cad.solids import display_mesh
from tol3d.errors import RunError
from tol3d.gearing.machine.grammar.open_chain import OpenChainSpec
from tol3d.gearing.machine.system import MachineSystem
from tol3d.gearing.model import Model
from tol3d.gearing.presenting.shown_train import shown_build
from tol3d.gearing.shown.display import seated_build
from tol3d.numerics.arrays import Array
from tol3d.report.body import Body, Surface, World
from tol3d.study.results.replaying import replayed
from tol3d.study.system.stated import nominal_build
from tol3d.study.trials.simulation import Simulation

COARSE: Final = 0.2
"""mm; deflection of triangles from faces, far below a pixel of a picture of a whole arm."""
SOME_NAMES: Final = 3
"""Bodies of one colour that are named where their names have no word in common."""
ONE_LINE: Final = 1e-9
"""Sine of an angle, and mm; shafts that cross by less are parallel."""
APART: Final = 1.0
"""mm; where the axis of a joint passes the joint before nearer than that, as in a wrist, its input is turned along that
axis."""


@dataclass(frozen=True, eq=False)
class TrainInJoint:
    """A train with its parts about its output at the origin, which turns about z.

    Args:
        name: the train's.
        axis: the feature of the link before that its joint turns about.
        bodies: of one colour each, in that frame.
        towards: to its input, square to z (3,) [mm]; near 0 where that lies on z.
        behind: z of its foremost point [mm].
    """

    name: str
    axis: str
    bodies: tuple[Body, ...]
    towards: Array
    behind: float

    def placed(self, placed: Placed) -> tuple[Body, ...]:
        """Its parts behind its joint as the parts of an arm lie."""
        world_from_axis = placed.frames[self.axis]
        pose = np.eye(4)
        if np.linalg.norm(self.towards) > ONE_LINE:
            back = np.linalg.inv(world_from_axis) @ placed.poses[part_of(self.axis)]
            away = back[:2, 3] if np.linalg.norm(back[:2, 3]) > APART else back[:2, 2]
            turn = np.arctan2(away[1], away[0]) - np.arctan2(self.towards[1], self.towards[0])
            pose[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        pose[2, 3] = -self.behind - placed.assembly.features[self.axis].shape.ends[:, 2].max()
        return tuple(_moved(body, world_from_axis @ pose) for body in self.bodies)


def _moved(body: Body, pose: Array) -> Body:
    """A body whose surface lies in the frame of its train, in a world."""
    return Body(body.name, pose, body.surface, None, body.colour)


def trains_in_joints(simulation: Simulation) -> tuple[TrainInJoint, ...]:
    """The trains that turn the joints of an arm, from its nominal build; none where that cannot be shown.

    Trains with shafts in bores are left out: they are shown in the worlds of their gears, where the parts have them.
    """
    system = simulation.system
    assert isinstance(system, MachineSystem)
    joints = (
        [
            (own.train, own.between[0])
            for spec in system.parts.of(OpenChainSpec).values()
            for own in spec.joints.values()
            if own.train
        ]
        if system.parts is not None
        else []
    )
    if not joints:
        return ()
    try:
        display = shown_build(seated_build(replayed(simulation, nominal_build(system)), "nominal"))
    except RunError:
        return ()
    model = system.gears.model
    layout, trains = model.layout, {own.name: own for own in model.trains}
    found = []
    for name, axis in joints:
        train = trains[name]
        root = layout.root_of[train.output]
        if root in system.worlds:
            continue
        output, first = layout.world_from_shaft[train.output], layout.world_from_shaft[train.driven]
        into = np.asarray(np.linalg.inv(output), dtype=np.float64)
        if (into @ first)[2, 3] > ONE_LINE:
            into = np.asarray(np.diag([1.0, -1.0, -1.0, 1.0]) @ into, dtype=np.float64)
        bodies = tuple(_joined(name, list(_parts(display.worlds, model, root)), into))
        if bodies:
            crossing = np.linalg.norm(np.cross(output[:3, 2], first[:3, 2])) > ONE_LINE
            towards = (into @ first)[:3, 3] * (1.0, 1.0, 0.0) if crossing else np.zeros(3)
            behind = max(float(body.surface()[0][:, 2].max()) for body in bodies)
            found.append(TrainInJoint(name, axis, bodies, towards, behind))
    return tuple(found)


def _parts(worlds: Sequence[World], model: Model, root: str) -> Iterator[Body]:
    """Bodies of the train of a first shaft, in its world; single pairs have a world a mesh."""
    for world in worlds:
        if world.name == root:
            yield from world.bodies
        elif world.name in model.layout.world_from_mesh:
            driver = model.layout.carrying[model.mesh(world.name).driver][0]
            if model.layout.root_of[driver] == root:
                into = model.layout.world_from_mesh[world.name]
                yield from (replace(body, world_from_part=into @ body.world_from_part) for body in world.bodies)


def _joined(train: str, bodies: Sequence[Body], into: Array) -> Iterator[Body]:
    """Bodies of a train in another frame, coarse, those of one colour as one."""
    by_colour: dict[str, list[Body]] = {}
    for body in bodies:
        by_colour.setdefault(body.colour, []).append(body)
    for colour, alike in by_colour.items():
        surface = _coarse(alike, into)
        names = [body.name for body in alike]
        shared = takewhile(lambda words: len(set(words)) == 1, zip(*(name.split() for name in names), strict=False))
        more = f" and {len(names) - SOME_NAMES} more" if len(names) > SOME_NAMES else ""
        words = " ".join(word[0] for word in shared) or ", ".join(names[:SOME_NAMES]) + more
        yield Body(f"{train}: {words}", np.eye(4), partial(_as_made, surface), None, colour)


def _coarse(bodies: Sequence[Body], into: Array) -> Surface:
    vertices, triangles, count = [], [], 0
    for body in bodies:
        if body.posed is None:
            own, faces = body.surface()
        else:
            mesh = display_mesh(body.posed().shape, COARSE)
            own, faces = mesh.vertices, mesh.triangles
        pose = into @ body.world_from_part
        vertices.append(own @ pose[:3, :3].T + pose[:3, 3])
        triangles.append(faces + count)
        count += len(own)
    return np.concatenate(vertices), np.concatenate(triangles)


def _as_made(surface: Surface) -> Surface:
    return surface
