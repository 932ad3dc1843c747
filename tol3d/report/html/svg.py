"""Charts as SVG, for wide and for narrow pages, with tooltips, a legend, and a table for screen readers."""

from collections.abc import Iterator, Sequence
from typing import Final, assert_never

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.report.chart import (
    Axis,
    Band,
    Cells,
    Chart,
    Charts,
    Field,
    Filled,
    Lengths,
    Line,
    Mark,
    Names,
    Outline,
    Panel,
    Points,
    Range,
    Series,
)
from tol3d.report.heading import cut
from tol3d.report.html.blocks import Markup, page_blocks, tag, together
from tol3d.report.html.frame import LETTER, NARROW, WIDE, Frame, Scale
from tol3d.report.page import Page

HIGH: Final = 246.0
"""Height of a panel of numbers."""
TOP, WORDS_TOP = 14.0, 58.0
"""Margin above a chart, and with words of ends, and of limits in two lines."""
FOOT, GAP = 44.0, 16.0
RANGE: Final = 22.0
"""Height of a row."""
BAR, BETWEEN = 13.0, 8.0
NUMBERS: Final = 40.0
"""Width of the numbers beside bars."""
MOST_BESIDE: Final = 7
"""Ticks of a vertical axis of a histogram."""
CELL: Final = 18.0
LONGEST_HEAD: Final = 26
MOST_HEADS: Final = 24
LEAST_WRITTEN: Final = 0.95
"""The smallest share with a number [%]."""
DARK: Final = 0.75
"""Part of the largest share; digits of cells beyond it have the colour of the paper, others a rim of it."""


def figure(chart: Chart, *behind: Markup, note: str = "", **attributes: object) -> Markup:
    """A chart on a page: as it is drawn for wide and for narrow pages, each of which shows its own, and its legend."""
    if chart.instead:
        return tag("figure", tag("p", chart.instead, class_="warning"), *behind, **attributes)
    words = [*([tag("span", note)] if note else []), *_legend(chart)]
    caption = tag("figcaption", *words) if words else None
    return tag("figure", svg(chart, WIDE), svg(chart, NARROW), caption, heard(chart), *behind, **attributes)


def illustrated(page: Page, charts: Charts) -> Markup:
    """A page with its charts below it; a matrix says below what its numbers are."""
    every = (own for row in charts.rows for own in row)
    noted = (figure(own, note=own.words if isinstance(own.x, Names) else "") for own in every)
    return together(page_blocks(page.blocks), *noted)


def svg(chart: Chart, frame: Frame) -> Markup:
    """A chart as wide as the page allows, with alternative text."""
    drawn, height = _matrix(chart, frame) if isinstance(chart.x, Names) else _panels(chart, chart.x, frame)
    return tag(
        "svg",
        tag("title", chart.alternative),
        *drawn,
        viewBox=f"0 0 {frame.width:.0f} {height:.0f}",
        role="img",
        class_=f"chart {frame.name}",
    )


def _legend(chart: Chart) -> Iterator[Markup]:
    for label, own in chart.labelled():
        if isinstance(own, Mark):
            look = _look(own)
        elif isinstance(own, Outline | Line):
            look = f"line {_stroke(own)}{own.role}"
        else:
            look = "" if isinstance(own, Cells | Field) else f"fill {own.role}"
        yield tag("span", tag("i", class_=look), label)
    for field in (own for own in _series(chart) if isinstance(own, Field)):
        low, high = float(np.nanmin(field.values)), float(np.nanmax(field.values))
        yield tag("span", f"{field.words}: {low:.4g}, pale, to {high:.4g}")


def _stroke(own: Outline | Line) -> str:
    if isinstance(own, Outline):
        return "dashed " if own.dashed else ""
    return "" if own.stroke == "solid" else f"{own.stroke} "


