"""A set at one centre distance: profile shifts without backlash in any mesh, and the margins of its teeth."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from tol3d.apps.design.working_mesh import BasicRack, WorkingMesh, mesh_efficiency, shift_sum
from tol3d.errors import GeometryError
from tol3d.gearing.planetary import Sharing, ToothSet
from tol3d.gears import RACK_ADDENDUM, InternalGear, InternalPair, SpurGear, SpurPair


def tip_gap(centre_distance: float, planets: int, largest_tip_radius: float) -> float:
    """Free distance [mm] between the tip circles of neighbouring planets: 2 a sin(pi/n) - d_a; negative: they overlap.

    Args:
        centre_distance: a [mm].
        planets: n; one alone has no neighbour.
        largest_tip_radius: d_a/2 of the planet's larger step [mm].

    >>> round(tip_gap(26.0, 4, 14.5), 4)
    7.7696
    """
    if planets < 2:
        return math.inf
    return 2 * centre_distance * math.sin(math.pi / planets) - 2 * largest_tip_radius


APART = 1e-3  # modules; a micrometre of a module of 1 mm, so that nothing touches by rounding alone
PLANET_GAP = "gap between the tips of neighbouring planets"
NO_CONTACT = 1.0  # rad; a margin that stands for tips whose circles do not cross


@dataclass(frozen=True)
class Limits:
    """Limits on the teeth of a set.

    Args:
        tip_thickness: least arc at each tip circle [modules].
        contact_ratio: least one of each mesh.
        tip_clearance: least distance of each tip from its mate's root [modules].
        planet_gap: least distance between the tips of neighbouring planets [mm].
        shift: largest profile shift of any gear, either way [modules].
    """

    tip_thickness: float = 0.2
    contact_ratio: float = 1.2
    tip_clearance: float = 0.15
    planet_gap: float = 0.5
    shift: float = 1.0


class Margin(NamedTuple):
    """A limited quantity: its name, its value, the least allowed, its unit."""

    what: str
    value: float
    least: float
    unit: str

    @property
    def kept(self) -> float:
        """Margin, negative if the limit is not kept."""
        return self.value - self.least

    @property
    def words(self) -> str:
        """Limit in words, with its numbers."""
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.what}: {self.value:.4g}{unit}, at least {self.least:.4g}{unit} needed"


@dataclass(frozen=True)
class ShiftedSet:
    """Tooth numbers, their rack, one centre distance, and the division of its shift sums.

    Args:
        centre_distance: a [mm].
        planet_shifts: x of each step of the planets; central gears take the rest of their mesh's sum.
    """

    teeth: ToothSet
    rack: BasicRack
    centre_distance: float
    planet_shifts: tuple[float, ...]

    @cached_property
    def meshes(self) -> tuple[WorkingMesh, ...]:
        """Meshes in the order of the set.

        Raises:
            GeometryError: a mesh does not reach the centre distance.
        """
        return tuple(
            WorkingMesh(
                mesh,
                self.rack,
                self.centre_distance,
                shift_sum(mesh, self.rack, self.centre_distance) - self.planet_shifts[mesh.step],
                self.planet_shifts[mesh.step],
            )
            for mesh in self.teeth.meshes
        )

    @property
    def shifts(self) -> Mapping[str, float]:
        """x of each gear: central gears by their names, then the planets' steps."""
        central = {mesh.mesh.central: mesh.central_shift for mesh in self.meshes}
        return central | {step_name(self.teeth, k): shift for k, shift in enumerate(self.planet_shifts)}

    def mesh_efficiencies(self, friction: float, sharing: Sharing = "formula") -> Mapping[str, float]:
        """Efficiency of each mesh, by its central gear."""
        return {mesh.mesh.central: mesh_efficiency(mesh, friction, sharing) for mesh in self.meshes}

    def planet_gap(self, planets: int) -> float:
        """Between the tips of neighbouring planets [mm]."""
        largest = max(own.tip_radii[1] for own in self.meshes)
        return tip_gap(self.centre_distance, planets, largest)

    def margins(self, limits: Limits, planets: int) -> tuple[Margin, ...]:
        """All that limits hold, lengths of teeth in modules."""
        gap = min(self.planet_gap(planets), 2 * self.centre_distance)
        between = Margin(PLANET_GAP, gap, limits.planet_gap, "mm")
        return (*self._shift_margins(limits), *self._undercut_margins(), *self._mesh_margins(limits), between)

    def _shift_margins(self, limits: Limits) -> Iterator[Margin]:
        for name, shift in self.shifts.items():
            yield Margin(
                f"{limits.shift:g} modules less the profile shift of {name}", limits.shift - abs(shift), 0.0, "modules"
            )

    def _undercut_margins(self) -> Iterator[Margin]:
        shifts = self.shifts
        teeth = {mesh.central: mesh.teeth for mesh in self.teeth.meshes if not mesh.internal}
        teeth |= {step_name(self.teeth, k): count for k, count in enumerate(self.teeth.steps)}
        for name, count in teeth.items():
            least = least_shift(count, self.rack)
            yield Margin(f"profile shift of {name}, for no undercut", shifts[name], least, "")

    def _mesh_margins(self, limits: Limits) -> Iterator[Margin]:
        m = self.rack.module
        for mesh in self.meshes:
            name, planet = mesh.mesh.central, step_name(self.teeth, mesh.mesh.step)
            for gear, mate, thick, clear, involute in zip(
                (name, planet),
                (planet, name),
                mesh.tip_thicknesses,
                mesh.tip_clearances,
                mesh.involute_margins,
                strict=True,
            ):
                yield Margin(f"tip thickness of {gear}", thick / m, limits.tip_thickness, "modules")
                yield Margin(f"clearance of the tip of {gear} in {mate}", clear / m, limits.tip_clearance, "modules")
                yield Margin(
                    f"contact of {gear} with {mate} off its fillet, along the path", involute / m, APART, "modules"
                )
            yield Margin(f"contact ratio of {name} and {planet}", mesh.contact_ratio, limits.contact_ratio, "")
            if mesh.mesh.internal:
                apart = min(mesh.tip_interference_margin, NO_CONTACT) * mesh.mesh.teeth / 2
                yield Margin(f"tips of {planet} past those of {name}, as they leave", apart, APART, "modules")

    def worst(self, limits: Limits, planets: int) -> Margin:
        """The margin kept least."""
        return min(self.margins(limits, planets), key=lambda own: own.kept)


