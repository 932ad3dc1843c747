"""Random machined parts: valid ones against the sum of their pieces; which details meet, against distances by hand."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.random import Generator

from tol3d.errors import GeometryError
from tol3d.parts.block import block
from tol3d.parts.bracket import bracket
from tol3d.parts.cover import cover
from tol3d.parts.details import Bore, Boss, Hole, Pin, Slot, Spigot
from tol3d.parts.housing import housing
from tol3d.parts.plate import plate

EXACT = 1e-9  # relative; sums of boxes, cylinders and stadiums
PARTS = 200


def disc(diameter: float) -> float:
    return math.pi * diameter**2 / 4


def stadium(length: float, width: float) -> float:
    return (length - width) * width + disc(width)


def cells(low: tuple[float, float], high: tuple[float, float], columns: int, rows: int) -> list[tuple[float, float]]:
    """Middles of equal cells of a rectangle."""
    xs = low[0] + (np.arange(columns) + 0.5) * (high[0] - low[0]) / columns
    ys = low[1] + (np.arange(rows) + 0.5) * (high[1] - low[1]) / rows
    return [(float(x), float(y)) for x in xs for y in ys]


def random_plate(rng: Generator) -> tuple[Any, float, int]:
    """A plate with one detail or none in each of its cells; its volume, and how many faces it has."""
    length, width, thick = rng.uniform(5, 500), rng.uniform(5, 500), rng.uniform(0.5, 60)
    columns, rows = int(rng.integers(1, 5)), int(rng.integers(1, 5))
    room = 0.98 * min(length / columns, width / rows)
    holes, slots, pins = [], [], []
    volume, faces = length * width * thick, 6
    for number, at in enumerate(cells((-length / 2, -width / 2), (length / 2, width / 2), columns, rows)):
        name, size, depth = f"own {number}", room * rng.uniform(0.05, 1.0), thick * rng.uniform(0.05, 0.95)
        match rng.integers(6):
            case 0:
                holes.append(Hole(name, at, size))
                volume, faces = volume - disc(size) * thick, faces + 1
            case 1:
                holes.append(Hole(name, at, size, depth))
                volume, faces = volume - disc(size) * depth, faces + 2
            case 2 | 3 as blind:
                narrow, turned = size * rng.uniform(0.1, 0.9), rng.uniform(-4, 4)
                slots.append(Slot(name, at, size, narrow, turned, depth if blind == 2 else None))
                volume -= stadium(size, narrow) * (depth if blind == 2 else thick)
                faces += 5 if blind == 2 else 4
            case 4:
                pins.append(Pin(name, at, size, depth))
                volume, faces = volume + disc(size) * depth, faces + 2
            case _:
                pass
    return plate(length, width, thick, holes, slots, pins), volume, faces


def random_block(rng: Generator) -> tuple[Any, float, int]:
    """A block with shallow holes in the cells of all faces: no two meet, for each ends within its face's own shell."""
    size = rng.uniform(20, 300, 3)
    shell = 0.2 * size.min()
    low, high = np.array([-size[0] / 2, -size[1] / 2, 0.0]), np.array([size[0] / 2, size[1] / 2, size[2]])
    holes, volume = [], float(size.prod())
    for face, axis in (("top", 2), ("bottom", 2), ("left", 0), ("right", 0), ("front", 1), ("back", 1)):
        first, second = (own for own in range(3) if own != axis)
        room = 0.9 * min(size[first] - 2 * shell, size[second] - 2 * shell) / 2
        inner = [(float(low[own] + shell), float(high[own] - shell)) for own in (first, second)]
        for number, at in enumerate(cells((inner[0][0], inner[1][0]), (inner[0][1], inner[1][1]), 2, 2)):
            if rng.random() < 0.6:
                wide, depth = float(room * rng.uniform(0.1, 1.0)), float(shell * rng.uniform(0.1, 0.95))
                holes.append(Hole(f"{face} {number}", at, wide, depth, face))
                volume -= disc(wide) * depth
    return block(*(float(own) for own in size), holes), volume, 6 + 2 * len(holes)


def random_bracket(rng: Generator) -> tuple[Any, float, int]:
    thick, width = rng.uniform(1, 20), rng.uniform(5, 200)
    fillet = float(rng.choice([0.0, 1.0]) * rng.uniform(0.1, 30))
    length, height = (thick + fillet + rng.uniform(5, 200, 2)).tolist()
    volume = width * (thick * (length + height - thick) + fillet**2 * (1 - math.pi / 4))
    holes = []
    for leg, reach in (("base", length), ("upright", height)):
        for side, (at, room) in zip(
            ("outside", "inside"),
            ((-width / 4, min(width / 2, reach - thick - fillet)), (width / 4, min(width / 2, reach - thick - fillet))),
            strict=True,
        ):
            middle = (reach + thick + fillet) / 2
            wide, deep = 0.95 * room * rng.uniform(0.1, 1), rng.choice([0.0, 0.6 * thick])
            place = (middle, at) if leg == "base" else (at, middle)
            holes.append(Hole(f"{leg} {side} hole", place, wide, deep or None, f"{leg} {side}"))
            volume -= disc(wide) * (deep or thick)
    faces = 8 + (fillet > 0) + len(holes) + sum(hole.depth is not None for hole in holes)
    return bracket(length, height, width, thick, fillet, holes), volume, faces


