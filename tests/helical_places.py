"""Helical pairs in displaced, tilted and eccentric builds: read by the exact engine, and searched by the oracle."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from oracles.screw_flanks import Placed, ScrewGear, lag
from scipy.spatial.transform import Rotation

from tol3d.gearing.builds.build import Build
from tol3d.gearing.engines import MeshReading
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.model import Mesh, Model, Reading
from tol3d.gearing.model.model import GearPart
from tol3d.gearing.shown.placed import PlacedGear
from tol3d.gears import LEFT, LEFT_HAND, RIGHT, RIGHT_HAND, Flank, InternalGear, InternalPair, SpurGear, SpurPair
from tol3d.numerics.arrays import Array

BOTH = frozenset(("driver", "driven"))

Pairs = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class Places:
    """Deviations of driver and driven gear: shifts [mm], tilts (in, out) [rad], centres (length [mm], azimuth)."""

    shifts: Sequence[Sequence[float]] = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    tilts: Pairs = ((0.0, 0.0), (0.0, 0.0))
    centres: Pairs = ((0.0, 0.0), (0.0, 0.0))

    def rotations(self) -> list[Array]:
        """Turns of both axes by their tilts, about their face centres."""
        vectors = ([-out, along, 0.0] for along, out in self.tilts)
        return [Rotation.from_rotvec(vector).as_matrix() for vector in vectors]

    def off_axis(self) -> list[tuple[float, float]]:
        """Centres (x, y) in the gears' frames [mm]."""
        return [(e * math.cos(azimuth), e * math.sin(azimuth)) for e, azimuth in self.centres]


def model_of(pair: SpurPair | InternalPair, flank: Flank) -> Model:
    """A model of one mesh."""
    gears = (GearPart("driver", pair.pinion), GearPart("driven", pair.wheel))
    return Model("m", gears, (), (), (Mesh("mesh", "driver", "driven", pair, flank),), ())


def read(pair: SpurPair | InternalPair, angle: float, flank: Flank, places: Places) -> MeshReading:
    """One build brought to contact and read."""
    model, shafts = model_of(pair, flank), np.tile(np.eye(4), (1, 2, 1, 1))
    for seat, rotation in enumerate(places.rotations()):
        shafts[0, seat, :3, :3], shafts[0, seat, :3, 3] = rotation, places.shifts[seat]
    shafts[0, 1, :3, 3] += pair.wheel_origin
    vectors = np.array([[[-out, along, 0.0] for along, out in places.tilts]])
    made = Build(shafts, np.array([places.off_axis()]), vectors, np.zeros((1, 2)), np.zeros((1, 2)), np.ones((1, 2)))
    return ExactEngine(model).read(made, model.meshes[0], Reading(), np.array([angle]), BOTH)


def random_places(rng: np.random.Generator, size: float = 1.0) -> Places:
    """Shifts of some um, tilts of some tenths of a mrad, and eccentricities."""
    shifts = rng.uniform(-1, 1, (2, 3)) * np.array([0.01, 0.01, 0.3]) * size
    tilts = rng.uniform(-3e-4, 3e-4, (2, 2)) * size
    centres = np.stack([rng.uniform(0, 0.015, 2) * size, rng.uniform(0, 2 * math.pi, 2)], axis=-1)
    return Places(shifts.tolist(), _pairs(tilts), _pairs(centres))


def _pairs(values: Array) -> Pairs:
    (a, b), (c, d) = values.tolist()
    return (a, b), (c, d)


def least_lag(
    pair: SpurPair | InternalPair,
    screws: tuple[ScrewGear, ScrewGear],
    places: Places,
    turns: tuple[float, float],
    flank: Flank,
) -> float:
    """Arc [mm] on the driven base circle until the first pair of a side touches, by the search."""
    origins = [np.array(shift, dtype=float) for shift in places.shifts]
    origins[1] = origins[1] + pair.wheel_origin
    driver, driven = (
        Placed(screw, rotation, origin, centre)
        for screw, rotation, origin, centre in zip(screws, places.rotations(), origins, places.off_axis(), strict=True)
    )
    first = round(-turns[0] * screws[0].teeth / (2 * math.pi))
    found = []
    for tooth in range(first - 4, first + 5):
        mate = int(pair.mating_teeth(np.array([tooth]), flank)[0])
        found.append(lag(driver, driven, turns, flank, (tooth, mate)))
    return min(found)


