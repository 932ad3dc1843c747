"""Results of the commands, for notebooks and scripts: tables, pictures, files and parts in space, nothing printed.

Objects here show themselves as the last value of a notebook cell; `str()` is the text of a table, `path` the place of a
picture. Drawing libraries are loaded on demand.
"""

import operator
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from platform import machine, python_version
from typing import TYPE_CHECKING, Final

from tol3d import report, simulate
from tol3d.analyses.kept_pages import kept_advice, kept_charts, kept_pages, kept_shares
from tol3d.analyses.response import Response, response_of
from tol3d.errors import InputError, RunError, unwritable
from tol3d.gearing.model import Model
from tol3d.gearing.slopes.coefficients import Coefficient, coefficients_of
from tol3d.gearing.system import gear_model
from tol3d.numerics.arrays import Array
from tol3d.report.presenter import Display, Which, presenter_at
from tol3d.report.printed import Picture as Picture
from tol3d.report.printed import Report as Report
from tol3d.report.report_sections import report_sections
from tol3d.report.table_files import ReportFormat, require_room_for_tables, write_tables
from tol3d.scene import Scene
from tol3d.study.runs.atomic_write import write_whole
from tol3d.study.runs.bare import MissingMechanismWarning, open_even_bare
from tol3d.study.runs.run import Run, open_run
from tol3d.study.runs.summary.judged import Accepted, AcceptedPpk
from tol3d.study.system.system import System
from tol3d.study.trials.overrides import AS_WRITTEN, Overrides

if TYPE_CHECKING:
    import trimesh

    from tol3d.report.export import Exported


REPORT: Final = "report.html"  # in a run's folder


@dataclass(frozen=True, repr=False)
class Check(Report):
    """Report on a scene before any trial.

    Args:
        system: the system that is built and measured.
    """

    system: System

    @property
    def model(self) -> Model:
        """Model of gears: the parts, moves, measures and contributors, in mm and rad.

        Raises:
            InputError: it is a system of something else.
        """
        return gear_model(self.system)

    @cached_property
    def coefficients(self) -> Mapping[str, Sequence[Coefficient]]:
        """Coefficient of each contributor in each measure of gears by its name, by either method, with its share.

        Raises:
            InputError: it is a system of something else.
        """
        return coefficients_of(self.model)


@dataclass(frozen=True, repr=False)
class Comparison(Report):
    """Runs laid over each other.

    Args:
        picture: of their histograms; None where no `out` was given.
    """

    picture: Picture | None


@dataclass(frozen=True, repr=False)
class Replay(simulate.Replay):
    """One trial again, with its parts in space.

    Parts are where they came to rest, in the world of their mesh (the driver's axis is z, the driven one at +x), or
    where shafts connect gears in that of the first shaft. A measure of several positions shows the extreme that it
    takes, or its first.

    Args:
        trial: its number.
    """

    trial: int

    def __repr__(self) -> str:
        return f"<Replay of trial {self.trial} of {self.simulation.system.name}: {self.status}, {dict(self.geometric)}>"

    @cached_property
    def display(self) -> Display:
        """Its parts where they came to rest.

        Raises:
            RunError: it cannot be shown.
        """
        return presenter_at(self.simulation.presenter).replayed(self, f"trial-{self.trial}")

    @cached_property
    def poses(self) -> Mapping[str, Array]:
        """World from each part's own frame, by its name (4, 4) [mm].

        Raises:
            RunError: it cannot be shown.
        """
        return {body.name: body.world_from_part for world in self.display.worlds for body in world.bodies}

    @cached_property
    def meshes(self) -> "Mapping[str, trimesh.Trimesh]":
        """Each part as a closed mesh in the world, its deviations and growth on it, by its name [mm].

        Raises:
            RunError: it cannot be shown.
        """
        return report.part_meshes(self.display)


