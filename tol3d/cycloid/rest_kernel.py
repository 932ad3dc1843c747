"""A cycloid stage at rest under a torque on its carrier: discs and cranks as bodies on one-sided contacts, compiled.

Unknown are the carrier's turn, the place and turn of each disc, and those of each crank. Contacts are pins against
lobes, throws in the holes of discs and cranks in those of the carrier, each by half its clearance, and the play by
which the first stage lets a crank turn. The torque turns the carrier as far as all contacts let it: a linear programme
with the gaps and slopes of the pose reached, solved again from where it leads until nothing moves. A round clearance is
half-planes across two directions first; each solution that leaves the circle adds the tangent there, so that the
circle is met to 1e-10 mm. The multiplier of a gap is the force on it per torque.
"""

from typing import Any, Final

import numpy as np

from tol3d.cycloid.contact_newton import TURN, ContactShape, lobe_at, lobe_turn, placed
from tol3d.numerics.compiled import kernel, part
from tol3d.numerics.programme import NO_ROOM, OK, STALLED, farthest

NOT_HELD: Final = 3
"""A body leaves by the end of the room that it is given: nothing stops it."""
ROOM: Final = 1.0  # mm, on either side of where it would be nominally
MET: Final = 1e-10  # mm
STILL: Final = 1e-11  # mm at the arm, of the carrier's turn
ARM: Final = 100.0  # mm; turns count as lengths there, so that all rows are of one size
MOST_STEPS: Final = 150
WILD: Final = 8  # steps in which bodies may go anywhere in their room; then
NEAR: Final = 100.0  # times the deepest overlap or the last turn, so that idle bodies do not go to and fro
CUTS: Final = 40  # tangents a bearing
CARRIES: Final = 1e-9  # of a gap's multiplier
FOOT_STEPS: Final = 30
FOOT_XTOL: Final = 1e-12  # rad


@part
def pin_gap(shape: Any, pose: Any, clock: float, flanks: Any, pin: Any, u: float) -> Any:
    """Gap between a pin and a disc where it lies [mm], and its slopes: along x, y and by a turn of the disc [mm/rad].

    Args:
        pose: cosine and sine of the disc's turn, and its centre.
        clock, flanks, pin, u: see contact_newton.touched.
    """
    lobe_pitch, lobe_profile = flanks
    cos_psi, sin_psi, centre_x, centre_y = pose
    ratio = shape.eccentricity * shape.pins / shape.ground_circle
    away_x, away_y = pin[0] - centre_x, pin[1] - centre_y
    gap, n_x, n_y = np.nan, 1.0, 0.0
    for _ in range(FOOT_STEPS):
        c, s = np.cos(u), np.sin(u)
        e, f = np.cos(shape.pins * u), np.sin(shape.pins * u)
        lobe = lobe_at(u, shape.lobes)
        own = clock + lobe_turn(shape, lobe_pitch, lobe, f * c - e * s)
        cos_own, sin_own = np.cos(own), np.sin(own)
        cos_all, sin_all = cos_psi * cos_own - sin_psi * sin_own, sin_psi * cos_own + cos_psi * sin_own
        x, y = cos_all * away_x + sin_all * away_y, cos_all * away_y - sin_all * away_x
        speed = np.sqrt((c - ratio * e) ** 2 + (s - ratio * f) ** 2)
        n_x, n_y = (c - ratio * e) / speed, (s - ratio * f) / speed
        x, y = (
            x - shape.ground_circle * c + shape.eccentricity * e,
            y - shape.ground_circle * s + shape.eccentricity * f,
        )
        gap = n_x * x + n_y * y - (pin[2] - shape.ground_radius + lobe_profile[lobe])
        bend = 1.0 + ratio * (ratio * shape.pins - (1.0 + shape.pins) * (e * c + f * s))
        away = n_x * x + n_y * y
        along = shape.ground_circle * speed + away * bend / (speed * speed)
        n_x, n_y = cos_all * n_x - sin_all * n_y, sin_all * n_x + cos_all * n_y
        step = (n_x * (sin_all * x + cos_all * y) - n_y * (cos_all * x - sin_all * y)) / along
        u += step
        if abs(step) < FOOT_XTOL:
            break
    return gap, -n_x, -n_y, n_x * away_y - n_y * away_x


