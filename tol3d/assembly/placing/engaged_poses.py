"""Finite poses of parts with play, trial by trial, by the lever arms of the pose itself, in a kernel.

The programme of `rooms` is one of small displacements. Its step is made as a finite motion, relations are met again,
and offsets, clearances and their changes are found anew, until nothing moves: there the conditions of the programme's
optimum are those of the finite one.
"""

from typing import Any, Final

import numpy as np

from tol3d.assembly.placing.engaged_places import BOLT_IN_HOLE, PIN_IN_HOLE, rows_here
from tol3d.assembly.placing.one_sided_gaps import restored, wrench
from tol3d.assembly.placing.pose_steps import stepped
from tol3d.assembly.placing.rests import begin
from tol3d.assembly.placing.rooms import at_step, lain, new_rooms, reached, started
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy_matrix, fill, fill_matrix

ENDS: Final = 4
"""Ends of both holes of a bolt; and its unknowns."""
STEPS: Final = 60
"""Newton steps and doublings at most, 3 to 6 in practice."""
OPEN: Final = 1e-13
"""Fraction of clearances that is no slack."""
STILL: Final = 1e-9
"""Change of all offsets per unit distance that counts as none."""


@nested
def bolt_slack(own: Any, t: float, rooms: Any) -> Any:
    """The largest slack of a bolt after a distance t, and its derivative; NaN if it is not found."""
    offsets, clearances, rows, gone, at, q = own
    _, used, y, z, found, _, inner = rooms
    fill(used, True)
    fill(q, 0.0)
    for k in range(ENDS):
        for c in range(2):
            at[k, c] = offsets[k, c] + t * gone[k, c]
    started((at, clearances, rows), q, used, y, z, ENDS, 1, 1.0)
    if not reached((at, clearances, rows), q, (y, z, rows, used), ENDS, 1, 1.0, q, found, inner):
        return np.nan, np.nan
    for r in range(ENDS):
        q[r] = found[r]
    slack, slope = np.inf, 0.0
    for k in range(ENDS):
        a, b = at_step(at, rows, q, k)
        length = np.sqrt(a * a + b * b)
        slack = min(slack, clearances[k] - length)
        if length > 0.0:
            slope -= z[k, 0] * (a * gone[k, 0] + b * gone[k, 1]) / length
    return slack, slope


@nested
def bolt_way(place: Any, bolt_of: Any, bolt: int, drawn: Any, i: int, most: float, rooms: Any) -> Any:
    """Distance a part can go along a direction until a bolt no longer fits; at most `most`.

    Args:
        place: offsets (cones, 2), clearances (cones,) and rows (cones, 2, freedoms + 4 bolts) at its pose.
        bolt_of: bolt of each cone (cones,).
        bolt: its number.
        drawn: directions, and fractions of the step (freedoms + 1, n).
        i: trial.
        most: largest distance [mm].
        rooms: see `bolt_rooms`.
    """
    own, inner = rooms
    offsets, clearances, rows, gone, _, _ = own
    parts, n, fastest, widest = drawn.shape[0] - 1, 0, 0.0, 0.0
    for k in range(bolt_of.shape[0]):
        if bolt_of[k] != bolt:
            continue
        clearances[n] = place[1][k]
        widest = max(widest, abs(clearances[n]))
        for c in range(2):
            offsets[n, c], gone[n, c] = place[0][k, c], 0.0
            for f in range(parts):
                gone[n, c] += place[2][k, c, f] * drawn[f, i]
            for r in range(ENDS):
                rows[n, c, r] = place[2][k, c, parts + ENDS * bolt + r]
            fastest = max(fastest, abs(gone[n, c]))
        n += 1
    if not fastest > STILL:
        return most
    t, ahead, slack = 0.0, 2.0 * widest / fastest, np.nan  # distances are doubled until one is too long
    for _ in range(2 * STEPS):
        slack, slope = bolt_slack(own, t, inner)
        if slack > 0.0 and ahead > 0.0:
            if t >= most:
                return most
            t, ahead = min(ahead, most), 2.0 * ahead
            continue
        ahead = 0.0
        if slack >= -OPEN * widest or not slope < 0.0:
            break
        t -= slack / slope
    return t if np.isfinite(slack) else np.nan


@nested
def bolt_rooms() -> Any:
    """Work arrays for `bolt_way`."""
    own = (
        np.empty((ENDS, 2)), np.empty(ENDS), np.empty((ENDS, 2, ENDS)), np.empty((ENDS, 2)), np.empty((ENDS, 2)),
        np.empty(ENDS),
    )  # fmt: skip
    return own, new_rooms(ENDS, ENDS)


