"""Output turn of an RV reducer with bearing play, by each method: until a torque on it rests.

Cranks are taken where first contact without play would have them (see turning.py), and may turn from there between both
flanks of their planets. The flank that holds all cranks holds; where a planet's other flank overlaps, as of a tight
build, that one holds nothing. Rates of the analytic method follow from the forces at rest.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.cycloid.exact.contact_kernel import first_contacts
from tol3d.gearing.cycloid.exact.mesh_kernel import planet_turns
from tol3d.gearing.cycloid.exact.rest import RestStage
from tol3d.gearing.cycloid.exact.rest_kernel import NOT_HELD, rests
from tol3d.gearing.cycloid.first_order.linear_rest import Forces, LinearRest
from tol3d.gearing.cycloid.first_order.turns_kernel import first_order_turns
from tol3d.gearing.cycloid.model.stage import Deviated, Play
from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.first_stage import (
    OneMesh,
    add_rates,
    crank_turns,
    first_order_mesh,
    held_stage,
    placed_mesh,
    throw_turn,
)
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.cycloid.reducer.trials import NO_CONTACT, NO_FIT, NO_REST
from tol3d.gearing.cycloid.reducer.turning import ExactTurning, LinearTurning, Turned, Turning, leans_of, led_angles
from tol3d.gearing.reducers.trials import Solver
from tol3d.gears import LEFT, RIGHT
from tol3d.numerics.arrays import Array, Places
from tol3d.numerics.cone_programme import cone_programmes
from tol3d.numerics.kept import row_keys
from tol3d.numerics.plane import as_complex, as_points, evenly
from tol3d.numerics.programme import NO_ROOM, OK, STALLED
from tol3d.study.system.method import ANALYTIC_METHOD


def rest_rates(rv_set: RVSet, deviated: RVDeviated, turns: Array, phis: Array, forces: Forces) -> RVDeviated:
    """Rates of trials, in the form of their deviations [rad/mm or rad/rad].

    A tilt closes gaps whatever its sign: its rates are those on its side.

    Args:
        turns: of the output (trials,).
        phis: crank angles (trials,) [rad].
    """
    found = RVDeviated.nothing(rv_set, len(turns))
    _of_planets(rv_set, found, turns, forces)
    _of_pins(rv_set, found, deviated.disc_tilts, phis, forces)
    _of_bearings(rv_set, found.stage, phis, forces)
    found.disc_play[...] = np.swapaxes(forces.disc_play, 1, 2)
    found.carrier_play[...] = forces.carrier_play
    return found


def _of_planets(rv_set: RVSet, found: RVDeviated, turns: Array, forces: Forces) -> None:
    """Add the rates of the teeth; planets lie where the cranks do, whose bearings hold them."""
    for crank in range(rv_set.cranks):
        planets = np.full(len(turns), crank)
        for side, flank in enumerate((RIGHT, LEFT)):
            add_rates(rv_set, found, turns, planets, flank, forces.planets[:, crank, side])
    found.stage.carrier_holes[...] = 0.0
    found.stage.carrier_offsets[...] = 0.0


def _of_pins(rv_set: RVSet, found: RVDeviated, tilts: Array, phis: Array, forces: Forces) -> None:
    profile, stage, rows = rv_set.profile, rv_set.linear, np.arange(len(phis))[:, None]
    nothing, azimuths = Deviated.nothing(1, profile.pins, rv_set.discs, rv_set.cranks), evenly(profile.pins)
    for disc in range(rv_set.discs):
        force = forces.pins[:, disc]
        _, lever, normal = stage.nominal_gaps(nothing, disc, phis, None)
        lobes = stage.lobes_at(disc, phis)
        found.stage.pins[...] += as_points(force * normal * np.exp(-1j * azimuths))
        found.stage.pin_radii[...] -= force
        np.add.at(found.stage.lobe_profile[:, disc], (rows, lobes), -force)
        pitch = lever * profile.shortening / profile.pitch_radius
        np.add.at(found.stage.lobe_pitch[:, disc], (rows, lobes), -force * pitch)
        if rv_set.width is not None:
            across = -1j * normal * np.exp(1j * phis / profile.lobes)[:, None]
            side = np.sign((np.conj(across) * as_complex(tilts[:, disc])[:, None]).real)
            found.disc_tilts[:, disc] = as_points(-rv_set.width / 2 * (force * side * across).sum(axis=1))


def _of_bearings(rv_set: RVSet, found: Deviated, phis: Array, forces: Forces) -> None:
    ahead = np.exp(1j * phis * (1 + 1 / rv_set.profile.lobes))
    discs, carrier = as_complex(forces.discs), -as_complex(forces.carrier)
    swung = 1j * rv_set.profile.eccentricity * np.exp(1j * rv_set.linear.throws)
    thrown = -discs * np.conj(ahead)[:, None, None]
    found.disc_holes[...] = np.swapaxes(forces.discs, 1, 2)
    found.disc_offsets[...] = -as_points(discs.sum(axis=1))
    found.crank_errors[...] = as_points(thrown)
    if rv_set.first is None:  # else those of planets
        found.crank_phases[...] = (np.conj(thrown) * swung).real.sum(axis=2)
    found.carrier_holes[...] = as_points(carrier)
    found.carrier_offsets[...] = as_points(carrier.sum(axis=1))


AT_ONCE: Final = 1024  # rests of the analytic method in memory, some 10 kB each
ALIKE: Final = 1e-11  # mm or rad; builds read again from columns differ by rounding alone, and have the same forces
Known = tuple[Forces, Array, int]  # forces and crank angles of several rests, and one of them
MEANS: Final = {OK: OK, NO_ROOM: NO_FIT, STALLED: NO_REST, NOT_HELD: NO_CONTACT}


@dataclass(frozen=True)
class ExactResting:
    """Rest of a reducer in finite geometry."""

    own: RVSet

    def turned(self, deviated: RVDeviated, turns: Array, sense: int, deflection: float | None = None) -> Turned:
        """See Turning; rest position, and the pin that carries most."""
        own = self.own
        beta, planets = crank_turns(own, deviated, turns, sense, placed_mesh)
        play = play_of(own, deviated, turns, beta, placed_mesh)
        stage = RestStage.of(own)
        phis, leans = led_angles(own, turns, beta), leans_of(own, deviated)
        found = stage.rests(held_stage(own, deviated), phis, play, float(sense), deflection, leans)
        codes = np.zeros(found.status.shape, dtype=np.int8)
        for status, code in MEANS.items():
            codes[found.status == status] = code
        places = np.where(codes == OK, found.loads.argmax(axis=-1), -1)
        near = None if deflection is None else found.near
        return Turned(found.turns - beta / own.crank_arm, places, planets, near, codes=codes)


def play_of(rv_set: RVSet, deviated: RVDeviated, turns: Array, beta: Array, one_mesh: OneMesh) -> Play:
    """Play of a reducer's bearings and planets, with its cranks beta (trials, positions) ahead."""
    disc = np.maximum(np.swapaxes(deviated.disc_play, 1, 2), 0.0)
    carrier = np.maximum(deviated.carrier_play, 0.0)
    free = np.zeros((*beta.shape, rv_set.cranks, 2))
    if rv_set.first is None:
        return Play(disc, carrier, free)
    for crank in range(rv_set.cranks):
        for side, flank in enumerate((RIGHT, LEFT)):
            free[:, :, crank, side] = throw_turn(rv_set, deviated, turns, crank, flank, one_mesh) - beta
    free[..., 0], free[..., 1] = np.minimum(free[..., 0], 0.0), np.maximum(free[..., 1], 0.0)
    pair = rv_set.first.pair
    alpha, arm = pair.working_pressure_angle, pair.wheel.base_radius
    return Play(disc, carrier, free, (math.cos(alpha) / arm, math.sin(alpha) / arm))


