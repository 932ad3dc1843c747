"""A run that goes where something lies: only one of the same study with nothing else in its folder is replaced."""

import json
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from fixtures import Command
from places import SPUR_PAIR

from tol3d import Overrides, RunError, open_run, run_scene
from tol3d.cli.arguments import scene_path
from tol3d.simulate import Watch, folder_for, load, simulation_of
from tol3d.study.execution.pools import Execution
from tol3d.study.runs.manifest import MANIFEST
from tol3d.study.runs.occupant import MovedAsideWarning

FEW = Overrides(trials=20, engine="analytic", witness=0)
OTHER_SEED = Overrides(trials=20, engine="analytic", witness=0, seed=5)
MORE = Overrides(trials=30, engine="analytic", witness=0)

Files = dict[str, bytes]


def files_in(folder: Path) -> Files:
    """Every file below a folder, by its path there."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def project(folder: Path) -> Path:
    """Somebody's work, which happens to have a file of the name that runs have too."""
    (folder / "src").mkdir(parents=True)
    (folder / "src" / "main.c").write_text("int main() {}", "utf-8")
    (folder / "summary.json").write_text('{"coverage": 93}', "utf-8")
    return folder


def test_a_folder_of_a_name_that_was_once_a_backup_is_left_alone(tmp_path: Path) -> None:
    precious = project(tmp_path / "a.old")
    before = files_in(precious)
    for _ in range(2):
        run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "a")
    assert files_in(precious) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "a.old"]


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize(
    "text",
    [
        '{"coverage": 93}',
        '{"trials": 3, "measures": {}, "study": {}, "files": {}}',  # what an older tol3d took for a run
        "[]",
        "not JSON",
    ],
)
def test_a_foreign_folder_with_a_summary_is_refused_even_by_force(text: str, force: bool, tmp_path: Path) -> None:
    folder = project(tmp_path / "project")
    (folder / "summary.json").write_text(text, "utf-8")
    before = files_in(folder)
    with pytest.raises(RunError, match=r"project: exists and is not a tol3d run .*choose another folder with --out"):
        run_scene(SPUR_PAIR, overrides=FEW, out=folder, force=force)
    assert files_in(folder) == before
    assert [path.name for path in tmp_path.iterdir()] == ["project"]


def added_file(name: str, text: str) -> Callable[[Path], None]:
    def add(run: Path) -> None:
        (run / name).parent.mkdir(exist_ok=True)
        (run / name).write_text(text, "utf-8")

    return add


ADDED: dict[str, Callable[[Path], None]] = {
    "notes": added_file("notes.md", "the good one"),
    "exports": added_file("exports/wheel.stl", "solid"),
    "a table beside the trials": added_file("trials/mine.csv", "a,b"),
    "an empty folder": lambda run: (run / "for later").mkdir(),
    "a link": lambda run: (run / "link").symlink_to("summary.json"),
    "a picture that was painted over": added_file("histogram.png", "circled"),
    "a commented scene": added_file("scene.yaml", "# mine"),
}


def drawn(place: Path, summary: object) -> None:
    """Stands for what draws the pictures of a run."""
    (place / "histogram.png").write_bytes(b"a picture")


def a_run(folder: Path, overrides: Overrides = FEW, *, force: bool = False) -> None:
    run_scene(SPUR_PAIR, overrides=overrides, out=folder, watch=Watch(finisher=drawn), force=force)


@pytest.mark.parametrize("added", ADDED)
def test_what_a_user_keeps_in_a_run_is_never_lost(added: str, tmp_path: Path) -> None:
    a_run(tmp_path / "run")
    ADDED[added](tmp_path / "run")
    before = files_in(tmp_path / "run")
    with pytest.raises(RunError, match=r"run: holds files that are not of the run.*choose another --out, or --force"):
        a_run(tmp_path / "run")
    assert files_in(tmp_path / "run") == before
    assert [path.name for path in tmp_path.iterdir()] == ["run"]
    with pytest.warns(MovedAsideWarning, match=r"run: .* was moved aside to .*run\.1"):
        a_run(tmp_path / "run", force=True)
    assert files_in(tmp_path / "run.1") == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run", "run.1"]
    assert open_run(tmp_path / "run").trials == 20


def test_what_a_file_manager_leaves_is_no_work_of_anyone(tmp_path: Path) -> None:
    a_run(tmp_path / "run")
    (tmp_path / "run" / ".DS_Store").write_bytes(b"icons")
    a_run(tmp_path / "run")
    assert not (tmp_path / "run" / ".DS_Store").exists()


