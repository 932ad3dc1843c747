"""Shafts, reducers, arms and trains of a scene, with checks that they make trains."""

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np

from tol3d.errors import GeometryError
from tol3d.gearing.grammar.moves import GearMeshSpec, LinkSpec, TrainSpec, meshes_of
from tol3d.gearing.grammar.parts import ArmSpec, BearingSpec, GearSpec, ShaftSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import ReducerBacklashSpec
from tol3d.gearing.links import StatedLink
from tol3d.gearing.model.faces import no_common_face
from tol3d.gearing.model.layout import Layout, misfit
from tol3d.gearing.model.shaft_trees import ratio_text
from tol3d.gearing.shafts import Arm, Carried, Mesh, Shaft, Train, Vector
from tol3d.gears import LEFT, RIGHT, Flank
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath
from tol3d.units import Quantity

RATIO_AS_WRITTEN = 5e-4  # relative; four digits are enough to check a drawing's ratio
PLACE_AS_WRITTEN = 0.05  # mm; azimuths are written with few decimals, and parallel load paths need not close better
AXES_AS_WRITTEN = 1e-3  # rad
NO_TORQUE = 1e-6  # of the lever of the arm's weight; less is none


def shafts_of(scene: Scene) -> tuple[Shaft, ...]:
    """The scene's shafts."""
    return tuple(_shaft(name, part) for name, part in scene.parts.items() if isinstance(part, ShaftSpec))


def _shaft(name: str, part: ShaftSpec) -> Shaft:
    carries = tuple(
        Carried(gear, own.at.internal, own.facing == "backward", own.phase.internal)
        for gear, own in part.carries.items()
    )
    sizes = (None if size is None else size.internal for size in (part.diameter, part.start, part.end))
    return Shaft(name, carries, *sizes)


def refuse_bearings(scene: Scene) -> None:
    """Refuse bearings that do not hold a shaft: two in one place, or more than two, which no rigid shaft fits.

    Raises:
        SceneError: at the bearing that is too many.
    """
    held: dict[str, list[str]] = {}
    for name, part in scene.parts.items():
        if not isinstance(part, BearingSpec):
            continue
        others = held.setdefault(part.shaft, [])
        if len(others) == 2:
            raise scene.refuse(
                ("parts", name),
                f"expected two bearings of {part.shaft!r} at most, got a third beside {others[0]!r} and {others[1]!r}: "
                "a rigid shaft would not fit into their clearances",
            )
        for other in others:
            there = scene.parts[other]
            if isinstance(there, BearingSpec) and there.at.internal == part.at.internal:
                sentence = f"expected another place than that of {other!r}, got '{part.at}'; two there hold no more"
                raise scene.refuse(("parts", name, "at"), f"{sentence} than one")
        others.append(name)


def arms_of(scene: Scene) -> tuple[Arm, ...]:
    """The scene's arms."""
    return tuple(
        Arm(
            name,
            part.shaft,
            tuple((point, _vector(place)) for point, place in part.points.items()),
            None if part.centre_of_mass is None else _vector(part.centre_of_mass),
            None if part.diameter is None else part.diameter.internal,
        )
        for name, part in scene.parts.items()
        if isinstance(part, ArmSpec)
    )


def _vector(lengths: Sequence[Quantity]) -> Vector:
    x, y, z = (length.internal for length in lengths)
    return x, y, z


def refuse_second_laws(scene: Scene) -> None:
    """Refuse a second distribution of one reducer's play.

    Raises:
        SceneError: at the second of them.
    """
    drawn: dict[str, str] = {}
    for name, spec in scene.tolerances.items():
        if isinstance(spec, ReducerBacklashSpec) and spec.of in drawn:
            sentence = f"expected one distribution of its play, got another one in {drawn[spec.of]!r}; leave out one"
            raise scene.refuse(("tolerances", name, "of"), sentence)
        if isinstance(spec, ReducerBacklashSpec):
            drawn[spec.of] = name


