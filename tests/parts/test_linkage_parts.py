"""Rods, sockets, nuts, screws and thrust rings: volumes, areas and places against closed forms, and what is refused."""

import math
from collections.abc import Callable
from typing import Any

import pytest

from tol3d.errors import GeometryError
from tol3d.parts.ball_screw import ball_screw
from tol3d.parts.ball_socket import ball_socket
from tol3d.parts.ear import Ear
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.nut import nut
from tol3d.parts.rod import rod
from tol3d.parts.thrust_ring import thrust_ring

DEGREE = math.pi / 180


def cap(radius: float, height: float) -> float:
    """Volume of a spherical cap."""
    return math.pi * height**2 * (3 * radius - height) / 3


def disc(diameter: float) -> float:
    return math.pi * diameter**2 / 4


def ear_beyond(outside: float, reach: float, width: float) -> float:
    """Area of an ear outside its disc: a rectangle and half a disc, less the segment of the disc below them."""
    half = width / 2
    root = math.sqrt(outside**2 - half**2)
    segment = outside**2 * math.asin(half / outside) - half * root
    return (reach - root) * width + math.pi * half**2 / 2 - segment


def well_made(part: NamedSolid) -> None:
    assert part.solid.isValid()
    assert part.solid.ShapeType() == "Solid"
    assert set(part.faces.values()) == set(part.solid.Faces())
    assert len(part.faces) == len(part.solid.Faces())


def sphere_of(part: NamedSolid, name: str) -> list[float]:
    """Centre and radius of a spherical face."""
    face = part.faces[name]
    assert face.geomType() == "SPHERE"
    made = face._geomAdaptor().Sphere()
    place = made.Location()
    return [place.X(), place.Y(), place.Z(), made.Radius()]


def test_a_rod_is_a_cylinder_between_two_balls_less_their_caps() -> None:
    part = rod(260.0, 8.0, 16.0)
    well_made(part)
    begin = math.sqrt(8**2 - 4**2)
    volume = 2 * (4 / 3 * math.pi * 8**3 - cap(8, 8 - begin)) + disc(8) * (260 - 2 * begin)
    assert part.solid.Volume() == pytest.approx(volume, rel=1e-12)
    areas = {
        "bottom ball": 2 * math.pi * 8 * (8 + begin),
        "side": math.pi * 8 * (260 - 2 * begin),
        "top ball": 2 * math.pi * 8 * (8 + begin),
    }
    assert {name: face.Area() for name, face in part.faces.items()} == pytest.approx(areas, rel=1e-12)
    assert sphere_of(part, "bottom ball") == pytest.approx([0, 0, 0, 8], abs=1e-12)
    assert sphere_of(part, "top ball") == pytest.approx([0, 0, 260, 8], abs=1e-12)


@pytest.mark.parametrize("mouth", [16.0, 14.0])
def test_a_socket_is_a_cylinder_less_the_ball_up_to_its_mouth(mouth: float) -> None:
    part = ball_socket(16.0, mouth, 26.0, 12.0)
    well_made(part)
    rim = math.sqrt(8**2 - (mouth / 2) ** 2)
    away = 4 / 3 * math.pi * 8**3 - cap(8, 8 - rim)
    assert part.solid.Volume() == pytest.approx(disc(26) * (12 + rim) - away, rel=1e-9)
    assert part.faces["seat"].Area() == pytest.approx(2 * math.pi * 8 * (8 + rim), rel=1e-9)
    assert part.faces["rim"].Area() == pytest.approx(disc(26) - disc(mouth), rel=1e-9)
    assert part.faces["rim"].Center().z == pytest.approx(rim, abs=1e-9)
    assert sphere_of(part, "seat") == pytest.approx([0, 0, 0, 8], abs=1e-12)


def test_a_screw_is_three_cylinders() -> None:
    part = ball_screw(16.0, 300.0, (12.0, 20.0))
    well_made(part)
    assert part.solid.Volume() == pytest.approx(disc(16) * 260 + 2 * disc(12) * 20, rel=1e-12)
    assert part.faces["thread"].Area() == pytest.approx(math.pi * 16 * 260, rel=1e-12)
    places = {"bottom": 0, "lower shoulder": 20, "upper shoulder": 280, "top": 300}
    assert {name: part.faces[name].Center().z for name in places} == pytest.approx(places, abs=1e-9)
    plain = ball_screw(16.0, 300.0)
    well_made(plain)
    assert set(plain.faces) == {"bottom", "thread", "top"}
    assert plain.solid.Volume() == pytest.approx(disc(16) * 300, rel=1e-12)


def test_a_nut_is_a_disc_with_an_ear_less_bore_and_half_a_ball() -> None:
    part = nut(32.0, 24.0, 16.0, 32.0, 24.0, 16.0)
    well_made(part)
    section = disc(32) + ear_beyond(16, 32, 24) - disc(16)
    assert part.solid.Volume() == pytest.approx(section * 24 - 2 / 3 * math.pi * 8**3, rel=1e-9)
    assert part.faces["seat"].Area() == pytest.approx(2 * math.pi * 8**2, rel=1e-9)
    assert sphere_of(part, "seat") == pytest.approx([32, 0, 24, 8], abs=1e-12)
    assert part.faces["top"].Area() == pytest.approx(section - disc(16), rel=1e-9)
    assert part.faces["bottom"].Area() == pytest.approx(section, rel=1e-9)
    assert part.faces["top"].normalAt().toTuple() == pytest.approx((0, 0, 1), abs=1e-12)
    assert part.faces["ear left"].Center().y == pytest.approx(12)
    assert part.faces["ear right"].Center().y == pytest.approx(-12)


