"""A planetary set as it is meant: gears, planets round the axis, meshes, and which of its shafts is held or drives.

Sets with one, two (3K, Wolfrom) or more rings, with suns or without, differ by their meshes alone.
"""

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.gearing.planetary.model.set_mesh import SetGear, SetMesh
from tol3d.gearing.planetary.model.tooth_set import CentralMesh, ToothSet
from tol3d.gears.cylindrical_gear import SAME_LEAD
from tol3d.numerics.arrays import Array, Places
from tol3d.numerics.programme import first_basis

SMALL_TORQUE: Final = 1.0  # N mm a N of the first spring's force, at the output
OVERCOME: Final = 1e-6  # of the springs' force; breakaway torques are hundreds of times under what that leaves
WEAKER: Final = 0.25  # each spring than the one before; of equal ones nothing would say which gives way
MOST_PUSH: Final = 10.0  # mm; no mesh leaves a planet so much


@dataclass(frozen=True)
class Spring:
    """Spring that turns some planets on the carrier against others, about the common axis.

    Args:
        forward, backward: planets that it pushes counter-clockwise and clockwise, counted from 0.
        displacement: of each of them along the circle of the pins [mm], as it is set; None where the spring pushes them
            as far as their meshes let it.
    """

    forward: tuple[int, ...]
    backward: tuple[int, ...]
    displacement: float | None = None

    @property
    def pushes(self) -> bool:
        """True if it pushes, rather than being set."""
        return self.displacement is None

    def sense(self, planet: int) -> float:
        """1 of a planet that it pushes forward, -1 backward, 0 of others."""
        return float(planet in self.forward) - float(planet in self.backward)


