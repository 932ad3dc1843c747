"""Presentation of RV reducers: the data of a scene's reducer."""

from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

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


class CycloidPresenter(GearPresenter):
    """The presenter of RV reducers; see `tol3d.report.presenter.Presenter`."""

    def sections(self, summary: "RunSummary") -> "Sequence[PageItem]":
        """Its cycloid stage by formula, published and by first principles, and the sense of a negative lost motion."""
        return (*_lazily("formulas").below_zero(summary), *self.link_sections(summary))

    def first_notes(self, summary: "RunSummary") -> "Sequence[PageItem]":
        """The sense of a negative lost motion; see ShowsNotes."""
        return _lazily("formulas").below_zero(summary)  # type: ignore[no-any-return]

    def check(self, simulation: "Simulation") -> "Sequence[PageItem]":
        """Data of the reducer, then the items of any system."""
        return _lazily("tables").check_blocks(simulation)  # type: ignore[no-any-return]

    def display(self, run: "Run", which: "Which", *, magnify: float) -> "Display":
        """A build with its first pin in contact."""
        return _lazily("shown_reducer").display(run, which, magnify=magnify)  # type: ignore[no-any-return]

    def replayed(self, replay: "Replay", label: str) -> "Display":
        """A trial that was replayed."""
        return _lazily("shown_reducer").replayed_display(replay, label)  # type: ignore[no-any-return]

    # reducers in trains -------------------------------------------------------------------------------

    def link_blocks(self, link: "StatedLink", contributors: "Sequence[Contributor]") -> "Sequence[PageItem]":
        """Data of a reducer; see ShowsLinks."""
        return _lazily("tables").link_blocks(link, contributors)  # type: ignore[no-any-return]

    def link_sections(self, summary: "RunSummary") -> "Sequence[PageItem]":
        """Cycloid stages by formula, and the meaning of a negative play of one in a train; see ShowsLinks."""
        return _lazily("formulas").link_sections(summary)  # type: ignore[no-any-return]

    def shown_link(self, link: "StatedLink", seen: "LinkTrials", world_from_driver: "Array") -> "ShownLink":
        """All parts of a reducer; see ShowsLinks."""
        return _lazily("shown_reducer").shown_link(link, seen, world_from_driver)  # type: ignore[no-any-return]


def _lazily(module: str) -> Any:
    """A module of this folder, imported when it is needed."""
    return import_module(f"{__name__}.{module}")


PRESENTER: Final = CycloidPresenter()