def ring(*ears: Ear, **changed: float) -> NamedSolid:
    sizes = {"inner_diameter": 112.0, "outer_diameter": 140.0, "thickness": 14.0, "radius": 80.0}
    sizes |= {"ear_width": 24.0, "ball_diameter": 16.0} | changed
    return thrust_ring(**sizes, ears=ears or (Ear("B", 120 * DEGREE), Ear("D", 60 * DEGREE)))


@pytest.mark.parametrize(
    "ears",
    [
        (Ear("B", 120 * DEGREE), Ear("D", 60 * DEGREE)),
        (Ear("one", -10 * DEGREE),),
        tuple(Ear(f"E{k}", 60 * k * DEGREE + 5) for k in range(6)),
    ],
    ids=["two", "one", "six"],
)
def test_a_thrust_ring_is_a_ring_with_ears_less_half_a_ball_in_each(ears: tuple[Ear, ...]) -> None:
    part = ring(*ears)
    well_made(part)
    section = disc(140) - disc(112) + len(ears) * ear_beyond(70, 80, 24)
    assert part.solid.Volume() == pytest.approx(section * 14 - len(ears) * 2 / 3 * math.pi * 8**3, rel=1e-9)
    for ear in ears:
        place = 80 * math.cos(ear.angle), 80 * math.sin(ear.angle), 0
        assert sphere_of(part, ear.name) == pytest.approx([*place, 8], abs=1e-9)
        assert part.faces[ear.name].Center().z > 0  # the seat is in the bottom, and opens downwards
        beside = -math.sin(ear.angle), math.cos(ear.angle)
        for side, sign in (("left", 1), ("right", -1)):
            normal = part.faces[f"{ear.name} {side}"].normalAt().toTuple()
            assert normal == pytest.approx((sign * beside[0], sign * beside[1], 0), abs=1e-9)
    assert part.faces["top"].Center().z == pytest.approx(14)
    around = 140 * (math.pi - len(ears) * math.asin(24 / 140)) * 14
    sides = [face.Area() for name, face in part.faces.items() if name.startswith("side ")]
    assert len(sides) == len(ears)
    assert sum(sides) == pytest.approx(around, rel=1e-9)


REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "thick rod": (lambda: rod(100.0, 16.0, 16.0), "a rod of 16 mm is not thinner than its balls of 16 mm"),
    "short rod": (lambda: rod(12.0, 8.0, 16.0), "centres 12 mm apart leave nothing of the rod"),
    "a rod that is no number": (lambda: rod(math.nan, 8.0, 16.0), "leave nothing of the rod"),
    "wide mouth": (lambda: ball_socket(16.0, 17.0, 26.0, 12.0), "a mouth of 17 mm is wider than the seat of 16 mm"),
    "thin socket": (lambda: ball_socket(16.0, 16.0, 16.0, 12.0), "leaves no wall in a socket of 16 mm"),
    "low socket": (lambda: ball_socket(16.0, 16.0, 26.0, 8.0), "a socket of 26 mm, 8 mm high below it"),
    "flat screw": (lambda: ball_screw(16.0, 0.0), "a screw of 16 mm, 0 mm long, has no volume"),
    "thick journal": (lambda: ball_screw(16.0, 100.0, (16.0, 10.0)), "a journal of 16 mm, 10 mm long, is not thinner"),
    "all journals": (lambda: ball_screw(16.0, 100.0, (12.0, 50.0)), "leave no thread of a screw 100 mm long"),
    "no bore": (lambda: nut(32.0, 24.0, 0.0, 32.0, 24.0, 16.0), "a nut with a bore of 0 mm.* has no volume"),
    "wide bore": (lambda: nut(32.0, 24.0, 32.0, 64.0, 24.0, 16.0), "a nut of 32 mm leaves no wall round its bore"),
    "narrow ear": (
        lambda: nut(32.0, 24.0, 16.0, 32.0, 16.0, 16.0),
        "ears 16 mm wide leave no wall round balls of 16 mm",
    ),
    "flat nut": (lambda: nut(32.0, 8.0, 16.0, 32.0, 24.0, 16.0), "8 mm along z, has no floor below seats of 16 mm"),
    "seat in the bore": (lambda: nut(32.0, 24.0, 16.0, 15.0, 24.0, 16.0), "break into the bore of 16 mm"),
    "ear within the nut": (lambda: nut(40.0, 24.0, 10.0, 15.0, 24.0, 16.0), "15 mm from the axis do not leave a nut"),
    "no ears": (lambda: thrust_ring(112.0, 140.0, 14.0, 80.0, 24.0, 16.0, ()), "no ears: expected one at least"),
    "ears too near": (
        lambda: ring(Ear("B", 0.0), Ear("D", 19 * DEGREE)),
        "ears 'B' and 'D' of the ring overlap or meet: they are 19 deg apart, and 19.7",
    ),
    "one name twice": (lambda: ring(Ear("B", 0.0), Ear("B", 1.0)), "'B'"),
    "the name of another face": (lambda: ring(Ear("top", 0.0)), "two faces of the ring are called 'top'"),
}


@pytest.mark.parametrize(("made", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_what_makes_no_part_is_refused_by_numbers(made: Callable[[], Any], message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        made()
