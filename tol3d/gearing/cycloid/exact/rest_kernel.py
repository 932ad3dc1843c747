"""A cycloid stage at rest under a torque on its carrier: discs and cranks as bodies on one-sided contacts, compiled.

Unknowns are the carrier's turn, the place and turn of each disc, and those of each crank. Contacts are pins against
lobes; throws in the holes of discs and cranks in those of the carrier, each with half its clearance; and both flanks of
each planet against the sun's, between which its crank may turn. The torque turns the carrier as far as all contacts let
it: a linear programme with the gaps and slopes of the pose reached, solved again from its solution until nothing moves.
A round clearance begins as half-planes across two directions; each solution that leaves the circle adds the tangent
there, so that the circle is met to 1e-10 mm. Tangents at overlapping pins are kept, too, because a pin in a hollow
flank rests on its curvature: with the last tangent alone bodies may alternate for ever. From the third programme on the
loaded contacts are met by Newton's method, see rest_balance.py; while these are not yet the right ones the programmes
go on. The multiplier of a gap is the force on it per torque.

Successive builds that differ in pins and lobes alone, such as those that move one pin after another, have the same rest
as long as the loaded pins are the same and no other overlaps there: such a rest is not solved again.
"""

from typing import Any, Final

import numpy as np

from tol3d.gearing.cycloid.exact.pin_contact import ContactShape
from tol3d.gearing.cycloid.exact.rest_balance import CARRIES, PIN, balanced
from tol3d.gearing.cycloid.exact.rest_rows import (
    ARM,
    ROOM,
    TURNS,
    based,
    bearing_at,
    mesh_written,
    pins_written,
    working_pins,
)
from tol3d.numerics.arrays import Array, Places
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy, fill
from tol3d.numerics.programme import NO_ROOM, OK, STALLED, new_rooms, solve_lp

NOT_HELD: Final = 3
"""A body reaches the end of its room: nothing stops it."""
MET: Final = 1e-10  # mm
NEARLY_MET: Final = 1e-8  # mm; in the last steps, in which unloaded bodies may alternate while the carrier stands
STILL: Final = 5e-11  # mm at the arm, of the carrier's turn
MOST_STEPS: Final = 150
SETTLES: Final = 2  # steps before Newton's method on the loaded contacts is tried
LAST: Final = 100  # steps before the last ones, in which NEARLY_MET is enough
WILD: Final = 8  # steps in which bodies may go anywhere in their room
NEAR: Final = 100.0  # longest later step over the deepest overlap or last turn, so that unloaded bodies settle
CUTS: Final = 40  # most tangents of a bearing
BENDS: Final = 60  # most tangents at pins


@nested
def boxed(count: int, basis: Any, loads: Any) -> bool:
    """True if an end of a body's room carries some of the torque."""
    carried = 0.0
    for k in range(count):
        if basis[k] < count:
            carried = max(carried, abs(loads[k]))
    return carried > CARRIES


@nested
def begin(count: int, basis: Any, sides: Any) -> None:
    """Write the first basis: the rows of the bodies' room."""
    for k in range(count):
        basis[k], sides[k] = k, 1.0


@nested
def room_written(count: int, discs: int, near: float, z: Any, lower: Any, upper: Any) -> None:
    """Write the limits of the bodies' next step: to the end of their room, and at most `near` [mm]."""
    for k in range(count):  # turns of cranks have more room
        most = TURNS * ROOM if k > 3 * discs and (k - 3 * discs) % 3 == 0 else ROOM
        lower[k], upper[k] = max(-most - z[k], -near), min(most - z[k], near)


@nested
def bend_kept(pin: int, gap: float, row: Any, z: Any, bend: Any) -> None:
    """Keep the tangent of a pin's gap: slopes, gap at z = 0, and the row of the pin."""
    count = z.shape[0]
    bend[count], bend[count + 1] = gap, float(pin)
    for j in range(count):
        bend[j] = row[j]
        bend[count] -= row[j] * z[j]


