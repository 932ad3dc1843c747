"""The analytic method: travel of each flank of each mesh, to first order in the deviations, and the free turns.

Along the line of action, with alpha_w the working pressure angle and s = 1 of a sun, -1 of a ring: a tooth thicker by
an arc E takes E cos(alpha)/2 from each flank, of helical gears E cos(alpha_t)/(2 cos(beta)); a planet displaced against
its central gear by d_r outwards and d_t counter-clockwise opens the flanks by s (sin(alpha_w) d_r +- cos(alpha_w) d_t);
a gear turned on its shaft by a moves them by r_b a. Working radii alone decide the rest: see PlanetarySet.all_rows.
Nothing here sees a pose.

Bound on the change of a shaft's play for a small error of every gap.

Of a planet's rows any two leave its own turn out: a relation between shafts, and springs. As many of them as there are
unknowns decide where a shaft stops, whichever contacts hold it; so the worst such choice bounds what gaps may do.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, Final

import numpy as np

from tol3d.gearing.planetary.first_order.curve_kernel import curve_slopes, first_order_curve
from tol3d.gearing.planetary.model.deviated import Deviated, Free, cosines_and_sines
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.numerics.arrays import Array, Places
from tol3d.numerics.plane import turned
from tol3d.numerics.programme import ranges


@dataclass(frozen=True)
class StackUp:
    """First-order gaps of a set and the free turns that they leave."""

    own: PlanetarySet

    def sides(self, deviated: Deviated, turns: Array) -> tuple[Array, Array]:
        """Lower and upper side (trials, planets x meshes) [mm] of n, at turns (trials,) of the output."""
        own = self.own
        lower = np.empty((len(turns), own.planets, len(own.meshes)))
        upper = np.empty_like(lower)
        azimuths = np.array(own.azimuths) / (2 * np.pi)
        of_centrals, of_planet = own.gear_rates
        for place, mesh in enumerate(own.meshes):
            gear = own.gear_of(mesh)
            s, angle = mesh.sense, mesh.working_pressure_angle
            central = deviated.central_offset[:, None, place].repeat(own.planets, axis=1)
            central = turned(central, (of_centrals[place] * turns)[:, None] - azimuths)
            phases = own.phases / (2 * np.pi)
            planet = turned(deviated.planet_offset[:, gear], (of_planet * turns)[:, None] + phases)
            aside = turned(deviated.aside[:, None, place].repeat(own.planets, axis=1), -azimuths)
            apart = planet + deviated.pins - central + aside
            thicker = deviated.central_thickness[:, place, None] + deviated.planet_thickness[:, gear]
            room = mesh.clearance - thicker * mesh.central.along_action / 2
            room = room + s * np.sin(angle) * apart[..., 0]
            slid = deviated.planet_slide * (abs(own.planet_slides[place]) / 2)
            room = room + np.where(room >= 0.0, slid, 0.0)  # teeth too thick for their spaces are so at any height
            moved = s * np.cos(angle) * apart[..., 1]
            moved = moved - mesh.planet.base_radius * deviated.planet_clocking[:, gear]
            moved = moved - s * mesh.central.base_radius * deviated.central_clocking[:, place, None]
            lower[:, :, place] = moved - room
            upper[:, :, place] = moved + room
        return lower.reshape(len(turns), -1), upper.reshape(len(turns), -1)

    def free(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> Free:
        """Free turn of a shaft while another one and the held one stand."""
        own, found = self.own, Free.of(len(turns))
        sides = zip(self.sides(deviated, turns), own.spring_ends, strict=True)
        lower, upper = (np.hstack([side, np.tile(push, (len(turns), 1))]) for side, push in sides)
        ranges(own.rows(stands), lower, upper, *own.asked(stands, shaft), *found.written)
        return found

    def followed(self, deviated: Deviated, turns: Array, shaft: str, stands: str, end: int) -> Free:
        """The lower (0) or upper (1) end of a shaft's turn at turns (positions,) of the output; see free."""
        return self._run(deviated, turns, shaft, stands, end)[0]

    def slopes(
        self,
        deviated: Deviated,
        turns: Array,
        shaft: str,
        stands: str,
        end: int,
        coefficients_of: Callable[[Array], Array],
    ) -> Deviated:
        """Change of a sum of ends by a unit of each deviation while the contacts that are met stay the same.

        Args:
            turns: of the output, (positions,) of all trials or (trials, positions) of each.
            shaft, stands, end: see `followed`.
            coefficients_of: those of ends in the sum (trials, positions), from the ends themselves.
        """
        trials = len(deviated.pins)
        own, met = self.own, np.empty((trials, turns.shape[-1], len(self.own.unknowns(stands))), dtype=np.int64)
        found, given = self._run(deviated, turns, shaft, stands, end, met)
        slopes = (
            np.zeros((trials, 2, len(own.all_rows))),
            np.zeros(deviated.central_offset.shape),
            np.zeros(deviated.planet_offset.shape),
        )
        coefficients = np.ascontiguousarray(coefficients_of(found.ends))
        curve_slopes(own.rows(stands), own.objective(stands, shaft), *given, met, coefficients, *slopes)
        return self._by_deviation(*slopes)

    def lost_motion_slopes(self, deviated: Deviated, turns: Array, shaft: str) -> Deviated:
        """The same of a shaft's free turn at turns (trials,) of the output, the opposite shaft standing."""
        stands = self.own.opposite(shaft)
        low, high = (self.slopes(deviated, turns[:, None], shaft, stands, end, np.ones_like) for end in range(2))
        found = high.plus(low, -1.0)
        found.shaft_slide[...] = np.abs(self.own.slide_turns(shaft))
        return found

    def _run(
        self,
        deviated: Deviated,
        turns: Array,
        shaft: str,
        stands: str,
        end: int,
        met: Places | None = None,
    ) -> tuple[Free, tuple[Any, ...]]:
        """Ends, and what they and their derivatives are found from; see first_order_curve, which writes `met`."""
        own, trials = self.own, len(deviated.pins)
        rates, planet = own.gear_rates
        still = replace(
            deviated,
            central_offset=np.zeros_like(deviated.central_offset),
            planet_offset=np.zeros_like(deviated.planet_offset),
        )
        sides = zip(self.sides(still, np.zeros(trials)), own.spring_ends, strict=True)
        lower, upper = (np.ascontiguousarray(np.hstack([side, np.tile(push, (trials, 1))])) for side, push in sides)
        across = [
            (m.sense * np.sin(m.working_pressure_angle), m.sense * np.cos(m.working_pressure_angle)) for m in own.meshes
        ]
        flat, found = np.ravel(turns), Free.of(trials, turns.shape[-1])
        given = (
            np.array(across),
            np.array([own.gear_of(mesh) for mesh in own.meshes]),
            cosines_and_sines(np.array(own.azimuths) / (2 * np.pi)),
            cosines_and_sines(own.phases / (2 * np.pi)),
            cosines_and_sines(flat[:, None] * rates),
            cosines_and_sines(flat * planet),
        )
        first_order_curve(
            own.rows(stands),
            lower,
            upper,
            np.ascontiguousarray(deviated.central_offset),
            np.ascontiguousarray(deviated.planet_offset),
            *given,
            *own.asked(stands, shaft, end),
            *found.written,
            np.empty((0, 0, 0), dtype=np.int64) if met is None else met,
        )
        return found, given

    def _by_deviation(self, on_sides: Array, on_central: Array, on_planet: Array) -> Deviated:
        """Change a unit of each deviation of each trial, in the places of the deviations themselves.

        Args:
            on_sides: by lower and upper sides of contacts and springs (trials, 2, rows).
            on_central, on_planet: by offsets of gears (trials, centrals, 2), (trials, gears, planets, 2).
        """
        own = self.own
        contacts = len(own.meshes) * own.planets
        lower, upper = (on_sides[:, side, :contacts].reshape(-1, own.planets, len(own.meshes)) for side in range(2))
        opened, moved = upper - lower, upper + lower
        found = Deviated.nothing(own, len(lower))
        found.central_offset[...], found.planet_offset[...] = on_central, on_planet
        for place, mesh in enumerate(own.meshes):
            gear, s, angle = own.gear_of(mesh), mesh.sense, mesh.working_pressure_angle
            thicker = -mesh.central.along_action / 2 * opened[:, :, place]
            found.central_thickness[:, place] += thicker.sum(axis=1)
            found.planet_thickness[:, gear] += thicker
            pushed = np.stack([np.sin(angle) * opened[:, :, place], np.cos(angle) * moved[:, :, place]], axis=-1) * s
            found.pins[...] += pushed
            found.planet_slide[...] += abs(own.planet_slides[place]) / 2 * opened[:, :, place]
            found.aside[:, place] += turned(pushed, np.array(own.azimuths) / (2 * np.pi)).sum(axis=1)
            found.planet_clocking[:, gear] -= mesh.planet.base_radius * moved[:, :, place]
            found.central_clocking[:, place] -= s * mesh.central.base_radius * moved[:, :, place].sum(axis=1)
        return found


