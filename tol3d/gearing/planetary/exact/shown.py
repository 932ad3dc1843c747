"""A set as it stands in one trial, and moved: turned in contact, swung through its play, or opened by its carrier."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tol3d.errors import InputError
from tol3d.gearing.model.pairs import cylindrical_gear
from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.exact.flank_gaps import flank_gaps
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.shown.placed import PlacedGear
from tol3d.gears import LEFT, RIGHT, InternalGear, SpurGear
from tol3d.numerics.arrays import Array
from tol3d.numerics.plane import upright_pose
from tol3d.scene import Scene

Made = Mapping[str, SpurGear | InternalGear]
"""Nominal gears by their names."""

BETWEEN = 0.2  # of a face width; free room between gears of a planet along the axis


@dataclass(frozen=True, eq=False)
class ShownSet:
    """Gears of a set, the output turned as far as it goes counter-clockwise; nominal where the set jams.

    Args:
        gears: central gears, then those of each planet.
        status: 0 where it seats; see tol3d.numerics.programme.
        made: its gears by name, nominal.
        deviated: of one trial.
        turns: of the output.
        pins: axes of the planets (2,) [mm].
    """

    own: PlanetarySet
    gears: tuple[PlacedGear, ...]
    status: int
    made: Made
    deviated: Deviated
    turns: float
    pins: tuple[Array, ...]


def shown_set(planetary_set: PlanetarySet, made: Made, deviated: Deviated, turns: float) -> ShownSet:
    """A set of one trial at some turns of its output.

    Args:
        made: its gears by name, nominal.
        deviated: of one trial.
        turns: of the output.
    """
    free, reached = Contact(planetary_set).seated(
        deviated, np.array([turns]), planetary_set.output, planetary_set.opposite(planetary_set.output)
    )
    at = np.nan_to_num(reached[0, 1])
    gears, pins = (
        placed_gears(planetary_set, made, deviated, turns, at),
        placed_pins(planetary_set, deviated, turns, at),
    )
    return ShownSet(planetary_set, gears, int(free.status[0]), made, deviated, turns, pins)


def placed_pins(planetary_set: PlanetarySet, deviated: Deviated, turns: float, at: Array) -> tuple[Array, ...]:
    """Axes of the planets (2,) [mm]; arguments as of placed_gears."""
    count, carrier, pins = len(planetary_set.meshes), _carrier_angle(planetary_set, turns), []
    for k in range(planetary_set.planets):
        pushed = sum(
            at[count + 1 + planetary_set.planets + j] * spring.sense(k)
            for j, spring in enumerate(planetary_set.springs)
        )
        arm = carrier + planetary_set.azimuths[k] + at[count] + pushed / planetary_set.centre_distance
        pins.append(
            _turned(np.array([planetary_set.centre_distance + deviated.pins[0, k, 0], deviated.pins[0, k, 1]]), arm)
        )
    return tuple(pins)


def _carrier_angle(planetary_set: PlanetarySet, turns: float) -> float:
    return -2 * math.pi * float(planetary_set.turn(planetary_set.held) * planetary_set.planet_turns) * turns


def placed_gears(
    planetary_set: PlanetarySet, made: Made, deviated: Deviated, turns: float, at: Array
) -> tuple[PlacedGear, ...]:
    """Central gears, then those of each planet, where they stand.

    Args:
        own, made, deviated, turns: see shown_set.
        at: turns of shafts and planets [rad] and displacements by springs [mm], beyond where no backlash would have
            them.
    """
    carrier, heights, count = (
        _carrier_angle(planetary_set, turns),
        _heights(planetary_set, made),
        len(planetary_set.meshes),
    )
    found = []
    for m, mesh in enumerate(planetary_set.meshes):
        angle = (
            carrier + 2 * math.pi * float(planetary_set.turn(mesh.central.name) * planetary_set.planet_turns) * turns
        )
        angle += at[m] + deviated.central_clocking[0, m]
        place = _turned(deviated.central_offset[0, m], angle) - _turned(deviated.aside[0, m], carrier)
        thick = deviated.central_thickness[0, m] / (mesh.central.module * mesh.central.teeth)
        pose = upright_pose(angle + mesh.facing, place, heights[planetary_set.gear_of(mesh)])
        found.append(PlacedGear(mesh.central.name, made[mesh.central.name], pose, float(thick), 1.0))
    for k, pin in enumerate(placed_pins(planetary_set, deviated, turns, at)):
        for g, gear in enumerate(
            planetary_set.gears
        ):  # tooth 0 of the first planet's points outwards where nothing has turned
            angle = (
                carrier
                + 2 * math.pi * float(planetary_set.planet_turns) * turns
                + planetary_set.azimuths[k]
                + planetary_set.phase(k)
            )
            angle += at[count + 1 + k] + deviated.planet_clocking[0, g, k]
            place = pin + _turned(deviated.planet_offset[0, g, k], angle)
            thick = deviated.planet_thickness[0, g, k] / (gear.module * gear.teeth)
            pose = upright_pose(angle, place, heights[g])
            found.append(PlacedGear(f"{gear.name} of planet {k + 1}", made[gear.name], pose, float(thick), 1.0))
    return tuple(_slid(planetary_set, deviated, found) if deviated.planet_slide.any() else found)


def _slid(own: PlanetarySet, deviated: Deviated, gears: Sequence[PlacedGear]) -> Iterator[PlacedGear]:
    """The gears, planets shifted along their pins to the middle of the mesh that opens as they slide, or towards it."""
    yield from gears[: len(own.meshes)]
    gaps = {(gap.planet, gap.mesh, gap.flank): gap.value for gap in flank_gaps(own, gears)}
    for k, play in enumerate(deviated.planet_slide[0].tolist()):
        shift = 0.0
        for m in own.unlike_leads:
            off = (gaps[k, m, LEFT] - gaps[k, m, RIGHT]) / 2 / own.meshes[m].central.base_helix_cosine
            shift = min(max(off / own.planet_slides[m], -play / 2), play / 2)
        screwed = upright_pose(own.planet_twist * shift, level=shift)
        first = len(own.meshes) + k * len(own.gears)
        for gear in gears[first : first + len(own.gears)]:
            yield replace(gear, world_from_gear=gear.world_from_gear @ screwed)


def made_gears(scene: Scene, planetary_set: PlanetarySet) -> Made:
    """The gears of a set, nominal."""
    return {gear.name: cylindrical_gear(scene, gear.name) for gear in planetary_set.all_gears}


def heights_of(planetary_set: PlanetarySet, made: Made) -> Mapping[str, float]:
    """Height of the middle of each central gear's face along the axis of a set [mm]; 0 for the carrier."""
    heights = _heights(planetary_set, made)
    return {mesh.central.name: heights[planetary_set.gear_of(mesh)] for mesh in planetary_set.meshes} | {
        planetary_set.carrier: 0.0
    }


