"""Read this first: the way of the data, stage by stage.

    scene        what the user wrote        scene/                      load_scene
    model        what it means, mm and rad  gearing/model/              model_from_scene
    layout       shafts in trees, one world gearing/model/layout.py     Model.layout
    solids       CAD, strips of its flanks  parts/, solids/             measuring_strips (for FCL, engine or witness)
    draws        seed -> deviations         study/draws.py              deviations
    build        deviations -> poses        gearing/build.py            build
    meshing      gaps -> seated meshes      gearing/meshing/            Meshing.seat     (engines/ give the gaps)
    measures     seated meshes -> values    gearing/measures/           measure_backlash
    stack-up     the second road            gearing/stack_up/           analytic_backlash
    play         backlashes, together       gearing/play.py             Play             (load_paths.py: in parallel)
    columns      both roads, one block      study/block.py              simulate_block
    outcome      which trials seated, jam   runs/outcome.py             told
    statistics   of one block, or several   study/tally.py              Tally            (sample.py: one road's)
    task         what workers run           study/task.py               Task             (execution/pools.py: who runs)
    blocks       run, kept, folded in order execution/folding.py        run_blocks
    witness      some trials again, by FCL  study/witness.py            witness_summary
    explanation  why both roads differ      study/agreement/            explanations
    result       the run on disk            runs/run.py                 Run              (writer.py, manifest.py)

The exact engine goes build, moves and measures in one compiled kernel (engines/exact/: foot -> nearest -> seating ->
rows), to the same result as by its gaps; `compiled.py` is the door to numba. `rates.py` and `sensitivity.py` take the
derivatives of measures through the contact.

A gear has a seat in each mesh that it is in, and builds have a place for each seat, in that mesh's own world; shafts
turn together (`layout.py`), so one position of the first shaft of a tree tells all. A measure is a weighted sum of
backlashes, one of a mesh, several of a train, or what that sum moves (`measures/lost_motion.py`); both roads go through
`play.py`, with what they read of single meshes.

Spur and bevel pairs go the same way: `gears/pair.py` says what every pair offers. A new kind of gear is one file in
gears/, parts/, solids/, engines/exact/, analytic/ and in each folder of scene/ that it concerns, named in
model/pairs.py.

`study.py` says what is asked, `analyses/` asks what takes several studies (shims, compensation), `report/` and `cli/`
show what is there. The analytic road gets the same deviations and the same driver position as the geometric one and
never sees a mesh, a pose or an engine. A trial is a pure function of (model, seed, trial index): `replay` makes any of
them again.
"""

import json
import platform
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tol3d.errors import DiskError, RunError, refused_by_disk
from tol3d.execution.folding import Outcome, Plan, Progress, run_blocks
from tol3d.execution.pools import ONE_WORKER, Execution, pool_of
from tol3d.files import FileContent
from tol3d.gearing.engines import Engine
from tol3d.gearing.engines.lazy import exact_is_compiled
from tol3d.gearing.model import Model
from tol3d.runs.atomic_write import lacks_space
from tol3d.runs.occupant import free_folder
from tol3d.runs.run import Fingerprint, Run, whole_run
from tol3d.runs.writer import RunWriter
from tol3d.scene import Scene
from tol3d.study.block import block_trials, positions_in_all
from tol3d.study.overrides import AS_WRITTEN, Overrides, effective_model, load
from tol3d.study.replaying import Replay, model_of, replay, replay_block
from tol3d.study.stopping import enough
from tol3d.study.summary import study_summary
from tol3d.study.tally import PILOT_TRIALS, Tally, grids_of
from tol3d.study.task import Task, installed_versions, strips_for, strips_of, way_of, workers_for
from tol3d.study.witness import witness_summary, witness_warnings

try:
    import resource
except ImportError:  # Windows has none
    resource = None  # type: ignore[assignment]

SETUP_STAGE: Mapping[str, str] = {
    "analytic": "model",
    "fcl": "gears: solids and measuring strips",
    "exact": "kernels",
}

COMPILING = "compiling kernels, once on this machine"