@nested
def bend_written(bend: Any, z: Any, row: int, rows: Any, lower: Any, upper: Any) -> None:
    """Write the row of a kept tangent.

    At a hollow flank the gap is less than by any tangent, so that all hold, as those of a round bearing do. A tangent
    below the gap is not of a hollow flank, and is dropped.
    """
    count = z.shape[0]
    pin, value = int(bend[count + 1]), bend[count]
    for j in range(count):
        value += bend[j] * z[j]
    if value < -lower[pin] - MET:
        for j in range(count):
            bend[j] = 0.0
        bend[count] = value = ROOM
    for j in range(count):
        rows[row, j] = bend[j]
    lower[row], upper[row] = -value, ROOM * ARM


@nested
def bends_written(
    step: int, pinned: int, first: int, cuts: int, z: Any, planes: Any, bends: Any, rows: Any, lower: Any, upper: Any
) -> int:  # fmt: skip
    """Write the rows of kept tangents at pins, and keep those at overlapping pins; returns the number of planes."""
    for k in range(cuts):
        if planes[k, 0] == PIN:
            bend_written(bends[k], z, first + k, rows, lower, upper)
    for r in range(pinned, first):
        if step >= WILD and lower[r] > MET and cuts < planes.shape[0]:
            bend_kept(r, -lower[r], rows[r], z, bends[cuts])
            bend_written(bends[cuts], z, first + cuts, rows, lower, upper)
            planes[cuts, 0] = PIN
            cuts += 1
    return cuts


@nested
def begin_planes(bearings: int, planes: Any) -> int:
    """Write the first planes, across two directions of each bearing; returns their number."""
    cuts = 0
    for b in range(bearings):
        for axis in range(2):
            planes[cuts, 0], planes[cuts, 1], planes[cuts, 2] = float(b), 1.0 - axis, float(axis)
            cuts += 1
    return cuts


@nested
def rested(
    shape: Any, stage: Any, throws: Any, made: Any, base: Any, pins: Any, clearances: Any, working: Any, sense: float,
    rooms: Any,
) -> tuple[int, float]:  # fmt: skip
    """Status of a stage whose carrier is turned in a sense, and the carrier's turn [rad]."""
    rows, lower, upper, basis, solving, x, z, planes, across, bends, _, _ = rooms
    discs, cranks, _, _, _ = stage
    radial, meshes = clearances
    count, bearings = z.shape[0], cranks * (discs + 1)
    pinned = count + 2 * cranks
    first = pinned + working.shape[0]
    cuts = begin_planes(bearings, planes)
    for k in range(bends.shape[0]):
        bends[k, count + 1] = 0.0
    fill(z, 0.0)
    fill(x, 0.0)
    begin(count, basis, solving[2])
    fill(across[2], 0.0)
    across[2, 0] = sense
    more, near = NEAR, 2.0 * ROOM
    for step in range(MOST_STEPS):
        deepest = pins_written(shape, stage, throws, pins, base, z, working, rows, lower, pinned)
        cuts = bends_written(step, pinned, first, cuts, z, planes, bends, rows, lower, upper)
        for b in range(bearings):
            x_b, y_b = bearing_at(stage, made, base, z, b, across[:2])
            far = np.sqrt(x_b * x_b + y_b * y_b)
            deepest = max(deepest, far - radial[b])
            if far - radial[b] > MET and radial[b] > 0.0 and step > 0 and cuts < planes.shape[0]:
                planes[cuts, 0], planes[cuts, 1], planes[cuts, 2] = float(b), x_b / far, y_b / far
                cuts += 1
            for k in range(cuts):
                if planes[k, 0] == float(b):
                    for j in range(count):
                        rows[first + k, j] = planes[k, 1] * across[0, j] + planes[k, 2] * across[1, j]
                    reach = planes[k, 1] * x_b + planes[k, 2] * y_b
                    lower[first + k], upper[first + k] = -radial[b] - reach, radial[b] - reach
            if b >= cranks * discs:
                crank = b - cranks * discs
                mesh = count + 2 * crank
                limits = lower[mesh : mesh + 2], upper[mesh : mesh + 2]
                mesh_written(stage, meshes, z, crank, (x_b, y_b), across, rows[mesh : mesh + 2], limits)
        held = step < 1 or not boxed(count, basis, solving[3][0])
        met = deepest < (MET if step < LAST else NEARLY_MET)
        if step > 0 and met and abs(x[0]) < STILL and (held or near >= ROOM):
            return OK if held else NOT_HELD, z[0] / ARM
        more = max(NEAR, more / 4.0) if held else 4.0 * more
        near = 2.0 * ROOM if step < WILD else min(more * (max(deepest, abs(x[0])) + MET), 2.0 * ROOM)
        room_written(count, discs, near, z, lower, upper)
        used = first + cuts
        solved, _, _ = solve_lp(rows[:used], lower[:used], upper[:used], across[2], basis, solving, x)
        if solved == NO_ROOM and near >= ROOM:
            return NO_ROOM, np.nan
        if solved != OK:  # too little room, or tangents that nearly coincide
            more = 10.0 * more if solved == NO_ROOM else 0.1 * more
            begin(count, basis, solving[2])
            continue
        for k in range(count):
            z[k] += x[k]
        if step >= SETTLES and balanced(shape, stage, throws, made, base, pins, clearances, working, rooms):
            return OK, z[0] / ARM
    return STALLED, np.nan