INDEPENDENT: Final = 1e-9  # of relations in mm a turn; those of less decide nothing
ALIKE: Final = 12  # decimals; planets that stand alike have the same relations


def play_bound(planetary_set: PlanetarySet, shaft: str, errors: Sequence[float]) -> float:
    """Largest change of a shaft's end [rad] where each gap of a mesh is off by up to an error.

    Args:
        shaft: the input or the output; the other one stands.
        errors: of each mesh [mm].
    """
    relations, amounts = (np.array(each) for each in zip(*_relations(planetary_set, shaft, errors), strict=True))
    _, first = np.unique(np.round(np.column_stack([relations, amounts]), ALIKE), axis=0, return_index=True)
    relations, amounts = relations[first], amounts[first]
    turn = np.zeros(relations.shape[1])
    turn[_coordinates(planetary_set, shaft).index(planetary_set.shafts.index(shaft))] = 1.0
    worst = 0.0
    for chosen in combinations(range(len(relations)), relations.shape[1]):
        basis = relations[list(chosen)]
        if abs(np.linalg.det(basis)) > INDEPENDENT:
            worst = max(worst, float(np.abs(np.linalg.solve(basis.T, turn)) @ amounts[list(chosen)]))
    return worst


def _coordinates(planetary_set: PlanetarySet, shaft: str) -> list[int]:
    """Unknowns that are no planet's."""
    planets = range(len(planetary_set.shafts), len(planetary_set.shafts) + planetary_set.planets)
    return [place for place in planetary_set.unknowns(planetary_set.opposite(shaft)) if place not in planets]


def _relations(planetary_set: PlanetarySet, shaft: str, errors: Sequence[float]) -> Iterator[tuple[Array, float]]:
    """Each with its largest error [mm a mm of the planet's base radius]; springs that are set are exact."""
    coordinates, count = _coordinates(planetary_set, shaft), len(planetary_set.meshes)
    for planet in range(planetary_set.planets):
        rows = planetary_set.all_rows[planet * count : (planet + 1) * count]
        radii = rows[:, len(planetary_set.shafts) + planet]
        for one, other in combinations(range(count), 2):
            relation = rows[one] / radii[one] - rows[other] / radii[other]
            yield relation[coordinates], errors[one] / radii[one] + errors[other] / radii[other]
    for spring, its in zip(planetary_set.springs, planetary_set.all_rows[planetary_set.planets * count :], strict=True):
        if not spring.pushes:
            yield its[coordinates], 0.0