ROUNDS: Final = 40
"""Corrections of a pose at most, 2 or 3 in practice; each leaves a turn's share of the correction."""
MET: Final = 1e-10
"""Residual [mm] predicted from the ratio of two steps, at which a trial is done."""
TURNED: Final = 1e-5
"""Step, per mm of reach, after which the motions that keep the relations are found anew."""
LOST: Final = 1e-6
"""Step [mm] left after all rounds at which the pose counts as not found."""
CENTRED: Final = 0
PUSHED: Final = 1
STRAYED: Final = 2
DONE: Final = 3
NO_WAY: Final = 1e300
"""Distance where nothing stops the part."""
NONE: Final = 1e-300
"""Step before the first."""


@nested
def moved_on(pose: Any, trial: Any, reach: float, q: Any, tangents: Any, step: Any) -> None:
    """Make a step (freedoms,) as a finite motion that keeps the constraints."""
    _, i, kept, _, _ = trial
    for r in range(6):
        step[r] = 0.0
        for f in range(tangents.shape[1]):
            step[r] += tangents[r, f] * q[f]
    stepped(pose, step, reach)
    restored(pose, kept, i, reach, step)


@nested
def way_of(x: float, y: float, a: float, b: float, square_room: float) -> Any:
    """Largest step of an offset (x, y) along (a, b) until its square is `square_room`; NO_WAY if it does not move."""
    square, slope, room = a * a + b * b, x * a + y * b, square_room - x * x - y * y
    if not square > 0.0:
        return NO_WAY
    root = np.sqrt(max(slope * slope + square * room, 0.0))
    return room / (slope + root) if slope > 0.0 else (root - slope) / square


@nested
def goal_at(pose: Any, goal: Any, i: int, reach: float, tangents: Any, nominal: bool, push: Any) -> float:
    """The direction of the freedoms in which a part goes as far as it can (freedoms,), its largest component.

    Where motions are nominal, so is the arm of a point: by that of the pose a turn that leaves the point where it is
    would count as a way on.
    """
    _, given, point, along = goal[:4]
    arm, pull, square, largest = np.empty(3), np.empty(6), 0.0, 0.0
    p = min(i, point.shape[1] - 1)
    as_given = nominal or (along[0] == 0.0 and along[1] == 0.0 and along[2] == 0.0)
    for r in range(3):
        arm[r] = pose[r, 0] * point[0, p] + pose[r, 1] * point[1, p] + pose[r, 2] * point[2, p]
    wrench(arm, along, reach, pull)
    for f in range(tangents.shape[1]):
        push[f] = given[f] if as_given else 0.0
        for r in range(6):
            push[f] += 0.0 if as_given else pull[r] * tangents[r, f]
        square += push[f] * push[f]
    for f in range(push.shape[0]):
        push[f] *= 1.0 / np.sqrt(square) if square > 0.0 else 1.0
        largest = max(largest, abs(push[f]))
    return largest


@nested
def as_nominally(pose: Any, engaged: Any, i: int, turn: Any, offsets: Any) -> None:
    """Turn the axes of offsets that turn with the part back, each about its hole's, to where they lie nominally."""
    axes, inner_moves, kinds = engaged[2], engaged[5], engaged[6]
    for k in range(kinds.shape[0]):
        if not inner_moves[k] or (kinds[k] != PIN_IN_HOLE and kinds[k] != BOLT_IN_HOLE):
            continue
        a, b = 0.0, 0.0
        for r in range(3):
            x, y, own = 0.0, 0.0, 0.0
            for s in range(3):
                x += pose[r, s] * axes[k, 0, s, i]
                y += pose[r, s] * axes[k, 1, s, i]
                own += turn[r, s] * axes[k, 0, s, i]
            a += x * own
            b += y * own
        length, o, p = np.sqrt(a * a + b * b), offsets[k, 0], offsets[k, 1]
        offsets[k, 0], offsets[k, 1] = (a * o + b * p) / length, (a * p - b * o) / length