def stated_links_of(scene: Scene) -> tuple[StatedLink, ...]:
    """The scene's links that are no meshes, of whatever mechanism.

    Raises:
        SceneError: an impossible link, such as one on a shaft that its driver does not turn.
    """
    found = tuple(move.link(name, scene) for name, move in scene.moves.items() if isinstance(move, LinkSpec))
    for link in found:
        if not link.rate:
            sentence = f"expected a link that turns {link.driven!r}, got one that leaves it at rest"
            raise scene.refuse(("moves", link.name), sentence)
    return found


def refuse_misfits(scene: Scene, meshes: Sequence[Mesh], layout: Layout) -> None:
    """Refuse parallel load paths that would put the shaft where they join in two places, or whose teeth would not fit.

    Raises:
        SceneError: at the mesh that closes them.
    """
    for mesh in meshes:
        if mesh.name in {link.name for link in layout.closing}:
            off, askew = misfit(layout, mesh)
            if (apart := float(np.linalg.norm(off))) > PLACE_AS_WRITTEN or askew > AXES_AS_WRITTEN:
                shaft = layout.carrying[mesh.driven][0]
                raise scene.refuse(
                    ("moves", mesh.name),
                    f"the load paths to {shaft!r} do not fit: here it lies {apart:.3f} mm and "
                    f"{math.degrees(askew):.3f} deg from where {layout.driving[shaft].name!r} "
                    f"puts it{no_common_face(mesh, float(off[2]))}; check azimuths, centre distances and places "
                    "on the shafts",
                )
            if layout.seating(mesh.name).gap > PLACE_AS_WRITTEN:
                raise scene.refuse(
                    ("moves", mesh.name),
                    f"the teeth of {mesh.driver!r} and {mesh.driven!r} do not fit: they miss each other by "
                    f"{layout.seating(mesh.name).gap:.3f} mm, and both are in other meshes too, so that neither can be "
                    "turned on its shaft; check azimuths and numbers of teeth",
                )


def refuse_other_ratios(scene: Scene, meshes: Sequence[Mesh], layout: Layout) -> None:
    """Refuse ratios that the teeth do not give.

    Raises:
        SceneError: at the stated ratio.
    """
    for mesh in meshes:
        move = scene.moves[mesh.name]
        if isinstance(move, GearMeshSpec) and move.ratio is not None:
            why = f"{mesh.pair.wheel.teeth}/{mesh.pair.pinion.teeth}, teeth of {mesh.driven!r} over {mesh.driver!r}"
            _refuse_ratio(scene, mesh.name, move.ratio, abs(1 / mesh.rate), why)
    for name, move in scene.moves.items():
        if isinstance(move, TrainSpec) and move.ratio is not None:
            _refuse_ratio(scene, name, move.ratio, layout.ratio(move.driven, move.output), _ratio_of(layout, move))


def _ratio_of(layout: Layout, move: TrainSpec) -> str:
    """Ratios that make up the ratio of a train."""
    carried = [link for link in layout.upstream(move.output) if link.carrier is not None]
    if carried:
        each = ", ".join(f"{ratio_text(1 / link.rate)} ({link.name}, on {link.carrier!r})" for link in carried)
        return f"that of a train with carriers: {each}"
    links = reversed(layout.behind(move.output))
    return " · ".join(f"{ratio_text(1 / link.rate)} ({link.name})" for link in links) or "the same shaft"


def _refuse_ratio(scene: Scene, move: str, stated: float, real: Fraction, why: str) -> None:
    """A ratio without a sign is a magnitude; one below zero says that the shafts turn opposite."""
    wanted = real if stated < 0.0 else abs(real)
    if abs(stated - float(wanted)) > RATIO_AS_WRITTEN * abs(float(real)):
        loosely = " (its sign may be left out)" if real < 0 else ""
        sentence = f"expected {ratio_text(real)}{loosely} = {why}, got {stated:g}"
        raise scene.refuse(("moves", move, "ratio"), sentence)


def trains_of(scene: Scene, layout: Layout) -> tuple[Train, ...]:
    """The scene's trains.

    Raises:
        SceneError: a train that does not connect, or whose motor is not the first of its shafts.
    """
    return tuple(_train(scene, name, move, layout) for name, move in scene.moves.items() if isinstance(move, TrainSpec))