def heard(chart: Chart) -> Markup | None:
    """The words of a chart, for those who hear it."""
    if not chart.table:
        return None
    rows = (tag("tr", tag("th", word, scope="row"), tag("td", value)) for word, value in chart.table)
    return tag("div", tag("table", tag("caption", chart.alternative), *rows), class_="unseen")


# panels -------------------------------------------------------------------------------------------


def _panels(chart: Chart, across: Axis, frame: Frame) -> tuple[list[Markup], float]:
    """A chart over numbers, and its height."""
    lengths = any(isinstance(own, Lengths) or (isinstance(own, Range) and own.after) for own in _series(chart))
    left = frame.names if chart.has_rows else frame.left
    right = frame.width - (NUMBERS if lengths else frame.right)
    x = Scale(across, left, right, max(round((right - left) / 90), 2))
    worded = any(mark.upright and mark.words for mark in chart.panels[0].marks)
    inside, top = list[Markup](), WORDS_TOP if worded else TOP
    bottom = top
    for panel in chart.panels:
        bottom = top + _height(panel)
        inside += x.grid_below(top, bottom)
        if isinstance(panel.y, Names):
            inside += _rows(panel, panel.y, x, top, frame, beside=chart.has_rows)
            inside += _marks(panel, x, None, top, bottom, frame)
        else:
            y = Scale(panel.y, bottom, top, max(round(MOST_BESIDE * panel.height), 4))
            inside += y.beside(left, right)
            for own in panel.series:
                inside += _drawn(own, x, y)
            inside += _marks(panel, x, y, top, bottom, frame)
            inside.append(tag("path", d=f"M{left:.1f} {bottom:.1f}H{right:.1f}", class_="frame"))
        top = bottom + GAP
    inside += x.words_below(bottom)
    return inside, bottom + FOOT


def _series(chart: Chart) -> Iterator[Series]:
    for panel in chart.panels:
        yield from panel.series


def _height(panel: Panel) -> float:
    if not isinstance(panel.y, Names):
        return HIGH * panel.height
    return _row_height(panel) * len(panel.y.names)


def _row_height(panel: Panel) -> float:
    bars = sum(isinstance(own, Lengths) for own in panel.series)
    return bars * BAR + BETWEEN if bars else RANGE


def _drawn(series: Series, x: Scale, y: Scale) -> Iterator[Markup]:
    """A series over numbers."""
    match series:
        case Filled():
            yield from _bars(series, x, y)
        case Outline():
            path = f"M{x(float(series.edges[0])):.1f} {y(0.0):.1f}"
            places = zip(series.heights, series.edges[1:], strict=True)
            path += "".join(f"V{y(float(height)):.1f}H{x(float(edge)):.1f}" for height, edge in places)
            yield _path(f"{path}V{y(0.0):.1f}", f"line {_stroke(series)}{series.role}", series.label)
        case Line():
            if points := _broken(series.x, series.y, x, y):
                yield _path(points, f"line {_stroke(series)}{series.role}", series.label)
            if series.dots:
                yield from (_dot(a, b, series.role, series.label, 2.5) for a, b in _known(series.x, series.y, x, y))
        case Band():
            there, back = _points(series.x, series.low, x, y), _points(series.x[::-1], series.high[::-1], x, y)
            if there:
                yield _path(f"M{there}L{back}Z", f"band {series.role}", series.label)
        case Points():
            size = 1.5 if series.sign == "speck" else 4.0
            yield from (_dot(a, b, series.role, series.label, size) for a, b in _known(series.x, series.y, x, y))
        case Field():
            yield from _field(series, x, y)
        case Range() | Lengths() | Cells():
            raise TypeError(f"{type(series).__name__} stands in rows")
        case _:
            assert_never(series)


