"""The kernels: one of each sort for every kind of pair, compiled for the arrays of a Build and no others."""

import math
from dataclasses import dataclass
from functools import singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines.exact.bevel import BevelTooth
from tol3d.gearing.engines.exact.deviated import DeviatedTooth
from tol3d.gearing.engines.exact.deviated_helical import DeviatedHelicalTooth
from tol3d.gearing.engines.exact.deviated_ring import DeviatedInternalHelicalTooth
from tol3d.gearing.engines.exact.foot import quick_turn
from tol3d.gearing.engines.exact.helical import HelicalTooth, InternalHelicalTooth
from tol3d.gearing.engines.exact.internal import InternalTooth
from tol3d.gearing.engines.exact.numbers import PairNumbers, Pose
from tol3d.gearing.engines.exact.rests import rest_rows
from tol3d.gearing.engines.exact.rows import gap_rows, read_rows
from tol3d.gearing.engines.exact.spur import SpurTooth
from tol3d.gearing.engines.exact.tooth_contact import turn_by_line
from tol3d.gears import BevelGear, BevelPair, GearPair, InternalGear, InternalPair, SpurGear, SpurPair
from tol3d.gears.pair import CONTACT_MARGIN
from tol3d.numerics.compiled import Kernel, variant

variant(quick_turn, DeviatedTooth)(turn_by_line)

BUILD = "float64[:, :, :, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1]"
RESTING = "float64[::1], float64[:, :, ::1], float64[:, :, ::1], int64[:, ::1], int8[:, ::1]"
READING = "float64[::1], float64[:, ::1], int64[::1], int8[::1]"
GAP = (
    "float64[::1], float64[::1], int64[:, ::1], boolean[:, ::1], "
    "float64[:, ::1], float64[:, :, :, ::1], boolean[:, ::1]"
)
FLANKS = "float64[:, ::1], int64[::1], int64[::1]"
NO_FLANKS = (np.zeros((0, 0)), np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))
READ, GAPS, REST = (f"int64[::1], {BUILD}, {FLANKS}, {own}" for own in (READING, GAP, RESTING))

SPUR = (SpurTooth, SpurTooth, PairNumbers, Pose)
DEVIATED = (DeviatedTooth, DeviatedTooth, PairNumbers, Pose)
DEVIATED_HELICAL = (DeviatedHelicalTooth, DeviatedHelicalTooth, PairNumbers, Pose)
HELICAL = (HelicalTooth, HelicalTooth, PairNumbers, Pose)
INTERNAL = (InternalTooth, InternalTooth, PairNumbers, Pose)
INTERNAL_HELICAL = (InternalHelicalTooth, InternalHelicalTooth, PairNumbers, Pose)
DEVIATED_INTERNAL_HELICAL = (DeviatedInternalHelicalTooth, DeviatedInternalHelicalTooth, PairNumbers, Pose)
BEVEL = (BevelTooth, BevelTooth, PairNumbers, Pose)

spur_read, spur_gaps = Kernel(read_rows, SPUR, READ), Kernel(gap_rows, SPUR, GAPS)
bevel_read, bevel_gaps = Kernel(read_rows, BEVEL, READ), Kernel(gap_rows, BEVEL, GAPS)
spur_rests, bevel_rests = Kernel(rest_rows, SPUR, REST), Kernel(rest_rows, BEVEL, REST)
helical_read, helical_gaps = Kernel(read_rows, HELICAL, READ), Kernel(gap_rows, HELICAL, GAPS)
helical_rests = Kernel(rest_rows, HELICAL, REST)
internal_read, internal_gaps = Kernel(read_rows, INTERNAL, READ), Kernel(gap_rows, INTERNAL, GAPS)
internal_rests = Kernel(rest_rows, INTERNAL, REST)
internal_helical_read = Kernel(read_rows, INTERNAL_HELICAL, READ)
internal_helical_gaps = Kernel(gap_rows, INTERNAL_HELICAL, GAPS)
internal_helical_rests = Kernel(rest_rows, INTERNAL_HELICAL, REST)
deviated_read, deviated_gaps = Kernel(read_rows, DEVIATED, READ), Kernel(gap_rows, DEVIATED, GAPS)
deviated_rests = Kernel(rest_rows, DEVIATED, REST)
deviated_helical_read = Kernel(read_rows, DEVIATED_HELICAL, READ)
deviated_helical_gaps = Kernel(gap_rows, DEVIATED_HELICAL, GAPS)
deviated_helical_rests = Kernel(rest_rows, DEVIATED_HELICAL, REST)
deviated_internal_helical_read = Kernel(read_rows, DEVIATED_INTERNAL_HELICAL, READ)
deviated_internal_helical_gaps = Kernel(gap_rows, DEVIATED_INTERNAL_HELICAL, GAPS)
deviated_internal_helical_rests = Kernel(rest_rows, DEVIATED_INTERNAL_HELICAL, REST)


