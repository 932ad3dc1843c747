"""Brackets: volumes, areas and places against closed forms, and what is refused."""

import math
from typing import Any

import pytest

from tol3d.errors import GeometryError
from tol3d.parts.bracket import bracket
from tol3d.parts.details import Hole

LENGTH, HEIGHT, WIDTH, THICK = 60.0, 50.0, 30.0, 8.0


@pytest.mark.parametrize("fillet", [0.0, 5.0])
def test_a_bracket_is_two_legs_and_what_the_fillet_adds(fillet: float) -> None:
    part = bracket(LENGTH, HEIGHT, WIDTH, THICK, fillet)
    corner = fillet**2 * (1 - math.pi / 4)  # a square less a quarter of a disc
    section = LENGTH * THICK + (HEIGHT - THICK) * THICK + corner
    assert part.solid.isValid()
    assert part.solid.Volume() == pytest.approx(section * WIDTH, rel=1e-9)
    areas = {
        "base outside": LENGTH * WIDTH,
        "base inside": (LENGTH - THICK - fillet) * WIDTH,
        "base end": THICK * WIDTH,
        "upright outside": HEIGHT * WIDTH,
        "upright inside": (HEIGHT - THICK - fillet) * WIDTH,
        "upright end": THICK * WIDTH,
        "front": section,
        "back": section,
    } | ({"fillet": math.pi / 2 * fillet * WIDTH} if fillet else {})
    assert {name: face.Area() for name, face in part.faces.items()} == pytest.approx(areas, rel=1e-9)


def test_the_faces_of_a_bracket_sit_where_they_say_and_look_outwards() -> None:
    faces = bracket(LENGTH, HEIGHT, WIDTH, THICK, 5.0).faces
    places = {
        "base outside": ((30, 0, 0), (0, 0, -1)),
        "base inside": ((36.5, 0, 8), (0, 0, 1)),
        "base end": ((60, 0, 4), (1, 0, 0)),
        "upright outside": ((0, 0, 25), (-1, 0, 0)),
        "upright inside": ((8, 0, 31.5), (1, 0, 0)),
        "upright end": ((4, 0, 50), (0, 0, 1)),
    }
    for name, (place, normal) in places.items():
        assert faces[name].Center().toTuple() == pytest.approx(place, abs=1e-9)
        assert faces[name].normalAt().toTuple() == pytest.approx(normal, abs=1e-12)
    for name, side in (("front", -1), ("back", 1)):
        assert faces[name].Center().y == pytest.approx(15 * side, abs=1e-9)
        assert faces[name].normalAt().toTuple() == pytest.approx((0, side, 0), abs=1e-12)
    # the middle of a quarter of a circle about (13, 13)
    off = 13 - 5 * 2 / math.pi
    assert faces["fillet"].Center().toTuple() == pytest.approx((off, 0, off), abs=1e-9)


def test_holes_in_either_leg_take_their_cylinders() -> None:
    holes = [
        Hole("base through", (40.0, 3.0), 6.0, None, "base inside"),
        Hole("base blind", (25.0, -4.0), 6.0, 5.0, "base outside"),
        Hole("upright through", (2.0, 40.0), 9.0, None, "upright outside"),
        Hole("upright blind", (-5.0, 25.0), 4.0, 3.0, "upright inside"),
    ]
    part = bracket(LENGTH, HEIGHT, WIDTH, THICK, 5.0, holes)
    whole = bracket(LENGTH, HEIGHT, WIDTH, THICK, 5.0)
    away = math.pi * (9 * 8 + 9 * 5 + 4.5**2 * 8 + 4 * 3)
    assert whole.solid.Volume() - part.solid.Volume() == pytest.approx(away, rel=1e-9)
    assert part.faces["base through"].Center().toTuple() == pytest.approx((40, 3, 4), abs=1e-9)
    assert part.faces["base blind floor"].Center().toTuple() == pytest.approx((25, -4, 5), abs=1e-9)
    assert part.faces["upright through"].Center().toTuple() == pytest.approx((4, 2, 40), abs=1e-9)
    assert part.faces["upright blind floor"].Center().toTuple() == pytest.approx((5, -5, 25), abs=1e-9)
    assert part.faces["upright blind floor"].normalAt().toTuple() == pytest.approx((1, 0, 0), abs=1e-12)
    assert set(part.faces.values()) == set(part.solid.Faces())


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "hole in the fillet": (
        {"fillet": 5.0, "holes": [Hole("a", (15.0, 0.0), 6.0, None, "base inside")]},
        "hole 'a' .* leaves the base inside: along x it reaches from 12 mm to 18 mm, the base inside from 13 mm",
    ),
    "hole below the other leg": (
        {"holes": [Hole("a", (4.0, 0.0), 6.0, 3.0, "base outside")]},
        "leaves the base outside: along x",
    ),
    "no such face": ({"holes": [Hole("a", (30.0, 0.0), 6.0)]}, "'top'; expected one of base outside, base inside"),
    "overlap": (
        {"holes": [Hole("a", (30.0, 0.0), 6.0, None, "base inside"), Hole("b", (34.0, 0.0), 6.0, 2.0, "base outside")]},
        "hole 'a' .* and hole 'b' .* overlap",
    ),
    "fillet too large": ({"fillet": 42.0}, "do not reach beyond its thickness of 8 mm and its fillet of 42 mm"),
    "negative fillet": ({"fillet": -1.0}, "fillet of -1 mm"),
    "no thickness": ({"thickness": 0.0}, "0 mm thick"),
    "short leg": ({"length": 8.0}, "do not reach beyond"),
}


@pytest.mark.parametrize(("changed", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_what_makes_no_bracket_is_refused_by_name_and_numbers(changed: dict[str, Any], message: str) -> None:
    sizes = {"length": LENGTH, "height": HEIGHT, "width": WIDTH, "thickness": THICK}
    with pytest.raises(GeometryError, match=message):
        bracket(**(sizes | changed))
