"""Parts, moves and measures of a gearbox as entries of a scene."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from tol3d.apps.drafting.entry import Entry, Wording
from tol3d.apps.drafting.rexs.gearbox import Bearing, Gear, Gearbox, PlanetarySet, Shaft, Stage, counted
from tol3d.apps.drafting.rexs.kinematics import CARRIER, Drive, Link, Mounting
from tol3d.apps.drafting.rexs.limits import um
from tol3d.apps.drafting.rexs.named import Named
from tol3d.apps.drafting.words import comment, length, number, scalar

GUESSED_WIDTH: Final = 10.0  # modules, of faces whose width no file says
MOST_BEARINGS: Final = 2  # of a shaft: by a third it would be bent
DIGITS_OF_SHIFT: Final = 9
STEP_OF_SHIFT: Final = 1e-9
DIGITS: Final = 6  # of factors and degrees, as gear programs print them


def degrees(angle: float) -> str:
    """An angle [rad] in degrees, of half a turn the positive one."""
    value = round(math.degrees(angle), DIGITS)
    return f"{number(180.0 if value == -180.0 else value)} deg"


def chosen_bearings(gearbox: Gearbox, shafts: Sequence[Shaft]) -> tuple[list[Bearing], list[str]]:
    """Bearings that are parts of the scene, of its shafts, and a line on the others."""
    in_sets = {gear.id for own in gearbox.sets for mesh in own.meshes for gear in mesh}
    carriers = {own.carrier.ids[0] for own in gearbox.sets}
    on_shaft: dict[int, list[Bearing]] = {}
    for bearing in gearbox.bearings:
        if bearing.at is not None:
            on_shaft.setdefault(bearing.shaft, []).append(bearing)
    chosen = list[Bearing]()
    for shaft in shafts:
        if shaft.ids[0] not in carriers and not any(gear.id in in_sets for gear in shaft.gears):
            own = [bearing for each in shaft.ids for bearing in on_shaft.get(each, ())]
            chosen += sorted(own, key=lambda bearing: bearing.clearance is None)[:MOST_BEARINGS]
    ids = {own.id for own in chosen}
    others = [own.name or str(own.id) for own in gearbox.bearings if own.id not in ids]
    why = "on a shaft of a planetary stage or without gears, without a place, or a third one"
    return chosen, [f"{counted(others)} {why}: not drafted"] if others else []


def parts(
    gearbox: Gearbox, names: Named, places: Mounting, bearings: Sequence[Bearing], rounding: Mapping[int, float]
) -> Iterator[Entry]:
    """Shafts with what they carry, bearings, gears, planets and carriers.

    Args:
        gearbox: that they are of.
        names: of them.
        places: of shafts.
        bearings: those that are drafted.
        rounding: profile shift that gears have less of than in the file, by their ids.
    """
    for shaft in names.shafts:
        yield _part(names.of(shaft.ids[0]), _shaft(shaft, gearbox, names, places), f"shaft {shaft.ids[0]}")
    for bearing in bearings:
        shaft = next(own for own in names.shafts if bearing.shaft in own.ids)
        at = places.senses.get(shaft.ids[0], 1) * (shaft.offsets[bearing.shaft] + (bearing.at or 0.0))
        line = f"{{kind: bearing, shaft: {scalar(names.of(shaft.ids[0]))}, at: {length(at)}}}"
        yield _part(names.of(bearing.id), line, f"bearing {bearing.id}")
    gears = [gear for stage in gearbox.stages for gear in stage.gears]
    gears += [gear for own in gearbox.sets for mesh in own.meshes for gear in mesh]
    for gear in {own.id: own for own in gears}.values():
        told = [f"gear {gear.id}"]
        told += [f"guess: x {gear.shift_guess}"] if gear.shift_guess else []
        told += [] if gear.face_width else ["guess: face_width not in the file"]
        less = rounding.get(gear.id, 0.0)
        told += [f"x {number(gear.profile_shift or 0.0)} in the file, rounded: its teeth interfere"] if less else []
        yield _part(names.of(gear), _gear(gear, less), "; ".join(told))
    for own in gearbox.sets:
        planet = ", ".join(dict.fromkeys(scalar(names.of(gear)) for _, gear in own.meshes))
        yield _part(names.planets[own.id], f"{{kind: planet, gears: [{planet}]}}", f"{own.planets} of them")
        yield _part(names.carriers[own.id], "{kind: planet_carrier}", "")


def _part(name: str, line: str, told: str) -> Entry:
    return Entry("parts", scalar(name), [Wording((line,), comment(told, 200))])


def _shaft(shaft: Shaft, gearbox: Gearbox, names: Named, places: Mounting) -> str:
    """A shaft along the z of its drive's root; parts sit where the middle of their faces is."""
    sense = places.senses.get(shaft.ids[0], 1)
    carried = []
    for gear in shaft.gears:
        middle = sense * (shaft.offsets[gear.id] + (gear.start or 0.0) + _width(gear) / 2.0)
        carried.append(f"{scalar(names.of(gear))}: {'{}' if gear.start is None else f'{{at: {length(middle)}}}'}")
    carried += [f"{scalar(names.carriers[own.id])}: {{}}" for own in gearbox.sets if own.carrier.ids == shaft.ids]
    return f"{{kind: shaft, carries: {{{', '.join(carried)}}}}}"


def _width(gear: Gear) -> float:
    return gear.face_width or GUESSED_WIDTH * gear.module


