"""Output turn of an RV reducer, by each method.

A crank turned by beta against the carrier's motion is a crank at another angle: with rho turns of the cranks a turn of
the carrier while the input stands, exactly

    turn(phi, beta) = turn(phi + beta / (1 + rho / Zc)) - beta / (Zc + rho).

Over a turn the analytic method leaves out the first, by which the angle of the cranks shifts: trials share their angles
there. Which pins work at the window's edge may differ by that.
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.cycloid.exact.contact import leaning
from tol3d.gearing.cycloid.first_order.linear import LinearStage
from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.first_stage import add_rates, crank_turns, first_order_mesh, held_stage, placed_mesh
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gears import LEFT, RIGHT
from tol3d.numerics.arrays import Array, Places


@dataclass(frozen=True)
class Turned:
    """Turn of the output.

    Args:
        turns: beyond its nominal position (trials, positions) [rad], counter-clockwise; NaN where no pin touches.
        places: the pin that touches, disc times pins + pin; -1 for none.
        planets: the planet that stops the cranks, 0 without a first stage.
        near: working pins within a deflection of contact; None where none was stated.
        phis: crank angles (trials, 1) that the first stage has shifted [rad]; None where they are the nominal ones.
        codes: of the system's statuses (trials, positions); None where NaN says all.
    """

    turns: Array
    places: Places
    planets: Places
    near: Places | None = None
    phis: Array | None = None
    codes: NDArray[np.int8] | None = None


class Turning(Protocol):
    """One method to it."""

    def turned(self, deviated: RVDeviated, turns: Array, sense: int, deflection: float | None = None) -> Turned:
        """Turn the output until the first contact while the input stands.

        Args:
            turns: of the output (trials, positions) or (1, positions).
            sense: 1 counter-clockwise, -1 back.
            deflection: pins with at most this gap are counted [mm].
        """
        ...


@dataclass(frozen=True)
class ExactTurning:
    """Turning in finite geometry."""

    own: RVSet

    def turned(self, deviated: RVDeviated, turns: Array, sense: int, deflection: float | None = None) -> Turned:
        """See Turning."""
        own = self.own
        beta, planets = crank_turns(own, deviated, turns, sense, placed_mesh)
        phis = led_angles(own, turns, beta)
        stage = held_stage(own, deviated)
        found = own.contact.touches(stage, phis, (float(sense),), deflection, leans_of(own, deviated))
        near = None if found.near is None else found.near[..., 0]
        turned = output_turns(own, deviated, turns, sense, found.turns[..., 0], beta)
        return Turned(turned, found.places[..., 0], planets, near)


def output_turns(rv_set: RVSet, deviated: RVDeviated, turns: Array, sense: int, found: Array, beta: Array) -> Array:
    """Turn of the output (trials, positions) [rad], given the part found for the cycloid stage.

    Args:
        own, deviated, turns, sense: see Turning.
        found: turn of the cycloid stage.
        beta: turn of the cranks with the carrier in its place. By its turn they turn less than a thousandth of
            that more, which is nothing to the discs.
    """
    there = partial(placed_mesh, carried=found - beta / rv_set.crank_arm)
    return found - crank_turns(rv_set, deviated, turns, sense, there)[0] / rv_set.crank_arm


def leans_of(rv_set: RVSet, deviated: RVDeviated) -> Array | None:
    """Lean of the discs (trials, discs, 3): see `leaning`; None if they lie flat."""
    if rv_set.width is None or not np.any(deviated.disc_tilts):
        return None
    return leaning(deviated.disc_tilts, rv_set.width)


def led_angles(rv_set: RVSet, turns: Array, beta: Array) -> Array:
    """The angle of cranks that lead by beta, as cranks that do not."""
    return np.asarray(rv_set.crank_angles(turns) + beta * (rv_set.profile.lobes / rv_set.crank_arm))


@dataclass(frozen=True)
class LinearTurning:
    """Turning to first order."""

    own: RVSet

    def turned(self, deviated: RVDeviated, turns: Array, sense: int, deflection: float | None = None) -> Turned:
        """See Turning."""
        own = self.own
        beta, planets = crank_turns(own, deviated, turns, sense, first_order_mesh)
        aside = None if own.width is None else deviated.disc_tilts * (own.width / 2)
        phis = self.phis(turns, beta)
        found = self.stage.touches(held_stage(own, deviated), phis, 1 if sense > 0 else -1, aside, deflection)
        shifted = phis if turns.shape[1] == 1 else None
        return Turned(found.turns - beta / own.crank_arm, found.places, planets, found.near, shifted)

    @property
    def stage(self) -> LinearStage:
        """The cycloid stage."""
        return self.own.linear

    def phis(self, turns: Array, beta: Array) -> Array:
        """Crank angles (trials, 1), or over a turn (1, positions) of all trials [rad]; the cranks lead by beta."""
        return led_angles(self.own, turns, beta) if turns.shape[1] == 1 else self.own.crank_angles(turns)

    def rates(self, tilts: Array, turns: Array, found: Turned, sense: int) -> RVDeviated:
        """Derivatives of the turn (trials,) by each deviation with these pins and planets in contact.

        A tilt closes gaps whatever its sign: its rates are those on the side of the discs' tilts (trials, discs, 2).
        """
        own = self.own
        rates = RVDeviated.nothing(own, len(turns))
        phis = own.crank_angles(turns) if found.phis is None else found.phis[:, 0]
        rates = replace(rates, stage=own.linear.rates(phis, found.places[:, 0]))
        if own.first is not None:
            rates.stage.crank_phases[...] = 0.0  # of planets, below
        if own.width is not None:
            at = np.arange(len(turns)), found.places[:, 0] // own.profile.pins
            rates.disc_tilts[at] = _tilt_rates(rates.stage.carrier_offsets, tilts[at], own.width, sense)
        add_rates(own, rates, turns, found.planets[:, 0], LEFT if sense < 0 else RIGHT, -1 / own.crank_arm)
        return rates


def _tilt_rates(shifted: Array, tilts: Array, width: float, sense: int) -> Array:
    """Turn per tilt of the disc that touches (rows, 2), on the side on which it tilts.

    Args:
        shifted: turn per displacement of the disc in its own frame, -n over the pin's reach (rows, 2) [rad/mm].
        tilts: of that disc (rows, 2) [rad].
        width: of its face [mm].
        sense: of the turn, that of the reach.
    """
    across = np.stack([shifted[:, 1], -shifted[:, 0]], axis=-1)
    side = -sense * np.sign((across * tilts).sum(axis=1))
    return np.asarray(width / 2 * side[:, None] * across)
