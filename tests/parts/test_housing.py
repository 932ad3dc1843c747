"""Housings: the one of scenes/housed_gears.yaml, volumes, areas and places against closed forms, what is refused."""

import math
from typing import Any

import numpy as np
import pytest
from places import SCENES

from tol3d import load_scene
from tol3d.errors import GeometryError
from tol3d.parts.details import Bore, Boss, Hole, Pin
from tol3d.parts.housing import housing

CORNER, SIZE = (-35.0, -60.0, -40.0), (200.0, 150.0, 80.0)  # round two stages of spur gears
BORES = [
    Bore("input bore", (0.0, 0.0), 22.0, "back"),
    Bore("far input bore", (0.0, 0.0), 22.0, "front"),
    Bore("middle bore", (52.5, 0.0), 22.0, "back"),
    Bore("far middle bore", (52.5, 0.0), 22.0, "front"),
    Bore("output bore", (102.9, 37.8), 35.0, "back"),
    Bore("far output bore", (102.9, 37.8), 35.0, "front"),
]
SCREWS = [
    Hole(f"screw {number}", place, 5.0, 18.0, "rim")
    for number, place in enumerate([(-29.0, -34.0), (159.0, -34.0), (159.0, 34.0), (-29.0, 34.0)], start=1)
]


def volume(walls: float, floor: float) -> float:
    """Volume of the open box."""
    x, y, z = SIZE
    return x * y * z - (x - 2 * walls) * (y - floor) * (z - 2 * walls)


def test_a_housing_is_a_box_less_its_hollow_its_bores_and_its_holes() -> None:
    part = housing(
        CORNER,
        SIZE,
        12.0,
        10.0,
        BORES,
        [*SCREWS, Hole("foot", (20.0, 5.0), 9.0, None, "bottom")],
        [Boss("boss", (102.9, 37.8), 55.0, 6.0, "front"), Boss("pad", (20.0, -35.0), 16.0, 3.0, "back")],
    )
    bores = math.pi * (4 * 11**2 * 12 + 2 * 17.5**2 * 12)
    boss = math.pi * ((27.5**2 - 17.5**2) * 6 + 8**2 * 3)
    holes = math.pi * (4 * 2.5**2 * 18 + 4.5**2 * 10)
    assert part.solid.isValid()
    assert part.solid.ShapeType() == "Solid"
    assert part.solid.Volume() == pytest.approx(volume(12.0, 10.0) - bores + boss - holes, rel=1e-9)
    assert set(part.faces.values()) == set(part.solid.Faces())
    assert len(part.faces) == 6 + 5 + 6 + 4 * 2 + 1 + 2 * 2
    assert part.faces["rim"].Area() == pytest.approx(200 * 80 - 176 * 56 - 4 * math.pi * 2.5**2, rel=1e-9)
    assert part.faces["far output bore"].Area() == pytest.approx(math.pi * 35 * (12 + 6), rel=1e-9)
    assert part.faces["boss end"].Area() == pytest.approx(math.pi * (27.5**2 - 17.5**2), rel=1e-9)
    assert part.faces["boss end"].Center().toTuple() == pytest.approx((102.9, 37.8, 46), abs=1e-9)
    assert part.faces["pad end"].Center().toTuple() == pytest.approx((20, -35, -43), abs=1e-9)
    assert part.faces["screw 3 floor"].Center().toTuple() == pytest.approx((159, 72, 34), abs=1e-9)
    assert part.faces["foot"].Center().toTuple() == pytest.approx((20, -55, 5), abs=1e-9)


