"""Runs that somebody else made, or changed: opening one executes nothing, waits for nothing, and says what is wrong."""

import hashlib
import json
import math
import os
import random
import shutil
import tracemalloc
from collections.abc import Callable, Iterator
from io import StringIO
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fixtures import Command
from places import SCENES
from rich.console import Console
from schemas import validate

from tol3d import InputError, Overrides, Run, RunError, open_run, replay, run_scene
from tol3d.cli.console import SafeConsole, shown_controls
from tol3d.files import contained, read_contained
from tol3d.report import comparison_report, draw_comparison, run_report
from tol3d.simulate import simulation_again
from tol3d.study.runs.block_files import CHECKSUMS
from tol3d.study.runs.manifest import MANIFEST
from tol3d.study.runs.run import SUMMARY
from tol3d.study.runs.summary.kinds import default_kinds
from tol3d.study.runs.summary.text import SchemaWarning, typed, written
from tol3d.study.runs.worst import worst_trial

TRIALS = 24
ESCAPE = "\x1b[2J\x1b]0;owned\x07"
WRONG: tuple[Any, ...] = (None, ESCAPE, "x", True, -1, 0, 0.5, 1e14, 1e300, -1e300, 10**30, [], {}, [None], {"a": 1})
MORE_EDITS = ("whole", 0.014), ("whole", 0.3), ("train", 0.3)  # scene and share of all values that are edited
KeyPath = tuple[str | int, ...]


def sealed(folder: Path, name: str, content: bytes) -> None:
    """Change a file of a run as a stranger would: with its checksum."""
    (folder / name).write_bytes(content)
    sums = {file: line.split("  ")[0] for line in lines_of(folder) for file in [line.split("  ", 1)[1]]}
    sums[name] = hashlib.sha256(content).hexdigest()
    (folder / MANIFEST).write_text("".join(f"{sums[file]}  {file}\n" for file in sums), "utf-8")


def lines_of(folder: Path) -> list[str]:
    return (folder / MANIFEST).read_text("utf-8").splitlines()


def sealed_block(folder: Path, content: bytes) -> None:
    """Put another first block into a run, with all checksums."""
    (folder / "trials" / "block-000000.parquet").write_bytes(content)
    line = f"{hashlib.sha256(content).hexdigest()}  block-000000.parquet\n"
    sealed(folder, f"trials/{CHECKSUMS}", line.encode())


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run with curves, files, a witness and another's column."""
    out = tmp_path_factory.mktemp("runs") / "every"
    run_scene(SCENES / "every_field.yaml", overrides=Overrides(trials=TRIALS, witness=3), out=out)
    return out


