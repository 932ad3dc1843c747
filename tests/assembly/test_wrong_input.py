"""Errors in a scene of an assembly are reported once: place, expectation, what came, remedy."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from fixtures import Command
from places import SCENES
from scene_texts import Edit, edited, refusal, refusal_at, written

COVER, TWO_PLATES = ((SCENES / f"{name}.yaml").read_text("utf-8") for name in ("cover_on_base", "two_plates"))
PARTS, TOLERANCES, MEASURES = "\nparts:\n", "\ntolerances:\n", "\nmeasures:\n"
LEDGE = "ledge: {kind: plane, at: [9 mm, 9 mm, 9 mm], normal: [0, 0, 1], radius: 4 mm}"
NEAR = "near: {kind: point, at: [50 mm, 10 mm, 0 mm]}"
LOCATED = COVER[COVER.index("  cover on the base:\n") : COVER.index(MEASURES)]
BASE_HOLE = (
    "{kind: position, of: base.hole, zone: {diameter: 0.2 mm}, law: {kind: normal}, datums: [floor, back, left]}"
)
BACK = "{kind: perpendicularity, of: base.back, zone: {width: 0.02 mm}, law: {kind: uniform}, datums: [floor]}"
SPREAD = "distribution: {kind: uniform, lower: 0 um, upper: 5 um}"
HOLES = "to: cover.hole, along: [1, 0, 0]"


def added(section: str, entry: str) -> Edit:
    return section, f"{section}  {entry}\n"


def changed(line: str, old: str, new: str) -> Edit:
    assert old in line, old
    return line, line.replace(old, new)


def located(kind: str, key: str, *pairs: str) -> Edit:
    listed = "".join(f"      - {pair}\n" for pair in pairs)
    return LOCATED, f"  cover on the base:\n    kind: {kind}\n    part: cover\n    {key}:\n{listed}"


WRONG: dict[str, tuple[Sequence[Edit], str, str]] = {
    "missing feature": (
        [changed(BASE_HOLE, "base.hole", "base.hola")],
        "tolerances.base hole position.of",
        "expected a feature of 'base', got 'base.hola', which it does not have; did you mean \"base.hole\"?",
    ),
    "missing part of a feature": (
        [("to: base.left}", "to: bass.left}")],
        "moves.cover on the base.tertiary[0].to",
        "expected the name of a solid part, got 'bass', which is not in the scene; did you mean \"base\"?",
    ),
    "missing datum": (
        [changed(BASE_HOLE, "[floor,", "[flor,")],
        "tolerances.base hole position.datums[0]",
        "expected a feature of 'base', got 'base.flor', which it does not have; did you mean \"base.floor\"?",
    ),
    "feature without its part": (
        [changed(BASE_HOLE, "base.hole", "hole")],
        "tolerances.base hole position.of",
        "expected a feature with its part, such as housing.bore 1, got 'hole'",
    ),
    "feature of the wrong kind": (
        [added(TOLERANCES, f"thick: {{kind: size, of: base.floor, {SPREAD}}}")],
        "tolerances.thick.of",
        "expected a cylinder or cone or slot or sphere, got 'base.floor', which is a plane; "
        'did you mean "base.hole"?',
    ),
    "point with an orientation": (
        [added(TOLERANCES, "level: {kind: parallelism, of: base.rim, zone: {width: 0.1 mm}, datums: [floor]}")],
        "tolerances.level.of",
        "expected a plane or slot or cylinder or axis or cone, got 'base.rim', which is a point; "
        'did you mean "base.floor"?',
    ),
    "three locators on a line": (
        [("at: [60 mm, 70 mm, 0 mm]", "at: [60 mm, 10 mm, 0 mm]")],
        "moves.cover on the base",
        "its six contacts leave cover free: it turns about x through (0, 10, 3); "
        "expected contacts that hold all six freedoms",
    ),
    "three locators along y": (
        [("{from: cover.C1, to: base.left}", "{from: cover.B1, to: base.back}")],
        "moves.cover on the base",
        "its six contacts leave cover free: it shifts along x; expected contacts that hold all six freedoms",
    ),
    "cyclic datums": (
        [changed(BACK, "[floor]", "[left]")],
        "tolerances.back perpendicular.datums",
        "expected datums that do not depend on 'base.back' themselves, got a ring of 'base.back' and 'base.left'",
    ),
    "feature as its own datum": (
        [changed(BACK, "[floor]", "[back]")],
        "tolerances.back perpendicular.datums",
        "expected datums that do not depend on 'base.back' themselves, got a ring of 'base.back'",
    ),
    "datum twice": (
        [changed(BASE_HOLE, "[floor, back, left]", "[floor, floor]")],
        "tolerances.base hole position.datums",
        "base.floor takes no freedom: datums before it hold all that it could take; leave it out",
    ),
    "datum that takes nothing": (
        [
            changed(BASE_HOLE, "[floor, back, left]", "[floor, ledge]"),
            (
                "      hole:",
                "      ledge: {kind: plane, at: [9 mm, 9 mm, 9 mm], normal: [0, 0, 1], radius: 4 mm}\n      hole:",
            ),
        ],
        "tolerances.base hole position.datums",
        "base.ledge takes no freedom: datums before it hold all that it could take; leave it out",
    ),
    "targets without points": (
        [changed(BASE_HOLE, "back,", "{feature: back, simulator: targets},")],
        "tolerances.base hole position.datums[1].targets",
        "expected the points that touch, such as [[10 mm, 0 mm, 5 mm]], got none",
    ),
    "points without targets": (
        [changed(BASE_HOLE, "back,", "{feature: back, targets: [[10 mm, 0 mm, 5 mm]]},")],
        "tolerances.base hole position.datums[1].targets",
        "expected simulator: targets beside them, got simulator: contact",
    ),
    "part placed twice": (
        [(MEASURES, f"  again: {{kind: fix, part: cover}}\n{MEASURES}")],
        "moves.again.part",
        "expected a part that is not placed yet, got 'cover', which 'cover on the base' places",
    ),
    "part placed never": (
        [("  base on the table: {kind: fix, part: base}\n", "")],
        "parts.base",
        "expected a move that places 'base', got none; add one, such as {kind: fix, part: base}",
    ),
    "move against a part that is not placed yet": (
        [
            ("  base on the table: {kind: fix, part: base}\n", ""),
            (MEASURES, f"  base on the table: {{kind: fix, part: base}}\n{MEASURES}"),
        ],
        "moves.cover on the base.primary[0].to",
        "expected a feature of a part that is placed already, got 'base.floor'; "
        "put the move that places 'base' before this one",
    ),
    "part welded to itself": (
        [(MEASURES, f"  joint: {{kind: weld, part: base, to: [base]}}\n{MEASURES}")],
        "moves.joint.to[0]",
        "expected a part of another body, got 'base', which is of this one already",
    ),
    "law missing": (
        [changed(BASE_HOLE, "law: {kind: normal}, ", "")],
        "tolerances.base hole position.law",
        "expected how deviations lie in the zone, which drawings leave open: {kind: uniform}, {kind: normal} or "
        "{kind: process, distribution: …}, got none",
    ),
    "law as a word": (
        [changed(BASE_HOLE, "{kind: normal}", "normal")],
        "tolerances.base hole position.law",
        "expected a law such as {kind: uniform}, got 'normal'",
    ),
    "law of an orientation alone missing": (
        [changed(BACK, "law: {kind: uniform}, ", "")],
        "tolerances.back perpendicular",
        "expected a law, such as {kind: uniform}: no other zone says where the feature lies",
    ),
    "two location tolerances": (
        [(f"    {BASE_HOLE}\n", f"    {BASE_HOLE}\n  second: {BASE_HOLE}\n")],
        "tolerances.second",
        "expected one tolerance of 'base.hole' for where it lies, got 'base hole position' too, "
        "which would count twice; remove one; a tilt that it refines is an orientation tolerance beside the other",
    ),
    "zone narrower than its refinement": (
        [
            added(
                TOLERANCES, "square: {kind: perpendicularity, of: base.hole, zone: {diameter: 0.3 mm}, datums: [floor]}"
            )
        ],
        "tolerances.base hole position.zone",
        "expected more than the 300 um of 'square', which refines it, got 200 um",
    ),
    "diameter for a plane": (
        [changed(BACK, "width", "diameter")],
        "tolerances.back perpendicular.zone.diameter",
        "expected a width, for a plane lies between two planes",
    ),
    "width without a direction for an axis": (
        [changed(BASE_HOLE, "diameter", "width")],
        "tolerances.base hole position.zone",
        "expected the direction `along` in which the width limits, or a diameter",
    ),
    "width along the axis": (
        [changed(BASE_HOLE, "diameter: 0.2 mm", "width: 0.2 mm, along: [0, 0, 1]")],
        "tolerances.base hole position.zone",
        "expected a direction `along` across the axis, got one along it",
    ),
    "dimension along the axis": (
        [(BASE_HOLE, f"{{kind: plus_minus, of: base.hole, along: [0, 0, 1], {SPREAD}}}")],
        "tolerances.base hole position.along",
        "expected a direction across the axis, got one along it, where it does not deviate",
    ),
    "unknown pair of a locator": (
        [added(TOLERANCES, f"pin: {{kind: locator, of: cover on the base, pair: secondary 3, {SPREAD}}}")],
        "tolerances.pin.pair",
        "expected one of primary 1, primary 2, primary 3, secondary 1, secondary 2, tertiary 1, got 'secondary 3'; "
        'did you mean "secondary 2"?',
    ),
    "contact against the plane's normal": (
        [("{from: cover.C1, to: base.left}", "{from: cover.C1, to: base.left, along: [-1, 0, 0]}")],
        "moves.cover on the base.tertiary[0].along",
        "expected none, or the normal of the plane 'base.left'",
    ),
    "mate that takes nothing": (
        [
            located(
                "mate",
                "relations",
                "{kind: coaxial, from: cover.hole, to: base.hole}",
                "{kind: coincident, from: cover.A1, to: base.floor}",
                "{kind: coincident, from: cover.A2, to: base.floor}",
            )
        ],
        "moves.cover on the base",
        "coincident of cover.A2 and base.floor takes no freedom: earlier relations hold all that it constrains; "
        "leave it out",
    ),
    "mate of what does not mate": (
        [located("mate", "relations", "{kind: coaxial, from: cover.A1, to: base.hole}")],
        "moves.cover on the base",
        "coaxial of cover.A1 and base.hole: expected axis on axis, got point on axis",
    ),
    "distance without a length": (
        [located("mate", "relations", "{kind: distance, from: cover.A1, to: base.floor}")],
        "moves.cover on the base.relations[0].distance",
        "expected a length, such as 2 mm, got none",
    ),
    "best fit of points on a line": (
        [
            located("best_fit", "pairs", *(f"{{from: cover.{own}, to: base.rim}}" for own in ("A1", "A2", "near"))),
            ("      top: ", f"      {NEAR}\n      top: "),
        ],
        "moves.cover on the base.pairs",
        "expected points that do not all lie on one line, about which 'cover' would be free to turn; "
        "add a point beside it",
    ),
    "measure after an unknown move": (
        [(HOLES, f"{HOLES}, after: cover in the base")],
        "measures.hole offset.after",
        "expected the name of a move that places or joins parts, got 'cover in the base', which is not in the scene; "
        'did you mean "cover on the base"?',
    ),
    "measure before its parts are placed": (
        [(HOLES, f"{HOLES}, after: base on the table")],
        "measures.hole offset.after",
        "expected a move by which 'cover' is placed, got 'base on the table'; name a later one",
    ),
    "limit of another dimension": (
        [("lower_limit: -0.15 mm", "lower_limit: -1 deg")],
        "measures.hole offset.lower_limit",
        "expected a length with its unit, such as \"4.5 um\", got '-1 deg'",
    ),
    "difference of an angle and a length": (
        [
            added(MEASURES, "lean: {kind: angle, from: base.floor, to: base.back}"),
            added(MEASURES, "less: {kind: difference, of: lean, minus: flush}"),
        ],
        "measures.less.minus",
        "expected an angle, as 'lean' is, got 'flush', a length",
    ),
    "flatness of two parts": (
        [
            added(
                MEASURES,
                "wavy: {kind: inspected_flatness, points: [cover.A1, cover.A2, cover.A3, base.rim], normal: [0, 0, 1]}",
            )
        ],
        "measures.wavy.points",
        "expected points of one part, got points of 'base', 'cover'",
    ),
    "a word that left the standard": (
        [changed(BASE_HOLE, "kind: position", "kind: concentricity")],
        "tolerances.base hole position.kind",
        "expected another word here, got 'concentricity'; it left ASME Y14.5 in 2018: write coaxiality, of the "
        "axis, as in ISO 1101",
    ),
    "a key of what is not there": (
        [changed(BASE_HOLE, "[floor,", "[{feature: floor, translation: true},")],
        "tolerances.base hole position.datums[0].translation",
        "expected another word here, got 'translation'; datums that may shift (a triangle) are not supported: "
        "leave the datum out, or name it with `mmb`",
    ),
    "a modifier that is not there": (
        [changed(BASE_HOLE, "kind: position", "kind: position, modifier: st")],
        "tolerances.base hole position.modifier",
        "expected another word here, got 'st'; statistical tolerances (ST) are not supported: "
        "name the law of the process",
    ),
    "a key that is a word elsewhere": (
        [changed(BASE_HOLE, "kind: position", "kind: position, width: 1 mm")],
        "tolerances.base hole position.width",
        'unknown key "width"; known here: '
        "kind, description, of, zone, law, datums, lower_segment, rigid_with, modifier",
    ),
    "a word of another kind of feature": (
        [("      rim:   {kind: point", "      rim:   {kind: taper")],
        "parts.base.features.rim.kind",
        "expected another word here, got 'taper'; write cone, with its `diameters` at both ends",
    ),
    "gears and assemblies": (
        [added(PARTS, "pinion: {kind: spur_gear, teeth: 20, module: 1 mm, face_width: 10 mm}")],
        "parts.base",
        "kinds of gearing and assembly do not go together in one scene, got 'pinion' of gearing and 'base' of "
        "assembly; join them by a move of kind carrier_pins or a move of kind open_chain or a move of kind "
        "shaft_in_bores, or make two scenes",
    ),
    "engine of gears": (
        [("trials: 10000", "trials: 10000, engine: fcl")],
        "study.engine",
        "expected exact or analytic, got 'fcl'; these are the engines of this scene",
    ),
}


@pytest.mark.parametrize(("edits", "place", "said"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_said_once_with_its_line(edits: Sequence[Edit], place: str, said: str, tmp_path: Path) -> None:
    text = edited(COVER, *edits)
    line, _, message = refusal_at(text, tmp_path).partition(": ")
    assert message == f"{place}: {said}"
    there = text.splitlines()[int(line) - 1]
    keys = [key.partition("[")[0] for key in place.split(".")[1:]]
    assert any(f"{key}:" in there for key in keys) or ("[" in place and there.strip().startswith("- "))


@pytest.mark.parametrize("case", ["three locators on a line", "gears and assemblies"])
@pytest.mark.parametrize("command", ["check", "run"])
def test_the_command_line_ends_with_2(case: str, command: str, tol3d: Command, tmp_path: Path) -> None:
    edits, place, _ = WRONG[case]
    code, out, err = tol3d(command, str(written(edited(COVER, *edits), tmp_path)))
    assert (code, out) == (2, "")
    assert place in err
    assert "Traceback" not in err


def test_pins_beside_their_holes_are_a_message(tmp_path: Path) -> None:
    """4 mm off, where pins and holes have tenths of a millimetre of room: no deviation of the scene closes that."""
    text = edited(TWO_PLATES, ("hole 1: {kind: cylinder, at: [0 mm,", "hole 1: {kind: cylinder, at: [4 mm,"))
    assert "measures.edge: cannot be read even without deviations: no build" in refusal(text, tmp_path)


def test_an_engine_of_gears_is_refused_as_an_option_too(tol3d: Command) -> None:
    code, _, err = tol3d("run", "cover_on_base", "--engine", "fcl")
    assert code == 2
    assert "--engine" in err
    assert "expected exact or analytic, got 'fcl'" in err