class TemporaryRunWarning(UserWarning):
    """A run was given no folder; the text says where it is."""


Stage = Callable[[str], None]
Finisher = Callable[[Path, Mapping[str, Any]], None]


@dataclass(frozen=True)
class Watch:
    """Who is told of a run while it goes on.

    Args:
        stage: told what goes on.
        progress: told how many trials were finished since it was told last.
        finisher: adds pictures to the folder before the run is put in its place.
    """

    stage: Stage = lambda text: None
    progress: Progress = lambda done: None
    finisher: Finisher = lambda folder, summary: None


def run_scene(
    scene: Scene | Path | str,
    *,
    overrides: Overrides = AS_WRITTEN,
    out: Path | str | None = None,
    execution: Execution = ONE_WORKER,
    trust_parts: bool = False,
    force: bool = False,
    watch: Watch = Watch(),
) -> Run:
    """Run a scene's study and keep it on disk.

    Args:
        scene: a scene, the path of one, or the name of a bundled one.
        overrides: what is said otherwise than in the scene's study.
        out: the run's folder; None takes a new one in the system's temporary folder, says where that is, and leaves
            it there until the user or the system deletes it. A run of the same
            study there is replaced, if nothing but its own files is in its folder.
        execution: who runs it and what is kept; the results are the same to the last bit for any.
        trust_parts: allow files outside the scene's folder.
        force: replace a run of another study too; one that holds more than its own files is moved aside.
        watch: who is told.

    Raises:
        SceneError, RunError, InputError: with the place and what to do.
    """
    started = time.perf_counter()
    scene = load(scene, trust_parts=trust_parts)
    model = effective_model(scene, overrides)
    folder = Path(out) if out is not None else _temporary(scene)
    fingerprint = _fingerprint(scene, model, execution)
    if execution.resume and (whole := whole_run(folder, fingerprint)):
        return whole
    writer = RunWriter(
        folder,
        fingerprint,
        _column_units(model),
        keep_trials=execution.keep_trials,
        resume=execution.resume,
        force=force,
    )
    plan = Plan(model.study.trials, block_trials(model), positions_in_all(model))
    with _told_of_a_full_disk(writer, plan):
        watch.stage(_setup_stage(model))
        task = _task(model, str(fingerprint), execution)
        prepared = time.perf_counter()
        watch.stage("trials")
        with pool_of(execution.workers, execution.scheduler, task.way) as pool:
            outcome = run_blocks(
                task, plan, pool, writer, writer.checkpoint(Tally), on_progress=watch.progress, enough=enough(model)
            )
        writer.drop_from(plan.block_count(outcome.trials))
        simulate_s = time.perf_counter() - prepared
        summary = {
            **_found(model, task.engine, outcome.statistics, watch.stage),
            "blocks": fingerprint["blocks"],
            "files": writer.keep(_text_of(scene), scene.files),
            "timing": _timing(outcome, prepared - started, simulate_s, pool.slots),
            "versions": {"python": platform.python_version(), **dict(installed_versions())},
        }
        with writer.pictures() as place:
            watch.finisher(place, summary)
        return writer.finish(summary)


def _temporary(scene: Scene) -> Path:
    """A run's folder in the system's temporary one, told of before the run, so that a stopped one is found too."""
    folder = Path(tempfile.mkdtemp(prefix="tol3d-")) / scene.source.stem
    told = f"no out was given: the run is written to {folder}, and stays there until you delete it"
    warnings.warn(told, TemporaryRunWarning, stacklevel=3)
    return folder


def _setup_stage(model: Model) -> str:
    """What goes on before the trials; kernels that this machine has not compiled yet take ten seconds."""
    if model.study.engine == "exact" and not exact_is_compiled(model):
        return COMPILING
    return SETUP_STAGE[model.study.engine]


