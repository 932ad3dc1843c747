"""Tables of any scene: contributors, measures, and the effect of each contributor on each measure."""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from tol3d.report.declared import declared_table
from tol3d.report.heading import MOST_MEASURES, WORST_FIRST, badness, largest
from tol3d.report.number import NOTHING, UM_PER_MM, UNIT_SIGNS, limits_text, measured_text, unsigned_zero, value_text
from tol3d.report.page import Further, Line, PageItem, Row, Shown, Table, note, some, titled, warning
from tol3d.report.shown_unit import shown_unit
from tol3d.report.worst_found import WORST_FOUND, worst_text
from tol3d.statistics.distributions import DeviationLaw, Distribution, Empirical
from tol3d.statistics.distributions.derived import Derived
from tol3d.statistics.estimates.limits import normal_share
from tol3d.study.effects.acting_contributors import acting, nothing_acts
from tol3d.study.effects.first_order import FirstOrder, FirstOrderEffect, first_orders
from tol3d.study.effects.worst_cases import worst_cases
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.runs.summary.shows import Computed, RowOf, Shows
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.draw import JointDraw, MiddleDraw, drawn_each, told_sigma
from tol3d.study.system.measure import Measure
from tol3d.study.trials.simulation import Simulation

SLOPES = (
    "slope: change of the measure per unit of the deviation at the mean build, from differences over ± one sigma; for "
    "several components the length of their gradient"
)
EACH = "each: of every single deviation, such as one per planet; greatest: of the one with the largest effect"
SHARES = "RSS: share of the variance by root sum of squares; worst: share of the sum of all ranges"
MIDDLE = (
    "sigma of a zone: of the middle of its feature along one axis; of an orientation alone, of a rise at the edge or "
    "an end of the axis; a process draws both ends of an axis, so that the middle has 1/√2 of its sigma"
)
NO_SUM = "no sum of effects, so no RSS: slopes are means over ± one sigma; tol3d run simulates the measure"
BESIDE = 1e-6  # um or arcmin; a value nearer to a limit lies on it


def system_blocks(simulation: Simulation, long_in_mm: Collection[str] = ()) -> list[PageItem]:
    """Contributors, measures and first-order coefficients by both methods, of any kind of system.

    Args:
        simulation: of the scene.
        long_in_mm: names of measures whose values are shown in mm where they are nominally over 1 mm.
    """
    system, study = simulation.system, simulation.study
    method = method_of(simulation, materials_of(simulation))
    headings = {"analytic": "analytic"} | ({"geometric": study.engine} if method else {})
    found: dict[str, dict[str, FirstOrder]] = {measure.name: {} for measure in system.measures}
    found |= first_orders(simulation, method, [measure for measure in system.measures if measure.take != "curve"])
    worst = worst_cases(simulation, method, [measure for measure in system.measures if found[measure.name]])
    units = {
        name: shown_unit(own.unit, _nominal(found[name])) if name in long_in_mm else own.unit
        for name, own in ((measure.name, measure) for measure in system.measures)
    }
    kinds = {measure.name: str(system.describe(measure).get("kind", NOTHING)) for measure in system.measures}
    shown, left = _worst(system.measures, found)

    def coefficients(measures: Sequence[Measure]) -> list[PageItem]:
        return [
            block
            for measure in measures
            if found[measure.name] and acting(simulation, measure)
            for block in _coefficients(
                measure,
                units[measure.name],
                found[measure.name],
                headings,
                {
                    name: worst_text(simulation, measure, units[measure.name], own)
                    for name, own in worst[measure.name].items()
                },
            )
        ]

    def listed(measures: Sequence[Measure]) -> Table:
        rows = [
            _measure_row(measure, units[measure.name], kinds[measure.name], found[measure.name], headings)
            for measure in measures
        ]
        return declared_table("", [(own.name, row) for own, row in zip(measures, rows, strict=True)])

    tables, further = coefficients(shown), None
    if left:
        words = f"\nand {len(left)} more measures; shown are the {len(shown)} worst, {WORST_FIRST} by first order"
        tables.append(Line(((words, ""),), stands_for=lambda: coefficients(left)))
        blank = [""] * len(listed(left).headings)
        further = Further(Row(f"and {len(left)} more", blank, "dim"), lambda: listed(left).rows)
    sums = any(measure.adds_up and found[measure.name] for measure in system.measures)
    several = any(effect.each > 1 for own in found.values() for method in own.values() for effect in method.effects)
    searched = any(own is not None for by_method in worst.values() for own in by_method.values())
    texts = (SLOPES, *([EACH] if several else []), *([SHARES] if sums else []), *([WORST_FOUND] if searched else []))
    notes = [note(text) for text in texts] if tables else []
    measures = titled("measures", replace(listed(shown), further=further))
    asked = system.measures if system.contributors else ()
    idle = [f"{own.name}: {words}" for own in asked if (words := nothing_acts(simulation, own))]
    outside = [
        text for measure in system.measures for text in _outside(measure, units[measure.name], found[measure.name])
    ]
    return [
        *_contributors(system.contributors),
        *measures,
        *map(warning, some([*outside, *idle])),
        *tables,
        *notes,
    ]


