"""The app's questions on its folder: forms of analyses, jobs that are deleted, runs, scenes that come and go."""

import inspect
import os
import re
import shutil
import time
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any, get_args

import pytest
import typer
from app_folders import BUILT, EVIL, HOSTILE, ORDER, left_attempt, until
from places import SPUR_PAIR

from tol3d import InputError, Overrides, RunError, run_scene
from tol3d.analyses import answers
from tol3d.analyses.variants import variable_of
from tol3d.apps.workbench import commands, made_runs
from tol3d.apps.workbench import jobs as jobs_module
from tol3d.apps.workbench.answer import keep_answer
from tol3d.apps.workbench.asked_analysis import OF_STUDY, ask
from tol3d.apps.workbench.attempt import JOBS, Attempt, Progress, Said
from tol3d.apps.workbench.folder_questions import FolderQuestions
from tol3d.apps.workbench.forms import ANALYSES
from tol3d.apps.workbench.jobs import Analysis
from tol3d.apps.workbench.place import FolderLock
from tol3d.apps.workbench.questions import Questions
from tol3d.apps.workbench.standing import Job
from tol3d.apps.workbench.words import WORDS, UnfitError, words_of
from tol3d.apps.workbench.workspace import Workspace, is_bundled
from tol3d.report import page_html