@part
def bearing_at(stage: Any, made: Any, base: Any, z: Any, bearing: int, row: Any) -> Any:
    """Displacement in a bearing (x, y) [mm], and its slopes written into two rows (2, unknowns).

    Bearings of discs come first, crank by crank and disc by disc, then those of the carrier. For a disc's it is its
    hole's centre less the throw's, for the carrier's the crank less the hole.
    """
    discs, cranks, rolling, phi, chi = stage
    holes, thrown, bored = made
    poses, axes = base
    row[:] = 0.0
    if bearing < cranks * discs:
        i, d = bearing // discs, bearing % discs
        at, own = 1 + 3 * d, 1 + 3 * discs + 3 * i
        turn = z[at + 2] / ARM
        c, s = np.cos(turn), np.sin(turn)
        cos_psi, sin_psi = poses[d, 0] * c - poses[d, 1] * s, poses[d, 1] * c + poses[d, 0] * s
        h_x = cos_psi * bored[d, i, 0] - sin_psi * bored[d, i, 1]
        h_y = sin_psi * bored[d, i, 0] + cos_psi * bored[d, i, 1]
        angle = phi + (rolling * z[0] + z[own + 2]) / ARM
        c, s = np.cos(angle), np.sin(angle)
        t_x = c * thrown[i, d, 0] - s * thrown[i, d, 1]
        t_y = s * thrown[i, d, 0] + c * thrown[i, d, 1]
        row[0, at], row[1, at + 1] = 1.0, 1.0
        row[0, at + 2], row[1, at + 2] = -h_y / ARM, h_x / ARM
        row[0, own], row[1, own + 1] = -1.0, -1.0
        row[0, own + 2], row[1, own + 2] = t_y / ARM, -t_x / ARM
        row[0, 0], row[1, 0] = rolling * t_y / ARM, -rolling * t_x / ARM
        x = poses[d, 2] + z[at] + h_x - axes[i, 0] - z[own] - t_x
        y = poses[d, 3] + z[at + 1] + h_y - axes[i, 1] - z[own + 1] - t_y
        return x, y
    i = bearing - cranks * discs
    own = 1 + 3 * discs + 3 * i
    angle = chi + z[0] / ARM
    c, s = np.cos(angle), np.sin(angle)
    a_x, a_y = c * holes[i, 0] - s * holes[i, 1], s * holes[i, 0] + c * holes[i, 1]
    row[0, own], row[1, own + 1] = 1.0, 1.0
    row[0, 0], row[1, 0] = a_y / ARM, -a_x / ARM
    return axes[i, 0] + z[own] - a_x, axes[i, 1] + z[own + 1] - a_y


@part
def based(stage: Any, linkage: Any, made: Any, poses: Any, axes: Any) -> None:
    """Write where discs and crank axes begin: held without play, at the crank's angle."""
    discs, cranks, _, phi, chi = stage
    holes, _, _ = made
    cos_phi, sin_phi, cos_chi, sin_chi = np.cos(phi), np.sin(phi), np.cos(chi), np.sin(chi)
    for d in range(discs):
        poses[d, 0], poses[d, 1], poses[d, 2], poses[d, 3] = placed(linkage[d], cos_phi, sin_phi, cos_chi, sin_chi)
    for i in range(cranks):
        axes[i, 0] = cos_chi * holes[i, 0] - sin_chi * holes[i, 1]
        axes[i, 1] = sin_chi * holes[i, 0] + cos_chi * holes[i, 1]