def _worst(
    measures: Sequence[Measure], found: Mapping[str, Mapping[str, FirstOrder]]
) -> tuple[Sequence[Measure], Sequence[Measure]]:
    """The measures that are shown and the others: of many the worst, were they normal with a sigma by first order."""
    if len(measures) <= MOST_MEASURES:
        return measures, ()
    ranked = sorted(measures, key=lambda own: _badness(own, [*found[own.name].values()]))
    return ranked[:MOST_MEASURES], ranked[MOST_MEASURES:]


def _badness(measure: Measure, methods: Sequence[FirstOrder]) -> tuple[float, float]:
    """A key that sorts the worst first, by the last method that knows its sigma."""
    known = [
        method
        for method in methods
        if math.isfinite(method.mean) and math.isfinite(method.sigma) and method.sigma > 0.0
    ]
    if not known:
        return badness(None, None)
    own, per = known[-1], measure.per_internal
    margins = [] if measure.lower_limit is None else [own.mean - measure.lower_limit * per]
    margins += [] if measure.upper_limit is None else [measure.upper_limit * per - own.mean]
    ppk = min(margins) / (3 * own.sigma) if margins else None
    return badness(1e6 * sum(normal_share(margin, own.sigma) for margin in margins), ppk)


def _nominal(found: Mapping[str, FirstOrder]) -> float | None:
    """The nominal value by the first method that has one."""
    return next((own.nominal for own in found.values() if not math.isnan(own.nominal)), None)


def law_name(law: DeviationLaw) -> str:
    """A distribution in words, such as "truncated normal"."""
    return law.words if isinstance(law, Distribution) else type(law).__name__.lower()


def law_words(contributor: Contributor) -> str:
    """The law of a contributor and what is drawn by it: "rayleigh, random direction", "normal, each of 6"."""
    draw = contributor.draw
    if isinstance(draw, JointDraw):
        return draw.words
    law, count = law_name(draw.distribution), len(draw.components)
    if count == 1:
        return law
    if drawn_each(draw):
        return f"{law}, each of {count}"
    return f"{law}, random direction" if draw.uniforms > 1 else f"{law}, fixed direction"


def sample_notes(laws: Iterable[tuple[str, DeviationLaw, float, str]]) -> list[Line]:
    """A note on each law of measured values: their number, s, and the law's tails.

    Args:
        laws: name of the contributor, its law, mm, rad or K of its unit, and the unit.
    """
    notes = []
    for name, stated, per, unit in laws:
        law = stated.measured if isinstance(stated, Derived) else stated
        if isinstance(law, Empirical):
            spread, own, sign = float(np.std(law.values, ddof=1)) / per, law.sigma / per, UNIT_SIGNS[unit]
            first, last = (f"{unsigned_zero(f'{end / per:.4g}')} {sign}" for end in law.extremes)
            words = f"{len(law.values)} measured values, s {spread:.3g} {sign} (n − 1)"
            if law.draws == "smoothed":
                words += f", smoothed to sigma {own:.3g} {sign}; tails end at {first} and {last}, by the sample alone"
            else:
                words += f", each drawn as often: sigma {own:.3g} {sign} (n); no tails beyond {first} and {last}"
            notes.append(note(f"{name}: {words}"))
    return notes


