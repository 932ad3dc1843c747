"""A machine as a study sees it: the gears' system and the assembly's, joined at bores and at joints."""

import math
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.clearances.prepared import reader_of
from tol3d.assembly.posed import has_loops
from tol3d.assembly.system import AssemblySystem, ClearanceSystem, assembly_system
from tol3d.assembly.zones import laws_told
from tol3d.gearing.machine.closed_form import closed_form, with_joints
from tol3d.gearing.machine.grammar.open_chain import OpenChainSpec, turn_name
from tol3d.gearing.machine.joined import Joined, is_hidden
from tol3d.gearing.machine.methods import MachineMethod, WorstMeasure
from tol3d.gearing.machine.open_chains import HALF, JointDrive, loaded_sides, reading_at, with_inputs
from tol3d.gearing.machine.regressors import parts_by_links, regress_bores, with_displacements
from tol3d.gearing.machine.statuses import STATUSES, WITH_CLEARANCES, WITH_LOOPS
from tol3d.gearing.model.measure import Measure as GearMeasure
from tol3d.gearing.summary.backlash_stages import CENTRE_DISTANCE, OPERATING, Staged, limits_of_meshes
from tol3d.gearing.summary.types import BacklashLimits
from tol3d.gearing.system import EXACT, METHODS, GearSystem
from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import kept
from tol3d.study.system.breakdown import Breakdown
from tol3d.study.system.closed_form import ClosedForm
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import INDEPENDENT, Copula
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import ANALYTIC_METHOD, Codes, Method, MethodKind
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.pooled import PooledTerms
from tol3d.study.system.posable import AS_SET, Coordinate
from tol3d.study.system.positions import Positions
from tol3d.study.system.stated import component_slices
from tol3d.study.system.system import Columns, KeyPath, Published, StreamKey
from tol3d.study.system.trials import Trials
from tol3d.study.trials.simulation import Simulation

HALF_TURN: Final = 180.0  # deg


def _inputs(spec: OpenChainSpec, joint: str) -> Mapping[str, float]:
    """Inputs of a joint by pose [deg]."""
    return {pose: math.degrees(own[joint].internal) for pose, own in spec.poses.items()}


def _joined(every: Sequence[Mapping[str, Array]]) -> Sequence[str]:
    return list(dict.fromkeys(words for own in every for words in own))


def no_closed_form(simulation: Simulation, measure: Measure) -> None:
    """None: of axes that lean draws are known sooner than integrals over the laws of all bores."""
    return


