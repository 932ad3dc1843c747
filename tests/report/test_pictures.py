"""Pictures of a run: tested by their artists and the data in them, never by their pixels."""

import math
import os
from itertools import combinations
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from loose_summaries import typed_measure, typed_run, valid
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.patches import Patch, StepPatch
from matplotlib.text import Text
from matplotlib.transforms import Bbox
from of_kind import known

from tol3d.report import picture
from tol3d.report.bars import bars_of
from tol3d.report.canvas import OUTSIDE, new_figure, save_figure
from tol3d.report.chart import Chart
from tol3d.report.chart_figure import matrix_figure
from tol3d.report.column import columns_of, is_bounded
from tol3d.report.comparison_picture import comparison_figure
from tol3d.report.drawn_chart import draw_panel
from tol3d.report.heading import heading, legible
from tol3d.report.histogram import histogram_figure, overview_figure
from tol3d.report.histogram_process import _refused
from tol3d.report.measure_charts import curve as curve_chart
from tol3d.report.measure_charts import histogram
from tol3d.report.picture import measure_files
from tol3d.report.share_charts import pareto, run_matrix
from tol3d.study.runs.summary.run import RunSummary

LONGEST = 80  # characters; of a name in a scene
READING = {"contact": "face", "gap": "section", "teeth": "driven"}
BACKLASH: dict[str, Any] = {"kind": "normal_backlash", "of": "gear pair", "gear": None, "reading": READING}


def sample_of(values: np.ndarray) -> dict[str, Any]:
    """Contents of summary.json for a method's values, as far as pictures read it."""
    mean, sigma = float(values.mean()), float(values.std(ddof=1))
    quantiles = dict(zip(("p0.135", "p50", "p99.865"), np.quantile(values, [0.00135, 0.5, 0.99865]), strict=True))
    ends = {"low_3sigma": mean - 3 * sigma, "high_3sigma": mean + 3 * sigma}
    found = {"sample_min": float(values.min()), "sample_max": float(values.max()), "failed_ppm": 0.0}
    ppm = {"below_limit_ppm": 0.0, "above_limit_ppm": 0.0}
    return {"count": len(values), "mean": mean, "sigma": sigma} | ends | found | ppm | quantiles


def measure_of(values: np.ndarray, names: tuple[str, ...] = (), **said: Any) -> dict[str, Any]:
    """A measure whose methods found the same values; its contributors have equal shares."""
    counts, edges = np.histogram(values, 64)
    sample = sample_of(values)
    counted = {"lower_edge": edges[0], "bin_width": edges[1] - edges[0]}
    shares = {"analytic_percent": 100 / max(len(names), 1), "geometric_percent": 100 / max(len(names), 1)}
    measure = BACKLASH | {"unit": "um", "over": "random", "take": "value", "lower_limit": None, "upper_limit": None}
    measure |= {"analytic": sample, "geometric": sample, "published": {}}
    measure |= {"histogram": counted | {"counts": {method: counts.tolist() for method in ("analytic", "geometric")}}}
    return measure | {"contributors": [{"name": name} | shares for name in names]} | said


def summary_of(measures: dict[str, Any], trials: int = 2000) -> dict[str, Any]:
    return {"scene": "a scene", "trials": trials, "seed": 1, "status": {"ok": trials}, "measures": measures}


def typed_summary_of(measures: dict[str, Any], trials: int = 2000) -> RunSummary:
    return typed_run(summary_of(measures, trials))