def _train(scene: Scene, name: str, move: TrainSpec, layout: Layout) -> Train:
    for field in ("driven", "output", "held"):
        shaft = getattr(move, field) or move.driven
        if shaft not in layout.root_of:
            raise scene.refuse(("moves", name, field), f"expected a shaft that some move turns, got {shaft!r}")
    if link := layout.driving.get(move.driven):
        raise scene.refuse(
            ("moves", name, "driven"),
            f"two drivers: expected the shaft that the motor turns and no other, got {move.driven!r}, which "
            f"{link.driver!r} drives in {link.name!r}; the first shaft there is {layout.root_of[move.driven]!r}",
        )
    for field in ("output", "held"):
        shaft = getattr(move, field) or move.driven
        if layout.root_of[shaft] != move.driven:
            reached = [s for s, root in layout.root_of.items() if root == move.driven]
            root = layout.root_of[shaft]
            raise scene.refuse(
                ("moves", name, field),
                f"the train does not connect: from {move.driven!r} one gets to {', '.join(map(repr, reached))}; "
                f"{'nothing drives ' + repr(shaft) if root == shaft else f'{shaft!r} is driven from {root!r}'}",
            )
    for field in ("output", "held"):
        refuse_incomparable(scene, ("moves", name, field), layout, move.driven, getattr(move, field) or move.driven)
    return Train(
        name=name,
        driven=move.driven,
        output=move.output,
        held=move.held or move.driven,
        gravity=None if move.gravity is None else (move.gravity[0], move.gravity[1], move.gravity[2]),
        sense=1 if move.turns == "counter_clockwise" else -1,
    )


def refuse_incomparable(scene: Scene, path: KeyPath, layout: Layout, first: str, last: str) -> None:
    """Refuse a shaft with load paths that cannot be compared: carriers turn in them, or there are too many.

    Raises:
        SceneError: at the path.
    """
    try:
        layout.load_path(first, last)
    except GeometryError as error:
        raise scene.refuse(path, f"expected a shaft whose load paths can be compared, got {last!r}: {error}") from None


def loose_gears(scene: Scene) -> Iterator[str]:
    """Gears that take part in no mesh."""
    for name, part in scene.parts.items():
        if isinstance(part, GearSpec) and not meshes_of(name, scene.moves):
            yield name


# which flank works ----------------------------------------------------------------------------------


def loaded_flank(mesh: Mesh, train: Train, layout: Layout, arms: Sequence[Arm], angle: float = 0.0) -> Flank:
    """The driver's flank that works in a mesh: by gravity at an angle of the output [rad], or by the motor's sense.

    A shaft that gravity turns one way is held by its driver as if that drove it the other way; a driver that turns
    counter-clockwise about its own z pushes with its left flank.
    """
    torque = gravity_torque(train, layout, arms, angle)
    shaft, carried = layout.carrying[mesh.driver]
    output = layout.shaft_turn[train.output].rate
    pushed = train.sense * output if not torque else -math.copysign(1.0, torque)  # the way that the driver pushes it
    through = layout.turn_by(shaft, train.output) or layout.shaft_turn[shaft].rate / output  # none: of a branch
    return LEFT if carried.sense * pushed * through > 0.0 else RIGHT


def gravity_torque(train: Train, layout: Layout, arms: Sequence[Arm], angle: float) -> float | None:
    """Torque of gravity on the arms of a train's output about its z, the output turned [rad]; None where there is none.

    Per weight [mm]; arms that are several count alike.
    """
    hanging = [arm for arm in arms if arm.on == train.output]
    if train.gravity is None or not hanging:
        return None
    x, y, z = layout.world_from_shaft[train.output][:3, :3].T @ np.array(train.gravity)
    reach = max(float(np.hypot(px, py)) for arm in hanging for _, (px, py, _) in arm.points)
    torque = sum(arm.torque((x, y, z), angle) for arm in hanging)
    return 0.0 if abs(torque) < NO_TORQUE * reach else torque
