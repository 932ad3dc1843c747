"""A gearbox of a REXS text: its components become gears, stages, shafts and bearings."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Final

from tol3d.apps.drafting.rexs.document import Component, Document, LeftOut, Relation, RexsError
from tol3d.apps.drafting.rexs.gearbox import MOST_NAMED, Bearing, Gear, Gearbox, Stage, Stop, counted
from tol3d.apps.drafting.rexs.gears import gear_of, limits_of, require_mates
from tol3d.apps.drafting.rexs.places import HOUSINGS, shafts_of
from tol3d.apps.drafting.rexs.planetary import planetary_set
from tol3d.cad.step import shown

GEARS: Final = ("cylindrical_gear", "ring_gear")
BEARINGS: Final = (
    "concept_bearing",
    "rolling_bearing_with_catalog_geometry",
    "rolling_bearing_with_detailed_geometry",
    "hydrodynamic_radial_plain_bearing",
)
READ: Final = frozenset(
    (*GEARS, *BEARINGS, *HOUSINGS, "shaft", "cylindrical_stage", "planetary_stage", "cylindrical_gear_flank",
     "cylindrical_stage_gear_data", "coupling", "switchable_coupling", "planet_carrier", "side_plate")
)  # fmt: skip
NO_PLAY: Final = (
    "material", "lubricant", "load", "tool", "section", "data_set", "list", "groove", "notch", "shoulder", "curve",
    "rolling_element", "bearing_row", "bearing_ring", "mass", "group", "reduction_point", "root", "body", "contact",
    "fkm", "bore", "shell", "slot", "hole", "flank", "gear_data", "worm_gear", "worm_wheel", "bevel_gear",
    "general_gear",
)  # fmt: skip
"""Words in types of components that say nothing of play, or whose stage is named instead."""
CLEARANCES: Final = (
    "operating_{}_bearing_clearance",
    "mounted_{}_bearing_clearance",
    "{}_bearing_clearance",
    "{}_clearance",
)
"""Names of single values, with `radial` or `axial`, that which is nearest to the mounted gearbox first."""
HOLDS: Final = {"both_directions": True, "positive": False, "negative": False}
"""Axial forces that a bearing takes, and whether these are all."""
MOST_STAGES: Final = 200  # of one scene that a person reads
GRADES: Final = range(5, 12)  # of DIN 3964
DIGITS_OF_SHIFT: Final = 6  # as gear programs print x


def gearbox_of(document: Document) -> Gearbox:
    """The gearbox of a REXS text.

    Raises:
        RexsError: it has no cylindrical stage, or one that cannot be.
    """
    left = LeftOut()
    flanks = {own.one("gear"): own for own in reversed(document.of_type.get("flank", ()))}
    gears = {own.id: gear_of(document, own, flanks.get(own.id), left) for own in _gears(document)}
    driving = _driving(document)
    stages = [_stage(document, relation, gears, driving, left) for relation in _stages(document)]
    others = list(_others(document))
    if not stages:
        raise RexsError(f"expected a cylindrical or planetary stage, got {', '.join(others) or 'none'}")
    left.lines += [f"{each}: not drafted" for each in others]
    meshing = {stage.id for stage in stages} | {*gears}
    alone = [own for own in document.all_of("cylindrical_stage", *GEARS) if own.id not in meshing]
    left.lines += [f"{own}: without a mesh, not drafted" for own in alone]
    for stage in stages:
        require_mates(stage)
    stages = with_shifts(stages)
    shafts = shafts_of(document, {gear.id: gear for stage in stages for gear in stage.gears}, left)
    in_set = {
        own.one("part"): own.one("assembly")
        for own in document.of_type.get("assembly", ())
        if document.components[own.one("assembly")].type == "planetary_stage"
    }
    sets = [
        planetary_set(document, own, [stage for stage in stages if in_set.get(stage.id) == own.id], shafts)
        for own in document.all_of("planetary_stage")
    ]
    bearings = list(_bearings(document, left))
    stops = list(_stops(document, left))
    return Gearbox([own for own in stages if own.id not in in_set], sets, shafts, bearings, stops, left.lines)


def _stages(document: Document) -> list[Relation]:
    """Relations of cylindrical stages with their gears.

    Raises:
        RexsError: there are more than a scene has.
    """
    relations = document.of_type.get("stage", ())
    found = [own for own in relations if document.components[own.one("stage")].type == "cylindrical_stage"]
    if len(found) > MOST_STAGES:
        raise RexsError(f"expected at most {MOST_STAGES} cylindrical stages, got {len(found)}")
    return found


def _gears(document: Document) -> Iterator[Component]:
    """Gears of cylindrical stages, once each."""
    ids = [relation.one(role) for relation in _stages(document) for role in ("gear_1", "gear_2")]
    for each in dict.fromkeys(ids):
        gear = document.components[each]
        if gear.type not in GEARS:
            raise RexsError(f"{gear}: expected a cylindrical_gear or ring_gear in a cylindrical_stage")
        yield gear


def _others(document: Document) -> Iterator[str]:
    """Components that are not read, by type: worm stages, bevel stages, splines."""
    others = [own for own in document.components.values() if own.type not in READ and not _says_no_play(own.type)]
    for kind, group in groupby(sorted(others, key=lambda own: own.type), key=lambda own: own.type):
        members = list(group)
        names = ", ".join(repr(shown(own.name)) if own.name else str(own.id) for own in members[:MOST_NAMED])
        yield f"{shown(kind)} {names}{' …' if len(members) > MOST_NAMED else ''}"


def _says_no_play(kind: str) -> bool:
    return not kind.endswith("_stage") and any(word in kind for word in NO_PLAY)


def _stage(
    document: Document, relation: Relation, gears: dict[int, Gear], driving: dict[int, int], left: LeftOut
) -> Stage:
    """A mesh.

    Raises:
        RexsError: a gear meshes with itself, or the centre distance is missing.
    """
    stage = document.components[relation.one("stage")]
    first, second = relation.one("gear_1"), relation.one("gear_2")
    if first == second:
        raise RexsError(f"{stage}: expected two gears, got {document.components[first]} twice")
    distance = abs(stage.needed("center_distance", "length"))
    if distance == 0.0:
        raise RexsError(f"{stage}: center_distance: expected one above 0, got 0")
    turned = left.spared(stage.number, "rotating_angle_around_neg_u_axis", "angle")
    low, high = "lower_center_distance_allowance", "upper_center_distance_allowance"
    return Stage(
        id=stage.id,
        name=stage.name,
        first=gears[first],
        second=gears[second],
        centre_distance=distance,
        field=left.spared(_field, stage),
        allowance=left.spared(limits_of, stage, low, high),
        direction=None if turned is None else -turned,
        driven_by=driving.get(stage.id),
        backlash=left.spared(limits_of, stage, "minimum_normal_backlash", "maximum_normal_backlash"),
        distance_digit=stage.last_digit("center_distance", "length"),
    )


def _field(stage: Component) -> int | None:
    """Grade of the field of DIN 3964, whose letters are js."""
    name = "center_distance_tolerance_field_din_3964_1980"
    written = stage.text(name)
    if written is None:
        return None
    number = written.lower().removeprefix("js").removesuffix(".0")  # as programs write it that know floats alone
    if not number.isdecimal() or int(number) not in GRADES:
        raise RexsError(f"{stage}: {name}: expected 5 to 11, got {shown(written)!r}")
    return int(number)


def _driving(document: Document) -> dict[int, int]:
    """The gears that drive stages, as the file's loads have it."""
    relations = document.of_type.get("stage_gear_data", ())
    return {
        own.one("stage"): own.one("gear")
        for own in reversed(relations)
        if document.components[own.one("stage_gear_data")].flag("is_driving_gear")
    }