def _heights(planetary_set: PlanetarySet, made: Made) -> list[float]:
    """Middles of the faces of a planet's gears along the axis [mm]; the first lies at 0."""
    heights, above = [], 0.0
    for k, gear in enumerate(planetary_set.gears):
        width = made[gear.name].face_width
        heights.append(above + width / 2 if k else 0.0)
        above = heights[-1] + width * (0.5 + BETWEEN)
    return heights


def _turned(vector: Array, angle: float) -> Array:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([cos * vector[0] - sin * vector[1], sin * vector[0] + cos * vector[1]])


LOW, HIGH = 0, 1
"""Ends of a shaft's turn, clockwise and counter-clockwise."""


@dataclass(frozen=True, eq=False)
class MovedSet:
    """A set at one moment.

    Args:
        gears: central gears, then those of each planet.
        pins: axes of the planets (2,) [mm].
        turns: of the output, beyond where the trial has it, where no backlash would have it.
        at: turns of shafts and planets [rad] beyond that, and displacements by springs [mm].
        free: turn of the output with the input held [rad], at this displacement.
    """

    gears: tuple[PlacedGear, ...]
    pins: tuple[Array, ...]
    turns: float
    at: Array
    free: float


def turned(shown: ShownSet, frames: int) -> tuple[MovedSet, ...]:
    """The input turns counter-clockwise and the output follows in contact, its load resisting.

    Planets go as far as from their place to the next, or turn once where the carrier stands.
    """
    own = shown.own
    carrier = -float(own.turn(own.held) * own.planet_turns)  # turns a turn of the output
    way = 1 / (own.planets * abs(carrier)) if carrier else 1 / abs(float(own.planet_turns))
    sense = 1.0 if own.ratio > 0 else -1.0
    beyond = sense * way * np.linspace(0.0, 1.0, frames)
    ends, reached = _seated(own, shown.deviated, shown.turns + beyond)
    behind = LOW if sense > 0.0 else HIGH
    return tuple(
        _state(shown, own, float(turns), at[behind], end) for turns, at, end in zip(beyond, reached, ends, strict=True)
    )


