"""The number on the card is that of a run and of `what-if`, and what is kept in the scene's file has it too."""

import json
import re
import shutil
from collections.abc import Iterator, Mapping
from concurrent.futures import wait
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from places import SPUR_PAIR

from tol3d import InputError, Overrides, run_scene
from tol3d.analyses.before_after import what_if
from tol3d.analyses.stated_changes import factor_of
from tol3d.analyses.stated_limits import limits_of_text
from tol3d.apps.workbench import session
from tol3d.apps.workbench.card import NO_SHARES, sliders
from tol3d.apps.workbench.folder_questions import FolderQuestions
from tol3d.apps.workbench.place import APP, FolderLock
from tol3d.apps.workbench.questions import Questions, StaleError
from tol3d.apps.workbench.session import NoEstimate, Turn
from tol3d.apps.workbench.workspace import MOST_UNDONE, Workspace
from tol3d.numerics.arrays import Array
from tol3d.study.runs.summary.judged import JudgedMeasure
from tol3d.study.runs.summary.sample import CurveSample, Sample

TRIALS = 200
SCENE = "pair.yaml"
TEXT = SPUR_PAIR.read_text("utf-8").replace("trials: 2000, seed: 1", f"trials: {TRIALS}, seed: 7")
BACKLASH, MOTION, CENTRE = "normal backlash", "lost motion", "centre distance"
WIDER = {CENTRE: "x1.65"}
DIGITS = 1e-9
"""Relative: a kept tolerance is written to ten digits."""


def opened(folder: Path, text: str = TEXT) -> Questions:
    """Questions of a folder with one scene."""
    (folder / SCENE).write_bytes(text.encode())
    return Questions(Workspace.of(folder), FolderLock(folder))


def of_folder(questions: Questions) -> FolderQuestions:
    """Questions on the folder, beside those on its scenes."""
    return FolderQuestions(questions.workspace, questions.lock)


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Questions]:
    """The spur pair, as it is."""
    questions = opened(tmp_path_factory.mktemp("pair"))
    yield questions
    questions.close()


@pytest.fixture
def own(tmp_path: Path) -> Iterator[Questions]:
    """One that is changed."""
    questions = opened(tmp_path)
    yield questions
    questions.close()


def asked(now: dict[str, str] | None = None, **words: Any) -> dict[str, Any]:
    return {"scene": SCENE, "measure": BACKLASH, "now": now or {}, **words}


def sample(questions: Questions, now: dict[str, str] | None = None, measure: str = BACKLASH) -> Sample:
    """Statistics of a card, all of its trials."""
    while "answer" not in (told := questions.card(asked(now, measure=measure))) or told["done"] < told["of"]:
        pass
    found = questions.session(SCENE).evaluated(measure, now or {})
    assert found.done == found.count == TRIALS
    return found.sample


def answered(questions: Questions, now: dict[str, str]) -> dict[str, Any]:
    """Answer of a card, all of its trials."""
    sample(questions, now)
    return dict(questions.card(asked(now)))


def diff_lines(told: Mapping[str, Any]) -> list[str]:
    return [line for line in told["diff"].splitlines() if line[0] in "+-" and line[:3] not in ("+++", "---")]


def numbers(found: Sample | CurveSample) -> dict[str, float]:
    """Numbers of a sample."""
    return {key: value for key, value in found.model_dump().items() if isinstance(value, int | float)}


def estimated(questions: Questions, now: dict[str, str]) -> Array:
    """The estimate, when all that it takes is there."""
    found = questions.session(SCENE).estimate(BACKLASH, now, Turn())
    while isinstance(found, NoEstimate):
        assert found.is_coming
        found = questions.session(SCENE).estimate(BACKLASH, now, Turn())
    return found


def path_of(questions: Questions) -> Path:
    return questions.workspace.folder / SCENE


def test_the_card_s_numbers_are_those_of_a_run_bit_for_bit(pair: Questions, tmp_path: Path) -> None:
    run = run_scene(path_of(pair), overrides=Overrides(witness=0), out=tmp_path / "run")
    for measure in (BACKLASH, MOTION):
        summary = run.found.measures[measure]
        assert sample(pair, measure=measure) == summary.shares
        judged = pair.session(SCENE).evaluated(measure, {}).judged
        assert judged == JudgedMeasure.of(summary)
        shown = pair.card(asked(measure=measure))["answer"]
        assert f">{judged.verdict}</p>" in shown
        assert f"{TRIALS} trials" in shown