def check_scene(
    scene: Scene | Path | str,
    *,
    overrides: Overrides = AS_WRITTEN,
    trust_parts: bool = False,
    run_builders: bool = False,
) -> Check:
    """Report on a scene before any trial, as `tol3d check` shows it.

    Args:
        scene: a scene, its path, or the name of a bundled one.
        overrides: values that replace those of its study.
        trust_parts: allow files outside the scene's folder.
        run_builders: run the Python files that the scene names as builders of its parts.

    Raises:
        SceneError: it cannot be read or built.
    """
    loaded = simulate.load(scene, trust_parts=trust_parts, run_builders=run_builders)
    simulation = simulate.simulation_of(loaded, overrides)
    return Check(report.check_report(simulation), simulation.system)


def compare_runs(runs: Sequence[Run | Path | str], *, out: Path | str | None = None) -> Comparison:
    """Runs beside each other, as `tol3d compare` shows them.

    Args:
        runs: finished runs, or their folders.
        out: the picture to draw; None draws none.

    Raises:
        RunError: one is no run. InputError: there are none, or the picture cannot be written.
    """
    opened = [opened_run(run) for run in runs]
    if out is not None:
        report.draw_comparison(opened, Path(out))
    return Comparison(report.comparison_report(opened), None if out is None else Picture(Path(out)))


def write_report(
    runs: Sequence[Run | Path | str] | Run | Path | str,
    out: Path | str,
    *,
    accepted_ppm: float | None = None,
    accepted_ppk: float | None = None,
    trials: Sequence[int] = (),
    in_3d: bool = True,
    format: ReportFormat = "html",
    force: bool = False,
) -> Path:
    """Write a run, or several compared, as one page of HTML or as tables, as `tol3d report` does.

    Args:
        runs: finished runs, or their folders.
        out: the file; of "csv" a folder, which gets a file for each table.
        accepted_ppm: share of trials that may be out of a measure's limits; default: as the study asks, or 0.27 %.
        accepted_ppk: Ppk that a measure must have, instead.
        trials: which the 3D view has besides the nominal build and the worst one.
        in_3d: whether the parts are shown in 3D, which takes a megabyte.
        format: "html" the page; "xlsx", "csv" and "json" its tables, numbers with all their digits.
        force: replace existing files.

    Raises:
        RunError: one is no run, or changed since. InputError: the file is there, or cannot be written.
    """
    if accepted_ppm is not None and accepted_ppk is not None:
        raise InputError("expected accepted_ppm or accepted_ppk, got both")
    accepted = accepted_ppm if accepted_ppk is None else AcceptedPpk(accepted_ppk)
    path = Path(out)
    several = [runs] if isinstance(runs, Run | Path | str) else runs
    found = [(run, "") if isinstance(run, Run) else open_even_bare(run) for run in several]
    opened, missing = [run for run, _ in found], tuple(dict.fromkeys(words for _, words in found if words))
    for words in missing:
        warnings.warn(words, MissingMechanismWarning, stacklevel=2)
    if format == "csv":
        require_room_for_tables(path, force=force)
    elif path.is_dir():
        raise InputError(f"{path}: expected the name of a file, this is a folder")
    elif path.exists() and not force:
        raise InputError(f"{path}: expected the name of a new file, there is one already; --force replaces it")
    analyses = kept_pages(opened[0]) if len(opened) == 1 and not missing else {}
    if format != "html":
        return write_tables(report_sections(opened, accepted, analyses), path, format, _about(opened))
    now = datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z")
    made = f"report made {now} by tol3d {version('tol3d')}, Python {python_version()}, {machine()}"
    text = report.report_html(
        opened,
        analyses=analyses,
        charts=kept_charts(opened[0]) if analyses else {},
        shares=kept_shares(opened[0]) if analyses else {},
        best=kept_advice(opened[0]) if analyses else "",
        accepted=accepted,
        trials=trials,
        in_3d=in_3d and not missing,
        missing=missing,
        made=made,
    )
    try:
        write_whole(path, text.encode())
    except OSError as error:
        raise unwritable(path, error, "choose another file") from None
    return path


