"""The card of a measure: its verdict, its distribution before and now, and a slider for each tolerance that acts."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from tol3d.analyses.before_after import SIDES, limits_of
from tol3d.analyses.limit_state import Side
from tol3d.analyses.scope import Scope
from tol3d.analyses.stated_changes import told
from tol3d.analyses.stated_classes import class_of, class_size, class_words, neighbours
from tol3d.analyses.stated_limits import FIELDS, NONE, changeable
from tol3d.analyses.stated_sizes import sizes_of_law
from tol3d.apps.workbench.session import LIMITS, Evaluated, Session
from tol3d.apps.workbench.workspace import WhatIf
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.report.chart import Axis, Chart, Filled, Outline, Panel, Series
from tol3d.report.column import TOLD, Share, shares_by_contributor, unexplained_words, within_error_words
from tol3d.report.html.blocks import Inside, Markup, tag, together
from tol3d.report.html.frame import NARROW
from tol3d.report.html.svg import heard, svg
from tol3d.report.measure_charts import limit_marks, spanned
from tol3d.report.number import (
    bounded_share_text,
    limit_text,
    limits_text,
    measured_text,
    percent_text,
    signed_units,
    value_text,
)
from tol3d.report.shown_unit import LONG_UM
from tol3d.statistics.distributions import Distribution
from tol3d.study.runs.summary.judged import trials_to_judge
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.sample import Sample
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.draw import Draw
from tol3d.study.system.other_laws import Zoned

BINS: Final = 40
TOGETHER: Final = 5
"""Bars that are told as one in the histogram's table."""
HIGH: Final = 0.45
"""Height of the histogram, of a chart's: sliders are seen below it."""
STEP: Final = 1.01
"""Factor on the width by a step of a slider, as in `page/sliders.js`, about: it lands on round numbers."""
WIDEST: Final = 4.0
"""Factor at the ends of a slider, where nothing ends it before."""
NO_SHARES: Final = "shares are not known here: a regression explains too little; a run tells them by high–low–mean"
KINDS: Final = {"OK": "ok", "NOT OK": "not-ok", "too few trials": "open", "no limits": "none"}


@dataclass(frozen=True)
class Shown:
    """Unit of a measure's numbers, and what of its own unit is one of them."""

    unit: str
    per: float = 1.0

    @classmethod
    def of(cls, evaluated: Evaluated) -> "Shown":
        """Millimetres of a length over one, as in reports."""
        measure, mean = evaluated.measure, evaluated.sample.mean
        if measure.unit == "um" and mean is not None and abs(mean) > LONG_UM:
            return cls("mm", 1e-3)
        return cls(measure.unit)

    def text(self, value: float | None) -> str:
        """A value with its unit."""
        return measured_text(None if value is None else self.per * value, self.unit)


def answer(base: Evaluated, now: Evaluated) -> Markup:
    """Verdict and the numbers that it rests on, with those of the scene where something is moved.

    Args:
        base: by the scene's tolerances.
        now: by those that are tried.
    """
    shown, judged, moved = Shown.of(base), now.judged, now is not base
    limits = limits_of(now.measure)
    low, high = (None if (own := limits.get(side)) is None else shown.per * own for side in ("low", "high"))
    rows = [*_numbers(now.sample, shown)]
    before = dict(_numbers(base.sample, shown)) if moved else {}
    if judged.verdict != "no limits":
        rows.insert(0, ("out of limits", bounded_share_text(judged.out_ppm, judged.interval)))
        if moved:
            before["out of limits"] = bounded_share_text(base.judged.out_ppm, base.judged.interval)
    cells = (
        tag(
            "tr",
            tag("th", name, scope="row"),
            tag("td", own),
            tag("td", before.get(name, ""), class_="dim") if moved else None,
        )
        for name, own in rows
    )
    head = (
        tag("tr", tag("th", "", scope="col"), tag("th", "now", scope="col"), tag("th", "scene", scope="col"))
        if moved
        else None
    )
    trials = f"{now.done} of {now.count} trials" if now.done < now.count else f"{now.count} trials"
    failed = now.sample.trials - now.sample.count
    words = f"limits {limits_text(low, high, shown.unit)} · " if judged.verdict != "no limits" else ""
    more = f" · {failed} of them not assembled" if failed else ""
    advice = _advice(now) if judged.verdict == "too few trials" and now.done == now.count else ""
    return together(
        tag("p", judged.verdict, class_=f"verdict {KINDS[judged.verdict]}"),
        tag("p", tag("span", words, class_="limit-words"), f"{trials}{more}", class_="dim"),
        tag("p", advice, class_="advice") if advice else None,
        tag("table", head, *cells),
    )


