"""Read this first: the way of the data, stage by stage.

    scene        what the user wrote        scene/                       load_scene      (kinds.py: what it may have)
    system       what it means, mm and rad  study/system/, */system.py   mechanism_of
    simulation   system, study, published   study/trials/simulation.py   Simulation
    draws        seed -> trials             study/trials/draws.py        drawn
    methods      trials -> answers          each mechanism's own         Method.answers
    columns      both methods, in units     study/trials/columns.py      columns_of
    outcome      which trials seated        study/system/outcome.py      outcome_of
    statistics   of one block, or several   study/tallies/tally.py       Tally           (sample.py: one method's)
    task         what workers run           study/results/task.py        Task            (execution/pools.py: who runs)
    blocks       run, kept, folded in order study/execution/folding.py   run_blocks
    findings     tally -> summary           study/results/findings.py    findings
    witness      some trials again          study/results/witness.py     witness_summary
    explanation  why both methods differ    study/results/agreement/     explanations
    result       the run on disk            study/runs/run.py            Run             (writer.py, occupant.py)
    verdicts     what is accepted           study/runs/summary/judged.py JudgedMeasure
    shown        to programs and notebooks  report/displayed_run.py      DisplayedRun

A study knows a system by `study/system/` alone: contributors, measures, statuses, methods. Gears are one such system.
Theirs:

    model        parts, meshes, measures    gearing/model/           model_from_scene
    layout       shafts in trees, one world gearing/model/layout.py  Model.layout
    solids       CAD, strips of its flanks  parts/, cad/solids/      measuring_strips  (for FCL, engine or witness)
    build        deviations -> poses        gearing/builds/          build
    meshing      gaps -> seated meshes      gearing/meshing/         Meshing.seat      (engines/ give the gaps)
    measures     seated meshes -> values    gearing/meshing/seats.py measure_backlash
    stack-up     the second method          gearing/stack_up/        analytic_backlash
    play         backlashes, together       gearing/play/            Play              (loops too)

The exact engine goes from builds to readings in one compiled kernel (engines/exact/: foot -> nearest -> flank_contact
-> rows), to the same result as by its gaps. `builds/rates.py` and `slopes/` take the derivatives of measures through
the contact.

A gear has a seat in each mesh that it is in, and builds have a place for each seat, in that mesh's own world; shafts
turn together (`layout.py`), so one position of the first shaft of a tree is that of all. A measure is a weighted sum of
backlashes, one of a mesh, several of a train, or what that sum moves; both methods go through `play/`, with what they
read of single meshes. Spur and bevel pairs go the same way: `gears/pair.py` says what every pair offers.

Assemblies are another. Theirs:

    picks        faces -> numbers           assembly/picking/          settle     (when the scene is read)
    drawing      tolerances, by feature     assembly/grammar/          Drawing
    assembly     parts, frames, moves       assembly/from_scene/       understood (model/: what they are)
    zones        uniforms -> deviations     assembly/zones/            Confined   (catalogue.py: all zones)
    placing      deviations -> finite poses assembly/placing/method.py values
    torsors      the second method          assembly/torsors/method.py values

A feature lies in the datum frame that its location is toleranced to, made of the features of the same trial; moves
place bodies in order, measures read them at the end or after a move. The torsors are worked out from the nominal
geometry alone: they never see a pose.

Machines are both in one world (`gearing/machine/`): shafts lie in bores of parts, and trains turn the joints between
parts.

    bores        where shafts lie nominally gearing/machine/nominal.py     housed
    displaced    deviations -> axes         gearing/machine/bores.py       Bores.exactly (and to first order)
    chains       links, joints, poses       gearing/machine/chain.py       Chain
    drives       which train turns which    gearing/machine/open_chains.py drives_of
    all          placed, meshed, turned     gearing/machine/methods.py     MachineMethod

Each method of the assembly hands the axes of the trial to the same method of the gears, which hands back how far its
trains turn the joints, pose by pose: both as deviations that are not drawn.

Linkages bring one move into an assembly, `close_loop`, which places several bodies at once (`assembly/linkage/`).

    structure    a tree of joints, loops   assembly/linkage/structure.py   structured
    kinematics   where it stands in a pose assembly/linkage/kinematics.py  Kinematics
    closing      deviations -> poses       assembly/linkage/closing.py     loops_closed
    first order  the second method         assembly/linkage/first_order.py Displaced
    poses, paths an assembly in several    assembly/posed.py               PosedSystem

`analyses/` asks any scene what an engineer decides from, by `analyses/response.py` alone; `apps/adjustment/` finds
shims and corrections of gears by several studies; `report/` and `cli/` show what is there. The analytic method gets the
same deviations and the same positions as the geometric one and never sees a mesh, a pose or an engine. A trial is a
pure function of (system, seed, trial index): `replay` makes any of them again.
"""