def swung(shown: ShownSet, frames: int) -> tuple[MovedSet, ...]:
    """The output goes from its clockwise to its counter-clockwise end with the input held.

    Between both ends every coordinate goes evenly: contacts are linear in them but for some thousandths.
    """
    ends, reached = _seated(shown.own, shown.deviated, np.array([shown.turns]))
    between = np.linspace(0.0, 1.0, frames)[:, None]
    way = (1 - between) * reached[0, LOW] + between * reached[0, HIGH]
    return tuple(_state(shown, shown.own, 0.0, at, ends[0]) for at in way)


def opened(shown: ShownSet, frames: int) -> tuple[MovedSet, ...]:
    """The flexible carrier turns its planets apart, from 0 to where its springs hold them; the output at its end.

    Args:
        shown: a set with springs.

    Raises:
        InputError: springs do not open it.
    """
    first = len(shown.own.shafts) + shown.own.planets
    _, reached = _seated(shown.own, shown.deviated, np.array([shown.turns]))
    last = reached[0, HIGH, first:]
    if not (last > 0.0).all():
        raise InputError("the carrier does not open: no spring finds room to push the planets apart")
    states = []
    for share in np.linspace(0.0, 1.0, frames)[:-1]:
        own = displaced(shown.own, share * last)
        ends, reached = _seated(own, shown.deviated, np.array([shown.turns]))
        states.append(_state(shown, own, 0.0, reached[0, HIGH], ends[0]))
    ends, reached = _seated(shown.own, shown.deviated, np.array([shown.turns]))
    return (*states, _state(shown, shown.own, 0.0, reached[0, HIGH], ends[0]))


def displaced(planetary_set: PlanetarySet, displacements: Sequence[float] | Array) -> PlanetarySet:
    """The set with each of its springs set to a displacement [mm]."""
    springs = zip(planetary_set.springs, displacements, strict=True)
    return replace(planetary_set, springs=tuple(replace(spring, displacement=float(at)) for spring, at in springs))


def _seated(planetary_set: PlanetarySet, deviated: Deviated, turns: Array) -> tuple[Array, Array]:
    """Ends of the output's turn (positions, 2) [rad] and all coordinates there (positions, 2, coordinates).

    Raises:
        InputError: the set jams.
    """
    free, reached = Contact(planetary_set).seated(
        deviated[np.zeros(len(turns), dtype=np.int64)],
        turns,
        planetary_set.output,
        planetary_set.opposite(planetary_set.output),
    )
    if free.status.any():
        raise InputError("the set jams, so that nothing of it moves; choose another trial")
    return free.ends, reached


def _state(shown: ShownSet, planetary_set: PlanetarySet, beyond: float, at: Array, ends: Array) -> MovedSet:
    gears = placed_gears(planetary_set, shown.made, shown.deviated, shown.turns + beyond, at)
    pins = placed_pins(planetary_set, shown.deviated, shown.turns + beyond, at)
    return MovedSet(gears, pins, beyond, at, float(ends[1] - ends[0]))


def shaft_turn(planetary_set: PlanetarySet, state: MovedSet, shaft: str) -> float:
    """Turn of a shaft [rad], counted from its position without backlash in the trial."""
    rate = float((planetary_set.turn(shaft) - planetary_set.turn(planetary_set.held)) * planetary_set.planet_turns)
    return 2 * math.pi * rate * state.turns + float(state.at[planetary_set.shafts.index(shaft)])
