"""Trains in tables and pictures, against the figures that the paper prints of the robot's shoulder (section 4)."""

import itertools
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from loose_summaries import typed_measure, typed_run, valid
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.patches import FancyBboxPatch, Polygon
from matplotlib.text import Text
from of_kind import known
from printing import printed, row_of
from sets import covering

from tol3d.gearing.presenting.chain import chain_figure
from tol3d.gearing.presenting.shown_stage import shafts_along, stages_of, sums_of, trains_of
from tol3d.gearing.presenting.train_tables import train_report
from tol3d.gearing.summary.types import TrainSummary
from tol3d.report import picture
from tol3d.report.canvas import wrapped
from tol3d.report.chart import Axis
from tol3d.report.chart_figure import charts_figure
from tol3d.report.compare import Compared
from tol3d.report.heading import heading, limits_text
from tol3d.report.measure_charts import curve
from tol3d.report.measure_table import curve_table
from tol3d.report.number import difference_text
from tol3d.report.table import run_report

LEVER = 763.0  # mm, of the robot's arm
DEGREES_PER_UM = 0.12195  # times j_n [um] over the gear's diameter [mm]: the paper's lost motion of a pair
SPUR, BEVEL = (34.0, 54.0, 75.0), (72.0, 90.0, 108.0)  # um; low, mean and high of the paper's Tables 4 and 8
SPUR_DIAMETER, BEVEL_DIAMETER = 275.0, 102.1  # mm
KEYS = ("low_3sigma", "mean", "high_3sigma")
CONES, SHAFT = "#009e73", "#f3f3f3"  # colours in the picture of a train


def lost_motion(backlashes: tuple[float, ...], diameter: float) -> dict[str, float]:
    return {key: 60 * DEGREES_PER_UM * j / diameter for key, j in zip(KEYS, backlashes, strict=True)}


DATA_SHEET = dict.fromkeys(KEYS, 1.0)  # arcmin, in every trial
OWN = (DATA_SHEET, lost_motion(SPUR, SPUR_DIAMETER), lost_motion(BEVEL, BEVEL_DIAMETER))
RATIOS = (152.0, -110 / 28, -1.0)
FACTORS = (28 / 110, 1.0, 1.0)
SHAFTS = ("motor", "reducer output", "spline shaft", "shoulder flange")


def method(own: dict[str, float], share: float) -> dict[str, float]:
    sigma = (own["high_3sigma"] - own["low_3sigma"]) / 6
    return own | {
        "sigma": sigma,
        "sample_min": own["low_3sigma"],
        "sample_max": own["high_3sigma"],
        "share_percent": share,
    }


def stage(
    link: str,
    kind: str,
    driver: str,
    driven: str,
    teeth: list[int] | None,
    ratio: float,
    flank: str | None,
    factor: float,
    own: dict[str, float],
    share: float,
) -> dict[str, Any]:
    return {
        "link": link,
        "kind": kind,
        "driver": driver,
        "driven": driven,
        "gears": teeth and ["pinion", "wheel"],
        "teeth": teeth,
        "ratio": ratio,
        "working_flank": flank,
        "factor": factor,
        "methods": {name: method(own, share) for name in ("analytic", "geometric")},
        "published": {"paper, 3DCS": own} if teeth else {},
    }


def shares() -> list[float]:
    """Shares of the sum's variance [%], the stages being independent."""
    variances = [((own["high_3sigma"] - own["low_3sigma"]) * f) ** 2 for own, f in zip(OWN, FACTORS, strict=True)]
    return [100 * variance / sum(variances) for variance in variances]


def sums_at_output(own: Sequence[dict[str, float]] = OWN, factors: Sequence[float] = FACTORS) -> dict[str, float]:
    return {key: sum(each[key] * abs(f) for each, f in zip(own, factors, strict=True)) for key in KEYS}


def distribution() -> dict[str, float]:
    """The sum of independent stages [arcmin]: means add up, and so do variances."""
    mean = sum(own["mean"] * f for own, f in zip(OWN, FACTORS, strict=True))
    reach = math.hypot(*((own["high_3sigma"] - own["low_3sigma"]) / 2 * f for own, f in zip(OWN, FACTORS, strict=True)))
    return {"mean": mean, "sigma": reach / 3, "low_3sigma": mean - reach, "high_3sigma": mean + reach}


