"""The process that reads foreign geometry: whatever it does, the one that asked it goes on."""

import json
import random
import re
import time
from pathlib import Path

import pytest
from foreign_parts import nist_file, slotted_block, step_file

from tol3d.cad.step import reading
from tol3d.cad.step.reading import StepPart, read_step
from tol3d.errors import InputError
from tol3d.files import FileContent
from tol3d.numerics.cache_folder import FOLDER_VARIABLE


@pytest.fixture
def fresh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own, empty."""
    folder = tmp_path / "cache"
    folder.mkdir(mode=0o700)
    monkeypatch.setenv(FOLDER_VARIABLE, str(folder))
    return folder


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> FileContent:
    return step_file({"block": slotted_block()}, tmp_path_factory.mktemp("block") / "block.step")


FACE = {"id": 1, "kind": "plane", "area": 1.0, "centre": [0.0] * 3, "place": [0.0] * 3, "normal": [0.0] * 3}
LOOSE, FLAT = (
    json.dumps({"roots": [{"id": 1, "solid": True, "edges": [], "faces": [{**FACE, "outer": [], **own}]}]})
    for own in ({"edges": [5]}, {"edges": [], "axis": [0.0] * 3})
)
ANSWER = "import json, sys, pathlib; folder = pathlib.Path(sys.argv[1]); "


@pytest.mark.parametrize(
    ("program", "words"),
    [
        ("import os; os.abort()", "crashes on it (SIGABRT)"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "crashes on it (SIGSEGV)"),
        ("import os; os._exit(3)", "fails on it (exit code 3)"),
        ("while True: pass", "; TOL3D_STEP_SECONDS=20 would give it longer"),
        ("import time; time.sleep(60)", "does not read it within 4 s; TOL3D_STEP_SECONDS=20 would give it longer"),
        ("x = [bytearray(10**9) for _ in range(50)]", "needs too much memory"),
        ("raise RuntimeError('a\\x1b[31m\\nb')", "fails on it (b)"),
        ("pass", "fails on it (exit code 0)"),
        (ANSWER + "(folder / 'answer.json').write_text('[' * 100000)", "fails on it (exit code 0)"),
        pytest.param(ANSWER + "(folder / 'answer.json').write_text('{\"roots\": []}')", "reads 0 of ", id="no bodies"),
        (ANSWER + "(folder / 'answer.json').write_text('{\"roots\": 1}')", "numbers that no part has"),
        (ANSWER + "import os; os.mkfifo(folder / 'answer.json')", "fails on it (exit code 0)"),
        (ANSWER + "(folder / 'answer.json').symlink_to('/dev/zero')", "fails on it (exit code 0)"),
        (ANSWER + f"(folder / 'answer.json').write_text({LOOSE!r})", "should name edges that are there"),
        (ANSWER + f"(folder / 'answer.json').write_text({FLAT!r})", "a direction of length 1"),
        (
            ANSWER + "(folder / 'answer.json').write_text('{\"refused\": \"no\"}')",
            "no; mend the file in the CAD system",
        ),
    ],
)
def test_whatever_it_does_is_one_line(
    program: str, words: str, block: FileContent, fresh: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    limits = (
        "import json, sys; from tol3d.cad.step.limits import limit_this_process; "
        "own = json.load(open(sys.argv[1] + '/order.json')); limit_this_process(own['megabytes'], own['seconds'])\n"
    )
    monkeypatch.setattr(reading, "PROGRAM", limits + program)
    monkeypatch.setenv("TOL3D_STEP_SECONDS", "20" if "bytearray" in program else "2")
    monkeypatch.setenv("TOL3D_STEP_MEGABYTES", "3000")
    began = time.monotonic()
    with pytest.raises(InputError) as error:
        read_step(block)
    assert words in str(error.value)
    assert str(error.value).startswith("block.step")
    assert "\n" not in str(error.value)
    assert str(error.value).isprintable()
    assert time.monotonic() - began < 60
    assert not list(fresh.glob("step-*.npz"))


def test_a_damaged_entry_of_the_cache_is_read_anew(block: FileContent, fresh: Path) -> None:
    features = read_step(block).part(None).features
    assert sorted(path.name.rpartition("-")[0] for path in fresh.glob("step-*.npz")) == [
        "step-faces", "step-mesh", "step-read",
    ]  # fmt: skip
    for path in fresh.glob("step-*.npz"):
        content = bytearray(path.read_bytes())
        content[len(content) // 2] ^= 1
        path.write_bytes(content)
    assert read_step(block).part(None).features == features


def test_a_second_reading_starts_no_process(block: FileContent, fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = read_step(block).part(None)
    mesh = first.mesh()
    monkeypatch.setattr(reading, "PROGRAM", "import os; os.abort()")
    again = read_step(FileContent(Path("elsewhere") / "other.step", block.content)).part(None)
    assert again.features == first.features
    assert (again.mesh().vertices == mesh.vertices).all()
    changed = FileContent(block.path, block.content.replace(b"FILE_NAME('", b"FILE_NAME('x"))
    with pytest.raises(InputError, match="SIGABRT"):
        read_step(changed)


@pytest.mark.parametrize("unit", ["0", "-1", "x", "nan"])
def test_a_limit_must_be_a_number(unit: str, block: FileContent, fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TOL3D_STEP_SECONDS", unit)
    with pytest.raises(InputError, match="TOL3D_STEP_SECONDS: expected a number of seconds"):
        read_step(block)


def damaged(seed: int, content: bytes) -> bytes:
    """A file that is cut, or has other bytes or other references in its data."""
    dice = random.Random(seed)
    start = content.index(b"DATA;")
    if seed % 4 == 0:
        return content[: dice.randrange(start, len(content))]
    found = bytearray(content)
    if seed % 4 == 1:
        for _ in range(20):
            found[dice.randrange(start, len(found))] = dice.randrange(32, 127)
        return bytes(found)
    places = [k for k in range(start, len(found)) if found[k] in b"0123456789"]
    for k in dice.sample(places, 12 if seed % 4 == 2 else 3):
        found[k] = dice.choice(b"0123456789")
    return bytes(found)


@pytest.mark.parametrize("seed", range(12))
def test_damaged_files_end_and_no_part_lacks_faces(seed: int, fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = nist_file("ctc_01")
    monkeypatch.setenv("TOL3D_STEP_SECONDS", "20")
    content = FileContent(Path("damaged.stp"), damaged(seed, whole.content))
    refused = ""
    parts: tuple[StepPart, ...] = ()
    try:
        parts = read_step(content).parts
    except InputError as error:
        refused = str(error)
    assert bool(refused) is not bool(parts)
    assert not refused or (refused.startswith("damaged.stp") and "\n" not in refused)
    for part in parts:
        faces = [number for own in part.features for number in own.faces]
        assert len(faces) == len(set(faces)) == content.content.count(b"ADVANCED_FACE(")


def test_only_the_other_process_imports_open_cascade() -> None:
    apart = ("worker.py", "step_cad.py")
    for path in Path(reading.__file__).parent.glob("*.py"):
        text = path.read_text("utf-8")
        imports = re.findall(r"^(?:from|import) ([\w.]+)", text, re.MULTILINE)
        own = {"OCP", "cadquery"} & {name.partition(".")[0] for name in imports}
        own |= {"tol3d.cad.step.worker", "tol3d.cad.step.step_cad"} & set(imports)
        assert not own or path.name in apart