class ContributorRow(RowOf[Contributor]):
    """A contributor in its unit."""

    kind = Computed(Shows("kind", "words"), lambda own: own.of.kind)
    law = Computed(Shows("law", "words"), lambda own: law_words(own.of))
    mean = Computed(Shows("mean", ".4g"), lambda own: own.of.distribution.mean / own.of.per_unit)
    sigma = Computed(Shows("sigma", ".3g"), lambda own: told_sigma(own.of.draw) / own.of.per_unit)
    unit_sign = Computed(Shows("unit"), lambda own: UNIT_SIGNS[own.of.unit])
    least = Computed(Shows("least", "g"), lambda own: None if own.of.least is None else own.of.least / own.of.per_unit)


@dataclass(frozen=True)
class MeasureRow:
    """A measure, and its value in the nominal build and in that at all means by each method."""

    kind: Annotated[str, Shows("kind", "words")]
    limits: Annotated[str, Shows("limits", "words")]
    nominal: Annotated[Mapping[str, Shown], Shows("nominal, {key}")]
    mean: Annotated[Mapping[str, Shown], Shows("mean build, {key}")]
    unit_sign: Annotated[str, Shows("unit")]


@dataclass(frozen=True)
class SlopeRow:
    """The effect of a deviation on a measure by each method, and its shares [%] where effects add up."""

    unit_sign: Annotated[str, Shows("unit")]
    slope: Annotated[Mapping[str, str], Shows("slope, {key}", meaning=SLOPES)]
    rss: Annotated[Mapping[str, float], Shows("RSS [%], {key}", ".1f", meaning=SHARES)]
    worst: Annotated[Mapping[str, float], Shows("worst [%], {key}", ".1f", meaning=SHARES)]


def _contributors(contributors: Sequence[Contributor]) -> list[PageItem]:
    table = declared_table("", [(contributor.name, ContributorRow(contributor)) for contributor in contributors])
    notes = [note(MIDDLE)] if any(isinstance(contributor.draw, MiddleDraw) for contributor in contributors) else []
    notes += sample_notes(
        (contributor.name, contributor.draw.distribution, contributor.per_unit, contributor.unit)
        for contributor in contributors
    )
    return [*titled("contributors", table), *notes] if contributors else []


def _measure_row(
    measure: Measure, shown: str, kind: str, found: Mapping[str, FirstOrder], headings: Mapping[str, str]
) -> MeasureRow:
    """Row of a measure: its description, and its nominal and mean builds by each method."""
    nominal, mean = (
        {name: _value(measure, getattr(found.get(method), build, None), shown) for method, name in headings.items()}
        for build in ("nominal", "mean")
    )
    return MeasureRow(kind, _limits(measure, shown), nominal, mean, "′, ″" if shown == "arcmin" else UNIT_SIGNS[shown])


def _outside(measure: Measure, unit: str, found: Mapping[str, FirstOrder]) -> Iterator[str]:
    """A mean build out of a measure's limits, by the first method that finds it so; its nominal value, if out too."""
    for own in found.values():
        if _is_outside(measure, own.mean):
            words, value = ("nominal", own.nominal) if _is_outside(measure, own.nominal) else ("mean build", own.mean)
            text = f"{words} {measured_text(_in(measure, value, unit), unit)}"
            yield f"{measure.name}: {text} is outside its limits {_limits(measure, unit)}"
            return


def _is_outside(measure: Measure, value: float) -> bool:
    """True if a value [unit of the measure] is out of limits; False if it is unknown."""
    low, high, per = measure.lower_limit, measure.upper_limit, measure.per_internal
    return (low is not None and value < low * per - BESIDE) or (high is not None and value > high * per + BESIDE)


def _in(measure: Measure, value: float, unit: str) -> float:
    """A value of a measure in the unit in which it is shown."""
    return value / UM_PER_MM if unit != measure.unit else value