def measure(kind: str, per: float, **fields: object) -> dict[str, Any]:
    values: dict[str, Any] = {key: value * per for key, value in distribution().items()} | {"count": 2000}
    values |= {"below_limit_ppm": None, "above_limit_ppm": None, "sample_min": None, "sample_max": None}
    counts = {"analytic": [3, 9, 3], "geometric": [4, 8, 3]}
    edges = {"lower_edge": values["low_3sigma"], "bin_width": (values["high_3sigma"] - values["low_3sigma"]) / 3}
    return {
        "kind": kind,
        "of": "shoulder swing",
        "gear": None,
        "reading": None,
        "over": "random",
        "take": "value",
        "lower_limit": None,
        "upper_limit": None,
        "shaft": "shoulder flange",
        "held": "motor",
        "nominal": {},
        "mean_build": {},
        "analytic": values,
        "geometric": values,
        "histogram": edges | {"counts": counts},
        "contributors": [{"name": "reducer play", "analytic_percent": 3.0, "geometric_percent": 3.1}],
        "published": {"paper, 3DCS": {"high_3sigma": 599.0 / 60 * per}},
        **fields,
    }


MM_PER_ARCMIN = math.pi / 10800 * LEVER
MEASURES = {
    "lost motion": measure("lost_motion", 1.0, unit="arcmin"),
    "tip displacement": measure("tip_displacement", MM_PER_ARCMIN, unit="mm", arm="arm", point="tip", upper_limit=2.21),
}


def summary_of(
    stages: list[dict[str, Any]], measures: dict[str, Any] = MEASURES, lever: float | None = LEVER
) -> dict[str, Any]:
    own = [each["methods"]["geometric"] for each in stages]
    sums = sums_at_output(own, [each["factor"] for each in stages])
    return {
        "scene": "robot shoulder",
        "trials": 2000,
        "seed": 7,
        "engine": "exact",
        "status": {"ok": 2000},
        "study": {},
        "timing": {"setup_s": 0.1, "simulate_s": 0.2, "trials_per_s": 10000.0},
        "chord_error_um": 0.0,
        "measures": measures,
        "trains": {
            "shoulder swing": {
                "driven": "motor",
                "held": "motor",
                "output": stages[-1]["driven"],
                "ratio": math.prod(each["ratio"] for each in stages),
                "shaft": stages[-1]["driven"],
                "measure": "lost motion",
                "unit": "arcmin",
                "lever_mm": lever,
                "point": None if lever is None else "tip of arm",
                "stages": stages,
                "sums": {"analytic": sums, "geometric": sums, "published": {"paper, 3DCS": sums}},
            }
        },
    }


def shoulder(**fields: Any) -> dict[str, Any]:
    """The robot's shoulder: motor, planetary reducer, spur pair, bevel pair, arm."""
    links = (
        ("planetary reducer", "reducer", None, None),
        ("spur pair", "mesh", [28, 110], "left"),
        ("bevel pair", "bevel_mesh", [31, 31], "right"),
    )
    return summary_of(
        [
            stage(name, kind, SHAFTS[k], SHAFTS[k + 1], teeth, RATIOS[k], flank, FACTORS[k], OWN[k], shares()[k])
            for k, (name, kind, teeth, flank) in enumerate(links)
        ],
        **fields,
    )


def long_train(count: int, lever: float | None = LEVER) -> dict[str, Any]:
    """A train of spur and bevel pairs behind a reducer, with names as long as users give them."""
    stages = []
    for k in range(count):
        kind = ("reducer", "mesh", "bevel_mesh")[k % 3]
        names = (f"the shaft number {k} of seven gears", f"the shaft number {k + 1} of seven gears")
        teeth = None if kind == "reducer" else [17, 60 + k] if kind == "mesh" else [31, 31]
        ratio = 20.0 if teeth is None else -teeth[1] / teeth[0]
        name = f"the {kind.replace('_', ' ')} number {k + 1} behind the wall"
        stages.append(
            stage(
                name, kind, *names, teeth, ratio, "left" if teeth else None, 0.9 ** (count - k), OWN[k % 3], 100 / count
            )
        )
    return summary_of(stages, lever=lever)


def all_printed(summary: dict[str, Any], width: int = 140) -> str:
    return "".join(printed(block, width) for block in train_report(typed_run(summary)))


def train_of(summary: dict[str, Any]) -> TrainSummary:
    return trains_of(typed_run(summary))["shoulder swing"]


# tables -------------------------------------------------------------------------------------------


