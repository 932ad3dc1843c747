"""The method of RV reducers by FCL, which witnesses the exact one: strips of CAD faces against cylinders, the pins.

FCL iterates the distance of a cylinder, to some 1e-5 mm, and that of a ball from a triangle is a closed form. Strips of
a flat disc are ruled along its pins, so that a ball at mid-height is as far off as the pin: it finds which one touches,
and the cylinder says where. Of a disc that leans only cylinders know.

The carrier is turned by the least gap over lever, with nominal levers, until no gap is left. Strips are pulled into the
disc by a slack, which is taken off again, so that a lobe which overlaps its pin a little has a negative gap. The chords
of a strip lie inside the disc where it is convex and outside where it is concave: a gap errs by the strips' chord error
either way. Errors of lobes move whole strips: pitch turns them, profile acts along the normal.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from tol3d.cad.solids.distance import NearestPoints, Surface, cylinder, mesh_surface, put, sphere
from tol3d.gearing.cycloid.exact.contact import BOTH, ContactStage
from tol3d.gearing.cycloid.exact.places import StagePlaces
from tol3d.gearing.cycloid.model.shapes import LobeStrips
from tol3d.gearing.cycloid.model.stage import Deviated, Touching
from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.first_stage import crank_turns, held_stage, placed_mesh
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.cycloid.reducer.trials import RVMethod, RVTrials
from tol3d.gearing.cycloid.reducer.turning import Turned, led_angles, output_turns
from tol3d.gearing.reducers.trials import Witnesses
from tol3d.numerics.arrays import Array
from tol3d.numerics.plane import evenly

SLACK: Final = 0.05  # mm; overlaps up to it are measured
LAST_STEP: Final = 1e-7  # mm over the pitch radius
MOST_STEPS: Final = 25
LAST_PIN_STEP: Final = 2e-5  # mm; the same by cylinders
PIN_WIDTHS: Final = 2.0  # shorter and much longer cylinders take FCL more steps, and leave more
NEARLY: Final = 3e-6  # rad; pins that to first order would touch so much later are asked again at the end only
NEARLY_SHARE: Final = 0.05  # of the turn, on top
NO_PIN: Final = -1


@dataclass(frozen=True, eq=False)
class StripContact:
    """Made in the worker: FCL's objects do not pickle.

    Args:
        strips: of one disc whose lobes are not clocked.
    """

    stage: ContactStage
    strips: LobeStrips

    def touches(
        self, deviated: Deviated, phis: Array, senses: tuple[float, ...] = BOTH, tilts: Array | None = None
    ) -> Touching:
        """See ContactStage.touches; no pins are counted.

        Args:
            deviated, phis, senses: as there.
            tilts: of discs about x and y of the frame of their holes (trials, discs, 2) [rad]; None: they lie flat.
        """
        trials = len(deviated.pins)
        rotations = np.broadcast_to(np.eye(3), (trials, self.stage.discs, 3, 3)) if tilts is None else tilted(tilts)
        positions = np.broadcast_to(phis, (trials, phis.shape[1]))
        turns = np.full((*positions.shape, len(senses)), np.nan)
        places = np.full(turns.shape, NO_PIN, dtype=np.int64)
        for trial in range(trials):
            own = deviated[trial : trial + 1]
            for position, phi in enumerate(positions[trial].tolist()):
                for s, sense in enumerate(senses):
                    turns[trial, position, s], places[trial, position, s] = self._first(
                        own, rotations[trial], phi, sense
                    )
        return Touching(turns, places, None)

    def _first(self, deviated: Deviated, rotations: Array, phi: float, sense: float) -> tuple[float, int]:
        """The carrier's turn and the place of the pin that touches; NaN and NO_PIN where the search does not end.

        Args:
            deviated: of one trial.
            rotations: of its discs from lying flat (discs, 3, 3), in the frames of their holes.
            phi, sense: of the cranks, and of the turn.
        """
        flat = bool((rotations == np.eye(3)).all())
        asked_by, last = (self._ball, LAST_STEP) if flat else (self._pin, LAST_PIN_STEP)
        levers = self._levers(phi)
        working = np.flatnonzero(sense * levers > self.stage.window * self.stage.profile.pitch_radius)
        if not working.size:
            return math.nan, NO_PIN
        levers = levers * (1.0 + self.stage.rolling / self.stage.profile.lobes)
        turn, asked, every = 0.0, working, True
        for _ in range(MOST_STEPS):
            at = StagePlaces(self.stage, deviated, phi, turn)
            gaps = self._gaps(at, rotations, asked.tolist(), asked_by)
            allowed = gaps / levers[asked]
            first = int(np.argmin(sense * allowed))
            step = float(allowed[first])
            if abs(step) * self.stage.profile.pitch_radius < last:
                if every:
                    place = int(asked[first])
                    return turn + float(self._gaps(at, rotations, [place], self._pin)[0] / levers[place]), place
                asked, every = working, True
                continue
            turn += step
            later = sense * (allowed - step)
            asked, every = asked[later < NEARLY + NEARLY_SHARE * abs(step)], False
        return math.nan, NO_PIN

    def _gaps(self, at: StagePlaces, rotations: Array, asked: Iterable[int], pin_surface: Surface) -> Array:
        """Between discs and pins [mm], by their places disc times pins + pin; not below -SLACK less errors of size."""
        profile, own, discs, pins = self.stage.profile, at.deviated, at.discs, at.pins
        found = []
        for place in asked:
            disc, pin = divmod(place, profile.pins)
            throw = float(self.stage.throws[disc])
            u = 2 * math.pi * pin / profile.pins + (at.phi + throw) / profile.lobes
            lobe = math.floor(u / profile.lobe_pitch) % profile.lobes
            side = int(math.sin(profile.lobes * u) < 0.0)
            turned = lobe * profile.lobe_pitch - throw / profile.lobes
            turned += own.lobe_pitch[0, disc, lobe] * profile.shortening / profile.pitch_radius
            centre = (pins[pin].at - discs[disc].at) * np.exp(-1j * discs[disc].turned)
            lobe_from_world = about_z(-turned) @ rotations[disc].T
            put(pin_surface, lobe_from_world, lobe_from_world @ np.array([centre.real, centre.imag, 0.0]))
            distance = self._nearest.of(self._flanks[side], pin_surface).distance
            found.append(distance - SLACK - own.lobe_profile[0, disc, lobe] - own.pin_radii[0, pin])
        return np.array(found)

    def _levers(self, phi: float) -> Array:
        """Nominal levers of all discs' pins (discs pins,) [mm], positive where they stop counter-clockwise turning."""
        profile = self.stage.profile
        return -profile.lever(evenly(profile.pins) + (phi + self.stage.throws[:, None]) / profile.lobes).ravel()

    @cached_property
    def _flanks(self) -> tuple[Surface, Surface]:
        return (mesh_surface(*self.strips.right.mesh(SLACK)), mesh_surface(*self.strips.left.mesh(SLACK)))

    @cached_property
    def _pin(self) -> Surface:
        return cylinder(self.stage.profile.pin_radius, PIN_WIDTHS * self.strips.right.width)

    @cached_property
    def _ball(self) -> Surface:
        return sphere(self.stage.profile.pin_radius)

    @cached_property
    def _nearest(self) -> NearestPoints:
        return NearestPoints()