@pytest.fixture(scope="module")
def train(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of a train with parallel load paths."""
    out = tmp_path_factory.mktemp("runs") / "train"
    run_scene(SCENES / "split_train.yaml", overrides=Overrides(trials=TRIALS, witness=0), out=out)
    return out


@pytest.fixture
def run(whole: Path, tmp_path: Path) -> Path:
    """A copy to be spoilt."""
    return Path(shutil.copytree(whole, tmp_path / "run"))


def read_all_of(folder: Path) -> Run:
    """Open a run and read every file of it."""
    opened = open_run(folder)
    opened.columns()
    replay(opened, 0)
    return opened


def summary_in(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / SUMMARY).read_bytes())
    return found


# integrity ----------------------------------------------------------------------------------------


def test_the_list_of_a_run_is_that_of_sha256sum(whole: Path) -> None:
    listed = {line.split("  ", 1)[1]: line.split("  ")[0] for line in lines_of(whole)}
    blocks = {f"trials/{path.name}" for path in (whole / "trials").glob("*.parquet")}
    files = {path.relative_to(whole).as_posix() for path in whole.rglob("*") if path.is_file()}
    assert listed.keys() == files - blocks - {MANIFEST}
    for name, sha256 in listed.items():
        assert hashlib.sha256((whole / name).read_bytes()).hexdigest() == sha256


def test_a_changed_seed_is_refused(run: Path) -> None:
    summary = summary_in(run)
    summary["study"]["seed"] += 1
    (run / SUMMARY).write_text(json.dumps(summary), "utf-8")
    for use in (open_run, lambda path: replay(path, 0)):
        with pytest.raises(RunError, match=r"summary\.json: was changed since the run was made"):
            use(run)
    sealed(run, SUMMARY, json.dumps(summary).encode())
    with pytest.raises(RunError, match=r"study\.seed: expected 7, as it says for the run, got 8"):
        open_run(run)


def test_every_file_of_a_run_is_held_against_its_checksum_when_it_is_read(whole: Path, tmp_path: Path) -> None:
    # the scene's curve reads the block, a replay the scene and the files that it names
    for number, path in enumerate(sorted(whole.rglob("*"))):
        if not path.is_file() or path.name in (MANIFEST, "contributors.csv", "correlations.csv"):  # for people to read
            continue
        copy = Path(shutil.copytree(whole, tmp_path / f"copy{number}"))
        changed = copy / path.relative_to(whole)
        content = bytearray(changed.read_bytes())
        content[len(content) // 2] ^= 1
        changed.write_bytes(content)
        with pytest.raises(RunError):
            read_all_of(copy)


def test_a_run_without_its_list_is_refused(run: Path) -> None:
    (run / MANIFEST).unlink()
    with pytest.raises(RunError, match=r"SHA256SUMS: cannot be read .*run the scene again"):
        open_run(run)


@pytest.mark.parametrize("name", ["../outside", "/etc/passwd", "a/../../b", "C:/x", "a\\b", ".", ""])
def test_no_name_in_a_list_leads_out_of_the_run(name: str, run: Path) -> None:
    assert not contained(name)
    with (run / MANIFEST).open("a") as stream:
        stream.write(f"{'0' * 64}  {name}\n")
    with pytest.raises(RunError, match="expected lines of a SHA-256 and the path of a file in the run"):
        open_run(run)


def test_a_list_of_blocks_deletes_nothing_outside_when_the_run_is_replaced(run: Path, tmp_path: Path) -> None:
    precious = tmp_path / "precious.parquet"
    precious.write_bytes(b"mine")
    content = (run / "trials" / CHECKSUMS).read_bytes() + f"{'0' * 64}  ../../precious.parquet\n".encode()
    sealed(run, f"trials/{CHECKSUMS}", content)
    overrides = Overrides(trials=TRIALS, engine="analytic", witness=0)
    run_scene(SCENES / "every_field.yaml", overrides=overrides, out=run, force=True)
    assert precious.read_bytes() == b"mine"


# every value of a summary ---------------------------------------------------------------------------


def leaves(value: Any, path: KeyPath = ()) -> Iterator[KeyPath]:
    """Every place in a summary; of a list its first item."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, (*path, key))
    elif isinstance(value, list) and value:
        yield from leaves(value[0], (*path, 0))
    if path:
        yield path


def replaced(summary: dict[str, Any], path: KeyPath, value: Any) -> bytes:
    copy = json.loads(json.dumps(summary))
    at = copy
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return json.dumps(copy).encode()


def told_of(run: Run) -> str:
    """Tables of a run in text, and the worst of its trials."""
    page = StringIO()
    console = SafeConsole(file=page, width=120, highlight=False, markup=False)
    console.print(run_report(run.found))
    console.print(comparison_report([run]))
    return f"{page.getvalue()}\n{worst_trial(run)}"


def edits(folder: Path, share: float) -> Iterator[tuple[KeyPath, Any]]:
    """One-value edits, the same ones every time."""
    chosen = random.Random(1)
    for path in leaves(summary_in(folder)):
        for value in WRONG:
            if chosen.random() < share:
                yield path, value


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "share"), [("whole", 0.07), ("train", 0.2)])
def test_an_edit_of_a_summary_is_refused(
    scene: str, share: float, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    folder = Path(shutil.copytree(request.getfixturevalue(scene), tmp_path / "run"))
    summary = summary_in(folder)
    edited = 0
    for path, value in edits(folder, share):
        text = replaced(summary, path, value)
        if json.loads(text) != summary:
            (folder / SUMMARY).write_bytes(text)
            edited += 1
            with pytest.raises(RunError, match="was changed since the run was made"):
                open_run(folder)
    assert edited > 500


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "share"), [("train", 0.014), *(pytest.param(*edits, marks=pytest.mark.slow) for edits in MORE_EDITS)]
)
def test_an_edit_with_its_checksum_is_refused_or_harmless(
    scene: str, share: float, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    folder = Path(shutil.copytree(request.getfixturevalue(scene), tmp_path / "run"))
    summary = summary_in(folder)
    said = []
    for path, value in edits(folder, share):
        sealed(folder, SUMMARY, replaced(summary, path, value))
        try:
            assert "\x1b" not in told_of(open_run(folder)), path
        except InputError as error:  # anything else would be exit code 3
            said.append(str(error))
    assert len(said) > 100
    assert all(text.isprintable() and len(text) < 1500 for text in said)


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["whole", "train"])
def test_an_edit_with_its_checksum_is_drawn_and_replayed_or_refused(
    scene: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    folder = Path(shutil.copytree(request.getfixturevalue(scene), tmp_path / "run"))
    summary = summary_in(folder)
    drawn = 0
    for path, value in edits(folder, 0.01):
        sealed(folder, SUMMARY, replaced(summary, path, value))
        try:
            opened = open_run(folder)
            draw_comparison([opened], tmp_path / "picture.png")
            drawn += 1
            simulation_again(opened)
        except InputError:
            continue
    assert drawn > 2


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"null",
        b"3",
        b"NaN",
        b"[1, 2",
        b"\xff\xfe",
        b"[" * 100_000,
        b'{"a": ' * 100_000,
        b'{"trials": ' + b"9" * 10_000 + b"}",
        b'{"scene": "\\ud800"}',
        b"{}",
    ],
    ids=range(11),
)
def test_what_is_no_summary_at_all_is_one_message(text: bytes, run: Path) -> None:
    sealed(run, SUMMARY, text)
    with pytest.raises(RunError, match=r"summary\.json: ") as caught:
        open_run(run)
    assert str(caught.value).isprintable()


