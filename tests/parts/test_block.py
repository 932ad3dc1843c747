"""Blocks: holes and slots in every face, volumes, areas and places against closed forms."""

import math
from typing import Any

import pytest

from tol3d.errors import GeometryError
from tol3d.parts.block import block
from tol3d.parts.details import Hole, Pin, Slot

SIDES = {
    "top": (0, 0, 1),
    "bottom": (0, 0, -1),
    "left": (-1, 0, 0),
    "right": (1, 0, 0),
    "front": (0, -1, 0),
    "back": (0, 1, 0),
}
MIDDLES = {
    "top": (0, 0, 30),
    "bottom": (0, 0, 0),
    "left": (-30, 0, 15),
    "right": (30, 0, 15),
    "front": (0, -20, 15),
    "back": (0, 20, 15),
}


@pytest.mark.parametrize("face", SIDES)
def test_a_hole_goes_in_from_its_face_at_the_coordinates_that_are_left(face: str) -> None:
    """A blind hole 4 mm deep at the place (3, 12) on the face."""
    normal, middle = SIDES[face], MIDDLES[face]
    part = block(60.0, 40.0, 30.0, [Hole("a", (3.0, 12.0), 5.0, 4.0, face)])
    coordinates = iter((3.0, 12.0))
    mouth = [level if axis else next(coordinates) for level, axis in zip(middle, normal, strict=True)]
    floor = [place - 4 * axis for place, axis in zip(mouth, normal, strict=True)]
    assert part.faces["a floor"].Center().toTuple() == pytest.approx(floor, abs=1e-9)
    assert part.faces["a floor"].normalAt().toTuple() == pytest.approx(normal, abs=1e-12)
    half = [place - 2 * axis for place, axis in zip(mouth, normal, strict=True)]
    assert part.faces["a"].Center().toTuple() == pytest.approx(half, abs=1e-9)
    assert part.solid.Volume() == pytest.approx(60 * 40 * 30 - math.pi * 2.5**2 * 4, rel=1e-9)
    assert part.faces[face].normalAt().toTuple() == pytest.approx(normal, abs=1e-12)


@pytest.mark.parametrize("face", SIDES)
def test_the_walls_of_a_slot_are_left_and_right_as_one_looks_onto_its_face(face: str) -> None:
    """Turned by 90 degrees it runs along the second coordinate; left of it is normal x direction."""
    normal, middle = SIDES[face], MIDDLES[face]
    faces = block(60.0, 40.0, 30.0, slots=[Slot("s", (2.0, 11.0), 16.0, 4.0, math.pi / 2, 5.0, face)]).faces
    second = [axis for axis in range(3) if not normal[axis]][1]
    along = [1.0 if axis == second else 0.0 for axis in range(3)]
    left = [
        normal[1] * along[2] - normal[2] * along[1],
        normal[2] * along[0] - normal[0] * along[2],
        normal[0] * along[1] - normal[1] * along[0],
    ]
    coordinates = iter((2.0, 11.0))
    mouth = [level if axis else next(coordinates) for level, axis in zip(middle, normal, strict=True)]
    for wall, side in (("left", 2.0), ("right", -2.0)):
        place = [at - 2.5 * out + side * off for at, out, off in zip(mouth, normal, left, strict=True)]
        assert faces[f"s {wall} wall"].Center().toTuple() == pytest.approx(place, abs=1e-9)
        assert faces[f"s {wall} wall"].Area() == pytest.approx(12 * 5, rel=1e-9)
    off = 6 + 2 * 2 / math.pi  # the middle of half a circle
    place = [at - 2.5 * out + off * way for at, out, way in zip(mouth, normal, along, strict=True)]
    assert faces["s end"].Center().toTuple() == pytest.approx(place, abs=1e-9)


def test_a_block_of_everything_is_the_sum_of_its_pieces() -> None:
    part = block(
        60.0,
        40.0,
        30.0,
        [Hole("down", (-20.0, 10.0), 6.0), Hole("across", (-12.0, 8.0), 5.0, None, "front")],
        [Slot("s", (8.0, 15.0), 14.0, 6.0, 0.0, 10.0, "right")],
        [Pin("pin", (0.0, 0.0), 8.0, 11.0)],
    )
    away = math.pi * 3**2 * 30 + math.pi * 2.5**2 * 40 + (8 * 6 + math.pi * 3**2) * 10
    assert part.solid.isValid()
    assert part.solid.Volume() == pytest.approx(60 * 40 * 30 - away + math.pi * 4**2 * 11, rel=1e-9)
    assert set(part.faces.values()) == set(part.solid.Faces())
    assert len(part.faces) == 6 + 1 + 1 + 5 + 2
    assert part.faces["front"].Area() == pytest.approx(60 * 30 - math.pi * 2.5**2, rel=1e-9)
    assert part.faces["back"].Area() == pytest.approx(60 * 30 - math.pi * 2.5**2, rel=1e-9)


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "cross drilled": (
        {"holes": [Hole("down", (0.0, 0.0), 8.0), Hole("across", (0.0, 15.0), 5.0, None, "front")]},
        "hole 'down' .* and hole 'across' .* overlap",
    ),
    "leaves the right": ({"holes": [Hole("a", (0.0, 28.0), 8.0, 4.0, "right")]}, "leaves the right: along z .* 32 mm"),
    "too deep": ({"holes": [Hole("a", (0.0, 15.0), 8.0, 60.0, "left")]}, "60 mm deep in 60 mm"),
    "no such face": ({"holes": [Hole("a", (0.0, 15.0), 8.0, 6.0, "side")]}, "'side'; expected one of top, bottom"),
    "slot meets hole": (
        {"holes": [Hole("a", (0.0, 0.0), 8.0)], "slots": [Slot("s", (0.0, 15.0), 20.0, 4.0, 0.0, 17.0, "back")]},
        "hole 'a' .* and slot 's' .* overlap",
    ),
}


@pytest.mark.parametrize(("details", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_what_makes_no_block_is_refused_by_name_and_numbers(details: dict[str, Any], message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        block(60.0, 40.0, 30.0, **details)


def test_holes_that_end_before_they_would_meet_are_no_overlap() -> None:
    """The upper hole ends 0.5 mm above the cross hole."""
    upper, across = Hole("down", (0.0, 0.0), 8.0, 12.0), Hole("across", (0.0, 15.0), 5.0, None, "front")
    part = block(60.0, 40.0, 30.0, [upper, across])
    away = math.pi * 16 * 12 + math.pi * 2.5**2 * 40
    assert part.solid.Volume() == pytest.approx(72000 - away, rel=1e-9)


def test_a_block_without_volume_is_refused() -> None:
    with pytest.raises(GeometryError, match="a block of 60 mm by 40 mm by 0 mm has no volume"):
        block(60.0, 40.0, 0.0)
