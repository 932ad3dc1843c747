"""Charts told once: both renderers draw the same numbers of a chart, which tests write down."""

import itertools
import math
import re
import subprocess
import sys
from importlib import resources
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.collections import PolyCollection

from tol3d.report.canvas import new_figure
from tol3d.report.chart import Axis, Cells, Chart, Field, Filled, Lengths, Line, Mark, Names, Panel, Range
from tol3d.report.chart_figure import charts_figure
from tol3d.report.drawn_chart import draw_panel
from tol3d.report.html.frame import LETTER, NARROW, WIDE, Frame, Scale
from tol3d.report.html.svg import figure, svg
from tol3d.report.ticks import ticks_of

EDGES, HEIGHTS = np.array([-3.0, 1.0, 2.0, 7.0]), np.array([5.0, 2.0, 9.0])


def chart() -> Chart:
    """Three bars, the last beyond a limit at 2, over a row from -2 to 4."""
    beyond, words = np.array([False, False, True]), ["5 <here>", "2", "9"]
    bars = Filled(EDGES, HEIGHTS, "geometric", "3D simulation", beyond, range(3), words)
    limit = Mark(2.0, "limit", ("USL 2 µm", "9 above"), upper=True)
    rows = Panel(Names(["$one$ & only"]), [Range(0, -2.0, 4.0, 0.5, "analytic")])
    panels = [Panel(Axis("trials", 0.0, 10.0), [bars], [limit]), rows]
    return Chart("bars of a test", Axis("play", -4.0, 8.0, "um"), panels, "play", table=[("mean", "0.5 µm")])


@pytest.mark.parametrize("frame", [WIDE, NARROW])
def test_bars_of_both_renderers_stand_at_the_chart_s_numbers(frame: object) -> None:
    """In matplotlib by corners, in SVG by places that are a line of values: 12 um and 10 trials fill the panel."""
    drawn = svg(chart(), WIDE if frame is WIDE else NARROW)
    bars = re.findall(r'<rect x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)" class="(\w+)"', drawn)
    assert [own[4] for own in bars] == ["geometric", "geometric", "beyond"]
    x, _, width, height = np.array([[float(value) for value in own[:4]] for own in bars]).T
    per_um = (x[2] - x[0]) / 5.0
    assert (width + 0.8) / per_um == pytest.approx(np.diff(EDGES), rel=1e-4)
    assert height / height[0] == pytest.approx(HEIGHTS / 5.0, rel=1e-4)
    axes = new_figure(6, 4).add_subplot()
    draw_panel(axes, chart(), chart().panels[0])
    paths = [path for own in axes.collections if isinstance(own, PolyCollection) for path in own.get_paths()]
    extents = sorted([*path.get_extents().extents] for path in paths)
    assert extents == [list(own) for own in zip(EDGES[:-1], [0.0] * 3, EDGES[1:], HEIGHTS, strict=True)]
    assert axes.get_xlim() == (-4.0, 8.0)


def test_a_page_s_chart_has_its_words_whole_and_escaped_and_a_table_for_those_who_hear_it() -> None:
    page = figure(chart(), note="said")
    assert page.count('role="img"') == page.count("<title>bars of a test</title>") == 2, "wide and narrow"
    assert "5 &lt;here&gt;" in page
    assert "$one$ &amp; only" in page, "a dollar sign is no formula here"
    assert page.count("USL 2 µm, 9 above</text>") == 2
    assert '<tr><th scope="row">mean</th><td>0.5 µm</td></tr>' in page
    assert '<i class="fill geometric"></i>3D simulation' in page
    words = [text.get_text() for axes in charts_figure([[chart()]]).axes for text in axes.texts]
    assert "USL 2 µm\n9 above" in words


def test_a_line_breaks_where_values_are_missing() -> None:
    line = Line(np.arange(5.0), np.array([1.0, 2.0, np.nan, 3.0, 1.0]), "analytic")
    drawn = svg(Chart("line", Axis("x", 0.0, 4.0), [Panel(Axis("y", 0.0, 4.0), [line])]), WIDE)
    (path,) = re.findall(r'd="([^"]*)" class="line analytic"', drawn)
    assert (path.count("M"), path.count("L")) == (2, 2)


