"""A folder with a file for each module that Python or a package of tol3d could be looking for: none may be run."""

import sys
from importlib.metadata import packages_distributions
from pathlib import Path

MARKER = "what was run"
EVIL = """import posix, sys
descriptor = posix.open({marker!r}, posix.O_WRONLY | posix.O_CREAT | posix.O_APPEND, 0o600)
posix.write(descriptor, (__name__ + " by " + " ".join(sys.orig_argv) + chr(10)).encode())
posix.close(descriptor)
raise SystemExit("a stranger's module was imported")
"""


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
    info = folder / "evil-1.0.dist-info"
    info.mkdir(exist_ok=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: evil\nVersion: 1.0\n", "utf-8")
    (info / "entry_points.txt").write_text("[tol3d.mechanisms]\nevil = evil:EVIL\n", "utf-8")
    return folder


def run_from(folder: Path) -> list[str]:
    """Modules of it that were run since it was made, and by which command."""
    marker = folder / MARKER
    return marker.read_text("utf-8").splitlines() if marker.exists() else []
