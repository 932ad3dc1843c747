"""The command line as a user meets it: exit codes, messages, what it prints and writes."""

import errno
import importlib.metadata
import json
import os
import re
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import pytest
from fixtures import Command
from places import SCENES
from ruamel.yaml import YAML
from schemas import validate

from tol3d import Overrides, Scene, load_scene, run_scene
from tol3d.cad.solids.cache import CacheWarning
from tol3d.cli import studies
from tol3d.errors import InputError
from tol3d.gearing.model import model_from_scene
from tol3d.gearing.system import strips_of
from tol3d.report import picture
from tol3d.simulate import load, simulation_of
from tol3d.study.results.task import workers_for
from tol3d.study.runs.run import open_run

SPUR = str(SCENES / "spur_pair.yaml")
TABLES = ("summary.json", "contributors.csv", "correlations.csv")
PLAIN = ("--no-picture",)  # where no picture is asked about: drawing one takes two seconds of a processor


def test_run_prints_the_table_and_writes_the_run(tol3d: Command, tmp_path: Path) -> None:
    code, out, _ = tol3d("run", SPUR, "--trials", "100", "-v", "--out", str(tmp_path / "spur"))
    assert code == 0
    # 53.397: the closed form by the paper's tables; 53.398: the mean build with the squares that it leaves out
    for words in ("normal backlash", "3D simulation", "paper, 3DCS", "centre distance", "53.397", "53.398"):
        assert words in out
    assert "witness: FCL measured 20 of these trials again: within ±0.0" in out
    written = {path.name for path in (tmp_path / "spur").iterdir()}
    assert written == {"SHA256SUMS", "trials", "scene.yaml", "histogram.png", *TABLES}


def test_overrides_are_recorded(tol3d: Command, tmp_path: Path) -> None:
    arguments = ("--trials", "50", "--seed", "9", "--engine", "analytic", *PLAIN, "--out", str(tmp_path / "run"))
    assert tol3d("run", SPUR, *arguments)[0] == 0
    study = json.loads((tmp_path / "run" / "summary.json").read_text("utf-8"))["study"]
    assert (study["trials"], study["seed"], study["engine"]) == (50, 9, "analytic")


def test_sampler_and_witness_are_recorded(tol3d: Command, tmp_path: Path) -> None:
    arguments = ("--trials", "64", "--sampler", "sobol", "--witness", "3", *PLAIN)
    assert tol3d("run", SPUR, *arguments, "--out", str(tmp_path / "run"))[0] == 0
    study = json.loads((tmp_path / "run" / "summary.json").read_text("utf-8"))["study"]
    assert (study["sampler"], study["witness"]) == ("sobol", 3)


def test_a_scenes_witness_is_not_asked_of_another_engine(tol3d: Command, tmp_path: Path) -> None:
    arguments = ("run", SPUR, "--trials", "4", *PLAIN, "--out", str(tmp_path / "run"), "--force", "--engine")
    for engine in ("analytic", "fcl"):
        assert tol3d(*arguments, engine)[0] == 0
        assert json.loads((tmp_path / "run" / "summary.json").read_text("utf-8"))["study"]["witness"] == 0


NO_MEMORY = (
    MemoryError("Unable to allocate 9 TiB"),
    OSError(errno.ENOMEM, "Cannot allocate memory"),
    ImportError("numpy.so: failed to map segment from shared object"),
)


@pytest.mark.parametrize("hidden", [False, True])
@pytest.mark.parametrize("error", NO_MEMORY, ids=lambda error: type(error).__name__)
def test_too_little_memory_is_a_line_and_no_fault(
    error: Exception, hidden: bool, tol3d: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*arguments: Any, **others: Any) -> Any:
        try:
            raise error
        except type(error):
            if hidden:  # as llvmlite does
                raise OSError("Could not find/load shared object file 'libllvmlite.so'")  # noqa: B904
            raise

    monkeypatch.setattr("tol3d.simulate.load", refused)
    code, _, err = tol3d("run", SPUR, *PLAIN)
    assert code == 2
    assert err.startswith(f"out of memory ({error}): the input is not at fault; allow more")
    assert err.count("\n") == 1