import platform
import tempfile
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tol3d.kinds import NEEDED_KINDS
from tol3d.report.displayed_run import DisplayedRun
from tol3d.scene import Grammar, Scene, read_scene, scene_from_python
from tol3d.scene.load import scene_of_text
from tol3d.study.execution.folding import Plan, StudyOutcome, run_blocks
from tol3d.study.execution.pools import ONE_WORKER, Execution, pool_of
from tol3d.study.execution.timing import Clock
from tol3d.study.execution.watch import UNWATCHED, Watch
from tol3d.study.results.findings import findings, run_tables
from tol3d.study.results.fingerprint import column_units, fingerprint_of, text_of
from tol3d.study.results.replaying import Replay, replay, replayed, simulation_again
from tol3d.study.results.stopping import enough
from tol3d.study.results.task import Task, plan_of, task_of, workers_for
from tol3d.study.results.versions import installed_versions
from tol3d.study.runs.manifest import Fingerprint
from tol3d.study.runs.occupant import Place, free_folder, refuse_changed
from tol3d.study.runs.run import Run
from tol3d.study.runs.writer import RunWriter, refusals_explained
from tol3d.study.system.faults import faults_of
from tol3d.study.tallies.tally import Tally
from tol3d.study.trials.overrides import AS_WRITTEN, Overrides, simulation_of
from tol3d.study.trials.simulation import Simulation

COMPILING = "compiling kernels, once on this machine"


class TemporaryRunWarning(UserWarning):
    """A run was given no folder; the text says where it is."""


def run_scene(
    scene: Scene | Path | str,
    *,
    overrides: Overrides = AS_WRITTEN,
    out: Path | str | None = None,
    execution: Execution = ONE_WORKER,
    trust_parts: bool = False,
    run_builders: bool = False,
    force: bool = False,
    watch: Watch = UNWATCHED,
    kinds: Grammar | None = None,
) -> DisplayedRun:
    """Run a scene's study and keep it on disk.

    Args:
        scene: a scene, the path of one, or the name of a bundled one.
        overrides: values that replace those of the scene's study.
        out: the run's folder; None takes a new one in the system's temporary folder, says where that is, and leaves
            it there until the user or the system deletes it. A run of the same
            study there is replaced, if nothing but its own files is in its folder.
        execution: workers and storage; the results are the same to the last bit for any.
        trust_parts: allow files outside the scene's folder.
        run_builders: run the Python files that the scene names as builders of its parts.
        force: replace a run of another study too; one with other files is moved aside.
        watch: callbacks while it goes on.
        kinds: allowed kinds; default: those of every mechanism.

    Raises:
        SceneError, RunError, InputError: with the place and the remedy.
        MechanismError: a mechanism of another package is at fault.
    """
    clock = Clock()
    resumed = [Path(out)] if out is not None and execution.resume else []
    scene = load(scene, trust_parts=trust_parts, run_builders=run_builders, kinds=kinds, resumed=resumed)
    simulation = simulation_of(scene, overrides)
    with faults_of(simulation.mechanism):
        return DisplayedRun.of(_run(_order(scene, simulation, execution, out, clock), watch, force=force))


def run_simulation(
    scene: Scene,
    simulation: Simulation,
    out: Path | str,
    *,
    execution: Execution = ONE_WORKER,
    force: bool = False,
    watch: Watch = UNWATCHED,
) -> Run:
    """Run a scene with its simulation from `simulation_of`, which takes seconds to make for a large scene.

    Args:
        scene: a scene.
        simulation: of the scene, overrides included.
        out, execution, force, watch: see run_scene.

    Raises:
        RunError, InputError, MechanismError: see run_scene.
    """
    clock = Clock()
    with faults_of(simulation.mechanism):
        return _run(_order(scene, simulation, execution, out, clock), watch, force=force)


def _run(order: "_Order", watch: Watch, *, force: bool) -> Run:
    if whole := order.whole_run():
        return whole
    with order.writing(force=force) as writer:
        task = order.task(watch)
        outcome = order.run(task, writer, watch)
        found = findings(order.simulation, task.method, outcome.statistics, watch.activity)
        order.clock.end_findings()
        return order.finished(writer, found, outcome, watch)


