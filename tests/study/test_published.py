"""The paper's printed figures stand beside ours in words that its own numbers bear out."""

import json
import math
import pickle
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import jsonschema
import pytest
from fixtures import Command
from matplotlib.patches import StepPatch
from places import SCENES
from printing import printed
from pydantic import ValidationError
from scene_texts import written
from schemas import validate

from tol3d import Run, load_scene
from tol3d.apps.adjustment.compensation import CompensationQuestion, compensation
from tol3d.apps.adjustment.compensation_table import highs_table
from tol3d.report import published as shown
from tol3d.report.chart_figure import charts_figure
from tol3d.report.measure_charts import histogram
from tol3d.report.measure_table import curve_table
from tol3d.report.published import published_notes
from tol3d.report.table import run_report
from tol3d.scene import scene_from_python
from tol3d.scene.published import PublishedMeasure
from tol3d.simulate import Overrides, run_scene
from tol3d.study.runs.summary.kinds import default_kinds
from tol3d.study.runs.summary.measure import PublishedColumn
from tol3d.study.runs.summary.sample import Sample

COS, SIN = math.cos(math.radians(20)), math.sin(math.radians(20))
JUST_RUN = Overrides(trials=20, engine="analytic")
SHOWN = ("spur_pair", "bevel_pair", "bevel_pair_3dcs", "robot_shoulder", "robot_shoulder_shimmed", "every_field")


def published(scene: str, column: str, measure: str) -> Any:
    return load_scene(SCENES / f"{scene}.yaml").published[column][measure]


def um(quantity: Any) -> float:
    return float(1000 * quantity.internal)


@pytest.mark.parametrize("scene", SHOWN)
def test_what_a_scene_says_of_other_peoples_numbers_is_printed_below_them_whole(scene: str, tmp_path: Path) -> None:
    run = run_scene(SCENES / f"{scene}.yaml", overrides=JUST_RUN, out=tmp_path / "run")
    text = " ".join(printed(run_report(run.found), 90).split())
    told = [
        (measure, column, values.description)
        for column, measures in load_scene(SCENES / f"{scene}.yaml").published.items()
        for measure, values in measures.items()
        if values.description
    ]
    assert told
    for measure, column, description in told:
        assert run.summary["measures"][measure]["published"][column]["description"] == description
        assert f"{column}: {' '.join(description.split())}" in text


def test_the_papers_sigmas_and_its_mean_stand_in_its_columns() -> None:
    spur = published("spur_pair", "paper, analytic", "normal backlash")
    bevel = published("bevel_pair", "paper, analytic", "normal backlash")
    assert (um(spur.mean), um(spur.sigma)) == pytest.approx((53.0, 7.0))
    assert (um(bevel.mean), um(bevel.sigma)) == pytest.approx((89.5, 6.7))
    for scene in ("robot_shoulder", "bevel_pair_3dcs"):
        name = "bevel normal backlash" if scene == "robot_shoulder" else "normal backlash"
        assert um(published(scene, "paper, analytic", name).sigma) == pytest.approx(6.7)


def test_the_words_on_table_3_follow_from_tables_1_and_3() -> None:
    """Variances as the paper has them, its section 2.1; shares of Table 3 beside them."""
    thickness, centre_distance = 11**2 * COS**2 / 36, 4 / 9 * 20**2 * SIN**2
    rest = (27**2 + 31**2 + 8**2) * SIN**2 / 9 + 28**2 * SIN**2 / 36
    whole = 2 * thickness + centre_distance + rest
    table3 = published("spur_pair", "paper, 3DCS", "normal backlash")
    share = table3.contributors["pinion tooth thickness"] / 100
    told = math.sqrt(thickness / share)
    numbers = [float(text) for text in re.findall(r"\d+(?:\.\d+)?", table3.description.replace("Table 4", "").replace("Table 3", "").replace("(Table 1)", ""))]  # fmt: skip # noqa: E501
    expected = [11, math.sqrt(thickness), 22, told, 54, 3 * told, 34, 75, 100 * thickness / whole]
    expected.append(100 * centre_distance / whole)
    assert numbers == [pytest.approx(value, abs=0.05 if value < 10 else 0.5) for value in expected]
    assert 3 * told < 0.55 * (75 - 34) / 2  # they do not go together: a little over half of the printed range