@nested
def way_along(place: Any, drawn: Any, i: int, engaged: Any, rooms: Any) -> Any:
    """Largest step of a part along a direction (freedoms,) until an offset is as long as its clearance.

    With bolts: until one of them no longer fits.
    """
    offsets, clearances, rows = place
    kinds, bolt_of, bolts = engaged[6], engaged[7], engaged[8]
    way = NO_WAY
    for k in range(rows.shape[0]):
        if kinds[k] == BOLT_IN_HOLE:
            continue
        a, b = 0.0, 0.0
        for f in range(drawn.shape[0] - 1):
            a += rows[k, 0, f] * drawn[f, i]
            b += rows[k, 1, f] * drawn[f, i]
        way = min(way, way_of(offsets[k, 0], offsets[k, 1], a, b, clearances[k] * clearances[k]))
    for n in range(bolts.shape[0]):
        way = min(way, bolt_way(place, bolt_of, n, drawn, i, way, rooms))
    return way if way < NO_WAY else 0.0


@nested
def conjugate(place: Any, axes: Any, stiffness: Any, found: Any) -> None:
    """Directions of the freedoms (freedoms, freedoms), a row each, that a room rounded about its middle has as axes.

    Each axis less its part along those before it, by the curvature of -log(c_k^2 - |o_k + B_k q|^2), summed.

    Args:
        place: offsets (cones, 2), clearances (cones,), rows (cones, 2, freedoms or more).
        axes: of the room.
        stiffness, found: (freedoms, freedoms); changed.
    """
    offsets, clearances, rows = place
    size = axes.shape[0]
    fill_matrix(stiffness, 0.0)
    for k in range(rows.shape[0]):
        room = clearances[k] * clearances[k] - offsets[k, 0] * offsets[k, 0] - offsets[k, 1] * offsets[k, 1]
        for f in range(size):
            out = offsets[k, 0] * rows[k, 0, f] + offsets[k, 1] * rows[k, 1, f]
            for g in range(size):
                its = offsets[k, 0] * rows[k, 0, g] + offsets[k, 1] * rows[k, 1, g]
                both = rows[k, 0, f] * rows[k, 0, g] + rows[k, 1, f] * rows[k, 1, g]
                stiffness[f, g] += 2.0 * both / room + 4.0 * out * its / (room * room)
    for s in range(size):
        for f in range(size):
            found[s, f] = axes[s, f]
        for t in range(s + 1):  # the last time, to length 1
            product = 0.0
            for f in range(size):
                for g in range(size):
                    product += found[t, f] * stiffness[f, g] * found[s, g]
            for f in range(size):
                found[s, f] = found[s, f] - product * found[t, f] if t < s else found[s, f] / np.sqrt(product)


@nested
def drawn_ray(place: Any, drawn: Any, i: int, axes: Any, engaged: Any, ray: Any, rooms: Any) -> None:
    """Find the direction of the freedoms in which a part lies from its centred pose, and its share of the way.

    Args:
        place: of the centred pose; offsets are changed.
        drawn: see `engaged_poses_found`.
        i: trial.
        axes: of the room (freedoms, freedoms).
        engaged: see `engaged_poses_found`.
        ray: direction, of length 1, then the share (freedoms + 1, 1); changed.
        rooms: work arrays.
    """
    offsets, _, rows = place
    (start, gone, stiffness, directions), bolting = rooms
    size = axes.shape[0]
    sweeps = drawn.shape[0] // size
    fill(gone, 0.0)
    stated = np.isnan(drawn[0, i])
    if stated:
        for s in range(size):
            for f in range(size):
                gone[f] += (2.0 * drawn[(sweeps - 1) * size + s, i] - 1.0) * axes[s, f]
    else:
        copy_matrix(start, offsets)
        conjugate(place, axes, stiffness, directions)
        for n in range(sweeps * size):
            s = n % size
            for f in range(size):
                ray[f, 0] = -directions[s, f]
            back = way_along(place, ray, 0, engaged, bolting)
            for f in range(size):
                ray[f, 0] = directions[s, f]
            step = (back + way_along(place, ray, 0, engaged, bolting)) * drawn[n, i] - back
            for f in range(size):
                gone[f] += step * directions[s, f]
            for k in range(rows.shape[0]):
                for r in range(2):
                    for f in range(size):
                        offsets[k, r] += step * rows[k, r, f] * directions[s, f]
        copy_matrix(offsets, start)
    length = 0.0
    for f in range(size):
        length += gone[f] * gone[f]
    length = np.sqrt(length)
    for f in range(size):
        ray[f, 0] = gone[f] / length if length > 0.0 else 0.0
    way = 1.0 if stated else way_along(place, ray, 0, engaged, bolting) if length > 0.0 else 0.0
    ray[size, 0] = min(length / way, 1.0) if way > 0.0 else 0.0