def result(now: Evaluated) -> str:
    """The answer in a line, to be heard."""
    own = [*_numbers(now.sample, Shown.of(now))]
    if now.judged.verdict != "no limits":
        own.insert(0, ("out of limits", bounded_share_text(now.judged.out_ppm, now.judged.interval)))
    return f"{now.judged.verdict}; " + ", ".join(f"{name} {words}" for name, words in own[:2])


def _advice(now: Evaluated) -> str:
    """Number of trials that would give a verdict, to two digits."""
    enough = trials_to_judge(now.sample, now.demand, limited=now.limited)
    if enough is None:
        return "it lies at what is accepted: more trials will hardly tell; change a tolerance"
    unit = 10 ** max(len(str(enough)) - 2, 0)
    return f"about {-(-enough // unit) * unit:,} trials would tell; the study has {now.count:,}".replace(",", " ")


def limit_fields(base: Evaluated, now: Evaluated) -> Mapping[str, Mapping[str, str | bool]]:
    """Texts of the fields of both limits now and of the scene, "" without one, and whether they may be changed."""
    shown, sides = Shown.of(base), changeable(base.response, base.response.measures[0])
    found = dict[str, dict[str, str | bool]]()
    for side, field in zip(SIDES, FIELDS, strict=True):
        texts = [
            "" if (limit := limits_of(own.measure).get(side)) is None else limit_text(shown.per * limit, shown.unit)
            for own in (now, base)
        ]
        found[field] = {"now": texts[0] or (NONE if texts[1] else ""), "scene": texts[1], "is": field in sides}
    return found


def _numbers(sample: Sample, shown: Shown) -> Iterator[tuple[str, str]]:
    spread = Shown("um") if shown.unit == "mm" else shown
    if sample.ppk is not None:
        yield "Ppk", f"{sample.ppk:.2f}"
    yield "mean", shown.text(sample.mean)
    yield "sigma", spread.text(sample.sigma)
    low = None if sample.p0_135 is None else shown.per * sample.p0_135
    yield "0.135 to 99.865 %", f"{value_text(low, shown.unit)} to {shown.text(sample.p99_865)}"


def histogram(base: Evaluated, now: Evaluated | None, estimate: Array | None) -> Markup:
    """The distribution by the scene's tolerances, by those that are tried, and its estimate, dashed.

    Args:
        base: by the scene's.
        now: by others, as far as they are simulated; None while a tolerance moves.
        estimate: values by others, of slopes alone; None for none.
    """
    shown, solid = Shown.of(base), base if now is None else now
    parts = [
        base.good,
        *([now.good] if now is not None else []),
        *([] if estimate is None else [estimate[np.isfinite(estimate)]]),
    ]
    every = shown.per * np.concatenate(parts)
    if not every.size:
        return tag("p", "no build could be assembled", class_="warning")
    low, high = float(every.min()), float(every.max())
    edges = np.linspace(low, high, BINS + 1) if high > low else np.array([low - 0.5, low + 0.5])
    series = list[Series]()
    if now is not None and now is not base:
        series.append(Outline(edges, _percent(base, shown, edges), "soft", "scene"))
    limits: dict[Side, float] = {side: shown.per * own for side, own in limits_of(solid.measure).items()}
    middles = (edges[1:] + edges[:-1]) / 2
    beyond = (middles < limits.get("low", -math.inf)) | (middles > limits.get("high", math.inf))
    words = "simulated" if solid is now and now is not base else "scene"
    series.append(Filled(edges, _percent(solid, shown, edges), "geometric", words, beyond, range(len(middles)), ()))
    if estimate is not None:
        heights = 100.0 * np.histogram(shown.per * estimate, edges)[0] / max(len(estimate), 1)
        series.append(Outline(edges, heights, "analytic", "estimate", dashed=True))
    marks = [*limit_marks((limits.get("low"), limits.get("high")), solid.sample, shown.unit)]
    top = max(float(own.heights.max()) for own in series if isinstance(own, Filled | Outline))
    name = base.measure.name
    across = spanned(name, np.array([edges[0], edges[-1], *limits.values()]), shown.unit)
    panel = Panel(Axis("% of trials", 0.0, 1.05 * top or 1.0), series, marks, HIGH)
    table = [*((mark.words[0], mark.words[1]) for mark in marks), *_heard(edges, series, shown.unit)]
    chart = Chart(f"histogram of {name}", across, [panel], name, table=table)
    return together(svg(chart, NARROW), _legend(series), heard(chart))


