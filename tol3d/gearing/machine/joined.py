"""Gears and an assembly in one world: whose columns are whose, and how bores and joints follow from deviations."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model.statuses import OK
from tol3d.assembly.moments import widely
from tol3d.assembly.placing import method as placing
from tol3d.assembly.system import AssemblySystem
from tol3d.assembly.torsors import method as torsors
from tol3d.assembly.torsors.first_order import Slopes
from tol3d.gearing.machine.bores import Bores
from tol3d.gearing.machine.open_chains import JointDrive
from tol3d.gearing.methods.analytic import analytic_values
from tol3d.gearing.model import Contributor as GearContributor
from tol3d.gearing.model.measure import Measure as GearMeasure
from tol3d.gearing.system import GearSystem
from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import KnownRows, kept
from tol3d.scene import Scene
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.measure import Measure
from tol3d.study.system.stated import component_slices, mean_deviations, stated
from tol3d.study.system.trials import Trials

Bools = NDArray[np.bool_]

HIDDEN: Final = "."
"""First character of names of contributors and measures that no scene has."""

NOTHING: Final = 1e-12
"""Displacement [mm] of an axis per mm, rad or K that is rounding."""

FLAT: Final = 1e-6
"""Displacement per deviation of one that raises it to both sides."""

TURN: Final = 1e-2
"""rad; a measure that it does not change depends on no joint that turns by it."""

MOST_BUILDS: Final = 200_000
"""Builds of a joint's train whose turns are kept."""
OTHERS: Final = (0.0, 1.0, 2.0, 3.0)
"""Builds in which that is tried: with the other joints in the middle of their plays, then each turned by its own angle.

Rotations add up to second order in an order: two joints about y and z turn a part about x, neither of them alone."""

STEP: Final = 1e-4
"""mm; over which the analytic method's slopes by displacements of bores are taken, to both sides."""


def is_hidden(own: Contributor | Measure) -> bool:
    """True if a contributor or measure only links gears and assembly: it is neither drawn nor read."""
    return own.name.startswith(HIDDEN)


