"""Disk cache between runs: trusted only where nobody else may write, whole or made anew."""

import hashlib
import io
import os
import stat
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numba
import numpy as np
import pytest
from filelock import FileLock, Timeout
from fixtures import Command
from places import SPUR_PAIR

from tol3d.cad.solids import cache as solids_cache
from tol3d.gears import SpurGear
from tol3d.numerics import compiled
from tol3d.numerics.cache_folder import CacheError, cache_folder, read_entry, sole_maker, write_entry
from tol3d.numerics.compiled import Kernel
from tol3d.statistics.samplers.monte_carlo import uniforms
from tol3d.statistics.samplers.quick_uniforms import quick_uniforms

posix = pytest.mark.skipif(not hasattr(os, "getuid"), reason="owners and modes are POSIX's")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("TOL3D_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


# the folder -----------------------------------------------------------------------------------------------------------


@posix
def test_the_folder_is_made_for_its_user_alone(folder: Path) -> None:
    before = os.umask(0)
    try:
        write_entry("a.npz", b"something")
    finally:
        os.umask(before)
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert read_entry("a.npz") == b"something"


@posix
@pytest.mark.parametrize("mode", [0o777, 0o770, 0o720, 0o702, 0o1777])
def test_a_folder_that_others_may_write_to_is_refused(folder: Path, mode: int, tol3d: Command, tmp_path: Path) -> None:
    folder.mkdir()
    folder.chmod(mode)
    with pytest.raises(CacheError, match=f"others may write .*mode {mode:o}.*chmod 700"):
        read_entry("a.npz")
    with pytest.raises(CacheError):
        write_entry("a.npz", b"something")
    code, _, err = tol3d("run", str(SPUR_PAIR), "--trials", "10", "--no-picture", "--out", str(tmp_path / "run"))
    assert code == 2
    assert "may write to this folder" in " ".join(err.split())
    assert list(folder.iterdir()) == []
    assert not (tmp_path / "run").exists()
    folder.chmod(0o755)  # to be read by others is harmless
    write_entry("a.npz", b"something")


@posix
def test_a_folder_of_somebody_else_is_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder.mkdir(mode=0o755)
    if os.getuid() == 0:
        os.chown(folder, 4711, 4711)
        stranger, me = 4711, 0
    else:
        stranger, me = os.getuid(), os.getuid() + 1
    monkeypatch.setattr(os, "getuid", lambda: me)
    with pytest.raises(CacheError, match=f"belongs to user {stranger}.*expected one of your own"):
        cache_folder()
    monkeypatch.setattr(os, "getuid", lambda: stranger)
    assert cache_folder() == folder


@posix
def test_the_users_own_cache_is_held_to_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("TOL3D_CACHE", raising=False)
    monkeypatch.setattr("platformdirs.user_cache_path", lambda *names, **settings: tmp_path / "tol3d")
    assert cache_folder() == tmp_path / "tol3d"
    write_entry("a", b"b")
    (tmp_path / "tol3d").chmod(0o775)
    with pytest.raises(CacheError, match="TOL3D_CACHE names another"):
        cache_folder()


# damage ---------------------------------------------------------------------------------------------------------------


def test_an_entry_cut_anywhere_counts_as_none(folder: Path) -> None:
    write_entry("a", bytes(range(200)))
    whole = (folder / "a").read_bytes()
    assert len(whole) == 232
    for length in range(len(whole)):
        (folder / "a").write_bytes(whole[:length])
        assert read_entry("a") is None, length
    for place in range(len(whole)):
        (folder / "a").write_bytes(whole[:place] + bytes([whole[place] ^ 4]) + whole[place + 1 :])
        assert read_entry("a") is None, place
    (folder / "a").write_bytes(hashlib.sha256(b"").digest())  # the right sum of nothing
    assert read_entry("a") is None
    (folder / "a").write_bytes(whole)
    assert read_entry("a") == bytes(range(200))


def fresh(like: Kernel) -> Kernel:
    """The same kernel as a process that starts has it."""
    made = Kernel(like._function, like._tuples, like._arrays, level=like._level)
    made._settings = like._settings
    return made


def drawn(kernel: Kernel, count: int = 50) -> np.ndarray:
    values = np.empty(count)
    kernel(np.array([1, 2], dtype=np.uint64), np.array([1], dtype=np.uint64), values)
    return values


Damage = Callable[[bytes], bytes]


def cut(share: float) -> Damage:
    return lambda content: content[: int(share * len(content))]


DAMAGES: dict[str, Damage] = {
    "empty": lambda content: b"",
    **{f"cut at {share}": cut(share) for share in (0.001, 0.1, 0.5, 0.9, 0.999)},
    "noise": lambda content: np.random.default_rng(3).bytes(len(content)),
    "zeros": lambda content: bytes(len(content)),
    "a bit": lambda content: content[:-200] + bytes([content[-200] ^ 1]) + content[-199:],
}


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES.keys())
def test_a_damaged_kernel_is_compiled_anew(folder: Path, damage: Damage) -> None:
    from tol3d.statistics.samplers import quick_uniforms as module

    expected = drawn(fresh(module._draw))
    files = [path for path in folder.rglob("*") if path.is_file()]
    assert files
    for path in files:
        path.write_bytes(damage(path.read_bytes()))
    again = fresh(module._draw)
    assert not again.kept
    assert np.array_equal(drawn(again), expected)
    third = fresh(module._draw)
    assert third.kept
    assert np.array_equal(drawn(third), expected)
    assert sum(vars(third)["_compiled"].stats.cache_hits.values()) == 1