def test_a_missing_or_unknown_key_is_named(run: Path) -> None:
    summary = summary_in(run)
    del summary["measures"]["normal backlash curve"]["curve"]["geometric"]["sigma"]
    sealed(run, SUMMARY, json.dumps(summary).encode())
    with pytest.raises(RunError, match=r"measures\.normal backlash curve\.curve\.geometric\.sigma: Field required"):
        open_run(run)
    summary = summary_in(run) | {"extra": 1}
    sealed(run, SUMMARY, json.dumps(summary).encode())
    with pytest.raises(RunError):
        open_run(run)


# the schema -----------------------------------------------------------------------------------------


def test_a_measure_of_no_kind_is_refused_by_the_kinds_of_all_mechanisms(run: Path) -> None:
    summary = summary_in(run)
    next(iter(summary["measures"].values()))["kind"] = "backlush"
    said = []
    for kinds in (None, default_kinds()):
        with pytest.raises(RunError, match="backlush") as refused:
            typed(summary, lambda place, words: RunError(f"{place}: {words}"), kinds)
        said.append(str(refused.value))
    assert said[0] == said[1]


def test_the_schema_that_is_printed_is_valid_and_accepts_runs(tol3d: Command, whole: Path, train: Path) -> None:
    code, out, _ = tol3d("schema", "--summary")
    assert code == 0
    schema = json.loads(out)
    jsonschema.Draft202012Validator.check_schema(schema)
    for folder in (whole, train):
        validate(summary_in(folder), schema)
    with pytest.raises(jsonschema.ValidationError):
        validate(summary_in(whole) | {"trials": "many"}, schema)
    assert schema == default_kinds().run.model_json_schema()


