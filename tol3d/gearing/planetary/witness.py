"""The method of planetary sets by FCL, which witnesses the exact one: gaps of strips of flank faces of their solids.

Strips are pulled into their teeth by a slack and put back afterwards, as gearing's engine does it, so that flanks which
overlap a little have a negative gap. Chords lie inside the teeth: a gap is too large by those of both flanks at most.
The programme goes on with these gaps until nothing moves.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.cad.solids import FlankStrips, PulledStrip
from tol3d.cad.solids.distance import NearestPoints, Surface, mesh_surface, put
from tol3d.gearing.engines.fcl import OUT_OF_REACH, SLACK, Found, read_strips
from tol3d.gearing.methods.geometric import ALLOWANCE
from tol3d.gearing.planetary.exact.shown import Made, placed_gears
from tol3d.gearing.planetary.model.deviated import Deviated, Free
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.trials import PlanetaryMethod, SetTrials
from tol3d.gearing.reducers.trials import Witnesses
from tol3d.gearing.shown.placed import PlacedGear
from tol3d.gears import LEFT, RIGHT, Flank, InternalGear, SpurGear
from tol3d.gears.involute import involute
from tol3d.numerics.arrays import Array
from tol3d.numerics.plane import upright_pose
from tol3d.numerics.programme import OK, STALLED, ranges

BESIDE: Final = (-1, 0, 1)
"""Pairs of teeth that are asked, from the one at the pitch point on; no more than three can touch at once."""


@dataclass(frozen=True, eq=False)
class StripGaps:
    """Made in the worker: FCL's objects do not pickle.

    Args:
        strips: of each of its gears, by name.
    """

    own: PlanetarySet
    strips: Mapping[str, FlankStrips]

    @cached_property
    def _pulled(self) -> Mapping[tuple[str, Flank], PulledStrip]:
        modules = {gear.name: gear.module for gear in self.own.all_gears}
        return {
            (name, flank): PulledStrip(own, flank, SLACK * modules[name])
            for name, own in self.strips.items()
            for flank in (RIGHT, LEFT)
        }

    @cached_property
    def _surfaces(self) -> Mapping[tuple[str, Flank], Surface]:
        return {key: mesh_surface(*strip.mesh(1.0)) for key, strip in self._pulled.items()}

    @cached_property
    def _nearest(self) -> NearestPoints:
        return NearestPoints()

    def gaps(self, gears: Sequence[PlacedGear]) -> Array:
        """(planets, meshes, 2) [mm]: before the right and the left flank of the planet's teeth.

        Where flanks overlap by more than the slack of both it is that slack, negative. They are lengths along the line
        of action: the normals of helical gears, along which strips are apart, lean out of it and are shorter.

        Args:
            gears: central gears, then those of each planet, as ShownSet has them.
        """
        own, steps = self.own, len(self.own.gears)
        found = np.empty((own.planets, len(own.meshes), 2))
        for k in range(own.planets):
            for m, mesh in enumerate(own.meshes):
                planet = gears[len(own.meshes) + k * steps + own.gear_of(mesh)]
                names = mesh.central.name, mesh.planet.name
                for side, flank in enumerate((RIGHT, LEFT)):
                    normal = self._gap(names, gears[m], planet, flank)
                    found[k, m, side] = normal / mesh.central.base_helix_cosine
        return found

    def _gap(self, names: tuple[str, str], central: PlacedGear, planet: PlacedGear, flank: Flank) -> float:
        """Least gap of the teeth that can touch."""
        ring = isinstance(central.gear, InternalGear)
        other: Flank = (LEFT if flank == RIGHT else RIGHT) if ring else flank
        keys = (names[0], other), (names[1], flank)
        central_tooth, planet_tooth = _in_mesh(central, planet, other, flank)
        distances, points, triangles = [], [], []
        turns, shifts = [], []
        for beside in BESIDE:
            first = _flank_pose(central, central_tooth + (beside if ring else -beside), other)
            pose = np.linalg.inv(first) @ _flank_pose(planet, planet_tooth + beside, flank)
            put(self._surfaces[keys[1]], pose[:3, :3], pose[:3, 3])
            nearest = self._nearest.of(self._surfaces[keys[0]], self._surfaces[keys[1]])
            distances.append(nearest.distance)
            points.append(nearest.points)
            triangles.append(nearest.triangles)
            turns.append(pose[:3, :3])
            shifts.append(pose[:3, 3])
        return self._least(keys, central.gear.module, distances, (points, triangles, turns, shifts))

    def _least(
        self, keys: Sequence[tuple[str, Flank]], module: float, distances: Sequence[float], nearest: Sequence[object]
    ) -> float:
        """Least gap, points put back onto their flanks."""
        points, triangles, turns, shifts = (np.array(each) for each in nearest)
        deep = np.array(distances)[:, None] < OUT_OF_REACH * module
        if deep.any():
            return -2 * SLACK * module
        count, ones = len(distances), np.ones(len(distances))
        back, bent = np.empty((count, 1, 2, 3)), np.empty((count, 1, 2))
        everywhere = np.arange(count)
        for side, key in enumerate(keys):
            own = points[:, side]
            if side:
                own = np.einsum("pji,pj->pi", turns, own - shifts)
            found, bent[:, 0, side], _ = read_strips(
                [(self._pulled[key], everywhere)], ones, triangles[:, side], np.asarray(own)
            )
            back[:, 0, side] = np.einsum("pij,pj->pi", turns, found) if side else found
        gaps = Found(np.array(distances)[:, None], points[:, None], back, bent, deep, deep).gaps(
            np.zeros((count, 2)), (np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3))), np.zeros((count, 1), int)
        )
        return float(gaps.value.min())


def _in_mesh(central: PlacedGear, planet: PlacedGear, other: Flank, flank: Flank) -> tuple[int, int]:
    """Teeth of both gears whose flanks stand before each other nearest to the pitch point."""
    ring = isinstance(central.gear, InternalGear)
    x, y = planet.world_from_gear[:2, 3] - central.world_from_gear[:2, 3]
    towards = math.atan2(y, x)
    sense = -1.0 if ring else 1.0
    base = central.gear.base_radius + sense * planet.gear.base_radius
    inv = involute(math.acos(base / math.hypot(x, y)))
    at_planet = _flank_azimuth(planet, flank, inv) - (towards if ring else towards + math.pi)
    tooth = -round(at_planet / planet.gear.angular_pitch)
    off = at_planet + tooth * planet.gear.angular_pitch
    at_central = _flank_azimuth(central, other, inv) - towards
    followed = -sense * off * planet.gear.teeth / central.gear.teeth
    return round((followed - at_central) / central.gear.angular_pitch), tooth


def _flank_azimuth(gear: PlacedGear, flank: Flank, inv: float) -> float:
    """Azimuth at which a flank of tooth 0 crosses the working pitch circle [rad], from its inv alpha."""
    own = gear.gear
    assert isinstance(own, SpurGear | InternalGear)
    narrowing = -inv if isinstance(own, SpurGear) else inv
    middle = math.atan2(gear.world_from_gear[1, 0], gear.world_from_gear[0, 0])
    return middle - flank * (own.base_half_angle + gear.flank_turn + narrowing)


def _flank_pose(gear: PlacedGear, tooth: int, flank: Flank) -> Array:
    """Pose of the flank of a tooth, (4, 4), from the strip of tooth 0; a thicker tooth turns its flanks apart."""
    angle = gear.gear.angular_pitch * tooth - flank * gear.flank_turn
    return gear.world_from_gear @ upright_pose(angle)


LAST_MOVE: Final = 1e-4  # mm along the base circles; slopes are known to some thousandths, so 1e-7 mm are left
MOST_STEPS: Final = 25


@dataclass(frozen=True, eq=False)
class StripContact:
    """Turns of shafts from FCL's gaps, with first-order slopes; see Contact.

    Args:
        made: its gears by name, nominal.
    """

    own: PlanetarySet
    made: Made
    engine: StripGaps

    def free(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> Free:
        """Free turn of a shaft while another one and the held one stand, at turns (trials,) of the output."""
        found = Free.of(len(turns))
        for trial, own in enumerate(deviated[trial : trial + 1] for trial in range(len(deviated.pins))):
            for end in (0, 1):
                begun = np.zeros(self.own.all_rows.shape[1])
                at, status, row, lacking = self._seated(own, float(turns[trial]), (shaft, stands, end), begun)
                found.ends[trial, end] = at[self.own.shafts.index(shaft)]
                found.status[trial], found.row[trial], found.lacking[trial] = status, row, lacking
                if status != OK:
                    found.ends[trial] = np.nan
                    break
        return found

    def followed(self, deviated: Deviated, turns: Array, shaft: str, stands: str, end: int) -> Free:
        """The lower (0) or upper (1) end of that at turns (positions,) of the output that all trials share."""
        found = Free.of(len(deviated.pins), len(turns))
        found.status[:], found.row[:], found.lacking[:] = OK, -1, 0.0
        for trial, own in enumerate(deviated[trial : trial + 1] for trial in range(len(deviated.pins))):
            at = np.zeros(self.own.all_rows.shape[1])
            for position, turn in enumerate(turns.tolist()):
                at, status, row, lacking = self._seated(own, turn, (shaft, stands, end), at)
                if status == OK:
                    found.ends[trial, position] = at[self.own.shafts.index(shaft)]
                else:
                    found.ends[trial] = 0.0
                    found.status[trial], found.row[trial], found.lacking[trial] = status, row, lacking
                    break
        return found

    def _seated(
        self, deviated: Deviated, turns: float, asked: tuple[str, str, int], begun_at: Array
    ) -> tuple[Array, int, int, float]:
        """Turns [rad] and displacements by springs [mm] at an end, status of the set, and the place that lacks room.

        Args:
            deviated: of one trial.
            turns: of the output.
            asked: which shaft turns, which one stands, and to which end.
            begun_at: turns and displacements to begin with.
        """
        own, (shaft, stands, end) = self.own, asked
        at = begun_at.copy()
        unknowns = list(own.unknowns(stands))
        rows, wanted, begun = own.rows(stands), own.wanted(stands, shaft), own.begun(stands)
        of_springs = slice(len(at) - len(own.springs), None)
        arms = np.abs(own.all_rows[:, unknowns]).max(axis=0)
        readouts = np.eye(len(unknowns))
        for _ in range(MOST_STEPS):
            gears = placed_gears(own, self.made, deviated, turns, at)
            gaps = self.engine.gaps(gears)
            gaps = gaps + np.where(gaps.sum(axis=-1, keepdims=True) >= 0.0, self._slides(deviated, gears), 0.0)
            least, most = (push - at[of_springs] for push in own.spring_ends)
            lower = np.concatenate([-gaps[..., 0].ravel(), least])[None]
            upper = np.concatenate([gaps[..., 1].ravel(), most])[None]
            step = np.empty(len(unknowns))
            for place, readout in enumerate(readouts):
                free = Free.of(1)
                ranges(rows, lower, upper, readout, wanted, begun, *free.written)
                if free.status[0] != OK:
                    return at, int(free.status[0]), int(free.row[0]), float(free.lacking[0])
                step[place] = free.ends[0, end]
            at[unknowns] += step
            if (np.abs(step) * arms).max() < LAST_MOVE:
                return at, OK, -1, 0.0
        return at, STALLED, -1, 0.0

    def _slides(self, deviated: Deviated, gears: Sequence[PlacedGear]) -> Array:
        """Further room of both flanks of each mesh (planets, meshes, 2) [mm], as planets slide on to either stop."""
        own = self.own
        firsts = gears[len(own.meshes) :: len(own.gears)]  # of each planet, in the middle at a height of 0
        moved = np.array([gear.world_from_gear[2, 3] for gear in firsts])[:, None] * own.planet_slides
        half = deviated.planet_slide[0, :, None] * (np.abs(own.planet_slides) / 2)
        return np.stack([half - moved, half + moved], axis=-1)


@dataclass(frozen=True)
class PlanetaryWitness(Witnesses, PlanetaryMethod):
    """Implements WitnessMethod."""


def witness(system: SetTrials, made: Made, strips: Mapping[str, FlankStrips]) -> PlanetaryWitness:
    """The method of a set's trials by FCL, from the strips of every gear by name."""
    turning, overcome = (StripContact(own, made, StripGaps(own, strips)) for own in (system.own, system.overcome))
    meshes = system.own.meshes
    leaning = [mesh.central.base_helix_cosine for mesh in meshes]
    chords = [
        (strips[mesh.central.name].chord_error + strips[mesh.planet.name].chord_error) / cosine
        for mesh, cosine in zip(meshes, leaning, strict=True)
    ]
    others = [ALLOWANCE * mesh.central.module / cosine for mesh, cosine in zip(meshes, leaning, strict=True)]
    largest = max(strip.chord_error for strip in strips.values())
    return PlanetaryWitness(system, turning, overcome, chord_error=largest, errors=(chords, others))