def archive(**files: bytes) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as entries:
        for name, content in files.items():
            entries.writestr(name, content)
    return stream.getvalue()


def test_an_entry_that_is_whole_but_no_kernel_is_compiled_anew(folder: Path) -> None:
    from tol3d.statistics.samplers import quick_uniforms as module

    expected = drawn(fresh(module._draw))
    name = module._draw.name
    assert name is not None
    good = read_entry(name)
    assert good is not None
    names = zipfile.ZipFile(io.BytesIO(good)).namelist()
    for payload in (
        b"no archive",
        archive(),
        archive(**dict.fromkeys(names, b"")),
        archive(**dict.fromkeys(names, b"x")),
    ):
        write_entry(name, payload)
        assert np.array_equal(drawn(fresh(module._draw)), expected)
        assert read_entry(name) not in (payload, None)


def test_arrays_that_are_whole_but_none_are_built_anew(folder: Path) -> None:
    gear = SpurGear(20, 1.0, 0.35, 5.0)
    made = []

    def build() -> dict[str, np.ndarray]:
        made.append(1)
        return {"x": np.arange(3.0)}

    solids_cache.cached("strips", gear, {}, build)
    (entry,) = folder.iterdir()
    for payload in (b"PK", b"no archive", b"\x93NUMPY"):
        write_entry(entry.name, payload)
        assert solids_cache.cached("strips", gear, {}, build)["x"].tolist() == [0.0, 1.0, 2.0]
    assert len(made) == 4
    solids_cache.cached("strips", gear, {}, build)
    assert len(made) == 4


def test_a_pipe_in_the_place_of_an_entry_counts_as_none(folder: Path) -> None:
    """And is not waited for: nobody writes into it."""
    write_entry("entry", b"payload")
    (folder / "entry").unlink()
    os.mkfifo(folder / "entry")
    assert read_entry("entry") is None


# several processes ----------------------------------------------------------------------------------------------------

HANGS = 120.0  # s; a guard against waiting for ever, no claim

MAKERS = """
import os, sys, time, pathlib
from tol3d.numerics.cache_folder import read_entry, sole_maker, write_entry
mine, *others = (pathlib.Path(name) for name in sys.argv[1:])
mine.touch()
while not all(other.exists() for other in others):
    time.sleep(0.001)
with sole_maker("entry", 120.0):
    made = read_entry("entry") is None
    if made:
        time.sleep(0.3)
        write_entry("entry", b"made by " + str(os.getpid()).encode())
print(os.getpid() if made else "")
"""

HOLDER = """
import time
from tol3d.numerics.cache_folder import sole_maker
with sole_maker("entry", 120.0):
    print("held", flush=True)
    time.sleep(3600)
"""