def test_a_reader_that_goes_away_ends_a_command_without_a_word() -> None:
    command = [sys.executable, "-P", "-m", "tol3d.cli"]
    for words in (["--help"], ["--version"], ["check", "no such scene"]):
        receiver, sender = os.pipe()
        os.close(receiver)
        closed_out, closed_err = (sender, subprocess.PIPE) if words[0] != "check" else (subprocess.PIPE, sender)
        done = subprocess.run(command + words, stdout=closed_out, stderr=closed_err, timeout=60, check=False)
        os.close(sender)
        assert (words, done.returncode, done.stdout or b"", done.stderr or b"") == (words, 141, b"", b"")


def test_a_run_is_not_put_in_the_place_of_the_root_folder(tol3d: Command) -> None:
    root = Path.cwd().anchor
    for more in ((), ("--resume",), ("--force",)):
        code, _, err = tol3d("run", SPUR, *PLAIN, "--trials", "4", "--out", root, *more)
        told = f"{root}: no run takes the place of the root of all folders; name a folder in it"
        assert (code, err.strip()) == (2, told)


WRONG_OPTIONS = {
    "no number of trials": (("--trials", "many"), "a whole number from 1 on, or auto, got 'many'"),
    "no trials": (("--trials", "0"), "a whole number from 1 on, or auto, got '0'"),
    "auto without an end": (("--trials", "auto"), "the standard errors to stop at"),
    "too many trials": (
        ("--trials", "10000000001"),
        "--trials (in Python Overrides.trials): expected a number of at most 1e+10, got 10000000001",
    ),
    "no such engine": (
        ("--engine", "foo"),
        "--engine (in Python Overrides.engine): expected one of exact, fcl, analytic, got 'foo'; these are the",
    ),
    "an engine misspelt": (("--engine", "exat"), "analytic, got 'exat'; did you mean \"exact\"?"),
    "a witness of no simulation": (("--engine", "analytic", "--witness", "3"), "no 3D simulation to check"),
    "a witness of the witness": (("--engine", "fcl", "--witness", "3"), "an exact study may have one"),
    "workers here and there": (("--scheduler", "tcp://here:1", "--workers", "2"), "leave out --workers"),
    "nothing to resume": (("--resume",), "nothing to resume, neither a run nor run.partial is there"),
}


@pytest.mark.parametrize("what", WRONG_OPTIONS)
def test_a_wrong_option_gets_one_message_and_exit_code_2(tol3d: Command, tmp_path: Path, what: str) -> None:
    options, words = WRONG_OPTIONS[what]
    code, out, err = tol3d("run", SPUR, *options, "--out", str(tmp_path / "run"))
    assert (code, out) == (2, "")
    assert words in " ".join(err.replace("│", " ").split())
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("engine", "trials", "said"),
    [
        ("fcl", 180_000, ""),
        ("fcl", 360_000, "one position a trial: about 2 min of one core"),
        ("exact", 360_000, ""),
        ("exact", 80_000_000, "one position a trial: about 2 min of one core"),
    ],
)
def test_a_long_study_is_announced_by_its_engines_speed(engine: str, trials: int, said: str) -> None:
    assert studies.long_study(simulation_of(load(SPUR), Overrides(trials=trials, engine=engine))) == said


@pytest.mark.parametrize(
    ("engine", "trials", "workers"),
    [("exact", 65_536, 1), ("exact", 65_537, 2), ("analytic", 3 * 65_536, 3), ("exact", 10**9, 8), ("fcl", 20_000, 1)],
)
def test_threads_are_as_many_as_blocks_and_processes_are_not_started_for_seconds(
    engine: str, trials: int, workers: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: 8)
    assert workers_for(simulation_of(load(SPUR), Overrides(trials=trials, engine=engine))) == workers