def test_the_paper_s_sum_of_highs_of_the_shoulder_is_9_minutes_59_4_seconds_and_2_217_mm_at_the_tip() -> None:
    """Section 4: a maximum of 9′59″ and 2.21 mm (its 2.2172 cut short)."""
    text = all_printed(shoulder())
    assert row_of(text, "sum of the stages' highs") == ["9′59.4″"] * 3
    assert row_of(text, "tip of arm, sum of highs [mm]") == ["2.2172"] * 3


def test_each_stage_stands_with_the_paper_s_lost_motion_ratio_and_sense() -> None:
    text = all_printed(shoulder())
    assert row_of(text, "planetary reducer")[:8] == ["i", "=", "152", "same", "1′00.0″", "1′00.0″", "1′00.0″", "15.3″"]
    spur, bevel = row_of(text, "spur pair"), row_of(text, "bevel pair")
    assert spur[:3] == ["110/28", "=", "3.929"]
    assert spur[3:8] == ["opposite", "54.3″", "1′26.2″", "1′59.7″", "1′26.2″"]  # paper: 54″, 1′26″, 2′
    assert bevel[3:8] == ["opposite", "5′09.6″", "6′27.0″", "7′44.4″", "6′27.0″"]  # paper: 5′10″, 6′27″, 7′44″
    spur_share = 100 / (1 + (36 / BEVEL_DIAMETER) ** 2 / (41 / SPUR_DIAMETER) ** 2)
    assert spur[8:] == [f"{spur_share:.1f}", "1′59.7″"]
    assert bevel[8:] == [f"{100 - spur_share:.1f}", "7′44.4″"]
    assert "motor → reducer output → spline shaft → shoulder flange" in text
    assert "i = 597.143, motor and shoulder flange turn the same way" in text  # 152 * 110/28


def test_mean_and_3_sigma_of_the_sum_stand_beside_the_sum_of_highs_and_are_less() -> None:
    """Means add up, spreads only in squares: sqrt(a² + b²) < a + b."""
    seconds = 3600 * DEGREES_PER_UM
    mean = 28 / 110 * 60 + seconds * (54 / SPUR_DIAMETER + 90 / BEVEL_DIAMETER)
    low, high = (seconds * math.hypot((j - 54) / SPUR_DIAMETER, 18 / BEVEL_DIAMETER) for j in (33.5, 74.5))
    assert low == high  # 41 um wide, taken about its middle
    total = mean + high
    assert total < 599.4
    cells = row_of(all_printed(shoulder()), "mean + 3 sigma of the sum")
    assert cells == [*[f"{total // 60:.0f}′{total % 60:04.1f}″"] * 2, "–"]  # the 9′59″ published is a sum of highs
    tip = total / 3600 * math.pi / 180 * LEVER
    assert row_of(all_printed(shoulder()), "tip of arm, mean + 3 sigma [mm]")[:2] == [f"{tip:.4f}"] * 2


@pytest.mark.parametrize("width", [80, 120])
def test_trains_fit_the_width_of_a_terminal(width: int) -> None:
    for summary in (shoulder(), long_train(12)):
        text = printed(run_report(typed_run(summary)), width)
        assert max(map(len, text.splitlines())) <= width
        assert "…" not in text


def test_measures_of_a_train_have_the_sums_of_its_stages_below() -> None:
    """In their own units, with what the paper prints for the train: 9′59″ and 2.21 mm."""
    text = printed(run_report(typed_run(shoulder())))
    turn, tip = text.split("train shoulder swing")[0].split("tip displacement")[-2:]
    assert row_of(turn, "sum of the stages' highs") == ["9′59.4″"] * 3
    assert row_of(tip, "sum of the stages' highs") == ["2.2172"] * 3
    assert row_of(tip, "high (+3 sigma)")[-1] == "2.21578"  # 599″ of 763 mm, published: pi / 648000 each
    assert "[mm]" in tip
    assert text.count("it is no worst case") == 1  # beside the train, for its measures too
    means = sum(FACTORS[k] * OWN[k]["mean"] for k in range(3)) * MM_PER_ARCMIN
    assert row_of(tip, "sum of the stages' means")[0] == f"{means:.4f}"


@pytest.mark.parametrize(
    "other",
    [
        {"shaft": "spline shaft"},
        {"held": "reducer output"},
        {"kind": "tip_displacement", "arm": "arm", "point": "elbow"},
    ],
)
def test_a_measure_at_another_shaft_or_point_has_no_sums_of_these_stages(other: dict[str, Any]) -> None:
    summary = shoulder()
    assert sums_of(typed_measure(summary["measures"]["lost motion"]), typed_run(summary))
    assert sums_of(typed_measure(summary["measures"]["lost motion"] | other), typed_run(summary)) == {}


