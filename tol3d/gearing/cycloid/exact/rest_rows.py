"""Contacts of a cycloid stage whose discs and cranks are bodies: gaps and slopes of each where they lie, compiled."""

from typing import Any, Final

import numpy as np

from tol3d.gearing.cycloid.exact.pin_contact import FOOT_XTOL, TURN, lobe_at, lobe_turn, placed
from tol3d.numerics.compiled import nested
from tol3d.numerics.loops import fill
from tol3d.numerics.quick_angles import turned_by

ARM: Final = 100.0  # mm; turns count as lengths there, so that all rows are of one size
ROOM: Final = 1.0  # mm, on either side of where it would be nominally
TURNS: Final = 10.0  # times that, for turns of cranks: teeth may leave them more
FOOT_STEPS: Final = 30


@nested
def pin_gap(shape: Any, pose: Any, clock: float, flanks: Any, pin: Any, u: float) -> Any:
    """Gap between a pin and a disc where it lies [mm], and its slopes: along x, y and by a turn of the disc [mm/rad].

    Args:
        pose: cosine and sine of the disc's turn, and its centre.
        clock, flanks, pin, u: see touched.
    """
    lobe_pitch, lobe_profile = flanks
    cos_psi, sin_psi, centre_x, centre_y = pose
    ratio = shape.eccentricity * shape.pins / shape.ground_circle
    away_x, away_y = pin[0] - centre_x, pin[1] - centre_y
    gap, n_x, n_y = np.nan, 1.0, 0.0
    c, s, e, f = np.cos(u), np.sin(u), np.cos(shape.pins * u), np.sin(shape.pins * u)
    cos_psi, sin_psi = turned_by(cos_psi, sin_psi, clock)
    for _ in range(FOOT_STEPS):
        lobe = lobe_at(u, shape.lobes)
        cos_all, sin_all = turned_by(cos_psi, sin_psi, lobe_turn(shape, lobe_pitch, lobe, f * c - e * s))
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
        c, s = turned_by(c, s, step)
        e, f = turned_by(e, f, shape.pins * step)
    return gap, -n_x, -n_y, n_x * away_y - n_y * away_x


@nested
def bearing_at(stage: Any, made: Any, base: Any, z: Any, bearing: int, row: Any) -> Any:
    """Displacement in a bearing (x, y) [mm], and its slopes written into two rows (2, unknowns).

    Bearings of discs come first, crank by crank and disc by disc, then those of the carrier. For a disc's it is its
    hole's centre less the throw's, for the carrier's the crank less the hole.
    """
    discs, cranks, rolling, phi, chi = stage
    holes, thrown, bored = made
    poses, axes = base
    fill(row, 0.0)
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


@nested
def mesh_written(stage: Any, meshes: Any, z: Any, crank: int, off: Any, across: Any, rows: Any, sides: Any) -> None:
    """Write the rows of a planet's two flanks against the sun's: by its turn, and by where the bearing lets it lie.

    Args:
        meshes: least and most turn of each crank in the middle of its bearing (cranks, 2) [rad], and what a turn is
            for a planet that lies off by 1 mm across the line of centres, and along it [rad/mm].
        off: displacement in the crank's bearing of the carrier (x, y) [mm].
        across: its slopes (2, unknowns).
        rows: of this crank's flanks (2, unknowns); written.
        sides: lower and upper sides of these rows; written.
    """
    discs, cranks, _, _, chi = stage
    turns, around, outwards = meshes
    own = 3 + 3 * discs + 3 * crank
    azimuth = chi + TURN * crank / cranks
    c, s = np.cos(azimuth), np.sin(azimuth)
    for side in range(2):
        sign = 1.0 - 2.0 * side  # the first holds the crank back, the second ahead; outwards there is more of both
        by_x = ARM * (-around * s - sign * outwards * c)
        by_y = ARM * (around * c - sign * outwards * s)
        for j in range(rows.shape[1]):
            rows[side, j] = -by_x * across[0, j] - by_y * across[1, j]
        rows[side, own] += 1.0
        free = ARM * turns[crank, side] - (z[own] - by_x * off[0] - by_y * off[1])
        sides[0][side] = free if side == 0 else -TURNS * ROOM
        sides[1][side] = free if side == 1 else TURNS * ROOM


@nested
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


@nested
def pins_written(
    shape: Any, stage: Any, throws: Any, pins: Any, base: Any, z: Any, working: Any, rows: Any, lower: Any, begun: int
) -> float:  # fmt: skip
    """Write rows of the working pins' gaps; the deepest overlap [mm]."""
    _, _, _, phi, _ = stage
    places, radii, lobe_pitch, lobe_profile, leans = pins
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
        slope_x, slope_y = pose[0] * leans[d, 0] - pose[1] * leans[d, 1], pose[1] * leans[d, 0] + pose[0] * leans[d, 1]
        gap -= abs(by_x * slope_x + by_y * slope_y) * leans[d, 2]  # the face of a leaning disc that is nearer
        row = rows[begun + r]
        fill(row, 0.0)
        row[at], row[at + 1], row[at + 2] = by_x, by_y, by_turn / ARM
        lower[begun + r] = -gap
        deepest = max(deepest, -gap)
    return deepest


@nested
def working_pins(shape: Any, throws: Any, phi: float, sense: float, working: Any) -> int:
    """Write the places of pins that stop a disc in a sense; their number."""
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