def random_housing(rng: Generator) -> tuple[Any, float, int]:
    """Bores, some of them in bosses, in cells of the end walls; blind holes along two sides of the rim."""
    size, corner = rng.uniform(40, 400, 3), rng.uniform(-200, 200, 3)
    walls, floor = rng.uniform(0.05, 0.3, 2) * size.min()
    low, high = corner + np.array([walls, floor, walls]), corner + size - np.array([walls, 0, walls])
    volume = size.prod() - (high - low).prod()
    bores, bosses, holes = [], [], []
    columns, rows = int(rng.integers(1, 4)), int(rng.integers(1, 3))
    room = 0.95 * min((high[0] - low[0]) / columns, (high[1] - low[1]) / rows)
    faces = 11
    for wall in ("front", "back"):
        for number, at in enumerate(cells(tuple(low[:2]), tuple(high[:2]), columns, rows)):
            wide, deep = room * rng.uniform(0.1, 0.7), walls
            if rng.random() < 0.4:
                rise, round_ = rng.uniform(1, 20), room * rng.uniform(0.75, 1.0)
                bosses.append(Boss(f"{wall} boss {number}", at, round_, rise, wall))
                volume, deep, faces = volume + disc(round_) * rise, deep + rise, faces + 2
            bores.append(Bore(f"{wall} bore {number}", at, wide, wall))
            volume, faces = volume - disc(wide) * deep, faces + 1
    for number, z in enumerate(np.linspace(low[2], high[2], 4)):
        for side, x in (("left", (corner[0] + low[0]) / 2), ("right", (corner[0] + size[0] + high[0]) / 2)):
            wide = min(walls, (high[2] - low[2]) / 3) * rng.uniform(0.1, 0.9)
            deep = size[1] * rng.uniform(0.05, 0.9)
            holes.append(Hole(f"{side} hole {number}", (x, float(z)), wide, deep, "rim"))
            volume, faces = volume - disc(wide) * deep, faces + 2
    made = housing(tuple(corner), tuple(size), walls, floor, bores, holes, bosses)
    assert made.faces["rim"].Area() == pytest.approx(
        size[0] * size[2] - (high - low)[[0, 2]].prod() - sum(disc(hole.diameter) for hole in holes), rel=EXACT
    )
    return made, float(volume), faces


def random_cup(rng: Generator) -> tuple[Any, float, int]:
    """Open at its front: bores in its floor, pins and blind holes along the rim, holes through the sides."""
    size, corner = rng.uniform(40, 400, 3), rng.uniform(-200, 200, 3)
    walls, floor = rng.uniform(0.05, 0.3, 2) * size.min()
    low, high = corner + np.array([walls, walls, floor]), corner + size - np.array([walls, walls, 0])
    volume, faces = size.prod() - (high - low).prod(), 11
    bores, holes, pins = [], [], []
    columns, rows = int(rng.integers(1, 4)), int(rng.integers(1, 3))
    room = 0.95 * min((high[0] - low[0]) / columns, (high[1] - low[1]) / rows)
    for number, at in enumerate(cells(tuple(low[:2]), tuple(high[:2]), columns, rows)):
        wide = room * rng.uniform(0.1, 1.0)
        bores.append(Bore(f"bore {number}", at, wide, "back"))
        volume, faces = volume - disc(wide) * floor, faces + 1
    for number, x in enumerate(np.linspace(low[0], high[0], 4)):
        wide = min(walls, (high[0] - low[0]) / 3) * rng.uniform(0.1, 0.9)
        tall = size[2] * rng.uniform(0.05, 0.9)
        holes.append(Hole(f"hole {number}", (float(x), (corner[1] + low[1]) / 2), wide, tall, "rim"))
        pins.append(Pin(f"pin {number}", (float(x), (corner[1] + size[1] + high[1]) / 2), wide, tall))
        faces += 4  # what one takes the other adds
    for side in ("left", "right"):
        wide = 0.9 * min(high[1] - low[1], high[2] - low[2]) * rng.uniform(0.1, 1.0)
        holes.append(Hole(side + " window", ((low[1] + high[1]) / 2, (low[2] + high[2]) / 2), wide, None, side))
        volume, faces = volume - disc(wide) * walls, faces + 1
    made = housing(tuple(corner), tuple(size), walls, floor, bores, holes, (), pins, "front")
    return made, float(volume), faces


