"""The exact engine: contact of the mathematical flanks, in compiled kernels; no solid, no mesh, no chord error."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.build import Build
from tol3d.engines.exact.bevel import BevelTooth
from tol3d.engines.exact.compiled import Kernel
from tol3d.engines.exact.kernels import bevel_backlashes, bevel_gaps, spur_backlashes, spur_gaps
from tol3d.engines.exact.numbers import PairNumbers
from tol3d.engines.exact.rows import READINGS
from tol3d.engines.exact.seating import ALL_TEETH, DRIVEN_TOOTH, DRIVER_TOOTH
from tol3d.engines.exact.spur import SpurTooth
from tol3d.engines.gaps import Gaps
from tol3d.gears import BevelPair, Flank, GearPair, SpurPair
from tol3d.model import Mesh, Model

Array = NDArray[np.float64]
Teeth = NDArray[np.int64]

MARGIN = 0.15
WHICH_TEETH = {"all": ALL_TEETH, "driver": DRIVER_TOOTH, "driven": DRIVEN_TOOTH}


@dataclass(frozen=True, eq=False)
class _Kind:
    """What the kernels need of a pair, and which kernels those are."""

    gears: Array
    pair: Array
    nominal: Array
    backlashes: Kernel
    gaps: Kernel


class ExactEngine:
    """Gaps and backlashes of the mathematical flanks of a model's meshes."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._kinds = {mesh.name: _kind_of(mesh.pair) for mesh in model.meshes}

    depth = 1.0  # mm; any overlap can be told
    last_step = 1e-8  # mm; what is left of a gap after it is of its square
    chord_error = 0.0

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
        kind = self._kinds[mesh.name]
        value = np.empty(wanted.shape)
        vectors = np.empty((*wanted.shape, 3, 3))
        which = np.array([*self._gears(mesh), flank, section], dtype=np.int64)
        kind.gaps(
            kind.gears,
            kind.pair,
            which,
            *_arrays(build),
            *(np.ascontiguousarray(angle) for angle in angles),
            np.ascontiguousarray(driver_teeth),
            np.ascontiguousarray(wanted),
            value,
            vectors,
        )
        return Gaps(
            value=np.where(np.isinf(value), np.nan, value),
            deep=np.zeros(wanted.shape, dtype=bool),
            driver_point=vectors[..., 0, :],
            driven_point=vectors[..., 1, :],
            normal=vectors[..., 2, :],
            driver_teeth=driver_teeth,
        )

    def backlashes(self, build, mesh, reading, driver_angle, turns=(True, True)):
        kind = self._kinds[mesh.name]
        rows = len(driver_angle)
        readings, teeth = np.empty((rows, READINGS)), np.empty(rows, dtype=np.int64)
        status = np.empty(rows, dtype=np.int8)
        which = np.array(
            [
                *self._gears(mesh),
                mesh.working_flank,
                WHICH_TEETH[reading.teeth],
                reading.contact == "section",
                reading.gap == "section",
                *turns,
            ],
            dtype=np.int64,
        )
        kind.backlashes(
            kind.gears,
            kind.pair,
            kind.nominal,
            which,
            *_arrays(build),
            np.ascontiguousarray(driver_angle),
            readings,
            teeth,
            status,
        )
        return readings, teeth, status

    def _gears(self, mesh: Mesh) -> tuple[int, int]:
        return self._model.gear_index[mesh.driver], self._model.gear_index[mesh.driven]


def _arrays(build: Build) -> tuple[Array, ...]:
    each = (build.world_from_shaft, build.centre, build.flank_turn, build.flank_offset, build.scale)
    return tuple(np.ascontiguousarray(values) for values in each)


def _kind_of(pair: GearPair) -> _Kind:
    if isinstance(pair, SpurPair):
        gears = [
            SpurTooth(g.base_radius, g.base_half_angle, g.form_roll, g.tip_roll, -g.face_width / 2, g.face_width / 2)
            for g in (pair.pinion, pair.wheel)
        ]
        numbers = _pair_numbers(
            pair,
            at_pitch=pair.working_pressure_angle + pair.pinion.base_half_angle,
            per_azimuth=1.0,
            ends=(pair.start_roll, pair.pinion.tip_roll),
            lever=max(pair.pinion.face_width, pair.wheel.face_width) / 2,
            along=0.0,
        )
        return _Kind(np.array(gears), numbers, _nominal(pair), spur_backlashes, spur_gaps)
    if isinstance(pair, BevelPair):
        gears = [
            BevelTooth(
                math.sin(g.base_angle),
                math.cos(g.base_angle),
                g.base_half_angle,
                g.form_q,
                g.tip_q,
                g.inner_cone_distance,
                g.outer_cone_distance,
            )
            for g in (pair.pinion, pair.wheel)
        ]
        sine = math.sin(pair.pinion.base_angle)
        numbers = _pair_numbers(
            pair,
            at_pitch=pair.pinion.pitch_q + sine * pair.pinion.pitch_half_angle,
            per_azimuth=sine,
            ends=(pair.start_q, pair.pinion.tip_q),
            lever=pair.pinion.outer_cone_distance,
            along=1.0,
        )
        return _Kind(np.array(gears), numbers, _nominal(pair), bevel_backlashes, bevel_gaps)
    raise TypeError(f"engines/exact has no kernels for {type(pair).__name__}")


def _pair_numbers(pair, *, at_pitch, per_azimuth, ends, lever, along) -> Array:
    pitch = pair.pinion.angular_pitch
    start, tip = ends
    return np.array(
        PairNumbers(
            at_pitch=at_pitch,
            per_azimuth=per_azimuth,
            lowest=(at_pitch - tip) / per_azimuth - MARGIN * pitch,
            highest=(at_pitch - start) / per_azimuth + MARGIN * pitch,
            driver_pitch=pitch,
            driven_pitch=pair.wheel.angular_pitch,
            driven_start=float(pair.driven_angle(np.zeros(1))[0]),
            ratio=pair.wheel.teeth / pair.pinion.teeth,
            section=pair.pinion_section,
            reach=MARGIN * pair.pinion.base_pitch * math.sin(pair.working_pressure_angle),
            lever=lever,
            along=along,
        )
    )


def _nominal(pair: GearPair) -> Array:
    rest = pair.world_from_wheel
    return np.concatenate([rest.T.ravel(), -(rest.T @ pair.wheel_origin)])