def test_the_faces_of_a_housing_sit_where_they_say_and_look_out_of_the_material() -> None:
    faces = housing(CORNER, SIZE, 12.0, 10.0).faces
    places = {
        "rim": ((65, 90, 0), (0, 1, 0)),
        "bottom": ((65, -60, 0), (0, -1, 0)),
        "left": ((-35, 15, 0), (-1, 0, 0)),
        "right": ((165, 15, 0), (1, 0, 0)),
        "front": ((65, 15, 40), (0, 0, 1)),
        "back": ((65, 15, -40), (0, 0, -1)),
        "floor": ((65, -50, 0), (0, 1, 0)),
        "inside left": ((-23, 20, 0), (1, 0, 0)),
        "inside right": ((153, 20, 0), (-1, 0, 0)),
        "inside front": ((65, 20, 28), (0, 0, -1)),
        "inside back": ((65, 20, -28), (0, 0, 1)),
    }
    assert set(faces) == set(places)
    for name, (place, normal) in places.items():
        assert faces[name].Center().toTuple() == pytest.approx(place, abs=1e-9)
        assert faces[name].normalAt().toTuple() == pytest.approx(normal, abs=1e-12)


def test_the_housing_of_the_geared_scene_has_its_bores_where_the_scene_s_features_are() -> None:
    """Each bore's cylinder against place, length and diameter that stand in scenes/housed_gears.yaml."""
    features: Any = load_scene(SCENES / "housed_gears.yaml").parts["housing"]
    faces = housing(CORNER, SIZE, 12.0, 12.0, BORES).faces
    found = {name: own for name, own in features.features.items() if own.kind == "cylinder"}
    assert set(found) == {bore.name for bore in BORES}
    for name, own in found.items():
        diameter, length = own.diameter.internal, own.length.internal
        assert faces[name].geomType() == "CYLINDER"
        assert faces[name].Center().toTuple() == pytest.approx(own.origin.tolist(), abs=1e-9)
        assert faces[name].Area() == pytest.approx(math.pi * diameter * length, rel=1e-9)


def test_the_gears_of_the_scene_turn_inside_without_touching() -> None:
    """Tip circles, reference diameter and two modules: the hollow must reach beyond each of them."""
    parts: Any = load_scene(SCENES / "housed_gears.yaml").parts
    faces = housing(CORNER, SIZE, 12.0, 12.0, BORES).faces
    axes = {"first pinion": (0, 0), "first wheel": (52.5, 0), "second pinion": (52.5, 0), "second wheel": (102.9, 37.8)}
    centres = {"first pinion": -12, "first wheel": -12, "second pinion": 12, "second wheel": 12}
    hollow = {name: faces[f"inside {name}"].Center() for name in ("left", "right", "front", "back")}
    for name, (x, y) in axes.items():
        gear = parts[name]
        tip = gear.module.internal * (gear.teeth + 2) / 2
        half = gear.face_width.internal / 2
        assert x - tip > hollow["left"].x
        assert x + tip < hollow["right"].x
        assert y - tip > faces["floor"].Center().y
        assert y + tip < faces["rim"].Center().y
        assert np.abs(centres[name]) + half < min(hollow["front"].z, -hollow["back"].z)