def test_a_moved_tolerance_has_the_numbers_of_what_if_and_of_the_kept_scene(own: Questions, tmp_path: Path) -> None:
    response = own.session(SCENE).response
    after = what_if(response, [factor_of(response, f"{CENTRE}=1.65")], BACKLASH, draws=0).measures[BACKLASH].after
    tried = sample(own, WIDER)
    assert (tried.mean, tried.sigma, tried.p0_135, tried.p99_865) == (after.mean, after.sigma, after.low, after.high)
    assert (tried.ppk, tried.out_ppm, tried.out_ppm_95) == (after.ppk, after.out_ppm, after.out_ppm_95)
    assert own.session(SCENE).evaluated(BACKLASH, WIDER).judged.verdict == after.verdict
    assert tried.sigma is not None
    assert tried.sigma > 1.2 * (sample(own).sigma or np.inf)

    told = own.keep(asked(WIDER))
    own.keep(asked(WIDER, write=True, digest=told["digest"]))
    run = run_scene(path_of(own), overrides=Overrides(witness=0), out=tmp_path / "run")
    for kept in (run.found.measures[BACKLASH].shares, sample(own)):
        assert numbers(kept) == pytest.approx(numbers(tried), rel=DIGITS)


LIMITED = {"limits: normal backlash": "36 µm..70 um"}


@pytest.mark.parametrize("more", [{}, WIDER])
def test_other_limits_have_the_numbers_of_what_if_and_of_the_kept_scene(
    more: dict[str, str], own: Questions, tmp_path: Path
) -> None:
    """Without a change of a tolerance nothing is evaluated for them."""
    now = {**LIMITED, **more}
    response = own.session(SCENE).response
    changes = [factor_of(response, f"{CENTRE}=1.65")] if more else []
    limits = [limits_of_text(response, "normal backlash=36 um..70 um")]
    found = what_if(response, changes, BACKLASH, limits=limits, draws=0).measures[BACKLASH]
    scene = own.card(asked())["answer"]
    answered(own, more)
    before = response.evaluations
    card = answered(own, now)
    assert response.evaluations == before
    judged = own.session(SCENE).evaluated(BACKLASH, now).within(limits)
    after, tried = found.after, judged.sample
    assert (tried.mean, tried.sigma, tried.p0_135, tried.p99_865) == (after.mean, after.sigma, after.low, after.high)
    assert (tried.ppk, tried.out_ppm, tried.out_ppm_95) == (after.ppk, after.out_ppm, after.out_ppm_95)
    assert judged.judged.verdict == after.verdict == "NOT OK"
    assert found.limits_before == [15.0, None]
    assert (found.lower_limit, found.upper_limit) == pytest.approx((36.0, 70.0), rel=1e-12)
    low, high = ((judged.good < 36.0).mean(), (judged.good > 70.0).mean())
    assert tried.out_ppm == pytest.approx(1e6 * (low + high), rel=1e-12)
    assert tried.out_ppm != found.before.out_ppm
    assert min(low, high) > 0.0
    for words in (">NOT OK</p>", "limits 36 to 70 µm", f"{1e-4 * (tried.out_ppm or 0.0):.4g} %"):
        assert words in card["answer"]
    assert {key: told["now"] for key, told in card["limits"].items()} == {
        "lower_limit": "36 µm",
        "upper_limit": "70 µm",
    }
    for words in ("LSL 36 µm", "USL 70 µm"):
        assert words in card["chart"]
        assert words in own.estimate(asked(now))["chart"]
    assert own.card(asked())["answer"] == scene

    told = own.keep(asked(now))
    changed = [
        "-    lower_limit: 15 um  # the paper's lower limit",
        "+    lower_limit: 36 um  # the paper's lower limit",
        "+    upper_limit: 70 um",
    ]
    assert diff_lines(told)[-3:] == changed
    aside = {"limits: normal backlash": "none..", CENTRE: "x0.5"}
    own.keep(asked(now, write=True, digest=told["digest"], beside=[aside]))
    assert own.scene(asked())["notes"]["beside"] == [aside | {CENTRE: "±10 µm"}]
    run = run_scene(path_of(own), overrides=Overrides(witness=0), out=tmp_path / "run")
    summary = run.found.measures[BACKLASH]
    assert summary.limits == pytest.approx((36.0, 70.0), rel=1e-12)
    for kept in (summary.shares, sample(own)):
        assert numbers(kept) == pytest.approx(numbers(tried), rel=DIGITS)
    assert JudgedMeasure.of(summary) == judged.judged


