"""Derivatives of measures by deviations, through the contacts that seat a mesh.

A gap changes by the motion of its nearest points along its normal, for they stay nearest to first order (envelope
theorem). The driven gear's turn keeps the gap of the touching pair zero, which gives its rate (implicit function
theorem), and the measure's own gap or turn follows. Where two pairs tie, or a gap lies all along a face, a measure has
a kink, and the derivative is that of the one pair or point which the engine gives.

Neglected: errors of an engine's normals. At contacts of edges an engine that gives the normal of a flank, not of the
nearest points, is off by the slope of the gap along that edge.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.builds.flank_offsets import FlankPlaces
from tol3d.gearing.builds.rates import BuildRates, build_rates
from tol3d.gearing.engines import OK, Engine, Gaps
from tol3d.gearing.meshing.mesh import Meshing, MeshSeat
from tol3d.gearing.meshing.seats import Seats, geometric_values, moved_rates, play_of, seated
from tol3d.gearing.model import Backlash, Measure, Model, TransmissionError
from tol3d.gearing.model.measure import Slide
from tol3d.gearing.play.linked import link_trials
from tol3d.gearing.play.play import Variable, axial_rates, seat_key
from tol3d.gears import Flank
from tol3d.gears.flank import opposite
from tol3d.numerics import frames
from tol3d.numerics.arrays import Array
from tol3d.study.system.taken import ROWS_AT_ONCE
from tol3d.study.system.trials import Trials

Moves = tuple[BuildRates, BuildRates]
"""Rates of the builds, and of those with the load on the other flanks."""


def sensitivities(model: Model, engine: Engine, trials: Trials, measure: Measure) -> Array:
    """Derivatives of a measure's value by each component of the deviations, each trial at its own build.

    Args:
        model, engine: the model, and the engine for its gaps.
        trials: deviations and driver positions of the trials.
        measure: of that model, or one like it.

    Returns:
        (trials, components) [mm or rad per mm, rad, K], columns as in `model.component_slices`; for a curve
        (trials, positions, components). NaN where a trial could not be assembled.
    """
    size = max(1, ROWS_AT_ONCE // measure.positions.in_a_trial)
    pieces = (trials.part(first, first + size) for first in range(0, len(trials), size))
    return np.concatenate([_sensitivities(model, engine, piece, measure) for piece in pieces])


def _sensitivities(model: Model, engine: Engine, trials: Trials, measure: Measure) -> Array:
    alone = replace(model, measures=(measure,))
    seats, count = seated(alone, engine, trials), measure.positions.in_a_trial
    rows = np.repeat(np.arange(len(trials)), count)
    moves = build_rates(model, seats.build, trials.deviations).rows(rows)
    others = moves
    if seats.reversed_build:
        others = build_rates(model.reversed, seats.reversed_build, trials.deviations).rows(rows)
    rates = _free_rates(alone, measure, (moves, others), seats).reshape(len(trials), count, -1)
    rates = moved_rates(measure.kind, play_of(measure, seats).free(), rates)
    return taken_rates(measure, geometric_values(measure, seats), rates)


def _free_rates(model: Model, measure: Measure, moves: Moves, seats: Seats) -> Array:
    """Derivatives of a measure's play, (rows, components)."""
    kind = measure.kind
    if isinstance(kind, Backlash):
        key = seat_key(model, measure, kind)
        return _rates(kind, seats.meshings[key], moves, seats.seats[key]) + _sliding_rates(seats, kind.slides, measure)
    total = np.zeros((len(moves[0].scale), model.component_count))
    if isinstance(kind, TransmissionError):
        for factor, backlash in kind.backlashes:
            key = seat_key(model, measure, backlash)
            total += factor * _rates(backlash, seats.meshings[key], moves, seats.seats[key])
        return total
    play = play_of(measure, seats)
    for stage in kind.stages:
        for variable, weight in play.form(stage).items():
            rows = np.broadcast_to(weight, (len(seats.trials), measure.positions.in_a_trial)).reshape(-1, 1)
            total += stage.factor * rows * _variable_rates(model, measure, moves, seats, variable)
        total += stage.factor * _sliding_rates(seats, stage.slides, measure)
    return total


def _sliding_rates(seats: Seats, slides: Sequence[Slide], measure: Measure) -> Array:
    """Derivatives of the turns by which shafts slide, (rows, components); one row of zeros where none does."""
    total = np.zeros((1, seats.model.component_count))
    for slide in slides:
        total = total + slide.factor * axial_rates(seats.model, slide.shaft, seats.trials.deviations)
    return total if not slides else np.repeat(total, measure.positions.in_a_trial, axis=0)


