"""One trial of a run again: its deviations, build, contacts and values."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from tol3d.errors import InputError
from tol3d.scene import Kinds, read_scene
from tol3d.scene.grammar import registered_kinds
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.results.versions import installed_versions
from tol3d.study.runs.manifest import differences
from tol3d.study.runs.run import Run, open_run
from tol3d.study.runs.worst import worst_trial
from tol3d.study.system.faults import faults_of
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC, value_column
from tol3d.study.system.stated import magnified, mean_build, nominal_build
from tol3d.study.system.trials import Trials
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study, Until


class ElsewhereWarning(UserWarning):
    """A run was made with other packages or on another kind of processor; its trials again differ by rounding."""


@dataclass(frozen=True)
class Replay:
    """One trial again: everything about it.

    Args:
        simulation: the run's.
        trials: its deviations and positions (one trial).
        build: with its contacts, as the system has it.
        analytic, geometric: values of each measure, in the measure's unit.
        status: "ok", or why it could not be assembled.
    """

    simulation: Simulation
    trials: Trials
    build: Any
    analytic: Mapping[str, Any]
    geometric: Mapping[str, Any]
    status: str


def simulation_again(run: Run, kinds: Kinds | None = None) -> Simulation:
    """The simulation of a run, from the files that it kept, with the study it was run with.

    Raises:
        RunError: a kept file was changed since.
    """
    again = simulation_of(read_scene(run.scene_path, kinds or registered_kinds(), files=run.files))
    known = {field.name for field in fields(Study)}
    study = {name: value for name, value in run.summary["study"].items() if name in known}
    until = tuple(Until(*errors) for errors in study.pop("until", ()))
    return replace(again, study=Study(**study, until=until))


def replay(run: Run | Path | str, trial: int, kinds: Kinds | None = None) -> Replay:
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
    simulation = simulation_again(run, kinds)
    here = dict(installed_versions(simulation.requires))
    if found := differences(run.fingerprint["versions"], here):
        words = f"{run.path}: made elsewhere ({'; '.join(found)}), so its trials again differ by rounding"
        warnings.warn(words, ElsewhereWarning, stacklevel=2)
    return replayed(simulation, drawn(simulation, trial, 1))


def build_of(run: Run, which: int | str) -> tuple[Replay, str]:
    """A build of a run again, with its label, such as "trial-17" or "nominal".

    Args:
        which: a trial, or "worst", "nominal", "mean".

    Raises:
        InputError: no such build.
    """
    if which == "worst":
        which = worst_trial(run)
    if isinstance(which, int):
        return replay(run, which), f"trial-{which}"
    if which not in ("nominal", "mean"):
        raise InputError(f"expected a trial's number, worst, nominal or mean, got {which!r}")
    simulation = simulation_again(run)
    system = simulation.system
    build = nominal_build(system) if which == "nominal" else mean_build(system, system.measures[0])
    return replayed(simulation, build), which


def enlarged(build: Replay, factor: float) -> Replay:
    """A build with its deviations multiplied by a factor; see `tol3d.study.system.stated.magnified`."""
    if factor == 1.0:
        return build
    return replayed(build.simulation, magnified(build.simulation.system, build.trials, factor))


def replayed(simulation: Simulation, trials: Trials) -> Replay:
    """One build with all its contacts, for any deviations; that of an analytic study by the system's first engine.

    Raises:
        MechanismError: the system's mechanism is at fault.
    """
    with faults_of(simulation.mechanism):
        return _replayed(simulation, trials)


def _replayed(simulation: Simulation, trials: Trials) -> Replay:
    system = simulation.system
    if not simulation.has_geometry:
        engine = next(name for name in system.methods if name != ANALYTIC_METHOD)
        simulation = replace(simulation, study=replace(simulation.study, engine=engine, witness=0))
    method = method_of(simulation, materials_of(simulation))
    if method is None:
        raise ValueError(f"{system.name} has no engine")
    columns = columns_of(system, method, trials)

    def values(method: str) -> dict[str, Any]:
        return {measure.name: columns[value_column(method, measure.name)][0].tolist() for measure in system.measures}

    return Replay(
        simulation=simulation,
        trials=trials,
        build=system.display(trials, method),
        analytic=values(ANALYTIC),
        geometric=values(GEOMETRIC),
        status=str(columns["status"][0]),
    )
