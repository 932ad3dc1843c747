"""Errors in a scene of gears in a housing are reported once: place, expectation, what came, remedy."""

from pathlib import Path
from typing import Any

import pytest
from machine.housed import FOUR_BORES, GEARS, LAID, SHAFTS, housed_scene
from scene_texts import refusal

LAW = "distribution: {kind: uniform, lower: -10 um, upper: 10 um}"
F = f"\n  f: {{kind: plus_minus, of: housing.bore 2, along: [1, 0, 0], {LAW}}}"
ZONE = "zone: {diameter: 10 um}, law: {kind: uniform}"
BEARING = "\n  far bearing: {kind: bearing, shaft: last shaft, at: 30 mm}"
CLEARANCE = f"\n  play: {{kind: bearing_clearance, of: far bearing, direction: random, {LAW}}}"

WRONG: dict[str, tuple[dict[str, str], str, str]] = {
    "a centre distance beside a bore": (
        {"tolerances": F + f"\n  fa: {{kind: centre_distance, of: stage, {LAW}}}"},
        "tolerances.fa",
        "expected no centre_distance of 'stage', for 'f' moves the bores of its shafts already, and both would count; "
        "take out one",
    ),
    "axes that are not parallel beside a bore": (
        {
            "tolerances": f"\n  p: {{kind: position, of: housing.bore 1b, datums: [floor, bore 1], {ZONE}}}"
            f"\n  lean: {{kind: axis_out_of_plane, of: stage, {LAW}}}"
        },
        "tolerances.lean",
        "expected no axis_out_of_plane of 'stage', for 'p' moves the bores of its shafts already, and both would "
        "count; take out one",
    ),
    "a bore's size beside the clearance of its bearing": (
        {"tolerances": f"\n  wide: {{kind: size, of: housing.bore 2b, {LAW}}}" + CLEARANCE, "more": BEARING},
        "tolerances.play",
        "expected no clearance beside 'wide', the size of a bore of the same shaft, for both say how loose it "
        "is; take out one",
    ),
    "another centre distance than that of the bores": (
        {"tolerances": F, "moves": LAID.replace("driven: wheel", "driven: wheel, centre_distance: 75 mm")},
        "moves.stage.centre_distance",
        "expected 75.080024 mm, as the bores lie, got 75 mm; take it out, for it follows",
    ),
    "another azimuth than that of the bores": (
        {"tolerances": F, "moves": LAID.replace("driven: wheel", "driven: wheel, azimuth: 36 deg")},
        "moves.stage.azimuth",
        "expected 36.8241099 deg, as the bores lie, got 36 deg; take it out, for it follows",
    ),
    "another place along the shaft": (
        {"tolerances": F, "moves": LAID.replace("housing.bore 2b]", "housing.bore 2b], at: 5 mm")},
        "moves.last in bores.at",
        "expected -2 mm, as the bores lie, got 5 mm; take it out, for it follows",
    ),
    "a shaft outside": (
        {
            "tolerances": F,
            "moves": LAID.replace(
                "  last in bores: {kind: shaft_in_bores, shaft: last shaft, in: [housing.bore 2, housing.bore 2b]}\n",
                "",
            ),
        },
        "moves.stage",
        "expected both shafts in bores, got 'last shaft' in none, while 'first shaft' lies in bores; add a move of "
        "kind shaft_in_bores for it",
    ),
    "bores that are not parallel": (
        {
            "tolerances": F,
            "features": FOUR_BORES.replace(
                "at: [60.1 mm, 45 mm, 30 mm], axis: [0, 0, -1]", "at: [60.1 mm, 46 mm, 30 mm], axis: [0, 1, 60]"
            ).replace(
                "at: [60.1 mm, 45 mm, -30 mm], axis: [0, 0, 1]", "at: [60.1 mm, 45 mm, -30 mm], axis: [0, 1, 60]"
            ),
        },
        "moves.stage",
        "expected parallel bores of 'first shaft' and 'last shaft', got axes at 16.66 mrad",
    ),
    "bores on two lines": (
        {
            "tolerances": F,
            "features": FOUR_BORES.replace("at: [60.1 mm, 45 mm, 30 mm]", "at: [60.1 mm, 45.2 mm, 30 mm]"),
        },
        "moves.last in bores.in",
        "expected bores on one line, got 'housing.bore 2', whose axis passes the middle of the other bore at 0.2 mm",
    ),
    "one bore twice": (
        {"tolerances": F, "moves": LAID.replace("housing.bore 2b]", "housing.bore 2]")},
        "moves.last in bores.in[1]",
        "expected another bore than the first, got 'housing.bore 2' twice",
    ),
    "two shafts in one bore": (
        {"tolerances": F, "moves": LAID.replace("housing.bore 2b]", "housing.bore 1]")},
        "moves.last in bores.in[1]",
        "expected a bore without a shaft, got 'housing.bore 1', in which 'first in bores' lays one",
    ),
    "a plane as a bore": (
        {"tolerances": F, "moves": LAID.replace("housing.bore 2b]", "housing.floor]")},
        "moves.last in bores.in[1]",
        "expected an axis or cylinder, got 'housing.floor', which is a plane",
    ),
    "a part that is placed later": (
        {"tolerances": F, "fixed": "", "moves": LAID + "\n  base: {kind: fix, part: housing}"},
        "moves.first in bores.in[0]",
        "expected a bore of a part that is placed already, got 'housing.bore 1'; put the move 'base', which places it, "
        "before this one",
    ),
    "three bores": (
        {"tolerances": F, "moves": LAID.replace("housing.bore 2b]", "housing.bore 2b, housing.bore 1]")},
        "moves.last in bores.in",
        "expected a list of 1 to 2 bores, got a list of 3",
    ),
    "the old housing as well": (
        {
            "tolerances": F,
            "more": "\n  case: {kind: housing, expansion: 23e-6 1/K}",
            "moves": LAID.replace("driven: wheel", "driven: wheel, housing: case"),
        },
        "moves.stage.housing",
        "expected none, for both shafts lie in bores, which grow with their parts; got 'case'",
    ),
    "no bores and no centre distance": (
        {"tolerances": F, "moves": "\n  stage: {kind: mesh, driver: pinion, driven: wheel}"},
        "parts.first shaft",
        "kinds of assembly and gearing do not go together in one scene, got 'housing' of assembly and 'first shaft' of "
        "gearing; join them by a move of kind carrier_pins or "
        "a move of kind open_chain or a move of kind shaft_in_bores, or make two scenes",
    ),
}


@pytest.mark.parametrize(("wrong", "place", "words"), WRONG.values(), ids=WRONG)
def test_it_is_refused_with_one_message(wrong: dict[str, Any], place: str, words: str, tmp_path: Path) -> None:
    said = refusal(housed_scene(parts=SHAFTS + GEARS, **wrong), tmp_path)
    assert said.startswith(place), said
    assert "\n" not in said, said
    assert words in said