def test_the_same_study_is_replaced_and_nothing_is_left_beside_it(tmp_path: Path) -> None:
    a_run(tmp_path / "run")
    first = files_in(tmp_path / "run")
    a_run(tmp_path / "run")
    second = files_in(tmp_path / "run")
    assert {name for name in first if first[name] != second[name]} <= {"summary.json", MANIFEST}  # its timing
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


@pytest.mark.parametrize(
    ("other", "words"), [(OTHER_SEED, "study: seed 1 there, 5 now"), (MORE, "study: trials 20 there, 30 now")]
)
def test_another_study_is_refused_until_it_is_forced(other: Overrides, words: str, tmp_path: Path) -> None:
    a_run(tmp_path / "run")
    before = files_in(tmp_path / "run")
    with pytest.raises(RunError, match=rf"run: holds another study \({words}\); choose another --out, or --force"):
        a_run(tmp_path / "run", other)
    assert files_in(tmp_path / "run") == before
    a_run(tmp_path / "run", other, force=True)
    assert open_run(tmp_path / "run").summary["study"]["seed"] == (other.seed or 1)
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_another_scene_of_the_same_file_name_is_refused(tmp_path: Path) -> None:
    a_run(tmp_path / "run")
    other = tmp_path / "spur_pair.yaml"
    other.write_text(SPUR_PAIR.read_text("utf-8").replace("172.5 mm", "172.51 mm"), "utf-8")
    with pytest.raises(RunError, match=r"run: holds another study \(the scene's text\)"):
        run_scene(other, overrides=FEW, out=tmp_path / "run")


def test_trials_are_not_replaced_by_statistics_only_but_these_by_trials(tmp_path: Path) -> None:
    run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "run")
    bare = Execution(keep_trials=False)
    with pytest.raises(RunError, match="holds the trials, too"):
        run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "run", execution=bare)
    run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "run", execution=bare, force=True)
    assert run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "run").keeps_trials


def test_an_interrupted_run_of_another_study_is_kept_until_it_is_forced(tmp_path: Path) -> None:
    def stop(done: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "run", watch=Watch(progress=stop))
    (tmp_path / "run.partial" / "notes.md").write_text("stopped for lunch", "utf-8")
    before = files_in(tmp_path / "run.partial")
    assert "trials/block-000000.parquet" in before
    with pytest.raises(RunError, match=r"run\.partial: an interrupted run of another study is kept there \(.*seed 1"):
        run_scene(SPUR_PAIR, overrides=OTHER_SEED, out=tmp_path / "run")
    assert files_in(tmp_path / "run.partial") == before
    run = run_scene(SPUR_PAIR, overrides=OTHER_SEED, out=tmp_path / "run", force=True)
    assert run.summary["timing"]["resumed_trials"] == 0
    assert (run.path / "notes.md").read_text("utf-8") == "stopped for lunch"


def test_a_partial_folder_of_somebody_else_is_left_alone(tmp_path: Path) -> None:
    precious = tmp_path / "run.partial"
    (precious / "trials").mkdir(parents=True)
    (precious / "trials" / "mine.txt").write_text("precious", "utf-8")
    (precious / "fingerprint.json").write_text('["of my thumb"]', "utf-8")
    before = files_in(precious)
    for force in (False, True):
        with pytest.raises(RunError, match=r"run\.partial: exists and is not an interrupted run; move it away"):
            run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "run", force=force)
    assert files_in(precious) == before


def test_mending_a_run_leaves_what_is_kept_in_it(tmp_path: Path) -> None:
    a_run(tmp_path / "run")
    for added in ("notes", "exports", "a table beside the trials"):
        ADDED[added](tmp_path / "run")
    (tmp_path / "run" / "files").mkdir()
    (tmp_path / "run" / "files" / "mine.csv").write_text("a,b", "utf-8")
    block = tmp_path / "run" / "trials" / "block-000000.parquet"
    whole = files_in(tmp_path / "run")
    block.write_bytes(block.read_bytes()[:-9])
    with pytest.warns(UserWarning, match="it is made again"):
        run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "run", execution=Execution(resume=True))
    mended = files_in(tmp_path / "run")
    assert {name for name in whole if whole[name] != mended.get(name)} <= {"summary.json", MANIFEST}
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_a_picture_painted_over_while_a_run_is_mended_is_not_of_the_run(tmp_path: Path) -> None:
    a_run(tmp_path / "run")
    block = tmp_path / "run" / "trials" / "block-000000.parquet"
    block.write_bytes(block.read_bytes()[:-9])

    def paint(place: Path, summary: object) -> None:
        (place.parent / "histogram.png").write_text("circled", "utf-8")

    with pytest.warns(UserWarning, match="it is made again"):
        run_scene(
            SPUR_PAIR,
            overrides=FEW,
            out=tmp_path / "run",
            execution=Execution(resume=True),
            watch=Watch(finisher=paint),
        )
    assert open_run(tmp_path / "run").manifest.foreign() == ["histogram.png"]
    with pytest.raises(RunError, match=r"holds files that are not of the run \(histogram\.png\)"):
        run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "run")


