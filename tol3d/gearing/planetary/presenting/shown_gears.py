"""A build of a planetary set as it is shown, exported and moved: all gears in one world, and an arm to each planet."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Final

import numpy as np
from typing_extensions import override

from tol3d.cad.solids import PosedBody
from tol3d.cad.solids.posed_gear import ArmBody
from tol3d.errors import InputError
from tol3d.gearing.links import LinkTrials, StatedLink
from tol3d.gearing.planetary.exact.flank_gaps import flank_gaps
from tol3d.gearing.planetary.exact.shown import MovedSet, ShownSet, opened, shaft_turn, swung, turned
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.set_link import SetLink
from tol3d.gearing.presenting.shown_train import ShownLink
from tol3d.gearing.presenting.whole_trains import gear_body, plain_body
from tol3d.gearing.reducers.shown import SWING, TURN, Moves, ReducerDisplay, from_front, world_from_middle
from tol3d.gears import LEFT, SpurGear
from tol3d.numerics.arrays import Array
from tol3d.numerics.plane import upright_pose
from tol3d.report.body import Body, World
from tol3d.report.motion import FRONT, Frame, Look, Mark, Shot

PIN: Final = 0.7  # of the smallest bore of a planet
BELOW: Final = 0.75  # of a pin's diameter, from the lowest face to the axis of an arm
FORWARD_ARM, BACKWARD_ARM, RIGID_ARM = "#7FB2D9", "#8CC5A2", "#B0B8C0"


def arms_of(shown: ShownSet) -> Iterator[Body]:
    """One a planet; none where a gear of the planets has no bore, or lies where it is not known."""
    own = shown.own
    gears = [gear for gear in shown.gears[len(own.meshes) :] if isinstance(gear.gear, SpurGear)]
    bores = [gear.gear.bore for gear in gears if isinstance(gear.gear, SpurGear)]
    diameter = PIN * min(bores, default=0.0)
    if not diameter:
        return
    faces = [(gear.world_from_gear[2, 3], gear.gear.face_width / 2) for gear in gears]
    low, high = min(at - half for at, half in faces), max(at + half for at, half in faces)
    level = low - BELOW * diameter
    shape = ArmBody(((own.centre_distance, 0.0, 0.0), (own.centre_distance, 0.0, high - level)), diameter)
    for planet, pin in enumerate(shown.pins):
        senses = [spring.sense(planet) for spring in own.springs if spring.sense(planet)]
        colour = RIGID_ARM if not senses else FORWARD_ARM if senses[0] > 0 else BACKWARD_ARM
        yield plain_body(PosedBody(arm_name(own, planet), shape, arm_pose(pin, level)), colour)


def arm_name(planetary_set: PlanetarySet, planet: int) -> str:
    """Name of the part of the carrier that holds a planet, counted from 0."""
    return f"{planetary_set.carrier} at planet {planet + 1}"


def arm_pose(pin: Array, level: float) -> Array:
    """Pose of an arm from its pin's axis (2,) [mm], as far as it turns about the common axis."""
    return upright_pose(math.atan2(pin[1], pin[0]), level=level)


OPENING: Final = "opening"
AHEAD, BEHIND = "touches ahead, counter-clockwise", "touches behind, clockwise"
TOUCHING: Final = 1e-6  # mm; contacts are found to some 1e-9
TEETH_HIGH: Final = 2.4  # modules from the middle of the teeth in mesh to the upper edge
MOST_CLOSE_UPS: Final = 3
CENTRALS, FORWARD, BACKWARD, PLANETS = "#E69F00", "#4682B4", "#009E73", "#4682B4"


@dataclass(frozen=True, eq=False)
class PlanetaryDisplay(ReducerDisplay):
    """A build of a set: every gear, and the carrier where its pins fit in bores."""

    words: ClassVar[str] = "a planetary set"
    colours: ClassVar[Mapping[str, str]] = {AHEAD: "#B0127B", BEHIND: "#101060"}

    shown: ShownSet

    @property
    @override
    def bodies(self) -> tuple[Body, ...]:
        return (*bodies_of(self.shown), *arms_of(self.shown))

    @property
    def moves(self) -> Moves:
        """See ReducerDisplay; a flexible carrier opens."""
        opening = {OPENING: (opened, 24)} if self.shown.own.springs else {}
        return {**opening, TURN: (turned, 72), SWING: (swung, 16)}

    @override
    def frames(self, states: Sequence[MovedSet], name: str) -> Iterator[Frame]:
        own = self.shown.own
        levels = {body.name: float(body.world_from_part[2, 3]) for body in self.seen.bodies}
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

    @override
    def shots(self, states: Sequence[MovedSet], name: str) -> Iterator[Shot]:
        return _steps(self.shown, self.seen) if name == TURN else _close_ups(self.shown, self.seen)