@pytest.mark.parametrize("scene", ["bevel_pair", "bevel_pair_3dcs"])
def test_the_sigma_of_3dcs_is_marked_as_derived_and_agrees_with_table_7(scene: str) -> None:
    told = published(scene, "paper, 3DCS", "normal backlash")
    assert um(told.sigma) == pytest.approx((um(told.high_3sigma) - um(told.low_3sigma)) / 6)
    assert "derived, not printed" in told.description
    of_thickness = math.sqrt(21**2 * COS**2 / 36 / (told.contributors["driver tooth thickness"] / 100))
    assert of_thickness == pytest.approx(um(told.sigma), rel=0.002)


def test_what_compensation_leaves_of_each_pair_is_the_papers() -> None:
    """34″ and 1′17″: highs less means, (75 - 54) and (61 - 43) um, by 0.12195/d degrees each, d 275 and 102.1 mm."""
    scene = load_scene(SCENES / "robot_shoulder_shimmed.yaml")
    found = compensation(scene, CompensationQuestion(None, 1, 2))
    text = printed(highs_table([found]), 120)
    of_paper = text[text.index("paper, 3DCS") :].splitlines()
    left = {line.split(",")[0].strip(): line.split()[-1] for line in of_paper if "at its driven shaft" in line}
    assert left == {"– of spur pair": "33.5″", "– of bevel pair": "1′17.4″"}
    by_hand = (0.12195 * (75 - 54) / 275 * 3600, 0.12195 * (61 - 43) / 102.1 * 3600)
    assert by_hand == pytest.approx((33.5, 77.4), abs=0.05)


@pytest.mark.parametrize(
    ("said", "told"),
    [("a\x1b[31mb", "without invisible characters"), ("a" * 2001, "up to 2000"), ("two\n lines\n", "two lines")],
)
def test_a_description_is_one_line_that_moves_no_cursor(said: str, told: str) -> None:
    if told.startswith(("without", "up")):
        with pytest.raises(ValidationError, match=told):
            PublishedMeasure.model_validate({"description": said})
    else:
        assert PublishedMeasure.model_validate({"description": said}).description == told


def test_any_number_of_a_sample_may_be_published_and_stands_in_its_row(tmp_path: Path) -> None:
    given = "p0.135: 30 um, p50: 53 um, p99.865: 76 um, ppk: 1.5, below_limit_ppm: 12, skewness: 0.1"
    text = (SCENES / "spur_pair.yaml").read_text("utf-8")
    column = f"published:\n  shop floor:\n    normal backlash: {{{given}}}\n"
    scene = written(text[: text.index("published:")] + column, tmp_path)
    run = run_scene(scene, overrides=Overrides(trials=50, witness=0), out=tmp_path / "run")
    published = run.summary["measures"]["normal backlash"]["published"]["shop floor"]
    assert published == pytest.approx(
        {"p0.135": 30.0, "p50": 53.0, "p99.865": 76.0, "ppk": 1.5, "below_limit_ppm": 12.0, "skewness": 0.1}
    )
    rows = [line.split() for line in printed(run_report(run.found), 120).splitlines()]
    assert next(row for row in rows if row[:3] == ["50", "%", "quantile"])[-1] == "53"
    assert next(row for row in rows if row[:1] == ["Ppk"] and row[1] != "by")[-1].startswith("1.5")


