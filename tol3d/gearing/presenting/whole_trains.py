"""A build's parts in one world: every gear once, in the mesh that drives it, with shafts, arms and other links.

Gears stand where they came to rest; shafts and arms on their nominal axes, turned with their gears.
"""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.cad.solids import PosedBody, PosedGear, display_mesh
from tol3d.gearing.model import Arm, LostMotion, Model
from tol3d.gearing.model.layout import Layout
from tol3d.gearing.presenting.shaft_sizes import ShaftSizes, Span, arm_body
from tol3d.gearing.shown.display import SeatedBuild, shows_shafts
from tol3d.gearing.shown.placed import PlacedGear, SeatedMesh
from tol3d.numerics import frames
from tol3d.numerics.arrays import Array
from tol3d.report.body import Arrow, Body, Surface, World

BODY_DEFLECTION: Final = 1 / 500  # of the diameter; forty facets round, their edges too blunt to be drawn

SHAFT_COLOURS: Final = (
    "#7FB2D9", "#F0C36D", "#8CC5A2", "#E39B86", "#B7A3D6", "#7CC4C4", "#D9A5C3", "#B9C27B",
)  # fmt: skip
HOUSING_COLOUR: Final = "#A4ACB5"


@dataclass(frozen=True, eq=False)
class WholeTrain:
    """A tree of shafts with all of its parts, in the world of its first shaft.

    Args:
        root: its first shaft.
        gears: as they came to rest.
        bodies: shafts, arms and housings of links.
        shaft_of: the shaft that each gear and body turns with, by the part's name; None for a housing.
        points: points of the arms that are named in pictures, (3,) [mm].
        gravity: its direction and its point of action, both (3,); None if the scene states none.
    """

    root: str
    gears: tuple[PlacedGear, ...]
    bodies: tuple[PosedBody, ...]
    shaft_of: Mapping[str, str | None]
    points: Mapping[str, Array]
    gravity: tuple[Array, Array] | None

    @cached_property
    def colours(self) -> Mapping[str, str]:
        """Colour of each part, "#RRGGBB": one a shaft, and one for all housings."""
        shafts = dict.fromkeys(shaft for shaft in self.shaft_of.values() if shaft is not None)
        of_shaft = dict(zip(shafts, itertools.cycle(SHAFT_COLOURS), strict=False))
        return {name: of_shaft[shaft] if shaft else HOUSING_COLOUR for name, shaft in self.shaft_of.items()}

    @cached_property
    def world(self) -> World:
        """All its parts as they are shown and exported."""
        gears = [gear_body(part, self.colours[part.name]) for part in self.gears]
        others = [plain_body(body, self.colours[body.name]) for body in self.bodies]
        if self.gravity is None:
            return World(self.root, (*gears, *others), points=self.points)
        direction, place = self.gravity
        x, y, z = (-direction).tolist()
        return World(
            self.root, (*gears, *others), points=self.points, arrows={"gravity": Arrow(direction, place)}, up=(x, y, z)
        )

    @property
    def meshes(self) -> Mapping[str, Surface]:
        """Closed triangle mesh of each part: vertices (n, 3) [mm], triangles (m, 3)."""
        return {body.name: body.mesh for body in self.world.bodies}


def gear_body(part: PlacedGear, colour: str) -> Body:
    """A placed gear as it is shown and exported."""
    return Body(
        name=part.name,
        world_from_part=part.world_from_gear,
        surface=part.surface,
        posed=lambda: PosedGear(part.name, part.perturbed, part.world_from_gear),
        colour=colour,
        scale=part.scale,
        coarse=part.coarse,
    )


def plain_body(body: PosedBody, colour: str) -> Body:
    """A shaft, an arm or a housing as it is shown and exported."""

    def surface() -> Surface:
        display = display_mesh(body.shape, BODY_DEFLECTION * body.shape.diameter)
        return display.vertices, display.triangles

    return Body(body.name, body.world_from_part, surface, lambda: body, colour, smooth=True)


def whole_trains(build: SeatedBuild) -> tuple[WholeTrain, ...]:
    """The trees of a build's shafts; none of a build of single pairs."""
    if not shows_shafts(build.model):
        return ()
    return tuple(_train(build, root) for root in dict.fromkeys(build.model.layout.root_of.values()))


def _train(build: SeatedBuild, root: str) -> WholeTrain:
    model = build.model
    layout = model.layout
    own = [shaft for shaft, first in layout.root_of.items() if first == root]
    angles = {shaft: _angle(build, shaft) for shaft in own}
    sizes = ShaftSizes(model, _faces(build))
    gears: list[PlacedGear] = []
    bodies: list[PosedBody] = []
    shaft_of: dict[str, str | None] = {}
    points: dict[str, Array] = {}
    for shaft in own:
        pose = _shaft_pose(layout, shaft, angles)
        for gear in (
            name for name, (carrier, _) in layout.carrying.items() if carrier == shaft and _meshes(build, name)
        ):
            gears.append(_in_world(build, gear))
            shaft_of[gear] = shaft
        if shaft in sizes.shafts:
            bodies.append(PosedBody(shaft, sizes.body(shaft), pose))
            shaft_of[shaft] = shaft
        for arm in (arm for arm in model.arms if arm.on == shaft):
            hung = _arm_pose(model, arm, angles)
            bodies.append(PosedBody(arm.name, arm_body(arm), hung))
            shaft_of[arm.name] = shaft
            shown = {name: place for name, place in arm.points if name in _named_points(model, arm)}
            points |= {f"{name} of {arm.name}": hung[:3, :3] @ place + hung[:3, 3] for name, place in shown.items()}
    for link in (link for link in model.links if link.housed and link.coaxial and link.driven in own):
        name = _free_name(link.name, {*shaft_of, *sizes.shafts, *(arm.name for arm in model.arms)})
        bodies.append(PosedBody(name, sizes.housing(link), layout.world_from_shaft[link.driven]))
        shaft_of[name] = None
    return WholeTrain(root, tuple(gears), tuple(bodies), shaft_of, points, _gravity(model, root, angles))