def mirrored(places: Places, pitch: float) -> Places:
    """In the plane of the axes: y turns over, and so do turns about x and azimuths of centres.

    The driven gear's space on the line of centres is then that on the other side of its tooth 0, a pitch [rad] on.
    """
    shifts = [(x, -y, z) for x, y, z in places.shifts]
    (along, out), (other_along, other_out) = places.tilts
    tilts = ((along, -out), (other_along, -other_out))
    (first, at), (second, other) = places.centres
    centres = ((first, -at), (second, -other - pitch))
    return Places(shifts, tilts, centres)


def screw_of(gear: SpurGear | InternalGear, flank_turn: float) -> ScrewGear:
    """The oracle's gear with the thickness of a trial."""
    thinner = -2 * flank_turn * gear.module * gear.teeth / 2 - gear.tooth_thickness_deviation
    return ScrewGear(
        gear.teeth, gear.module, gear.pressure_angle, gear.helix_angle, gear.hand, gear.face_width, gear.profile_shift,
        thinner, gear.addendum, isinstance(gear, InternalGear),
    )  # fmt: skip


def least_placed_lag(driver: PlacedGear, driven: PlacedGear, side: int) -> float:
    """Least arc [mm] by which the flanks of a planet and a central gear are apart, of the teeth about the mesh."""
    assert isinstance(driver.gear, SpurGear)
    assert isinstance(driven.gear, SpurGear | InternalGear)
    first, second = screw_of(driver.gear, driver.flank_turn), screw_of(driven.gear, driven.flank_turn)
    placed = [
        Placed(screw, np.array(gear.world_from_gear[:3, :3]), np.array(gear.world_from_gear[:3, 3]))
        for screw, gear in ((first, driver), (second, driven))
    ]
    x, y = driver.world_from_gear[:2, 3] - driven.world_from_gear[:2, 3]
    towards = math.atan2(y, x)
    at_planet = towards if second.inside else towards + math.pi
    turned = [math.atan2(gear.world_from_gear[1, 0], gear.world_from_gear[0, 0]) for gear in (driver, driven)]
    tooth = round((at_planet - turned[0]) / driver.gear.angular_pitch)
    mate = round((towards - turned[1]) / driven.gear.angular_pitch)
    near = range(-2, 3)
    return min(
        (
            abs(found) and found
            for own in near
            for its in near
            if abs(found := lag(placed[0], placed[1], (0.0, 0.0), side, (tooth + own, mate + its))) < 1.0
        ),
        default=math.inf,
    )


def assert_read_as_spur(
    leaning: SpurPair | InternalPair, spur: SpurPair | InternalPair, rng: np.random.Generator
) -> None:
    """A pair whose helix vanishes reads what the spur pair does: displaced and eccentric, on both sides."""
    for flank in (RIGHT, LEFT):
        places, angle = random_places(rng), float(rng.uniform(-3.0, 3.0))
        across = [(x, y, 0.0) for x, y, _ in places.shifts]  # along the axis even such a helix turns its mate by 5e-12
        places = replace(places, shifts=across, tilts=((0.0, 0.0), (0.0, 0.0)))
        ours, theirs = read(leaning, angle, flank, places), read(spur, angle, flank, places)
        assert ours.gap[0] == pytest.approx(theirs.gap[0], abs=1e-12)
        for name in ("driven_angle", "driven_turn", "driver_turn"):
            assert getattr(ours, name)[0] == pytest.approx(getattr(theirs, name)[0], abs=1e-12), name


def assert_mirrored_reads_the_same(pair: SpurPair | InternalPair, rng: np.random.Generator) -> None:
    """Both hands and the flanks exchanged, and every place mirrored in the plane of the axes."""
    places, angle = random_places(rng), float(rng.uniform(-3.0, 3.0))
    hands = {RIGHT_HAND: LEFT_HAND, LEFT_HAND: RIGHT_HAND}
    gears: dict[str, Any] = {
        name: replace(gear, hand=hands[gear.hand]) for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel))
    }
    other = replace(pair, **gears)
    ours = read(pair, angle, RIGHT, places)
    theirs = read(other, -angle, LEFT, mirrored(places, pair.wheel.angular_pitch))
    assert ours.gap[0] == pytest.approx(theirs.gap[0], abs=2e-8)  # two ways to the same least gap: QUICK_FALL
    assert ours.driven_turn[0] == pytest.approx(theirs.driven_turn[0], abs=1e-9)
    total = (ours.driven_angle[0] + theirs.driven_angle[0]) * pair.wheel.teeth / (2 * math.pi)
    assert total == pytest.approx(round(total), abs=1e-7)
