"""Rows of builds whose flanks deviate tooth by tooth: as in rows.py, each with the offsets of its build."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines.exact.deviated import FlankOffsets
from tol3d.gearing.engines.exact.numbers import PairNumbers, Pose
from tol3d.gearing.engines.exact.rows import build_of, gap_row, looks_of, read_row
from tol3d.numerics.arrays import Array

Integers = NDArray[np.int64]


def read_deviated_rows(
    pinion: Any,
    wheel: Any,
    pair: PairNumbers,
    nominal: Pose,
    which: Integers,
    shafts: Array,
    centre: Array,
    flank_turn: Array,
    flank_offset: Array,
    scale: Array,
    offsets: Array,
    builds: Integers,
    places: Integers,
    driver_angles: Array,
    readings: Array,
    teeth: Integers,
    status: NDArray[np.int8],
) -> None:
    """Seat every row and read it.

    Args:
        pinion ... scale: as in rows.read_rows.
        offsets, builds: of FlankDeviations, its values and rows.
        places: of driver and driven, see deviated.FlankOffsets.
        driver_angles ... status: as in rows.read_rows.
    """
    gears, looks = (which[0], which[1]), looks_of(pair, which)
    for row in range(len(driver_angles)):
        own = FlankOffsets(offsets[builds[row]], places)
        build = build_of(pinion, wheel, pair, nominal, gears, shafts, centre, flank_turn, flank_offset, scale, row, own)
        read_row(build, which, looks, shafts, flank_offset, scale, row, driver_angles[row], readings, teeth, status)


def gap_deviated_rows(
    pinion: Any,
    wheel: Any,
    pair: PairNumbers,
    nominal: Pose,
    which: Integers,
    shafts: Array,
    centre: Array,
    flank_turn: Array,
    flank_offset: Array,
    scale: Array,
    offsets: Array,
    builds: Integers,
    places: Integers,
    driver_angles: Array,
    driven_angles: Array,
    driver_teeth: Integers,
    wanted: NDArray[np.bool_],
    value: Array,
    vectors: Array,
    at_end: NDArray[np.bool_],
) -> None:
    """Gaps of the tooth pairs that are asked for; arguments as in rows.gap_rows and above."""
    gears = (which[0], which[1])
    for row in range(len(driver_angles)):
        own = FlankOffsets(offsets[builds[row]], places)
        build = build_of(pinion, wheel, pair, nominal, gears, shafts, centre, flank_turn, flank_offset, scale, row, own)
        angles = (driver_angles[row], driven_angles[row])
        gap_row(build, which, shafts, flank_offset, row, angles, driver_teeth, wanted, value, vectors, at_end)
