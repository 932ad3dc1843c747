"""The exact engine: contact of the mathematical flanks, in compiled kernels; no solid, no mesh, no chord error."""

import math
from dataclasses import dataclass
from functools import singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.build import Build
from tol3d.gearing.engines.exact.bevel import BevelTooth
from tol3d.gearing.engines.exact.compiled_displacements import compiled_displacements
from tol3d.gearing.engines.exact.deviated import DeviatedTooth
from tol3d.gearing.engines.exact.kernels import (
    bevel_gaps,
    bevel_read,
    bevel_rests,
    deviated_gaps,
    deviated_read,
    deviated_rests,
    spur_gaps,
    spur_read,
    spur_rests,
)
from tol3d.gearing.engines.exact.numbers import PairNumbers, Pose
from tol3d.gearing.engines.exact.rows import CONTACT, DRIVEN_ANGLE, DRIVEN_TURN, DRIVER_TURN, GAP, READINGS
from tol3d.gearing.engines.exact.seating import ALL_TEETH, DRIVEN_TOOTH, DRIVER_TOOTH
from tol3d.gearing.engines.exact.spur import SpurTooth
from tol3d.gearing.engines.gaps import Gaps, MeshReading
from tol3d.gearing.engines.status import OUT_OF_RANGE
from tol3d.gearing.flank_offsets import DEVIATED_MARGIN, FlankPlaces, standing_out
from tol3d.gearing.model import Mesh, Model, Reading, TransmissionError
from tol3d.gears import BevelGear, BevelPair, Flank, GearPair, SpurGear, SpurPair
from tol3d.gears.pair import CONTACT_MARGIN
from tol3d.numerics.compiled import Kernel

Array = NDArray[np.float64]
Teeth = NDArray[np.int64]

DEPTH = 1.0  # mm
LAST_STEP = 1e-8  # mm
WHICH_TEETH = {"all": ALL_TEETH, "driver": DRIVER_TOOTH, "driven": DRIVEN_TOOTH}


@dataclass(frozen=True, eq=False)
class PairKernels:
    """A pair as kernels know it, and its kernels.

    Args:
        numbers: pinion's teeth, wheel's, which of them may meet, where the wheel's shaft sees the pinion's.
        read, gaps, rests: see kernels.
        flanks: where offsets of single flanks lie, of a pair that has any.
    """

    numbers: tuple[Any, Any, PairNumbers, Pose]
    read: Kernel
    gaps: Kernel
    rests: Kernel
    flanks: NDArray[np.int64] | None = None


class ExactEngine:
    """Gaps and backlashes of the mathematical flanks of a model's meshes."""

    chord_error = 0.0

    def __init__(self, model: Model) -> None:
        self._model = model
        self._displacements = compiled_displacements(model)
        self._pairs = {mesh.name: kernels_in(model, mesh, self._displacements.flanks) for mesh in model.meshes}

    @property
    def kept(self) -> bool:
        """Whether this machine has compiled what its studies need."""
        rests = any(isinstance(measure.kind, TransmissionError) for measure in self._model.measures)
        return all(pair.read.kept and (pair.rests.kept or not rests) for pair in self._pairs.values())

    def depth(self, mesh: Mesh) -> float:
        """1 mm: any overlap can be measured."""
        return DEPTH

    def last_step(self, mesh: Mesh) -> float:
        """1e-8 mm: what is left of a gap after it goes with its square."""
        return LAST_STEP

    def build(self, deviations: Array) -> Build:
        """See ReadingEngine.build."""
        return self._displacements.build(deviations)

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
        """Mark rows in which a flank stands out so far that teeth beyond the candidates might touch first."""
        places = self._displacements.flanks
        if build.flanks is None or not places.acts_in(mesh.driver, mesh.driven):
            return
        out = places.reach(build.flanks, self._model, mesh.driver, mesh.driven) > standing_out(mesh.pair)
        if out.any():
            far = out[build.flanks.row]
            readings[far], status[far] = np.nan, OUT_OF_RANGE

    def _seats(self, mesh: Mesh) -> tuple[int, int]:
        return self._model.seat_index[mesh.name, mesh.driver], self._model.seat_index[mesh.name, mesh.driven]


def _arrays(build: Build, pair: PairKernels) -> tuple[NDArray[Any], ...]:
    each: tuple[NDArray[Any], ...] = (
        build.world_from_shaft,
        build.centre,
        build.flank_turn,
        build.flank_offset,
        build.scale,
    )
    if pair.flanks is not None and build.flanks is not None:
        each += (build.flanks.values, build.flanks.row, pair.flanks)
    return tuple(_array(values) for values in each)


def _array(values: NDArray[Any]) -> NDArray[Any]:
    """As kernels take arrays: contiguous, writable."""
    return np.require(values, requirements=["C", "W"])


# pairs as kernels know them: one function a kind ------------------------------------------------------


