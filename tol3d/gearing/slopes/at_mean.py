"""Slopes of measures at the mean build, contributor by contributor."""

from dataclasses import dataclass

import numpy as np

from tol3d.gearing.engines import Engine
from tol3d.gearing.model import Contributor, Measure, Model, Planar
from tol3d.gearing.model.contributor import Unit
from tol3d.gearing.slopes.sensitivity import sensitivities
from tol3d.numerics.arrays import Array
from tol3d.system.stated import mean_deviations, stated

# mm, rad, K; separates the two sides of a kink (1 um of a gap by the end of a face) and bends nothing (1e-5 of a slope)
STEP_ASIDE: dict[Unit, float] = {"um": 1e-4, "mrad": 1e-5, "arcmin": 1e-5, "K": 0.1}


@dataclass(frozen=True)
class Slope:
    """How a measure changes with one contributor alone, others at their means; at a kink differently on both sides.

    Args:
        name: the contributor's.
        below, above: derivative [mm or rad per mm, rad, K] on the side of smaller and of larger deviations; nan
            where neither side seats.
        direction: along which a deviation with a direction is taken [rad]: the one in which the measure grows most,
            or its own fixed one; None for a deviation without.
    """

    name: str
    below: float
    above: float
    direction: float | None = None


def mean_slopes(model: Model, engine: Engine, measure: Measure) -> tuple[Slope, ...]:
    """Slopes of a measure with one value, at the mean build, the driver at 0 for random positions.

    At a nominal build pairs tie and gaps lie all along a face, so that each slope is taken STEP_ASIDE of it.
    """
    middle = mean_deviations(model, measure.positions)
    unit_steps = np.eye(model.component_count)
    gradients = _beside(model, engine, measure, middle, unit_steps)
    gradient = np.array([_either(*gradients[:, :, k][:, k]).mean() for k in range(model.component_count)])
    directions = [_direction(c, measure, gradient[model.component_slices[c.name]]) for c in model.contributors]
    steps = np.zeros((len(directions), model.component_count))
    for step, contributor, direction in zip(steps, model.contributors, directions, strict=True):
        along = [1.0] if direction is None else [np.cos(direction), np.sin(direction)]
        step[model.component_slices[contributor.name]] = along
    sides = (_beside(model, engine, measure, middle, steps) * steps).sum(axis=2)
    both = [_either(*own) for own in sides.T]
    return tuple(
        Slope(contributor.name, float(below), float(above), direction)
        for contributor, (below, above), direction in zip(model.contributors, both, directions, strict=True)
    )


def _beside(model: Model, engine: Engine, measure: Measure, middle: Array, steps: Array) -> Array:
    """Derivatives (2, steps, components) below and above a build (1, components), STEP_ASIDE along each step."""
    lengths = np.array([STEP_ASIDE[c.unit] for c in model.contributors for _ in c.draw.components])
    rows = np.concatenate([middle - lengths * steps, middle + lengths * steps])
    return sensitivities(model, engine, stated(model, rows), measure).reshape(2, len(steps), -1)


def _either(below: float, above: float) -> Array:
    """Both sides; one that does not seat takes the other's."""
    return np.array([above if np.isnan(below) else below, below if np.isnan(above) else above])


def _direction(contributor: Contributor, measure: Measure, gradient: Array) -> float | None:
    draw = contributor.draw
    if not isinstance(draw, Planar):
        return None
    turns_at_random = contributor.effect.turns_with is not None and measure.positions.over == "random"
    if draw.direction is not None and not turns_at_random:
        return draw.direction
    return float(np.arctan2(gradient[1], gradient[0]))