def test_another_point_of_the_arm_moves_by_its_own_lever() -> None:
    summary = shoulder()
    elbow = summary["measures"]["tip displacement"] | {"point": "elbow", "lever_mm": LEVER / 2}
    highs = sums_of(typed_measure(elbow), typed_run(summary))["geometric"].high
    assert highs == pytest.approx(2.2172 / 2, abs=0.5e-4)


def test_a_run_without_trains_prints_none() -> None:
    summary = shoulder() | {"trains": {}}
    assert train_report(typed_run(summary)) == []
    assert "sum of the stages" not in printed(run_report(typed_run(summary)))
    del summary["trains"]  # of an older version
    assert train_report(typed_run(summary)) == []


def test_an_analytic_study_is_told_by_its_own_method() -> None:
    summary = shoulder()
    train = summary["trains"]["shoulder swing"]
    for each in train["stages"]:
        del each["methods"]["geometric"]
        each["methods"]["analytic"] |= {"mean": 2.0}
    del train["sums"]["geometric"]
    text = all_printed(summary)
    assert "by the analytic method" in text
    assert "3D simulation" not in text
    assert row_of(text, "spur pair")[5] == "2′00.0″"


def test_numbers_that_nobody_knows_are_dashes() -> None:
    summary = shoulder()
    train = summary["trains"]["shoulder swing"]
    train["stages"][1]["methods"]["geometric"] = dict.fromkeys(train["stages"][1]["methods"]["geometric"])
    train["sums"]["geometric"] = dict.fromkeys(KEYS)
    assert row_of(all_printed(summary), "spur pair")[4:9] == ["–"] * 5
    assert row_of(all_printed(summary), "sum of the stages' highs") == ["9′59.4″", "–", "9′59.4″"]
    assert "–" in texts_of(chain_figure(typed_run(summary), "shoulder swing"))


def test_a_chain_is_followed_through_a_link_from_its_driven_side() -> None:
    """Held is a branch of the motor's shaft: from it back to the motor, and on to the output."""
    summary = shoulder()
    stages = summary["trains"]["shoulder swing"]["stages"]
    stages[0] |= {"driver": "reducer output", "driven": "brake"}
    assert shafts_along(stages_of(train_of(summary)), "brake") == ["brake", *SHAFTS[1:]]
    stages[:] = stages[:1]
    assert shafts_along(stages_of(train_of(summary)), "brake") == ["brake", "reducer output"]


# words and units ----------------------------------------------------------------------------------


def test_limits_differences_and_labels_of_a_tip_are_in_mm() -> None:
    tip = typed_measure(MEASURES["tip displacement"])
    assert limits_text(tip) == "upper limit 2.21 mm"
    assert difference_text(0.00125, "mm") == "1.250 µm"
    assert Axis("tip", 0.0, 1.0, "mm").words(80) == "tip [mm]"
    assert heading(tip) == ("displacement of tip of arm by the lost motion, at a random position each trial")
    assert heading(typed_measure(MEASURES["lost motion"])).startswith(
        "lost motion of shoulder flange, motor held, without load, at a random"
    )
    assert Compared.of("tip", tip) != Compared.of(
        "tip", typed_measure(MEASURES["tip displacement"] | {"point": "elbow"})
    )


def tip_error() -> dict[str, Any]:
    """An error that jumps by the displacement where the arm passes the vertical."""
    positions = [-60.0 + 5 * k for k in range(25)]
    mean = [0.0 if position < 0 else 1.81 for position in positions]
    values: dict[str, Any] = {
        "mean": mean,
        "sigma": [0.1] * 25,
        "min": [m - 0.2 for m in mean],
        "max": [m + 0.2 for m in mean],
    }
    values |= {"below_limit_ppm": 0.0, "above_limit_ppm": 12.0}
    fields = {"unit": "mm", "arm": "arm", "point": "tip", "over": "swing", "take": "curve", "upper_limit": 2.21}
    curve = {"position_deg": positions, "curve": {"analytic": values, "geometric": values}}
    return MEASURES["tip displacement"] | fields | curve | {"kind": "tip_error", "contributors": []}


