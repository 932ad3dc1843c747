"""An RV reducer in motion, as frames: cranks turn and discs roll on their pins, or the output swings."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.shown import SeatedReducer, ShownReducer, carrier_angles, swung, turned
from tol3d.report.body import World
from tol3d.report.motion import Frame, Look, Mark, Motion, Shot, around

Array = NDArray[np.float64]

TURN, SWING = "turn", "swing"
MOTIONS: Final = (TURN, SWING)
FRAMES: Final[Mapping[str, int]] = {TURN: 48, SWING: 16}
TOUCHES: Final = "first contact"
COLOURS: Final = {TOUCHES: "#B0127B"}
FRONT, UP = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
CLOSE: Final = 2.5  # pin radii from the contact to the upper edge of the picture


def motion(shown: ShownReducer, world: World, name: str, frames: int | None) -> Motion:
    """One of MOTIONS.

    Args:
        shown: the reducer of a trial.
        world: its parts, all pins as one body.
        name: of the motion.
        frames: how many; None: FRAMES.

    Raises:
        InputError: no pin touches.
    """
    states = (turned if name == TURN else swung)(shown, frames or FRAMES[name])
    made = tuple(_frames(shown, states, name))
    return Motion(world, made, tuple(_shots(shown, world, states)), COLOURS, back=name == SWING)


def _frames(shown: ShownReducer, states: Sequence[SeatedReducer], name: str) -> Iterator[Frame]:
    still = {"sun"} if name == SWING else set()
    for state, angle in zip(states, carrier_angles(states), strict=True):
        parts = shown.shapes.placed(state.places)
        poses = {part.name: part.world_from_part for part in parts if part.name not in still}
        marks: tuple[Mark, ...] = ()
        if state.touching is not None and state.contact is not None:
            marks = (Mark(TOUCHES, np.array([*state.contact, 0.0]), (f"disc {state.touching[0] + 1}",)),)
        touched = touching_words(state, angle)
        if name == TURN:
            cranks = math.degrees(state.places.phi - states[0].places.phi)
            yield Frame(f"cranks {cranks:.1f}°, {shown.own.carrier} {angle:.3f}°, {touched}", poses, marks)
        else:
            yield Frame(f"input held, {shown.own.carrier} {3600 * angle:.2f} arcsec, {touched}", poses, marks)


def touching_words(state: SeatedReducer, angle: float) -> str:
    """What touches; between the ends of a swing nothing does, or both sides overlap where it goes back (below 0)."""
    if state.touching is not None:
        disc, pin = state.touching
        return f"disc {disc + 1} touches pin {pin + 1}"
    return "lobes and pins overlap" if angle < 0.0 else "no pin touches"


def _shots(shown: ShownReducer, world: World, states: Sequence[SeatedReducer]) -> Iterator[Shot]:
    """Each disc among the pins with its cranks; then what touches, close up."""
    points = np.concatenate([body.mesh[0] for body in world.bodies])
    everything = around(points, np.zeros(3), FRONT, UP)
    cranks = tuple(f"crank {number + 1}" for number in range(shown.own.cranks))
    discs = tuple(f"disc {number + 1}" for number in range(shown.own.discs))
    for disc in discs:
        yield Shot(disc, (everything,), ("pin ring", "pins", disc, *cranks))
    yield Shot("first contact", tuple(_close(shown, states)), ("pins", *discs))


def _close(shown: ShownReducer, states: Sequence[SeatedReducer]) -> Iterator[Look]:
    """At the contact of each state, upwards what is outwards, from the side of its disc; between contacts at the last.

    Discs lie above each other along the axis, the first one lowest.
    """
    last = states[0]
    for state in states:
        last = state if state.contact is not None else last
        assert last.contact is not None
        assert last.touching is not None
        middle = np.array([*last.contact, 0.0])
        towards = FRONT if 2 * last.touching[0] >= shown.own.discs - 1 else -FRONT
        yield Look(middle, CLOSE * shown.own.profile.pin_radius, towards, middle / np.linalg.norm(middle))
