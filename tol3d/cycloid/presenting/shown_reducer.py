"""A build of an RV reducer as it is shown, exported and moved: discs among their pins, where the first pin touches."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from importlib import import_module
from typing import Any, Final

import numpy as np

from tol3d.cycloid.exact.places import StagePlaces
from tol3d.cycloid.reducer.rv_set import RVSet
from tol3d.cycloid.reducer.shown import SeatedReducer, ShownReducer, carrier_angles, swung, turned
from tol3d.cycloid.rv_link import RVLink
from tol3d.errors import InputError
from tol3d.gearing.links import LinkTrials, StatedLink
from tol3d.gearing.presenting.shown_train import ShownLink
from tol3d.gearing.presenting.whole_trains import gear_body
from tol3d.gearing.shown.display import magnified_of
from tol3d.gearing.shown.placed import PlacedGear
from tol3d.numerics.arrays import Array
from tol3d.reducers.shown import from_front, world_from_middle
from tol3d.report.body import Body, Surface, World, built_body
from tol3d.report.motion import FRONT, Frame, Look, Mark, Motion, Shot
from tol3d.report.presenter import View, Which
from tol3d.runs.run import Run
from tol3d.solids import PosedGear, PosedPart, PosedShape
from tol3d.study.replaying import Replay

TURN, SWING = "turn", "swing"
MOTIONS: Final = (TURN, SWING)
FRAMES: Final[Mapping[str, int]] = {TURN: 48, SWING: 16}
TOUCHES: Final = "first contact"
MARK_COLOURS: Final = {TOUCHES: "#B0127B"}
CLOSE: Final = 2.5  # pin radii from the contact to the upper edge of the picture


def motion(shown: ShownReducer, world: World, name: str, frames: int | None) -> Motion:
    """One of MOTIONS.

    Args:
        world: its parts, all pins as one body.
        frames: their number; None: FRAMES.

    Raises:
        InputError: no pin touches.
    """
    states = (turned if name == TURN else swung)(shown, frames or FRAMES[name])
    made = tuple(_frames(shown, states, name))
    return Motion(world, made, tuple(_shots(shown, world, states)), MARK_COLOURS, back=name == SWING)


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
    """Contacts in words; between the ends of a swing there are none, or both sides overlap (below 0)."""
    if state.touching is not None:
        disc, pin = state.touching
        return f"disc {disc + 1} touches pin {pin + 1}"
    return "lobes and pins overlap" if angle < 0.0 else "no pin touches"


def _shots(shown: ShownReducer, world: World, states: Sequence[SeatedReducer]) -> Iterator[Shot]:
    """Each disc among the pins with its cranks; then the contacts, close up."""
    everything = from_front(world)
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


DEFLECTION: Final = 0.02  # mm; of triangles off round surfaces
TITLE_SIZE: Final = 13
COLOURS: Final = {"ring": "#A4ACB5", "pin": "#6B747E", "carrier": "#8CC5A2", "crank": "#E39B86", "sun": "#B7A3D6"}
PLANET_COLOUR: Final = "#D9A5C3"
DISC_COLOURS: Final = ("#4682B4", "#E69F00", "#009E73", "#CC79A7")
PINS: Final = "pins"


@dataclass(frozen=True, eq=False)
class RVDisplay:
    """A build of a reducer; see `tol3d.report.presenter.Display`."""

    label: str
    shown: ShownReducer
    notes: tuple[str, ...] = ()

    motions = MOTIONS

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """One world with every part."""
        parts = self.shown.shapes.placed(self.shown.seated.places)
        return (World(self.shown.own.name, tuple(map(_body, parts))),)

    @cached_property
    def seen(self) -> World:
        """The same with all pins as one body, for pictures."""
        bodies = self.worlds[0].bodies
        pins = [body for body in bodies if _is_pin(body.name)]
        joined = Body(PINS, np.eye(4), partial(_joined, pins), None, COLOURS["pin"])
        return World(self.shown.own.name, (*(body for body in bodies if not _is_pin(body.name)), joined))

    def view(self, close_up: str | None) -> View:
        """All parts.

        Raises:
            InputError: a close-up was asked for.
        """
        if close_up is not None:
            raise InputError(f"--mesh: nothing of an RV reducer is shown close up, not {close_up[:80]!r}")
        return View((self._panel,))

    def _panel(self, plotter: Any, width_by_height: float) -> None:
        import_module("tol3d.report.whole").draw_whole(plotter, self.seen, width_by_height)
        import_module("tol3d.report.drawn_solids").add_title(plotter, self.label, TITLE_SIZE)

    def motion(self, name: str, frames: int | None) -> Motion:
        """See `tol3d.report.motion.Movable`."""
        return motion(self.shown, self.seen, name, frames)


def _is_pin(name: str) -> bool:
    return name.startswith("pin ") and name != "pin ring"


def _joined(bodies: list[Body]) -> Surface:
    """Bodies as one mesh in the world."""
    counts = np.cumsum([0, *(len(body.mesh[0]) for body in bodies)])
    triangles = [body.mesh[1] + first for body, first in zip(bodies, counts[:-1], strict=True)]
    return np.concatenate([body.mesh[0] for body in bodies]), np.concatenate(triangles)


def _body(part: PosedPart) -> Body:
    if isinstance(part, PosedGear):
        colour = COLOURS["sun"] if part.name == "sun" else PLANET_COLOUR
        return gear_body(PlacedGear(part.name, part.gear, part.world_from_part, 0.0, 1.0), colour)
    assert isinstance(part, PosedShape)
    kind, _, number = part.name.rpartition(" ")
    colour = DISC_COLOURS[(int(number) - 1) % len(DISC_COLOURS)] if kind == "disc" else COLOURS.get(kind or number, "")
    colour = COLOURS["ring"] if part.name == "pin ring" else colour
    return built_body(part.name, part.shape, part.world_from_part, colour, deflection=DEFLECTION)


# in trains ----------------------------------------------------------------------------------------


def shown_link(link: StatedLink, seen: LinkTrials, world_from_driver: Array) -> ShownLink:
    """A reducer in the world of its train, its load turning the output back; see ShowsLinks."""
    assert isinstance(link, RVLink)
    shown, note = link.shown(seen), ""
    try:
        places = shown.seated.places
    except InputError:
        note = f"{link.name}: no pin touches its discs; shown where no clearance would have them"
        places = StagePlaces(
            shown.own.contact, shown.deviated.stage, float(shown.own.crank_angles(np.array(shown.turns)))
        )
    into, names = world_from_middle(link, world_from_driver), _names(shown.own)
    placed = (replace(part, world_from_part=into @ part.world_from_part) for part in shown.shapes.placed(places))
    named = [(body.name, replace(body, name=names(body.name))) for body in map(_body, placed)]
    pins = [body for name, body in named if _is_pin(name)]
    joined = Body(f"pins of {shown.own.ring}", np.eye(4), partial(_joined, pins), None, COLOURS["pin"])
    others = (body for name, body in named if not _is_pin(name))
    return ShownLink(tuple(body for _, body in named), note, (*others, joined))


def _names(own: RVSet) -> Callable[[str], str]:
    """Names of bodies in a train, after the parts of the scene; several alike are numbered."""
    first = {} if own.first is None else {"sun": own.first.sun, "planet": own.first.planet}
    known = {"pin ring": own.ring, "carrier": own.carrier, "disc": own.disc, "crank": own.crankshaft, **first}

    def named(body: str) -> str:
        kind, _, number = body.rpartition(" ")
        if body in known:
            return known[body]
        return f"pin {number} of {own.ring}" if kind == "pin" else f"{known[kind]} {number}"

    return named


# builds -------------------------------------------------------------------------------------------


def display(run: Run, which: Which, *, magnify: float) -> RVDisplay:
    """A build of a run.

    Raises:
        InputError: no such build, or one that no pin touches.
    """
    label, seen, notes = magnified_of(run, which, magnify)
    return RVDisplay(label, seen.build, (*notes, *_left_out(seen.build)))


def replayed_display(seen: Replay, label: str) -> RVDisplay:
    """A build that was replayed, under a label."""
    return RVDisplay(label, seen.build, tuple(_left_out(seen.build)))


def _left_out(shown: ShownReducer) -> Iterator[str]:
    stage = shown.deviated.stage
    if stage.lobe_pitch.any() or stage.lobe_profile.any():
        yield "solids of discs have the nominal profile: errors of single lobes act, but are not drawn"
    if shown.own.plays:
        yield "bearings are drawn without play: discs and cranks where the first pin would touch"
    if shown.own.first is not None:
        yield "gears of the first stage are drawn without their deviations"