PAIR = {"scene": "spur_pair.yaml"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """One with the spur pair."""
    shutil.copy(SPUR_PAIR, tmp_path)
    return tmp_path


def asked(folder: Path, **trusted: bool) -> FolderQuestions:
    return FolderQuestions(Workspace.of(folder), FolderLock(folder), **trusted)


def left(folder: Path, number: int, state: Said = "done", kind: Any = "run", run: str = "") -> Attempt:
    """A job that has ended."""
    order = replace(ORDER, job=f"{number:04}", kind=kind, words={})
    return left_attempt(folder, order, Progress(state, run=run), number)


# forms --------------------------------------------------------------------------------------------


class _Controls(HTMLParser):
    """Controls of a form by argument, and of each the attributes and the texts of its choices."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.found: dict[str, list[dict[str, str]]] = {}
        self.texts: list[str] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        own = {key: value or "" for key, value in attrs} | {"tag": tag}
        if "data-argument" in own:
            self.found.setdefault(own["data-argument"], []).append(own)

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Questions]:
    folder = tmp_path_factory.mktemp("forms")
    shutil.copy(SPUR_PAIR, folder)
    with FolderLock(folder) as lock:
        questions = Questions(Workspace.of(folder), lock)
        yield questions
        questions.close()


@pytest.mark.parametrize("kind", get_args(Analysis))
def test_a_form_asks_for_every_argument_and_shows_the_default_of_its_command(kind: Analysis, pair: Questions) -> None:
    told = pair.forms({**PAIR, "kind": kind})
    assert set(told["kinds"]) == set(get_args(Analysis)) == set(ANALYSES)
    form = _Controls(told["form"])
    assert set(form.found) == set(WORDS[kind]) - {"factor"}, "a factor is a new value that begins with x"
    defaults = inspect.signature(getattr(answers, kind)).parameters
    for name, controls in form.found.items():
        if kind == "sweep" and name in OF_STUDY:
            assert WORDS[kind][name].default == "the study's"
            continue
        default, (first, *_) = defaults[name].default, controls
        if default is False:
            assert first["type"] == "checkbox"
        elif isinstance(default, str | int):
            assert WORDS[kind][name].default == str(default)
            assert str(default) in (form.texts if first["tag"] == "select" else [first["placeholder"]])
    if "measure" in form.found:
        assert {"normal backlash", "lost motion"} <= {own.strip() for own in form.texts}


def test_a_sweep_offers_the_numbers_of_the_scene(pair: Questions) -> None:
    form = pair.forms({**PAIR, "kind": "sweep"})["form"]
    offered = dict(re.findall('<option value="([^"]*)=">now ([^<]*)</option>', form))
    assert offered["parts.pinion.teeth"] == "28"
    assert offered["tolerances.centre distance.distribution.upper"] == "20 um"
    assert offered["moves.gear pair.centre_distance"] == "172.5 mm"
    assert not any(own.startswith(("study", "published", "scene")) for own in offered)
    scene = pair.session(PAIR["scene"]).scene
    for field, now in offered.items():
        (number,) = variable_of(f"{field}={now}").values
        assert scene.with_({field: number}).model_dump() == scene.model_dump(), field


REFUSED: list[tuple[str, dict[str, Any], str, str, str]] = [
    ("effects", {"base": "63", "seed": "2"}, "base", "", "expected a power of two pairs of builds"),
    ("effects", {"position": "as-input", "measure": "nothing"}, "measure", "", "expected a measure, got 'nothing'"),
    (
        "what_if",
        {"set": {"centre distance": "±9 um", "bearing clearance": "3 kg"}},
        "set",
        "bearing clearance",
        "expected",
    ),
    (
        "what_if",
        {"set": {"centre distance": "±9 um", "bearing clearance": "x9"}},
        "factor",
        "bearing clearance",
        "bearing",
    ),
    ("what_if", {"limits": {"lost motion": "3 um..9 um"}}, "limits", "lost motion", "expected an angle"),
    (
        "changes",
        {"measure": "lost motion", "builds": "50"},
        "measure",
        "",
        "expected a limit (lower_limit, upper_limit)",
    ),
    ("allocate", {"bounds": "2..3", "ppk": "1.2"}, "bounds", "", "expected bounds above 0 with 1 between them"),
    ("allocate", {"bound": {"centre distance": "all"}}, "bound", "centre distance", "expected bounds of factors"),
    ("allocate", {"ppk": "1000", "freeze": ["centre distance"]}, "ppk", "", "expected a number above 0 and below 10"),
    ("rare", {"measure": "lost motion"}, "measure", "", "expected a limit (lower_limit, upper_limit)"),
    ("methods", {"measure": "nothing", "trials": "100"}, "measure", "", "expected a measure, got 'nothing'"),
    ("sweep", {}, "", "", "expected a number to vary, FIELD=values"),
    (
        "sweep",
        {"vary": ["parts.pinion.teeth=17,19", "parts.wheel.teeth=100..110"]},
        "vary",
        "parts.wheel.teeth=100..110",
        "parts.wheel.teeth: expected a step",
    ),
    ("sweep", {"vary": ["parts.pinion.teeth=17,19"], "engine": "none"}, "engine", "", "expected one of exact"),
    (
        "sweep",
        {"vary": ["parts.pinon.teeth=17,19"]},
        "vary",
        "parts.pinon.teeth=17,19",
        "parts.pinon.teeth: expected a name",
    ),
]


@pytest.mark.parametrize(("kind", "fields", "argument", "of", "message"), REFUSED)
def test_what_a_command_refuses_is_told_at_the_field_before_there_is_a_job(
    kind: Analysis, fields: dict[str, Any], argument: str, of: str, message: str, pair: Questions, tmp_path: Path
) -> None:
    refused = pair.fit({**PAIR, "kind": kind, "fields": fields})["refused"]
    assert (refused["argument"], refused["of"]) == (argument, of)
    assert refused["message"].startswith(message)
    with pytest.raises(InputError) as error:
        ask(kind, SPUR_PAIR, words_of(kind, fields), answers.silent)
    assert str(error.value).endswith(refused["message"]), "the words of the command"


def test_what_begins_to_evaluate_is_not_refused_and_evaluates_nothing(pair: Questions) -> None:
    before = pair.session(PAIR["scene"]).response.evaluations
    for kind, fields in {
        "effects": {"base": "64"},
        "what_if": {"set": {"centre distance": "±9 um"}, "limits": {"normal backlash": "10 um.."}},
        "changes": {"measure": "normal backlash"},
        "allocate": {"bound": {"centre distance": "0.8..1.2"}},
        "rare": {},
        "methods": {"trials": "100"},
        "sweep": {"vary": ["parts.pinion.teeth=17..25:2"]},
    }.items():
        assert pair.fit({**PAIR, "kind": kind, "fields": fields}) == {}, kind
    assert pair.session(PAIR["scene"]).response.evaluations == before


def test_a_what_if_begins_with_what_is_moved(pair: Questions) -> None:
    now = {"centre distance": "x1.65", "limits: normal backlash": "10 um..40 um"}
    found = _Controls(pair.forms({**PAIR, "kind": "what_if", "now": now})["form"]).found
    limits = {own["data-of"]: own.get("value") for own in found["limits"]}
    assert limits == {"normal backlash": "10 um..40 um", "lost motion": None}
    fields = {own["data-of"]: own.get("value") for own in found["set"]}
    assert len(fields) == 7
    assert {line: value for line, value in fields.items() if value} == {"centre distance": "±33 µm"}


def test_fields_are_arguments_as_commands_take_them() -> None:
    assert words_of("effects", {"measure": "", "base": "2e3", "seed": " 7 ", "shapley": False}) == {
        "base": 2000,
        "seed": 7,
    }
    given = {"centre distance": "±33 um", "bearing clearance": "x1.5", "wheel eccentricity": ""}
    assert words_of("what_if", {"set": given, "quick": True}) == {
        "set": {"centre distance": "±33 um"},
        "factor": {"bearing clearance": 1.5},
        "quick": True,
    }
    assert words_of("allocate", {"ppk": "1.67", "freeze": [], "stays": {"a": "low"}, "bounds": ""}) == {
        "ppk": 1.67,
        "stays": {"a": "low"},
    }
    assert words_of("sweep", {"vary": ["a.b=1,2"], "trials": "1e3"}) == {"vary": ["a.b=1,2"], "trials": 1000}


@pytest.mark.parametrize(
    ("kind", "fields", "argument", "message"),
    [
        ("effects", {"base": "many"}, "base", "expected a whole number from 2 on, got 'many'"),
        ("effects", {"position": "here"}, "position", "expected averaged or as-input, got 'here'"),
        ("run", {"trials": "0"}, "trials", "expected a whole number from 1 on, got 0"),
        ("run", {"trials": True}, "trials", "expected a whole number from 1 on, got True"),
        ("rare", {"draws": "99"}, "draws", "expected a whole number from 100 on, got 99"),
        ("changes", {"accept": "1", "accept_ppk": "1"}, "accept_ppk", "leave out one of the two"),
        ("allocate", {"ppk": "-1"}, "ppk", "expected a number above 0, such as 1.33, got -1"),
        ("allocate", {"cost": "/etc/passwd"}, "cost", ""),
        (
            "what_if",
            {"set": {"play": ""}},
            "",
            "expected a new value of a tolerance or other limits of a measure, got none",
        ),
    ],
)
def test_an_unfit_field_is_named_with_a_sentence(
    kind: str, fields: dict[str, Any], argument: str, message: str, folder: Path
) -> None:
    with pytest.raises(UnfitError) as error:
        words_of(kind, fields)
    assert (error.value.argument, error.value.sentence) == (argument, message)
    questions = asked(folder)
    told = questions.analyse({**PAIR, "kind": kind, "fields": fields})
    assert told["refused"] == {"argument": argument, "message": message or str(error.value)}
    assert questions.jobs({}) == {"jobs": []}


# answers ------------------------------------------------------------------------------------------


def test_an_answer_is_shown_as_its_command_and_the_report_show_it(folder: Path) -> None:
    found = answers.what_if(SPUR_PAIR, set={"centre distance": "±10 um"}, quick=True)
    keep_answer(found, left(folder, 1, kind="what_if").place)
    questions = asked(folder)
    html = questions.answer({"id": "0001", "title": "spur pair at the drive end"})["html"]
    assert html.startswith(page_html(found.page))
    figures = re.findall("<figure>", html)
    assert len(figures) == sum(len(row) for row in found.charts().rows) > 0
    assert questions.numbers({"id": "0001"}).read_text("utf-8") == found.csv()
    with pytest.raises(InputError, match="expected a finished analysis"):
        questions.numbers({"id": left(folder, 2).place.name})
    (questions.numbers({"id": "0001"}).with_name("answer.json")).write_text("{}")
    with pytest.raises(RunError, match="it is damaged"):
        questions.answer({"id": "0001"})


def test_names_of_a_stranger_are_text_in_forms_jobs_and_answers(tmp_path: Path) -> None:
    name = f"{EVIL} \u202e{'x' * 100}.yaml"
    (tmp_path / name).write_text(HOSTILE, "utf-8")
    questions = asked(tmp_path)
    scenes = Questions(questions.workspace, questions.lock)
    pieces = [scenes.forms({"scene": name, "kind": kind})["form"] for kind in ANALYSES]
    found = answers.what_if(tmp_path / name, set={f"{EVIL} tolerance": "±10 um"}, quick=True)
    keep_answer(found, left(tmp_path, 1, kind="what_if").place)
    pieces.append(questions.answer({"id": "0001", "title": EVIL})["html"])
    for piece in pieces:
        assert EVIL not in piece
        assert "&lt;img src=x onerror=alert(1)&gt;" in piece
        assert "\u202e" not in piece
    assert questions.folder({})["scenes"] == [name]
    assert questions.runs({"scene": name}) == {"runs": []}
    scenes.close()


# jobs that have ended -----------------------------------------------------------------------------


def test_a_deleted_job_leaves_its_run_and_files_of_others(folder: Path) -> None:
    run_scene(SPUR_PAIR, overrides=Overrides(trials=5), out=folder / "runs" / "spur_pair")
    for number in (1, 2, 3):
        left(folder, number, run="spur_pair")
    again = left(folder, 4)
    again.write(replace(ORDER, job="0001", kind="run", words={}))  # resumed: two attempts of one job
    (Attempt(folder, 1).place / "order.json.writing").touch()
    mine = Attempt(folder, 3).place / "notes.txt"
    mine.touch()
    questions = asked(folder)
    assert [own["id"] for own in questions.jobs({})["jobs"]] == ["0003", "0002", "0001"]
    questions.delete({"id": "0001"})
    questions.delete({"id": "0003"})
    assert [own["id"] for own in questions.jobs({})["jobs"]] == ["0002"]
    places = sorted(own.relative_to(folder / JOBS).as_posix() for own in (folder / JOBS).rglob("*"))
    assert places == ["0002", "0002/order.json", "0002/progress.json", "0003", "0003/notes.txt"]
    assert [own["name"] for own in questions.runs(PAIR)["runs"]] == ["spur_pair"]
    with pytest.raises(InputError, match=r"expected its own finished run, got '\.\./spur_pair'"):
        questions.delete({"id": "0002", "run": "../spur_pair"})
    (folder / "runs" / "spur_pair" / "notes.txt").touch()
    with pytest.raises(InputError, match=r"files that are not of the run \(notes.txt\)"):
        questions.delete({"id": "0002", "run": "spur_pair"})
    (folder / "runs" / "spur_pair" / "notes.txt").unlink()
    questions.delete({"id": "0002", "run": "spur_pair"})
    assert [*(folder / "runs").iterdir()] == []
    assert questions.jobs({}) == {"jobs": []}


def test_a_job_that_goes_on_is_not_deleted(folder: Path) -> None:
    attempt = left(folder, 1, "running")
    questions = asked(folder)
    with attempt.lock:
        with pytest.raises(InputError, match="job 0001: expected one that has ended, this one is running"):
            questions.delete({"id": "0001"})
        attempt.cancel()
        with pytest.raises(InputError, match="its process is still ending"):
            questions.delete({"id": "0001"})
    questions.delete({"id": "0001"})
    with FolderLock(folder), pytest.raises(InputError, match="there is none"):
        questions.delete({"id": "0001"})


def test_a_job_s_folder_that_is_a_link_loses_the_link_alone(folder: Path) -> None:
    kept = left(folder, 1)
    own = folder / "own"
    kept.place.rename(own)
    kept.place.symlink_to(own)
    asked(folder).delete({"id": "0001"})
    assert not kept.place.is_symlink()
    assert sorted(path.name for path in own.iterdir()) == ["order.json", "progress.json"]


def test_the_oldest_jobs_are_dropped_as_an_app_starts(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jobs_module, "MOST_ENDED", 2)
    states: tuple[Said, ...] = ("done", "running", "cancelled", "failed", "done")
    attempts = [left(folder, number, state) for number, state in enumerate(states, 1)]
    with attempts[1].lock:
        with FolderLock(folder):
            assert len(asked(folder).queue.list()) == 5, "another app that only reads drops none"
        questions = asked(folder)
        assert [own.id for own in questions.queue.list()] == ["0002", "0004", "0005"]


# runs ---------------------------------------------------------------------------------------------


def test_runs_of_a_scene_are_listed_the_newest_first(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    shutil.copy(SPUR_PAIR, folder / "spur_pair-2.yaml")
    for name in ("spur_pair", "spur_pair-3", "spur_pair-2", "other"):
        run_scene(folder / "spur_pair.yaml", overrides=Overrides(trials=5), out=folder / "runs" / name)
    outside = tmp_path_factory.mktemp("outside")
    shutil.copytree(folder / "runs" / "other", outside / "run")
    (folder / "runs" / "spur_pair-4").symlink_to(outside / "run")
    (folder / "runs" / "spur_pair-5").mkdir()
    (folder / "runs" / "spur_pair-5" / "summary.json").write_text("{}")
    os.utime(folder / "runs" / "spur_pair" / "summary.json", (0.0, 0.0))
    questions = asked(folder)
    first, second = questions.runs(PAIR)["runs"]
    assert (first["name"], first["trials"], first["is_of_now"]) == ("spur_pair-3", 5, True)
    assert (second["name"], second["made"][:4]) == ("spur_pair", time.strftime("%Y", time.localtime(0.0)))
    text = SPUR_PAIR.read_text("utf-8").replace("trials: 2000", "trials: 20")
    (folder / "spur_pair.yaml").write_text(text, "utf-8")
    assert [own["is_of_now"] for own in questions.runs(PAIR)["runs"]] == [False, False]
    for name in ("../spur_pair", "spur_pair-4", "none"):
        with pytest.raises(InputError):
            made_runs.delete_run(name, folder)
    assert (outside / "run" / "summary.json").exists()
    report = folder / "runs" / "spur_pair" / "report.html"
    report.touch()
    assert questions.report({**PAIR, "run": "spur_pair"}) == report


# scenes that come and go --------------------------------------------------------------------------


def test_a_new_scene_and_one_that_is_gone_are_seen(folder: Path) -> None:
    questions = asked(folder)
    listed = questions.folder({})["listed"]
    first = questions.changed(PAIR)
    assert first["listed"] == listed
    shutil.copy(SPUR_PAIR, folder / "new.yaml")
    assert questions.folder({})["scenes"] == ["new.yaml", "spur_pair.yaml"]
    assert questions.changed(PAIR) == {"digest": first["digest"], "listed": questions.folder({})["listed"]}
    assert questions.changed(PAIR)["listed"] != listed
    (folder / "spur_pair.yaml").unlink()
    assert questions.changed(PAIR)["digest"] == ""


def test_no_repository_takes_in_what_the_app_keeps(folder: Path) -> None:
    ignore = folder / ".tol3d" / ".gitignore"
    with FolderLock(folder):
        assert ignore.read_text() == "*\n"
    ignore.write_text("mine\n")
    with FolderLock(folder):
        assert ignore.read_text() == "mine\n"
    ignore.unlink()
    ignore.symlink_to(folder / "elsewhere")
    with FolderLock(folder):
        assert not (folder / "elsewhere").exists()


def test_a_bundled_scene_is_copied_here_and_not_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert is_bundled("spur_pair")
    assert not is_bundled("spur_pai")
    path = commands._copied("spur_pair")
    assert path.read_bytes() == SPUR_PAIR.read_bytes()
    assert Workspace.of(path).first == "spur_pair.yaml"
    path.write_text("mine")
    assert commands._copied("spur_pair").read_text() == "mine"
    assert capsys.readouterr().out.splitlines() == [
        "spur_pair.yaml: copied here",
        "spur_pair.yaml: is here already, and is opened as it is",
    ]
    (tmp_path / "spur_pair").mkdir()
    assert not is_bundled("spur_pair"), "a folder of that name is opened"


@pytest.mark.parametrize(
    ("place", "message"),
    [
        (".", "expected a scene or a folder with scenes, got one without .yaml files; `tol3d app spur_pair` begins"),
        ("spur_pai", 'found nothing of that name; did you mean "spur_pair"?'),
        ("spur_pai.yaml", "found nothing of that name"),
    ],
)
def test_where_no_scene_is_a_beginning_is_told(
    place: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError) as error:
        Workspace.of(Path(place))
    assert message in str(error.value)
    assert str(error.value).endswith(message) == (place != ".")


# programs of a scene ------------------------------------------------------------------------------


def test_no_question_runs_a_program_that_a_scene_names(tmp_path: Path) -> None:
    (tmp_path / "built.yaml").write_text(BUILT, "utf-8")
    (tmp_path / "ours.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')\n", "utf-8")
    built = {"scene": "built.yaml", "now": {}, "measure": "", "kind": "effects", "fields": {"run_builders": True}}
    questions = asked(tmp_path)
    scenes = Questions(questions.workspace, questions.lock)
    assert "--run-builders" in scenes.scene(built)["problems"][0]["message"]
    for question in (scenes.card, scenes.estimate, scenes.sliders, scenes.view, scenes.forms, scenes.keep):
        with pytest.raises(InputError, match="--run-builders"):
            question(built)
    assert questions.analyse(built)["refused"]["argument"] == "run_builders"
    assert questions.start(built)["refused"]["argument"] == "run_builders"
    job = questions.start({"scene": "built.yaml"})
    until(lambda: not questions.queue.job(job["id"]).goes_on)
    (ended,) = questions.queue.list()
    assert ended.state == "failed"
    assert "expected permission to run ours.py, which is a program, got none" in ended.message
    assert not (tmp_path / "ran").exists()
    scenes.close()


# the end of an app --------------------------------------------------------------------------------

RUNNING = Job("0002", "pair.yaml", "run", {}, "running", 1200, 20000, "", "", None, "")
WAITING = replace(RUNNING, id="0001", kind="what_if", state="waiting", done=0, of=0)


class _Queue:
    """Jobs of a folder that notes which of them are cancelled."""

    def __init__(self, *working: Job) -> None:
        self.working, self.cancelled = working, list[str]()

    def cancel(self, id: str) -> None:
        self.cancelled.append(id)


@pytest.mark.parametrize(
    ("terminal", "said", "cancelled"),
    [(True, True, []), (True, False, ["0001", "0002"]), (True, typer.Abort(), []), (False, False, [])],
)
def test_an_app_that_ends_asks_at_a_terminal_alone_whether_jobs_go_on(
    terminal: bool,
    said: bool | BaseException,
    cancelled: list[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    questions: list[str] = []

    def confirm(text: str, *, default: bool) -> bool:
        questions.append(text)
        assert default
        if isinstance(said, BaseException):
            raise said
        return said

    monkeypatch.setattr(typer, "confirm", confirm)
    for stream in ("stdin", "stdout"):
        monkeypatch.setattr(f"sys.{stream}.isatty", lambda: terminal)
    queue: Any = _Queue(WAITING, RUNNING)
    commands._leave(queue)
    words = "run of pair.yaml goes on (1200 of 20000), and 1 more waits"
    assert questions == ([f"{words}: leave it running?"] if terminal else [])
    assert queue.cancelled == cancelled
    told = capsys.readouterr().out
    assert (words in told) == (not terminal)
    assert told.startswith("cancelled; what is finished is kept") == bool(cancelled)
    assert told.startswith("it goes on;") == (terminal and not cancelled)
    commands._leave(_Queue())  # type: ignore[arg-type]
    assert capsys.readouterr().out == ""
