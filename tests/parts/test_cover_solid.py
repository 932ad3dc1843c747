"""Covers: volumes, areas and places against closed forms, and what is refused."""

import math
from typing import Any

import pytest

from tol3d.errors import GeometryError
from tol3d.parts.cover import cover
from tol3d.parts.details import Hole, Slot, Spigot


def test_a_cover_is_a_plate_and_a_spigot_less_its_holes() -> None:
    """The hole above the spigot goes through both, the blind one does not, the screw is beside it."""
    holes = [
        Hole("screw", (-94.0, 34.0), 5.5),
        Hole("filler", (10.0, 10.0), 16.0),
        Hole("sight", (60.0, 0.0), 20.0, 9.0),
    ]
    part = cover(200.0, 80.0, 8.0, holes, Spigot(175.0, 55.0, 4.0, (1.0, -2.0)))
    away = math.pi * (2.75**2 * 8 + 8**2 * 12 + 10**2 * 9)
    assert part.solid.isValid()
    assert part.solid.Volume() == pytest.approx(200 * 80 * 8 + 175 * 55 * 4 - away, rel=1e-9)
    areas = {
        "seat": 200 * 80 - 175 * 55 - math.pi * 2.75**2,
        "top": 200 * 80 - math.pi * (2.75**2 + 8**2 + 10**2),
        "left": 640,
        "right": 640,
        "front": 1600,
        "back": 1600,
        "spigot end": 175 * 55 - math.pi * 8**2,
        "spigot left": 55 * 4,
        "spigot right": 55 * 4,
        "spigot front": 175 * 4,
        "spigot back": 175 * 4,
        "screw": math.pi * 5.5 * 8,
        "filler": math.pi * 16 * 12,
        "sight": math.pi * 20 * 9,
        "sight floor": math.pi * 10**2,
    }
    assert {name: face.Area() for name, face in part.faces.items()} == pytest.approx(areas, rel=1e-9)
    places = {
        "spigot end": (None, (0, 0, -1)),
        "spigot left": ((-86.5, -2, -2), (-1, 0, 0)),
        "spigot right": ((88.5, -2, -2), (1, 0, 0)),
        "spigot front": ((1, -29.5, -2), (0, -1, 0)),
        "spigot back": ((1, 25.5, -2), (0, 1, 0)),
        "seat": (None, (0, 0, -1)),
        "top": (None, (0, 0, 1)),
        "left": ((-100, 0, 4), (-1, 0, 0)),
        "front": ((0, -40, 4), (0, -1, 0)),
        "sight floor": ((60, 0, -1), (0, 0, 1)),
    }
    for name, (place, normal) in places.items():
        face = part.faces[name]
        assert face.normalAt().toTuple() == pytest.approx(normal, abs=1e-12)
        assert place is None or face.Center().toTuple() == pytest.approx(place, abs=1e-9)
    assert part.faces["seat"].Center().z == pytest.approx(0.0, abs=1e-9)


def test_slots_of_a_cover_lie_in_the_spigot_or_clear_of_it() -> None:
    """As for a dowel beside the spigot, and a window through it."""
    slots = [
        Slot("dowel", (-93.0, 0.0), 8.0, 5.0, math.pi / 2),
        Slot("window", (20.0, 0.0), 40.0, 12.0),
        Slot("pocket", (-40.0, 10.0), 30.0, 10.0, 0.5, 10.0),
    ]
    part = cover(200.0, 80.0, 8.0, [], Spigot(175.0, 55.0, 4.0), slots)
    stadiums = [3 * 5 + math.pi * 2.5**2, 28 * 12 + math.pi * 6**2, 20 * 10 + math.pi * 5**2]
    away = sum(area * deep for area, deep in zip(stadiums, (8, 12, 10), strict=True))
    assert part.solid.Volume() == pytest.approx(200 * 80 * 8 + 175 * 55 * 4 - away, rel=1e-9)
    assert part.faces["dowel left wall"].Center().toTuple() == pytest.approx((-95.5, 0, 4), abs=1e-9)
    assert part.faces["window left wall"].Center().toTuple() == pytest.approx((20, 6, 2), abs=1e-9)
    assert part.faces["seat"].Area() == pytest.approx(200 * 80 - 175 * 55 - stadiums[0], rel=1e-9)


def test_a_cover_without_a_spigot_is_a_plate_on_its_seat() -> None:
    part = cover(50.0, 40.0, 6.0)
    assert set(part.faces) == {"seat", "top", "left", "right", "front", "back"}
    assert part.solid.Volume() == pytest.approx(12000, rel=1e-9)
    assert part.faces["seat"].Center().toTuple() == pytest.approx((0, 0, 0), abs=1e-9)


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "meets the spigot": (
        {"holes": [Hole("a", (-87.0, 0.0), 8.0)]},
        "hole 'a' .* meets the side of the spigot, which reaches from -87.5 mm to 87.5 mm along x",
    ),
    "slot meets the spigot": (
        {"slots": [Slot("s", (-90.0, 0.0), 12.0, 5.0)]},
        "slot 's' .* meets the side of the spigot",
    ),
    "corner of the spigot": ({"holes": [Hole("a", (-89.0, 29.0), 8.0)]}, "meets the side of the spigot"),
    "wide spigot": ({"spigot": Spigot(201.0, 50.0, 4.0)}, "the spigot .* leaves the seat: along x"),
    "whole seat": ({"spigot": Spigot(200.0, 80.0, 4.0)}, "leaves the seat"),
    "off the seat": ({"spigot": Spigot(175.0, 55.0, 4.0, (15.0, 0.0))}, "leaves the seat: along x .* 102.5 mm"),
    "flat spigot": ({"spigot": Spigot(175.0, 55.0, 0.0)}, "a spigot of .* has no volume"),
    "outside": ({"holes": [Hole("a", (-98.0, 0.0), 8.0)]}, "hole 'a' .* leaves the top"),
    "too deep": ({"holes": [Hole("a", (0.0, 0.0), 8.0, 12.0)]}, "12 mm deep in 12 mm"),
    "from below": ({"holes": [Hole("a", (0.0, 0.0), 8.0, 2.0, "seat")]}, "expected the top"),
    "overlap": ({"holes": [Hole("a", (0.0, 0.0), 8.0), Hole("b", (5.0, 5.0), 8.0, 2.0)]}, "'a' .* and hole 'b' .*over"),
    "name of a face": ({"holes": [Hole("spigot end", (0.0, 0.0), 8.0)]}, "called 'spigot end'"),
    "flat": ({"thickness": 0.0}, "a cover of 200 mm by 80 mm by 0 mm has no volume"),
}


@pytest.mark.parametrize(("changed", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_what_makes_no_cover_is_refused_by_name_and_numbers(changed: dict[str, Any], message: str) -> None:
    plain: dict[str, Any] = {"length": 200.0, "width": 80.0, "thickness": 8.0, "spigot": Spigot(175.0, 55.0, 4.0)}
    with pytest.raises(GeometryError, match=message):
        cover(**(plain | changed))