def _gear(gear: Gear, less: float) -> str:
    """A gear, of so much less profile shift; a helical one has module and pressure angle in the normal section."""
    kind = "internal_gear" if gear.internal else "helical_gear" if gear.helical else "spur_gear"
    fields = {
        "kind": kind,
        "teeth": str(gear.teeth),
        "module": length(gear.module),
        "pressure_angle": degrees(gear.pressure_angle),
        "face_width": length(_width(gear)),
    }
    if gear.helical:
        fields |= {"helix_angle": degrees(abs(gear.helix_angle)), "hand": "right" if gear.helix_angle > 0.0 else "left"}
    shift = round((gear.profile_shift or 0.0) - less - (STEP_OF_SHIFT if less else 0.0), DIGITS_OF_SHIFT)
    if shift:
        fields["profile_shift"] = number(shift)
    if gear.addendum is not None and gear.addendum > 0.0:
        fields["addendum"] = number(round(gear.addendum, DIGITS))
    return "{" + ", ".join(f"{key}: {own}" for key, own in fields.items()) + "}"


@dataclass(frozen=True)
class Train:
    """A train of a drive.

    Args:
        name: of its move.
        driven, output: names of shafts, or of gears and carriers that are their own.
    """

    name: str
    driven: str
    output: str


def trains_of(drives: Sequence[tuple[Drive, Mounting]], gearbox: Gearbox, names: Named) -> Iterator[Train]:
    """A train to each output; a planetary stage alone has none, since its own move says its input and output."""
    for drive, _ in () if _is_set_alone(gearbox) else drives:
        for end in drive.outputs:
            start, last = drive.links[0], next(own for own in reversed(drive.links) if own.end == end)
            driven = names.part(drive.root, start.driver, start.cause)
            output = names.part(end, last.driven, last.cause)
            yield Train(names.titles.new(f"train to {output}", "train"), driven, output)


def moves(drives: Sequence[tuple[Drive, Mounting]], trains: Sequence[Train], names: Named) -> Iterator[Entry]:
    """Meshes and planetary stages from the driven shaft on, and a train to each output."""
    for drive, places in drives:
        for link in drive.links:
            cause = link.cause
            if isinstance(cause, Stage):
                yield _mesh(cause, link, places.azimuths, names, either=bool(trains))
            else:
                yield _set(cause, link, names)
    for train in trains:
        line = f"{{kind: train, driven: {scalar(train.driven)}, output: {scalar(train.output)}}}"
        yield Entry("moves", scalar(train.name), [Wording((line,))])


def _is_set_alone(gearbox: Gearbox) -> bool:
    return not gearbox.stages and len(gearbox.sets) == 1


def _mesh(stage: Stage, link: Link, azimuths: Mapping[int, float], names: Named, *, either: bool) -> Entry:
    """A mesh, on either flank where a train says which way the load is."""
    driver, driven = names.of(link.driver), names.of(link.driven)
    azimuth = degrees(azimuths[stage.id])
    words = [f"kind: mesh, driver: {scalar(driver)}, driven: {scalar(driven)}"]
    words.append(f"centre_distance: {length(stage.centre_distance)}")
    words += [f"azimuth: {azimuth}"] if azimuth != "0 deg" else []
    words += ["working_flank: either"] if either else []
    line = f"{{{', '.join(words)}}}"
    told = f"stage {stage.id}: {nominal(stage)} without tolerances"
    return Entry("moves", scalar(names.of(stage)), [Wording((line,), told)])


def nominal(stage: Stage) -> str:
    """Words on the backlash of the nominal gears."""
    backlash = stage.normal_backlash
    return "axes too near for any backlash" if backlash is None else f"normal backlash {um(round(backlash, 6))}"


def _set(own: PlanetarySet, link: Link, names: Named) -> Entry:
    def member(each: int) -> str:
        return scalar(names.carriers[own.id] if each == CARRIER else names.of(each))

    meshes = ", ".join(f"{scalar(names.of(central))}: {scalar(names.of(planet))}" for central, planet in own.meshes)
    lines = (
        "kind: planetary",
        f"planet: {scalar(names.planets[own.id])}",
        f"planets: {own.planets}",
        f"carrier: {scalar(names.carriers[own.id])}",
        f"meshes: {{{meshes}}}",
        f"centre_distance: {length(own.stages[0].centre_distance)}",
        f"held: {member(own.held)}{'  # guess: no coupling to the casing says it' if own.guessed else ''}",
        f"input: {member(link.driver)}",
        f"output: {member(link.driven)}",
    )
    return Entry("moves", scalar(names.of(own)), [Wording(lines, f"planetary_stage {own.id}")])


def measures(gearbox: Gearbox, trains: Sequence[Train], names: Named) -> Iterator[Entry]:
    """Normal backlash of each mesh, and the lost motion at each output."""
    for stage in gearbox.stages:
        line = f"{{kind: normal_backlash, of: {scalar(names.of(stage))}}}"
        low, high = (None, None) if stage.backlash is None else stage.backlash
        told = "" if low is None or high is None else f"the file's program has {um(low)} to {um(high)}"
        title = names.titles.new(f"{names.of(stage)} normal backlash", "normal backlash")
        yield Entry("measures", scalar(title), [Wording((line,), told)])
    if _is_set_alone(gearbox):
        name = scalar(names.titles.new("lost motion", "lost motion"))
        line = f"{{kind: planetary_lost_motion, of: {scalar(names.of(gearbox.sets[0]))}}}"
        yield Entry("measures", name, [Wording((line,))])
        return
    for train in trains:
        title = names.titles.new(f"lost motion of {train.output}", "lost motion")
        yield Entry("measures", scalar(title), [Wording((f"{{kind: lost_motion, of: {scalar(train.name)}}}",))])
