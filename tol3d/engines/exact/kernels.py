"""The kernels: one of each sort for every kind of pair, compiled for the arrays of a Build and no others."""

from typing import Any

from tol3d.compiled import kernel
from tol3d.engines.exact.bevel import BevelTooth
from tol3d.engines.exact.numbers import PairNumbers, Pose
from tol3d.engines.exact.rows import gap_rows, read_rows
from tol3d.engines.exact.spur import SpurTooth

BUILD = "float64[:, :, :, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1]"
READ = f"int64[::1], {BUILD}, float64[::1], float64[:, ::1], int64[::1], int8[::1]"
GAPS = (
    f"int64[::1], {BUILD}, float64[::1], float64[::1], int64[:, ::1], boolean[:, ::1], "
    "float64[:, ::1], float64[:, :, :, ::1]"
)


@kernel(SpurTooth, SpurTooth, PairNumbers, Pose, arrays=READ)
def spur_read(
    pinion: Any,
    wheel: Any,
    pair: Any,
    nominal: Any,
    which: Any,
    shafts: Any,
    centre: Any,
    turn: Any,
    offset: Any,
    scale: Any,
    driver_angles: Any,
    readings: Any,
    teeth: Any,
    status: Any,
) -> None:
    """Seat and read rows of spur pairs; see rows.read_rows."""
    read_rows(
        pinion, wheel, pair, nominal, which, shafts, centre, turn, offset, scale, driver_angles, readings, teeth, status
    )


@kernel(SpurTooth, SpurTooth, PairNumbers, Pose, arrays=GAPS)
def spur_gaps(
    pinion: Any,
    wheel: Any,
    pair: Any,
    nominal: Any,
    which: Any,
    shafts: Any,
    centre: Any,
    turn: Any,
    offset: Any,
    scale: Any,
    driver_angles: Any,
    driven_angles: Any,
    teeth: Any,
    wanted: Any,
    value: Any,
    vectors: Any,
) -> None:
    """Gaps of tooth pairs of spur gears; see rows.gap_rows."""
    gap_rows(
        pinion,
        wheel,
        pair,
        nominal,
        which,
        shafts,
        centre,
        turn,
        offset,
        scale,
        driver_angles,
        driven_angles,
        teeth,
        wanted,
        value,
        vectors,
    )


@kernel(BevelTooth, BevelTooth, PairNumbers, Pose, arrays=READ)
def bevel_read(
    pinion: Any,
    wheel: Any,
    pair: Any,
    nominal: Any,
    which: Any,
    shafts: Any,
    centre: Any,
    turn: Any,
    offset: Any,
    scale: Any,
    driver_angles: Any,
    readings: Any,
    teeth: Any,
    status: Any,
) -> None:
    """Seat and read rows of bevel pairs; see rows.read_rows."""
    read_rows(
        pinion, wheel, pair, nominal, which, shafts, centre, turn, offset, scale, driver_angles, readings, teeth, status
    )


@kernel(BevelTooth, BevelTooth, PairNumbers, Pose, arrays=GAPS)
def bevel_gaps(
    pinion: Any,
    wheel: Any,
    pair: Any,
    nominal: Any,
    which: Any,
    shafts: Any,
    centre: Any,
    turn: Any,
    offset: Any,
    scale: Any,
    driver_angles: Any,
    driven_angles: Any,
    teeth: Any,
    wanted: Any,
    value: Any,
    vectors: Any,
) -> None:
    """Gaps of tooth pairs of bevel gears; see rows.gap_rows."""
    gap_rows(
        pinion,
        wheel,
        pair,
        nominal,
        which,
        shafts,
        centre,
        turn,
        offset,
        scale,
        driver_angles,
        driven_angles,
        teeth,
        wanted,
        value,
        vectors,
    )