def test_a_key_that_the_schema_lacks_is_told_when_it_is_written(whole: Path) -> None:
    summary = summary_in(whole)
    summary["measures"]["normal backlash curve"]["new key"] = 1.0
    told = r"curve\.new key: unknown key.*written down in tol3d/study/runs/summary/"
    with pytest.warns(SchemaWarning, match=told):
        text = written(summary)
    assert json.loads(text) == summary


# pipes, devices, links, bombs -----------------------------------------------------------------------


def a_pipe(path: Path) -> None:
    os.mkfifo(path)


def an_endless_device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def a_link_to_a_secret(path: Path) -> None:
    secret = path.parent.parent / f"secret of {path.name}"
    if path.parent.name in ("trials", "files"):
        secret = path.parent.parent.parent / secret.name
    secret.write_text("root:x:0:0", "utf-8")
    path.symlink_to(secret)


def a_folder(path: Path) -> None:
    path.mkdir()


def a_link_to_itself(path: Path) -> None:
    path.symlink_to(path.name)


PLACES = (SUMMARY, MANIFEST, "scene.yaml", f"trials/{CHECKSUMS}", "trials/block-000000.parquet", "files/*")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes")
@pytest.mark.parametrize("trap", [a_pipe, an_endless_device, a_link_to_a_secret, a_folder, a_link_to_itself])
@pytest.mark.parametrize("place", PLACES)
def test_nothing_is_waited_for_and_nothing_outside_is_read(place: str, trap: Callable[[Path], None], run: Path) -> None:
    path = next(run.glob(place))
    path.unlink()
    trap(path)
    with pytest.raises(RunError) as caught:
        read_all_of(run)
    assert path.name in str(caught.value) or place == SUMMARY
    assert "root:x" not in str(caught.value)


def parquet(columns: dict[str, Any]) -> bytes:
    stream = pa.BufferOutputStream()
    pq.write_table(pa.table(columns), stream, compression="zstd")
    return bytes(stream.getvalue())


def zeros(count: int) -> pa.Array:
    return pa.array(np.zeros(count))


BOMBS: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "too many trials": lambda columns: {name: zeros(3_000_000) for name in columns},
    "one trial too many": lambda columns: {name: zeros(TRIALS + 1) for name in columns},
    "a curve of a million positions": lambda columns: {
        name: pa.FixedSizeListArray.from_arrays(zeros(1_000_000 * TRIALS), 1_000_000)
        if name.endswith("curve")
        else column
        for name, column in columns.items()
    },
    "lists of any length": lambda columns: {name: pa.array([[0.0]] * TRIALS) for name in columns},
    "structures": lambda columns: {name: pa.array([{"a": 1}] * TRIALS) for name in columns},
    "bytes": lambda columns: {name: pa.array([b"\x80"] * TRIALS) for name in columns},
    "words for numbers": lambda columns: {name: pa.array(["x"] * TRIALS) for name in columns},
    "no 3D simulation": lambda columns: {k: v for k, v in columns.items() if not k.startswith("geometric:")},
    "no columns": lambda columns: {},
    "a word of ten megabytes": lambda columns: columns | {"status": pa.array(["x" * 10**7] * TRIALS)},
}


READ_AS_BLOCKS = ("words for numbers", "no 3D simulation")  # of the size of a block