def test_a_tip_s_error_is_told_over_the_output_s_angle_in_mm() -> None:
    error = typed_measure(tip_error())
    assert error.curve
    text = printed(curve_table(error, error.curve))
    assert "output at [°]" in text
    rows = {line.split()[0]: line.split()[1] for line in text.splitlines() if re.match(r" *-?\d+\.\d ", line)}
    assert (rows["-60.0"], rows["0.0"]) == ("0.0000", "1.8100")
    (axes,) = charts_figure([[curve("tip error", error)]]).axes
    assert axes.get_xlabel() == "output position [deg]"
    assert axes.get_ylabel() == "tip error [mm]"
    assert axes.get_xlim() == (-60.0, 60.0)
    assert [line.get_marker() for line in axes.lines if line.get_label() == "3D simulation, mean"] == ["."]
    legend = [text.get_text() for text in known(axes.get_legend()).get_texts()]
    assert "USL 2.21 mm" in legend
    assert "anywhere above 2.21 mm, of all trials: analytic 12 ppm, 3D 12 ppm" in printed(
        run_report(typed_run(shoulder() | {"measures": {"tip error": tip_error()}}))
    )


# pictures -----------------------------------------------------------------------------------------


def artists_of(figure: Figure) -> list[Text]:
    return [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]


def texts_of(figure: Figure) -> list[str]:
    return [text.get_text() for text in artists_of(figure)]


def test_the_picture_tells_ratios_own_lost_motions_shares_and_the_sum_of_highs() -> None:
    texts = texts_of(chain_figure(typed_run(shoulder()), "shoulder swing"))
    for text in ("i = 152", "110/28 = 3.929", "31/31 = 1", "54.3″ … 1′59.7″", "5′09.6″ … 7′44.4″", "left", "right"):
        assert text in texts
    assert "119.7″\n0.443 mm" in texts  # 75 um: 0.12195 * 75 / 275 deg; by 763 mm
    assert "464.4″\n1.718 mm" in texts
    assert "15.3″\n0.056 mm" in texts  # 1′ behind 110/28
    assert "9′59.4″ = 2.217 mm, all at +3 sigma" in texts
    assert not any("worst" in text for text in texts)
    spur_share = 100 / (1 + (36 / BEVEL_DIAMETER) ** 2 / (41 / SPUR_DIAMETER) ** 2)
    assert f"{spur_share:.0f} %" in texts
    assert "tip of arm\nlever 763 mm" in texts


def test_a_shaft_turns_against_the_motor_behind_an_odd_number_of_reversals() -> None:
    """Motor and reducer's output alike; the spur pair reverses, and the bevel pair once more."""
    texts = texts_of(chain_figure(typed_run(shoulder()), "shoulder swing"))
    assert [text for text in texts if text in "↺↻"] == ["↺", "↺", "↻", "↺"]


def test_ends_that_are_those_of_a_data_sheet_are_told_so_and_no_other_ones() -> None:
    """A reducer's play of sigma 1.5′ about 5′ that its law ends at 2′ and 9′; 3 sigma would be 0.5′ and 9.5′."""
    summary = shoulder()
    law = {"low_3sigma": 2.0, "mean": 5.0, "high_3sigma": 9.0, "sigma": 1.5}
    for own in summary["trains"]["shoulder swing"]["stages"][0]["methods"].values():
        own |= law
    texts = texts_of(chain_figure(typed_run(summary), "shoulder swing"))
    assert [text for text in texts if text.endswith("law's")] == ["2′00.0″ … 9′00.0″, its law's"]


def test_a_chain_says_of_how_many_trials_it_is_where_some_failed() -> None:
    summary = shoulder()
    measure = summary["trains"]["shoulder swing"]["measure"]
    summary["measures"][measure] = summary["measures"][measure] | {"status": {"ok": 1900, "interferes": 100}}
    assert any(
        "of the 1900 of 2000 that were assembled" in text
        for text in texts_of(chain_figure(typed_run(summary), "shoulder swing"))
    )


def assert_labels_apart(figure: Figure, least: int) -> None:
    """So many labels at least, none over another one and none beyond the picture."""
    figure.canvas.draw()
    width, height = figure.canvas.get_width_height()
    boxes = [(text.get_text(), text.get_window_extent()) for text in artists_of(figure)]
    assert len(boxes) > least
    for text, box in boxes:
        assert box.x0 >= 0, text
        assert box.y0 >= 0, text
        assert box.x1 <= width, text
        assert box.y1 <= height, text
    for (text, box), (other, beside) in itertools.combinations(boxes, 2):
        apart = box.x1 <= beside.x0 or beside.x1 <= box.x0 or box.y1 <= beside.y0 or beside.y1 <= box.y0
        assert apart, (text, other)


