"""Presentation of planetary sets: every gear in its place, and the data of a scene's set."""

from collections.abc import Mapping, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final

from tol3d.gearing.planetary.summary_types import PlanetaryOfRun, SpringSummary
from tol3d.gearing.presenting import PRESENTER as TRAINS
from tol3d.gearing.reducers.presenting import ReducerPresenter
from tol3d.study.runs.summary.run import RunSummary

if TYPE_CHECKING:
    from tol3d.report.page import PageItem
    from tol3d.report.presenter import Display, Draw, Which
    from tol3d.study.runs.run import Run
    from tol3d.study.trials.simulation import Simulation


class PlanetaryPresenter(ReducerPresenter):
    """The presenter of planetary sets."""

    def pictures(self, summary: RunSummary) -> "Mapping[str, Draw]":
        """Chains of trains, and the torque curve of a set whose carrier has a spring: "torque-curve"."""
        sets = (summary.planetary_sets or {}) if isinstance(summary, PlanetaryOfRun) else {}
        springs = [own.spring for own in sets.values() if own.spring is not None][:1]
        curves = {"torque-curve": partial(_draw_curve, spring) for spring in springs}  # noqa: B035 - one set at most
        return {**super().pictures(summary), **curves}

    def sections(self, summary: RunSummary) -> "Sequence[PageItem]":
        """Efficiencies and torques of the set; of former versions also tables of a train around it."""
        return (*super().sections(summary), *self.link_sections(summary))

    def check(self, simulation: "Simulation") -> "Sequence[PageItem]":
        """Data of the set, the backlash of its meshes, then the items of any system."""
        return import_module(self.tables).check_blocks(simulation)  # type: ignore[no-any-return]

    def display(self, run: "Run", which: "Which", *, magnify: float) -> "Display":
        """A build with its gears placed again; of former versions a train around the set too."""
        if getattr(run.found, "trains", None):
            return TRAINS.display(run, which, magnify=magnify)
        return super().display(run, which, magnify=magnify)


def _draw_curve(spring: SpringSummary, path: Path) -> None:
    import_module("tol3d.gearing.planetary.hysteresis_picture").draw_curve(spring.curve, path)


PRESENTER: Final = PlanetaryPresenter(
    tables="tol3d.gearing.planetary.presenting.tables",
    results="tol3d.gearing.planetary.presenting.tables",
    builds="tol3d.gearing.planetary.presenting.shown_gears",
)
