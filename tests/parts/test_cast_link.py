"""Cast links: volumes against closed forms, faces where joints are, Denavit-Hartenberg links and what is refused."""

import math
import random
from typing import Any

import cadquery as cq
import numpy as np
import pytest
from places import SCENES

from tol3d import load_scene
from tol3d.errors import GeometryError
from tol3d.parts.cast_link import cast_link
from tol3d.parts.link_ends import RELIEF, Cylinder, Distal, Proximal
from tol3d.parts.named_solid import NamedSolid

PARTS: Any = load_scene(SCENES / "robot_arm.yaml").parts
LINKS: Any = {name: part.builder.shape for name, part in PARTS.items() if getattr(part, "builder", None) is not None}
FACES = {"seat": "seat", "foot": "seat", "pilot": "pilot", "bore": "bore", "flange": "flange"}
"""Faces of solids by the features of the scene that lie on them."""


def pipe(outer: float, inner: float, length: float) -> float:
    return math.pi / 4 * (outer**2 - inner**2) * length


def test_a_straight_link_is_its_shells_less_their_openings() -> None:
    """Two closed drums, open to the tube between them: walls of 5 mm, drums of 60 and 40 mm on an axis."""
    made = cast_link(Proximal(100.0, 60.0), Distal((0.0, 0.0, 300.0), (0.0, 0.0, 1.0), 80.0, 40.0), 5.0, 60.0)
    drums = pipe(100, 0, 60) - pipe(90, 0, 50) + pipe(80, 0, 40) - pipe(70, 0, 30)
    between = pipe(60, 50, 300 - 60 - 40) - 2 * pipe(50, 0, 5)
    assert made.solid.isValid()
    assert made.solid.Volume() == pytest.approx(drums + between, rel=1e-9)
    assert made.faces["seat"].Area() == pytest.approx(math.pi * 50**2, rel=1e-9)
    assert made.faces["flange"].Center().toTuple() == pytest.approx((0, 0, 300), abs=1e-9)


def test_a_pilot_a_hole_and_a_bore_are_as_large_as_they_are_stated() -> None:
    near = Proximal(100.0, 60.0, 10.0, Cylinder(50.0, 12.0), 20.0)
    far = Distal((0.0, 400.0, 35.0), (0.0, 0.0, 1.0), 120.0, 70.0, Cylinder(80.0, 30.0))
    faces = cast_link(near, far, 6.0).faces
    assert faces["pilot"].Area() == pytest.approx(math.pi * 50 * 12, rel=1e-9)
    assert faces["seat"].Area() == pytest.approx(pipe(100, 50 + 2 * RELIEF, 1), rel=1e-9)
    assert faces["pilot end"].Area() == pytest.approx(pipe(50, 20, 1), rel=1e-9)
    assert faces["hole"].Area() == pytest.approx(math.pi * 20 * (12 + 6), rel=1e-9)
    assert faces["bore"].Area() == pytest.approx(math.pi * 80 * 30, rel=1e-9)
    assert faces["mouth"].Center().toTuple() == pytest.approx((0, 400, 50), abs=1e-6)
    assert faces["seat"].normalAt().toTuple() == pytest.approx((0, 0, -1), abs=1e-12)


def along(face: cq.Face) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any], float]:
    """A point and the direction of a cylinder's axis, and its radius."""
    found = face._geomAdaptor().Cylinder()
    place, axis = found.Axis().Location(), found.Axis().Direction()
    return np.array([place.X(), place.Y(), place.Z()]), np.array([axis.X(), axis.Y(), axis.Z()]), found.Radius()


@pytest.mark.parametrize("name", LINKS)
def test_the_faces_of_the_arm_s_links_lie_where_its_features_are_drawn(name: str) -> None:
    part = PARTS[name]
    made = cast_link(LINKS[name].proximal, LINKS[name].distal, LINKS[name].wall, LINKS[name].body)
    assert made.solid.isValid()
    drawn = {feature: own for feature, own in part.features.items() if feature in FACES}
    assert len(drawn) >= 2
    for feature, own in drawn.items():
        face, at = made.faces[FACES[feature]], np.array([place.internal for place in own.at])
        if own.kind == "plane":
            assert face.normalAt().toTuple() == pytest.approx(own.normal, abs=1e-12)
            assert (np.array(face.Center().toTuple()) - at) @ own.normal == pytest.approx(0.0, abs=1e-9)
            continue
        place, axis, radius = along(face)
        assert radius == pytest.approx(own.diameter.internal / 2, abs=1e-9)
        assert np.linalg.norm(np.cross(axis, own.axis)) < 1e-12
        assert np.linalg.norm(np.cross(at - place, axis)) < 1e-9
        reach = [(np.array(vertex.toTuple()) - at) @ own.axis for vertex in face.Vertices()]
        half = own.length.internal / 2
        assert [min(reach), max(reach)] == pytest.approx([-half, half], abs=1e-6)


def drawn(a: float, alpha: float, d: float, wide: float, mouth: float) -> NamedSolid:
    """A link between the frames that Denavit and Hartenberg have, of such drums."""
    at, axis = (a, 0.0, d), (0.0, -math.sin(alpha), math.cos(alpha))
    near = Proximal(wide, 0.9 * wide, 0.0, Cylinder(wide / 2, 10.0), wide / 4)
    far = Distal(at, axis, mouth, 0.9 * mouth, Cylinder(0.7 * mouth, 0.3 * mouth))
    return cast_link(near, far, 0.06 * min(wide, mouth))