def test_published_numbers_are_numbers_of_samples() -> None:
    keys = {str(field.validation_alias or name) for name, field in PublishedMeasure.model_fields.items()}
    numbers = {str(field.validation_alias or name) for name, field in PublishedColumn.model_fields.items()}
    sample = {str(field.validation_alias or name) for name, field in Sample.model_fields.items()}
    assert keys == numbers
    assert sample - keys == {"error_by", "ppk_by", "ppk_reason"}  # words


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"p50": "53 um", "p99.865": "50 um"}, "at most p99.865"),
        ({"sample_min": "9 um", "p0.135": "8 um"}, "at most p0.135"),
        ({"sigma_se": "0 um"}, "more than 0"),
        ({"out_ppm": -1.0}, "greater than or equal to 0"),
    ],
)
def test_published_numbers_that_cannot_be_are_refused(given: dict[str, object], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        PublishedMeasure.model_validate(given)


WHOLE = """
published:
  paper:
    normal backlash:
      nominal: 0.053 mm
      pooled: {half range: 30000 nm}
      status: {ok: 96, no contact: 4}
      below_limit_ppm_95: [10, 40]
      skewness: 0.25
      trials: 100
      contributors: {pinion tooth thickness: {percent: 33, high_low_mean_percent: 41}, centre distance: 20}
      agreement: {max_abs_difference: 2 um, compared: 90}
      histogram: {lower_edge: 20 um, bin_width: 30 um, counts: [40, 56]}
    lost motion: {mean: 0.02 deg}
    joint: {yields: {yield_ppm: 987600}, correlations: {lost motion: {normal backlash: {r: 0.75, trials: 90}}}}
    trials: 100
    timing: {trials_per_s: 0.5}
"""


def with_published(folder: Path, published: str, scene: str = "spur_pair") -> Path:
    """A shipped scene with other columns of others."""
    text = (SCENES / f"{scene}.yaml").read_text("utf-8")
    return written(text.partition("\npublished:")[0] + "\n" + published, folder)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("whole")
    few = Overrides(trials=60, witness=0)
    return run_scene(with_published(folder, WHOLE), overrides=few, out=folder / "run")


def test_any_number_of_a_measure_is_kept_in_its_unit(whole: Run) -> None:
    own = whole.summary["measures"]["normal backlash"]["published"]["paper"]
    assert own == {
        "contributors": {
            "pinion tooth thickness": {"percent": 33.0, "high_low_mean_percent": 41.0},
            "centre distance": 20.0,
        },
        "skewness": 0.25,
        "trials": 100,
        "status": {"ok": 96, "no contact": 4},
        "nominal": pytest.approx(53.0),
        "below_limit_ppm_95": [10.0, 40.0],
        "pooled": {"half range": pytest.approx(30.0)},
        "histogram": {"lower_edge": pytest.approx(20.0), "bin_width": pytest.approx(30.0), "counts": [40, 56]},
        "agreement": {"max_abs_difference": pytest.approx(2.0), "compared": 90},
    }
    lost = whole.summary["measures"]["lost motion"]["published"]["paper"]
    assert lost == {"mean": pytest.approx(0.02 * 60)}  # arcmin
    assert whole.summary["published"]["paper"] == {
        "trials": 100,
        "joint": {
            "yields": {"yield_ppm": 987600.0},
            "correlations": {"lost motion": {"normal backlash": {"r": 0.75, "trials": 90}}},
        },
        "timing": {"trials_per_s": 0.5},
    }
    schema = default_kinds().run.model_json_schema()
    validate(json.loads((whole.path / "summary.json").read_text("utf-8")), schema)


def test_each_stands_beside_ours_in_print(whole: Run) -> None:
    lines = printed(run_report(whole.found), 160).splitlines()

    def row(*words: str) -> list[str]:
        return next(line.split() for line in lines if line.split()[: len(words)] == [*words])

    own = whole.summary["measures"]["normal backlash"]
    skewness = row("skewness")
    assert float(skewness[-1]) == 0.25
    assert float(skewness[-2]) == pytest.approx(own["geometric"]["skewness"], rel=1e-5)
    assert row("half", "range")[-1] == "30"
    assert row("trials", "assembled")[-1] == "96"
    assert row("trials", *whole.found.state("no contact").split())[-1] == "4"
    assert row("nominal", "build")[-1] == "53"
    assert [float(cell) for cell in row("centre", "distance")[-2:-1]] == [20.0]
    assert row("pinion", "tooth", "thickness")[-2:] == ["33.0", "41.0"]
    names, matrices = whole.summary["joint"]["correlated"], whole.summary["joint"]["correlations"]
    i, j = names.index("lost motion"), names.index("normal backlash")
    r = row("joint", "·", "correlations", "·", "lost", "motion", "·", "normal", "backlash", "·", "r")
    ours = [matrices["analytic"]["r"][i][j], matrices["geometric"]["r"][i][j]]
    assert [float(cell) for cell in r[-3:]] == pytest.approx([*ours, 0.75], rel=1e-5)
    yields = whole.summary["joint"]["yields"]
    cells = row("joint", "·", "yields", "·", "yield_ppm")[-3:]
    expected = [yields["analytic"]["yield_ppm"], yields["geometric"]["yield_ppm"], 987600.0]
    assert [float(cell) for cell in cells] == pytest.approx(expected, rel=1e-5)
    assert ["trials", "60", "60", "100"] in [line.split() for line in lines]
    assert any("at most 2.000 µm, of 90 trials" in line for line in lines)


def test_a_correlation_is_that_of_its_method() -> None:
    found = {"analytic": {"r": [[1.0, 0.25], [0.25, 1.0]]}, "geometric": {"r": [[1.0, 0.5], [0.5, 1.0]]}}
    joint: Any = SimpleNamespace(correlated=["a", "b"], correlations=found)
    of_methods = [shown._correlation(joint, ("a", "b"), method) for method in ("analytic", "geometric")]
    assert of_methods == [0.25, 0.5]


def test_the_picture_has_the_published_histogram_at_its_density(whole: Run) -> None:
    """40 and 56 of 100 trials in bars of 30 um: 1.333 and 1.867 % a um."""
    axes = charts_figure([[histogram("normal backlash", whole.found.measures["normal backlash"])]]).axes[0]
    outlines = [own.get_data() for own in axes.patches if isinstance(own, StepPatch)]
    values, edges, _ = next(each for each in outlines if len(each[0]) == 2)
    assert values == pytest.approx([40 / 30, 56 / 30])
    assert edges == pytest.approx([20, 50, 80])


def test_a_published_curve_stands_at_its_positions(tmp_path: Path) -> None:
    column = """published:
  bench:
    normal backlash curve: {position_deg: [0, 90, 10], curve: {mean: [90 um, 95 um, 1 um], out_ppm: 500}}
"""
    path = with_published(tmp_path, column, "every_field")
    (tmp_path / "wheel_thickness.csv").write_bytes((SCENES / "wheel_thickness.csv").read_bytes())
    run = run_scene(path, overrides=JUST_RUN, out=tmp_path / "run")
    measure = run.found.measures["normal backlash curve"]
    assert measure.curve
    table = curve_table(measure, measure.curve)
    assert table.headings[-1].text == "bench: mean"
    shown = {float(row.label): row.cells[-1] for row in table.rows}
    assert {at: cell for at, cell in shown.items() if cell != "–"} == {0.0: "90.000", 90.0: "95.000"}
    assert "bench: anywhere on the curve: out in all 500 ppm" in [*published_notes(measure)]


def test_a_train_has_what_is_said_of_it_and_else_what_its_meshes_give(tmp_path: Path) -> None:
    """The sum of highs of others who say nothing of the reducer has ours of it."""
    column = """published:
  bench:
    spur lost motion: {mean: 50 arcsec, high_3sigma: 70 arcsec}
    bevel lost motion: {mean: 3 arcmin, high_3sigma: 4 arcmin}
    trains:
      shoulder swing: {stages: {spur pair: {mean: 60 arcsec, high_3sigma: 90 arcsec}}}
  said:
    trains:
      shoulder swing: {ratio: 600, sums: {high_3sigma: 5 arcmin}}
"""
    run = run_scene(with_published(tmp_path, column, "robot_shoulder"), overrides=JUST_RUN, out=tmp_path / "run")
    (train,) = run.summary["trains"].values()
    stages = {stage["link"]: stage for stage in train["stages"]}
    assert stages["spur pair"]["published"]["bench"] == pytest.approx({"mean": 1.0, "high_3sigma": 1.5})
    assert stages["bevel pair"]["published"]["bench"]["mean"] == pytest.approx(3.0)
    reducer = stages["planetary reducer"]["methods"]["analytic"]["high_3sigma"]
    expected = 4.0 + stages["spur pair"]["factor"] * 1.5 + stages["planetary reducer"]["factor"] * reducer
    assert train["sums"]["published"]["bench"]["high_3sigma"] == pytest.approx(expected)
    assert train["sums"]["published"]["said"] == {"high_3sigma": 5.0}
    rows = [line.split() for line in printed(run_report(run.found), 200).splitlines()]
    ratio = next(row for row in rows if row[:5] == ["trains", "·", "shoulder", "swing", "·"] and "ratio" in row)
    assert [float(cell) for cell in (ratio[-3], ratio[-1])] == pytest.approx([train["ratio"], 600.0], rel=1e-5)


def test_a_measure_of_the_name_of_a_key_is_meant_where_it_may_be(tmp_path: Path) -> None:
    text = (SCENES / "spur_pair.yaml").read_text("utf-8").partition("\npublished:")[0]
    path = tmp_path / "scene.yaml"
    column = "\npublished:\n  a: {joint: {mean: 5 um}}\n  b: {joint: {yields: {yield_ppm: 7}}}\n"
    path.write_text(text.replace("\n  normal backlash:", "\n  joint:") + column, "utf-8")
    scene = load_scene(path)
    assert um(scene.published["a"]["joint"].mean) == pytest.approx(5.0)
    assert scene.published["a"].figures == {}
    assert scene.published["b"].figures["joint"].yields.yield_ppm == 7.0
    again = scene_from_python(type(scene).model_validate(scene.model_dump(exclude_unset=True, by_alias=True)))
    assert again.published == scene.published
    assert pickle.loads(pickle.dumps(scene)).published == scene.published
    whole = type(scene).model_json_schema()
    schema = {key: own for key, own in whole.items() if key not in ("required", "anyOf")}  # sections that it must have
    validate({"published": {"a": {"joint": {"mean": "5 um"}}}}, schema)
    refused: list[dict[str, Any]] = [
        {"joint": {"yelds": {}}},
        {"trials": "many"},
        {"trains": {"x": {"sums": {"mean": "3 um"}}}},
    ]
    for wrong in refused:
        with pytest.raises(jsonschema.ValidationError):
            validate({"published": {"a": wrong}}, schema)


REFUSED = {
    "normal backlash: {nominl: 3 um}": 'normal backlash.nominl: unknown key "nominl"; did you mean "nominal"?',
    "jont: {yields: {yield_ppm: 5}}": 'jont: unknown key "jont"; did you mean "joint"?',
    "joint: {yield: {yield_ppm: 5}}": 'joint.yield: unknown key "yield"; did you mean "yields"?',
    "joint: {yields: {within: 6, trials: 5}}": "joint.yields.within: expected at most the 5 trials, got 6",
    "joint: {yields: {yield_ppm_95: [9, 7]}}": "expected the lower bound first, at most 7, got 9",
    "joint: {correlations: {lost motion: {normal backlsh: 0.5}}}": "joint.correlations.lost motion.normal backlsh: "
    "expected the name of a measure, got 'normal backlsh'; did you mean \"normal backlash\"?",
    "joint: {correlations: {lost motion: {normal backlash: 1.5}}}": "expected a number of at most 1, got 1.5",
    "joint: {correlations: {lost motion: {lost motion: 1}}}": "expected another measure, got 'lost motion'",
    "joint: {correlations: {lost motion: {normal backlash: high}}}": "expected a number, or keys with",
    "normal backlash: {pooled: {x: 3 deg}}": "normal backlash.pooled.x: expected a length with its unit",
    "normal backlash: {curve: {out_ppm: 3}}": "curve: expected none, for 'normal backlash' has one value a trial",
    "normal backlash: {curve: {mean: [3 um]}}": "normal backlash.position_deg: expected the positions of the curve",
    "normal backlash: {position_deg: [1], curve: {mean: [3 um, 4 um]}}": "curve.mean: expected 1 values, as",
    "normal backlash: {agreement: {rms_difference: 3}}": "agreement.rms_difference: expected a number with its unit",
    "normal backlash: {contributors: {centre distance: {percents: 3}}}": '"percents"; did you mean "percent"?',
    "normal backlash: {histogram: {lower_edge: 3 um, bin_width: 0 um, counts: [3]}}": "bin_width: expected more",
    "trains: {shoulder: {ratio: 3}}": "trains.shoulder: expected the name of a train, got 'shoulder'",
    "timing: {trials_per_s: -3}": "timing.trials_per_s: expected a number of at least 0, got -3",
    "anything: {mean: 3 um}": "expected the name of a measure, got 'anything'",
}


@pytest.mark.parametrize(("said", "words"), REFUSED.items())
def test_what_cannot_be_published_is_refused_in_one_line(said: str, words: str, tol3d: Command, tmp_path: Path) -> None:
    path = with_published(tmp_path, f"published:\n  paper:\n    {said}\n")
    code, _, err = tol3d("check", str(path))
    assert code == 2
    assert words in " ".join(err.split())
    assert "published.paper." in err
    assert "Traceback" not in err
    assert err.count("scene.yaml:") == 1
