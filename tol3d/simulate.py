"""Read this first: the way of the data, stage by stage.

    scene        what the user wrote        tol3d/scene/          load_scene
    model        what it means, mm and rad  tol3d/model/          model_from_scene
    solids       CAD, strips of its flanks  parts/, tol3d/solids/ measuring_strips
    trials       seed -> deviations         tol3d/trials.py       drawn_block
    build        deviations -> poses        tol3d/build.py        build
    moves        gaps -> seated meshes      tol3d/moves/          Meshing.seat     (engines/ tell the gaps)
    measures     seated meshes -> values    tol3d/measures/       measure_backlash
    analytic     the second road            tol3d/analytic/       analytic_backlash
    columns      both roads, one block      tol3d/block.py        simulate_block
    statistics   folded block by block      tol3d/tally.py        Tally
    result       the run on disk            tol3d/result.py       RunWriter, Run

Spur and bevel pairs go the same way: `gears/pair.py` says what every pair offers. A new kind of gear is one file in
gears/, parts/, solids/, analytic/ and in each folder of scene/ that it concerns, named in model/pairs.py.

`execution.py` hands blocks to workers; `report/` and `cli.py` show what is there. The analytic road gets the
same deviations and the same driver position as the geometric one and never sees a mesh, a pose or an engine.
A trial is a pure function of (model, seed, trial index): `replay` makes any of them again.
"""

import importlib.metadata
import platform
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache, reduce
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.block import (
    Block,
    Seats,
    analytic_values,
    block_trials,
    drawn_block,
    geometric_values,
    mean_block,
    nominal_block,
    positions_in_all,
    seat_block,
    simulate_block,
    taken,
)
from tol3d.engines import Engine
from tol3d.engines.fcl import FclEngine
from tol3d.errors import InputError
from tol3d.execution import Columns, Progress, run_blocks
from tol3d.files import FileContent
from tol3d.model import Model, model_from_scene
from tol3d.moves import OK, STATUS_TEXT
from tol3d.result import Run, RunWriter, open_run
from tol3d.scene import Scene, load_scene, scene_from_python
from tol3d.solids import FlankStrips, measuring_strips
from tol3d.summary import study_summary
from tol3d.tally import PILOT_TRIALS, Tally, grids_of

Stage = Callable[[str], None]
Finisher = Callable[[Path, Mapping[str, Any]], None]

ZERO_BACKLASH = 1e-9  # mm or rad; nominal backlash zero is legal, and closed forms round to 1e-14
VERSIONS_OF = ("tol3d", "numpy", "scipy", "python-fcl", "cadquery")


@dataclass(frozen=True)
class Overrides:
    """What a run may say otherwise than its scene; None keeps the scene's word."""

    trials: int | None = None
    seed: int | None = None
    engine: str | None = None


def load(scene: Scene | Path | str, *, trust_parts: bool = False) -> Scene:
    """A scene from a path, or the scene itself; one that was made in Python is checked first."""
    if not isinstance(scene, Scene):
        return load_scene(Path(scene), trust_parts=trust_parts)
    return scene if scene.text else scene_from_python(scene, trust_parts=trust_parts)


def effective_model(scene: Scene, overrides: Overrides = Overrides()) -> Model:
    """The model of a scene with a run's overrides in its study; refuses a mean build that interferes."""
    model = model_from_scene(scene)
    given = {key: value for key, value in vars(overrides).items() if value is not None}
    model = replace(model, study=replace(model.study, **given))
    refuse_interfering_mean(scene, model)
    return model


def refuse_interfering_mean(scene: Scene, model: Model) -> None:
    """Refuse a mesh whose non-working flanks overlap with every contributor at its mean.

    Raises:
        SceneError: at the mesh's centre distance, with the backlash of nominal and mean build.
    """
    for measure in model.measures:
        value = float(analytic_values(model, measure, mean_block(model, measure)).min())
        if value < -ZERO_BACKLASH:
            mesh = model.mesh(measure.kind.mesh)
            nominal = float(analytic_values(model, measure, nominal_block(model)).min())
            unit, per = measure.unit, measure.per_internal
            raise scene.refuse(
                ("moves", mesh.name),
                f"the teeth interfere at the mean build: {measure.name} is {value * per:.3f} {unit} there "
                f"(nominal {nominal * per:.3f} {unit}); {mesh.pair.remedy}",
            )


def strips_of(model: Model) -> dict[str, FlankStrips]:
    """Measuring strips of every gear, from its CAD solid (cached on disk)."""
    return {part.name: measuring_strips(part.gear, model.study.profile_steps) for part in model.gears}


@dataclass(frozen=True, eq=False)
class _Task:
    """What a worker runs: columns of some trials. Equal by fingerprint, so that a process makes one engine for all."""

    model: Model
    strips: Mapping[str, FlankStrips] | None
    fingerprint: str

    def __call__(self, first: int, count: int) -> dict[str, NDArray[np.generic]]:
        return simulate_block(self.model, self.engine, drawn_block(self.model, self.model.study.seed, first, count))

    @property
    def engine(self) -> Engine | None:
        """The engine of this process; None for an analytic study."""
        return None if self.strips is None else _engine_of(self)

    def __hash__(self) -> int:
        return hash(self.fingerprint)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Task) and other.fingerprint == self.fingerprint


@lru_cache(maxsize=1)
def _engine_of(task: _Task) -> Engine:
    return FclEngine(task.model, task.strips or {})


