"""Balance of a stage's bodies on given contacts, by Newton's method: where a programme's basis leads, compiled.

A programme knows a round clearance by tangents, each of which halves the angle to the force on it: a dozen programmes
lie between the contacts that carry, which the first ones find, and a circle that is met to 1e-10 mm. Here the contacts
that carry are met as they are: pins, planets, and the circles of bearings. With h the gaps, mu the forces per torque on
the carrier and z the bodies,

    H x + A' mu = e,    A x = -h,    H = sum of mu / d (J' t) (J' t)' over bearings,

e the carrier's turn, A the slopes of the gaps, J the slopes of a displacement in a bearing, of length d, and t the
direction across it. Idle bodies go where the contacts they overlap let them, and no farther. What is found rests if all
forces press, and nothing overlaps.
"""

from typing import Any, Final

import numpy as np

from tol3d.gearing.cycloid.exact.rest_rows import ROOM, bearing_at, mesh_written, pins_written
from tol3d.numerics.compiled import nested
from tol3d.numerics.loops import fill

CARRIES: Final = 1e-9  # of a gap's multiplier
PIN: Final = -1.0  # in place of a bearing's number, of a tangent at a pin
SETTLED: Final = 1e-12  # mm, of overlaps and of the carrier's step
IDLE: Final = 1e-9  # 1/mm, of bodies that nothing holds
APART: Final = 1e-5  # mm, by which contacts without force are opened
MOST_BALANCES: Final = 10
LEAST_PIVOT: Final = 1e-12
FREE: Final = 0
LOADED: Final = 1
OPENED: Final = 2


@nested
def carrying(first: int, radial: Any, basis: Any, solving: Any, planes: Any, forces: Any, roles: Any) -> bool:
    """Write the forces on bearings by a programme's multipliers, and which contacts carry.

    False if a tangent at a pin is among them, or a bearing without play: a circle that is a point.

    Args:
        roles: of bearings, then of flanks of planets and of pins; written.
    """
    _, _, sides, loads, _ = solving
    count, bearings = basis.shape[0], forces.shape[0]
    for r in range(roles.shape[0]):
        roles[r] = FREE
    for k in range(count):
        if count <= basis[k] < first and abs(loads[0, k]) > CARRIES:
            roles[bearings + basis[k] - count] = LOADED
    for b in range(bearings):
        x, y = 0.0, 0.0
        for k in range(count):
            own = basis[k] - first
            if own >= 0 and planes[own, 0] == PIN:
                return False
            if own >= 0 and planes[own, 0] == float(b):
                x += sides[k] * loads[0, k] * planes[own, 1]
                y += sides[k] * loads[0, k] * planes[own, 2]
        forces[b] = np.sqrt(x * x + y * y)
        if forces[b] > CARRIES:
            if not radial[b] > 0.0:
                return False
            roles[b] = LOADED
    return True


@nested
def bowed(by: float, row: Any, system: Any) -> None:
    """Add a slope times itself to the bend of the bodies."""
    for i in range(row.shape[0]):
        scaled = by * row[i]
        if scaled != 0.0:
            for j in range(row.shape[0]):
                system[i, j] += scaled * row[j]


@nested
def held(row: Any, lacking: float, place: int, system: Any) -> None:
    """Write the equation of a contact, and its force in those of the bodies."""
    for j in range(row.shape[0]):
        system[place, j] = system[j, place] = row[j]
    system[place, system.shape[1] - 1] = lacking


@nested
def eliminated(number: int, system: Any) -> bool:
    """Solve equations (number, number), right sides and solution in the last column; False where they depend."""
    last = system.shape[1] - 1
    for k in range(number):
        best = k
        for i in range(k + 1, number):
            if abs(system[i, k]) > abs(system[best, k]):
                best = i
        if not abs(system[best, k]) > LEAST_PIVOT:
            return False
        if best != k:
            for j in range(k, number):
                system[k, j], system[best, j] = system[best, j], system[k, j]
            system[k, last], system[best, last] = system[best, last], system[k, last]
        for i in range(k + 1, number):
            if system[i, k] != 0.0:
                factor = system[i, k] / system[k, k]
                for j in range(k + 1, number):
                    system[i, j] -= factor * system[k, j]
                system[i, last] -= factor * system[k, last]
    for i in range(number - 1, -1, -1):
        value = system[i, last]
        for j in range(i + 1, number):
            value -= system[i, j] * system[j, last]
        system[i, last] = value / system[i, i]
    return True