def with_shifts(stages: Sequence[Stage]) -> list[Stage]:
    """Stages whose gears have profile shifts, also where the file does not say them.

    One that is missing makes its mesh tight with the other; where both are, they are 0.
    """
    known = {gear.id: gear for stage in stages for gear in stage.gears}
    missing = [own for own in known.values() if own.profile_shift is None]
    while missing:
        derived = dict[int, Gear]()
        for stage in stages:
            for gear in stage.gears:
                mate, tight = known[stage.mate(gear).id], stage.tight_shift
                if known[gear.id].profile_shift is None and mate.profile_shift is not None and tight is not None:
                    shift = round(tight - mate.profile_shift, DIGITS_OF_SHIFT)
                    why = "not in the file; x without backlash at the centre distance"
                    derived.setdefault(gear.id, replace(known[gear.id], profile_shift=shift, shift_guess=why))
        if not derived:
            first = missing[0]
            derived[first.id] = replace(known[first.id], profile_shift=0.0, shift_guess="not in the file")
        known |= derived
        missing = [own for own in known.values() if own.profile_shift is None]
    return [replace(own, first=known[own.first.id], second=known[own.second.id]) for own in stages]


def _bearings(document: Document, left: LeftOut) -> Iterator[Bearing]:
    """Bearings between a shaft and the casing; others are listed together."""
    between = list[str]()
    for relation in document.of_type.get("side", ()):
        bearing = document.components[relation.one("assembly")]
        if bearing.type not in BEARINGS or bearing.flag("radial_force_absorption") is False:
            continue
        if (held := _in_casing(document, relation)) is None:
            between.append(shown(bearing.name or str(bearing.id)))
            continue
        shaft, side = held
        at = left.spared(bearing.number, f"u_coordinate_on_shaft_{side}_side", "length")
        clearance, source = left.spared(_clearance, bearing, "radial") or (None, "")
        yield Bearing(bearing.id, bearing.name, shaft.id, at, clearance, source)
    if between:
        left.lines.append(f"{counted(between)} between parts that turn: not drafted")