@pytest.mark.parametrize(
    "bomb", [pytest.param(own, marks=pytest.mark.slow) if "megabytes" in own else own for own in BOMBS]
)
def test_a_block_that_is_none_is_refused_before_it_is_unpacked(
    bomb: str, run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = pq.read_table(run / "trials" / "block-000000.parquet")
    sealed_block(run, parquet(BOMBS[bomb]({name: table.column(name) for name in table.column_names})))

    def unpack(*arguments: object, **more: object) -> None:
        pytest.fail("the block is unpacked")

    if bomb not in READ_AS_BLOCKS:
        monkeypatch.setattr(pq.ParquetFile, "read", unpack)
    with pytest.raises(RunError) as caught:
        told_of(read_all_of(run))
    assert "block-000000.parquet" in str(caught.value) or "column" in str(caught.value)


def test_five_megabytes_of_three_hundred_million_zeros_are_refused_by_their_number(run: Path) -> None:
    # a dictionary of one zero, and run lengths: told by the metadata, which alone are read
    column = pa.DictionaryArray.from_arrays(pa.array(np.zeros(10**6, np.int32)), [0.0])
    names = pq.read_schema(run / "trials" / "block-000000.parquet").names
    sealed_block(run, parquet({name: column for name in names if name.startswith(("analytic:", "geometric:"))}))
    with pytest.raises(RunError, match=rf"1000000 trials where there should be {TRIALS}"):
        open_run(run).columns()


def test_the_number_of_blocks_is_believed_to_the_files_alone(run: Path) -> None:
    summary = summary_in(run)
    summary["trials"] = summary["study"]["trials"] = summary["status"]["ok"] = 10**10
    summary["blocks"]["trials"] = 1
    sealed(run, SUMMARY, json.dumps(summary).encode())
    with pytest.raises(RunError, match="expected 10000000000 Parquet files with the trials, found 1"):
        open_run(run)


# what is printed ------------------------------------------------------------------------------------


def test_escapes_of_a_summary_reach_no_terminal(tol3d: Command, run: Path, tmp_path: Path) -> None:
    summary = summary_in(run)
    for path in (("scene",), ("warnings",), ("measures", "normal backlash curve", "of"), ("versions", "numpy")):
        spoilt = [f"beware {ESCAPE}"] if path == ("warnings",) else f"a{ESCAPE}\u202eb"
        sealed(run, SUMMARY, replaced(summary, path, spoilt))
        for command in ("compare", "export", "view"):
            code, out, err = tol3d(command, str(run))
            assert code == 2, (command, path, err)
            assert "\x1b" not in out + err
            assert "\u202e" not in out + err
            assert "without control or invisible characters" in err


def test_escapes_in_anything_that_is_printed_are_shown_as_pictures() -> None:
    page = StringIO()
    console = SafeConsole(file=page, force_terminal=True, width=60, highlight=False, markup=False)
    console.print(f"a{ESCAPE}b\u202ec\x7f", style="red")
    assert page.getvalue() == "\x1b[31ma␛[2J␛]0;ownedb\ufffdc␡\x1b[0m\n"
    bare = StringIO()
    Console(file=bare, force_terminal=True, width=60, highlight=False).print(f"a{ESCAPE}b", markup=False)
    assert "\x1b]0;owned" in bare.getvalue()  # what this is for
    assert shown_controls("über 5′ ∥ 歯\nnext") == "über 5′ ∥ 歯\nnext"


def test_bounds_of_the_schema_are_finite() -> None:
    # JSON has no infinity; a number beyond the bounds would make pictures of nothing
    def bounds(schema: Any) -> Iterator[float]:
        if isinstance(schema, dict):
            if schema.get("type") in ("number", "integer"):
                yield schema.get("maximum", math.inf)
            for item in schema.values():
                yield from bounds(item)
        elif isinstance(schema, list):
            for item in schema:
                yield from bounds(item)

    assert max(bounds(default_kinds().run.model_json_schema())) < 1e19


def test_a_small_file_takes_no_more_memory_than_it_has(tmp_path: Path) -> None:
    (tmp_path / "own").write_bytes(b"0123456789")
    tracemalloc.start()
    assert read_contained(tmp_path / "own", tmp_path, 100_000_000) == b"0123456789"
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 1_000_000  # paths and the file's ten bytes; 100 MB were asked for before
