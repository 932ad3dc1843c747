"""A build of an RV reducer as it is shown, exported and moved: discs among their pins, where the first pin touches."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import ClassVar, Final

import numpy as np
from typing_extensions import override

from tol3d.cad.solids import PosedGear, PosedPart, PosedShape
from tol3d.errors import InputError
from tol3d.gearing.cycloid.exact.places import StagePlaces
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.cycloid.reducer.shown import SeatedReducer, ShownReducer, carrier_angles, swung, turned
from tol3d.gearing.cycloid.rv_link import RVLink
from tol3d.gearing.links import LinkTrials, StatedLink
from tol3d.gearing.presenting.shown_train import ShownLink
from tol3d.gearing.presenting.whole_trains import gear_body
from tol3d.gearing.reducers.shown import SWING, TURN, Moves, ReducerDisplay, from_front, world_from_middle
from tol3d.gearing.shown.placed import PlacedGear
from tol3d.numerics.arrays import Array
from tol3d.report.body import Body, Surface, World, built_body
from tol3d.report.motion import FRONT, Frame, Look, Mark, Shot

TOUCHES: Final = "first contact"
CLOSE: Final = 2.5  # pin radii from the contact to the upper edge of the picture
DEFLECTION: Final = 0.02  # mm; of triangles off round surfaces
COLOURS: Final = {"ring": "#A4ACB5", "pin": "#6B747E", "carrier": "#8CC5A2", "crank": "#E39B86", "sun": "#B7A3D6"}
PLANET_COLOUR: Final = "#D9A5C3"
DISC_COLOURS: Final = ("#4682B4", "#E69F00", "#009E73", "#CC79A7")
PINS: Final = "pins"


@dataclass(frozen=True, eq=False)
class RVDisplay(ReducerDisplay):
    """A build of a reducer."""

    words: ClassVar[str] = "an RV reducer"
    colours: ClassVar[Mapping[str, str]] = {TOUCHES: "#B0127B"}
    moves: ClassVar[Moves] = {TURN: (turned, 48), SWING: (swung, 16)}

    shown: ShownReducer

    @property
    @override
    def bodies(self) -> tuple[Body, ...]:
        return tuple(map(_body, self.shown.shapes.placed(self.shown.seated.places)))

    @cached_property
    def seen(self) -> World:
        """See ReducerDisplay: all pins as one body."""
        bodies = self.worlds[0].bodies
        pins = [body for body in bodies if _is_pin(body.name)]
        joined = Body(PINS, np.eye(4), partial(_joined, pins), None, COLOURS["pin"])
        return World(self.shown.own.name, (*(body for body in bodies if not _is_pin(body.name)), joined))

    @override
    def frames(self, states: Sequence[SeatedReducer], name: str) -> Iterator[Frame]:
        shown, still = self.shown, {"sun"} if name == SWING else set()
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

    def shots(self, states: Sequence[SeatedReducer], name: str) -> Iterator[Shot]:
        """Each disc among the pins with its cranks; then the contacts, close up."""
        everything = from_front(self.seen)
        cranks = tuple(f"crank {number + 1}" for number in range(self.shown.own.cranks))
        discs = tuple(f"disc {number + 1}" for number in range(self.shown.own.discs))
        for disc in discs:
            yield Shot(disc, (everything,), ("pin ring", "pins", disc, *cranks))
        yield Shot("first contact", tuple(_close(self.shown, states)), ("pins", *discs))


def touching_words(state: SeatedReducer, angle: float) -> str:
    """Contacts in words; between the ends of a swing there are none, or both sides overlap (below 0)."""
    if state.touching is not None:
        disc, pin = state.touching
        return f"disc {disc + 1} touches pin {pin + 1}"
    return "lobes and pins overlap" if angle < 0.0 else "no pin touches"


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


def display_of(label: str, shown: ShownReducer, notes: tuple[str, ...]) -> RVDisplay:
    """A build under a label, with notes if it is magnified."""
    return RVDisplay(label, shown, (*notes, *_left_out(shown)))


def _left_out(shown: ShownReducer) -> Iterator[str]:
    stage = shown.deviated.stage
    if stage.lobe_pitch.any() or stage.lobe_profile.any():
        yield "solids of discs have the nominal profile: errors of single lobes act, but are not drawn"
    if shown.own.plays:
        yield "bearings are drawn without play: discs and cranks where the first pin would touch"
    if shown.own.first is not None:
        yield "gears of the first stage are drawn without their deviations"