@part
def pins_written(
    shape: Any, stage: Any, throws: Any, pins: Any, base: Any, z: Any, working: Any, rows: Any, lower: Any, begun: int
) -> float:  # fmt: skip
    """Write rows of the working pins' gaps; the deepest overlap [mm]."""
    _, _, _, phi, _ = stage
    places, radii, lobe_pitch, lobe_profile = pins
    poses, _ = base
    deepest = 0.0
    count = places.shape[0]
    for r in range(working.shape[0]):
        d, j = working[r] // count, working[r] % count
        at = 1 + 3 * d
        turn = z[at + 2] / ARM
        c, s = np.cos(turn), np.sin(turn)
        pose = (
            poses[d, 0] * c - poses[d, 1] * s, poses[d, 1] * c + poses[d, 0] * s,
            poses[d, 2] + z[at], poses[d, 3] + z[at + 1],
        )  # fmt: skip
        u = TURN * j / shape.pins + (phi + throws[d]) / shape.lobes
        pin = (places[j, 0], places[j, 1], radii[j])
        gap, by_x, by_y, by_turn = pin_gap(
            shape, pose, -throws[d] / shape.lobes, (lobe_pitch[d], lobe_profile[d]), pin, u
        )  # fmt: skip
        row = rows[begun + r]
        row[:] = 0.0
        row[at], row[at + 1], row[at + 2] = by_x, by_y, by_turn / ARM
        lower[begun + r] = -gap
        deepest = max(deepest, -gap)
    return deepest


@part
def working_pins(shape: Any, throws: Any, phi: float, sense: float, working: Any) -> int:
    """Write the places of pins that stop a disc in a sense; how many."""
    found, count = 0, int(shape.pins)
    ratio = shape.eccentricity * shape.pins / shape.pin_circle
    for d in range(throws.shape[0]):
        for j in range(count):
            phase = TURN * j / shape.pins - phi - throws[d]
            least = shape.window * np.sqrt(1.0 + ratio * (ratio - 2.0 * np.cos(phase)))
            if sense * np.sin(phase) > least:
                working[found] = d * count + j
                found += 1
    return found


@part
def boxed(count: int, discs: int, basis: Any, loads: Any) -> bool:
    """Whether the room that is given to a body carries some of the torque; the play of cranks may."""
    for k in range(count):
        row = basis[k]
        if row < count and abs(loads[k]) > CARRIES and not (row > 3 * discs and (row - 3 * discs) % 3 == 0):
            return True
    return False


@part
def begin(count: int, basis: Any, sides: Any) -> None:
    """Put the first basis: the room of each body."""
    for k in range(count):
        basis[k], sides[k] = k, 1.0


@part
def room_written(count: int, discs: int, play: float, near: float, z: Any, lower: Any, upper: Any) -> None:
    """Write how far bodies may go next: to the end of their room, and no farther than near."""
    for k in range(count):
        most = play * ARM if k > 3 * discs and (k - 3 * discs) % 3 == 0 else ROOM
        lower[k], upper[k] = max(-most - z[k], -near), min(most - z[k], near)


@part
def rested(
    shape: Any, stage: Any, throws: Any, made: Any, base: Any, pins: Any, clearances: Any, working: Any, sense: float,
    rooms: Any,
) -> tuple[int, float]:  # fmt: skip
    """What becomes of a stage that is turned in a sense, and the carrier's turn [rad]."""
    rows, lower, upper, basis, solving, x, z, planes, across = rooms
    discs, cranks, _, _, _ = stage
    radial, play = clearances
    count, bearings = z.shape[0], cranks * (discs + 1)
    first = count + working.shape[0]
    cuts = 0
    for b in range(bearings):
        for axis in range(2):
            planes[cuts, 0], planes[cuts, 1], planes[cuts, 2] = float(b), 1.0 - axis, float(axis)
            cuts += 1
    z[:] = 0.0
    x[:] = 0.0
    begin(count, basis, solving[2])
    across[2, :] = 0.0
    across[2, 0] = sense
    more, near = NEAR, 2.0 * ROOM
    for step in range(MOST_STEPS):
        deepest = pins_written(shape, stage, throws, pins, base, z, working, rows, lower, count)
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
        held = step < 1 or not boxed(count, discs, basis, solving[3])
        if step > 0 and deepest < MET and abs(x[0]) < STILL and (held or near >= ROOM):
            return OK if held else NOT_HELD, z[0] / ARM
        more = max(NEAR, more / 4.0) if held else 4.0 * more
        near = 2.0 * ROOM if step < WILD else min(more * (max(deepest, abs(x[0])) + MET), 2.0 * ROOM)
        room_written(count, discs, play, near, z, lower, upper)
        used = first + cuts
        found, _, _ = farthest(rows[:used], lower[:used], upper[:used], across[2], basis, solving, x)
        if found == NO_ROOM and near >= ROOM:
            return NO_ROOM, np.nan
        if found != OK:  # too little room, or tangents that nearly coincide
            more *= 10.0
            begin(count, basis, solving[2])
            continue
        for k in range(count):
            z[k] += x[k]
    return STALLED, np.nan