@nested
def stated(stage: Any, made: Any, base: Any, clearances: Any, pinned: int, deepest: float, rooms: Any) -> Any:
    """Write the equations of the balance where bodies lie; their number, and the deepest overlap."""
    rows, lower, upper, _, _, _, z, _, across, _, system, roles = rooms
    discs, cranks, _, _, _ = stage
    radial, meshes = clearances
    count, bearings = z.shape[0], cranks * (discs + 1)
    forces, last, place = system[2 * count + 1], system.shape[1] - 1, count
    for i in range(2 * count):
        fill(system[i], 0.0)
    for k in range(count):
        system[k, k] = IDLE
    system[0, last] = across[2, 0]
    for b in range(bearings):
        x_b, y_b = bearing_at(stage, made, base, z, b, across[:2])
        far = np.sqrt(x_b * x_b + y_b * y_b)
        if b >= cranks * discs:
            own = count + 2 * (b - cranks * discs)
            both = lower[own : own + 2], upper[own : own + 2]
            mesh_written(stage, meshes, z, b - cranks * discs, (x_b, y_b), across, rows[own : own + 2], both)
        deepest = max(deepest, far - radial[b])
        if roles[b] == FREE and far - radial[b] > SETTLED:
            roles[b] = OPENED
        if roles[b] != FREE and far > 0.0 and place < 2 * count:
            for j in range(count):
                along = (x_b * across[0, j] + y_b * across[1, j]) / far
                across[1, j] = (x_b * across[1, j] - y_b * across[0, j]) / far
                across[0, j] = along
            if roles[b] == LOADED:
                bowed(forces[b] / far, across[1], system)
            held(across[0], radial[b] - far - min(APART, radial[b] / 2.0) * (roles[b] == OPENED), place, system)
            place += 1
    for r in range(bearings, roles.shape[0]):
        row = count + r - bearings
        is_upper = row < pinned and (row - count) % 2 == 1
        over = -upper[row] if is_upper else lower[row]
        deepest = max(deepest, over)
        if roles[r] == FREE and over > SETTLED:
            roles[r] = OPENED
        if roles[r] != FREE and place < 2 * count:
            apart = over + APART * (roles[r] == OPENED)
            held(rows[row], -apart if is_upper else apart, place, system)
            place += 1
    return place, deepest


@nested
def pressing(pinned: int, number: int, bearings: int, rooms: Any) -> bool:
    """True if all contacts that carry press, and no others do; written are the forces on bearings."""
    _, _, _, basis, _, _, _, _, _, _, system, roles = rooms
    count, place, last = basis.shape[0], basis.shape[0], system.shape[1] - 1
    for r in range(roles.shape[0]):
        if roles[r] != FREE:
            force = system[place, last]
            is_upper = r < bearings or (r - bearings < pinned - count and (r - bearings) % 2 == 1)
            if roles[r] == OPENED:
                if abs(force) > CARRIES:
                    return False
            elif not (force if is_upper else -force) > CARRIES:
                return False
            elif r < bearings:
                system[2 * count + 1, r] = force
            place += 1
    return bool(place == number)


@nested
def balanced(
    shape: Any, stage: Any, throws: Any, made: Any, base: Any, pins: Any, clearances: Any, working: Any, rooms: Any
) -> bool:  # fmt: skip
    """Move bodies to rest on the contacts that carry in a programme; False, with bodies left alone, if they do not."""
    rows, lower, _, basis, solving, _, z, planes, _, _, system, every = rooms
    discs, cranks, _, _, _ = stage
    count, bearings = z.shape[0], cranks * (discs + 1)
    pinned, last = count + 2 * cranks, system.shape[1] - 1
    first = pinned + working.shape[0]
    roles = every[: bearings + first - count]
    own = (*rooms[:11], roles)
    if not carrying(first, clearances[0], basis, solving, planes, system[2 * count + 1, :bearings], roles):
        return False
    for k in range(count):
        system[2 * count, k] = z[k]
    for _ in range(MOST_BALANCES):
        deepest = pins_written(shape, stage, throws, pins, base, z, working, rows, lower, pinned)
        number, deepest = stated(stage, made, base, clearances, pinned, deepest, own)
        if number >= 2 * count or not eliminated(number, system) or not pressing(pinned, number, bearings, own):
            break
        farthest = 0.0
        for k in range(count):
            farthest = max(farthest, abs(system[k, last]))
        if not farthest < ROOM:
            break
        if deepest < SETTLED and abs(system[0, last]) < SETTLED:
            fill(solving[3][0], 0.0)
            place = count
            for r in range(roles.shape[0]):
                for k in range(count):
                    if roles[r] != FREE and r >= bearings and basis[k] == count + r - bearings:
                        solving[3][0, k] = system[place, last]
                place += roles[r] != FREE
            return True
        for k in range(count):
            z[k] += system[k, last]
    for k in range(count):
        z[k] = system[2 * count, k]
    return False