def _found(model: Model, engine: Engine | None, tally: Tally, stage: Stage) -> dict[str, Any]:
    """What the study found, and what its witness found of it."""
    found = study_summary(model, engine, tally)
    if engine is None or not model.study.witness:
        return found
    stage(f"witness: FCL measures {min(model.study.witness, tally.trials)} trials again")
    witness = witness_summary(model, engine, tally.trials)
    return found | {"witness": witness, "warnings": [*found["warnings"], *witness_warnings(model, witness)]}


def _task(model: Model, fingerprint: str, execution: Execution) -> Task:
    """What workers run; its pilot trials load what trials need: that is setup, not simulation."""
    pilot = Task(model, strips_for(model), {}, fingerprint, execution.keep_trials, installed_versions())
    return replace(pilot, grids=grids_of(model, pilot.columns(0, PILOT_TRIALS)))


@contextmanager
def _told_of_a_full_disk(writer: RunWriter, plan: Plan) -> Iterator[None]:
    """Within it, a write that fails raises a RunError that says what is kept."""
    try:
        yield
    except OSError as error:
        if refused_by_disk(error):
            kept = min(writer.kept_blocks(Tally) * plan.block_trials, plan.trials)
            why, way = _why(error, writer)
            raise DiskError(
                f"{why}: {kept} of {plan.trials} trials are kept in {writer.partial}; {way}, then the same command "
                "goes on"
            ) from None
        if str(error.filename or "").startswith(str(writer.partial)):
            raise RunError(f"{error.filename}: cannot be written ({error.strerror})") from None
        raise


def _why(error: OSError, writer: RunWriter) -> tuple[str, str]:
    """What the disk refused, and what helps."""
    if lacks_space(error):
        return f"{writer.path}: no space left on the disk", "make room"
    return f"{error.filename or writer.partial}: cannot be written ({error.strerror})", "mend the disk or its limits"


def _timing(outcome: Outcome[Tally], setup_s: float, simulate_s: float, slots: int) -> dict[str, float | None]:
    return {
        "setup_s": round(setup_s, 4),
        "simulate_s": round(simulate_s, 4),
        "first_block_s": round(outcome.first_block_s, 4),
        "trials_per_s": round((outcome.trials - outcome.resumed_trials) / simulate_s, 1),
        "resumed_trials": outcome.resumed_trials,
        "workers": slots,
        "peak_memory_mb": _peak_memory_mb(),
    }


def _peak_memory_mb() -> float | None:
    """Largest resident size of this process so far [MB]; None where the system does not tell."""
    if resource is None:
        return None
    per_mb = 1e6 if sys.platform == "darwin" else 1e3  # bytes there, kB elsewhere
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / per_mb, 1)


def _text_of(scene: Scene) -> FileContent:
    return FileContent(scene.source, scene.text.encode())


def folder_for(scene: Scene, model: Model, execution: Execution, runs: Path) -> tuple[Path, str]:
    """Where a run of a scene goes by default, and what is in the folder of the scene's name where it is another one.

    Args:
        scene, model, execution: of the run.
        runs: the folder of all runs.
    """
    return free_folder(runs / scene.source.stem, _fingerprint(scene, model, execution), resume=execution.resume)


def _fingerprint(scene: Scene, model: Model, execution: Execution) -> Fingerprint:
    fingerprint = {
        "scene": _text_of(scene).sha256,
        "files": {name: file.sha256 for name, file in scene.files.items()},
        "study": vars(model.study),
        "versions": dict(installed_versions()),
        "blocks": {"trials": block_trials(model), "kept": execution.keep_trials},
    }
    read_back: Fingerprint = json.loads(json.dumps(fingerprint))
    return read_back


def _column_units(model: Model) -> dict[str, str]:
    units: dict[str, str] = {name: c.unit for c in model.contributors for name in c.columns}
    for measure in model.measures:
        units |= {f"{road}:{measure.name}": measure.unit for road in ("analytic", "geometric")}
    return units


__all__ = [
    "Execution",
    "Overrides",
    "Replay",
    "Watch",
    "effective_model",
    "folder_for",
    "load",
    "model_of",
    "replay",
    "replay_block",
    "run_scene",
    "strips_of",
    "way_of",
    "workers_for",
]