def keep_report(run: Run, accepted: Accepted | None = None) -> Path:
    """Write a run's report into its own folder, in place of an older one, as `tol3d run --report` does.

    Raises:
        RunError: a file of that name is not the run's own, or the folder cannot be written.
    """
    path, manifest = run.path / REPORT, run.manifest
    if path.exists() and REPORT not in manifest.sums:
        raise RunError(f"{path}: this file is not the run's own; move it elsewhere")
    ppk = accepted.ppk if isinstance(accepted, AcceptedPpk) else None
    ppm = None if isinstance(accepted, AcceptedPpk) else accepted
    write_report(run, path, accepted_ppm=ppm, accepted_ppk=ppk, force=True)
    manifest.adding(REPORT).write()
    return path


def _about(runs: Sequence[Run]) -> Mapping[str, object]:
    """Items beside the tables of a report."""
    return {
        "runs": [
            {"run": run.path.name, "scene": run.found.scene, "trials": run.trials, "seed": run.found.seed}
            for run in runs
        ],
        "tol3d": version("tol3d"),
    }


def export_trial(
    run: Run | Path | str,
    trial: Which = "worst",
    *,
    format: str = "glb",
    magnify: float = 1.0,
    out: Path | str = ".",
) -> "Exported":
    """Write the perturbed parts of a build where they ended up, as `tol3d export` does.

    Args:
        run: a finished run, or its folder.
        trial: its number, or "worst", "nominal", "mean".
        format: "stl" and "ply" a file a part, "glb", "step" and any of a train one.
        magnify: scales the deviations and seats again.
        out: the folder; made if missing.

    Returns:
        the files, and notes on them.

    Raises:
        InputError: no such build or format, or the folder cannot be written.
    """
    return report.export_run(opened_run(run), _which(trial), format, magnify=magnify, out=Path(out))


def view_trial(
    run: Run | Path | str,
    trial: Which = "worst",
    *,
    out: Path | str | None = None,
    magnify: float = 1.0,
    mesh: str | None = None,
) -> Picture:
    """Show a build in 3D with contact and gap marked, as `tol3d view` does.

    Args:
        run: a finished run, or its folder.
        trial: its number, or "worst", "nominal", "mean".
        out: the picture to write; None opens a window and waits until it is closed.
        magnify: scales the deviations and seats again.
        mesh: which is shown close up; by default the first.

    Raises:
        InputError: no such build or mesh, no display, or the picture cannot be written.
    """
    picture = None if out is None else Path(out)
    notes = report.view_run(opened_run(run), _which(trial), screenshot=picture, magnify=magnify, close_up=mesh)
    return Picture(picture, notes)


def response(
    scene: Scene | Path | str,
    *,
    overrides: Overrides = AS_WRITTEN,
    analytic: bool = False,
    trust_parts: bool = False,
    run_builders: bool = False,
) -> Response:
    """Measures of builds whose deviations are stated, in batches, as every analysis asks them.

    Args:
        scene: a scene, its path, or the name of a bundled one.
        overrides: values that replace those of its study, such as its engine.
        analytic: by the analytic model, not by the 3D simulation.
        trust_parts, run_builders: see run_scene.

    Raises:
        SceneError: it cannot be read or built. InputError: all of its measures are curves.
    """
    loaded = simulate.load(scene, trust_parts=trust_parts, run_builders=run_builders)
    return response_of(simulate.simulation_of(loaded, overrides), analytic=analytic)


def replay(run: Run | Path | str, trial: int) -> Replay:
    """Trial k of a run again, with its parts in space; see `simulate.replay`.

    Raises:
        RunError: no run, or changed since. InputError: the run has no such trial.
    """
    index = _index(trial)
    return Replay(**vars(simulate.replay(run, index)), trial=index)


def opened_run(run: Run | Path | str) -> Run:
    """A run from its folder, or the run itself."""
    return run if isinstance(run, Run) else open_run(run)


def _which(trial: Which) -> Which:
    """A trial's number of any integer type, or the word for a build."""
    return trial if isinstance(trial, str) else _index(trial)


def _index(trial: int) -> int:
    try:
        return operator.index(trial)
    except TypeError:
        raise InputError(f"trial: expected a whole number from 0 on, got {trial!r}") from None