def _shaft_pose(layout: Layout, shaft: str, angles: Mapping[str, float]) -> Array:
    """Pose of a shaft; one on a carrier has gone round with it, and turns against it about its own axis."""
    at_0 = layout.world_from_shaft[shaft]
    link = layout.driving.get(shaft)
    if link is None or link.carrier is None:
        return np.asarray(at_0 @ _about_z(angles[shaft]))
    carrier = _shaft_pose(layout, link.carrier, angles) @ np.linalg.inv(layout.world_from_shaft[link.carrier])
    return np.asarray(carrier @ at_0 @ _about_z(angles[shaft] - angles[link.carrier]))


def _arm_pose(model: Model, arm: Arm, angles: Mapping[str, float]) -> Array:
    """An arm stands at 0 where the first shaft does, however the teeth then lie to its shaft."""
    layout = model.layout
    turn = angles[arm.on] - layout.shaft_turn[arm.on].offset
    return np.asarray(layout.world_from_shaft[arm.on] @ _about_z(turn))


def _named_points(model: Model, arm: Arm) -> set[str]:
    """Points of an arm whose displacement is measured, and its last."""
    kinds = [measure.kind for measure in model.measures]
    tips = [kind.tip for kind in kinds if isinstance(kind, LostMotion) and kind.tip]
    return {tip.point for tip in tips if tip.arm == arm.name} | {arm.points[-1][0]}


def _free_name(name: str, taken: set[str]) -> str:
    return _free_name(f"{name} housing", taken) if name in taken else name


def _gravity(model: Model, root: str, angles: Mapping[str, float]) -> tuple[Array, Array] | None:
    """Direction and point of gravity: at the weight of an arm, or at the axis of the train's output."""
    for train in model.trains:
        if train.driven == root and train.gravity is not None:
            arm = next((arm for arm in model.arms if arm.on == train.output), None)
            place = (0.0, 0.0, 0.0) if arm is None else arm.centre_of_mass or arm.points[-1][1]
            pose = model.layout.world_from_shaft[train.output] if arm is None else _arm_pose(model, arm, angles)
            direction = np.array(train.gravity) / np.linalg.norm(train.gravity)
            return direction, pose[:3, :3] @ np.array(place) + pose[:3, 3]
    return None


# positions ----------------------------------------------------------------------------------------


def _meshes(build: SeatedBuild, gear: str) -> bool:
    """True if a gear is in a mesh; one in another link is not."""
    return any(gear in (seated.mesh.driver, seated.mesh.driven) for seated in build.meshes)


def _seating(build: SeatedBuild, gear: str) -> SeatedMesh:
    """The mesh in which a gear is shown: the one that drives it, or the first that it drives."""
    return next(
        (seated for seated in build.meshes if seated.mesh.driven == gear),
        next(seated for seated in build.meshes if gear in (seated.mesh.driver, seated.mesh.driven)),
    )


def _in_world(build: SeatedBuild, gear: str) -> PlacedGear:
    """A gear as it came to rest, in the world of its tree."""
    seated = _seating(build, gear)
    placed = seated.driven if seated.mesh.driven == gear else seated.driver
    pose = build.model.layout.world_from_mesh[seated.mesh.name] @ placed.world_from_gear
    return replace(placed, world_from_gear=pose)


def _angle(build: SeatedBuild, shaft: str) -> float:
    """Turn of a shaft [rad]: that of its gear, the driven one if there is one; without gears as the first shaft's."""
    layout = build.model.layout
    own = [own for carrier, own in layout.carrying.values() if carrier == shaft and _meshes(build, own.gear)]
    driven = [carried for carried in own if _seating(build, carried.gear).mesh.driven == carried.gear]
    for carried in driven or own:
        seated = _seating(build, carried.gear)
        lies = layout.seating(seated.mesh.name)
        azimuth = lies.azimuth + lies.ahead if carried in driven else seated.mesh.azimuth
        at_rest = (seated.driven_angle if carried in driven else seated.driver_angle) + azimuth
        return carried.sense * (at_rest - carried.phase)
    return layout.shaft_turn[shaft].at(_root_angle(build, layout.root_of[shaft]))


def _root_angle(build: SeatedBuild, root: str) -> float:
    """Turn of a tree's first shaft [rad], from its meshes; 0 where there are none."""
    layout = build.model.layout
    for seated in build.meshes:
        turning = layout.mesh_turn[seated.mesh.name]
        if layout.root_of[layout.carrying[seated.mesh.driver][0]] == root:
            return (seated.driver_angle - turning.offset) / float(turning.rate)
    return 0.0


def _about_z(angle: float) -> Array:
    return frames.transform(frames.about_z(np.array(angle)), np.zeros(3))


def _faces(build: SeatedBuild) -> Mapping[str, Span]:
    """Ends of each gear along its own z [mm]."""
    spans = {}
    for seated in build.meshes:
        for part in (seated.driver, seated.driven):
            heights = part.display.vertices[:, 2]
            spans[part.name] = float(heights.min()), float(heights.max())
    return spans
