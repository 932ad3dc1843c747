"""Spherical gears: their profile against the involute, their volume against Pappus, two of them in mesh."""

import math
from collections.abc import Callable
from typing import Any

import cadquery as cq
import numpy as np
import pytest
from oracles.train import involute
from scipy.integrate import quad

from tol3d.errors import GeometryError
from tol3d.gears import SpurGear
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.spherical_gear import spherical_gear

MODULE, TEETH, ALPHA, THIN = 4.0, 25, math.radians(20), 0.05
PITCH, BASE = MODULE * TEETH / 2, MODULE * TEETH / 2 * math.cos(ALPHA)
TIP, ROOT = PITCH + MODULE, PITCH - 1.25 * MODULE
STEP = 2 * math.pi / TEETH
PROFILE_ERROR = 1e-6  # mm; what a flank's spline may be off


def section(thin: float = THIN) -> SpurGear:
    return SpurGear(TEETH, MODULE, ALPHA, 1.0, tooth_thickness_deviation=-thin)


def gear(*, tooth: bool = True, reach: float = 95.0, thin: float = THIN, bore: Any = None) -> NamedSolid:
    return spherical_gear(section(thin), math.radians(reach), tooth_at_pole=tooth, bore=bore)


def half_angle(radius: float, thin: float = THIN) -> float:
    """Half the angle that a tooth takes at a radius above its base: pi m / 2 less `thin` on the pitch circle."""
    pressure = math.acos(BASE / radius)
    return (math.pi * MODULE / 2 - thin) / (2 * PITCH) + involute(ALPHA) - involute(pressure)


def whole_half_angle(radius: float) -> float:
    """The same from the root on: fillets are arcs of 0.38 m that touch the root circle and radial lines."""
    flat = (math.pi * MODULE / 2 - THIN) / (2 * PITCH) + involute(ALPHA)
    fillet = 0.38 * MODULE
    centre = ROOT + fillet
    top = math.sqrt(centre**2 - fillet**2)
    assert top < BASE  # so that a radial line leads from the fillet to the involute
    if radius >= BASE:
        return half_angle(radius)
    if radius >= top:
        return flat
    away = math.asin(fillet / centre)
    return flat + away - math.acos((radius**2 + centre**2 - fillet**2) / (2 * radius * centre))


@pytest.mark.parametrize("tooth", [True, False])
def test_flanks_are_involutes_of_half_a_pitch_on_the_pitch_sphere(tooth: bool) -> None:
    part = gear(tooth=tooth, thin=0.0)
    first = 1.0 if tooth else 0.5
    for ring in (1, 4, 6):
        middle = (ring - 1 + first) * STEP
        for side, sign in (("inner", -1), ("outer", 1)):
            face = part.faces[f"ring {ring} {side} flank"]
            low, high = face._uvBounds()[2:]
            for share in (0.0, 0.137, 0.5, 0.811, 1.0):
                point = face._geomAdaptor().Value(0.3, low + share * (high - low))
                radius = math.sqrt(point.X() ** 2 + point.Y() ** 2 + point.Z() ** 2)
                polar = math.atan2(math.hypot(point.X(), point.Y()), point.Z())
                inside = max(radius, BASE)  # the base circle to the last bit
                expected = middle + sign * half_angle(inside, 0.0)
                assert abs(polar - expected) * radius < PROFILE_ERROR
    assert 2 * half_angle(PITCH, 0.0) * PITCH == pytest.approx(math.pi * MODULE / 2, rel=1e-12)
    for name, face in part.faces.items():
        if name.endswith("tip") or "root" in name:
            made = face._geomAdaptor().Sphere()
            assert made.Radius() == pytest.approx(TIP if name.endswith("tip") else ROOT, abs=1e-9)


def ring_volume(middle: float) -> float:
    """Volume of a ring of teeth above the root, at an angle from the pole, slice by slice."""
    found, _ = quad(
        lambda r: r**2 * 4 * math.pi * math.sin(middle) * math.sin(whole_half_angle(r)),
        ROOT, TIP, points=[math.sqrt((ROOT + 1.52) ** 2 - 1.52**2), BASE], epsabs=1e-9,
    )  # fmt: skip
    return float(found)


def dome(reach: float) -> float:
    """Volume of a ball of the root's radius above the flat bottom."""
    height = ROOT - ROOT * math.cos(reach)
    return math.pi * height**2 * (3 * ROOT - height) / 3


@pytest.mark.parametrize("ring", [2, 3, 6])
def test_one_ring_of_teeth_has_its_volume_by_pappus(ring: int) -> None:
    """Two gears that differ by one ring, less what lies below the roots."""
    few, more = ((ring - 0.5) * STEP, (ring + 0.5) * STEP)
    volumes = [gear(reach=math.degrees(reach)).solid.Volume() - dome(reach) for reach in (few, more)]
    assert volumes[1] - volumes[0] == pytest.approx(ring_volume(ring * STEP), rel=1e-6)