def _variable_rates(model: Model, measure: Measure, moves: Moves, seats: Seats, variable: Variable) -> Array:
    """Derivatives of a stage's play, or of the angle at which its driven gear rests, (rows, components)."""
    stage, what = variable
    rates = np.zeros((len(moves[0].scale), model.component_count))
    if isinstance(stage, str) or what == "slide":
        by_shaft = axial_rates(model, str(stage), seats.trials.deviations)
        return np.repeat(by_shaft, measure.positions.in_a_trial, axis=0)
    if stage.backlash is None:
        link = model.link(stage.link)
        for name, own in link.rates(link_trials(model, measure, link, seats.trials), what).items():
            rates[:, model.component_slices[name]] = own.reshape(len(rates), -1)
        return rates
    key = seat_key(model, measure, stage.backlash)
    if what == "play":
        return _rates(stage.backlash, seats.meshings[key], moves, seats.seats[key])
    for contributor in model.contributors:
        rate = contributor.effect.clocking(model.mesh(stage.backlash.mesh))
        rates[:, model.component_slices[contributor.name]] += rate
    resting = replace(stage.backlash, quantity="rest_angle")
    return rates + _rates(resting, seats.meshings[key], moves, seats.seats[key])


def _rates(backlash: Backlash, meshing: Meshing, moves: Moves, seat: MeshSeat) -> Array:
    """Derivatives of a backlash at every position, (rows, components); NaN where the mesh could not be assembled."""
    good = np.flatnonzero(seat.status == OK)
    rates = np.full((len(seat.status), meshing.model.component_count), np.nan)
    contacts = _Contacts(meshing.rows(good), moves[0].rows(good))
    at_rest = (seat.driver_angle[good], seat.driven_angle[good])
    if backlash.quantity == "rest_angle":
        section = meshing.reading.contact == "section"
        rates[good] = contacts.nearest(meshing.flank, at_rest, seat.working.rows(good), section=section).driven_turn
        return rates
    if backlash.quantity == "normal_backlash":
        rates[good] = _of_gap(contacts, at_rest, seat.working.rows(good), seat.non_working.rows(good))
        return rates
    turn_driver = backlash.is_angle and backlash.gear == meshing.mesh.driver
    end = contacts if meshing.reversed is None else _Contacts(meshing.reversed.rows(good), moves[1].rows(good))
    turn = _of_turn((contacts, end), at_rest, seat.working.rows(good), turn_driver=turn_driver)
    rates[good] = turn if backlash.is_angle else turn * meshing.mesh.pair.working_radii[1]
    return rates


def _of_gap(contacts: "_Contacts", at_rest: tuple[Array, Array], working: Gaps, non_working: Gaps) -> Array:
    """Derivatives of the least gap of the non-working flanks at rest."""
    reading, flank = contacts.meshing.reading, contacts.meshing.mesh.working_flank
    touch = contacts.nearest(flank, at_rest, working, section=reading.contact == "section")
    gap = contacts.nearest(opposite(flank), at_rest, non_working, section=reading.gap == "section")
    return gap.by_deviation + gap.by_turn[1][:, None] * touch.driven_turn


def _of_turn(
    both: tuple["_Contacts", "_Contacts"], at_rest: tuple[Array, Array], working: Gaps, *, turn_driver: bool
) -> Array:
    """Derivatives of the turn of one gear from its rest to the contact of the non-working flanks, each in its build."""
    contacts, last = both
    meshing, flank = last.meshing, last.meshing.mesh.working_flank
    section = meshing.reading.contact == "section"
    touch = contacts.nearest(flank, at_rest, working, section=section)
    at_end, ends, touched = meshing.turn_to_contact(opposite(flank), at_rest, turn_driver=turn_driver)
    end = last.nearest(opposite(flank), at_end, ends, section=section)
    mover = 0 if turn_driver else 1
    if turn_driver:
        rate = -(end.by_deviation + end.by_turn[1][:, None] * touch.driven_turn) / end.by_turn[0][:, None]
    else:
        rate = end.driven_turn - touch.driven_turn
    rate *= np.sign(at_end[mover] - at_rest[mover])[:, None]
    rate[~touched] = np.nan
    return rate


@dataclass(frozen=True)
class _GapRates:
    """Rates of one gap of each row.

    Args:
        by_deviation: (rows, components) [mm per mm, rad, K], both gears held at their turns.
        by_turn: of driver and driven, each (rows,) [mm/rad].
    """

    by_deviation: Array
    by_turn: tuple[Array, Array]

    @property
    def driven_turn(self) -> Array:
        """Turn of the driven gear [rad] that keeps the gap as it is, (rows, components)."""
        return -self.by_deviation / self.by_turn[1][:, None]