@dataclass(frozen=True)
class LinearResting:
    """Rest of a reducer to first order."""

    own: RVSet

    def turned(self, deviated: RVDeviated, turns: Array, sense: int, deflection: float | None = None) -> Turned:
        """See Turning."""
        own, trials = self.own, len(deviated.sun_thickness)
        beta, planets = crank_turns(own, deviated, turns, sense, first_order_mesh)
        phis = np.broadcast_to(own.crank_angles(turns), beta.shape)
        if turns.shape[1] == 1:
            phis = led_angles(own, turns, beta)
        play = play_of(own, deviated, turns, beta, first_order_mesh)
        found, places, near = np.empty(beta.shape), *(np.empty(beta.shape, dtype=np.int64) for _ in range(2))
        for position in range(beta.shape[1]):
            for first in range(0, trials, AT_ONCE):
                rows = np.arange(first, min(first + AT_ONCE, trials))
                forces = self._forces(deviated[rows], phis[rows, position], play, (rows, position), sense)
                if beta.shape[1] == 1:
                    known = _each_of(forces, phis[rows, 0])
                    own.known_forces(sense).of(_keys(deviated[rows], turns[rows]), partial(_of_known, known))
                found[rows, position] = forces.turns
                near[rows, position] = (forces.gaps <= (deflection or 0.0)).sum(axis=1)
                places[rows, position] = np.abs(forces.pins).reshape(len(rows), -1).argmax(axis=1)
        shifted, counted = phis if turns.shape[1] == 1 else None, None if deflection is None else near
        return Turned(found - beta / own.crank_arm, places, planets, counted, shifted)

    def rates(self, deviated: RVDeviated, turns: Array, sense: int) -> RVDeviated:
        """Derivatives of the turn at output turns (trials,) by each deviation, from the forces at rest."""
        own, rates = self.own, RVDeviated.nothing(self.own, len(turns))
        for first in range(0, len(turns), AT_ONCE):
            rows = np.arange(first, min(first + AT_ONCE, len(turns)))
            part, at = deviated[rows], turns[rows, None]
            known = own.known_forces(sense).of(_keys(part, at), partial(self._solved, part, at, sense))
            phis = np.array([angles[k] for _, angles, k in known])
            rates[rows] = rest_rates(own, part, turns[rows], phis, _put_together(known))
        return rates

    def _solved(self, deviated: RVDeviated, turns: Array, sense: int, rows: NDArray[np.intp]) -> Sequence[Known]:
        """Forces of some trials (rows) at output turns (trials, 1)."""
        own, part, at = self.own, deviated[rows], turns[rows]
        beta, _ = crank_turns(own, part, at, sense, first_order_mesh)
        phis = led_angles(own, at, beta)
        play = play_of(own, part, at, beta, first_order_mesh)
        forces = self._forces(part, phis[:, 0], play, (np.arange(len(rows)), 0), sense)
        return _each_of(forces, phis[:, 0])

    def _forces(self, part: RVDeviated, phis: Array, play: Play, at: tuple[Places, int], sense: int) -> Forces:
        """Forces of some trials (rows) at a position, given the play of all."""
        own, (rows, position) = self.own, at
        played = Play(play.disc[rows], play.carrier[rows], play.crank[rows, position], play.leaving)
        aside = None if own.width is None else part.disc_tilts * (own.width / 2)
        return LinearRest.of(own).rests(held_stage(own, part), phis, played, 1 if sense > 0 else -1, aside)