def tilted(tilts: Array) -> Array:
    """Rotations (..., 3, 3) about axes in a plane (..., 2) [rad]."""
    about = np.concatenate([tilts, np.zeros((*tilts.shape[:-1], 1))], axis=-1)
    return np.asarray(Rotation.from_rotvec(about.reshape(-1, 3)).as_matrix()).reshape(*tilts.shape[:-1], 3, 3)


def about_z(angle: float) -> Array:
    """A rotation (3, 3)."""
    return np.asarray(Rotation.from_rotvec([0.0, 0.0, angle]).as_matrix())


ALLOWANCE: Final = 1.5e-5  # mm; what a gap may be off besides chords: FCL's cylinders by 8e-6, the solid by 1e-6


@dataclass(frozen=True)
class StripTurning:
    """The cycloid stage by FCL on strips of the discs' solids, the first stage in finite geometry."""

    own: RVSet
    strips: StripContact

    def turned(self, deviated: RVDeviated, turns: Array, sense: int, deflection: float | None = None) -> Turned:
        """See Turning; pins near contact are not counted."""
        own = self.own
        beta, planets = crank_turns(own, deviated, turns, sense, placed_mesh)
        tilts = deviated.disc_tilts if np.any(deviated.disc_tilts) else None
        found = self.strips.touches(held_stage(own, deviated), led_angles(own, turns, beta), (float(sense),), tilts)
        return Turned(
            output_turns(own, deviated, turns, sense, found.turns[..., 0], beta), found.places[..., 0], planets
        )


@dataclass(frozen=True)
class RVWitness(Witnesses, RVMethod):
    """Implements WitnessMethod."""


def witness(system: RVTrials, strips: LobeStrips) -> RVWitness:
    """The method of a reducer's trials by FCL."""
    turning = StripTurning(system.own, StripContact(system.own.contact, strips))
    return RVWitness(system, turning, chord_error=strips.chord_error, errors=(strips.chord_error, ALLOWANCE))
