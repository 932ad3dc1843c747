"""Tolerances of a gearbox as entries of a scene: those that its file states, and lines to fill in for the others."""

from collections.abc import Iterator, Sequence
from typing import Final

from tol3d.apps.drafting.entry import Entry, Wording
from tol3d.apps.drafting.rexs.gearbox import Bearing, Gear, Gearbox, PlanetarySet, Shaft, Stage, Stop
from tol3d.apps.drafting.rexs.named import Named
from tol3d.apps.drafting.words import comment, length, number, scalar

USUAL_SERIES: Final = "cd25"
USUAL_GRADE: Final = 7
USUAL_CLASS: Final = 7
ASKED: Final = "to fill in: "
LETTERS: Final = "DIN 3967: a ab b bc c cd d e f g h, 21 to 30"
FIELDS: Final = "DIN 3964: js5 to js11"
CLASS_WORDS: Final = {"pitch_deviation": "pitch", "profile_slope": "profile slope", "helix_slope": "helix slope"}
CLASS_LAWS: Final = {
    "pitch_deviation": "law: {kind: random_walk, fill: [0.71, 1]}",  # gears that meet their class and not the next
    "profile_slope": "each: tooth, law: {kind: normal, cpk: 1}",
    "helix_slope": "each: tooth, law: {kind: normal, cpk: 1}",
}


def um(value: float) -> str:
    """A length in micrometres, from mm."""
    return f"{number(round(value * 1e3, 6))} um"


def deviations(lower: float, upper: float) -> str:
    """Limits of a deviation [mm] as YAML; of one value a constant."""
    if lower == upper:
        return f"{{kind: constant, value: {um(lower)}}}"
    return f"[{um(lower)}, {um(upper)}]"


def tolerances(gearbox: Gearbox, names: Named, bearings: Sequence[Bearing]) -> Iterator[Entry]:
    """Tolerances, kind by kind: thickness, centre distances, pins, single teeth, clearances, axial plays.

    Args:
        gearbox: that they are of.
        names: of its parts.
        bearings: those that are parts of the scene.
    """
    meshing = list({gear.id: gear for stage in gearbox.stages for gear in stage.gears}.values())
    of_sets = list({gear.id: gear for own in gearbox.sets for mesh in own.meshes for gear in mesh}.values())
    gears = list({gear.id: gear for gear in (*meshing, *of_sets)}.values())
    usual = next((gear.series for gear in gears if gear.series), USUAL_SERIES)
    for gear in gears:
        yield _thickness(gear, names, usual)
    for stage in gearbox.stages:
        yield _centre_distance(stage, names)
    for own in gearbox.sets:
        yield _pins(own, names)
    for gear in gearbox.single_teeth:
        yield from _single_teeth(gear, names)
    for bearing in bearings:
        yield _clearance(bearing, names)
    for shaft in names.shafts:
        if any(gear.helical for gear in shaft.gears):
            yield _axial_play(shaft, names, gearbox.stops_of(shaft))


def _entry(name: str, words: Sequence[Wording], label: str, blank: bool = False) -> Entry:
    return Entry("tolerances", scalar(name), words, label=label, blank=blank)


def _thickness(gear: Gear, names: Named, usual: str) -> Entry:
    """Tooth thickness by the series, else by numbers, else to fill in."""
    of = scalar(names.of(gear))
    title = names.titles.new(f"{names.of(gear)} tooth thickness", "tooth thickness")
    label = f"{'ring_gear' if gear.internal else 'cylindrical_gear'} {gear.id}: tooth thickness"
    words = list[Wording]()
    if gear.series:
        line = f"{{kind: tooth_thickness, of: {of}, distribution: {{din_3967: {scalar(gear.series)}}}}}"
        words.append(Wording((line,), f"gear {gear.id}: series of DIN 3967"))
    lost = f"the series {comment(gear.series)} has no limits, numbers are drafted instead" if gear.series else ""
    for own in gear.allowances:
        measured = "" if own.measured == "arc" else f"measured: {own.measured}, "
        line = f"{{kind: tooth_thickness, of: {of}, {measured}distribution: {deviations(own.lower, own.upper)}}}"
        words.append(Wording((line,), f"gear {gear.id}: {own.source}", lost))
    if words:
        return _entry(title, words, label)
    line = f"{{kind: tooth_thickness, of: {of}, distribution: {{din_3967: {scalar(usual)}}}}}"
    return _entry(title, [Wording((line,), f"{ASKED}{LETTERS}")], label, blank=True)


def _centre_distance(stage: Stage, names: Named) -> Entry:
    title = names.titles.new(f"{names.of(stage)} centre distance", "centre distance")
    start = f"{{kind: centre_distance, of: {scalar(names.of(stage))}, distribution: "
    label = f"cylindrical_stage {stage.id}: centre distance"
    words = list[Wording]()
    if stage.field is not None:
        line = f"{start}{{din_3964: js{stage.field}}}}}"
        words.append(Wording((line,), f"stage {stage.id}: field of DIN 3964"))
    if stage.allowance is not None:
        lost = "" if stage.field is None else f"the field {stage.field} has no limits, numbers are drafted instead"
        words.append(Wording((f"{start}{deviations(*stage.allowance)}}}",), f"stage {stage.id}: allowances", lost))
    if words:
        return _entry(title, words, label)
    return _entry(title, [Wording((f"{start}{{din_3964: js{USUAL_GRADE}}}}}",), f"{ASKED}{FIELDS}")], label, blank=True)


