"""Sections that a run keeps, each as its command shows it: for reports."""

from collections.abc import Mapping
from typing import Final

from tol3d.analyses.allocate_table import allocation_report
from tol3d.analyses.allocation_section import Allocation
from tol3d.analyses.effects import Effects, MeasureEffects
from tol3d.analyses.effects_table import effects_report
from tol3d.analyses.methods_section import Methods
from tol3d.analyses.methods_table import methods_report
from tol3d.analyses.rare_section import RareEvents
from tol3d.analyses.rare_table import rare_report
from tol3d.analyses.subject import sections_of
from tol3d.analyses.what_if import WhatIf
from tol3d.analyses.what_if_table import what_if_report
from tol3d.analyses.what_to_change import Changes
from tol3d.analyses.what_to_change_table import best_change, changes_report
from tol3d.report.page import Page
from tol3d.runs.run import Run
from tol3d.runs.summary.values import Section
from tol3d.simulate import simulation_again

TITLES: Final[Mapping[str, str]] = {
    "changes": "what to change",
    "methods": "methods side by side",
    "effects": "effects",
    "rare": "rare events",
    "what-if": "what if",
    "allocation": "allocation",
}


def kept_pages(run: Run) -> Mapping[str, Page]:
    """Pages of the sections that a run keeps, by their titles.

    Raises:
        RunError: one was changed since it was made.
    """
    found = sections_of(run)
    return {title: _page(run, found[name]) for name, title in TITLES.items() if name in found}


def kept_advice(run: Run) -> str:
    """The best change of those that a run keeps, in a line; "" for none.

    Raises:
        RunError: they were changed since they were made.
    """
    found = sections_of(run).get("changes")
    return best_change(found) if isinstance(found, Changes) else ""


def kept_shares(run: Run) -> Mapping[str, Mapping[str, Mapping[str, float]]]:
    """Shares of contributors [%] by measure, of the sections that have them, by the sections' titles.

    Raises:
        RunError: one was changed since it was made.
    """
    effects = sections_of(run).get("effects")
    if not isinstance(effects, Effects):
        return {}
    return {TITLES["effects"]: {name: _totals(own) for name, own in effects.measures.items()}}


def _totals(own: MeasureEffects) -> Mapping[str, float]:
    """Total Sobol' indices [%], Shapley effects where there are some."""
    shown = {name: each.shapley or each.total for name, each in own.contributors.items()}
    return {name: 100 * max(index.share, 0.0) for name, index in shown.items() if index is not None}


def _page(run: Run, own: Section) -> Page:
    scene = run.found.scene
    match own:
        case Effects():
            return effects_report(own)
        case Methods():
            return methods_report(own, simulation_again(run).system.contributors)
        case RareEvents():
            return rare_report(own)
        case WhatIf():
            return what_if_report(scene, own)
        case Changes():
            return changes_report(scene, own)
        case Allocation():
            return allocation_report(scene, own)
        case _:
            raise AssertionError(f"a section without a page: {type(own).__name__}")
