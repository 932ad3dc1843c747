"""Both methods of a machine: the assembly is placed, gears mesh on the axes of its bores, trains turn its joints.

The assembly is read where its joints then stand, in each pose.

Measures of a machine, besides those of its gears and of its parts.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice, product
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model.statuses import NO_BUILD
from tol3d.assembly.placing import method as placing
from tol3d.assembly.placing.plan import planned
from tol3d.assembly.placing.world import SolidReader
from tol3d.assembly.torsors import method as torsors
from tol3d.gearing.machine.joined import Joined
from tol3d.gearing.machine.open_chains import HALF, JointDrive
from tol3d.gearing.machine.statuses import FROM_ASSEMBLIES
from tol3d.gearing.machine.turned_joints import Turned, Turning
from tol3d.gearing.model.measure import Measure as GearMeasure
from tol3d.numerics.arrays import Array
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Answers, Codes, Method
from tol3d.study.system.outcome import reason_column
from tol3d.study.system.plain import PlainMeasure
from tol3d.study.system.stated import component_slices
from tol3d.study.system.trials import Trials


@dataclass(frozen=True, kw_only=True)
class WorstMeasure(PlainMeasure):
    """The largest of an error in several poses.

    Args:
        sizes: pose and measure of the assembly that is the size there, in order; scenes have no such measure.
        any_flank: whether joints lie on the flanks that make it largest, not on those that their loads choose.
    """

    sizes: tuple[tuple[str, str], ...]
    any_flank: bool = False

    @property
    def longest(self) -> int:
        """Letters of the longest pose."""
        return max(len(pose) for pose, _ in self.sizes)

    def combinations(self, joints: Sequence[str]) -> Iterator[Mapping[str, float] | None]:
        """The ends of their plays at which joints are read; None for those that their loads choose."""
        if not self.any_flank:
            yield None
            return
        for sides in product((-1.0, 1.0), repeat=len(joints)):
            yield dict(zip(joints, sides, strict=True))


Details = dict[str, NDArray[np.generic]]

Kept = dict[int, dict[str, Any]]
"""What is found of trials once for all poses and flanks, by block; see tol3d.assembly.placing.world.World."""

NOT_TURNED: Final = int(FROM_ASSEMBLIES[NO_BUILD])
"""The status of parts on a joint whose train jams or finds no contact."""


@dataclass(frozen=True, eq=False)
class MachineMethod:
    """A method of the gears behind one of the assembly; implements WitnessMethod where the gears' does.

    Args:
        system: whose.
        gears: the gears' own method.
        exact: whether parts are placed by finite poses; else by torsors.
        solids: by pose, the reader of clearances of whole parts; empty if there are none.
        chords: by clearance, the part explained by chord errors of witness and checked method [mm]; else empty.
    """

    system: Joined
    gears: Method
    exact: bool
    solids: Mapping[str, SolidReader] = field(default_factory=dict)
    chords: Mapping[str, float] = field(default_factory=dict)

    @property
    def chord_error(self) -> float:
        """See Method."""
        return self.gears.chord_error

    def reads(self, measure: Measure) -> bool:
        """See WitnessMethod: every one."""
        return True

    def bounds(self, measure: Measure) -> tuple[float, float]:
        """See WitnessMethod; of the assembly clearances and joints are read otherwise than by the witnessed method."""
        witness: Any = self.gears
        if isinstance(measure, GearMeasure):
            found: tuple[float, float] = witness.bounds(measure)
            return found
        names = [name for _, name in measure.sizes] if isinstance(measure, WorstMeasure) else [measure.name]
        by_facets, by_all_else = self.chords.get(measure.name, 0.0), 0.0
        for own in (self._joint_bounds(name, witness) for name in names):
            by_facets, by_all_else = max(by_facets, own[0]), max(by_all_else, own[1])
        return by_facets * measure.per_internal, by_all_else * measure.per_internal

    def _joint_bounds(self, name: str, witness: Any) -> tuple[float, float]:
        """Errors of trains, as they move a measure of the assembly, with the clearance's own [mm or rad]."""
        found = np.array([self.chords.get(name, 0.0), 0.0])
        for drive in self.system.joints_of(name):
            reading = drive.readings[self.system.pose_of[name]]
            levers = self.system.lever_of(name, drive), self.system.reaches_of(name)[drive.joint]
            per = HALF * max(levers) / reading.per_internal
            found += per * np.array(witness.bounds(reading))
        return float(found[0]), float(found[1])

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Method."""
        system = self.system
        of_gears = [measure for measure in measures if isinstance(measure, GearMeasure)]
        worst = [measure for measure in measures if isinstance(measure, WorstMeasure)]
        others = [measure.name for measure in measures if not isinstance(measure, GearMeasure | WorstMeasure)]
        turning = self._turning(others, worst)
        needed = {own.name: own for drive, pose in turning for own in [drive.readings[pose]]}
        first = [name for name in others if system.pose_of[name] == next(iter(system.poses))]
        still = first if not turning else [name for name in first if not system.joints_of(name)]
        reads_gears, kept = bool(of_gears or needed), Kept()
        read = (*system.bores.names, *still) if reads_gears else still
        values, codes, details = self._placed(system.of_assembly(trials.deviations), read, "", kept)
        hidden = {reason_column(name) for name in system.bores.names}
        shown: Details = {name: own for name, own in details.items() if name not in hidden}
        found = Answers(
            {name: values[name][:, None] for name in still}, details=shown, status=self._status(codes, still)
        )
        gears, turned = Answers({}), Turned()
        if reads_gears:
            seen, failed = self._seen(trials, values, codes)
            if of_gears:
                gears = self._without_axes(self.gears.answers(seen, of_gears), of_gears, failed)
            turned = self._turned_by(seen, list(needed.values()), failed)
        found = self._with_poses(found, trials, [name for name in others if name not in still], turned, kept)
        for measure in worst:
            found = _joined(found, self._worst(trials, measure, turned, kept))
        return _joined(gears, found) if of_gears else found

    def gear_trials(self, trials: Trials) -> tuple[Trials, Mapping[str, Codes]]:
        """Trials as the gears see them, and by shaft the status of its bores (trials,), codes of this system."""
        values, codes, _ = self._placed(self.system.of_assembly(trials.deviations), self.system.bores.names, "", {})
        return self._seen(trials, values, codes)

    def in_pose(self, trials: Trials, pose: str) -> Array:
        """Deviations (trials, columns) of the assembly in a pose, every joint turned as its train lets it."""
        readings = {drive.readings[pose].name: drive.readings[pose] for drive in self.system.drives}
        if not readings:
            return self.system.of_assembly(trials.deviations)
        seen, failed = self.gear_trials(trials)
        return self._turned(trials, pose, self._turned_by(seen, list(readings.values()), failed))

    # joints -----------------------------------------------------------------------------------------

    def _turning(self, names: Iterable[str], worst: Sequence[WorstMeasure]) -> list[tuple[JointDrive, str]]:
        """The drives, each with a pose, on which some measures depend."""
        system = self.system
        wanted = [(drive, system.pose_of[name]) for name in names for drive in system.joints_of(name)]
        wanted += [(drive, pose) for own in worst for pose, name in own.sizes for drive in system.joints_of(name)]
        return list({(drive.joint, pose): (drive, pose) for drive, pose in wanted}.values())

    def _turned_by(self, seen: Trials, readings: Sequence[GearMeasure], failed: Mapping[str, Codes]) -> Turned:
        """Free motion of trains; unknown for one whose axes are misplaced."""
        found = self.turning.turned(seen, readings)
        lost = {
            reading.name: found.failed[reading.name]
            | np.any([failed[shaft] != 0 for shaft in self._shafts(reading)], axis=0)
            for reading in readings
            if self._shafts(reading)
        }
        return replace(found, failed={**found.failed, **lost}) if lost else found

    @cached_property
    def turning(self) -> Turning:
        """Turns of joints by the trains."""
        return Turning(self.system, self.gears)

    def _with_poses(
        self, answers: Answers, trials: Trials, names: Sequence[str], turned: Turned, kept: Kept
    ) -> Answers:
        """Answers, and measures of the assembly in their poses."""
        poses = self.system.pose_of
        for pose in dict.fromkeys(poses[name] for name in names):
            own = [name for name in names if poses[name] == pose]
            answers = _joined(answers, self._in_pose(trials, own, pose, turned, kept))
        return answers

    def _in_pose(self, trials: Trials, names: Sequence[str], pose: str, turned: Turned, kept: Kept) -> Answers:
        system = self.system
        deviations = self._turned(trials, pose, turned)
        values, codes, details = self._placed(deviations, names, pose, kept)
        status, reasons = self._status(codes, names), Details()
        found = {name: np.asarray(values[name])[:, None] for name in names}
        for name in names:
            drives = system.joints_of(name)
            if not drives:
                continue
            before = status.get(name, np.zeros(len(trials), dtype=np.int8))
            reason = np.asarray(details.get(reason_column(name), np.full(len(trials), "")))
            for drive in drives:
                failed = turned.failed[drive.readings[pose].name] & (before == 0)
                reason = np.where(failed, f"train of {drive.joint}", reason)
                before = np.where(failed, np.int8(NOT_TURNED), before).astype(np.int8)
            status[name], reasons[reason_column(name)] = before, reason
            found[name] = np.where((before != 0)[:, None], np.nan, found[name])
        return Answers(found, details={**details, **reasons}, status=status)

    def _turned(self, trials: Trials, pose: str, turned: Turned, sides: Mapping[str, float] | None = None) -> Array:
        """Deviations (trials, columns) of the assembly, its joints turned to one end of their plays.

        Args:
            trials, pose, turned: whose, where, by what.
            sides: by joint, to which end; default: by their loads.
        """
        system = self.system
        deviations, drawn = system.of_assembly(trials.deviations), component_slices(system.drawn)
        for drive in system.drives:
            name = drive.readings[pose].name
            if name not in turned.play or (sides is not None and drive.joint not in sides):
                continue
            side: Array | float = drive.sides[pose] if sides is None else sides[drive.joint]
            if not side:
                side = np.sign(deviations[:, drawn[drive.flank].start])
            play = np.where(turned.failed[name], 0.0, turned.play[name])
            deviations[:, drawn[drive.turn].start] = HALF * side * play
        return deviations

    def _worst(self, trials: Trials, measure: WorstMeasure, turned: Turned, kept: Kept) -> Answers:
        """The largest over poses, and over flanks; of a trial in which a joint has no play there is none."""
        largest, place = np.full(len(trials), -np.inf), np.full(len(trials), "", dtype=f"<U{measure.longest}")
        status, reason = np.zeros(len(trials), dtype=np.int8), np.full(len(trials), "")
        at_once = max(1, placing.BLOCK // len(trials))  # in one block, or trial by trial in the blocks that are kept
        for pose, name in measure.sizes:
            drives = self.system.joints_of(name)
            for sides in batched(measure.combinations([drive.joint for drive in drives]), at_once):
                builds = np.concatenate([self._turned(trials, pose, turned, side) for side in sides])
                values, codes, _ = self._placed(builds, [name], pose, kept)
                shape = len(sides), len(trials)
                if codes:
                    own = FROM_ASSEMBLIES[codes[name]].reshape(shape).max(axis=0)
                    status = np.maximum(status, own).astype(np.int8)
                highest = values[name].reshape(shape).max(axis=0)
                larger = highest > largest
                largest, place = np.where(larger, highest, largest), np.where(larger, pose, place)
            for drive in drives:
                failed = turned.failed[drive.readings[pose].name] & (status == 0)
                reason = np.where(failed, f"train of {drive.joint}", reason)
                status = np.where(failed, np.int8(NOT_TURNED), status).astype(np.int8)
        lost = status != 0
        details = {f"worst pose:{measure.name}": np.where(lost, "", place), reason_column(measure.name): reason}
        return Answers({measure.name: np.where(lost, np.nan, largest)[:, None]}, {}, details, {measure.name: status})

    # bores ------------------------------------------------------------------------------------------

    def _placed(
        self, deviations: Array, names: Sequence[str], pose: str, kept: Kept
    ) -> tuple[Mapping[str, Array], Mapping[str, Codes], Mapping[str, NDArray[np.generic]]]:
        """Measures of the assembly, their statuses in its own codes, empty if all are built, and details.

        Args:
            deviations: of the assembly (trials, columns), the trials once or repeated with other turns of joints.
            names: of the measures.
            pose: of the joints; "" for the first one.
            kept: found of the trials before, in other poses.
        """
        first = next(iter(self.system.poses))
        its_bores = not pose or pose == first
        assembly = self.system.bores.assembly if its_bores else self.system.poses[pose].assembly
        if not self.exact:
            return torsors.values(assembly, deviations, names), {}, {}
        plan = planned(assembly, self.solids.get(first if its_bores else pose))
        found, decided = placing.planned_answers(plan, deviations, names, kept)
        values = {name: own for name, (own, _) in found.items()}
        return values, {name: codes for name, (_, codes) in found.items()}, decided

    def _seen(
        self, trials: Trials, values: Mapping[str, Array], codes: Mapping[str, Codes]
    ) -> tuple[Trials, Mapping[str, Codes]]:
        bores = self.system.bores
        displaced = bores.exactly(values) if self.exact else bores.to_first_order(values)
        failed = {}
        for k, own in enumerate(bores.shafts):
            names = bores.names[6 * k : 6 * k + 6]
            worst = np.max([codes[name] for name in names], axis=0) if codes else np.zeros(len(trials), dtype=np.int8)
            failed[own.shaft] = FROM_ASSEMBLIES[worst]
        return self.system.gear_trials(trials, np.nan_to_num(displaced, nan=0.0)), failed

    def _status(self, codes: Mapping[str, Codes], names: Sequence[str]) -> dict[str, Codes]:
        return {name: FROM_ASSEMBLIES[codes[name]] for name in names} if codes else {}

    def _without_axes(self, answers: Answers, measures: Sequence[GearMeasure], failed: Mapping[str, Codes]) -> Answers:
        """Answers of gears; none for a gear with misplaced bores."""
        if not any(codes.any() for codes in failed.values()):
            return answers
        values, status = dict(answers.values), dict(answers.status)
        for measure in measures:
            before = status.get(measure.name, np.zeros(len(values[measure.name]), dtype=np.int8))
            codes = np.max([np.zeros_like(before), *(failed[shaft] for shaft in self._shafts(measure))], axis=0)
            status[measure.name] = np.where(codes != 0, codes, before).astype(np.int8)
            values[measure.name] = np.where((codes != 0)[:, None], np.nan, values[measure.name])
        return replace(answers, values=values, status=status)

    def _shafts(self, measure: GearMeasure) -> set[str]:
        """Shafts in bores of the meshes and other links that a measure reads."""
        model = self.system.gears.model
        meshes = [model.mesh(backlash.mesh) for _, backlash in measure.kind.backlashes]
        shafts = {model.layout.carrying[gear][0] for mesh in meshes for gear in (mesh.driver, mesh.driven)}
        shafts |= {shaft for _, link in measure.kind.links for shaft in self.system.link_shafts[link]}
        return shafts & {shaft.shaft for shaft in self.system.bores.shafts}


def batched(items: Iterator[Mapping[str, float] | None], size: int) -> Iterator[list[Mapping[str, float] | None]]:
    """Items, in groups."""
    while batch := list(islice(items, size)):
        yield batch


def _joined(first: Answers, second: Answers) -> Answers:
    return Answers(
        {**first.values, **second.values},
        {**first.terms, **second.terms},
        {**first.details, **second.details},
        {**first.status, **second.status},
    )
