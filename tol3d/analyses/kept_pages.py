"""Sections that a run keeps, each as its command shows it: for reports."""

from collections.abc import Mapping
from typing import Any, Final

from tol3d.analyses.subject import KEPT, sections_of
from tol3d.import_path import named
from tol3d.report.chart import Charts
from tol3d.report.page import Page
from tol3d.study.runs.run import Run
from tol3d.study.runs.summary.values import Section

BEST_CHANGE: Final = "tol3d.analyses.shown_changes:best_change"


def kept_pages(run: Run) -> Mapping[str, Page]:
    """Pages of the sections that a run keeps, by their titles.

    Raises:
        RunError: one was changed since it was made.
    """
    found = sections_of(run)
    return {own.title: page_of(name, found[name], run.found.scene) for name, own in KEPT.items() if name in found}


def kept_charts(run: Run) -> Mapping[str, Charts]:
    """Charts of the sections that a run keeps, by their titles.

    Raises:
        RunError: one was changed since it was made.
    """
    return {KEPT[name].title: charts_of(name, own, run.found.scene) for name, own in sections_of(run).items()}


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


def page_of(name: str, found: Section, scene: str) -> Page:
    """The page of an analysis.

    Args:
        name: of the analysis.
        found: its result.
        scene: name of the scene.
    """
    page: Page = named(KEPT[name].report)(*_with_scene(scene, found))
    return page


def charts_of(name: str, found: Section, scene: str) -> Charts:
    """The charts of an analysis; see `page_of`."""
    charts: Charts = named(KEPT[name].charts)(*_with_scene(scene, found))
    return charts


def _with_scene(scene: str, found: Section) -> tuple[Any, ...]:
    """A result, behind the name of its scene where it has none."""
    return (found,) if "scene" in type(found).model_fields else (scene, found)