@nested
def stays(pose: Any, start: Any, mode: int, trial: Any, reach: float, goal: Any, rooms: Any) -> Any:
    """Find a stationary pose; True if found, with the slack of the centred one and a cone that has it.

    Where the first round of the nominal programme leaves freedoms open, rows stay nominal: what those of the pose would
    gain along them is of second order, and a part would swing through its clearance for it. A push is then nominal too,
    and offsets are in the axes that holes have nominally.

    Args:
        pose: changed, from a nearby pose.
        start: that pose.
        mode: CENTRED, PUSHED or STRAYED.
        trial, reach: of the part.
        goal: target of the motion.
        rooms: work arrays.
    """
    place, all_rows, tangents, q, push, step, before, basis, done, inner, _, bolting, _, _ = rooms
    i, ray, freedoms, state = trial[1], goal[4], tangents.shape[1], place[4]
    previous, gone, slack, which, left, nominal = NONE, 0.0, 0.0, 0, 0, mode != STRAYED
    for n in range(ROUNDS):
        turned = n == 0 or (mode != STRAYED and (n == 1 or previous > TURNED * reach))
        rows_here(pose, trial, reach, place, all_rows, tangents, nominal, turned)
        if mode == STRAYED:
            more = way_along(place[:3], ray, 0, trial[0], bolting)
            gone += more
            size = abs(more)
        else:
            strength = goal_at(pose, goal, i, reach, tangents, nominal, push) if mode == PUSHED else 0.0
            if nominal and mode == PUSHED:
                as_nominally(pose, trial[0], i, goal[5], place[0])
            found, slack, which, left = lain(place[:3], freedoms, push, strength, before, basis, done, q, inner)
            if not found:
                return False, slack, which
            size = 0.0
            for f in range(freedoms):
                size = max(size, abs(q[f]))
            for b in range(state.shape[0]):
                for r in range(4):
                    state[b, r] += q[freedoms + 4 * b + r]
        ends = size * min(1.0, size / previous) <= MET and (n > 0 or state.shape[0] == 0)
        if mode == STRAYED:
            for f in range(freedoms):
                q[f] = gone * ray[f, 0] * (ray[freedoms, 0] if ends else 1.0)
            copy_matrix(pose, start)
        moved_on(pose, trial, reach, q, tangents, step)
        if ends:
            return True, slack, which
        previous, nominal = max(size, NONE), nominal and (n > 0 or left > 0)
    return previous < LOST, slack, which


@nested
def lies(pose: Any, trial: Any, reach: float, goal: Any, rooms: Any) -> Any:
    """Find a pose, and the shares of cones in the least slack of the centred one; True if found, with this slack."""
    mode, slack, start, before, shares = CENTRED, 0.0, rooms[10], rooms[6], rooms[13]
    pushes, ray, drawn, axes = goal[0], goal[4], goal[6], goal[7]
    while mode != DONE:
        copy_matrix(start, pose)
        found, least, decides = stays(pose, start, mode, trial, reach, goal, rooms)
        if not found:
            return False, slack
        if mode == CENTRED:
            slack = least
            for k in range(shares.shape[0]):
                shares[k] = before[0][k] if before[1][k] == 1 else 0.0
            if not shares[decides] > 0.0:  # no freedom moves it
                fill(shares, 0.0)
                shares[decides] = 1.0
        strays = not pushes and drawn.shape[1] > 0
        goes = mode == CENTRED and slack > 0.0 and (pushes or strays)
        mode = DONE if not goes else STRAYED if strays else PUSHED
        if mode == STRAYED:
            drawn_ray(rooms[0][:3], drawn, trial[1], axes, trial[0], ray, (rooms[12], rooms[11]))
    return True, slack


@nested
def work_rooms(cones: int, freedoms: int, bolts: int, kept: int) -> Any:
    """Work arrays for a trial."""
    every = freedoms + 4 * bolts
    vectors = (np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(6), np.empty((kept, freedoms)))
    place = (np.empty((cones, 2)), np.empty(cones), np.empty((cones, 2, every)), vectors, np.zeros((bolts, 4)))
    return (
        place,
        np.empty((cones, 2, 6)),
        np.empty((6, freedoms)),
        np.empty(every),
        np.zeros(every),
        np.empty(6),
        (np.empty(cones), np.empty(cones, dtype=np.int64)),
        np.empty((every, every)),
        np.empty(cones, dtype=np.bool_),
        new_rooms(cones, every),
        np.empty((3, 4)),
        bolt_rooms(),
        (np.empty((cones, 2)), np.empty(freedoms), np.empty((freedoms, freedoms)), np.empty((freedoms, freedoms))),
        np.empty(cones),
    )


