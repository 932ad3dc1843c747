"""A folder with a file for each module and file of settings that Python or a package of tol3d could be looking for.

No module may be run, no file of settings be opened.
"""

import ctypes
import os
import struct
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.metadata import packages_distributions
from pathlib import Path

MARKER = "what was run"
EVIL = """import posix, sys
descriptor = posix.open({marker!r}, posix.O_WRONLY | posix.O_CREAT | posix.O_APPEND, 0o600)
posix.write(descriptor, (__name__ + " by " + " ".join(sys.orig_argv) + chr(10)).encode())
posix.close(descriptor)
raise SystemExit("a stranger's module was imported")
"""

WRITTEN = "what numba was told to write"
SETTINGS = {
    ".numba_config.yaml": f"dump_html: {WRITTEN}\ncpu_name: generic\n",
    "matplotlibrc": "text.usetex: True\ntext.latex.preamble: \\input{stranger}\n",
    "ezdxf.ini": "no settings\n",  # which stops an import of CadQuery
}
SOUGHT_ELSEWHERE = (
    "XSTEP.us", "SHAPE.us", "STEP", "IGES", "Standard", "Units.dat", "Lexi_Expr.dat", "stranger.tex", "latex",
    "dvipng", "fonts.conf", "dask.yaml", "distributed.yaml", "joblib.ini", ".env", ".pythonrc", ".pdbrc", ".vtkrc",
    ".drirc", ".netrc", "pyproject.toml", "setup.cfg", "tox.ini", "pip.conf", "site.cfg", "pyvenv.cfg",
    "python311.zip", "evil.pth", "numba.yaml", "ipython_config.py", "jupyter_config.py", "pyvista.cfg", "llvm.cfg",
    "libgomp.so.1", "libm.so.6", "style.mplstyle", "tol3d.yaml", "tol3d.toml", ".tol3d.yaml", "conftest.py",
    ".python-version", "click.cfg", "typer.cfg",
)  # fmt: skip
"""Names that Open CASCADE, Python, the dynamic loader and other packages look for in some folder."""
OPENED, A_FOLDER = 0x20, 0x40000000  # of Linux' inotify
EVENT = struct.Struct("iIII")


def hostile(folder: Path, *, but: frozenset[str] = frozenset()) -> Path:
    """Make one: every module writes a line when it is run, and a package offers a mechanism.

    Args:
        folder: it is made here.
        but: modules that are left out.
    """
    folder.mkdir(exist_ok=True)
    text = EVIL.format(marker=str(folder / MARKER))
    names = {*sys.stdlib_module_names, *packages_distributions(), "tol3d", "evil", "sitecustomize", "usercustomize"}
    for name in names - set(sys.builtin_module_names) - but:
        if name.isidentifier():
            (folder / f"{name}.py").write_text(text, "utf-8")
    for package in {"tol3d", "numpy", "joblib", "multiprocessing"} - but:
        (folder / package).mkdir(exist_ok=True)
        (folder / package / "__init__.py").write_text(text, "utf-8")
    for name in {*SETTINGS, *SOUGHT_ELSEWHERE} - but:
        (folder / name).write_text(SETTINGS.get(name, "a stranger's settings\n"), "utf-8")
    info = folder / "evil-1.0.dist-info"
    info.mkdir(exist_ok=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: evil\nVersion: 1.0\n", "utf-8")
    (info / "entry_points.txt").write_text("[tol3d.mechanisms]\nevil = evil:EVIL\n", "utf-8")
    return folder


def run_from(folder: Path) -> list[str]:
    """Modules of it that were run since it was made, and by which command."""
    marker = folder / MARKER
    return marker.read_text("utf-8").splitlines() if marker.exists() else []


@contextmanager
def opened_in(folder: Path) -> Iterator[Callable[[], set[str]]]:
    """Watch a folder: the function gives the names of its files that any process has opened, Python or not."""
    system = ctypes.CDLL(None, use_errno=True)
    descriptor = system.inotify_init1(os.O_NONBLOCK)
    try:
        assert system.inotify_add_watch(descriptor, os.fsencode(folder), OPENED) >= 0, os.strerror(ctypes.get_errno())
        yield lambda: _opened(descriptor)
    finally:
        os.close(descriptor)


def _opened(descriptor: int) -> set[str]:
    names = set()
    with suppress(BlockingIOError):
        while True:
            events = os.read(descriptor, 1 << 16)
            while events:
                _, kind, _, length = EVENT.unpack_from(events)
                name, events = events[EVENT.size : EVENT.size + length], events[EVENT.size + length :]
                if not kind & A_FOLDER:
                    names.add(os.fsdecode(name.rstrip(b"\0")))
    return names
