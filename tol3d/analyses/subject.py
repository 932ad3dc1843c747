"""Subject of an analysis: a scene, or a finished run of one, in which its section is kept."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Final

from tol3d.analyses.kept_batches import KeptBatches
from tol3d.analyses.response import Response, response_of
from tol3d.errors import RunError, unwritable
from tol3d.import_path import named
from tol3d.kinds import NEEDED_KINDS
from tol3d.scene import Scene, read_scene
from tol3d.scene.bundled import scene_path
from tol3d.simulate import load, simulation_again, simulation_of
from tol3d.study.execution.pools import Execution
from tol3d.study.results.fingerprint import fingerprint_of
from tol3d.study.runs.atomic_write import write_whole
from tol3d.study.runs.run import SUMMARY, Run, open_run
from tol3d.study.runs.summary.text import parsed
from tol3d.study.runs.summary.values import Section, as_json
from tol3d.study.trials.simulation import Simulation

PACKAGE: Final = __name__.partition(".")[0]
FOLDER: Final = "analyses"


@dataclass(frozen=True)
class Kept:
    """An analysis whose result a run or a job keeps; what makes and shows it as import paths.

    Args:
        title: of it in reports.
        section: class of the result.
        report: makes its page. Where a result has no name of its scene, that is the first argument.
        charts: makes its charts.
    """

    title: str
    section: str
    report: str
    charts: str


KEPT: Final[Mapping[str, Kept]] = {
    "changes": Kept(
        "what to change",
        "tol3d.analyses.what_to_change:Changes",
        "tol3d.analyses.shown_changes:changes_report",
        "tol3d.analyses.shown_changes:changes_charts",
    ),
    "methods": Kept(
        "methods side by side",
        "tol3d.analyses.methods_section:Methods",
        "tol3d.analyses.shown_methods:methods_report",
        "tol3d.analyses.shown_methods:methods_charts",
    ),
    "effects": Kept(
        "effects",
        "tol3d.analyses.tolerance_effects:Effects",
        "tol3d.analyses.shown_effects:effects_report",
        "tol3d.analyses.effects_charts:effects_charts",
    ),
    "rare": Kept(
        "rare events",
        "tol3d.analyses.rare_section:RareEvents",
        "tol3d.analyses.shown_rare_events:rare_report",
        "tol3d.analyses.rare_charts:rare_charts",
    ),
    "what-if": Kept(
        "what if",
        "tol3d.analyses.before_after:WhatIf",
        "tol3d.analyses.shown_what_if:what_if_report",
        "tol3d.analyses.shown_what_if:what_if_charts",
    ),
    "allocation": Kept(
        "allocation",
        "tol3d.analyses.allocation_section:Allocation",
        "tol3d.analyses.allocate_table:allocation_report",
        "tol3d.analyses.allocate_charts:allocation_charts",
    ),
    "sweep": Kept(
        "variants",
        "tol3d.analyses.variant_sweep:Sweep",
        "tol3d.analyses.sweep_table:sweep_report",
        "tol3d.analyses.sweep_charts:sweep_charts",
    ),
}
"""Analyses by the names of their files, in the order of reports. Each is loaded where it is kept: a sweep by a job."""


@dataclass(frozen=True, eq=False)
class Subject:
    """A scene's simulation, and the run of it where there is one.

    Args:
        simulation: what builds are made of.
        run: where sections are kept; None of a scene.
        loaded: the scene; None of a run, which keeps its own.
    """

    simulation: Simulation
    run: Run | None = None
    loaded: Scene | None = None

    @cached_property
    def scene(self) -> Scene:
        """The scene, of a run the one that it kept."""
        if self.loaded is not None:
            return self.loaded
        assert self.run is not None
        return read_scene(self.run.scene_path, NEEDED_KINDS, files=self.run.files)

    @property
    def name(self) -> str:
        """The scene's own."""
        return self.simulation.system.name

    @cached_property
    def response(self) -> Response:
        """By the engine of its study; what it evaluates is kept until the analysis ends."""
        return replace(response_of(self.simulation), batches=self.batches)

    @cached_property
    def batches(self) -> KeptBatches:
        """Batches that an interrupted analysis of it evaluated."""
        origin = self.simulation.mechanism
        packages = [PACKAGE] if origin is None else [PACKAGE, origin.package]
        return KeptBatches.of(fingerprint_of(self.scene, self.simulation, Execution()), *packages)

    def keep(self, name: str, found: Section) -> Path | None:
        """Keep a section in the run; its file, None of a scene.

        Raises:
            RunError, InputError: the run was changed since it was made, or cannot be written.
        """
        return None if self.run is None else keep(self.run, name, found)


def subject_of(asked: Scene | Run | Path | str, *, trust_parts: bool = False, run_builders: bool = False) -> Subject:
    """The subject of an analysis.

    Args:
        asked: a scene or a run, or the path of one: a run's folder, a scene's file, or the name of a bundled scene.
        trust_parts, run_builders: see simulate.load.

    Raises:
        SceneError, RunError: it is none of them, or damaged.
    """
    if isinstance(asked, Path | str) and ((Path(asked) / SUMMARY).exists() or Path(asked).is_dir()):
        asked = open_run(Path(asked))
    if isinstance(asked, Run):
        return Subject(simulation_again(asked), asked)
    path = asked if isinstance(asked, Scene) else scene_path(str(asked))
    scene = load(path, trust_parts=trust_parts, run_builders=run_builders)
    return Subject(simulation_of(scene), loaded=scene)


def keep(run: Run, name: str, found: Section) -> Path:
    """Keep a section in a run, in place of an older one of that name; its file."""
    file = f"{FOLDER}/{name}.json"
    path, manifest = run.path / file, run.manifest
    if file not in manifest.sums and path.exists():
        raise RunError(f"{path}: this file is not the run's own; move it elsewhere")
    try:
        path.parent.mkdir(exist_ok=True)
        write_whole(path, text_of_section(found).encode())
        manifest.adding(file).write()
    except OSError as error:
        raise unwritable(path, error, "free it, or ask of a copy of the run") from None
    return path


def sections_of(run: Run) -> Mapping[str, Section]:
    """The sections that a run keeps, by their names.

    Raises:
        RunError: one was changed since it was made.
    """
    listed = [name for name in KEPT if f"{FOLDER}/{name}.json" in run.manifest.sums]
    return {name: _section(run, name) for name in listed}


def _section(run: Run, name: str) -> Section:
    file = f"{FOLDER}/{name}.json"
    return section_of(name, run.manifest.content(file), run.path / file)


def section_of(name: str, content: bytes, path: Path) -> Section:
    """A section from its JSON, which a stranger may have made.

    Args:
        name: of the analysis, see KEPT.
        content: the JSON, as of `text_of_section`.
        path: of its file, for messages.

    Raises:
        RunError: it is damaged.
    """
    kind: type[Section] = named(KEPT[name].section)
    try:
        return kind.model_validate(parsed(content, path))
    except ValueError:
        raise RunError(f"{path}: it is damaged, or of another tol3d; ask for {name} again") from None


def text_of_section(found: Section) -> str:
    """A section as JSON."""
    return json.dumps(as_json(found), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