def least_shift(teeth: int, rack: BasicRack) -> float:
    """x without undercut [modules]: 1 - z sin^2(alpha)/2 of teeth on the outside."""
    return RACK_ADDENDUM - teeth * math.sin(rack.pressure_angle) ** 2 / 2


def step_name(teeth: ToothSet, step: int) -> str:
    """Name of a step of the planets: "planet", or "planet 1" and "planet 2"."""
    return "planet" if len(teeth.steps) == 1 else f"planet {step + 1}"


FACE_WIDTH = 10.0  # modules; it decides nothing here


def made_pair(working_mesh: WorkingMesh) -> SpurPair | InternalPair:
    """The gears of a mesh at its centre distance: the sun drives its planet, a planet its ring.

    Raises:
        GeometryError: a gear cannot be made.
    """
    rack, mesh = working_mesh.rack, working_mesh.mesh
    common = (rack.module, rack.pressure_angle, FACE_WIDTH * rack.module)
    factors: Mapping[str, Any] = {"addendum": rack.addendum, "dedendum": rack.dedendum}
    planet = SpurGear(mesh.planet_teeth, *common, profile_shift=working_mesh.planet_shift, **factors)
    if mesh.internal:
        ring = InternalGear(mesh.teeth, *common, profile_shift=working_mesh.central_shift, **factors)
        return InternalPair(planet, ring, working_mesh.centre_distance)
    sun = SpurGear(mesh.teeth, *common, profile_shift=working_mesh.central_shift, **factors)
    return SpurPair(sun, planet, working_mesh.centre_distance)


def refuse_interference(shifted_set: ShiftedSet) -> None:
    """Raise unless all its gears can be made and run together.

    Raises:
        GeometryError: with the mesh, the radii and the remedy.
    """
    for mesh in shifted_set.meshes:
        try:
            made_pair(mesh).refuse_interference()
        except GeometryError as error:
            raise GeometryError(f"mesh of {mesh.mesh.central}: {error}") from error
