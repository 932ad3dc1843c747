"""The exact engine: contact of the mathematical flanks, in compiled kernels; no solid, no mesh, no chord error."""

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.builds.build import Build
from tol3d.gearing.builds.flank_offsets import FlankPlaces
from tol3d.gearing.engines.exact.compiled_displacements import CompiledDisplacements, compiled_displacements
from tol3d.gearing.engines.exact.deviated import DeviatedTooth
from tol3d.gearing.engines.exact.deviated_helical import DeviatedHelicalTooth
from tol3d.gearing.engines.exact.deviated_ring import DeviatedInternalHelicalTooth
from tol3d.gearing.engines.exact.flank_contact import ALL_TEETH, DRIVEN_TOOTH, DRIVER_TOOTH
from tol3d.gearing.engines.exact.helical import HelicalTooth, InternalHelicalTooth
from tol3d.gearing.engines.exact.kernels import (
    NO_FLANKS,
    PairKernels,
    deviated_gaps,
    deviated_helical_gaps,
    deviated_helical_read,
    deviated_helical_rests,
    deviated_internal_helical_gaps,
    deviated_internal_helical_read,
    deviated_internal_helical_rests,
    deviated_read,
    deviated_rests,
    kernels_of,
)
from tol3d.gearing.engines.exact.rows import CONTACT, DRIVEN_ANGLE, DRIVEN_TURN, DRIVER_TURN, GAP, READINGS
from tol3d.gearing.engines.exact.spur import SpurTooth
from tol3d.gearing.engines.gaps import Gaps, MeshReading
from tol3d.gearing.engines.status import OUT_OF_RANGE
from tol3d.gearing.model import Mesh, Model, Reading, TransmissionError
from tol3d.gearing.model.flank_margin import margin_of, standing_out
from tol3d.gears import Flank
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import Kernel

Teeth = NDArray[np.int64]

DEPTH = 1.0  # mm
LAST_STEP = 1e-8  # mm
WHICH_TEETH = {"all": ALL_TEETH, "driver": DRIVER_TOOTH, "driven": DRIVEN_TOOTH}


class ExactEngine:
    """Gaps and backlashes of the mathematical flanks of a model's meshes."""

    chord_error = 0.0

    def __init__(self, model: Model) -> None:
        self._model = model
        self._displacements = compiled_displacements(model)
        self._pairs = {mesh.name: kernels_in(model, mesh, self._displacements.flanks) for mesh in model.meshes}

    @property
    def kept(self) -> bool:
        """True if the kernels for its studies are compiled on this machine."""
        rests = any(isinstance(measure.kind, TransmissionError) for measure in self._model.measures)
        return all(pair.read.kept and (pair.rests.kept or not rests) for pair in self._pairs.values())

    def depth(self, mesh: Mesh) -> float:
        """1 mm: any overlap can be measured."""
        return DEPTH

    def last_step(self, mesh: Mesh) -> float:
        """1e-8 mm: the rest of a gap that falls quadratically."""
        return LAST_STEP

    def build(self, deviations: Array) -> Build:
        """See ReadingEngine.build."""
        return self._displacements.build(deviations)

    def reversed_build(self, deviations: Array) -> Build:
        """See ReadingEngine.reversed_build."""
        return self._reversed_displacements.build(deviations)

    @cached_property
    def _reversed_displacements(self) -> CompiledDisplacements:
        return compiled_displacements(self._model.reversed)

    def gaps(
        self,
        build: Build,
        mesh: Mesh,
        flank: Flank,
        angles: tuple[Array, Array],
        driver_teeth: Teeth,
        wanted: NDArray[np.bool_],
        *,
        section: bool = False,
    ) -> Gaps:
        """See Engine.gaps."""
        pair = self._pairs[mesh.name]
        value = np.empty(wanted.shape)
        vectors = np.empty((*wanted.shape, 3, 3))
        at_end = np.empty(wanted.shape, dtype=bool)
        pair.gaps(
            *pair.numbers,
            np.array([*self._seats(mesh), flank, section], dtype=np.int64),
            *_arrays(build, pair),
            *(_array(values) for values in (*angles, driver_teeth, wanted)),
            value,
            vectors,
            at_end,
        )
        return Gaps(
            value=np.where(np.isinf(value), np.nan, value),
            deep=np.zeros(wanted.shape, dtype=bool),
            at_end=at_end,
            driver_point=vectors[..., 0, :],
            driven_point=vectors[..., 1, :],
            normal=vectors[..., 2, :],
            driver_teeth=driver_teeth,
        )

    def read(
        self, build: Build, mesh: Mesh, reading: Reading, driver_angle: Array, turning: frozenset[str] = frozenset()
    ) -> MeshReading:
        """See ReadingEngine.read."""
        pair = self._pairs[mesh.name]
        rows = len(driver_angle)
        readings, tooth = np.empty((rows, READINGS)), np.empty(rows, dtype=np.int64)
        status = np.empty(rows, dtype=np.int8)
        how = (WHICH_TEETH[reading.teeth], reading.contact == "section", reading.gap == "section")
        turns = (mesh.driven in turning, mesh.driver in turning)
        pair.read(
            *pair.numbers,
            np.array([*self._seats(mesh), mesh.resting_flank(reading.flank), *how, *turns], dtype=np.int64),
            *_arrays(build, pair),
            _array(driver_angle),
            readings,
            tooth,
            status,
        )
        self._refuse_far(build, mesh, readings, status)
        return MeshReading(
            driver_angle=driver_angle,
            driven_angle=readings[:, DRIVEN_ANGLE],
            gap=readings[:, GAP],
            driven_turn=readings[:, DRIVEN_TURN],
            driver_turn=readings[:, DRIVER_TURN],
            contact=readings[:, CONTACT:],
            tooth=tooth,
            status=status,
        )

    def rests(self, build: Build, mesh: Mesh, reading: Reading, driver_angle: Array) -> tuple[MeshReading, MeshReading]:
        """See ReadingEngine.rests."""
        pair, shape = self._pairs[mesh.name], (build.trials, len(driver_angle))
        rests, status = np.empty((*shape, 2)), np.empty(shape, dtype=np.int8)
        contact, tooth = np.empty((build.trials, 2, 3)), np.empty((build.trials, 2), dtype=np.int64)
        how = (mesh.working_flank, WHICH_TEETH[reading.teeth], reading.contact == "section")
        pair.rests(
            *pair.numbers,
            np.array([*self._seats(mesh), *how], dtype=np.int64),
            *_arrays(build, pair),
            _array(driver_angle),
            rests,
            contact,
            tooth,
            status,
        )
        self._refuse_far(build, mesh, rests, status)
        unread = np.broadcast_to(np.nan, shape)
        drive, back = (
            MeshReading(
                driver_angle=driver_angle,
                driven_angle=rests[..., side],
                gap=unread,
                driven_turn=unread,
                driver_turn=unread,
                contact=contact[:, side],
                tooth=tooth[:, side],
                status=status,
            )
            for side in range(2)
        )
        return drive, back

    def _refuse_far(self, build: Build, mesh: Mesh, readings: Array, status: NDArray[np.int8]) -> None:
        """Mark rows in which a flank stands out enough for teeth beyond the candidates to touch first."""
        places = self._displacements.flanks
        if build.flanks is None or not places.acts_in(mesh.driver, mesh.driven):
            return
        reach = places.reach(build.flanks, self._model, mesh.driver, mesh.driven)
        out = reach > self._pairs[mesh.name].standing_out
        if out.any():
            far = out[build.flanks.row]
            readings[far], status[far] = np.nan, OUT_OF_RANGE

    def _seats(self, mesh: Mesh) -> tuple[int, int]:
        return self._model.seat_index[mesh.name, mesh.driver], self._model.seat_index[mesh.name, mesh.driven]