def test_the_whole_is_the_sum_of_its_rings() -> None:
    part = gear(tooth=False, reach=100.0, bore=(20.0, 30.0))
    assert part.solid.isValid()
    assert set(part.faces.values()) == set(part.solid.Faces())
    rings = sum(ring_volume((ring - 0.5) * STEP) for ring in range(1, 8))
    volume = dome(math.radians(100)) + rings - math.pi * 10**2 * 30
    assert part.solid.Volume() == pytest.approx(volume, rel=1e-7)
    assert {name for name in part.faces if "pole" in name} == {"pole root"}
    assert "ring 7 tip" in part.faces
    assert "ring 8 tip" not in part.faces
    assert part.faces["bottom"].Center().z == pytest.approx(ROOT * math.cos(math.radians(100)), abs=1e-9)
    assert part.faces["bore floor"].Center().z == pytest.approx(ROOT * math.cos(math.radians(100)) + 30, abs=1e-9)


# mesh ----------------------------------------------------------------------------------------------------------------


def tilt(angle: float) -> Any:
    """A rotation that leans z towards x."""
    return np.array([[math.cos(angle), 0, math.sin(angle)], [0, 1, 0], [-math.sin(angle), 0, math.cos(angle)]])


def in_teeth(points: Any, thin: float, pole: float) -> Any:
    """True for points in the frame of a gear that lie in it, by the closed form; `pole` is its first ring's angle."""
    radius = np.linalg.norm(points, axis=-1)
    polar = np.arccos(np.clip(points[..., 2] / radius, -1, 1))
    pressure = np.arccos(np.minimum(1.0, BASE / radius))
    half = (math.pi * MODULE / 2 - thin) / (2 * PITCH) + involute(ALPHA) - (np.tan(pressure) - pressure)
    off = np.abs((polar - pole + STEP / 2) % STEP - STEP / 2)
    return (radius < ROOT) | ((radius < TIP) & (off < half))


def overlap(angle: float, thin: float, steps: int = 60) -> float:
    """Volume [mm^3] that two gears share where the carrier is tilted, by points of a grid across their contact."""
    across = math.sqrt(TIP**2 - PITCH**2)
    along, beside, apart = (
        np.linspace(low, high, count + 1)
        for low, high, count in ((-across, across, 2 * steps), (0, across, steps), (-MODULE, MODULE, steps))
    )
    x, y, z = np.meshgrid(along, beside, apart, indexing="ij")
    points = np.stack([x, y, z + PITCH], axis=-1) @ tilt(angle).T
    centre = 2 * PITCH * tilt(angle)[:, 2]
    second = tilt(2 * angle) @ np.diag([1, -1, -1])
    both = in_teeth(points, thin, 0.0) & in_teeth((points - centre) @ second, thin, STEP / 2)
    cell = float((along[1] - along[0]) * (beside[1] - beside[0]) * (apart[1] - apart[0]))
    return 2 * cell * float(both.sum())


def common(angle: float, thin: float) -> float:
    """The same of the solids, by CAD."""
    first, second = gear(thin=thin).solid, gear(tooth=False, reach=100.0, thin=thin).solid
    degrees, centre = math.degrees(angle), 2 * PITCH * tilt(angle)[:, 2]
    origin = cq.Vector(0, 0, 0)
    placed = second.rotate(origin, cq.Vector(1, 0, 0), 180).rotate(origin, cq.Vector(0, 1, 0), 2 * degrees)
    return float(sum(own.Volume() for own in first.intersect(placed.translate(cq.Vector(*centre))).Solids()))


TILTS = (0.0, 7.2, 20.0, 45.0, 70.0)


@pytest.mark.parametrize("degrees", [0.0, pytest.param(45.0, marks=pytest.mark.slow)])
def test_gears_of_exact_thickness_touch_and_do_not_overlap(degrees: float) -> None:
    """Their rings curve the same way and turn from each other: what meshes in one plane does so in space."""
    assert overlap(math.radians(degrees), 1e-6) == 0.0
    assert overlap(math.radians(degrees), -0.05) > 0.2


@pytest.mark.slow
@pytest.mark.parametrize("degrees", TILTS)
def test_the_solids_of_two_gears_share_nothing_at_any_tilt(degrees: float) -> None:
    assert common(math.radians(degrees), 0.05) == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [0.0, 10.0, 45.0])
def test_thick_teeth_share_as_much_by_cad_as_by_points(degrees: float) -> None:
    angle = math.radians(degrees)
    grid = overlap(angle, -0.05, 120)  # of 0.17 by 0.17 by 0.07 mm; a sliver of 0.05 mm is about as thick
    assert common(angle, -0.05) == pytest.approx(grid, rel=0.15)


# refused -------------------------------------------------------------------------------------------------------------

REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "no ring": (lambda: gear(reach=15.0), "no ring of teeth ends within a reach of 15 deg"),
    "no reach": (lambda: gear(reach=0.0), "reach: expected more than 0 deg and at most 150 deg, got 0 deg"),
    "too far": (lambda: gear(reach=151.0), "got 151 deg"),
    "no number": (lambda: gear(reach=math.nan), "got nan deg"),
    "wide bore": (lambda: gear(bore=(90.0, 5.0)), r"bore: expected less than the bottom, 89\.65"),
    "deep bore": (lambda: gear(bore=(20.0, 60.0)), r"bore_depth: expected less than 47\.79"),
    "full round": (
        lambda: spherical_gear(
            SpurGear(25, 4.0, ALPHA, 1.0, root_fillet=section(0.0).full_round_fillet), 1.5, tooth_at_pole=True
        ),
        "the full round of a spur gear's space leaves no root",
    ),
}


@pytest.mark.parametrize(("made", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_what_makes_no_gear_is_refused_by_numbers(made: Callable[[], Any], message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        made()
