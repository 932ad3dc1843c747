"""Errors of a part at rest are reported once: motions that its contacts do not hold."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from places import SCENES
from scene_texts import Edit, edited, refusal

SHIPPED = (SCENES / "four_pads.yaml").read_text("utf-8")
PADS = SHIPPED[: SHIPPED.index("    relations:")] + SHIPPED[SHIPPED.index("    force:") :]  # it may slide
AT, DIRECTION = "at: [0 mm, 0 mm, 5 mm]", "direction: [0, 0, -1]"
FIRST = "      - {from: plate.bottom, to: table.pad 1}\n      - {from: plate.bottom, to: table.pad 2}\n"
LAST = "      - {from: plate.bottom, to: table.pad 3}\n      - {from: plate.bottom, to: table.pad 4}\n"
FORCE = PADS[PADS.index("    force:") : PADS.index("measures:")]
SIX = 6 * "      - {from: plate.bottom, to: table.pad 1}\n"
WALL = "{from: plate.middle, to: table.pad 1, along: [1, 0, 0]}"
LOCATOR = "{kind: locator, of: plate on the pads, pair: '5', distribution: {kind: constant, value: 1 um}}"
MOVE = "moves.plate on the pads"
HELD = "its contacts do not hold plate against the force"
PRESSED = "the force does not press plate against all of its contacts"

WRONG: dict[str, tuple[Sequence[tuple[str, str]], str, str]] = {
    "beside the pads": ([(AT, "at: [120 mm, 0 mm, 5 mm]")], MOVE, f"{HELD}: it turns about y through (100, 0, 0)"),
    "over an edge": ([(AT, "at: [100 mm, 0 mm, 5 mm]")], MOVE, f"{PRESSED}: it turns about y through (100, 0, 0)"),
    "aslant": ([(DIRECTION, "direction: [1, 0, -1]")], MOVE, f"{HELD}: it shifts along x"),
    "upwards": ([(DIRECTION, "direction: [0, 0, 1]")], MOVE, f"{HELD}: it shifts along z"),
    "nowhere": ([(DIRECTION, "direction: [0, 0, 0]")], f"{MOVE}.force.direction", "a number other than 0, got zeros"),
    "two pads": ([(FIRST, "")], MOVE, f"{HELD}: it turns about x through (0, 60, 0)"),
    "no contacts": ([(f"contacts:\n{FIRST}{LAST}", "contacts: []\n")], f"{MOVE}.contacts", "1 or more contacts"),
    "a wall that nothing presses against": (
        [("points_on: fixture", "points_on: part"), (LAST, f"{LAST}      - {WALL}\n")],
        MOVE,
        f"{PRESSED}: it shifts along x",
    ),
    "rocking where nothing rests": (
        [("kind: rest ", "kind: six_plane "), (f"contacts:\n{FIRST}{LAST}", f"pairs:\n{SIX}"), (FORCE, "")],
        "measures.gap at pad 1.rocking",
        "expected none, for no part of this scene rests on one-sided contacts, got 'largest'",
    ),
    "another word for rocking": (
        [("rocking: largest", "rocking: biggest")],
        "measures.gap at pad 1.rocking",
        "expected one of least, middle, largest, got 'biggest'",
    ),
    "a locator of a contact that is not there": (
        [("\nmoves:\n", f"  loc: {LOCATOR}\nmoves:\n")],
        "tolerances.loc.pair",
        "expected one of 1, 2, 3, 4, got '5'",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("edits", "place", "words"), WRONG.values(), ids=list(WRONG))
def test_a_part_that_cannot_rest_is_refused_with_its_motion(
    edits: Sequence[Edit], place: str, words: str, tmp_path: Path
) -> None:
    said = refusal(edited(PADS, *edits), tmp_path)
    assert said.startswith(f"{place}: ")
    assert words in said