def test_a_limit_can_be_left_out_and_comes_back(pair: Questions) -> None:
    none = answered(pair, {"limits: normal backlash": "none.."})
    assert ">no limits</p>" in none["answer"]
    assert none["limits"]["lower_limit"] == {"now": "none", "scene": "15 µm", "is": True}
    assert none["limits"]["upper_limit"] == {"now": "", "scene": "", "is": True}
    assert "LSL" not in none["chart"]
    assert answered(pair, {})["limits"]["lower_limit"]["now"] == "15 µm"
    other = pair.card(asked({"limits: lost motion": "..9 arcmin"}))
    assert {**other, "written": {}} == answered(pair, {}), "limits of another measure"
    with pytest.raises(InputError, match="expected a lower limit below the upper one, got 15 um and 9 um"):
        pair.card(asked({"limits: normal backlash": "..9 um"}))


FITTED = TEXT.replace("{kind: normal, lower: -20 um, upper: 20 um}", "{fit: js7, of: 172.5 mm}").replace(
    "parts:", "default_law: {kind: normal, sigmas: 3}\nparts:", 1
)


def test_a_class_of_a_drawing_is_a_value_of_a_field(tmp_path: Path) -> None:
    """js7 of 172.5 mm is ±20 µm, k6 +3 to +28, js8 ±31.5: ISO 286-2, tables 18 and 19."""
    questions = opened(tmp_path, FITTED)
    first = questions.sliders(asked())["sliders"]
    assert "js7: ±20 µm" in first
    assert 'value="js7"' in first
    assert [f'<option value="{own}">' in first for own in ("js5", "js6", "js7", "js8")] == [False, True, True, True]
    halved = {CENTRE: "x0.44"}
    moved = questions.sliders(asked(halved))["sliders"]
    assert 'value="±8.8 µm"' in moved
    assert '<span class="was">was </span>js7: ±20 µm' in moved
    kept = questions.keep(asked(halved))
    assert [line.strip() for line in diff_lines(kept)] == [
        "-    distribution: {fit: js7, of: 172.5 mm}",
        "+    distribution: ±0.0088 mm",
    ]
    for value, words, limits in (("k6", "k6: +28/+3 µm", (0.003, 0.028)), ("js8", "js8: ±31.5 µm", (-0.0315, 0.0315))):
        now = {CENTRE: value}
        assert questions.card(asked(now))["written"] == {CENTRE: value}
        assert words in questions.sliders(asked(now))["sliders"]
        law: Any = questions.session(SCENE).changed(now).drawn_by(CENTRE).distribution
        assert law.limits == pytest.approx(limits, rel=1e-12)
        kept = questions.keep(asked(now))
        assert diff_lines(kept)[1] == f"+    distribution: {{fit: {value}, of: 172.5 mm}}"
    with pytest.raises(InputError, match="expected"):
        questions.card(asked({CENTRE: "js77"}))
    with pytest.raises(InputError, match="no nominal size at which a class could be read, got 'H7'"):
        questions.card(asked({"bearing clearance": "H7"}))
    fit = "{fit: H7, of: 60 mm}"
    now = {"bearing clearance": "{ of: 60 mm, fit: H7 }"}
    assert questions.card(asked(now))["written"] == {"bearing clearance": fit}
    shown = questions.sliders(asked(now))["sliders"]
    assert f"{fit}: +30/0 µm" in shown
    assert 'value="{fit: H6, of: 60 mm}"' in shown
    questions.close()


def test_a_series_of_din_3967_is_a_value_of_a_field(tmp_path: Path) -> None:
    """Its words stand in the field, with the next finer and coarser; numbers of a slider stay numbers."""
    text = re.sub(r"(of: pinion\n    )distribution:.*", r"\1distribution: {din_3967: cd25}", FITTED, count=1)
    questions = opened(tmp_path, text)
    line = "pinion tooth thickness"
    first = questions.sliders(asked())["sliders"]
    assert 'value="cd25"' in first
    assert "cd25: -" in first
    assert [f'<option value="{own}">' in first for own in ("cd24", "cd25", "cd26", "cd27")] == [True] * 3 + [False]
    for words in ("d 24", "{din_3967: d 24}"):
        now = {line: words}
        assert questions.card(asked(now))["written"] == {line: "d 24"}
        assert 'value="d 24"' in questions.sliders(asked(now))["sliders"]
        assert diff_lines(questions.keep(asked(now)))[1].strip() == "+    distribution: {din_3967: d 24}"
    with pytest.raises(InputError, match="as in cd25, got 'cd40'"):
        questions.card(asked({line: "cd40"}))
    questions.close()