@dataclass(frozen=True, eq=False)
class MachineSystem(Joined):
    """Implements System."""

    # what it is -------------------------------------------------------------------------------------

    @property
    def _is_clearing(self) -> bool:
        """True if clearances of whole parts are asked."""
        return any(isinstance(system, ClearanceSystem) for system in self.poses.values())

    @property
    def statuses(self) -> Statuses:
        """See System."""
        if has_loops(self.drawn.assembly):
            return WITH_LOOPS
        return WITH_CLEARANCES if self._is_clearing else STATUSES

    @property
    def methods(self) -> Mapping[str, MethodKind]:
        """See System: those of the gears, one process each where solids are read."""
        return {**METHODS, EXACT: replace(METHODS[EXACT], threads=False)} if self._is_clearing else METHODS

    @property
    def breakdowns(self) -> Sequence[Breakdown]:
        """See System."""
        return self.gears.breakdowns

    @property
    def warnings(self) -> tuple[str, ...]:
        """See System."""
        return (*self.off_shafts, *self.gears.warnings, *self.drawn.warnings)

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        """See System."""
        for system in self.poses.values():
            yield from system.problems()
        yield from self.gears.problems()

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        """See System: for gears, also the laws of the bores in their zones."""
        if isinstance(measure, WorstMeasure):
            return {
                "kind": measure.kind,
                "of": list(self._worst_of(measure)),
                "poses": [own for own, _ in measure.sizes],
            }
        found = self._owner(measure).describe(measure)
        if not isinstance(measure, GearMeasure):
            return {**found, **({"pose": pose} if (pose := self.pose_of[measure.name]) else {})}
        slices = component_slices(self.drawn)
        moving = (
            contributor for contributor in self.drawn.contributors if self.displacing[:, slices[contributor.name]].any()
        )
        return {**found, **laws_told(moving)}

    def _owner(self, measure: Measure) -> GearSystem | AssemblySystem:
        return self.gears if isinstance(measure, GearMeasure) else self.poses[self.pose_of[measure.name]]

    def _worst_of(self, measure: WorstMeasure) -> tuple[str, ...]:
        pose, name = measure.sizes[0]
        return self.poses[pose].named[name]

    # its trials -------------------------------------------------------------------------------------

    @property
    def streams(self) -> tuple[StreamKey, ...]:
        """See System."""
        return self.gears.streams

    def positions(self, uniforms: Mapping[StreamKey, Array]) -> Mapping[str, Array]:
        """See System: those of the gears."""
        return self.gears.positions(uniforms)

    def columns(self, trials: Trials) -> Mapping[str, NDArray[np.generic]]:
        """See System."""
        return self.gears.columns(trials)

    def turns_at_random(self, contributor: Contributor, positions: Positions) -> bool:
        """See System."""
        return contributor.name in self._of_gears and self.gears.turns_at_random(contributor, positions)

    @cached_property
    def _of_gears(self) -> frozenset[str]:
        """Contributors that act on gears themselves."""
        return frozenset(drawn_by_gear.name for drawn_by_gear in self.drawn_by_gears)

    def seen_by_gears(self, trials: Trials) -> tuple[Trials, Mapping[str, Codes]]:
        """Trials as the gears see them, on the axes that placed bores give; and their statuses (trials,)."""
        return MachineMethod(self, self.gears.method(ANALYTIC_METHOD, {}), exact=True).gear_trials(trials)

    def in_pose(self, trials: Trials, pose: str) -> Array:
        """Deviations (trials, columns) of the assembly as the exact method has them in a pose, its joints turned."""
        return MachineMethod(self, self.gears.method(EXACT, {}), exact=True).in_pose(trials, pose)

    # other poses ------------------------------------------------------------------------------------

    @property
    def _chains(self) -> Mapping[str, OpenChainSpec]:
        return self.parts.of(OpenChainSpec) if self.parts is not None else {}

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """See Posable: the inputs of joints, which go half a turn to either side."""
        return tuple(
            Coordinate(joint, -HALF_TURN, HALF_TURN, "deg", _inputs(spec, joint))
            for spec in self._chains.values()
            for joint in spec.joints
        )

    @property
    def turns(self) -> Mapping[str, int]:
        """Columns of the turns of joints beyond their inputs, by joint, of the assembly's deviations."""
        slices, chains = component_slices(self.drawn), self._chains
        return {own: slices[turn_name(name, own)].start for name, spec in chains.items() for own in spec.joints}

    @property
    def arm_poses(self) -> tuple[str, ...]:
        """Poses of its chains."""
        return tuple(dict.fromkeys(pose for spec in self._chains.values() for pose in spec.poses))

    def inputs_in(self, pose: str) -> Sequence[float]:
        """Inputs of all joints in a pose [rad], in the order of `turns`; a chain that lacks it stands in its first."""
        found = list[float]()
        for spec in self._chains.values():
            its = spec.poses.get(pose, next(iter(spec.poses.values())))
            found += [its[joint].internal for joint in spec.joints]
        return found

    def standing(self, values: Mapping[str, float], measures: Sequence[str]) -> "MachineSystem":
        """See Posable: trains turn the joints by their play where these stand; only parts are measured."""
        assert self.parts is not None
        first = next(iter(self.poses))
        parts, drawn = with_inputs(self.parts, values), component_slices(self.drawn)
        posed = assembly_system(parts, AS_SET)
        drives = []
        for own in self.drives:
            spec = next(spec for spec in parts.of(OpenChainSpec).values() if own.joint in spec.joints)
            train = spec.joints[own.joint].train
            assert train is not None
            angle = spec.poses[AS_SET][own.joint].internal
            reading = reading_at(self.gears.model, train, own.joint, angle)
            side = loaded_sides(parts, spec, AS_SET)[own.joint] or (0 if own.flank in drawn else 1)
            drives.append(replace(own, readings={**own.readings, AS_SET: reading}, sides={**own.sides, AS_SET: side}))
        read = tuple(
            replace(measure, sizes=((AS_SET, measure.sizes[0][1]),)) if isinstance(measure, WorstMeasure) else measure
            for measure in self.measures
            if measure.name in measures
        )
        poses = {first: replace(self.drawn, measures=()), AS_SET: posed}
        return replace(self, poses=poses, drives=tuple(drives), measures=read, alone=AS_SET)

    def shown_in(self, pose: str) -> "MachineSystem":
        """See Posable: without the gears, whose teeth would have to be seated."""
        return replace(self, alone=pose) if pose in self.poses else self

    @property
    def shown_poses(self) -> Mapping[str, AssemblySystem]:
        """The poses in which its parts are shown."""
        return {self.alone: self.poses[self.alone]} if self.alone else self.poses

    # its methods --------------------------------------------------------------------------------------

    def is_compiled(self, method: str) -> bool:
        """See System."""
        return self.gears.is_compiled(method)

    def materials(self, method: str) -> Any:
        """See System."""
        own = self.gears.materials(method)
        if not self._is_clearing or method == ANALYTIC_METHOD:
            return own
        return own, {pose: system.materials(method) for pose, system in self.poses.items()}

    def method(self, name: str, materials: Any) -> Method:
        """See System: each system's own, that of gears by the assembly's results for the bores."""
        exact = name != ANALYTIC_METHOD
        if not self._is_clearing or not exact:
            return MachineMethod(self, self.gears.method(name, materials), exact)
        own, solids = materials
        gears = self.gears.method(name, own)
        if name == EXACT:
            return MachineMethod(self, gears, exact, {pose: reader_of(pairs) for pose, pairs in solids.items()})
        chords = {
            name: given[name].chord_error + pair.chord_error
            for given, finer in solids.values()
            for name, pair in finer.items()
        }
        readers = {pose: reader_of(finer) for pose, (_, finer) in solids.items()}
        return MachineMethod(self, gears, exact, readers, chords)

    def cost(self, measures: Sequence[Measure]) -> int:
        """See System."""
        own = [measure for measure in measures if isinstance(measure, GearMeasure)]
        read = {name: reading for measure in measures for name, reading in self._readings(measure).items()}
        gears = [*own, *read.values()]
        placed = sum(
            len(measure.sizes) * (2 ** len(self.drives) if measure.any_flank else 1)
            for measure in measures
            if isinstance(measure, WorstMeasure)
        )
        return (self.gears.cost(gears) if gears else 0) + placed + len(measures) - len(own)

    def _readings(self, measure: Measure) -> Mapping[str, GearMeasure]:
        """The lost motions of trains on which a measure of the assembly depends, by name."""
        return {drive.readings[pose].name: drive.readings[pose] for drive, pose in self._turning(measure)}

    def _turning(self, measure: Measure) -> Sequence[tuple[JointDrive, str]]:
        """The drives on which a measure depends, each in a pose in which it is read."""
        if isinstance(measure, GearMeasure):
            return ()
        names = [name for _, name in measure.sizes] if isinstance(measure, WorstMeasure) else [measure.name]
        return [(drive, self.pose_of[name]) for name in names for drive in self.joints_of(name)]

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """See System."""
        if isinstance(measure, GearMeasure):
            return self.gears.chord_bound(measure, chord_error)
        if isinstance(measure, WorstMeasure):
            return max(self.chord_bound(size, chord_error) for size in self._sizes(measure))
        by_joints = sum(
            HALF
            * self.lever_of(measure.name, drive)
            * self.gears.chord_bound(reading, chord_error)
            / reading.per_internal
            for drive, pose in self._turning(measure)
            for reading in [drive.readings[pose]]
        )
        return self._owner(measure).chord_bound(measure, chord_error) + by_joints * measure.per_internal

    # what acts on a measure -------------------------------------------------------------------------

    @kept
    def acting(self, measure: Measure) -> Sequence[Contributor]:
        """See System: for a backlash also what moves its shafts' bores; for a part also what turns its joints."""
        if isinstance(measure, WorstMeasure):
            names = {own.name for size in self._sizes(measure) for own in self.acting(size)}
        elif not isinstance(measure, GearMeasure):
            names = {own.name for own in self._owner(measure).acting(measure)} | set(self._behind_joints(measure))
        else:
            own = {each.name for each in self.gears.acting(measure)}
            rows = self.reading(measure)
            acts = np.asarray(np.concatenate([self.displacing[rows] != 0.0, self.bending[rows]]).any(axis=0))
            slices = component_slices(self.drawn)
            names = own | {
                contributor.name for contributor in self.drawn.contributors if np.any(acts[slices[contributor.name]])
            }
        return [contributor for contributor in self.contributors if contributor.name in names]

    def _sizes(self, measure: WorstMeasure) -> Sequence[Measure]:
        """The measures of the assembly of which it is the largest."""
        return [next(own for own in self.poses[pose].measures if own.name == name) for pose, name in measure.sizes]

    @kept
    def _behind_joints(self, measure: Measure) -> Mapping[str, GearMeasure | None]:
        """Contributors of trains that turn a part, each with the lost motion by which it does, and flanks with none."""
        slopes = self._owner_of_part(measure).slopes_of(measure.name)
        slices, found = component_slices(self.drawn), dict[str, GearMeasure | None]()
        for drive, pose in self._turning(measure):
            column = slices[drive.turn].start
            if not slopes.coefficients[column] and column not in slopes.bent:
                continue
            if not drive.sides[pose]:
                found.setdefault(drive.flank, None)
            for own in self.acting(drive.readings[pose]):
                found.setdefault(own.name, drive.readings[pose])
        return found

    def _owner_of_part(self, measure: Measure) -> AssemblySystem:
        return self.poses[self.pose_of[measure.name]]

    def regressor_key(self, measure: Measure) -> Hashable:
        """See System."""
        if isinstance(measure, WorstMeasure):
            return measure.name
        own = self._owner(measure).regressor_key(measure)
        return (own, self.pose_of[measure.name]) if self._turning(measure) else own

    def regress(
        self, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
    ) -> None:
        """See System."""
        if isinstance(measure, WorstMeasure):
            waiting = {contributor.name: contributor for contributor in contributors}
            for size in self._sizes(measure):  # as in the first pose in which they act
                its = [waiting.pop(own.name) for own in self.acting(size) if own.name in waiting]
                self._regress_part(size, its, columns, rows)
            return
        if not isinstance(measure, GearMeasure):
            self._regress_part(measure, contributors, columns, rows)
            return
        seen = with_displacements(self, measure, columns)
        self.gears.regress(
            measure, [contributor for contributor in contributors if contributor.name in self._of_gears], seen, rows
        )
        others = [contributor for contributor in contributors if contributor.name not in self._of_gears]
        slices = component_slices(self.drawn)
        squared = {other.name: self.squared[slices[other.name]] for other in others}
        regress_bores(others, columns, rows, squared, lambda: self._bore_slopes(measure, others))
        for name, part in parts_by_links(self, measure, others, seen).items():
            rows[name][...] = 0.0
            rows[name][0] = part

    def _regress_part(
        self, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
    ) -> None:
        """Regress the effect of trains on a part as is done for the lost motion that causes it."""
        known = {contributor.name: contributor for contributor in self.drawn.contributors if not is_hidden(contributor)}
        behind = {name: by for name, by in self._behind_joints(measure).items() if by is not None}
        its = [
            known[contributor.name]
            for contributor in contributors
            if contributor.name in known and contributor.name not in behind
        ]
        self._owner_of_part(measure).regress(measure, its, columns, rows)
        for reading in {by.name: by for by in behind.values()}.values():
            own = [
                contributor
                for contributor in contributors
                if (by := behind.get(contributor.name)) and by.name == reading.name
            ]
            self.regress(reading, own, columns, rows)

    def _bore_slopes(self, measure: GearMeasure, contributors: Sequence[Contributor]) -> Mapping[str, Array]:
        """Change of a backlash by each component of contributors that move bores."""
        per_column = self.bore_slopes(measure) @ self.displacing
        slices = component_slices(self.drawn)
        return {contributor.name: per_column[slices[contributor.name]] for contributor in contributors}

    def closed_form(self, measure: Measure) -> ClosedForm | None:
        """See System."""
        if not isinstance(measure, GearMeasure):
            return self._form_of_part(measure)
        return self._form(measure, at_one_position=False)

    def _form_of_part(self, measure: Measure) -> ClosedForm | None:
        """None of a largest one, and where the play of a train has none itself, or lies on either side."""
        if isinstance(measure, WorstMeasure):
            return None
        own = self._owner_of_part(measure)
        form = own.closed_form(measure)
        turning = self._turning(measure)
        if form is None or not turning:
            return form
        slopes, slices = own.slopes_of(measure.name).coefficients, component_slices(self.drawn)
        forms = []
        for drive, pose in turning:
            slope = float(slopes[slices[drive.turn].start])
            if not slope:
                continue  # it acts to second order alone
            its = self.closed_form(drive.readings[pose]) if drive.sides[pose] else None
            if its is None:
                return None
            factor = HALF * drive.sides[pose] * slope
            forms.append((factor, its))
        return with_joints(form, forms, [contributor.name for contributor in self.contributors])

    @kept
    def _form(self, measure: GearMeasure, *, at_one_position: bool) -> ClosedForm | None:
        return closed_form(self, measure, at_one_position=at_one_position)

    def reference_form(self, measure: Measure) -> ClosedForm | None:
        """See System."""
        if not isinstance(measure, GearMeasure):
            return self._form_of_part(measure)
        return self._form(measure, at_one_position=True)

    def neglected(self, measure: Measure, trials: Trials) -> Mapping[str, Array]:
        """See System."""
        if isinstance(measure, WorstMeasure):
            every = [self.neglected(size, trials) for size in self._sizes(measure)]
            return {words: np.max([own[words] for own in every if words in own], axis=0) for words in _joined(every)}
        if not isinstance(measure, GearMeasure):
            own = replace(trials, deviations=self.of_assembly(trials.deviations))
            return self._with_joints(measure, self._owner(measure).neglected(measure, own), trials)
        return self.gears.neglected(measure, self.linear_gear_trials(trials))

    def _with_joints(self, measure: Measure, found: Mapping[str, Array], trials: Trials) -> Mapping[str, Array]:
        """Neglected terms with those of the plays that turn a part, as they move the measure."""
        added = dict(found)
        for drive, pose in self._turning(measure):
            reading = drive.readings[pose]
            per = HALF * self.lever_of(measure.name, drive) * measure.per_internal / reading.per_internal
            for words, own in self.neglected(reading, trials).items() if per else ():
                added[words] = added.get(words, 0.0) + per * own
        return added

    # what it shows ----------------------------------------------------------------------------------

    def sections(
        self, terms: Mapping[str, Mapping[str, PooledTerms]], published: Published, copula: Copula = INDEPENDENT
    ) -> Mapping[str, Any]:
        """See System."""
        limits = self.backlash_limits(copula)
        found: dict[str, Any] = {"backlash": limits} if limits else {}
        return found | self.gears.train_sections(terms, published)

    def backlash_limits(self, copula: Copula = INDEPENDENT) -> Sequence[BacklashLimits]:
        """Limits of the backlash of its meshes, whose distances the bores decide; the worst by the analytic method."""
        temperatures = {own.name for own in self.contributors if own.kind in OPERATING}
        bores = {own.name for own in self.drawn.contributors} - temperatures
        own = frozenset(own.name for own in self.gears.contributors if own.kind == CENTRE_DISTANCE)
        staged = Staged(self, self.only, ANALYTIC_METHOD, frozenset(bores) | own, copula, no_closed_form)
        return [*limits_of_meshes(self.gears.model.meshes, staged), *self.gears.backlash_limits_of_links(copula)]

    def only(self, kept: Sequence[Contributor], measure: GearMeasure) -> "MachineSystem":
        """The same with some of its contributors, those left out being nominal, and one backlash."""
        names = {contributor.name for contributor in kept}
        own = [contributor for contributor in self.drawn_by_gears if contributor.name in names]
        model = replace(self.gears.model, contributors=(*own, *self.displacements), measures=(measure,))
        return replace(self, contributors=tuple(kept), measures=(measure,), gears=GearSystem(model))

    def display(self, trials: Trials, method: Method) -> Any:
        """See System: the seated meshes of the gears."""
        assert isinstance(method, MachineMethod)
        seen, _ = method.gear_trials(trials)
        return self.gears.display(seen, method.gears)