def _arrays(build: Build, pair: PairKernels) -> tuple[NDArray[Any], ...]:
    each = (build.world_from_shaft, build.centre, build.flank_turn, build.flank_offset, build.scale)
    flanks: tuple[NDArray[Any], ...] = NO_FLANKS
    if pair.flanks is not None and build.flanks is not None:
        flanks = (build.flanks.values, build.flanks.row, pair.flanks)
    return tuple(_array(values) for values in (*each, *flanks))


def _array(values: NDArray[Any]) -> NDArray[Any]:
    """As kernels take arrays: contiguous, writable."""
    return np.require(values, requirements=["C", "W"])


# pairs as kernels know them: one function a kind ------------------------------------------------------


DEVIATED: Mapping[type, tuple[Any, Kernel, Kernel, Kernel]] = {
    SpurTooth: (DeviatedTooth, deviated_read, deviated_gaps, deviated_rests),
    HelicalTooth: (DeviatedHelicalTooth, deviated_helical_read, deviated_helical_gaps, deviated_helical_rests),
    InternalHelicalTooth: (
        DeviatedInternalHelicalTooth,
        deviated_internal_helical_read,
        deviated_internal_helical_gaps,
        deviated_internal_helical_rests,
    ),
}
"""Teeth whose single flanks deviate, and their kernels, by those that are alike."""


def kernels_in(model: Model, mesh: Mesh, flanks: FlankPlaces) -> PairKernels:
    """Numbers and kernels of the pair of a mesh; where single flanks deviate, of their own variant."""
    alike = kernels_of(mesh.pair)
    if not flanks.acts_in(mesh.driver, mesh.driven):
        return alike
    pinion, wheel, numbers, nominal = alike.numbers
    gears: tuple[tuple[str, SpurTooth | HelicalTooth | InternalHelicalTooth], ...]
    gears = ((mesh.driver, pinion), (mesh.driven, wheel))
    kind, read, gaps, rests = DEVIATED[type(pinion)]
    places: list[int] = []
    teeth: list[Any] = []
    for name, own in gears:
        gear, seat = mesh.gear(name), model.seats[model.seat_index[mesh.name, name]]
        places += [flanks.starts.get(name, -1), gear.teeth, round(seat.ahead / gear.angular_pitch)]
        begin, end = own.begin, own.end
        if name in flanks.spans:
            sense = own.sense if isinstance(own, InternalHelicalTooth) else 1.0
            begin, end = (sense * roll for roll in flanks.spans[name])
        shape = ((begin + end) / 2, 1.0 / (end - begin), 1.0 / gear.face_width, flanks.waves.get(name, 0.0))
        each: tuple[float, ...] = (*own, 1.0, *shape, 0.0, 0.0, 0.0, 0.0)
        teeth.append(kind(*each))
    margin = margin_of(model, mesh)
    beyond = margin * mesh.pair.pinion.angular_pitch
    numbers = numbers._replace(lowest=numbers.lowest - beyond, highest=numbers.highest + beyond)
    return PairKernels(
        (teeth[0], teeth[1], numbers, nominal),
        read,
        gaps,
        rests,
        np.array(places, dtype=np.int64),
        standing_out(mesh.pair, margin),
    )
