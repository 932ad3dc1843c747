"""Presentation of RV reducers: the data of a scene's reducer."""

from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Final

from tol3d.gearing.reducers.presenting import ReducerPresenter

if TYPE_CHECKING:
    from tol3d.report.page import PageItem
    from tol3d.study.runs.summary.run import RunSummary


class CycloidPresenter(ReducerPresenter):
    """The presenter of RV reducers."""

    def sections(self, summary: "RunSummary") -> "Sequence[PageItem]":
        """Its cycloid stage by formula, published and by first principles, and the sense of a negative lost motion."""
        return (*self.first_notes(summary), *self.link_sections(summary))

    def first_notes(self, summary: "RunSummary") -> "Sequence[PageItem]":
        """The sense of a negative lost motion; see ShowsNotes."""
        return import_module(self.results).below_zero(summary)  # type: ignore[no-any-return]


PRESENTER: Final = CycloidPresenter(
    tables="tol3d.gearing.cycloid.presenting.tables",
    results="tol3d.gearing.cycloid.presenting.tables",
    builds="tol3d.gearing.cycloid.presenting.shown_reducer",
)