def _pins(own: PlanetarySet, names: Named) -> Entry:
    """One contributor a pin: off its radius it opens the mesh with the sun as it closes that with the ring."""
    stage = next((each for each in own.stages if each.field or each.allowance), own.stages[0])
    title = names.titles.new(f"{names.of(own)} planet pins", "planet pins")
    distance = length(stage.centre_distance)
    start = f"{{kind: planet_pin, of: {scalar(names.carriers[own.id])}, direction: radial, distribution: "
    label = f"planetary_stage {own.id}: planet pins"
    meshes = f"{own.planets} pins, each in {len(own.meshes)} meshes"
    if stage.field is not None:
        line = f"{start}{{fit: js{stage.field}, of: {distance}}}}}"
        return _entry(title, [Wording((line,), f"stage {stage.id}: centre distance; {meshes}")], label)
    if stage.allowance is not None:
        line = f"{start}{deviations(*stage.allowance)}}}"
        return _entry(title, [Wording((line,), f"stage {stage.id}: centre distance; {meshes}")], label)
    line = f"{start}{{fit: js{USUAL_GRADE}, of: {distance}}}}}"
    return _entry(title, [Wording((line,), f"{ASKED}{FIELDS} of the centre distance; {meshes}")], label, blank=True)


def _single_teeth(gear: Gear, names: Named) -> Iterator[Entry]:
    """Deviations of single teeth by their classes; without any, a line for the pitch to fill in."""
    classes = gear.classes or {"pitch_deviation": USUAL_CLASS}
    for kind, grade in classes.items():
        title = names.titles.new(f"{names.of(gear)} {CLASS_WORDS[kind]}", CLASS_WORDS[kind])
        line = (
            f"{{kind: {kind}, of: {scalar(names.of(gear))}, flanks: each, limits: {{iso_class: {grade}}}, "
            f"{CLASS_LAWS[kind]}}}"
        )
        told = f"gear {gear.id}: class of ISO 1328-1" if gear.classes else f"{ASKED}ISO 1328-1: class 1 to 11"
        label = f"cylindrical_gear {gear.id}: class {grade} of ISO 1328-1, {CLASS_WORDS[kind]}"
        yield _entry(title, [Wording((line,), told)], label, blank=not gear.classes)


def _clearance(bearing: Bearing, names: Named) -> Entry:
    """Clearance in any direction, since the file says nothing of the force on the shaft."""
    title = names.titles.new(f"{names.of(bearing.id)} clearance", "clearance")
    label = f"bearing {bearing.id}: clearance"
    start = f"{{kind: bearing_clearance, of: {scalar(names.of(bearing.id))}, direction: random, distribution: "
    if bearing.clearance is None:
        told = f"{ASKED}limits of the radial clearance{comment(', ' + bearing.source if bearing.source else '')}"
        line = f"{start}{{kind: uniform, lower: 0 um, upper: 20 um}}}}"
        return _entry(title, [Wording((line,), told)], label, blank=True)
    line = f"{start}{deviations(*bearing.clearance)}}}"
    return _entry(title, [Wording((line,), comment(f"bearing {bearing.id}: {bearing.source}"))], label)


def _axial_play(shaft: Shaft, names: Named, stops: Sequence[Stop]) -> Entry:
    """Play of a shaft along its axis, through which the thrust of its helical gears moves it at each reversal.

    That of the one bearing that holds it; where several do, their clearances are said beside a line to fill in.
    """
    of = names.of(shaft.ids[0])
    title, label = names.titles.new(f"{of} axial play", "axial play"), f"shaft {shaft.ids[0]}: axial play"
    start = f"{{kind: axial_play, of: {scalar(of)}, distribution: "
    stop = stops[0] if len(stops) == 1 and stops[0].both is not False else None
    if stop is not None and (play := stop.play) is not None:
        told = comment(f"bearing {stop.name}: {stop.source}")
        return _entry(title, [Wording((f"{start}{deviations(*play)}}}",), told)], label)
    said = "".join(f", {own.name} {_words(own)}" for own in stops if own.play is not None or own.source)
    line = f"{start}{{kind: uniform, lower: 0 um, upper: 50 um}}}}"
    return _entry(
        title, [Wording((line,), f"{ASKED}limits of the play between its stops{comment(said)}")], label, blank=True
    )


def _words(stop: Stop) -> str:
    """A bearing's axial clearance in words."""
    if stop.play is None:
        return stop.source
    low, high = stop.play
    return um(low) if low == high else f"{um(low)} to {um(high)}"