@kernel(
    arrays="float64[:,:,::1], float64[:,:,::1], float64[:,:,:,::1], float64[:,:,::1], float64[:,:,::1], boolean[::1], "
    "int64[::1], int64[::1], float64[:,:,::1], float64[:,:,::1], float64[:,:,::1], float64[::1], float64[:,::1], "
    "float64[:,::1], float64[:,:,::1], "
    "float64[:,:,::1], float64, boolean, float64[::1], float64[:,::1], float64[::1], float64[:,::1], float64[:,::1], "
    "float64[:,::1], "
    "float64[:,:,::1], float64[:,::1], "
    "float64[::1], float64[:,::1], boolean[::1]"
)
def engaged_poses_found(
    moving: Any, fixed: Any, axes: Any, others: Any, halves: Any, inner_moves: Any, kinds: Any,
    bolt_of: Any, bolts: Any,
    kept_vectors: Any, kept_normals: Any, kept_shifts: Any, kept_steps: Any, steps: Any, rows: Any, start: Any,
    reach: float, pushes: bool, push: Any, point: Any, along: Any, drawn: Any, room_axes: Any, turn: Any,
    turns: Any, shifts: Any, slacks: Any, shares: Any, found: Any,
) -> None:  # fmt: skip
    """Poses of parts within their clearances.

    Args:
        moving: points of what engages, of the part (cones, 3, n), from the middle in its frame [mm].
        fixed: those of what it engages (cones, 3, n), from the middle in the world [mm].
        axes: of offsets (cones, 2, 3, n), in the frame of the inner one: of the part, or of the world.
        others: direction of the outer one, the same way (cones, 3, n).
        halves: sizes / 2 of the inner and of the outer one (cones, 2, n) [mm].
        inner_moves: whether the inner one is of the part (cones,).
        kinds: PIN_IN_HOLE, PIN_IN_SLOT, TAB_IN_SLOT or BOLT_IN_HOLE (cones,).
        bolt_of: which bolt, -1 for none (cones,); its holes are inner ones, with their axes as `others`.
        bolts: nominally, its middle from that of all places in the world, two directions across it, that along it,
            and (reach, 0, 0) (bolts, 5, 3) [mm].
        kept_vectors, kept_normals, kept_shifts, kept_steps: what relations keep, and which steps undo a change of it,
            as in `tilted_rests_found`.
        steps: the freedoms, turn times reach and shift (6, freedoms).
        rows: nominal change of offsets by them and by each bolt's shifts and leans (cones, 2, freedoms + 4 bolts).
        start: poses where relations lay the part (3, 4, n).
        reach: of all places about their middle [mm].
        pushes: whether it goes as far as it can: along `push` (freedoms,), or its point (3, n) along a direction (3,),
            if that is not 0; `push` is then the nominal way.
        drawn: uniforms of a random float, sweep by sweep (sweeps * freedoms, n); (0, 0) if it is none.
        room_axes: the freedoms in the order of a sweep (freedoms, freedoms); (0, 0) if it is none.
        turn: of the part as it lies nominally (3, 3).
        turns, shifts: found (3, 3, n), (3, n) [mm].
        slacks: the least slack of the centred pose (n,) [mm].
        shares: multipliers of the cones that decide it, which sum to 1 (cones, n); 1 for a cone that no freedom moves.
        found: whether all is found (n,).
    """
    cones, freedoms = kinds.shape[0], steps.shape[1]
    engaged = (moving, fixed, axes, others, halves, inner_moves, kinds, bolt_of, bolts)
    pose, first = np.empty((3, 4)), np.empty(kept_shifts.shape[0])
    rooms = work_rooms(cones, freedoms, bolts.shape[0], len(first))
    kept = (kept_vectors, kept_normals, kept_shifts, kept_steps, first)
    goal = (pushes, push, point, along, np.empty((freedoms + 1, 1)), turn, drawn, room_axes)
    for i in range(found.shape[0]):
        begin(pose, first, start, i, kept)
        fill(rooms[6][1], 0)
        fill(rooms[4], 0.0)
        fill_matrix(rooms[0][4], 0.0)
        fill(rooms[13], 0.0)
        found[i], slacks[i] = lies(pose, (engaged, i, kept, steps, rows), reach, goal, rooms)
        for k in range(cones):
            shares[k, i] = rooms[13][k]
        for r in range(3):
            shifts[r, i] = pose[r, 3]
            for c in range(3):
                turns[r, c, i] = pose[r, c]
