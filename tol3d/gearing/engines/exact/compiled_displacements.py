"""Displacements as coefficients of deviations: builds are linear in them, and a kernel adds them up.

A turn about a point off the gear's origin is not linear; sums.py computes it.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.builds.build import Build
from tol3d.gearing.builds.displacements import Displacement, FlankOffsets, Growth, PivotShift, displacements
from tol3d.gearing.builds.flank_offsets import FlankPlaces
from tol3d.gearing.engines.exact.sums import SCALE, SLOTS, write_builds
from tol3d.gearing.model import Model
from tol3d.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class CompiledDisplacements:
    """Dependence of a build's seats on deviations, as summed by the kernel.

    Args:
        terms: (terms, 2), component of the deviations, and slot of the seat: SLOTS per seat, then the growth of each
            mesh's housing.
        coefficients: (terms,), change of the slot per change of the component [mm/mm, rad/rad ...].
        pivots: (pivots, 2), component and seat of turns about a point off the gear's origin.
        levers: (pivots, 4), rotation vector per deviation in the seat's frame at rest, and the point's z there [mm].
        rest: (seats, 16), rotation of each seat's frame at rest row by row, its origin [mm], the mesh that it is the
            driven seat of or -1; padded. Frames of driver seats are the identity.
        flanks: offsets of single flanks.
    """

    terms: NDArray[np.int64]
    coefficients: Array
    pivots: NDArray[np.int64]
    levers: Array
    rest: Array
    flanks: FlankPlaces

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
        write_builds(
            np.require(deviations, requirements=["C", "W"]),
            self.terms,
            self.coefficients,
            self.pivots,
            self.levers,
            self.rest,
            *(values for values in vars(made).values() if values is not None),
        )
        return replace(made, flanks=self.flanks.made(deviations))


def compiled_displacements(model: Model) -> CompiledDisplacements:
    """Coefficients of all of a model's contributors."""
    terms, coefficients, pivots, levers = [], [], [], []
    for contributor in model.contributors:
        first, components = model.component_slices[contributor.name].start, len(contributor.draw.components)
        totals = np.zeros((components, SLOTS * len(model.seats) + len(model.meshes)))
        for effect in contributor.effect.singles:
            for term in displacements(effect, model, components):
                match term:
                    case Displacement():
                        start = SLOTS * term.seat
                        totals[:, start + term.slots.start : start + term.slots.stop] += term.rates
                    case PivotShift():
                        pivots.append((first, term.seat))
                        levers.append((*term.turn, term.pivot))
                    case Growth():
                        totals[:, _growing(model, term.part)] += model.expansions[term.part]
                    case FlankOffsets():
                        pass
        terms += [(first + component, slot) for component, slot in np.argwhere(totals)]
        coefficients += totals[totals != 0.0].tolist()
    return CompiledDisplacements(
        np.array(terms, dtype=np.int64).reshape(-1, 2),
        np.array(coefficients),
        np.array(pivots, dtype=np.int64).reshape(-1, 2),
        np.array(levers, dtype=float).reshape(-1, 4),
        _rest(model),
        FlankPlaces.of(model),
    )


def _growing(model: Model, part: str) -> list[int]:
    """Slots of a part's growth: in its own seats, and in the meshes that it holds."""
    seats = [SLOTS * index + SCALE for index, seat in enumerate(model.seats) if seat.gear == part]
    after = SLOTS * len(model.seats)
    return seats + [after + index for index, mesh in enumerate(model.meshes) if mesh.housing == part]


def _rest(model: Model) -> Array:
    rest = np.zeros((len(model.seats), 16))
    rest[:, [0, 4, 8]] = 1.0
    rest[:, 12] = -1.0
    for index, mesh in enumerate(model.meshes):
        driven = model.seat_index[mesh.name, mesh.driven]
        rest[driven, :13] = [*mesh.pair.world_from_wheel.ravel(), *mesh.pair.wheel_origin, index]
    return rest
