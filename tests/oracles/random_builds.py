"""Random builds of a pair anywhere near its place, the same for an engine and for a search of the surfaces."""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from oracles.bevel_brute_force import BevelMesh, BevelNumbers
from oracles.brute_force import Mesh as SearchedSpurs
from oracles.involute_gear import InvoluteGear
from tol3d.gearing.builds.build import Build
from tol3d.gearing.model import GearPart, Mesh, Model
from tol3d.gears import BevelGear, BevelPair, InternalPair, SpurGear, SpurPair
from tol3d.gears.flank import Flank


@dataclass(frozen=True)
class Spread:
    """Spread of builds, each way; lengths in mm, angles in rad.

    Args:
        tilt: of either axis, about any direction.
        shift: of either axis, in any direction.
        past: of the driven gear along its axis, that much of the smaller face at most.
        centre: of the gears off their axes, x and y.
        growth: of either gear, relative; base pitches differ.
        turned, offset: thickness of either gear, arcs at the reference circle and along the normals.
    """

    tilt: float = 1e-3
    shift: float = 0.05
    past: float = 0.0
    centre: float = 0.01
    growth: float = 0.0
    turned: float = 0.01
    offset: float = 0.004


@dataclass(frozen=True)
class Builds:
    """Rows of random builds and driver positions of one mesh."""

    model: Model
    made: Build
    driver_angle: np.ndarray

    @property
    def mesh(self) -> Mesh:
        return self.model.meshes[0]

    @property
    def count(self) -> int:
        return len(self.driver_angle)


def model_of(pair: SpurPair | InternalPair | BevelPair, flank: Flank) -> Model:
    """A model that is one mesh, nothing deviating."""
    mesh = Mesh("mesh", "pinion", "wheel", pair, flank)
    return Model("posed", (GearPart("pinion", pair.pinion), GearPart("wheel", pair.wheel)), (), (), (mesh,), ())


def random_builds(
    pair: SpurPair | InternalPair | BevelPair, flank: Flank, count: int, seed: int, *, spread: Spread, thinner: float
) -> Builds:
    """Builds of a pair.

    Args:
        pair: nominal gears.
        flank: the working one.
        count, seed: how many, and which.
        spread: how far they stray.
        thinner: mm, what is taken off the teeth of either gear, lest they interfere.
    """
    rng = np.random.default_rng(seed)
    rest = np.stack([np.eye(3), pair.world_from_wheel])
    turn = spread.tilt * in_ball(rng, (count, 2))
    shafts = np.tile(np.eye(4), (count, 2, 1, 1))
    shafts[:, :, :3, :3] = Rotation.from_rotvec(turn.reshape(-1, 3)).as_matrix().reshape(count, 2, 3, 3) @ rest
    shafts[:, :, :3, 3] = spread.shift * in_ball(rng, (count, 2))
    shafts[:, 1, :3, 3] += pair.wheel_origin
    past = spread.past * min(pair.pinion.face_width, pair.wheel.face_width) * rng.uniform(-1, 1, count)
    shafts[:, 1, :3, 3] += past[:, None] * pair.world_from_wheel[:, 2]
    radii = np.array([gear.thickness_radius for gear in (pair.pinion, pair.wheel)])
    made = Build(
        world_from_shaft=shafts,
        centre=spread.centre * rng.uniform(-1, 1, (count, 2, 2)),
        axis_turn=turn,
        flank_turn=(spread.turned * rng.uniform(-1, 1, (count, 2)) - thinner) / (2 * radii),
        flank_offset=spread.offset * rng.uniform(-1, 1, (count, 2)),
        scale=1.0 + spread.growth * rng.uniform(-1, 1, (count, 2)),
    )
    period = 2 * np.pi * pair.long_period_turns
    return Builds(model_of(pair, flank), made, rng.uniform(-period, period, count))


def in_ball(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    """Vectors (*shape, 3) of any direction, no longer than 1; a third of them are close to that."""
    direction = rng.normal(size=(*shape, 3))
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    return direction * np.minimum(1.5 * rng.uniform(size=shape), 1.0)[..., None]


def searched_spurs(builds: Builds) -> SearchedSpurs:
    """The same as brute_force.py sees it; offsets along normals are handed to a search apart."""
    made, pair = builds.made, builds.mesh.pair
    assert isinstance(pair, SpurPair)
    driver, driven = (
        spur_numbers(gear, 2 * gear.reference_radius * made.flank_turn[:, k], made.scale[:, k])
        for k, gear in enumerate((pair.pinion, pair.wheel))
    )
    shafts, centre = made.world_from_shaft, made.centre
    return SearchedSpurs(driver, driven, shafts[:, 0], shafts[:, 1], centre[:, 0], centre[:, 1])


def spur_numbers(gear: SpurGear, thickness: np.ndarray, growth: np.ndarray) -> InvoluteGear:
    """The plain numbers of grown gears, deviation and growth (n,)."""
    each = (-1, 1, 1, 1)
    return InvoluteGear(
        gear.teeth,
        gear.module,
        gear.pressure_angle,
        gear.face_width,
        gear.profile_shift,
        gear.addendum,
        thickness.reshape(each),
    ).grown(growth.reshape(each))


def searched_bevels(builds: Builds) -> list[BevelMesh]:
    """The same as bevel_brute_force.py sees it, build by build; growth is about the apex and ends the face."""
    made, pair = builds.made, builds.mesh.pair
    assert isinstance(pair, BevelPair)
    searched = []
    for row in range(builds.count):
        own = slice(row, row + 1)
        driver, driven = (
            bevel_numbers(gear, made.flank_turn[row, k], made.flank_offset[row, k], made.scale[row, k])
            for k, gear in enumerate((pair.pinion, pair.wheel))
        )
        shafts, centre = made.world_from_shaft[own], made.centre[own]
        searched.append(BevelMesh(driver, driven, shafts[:, 0], shafts[:, 1], centre[:, 0], centre[:, 1]))
    return searched


def bevel_numbers(gear: BevelGear, turned: float, offset: float, growth: float) -> BevelNumbers:
    """The plain numbers of a grown gear."""
    return BevelNumbers(
        gear.teeth,
        growth * gear.module,
        gear.pressure_angle,
        gear.pitch_angle,
        (growth * gear.inner_cone_distance, growth * gear.outer_cone_distance),
        gear.profile_shift,
        gear.addendum,
        gear.dedendum,
        turned,
        offset,
    )


def within_reach_of(pair: SpurPair | InternalPair, spread: Spread) -> Spread:
    """A spread that leaves room to the end of the range in which candidate teeth are known, small modules included."""
    reach = 0.15 * pair.pinion.base_pitch * math.sin(pair.working_pressure_angle)
    wide = max(pair.pinion.face_width, pair.wheel.face_width) / 2
    asked = 2 * (spread.shift + math.sqrt(2) * spread.centre + spread.tilt * wide)
    less = min(1.0, 0.7 * reach / asked)
    return replace(spread, tilt=less * spread.tilt, shift=less * spread.shift, centre=less * spread.centre)