def random_cover(rng: Generator) -> tuple[Any, float, int]:
    length, width, thick = rng.uniform(30, 400), rng.uniform(30, 400), rng.uniform(1, 30)
    edge, rise = 0.15 * min(length, width), rng.uniform(0.5, 40)
    spigot = Spigot(length - 2 * edge, width - 2 * edge, rise)
    holes, volume = [], length * width * thick + spigot.length * spigot.width * rise
    for number, (x, y) in enumerate([(-1, -1), (1, -1), (1, 1), (-1, 1)]):
        wide = 0.9 * edge * rng.uniform(0.1, 1.0)
        holes.append(Hole(f"screw {number}", (x * (length - edge) / 2, y * (width - edge) / 2), wide))
        volume -= disc(wide) * thick
    wide, deep = 0.5 * min(spigot.length, spigot.width) * rng.uniform(0.1, 1.0), rng.choice([0.0, 0.8 * (thick + rise)])
    holes.append(Hole("filler", (0.0, 0.0), wide, deep or None))
    volume -= disc(wide) * (deep or thick + rise)
    return cover(length, width, thick, holes, spigot), volume, 11 + 5 + bool(deep)


MAKERS = {
    own.__name__: own for own in (random_plate, random_block, random_bracket, random_housing, random_cup, random_cover)
}


def check(make: Callable[[Generator], tuple[Any, float, int]], seed: int) -> None:
    part, volume, faces = make(np.random.default_rng(seed))
    assert part.solid.isValid(), seed
    assert part.solid.ShapeType() == "Solid"
    assert part.solid.Volume() == pytest.approx(volume, rel=EXACT), seed
    assert len(part.faces) == len(part.solid.Faces()) == faces, seed
    assert set(part.faces.values()) == set(part.solid.Faces()), seed
    assert not any("piece" in name for name in part.faces), seed


@pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS.keys())
def test_some_random_parts_are_the_sums_of_their_pieces(make: Callable[[Generator], tuple[Any, float, int]]) -> None:
    for seed in range(4):
        check(make, seed)


@pytest.mark.slow
@pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS.keys())
def test_random_parts_are_the_sums_of_their_pieces(make: Callable[[Generator], tuple[Any, float, int]]) -> None:
    for seed in range(100, 100 + PARTS):
        check(make, seed)


# what meets ---------------------------------------------------------------------------------------------------


def from_segment(x: float, y: float, half: float) -> float:
    """Distance of a point from the segment from (-half, 0) to (half, 0)."""
    return math.hypot(max(abs(x) - half, 0.0), y)


def refused(*details: Any) -> bool:
    holes = [own for own in details if isinstance(own, Hole)]
    slots = [own for own in details if isinstance(own, Slot)]
    pins = [own for own in details if isinstance(own, Pin)]
    try:
        block(100.0, 100.0, 100.0, holes, slots, pins)
    except GeometryError as error:
        return "overlap" in str(error)
    return False


def hole_and_slot(rng: Generator) -> tuple[bool, float]:
    """A slot in the middle and a hole somewhere: what lies between their walls."""
    length, width, wide, turned = rng.uniform(20, 40), rng.uniform(3, 15), rng.uniform(2, 12), rng.uniform(-3, 3)
    x, y = rng.uniform(-30, 30, 2)
    along = x * math.cos(turned) + y * math.sin(turned), y * math.cos(turned) - x * math.sin(turned)
    apart = from_segment(*along, (length - width) / 2) - (width + wide) / 2
    return refused(Hole("h", (x, y), wide), Slot("s", (0.0, 0.0), length, width, turned)), apart


def hole_and_pin(rng: Generator) -> tuple[bool, float]:
    (x, y, u, v), (one, other) = rng.uniform(-20, 20, 4), rng.uniform(2, 25, 2)
    apart = math.hypot(x - u, y - v) - (one + other) / 2
    return refused(Hole("h", (x, y), one, 5.0), Pin("p", (u, v), other, 3.0)), apart


def crossing_holes(rng: Generator) -> tuple[bool, float]:
    """Through, from the top and from the front: their axes are as far apart as their x."""
    (x, u), (one, other) = rng.uniform(-30, 30, 2), rng.uniform(2, 25, 2)
    apart = abs(x - u) - (one + other) / 2
    return refused(Hole("h", (x, rng.uniform(-20, 20)), one), Hole("c", (u, 50.0), other, None, "front")), apart


def holes_from_both_sides(rng: Generator) -> tuple[bool, float]:
    """Blind, from the top and from the bottom: apart by their ends, by their sides or by both."""
    (x, y, u, v), (one, other) = rng.uniform(-15, 15, 4), rng.uniform(2, 25, 2)
    deep, deeper = rng.uniform(5, 90, 2)
    beside = math.hypot(x - u, y - v) - (one + other) / 2
    ends = 100 - deep - deeper
    apart = math.hypot(max(beside, 0.0), max(ends, 0.0)) if max(beside, ends) > 0 else -1.0
    return refused(Hole("h", (x, y), one, deep), Hole("c", (u, v), other, deeper, "bottom")), apart


PAIRS = (hole_and_slot, hole_and_pin, crossing_holes, holes_from_both_sides)
WALL = 1e-3  # mm, the least wall of all


@pytest.mark.parametrize("draw", PAIRS)
def test_details_are_refused_where_nothing_lies_between_them(draw: Callable[[Generator], tuple[bool, float]]) -> None:
    rng = np.random.default_rng(5)
    seen = set()
    for _ in range(25):
        met, apart = draw(rng)
        assert met == (apart < WALL), apart
        seen.add(met)
    assert seen == {True, False}