def _field(field: Field, x: Scale, y: Scale) -> Iterator[Markup]:
    """Cells with their values in tooltips, and as numbers where they are few."""
    lefts, lows = [x.within(a) for a in field.edges(upright=False)], [y.within(a) for a in field.edges(upright=True)]
    for (row, column), value in np.ndenumerate(field.values):
        if np.isnan(value):
            continue
        place = {"x": lefts[column], "y": lows[row + 1]}
        size = {"width": lefts[column + 1] - lefts[column], "height": lows[row] - lows[row + 1]}
        across, up = f"{x.axis.label} {field.x[column]:g}", f"{y.axis.label} {field.y[row]:g}"
        strength = float(field.strength[row, column])
        words = tag("title", f"{across}, {up}: {field.words} {value:.4g}")
        yield tag("rect", words, **place, **size, class_="cell", fill_opacity=0.06 + 0.94 * strength)
        if field.written:
            kind = "tick strong" if strength > DARK else "tick"
            middle = {"x": place["x"] + size["width"] / 2, "y": place["y"] + size["height"] / 2 + 4}
            yield tag("text", f"{value:.3g}", **middle, text_anchor="middle", class_=kind)


def _path(d: str, kind: str, words: str) -> Markup:
    return tag("path", tag("title", words) if words else None, d=d, class_=kind)


def _dot(x: float, y: float, role: str, words: str, size: float = 4.0) -> Markup:
    return tag("circle", tag("title", words) if words else None, cx=x, cy=y, r=size, class_=f"dot {role}")


def _known(x: Array, values: Array, across: Scale, up: Scale) -> Iterator[tuple[float, float]]:
    known = np.isfinite(values)
    yield from ((across(a), up.within(b)) for a, b in zip(x[known].tolist(), values[known].tolist(), strict=True))


def _points(x: Array, values: Array, across: Scale, up: Scale) -> str:
    return "L".join(f"{a:.1f} {b:.1f}" for a, b in _known(x, values, across, up))


def _broken(x: Array, values: Array, across: Scale, up: Scale) -> str:
    """A path through values, which begins anew after those that are missing."""
    missing = np.flatnonzero(~np.isfinite(values))
    pieces = zip(np.split(x, missing), np.split(values, missing), strict=True)
    return "".join(f"M{points}" for a, b in pieces if (points := _points(a, b, across, up)))


def _bars(own: Filled, x: Scale, y: Scale) -> Iterator[Markup]:
    """Each bar with its values and number of trials in a tooltip."""
    bottom, edges, heights = y(0.0), [x(edge) for edge in own.edges.tolist()], own.heights.tolist()
    for k, height in enumerate(heights):
        if not height:
            continue
        top = y(height)
        yield tag(
            "rect",
            tag("title", own.words[k]) if own.words else None,
            x=edges[k] + 0.4,
            y=top,
            width=max(edges[k + 1] - edges[k] - 0.8, 0.3),
            height=bottom - top,
            class_="beyond" if own.beyond is not None and own.beyond[k] else own.role,
            data_bar=own.bars[k] if own.bars else None,
        )


# rows ---------------------------------------------------------------------------------------------


def _rows(panel: Panel, names: Names, x: Scale, top: float, frame: Frame, *, beside: bool) -> Iterator[Markup]:
    """Rows with their names at the left, or above each where a panel of numbers has the room there."""
    high = _row_height(panel)
    for row, name in enumerate(names.names):
        middle = top + high * (row + 0.5)
        if beside:
            yield _name(name, frame.names - 8, middle, frame)
        else:
            yield tag("text", cut(name, 2 * frame.letters), x=4.0, y=middle - 5, class_="tick")
    lengths = [own for own in panel.series if isinstance(own, Lengths)]
    for row, name in enumerate(names.names):
        yield from _lengths(name, row, lengths, x, top + high * row)
    for own in panel.series:
        if isinstance(own, Range):
            yield from _range(own, x, top + high * (own.row + 0.5) + (0.0 if beside else 3.0))
        elif isinstance(own, Points):
            places = zip(own.x.tolist(), own.y.tolist(), strict=True)
            yield from (_dot(x(a), top + high * (row + 0.5), own.role, own.label) for a, row in places)


