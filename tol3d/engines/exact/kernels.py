"""The kernels: one of each sort for every kind of pair, compiled for the arrays of a Build and no others."""

from tol3d.engines.exact.bevel import BevelTooth
from tol3d.engines.exact.compiled import kernel
from tol3d.engines.exact.rows import backlashes, gaps
from tol3d.engines.exact.spur import SpurTooth

BUILD = "float64[:, :, :, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1]"
BACKLASHES = (
    "void(float64[:, ::1], float64[::1], float64[::1], int64[::1], "
    f"{BUILD}, float64[::1], float64[:, ::1], int64[::1], int8[::1])"
)
GAPS = (
    "void(float64[:, ::1], float64[::1], int64[::1], "
    f"{BUILD}, float64[::1], float64[::1], int64[:, ::1], boolean[:, ::1], float64[:, ::1], float64[:, :, :, ::1])"
)


@kernel(BACKLASHES)
def spur_backlashes(gears, pair, nominal, which, shafts, centre, turn, offset, scale, angles, readings, teeth, status):
    """Seat and read rows of spur pairs; `gears` (2, 6) holds the teeth. See rows.backlashes."""
    pinion, wheel = (
        SpurTooth(gears[0, 0], gears[0, 1], gears[0, 2], gears[0, 3], gears[0, 4], gears[0, 5]),
        SpurTooth(gears[1, 0], gears[1, 1], gears[1, 2], gears[1, 3], gears[1, 4], gears[1, 5]),
    )
    backlashes(
        pinion, wheel, pair, nominal, which, shafts, centre, turn, offset, scale, angles, readings, teeth, status
    )


@kernel(GAPS)
def spur_gaps(
    gears, pair, which, shafts, centre, turn, offset, scale, angles, driven_angles, teeth, wanted, value, vectors
):
    """Gaps of tooth pairs of spur gears; `gears` (2, 6) holds the teeth. See rows.gaps."""
    pinion, wheel = (
        SpurTooth(gears[0, 0], gears[0, 1], gears[0, 2], gears[0, 3], gears[0, 4], gears[0, 5]),
        SpurTooth(gears[1, 0], gears[1, 1], gears[1, 2], gears[1, 3], gears[1, 4], gears[1, 5]),
    )
    gaps(
        pinion,
        wheel,
        pair,
        which,
        shafts,
        centre,
        turn,
        offset,
        scale,
        angles,
        driven_angles,
        teeth,
        wanted,
        value,
        vectors,
    )


@kernel(BACKLASHES)
def bevel_backlashes(gears, pair, nominal, which, shafts, centre, turn, offset, scale, angles, readings, teeth, status):
    """Seat and read rows of bevel pairs; `gears` (2, 7) holds the teeth. See rows.backlashes."""
    pinion, wheel = (
        BevelTooth(gears[0, 0], gears[0, 1], gears[0, 2], gears[0, 3], gears[0, 4], gears[0, 5], gears[0, 6]),
        BevelTooth(gears[1, 0], gears[1, 1], gears[1, 2], gears[1, 3], gears[1, 4], gears[1, 5], gears[1, 6]),
    )
    backlashes(
        pinion, wheel, pair, nominal, which, shafts, centre, turn, offset, scale, angles, readings, teeth, status
    )


@kernel(GAPS)
def bevel_gaps(
    gears, pair, which, shafts, centre, turn, offset, scale, angles, driven_angles, teeth, wanted, value, vectors
):
    """Gaps of tooth pairs of bevel gears; `gears` (2, 7) holds the teeth. See rows.gaps."""
    pinion, wheel = (
        BevelTooth(gears[0, 0], gears[0, 1], gears[0, 2], gears[0, 3], gears[0, 4], gears[0, 5], gears[0, 6]),
        BevelTooth(gears[1, 0], gears[1, 1], gears[1, 2], gears[1, 3], gears[1, 4], gears[1, 5], gears[1, 6]),
    )
    gaps(
        pinion,
        wheel,
        pair,
        which,
        shafts,
        centre,
        turn,
        offset,
        scale,
        angles,
        driven_angles,
        teeth,
        wanted,
        value,
        vectors,
    )
