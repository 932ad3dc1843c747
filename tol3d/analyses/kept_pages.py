"""Sections that a run keeps, each as its command shows it: for reports."""

from collections.abc import Mapping
from typing import Any, Final

from tol3d.analyses.subject import sections_of
from tol3d.import_path import named
from tol3d.report.page import Page
from tol3d.runs.run import Run
from tol3d.simulate import simulation_again

TITLES: Final[Mapping[str, str]] = {
    "changes": "what to change",
    "methods": "methods side by side",
    "effects": "effects",
    "rare": "rare events",
    "what-if": "what if",
    "allocation": "allocation",
}
REPORTS: Final[Mapping[str, str]] = {
    "changes": "tol3d.analyses.what_to_change_table:changes_report",
    "methods": "tol3d.analyses.methods_table:methods_report",
    "effects": "tol3d.analyses.effects_table:effects_report",
    "rare": "tol3d.analyses.rare_table:rare_report",
    "what-if": "tol3d.analyses.what_if_table:what_if_report",
    "allocation": "tol3d.analyses.allocate_table:allocation_report",
}
"""What makes the page of each section, as an import path: a report loads the analyses that its run keeps."""
BEST_CHANGE: Final = "tol3d.analyses.what_to_change_table:best_change"


def kept_pages(run: Run) -> Mapping[str, Page]:
    """Pages of the sections that a run keeps, by their titles.

    Raises:
        RunError: one was changed since it was made.
    """
    found = sections_of(run)
    return {title: _page(run, name, found[name]) for name, title in TITLES.items() if name in found}


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
    return {TITLES["effects"]: {name: _totals(own) for name, own in effects.measures.items()}}


def _totals(own: Any) -> Mapping[str, float]:
    """Total Sobol' indices [%] of a measure's effects, Shapley effects where there are some."""
    shown = {name: each.shapley or each.total for name, each in own.contributors.items()}
    return {name: 100 * max(index.share, 0.0) for name, index in shown.items() if index is not None}


def _page(run: Run, name: str, found: Any) -> Page:
    """The page of a section; those that have no name of their scene are given it."""
    report: Any = named(REPORTS[name])
    if name == "methods":
        page: Page = report(found, simulation_again(run).system.contributors)
    else:
        page = report(found) if hasattr(found, "scene") else report(run.found.scene, found)
    return page