def _keys(deviated: RVDeviated, turns: Array) -> list[bytes]:
    """Keys of trials at output turns (trials, 1), the same of builds that differ by rounding."""
    stage = [getattr(deviated.stage, field.name) for field in fields(deviated.stage)]
    others = [getattr(deviated, field.name) for field in fields(deviated) if field.name != "stage"]
    rows = np.concatenate([own.reshape(len(turns), -1) for own in (*stage, *others, turns)], axis=1)
    return row_keys(np.rint(rows / ALIKE) + 0.0)  # no -0


def _each_of(forces: Forces, phis: Array) -> Sequence[Known]:
    return [(forces, phis, k) for k in range(len(phis))]


def _of_known(known: Sequence[Known], rows: NDArray[np.intp]) -> Sequence[Known]:
    return [known[k] for k in rows]


def _put_together(known: Sequence[Known]) -> Forces:
    """Forces of rests that were found at several times; gaps, which are of the pins that worked then, are left out."""
    names = (field.name for field in fields(Forces))
    none = np.empty((len(known), 0))
    return Forces(
        **{name: none if name == "gaps" else np.array([getattr(own, name)[k] for own, _, k in known]) for name in names}
    )


def exact_turning(rv_set: RVSet) -> Turning:
    """Turning of a reducer by the exact method."""
    return ExactResting(rv_set) if rv_set.plays else ExactTurning(rv_set)


def linear_turning(rv_set: RVSet) -> Turning:
    """Turning of a reducer by the analytic method."""
    return LinearResting(rv_set) if rv_set.plays else LinearTurning(rv_set)


SOLVERS: Final[Mapping[str, Solver]] = {
    "exact": Solver(
        exact_turning,
        lambda own: (cone_programmes.kept and rests.kept if own.plays else first_contacts.kept) and planet_turns.kept,
    ),
    ANALYTIC_METHOD: Solver(linear_turning, lambda own: cone_programmes.kept if own.plays else first_order_turns.kept),
}


def linear_rates(
    rv_set: RVSet, deviated: RVDeviated, turns: Array, sense: int, found: Turned | None = None
) -> RVDeviated:
    """Derivatives of the turn at output turns (trials,) by each deviation, at the contacts found or to be found."""
    if rv_set.plays:
        return LinearResting(rv_set).rates(deviated, turns, sense)
    turning = LinearTurning(rv_set)
    touching = found or turning.turned(deviated, turns[:, None], sense)
    return turning.rates(deviated.disc_tilts, turns, touching, sense)


def lost_motion_rates(rv_set: RVSet, deviated: RVDeviated, turns: Array) -> RVDeviated:
    """The same of the free turn between both ends."""
    return linear_rates(rv_set, deviated, turns, 1).plus(linear_rates(rv_set, deviated, turns, -1), -1.0)