def _name(name: str, right: float, middle: float, frame: Frame) -> Markup:
    short = cut(name, frame.letters)
    whole = tag("title", name) if short != name else None
    return tag("text", whole, short, x=right, y=middle, text_anchor="end", class_="name")


def _lengths(name: str, row: int, every: Sequence[Lengths], x: Scale, top: float) -> Iterator[Markup]:
    """Bars of a row below each other, their numbers behind the longest: none lies over a neighbour's bar."""
    start = x(0.0)
    longest = max((x(own.values[row] or 0.0) for own in every), default=start)
    for k, own in enumerate(every):
        value, y = own.values[row], top + k * BAR + BETWEEN / 2
        if value is None:
            continue
        words = f"{name}, {own.label}: {own.texts[row]}" if own.label else f"{name}: {own.texts[row]}"
        role = own.roles[row] if own.roles else own.role
        place = {"x": start, "y": y, "width": x(value) - start, "height": BAR - 1.5}
        yield tag("rect", tag("title", words), **place, class_=role)
        yield tag("text", own.texts[row], x=longest + 4, y=y + BAR - 2.5, class_="tick")


def _range(own: Range, x: Scale, y: float) -> Iterator[Markup]:
    if own.low is not None and own.high is not None:
        yield _path(f"M{x.within(own.low):.1f} {y:.1f}H{x.within(own.high):.1f}", f"range {own.role}", own.words)
    else:
        alone = [end for end in (own.low, own.high) if end is not None]
        yield from (_path(f"M{x(end):.1f} {y - 4:.1f}v8", f"range {own.role}", own.words) for end in alone)
    if own.middle is not None:
        yield _dot(x(own.middle), y, own.role, own.words)
    if own.after:
        yield tag("text", own.after, x=x.end + 4, y=y + 4, class_="tick")


# marks --------------------------------------------------------------------------------------------


def _marks(panel: Panel, x: Scale, y: Scale | None, top: float, bottom: float, frame: Frame) -> Iterator[Markup]:
    ends = [mark for mark in panel.marks if mark.kind == "end"]
    yield from _named_ends(ends, x, top, bottom, frame)
    yield from _named_limits([own for own in panel.marks if own.kind == "limit" and own.upright], x, top, bottom, frame)
    for mark in panel.marks:
        if not mark.upright and y is not None:
            yield from _level(mark, x, y)
        elif mark.kind == "guide" and mark.upright and x.axis.low <= mark.value <= x.axis.high:
            yield _path(f"M{x(mark.value):.1f} {top:.1f}V{bottom:.1f}", _look(mark), mark.label)


def _look(mark: Mark) -> str:
    look = "limit" if mark.kind == "limit" else "rule" if mark.role else "dotted"
    return f"{look} {mark.role}" if mark.role else look


def _level(mark: Mark, x: Scale, y: Scale) -> Iterator[Markup]:
    """A line at a value of y, a limit's with its words above."""
    place, words = y.within(mark.value), ", ".join(mark.words)
    yield _path(f"M{x.start:.1f} {place:.1f}H{x.end:.1f}", _look(mark), words or mark.label)
    if words:
        yield tag("text", words, x=x.start + 5, y=place - 4, class_="tick limit-words")


def _named_ends(ends: Sequence[Mark], x: Scale, top: float, bottom: float, frame: Frame) -> Iterator[Markup]:
    """Dotted lines at mean and ends, with words above where there is room."""
    free = 0.0
    for mark in ends:
        place, text = x(mark.value), " ".join(mark.words)
        yield tag("path", d=f"M{place:.1f} {top:.1f}V{bottom:.1f}", class_="dotted")
        wide = LETTER * len(text)
        starts = min(max(place - wide / 2, 0.0), frame.width - wide)
        if text and starts >= free:
            yield tag("text", text, x=starts + wide / 2, y=top - 6, text_anchor="middle", class_="tick")
            free = starts + wide


