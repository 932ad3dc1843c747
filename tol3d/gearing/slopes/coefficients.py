"""Coefficients of a scene's contributors in its measures, by the stack-up and by the geometry, before any trial."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tol3d.gearing.engines import Engine
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Unit
from tol3d.gearing.methods.analytic import analytic_values
from tol3d.gearing.model import Contributor, Measure, Model, Planar, Positions
from tol3d.gearing.model.measure import at_one_position
from tol3d.gearing.slopes.sensitivity import sensitivities
from tol3d.gearing.stack_up import reference_form
from tol3d.numerics.arrays import Array
from tol3d.report.number import NOTHING, UNIT_SIGNS
from tol3d.study.system.closed_form import Share
from tol3d.study.system.stated import mean_deviations, stated

# mm, rad, K; separates the two sides of a kink (1 um of a gap by the end of a face) and bends nothing (1e-5 of a slope)
STEP_ASIDE: dict[Unit, float] = {"um": 1e-4, "mrad": 1e-5, "arcmin": 1e-5, "K": 0.1}


@dataclass(frozen=True)
class Slope:
    """Slope of a measure for one contributor, others at their means; at a kink it has two values.

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
    """Both sides; one that cannot be assembled takes the other's."""
    return np.array([above if np.isnan(below) else below, below if np.isnan(above) else above])


def _direction(contributor: Contributor, measure: Measure, gradient: Array) -> float | None:
    draw = contributor.draw
    if not isinstance(draw, Planar):
        return None
    turns_at_random = contributor.effect.turns_with is not None and measure.positions.over == "random"
    if draw.direction is not None and not turns_at_random:
        return draw.direction
    return float(np.arctan2(gradient[1], gradient[0]))


UM = 1000.0  # um in a mm
ARCSEC = 648000 / math.pi  # arcsec in a rad
ONE_SIDED = ("axis_in_plane", "axis_out_of_plane")  # kinds whose coefficient acts by absolute value
LEAST_SLOPE = 5e-4  # um or arcsec per unit; less rounds to 0.000
DISAGREES = 0.05  # of the largest slope; beyond that a coefficient of the geometry is marked
BESIDE = 0.01  # of a step aside; the step of the slope there
KINK = 0.01  # of the larger slope; two sides that differ by less are one


@dataclass(frozen=True)
class Slopes:
    """Change of a measure per unit of a contributor, below and above its mean; NaN where neither seats."""

    below: float
    above: float

    def __str__(self) -> str:
        if math.isnan(self.below + self.above):
            return NOTHING
        if self.bends:
            return f"{_slope_text(self.below)}/{_slope_text(self.above)}"
        return _slope_text((self.below + self.above) / 2)

    @property
    def bends(self) -> bool:
        """True if the two sides are not one slope."""
        return self.differs(Slopes(self.above, self.below), KINK)

    def differs(self, other: "Slopes", share: float) -> bool:
        """True if either slope is off by more than a fraction of the largest of all."""
        slopes = (self.below, self.above, other.below, other.above)
        off = max(abs(self.below - other.below), abs(self.above - other.above))
        return off > max(share * max(map(abs, slopes)), LEAST_SLOPE)


LEVEL = Slopes(0.0, 0.0)
UNKNOWN = Slopes(math.nan, math.nan)


@dataclass(frozen=True)
class Coefficient:
    """Effect of a contributor on a measure at the mean build, in its worst direction if it has one.

    Args:
        name: the contributor's.
        unit: of the slopes, "µm/µm" or "″/K".
        stack_up, geometry: by each method.
        percent: its share of the variance by the stack-up; None with parallel load paths, or if only 3D sees it.
    """

    name: str
    unit: str
    stack_up: Slopes
    geometry: Slopes
    percent: float | None

    @property
    def disagrees(self) -> bool:
        """True if the geometry has another slope than the stack-up."""
        return self.geometry.differs(self.stack_up, DISAGREES)


def coefficients_of(model: Model) -> Mapping[str, Sequence[Coefficient]]:
    """For each measure the coefficients of the contributors that act on it, see `Coefficient`.

    Of a measure that takes an extreme or a curve those of its value at a random position, the driver at 0.
    """
    known = coefficients_by_value(model)
    return {measure.name: known[of_one_value(measure)] for measure in model.measures}