@dataclass(frozen=True)
class _Contacts:
    """Builds of a mesh with their rates, one row a trial and position."""

    meshing: Meshing
    moves: BuildRates

    def nearest(self, flank: Flank, angles: tuple[Array, Array], gaps: Gaps, *, section: bool) -> _GapRates:
        """Rates of the least of some gaps at turns (rows,) [rad]; asked again, for gaps at rest lie a step away."""
        meshing = self.meshing
        first = np.argmin(np.where(np.isnan(gaps.value), np.inf, gaps.value), axis=1)
        teeth = np.take_along_axis(gaps.driver_teeth, first[:, None], axis=1)
        wanted = np.ones(teeth.shape, dtype=bool)
        gap = meshing.engine.gaps(meshing.build, meshing.mesh, flank, angles, teeth, wanted, section=section)
        mesh = meshing.mesh
        driver, driven = (meshing.model.seat_index[mesh.name, name] for name in (mesh.driver, mesh.driven))
        normal = gap.normal[:, 0]
        turns = [gap.per_turn(*meshing.build.axis(gear), of_driver=gear == driver)[:, 0] for gear in (driver, driven)]
        behind = self._along(driver, angles[0], flank, gap.driver_point[:, 0], -normal)
        mating = mesh.pair.mating_flank(flank)
        before = self._along(driven, angles[1], mating, gap.driven_point[:, 0], normal)
        if meshing.build.flanks is not None:
            behind -= self._standing_out(driver, angles[0], flank, gap.driver_point[:, 0], teeth[:, 0])
            mates = mesh.pair.mating_teeth(teeth[:, 0], flank)
            before -= self._standing_out(driven, angles[1], mating, gap.driven_point[:, 0], mates)
        return _GapRates(behind + before, (turns[0], turns[1]))

    def _standing_out(self, seat: int, angle: Array, flank: Flank, point: Array, teeth: NDArray[np.int64]) -> Array:
        """Rate of a gear's single-flank offsets at a point [mm], (rows, components)."""
        made, model = self.meshing.build, self.meshing.model
        arm = (point - made.centre_of(seat, angle)) / made.scale[:, seat, None]
        height = _dot(arm, made.axis(seat)[1])
        across = _dot(arm, arm) - height * height
        base = model.gear(model.seats[seat].gear).gear.base_radius
        roll = np.sqrt(np.maximum(across / base**2 - 1.0, 0.0))
        return FlankPlaces.of(model).rates(model, seat, flank, teeth, (roll, height))

    def _along(self, gear: int, angle: Array, flank: Flank, point: Array, normal: Array) -> Array:
        """Rate at which a gear's flank recedes at a point [mm], (rows, components); the normal points into the gear.

        A flank that is turned out of its tooth turns about the gear's own centre, against its own sign. Growth moves
        the flank that has no offset yet.
        """
        made, moves = self.meshing.build, self.moves
        shaft, (origin, axis) = made.world_from_shaft[:, gear, :3, :3], made.axis(gear)
        arm = point - made.centre_of(gear, angle)
        grown = _dot(arm + made.flank_offset[:, gear, None] * normal, normal) / made.scale[:, gear]
        across = frames.apply(frames.transposed(frames.matmul(shaft, frames.about_z(angle))), normal)
        return (
            _dot(moves.origin[:, gear], normal[:, None])
            + _dot(moves.turn[:, gear], np.cross(point - origin, normal)[:, None])
            + _dot(moves.centre[:, gear], across[:, None, :2])
            - moves.flank_turn[:, gear] * (flank * _dot(np.cross(axis, arm), normal))[:, None]
            - moves.flank_offset[:, gear]
            + moves.scale[:, gear] * grown[:, None]
        )


def _dot(left: Array, right: Array) -> Array:
    """Scalar products over the last axis."""
    return np.asarray((left * right).sum(axis=-1))


# what is taken over positions ---------------------------------------------------------------------


def taken_rates(measure: Measure, values: Array, rates: Array) -> Array:
    """Derivatives of `taken`: (trials, components), or (trials, positions, components) for a curve.

    Args:
        measure: what is taken of its values.
        values: (trials, positions).
        rates: their derivatives, (trials, positions, components).
    """
    if measure.take == "curve":
        return rates
    if measure.take == "value":
        return rates[:, 0]
    closed = measure.positions.closed
    highest, lowest = (
        sample_weights(own) if measure.positions.jumps else peak_weights(own, closed=closed)
        for own in (values, -values)
    )
    weights = {"max": highest, "min": lowest, "range": highest - lowest}[measure.take]
    return np.asarray((weights[:, :, None] * rates).sum(axis=1))


def sample_weights(values: Array) -> Array:
    """Weights of the samples (trials, positions) in the highest of them."""
    weights = np.zeros_like(values)
    weights[np.arange(len(values)), np.argmax(values, axis=1)] = 1.0
    return weights


def peak_weights(values: Array, *, closed: bool) -> Array:
    """Weights of the samples (trials, positions) in the highest point of the parabola that `taken` lays through them.

    They are Lagrange's at the highest point. Its place moves with the samples, but there the parabola is level, and
    where the place is an end of the three samples it does not move: the weights serve for the derivative too.
    """
    count, rows = values.shape[1], np.arange(len(values))
    peak = np.argmax(values, axis=1)
    weights = np.zeros_like(values)
    if count < 3:
        weights[rows, peak] = 1.0
        return weights
    centre = peak if closed else np.clip(peak, 1, count - 2)
    before, after = (centre - 1) % count, (centre + 1) % count
    bend = 2 * values[rows, centre] - values[rows, before] - values[rows, after]
    slope = (values[rows, after] - values[rows, before]) / 2
    bent = bend > 0.0
    place = np.clip(slope / np.where(bent, bend, 1.0), -1.0, 1.0)
    weights[rows, centre] = 1 - place**2
    weights[rows, before] = (place**2 - place) / 2
    weights[rows, after] = (place**2 + place) / 2
    weights[~bent] = 0.0
    weights[rows[~bent], peak[~bent]] = 1.0
    return weights