def run_scene(
    scene: Scene | Path | str,
    *,
    overrides: Overrides = Overrides(),
    out: Path | str | None = None,
    workers: int = 1,
    trust_parts: bool = False,
    on_stage: Stage = lambda text: None,
    on_progress: Progress = lambda done: None,
    finisher: Finisher = lambda folder, summary: None,
) -> Run:
    """Run a scene's study and keep it on disk.

    Args:
        scene: a scene or the path of one.
        overrides: trials, seed or engine other than the scene's.
        out: the run's folder; None takes a temporary one.
        workers: processes; the columns are the same to the last bit for any number.
        trust_parts: allow files outside the scene's folder.
        on_stage, on_progress: told what goes on, and how many trials were finished since.
        finisher: adds pictures to the folder before the run is put in its place.

    Raises:
        SceneError, RunError: with the place and what to do.
    """
    started = time.perf_counter()
    scene = load(scene, trust_parts=trust_parts)
    model = effective_model(scene, overrides)
    folder = Path(out) if out is not None else Path(tempfile.mkdtemp(prefix="tol3d-")) / "run"
    fingerprint = _fingerprint(scene, model)
    writer = RunWriter(folder, fingerprint, _column_units(model))
    on_stage("gears: solids and measuring strips")
    task = _Task(model, strips_of(model) if model.study.engine == "fcl" else None, str(fingerprint))
    grids = grids_of(model, task(0, PILOT_TRIALS))  # also loads what trials need: that is setup, not simulation
    prepared = time.perf_counter()
    on_stage("trials")
    parts = (Tally.of(model, grids, columns) for columns in _blocks(task, workers, writer, on_progress))
    tally = reduce(Tally.merge, parts)
    done = time.perf_counter()
    summary = {
        **study_summary(model, task.engine, tally),
        "files": writer.keep(_text_of(scene), scene.files),
        "timing": _timing(model, started, prepared, done, workers),
        "versions": {"python": platform.python_version(), **_versions()},
    }
    finisher(writer.picture_path("."), summary)
    return writer.finish(summary)


def _blocks(task: _Task, workers: int, writer: RunWriter, on_progress: Progress) -> Iterator[Columns]:
    study, positions = task.model.study, positions_in_all(task.model)
    return run_blocks(
        task,
        study.trials,
        workers,
        writer,
        on_progress,
        block_trials=block_trials(task.model),
        positions=positions,
    )


def _timing(model: Model, started: float, prepared: float, done: float, workers: int) -> dict[str, float]:
    return {
        "setup_s": round(prepared - started, 4),
        "simulate_s": round(done - prepared, 4),
        "trials_per_s": round(model.study.trials / (done - prepared), 1),
        "workers": workers,
    }


def _text_of(scene: Scene) -> FileContent:
    return FileContent(scene.source, scene.text.encode())


def _fingerprint(scene: Scene, model: Model) -> dict[str, Any]:
    files = {name: file.sha256 for name, file in scene.files.items()}
    return {"scene": _text_of(scene).sha256, "files": files, "study": vars(model.study), "versions": _versions()}


def _versions() -> dict[str, str]:
    return {name: importlib.metadata.version(name) for name in VERSIONS_OF}


def _column_units(model: Model) -> dict[str, str]:
    units: dict[str, str] = {name: c.unit for c in model.contributors for name in c.columns}
    for measure in model.measures:
        units |= {f"{road}:{measure.name}": measure.unit for road in ("analytic", "geometric")}
    return units


# replay -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Replay:
    """One trial again: everything about it.

    Args:
        model: the run's model.
        block: its deviations and driver positions (one trial).
        seats: its build and seated meshes.
        analytic, geometric: values of each measure, in the measure's unit.
        status: "ok", or why it could not be assembled.
    """

    model: Model
    block: Block
    seats: Seats
    analytic: Mapping[str, Any]
    geometric: Mapping[str, Any]
    status: str


def model_of(run: Run) -> Model:
    """The model of a run, from the files that it kept, with the overrides it was run with.

    Raises:
        RunError: a kept file was changed since.
    """
    study = run.summary["study"]
    scene = load_scene(run.scene_path, files=run.files)
    return effective_model(scene, Overrides(study["trials"], study["seed"], study["engine"]))


def replay(run: Run | Path | str, trial: int) -> Replay:
    """Trial k of a run again, bit for bit: its deviations, build, contacts and values.

    Raises:
        RunError: the run has no such trial.
    """
    run = run if isinstance(run, Run) else open_run(Path(run))
    if not 0 <= trial < run.trials:
        raise InputError(f"trial {trial}: expected 0 to {run.trials - 1}")
    model = model_of(run)
    return replay_block(model, drawn_block(model, model.study.seed, trial, 1))


def replay_block(model: Model, block: Block) -> Replay:
    """One build with all its contacts, for any deviations."""
    engine = FclEngine(model, strips_of(model))
    seats = seat_block(model, engine, block)
    worst = max((int(seat.status.max()) for seat in seats.seats.values()), default=OK)
    values = {m.name: taken(m, geometric_values(m, seats)) * m.per_internal for m in model.measures}
    expected = {m.name: taken(m, analytic_values(model, m, block)) * m.per_internal for m in model.measures}
    return Replay(
        model=model,
        block=block,
        seats=seats,
        analytic={name: value[0].tolist() for name, value in expected.items()},
        geometric={name: value[0].tolist() for name, value in values.items()},
        status=STATUS_TEXT[worst],
    )


__all__ = [
    "Overrides",
    "Replay",
    "effective_model",
    "load",
    "model_of",
    "replay",
    "replay_block",
    "run_scene",
]