def of_one_value(measure: Measure) -> Measure:
    """The measure of one value that coefficients are of: measures that are equal here have the same."""
    at = measure.take == "value" and measure.positions.over == "at"
    positions = measure.positions if at else Positions("random", 1, 1)
    return Measure("", at_one_position(measure.kind), positions, "value")


def coefficients_by_value(model: Model) -> Mapping[Measure, Sequence[Coefficient]]:
    """The coefficients of each measure of one value, see `of_one_value`."""
    engine = ExactEngine(model)
    measures = dict.fromkeys(of_one_value(measure) for measure in model.measures)
    return {measure: tuple(_of_measure(model, engine, measure)) for measure in measures}


def _of_measure(model: Model, engine: Engine, measure: Measure) -> Iterator[Coefficient]:
    """One for each contributor that acts on the measure."""
    form = reference_form(model, measure)
    shares = {share.name: share for share in form.shares} if form else {}
    seen = mean_slopes(model, engine, measure)
    by_method = _method_slopes(model, measure, seen)
    for contributor, slope, on_method in zip(model.contributors, seen, by_method, strict=True):
        per = (ARCSEC if measure.kind.is_angle else UM) * contributor.per_unit
        unit = f"{'″' if measure.kind.is_angle else 'µm'}/{UNIT_SIGNS[contributor.unit]}"
        found = Slopes(slope.below * per, slope.above * per)
        share = shares.get(contributor.name)
        if form is None or contributor.name in form.leaning:
            expected = on_method
        else:
            expected = _linear(contributor, share) if share else UNKNOWN
        by_stack = Slopes(expected.below * per, expected.above * per)
        if share or found.differs(LEVEL, 0.0) or by_stack.differs(LEVEL, 0.0):
            percent = form.percent(contributor.name) if form and share else None
            yield Coefficient(contributor.name, unit, by_stack, found, percent)


def _linear(contributor: Contributor, share: Share) -> Slopes:
    """Slopes for a linear effect; a tilt acts by its absolute value: away from 0 one slope, at 0 two."""
    if contributor.kind not in ONE_SIDED:
        return Slopes(share.coefficient, share.coefficient)
    sides = np.sign(contributor.distribution.mean + STEP_ASIDE[contributor.unit] * np.array([-1.0, 1.0]))
    return Slopes(*(share.coefficient * sides).tolist())


def _method_slopes(model: Model, measure: Measure, along: Sequence[Slope]) -> list[Slopes]:
    """Slopes of the analytic method's values beside the mean build [internal units], in the directions that are stated.

    Where a contributor is no term of a sum: it leans axes, or only the tighter of parallel load paths counts. Taken
    STEP_ASIDE of the mean build, where those of the geometry are; the method is straight from kink to kink.
    """
    mean = mean_deviations(model, measure.positions)
    lengths = np.array([STEP_ASIDE[contributor.unit] for contributor in model.contributors])
    steps = np.zeros((len(along), model.component_count))
    for step, length, contributor, slope in zip(steps, lengths, model.contributors, along, strict=True):
        towards = [1.0] if slope.direction is None else [math.cos(slope.direction), math.sin(slope.direction)]
        step[model.component_slices[contributor.name]] = np.array(towards) * length
    ends = (-1 - BESIDE, -1 + BESIDE, 1 - BESIDE, 1 + BESIDE)
    rows = np.concatenate([mean + end * steps for end in ends])
    values = analytic_values(model, measure, stated(model, rows))[:, 0].reshape(len(ends), -1)
    sides = (values[1::2] - values[::2]) / (2 * BESIDE * lengths)
    return [Slopes(float(below), float(above)) for below, above in sides.T]


def _slope_text(slope: float) -> str:
    """A slope with three digits, or three decimals where it is small; 0 has no sign."""
    if abs(slope) < LEAST_SLOPE:
        return "0.000"
    return f"{slope:+.3f}" if abs(slope) < 1 else f"{slope:+#.3g}".rstrip(".")
