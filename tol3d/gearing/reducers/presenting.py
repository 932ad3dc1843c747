"""Presentation of reducers alone and in trains: the part that those of all models share."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from tol3d.gearing.presenting import DISPLAY, GearPresenter
from tol3d.report.presenter import SYSTEM_CHECK

if TYPE_CHECKING:
    from tol3d.gearing.links import LinkTrials, StatedLink
    from tol3d.gearing.presenting.shown_train import ShownLink
    from tol3d.numerics.arrays import Array
    from tol3d.report.page import PageItem
    from tol3d.report.presenter import Display
    from tol3d.study.results.replaying import Replay
    from tol3d.study.runs.summary.run import RunSummary
    from tol3d.study.system.contributor import Contributor
    from tol3d.study.trials.simulation import Simulation


@dataclass(frozen=True)
class ReducerPresenter(GearPresenter):
    """The presenter of a kind of reducers; see `tol3d.report.presenter.Presenter` and ShowsLinks.

    Its modules are imported when they are needed: a table needs no picture, a picture no model.

    Args:
        tables: module of `blocks`, the data of a scene's reducer, of its system or its link and their contributors.
        results: module of `link_sections`, the tables of a run besides those of its measures.
        builds: module of `display_of` and `shown_link`, a build alone and in a train.
    """

    tables: str
    results: str
    builds: str

    def check(self, simulation: "Simulation") -> "Sequence[PageItem]":
        """Data of the reducer, then the items of any system."""
        system = simulation.system
        blocks = import_module(self.tables).blocks(system, system.contributors)
        return (*blocks, *import_module(SYSTEM_CHECK).system_blocks(simulation))

    def shown(self, build: "Replay", label: str, *, magnify: float) -> "Display":
        """A build with its parts in contact again."""
        seen, label, notes = import_module(DISPLAY).magnified_build(build, label, magnify)
        return import_module(self.builds).display_of(label, seen.build, notes)  # type: ignore[no-any-return]

    def link_blocks(self, link: "StatedLink", contributors: "Sequence[Contributor]") -> "Sequence[PageItem]":
        """Data of a reducer in a train."""
        return import_module(self.tables).blocks(link, contributors)  # type: ignore[no-any-return]

    def link_sections(self, summary: "RunSummary") -> "Sequence[PageItem]":
        """Its tables in a run of a train."""
        return import_module(self.results).link_sections(summary)  # type: ignore[no-any-return]

    def shown_link(self, link: "StatedLink", seen: "LinkTrials", world_from_driver: "Array") -> "ShownLink":
        """All its parts in the world of a train."""
        return import_module(self.builds).shown_link(link, seen, world_from_driver)  # type: ignore[no-any-return]