def normals(count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(50.0, 2.0, count)


def long_name(first: str) -> str:
    """A name of the longest there may be, told from others by its end."""
    words = "tooth thickness of the second planet of the left stage by the gauge room"
    return f"{words[: LONGEST - len(first) - 1]} {first}".rjust(LONGEST, "x")


def whole(text: str) -> str:
    return text.replace("\n", "").replace(" ", "")


def texts_of(figure: Figure) -> list[str]:
    return [whole(text.get_text()) for text in figure.findobj(Text) if text.get_visible()]


def boxes_of(figure: Figure) -> list[tuple[str, Any]]:
    """Every title, word, legend and label of a row or a contributor, with its place [pixels]."""
    figure.canvas.draw()
    told = [text for axes in figure.axes for text in (axes.title, vars(axes)["_left_title"], *axes.texts)]
    told += [text for axes in figure.axes if (legend := axes.get_legend()) for text in legend.get_texts()]
    told += [label for axes in figure.axes for label in axes.get_yticklabels() if not _is_number(label.get_text())]
    told += [title] if (title := vars(figure)["_suptitle"]) else []
    return [(text.get_text(), text.get_window_extent()) for text in told if text.get_text().strip()]


def _is_number(text: str) -> bool:
    return text.replace("−", "").replace(".", "").isdigit() or not text


def assert_apart(figure: Figure) -> None:
    """No text of a picture leaves it or covers another one."""
    boxes = boxes_of(figure)
    width, height = figure.canvas.get_width_height()
    for index, (text, box) in enumerate(boxes):
        assert (box.x0 >= 0, box.x1 <= width, box.y0 >= 0, box.y1 <= height) == (True,) * 4, text
        for other, beside in boxes[:index]:
            apart = box.x1 <= beside.x0 or beside.x1 <= box.x0 or box.y1 <= beside.y0 or beside.y1 <= box.y0
            assert apart, (text, other)


def axes_of(chart: Chart, panel: int = 0) -> Any:
    """A panel of a chart: of a histogram the bars are the first, the ranges the second."""
    axes = new_figure(9, 4).add_subplot()
    draw_panel(axes, chart, chart.panels[panel])
    return axes


def histogram_of(measure: dict[str, Any]) -> Chart:
    return histogram("play", typed_measure(measure))


# curves -------------------------------------------------------------------------------------------


def curve(spread: float) -> dict[str, Any]:
    """A curve of sigma 2 whose trials reach `spread` to both sides."""
    mean = [50.0, 51.0, 52.0]
    own: dict[str, Any] = {
        "mean": mean,
        "sigma": [2.0] * 3,
        "min": [m - spread for m in mean],
        "max": [m + spread for m in mean],
    }
    own |= {"below_limit_ppm": 0.0, "above_limit_ppm": 0.0, "failed_ppm": 0.0}
    measure = BACKLASH | {"unit": "um", "over": "turn", "take": "curve", "lower_limit": None, "upper_limit": None}
    return measure | {"position_deg": [0.0, 120.0, 240.0], "curve": {"analytic": own, "geometric": own}}


@pytest.mark.parametrize("spread", [3.0, 6.0, 9.0])
def test_three_sigma_is_the_one_band_of_a_curve_whether_its_trials_reach_further_or_not(spread: float) -> None:
    """With sigma 2 the band goes from -6 to +6, whatever the trials reach, which lines tell."""
    axes = axes_of(curve_chart("play", typed_measure(curve(spread))))
    (band,) = (each for each in axes.collections if isinstance(each, PolyCollection))
    heights = np.asarray(band.get_paths()[0].vertices)[:, 1]
    assert (heights.min(), heights.max()) == pytest.approx((44.0, 58.0))
    assert band.get_label() == "3D simulation, ±3 sigma"
    reached = {tuple(line.get_ydata()) for line in axes.lines if line.get_linestyle() != "-"}
    assert {(50.0 - spread, 51.0 - spread, 52.0 - spread), (50.0 + spread, 51.0 + spread, 52.0 + spread)} <= reached


# ends ---------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_normal_samples_are_told_by_three_sigma_and_uniform_ones_by_quantiles() -> None:
    """Two chances of a thousandth each in 2000 studies: 4 are expected at most, 14 or more have a chance of 1e-4."""
    rng = np.random.default_rng(3)
    sizes = rng.integers(20, 3000, 2000)
    alarms = sum(is_bounded(typed_measure(measure_of(rng.normal(size=size)))) for size in sizes)
    assert alarms <= 14
    assert all(is_bounded(typed_measure(measure_of(rng.uniform(size=size)))) for size in (1000, 3000, 10_000))


def test_the_bars_of_a_range_end_where_its_trials_do() -> None:
    """A range of a Rayleigh law that begins at 8: mean - 3 sigma is 8 + 1.2533 - 3 * 0.6551 = 7.29, where none is."""
    values = 8.0 + np.random.default_rng(1).rayleigh(1.0, 4000)
    measure = measure_of(values, published={"a paper": {"low_3sigma": 7.0, "high_3sigma": 12.0}})
    assert measure["geometric"]["low_3sigma"] == pytest.approx(7.29, abs=0.05)  # sigma / sqrt(n) = 0.01, 3 of it
    axes = axes_of(histogram_of(measure), 1)
    bars = [tuple(line.get_xdata()) for line in axes.lines if len(line.get_xdata()) == 2]
    low, high = (float(np.quantile(values, p)) for p in (0.00135, 0.99865))
    assert bars == [pytest.approx((low, high)), pytest.approx((low, high)), (7.0, 12.0)]
    marked = [text.get_text() for text in axes_of(histogram_of(measure)).texts]
    assert [text.split("\n")[0] for text in marked] == ["0.135 %", "mean", "99.865 %"]
    figure = histogram_figure(typed_summary_of({"swing": measure}))
    assert any("0.135%and99.865%quantiles" in text for text in texts_of(figure))


def test_a_column_with_nothing_to_draw_has_no_empty_line() -> None:
    others = {"a table alone": {"pooled": {"half_span": 37.0}}, "a mean": {"mean": 8.0}}
    measure = typed_measure(measure_of(normals(4000), published=others))
    axes = axes_of(histogram("play", measure), 1)
    labels = [label.get_text() for label in axes.get_yticklabels()]
    assert "a mean" in labels
    assert "a table alone" not in labels
    assert len(labels) == len(columns_of(measure)) - 1


def test_the_bars_of_a_normal_measure_end_at_three_sigma() -> None:
    measure = measure_of(normals(4000))
    axes = axes_of(histogram_of(measure), 1)
    assert tuple(axes.lines[0].get_xdata()) == (measure["analytic"]["low_3sigma"], measure["analytic"]["high_3sigma"])
    marked = [text.get_text().split("\n")[0] for text in axes_of(histogram_of(measure)).texts]
    assert marked == ["−3σ", "mean", "+3σ"]


# names --------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("count", [2, 10, *(pytest.param(n, marks=pytest.mark.slow) for n in (1, 9, 40))])
def test_contributors_bear_their_whole_names_and_no_words_cover_each_other(count: int) -> None:
    names = tuple(long_name(f"no. {k}") for k in range(count))
    told = {long_name("a paper"): {"contributors": {names[0]: 30.0}, "mean": 50.0}}
    measure = measure_of(normals(500), names, published=told, lower_limit=40.0, upper_limit=80.0)
    figure = histogram_figure(typed_summary_of({long_name("play"): measure, "turn": measure}))
    texts = texts_of(figure)
    for name in names[:9]:
        assert whole(name) in texts, name
    assert ("31others" in texts) == (count == 40)
    assert ("1other" in texts) == (count == 10)
    assert_apart(figure)


def test_a_share_below_zero_is_a_bar_of_no_length() -> None:
    """Regression gives some to what does nothing: its number stands behind the axis' line, not in the names."""
    measure = measure_of(normals(500), ("one", "two"))
    measure["contributors"][1]["geometric_percent"] = -0.3
    axes = axes_of(pareto(typed_measure(measure)))
    assert min(bar.get_width() for bar in axes.patches) == 0.0


@pytest.mark.parametrize("upper", [56.2, 57.0, 200.0])
def test_no_limit_strikes_through_the_words_at_the_ends(upper: float) -> None:
    """The limit's line ends below them, wherever it stands."""
    axes = axes_of(histogram_of(measure_of(normals(2000), upper_limit=upper)))
    axes.figure.canvas.draw()
    lowest = min(text.get_window_extent().y0 for text in axes.texts if text.get_text().startswith(("+3σ", "mean")))
    lines = [line for line in axes.lines if to_hex(line.get_color()) == OUTSIDE.lower()]
    assert len(lines) == (upper < 100)
    for line in lines:
        assert line.get_window_extent().y1 < lowest


@pytest.mark.parametrize("sigma", [0.0, 1e-9, 1e-3, 1.0, 30.0])
def test_words_at_mean_and_ends_stand_apart_however_narrow_the_trials_are(sigma: float) -> None:
    values = 50.0 + sigma * np.random.default_rng(2).normal(size=2000)
    told = {"a paper": {"low_3sigma": 20.0, "mean": 55.0, "high_3sigma": 90.0}}
    measure = measure_of(values, ("one",), published=told, lower_limit=15.0)
    assert_apart(histogram_figure(typed_summary_of({"play": measure})))


# many measures ------------------------------------------------------------------------------------


@pytest.mark.slow
def test_each_of_many_measures_has_a_file_and_a_place_in_the_overview() -> None:
    kinds = [measure_of(normals(500, seed), ("one",), lower_limit=45.0, over="turn", take="min") for seed in range(19)]
    measures = {long_name(f"no. {k}"): kind for k, kind in enumerate(kinds)} | {"over a turn": curve(5.0)}
    files = measure_files(typed_summary_of(measures).measures)
    assert list(files) == list(measures)
    assert len({file.casefold() for file in files.values()}) == 20
    figure = overview_figure(typed_summary_of(measures))
    assert len(figure.axes) == 20
    texts = texts_of(figure)
    assert all(whole(name) in texts for name in measures)
    assert_apart(figure)


@pytest.mark.slow
def test_a_run_of_many_measures_draws_a_picture_of_each(tmp_path: Path) -> None:
    measures = {f"play {k}": measure_of(normals(50, k), ("one",)) for k in range(5)}
    with picture.drawing(pictures=picture.Pictures.ALL) as draw:
        draw(valid(summary_of(measures)), tmp_path / "histogram.png")
    expected = {"histogram.png", "contributors.png", *(f"histogram-play {k}.png" for k in range(5))}
    assert {path.name for path in tmp_path.iterdir()} == expected


@pytest.mark.slow
def test_a_measure_that_cannot_be_drawn_costs_a_warning_and_no_other_picture(tmp_path: Path) -> None:
    measures = {f"play {k}": measure_of(normals(50, k), ("one",)) for k in range(5)}
    (tmp_path / "histogram-play 3.png").symlink_to(tmp_path / "no such folder" / "picture.png")
    with (
        picture.drawing(pictures=picture.Pictures.ALL) as draw,
        pytest.warns(picture.PictureWarning, match=r"^histogram-play 3\.png could not be drawn"),
    ):
        draw(valid(summary_of(measures)), tmp_path / "histogram.png")
    assert not (tmp_path / "histogram-play 3.png").exists()
    assert len(list(tmp_path.iterdir())) == 6  # four others, the overview and the heat map


def test_lines_of_an_overview_cross_their_whole_histogram_and_those_below_words_end_there() -> None:
    """The overview has no words at its lines: they go through the highest bar, which at the mean is above 84 %."""
    measure = measure_of(normals(5000), ("one",))
    overview = overview_figure(typed_summary_of({f"play {k}": measure for k in range(5)}))
    assert len(overview.axes) == 5
    for axes in overview.axes:
        assert [line.get_ydata() for line in axes.lines if line.get_linestyle() == ":"] == [[0, 1]] * 3
    alone = axes_of(histogram_of(measure))
    alone.figure.canvas.draw()
    lowest = min(text.get_window_extent().y0 for text in alone.texts)
    lines = [line for line in alone.lines if line.get_linestyle() == ":"]
    assert len(lines) == 3
    assert all(line.get_window_extent().y1 < lowest for line in lines)


def test_bars_of_one_sample_are_told_apart_and_several_samples_each_have_their_outline() -> None:
    """Bars in white edges, one cut at a limit; of two runs each is one outline in its own colour, and no bar."""
    measure = measure_of(normals(2000), lower_limit=48.0)
    axes = axes_of(histogram_of(measure))
    bars = [each for each in axes.collections if isinstance(each, PolyCollection)]
    drawn = bars_of(typed_measure(measure))["geometric"]
    boxes = sorted([*path.get_extents().extents] for own in bars for path in own.get_paths())
    across = np.searchsorted(drawn.edges, 48.0) - 1
    edges, heights = np.insert(drawn.edges, across + 1, 48.0), np.insert(drawn.density, across, drawn.density[across])
    corners = zip(edges[:-1], np.zeros(len(heights)), edges[1:], heights, strict=True)
    assert boxes == [pytest.approx(box) for box in corners]
    assert {to_hex(colour) for own in bars for colour in np.asarray(own.get_edgecolor())} == {"#ffffff"}
    beyond = [own for own in bars if to_hex(np.asarray(own.get_facecolor())[0]) == OUTSIDE.lower()]
    assert [len(own.get_paths()) for own in beyond] == [across + 1]
    runs = [run_of(f"/{name}", {"play": measure_of(normals(500, seed))}) for seed, name in enumerate("ab")]
    both = comparison_figure(runs).axes[0]
    outlines = [step for step in both.patches if isinstance(step, StepPatch) and not step.get_fill()]
    assert len({to_hex(step.get_edgecolor()) for step in outlines if step.get_linestyle() == "solid"}) == 2
    assert not both.collections


# failed trials ------------------------------------------------------------------------------------


def jammed() -> dict[str, Any]:
    """A measure of which a third of 3000 trials jam: those below 48, by the 3D simulation alone."""
    values = normals(3000)
    seated = values[np.sort(values)[1000] <= values]
    measure = measure_of(values, lower_limit=49.0)
    counts = np.histogram(seated, 64, (values.min(), values.max()))[0]
    measure["histogram"]["counts"]["geometric"] = counts.tolist()
    out = {"trials": 3000, "below_limit_ppm": 400_000.0, "out_ppm": 400_000.0}
    measure["geometric"] = sample_of(seated) | out
    return measure | {"status": {"ok": len(seated), "interferes": 3000 - len(seated)}}


def test_what_failed_is_missing_in_the_bars_and_makes_the_others_no_more() -> None:
    """Both methods found the same values of what seated: their bars are as high there, and 2/3 of 100 % in all."""
    bars = bars_of(typed_measure(jammed()))
    assert float(np.sum(bars["geometric"].density * np.diff(bars["geometric"].edges))) == pytest.approx(200 / 3)
    assert float(np.sum(bars["analytic"].density * np.diff(bars["analytic"].edges))) == pytest.approx(100.0)
    higher = bars["geometric"].density[bars["geometric"].middles > 50.0]
    assert higher == pytest.approx(bars["analytic"].density[bars["analytic"].middles > 50.0])


def test_a_picture_says_how_many_seated_and_what_is_out_of_all() -> None:
    figure = histogram_figure(typed_summary_of({"play": jammed()}, 3000))
    texts = texts_of(figure)
    assert any("ofthe2000of3000thatwereassembled,outinall40%" in text for text in texts)
    assert any("LSL49µm40%below" in text for text in texts)
    many = overview_figure(typed_summary_of({f"play {k}": jammed() for k in range(5)}, 3000))
    assert sum("40%below" in text and "ofthe2000of3000thatwereassembled" in text for text in texts_of(many)) == 5
    assert_apart(figure)
    assert_apart(many)


# comparisons --------------------------------------------------------------------------------------


def run_of(path: str, measures: dict[str, Any]) -> Any:
    """A run that kept no trials, as far as comparisons read it."""
    return SimpleNamespace(path=Path(path), found=typed_summary_of(measures), keeps_trials=False, column_names=())


@pytest.mark.slow
def test_a_comparison_names_every_run_in_each_of_its_rows_in_one_colour() -> None:
    """The second run reads another section of the same name: a row of its own, which says where it is read."""
    section: dict[str, Any] = {"reading": READING | {"teeth": "driver"}, "lower_limit": 45.0}
    runs = [
        run_of("/runs/a/pair", {"play": measure_of(normals(500))}),
        run_of("/runs/b/pair", {"play": measure_of(normals(500, 1), **section)}),
        run_of(f"/runs/b/{long_name('third')}", {"play": measure_of(normals(500, 2)), "turn": measure_of(normals(9))}),
    ]
    figure = comparison_figure(runs)
    rows = figure.axes[::3]
    named = [[whole(text.get_text()) for text in known(axes.get_legend()).get_texts()] for axes in rows]
    third = whole(long_name("third"))
    assert [[name for name in row if name in ("a/pair", "b/pair", third)] for row in named] == [
        ["a/pair", third],
        ["b/pair"],
        [third],
    ]
    colours: dict[str, set[str]] = {}
    for axes in rows:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            if whole(label) in ("a/pair", "b/pair", third):
                assert isinstance(handle, Patch | PolyCollection)
                face = np.asarray(handle.get_facecolor())
                colours.setdefault(whole(label), set()).add(to_hex(face.reshape(-1, 4)[0]))
    assert [len(own) for own in colours.values()] == [1, 1, 1]
    assert len(set.union(*colours.values())) == 3
    texts = texts_of(figure)
    for run in runs[:2]:
        assert any(text.startswith(whole(heading(run.found.measures["play"]))) for text in texts)
    assert heading(runs[1].found.measures["play"]).endswith("gap in its middle, one driver tooth")
    assert_apart(figure)


def test_limits_that_runs_do_not_share_say_whose_they_are() -> None:
    limits = (46.0, 47.0, None)
    runs = [run_of(f"/{k}", {"play": measure_of(normals(500), lower_limit=each)}) for k, each in enumerate(limits)]
    texts = texts_of(comparison_figure(runs))
    assert "LSL46µmof0" in texts
    assert "LSL47µmof1" in texts
    shared = texts_of(comparison_figure(runs[:1] * 2))
    assert shared.count("LSL46µm") == 1


@pytest.mark.slow
def test_no_line_of_a_comparison_runs_through_its_legends() -> None:
    runs = [run_of(f"/runs/{long_name(str(k))}", {"play": measure_of(normals(500, k))}) for k in range(3)]
    figure = comparison_figure(runs)
    figure.canvas.draw()
    for axes in figure.axes:
        legend = axes.get_legend()
        if legend:
            assert legend.get_window_extent().y1 <= axes.get_window_extent().y0


# words --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["lost_motion", "tip_displacement"])
@pytest.mark.parametrize("over", ["random", "at"])
def test_a_train_without_a_motor_is_told_without_one(kind: str, over: str) -> None:
    measure = {"kind": kind, "of": "stage", "over": over, "take": "value", "shaft": "output", "held": "input"}
    assert "motor" not in heading(typed_measure(measure | {"arm": "arm", "point": "tip"}))


def test_a_cut_name_says_so() -> None:
    assert legible("a" * 40, 34) == "a" * 33 + "…"
    assert math.isclose(len(legible("b" * 34)), 34)


def test_a_png_has_the_pixels_that_matplotlib_itself_writes(tmp_path: Path) -> None:
    run = typed_summary_of({"play": measure_of(normals(300), ("one", "two"), lower_limit=45.0)})
    save_figure(histogram_figure(run), tmp_path / "ours.png")
    histogram_figure(run).savefig(tmp_path / "theirs.png", facecolor="white")
    assert np.array_equal(imread(tmp_path / "ours.png"), imread(tmp_path / "theirs.png"))


def judged(out_ppm: float, ppk: float | None) -> dict[str, Any]:
    measure = measure_of(normals(500), ("one",), lower_limit=40.0)
    own = measure["geometric"] | {"out_ppm": out_ppm, "ppk": ppk}
    return measure | {"geometric": own}


def test_of_many_measures_the_picture_shows_the_four_worst_and_says_so() -> None:
    found = [(0.0, 1.4), (900.0, 1.2), (0.0, 1.1), (0.0, None), (900.0, 1.0), (2000.0, 1.3)]
    run = typed_summary_of({f"play {k}": judged(*own) for k, own in enumerate(found)})
    texts = texts_of(histogram_figure(run))
    shown = [text for text in texts if text in {whole(name) for name in run.measures}]
    assert list(dict.fromkeys(shown)) == ["play5", "play4", "play1", "play2"]
    assert any("the4worstof6measures" in text for text in texts)


def test_each_share_stands_in_its_row_and_column_of_the_heat_map() -> None:
    """Row by row 60, 30, 10 % of the first measure; each further measure has its shares one row further on."""
    names, shares = ("one", "two", "three"), (60.0, 30.0, 10.0)
    measures = {
        f"play {k}": measure_of(normals(500), names)
        | {"contributors": [{"name": n, "geometric_percent": shares[(i - k) % 3]} for i, n in enumerate(names)]}
        for k in range(2)
    }
    (axes, *_) = matrix_figure(run_matrix(typed_summary_of(measures))).axes
    rows = [label.get_text() for label in axes.get_yticklabels()]
    columns = [label.get_text() for label in axes.get_xticklabels()]
    assert (rows, columns) == (["two", "one", "three"], ["play 0", "play 1"])  # 90, 70 and 40 % in both together
    cells = {(rows[int(t.get_position()[1])], columns[int(t.get_position()[0])]): t.get_text() for t in axes.texts}
    first = {("one", "play 0"): "60", ("two", "play 0"): "30", ("three", "play 0"): "10"}
    assert cells == first | {("one", "play 1"): "10", ("two", "play 1"): "60", ("three", "play 1"): "30"}


def test_labels_and_numbers_of_a_large_heat_map_do_not_overlap() -> None:
    names = tuple(long_name(f"no. {k}") for k in range(120))
    run = typed_summary_of({long_name(f"measure {k}"): measure_of(normals(50), names) for k in range(45)})
    figure = matrix_figure(run_matrix(run))
    figure.set_dpi(60)
    axes = figure.axes[0]
    assert (len(axes.get_yticklabels()), len(axes.get_xticklabels())) == (51, 40)
    figure.canvas.draw()
    boxes = [t.get_window_extent() for t in (*figure.texts, *axes.get_yticklabels(), *axes.get_xticklabels())]
    assert [t.get_text() for t in axes.texts] == [
        "58"
    ] * 40  # 70 others of 0.83 % each; less than 1 % has a colour alone
    boxes += [t.get_window_extent() for t in axes.texts]
    assert not [pair for pair in combinations(boxes, 2) if Bbox.intersection(*pair) is not None]
    width, height = figure.canvas.get_width_height()
    assert all(box.x0 >= 0 and box.y0 >= 0 and box.x1 <= width and box.y1 <= height for box in boxes)


# many pictures ------------------------------------------------------------------------------------


@pytest.mark.parametrize("processors", [1, 3])
def test_pictures_that_fail_are_told_and_the_others_drawn_by_any_number_of_processes(
    processors: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: set(range(processors)))

    def draw(path: Path) -> None:
        path.write_text(str(os.getpid()), encoding="utf-8")
        if path.stem in ("4", "9"):
            raise ValueError(f"no  {path.stem}")

    names = [f"{k}.png" for k in range(15)]
    assert _refused([(name, draw) for name in names], tmp_path) == {"4.png": "no 4", "9.png": "no 9"}
    drawn = {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()}
    assert drawn.keys() == set(names) - {"4.png", "9.png"}
    assert len(set(drawn.values())) == processors


def test_pictures_of_a_process_that_ends_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: {0, 1})
    own = os.getpid()

    def draw(path: Path) -> None:
        if os.getpid() != own:
            os._exit(1)

    refused = _refused([(f"{k}.png", draw) for k in range(10)], tmp_path)
    assert refused == {f"{k}.png": "its process ended" for k in range(1, 10, 2)}