def test_rows_and_cells_bear_their_numbers() -> None:
    shares = Lengths([30.0, None], ["30.0", ""], "analytic", "analytic")
    rows = svg(Chart("rows", Axis("share", 0.0, 30.0, "%"), [Panel(Names(["a", "b"]), [shares])]), WIDE)
    assert rows.count("<rect") == 1
    assert "a, analytic: 30.0" in rows
    cells = Cells(np.array([[60.0, np.nan], [0.4, 33.0]]), 2)
    matrix = svg(Chart("cells", Names(["one", "two"]), [Panel(Names(["a", "b"]), [cells])]), WIDE)
    assert re.findall(r'class="tick[^"]*">(\d+)</text>', matrix) == ["60", "33"], "what is below 1 % has no number"
    strengths = [float(own) for own in re.findall(r'class="cell" fill-opacity="([\d.]+)"', matrix)]
    assert strengths == pytest.approx([1.0, 0.06 + 0.94 * 0.4 / 60, 0.06 + 0.94 * 33 / 60], rel=1e-4)
    style = resources.files("tol3d.report.html").joinpath("style.css").read_text("utf-8")
    assert not re.search(r"\.chart rect(\.cell)? \{[^}]*fill-opacity", style), "a rule would outdo the attributes"


def test_a_field_has_a_cell_a_value_between_the_middles_of_its_places() -> None:
    """Places 0, 10, 30: edges -5, 5, 20, 40; colours by the logarithm where that is asked for."""
    field = Field(
        np.array([0.0, 10.0, 30.0]), np.array([1.0, 2.0]), np.array([[1.0, 10.0, 100.0], [np.nan, 3.0, 4.0]]), "c", True
    )
    assert field.edges(upright=False).tolist() == [-5.0, 5.0, 20.0, 40.0]
    drawn = Chart("field", Axis("x", -5.0, 40.0), [Panel(Axis("y", 0.5, 2.5), [field])])
    page = svg(drawn, WIDE)
    cells = re.findall(r'x="([\d.]+)" y="[\d.]+" width="([\d.]+)" [^>]*class="cell" fill-opacity="([\d.]+)"', page)
    left, right = WIDE.left, WIDE.width - WIDE.right
    widths = [float(own) / (right - left) for _, own, _ in cells]
    assert widths == pytest.approx([10 / 45, 15 / 45, 20 / 45, 15 / 45, 20 / 45], abs=1e-3)
    assert [float(own) for *_, own in cells[:3]] == pytest.approx([0.06, 0.53, 1.0], abs=1e-3)
    assert "x 30, y 1: c 100" in page
    (axes, _) = charts_figure([[drawn]]).axes
    shown: Any = axes.collections[0].get_array()
    assert shown.compressed().tolist() == [1.0, 10.0, 100.0, 3.0, 4.0]


@given(st.floats(-1e4, 1e4), st.floats(1e-2, 1e4), st.integers(3, 9))
def test_ticks_are_the_densest_even_ones_that_are_not_too_many(low: float, span: float, most: int) -> None:
    """Whole multiples of 1, 2, 2.5 or 5 times a power of ten; the next shorter step has more intervals than allowed."""
    steps = sorted(a * 10.0**b for a in (1.0, 2.0, 2.5, 5.0) for b in range(-5, 6))
    step = next(own for own in steps if span / own <= most * (1 + 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor((low + span) / step + 1e-9)
    found = ticks_of(low, low + span, "um", most)
    assert [value for value, _ in found] == pytest.approx([k * step for k in range(first, last + 1)], abs=1e-6 * step)
    assert [float(text.replace("−", "-")) for _, text in found] == [value for value, _ in found]


@given(st.floats(-2e3, 2e3), st.floats(0.05, 2e3), st.sampled_from([("um", NARROW), ("mm", NARROW), ("um", WIDE)]))
def test_an_axis_of_numbers_has_three_ticks_whose_words_stand_apart(
    low: float, span: float, drawn: tuple[str, Frame]
) -> None:
    """Letters are 6.6 wide. Of 264 units the widest words, such as −1999.99, take a fifth each."""
    unit, frame = drawn
    scale = Scale(Axis("play", low, low + span, unit), frame.left, frame.width - frame.right, 3)
    found = scale.ticks
    assert len(found) >= 3
    for (one, words), (other, next_words) in itertools.pairwise(found):
        assert scale(other) - scale(one) > LETTER * (len(words) + len(next_words)) / 2


def test_a_report_without_3d_loads_no_matplotlib() -> None:
    code = "import sys, tol3d.report.html.document as _; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "tol3d.report.html.svg" in loaded
    assert "matplotlib" not in loaded
