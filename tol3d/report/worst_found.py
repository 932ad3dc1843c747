"""Worst cases that were found before any trial, as lines and as a table."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.report.declared import declared_table
from tol3d.report.number import NOTHING, UM_PER_MM, measured_text
from tol3d.report.page import PageItem, note, titled
from tol3d.study.effects.worst_case import WorstBuild, WorstCase
from tol3d.study.effects.worst_cases import worst_cases
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.system.measure import Measure
from tol3d.study.system.outcome import OK
from tol3d.study.trials.simulation import Simulation

WORST_FOUND: Final = (
    "worst found: the worst of a search among builds within the tolerances, at rest; worse ones may exist; left out if "
    "it would take too many builds"
)


def worst_text(simulation: Simulation, measure: Measure, unit: str, found: WorstCase | None) -> str:
    """The worst builds of a measure in the unit in which it is shown, told where one fails; "" for none."""
    if found is None:
        return ""
    ends = (_end_text(simulation, measure, unit, own) for own in (found.low, found.high))
    unbuilt = found.unseated if found.unseated is not None and not measure.keeps_overlap else None
    texts = simulation.system.statuses.texts
    told = f"; builds within the tolerances cannot be assembled: {texts[unbuilt.code]}" if unbuilt is not None else ""
    return f"worst found {' … '.join(ends)}{told}"


@dataclass(frozen=True)
class WorstRow:
    """The worst builds of a measure by each method."""

    lowest: Annotated[Mapping[str, str], Shows("lowest, {key}", "words")]
    highest: Annotated[Mapping[str, str], Shows("highest, {key}", "words")]


def worst_blocks(simulation: Simulation) -> list[PageItem]:
    """Worst cases of all measures of one number as a table, by each method; nothing where none was looked for."""
    method = method_of(simulation, materials_of(simulation))
    measures = [own for own in simulation.system.measures if own.take != "curve"]
    found = worst_cases(simulation, method, measures)
    headings = {"analytic": "analytic"} | ({"geometric": simulation.study.engine} if method else {})
    rows = []
    for measure in measures:
        worst = {name: found[measure.name][method] for method, name in headings.items()}
        if any(found[measure.name].values()):
            ends = [{name: getattr(each, end, None) for name, each in worst.items()} for end in ("low", "high")]
            low, high = (
                {name: _end_text(simulation, measure, measure.unit, each) for name, each in of.items()} for of in ends
            )
            rows.append((measure.name, WorstRow(low, high)))
    if not rows:
        return []
    return [*titled("worst found", declared_table("", rows)), note(WORST_FOUND)]


def _end_text(simulation: Simulation, measure: Measure, unit: str, build: WorstBuild | None) -> str:
    if build is None:
        return NOTHING
    value = build.value / UM_PER_MM if unit != measure.unit else build.value
    text = measured_text(value, unit)
    return text if build.code == OK else f"{text} ({simulation.system.statuses.texts[build.code]})"
