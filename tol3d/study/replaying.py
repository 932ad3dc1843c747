"""One trial of a run again: its deviations, build, contacts and values."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from tol3d.errors import InputError
from tol3d.gearing.engines.lazy import exact_engine
from tol3d.gearing.model import Model, Study, Until, model_from_scene
from tol3d.kinds import load_scene
from tol3d.runs.run import Run, differences, open_run
from tol3d.study.block import Block, Seats, drawn_block, seat_block, simulate_block
from tol3d.study.task import engine_of, installed_versions, strips_for


class ElsewhereWarning(UserWarning):
    """A run was made with other packages or on another kind of processor; its trials again differ by rounding."""


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
    """The model of a run, from the files that it kept, with the study it was run with.

    Raises:
        RunError: a kept file was changed since.
    """
    model = model_from_scene(load_scene(run.scene_path, files=run.files))
    known = {field.name for field in fields(Study)}
    study = {name: value for name, value in run.summary["study"].items() if name in known}
    until = tuple(Until(*errors) for errors in study.pop("until", ()))
    return replace(model, study=Study(**study, until=until))


def replay(run: Run | Path | str, trial: int) -> Replay:
    """Trial k of a run again: its deviations, build, contacts and values.

    Bit for bit with the packages and on the kind of processor that made the run, elsewhere to rounding.

    Raises:
        RunError: the run has no such trial.

    Warns:
        ElsewhereWarning: they are others here.
    """
    run = run if isinstance(run, Run) else open_run(Path(run))
    if not 0 <= trial < run.trials:
        raise InputError(f"trial {trial}: expected 0 to {run.trials - 1}")
    if found := differences(run.fingerprint["versions"], dict(installed_versions())):
        words = f"{run.path}: made elsewhere ({'; '.join(found)}), so its trials again differ by rounding"
        warnings.warn(words, ElsewhereWarning, stacklevel=2)
    model = model_of(run)
    return replay_block(model, drawn_block(model, model.study.seed, trial, 1))


def replay_block(model: Model, block: Block) -> Replay:
    """One build with all its contacts, for any deviations."""
    engine = engine_of(model, strips_for(model)) or exact_engine(model)
    columns = simulate_block(model, engine, block)

    def values(road: str) -> dict[str, Any]:
        return {measure.name: columns[f"{road}:{measure.name}"][0].tolist() for measure in model.measures}

    return Replay(
        model=model,
        block=block,
        seats=seat_block(model, engine, block),
        analytic=values("analytic"),
        geometric=values("geometric"),
        status=str(columns["status"][0]),
    )