@part
def note(count: int, working: Any, basis: Any, multipliers: Any, loads: Any) -> None:
    """Write the force on each pin per torque [1/mm]."""
    for k in range(count):
        row = basis[k] - count
        if abs(multipliers[k]) > CARRIES and 0 <= row < working.shape[0]:
            loads[working[row]] = abs(multipliers[k]) / ARM


@kernel(
    ContactShape,
    arrays="f8[::1], f8[:,:,::1], f8[:,:,::1], f8[:,:,:,::1], f8[:,:,:,::1], f8[:,:,::1], f8[:,::1], f8[:,:,::1], "
    "f8[:,:,::1], f8[:,::1], f8[::1], f8[:,::1], f8, f8[:,::1], f8[:,:,::1], i1[:,::1]",
)
def rests(
    shape: Any, throws: Any, linkage: Any, holes: Any, thrown: Any, bored: Any, places: Any, radii: Any,
    lobe_pitch: Any, lobe_profile: Any, radial: Any, play: Any, phis: Any, sense: float,
    turns: Any, loads: Any, status: Any,
) -> None:  # fmt: skip
    """Rests of trials at crank angles.

    Args:
        shape, throws, linkage, places, radii, lobe_pitch, lobe_profile, phis: see contact_kernel.first_contacts.
        holes: of the carrier, in its frame (trials, cranks, 2) [mm].
        thrown: throws, in the crank's frame (trials, cranks, discs, 2) [mm].
        bored: holes of discs, in the profile's frame (trials, discs, cranks, 2) [mm].
        radial: half the clearance of each bearing (trials, bearings) [mm], in the order of bearing_at.
        play: by which a crank may turn either way (trials,) [rad].
        sense: +1 or -1.
        turns: the carrier's beyond -phi / Zc (trials, positions) [rad]; written.
        loads: on pins per torque (trials, positions, discs pins) [1/mm]; written.
        status: of the positions; written.
    """
    discs, cranks = throws.shape[0], holes.shape[1]
    count = 1 + 3 * (discs + cranks)
    bearings = cranks * (discs + 1)
    most = bearings * (2 + CUTS)
    size = count + discs * radii.shape[1] + most
    solving = (
        np.empty((count, count)), np.empty((count, count)), np.empty(count), np.empty(count), np.empty(count)
    )  # fmt: skip
    rows, lower, upper = np.zeros((size, count)), np.empty(size), np.empty(size)
    rooms = (
        rows, lower, upper, np.empty(count, np.int64), solving, np.empty(count), np.empty(count), np.empty((most, 3)),
        np.empty((3, count)),
    )  # fmt: skip
    working, base = np.empty(discs * radii.shape[1], np.int64), (np.empty((discs, 4)), np.empty((cranks, 2)))
    for i in range(phis.shape[0]):
        made = (holes[i], thrown[i], bored[i])
        pins = (places[i], radii[i], lobe_pitch[i], lobe_profile[i])
        for p in range(phis.shape[1]):
            stage = (discs, cranks, shape.rolling, phis[i, p], -phis[i, p] / shape.lobes)
            based(stage, linkage[i], made, base[0], base[1])
            number = working_pins(shape, throws, phis[i, p], sense, working)
            for k in range(count):
                rows[k, :] = 0.0
                rows[k, k] = 1.0
            upper[count : count + number] = ROOM * ARM
            status[i, p], turns[i, p] = rested(
                shape, stage, throws, made, base, pins, (radial[i], play[i]), working[:number], sense, rooms
            )  # fmt: skip
            loads[i, p, :] = 0.0
            if status[i, p] == OK:
                note(count, working[:number], rooms[3], solving[3], loads[i, p])