def test_no_trials_keeps_the_statistics_only(tol3d: Command, tmp_path: Path) -> None:
    study = ("--trials", "200", "--engine", "analytic", "--no-trials", *PLAIN)
    assert tol3d("run", SPUR, *study, "--out", str(tmp_path / "bare"))[0] == 0
    assert {path.name for path in (tmp_path / "bare").iterdir()} == {"SHA256SUMS", "scene.yaml", *TABLES}
    code, _, err = tol3d("export", str(tmp_path / "bare"), "--worst", "--out", str(tmp_path))
    assert code == 2
    assert "this run kept its statistics only" in err


def test_resume_of_a_finished_run_mends_it(tol3d: Command, tmp_path: Path) -> None:
    arguments = ("--trials", "200", "--engine", "analytic", *PLAIN, "--out", str(tmp_path / "run"))
    assert tol3d("run", SPUR, *arguments)[0] == 0
    block = tmp_path / "run" / "trials" / "block-000000.parquet"
    whole = block.read_bytes()
    block.write_bytes(whole[:-1])
    code, _, err = tol3d("run", SPUR, *arguments, "--resume")
    assert code == 0
    assert "warning: " in err
    assert "it is made again" in err
    assert block.read_bytes() == whole


def test_an_interrupted_command_ends_nobody_who_called_it(
    tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended: list[int] = []
    monkeypatch.setattr(os, "_exit", ended.append)
    monkeypatch.setattr(studies, "PATIENCE", 0.2)
    monkeypatch.setattr("tol3d.simulate.run_blocks", lambda *_, **__: signal.raise_signal(signal.SIGINT))
    out = tmp_path / "run"
    code, _, err = tol3d("run", SPUR, "--trials", "30", "--engine", "analytic", "--out", str(out))
    assert code == 130
    assert err.endswith(f"tol3d run {SPUR} --trials 30 --engine analytic --out {out} --resume\n")
    time.sleep(0.5)
    assert ended == []


def test_fail_on_limits_exits_with_1_only_when_a_limit_fails(tol3d: Command, tmp_path: Path) -> None:
    common = ("--trials", "200", "--engine", "analytic", *PLAIN, "--fail-on-limits")
    assert tol3d("run", SPUR, *common, "--out", str(tmp_path / "good"))[0] == 0
    tight = tmp_path / "tight.yaml"
    tight.write_text(Path(SPUR).read_text("utf-8").replace("lower_limit: 15 um", "lower_limit: 50 um"), "utf-8")
    code, _, err = tol3d("run", str(tight), *common, "--out", str(tmp_path / "bad"))
    assert code == 1
    assert "limits failed" in err
    assert (tmp_path / "bad" / "summary.json").exists()


def test_check_shows_coefficients_limits_and_sigma(tol3d: Command) -> None:
    code, out, _ = tol3d("check", SPUR)
    assert code == 0
    for words in ("pinion", "wheel", "172.5", "1.750", "0.684", "0.940", "15"):
        assert words in out


def test_schema_prints_what_the_example_scenes_are_held_against(tol3d: Command) -> None:
    """By tests/scene/test_scene.py; here the one with every field is, as printed."""
    code, out, _ = tol3d("schema")
    assert code == 0
    schema = json.loads(out)
    assert schema == Scene.model_json_schema()
    validate(YAML(typ="safe", pure=True).load((SCENES / "every_field.yaml").read_text("utf-8")), schema)


@pytest.mark.slow
def test_compare_lays_runs_over_each_other(tol3d: Command, tmp_path: Path) -> None:
    runs = []
    for seed in ("1", "2"):
        runs.append(str(tmp_path / f"run{seed}"))
        assert tol3d("run", SPUR, "--trials", "60", "--seed", seed, *PLAIN, "--out", runs[-1])[0] == 0
    code, out, _ = tol3d("compare", *runs, "--out", str(tmp_path / "both.png"))
    assert code == 0
    assert "normal backlash" in out
    assert (tmp_path / "both.png").read_bytes()[:4] == b"\x89PNG"


BAD_SCENES = {
    "unknown key": ("teeth: 28,", "teth: 28,", "teeth"),
    "missing unit": ("module: 2.5 mm", "module: 2.5", "without its unit"),
    "wrong unit": ("lower: -20 um", "lower: -20 furlong", "furlong"),
    "limits reversed": ("lower: -20 um, upper: 20 um", "lower: 20 um, upper: -20 um", "lower"),
    "zero teeth": ("teeth: 28", "teeth: 0", "teeth"),
    "undercut teeth": ("teeth: 28", "teeth: 8", "undercut"),
    "pointed teeth": ("teeth: 28,", "teeth: 28, profile_shift: 1.6,", "pointed"),
    "interfering centre distance": ("centre_distance: 172.5 mm", "centre_distance: 171.5 mm", "interfere"),
    "interfering mean build": ("centre_distance: 172.5 mm", "centre_distance: 172.4 mm", "mean build"),
    "missing part": ("driver: pinion", "driver: pinon", "pinion"),
}


@pytest.mark.parametrize("what", BAD_SCENES)
def test_a_wrong_scene_gets_one_message_and_exit_code_2(tol3d: Command, tmp_path: Path, what: str) -> None:
    old, new, words = BAD_SCENES[what]
    text = Path(SPUR).read_text("utf-8")
    assert old in text
    if what == "undercut teeth":  # on the centre distance of 8 and 110 teeth, so that nothing else is wrong
        text = text.replace("172.5 mm", "147.5 mm").replace("bore: 25 mm", "bore: 5 mm")
    scene = tmp_path / "bad.yaml"
    scene.write_text(text.replace(old, new, 1), "utf-8")
    code, out, err = tol3d("run", str(scene), "--out", str(tmp_path / "run"))
    assert code == 2, err
    assert out == ""
    assert words in err
    assert "bad.yaml:" in err
    assert "Traceback" not in err
    assert len(err.splitlines()) <= 6
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.yaml"]


def test_a_name_that_is_no_scene_is_refused(tol3d: Command, tmp_path: Path) -> None:
    code, _, err = tol3d("run", str(tmp_path / "nowhere.yaml"))
    assert code == 2
    assert "nowhere.yaml" in err


def test_a_name_near_a_bundled_scene_is_guessed(tol3d: Command) -> None:
    code, _, err = tol3d("run", "spur_pairs")
    assert code == 2
    assert err == 'spur_pairs: no such file, and no scene of that name; did you mean "spur_pair"?\n'
    _, _, err = tol3d("run", "xyz")
    assert "no such file, and no scene of that name (bundled scenes: bevel_pair, " in err


@pytest.mark.parametrize(
    ("option", "said", "expected"),
    [
        ("--witness", "x", "expected a whole number from 0 on, got 'x'"),
        ("--seed", "1.5", "expected a whole number from 0 on, got '1.5'"),
        ("--trials", "1e-1", "expected a whole number from 1 on, or auto, got '1e-1'"),
        ("--workers", "0", "expected a whole number from 1 on, got '0'"),
    ],
)
def test_numbers_of_options_are_asked_for_in_words_of_ours(
    tol3d: Command, option: str, said: str, expected: str
) -> None:
    code, _, err = tol3d("run", "spur_pair", option, said)
    assert code == 2
    assert expected in re.sub(r"[\s│]+", " ", err)


def test_a_scene_that_tol3d_brings_along_is_found_beside_a_folder_of_its_name(
    tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "spur_pair").mkdir()
    code, out, _ = tol3d("check", "spur_pair")
    assert code == 0
    assert "172.5" in out


def test_version_is_that_of_the_package(tol3d: Command) -> None:
    code, out, _ = tol3d("--version")
    assert (code, out) == (0, f"tol3d {importlib.metadata.version('tol3d')}\n")


FAILING_PAINTERS = {
    "no such colour": "sys.stdin.buffer.read(); print('a note', file=sys.stderr); sys.exit('no such colour')",
    "its process ended with 7": "sys.stdin.buffer.read(); sys.exit(7)",
    "its process ended with -9": "import os; os.kill(os.getpid(), 9)",
}


@pytest.mark.slow
@pytest.mark.parametrize("reason", FAILING_PAINTERS)
def test_a_picture_that_fails_costs_a_warning_and_not_the_run(
    tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, reason: str
) -> None:
    monkeypatch.setattr(picture, "COMMAND", (sys.executable, "-c", f"import sys; {FAILING_PAINTERS[reason]}"))
    code, out, err = tol3d("run", SPUR, "--trials", "30", "--engine", "analytic", "--out", str(tmp_path / "run"))
    assert code == 0
    assert f"warning: histogram.png could not be drawn ({reason}); the run is whole without it\n" in err
    assert "histogram.png" not in out
    assert {path.name for path in (tmp_path / "run").iterdir()} == {*("SHA256SUMS", "trials", "scene.yaml", *TABLES)}
    assert tol3d("compare", str(tmp_path / "run"), "--out", str(tmp_path / "c.png"))[0] == 0


def test_a_process_that_cannot_be_started_costs_a_warning_too(
    tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(picture, "COMMAND", (str(tmp_path / "no python"),))
    code, _, err = tol3d("run", SPUR, "--trials", "30", "--engine", "analytic", "--out", str(tmp_path / "run"))
    assert code == 0
    assert "could not be drawn ([Errno 2] No such file or directory" in err


def test_a_half_drawn_picture_is_taken_away(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    half = "import pickle, sys; pickle.load(sys.stdin.buffer); path, *_ = pickle.load(sys.stdin.buffer); "
    half += "path.write_bytes(b'half'); sys.exit('disk')"
    monkeypatch.setattr(picture, "COMMAND", (sys.executable, "-c", half))
    with picture.drawing() as draw, pytest.raises(picture.PictureError, match=r"^disk$"):
        draw({}, tmp_path / "histogram.png")
    assert list(tmp_path.iterdir()) == []


def test_no_picture_starts_no_process(tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subprocess, "Popen", lambda *_, **__: 1 / 0)
    arguments = ("--trials", "30", "--engine", "analytic", "--no-picture", "--out", str(tmp_path / "run"))
    code, out, err = tol3d("run", SPUR, *arguments)
    assert (code, "picture:" in out, "warning" in err) == (0, False, False)
    assert {path.name for path in (tmp_path / "run").iterdir()} == {*("SHA256SUMS", "trials", "scene.yaml", *TABLES)}


def test_a_run_from_python_starts_no_process_and_draws_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subprocess, "Popen", lambda *_, **__: 1 / 0)
    assert not (run_scene(SPUR, overrides=Overrides(trials=30), out=tmp_path / "run").path / "histogram.png").exists()


def test_a_refused_scene_leaves_no_process_behind(tol3d: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[subprocess.Popen[bytes]] = []
    really = subprocess.Popen

    def noted(*arguments: Any, **options: Any) -> subprocess.Popen[bytes]:
        started.append(really(*arguments, **options))
        return started[-1]

    monkeypatch.setattr(subprocess, "Popen", noted)
    assert tol3d("run", "spur_pairs")[0] == 2
    assert [process.returncode is not None for process in started] == [True]


def test_a_warning_of_ours_is_one_line_without_its_place_in_the_code(
    tol3d: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    def warns(*_: object, **__: object) -> None:
        warnings.warn("the folder cannot be written", CacheWarning, stacklevel=1)
        raise InputError("and that was all")

    monkeypatch.setattr("tol3d.simulate.simulation_of", warns)
    assert tol3d("check", SPUR)[2] == "warning: the folder cannot be written\nand that was all\n"


def test_ctrl_c_means_after_a_run_what_it_meant_before(tol3d: Command, tmp_path: Path) -> None:
    before = signal.getsignal(signal.SIGINT)
    assert tol3d("run", SPUR, "--trials", "30", "--engine", "analytic", *PLAIN, "--out", str(tmp_path / "run"))[0] == 0
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.slow
def test_an_export_tells_which_trial_it_took_and_why(tol3d: Command, tmp_path: Path) -> None:
    run = str(tmp_path / "run")
    assert tol3d("run", SPUR, "--trials", "40", *PLAIN, "--out", run)[0] == 0
    values = open_run(Path(run)).columns("geometric:normal backlash")["geometric:normal backlash"]
    words = f"trial {values.argmin()}, the worst: the nearest to a limit of normal backlash"
    for said, expected in (((), f"no build named: {words}"), (("--worst",), words)):
        folder = str(tmp_path / ("a long folder's name " * 8).strip())
        code, out, err = tol3d("export", run, *said, "--format", "stl", "--out", folder)
        assert code == 0
        assert err.startswith(expected)
        assert [Path(line).is_file() for line in out.splitlines()] == [True, True]  # whole paths, a line each
    assert tol3d("export", run, "--nominal", "--format", "stl", "--out", str(tmp_path))[2] == ""


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_no_write_permission_is_refused_before_anything_runs(tol3d: Command, tmp_path: Path) -> None:
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o500)
    code, _, err = tol3d("run", SPUR, "--out", str(locked / "run"))
    assert code == 2
    assert "cannot be written" in err


def test_a_fault_of_ours_exits_with_3_and_asks_for_a_report(tol3d: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tol3d.simulate.simulation_of", lambda *_: 1 / 0)
    code, _, err = tol3d("check", SPUR)
    assert code == 3
    assert "a fault in tol3d" in err


def test_export_and_view_refuse_two_choices(tol3d: Command, tmp_path: Path) -> None:
    assert tol3d("run", SPUR, "--trials", "5", "--engine", "analytic", *PLAIN, "--out", str(tmp_path / "run"))[0] == 0
    code, _, err = tol3d("export", str(tmp_path / "run"), "--trial", "1", "--worst")
    assert code == 2
    assert "one of" in err


def test_view_refuses_a_mesh_that_is_not_there(tol3d: Command, tmp_path: Path) -> None:
    assert tol3d("run", SPUR, "--trials", "5", "--engine", "analytic", *PLAIN, "--out", str(tmp_path / "run"))[0] == 0
    arguments = ("--nominal", "--mesh", "gear pear", "--screenshot", str(tmp_path / "view.png"))
    code, out, err = tol3d("view", str(tmp_path / "run"), *arguments)
    assert (code, out) == (2, "")
    assert err == "--mesh: no mesh 'gear pear' is shown of this run; did you mean \"gear pair\"?\n"


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--animate", "a.gif", "--screenshot", "a.png"), "expected one of --screenshot and --animate, got both\n"),
        (
            ("--animate", "a.gif", "--mesh", "m"),
            "--mesh: of moving pictures leave it out; --motion chooses what moves\n",
        ),
        (("--frames", "5"), "--frames: expected with --animate FILE, which writes moving pictures\n"),
        (("--motion", "turn"), "--motion: expected with --animate FILE, which writes moving pictures\n"),
    ],
)
def test_view_refuses_options_of_which_one_would_be_left_out(
    tol3d: Command, options: tuple[str, ...], expected: str
) -> None:
    assert tol3d("view", "no run", "--nominal", *options) == (2, "", expected)


@pytest.mark.slow
def test_run_names_every_picture_that_it_drew(tol3d: Command, tmp_path: Path) -> None:
    arguments = ("--trials", "5", "--engine", "analytic", "--pictures", "all", "--out")
    for scene, pictures in (("spur_pair", PAIRS_PICTURES), ("three_stage_train", TRAINS_PICTURES)):
        folder = tmp_path / scene
        code, out, _ = tol3d("run", str(SCENES / f"{scene}.yaml"), *arguments, str(folder))
        assert code == 0
        assert out.splitlines()[-1] == f"run: {folder}    {pictures}"


PAIRS_PICTURES = "pictures in it: histogram.png, contributors.png"
TRAINS_PICTURES = "pictures in it: histogram.png, contributors.png, chain.png, histogram-*.png"


HANGS = 120  # s; a guard against waiting for ever, no claim
MODULES_OF_HELP = 450  # 365 of them with today's typer and rich; NumPy alone would bring 140 more
OWN_OF_HELP = ("tol3d.cli", "tol3d.errors", "tol3d.current_folder", "tol3d.import_path", "tol3d.apps")


def test_help_loads_the_command_line_and_what_prints_it() -> None:
    """The half second that it takes is its imports: counted, for a clock tells of the machine."""
    code = "import sys; sys.argv = ['tol3d', '--help']\nfrom tol3d import cli\n"
    code += "try:\n    cli.main()\nexcept SystemExit:\n    print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=HANGS)
    loaded = done.stdout.splitlines()[-1].split()
    own = [name for name in loaded if name.startswith("tol3d.")]
    assert [name for name in own if not name.startswith(OWN_OF_HELP)] == []
    assert len(loaded) < MODULES_OF_HELP


NEVER = ("pint", "matplotlib", "scipy.stats", "cadquery", "OCP", "pyvista", "trimesh", "distributed", "pandas")
FEW = ("--trials", "5", "--witness", "0", "--out", "run")
COMPILING = ("numba.np.linalg", "numba.typed.typedlist")  # by which numba compiles what is not kept
LOADED = {
    "a run without a picture": (
        ("run", SPUR, *FEW, "--no-picture"),
        ("numba",),
        (*NEVER, *COMPILING, "fcl", "numpy.f2py.f2py2e", "unittest"),
    ),
    "a run": (("run", SPUR, "--trials", "5", "--witness", "0", "--out", "run"), ("numba",), (*NEVER, "fcl")),
    "a run with a witness": (("run", SPUR, "--trials", "5", "--witness", "2", "--out", "run"), ("numba", "fcl"), NEVER),
    "a run by FCL": (("run", SPUR, "--trials", "5", "--engine", "fcl", "--out", "run"), ("fcl",), (*NEVER, "numba")),
    "an analytic run": (
        ("run", SPUR, "--trials", "5", "--engine", "analytic", "--out", "run"),
        ("numpy",),
        (*NEVER, "fcl", "numba"),
    ),
    "check": (("check", SPUR), ("numpy",), (*NEVER, "fcl")),
    "a report without parts": (
        ("report", "before", "--no-3d"),
        ("numpy",),
        (
            "fcl",
            "scipy.stats",
            "cadquery",
            "OCP",
            "pyvista",
            "trimesh",
            "tol3d.analyses.rare_events",
            "tol3d.analyses.tolerance_effects",
        ),
    ),
    "schema": (("schema",), ("pydantic",), (*NEVER, "fcl", "numba", "pyarrow")),
    "help": (("--help",), ("typer",), (*NEVER, "fcl", "numba", "numpy", "scipy", "pyarrow")),
}


@pytest.mark.slow
@pytest.mark.parametrize("what", LOADED)
def test_a_command_loads_what_it_needs_and_nothing_heavy_besides(what: str, tmp_path: Path) -> None:
    """Modules loaded at a command's end, in a process of its own; strips and kernels are in the cache."""
    arguments, wanted, never = LOADED[what]
    measuring_strips_of_the_spur_pair()
    if set(COMPILING) <= set(never) or "before" in arguments:
        run_scene(SPUR, overrides=Overrides(trials=5, witness=0), out=tmp_path / "before")  # keeps its kernels
    code = f"import sys; sys.argv = {['tol3d', *arguments]!r}\nfrom tol3d import cli\n"
    code += "try:\n    cli.main()\nexcept SystemExit as stop:\n    assert not stop.code\n"
    code += f"print([name for name in {(*wanted, *never)!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path)
    assert done.stdout.splitlines()[-1] == str(list(wanted))
    if what == "a run":
        assert (tmp_path / "run" / "histogram.png").read_bytes()[:4] == b"\x89PNG"


def measuring_strips_of_the_spur_pair() -> None:
    """Have them in the cache."""
    strips_of(model_from_scene(load_scene(Path(SPUR))))
