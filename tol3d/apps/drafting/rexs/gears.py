"""Gears of a REXS text, with the limits of their teeth, and the conditions that two of them are mates."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final

from tol3d.apps.drafting.rexs.document import Component, Document, LeftOut, Relation, RexsError
from tol3d.apps.drafting.rexs.gearbox import Allowance, Gear, Stage
from tol3d.apps.drafting.words import length

SERIES: Final = "tooth_thickness_deviation_tolerance_series_din_3967_1978"
GLOBAL_CLASS: Final = "global_tolerance_class_iso_1328_2013"
CLASSES: Final[Mapping[str, Sequence[str]]] = {
    "pitch_deviation": ("single_pitch_tolerance_class_iso_1328_2013", "cumulative_pitch_tolerance_class_iso_1328_2013"),
    "profile_slope": ("profile_slope_tolerance_class_iso_1328_2013",),
    "helix_slope": ("helix_slope_tolerance_class_iso_1328_2013",),
}
"""Kinds of tolerances by a flank tolerance class, each with the attributes that state one for it alone."""
READ_CLASSES: Final = frozenset((
    GLOBAL_CLASS, "tolerance_class_according_to_iso_1328_2013", *(name for names in CLASSES.values() for name in names)
))  # fmt: skip
OTHER_LIMITS: Final = ("runout_tolerance", "_tolerance_class_", "_deviation_iso_", "_deviation_din_")
"""Parts of the names of other limits of teeth."""
SAME_ANGLE: Final = 1e-6  # rad; files print degrees with 6 digits and more
SAME_MODULE: Final = 1e-6  # mm
SAME_SHIFT: Final = 1e-9
STEEPEST: Final = 1.2  # rad, 69 deg; of helices, and more than any pressure angle


def gear_of(document: Document, gear: Component, flanks: Relation | None, left: LeftOut) -> Gear:
    """A gear with its flanks and the limits of its teeth.

    Args:
        document: that it is of.
        gear: its component.
        flanks: the relation with its flanks; without one the gear states what they do.
        left: takes what cannot be read.

    Raises:
        RexsError: teeth, module or flanks are missing, or none that a gear has.
    """
    teeth = gear.whole("number_of_teeth")
    if teeth is None or teeth < 1:
        raise RexsError(f"{gear}: number_of_teeth: expected a number above 0, got {'none' if teeth is None else teeth}")
    module = gear.needed("normal_module", "length")
    pressure_angle, shift, digit = _flanks(document, gear, flanks, left)
    helix = gear.number("helix_angle_reference_diameter", "angle") or 0.0
    if not (module > 0.0 and 0.0 < pressure_angle < STEEPEST and abs(helix) < STEEPEST):
        raise RexsError(f"{gear}: expected a module and a pressure angle above 0, and angles below 69 deg")
    left.lines += [
        f"{gear}: {name}: not read"
        for name in gear.attributes
        if any(part in name for part in OTHER_LIMITS) and name not in READ_CLASSES
    ]
    read = Gear(
        id=gear.id,
        name=gear.name,
        teeth=teeth,
        internal=gear.type == "ring_gear",
        module=module,
        helix_angle=helix,
        pressure_angle=pressure_angle,
        face_width=left.spared(gear.number, "face_width", "length"),
        profile_shift=shift,
        tip_diameter=None,
        start=left.spared(gear.number, "u_coordinate_on_shaft", "length"),
        series=left.spared(gear.text, SERIES) or "",
        allowances=tuple(_allowances(gear, left)),
        classes=left.spared(_classes, gear) or {},
        shift_digit=digit,
    )
    return replace(read, tip_diameter=left.spared(_tip_diameter, gear, read))


def _flanks(
    document: Document, gear: Component, flanks: Relation | None, left: LeftOut
) -> tuple[float, float | None, float]:
    """Pressure angle and profile shift, which both flanks have alike, and the last digit of the latter."""
    sides = [] if flanks is None else [document.components[flanks.one(side)] for side in ("left", "right")]
    states = sides or [gear]
    angles = [own.needed("normal_pressure_angle", "angle") for own in states]
    shifts = [left.spared(own.number, "addendum_modification_coefficient") for own in states]
    if abs(angles[0] - angles[-1]) > SAME_ANGLE or not _alike(shifts[0], shifts[-1]):
        raise RexsError(f"{gear}: expected left and right flanks with one pressure angle and profile shift, got two")
    return angles[0], shifts[0], states[0].last_digit("addendum_modification_coefficient")


def _alike(first: float | None, second: float | None) -> bool:
    return first == second or (first is not None and second is not None and abs(first - second) < SAME_SHIFT)


def _tip_diameter(gear: Component, read: Gear) -> float | None:
    """Tip diameter, which lies outside the reference circle, a ring's inside."""
    value = gear.number("tip_diameter", "length")
    if value is not None and (value < read.reference_diameter) != read.internal:
        raise RexsError(
            f"{gear}: tip_diameter: expected one {'below' if read.internal else 'above'} the reference diameter "
            f"{length(round(read.reference_diameter, 4))}, got {length(value)}"
        )
    return value