def _heard(edges: Array, series: Sequence[Series], unit: str) -> Iterator[tuple[str, str]]:
    """Bars in words, a few together: their range, and the share of the trials there."""
    few = edges[::TOGETHER] if (len(edges) - 1) % TOGETHER == 0 else edges
    for k, (low, high) in enumerate(pairwise(few.tolist())):
        inside = slice(k * TOGETHER, (k + 1) * TOGETHER)
        shares = [
            f"{own.label} {percent_text(float(own.heights[inside].sum()))} %"
            for own in series
            if isinstance(own, Filled | Outline)
        ]
        yield f"{value_text(low, unit)} to {measured_text(high, unit)}", ", ".join(shares)


def _percent(own: Evaluated, shown: Shown, edges: Array) -> Array:
    return np.asarray(100.0 * np.histogram(shown.per * own.good, edges)[0] / max(own.done, 1))


def _legend(series: Sequence[Series]) -> Markup:
    looks = {"soft": "line soft", "geometric": "fill geometric", "analytic": "line dashed analytic"}
    named = ((looks[own.role], own.label) for own in series if isinstance(own, Filled | Outline))
    return tag("p", *(tag("span", tag("i", class_=look), label) for look, label in named), class_="legend")


# sliders ------------------------------------------------------------------------------------------


def sliders(session: Session, measure: str, now: WhatIf, summary: MeasureSummary | None) -> Markup:
    """A slider and a field for each line of the scene whose contributors act on a measure, the largest share first.

    Args:
        session: the scene.
        measure: its name.
        now: what is moved.
        summary: of a run of the scene, which knows shares; None until there is one.
    """
    lines, shares = session.acting(measure), dict[str, Share]()
    known, none = shares_by_contributor(summary) if summary is not None else {}, Share(0.0, 0.0, 0.0)
    if known:
        shares = {line: Share.together(known.get(own, none) for own in session.response.lines[line]) for line in lines}
        lines = tuple(sorted(lines, key=lambda line: shares[line].order))
    if not lines:
        return tag(
            "p", session.response.nothing_acts(session.measure(measure)) or "no tolerance acts on it", class_="note"
        )
    words = (
        [unexplained_words(summary) if known else NO_SHARES, within_error_words(summary)] if summary is not None else []
    )
    first = [tag("p", own, class_="warning") for own in words if own]
    return together(
        *first, tag("ul", *(_slider(session, line, now, shares.get(line)) for line in lines), class_="sliders")
    )


