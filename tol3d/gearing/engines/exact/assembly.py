"""Builds, compiled: what build.py adds up effect by effect is linear, so each deviation has its coefficients.

They are found by asking build.py for every component alone; what an effect does stands there and nowhere else. A turn
about a point off the gear's origin is the exception, worked out in sums.py.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.build import Build, Sums, in_seat, summed
from tol3d.gearing.engines.exact.sums import assemble
from tol3d.gearing.model import AxisTilt, Contributor, Model, Together
from tol3d.gearing.model.contributor import single_effects

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Assembly:
    """How deviations become builds.

    Args:
        terms: (terms, 2), component of the deviations and slot: SLOTS a seat, then the growth of each mesh's housing.
        coefficients: (terms,), of the slot by the component.
        pivots: (pivots, 2), component and seat of turns about a point off the gear's origin.
        levers: (pivots, 4), rotation vector per deviation in the seat's frame at rest, and the point's z there [mm].
        rest: (seats, 16), rotation of each seat's frame at rest row by row, its origin [mm], its mesh or -1; padded.
    """

    terms: NDArray[np.int64]
    coefficients: Array
    pivots: NDArray[np.int64]
    levers: Array
    rest: Array

    def build(self, deviations: Array) -> Build:
        """Builds of the trials with these deviations, (trials, components): build.build to the last few bits."""
        trials, seats = len(deviations), len(self.rest)
        made = Build(
            world_from_shaft=np.empty((trials, seats, 4, 4)),
            centre=np.empty((trials, seats, 2)),
            axis_turn=np.empty((trials, seats, 3)),
            flank_turn=np.empty((trials, seats)),
            flank_offset=np.empty((trials, seats)),
            scale=np.empty((trials, seats)),
        )
        assemble(
            np.require(deviations, requirements=["C", "W"]),
            self.terms,
            self.coefficients,
            self.pivots,
            self.levers,
            self.rest,
            *vars(made).values(),
        )
        return made


def assembly_of(model: Model) -> Assembly:
    """The assembly of a model."""
    terms, coefficients = [], []
    for contributor in model.contributors:
        alone = replace(model, contributors=(_without_pivot(contributor),))
        first = model.component_slices[contributor.name].start
        for component, unit in enumerate(np.eye(alone.component_count)):
            for slot, coefficient in enumerate(_slots(alone, summed(alone, unit[None]))):
                if coefficient != 0.0:
                    terms.append((first + component, slot))
                    coefficients.append(coefficient)
    pivots, levers = [], []
    for contributor in model.contributors:
        for effect in single_effects(contributor.effect):
            if isinstance(effect, AxisTilt) and effect.pivot != 0.0:
                for seat in model.seats_of(effect.part, effect.mesh):
                    axis = effect.axis if effect.mesh else in_seat(effect.axis, model.seats[seat])
                    pivots.append((model.component_slices[contributor.name].start, seat))
                    levers.append((*(effect.per_length * np.array(axis)), effect.pivot))
    return Assembly(
        np.array(terms, dtype=np.int64).reshape(-1, 2),
        np.array(coefficients),
        np.array(pivots, dtype=np.int64).reshape(-1, 2),
        np.array(levers, dtype=float).reshape(-1, 4),
        _rest(model),
    )


def _without_pivot(contributor: Contributor) -> Contributor:
    effects = tuple(
        replace(effect, pivot=0.0) if isinstance(effect, AxisTilt) else effect
        for effect in single_effects(contributor.effect)
    )
    return replace(contributor, effect=Together(effects))


def _slots(model: Model, sums: Sums) -> Array:
    """What one build adds up to, a slot each."""
    seats = [
        [
            *sums.axis_offset[0, index],
            *sums.axis_turn[0, index],
            *sums.centre[0, index],
            sums.flank_turn[0, index],
            sums.flank_offset[0, index],
            sums.growth(model, seat.gear)[0],
        ]
        for index, seat in enumerate(model.seats)
    ]
    housings = [sums.growth(model, mesh.housing)[0] if mesh.housing else 0.0 for mesh in model.meshes]
    return np.array([*np.ravel(seats), *housings])


def _rest(model: Model) -> Array:
    rest = np.zeros((len(model.seats), 16))
    rest[:, [0, 4, 8]] = 1.0
    rest[:, 12] = -1.0
    for index, mesh in enumerate(model.meshes):
        driven = model.seat_index[mesh.name, mesh.driven]
        rest[driven, :13] = [*mesh.pair.world_from_wheel.ravel(), *mesh.pair.wheel_origin, index]
    return rest