@nested
def note(pinned: int, working: Any, basis: Any, multipliers: Any, bends: Any, loads: Any) -> None:
    """Add the force on each pin per torque [1/mm]."""
    count, first = basis.shape[0], pinned + working.shape[0]
    for k in range(count):
        row = basis[k]
        if row >= first:
            row = int(bends[row - first, count + 1])  # 0 of a bearing
        if abs(multipliers[k]) > CARRIES and row >= pinned:
            loads[working[row - pinned]] += abs(multipliers[k]) / ARM


@nested
def rests_alike(pinned: int, working: Any, loads: Any, rows: Any, lower: Any, known: Any) -> bool:
    """True if the loaded pins have the known gaps and slopes, and no other overlaps."""
    slopes, gaps = known
    for k in range(working.shape[0]):
        row = pinned + k
        if lower[row] > MET:
            return False
        if loads[working[k]] > 0.0:
            if lower[row] != gaps[k]:
                return False
            for j in range(slopes.shape[1]):
                if rows[row, j] != slopes[k, j]:
                    return False
    return True


@kernel(
    ContactShape,
    arrays="f8[::1], f8[:,:,::1], f8[:,:,::1], f8[:,:,:,::1], f8[:,:,:,::1], f8[:,:,::1], f8[:,::1], f8[:,:,::1], "
    "f8[:,:,::1], f8[:,:,::1], f8[:,::1], f8[:,:,:,::1], f8[::1], f8[:,::1], b1[:,::1], f8, f8[:,::1], f8[:,:,::1], "
    "i8[:,::1], i1[:,::1], f8[:,::1], f8[::1], f8[::1], i8[::1], f8[::1], f8[::1], f8[:,::1], f8[:,::1], f8[:,::1], "
    "i8[::1], f8[:,::1], f8[:,::1], f8[:,::1], i8[::1], f8[:,::1], f8[::1]",
)
def rests(
    shape: Any, throws: Any, linkage: Any, holes: Any, thrown: Any, bored: Any, places: Any, radii: Any,
    lobe_pitch: Any, lobe_profile: Any, leans: Any, radial: Any, free: Any, leaving: Any, phis: Any, like: Any,
    sense: float, turns: Any, loads: Any, near: Any, status: Any,
    rows: Any, lower: Any, upper: Any, basis: Any, x: Any, z: Any, planes: Any, across: Any, bends: Any, working: Any,
    poses: Any, axes: Any, system: Any, roles: Any, slopes: Any, gaps: Any,
) -> None:  # fmt: skip
    """Solve the rests of trials at crank angles.

    Args:
        shape, throws, linkage, places, radii, lobe_pitch, lobe_profile, leans, phis: see contact_kernel.first_contacts;
            of a leaning disc the nearer face is read.
        holes: of the carrier, in its frame (trials, cranks, 2) [mm].
        thrown: throws, in the crank's frame (trials, cranks, discs, 2) [mm].
        bored: holes of discs, in the profile's frame (trials, discs, cranks, 2) [mm].
        radial: half the clearance of each bearing (trials, bearings) [mm], in the order of bearing_at.
        free: least and most turn of each crank by its planet (trials, positions, cranks, 2) [rad].
        leaving: change of that turn for a planet that lies off by 1 mm across the line of centres, and along it (2,)
            [rad/mm].
        like: True if a trial differs from the one before it in pins and lobes alone (trials, positions).
        sense: of the carrier's turn, +1 or -1.
        turns: the carrier's beyond -phi / Zc (trials, positions) [rad]; written.
        loads: on pins per torque (trials, positions, discs pins) [1/mm]; written.
        near: number of working pins whose gap at rest is at most the shape's deflection (trials, positions); written.
        status: OK, NOT_HELD, NO_ROOM or STALLED (trials, positions); written.
        rows: zeros, to write in, as are lower, upper, basis, x, z, planes, across, bends, working, poses, axes,
            system, roles, slopes, gaps: see `work_arrays`.
    """
    discs, cranks, count = throws.shape[0], holes.shape[1], z.shape[0]
    pinned = count + 2 * cranks
    solving = new_rooms(count)
    rooms = (rows, lower, upper, basis, solving, x, z, planes, across, bends, system, roles)
    base = (poses, axes)
    for p in range(phis.shape[1]):
        last = -1  # the trial whose rest is in z, if this one is like it
        for i in range(phis.shape[0]):
            made = (holes[i], thrown[i], bored[i])
            pins = (places[i], radii[i], lobe_pitch[i], lobe_profile[i], leans[i])
            stage = (discs, cranks, shape.rolling, phis[i, p], -phis[i, p] / shape.lobes)
            based(stage, linkage[i], made, base[0], base[1])
            number = working_pins(shape, throws, phis[i, p], sense, working)
            if not like[i, p]:
                last = -1
            if last >= 0:
                pins_written(shape, stage, throws, pins, base, z, working[:number], rows, lower, pinned)
            if last >= 0 and rests_alike(pinned, working[:number], loads[last, p], rows, lower, (slopes, gaps)):
                status[i, p], turns[i, p] = OK, turns[last, p]
                copy(loads[i, p], loads[last, p])
            else:
                for k in range(count):
                    fill(rows[k], 0.0)
                    rows[k, k] = 1.0
                for k in range(number):
                    upper[pinned + k] = ROOM * ARM
                status[i, p], turns[i, p] = rested(
                    shape, stage, throws, made, base, pins, (radial[i], (free[i, p], leaving[0], leaving[1])),
                    working[:number], sense, rooms,
                )  # fmt: skip
                fill(loads[i, p], 0.0)
                last = -1
                if status[i, p] == OK:
                    note(pinned, working[:number], basis, solving[3][0], bends, loads[i, p])
                    last = i
            near[i, p] = 0
            if status[i, p] == OK:
                for k in range(number):
                    near[i, p] += -lower[pinned + k] <= shape.deflection
            if last == i and i + 1 < phis.shape[0] and like[i + 1, p]:
                pins_written(shape, stage, throws, pins, base, z, working[:number], slopes, gaps, 0)


def work_arrays(discs: int, cranks: int, pins: int) -> tuple[Array | Places, ...]:
    """Arrays that `rests` writes in; made inside it, each would take numba as long to compile as ten lines."""
    count, bearings = 1 + 3 * (discs + cranks), cranks * (discs + 1)
    most = bearings * (2 + CUTS) + BENDS
    size = count + 2 * cranks + discs * pins + most
    return (
        *(np.zeros((size, count)), np.empty(size), np.empty(size), np.empty(count, np.int64)),
        *(np.empty(count), np.empty(count), np.empty((most, 3)), np.empty((3, count)), np.empty((most, count + 2))),
        *(np.empty(discs * pins, np.int64), np.empty((discs, 4)), np.empty((cranks, 2))),
        np.empty((2 * count + 2, max(2 * count + 1, bearings))),
        np.empty(bearings + 2 * cranks + discs * pins, np.int64),
        *(np.empty((discs * pins, count)), np.empty(discs * pins)),
    )