@dataclass(frozen=True)
class _Order:
    """A run that was asked for.

    Args:
        scene, simulation: to run.
        execution: workers and storage.
        folder: of the run.
        fingerprint: identity of an interrupted run.
        plan: division of its trials.
        clock: since it was asked for.
    """

    scene: Scene
    simulation: Simulation
    execution: Execution
    folder: Path
    fingerprint: Fingerprint
    plan: Plan
    clock: Clock

    def whole_run(self) -> Run | None:
        """The run that is there already, if it was asked to go on and has nothing left to do."""
        return Place(self.folder, self.fingerprint).whole_run() if self.execution.resume else None

    @contextmanager
    def writing(self, *, force: bool) -> Iterator[RunWriter]:
        """Its writer; within it, a disk that refuses is explained."""
        writer = RunWriter(
            self.folder,
            self.fingerprint,
            column_units(self.simulation),
            keep_trials=self.execution.keep_trials,
            resume=self.execution.resume,
            force=force,
        )
        with closing(writer), refusals_explained(writer, lambda: self._kept(writer)):
            yield writer

    def _kept(self, writer: RunWriter) -> str:
        kept = min(writer.kept_blocks(Tally) * self.plan.block_trials, self.plan.trials)
        return f"{kept} of {self.plan.trials} trials are"

    def task(self, watch: Watch) -> Task:
        """Task of the workers; kernels that this machine has not compiled yet take ten seconds."""
        compiled = self.simulation.system.is_compiled(self.simulation.study.engine)
        watch.activity(self.simulation.method.setup if compiled else COMPILING)
        return task_of(self.simulation, str(self.fingerprint), keep_trials=self.execution.keep_trials)

    def run(self, task: Task, writer: RunWriter, watch: Watch) -> StudyOutcome[Tally]:
        """All trials, until it is enough."""
        self.clock.start_trials()
        watch.activity("trials")
        with pool_of(self.execution.workers, self.execution.scheduler, task.concurrency) as pool:
            outcome = run_blocks(
                task,
                self.plan,
                pool,
                writer,
                writer.checkpoint(Tally),
                on_progress=watch.progress,
                enough=enough(self.simulation),
            )
        writer.drop_from(self.plan.block_count(outcome.trials))
        self.clock.end_trials(pool.slots)
        return outcome

    def finished(self, writer: RunWriter, found: Mapping[str, Any], outcome: StudyOutcome[Tally], watch: Watch) -> Run:
        """The run on disk, with its pictures."""
        versions = dict(installed_versions(self.simulation.requires))
        summary = {
            **found,
            "blocks": self.fingerprint["blocks"],
            "files": writer.keep(text_of(self.scene), self.scene.files),
            "timing": self.clock.timing(outcome),
            "versions": {"python": platform.python_version(), **versions},
        }
        for name, text in run_tables(self.simulation, outcome.statistics, found):
            writer.table(name, text)
        with writer.pictures() as place:
            watch.finisher(place, summary)
        return writer.finish({**summary, "timing": self.clock.with_pictures(summary["timing"])})


def _order(scene: Scene, simulation: Simulation, execution: Execution, out: Path | str | None, clock: Clock) -> _Order:
    folder = Path(out) if out is not None else _temporary(scene)
    fingerprint = fingerprint_of(scene, simulation, execution)
    return _Order(scene, simulation, execution, folder, fingerprint, plan_of(simulation), clock)


def _temporary(scene: Scene) -> Path:
    """A run's folder in the system's temporary one, warned of before the run, so that a stopped one is found too."""
    folder = Path(tempfile.mkdtemp(prefix="tol3d-")) / scene.source.stem
    words = f"no out was given: the run is written to {folder}, and stays there until you delete it"
    warnings.warn(words, TemporaryRunWarning, stacklevel=4)
    return folder


def load(
    scene: Scene | Path | str,
    *,
    trust_parts: bool = False,
    run_builders: bool = False,
    kinds: Grammar | None = None,
    resumed: Iterable[Path] = (),
) -> Scene:
    """A scene from a path or a bundled name, or the scene itself; one made in Python is checked first.

    Args:
        scene: the scene, or its path.
        trust_parts, run_builders, kinds: see run_scene.
        resumed: folders, in one of which a run is to go on; no program is run for one of other files.
    """
    if isinstance(scene, Scene):
        return scene if scene.text else scene_from_python(scene, trust_parts=trust_parts, run_builders=run_builders)

    def examine(found: Scene) -> None:
        refuse_changed(resumed, text_of(found).sha256, {name: file.sha256 for name, file in found.files.items()})

    grammar = kinds or NEEDED_KINDS
    before_programs = examine if run_builders else None
    return read_scene(scene, grammar, trust_parts=trust_parts, run_builders=run_builders, examine=before_programs)


def load_text(text: str, source: Path, *, trust_parts: bool = False, run_builders: bool = False) -> Scene:
    """A scene of a text that lies in no file yet.

    Args:
        text: as its file would have it.
        source: the path of that file, for messages and for files that the scene names.
        trust_parts, run_builders: see run_scene.

    Raises:
        SceneError: as of a scene that is read from a file.
    """
    content = text.encode("utf-8", "surrogatepass")  # half of a pair is refused with its line
    return scene_of_text(source, content, NEEDED_KINDS, trust_parts=trust_parts, run_builders=run_builders)


def folder_for(scene: Scene, simulation: Simulation, execution: Execution, runs: Path) -> tuple[Path, str]:
    """Default folder of a scene's run, and the contents of the folder of the scene's name if it is another one.

    Args:
        scene, simulation, execution: of the run.
        runs: the folder of all runs.
    """
    with faults_of(simulation.mechanism):
        fingerprint = fingerprint_of(scene, simulation, execution)
    return free_folder(runs / scene.source.stem, fingerprint, resume=execution.resume)


__all__ = [
    "Execution",
    "Overrides",
    "Replay",
    "Watch",
    "folder_for",
    "load",
    "load_text",
    "replay",
    "replayed",
    "run_scene",
    "run_simulation",
    "simulation_again",
    "simulation_of",
    "workers_for",
]
