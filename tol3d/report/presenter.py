"""Presentation of a kind of system, in addition to that of every run."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final, Protocol, cast, runtime_checkable

from tol3d.errors import InputError
from tol3d.report.page import PageItem
from tol3d.study.runs.summary.measure import MeasureSummary

if TYPE_CHECKING:
    import pyvista as pv

    from tol3d.report.body import World
    from tol3d.study.results.replaying import Replay
    from tol3d.study.runs.run import Run
    from tol3d.study.runs.summary.run import RunSummary
    from tol3d.study.trials.simulation import Simulation

REPLAYING: Final = "tol3d.study.results.replaying"  # loads what simulates, which tables do without
SYSTEM_CHECK = "tol3d.report.system_check"  # loads distributions, and so scipy, which pictures do without

Which = int | str
"""A trial, or "worst", "nominal", "mean"."""
Draw = Callable[[Path], None]
"""Draws a picture and writes it; raises InputError where that is not possible."""
Panel = Callable[["pv.Plotter", float], None]
"""Draws one part of the 3D window into the plotter's current renderer, whose width by its height is given."""


@dataclass(frozen=True, eq=False)
class View:
    """Content of the 3D window.

    Args:
        panels: the first one large, on the left, the others one below the other on its right; one alone fills the
            window. Without any the window shows a world, its bodies named.
        notes: on all that the window does not show.
        world: shown without panels; None: the first of the display.
    """

    panels: tuple[Panel, ...] = ()
    notes: tuple[str, ...] = ()
    world: "World | None" = None


@dataclass(frozen=True)
class FurtherRow:
    """A row below a measure's statistics.

    Args:
        label: what it is.
        values: in the measure's unit, by method ("analytic", "geometric") and by who published one.
    """

    label: str
    values: Mapping[str, float | None]


class Display(Protocol):
    """A build as it is shown and exported."""

    @property
    def label(self) -> str:
        """Label, such as "trial-17" or "nominal", usable as the start of a file's name."""
        ...

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes for the user, such as the magnification in use."""
        ...

    @property
    def worlds(self) -> "tuple[World, ...]":
        """Its bodies; each world is a file of its own."""
        ...

    def view(self, close_up: str | None) -> View:
        """The 3D window with a close-up of that name, None for the first there is.

        Raises:
            InputError: there is no such close-up.
        """
        ...


class Presenter(Protocol):
    """Pictures, tables and bodies of one kind of system. It loads what draws when something is drawn."""

    def pictures(self, summary: "RunSummary") -> Mapping[str, Draw]:
        """Further pictures of a run by their names, which become file names."""
        ...

    def sections(self, summary: "RunSummary") -> Sequence[PageItem]:
        """Further tables of a run."""
        ...

    def measure_rows(self, measure: MeasureSummary, summary: "RunSummary") -> Sequence[FurtherRow]:
        """Further rows below a measure's statistics."""
        ...

    def check(self, simulation: "Simulation") -> Sequence[PageItem]:
        """Tables of a scene, before any trial: `tol3d.report.system_check.system_blocks`, or more than that.

        Args:
            simulation: whose system is of the presenter's own kind.
        """
        ...

    def display(self, run: "Run", which: Which, *, magnify: float) -> Display:
        """A build of a run, simulated again.

        Args:
            which: a trial, or "worst", "nominal", "mean".
            magnify: scales every deviation; lowered to what the build allows, as a note then says.

        Raises:
            InputError, RunError: no such build, or one that cannot be shown.
        """
        ...

    def replayed(self, replay: "Replay", label: str) -> Display:
        """A trial that was replayed.

        Raises:
            RunError: it cannot be shown.
        """
        ...


class ShowsBuilds(ABC):
    """The part of a presenter that shows a build of a run and a trial that was replayed in one way.

    A presenter that magnifies deviations only as far as a build allows, or that says so in its label or its notes, has
    this base; those of others are magnified before they are replayed.
    """

    @abstractmethod
    def shown(self, build: "Replay", label: str, *, magnify: float) -> Display:
        """A build under a label.

        Args:
            build: as it was simulated, without magnification.
            label: such as "trial-17", usable as the start of a file's name.
            magnify: see Presenter.display.

        Raises:
            InputError, RunError: it cannot be shown.
        """

    def display(self, run: "Run", which: Which, *, magnify: float) -> Display:
        """A build of a run, simulated again; see Presenter."""
        build, label = import_module(REPLAYING).build_of(run, which)
        return self.shown(build, label, magnify=magnify)

    def replayed(self, replay: "Replay", label: str) -> Display:
        """A trial that was replayed; see Presenter."""
        return self.shown(replay, label, magnify=1.0)


