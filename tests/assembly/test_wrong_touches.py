"""Errors in a touch are reported once: place, expectation, what came, remedy."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from places import SCENES
from scene_texts import Edit, edited, refusal

BOX = (SCENES / "box_with_discs.yaml").read_text("utf-8")
DISC = "      - {from: lower disc.rim, to: box.left}"
SOCKET = "      - {from: cap.socket, to: ball.surface}"
TOP = "      top: {kind: point"
ROD = "      rod: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 8 mm}"
PIN = ROD.replace("axis, at", "cylinder, diameter: 3 mm, at").replace("rod:", "pin:")
DISC_RIM = "{kind: cylinder, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 8 mm, diameter: 40 mm}"
THREE = """      - {from: lower disc.rim, to: box.left}
      - {from: lower disc.rim, to: box.right}"""
FREE = "expected contacts that are independent of each other where lower disc is `placed`"

WRONG = {
    "an axis without a size": (
        ((TOP, f"{ROD}\n{TOP}"), (SOCKET, "      - {from: cap.rod, to: ball.surface}")),
        "moves.fourth.contacts[0].from",
        "expected a plane or cylinder or sphere or point, got 'cap.rod', which is an axis; did you mean \"cap.top\"?",
    ),
    "nothing round": (
        ((SOCKET, "      - {from: cap.top, to: box.lid}"),),
        "moves.fourth.contacts[0]",
        "expected a cylinder or a sphere on one side at least",
    ),
    "a socket on a plane": (
        ((SOCKET, "      - {from: cap.socket, to: box.floor}"),),
        "moves.fourth.contacts[0]",
        "expected what lies in the hole, got a plane",
    ),
    "a pin in a socket": (
        (
            ("    like: lower disc\n", f"    features:\n{PIN}\n      rim: {DISC_RIM}\n"),
            (SOCKET, "      - {from: cap.socket, to: upper disc.pin}"),
        ),
        "moves.fourth.contacts[0]",
        "expected a sphere or a point in a socket, got a cylinder",
    ),
    "a ball larger than its socket": (
        (("diameter: 12 mm, hole", "diameter: 8 mm, hole"),),
        "moves.fourth.contacts[0]",
        "expected less than the 8 mm of the hole in which it lies, got 10 mm",
    ),
    "a third contact in the plane": (
        ((DISC, THREE),),
        "moves.first",
        "contact of lower disc.rim and box.right constrains what earlier contacts hold; lower disc is still free: "
        f"it shifts along z; {FREE}",
    ),
    "twice on the same floor": (
        ((DISC, "      - {from: lower disc.rim, to: box.floor}"),),
        "moves.first",
        "contact of lower disc.rim and box.floor constrains what earlier contacts hold; lower disc is still free: "
        f"it shifts along x; {FREE}",
    ),
    "in the middle of its hole": (
        (("  cap:\n    kind: solid\n    placed: {at: [45 mm, 4 mm, 0 mm]}",
          "  cap:\n    kind: solid\n    placed: {at: [45 mm, 5 mm, 0 mm]}"),),
        "moves.fourth",
        "contact of cap.socket and ball.surface: lies in its middle, so that there is no direction to it; place cap "
        "towards the contact",
    ),
    "out of reach": (
        (("at: [50 mm, 40 mm, 0 mm]", "at: [90 mm, 40 mm, 0 mm]"),),
        "moves.second",
        "upper disc has no contact even without deviations: expected surfaces that reach each other near where it is "
        "`placed`, and contacts on which it is pressed if it is `pressed`",
    ),
    "seven contacts": (
        ((DISC, "\n".join([DISC] * 6)),),
        "moves.first.contacts",
        "expected a list of 1 to 6 contacts, got a list of 7",
    ),
    "a gap of planes": (
        (("    from: upper disc.rim\n    to: box.lid", "    from: box.floor\n    to: box.lid"),),
        "measures.gap",
        "expected a cylinder or a sphere on one side at least",
    ),
    "a gap of a socket and a plane": (
        (("    from: upper disc.rim\n    to: box.lid", "    from: cap.socket\n    to: box.lid"),),
        "measures.gap",
        "expected what lies in the hole, got a plane",
    ),
    "an angle to nothing": (
        (("    along: [1, 0, 0]           # to a direction", "    # to a direction"),),
        "measures.lean.against",
        "expected either a plane or an axis `against`, or a direction `along`, got neither",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("edits", "place", "said"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_said_once_with_its_place(
    edits: Sequence[Edit], place: str, said: str, tmp_path: Path
) -> None:
    assert refusal(edited(BOX, *edits), tmp_path) == f"{place}: {said}"