def _caption(planetary_set: PlanetarySet, state: MovedSet, states: Sequence[MovedSet], name: str) -> str:
    if name == TURN:
        turns = (
            math.degrees(shaft_turn(planetary_set, state, shaft) - shaft_turn(planetary_set, states[0], shaft))
            for shaft in _ends(planetary_set)
        )
        return ", ".join(f"{shaft} {turn:.2f}°" for shaft, turn in zip(_ends(planetary_set), turns, strict=True))
    arcmin = math.degrees(state.free) * 60
    if name == SWING:
        at = (
            math.degrees(
                shaft_turn(planetary_set, state, planetary_set.output)
                - shaft_turn(planetary_set, states[0], planetary_set.output)
            )
            * 60
        )
        return f"{planetary_set.input} held, {planetary_set.output} at {at:.2f} of {arcmin:.2f} arcmin"
    apart = 1000 * state.at[len(planetary_set.shafts) + planetary_set.planets :]
    micrometres = " and ".join(f"{each:.1f}" for each in apart)
    return f"planets displaced by {micrometres} µm, {planetary_set.output} free by {arcmin:.2f} arcmin"


def _ends(planetary_set: PlanetarySet) -> tuple[str, str]:
    return planetary_set.input, planetary_set.output


# from where it is seen ----------------------------------------------------------------------------


def _steps(shown: ShownSet, world: World) -> Iterator[Shot]:
    """All gears from the front, then the meshes of each gear of the planets."""
    everything = from_front(world)
    yield Shot("from the front", (everything,))
    own = shown.own
    if len(own.gears) > 1:
        for gear in own.gears:
            bodies = [mesh.central.name for mesh in own.meshes if mesh.planet.name == gear.name]
            bodies += [f"{gear.name} of planet {k + 1}" for k in range(own.planets)]
            yield Shot(f"{gear.name} and what it meshes with", (everything,), tuple(bodies))


def _close_ups(shown: ShownSet, world: World) -> Iterator[Shot]:
    """All gears from the front, then the teeth of the last mesh of neighbouring planets, upwards what is outwards."""
    yield Shot("from the front", (from_front(world),))
    own = shown.own
    found = [gap for gap in flank_gaps(own, shown.gears) if gap.mesh == len(own.meshes) - 1]
    for k in range(min(own.planets, MOST_CLOSE_UPS if own.planets > 2 else own.planets)):
        both = [gap for gap in found if gap.planet == k]
        middle = np.mean([gap.point for gap in both], axis=0)
        radial = np.array([*middle[:2], 0.0]) / np.hypot(*middle[:2])
        look = Look(middle, TEETH_HIGH * own.meshes[-1].central.module, FRONT, radial)
        yield Shot(f"{both[0].bodies[0]} and {both[0].bodies[1]}", (look,), both[0].bodies)


def bodies_of(shown: ShownSet) -> tuple[Body, ...]:
    """Every gear of a set, central gears and planets in their colours, planets by how springs push them."""
    own, colours = shown.own, [CENTRALS] * len(shown.own.meshes)
    for planet in range(own.planets):
        pushed = [spring.sense(planet) for spring in own.springs if spring.sense(planet)]
        colours += [BACKWARD if pushed and pushed[0] < 0 else FORWARD if pushed else PLANETS] * len(own.gears)
    return tuple(gear_body(gear, colour) for gear, colour in zip(shown.gears, colours, strict=True))


def shown_link(link: StatedLink, seen: LinkTrials, world_from_driver: Array) -> ShownLink:
    """A set in the world of its train; see ShowsLinks."""
    assert isinstance(link, SetLink)
    shown, into = link.shown(seen), world_from_middle(link, world_from_driver)
    gears = tuple(replace(gear, world_from_gear=into @ gear.world_from_gear) for gear in shown.gears)
    note = f"{link.name} jams; shown where no backlash would have its gears" if shown.status else ""
    return ShownLink(bodies_of(replace(shown, gears=gears)), note)


def display_of(label: str, shown: ShownSet, notes: tuple[str, ...]) -> PlanetaryDisplay:
    """A build under a label, with notes if it is magnified.

    Raises:
        InputError: a magnification with which it jams.
    """
    if shown.status and notes:
        raise InputError(f"magnify: {label.rpartition('-x')[0]} jams with its {notes[0]}; take less")
    jams = (f"{label} jams; shown where no backlash would have its gears",) if shown.status else ()
    return PlanetaryDisplay(label, shown, (*notes, *jams))