@runtime_checkable
class ShowsNotes(Protocol):
    """A presenter with words that belong below the first tables of a run, such as what a negative mean is."""

    def first_notes(self, summary: "RunSummary") -> Sequence[PageItem]:
        """Notes; nothing where a run gives no occasion."""
        ...


class Map(Protocol):
    """A picture of values over a workspace."""

    def draw(self, path: Path) -> None:
        """Draw it and write it; raises InputError where that is not possible."""
        ...

    def csv(self) -> str:
        """Its numbers, as comma-separated values."""
        ...


@runtime_checkable
class Mapped(Protocol):
    """A presenter of systems that have a workspace."""

    def workspace(self, simulation: "Simulation", measure: str | None, activity: Callable[[str], None]) -> Map:
        """The workspace of a scene.

        Args:
            simulation: of the scene.
            measure: whose sigma is shown; default the mechanism's own data on its poses.
            activity: progress callback.

        Raises:
            InputError: it has none, or no such measure.
        """
        ...


def presenter_at(path: str) -> Presenter:
    """The presenter that a module calls PRESENTER; one that shows nothing where no module is named."""
    return cast(Presenter, import_module(path).PRESENTER) if path else _Nothing()


def presenter_of(run: "RunSummary", path: str | None = None) -> Presenter:
    """The presenter at an import path; without one that of the mechanism that made the run, or of its measures."""
    if path is not None:
        return presenter_at(path)
    own = run.presenters.get(run.mechanism.name, "") if run.mechanism else ""
    of_measures = (measure.presenter for measure in run.measures.values() if measure.presenter)
    return presenter_at(own or next(of_measures, ""))


def display_build(build: "Replay", label: str, *, magnify: float = 1.0) -> Display:
    """A build as its system's presenter shows it; a run is not needed.

    Args:
        build: what `tol3d.simulate.replayed` makes of a simulation, deviations and positions.
        label: such as "nominal" or "trial-17", usable as the start of a file's name.
        magnify: scales every deviation; lowered to what the build allows, as a note then says.

    Raises:
        InputError, RunError: it cannot be shown.
    """
    presenter = presenter_at(build.simulation.presenter)
    if isinstance(presenter, ShowsBuilds):
        return presenter.shown(build, label, magnify=magnify)
    return presenter.replayed(import_module(REPLAYING).enlarged(build, magnify), label)


def require_bodies(display: Display) -> None:
    """Refuse a build of which nothing can be seen.

    Raises:
        InputError: it has no bodies.
    """
    if not any(world.bodies for world in display.worlds):
        raise InputError(f"{display.label}: there is nothing to show in 3D: its presenter gives no bodies")


class _Nothing:
    """Shows nothing more of a system."""

    def pictures(self, summary: "RunSummary") -> Mapping[str, Draw]:
        return {}

    def sections(self, summary: "RunSummary") -> Sequence[PageItem]:
        return ()

    def measure_rows(self, measure: MeasureSummary, summary: "RunSummary") -> Sequence[FurtherRow]:
        return ()

    def check(self, simulation: "Simulation") -> Sequence[PageItem]:
        blocks: Sequence[PageItem] = import_module(SYSTEM_CHECK).system_blocks(simulation)
        return blocks

    def display(self, run: "Run", which: Which, *, magnify: float) -> Display:
        maker = run.found.mechanism
        whose = f"the mechanism {maker.name!r}" if maker else "its mechanism"
        raise InputError(
            f"{run.path}: there is nothing to show in 3D: {whose} has no presenter; its histograms and tables are in "
            "the run's folder and in tol3d compare"
        )

    def replayed(self, replay: "Replay", label: str) -> Display:
        raise InputError(f"{label}: there is nothing to show in 3D: its mechanism has no presenter")
