"""Presentation of reducers alone and in trains: the part that those of all models share."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from tol3d.gearing.presenting import GearPresenter

if TYPE_CHECKING:
    from tol3d.gearing.links import LinkTrials, StatedLink
    from tol3d.gearing.presenting.shown_train import ShownLink
    from tol3d.numerics.arrays import Array
    from tol3d.report.page import PageItem
    from tol3d.report.presenter import Display, Which
    from tol3d.runs.run import Run
    from tol3d.runs.summary.run import RunSummary
    from tol3d.study.replaying import Replay
    from tol3d.study.simulation import Simulation
    from tol3d.system.contributor import Contributor


@dataclass(frozen=True)
class ReducerPresenter(GearPresenter):
    """The presenter of a kind of reducers; see `tol3d.report.presenter.Presenter` and ShowsLinks.

    Its modules are imported when they are needed: a table needs no picture, a picture no model.

    Args:
        tables: module of `check_blocks` and `link_blocks`, the data of a scene's reducer alone and in a train.
        results: module of `link_sections`, the tables of a run besides those of its measures.
        builds: module of `display`, `replayed_display` and `shown_link`, a build alone, replayed and in a train.
    """

    tables: str
    results: str
    builds: str

    def check(self, simulation: "Simulation") -> "Sequence[PageItem]":
        """Data of the reducer, then the items of any system."""
        return import_module(self.tables).check_blocks(simulation)  # type: ignore[no-any-return]

    def display(self, run: "Run", which: "Which", *, magnify: float) -> "Display":
        """A build with its parts in contact again."""
        return import_module(self.builds).display(run, which, magnify=magnify)  # type: ignore[no-any-return]

    def replayed(self, replay: "Replay", label: str) -> "Display":
        """A trial that was replayed."""
        return import_module(self.builds).replayed_display(replay, label)  # type: ignore[no-any-return]

    def link_blocks(self, link: "StatedLink", contributors: "Sequence[Contributor]") -> "Sequence[PageItem]":
        """Data of a reducer in a train."""
        return import_module(self.tables).link_blocks(link, contributors)  # type: ignore[no-any-return]

    def link_sections(self, summary: "RunSummary") -> "Sequence[PageItem]":
        """Its tables in a run of a train."""
        return import_module(self.results).link_sections(summary)  # type: ignore[no-any-return]

    def shown_link(self, link: "StatedLink", seen: "LinkTrials", world_from_driver: "Array") -> "ShownLink":
        """All its parts in the world of a train."""
        return import_module(self.builds).shown_link(link, seen, world_from_driver)  # type: ignore[no-any-return]