def _named_limits(limits: Sequence[Mark], x: Scale, top: float, bottom: float, frame: Frame) -> Iterator[Markup]:
    """Lines at limits, and above them their words: those of the upper one higher where both find no room in a line."""
    free = 0.0
    for mark in limits:
        inside = x.axis.low <= mark.value <= x.axis.high
        place, words = x.within(mark.value), ", ".join(mark.words)
        if words and not inside:
            words = f"◄ {words}" if mark.value < x.axis.low else f"{words} ►"
        wide = LETTER * len(words)
        starts = min(max(place + 5 if place < frame.width / 2 else place - 5 - wide, 0.0), max(frame.width - wide, 0.0))
        height = top - (24 if starts >= free else 38)
        free = starts + wide
        if inside:
            above = height + 2 if words else top
            yield _path(f"M{place:.1f} {above:.1f}V{bottom:.1f}", _look(mark), words or mark.label)
        after = starts + wide / 2 < place
        if words:
            yield tag(
                "text",
                words,
                x=min(starts + wide, frame.width) if after else starts,
                y=height,
                text_anchor="end" if after else "start",
                class_="tick limit-words",
            )


# the matrix ---------------------------------------------------------------------------------------


def _matrix(chart: Chart, frame: Frame) -> tuple[list[Markup], float]:
    """Cells by rows and columns, as many columns as find room, and the height of it all."""
    (panel,) = chart.panels
    (own,) = panel.series
    assert isinstance(own, Cells)
    assert isinstance(chart.x, Names)
    assert isinstance(panel.y, Names)
    room = frame.width - frame.names - 10
    names = [*chart.x.names][: min(MOST_HEADS, int(room / CELL))]
    wide = min(CELL * 2, room / max(len(names), 1))
    most = float(np.nanmax(own.values[: own.coloured], initial=0.0)) or 1.0
    heads = LETTER * max((len(cut(name, LONGEST_HEAD)) for name in names), default=0) + 12
    inside = [_head(name, frame.names + wide * (k + 0.65), heads - 6) for k, name in enumerate(names)]
    for row, contributor in enumerate(panel.y.names):
        y = heads + CELL * row
        inside.append(_name(contributor, frame.names - 8, y + CELL / 2, frame))
        for k, name in enumerate(names):
            share = float(own.values[row, k])
            if not np.isnan(share):
                strength = max(0.0, min(1.0, share / most)) if row < own.coloured else 0.0
                words = f"{contributor}, {name}: {share:.1f} {own.unit}"
                inside += _cell(share, strength, words, frame.names + wide * k, y, wide)
    bottom = heads + CELL * len(panel.y.names) + 8
    if len(names) < len(chart.x.names):
        words = f"{len(names)} of {len(chart.x.names)} measures"
        words += "; a wider window shows more" if frame is NARROW else ""
        bottom += 14
        inside.append(tag("text", words, x=4.0, y=bottom - 6, class_="label"))
    return inside, bottom


def _head(name: str, x: float, y: float) -> Markup:
    place = f"translate({x:.1f} {y:.0f}) rotate(-90)"
    short = cut(name, LONGEST_HEAD)
    whole = tag("title", name) if short != name else None
    return tag("text", whole, short, class_="name", transform=place, text_anchor="start")


def _cell(share: float, strength: float, words: str, x: float, y: float, wide: float) -> Iterator[Markup]:
    place = {"x": x, "y": y, "width": wide - 1, "height": CELL - 1}
    yield tag("rect", tag("title", words), **place, class_="cell", fill_opacity=0.06 + 0.94 * strength)
    if share >= LEAST_WRITTEN:
        kind = "tick strong" if strength > DARK else "tick"
        yield tag("text", f"{share:.0f}", x=x + wide / 2, y=y + 13, text_anchor="middle", class_=kind)