def test_limits_of_a_size_are_the_words_of_a_field(tmp_path: Path) -> None:
    """Of the span itself, as typed; half as wide about the middle; other sizes typed there stay so in the file."""
    text = re.sub(
        r"(of: pinion\n    )distribution:.*",
        r"\1measured: {span: 4}\n    distribution: {limits: 26.76 / 26.80 mm, law: {kind: uniform}}",
        TEXT,
        count=1,
    )
    questions, line = opened(tmp_path, text), "pinion tooth thickness"
    assert 'value="26.76 / 26.80 mm"' in questions.sliders(asked())["sliders"]
    for words, field in (("x0.5", "26.77 / 26.79 mm"), ("26.78/26.79 mm", "26.78 / 26.79 mm")):
        assert f'value="{field}"' in questions.sliders(asked({line: words}))["sliders"]
        assert questions.card(asked({line: words}))["written"] == {line: field}
        added = diff_lines(questions.keep(asked({line: words})))[1].strip("+ ")
        assert added == f"distribution: {{limits: {field}, law: {{kind: uniform}}}}"
    questions.close()


def test_moves_of_what_is_no_longer_in_the_scene_are_dropped_with_a_sentence(own: Questions) -> None:
    now = {
        CENTRE: "±31 um",
        "bearing clearance": "x1.1",
        "limits: lost motion": "..9 arcmin",
        "wheel eccentricity": "x2",
    }
    beside: list[dict[str, str]] = [{CENTRE: "x2"}, {"bearing clearance": "x1.05"}]
    own.notes(asked(now, beside=beside, past=[{}, *beside], measure=MOTION))
    text = TEXT.replace("  centre distance:", "  distance of centres:").replace("  lost motion:", "  motion lost:")
    path_of(own).write_text(text, "utf-8")
    found = own.scene(asked())
    assert found["notes"]["now"] == {"bearing clearance": "x1.1", "wheel eccentricity": "x2"}
    assert found["notes"]["beside"] == [{"bearing clearance": "x1.05"}]
    assert found["notes"]["past"] == [{}, {"bearing clearance": "x1.05"}]
    assert found["dropped"] == [
        "centre distance is no longer in the scene: its move was dropped.",
        "lost motion is no longer in the scene: its move was dropped.",
    ]
    own.card(asked(found["notes"]["now"]))
    narrower = text.replace("lower: 2 um, upper: 30 um", "lower: 0 um, upper: 30 um")
    path_of(own).write_text(narrower, "utf-8")
    sentence = own.scene(asked())["dropped"][1]
    assert sentence.startswith("bearing clearance can no longer be × 1.1: its move was dropped (")


def test_an_estimate_is_near_what_is_simulated(pair: Questions) -> None:
    """One of slopes at kept builds: the pair's own second order is thousandths of its spread."""
    opened_scene = pair.session(SCENE)
    for now in (WIDER, {"bearing clearance": "x0.7", "wheel eccentricity": "x1.5"}):
        dashed, solid = estimated(pair, now), opened_scene.evaluated(BACKLASH, now)
        sample(pair, now)
        assert np.isfinite(dashed).all()
        moved = solid.good - opened_scene.evaluated(BACKLASH, {}).good
        assert np.abs(dashed - solid.good).max() < 0.01 * np.std(moved)
        assert 'class="legend"' in pair.estimate(asked(now))["chart"]


