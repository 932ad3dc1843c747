"""Both rests of a mesh at many positions: one contact per side and position, each build made once for all.

A position begins at the previous rest, so that the gears hardly have to turn. Of some kinds of teeth all positions but
the first are known from the line of action, see tooth_contact.turn_by_line; all others are evaluated as usual.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines.exact.flank_contact import Look, MeshBuild, closed, seen, standing
from tol3d.gearing.engines.exact.foot import flanks_in, opening, quick_turn
from tol3d.gearing.engines.exact.numbers import PairNumbers, Pose
from tol3d.gearing.engines.exact.reach import within_reach
from tol3d.gearing.engines.exact.rows import FREE, build_of, fault_of, write_contact
from tol3d.gearing.engines.status import INTERFERES, OK, OUT_OF_RANGE
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import part

Integers = NDArray[np.int64]


@part
def rest_row(
    build: MeshBuild,
    which: Integers,
    shafts: Array,
    flank_offset: Array,
    scale: Array,
    row: int,
    driver_angles: Array,
    rests: Array,
    contact: Array,
    teeth: Integers,
    status: NDArray[np.int8],
) -> None:
    """Seat a build at every position on both sides; arguments as in `rest_rows`, and the row's build."""
    gears, pair, sigma = (which[0], which[1]), build.pair, float(which[2])
    rests[row] = np.nan
    contact[row] = np.nan
    teeth[row] = 0
    status[row] = OUT_OF_RANGE
    if not within_reach(build, scale[row, gears[0]], scale[row, gears[1]]):
        return
    opened = sigma * (build.driver_turn / pair.ratio + build.driven_turn)
    ahead, behind = opened, -opened
    for k in range(len(driver_angles)):
        angle = driver_angles[k]
        middle, arm, fault = pair.driven_start - angle / pair.ratio, build.driven.base, OK
        for side in range(2):
            look = Look(sigma if side == 0 else -sigma, which[3], which[4] != 0, 1.0)
            start = standing(build, angle, middle + (ahead if side == 0 else behind))
            known, turn = quick_turn(build.driver, build, start, look) if k > 0 else (False, 0.0)
            driven = start.driven - look.sigma * turn
            if not known:
                at, touching = closed(seen(build, start, angle, look), build, start, look)
                own = fault_of(touching)
                fault = max(fault, own)
                if own != OK:
                    continue
                driven = at.driven
                arm = abs(touching.ny * touching.x - touching.nx * touching.y)
                if k == 0:
                    write_contact(contact[row, side], touching, shafts[row, gears[1]], flank_offset[row, gears[0]])
                    teeth[row, side] = touching.tooth
            rests[row, k, side] = driven
            if side == 0:
                ahead = driven - middle
            else:
                behind = driven - middle
        if fault == OK and sigma * opening(build.driven) * (behind - ahead) * arm < -FREE:
            fault = INTERFERES
        status[row, k] = fault


def rest_rows(
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
    rests: Array,
    contact: Array,
    teeth: Integers,
    status: NDArray[np.int8],
) -> None:
    """Seat every build at every position on both sides.

    Args:
        pinion, wheel, pair, nominal, shafts ... places: as in `read_rows`.
        which: driver and driven in the arrays of the build; working flank; teeth; whether the contact is that of the
            section.
        driver_angles: (positions,) [rad].
        rests: (trials, positions, 2), written: the driven gear's angle [rad] on the drive and on the back side.
        contact: (trials, 2, 3), written: the first position's contacts on the driver, world [mm].
        teeth: (trials, 2), written: the driver's teeth that touch there.
        status: (trials, positions), written.
    """
    gears = (which[0], which[1])
    for row in range(len(shafts)):
        own = flanks_in(pinion, offsets, builds, places, row)
        build = build_of(pinion, wheel, pair, nominal, gears, shafts, centre, flank_turn, flank_offset, scale, row, own)
        rest_row(build, which, shafts, flank_offset, scale, row, driver_angles, rests, contact, teeth, status)