def _classes(gear: Component) -> dict[str, int]:
    """Flank tolerance classes by the kind of tolerance; of two for the pitch the coarser one."""
    found = dict[str, int]()
    for kind, names in CLASSES.items():
        stated = [own for own in map(gear.whole, names) if own is not None]
        common = gear.whole(GLOBAL_CLASS)
        if stated or common is not None:
            found[kind] = max(stated) if stated else common or 0
    return found


def _allowances(gear: Component, left: LeftOut) -> Iterator[Allowance]:
    """Limits of the tooth thickness that are stated as numbers."""
    chordal = left.spared(
        limits_of, gear, "chordal_tooth_thickness_lower_deviation", "chordal_tooth_thickness_upper_deviation"
    )
    if chordal is not None:
        yield Allowance("arc", *chordal, "chordal_tooth_thickness_…_deviation")
    span = left.spared(
        limits_of, gear, "lower_backlash_allowance_referenced_to_span", "upper_backlash_allowance_referenced_to_span"
    )
    of_ring, source = gear.type == "ring_gear", "…_backlash_allowance_referenced_to_span"
    if span is not None and (told := _of_size(gear, span, source, left)):
        limits, source = told
        teeth = left.spared(gear.whole, "number_of_teeth_for_span_measurement")
        if teeth is not None:
            yield Allowance(f"{{span: {teeth}}}", *limits, source)
        else:
            yield Allowance("normal", *((-limits[1], -limits[0]) if of_ring else limits), source)
    pins = left.spared(
        limits_of, gear, "lower_backlash_allowance_balls_or_pins", "upper_backlash_allowance_balls_or_pins"
    )
    source = "…_backlash_allowance_balls_or_pins"
    if pins is not None and (told := _of_size(gear, pins, source, left)):
        limits, source = told
        diameter = left.spared(gear.number, "diameter_of_measuring_ball_or_pin", "length")
        if diameter is None:
            left.lines.append(f"{gear}: {source}: not read without diameter_of_measuring_ball_or_pin")
        else:
            # no straight pin fits between the flanks of a helical ring
            over = "balls" if of_ring else "pins"
            yield Allowance(f"{{{over}: {length(diameter)}}}", *limits, source)


def _of_size(
    gear: Component, limits: tuple[float, float], source: str, left: LeftOut
) -> tuple[tuple[float, float], str] | None:
    """Limits of a measured size, with their source in words; None of a ring's to both sides of 0.

    A ring's span over spaces and its size between pins grow as its teeth get thinner, which allowances for backlash
    make them. Files state that growth, or count it below 0, as DIN 3967 does thinner teeth.
    """
    if gear.type != "ring_gear" or limits[0] >= 0.0:
        return limits, source
    if limits[1] <= 0.0:
        return (-limits[1], -limits[0]), f"{source}, below 0 for thinner teeth"
    left.lines.append(f"{gear}: {source}: not read of a ring with limits to both sides of 0, whose sign is not told")
    return None


def limits_of(component: Component, lower: str, upper: str) -> tuple[float, float] | None:
    """A lower and an upper limit [mm]; None without them.

    Raises:
        RexsError: one is missing, or the lower one is larger.
    """
    low, high = component.number(lower, "length"), component.number(upper, "length")
    if low is None and high is None:
        return None
    if low is None or high is None:
        raise RexsError(f"{component}: expected {lower} and {upper}, got one of them")
    if low > high:
        raise RexsError(f"{component}: {lower}: expected at most {upper}, got {length(low)} and {length(high)}")
    return low, high


def require_mates(stage: Stage) -> None:
    """Refuse a stage whose gears cannot mesh.

    Raises:
        RexsError: modules, pressure angles or helix angles differ, or both are rings.
    """
    first, second = stage.gears
    place = f"cylindrical_stage {stage.id}"
    if first.internal and second.internal:
        raise RexsError(f"{place}: expected at most one ring_gear, got two")
    if abs(first.module - second.module) > SAME_MODULE:
        modules = f"{length(first.module)} and {length(second.module)}"
        raise RexsError(f"{place}: expected gears of one normal_module, got {modules}")
    if abs(first.pressure_angle - second.pressure_angle) > SAME_ANGLE:
        raise RexsError(f"{place}: expected gears of one normal_pressure_angle, got two")
    opposite = 1.0 if stage.ring is None else -1.0
    if abs(first.helix_angle + opposite * second.helix_angle) > SAME_ANGLE:
        signs = "opposite signs" if stage.ring is None else "one sign"
        raise RexsError(f"{place}: helix_angle_reference_diameter: expected one angle with {signs}, got others")
