"""Sections that a run keeps, each as its command shows it: for reports."""

from collections.abc import Mapping
from typing import Any, Final

from tol3d.analyses.subject import KEPT, sections_of
from tol3d.import_path import named
from tol3d.report.page import Page
from tol3d.runs.run import Run
from tol3d.simulate import simulation_again

BEST_CHANGE: Final = "tol3d.analyses.what_to_change_table:best_change"


def kept_pages(run: Run) -> Mapping[str, Page]:
    """Pages of the sections that a run keeps, by their titles.

    Raises:
        RunError: one was changed since it was made.
    """
    found = sections_of(run)
    return {own.title: _page(run, name, found[name]) for name, own in KEPT.items() if name in found}


def kept_advice(run: Run) -> str:
    """The best change of those that a run keeps, in a line; "" for none.

    Raises:
        RunError: they were changed since they were made.
    """
    found = sections_of(run).get("changes")
    return "" if found is None else str(named(BEST_CHANGE)(found))


def kept_shares(run: Run) -> Mapping[str, Mapping[str, Mapping[str, float]]]:
    """Shares of contributors [%] by measure, of the sections that have them, by the sections' titles.

    Raises:
        RunError: one was changed since it was made.
    """
    effects: Any = sections_of(run).get("effects")
    if effects is None:
        return {}
    return {KEPT["effects"].title: {name: _totals(own) for name, own in effects.measures.items()}}


def _totals(own: Any) -> Mapping[str, float]:
    """Total Sobol' indices [%] of a measure's effects, Shapley effects where there are some."""
    shown = {name: each.shapley or each.total for name, each in own.contributors.items()}
    return {name: 100 * max(index.share, 0.0) for name, index in shown.items() if index is not None}


def _page(run: Run, name: str, found: Any) -> Page:
    """The page of a section; those that have no name of their scene are given it."""
    report: Any = named(KEPT[name].report)
    if name == "methods":
        page: Page = report(found, simulation_again(run).system.contributors)
    else:
        page = report(found) if hasattr(found, "scene") else report(run.found.scene, found)
    return page