def _stops(document: Document, left: LeftOut) -> Iterator[Stop]:
    """Bearings between a shaft and the casing that take axial forces, or state an axial clearance and no forces."""
    for relation in document.of_type.get("side", ()):
        bearing = document.components[relation.one("assembly")]
        if bearing.type not in BEARINGS or (held := _in_casing(document, relation)) is None:
            continue
        forces = left.spared(bearing.text, "axial_force_absorption")
        play, source = left.spared(_clearance, bearing, "axial") or (None, "")
        if forces in HOLDS or (forces is None and (play or source)):
            yield Stop(bearing.name or str(bearing.id), held[0].id, HOLDS.get(forces or ""), play, source)


def _in_casing(document: Document, relation: Relation) -> tuple[Component, str] | None:
    """The shaft that a bearing carries in the casing, and its side of the bearing; None of other bearings."""
    inner, outer = document.components[relation.one("inner_part")], document.components[relation.one("outer_part")]
    shafts = [(own, side) for own, side in ((inner, "inner"), (outer, "outer")) if own.type == "shaft"]
    return shafts[0] if len(shafts) == 1 and {inner.type, outer.type} & {*HOUSINGS} else None


def _clearance(bearing: Component, way: str) -> tuple[tuple[float, float] | None, str]:
    """Limits of a clearance [mm] with the file's words, or None with the class that it states instead.

    Args:
        bearing: that has it.
        way: `radial` or `axial`.

    Raises:
        RexsError: it is below 0.
    """
    limits = limits_of(bearing, f"minimum_{way}_bearing_clearance", f"maximum_{way}_bearing_clearance")
    found, source = limits, f"minimum_… and maximum_{way}_bearing_clearance"
    for name in (own.format(way) for own in CLEARANCES):
        value = None if found is not None else bearing.number(name, "length")
        if value is not None:
            found, source = (value, value), name
    if found is None:
        group = bearing.text(f"{way}_clearance_class")
        return None, "" if group is None else f"class {group}"
    if not 0.0 <= found[0] < math.inf:
        raise RexsError(f"{bearing}: {source}: expected a clearance above 0, got {found[0]:g} mm, a preload")
    return found, source