@dataclass(frozen=True)
class PlanetarySet:
    """Central gears, planets on a carrier, and the meshes between them.

    Its shafts are the central gears and the carrier; planets turn on pins of the carrier. Angles are counter-clockwise
    about the common axis.

    Args:
        meshes: central gears in their order; each has one mesh with every planet.
        gears: of a planet, which turn as one.
        azimuths: of the planets [rad].
        springs: of a flexible carrier; none of a rigid one.
        overcome: whether torques are read that springs give way to, so that contacts alone stop the planets.
    """

    name: str
    meshes: tuple[SetMesh, ...]
    planets: int
    gears: tuple[SetGear, ...]
    carrier: str
    held: str
    input: str
    output: str
    azimuths: tuple[float, ...]
    springs: tuple[Spring, ...] = ()
    overcome: bool = False

    @property
    def shafts(self) -> tuple[str, ...]:
        """Central gears, then the carrier."""
        return (*(mesh.central.name for mesh in self.meshes), self.carrier)

    @property
    def all_gears(self) -> tuple[SetGear, ...]:
        """Central gears, then those of a planet."""
        return (*(mesh.central for mesh in self.meshes), *self.gears)

    @property
    def centre_distance(self) -> float:
        """Centre distance of all meshes [mm]."""
        return self.meshes[0].centre_distance

    def arm(self, shaft: str) -> float:
        """Base radius of a central gear, of the carrier the centre distance [mm]."""
        radii = {mesh.central.name: mesh.central.base_radius for mesh in self.meshes}
        return radii.get(shaft, self.centre_distance)

    def gear_of(self, mesh: SetMesh) -> int:
        """Gear of a planet that a mesh has."""
        return [gear.name for gear in self.gears].index(mesh.planet.name)

    @cached_property
    def teeth(self) -> ToothSet:
        """Its tooth numbers."""
        return ToothSet(
            tuple(
                CentralMesh(
                    mesh.central.name, mesh.central.teeth, mesh.planet.teeth, mesh.central.is_ring, self.gear_of(mesh)
                )
                for mesh in self.meshes
            )
        )

    # turns ------------------------------------------------------------------------------------------

    def turn(self, shaft: str) -> Fraction:
        """Turns of a shaft a turn of the planets on their pins, both seen from the carrier."""
        return Fraction(0) if shaft == self.carrier else self.teeth.mesh(shaft).turn

    @property
    def ratio(self) -> Fraction:
        """Turns of the input a turn of the output; negative where they turn against each other.

        Raises:
            ZeroDivisionError: the output does not turn.
        """
        return (self.turn(self.input) - self.turn(self.held)) / (self.turn(self.output) - self.turn(self.held))

    @property
    def planet_turns(self) -> Fraction:
        """Turns of a planet on its pin a turn of the output."""
        return 1 / (self.turn(self.output) - self.turn(self.held))

    @cached_property
    def gear_rates(self) -> tuple[Array, float]:
        """Turns of the central gears and of a planet against the carrier, a turn of the output."""
        return np.array([float(mesh.turn * self.planet_turns) for mesh in self.teeth.meshes]), float(self.planet_turns)

    @property
    def period_planet_turns(self) -> int:
        """Turns of a planet on its pin until all teeth meet again as they did."""
        return math.lcm(*(mesh.turn.denominator for mesh in self.teeth.meshes))

    @property
    def period(self) -> Fraction:
        """Turns of the output in that time."""
        return abs(self.period_planet_turns / self.planet_turns)

    # how it is assembled --------------------------------------------------------------------------

    def phase(self, planet: int) -> float:
        """Azimuth of x of a planet's gears, off the line to its pin [rad], where the first planet's lies on it.

        All planets are alike; if that cannot be assembled (see ToothSet.assembly_faults), the nearest one.
        """
        teeth = self.gears[0].teeth
        return min(
            ((self._lag(planet) + 2 * math.pi * tooth) / teeth for tooth in range(teeth)),
            key=lambda phase: (round(self._off(planet, phase), 9), phase),
        )

    @cached_property
    def phases(self) -> Array:
        """The same of all planets (planets,) [rad]."""
        return np.array([self.phase(planet) for planet in range(self.planets)])

    def _lag(self, planet: int) -> float:
        """Value of z times the phase of the first gear that the first mesh requires [rad]."""
        first = next(mesh for mesh in self.meshes if mesh.planet.name == self.gears[0].name)
        return first.sense * first.central.teeth * self.azimuths[planet]

    def _off(self, planet: int, phase: float) -> float:
        """Largest distance from a space, of all meshes, in pitches."""
        pitches = (
            (mesh.planet.teeth * phase - mesh.sense * mesh.central.teeth * self.azimuths[planet]) / (2 * math.pi)
            for mesh in self.meshes
        )
        return max(abs(pitch - round(pitch)) for pitch in pitches)

    # slides along the axis --------------------------------------------------------------------------

    def slide_turns(self, shaft: str) -> Array:
        """Turn of a shaft per shift along the axis of each shaft (shafts,) [rad/mm], the opposite one standing.

        A gear that slides by dz in the teeth of a mate at rest screws by kappa dz; as s r_bC kappa_C = -r_bP kappa_P,
        n changes by s r_bC kappa_C (z_P - z_C), and planets slide with their carrier. All contacts go along, so that
        the free turn grows by that of the whole play, whichever contacts there are.
        """
        centrals = len(self.meshes)
        places = [place for place in self.unknowns(self.opposite(shaft)) if place <= centrals + 1]
        rows = self.all_rows[:centrals]  # of the first planet, whose turn is the last of these unknowns
        screwed = np.array([rows[m, m] * mesh.central.twist for m, mesh in enumerate(self.meshes)])
        shifted = np.column_stack([np.diag(screwed), -screwed])
        turned = np.linalg.solve(rows[:, places], shifted)[places.index(self.shafts.index(shaft))]
        least = SAME_LEAD * max(abs(mesh.central.twist) for mesh in self.meshes)
        return np.where(np.abs(turned) > least, turned, 0.0)

    @cached_property
    def unlike_leads(self) -> tuple[int, ...]:
        """Meshes whose planet's gear has another lead than those of most meshes of a planet.

        A planet that slides turns with the others; in these alone it then opens one flank and closes the other.
        """
        twists = [mesh.planet.twist for mesh in self.meshes]
        alike = [[math.isclose(own, other, rel_tol=SAME_LEAD) for other in twists] for own in twists]
        most = max(alike, key=sum)
        return tuple(m for m, same in enumerate(most) if not same)

    @property
    def planet_twist(self) -> float:
        """Twist of a planet in its other meshes, in which it screws as it slides [rad/mm]."""
        return next(mesh.planet.twist for m, mesh in enumerate(self.meshes) if m not in self.unlike_leads)

    @cached_property
    def planet_slides(self) -> Array:
        """Change of n of each mesh per shift of a planet along its pin (meshes,), as it screws in its other meshes.

        r_bP (kappa_0 - kappa_P), kappa_0 the twist in those. Where one mesh alone changes, the shifts within half of
        the play on either side are as good as more room on both flanks.
        """
        changes = [mesh.planet.base_radius * (self.planet_twist - mesh.planet.twist) for mesh in self.meshes]
        return np.array([own if m in self.unlike_leads else 0.0 for m, own in enumerate(changes)])

    # the programme --------------------------------------------------------------------------------

    def unknowns(self, stands: str) -> tuple[int, ...]:
        """Coordinates that are free while the held shaft and another one stand: of shafts, planets and springs."""
        return tuple(
            place
            for place in range(len(self.shafts) + self.planets + len(self.springs))
            if place >= len(self.shafts) or self.shafts[place] not in (self.held, stands)
        )

    @cached_property
    def senses(self) -> Array:
        """Sense in which each spring pushes each planet (planets, springs)."""
        own = [[spring.sense(planet) for spring in self.springs] for planet in range(self.planets)]
        return np.array(own).reshape(self.planets, len(self.springs))

    @cached_property
    def all_rows(self) -> Array:
        """Change of n of each mesh of each planet by the coordinates (meshes x planets + springs, coordinates).

        n = r_bP (psi - h) + s r_bC (theta - h) [mm], along the line of action; psi, theta and h are the turns of
        planet, central gear and carrier. In the middle of the backlash n = 0; it is held by the two flanks. A spring
        that displaces a planet's pin by its coordinate [mm] is a turn of the carrier for that planet; the last rows are
        the springs' coordinates themselves.
        """
        centrals, pushes = len(self.meshes), len(self.springs)
        rows = np.zeros((centrals * self.planets + pushes, centrals + 1 + self.planets + pushes))
        for planet in range(self.planets):
            for place, mesh in enumerate(self.meshes):
                row = rows[planet * centrals + place]
                own = mesh.sense * mesh.central.base_radius
                row[place] += own
                row[centrals] -= own + mesh.planet.base_radius
                row[centrals + 1 + planet] += mesh.planet.base_radius
                row[centrals + 1 + self.planets :] = row[centrals] / self.centre_distance * self.senses[planet]
        for spring in range(pushes):
            rows[centrals * self.planets + spring, centrals + 1 + self.planets + spring] = 1.0
        return rows

    @property
    def spring_ends(self) -> tuple[Array, Array]:
        """Least and largest coordinate of each spring [mm]: as it is set, or as far as meshes may let it."""
        set_at = [spring.displacement for spring in self.springs]
        least = np.array([-MOST_PUSH if own is None else own for own in set_at])
        return least, np.array([MOST_PUSH if own is None else own for own in set_at])

    def wanted(self, stands: str, shaft: str) -> Array:
        """Objectives that are maximised (2, unknowns) for the smallest turn of a shaft, and for the largest.

        Where springs push, their work and that of a small torque on the shaft: it rests where both is largest. The
        torque is far less than that of a spring (12 N mm a N of force at the output of a 3K set with planets of 12
        mm), and far more than that of the spring's force by eccentric gears.
        """
        first = len(self.shafts) + self.planets
        force = {first + k: 1.0 / (1.0 + WEAKER * k) for k in range(len(self.springs)) if self.springs[k].pushes}
        if self.overcome:
            force = {place: OVERCOME * own for place, own in force.items()}
        push = np.array([force.get(place, 0.0) for place in self.unknowns(stands)])
        torque = SMALL_TORQUE / (abs(float(self.ratio)) if shaft == self.input else 1.0)
        turn = self.objective(stands, shaft) * (torque if force else 1.0)
        return np.stack([push - turn, push + turn])

    def rows(self, stands: str) -> Array:
        """The same for the freedom while the held shaft and another one stand."""
        return np.ascontiguousarray(self.all_rows[:, self.unknowns(stands)])

    def objective(self, stands: str, shaft: str) -> Array:
        """The turn of a shaft among those unknowns."""
        return np.array([float(place == self.shafts.index(shaft)) for place in self.unknowns(stands)])

    def asked(self, stands: str, shaft: str, end: int | slice = slice(None)) -> tuple[Array, Array, Places]:
        """Input of a programme for a shaft's turn: its objective, the quantity maximised at an end, its first basis."""
        wanted = np.ascontiguousarray(self.wanted(stands, shaft)[end])
        return self.objective(stands, shaft), wanted, self.begun(stands)

    @property
    def sense(self) -> float:
        """1 where the output turns counter-clockwise while the input does, else -1."""
        return 1.0 if self.ratio > 0 else -1.0

    def end(self, load: int) -> int:
        """End of its free turn at which the output rests, the lower (0) or the upper one (1), by its load's sense."""
        return int(load * self.sense > 0.0)

    def opposite(self, shaft: str) -> str:
        """Shaft that stands while another one is turned: the input, for the input the output."""
        return self.output if shaft == self.input else self.input

    def begun(self, stands: str) -> Places:
        """Rows of the first basis (unknowns,) of the programme; fewer where something is not held."""
        return first_basis(self.rows(stands))