def test_a_run_of_another_study_that_came_meanwhile_is_moved_aside(tmp_path: Path) -> None:
    a_run(tmp_path / "other", OTHER_SEED)
    others = files_in(tmp_path / "other")

    def come(place: Path, summary: object) -> None:
        shutil.copytree(tmp_path / "other", tmp_path / "run")

    with pytest.warns(MovedAsideWarning, match=r"another study .*run\.1"):
        run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "run", watch=Watch(finisher=come))
    assert files_in(tmp_path / "run.1") == others
    assert open_run(tmp_path / "run").summary["seed"] != 5


def test_a_note_written_while_a_run_is_replaced_is_not_lost(tmp_path: Path) -> None:
    a_run(tmp_path / "run")

    def write_a_note(place: Path, summary: object) -> None:
        (tmp_path / "run" / "notes.md").write_text("just now", "utf-8")

    with pytest.warns(MovedAsideWarning, match=r"notes\.md"):
        run_scene(SPUR_PAIR, overrides=FEW, out=tmp_path / "run", watch=Watch(finisher=write_a_note))
    assert (tmp_path / "run.1" / "notes.md").read_text("utf-8") == "just now"
    assert open_run(tmp_path / "run").trials == 20


LEFT = "run.replaced-4711-0123abcd"


@pytest.mark.parametrize("deleted", ["nothing", "the blocks", "all but the list", "all but the folder"])
def test_what_a_kill_left_of_a_replaced_run_goes_with_the_next(deleted: str, tmp_path: Path) -> None:
    a_run(tmp_path / "run")
    left = tmp_path / LEFT
    shutil.copytree(tmp_path / "run", left)
    if deleted == "the blocks":
        for block in (left / "trials").glob("*.parquet"):
            block.unlink()
    elif deleted != "nothing":
        for path in left.iterdir():
            if path.name != MANIFEST or deleted == "all but the folder":
                shutil.rmtree(path) if path.is_dir() else path.unlink()
    a_run(tmp_path / "run")
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


@pytest.mark.parametrize("added", ADDED)
def test_what_a_user_keeps_in_what_a_kill_left_is_moved_aside(added: str, tmp_path: Path) -> None:
    a_run(tmp_path / "run")
    shutil.copytree(tmp_path / "run", tmp_path / LEFT)
    ADDED[added](tmp_path / LEFT)
    before = files_in(tmp_path / LEFT)
    with pytest.warns(MovedAsideWarning, match=r"run\.1"):
        a_run(tmp_path / "run")
    assert files_in(tmp_path / "run.1") == before


def test_a_folder_that_is_called_like_what_a_kill_leaves_is_left_alone(tmp_path: Path) -> None:
    a_run(tmp_path / "run")
    before = files_in(project(tmp_path / LEFT))
    a_run(tmp_path / "run")
    assert files_in(tmp_path / LEFT) == before


class Killed(BaseException):
    """Exception that no handler takes for an error."""


@pytest.mark.slow
def test_killed_at_any_step_of_a_replacement_the_old_or_the_new_run_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # every call that changes a folder is a moment at which a kill may fall, before it and after it
    changing = ("replace", "rename", "unlink", "rmdir", "fsync")
    real = {name: getattr(os, name) for name in changing}
    out, moments = tmp_path / "runs" / "run", 0
    for moment in range(10_000):
        shutil.rmtree(tmp_path / "runs", ignore_errors=True)
        a_run(out)
        calls = iter(range(10**9))

        def killed(name: str, moment: int = moment, calls: Iterator[int] = calls) -> Callable[..., object]:
            def call(*arguments: object, **more: object) -> object:
                if next(calls) >= moment:
                    raise Killed
                return real[name](*arguments, **more)

            return call

        for name in changing:
            monkeypatch.setattr(os, name, killed(name))
        try:
            a_run(out, OTHER_SEED, force=True)
        except Killed:
            moments += 1
        else:
            break
        finally:
            monkeypatch.undo()
        whole = [path for path in out.parent.iterdir() if seed_of(path) == 1]
        new = seed_of(out) == 5
        assert whole or new or goes_on(out)
        a_run(out, OTHER_SEED, force=True)  # and the same command ends well
        assert seed_of(out) == 5
        assert [path.name for path in out.parent.iterdir()] == ["run"]  # and nothing is left of the old one
    assert moments > 10