@pytest.fixture
def holder(folder: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that makes an entry and does not finish."""
    with subprocess.Popen([sys.executable, "-c", HOLDER], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


def is_held(folder: Path) -> bool:
    try:
        with FileLock(folder / "entry.lock").acquire(timeout=0):
            return False
    except Timeout:
        return True


def started_together(script: str, count: int, tmp_path: Path) -> list[str]:
    """Output of processes that go on when all of them run."""
    marks = [str(tmp_path / f"mark {number}") for number in range(count)]
    commands = [[sys.executable, "-c", script, mark, *marks] for mark in marks]
    runs = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for command in commands]
    return [run.communicate(timeout=300)[0].strip() for run in runs]


def test_of_processes_that_want_an_entry_at_once_one_makes_it(folder: Path, tmp_path: Path) -> None:
    (maker,) = filter(None, started_together(MAKERS, 3, tmp_path))
    assert read_entry("entry") == b"made by " + maker.encode()
    assert [entry.name for entry in folder.iterdir()] == ["entry"]  # no lock is left


def test_a_maker_that_is_killed_is_not_waited_for(folder: Path, holder: subprocess.Popen[str]) -> None:
    assert is_held(folder)
    holder.kill()
    holder.wait(HANGS)
    assert not is_held(folder)
    with sole_maker("entry", HANGS):
        assert is_held(folder)
    assert not any(folder.iterdir())


def test_a_maker_that_takes_too_long_is_not_waited_for_either(folder: Path, holder: subprocess.Popen[str]) -> None:
    made = []
    with sole_maker("entry", 0.2):
        made.append(holder.poll() is None and is_held(folder))
    assert made == [True]
    assert is_held(folder)  # it is still the other's
    with sole_maker("another entry", HANGS):
        assert sorted(path.name for path in folder.iterdir()) == ["another entry.lock", "entry.lock"]


@pytest.mark.parametrize("error", [OSError("no locks here"), NotImplementedError(), RuntimeError("held")])
def test_without_locks_everybody_makes_entries(folder: Path, error: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(lock: FileLock, **settings: float) -> None:
        raise error

    monkeypatch.setattr(FileLock, "acquire", refuse)
    with sole_maker("entry", HANGS):
        write_entry("entry", b"made")
    assert read_entry("entry") == b"made"
    with pytest.raises(KeyError, match="its own"), sole_maker("entry", HANGS):
        raise KeyError("its own")


def test_a_maker_s_own_error_gives_the_lock_back(folder: Path) -> None:
    with pytest.raises(OSError, match="its own"), sole_maker("entry", HANGS):
        raise OSError("its own")
    assert not is_held(folder)


def test_a_kernel_that_another_process_compiled_meanwhile_is_loaded(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from tol3d.statistics.samplers import quick_uniforms as module

    expected = drawn(fresh(module._draw))
    name = module._draw.name
    assert name is not None
    good = read_entry(name)
    assert good is not None
    (folder / name).write_bytes(b"damaged")

    @contextmanager
    def waited_for(name: str, longest_wait: float) -> Iterator[None]:
        write_entry(name, good)
        yield

    monkeypatch.setattr("tol3d.numerics.compiled.sole_maker", waited_for)
    loaded = fresh(module._draw)
    assert np.array_equal(drawn(loaded), expected)
    assert sum(vars(loaded)["_compiled"].stats.cache_hits.values()) == 1


COMPILERS = """
import sys, pathlib, time
from tol3d.statistics.samplers import quick_uniforms as module
mine, *others = (pathlib.Path(name) for name in sys.argv[1:])
mine.touch()
while not all(other.exists() for other in others):
    time.sleep(0.001)
values = module.quick_uniforms(5, "a", "", 0, 40).tobytes().hex()
print(sum(vars(module._draw)["_compiled"].stats.cache_hits.values()), values)
"""


@pytest.mark.slow
def test_processes_that_want_a_kernel_at_once_compile_it_once(folder: Path, tmp_path: Path) -> None:
    expected = uniforms(5, "a", "", 0, 40).tobytes().hex()
    printed = started_together(COMPILERS, 3, tmp_path)
    assert sorted(printed) == [f"0 {expected}", f"1 {expected}", f"1 {expected}"]
    assert [entry.suffix for entry in folder.iterdir()] == [".zip"]
    assert read_entry(next(folder.iterdir()).name)


def test_a_folder_that_cannot_be_written_leaves_kernels_to_this_process(folder: Path) -> None:
    from tol3d.statistics.samplers import quick_uniforms as module

    folder.write_text("a file where the folder should be")
    assert np.array_equal(drawn(fresh(module._draw)), drawn(module._draw))
    assert folder.is_file()


def test_what_is_not_kept_is_refused_while_numba_loads_and_compiled_afterwards() -> None:
    def twice(x: float) -> float:
        return 2.0 * x

    with compiled._numbas_folder(), compiled._loading_only(), pytest.raises(RuntimeError, match=r"^nothing to load$"):
        numba.njit("float64(float64)", cache=True)(twice)
    assert numba.njit("float64(float64)")(twice)(3.5) == 7.0


def test_numba_keeps_nothing_of_its_own(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    assert len(quick_uniforms(1, "a", "", 0, 3)) == 3
    from tol3d.statistics.samplers import quick_uniforms as module

    drawn(fresh(module._draw))
    assert list((tmp_path / "temporary").iterdir()) == []
