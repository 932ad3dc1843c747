"""Work of a job, in its own process: a run, an analysis or a report. A run loads neither of the others."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Final

from tol3d.apps.workbench.attempt import RUNS, Attempt, Order
from tol3d.apps.workbench.monitor import Monitor
from tol3d.apps.workbench.place import inside
from tol3d.files import read_file
from tol3d.import_path import named
from tol3d.simulate import Execution, Overrides, Watch, folder_for, load, run_simulation, simulation_of, workers_for
from tol3d.study.runs.occupant import partial_of
from tol3d.study.runs.run import open_run

ASK: Final = "tol3d.apps.workbench.asked_analysis:ask"
KEEP_ANSWER: Final = "tol3d.apps.workbench.answer:keep_answer"
KEEP_REPORT: Final = "tol3d.notebook:keep_report"


def work(attempt: Attempt, order: Order, monitor: Monitor, trusted: Mapping[str, bool]) -> str:
    """Do what is asked.

    Args:
        attempt: of this process.
        order: its own.
        monitor: of it.
        trusted: allowed to the scene, by the arguments of `run_scene`.

    Returns:
        Remarks for the user, "" for none.

    Raises:
        InputError, MechanismError: with the place and the remedy.
        KeyboardInterrupt: it was cancelled; what it has finished is kept.
    """

    def tell(text: str) -> None:
        monitor.now = replace(monitor.now, words=text)

    if order.kind == "run":
        _run(attempt, order, monitor, tell, trusted)
    elif order.kind == "report":
        tell("report")
        named(KEEP_REPORT)(open_run(inside(attempt.folder / RUNS / order.run, attempt.folder)))
    else:
        scene = inside(attempt.folder / order.scene, attempt.folder)
        out = inside(attempt.folder / RUNS / f"{scene.stem}-sweep", attempt.folder)  # as `tol3d sweep` has it
        answer = named(ASK)(order.kind, scene, order.words, tell, out=out, **trusted)
        named(KEEP_ANSWER)(answer, attempt.place)
        return "; ".join(answer.warnings)
    return ""


def _run(
    attempt: Attempt, order: Order, monitor: Monitor, tell: Callable[[str], None], trusted: Mapping[str, bool]
) -> None:
    """A run, as `tol3d run` makes it, or the rest of one."""
    scene, runs = (inside(attempt.folder / name, attempt.folder) for name in (order.scene, RUNS))
    tell("reading the scene")
    monitor.now = replace(monitor.now, sha256=read_file(scene).sha256)
    begun = runs / order.run
    out = begun if order.run and (begun.exists() or partial_of(begun).exists()) else None
    loaded = load(
        scene,
        trust_parts=trusted["trust_parts"],
        run_builders=trusted["run_builders"],
        resumed=[] if out is None else [out],
    )
    trials = order.words.get("trials")
    simulation = simulation_of(loaded, Overrides(trials=trials if isinstance(trials, int) else None))
    execution = Execution(workers_for(simulation), resume=out is not None)
    folder = out or folder_for(loaded, simulation, execution, runs)[0]
    inside(folder, attempt.folder)
    inside(partial_of(folder), attempt.folder)
    monitor.now = replace(monitor.now, of=simulation.study.trials, run=folder.name)

    def progress(done: int) -> None:
        monitor.now = replace(monitor.now, done=monitor.now.done + done)

    watch = Watch(activity=tell, progress=progress)
    finished = run_simulation(loaded, simulation, folder, execution=execution, watch=watch)
    monitor.now = replace(monitor.now, done=finished.trials)
