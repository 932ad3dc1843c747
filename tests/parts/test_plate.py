"""Plates: volumes, areas and faces against closed forms, and what is refused."""

import math
from typing import Any

import pytest

from tol3d.errors import GeometryError
from tol3d.parts.details import Hole, Pin, Slot
from tol3d.parts.plate import plate

FLAT = {"top", "bottom", "left", "right", "front", "back"}
EXACT = 1e-9  # relative; OCC integrates planes and cylinders in closed form


def test_a_plain_plate_is_a_box_about_the_middle_of_its_bottom() -> None:
    part = plate(100.0, 60.0, 10.0)
    assert part.solid.isValid()
    assert part.solid.Volume() == pytest.approx(60000.0, rel=EXACT)
    assert set(part.faces) == FLAT
    places = {
        "top": (0, 0, 10),
        "bottom": (0, 0, 0),
        "left": (-50, 0, 5),
        "right": (50, 0, 5),
        "front": (0, -30, 5),
        "back": (0, 30, 5),
    }
    for name, place in places.items():
        assert part.faces[name].Center().toTuple() == pytest.approx(place, abs=1e-9)
        # outwards: away from the middle of the plate
        away = [end - middle for end, middle in zip(place, (0, 0, 5), strict=True)]
        assert part.faces[name].normalAt().toTuple() == pytest.approx([end / math.hypot(*away) for end in away])


def test_holes_slots_and_pins_take_and_add_what_they_should() -> None:
    part = plate(
        100.0,
        60.0,
        10.0,
        [Hole("through", (20.0, 10.0), 8.0), Hole("blind", (-20.0, 10.0), 6.0, 4.0)],
        [Slot("open", (0.0, -15.0), 30.0, 6.0, 0.3), Slot("groove", (-35.0, -15.0), 16.0, 5.0, math.pi / 2, 3.0)],
        [Pin("pin", (40.0, -20.0), 5.0, 12.0)],
    )
    stadium = {"open": 24 * 6 + math.pi * 3**2, "groove": 11 * 5 + math.pi * 2.5**2}
    away = math.pi * 4**2 * 10 + math.pi * 3**2 * 4 + stadium["open"] * 10 + stadium["groove"] * 3
    assert part.solid.isValid()
    assert part.solid.Volume() == pytest.approx(60000 - away + math.pi * 2.5**2 * 12, rel=EXACT)
    areas = {
        "through": math.pi * 8 * 10,
        "blind": math.pi * 6 * 4,
        "blind floor": math.pi * 3**2,
        "open left wall": 24 * 10,
        "open right wall": 24 * 10,
        "open start": math.pi * 3 * 10,
        "open end": math.pi * 3 * 10,
        "groove left wall": 11 * 3,
        "groove right wall": 11 * 3,
        "groove start": math.pi * 2.5 * 3,
        "groove end": math.pi * 2.5 * 3,
        "groove floor": stadium["groove"],
        "pin": math.pi * 5 * 12,
        "pin end": math.pi * 2.5**2,
        "top": 6000 - math.pi * (16 + 9 + 6.25) - sum(stadium.values()),
        "bottom": 6000 - math.pi * 16 - stadium["open"],
        "left": 600,
        "right": 600,
        "front": 1000,
        "back": 1000,
    }
    assert {name: face.Area() for name, face in part.faces.items()} == pytest.approx(areas, rel=EXACT)
    assert set(part.faces.values()) == set(part.solid.Faces())


def test_the_walls_of_a_slot_are_left_and_right_of_its_direction() -> None:
    turned = math.radians(30)
    faces = plate(100.0, 60.0, 10.0, slots=[Slot("slot", (5.0, -3.0), 40.0, 8.0, turned)]).faces
    along, left = (math.cos(turned), math.sin(turned)), (-math.sin(turned), math.cos(turned))
    for wall, side in (("left", 4.0), ("right", -4.0)):
        face = faces[f"slot {wall} wall"]
        assert face.Center().toTuple() == pytest.approx((5 + side * left[0], -3 + side * left[1], 5), abs=1e-9)
        inwards = -math.copysign(1.0, side)
        assert face.normalAt().toTuple() == pytest.approx((inwards * left[0], inwards * left[1], 0), abs=1e-9)
    # the middle of half a circle's arc is 2/pi of its radius off
    for end, sign in (("start", -1), ("end", 1)):
        off = sign * (16 + 4 * 2 / math.pi)
        assert faces[f"slot {end}"].Center().toTuple() == pytest.approx((5 + off * along[0], -3 + off * along[1], 5))


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "leaves": ({"holes": [Hole("a", (48.0, 0.0), 8.0)]}, r"hole 'a' .* leaves the top: along x .* 44 mm to 52 mm"),
    "tangent": ({"holes": [Hole("a", (0.0, 26.0), 8.0)]}, r"leaves the top: along y"),
    "overlap": (
        {"holes": [Hole("a", (0.0, 0.0), 8.0), Hole("b", (6.0, 0.0), 4.1)]},
        r"hole 'a' \(diameter 8 mm at \[0, 0\] mm\) and hole 'b' .*overlap",
    ),
    "one in the other": ({"holes": [Hole("a", (0.0, 0.0), 8.0), Hole("b", (1.0, 0.0), 2.0)]}, "overlap"),
    "twice a name": ({"holes": [Hole("a", (0.0, 0.0), 8.0)], "pins": [Pin("a", (20.0, 0.0), 3.0, 4.0)]}, "called 'a'"),
    "name of a face": ({"holes": [Hole("top", (0.0, 0.0), 8.0)]}, "called 'top'"),
    "too deep": ({"holes": [Hole("a", (0.0, 0.0), 8.0, 10.0)]}, "10 mm deep in 10 mm"),
    "no size": ({"holes": [Hole("a", (0.0, 0.0), 0.0)]}, "hole 'a' .* no size"),
    "round slot": ({"slots": [Slot("s", (0.0, 0.0), 8.0, 8.0)]}, "slot 's' .* no longer than wide"),
    "slot leaves": ({"slots": [Slot("s", (0.0, 0.0), 70.0, 8.0, math.pi / 2)]}, "slot 's' .* leaves the top: along y"),
    "pin in a hole": (
        {"holes": [Hole("a", (0.0, 0.0), 20.0, 5.0)], "pins": [Pin("p", (0.0, 8.0), 3.0, 4.0)]},
        "pin 'p' .* and hole 'a' .* overlap",
    ),
    "flat pin": ({"pins": [Pin("p", (0.0, 8.0), 3.0, 0.0)]}, "pin 'p' .* 0 mm high"),
}


@pytest.mark.parametrize(("details", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_what_makes_no_plate_is_refused_by_name_and_numbers(details: dict[str, Any], message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        plate(100.0, 60.0, 10.0, **details)


@pytest.mark.parametrize("sizes", [(0.0, 60.0, 10.0), (100.0, -1.0, 10.0), (100.0, 60.0, 0.0)])
def test_a_plate_without_volume_is_refused(sizes: tuple[float, float, float]) -> None:
    with pytest.raises(GeometryError, match="no volume"):
        plate(*sizes)
