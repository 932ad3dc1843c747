"""The analytic value of a backlash measure: the stack-up of its mesh, turned into the measure's quantity."""

import math

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Backlash, Kind, LostMotion, Mesh, Model, Reading
from tol3d.gearing.stack_up.bevel_stack import BevelStack
from tol3d.gearing.stack_up.spur_stack import SpurStack
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gearing.stack_up.term import Role
from tol3d.gears import BevelPair, GearPair, InternalPair, SpurPair

Array = NDArray[np.float64]


def stack_of(model: Model, mesh: Mesh, reading: Reading) -> Stack[GearPair]:
    """The stack-up of a mesh for one of its readings."""
    pair = mesh.pair
    if isinstance(pair, SpurPair | InternalPair):
        return SpurStack(model, mesh, pair, reading)
    if isinstance(pair, BevelPair):
        return BevelStack(model, mesh, pair, reading)
    raise TypeError(f"analytic/ has no stack-up for {type(pair).__name__}")


def analytic_backlash(model: Model, kind: Backlash, deviations: Array, driver_angle: Array) -> Array:
    """Value of a backlash measure by the stack-up [mm, or rad for an angle], (rows,).

    j_wt = j_bn / cos(alpha_w); an angle is j_bn over the arm of the gear that turns. For the rest angle it is the
    middle between both rests, by which the driven gear's play lies aside.
    """
    stack = stack_of(model, model.mesh(kind.mesh), kind.reading)
    per = per_normal_backlash(model, kind)
    if kind.quantity == "rest_angle":
        return stack.aside(deviations, driver_angle) * per
    turns: Role | None = None
    if kind.quantity != "normal_backlash":
        turns = "driver" if kind.is_angle and kind.gear == stack.mesh.driver else "driven"
    return stack.normal_backlash(deviations, driver_angle, turns) * per


def per_normal_backlash(model: Model, kind: Backlash) -> float:
    """What turns j_bn [mm] into the measure: 1, 1/cos(alpha_w) or one over the gear's arm [rad/mm]."""
    if kind.quantity == "normal_backlash":
        return 1.0
    if kind.quantity == "circumferential_backlash":
        return 1.0 / math.cos(model.mesh(kind.mesh).pair.working_pressure_angle)
    return 1.0 / model.gear(kind.gear).gear.section_arm


def first_order(kind: Kind, free: Array) -> Array:
    """A measure's values (trials, positions) of what its backlashes leave free: a tip moves by L times the turn.

    Over a swing the tip errs where the other flanks work than at the start.
    """
    if not isinstance(kind, LostMotion) or kind.tip is None:
        return free
    displacement = kind.tip.lever * free
    return displacement * np.array(kind.turned, dtype=float) if kind.turned else displacement