def test_a_cup_is_open_at_its_front_and_has_its_bores_in_its_floor() -> None:
    """200 mm by 150 mm by 80 mm about (65, 15, 0), walls of 12 mm, a floor of 9 mm at the back."""
    part = housing(
        CORNER,
        SIZE,
        12.0,
        9.0,
        [Bore("bore", (20.0, 10.0), 30.0, "back"), Bore("small", (90.0, 10.0), 8.0, "back")],
        [
            Hole("screw", (-29.0, 0.0), 5.0, 18.0, "rim"),
            Hole("drain", (80.0, 5.0), 7.0, None, "bottom"),
            Hole("vent", (40.0, 5.0), 6.0, 4.0, "top"),
            Hole("cap", (42.0, 10.0), 4.0, 11.0, "back"),
        ],
        [Boss("boss", (20.0, 10.0), 54.0, 7.0, "back")],
        [Pin("dowel", (159.0, 40.0), 6.0, 11.0)],
        "front",
    )
    away = math.pi * (15**2 * 16 + 4**2 * 9 + 2.5**2 * 18 + 3.5**2 * 12 + 3**2 * 4 + 2**2 * 11)
    boxes = 200 * 150 * 80 - 176 * 126 * 71
    assert part.solid.isValid()
    assert part.solid.Volume() == pytest.approx(boxes - away + math.pi * (27**2 * 7 + 3**2 * 11), rel=1e-9)
    assert set(part.faces.values()) == set(part.solid.Faces())
    rim = 200 * 150 - 176 * 126 - math.pi * (2.5**2 + 3**2)
    assert part.faces["rim"].Area() == pytest.approx(rim, rel=1e-9)
    assert part.faces["rim"].Center().z == pytest.approx(40.0, abs=1e-9)
    places = {
        "left": ((-35, 15, 0), (-1, 0, 0)),
        "right": ((165, 15, 0), (1, 0, 0)),
        "inside left": ((-23, 15, 4.5), (1, 0, 0)),
        "inside right": ((153, 15, 4.5), (-1, 0, 0)),
        "vent floor": ((40, 86, 5), (0, 1, 0)),
        "dowel end": ((159, 40, 51), (0, 0, 1)),
        "screw floor": ((-29, 0, 22), (0, 0, 1)),
        "cap floor": ((42, 10, -36), (0, 0, -1)),
        "bore": ((20, 10, -39), None),
        "small": ((90, 10, -35.5), None),
        "drain": ((80, -54, 5), None),
    }
    for name, (place, normal) in places.items():
        assert part.faces[name].Center().toTuple() == pytest.approx(place, abs=1e-9), name
        assert normal is None or part.faces[name].normalAt().toTuple() == pytest.approx(normal, abs=1e-12), name
    levels = {"top": (1, 90, 1), "bottom": (1, -60, -1), "back": (2, -40, -1), "floor": (2, -31, 1)}
    levels |= {"inside top": (1, 78, -1), "inside bottom": (1, -48, 1), "rim": (2, 40, 1), "boss end": (2, -47, -1)}
    for name, (axis, level, sign) in levels.items():
        assert part.faces[name].Center().toTuple()[axis] == pytest.approx(level, abs=1e-9), name
        assert part.faces[name].normalAt().toTuple()[axis] == pytest.approx(sign, abs=1e-12), name


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "bore leaves its wall": (
        {"bores": [Bore("a", (-20.0, 0.0), 22.0, "front")]},
        "bore 'a' .* leaves the front: along x it reaches from -31 mm to -9 mm, the front from -23 mm",
    ),
    "bore in the rim": ({"bores": [Bore("a", (50.0, 80.0), 22.0, "back")]}, "leaves the back: along y .* 91 mm"),
    "bore in a side": ({"bores": [Bore("a", (50.0, 0.0), 22.0, "left")]}, "expected the front or the back"),
    "bores overlap": (
        {"bores": [Bore("a", (0.0, 0.0), 22.0, "back"), Bore("b", (30.0, 0.0), 40.0, "back")]},
        "bore 'a' .* and bore 'b' .* overlap",
    ),
    "no bore": ({"bores": [Bore("a", (0.0, 0.0), 0.0, "back")]}, "bore 'a' .* no size"),
    "half in a boss": (
        {"bores": [Bore("a", (0.0, 0.0), 22.0, "back")], "bosses": [Boss("b", (15.0, 0.0), 30.0, 5.0, "back")]},
        "bore 'a' .* lies neither in boss 'b' .* nor clear of it",
    ),
    "boss leaves": ({"bosses": [Boss("b", (-30.0, 0.0), 30.0, 5.0, "back")]}, "boss 'b' .* leaves the back"),
    "bosses overlap": (
        {"bosses": [Boss("b", (0.0, 0.0), 30.0, 5.0, "back"), Boss("c", (20.0, 0.0), 30.0, 5.0, "back")]},
        "boss 'b' .* and boss 'c' .* overlap",
    ),
    "hole in the opening": (
        {"holes": [Hole("a", (-25.0, 0.0), 5.0, 10.0, "rim")]},
        "hole 'a' .* leaves the rim: its axis is 2 mm from the opening",
    ),
    "hole outside": ({"holes": [Hole("a", (-34.0, 0.0), 5.0, 10.0, "rim")]}, "leaves the rim: along x"),
    "screw meets a bore": (
        {"bores": [Bore("a", (0.0, 60.0), 30.0, "back")], "holes": [Hole("s", (0.0, -34.0), 5.0, 20.0, "rim")]},
        "bore 'a' .* and hole 's' .* overlap",
    ),
    "hole in the opening's side": (
        {"holes": [Hole("a", (0.0, 0.0), 5.0)]},
        "'top'; expected one of rim, bottom, left, right, front, back",
    ),
    "hole in a side, over a wall": (
        {"holes": [Hole("a", (85.0, 30.0), 5.0, None, "left")]},
        "leaves the left: along z",
    ),
    "wall drilled too deep": ({"holes": [Hole("a", (50.0, 0.0), 5.0, 12.0, "right")]}, "12 mm deep in 12 mm"),
    "half in a boss, a hole": (
        {"holes": [Hole("a", (0.0, 0.0), 5.0, None, "back")], "bosses": [Boss("b", (15.0, 0.0), 30.0, 5.0, "back")]},
        "hole 'a' .* lies neither in boss 'b' .* nor clear of it",
    ),
    "pin in the opening": ({"pins": [Pin("p", (-25.0, 0.0), 5.0, 9.0)]}, "pin 'p' .* leaves the rim: its axis is 2 mm"),
    "pin on a screw": (
        {"pins": [Pin("p", (-29.0, 30.0), 5.0, 9.0)], "holes": [SCREWS[3]]},
        "hole 'screw 4' .* and pin 'p' .* overlap",
    ),
    "bore in the opening": (
        {"opening": "front", "bores": [Bore("a", (0.0, 0.0), 22.0, "front")]},
        "bore 'a' .*: expected the back, a wall",
    ),
    "boss on the opening": (
        {"opening": "front", "bosses": [Boss("a", (0.0, 0.0), 22.0, 3.0, "front")]},
        "boss 'a' .*: expected the back, a wall",
    ),
    "open elsewhere": ({"opening": "left"}, "opens at its top or its front, got 'left'"),
    "floor of a cup": (
        {"opening": "front", "floor": 80.0},
        "a floor of 80 mm leaves nothing inside a housing of 80 mm along z",
    ),
    "below a wall": ({"holes": [Hole("a", (-20.0, 0.0), 8.0, None, "bottom")]}, "leaves the bottom: along x"),
    "thick walls": ({"walls": 40.0}, "walls of 40 mm leave nothing inside a housing of 80 mm along z"),
    "thick floor": ({"floor": 151.0}, "a floor of 151 mm leaves nothing inside a housing of 150 mm along y"),
    "no walls": ({"walls": 0.0}, "walls of 0 mm"),
    "no size": ({"size": (200.0, -1.0, 80.0)}, "has no volume"),
    "twice a name": (
        {"bores": [Bore("a", (0.0, 0.0), 22.0, "back"), Bore("a", (0.0, 0.0), 22.0, "front")]},
        "two faces of the housing are called 'a'",
    ),
    "name of a face": ({"bores": [Bore("floor", (0.0, 0.0), 22.0, "back")]}, "called 'floor'"),
}


@pytest.mark.parametrize(("changed", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_what_makes_no_housing_is_refused_by_name_and_numbers(changed: dict[str, Any], message: str) -> None:
    plain: dict[str, Any] = {"corner": CORNER, "size": SIZE, "walls": 12.0, "floor": 10.0}
    with pytest.raises(GeometryError, match=message):
        housing(**(plain | changed))