def closed(made: NamedSolid) -> bool:
    """True if a solid is valid, closed and has a volume, and each of its faces one name."""
    shells = made.solid.Shells()
    return (
        made.solid.isValid()
        and made.solid.Volume() > 0.0
        and all(shell.wrapped.Closed() for shell in shells)
        and set(made.faces.values()) == set(made.solid.Faces())
    )


@pytest.mark.parametrize(
    ("a", "alpha", "d"),
    [(700, 0, 0), (150, -90, 450), (0, 90, 700), (0, 90, 0), (400, 37, -120)],
    ids=["parallel", "offset", "crossing", "of a wrist", "skew and below"],
)
def test_links_of_every_kind_are_closed_solids(a: float, alpha: float, d: float) -> None:
    assert closed(drawn(a, math.radians(alpha), d, 120.0, 100.0))


@pytest.mark.slow
def test_random_links_are_closed_solids_or_refused_for_what_stands_in_each_other_s_way() -> None:
    """A refusal has a reason of geometry: the next joint lies before the seat or the mouth, or drums in each other."""
    rng, refused = random.Random(7), []
    for _ in range(50):
        a, d = rng.uniform(0.0, 800.0), rng.choice([0.0, rng.uniform(-500.0, 700.0)])
        alpha = rng.choice([0.0, math.pi / 2, -math.pi / 2, rng.uniform(-math.pi, math.pi)])
        wide, mouth = rng.uniform(40.0, 250.0), rng.uniform(40.0, 250.0)
        try:
            made = drawn(a, alpha, d, wide, mouth)
        except GeometryError as error:
            refused.append((a, alpha, d, wide, mouth, str(error)))
        else:
            assert closed(made)
    for a, alpha, d, wide, mouth, words in refused:
        near = math.hypot(a, d) < wide + mouth
        assert words.startswith(NEAR) if near else words.startswith("the other joint lies before"), (a, alpha, d, words)
        assert near or d < wide or math.cos(alpha) < 0.0
    assert len(refused) <= 20


NEAR = ("the other joint lies before", "the drums of the link are too large")
REFUSED: dict[str, tuple[Proximal, Distal, float, float | None, str]] = {
    "wall": (Proximal(100.0, 60.0), Distal((0.0, 0.0, 300.0), (0.0, 0.0, 1.0), 80.0, 40.0), 45.0, None, "a wall of 45"),
    "pilot": (
        Proximal(100.0, 60.0, 0.0, Cylinder(98.0, 5.0)),
        Distal((0.0, 0.0, 300.0), (0.0, 0.0, 1.0), 80.0, 40.0),
        5.0,
        None,
        "a pilot of 98 mm and its groove 2 mm wide leave no seat",
    ),
    "hole": (
        Proximal(100.0, 60.0, 0.0, Cylinder(40.0, 5.0), 40.0),
        Distal((0.0, 0.0, 300.0), (0.0, 0.0, 1.0), 80.0, 40.0),
        5.0,
        None,
        "a hole of 40 mm leaves no wall",
    ),
    "bore": (
        Proximal(100.0, 60.0),
        Distal((0.0, 0.0, 300.0), (0.0, 0.0, 1.0), 80.0, 40.0, Cylinder(75.0, 10.0)),
        5.0,
        None,
        "a bore of 75 mm leaves no wall of 5 mm in a distal drum of 80 mm",
    ),
    "body": (
        Proximal(100.0, 60.0),
        Distal((0.0, 0.0, 300.0), (0.0, 0.0, 1.0), 80.0, 40.0),
        5.0,
        82.0,
        "a body of 82 mm does not fit the distal drum of the link, which has room for 80 mm",
    ),
    "below its seat": (
        Proximal(100.0, 60.0),
        Distal((50.0, 0.0, -300.0), (0.0, 1.0, 0.0), 80.0, 40.0),
        5.0,
        None,
        "the other joint lies before the proximal drum of the link: its body would leave the drum through the seat",
    ),
    "one in the other": (
        Proximal(100.0, 60.0),
        Distal((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 120.0, 40.0, Cylinder(100.0, 20.0)),
        5.0,
        None,
        "the drums of the link are too large for how near its joints lie: they cut each other into pieces",
    ),
    "a drum round the seat": (
        Proximal(60.0, 60.0),
        Distal((0.0, 60.0, 0.0), (0.0, 1.0, 0.0), 180.0, 100.0),
        5.0,
        None,
        "the drums of the link are too large for how near its joints lie: 0 % of its seat is left",
    ),
    "opposite": (
        Proximal(100.0, 60.0),
        Distal((0.0, 0.0, 300.0), (0.0, 0.0, -1.0), 80.0, 40.0, Cylinder(50.0, 10.0)),
        5.0,
        None,
        "before the distal drum of the link: its body would leave the drum through the mouth of its bore",
    ),
}


@pytest.mark.parametrize(("near", "far", "wall", "body", "words"), REFUSED.values(), ids=REFUSED)
def test_what_makes_no_link_is_refused(
    near: Proximal, far: Distal, wall: float, body: float | None, words: str
) -> None:
    with pytest.raises(GeometryError, match=words):
        cast_link(near, far, wall, body)