def seed_of(folder: Path) -> int | None:
    """Seed of a whole run."""
    try:
        run = open_run(folder)
        run.columns()
    except RunError:
        return None
    return int(run.summary["seed"])


def goes_on(out: Path) -> bool:
    """True if the partial folder holds every trial of the new run."""
    mark = out.with_name("run.partial") / "fingerprint.json"
    return mark.is_file() and json.loads(mark.read_bytes()).get("study", {}).get("seed") == 5


# where a run goes by default ------------------------------------------------------------------------


def default_folder(scene: Path, overrides: Overrides = FEW, execution: Execution = Execution()) -> Path:  # noqa: B008
    loaded = load(scene)
    return folder_for(loaded, simulation_of(loaded, overrides), execution, Path("runs"))[0]


def test_by_default_each_study_has_a_folder_and_finds_it_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    other = tmp_path / "other" / "spur_pair.yaml"
    other.parent.mkdir()
    other.write_text(SPUR_PAIR.read_text("utf-8").replace("172.5 mm", "172.51 mm"), "utf-8")
    plain, second, third = (Path("runs") / name for name in ("spur_pair", "spur_pair-2", "spur_pair-3"))
    for scene, overrides, expected in (
        (SPUR_PAIR, FEW, plain),
        (SPUR_PAIR, FEW, plain),
        (other, FEW, second),
        (SPUR_PAIR, OTHER_SEED, third),
        (SPUR_PAIR, OTHER_SEED, third),
        (other, FEW, second),
        (scene_path("spur_pair"), FEW, plain),  # the same text, wherever it lies
    ):
        folder = default_folder(scene, overrides)
        assert folder == expected
        run_scene(scene, overrides=overrides, out=folder)
    (tmp_path / plain / "notes.md").write_text("kept", "utf-8")
    assert default_folder(SPUR_PAIR) == Path("runs") / "spur_pair-4"


def test_by_default_an_interrupted_run_is_found_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)

    def stop(done: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_scene(
            SPUR_PAIR, overrides=OTHER_SEED, out=default_folder(SPUR_PAIR, OTHER_SEED), watch=Watch(progress=stop)
        )
    run_scene(SPUR_PAIR, overrides=FEW, out=default_folder(SPUR_PAIR))
    assert sorted(path.name for path in (tmp_path / "runs").iterdir()) == ["spur_pair-2", "spur_pair.partial"]
    assert default_folder(SPUR_PAIR, OTHER_SEED, Execution(resume=True)) == Path("runs") / "spur_pair"
    assert default_folder(SPUR_PAIR, OTHER_SEED) == Path("runs") / "spur_pair"
    assert default_folder(SPUR_PAIR, FEW, Execution(resume=True)) == Path("runs") / "spur_pair-2"
    assert default_folder(SPUR_PAIR, MORE, Execution(resume=True)) == Path("runs") / "spur_pair"  # says what is there


def test_a_run_that_is_being_written_is_not_called_interrupted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    partial = tmp_path / "runs" / "spur_pair.partial"
    said = ""

    def ask(done: int) -> None:
        nonlocal said
        place = folder_for(load("spur_pair"), simulation_of(load("spur_pair"), OTHER_SEED), Execution(), Path("runs"))
        assert partial.exists()
        assert place[0] == Path("runs") / "spur_pair-2"
        said = place[1]

    run_scene(SPUR_PAIR, overrides=FEW, out=default_folder(SPUR_PAIR), watch=Watch(progress=ask))
    assert said.startswith("runs/spur_pair is being written by another run (study: ")


def test_the_command_says_where_it_went_and_why(
    tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    study = ("run", "spur_pair", "--engine", "analytic", "--no-picture", "--trials")
    assert tol3d(*study, "20")[0] == 0
    code, out, err = tol3d(*study, "30")
    assert code == 0
    assert "runs/spur_pair holds another study (study: trials 20 there, 30 now)" in err
    assert "runs/spur_pair-2" in out
    code, _, err = tol3d(*study, "40", "--out", "runs/spur_pair")
    assert code == 2
    assert "holds another study" in err
    assert tol3d(*study, "40", "--force")[0] == 0
    assert open_run(tmp_path / "runs" / "spur_pair").trials == 40