@pytest.mark.slow
@covering(count=[1, 2, 3, 4, 5, 6, 7, 9, 12], lever=[LEVER, None])
def test_no_two_labels_overlap_and_none_leaves_the_picture(count: int, lever: float) -> None:
    assert_labels_apart(chain_figure(typed_run(long_train(count, lever)), "shoulder swing"), 12 * count)


@pytest.mark.slow
@pytest.mark.parametrize("others", [1, 2, 3, 4])
def test_a_long_title_and_many_published_names_stand_apart_and_every_one_is_named(others: int) -> None:
    summary = long_train(3)
    train = summary["trains"].pop("shoulder swing")
    name = "the train that swings the arm of the robot about its shoulder, as measured on the bench"
    summary["trains"][name] = train | {
        "driven": "the shaft of the motor " * 4,
        "held": "the shaft that the brake holds",
    }
    for each in (*train["stages"], train["sums"]):
        own = train["sums"]["geometric"] if each is train["sums"] else each["methods"]["geometric"]
        each["published"] = {f"{k}: a column of somebody's own long paper": own for k in range(others)}
    figure = chain_figure(typed_run(summary), name)
    assert_labels_apart(figure, 36)
    texts = texts_of(figure)
    assert [text[0] for text in texts if text.endswith(": high")] == [str(k) for k in range(others)]
    assert sum(text.startswith("the train that swings") for text in texts) == 1
    assert "2000 trials, seed 7" in " ".join(texts).replace("\n", " ")


@covering(count=[1, 3, 4, 5, 6, 8], lever=[LEVER, None], teeth=[(31, 31), (20, 40), (40, 20)])
def test_no_cone_reaches_under_a_shaft(count: int, lever: float | None, teeth: tuple[int, int]) -> None:
    summary = long_train(count, lever)
    for each in summary["trains"]["shoulder swing"]["stages"]:
        each |= {"kind": "bevel_mesh", "teeth": list(teeth)}
    figure = chain_figure(typed_run(summary), "shoulder swing")
    cones = [patch.get_window_extent() for patch in figure.findobj(Polygon) if to_hex(patch.get_edgecolor()) == CONES]
    shafts = [box.get_window_extent() for box in figure.findobj(FancyBboxPatch) if to_hex(box.get_facecolor()) == SHAFT]
    assert len(cones) == 2 * count
    assert len(shafts) > count
    for cone, shaft in itertools.product(cones, shafts):
        assert not cone.overlaps(shaft)


def test_a_train_without_an_arm_shows_no_length() -> None:
    assert not any(
        "mm" in text for text in texts_of(chain_figure(typed_run(long_train(4, lever=None)), "shoulder swing"))
    )


@given(st.text(alphabet="aWi $", min_size=1, max_size=60).filter(str.strip), st.floats(0.4, 3.0))
def test_a_wrapped_name_keeps_its_letters_or_ends_in_an_ellipsis(text: str, width: int) -> None:
    lines = wrapped(text, width, 9.0, 3).replace("\\$", "$")
    assert lines.count("\n") < 3
    kept = lines.replace("\n", "").replace(" ", "")
    whole = text.replace(" ", "")
    assert kept == whole or (kept.endswith("…") and whole.startswith(kept[:-1]))


# the run's process --------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_run_with_trains_draws_a_picture_of_each_beside_the_histogram(tmp_path: Path) -> None:
    summary = shoulder()
    summary["trains"]["wrist: a/b"] = summary["trains"]["shoulder swing"]
    with picture.drawing() as draw:
        draw(valid(summary), tmp_path / "histogram.png")
    assert {path.name for path in tmp_path.iterdir()} == {"histogram.png", "chain.png", "chain-wrist_ a_b.png"}
    assert imread(tmp_path / "chain.png").shape[1] >= 1600


@pytest.mark.slow
def test_a_chain_that_cannot_be_drawn_costs_a_warning_and_not_the_histogram(tmp_path: Path) -> None:
    summary = shoulder()
    (tmp_path / "chain.png").symlink_to(tmp_path / "no such folder" / "picture.png")
    with (
        picture.drawing() as draw,
        pytest.warns(picture.PictureWarning, match=r"^chain\.png could not be drawn \(.*No such file"),
    ):
        draw(valid(summary), tmp_path / "histogram.png")
    assert {path.name for path in tmp_path.iterdir()} == {"histogram.png"}