@dataclass(frozen=True, eq=False)
class Joined:
    """Gears in a housing.

    Args:
        name: of the scene.
        contributors: of gears and of the assembly, in the scene's order.
        measures: likewise.
        gears: whose last contributors are the displacements of the bores: two a shaft, x and y each, not drawn.
        poses: the assembly as the scene has it, by pose with the measures that are read there; the pose is "" where its
            moves have none.
        bores: that of the first pose with the measures of its bores.
        worlds: by the first shaft of each train in bores, where its world lies in that of the parts (4, 4).
        off_shafts: warnings of bores beyond the ends of their shafts.
        drives: joints that trains turn.
        up: unit vector to the top of a picture, against gravity if there is some.
        parts: the scene of the assembly alone, from which it is made in other poses.
        alone: the pose in which parts alone are shown; "" for all that there is.
    """

    name: str
    contributors: tuple[Any, ...]
    measures: tuple[Any, ...]
    gears: GearSystem
    poses: Mapping[str, AssemblySystem]
    bores: Bores
    worlds: Mapping[str, Array]
    off_shafts: tuple[str, ...] = ()
    drives: tuple[JointDrive, ...] = ()
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    parts: Scene | None = None
    alone: str = ""

    @property
    def drawn(self) -> AssemblySystem:
        """The assembly in its first pose."""
        return next(iter(self.poses.values()))

    @cached_property
    def pose_of(self) -> Mapping[str, str]:
        """The pose in which each measure of the assembly is read, by name."""
        return {measure.name: pose for pose, system in self.poses.items() for measure in system.measures}

    @cached_property
    def assembly(self) -> AssemblySystem:
        """The assembly's system, with the measures of the bores."""
        return replace(self.drawn, assembly=self.bores.assembly)

    def joints_of(self, name: str) -> tuple[JointDrive, ...]:
        """The drives on whose joints a measure of the assembly depends."""
        reaches = self.reaches_of(name)
        return tuple(drive for drive in self.drives if drive.joint in reaches)

    @kept
    def reaches_of(self, name: str) -> Mapping[str, float]:
        """Movement of a measure per turn of each joint on which it depends, alone or with others, in some build."""
        return dict(self._reaches(name)) if self.drives else {}

    @kept
    def known_turns(self, method: str, reading: str) -> KnownRows[float]:
        """Turns of joints by the builds of their trains, as a method reads them."""
        return KnownRows(MOST_BUILDS)

    def _reaches(self, name: str) -> Iterator[tuple[str, float]]:
        own = self.poses[self.pose_of[name]]
        slices = component_slices(self.drawn)
        turns = [slices[drive.turn].start for drive in self.drives]
        if own.assembly.measures[name].kind == "clearance":  # whose solids are not read here
            yield from ((drive.joint, 0.0) for drive in self.drives)
            return
        builds = widely(own.contributors)[: len(OTHERS)].copy()
        others = np.sin(
            np.outer(OTHERS, np.arange(1.0, 1 + len(turns)))
        )  # no two alike, none of them 0 but in the first
        builds[:, turns] += TURN * others
        rows = np.repeat(builds[:, None], 1 + len(turns), axis=1)
        rows[:, np.arange(1, 1 + len(turns)), turns] += TURN
        read, status = placing.values(own.assembly, rows.reshape(-1, rows.shape[2]), [name])[name]
        values, is_ok = read.reshape(rows.shape[:2]), (status == OK).reshape(rows.shape[:2])
        moved = np.where(is_ok[:, 1:] & is_ok[:, :1], np.abs(values[:, 1:] - values[:, :1]), np.nan)
        for drive, its in zip(self.drives, moved.T, strict=True):
            known = its[np.isfinite(its)]
            if not len(known):
                yield drive.joint, 0.0
            elif known.max() >= NOTHING:
                yield drive.joint, float(known[known >= NOTHING][0]) / TURN

    def lever_of(self, name: str, drive: JointDrive) -> float:
        """Nominal change of a measure of the assembly per turn of a joint, to first order [mm/rad]."""
        own = self.poses[self.pose_of[name]].assembly
        rows = np.zeros((2, own.width))
        rows[1, component_slices(self.drawn)[drive.turn].start] = TURN
        start, turned = torsors.values(own, rows, [name])[name]
        return float(abs(turned - start)) / TURN

    @property
    def drawn_by_gears(self) -> tuple[GearContributor, ...]:
        """The contributors of the gears but the displacements of the bores."""
        return self.gears.contributors[: len(self.gears.contributors) - 2 * len(self.bores.shafts)]

    @cached_property
    def gear_places(self) -> NDArray[np.intp]:
        """Indices of the columns of the gears' own contributors."""
        return self._places(self.drawn_by_gears)

    @cached_property
    def _drawn_by_assembly(self) -> Sequence[Contributor]:
        """The assembly's contributors that are drawn: not those that only link it and the gears."""
        own = {contributor.name for contributor in self.contributors}
        return [contributor for contributor in self.drawn.contributors if contributor.name in own]

    @cached_property
    def assembly_places(self) -> NDArray[np.intp]:
        """Indices of the columns of the assembly's contributors, of those that are drawn."""
        return self._places(self._drawn_by_assembly)

    @cached_property
    def _drawn_columns(self) -> NDArray[np.intp]:
        """Columns of the assembly that are drawn."""
        slices = component_slices(self.drawn)
        ranges = [np.arange(*slices[contributor.name].indices(1 << 30)) for contributor in self._drawn_by_assembly]
        return np.concatenate([*ranges, np.zeros(0)]).astype(np.intp)

    def of_assembly(self, deviations: Array) -> Array:
        """Deviations (trials, columns) as the assembly has them; 0 for those not drawn."""
        own = np.asarray(deviations[:, self.assembly_places])
        if len(self._drawn_columns) == self.drawn.assembly.width:
            return own
        found = np.zeros((len(own), self.drawn.assembly.width))
        found[:, self._drawn_columns] = own
        return found

    def _places(self, contributors: Sequence[Contributor]) -> NDArray[np.intp]:
        slices = component_slices(self)
        ranges = [
            np.arange(slices[contributor.name].start, slices[contributor.name].stop) for contributor in contributors
        ]
        return np.concatenate([*ranges, np.zeros(0)]).astype(np.intp)

    def gear_trials(self, trials: Trials, displaced: Array) -> Trials:
        """Trials as the gears see them, the bores displaced (trials, shafts * 4) [mm]."""
        own = trials.deviations[:, self.gear_places]
        return replace(trials, deviations=np.concatenate([own, displaced], axis=1) if displaced.size else own)

    def linear_gear_trials(self, trials: Trials) -> Trials:
        """The same, the bores displaced to first order."""
        names = self.bores.lateral_names
        read = torsors.values(self.bores.assembly, self.of_assembly(trials.deviations), names)
        return self.gear_trials(trials, self.bores.to_first_order(read))

    @cached_property
    def _slopes(self) -> Sequence[Slopes]:
        """Slopes of the displacements of the bores, in their order."""
        return [self.assembly.slopes_of(name) for name in self.bores.lateral_names]

    @cached_property
    def displacing(self) -> Array:
        """Displacements of the bores per deviation of the assembly's contributors, (shafts * 4, columns)."""
        found = np.zeros((len(self._slopes), self.bores.assembly.width))
        for row, own in zip(found, self._slopes, strict=True):
            row[:] = own.coefficients
        return np.where(np.abs(found) < NOTHING, 0.0, found)

    @cached_property
    def bending(self) -> Bools:
        """True where a displacement depends on a deviation otherwise than by a slope, (shafts * 4, columns)."""
        found = np.zeros(self.displacing.shape, dtype=bool)
        for row, own in zip(found, self._slopes, strict=True):
            row[list(own.bent)] = True
        return found

    def bends(self, measure: GearMeasure) -> bool:
        """True if a backlash depends on displacements of bores that are no sum of effects."""
        return bool(self.bending[self.reading(measure)].any())

    @kept
    def reading(self, measure: GearMeasure) -> Bools:
        """True for displacements of the bores that a backlash depends on (shafts * 4,)."""
        own = {each.name for each in self.gears.acting(measure)}
        return np.array([displacement.name in own for displacement in self.displacements for _ in "xy"], dtype=bool)

    @cached_property
    def link_shafts(self) -> Mapping[str, frozenset[str]]:
        """Shafts whose bores move a link's parts, by link."""
        shaft_of = {own.name: self.bores.shafts[k // 2].shaft for k, own in enumerate(self.displacements)}
        links = self.gears.model.links
        return {link.name: frozenset(shaft_of[own.contributor] for own in link.moved) for link in links}

    @property
    def displacements(self) -> tuple[GearContributor, ...]:
        """The displacements of the bores, as the gears have them."""
        return self.gears.contributors[len(self.drawn_by_gears) :]

    @property
    def squared(self) -> Bools:
        """Deviations (columns,) that displace some bore to both sides of their mean alike."""
        return np.asarray((self.bending & (np.abs(self.displacing) < FLAT)).any(axis=0))

    def moving_apart(self, mesh: str) -> Iterator[str]:
        """Contributors but temperatures that change the distance or the parallelism of the axes of a mesh."""
        layout, own = self.gears.model.layout, self.gears.model.mesh(mesh)
        driver = self._housed.get(layout.carrying[own.driver][0])
        if driver is None:
            return
        z = driver.frame[:3, 2]
        lines = [self._line(layout.carrying[gear][0], z) for gear in (own.driver, own.driven)]
        if lines[0] is None or lines[1] is None:
            return
        (place, low, tilt), (other, low_other, tilt_other) = lines
        apart = other - place
        apart = (apart - z * (apart @ z)) / np.linalg.norm(apart - z * (apart @ z))
        # both at the height of the first point of the driver's axis
        shifted = low_other + tilt_other * ((place - other) @ z)
        changes = np.vstack([apart @ (shifted - low), tilt_other - tilt])
        slices = component_slices(self.drawn)
        for contributor in self.drawn.contributors:
            place = slices[contributor.name]
            moves = (np.abs(changes[:, place]) > NOTHING).any() or self.bending[:, place].any()
            if moves and contributor.kind != "temperature":
                yield contributor.name

    @cached_property
    def _housed(self) -> Mapping[str, Any]:
        return {shaft.shaft: shaft for shaft in self.bores.shafts}

    def _line(self, shaft: str, axis: Array) -> Any:
        """First point of a shaft's line (3,), its displacement, and that per mm along an axis (3, columns)."""
        names = [own.shaft for own in self.bores.shafts]
        if shaft not in names:
            return None
        own, start = self._housed[shaft], 4 * names.index(shaft)
        low, high = (own.frame[:3, :2] @ self.displacing[start + 2 * k : start + 2 * k + 2] for k in range(2))
        length = float((own.bores[1].place - own.bores[0].place) @ axis)
        return own.bores[0].place, low, (high - low) / length

    def bore_slopes(self, measure: GearMeasure) -> Array:
        """Change of a backlash by theory per displacement of the bores (shafts * 4,), at the means."""
        system = self.gears
        middle = mean_deviations(system, measure.positions)
        count = 4 * len(self.bores.shafts)
        steps = np.zeros((count, middle.shape[1]))
        steps[:, middle.shape[1] - count :] = STEP * np.eye(count)
        trials = stated(system, np.concatenate([middle + steps, middle - steps]))
        values = analytic_values(system.model, measure, trials)[:, 0]
        return np.asarray((values[:count] - values[count:]) / (2 * STEP))