def test_each_answer_takes_one_piece_where_builds_are_slow_and_nothing_is_lost(
    own: Questions, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of no time an answer takes one piece: 64 builds, the others up to 200; then slopes go on where they were."""
    monkeypatch.setattr(session, "AT_ONCE", 0.0)
    response, shown = own.session(SCENE).response, []
    for _ in range(2):
        shown.append(own.card(asked()))
    assert [(told["done"], "answer" in told, "chart" in told) for told in shown] == [
        (64, False, False),
        (200, True, True),
    ]
    before, waits = response.evaluations, []
    now = {"wheel eccentricity": "x1.5"}
    while (told := own.estimate(asked(now))).get("waits"):
        waits.append(told["none"])
        own.estimate(asked(WIDER))  # the latest wish goes first, and the other one is not forgotten
    assert 'class="legend"' in told["chart"]
    assert waits[0].startswith("check of slopes of wheel eccentricity: ")
    assert waits[-1].startswith("slopes of wheel eccentricity: ")
    estimated(own, WIDER)
    both, check, (runout, distance) = 2, 200, (2, 1)
    assert response.evaluations - before == both * check + 2 * (runout + distance) + 2 * runout * 200


def test_slopes_that_take_too_long_are_told_and_not_waited_for(own: Questions, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run-out has no slope at the mean build, and those at each build are left out; tooth thickness has one."""
    monkeypatch.setattr(session, "LONGEST_SLOPES", 0.0)
    sample(own)
    now = {"wheel eccentricity": "x1.5"}
    while (told := own.estimate(asked(now))).get("waits"):
        pass
    assert told["none"] == "slopes of wheel eccentricity take too long; release the slider to simulate"
    assert "chart" not in told
    assert np.isfinite(estimated(own, {"wheel tooth thickness": "x1.5"})).all()


def test_what_is_kept_is_one_line_of_the_file(own: Questions) -> None:
    told = own.keep(asked(WIDER))
    assert path_of(own).read_text("utf-8") == TEXT, "asked for, not written"
    old, new = "{kind: normal, lower: -20 um, upper: 20 um}", "{kind: normal, lower: -33 um, upper: 33 um}"
    assert diff_lines(told) == [f"-    distribution: {old}", f"+    distribution: {new}"]
    assert own.notes(asked(WIDER)) == {}
    again = own.keep(asked(WIDER, write=True, digest=told["digest"]))
    assert path_of(own).read_text("utf-8") == TEXT.replace(old, new)
    shown = own.scene(asked())
    assert (shown["digest"], shown["text"], shown["notes"]["now"]) == (again["digest"], TEXT.replace(old, new), {})


def test_ends_of_lines_stay(tmp_path: Path) -> None:
    text = TEXT.replace("\n", "\r\n")
    questions = opened(tmp_path, text)
    told = questions.keep(asked(WIDER))
    assert told["diff"].count("\n@@") == 1
    assert sum(line[0] in "+-" for line in told["diff"].splitlines()) == 4, "names, and one line before and after"
    questions.keep(asked(WIDER, write=True, digest=told["digest"]))
    kept = path_of(questions).read_bytes().decode()
    assert kept == text.replace("-20 um, upper: 20 um", "-33 um, upper: 33 um")
    shown = questions.scene(asked())
    questions.save(asked(text=TEXT, digest=shown["digest"]))
    assert path_of(questions).read_bytes().decode() == text, "an editor knows LF alone"
    questions.close()


def test_what_others_wrote_meanwhile_is_not_lost(own: Questions) -> None:
    told = own.keep(asked(WIDER))
    theirs = TEXT.replace("lower: 2 um, upper: 30 um", "lower: 2 um, upper: 40 um")
    before = sample(own).sigma
    path_of(own).write_text(theirs, "utf-8")
    assert of_folder(own).changed(asked())["digest"] != told["digest"]
    for call in (own.keep, own.save):
        with pytest.raises(StaleError, match=r"pair\.yaml was changed by another program since it was read here"):
            call(asked(WIDER, write=True, digest=told["digest"], text=TEXT))
    assert path_of(own).read_text("utf-8") == theirs
    assert sample(own).sigma != before, "what it says is read again"


def test_a_second_app_only_reads(own: Questions) -> None:
    other = Questions(own.workspace, FolderLock(own.workspace.folder))
    assert "another tol3d app has it open" in of_folder(other).folder({})["read_only"]
    told = other.keep(asked(WIDER))
    for call in (other.keep, other.save, of_folder(other).start, of_folder(other).analyse):
        with pytest.raises(InputError, match="this one only reads"):
            call(asked(WIDER, write=True, digest=told["digest"], text="", kind="effects"))
    assert other.notes(asked(WIDER)) == {}
    assert own.scene(asked())["notes"]["now"] == {}
    assert path_of(own).read_text("utf-8") == TEXT
    assert sample(other, WIDER) == sample(own, WIDER)
    other.close()


def test_what_ifs_outlive_the_app(own: Questions) -> None:
    beside = [{CENTRE: "x2"}, {CENTRE: "±10 um"}, {}, {CENTRE: "x3"}]
    past = [{CENTRE: f"±{own} µm"} for own in range(10, 35)]
    own.notes(asked(WIDER, measure=MOTION, beside=beside, past=past))
    own.lock.release()
    later = Questions(Workspace.of(own.workspace.folder), FolderLock(own.workspace.folder))
    assert later.scene(asked())["notes"] == {
        "now": WIDER,
        "beside": beside[:3],
        "past": past[-MOST_UNDONE:],
        "measure": MOTION,
    }
    later.close()


NOTES = {"version": 1, "now": WIDER, "beside": [], "measure": BACKLASH}


def test_an_app_begins_with_the_scene_that_was_opened_last(own: Questions) -> None:
    folder = own.workspace.folder
    (folder / "later.yaml").write_bytes((folder / SCENE).read_bytes())

    def first(place: Path) -> str:
        return str(FolderQuestions(Workspace.of(place), own.lock).folder({})["first"])

    assert first(folder) == ""
    for name in ("later.yaml", SCENE, "later.yaml"):
        own.scene(asked() | {"scene": name})
        assert first(folder) == name
        assert first(folder / SCENE) == SCENE, "the one that is asked for"
    file = own.workspace.notes_folder / "opened.json"
    for damaged in ("", "[]", "{}", '{"version": 1, "scene": ["x"]}', '{"version": 2, "scene": "later.yaml"}'):
        file.write_text(damaged)
        assert first(folder) == ""
    own.scene(asked() | {"scene": "later.yaml"})
    (folder / "later.yaml").unlink()
    assert first(folder) == ""


def test_an_app_that_only_reads_notes_no_scene_that_it_opens(own: Questions) -> None:
    reading = Questions(own.workspace, FolderLock(own.workspace.folder))
    assert reading.read_only
    reading.scene(asked())
    assert own.workspace.last == ""
    reading.close()


@pytest.mark.parametrize(
    "damaged",
    [
        *("", "{", "[]", "null", "[" * 100_000, "\0", '{"version": 1}'),
        *(
            json.dumps(NOTES | other)
            for other in ({"version": 2}, {"now": 3}, {"beside": 3}, {"beside": ["x"]}, {"past": 3}, {"past": ["x"]})
        ),
    ],
)
def test_notes_that_are_damaged_or_of_another_version_are_none(damaged: str, own: Questions) -> None:
    file = own.workspace.folder / APP / f"{SCENE}.json"
    file.write_text(json.dumps(NOTES))
    assert own.scene(asked())["notes"]["now"] == WIDER
    file.write_text(damaged)
    assert own.scene(asked())["notes"] == {"now": {}, "beside": [], "past": [], "measure": ""}


@pytest.mark.parametrize(
    ("now", "message"),
    [
        ({"center distance": "x2"}, "expected a contributor, got 'center distance'; did you mean"),
        ({CENTRE: "x0"}, "expected a factor above 0 such as 0.5, got '0'"),
        ({CENTRE: "xnan"}, "expected a factor above 0 such as 0.5, got 'nan'"),
        ({CENTRE: "±3 kg"}, "expected a length with its unit"),
        ({CENTRE: "wide"}, "expected a length with its unit"),
        ({CENTRE: ""}, "expected NAME=VALUE"),
        ({"bearing clearance": "-5 um..10 um"}, "expected at least 0 um, for less is not physical"),
    ],
)
def test_a_change_that_cannot_be_is_refused_with_words(now: dict[str, str], message: str, pair: Questions) -> None:
    for call in (pair.card, pair.estimate, pair.keep):
        with pytest.raises(InputError) as error:
            call(asked(now))
        assert message in str(error.value)
    with pytest.raises(InputError, match="normal backlash, lost motion"):
        pair.card(asked(measure="none"))


def test_a_wrong_scene_has_its_text_and_the_lines_of_its_faults(own: Questions) -> None:
    text = TEXT.replace("module: 2.5 mm", "modul: 2.5 mm", 1).replace("of: gear pair", "of: gear par", 1)
    line = 1 + text[: text.index("modul:")].count("\n")
    path_of(own).write_text(text, "utf-8")
    found = own.scene(asked())
    assert found["text"] == text
    assert "measures" not in found
    assert found["problems"] == own.check(asked(text=text))["problems"]
    assert line in [problem["line"] for problem in found["problems"]]
    assert own.check(asked(text=TEXT)) == {"problems": [], "warnings": []}
    with pytest.raises(InputError, match="modul"):
        own.card(asked())


def test_sliders_are_sorted_by_the_shares_of_a_run_and_end_where_a_tolerance_cannot_go(pair: Questions) -> None:
    first = pair.sliders(asked())
    assert len(first["acting"]) == 7
    wait(pair.runs.values())
    told = pair.sliders(asked(WIDER))
    assert (told["waits"], "%</span>" in told["sliders"]) == (False, True)
    lines = [part.partition('"')[0] for part in told["sliders"].split('<li data-line="')[1:]]
    (run,) = (own.result() for own in pair.runs.values())
    shares = {own.name: own.geometric_percent or 0.0 for own in run.found.measures[BACKLASH].contributors}
    low, high, at = (
        int(own) for own in re.findall(rf'min="(-\d+)" max="(\d+)" value="(\d+)"[^>]*"{CENTRE}"', told["sliders"])[0]
    )
    assert (1.01**at, 1.01**low, 1.01**high) == pytest.approx((1.65, 0.25, 4.0), rel=0.01)
    moved = [part.partition('"')[0] for part in told["sliders"].split('<li class="moved" data-line="')[1:]]
    assert moved == [CENTRE]
    assert lines == sorted([*{*shares} - {CENTRE}], key=lambda name: -shares[name])
    summary = run.found.measures[BACKLASH]
    unknown = [
        own.model_copy(update={"analytic_percent": None, "geometric_percent": None}) for own in summary.contributors
    ]
    words = sliders(
        pair.session("pair.yaml"),
        BACKLASH,
        {},
        summary.model_copy(update={"contributors": unknown, "analytic_closed_form": None}),
    )
    assert NO_SHARES in words
    assert "%</span>" not in words


def _picture(questions: Questions, **words: Any) -> dict[str, Any]:
    answer = questions.view(asked(**words))()
    found: dict[str, Any] = json.loads(answer[4 : 4 + int.from_bytes(answer[:4], "big")])
    return found


def test_a_build_that_is_not_there_has_a_sentence_and_the_nominal_one_is_shown(own: Questions) -> None:
    before = _picture(own, builds=["worst"])
    assert before["refused"] == {"worst": "no trial is simulated yet; shown is the nominal build"}
    assert [build["name"] for build in before["builds"]] == ["nominal"]
    sample(own)
    after = _picture(own, builds=["worst"])
    assert after["refused"] == {}
    values = own.session(SCENE).evaluated(BACKLASH, {}).good
    worst = int(np.argmin(values))
    words = after["builds"][1]["states"][0]["words"]
    assert words.startswith(f"trial {worst} of {TRIALS}, worst")
    number, unit = after["builds"][1]["states"][0]["values"][BACKLASH].split(" ")
    assert unit == "µm"
    assert float(number) == pytest.approx(values.min(), abs=1e-3)
    assert _picture(own, builds=["mean"])["builds"][1]["name"] == "mean"
    with pytest.raises(InputError, match=f"expected a trial from 0 to {TRIALS - 1}, got {TRIALS}"):
        own.view(asked(trial=TRIALS))


def test_while_a_slider_is_held_a_build_has_one_factor(own: Questions) -> None:
    def factors(**words: Any) -> list[float]:
        return [state["asked"] for state in _picture(own, trial=3, **words)["builds"][1]["states"]]

    assert factors() == [1.0, 10.0, 100.0]
    assert factors(factor=10) == [10.0]


def test_a_changed_scene_is_shown_anew(own: Questions) -> None:
    first = _picture(own)
    known = {"collection": first["collection"], "meshes": first["meshes"]}
    assert _picture(own, known=known)["first"] == first["meshes"] == 2
    path_of(own).write_text(TEXT.replace("scene: spur pair", "scene: another pair"), "utf-8")
    again = _picture(own, known=known)
    assert again["first"] == 0
    assert again["collection"] != first["collection"]


def test_as_many_scenes_as_are_allowed_stay_open(tmp_path: Path) -> None:
    questions = opened(tmp_path)
    for k in range(5):
        shutil.copy(tmp_path / SCENE, tmp_path / f"{k}.yaml")
        questions.session(f"{k}.yaml")
    assert [*questions.sessions] == ["2.yaml", "3.yaml", "4.yaml"]
    questions.close()
