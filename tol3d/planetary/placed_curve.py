"""Where a shaft rests at positions one after another, its gears placed: each position goes on from the one before.

The same contacts and steps as in `contact.py`, one end of the turn alone; see there. Where the shafts stand, less what
they have turned without backlash, and the contacts that are met are those that the next position begins with.
"""

from typing import Any

import numpy as np

from tol3d.numerics.compiled import kernel, part
from tol3d.numerics.programme import OK
from tol3d.planetary.contact import seated


@part
def turn_offsets(central: Any, planet: Any, centrals: Any, own: Any, now: Any) -> None:
    """Write offsets of central gears (meshes, 2) and planets' gears (gears, planets, 2) turned by cosine and sine."""
    for m in range(central.shape[0]):
        now[0][m, 0] = centrals[m, 0] * central[m, 0] - centrals[m, 1] * central[m, 1]
        now[0][m, 1] = centrals[m, 1] * central[m, 0] + centrals[m, 0] * central[m, 1]
    for g in range(planet.shape[0]):
        for k in range(planet.shape[1]):
            now[1][g, k, 0] = own[0] * planet[g, k, 0] - own[1] * planet[g, k, 1]
            now[1][g, k, 1] = own[1] * planet[g, k, 0] + own[0] * planet[g, k, 1]


@kernel(
    arrays="f8[:,::1], i8[::1], f8[:,::1], f8[:,::1], f8, f8[:,:,::1], f8[:,:,:,::1], f8[:,:,::1], f8[:,:,::1], "
    "f8[:,:,::1], f8[:,:,::1], f8[:,:,::1], f8[:,::1], f8[:,::1], i8[::1], f8[::1], f8[::1], i8[::1], "
    "f8[:,::1], i1[::1], i8[::1], f8[::1]"
)
def placed_curve(
    meshes: Any, places: Any, planets: Any, senses: Any, distance: float,
    central: Any, planet: Any, pin: Any, aside: Any, room: Any, middle: Any,
    centrals_turned: Any, planets_turned: Any, pushed: Any, unknowns: Any, turn: Any, wanted: Any, begun: Any,
    ends: Any, status: Any, decided: Any, amount: Any,
) -> None:  # fmt: skip
    """The end of one coordinate at positions that all trials share; for the arguments see contact.seated_ranges.

    Args:
        central, planet: offsets (trials, ...) where the first position's are not turned yet.
        centrals_turned, planets_turned: cosine and sine of each central gear's turn against the carrier (positions,
            meshes, 2), and of a planet's (positions, 2).
        wanted: what is made largest (unknowns,).
        ends: of the coordinate (trials, positions), written; 0 where the set jams.
        status, decided, amount: the worst position's.
    """
    count, springs = unknowns.shape[0], senses.shape[1]
    contacts = meshes.shape[0] * planets.shape[0]
    solving = (
        np.empty((count, count)), np.empty((count, count)), np.empty(count), np.empty(count), np.empty(count)
    )  # fmt: skip
    basis, turns = np.empty(count, np.int64), np.empty(meshes.shape[0] + 1 + planets.shape[0] + springs)
    slopes, rows = np.empty((contacts, turns.shape[0])), np.empty((contacts + springs, count))
    rooms = (solving, slopes, rows, np.empty(contacts + springs), np.empty(contacts + springs), np.empty(count))
    shape = (meshes, places, planets, senses, distance)
    now = (np.empty((meshes.shape[0], 2)), np.empty((planet.shape[1], planet.shape[2], 2)))
    for i in range(central.shape[0]):
        status[i], decided[i], amount[i] = OK, -1, 0.0
        afresh = True
        for p in range(ends.shape[1]):
            turn_offsets(central[i], planet[i], centrals_turned[p], planets_turned[p], now)
            given = (now[0], now[1], pin[i], aside[i], room[i], middle[i])
            for attempt in range(2):
                if afresh or attempt == 1:
                    turns[:] = 0.0
                    for j in range(count):
                        basis[j], solving[2][j] = begun[j], 1.0
                found, row, lacking = seated(shape, given, pushed, unknowns, wanted, basis, rooms, turns)
                if found == OK or afresh:
                    break
            ends[i, p] = 0.0
            afresh = found != OK
            if afresh:
                if found >= status[i]:
                    status[i], decided[i], amount[i] = found, row, max(amount[i], lacking)
                continue
            for j in range(count):
                ends[i, p] += turn[j] * turns[unknowns[j]]