def kernels_in(model: Model, mesh: Mesh, flanks: FlankPlaces) -> PairKernels:
    """Numbers and kernels of the pair of a mesh; of spur gears whose flanks deviate one by one their own variant."""
    alike = kernels_of(mesh.pair)
    if not flanks.acts_in(mesh.driver, mesh.driven):
        return alike
    pinion, wheel, numbers, nominal = alike.numbers
    gears: tuple[tuple[str, SpurTooth], ...] = ((mesh.driver, pinion), (mesh.driven, wheel))
    places: list[int] = []
    teeth: list[DeviatedTooth] = []
    for name, own in gears:
        gear, seat = mesh.gear(name), model.seats[model.seat_index[mesh.name, name]]
        places += [flanks.starts.get(name, -1), gear.teeth, round(seat.ahead / gear.angular_pitch)]
        begin, end = flanks.spans.get(name, (own.begin, own.end))
        shape = ((begin + end) / 2, 1.0 / (end - begin), 1.0 / gear.face_width, flanks.waves.get(name, 0.0))
        each: tuple[float, ...] = (*own, 1.0, *shape, 0.0, 0.0, 0.0, 0.0)
        teeth.append(DeviatedTooth(*each))
    beyond = DEVIATED_MARGIN * mesh.pair.pinion.angular_pitch
    numbers = numbers._replace(lowest=numbers.lowest - beyond, highest=numbers.highest + beyond)
    return PairKernels(
        (teeth[0], teeth[1], numbers, nominal),
        deviated_read,
        deviated_gaps,
        deviated_rests,
        np.array(places, dtype=np.int64),
    )


@singledispatch
def kernels_of(pair: GearPair) -> PairKernels:
    """A pair's numbers and kernels."""
    raise TypeError(f"engines/exact has no kernels for {type(pair).__name__}")


@kernels_of.register
def _(pair: SpurPair) -> PairKernels:
    alpha = pair.working_pressure_angle
    tangent = pair.centre_distance * math.sin(alpha)
    numbers = _pair_numbers(
        pair,
        at_pitch=alpha + pair.pinion.base_half_angle,
        per_azimuth=1.0,
        lever=max(pair.pinion.face_width, pair.wheel.face_width) / 2,
        along=0.0,
        in_all=0.0,
        by_x=math.cos(alpha) / tangent,
        by_y=math.sin(alpha) / tangent,
        by_z=0.0,
        by_tilt_x=0.0,
        by_tilt_y=0.0,
    )
    return PairKernels(
        (_spur(pair.pinion), _spur(pair.wheel), numbers, _nominal(pair)), spur_read, spur_gaps, spur_rests
    )


def _spur(gear: SpurGear) -> SpurTooth:
    half = gear.face_width / 2
    profile = (gear.base_half_angle, gear.form_roll, gear.tip_roll)
    return SpurTooth(gear.base_radius, 1.0 / gear.base_radius, *profile, -half, half)


@kernels_of.register
def _(pair: BevelPair) -> PairKernels:
    pinion, wheel = pair.pinion, pair.wheel
    sine, cosine = math.sin(wheel.base_angle), math.cos(wheel.base_angle)
    in_all = pinion.pitch_q + wheel.pitch_q
    # where the plane of action touches the wheel's base cone, seen from the pitch line
    azimuth = math.atan2(math.sin(wheel.pitch_q), sine * math.cos(wheel.pitch_q))
    whole = math.sin(in_all) / math.tan(pinion.base_angle)
    radius = pair.mean_cone_distance
    numbers = _pair_numbers(
        pair,
        at_pitch=pinion.pitch_q + math.sin(pinion.base_angle) * pinion.pitch_half_angle,
        per_azimuth=math.sin(pinion.base_angle),
        lever=pinion.outer_cone_distance,
        along=1.0,
        in_all=in_all,
        by_x=-cosine * math.cos(azimuth) / (radius * whole),
        by_y=-cosine * math.sin(azimuth) / (radius * whole),
        by_z=sine / (radius * whole),
        by_tilt_x=math.sin(azimuth) / whole,
        by_tilt_y=-math.cos(azimuth) / whole,
    )
    return PairKernels((_bevel(pinion), _bevel(wheel), numbers, _nominal(pair)), bevel_read, bevel_gaps, bevel_rests)


def _bevel(gear: BevelGear) -> BevelTooth:
    sine, cosine = math.sin(gear.base_angle), math.cos(gear.base_angle)
    profile = (gear.base_half_angle, gear.form_q, gear.tip_q)
    return BevelTooth(
        sine, cosine, 1.0 / sine, 1.0 / cosine, *profile, gear.inner_cone_distance, gear.outer_cone_distance
    )


def _pair_numbers(pair: GearPair, **own: float) -> PairNumbers:
    """What all pairs say alike, with what a kind says of its own."""
    lowest, highest = pair.touching_azimuths
    return PairNumbers(
        lowest=lowest,
        highest=highest,
        driver_pitch=pair.pinion.angular_pitch,
        driven_pitch=pair.wheel.angular_pitch,
        driven_start=float(pair.driven_angle(np.zeros(1))[0]),
        ratio=pair.wheel.teeth / pair.pinion.teeth,
        section=pair.pinion_section,
        reach=CONTACT_MARGIN * pair.pinion.base_pitch * math.sin(pair.working_pressure_angle),
        **own,
    )


def _nominal(pair: GearPair) -> Pose:
    rest = pair.world_from_wheel
    return Pose(*rest.T.ravel().tolist(), *(-(rest.T @ pair.wheel_origin)).tolist())
