"""Effects as tables: for each measure the effect of every contributor, and the matrix of all as a file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

from tol3d.analyses.tolerance_effects import ContributorEffects, Effects, Index, MeasureEffects
from tol3d.report.declared import declared_table
from tol3d.report.number import measured_text, share_text
from tol3d.report.page import BLANK, Line, Page, PageItem, Table, note, page, title, titled
from tol3d.study.runs.summary.shows import Computed, Shows, columns_of

MOST_SHOWN: Final = 15
"""Contributors of a measure."""
WORDS: Final = (
    "per unit: change of the measure per unit of the deviation, at the mean build; over all: range of the measure over "
    "the whole tolerance, the others at their means; first, total: Sobol' indices, the share of the variance of a "
    "contributor alone, and with all its interactions; ± 95 %"
)
POSITIONS: Final[Mapping[str, str]] = {
    "averaged": "at a position, averaged over positions",
    "input": "the position is an input",
    "none": "",
}


def effects_report(found: Effects) -> Page:
    """Effects of contributors on each measure, the largest first."""
    head = Line(((found.scene, "bold"), (f" · effects of contributors, {found.evaluations} builds", "")))
    blocks: list[PageItem] = [head]
    for name, own in found.measures.items():
        if own.contributors or own.position:
            blocks += titled(name, _table(own).shortened(MOST_SHOWN))
        else:
            blocks.append(title(name))
        blocks += map(note, _words(own))
    where = POSITIONS[found.positions]
    return page(*blocks, BLANK, note(WORDS + (f"; {where}" if where else "")))


def _table(effects: MeasureEffects) -> Table:
    parts: list[tuple[str, ContributorEffects]] = list(effects.contributors.items())
    if effects.position is not None:
        parts.append(("position", effects.position))
    ranked = sorted(parts, key=lambda each: -_size(each[1]))
    return declared_table("", ranked, effects.unit)


def _size(contributor_effects: ContributorEffects) -> float:
    """By which contributors are ranked."""
    shown = contributor_effects.shapley or contributor_effects.total
    return shown.share if shown is not None else -1.0


def _words(effects: MeasureEffects) -> Sequence[str]:
    if not effects.contributors and effects.position is None:
        out = "" if effects.failing_ppm is None else f", {share_text(effects.failing_ppm)} out of limits"
        return [f"{measured_text(effects.mean, effects.unit)} in all builds{out}: {effects.failures_words}"]
    spread = [f"mean {measured_text(effects.mean, effects.unit)}, sigma {measured_text(effects.sigma, effects.unit)}"]
    if effects.sum_of_first is not None and effects.sum_of_total is not None:
        first, total = effects.sum_of_first, effects.sum_of_total
        spread.append(f"sum of first indices {_plain(first)}, of total ones {_plain(total)}")
    groups = dict.fromkeys(
        tuple(contributor.together) for contributor in effects.contributors.values() if len(contributor.together) > 1
    )
    told = [", ".join(spread)]
    if groups:
        together = "; ".join(", ".join(group) for group in groups)
        told.append(f"indices of correlated contributors are those of all together: {together}")
    if effects.not_seated:
        told.append(
            f"{effects.not_seated} of {effects.builds} builds could not be assembled: left out of indices, "
            "counted as failures"
        )
    if effects.failing_ppm is not None:
        by = "shares by " if effects.failures_by else ""
        told.append(
            f"failures: {share_text(effects.failing_ppm)} of {effects.builds} builds; {by}{effects.failures_words}"
        )
    return told


def _plain(index: Index) -> str:
    return f"{index.share:.2f} ±{(index.high - index.low) / 2:.2f}"


@dataclass(frozen=True)
class EffectRow:
    """Effect of a contributor on a measure, with all digits."""

    of: ContributorEffects
    contributor: Annotated[str, Shows("contributor")]
    measure_unit: Annotated[str, Shows("measure unit")]
    own_unit = Computed(Shows("contributor unit"), lambda own: own.of.unit)
    slope = Computed(Shows("slope", "g"), lambda own: own.of.slope)
    change = Computed(Shows("change", "g"), lambda own: own.of.change)
    indices = Computed(Shows("{key}", "g"), lambda own: _numbers(own.of))


def _numbers(contributor_effects: ContributorEffects) -> Mapping[str, float | None]:
    """Each index, and the ends of its 95 %."""
    ends = {"": "share", "_low_95": "low", "_high_95": "high"}
    names = [name for name, shows in columns_of(contributor_effects).items() if shows.form == "index"]
    return {
        f"{name}{end}": getattr(getattr(contributor_effects, name), key, None)
        for name in names
        for end, key in ends.items()
    }


def whole_table(found: Effects) -> Table:
    """A row for each measure and contributor, all numbers with all their digits."""
    rows = []
    for name, own in found.measures.items():
        parts = {**own.contributors, **({"position": own.position} if own.position else {})}
        for contributor, each in parts.items():
            rows.append((name, EffectRow(each, contributor, own.unit)))
    return declared_table("measure", rows)
