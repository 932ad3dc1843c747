"""Rare events as tables: probability beyond each limit, and the most likely build beyond it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.analyses.rare_section import DesignBuild, LimitLeft, RareEvents
from tol3d.report.declared import declared_table
from tol3d.report.number import number_text
from tol3d.report.page import BLANK, Line, Page, PageItem, note, page, titled, warning
from tol3d.study.runs.summary.shows import Shows

MOST_SHOWN: Final = 8
"""Contributors of a design point."""
METHOD_WORDS: Final = {
    "importance": "importance sampling about the design points",
    "subset": "subset simulation",
    "form": "first order alone",
    "sorm": "second order alone",
}
BETA_WORDS: Final = (
    "β: distance of the design point, the most likely build beyond the limit, in standard normals; first order: Φ(−β), "
    "averaged over positions"
)
SUBSET_WORDS: Final = (
    "subset simulation takes about 100000 builds for 10 to 15 % at 0.1 ppm; β: of the failing build nearest to the "
    "mean that was met, an upper bound"
)


def rare_report(found: RareEvents) -> Page:
    """Probabilities of leaving limits, then the design point of each."""
    table = declared_table("", [(own.measure, own) for own in found.limits])
    blocks: list[PageItem] = [Line(((found.scene, "bold"), (" · fraction out of limits", ""))), BLANK, table]
    blocks += [note(words) for words in _notes(found.limits)]
    for limit in found.limits:
        blocks += [warning(f"{limit.measure}, {limit.words}: {words}") for words in limit.warnings]
    for own in found.limits:
        if own.design_point is not None:
            blocks += _design_point(own, own.design_point)
    return page(*blocks)


def _notes(limits: Sequence[LimitLeft]) -> Iterator[str]:
    methods = dict.fromkeys(own.method for own in limits)
    words = ", ".join(METHOD_WORDS[method] for method in methods)
    yield f"ppm: by {words}; builds that cannot be assembled count as out"
    yield SUBSET_WORDS if set(methods) == {"subset"} else BETA_WORDS
    if any(own.second_order_ppm is not None for own in limits):
        yield "second order: with the curvatures of the limit, by Hohenbichler and Rackwitz"
    for limit in limits:
        if limit.unseated_percent > 0.0:
            share = f"{limit.unseated_percent:.1f} % of the failing builds"
            yield f"{limit.measure}, {limit.words}: {share} cannot be assembled"


@dataclass(frozen=True)
class DesignRow:
    """A contributor in the most likely build beyond a limit."""

    deviation: Annotated[str, Shows("deviation")]
    unit_sign: Annotated[str, Shows("unit", "words")]
    share: Annotated[float, Shows("share of the distance [%]", ".1f")]


def _design_point(limit_left: LimitLeft, build: DesignBuild) -> Sequence[PageItem]:
    """Deviations of the contributors that lead there, the largest parts first."""
    rows = []
    for contributor in build.contributors[:MOST_SHOWN]:
        told = ", ".join(number_text(round(value, 3) + 0.0) for value in contributor.deviations)
        unit = "µm" if contributor.unit == "um" else contributor.unit
        rows.append((contributor.name, DesignRow(told, unit, contributor.percent)))
    side = "below" if limit_left.side == "low" else "above"
    kind = "within" if build.beta < 0.0 else side
    end = "lower" if limit_left.side == "low" else "upper"
    title = f"{limit_left.measure}: the most likely build {kind} its {end} limit"
    at = ", ".join(f"{name} {number_text(round(value, 2))}" for name, value in build.positions.items())
    return [*titled(title, declared_table("", rows)), *([note(at)] if at else [])]
