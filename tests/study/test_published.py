"""What the paper printed stands beside ours in words that its own numbers bear out."""

import math
import re
from pathlib import Path
from typing import Any

import pytest
from places import SCENES
from printing import printed
from pydantic import ValidationError

from tol3d import load_scene
from tol3d.analyses.compensation import CompensationQuestion, compensation
from tol3d.analyses.compensation_table import worst_table
from tol3d.report.table import run_report
from tol3d.runs.summary.measure import PublishedColumn
from tol3d.scene.published import PublishedMeasure
from tol3d.simulate import Overrides, run_scene

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
    text = printed(worst_table([found]), 120)
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
    scene = tmp_path / "scene.yaml"
    scene.write_text(text[: text.index("published:")] + column, "utf-8")
    run = run_scene(scene, overrides=Overrides(trials=50, witness=0), out=tmp_path / "run")
    published = run.summary["measures"]["normal backlash"]["published"]["shop floor"]
    assert published == pytest.approx(
        {"p0.135": 30.0, "p50": 53.0, "p99.865": 76.0, "ppk": 1.5, "below_limit_ppm": 12.0, "skewness": 0.1}
    )
    rows = [line.split() for line in printed(run_report(run.found), 120).splitlines()]
    assert next(row for row in rows if row[:3] == ["50", "%", "quantile"])[-1] == "53"
    assert next(row for row in rows if row[:1] == ["Ppk"])[-1].startswith("1.5")


def test_published_numbers_are_numbers_of_samples() -> None:
    """But for those that say nothing without the run: counts, what a grid resolves, the deepest overlap."""
    ours = {"count", "trials", "quantile_error", "outside_grid", "deepest_overlap"}
    keys = {str(field.validation_alias or name) for name, field in PublishedMeasure.model_fields.items()}
    numbers = {str(field.validation_alias or name) for name, field in PublishedColumn.model_fields.items()}
    assert keys == numbers - ours


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