def _value(measure: Measure, value: float | None, unit: str) -> Shown:
    known = None if value is None or math.isnan(value) else _in(measure, value, unit)
    return Shown(value_text(known, unit), known)


def _limits(measure: Measure, unit: str) -> str:
    lower, upper = (
        None if limit is None else _in(measure, limit * measure.per_internal, unit)
        for limit in (measure.lower_limit, measure.upper_limit)
    )
    return limits_text(lower, upper, unit)


def _coefficients(
    measure: Measure,
    unit: str,
    found: Mapping[str, FirstOrder],
    headings: Mapping[str, str],
    worst: Mapping[str, str],
) -> list[PageItem]:
    """Changes by each deviation in the measure's own unit; ends in the one in which it is shown."""
    by_method = [own.effects for own in found.values()]
    wholes = [(sum(own.variance for own in method), sum(own.reach for own in method)) for method in by_method]
    every = list(zip(*by_method, strict=True))
    sizes = {k: effects[-1].variance for k, effects in enumerate(every) if not math.isnan(effects[-1].variance)}

    def row(unit: str, slopes: Iterable[str], parts: Sequence[tuple[float, float]]) -> SlopeRow:
        """Slopes, and shares of variances and reaches by method in percent of the whole."""
        names = [*headings.values()]
        rss, worst = (
            {name: _percent(part[k], whole[k]) for name, part, whole in zip(names, parts, wholes, strict=True)}
            if measure.adds_up
            else {}
            for k in range(2)
        )
        return SlopeRow(unit, dict(zip(names, slopes, strict=True)), rss, worst)

    def listed(which: Iterable[int]) -> Table:
        signs = [f"{UNIT_SIGNS[measure.unit]}/{UNIT_SIGNS[own[0].unit]}" for own in every]
        parts = [[(each.variance, each.reach) for each in own] for own in every]
        return declared_table("", [(every[k][0].name, row(signs[k], map(_slope, every[k]), parts[k])) for k in which])

    shown = largest(range(len(every)), sizes)
    left, further = sorted({*range(len(every))} - {*shown}), None
    if left:
        parts = [(sum(method[k].variance for k in left), sum(method[k].reach for k in left)) for method in by_method]
        rest = Row(f"and {len(left)} more", (), "dim")
        (together,) = declared_table("", [(rest, row("", [""] * len(headings), parts))]).rows
        further = Further(together, lambda: listed(left).rows)
    table = replace(listed(shown), further=further)
    below = [] if measure.adds_up else [NO_SUM]
    sums = (_sums(measure, unit, headings[method], own, worst[method]) for method, own in found.items())
    below += filter(None, sums)
    return [*titled(f"{measure.name}: change by each deviation", table), *map(note, below)]


def _percent(part: float, whole: float) -> float:
    """A share [%]; 0 where nothing varies."""
    return 100 * part / whole if whole else 0.0


def _slope(first_order_effect: FirstOrderEffect) -> Shown:
    """With its sign, where it has one; of several deviations what it is of."""
    found = _number(first_order_effect.slope, ".4g")
    if first_order_effect.each == 1 or found.value is None:
        return found
    return Shown(f"{found} {'each' if first_order_effect.alike else 'greatest'}", first_order_effect.slope)


def _number(value: float, form: str) -> Shown:
    known = None if math.isnan(value) else value
    return Shown(NOTHING if known is None else unsigned_zero(f"{known:{form}}"), known)


def _sums(measure: Measure, unit: str, heading: str, found: FirstOrder, worst: str) -> str:
    """Sigma by RSS of what adds up, and the worst case that was found; where none was looked for, ends by slopes."""
    words = [worst] if worst else []
    if measure.adds_up:
        sigma = measured_text(None if math.isnan(found.sigma) else found.sigma, measure.unit)
        words = [
            f"sigma {sigma} by RSS",
            *(words or [f"with all contributors at their ends {_ends(found, unit, measure)}"]),
        ]
    return f"{heading}: {'; '.join(words)}" if words else ""


def _ends(found: FirstOrder, unit: str, measure: Measure) -> str:
    low, high = (measured_text(None if math.isnan(end) else _in(measure, end, unit), unit) for end in found.ends)
    return f"{low} … {high}"
