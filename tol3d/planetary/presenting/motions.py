"""A planetary set in motion, as frames: what turns, swings or opens, and which flanks touch."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.gears import LEFT
from tol3d.planetary.flank_gaps import flank_gaps
from tol3d.planetary.moved import MovedSet, opened, shaft_turn, swung, turned
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.presenting.arms import arm_name, arm_pose
from tol3d.planetary.shown import ShownSet
from tol3d.report.body import World
from tol3d.report.motion import Frame, Look, Mark, Motion, Shot, around

Array = NDArray[np.float64]

TURN, SWING, OPENING = "turn", "swing", "opening"
FRAMES: Final[Mapping[str, int]] = {TURN: 72, SWING: 16, OPENING: 24}
AHEAD, BEHIND = "touches ahead, counter-clockwise", "touches behind, clockwise"
COLOURS: Final = {AHEAD: "#B0127B", BEHIND: "#101060"}
TOUCHING: Final = 1e-6  # mm; contacts are found to some 1e-9
FRONT, UP = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
TEETH_HIGH: Final = 2.4  # modules from the middle of the teeth in mesh to the upper edge
MOST_CLOSE_UPS: Final = 3


def motions(own: PlanetarySet) -> tuple[str, ...]:
    """Names of the motions of a set."""
    return (OPENING, TURN, SWING) if own.springs else (TURN, SWING)


def motion(shown: ShownSet, world: World, name: str, frames: int | None) -> Motion:
    """One of them.

    Args:
        shown: the set of a trial.
        world: its gears as bodies.
        name: of the motion.
        frames: how many; None: FRAMES.

    Raises:
        InputError: the set jams, or its carrier does not open.
    """
    if shown.status:
        raise InputError("the set jams, so that nothing of it moves; choose another trial")
    states = {TURN: turned, SWING: swung, OPENING: opened}[name](shown, frames or FRAMES[name])
    pictures = _steps(shown, world) if name == TURN else _close_ups(shown, world)
    return Motion(world, tuple(_frames(shown, world, states, name)), tuple(pictures), COLOURS, back=name != TURN)


def _frames(shown: ShownSet, world: World, states: Sequence[MovedSet], name: str) -> Iterator[Frame]:
    own = shown.own
    levels = {body.name: float(body.world_from_part[2, 3]) for body in world.bodies}
    for state in states:
        poses = {gear.name: gear.world_from_gear for gear in state.gears}
        arms = ((arm_name(own, planet), pin) for planet, pin in enumerate(state.pins))
        poses |= {name: arm_pose(pin, levels[name]) for name, pin in arms if name in levels}
        marks = tuple(
            Mark(AHEAD if gap.flank == LEFT else BEHIND, gap.point, gap.bodies)
            for gap in flank_gaps(own, state.gears)
            if gap.value < TOUCHING
        )
        yield Frame(_caption(own, state, states, name), poses, marks)


def _caption(own: PlanetarySet, state: MovedSet, states: Sequence[MovedSet], name: str) -> str:
    if name == TURN:
        turns = (
            math.degrees(shaft_turn(own, state, shaft) - shaft_turn(own, states[0], shaft)) for shaft in _ends(own)
        )
        return ", ".join(f"{shaft} {turn:.2f}°" for shaft, turn in zip(_ends(own), turns, strict=True))
    arcmin = math.degrees(state.free) * 60
    if name == SWING:
        at = math.degrees(shaft_turn(own, state, own.output) - shaft_turn(own, states[0], own.output)) * 60
        return f"{own.input} held, {own.output} at {at:.2f} of {arcmin:.2f} arcmin"
    apart = 1000 * state.at[len(own.shafts) + own.planets :]
    micrometres = " and ".join(f"{each:.1f}" for each in apart)
    return f"planets displaced by {micrometres} µm, {own.output} free by {arcmin:.2f} arcmin"


def _ends(own: PlanetarySet) -> tuple[str, str]:
    return own.input, own.output


# from where it is seen ----------------------------------------------------------------------------


def _steps(shown: ShownSet, world: World) -> Iterator[Shot]:
    """All gears from the front, then the meshes of each gear of the planets."""
    everything = _front(world)
    yield Shot("from the front", (everything,))
    own = shown.own
    if len(own.gears) > 1:
        for gear in own.gears:
            bodies = [mesh.central.name for mesh in own.meshes if mesh.planet.name == gear.name]
            bodies += [f"{gear.name} of planet {k + 1}" for k in range(own.planets)]
            yield Shot(f"{gear.name} and what it meshes with", (everything,), tuple(bodies))


def _close_ups(shown: ShownSet, world: World) -> Iterator[Shot]:
    """All gears from the front, then the teeth of the last mesh of neighbouring planets, upwards what is outwards."""
    yield Shot("from the front", (_front(world),))
    own = shown.own
    found = [gap for gap in flank_gaps(own, shown.gears) if gap.mesh == len(own.meshes) - 1]
    for k in range(min(own.planets, MOST_CLOSE_UPS if own.planets > 2 else own.planets)):
        both = [gap for gap in found if gap.planet == k]
        middle = np.mean([gap.point for gap in both], axis=0)
        radial = np.array([*middle[:2], 0.0]) / np.hypot(*middle[:2])
        look = Look(middle, TEETH_HIGH * own.meshes[-1].central.module, FRONT, radial)
        yield Shot(f"{both[0].bodies[0]} and {both[0].bodies[1]}", (look,), both[0].bodies)


def _front(world: World) -> Look:
    return around(np.concatenate([body.mesh[0] for body in world.bodies]), np.zeros(3), FRONT, UP)