@dataclass(frozen=True, eq=False)
class PairKernels:
    """A pair as kernels know it, and its kernels.

    Args:
        numbers: pinion's teeth, wheel's, which of them may meet, where the wheel's shaft sees the pinion's.
        read, gaps, rests: see kernels.
        flanks: where offsets of single flanks lie, of a pair that has any.
        standing_out: largest excess of one of them over its neighbours [mm].
    """

    numbers: tuple[Any, Any, PairNumbers, Pose]
    read: Kernel
    gaps: Kernel
    rests: Kernel
    flanks: NDArray[np.int64] | None = None
    standing_out: float = math.inf


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
    if pair.pinion.helix_angle:
        helical = (_helical(pair.pinion), _helical(pair.wheel), numbers, _nominal(pair))
        return PairKernels(helical, helical_read, helical_gaps, helical_rests)
    return PairKernels(
        (_spur(pair.pinion), _spur(pair.wheel), numbers, _nominal(pair)), spur_read, spur_gaps, spur_rests
    )


def _helical(gear: SpurGear) -> HelicalTooth:
    profile = (gear.base_half_angle, gear.form_roll, gear.tip_roll)
    return HelicalTooth(*_screw(gear), *profile, -gear.face_width / 2, gear.face_width / 2)


def _screw(gear: SpurGear | InternalGear) -> tuple[float, float, float, float, float]:
    """Base radius, one over the arm of a turn, cosine of the base helix angle, its sine by the hand, and twist."""
    sine = gear.hand * math.sin(gear.base_helix_angle)
    return gear.base_radius, 1.0 / gear.section_arm, gear.base_helix_cosine, sine, gear.twist


def _helical_in_ring(gear: SpurGear | InternalGear) -> InternalHelicalTooth:
    _, _, *own = _in_ring(gear)
    return InternalHelicalTooth(*_screw(gear), *own)


def _spur(gear: SpurGear) -> SpurTooth:
    half = gear.face_width / 2
    profile = (gear.base_half_angle, gear.form_roll, gear.tip_roll)
    return SpurTooth(gear.base_radius, 1.0 / gear.base_radius, *profile, -half, half)


@kernels_of.register
def _(pair: InternalPair) -> PairKernels:
    """Kernels of an internal pair; a ring's flank counts its roll backwards, see InternalTooth."""
    alpha = pair.working_pressure_angle
    tangent = pair.centre_distance * math.sin(alpha)
    driver, driven = _in_ring(pair.pinion), _in_ring(pair.wheel)
    numbers = _pair_numbers(
        pair,
        at_pitch=driver.sense * (alpha + driver.half),
        per_azimuth=1.0,
        lever=max(pair.pinion.face_width, pair.wheel.face_width) / 2,
        along=0.0,
        in_all=0.0,
        by_x=-math.cos(alpha) / tangent,
        by_y=-driver.sense * math.sin(alpha) / tangent,
        by_z=0.0,
        by_tilt_x=0.0,
        by_tilt_y=0.0,
    )._replace(ratio=-pair.wheel.teeth / pair.pinion.teeth)
    if pair.pinion.helix_angle:
        helical = (_helical_in_ring(pair.pinion), _helical_in_ring(pair.wheel), numbers, _nominal(pair))
        return PairKernels(helical, internal_helical_read, internal_helical_gaps, internal_helical_rests)
    return PairKernels((driver, driven, numbers, _nominal(pair)), internal_read, internal_gaps, internal_rests)


def _in_ring(gear: SpurGear | InternalGear) -> InternalTooth:
    half, per_base = gear.face_width / 2, 1.0 / gear.base_radius
    if isinstance(gear, InternalGear):
        profile = (-gear.base_half_angle, -gear.form_roll, -gear.tip_roll)
        return InternalTooth(gear.base_radius, per_base, *profile, -half, half, -1.0)
    profile = (gear.base_half_angle, gear.form_roll, gear.tip_roll)
    return InternalTooth(gear.base_radius, per_base, *profile, -half, half, 1.0)


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
    """Numbers common to all pairs, with those of the kind."""
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