def _slider(session: Session, line: str, now: WhatIf, share: Share | None) -> Markup:
    response = session.response
    names = response.lines[line]
    contributor = next(own for own in response.contributors if own.name == names[0])
    draw, moved = response.drawn_by(names[0]), line in now
    scope = response.scope(line)
    try:
        other = session.changed({line: now[line]}).drawn_by(names[0]) if moved else draw
    except InputError:
        other = draw
    each = f" · each of {len(names)}" if len(names) > 1 else ""
    sizes = session.sizes.get(line, {})
    own_class, now_class = session.classes.get(line, ""), class_of(now.get(line, ""))
    stated = class_words(own_class, sizes) if own_class and sizes else told(contributor, draw)
    words = [tag("span", tag("span", "was ", class_="was"), f"{stated}{each}", class_="dim")]
    if now_class and (sizes or class_size(now_class, sizes)):
        words.insert(0, tag("span", class_words(now_class, sizes), class_="class-words"))
    offered = neighbours(now_class or own_class, sizes)
    scene_words, listed = (
        own_class or session.typed.get(line) or written(contributor, draw),
        "-".join(("classes", "of", *line.split())),
    )
    if share is not None:
        text = f"< {share.most:.2g}" if share.is_within_error and share.most > TOLD else percent_text(share.percent)
        words.append(tag("span", f"{text} %", class_="share"))
    ends = _ends(scope)
    inside = list[Inside]([tag("div", tag("b", line), *words, class_="head")])
    if ends is None:
        inside.append(tag("p", f"stays as it is: {signed_units(scope.above)}", class_="note"))
    else:
        low, high = ends
        at = round(math.log(_factor(draw, other)) / math.log(STEP))
        now_words = scene_words
        if moved:
            now_words = now_class or _sizes(session, line, other) or written(contributor, other)
        inside.append(
            tag(
                "div",
                tag(
                    "input", type="range", min=low, max=high, value=min(max(at, low), high), step=1, data_line=line,
                    aria_label=f"{line}: how wide", aria_valuetext=now_words, title=_why(scope),
                ),
                tag(
                    "input", type="text", value=now_words,
                    data_line=line, data_scene=scene_words, aria_label=f"{line}: tolerance",
                    list=listed if offered else None,
                ),
                tag("datalist", *(tag("option", value=own) for own in offered), id=listed) if offered else None,
                class_="move",
            )
        )  # fmt: skip
    return tag("li", *inside, class_="moved" if moved else None, data_line=line)


def _ends(scope: Scope) -> tuple[int, int] | None:
    """Ends of a slider in its steps; None where nothing can be moved."""
    if scope.factors is None:
        return None
    low, high = (math.log(min(max(own, 1 / WIDEST), WIDEST)) / math.log(STEP) for own in scope.factors)
    return math.ceil(low), math.floor(high)


def written_words(session: Session, now: WhatIf) -> Mapping[str, str]:
    """A what-if in words that mean the same in another scene: limits as stated, tolerances as in fields."""
    response, found = session.changed(now), dict[str, str]()
    known = {own.name: own for own in response.contributors}
    for line, words in now.items():
        if line.startswith(LIMITS):
            found[line] = words
            continue
        name = response.lines[line][0]
        own = response.drawn_by(name)
        found[line] = class_of(words) or _sizes(session, line, own) or written(known[name], own)
    return found


def _sizes(session: Session, line: str, draw: Draw) -> str | None:
    """Limits of a measured size, in the form in which the scene has them; None where it has none."""
    typed = session.typed.get(line)
    return None if typed is None else sizes_of_law(draw.distribution, typed, session.nominals[line])


def _why(scope: Scope) -> str | None:
    """Reasons why a slider ends before its usual ends."""
    assert scope.factors is not None
    reasons = [
        why
        for why, end in ((scope.below, scope.factors[0] > 1 / WIDEST), (scope.above, scope.factors[1] < WIDEST))
        if end
    ]
    return signed_units("; ".join(reasons)) or None


def _factor(draw: Draw, other: Draw) -> float:
    """Width of a draw by that of another, about."""
    own, its = (_width(each) for each in (draw, other))
    return its / own if own > 0.0 and its > 0.0 else 1.0


def _width(draw: Draw) -> float:
    first, *last = numbers_of(draw)
    return last[0] - first if last else first


def numbers_of(draw: Draw) -> tuple[float, ...]:
    """Both limits of a draw, or its one size [mm, rad, K]: the width of a zone, a scale or a sigma."""
    law = draw.distribution
    if isinstance(draw, Zoned):
        return (draw.width,)
    if isinstance(law, Distribution) and law.limits is not None:
        return law.limits
    return (float(getattr(law, "scale", law.sigma)),)


def written(contributor: Contributor, draw: Draw) -> str:
    """A tolerance as `--set` takes it, with the signs of reports: ±20 µm, -30 µm..-19 µm, or the width of a zone."""
    unit = "" if contributor.unit == "1" else signed_units(f" {contributor.unit}")
    low, *high = (float(f"{own / contributor.per_unit:.6g}") for own in numbers_of(draw))
    if not high:
        return f"{low:g}{unit}"
    return f"±{high[0]:g}{unit}" if low == -high[0] else f"{low:g}{unit}..{high[0]:g}{unit}"
