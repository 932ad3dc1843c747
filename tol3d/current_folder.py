"""Keeps libraries from reading files of the current folder that the user has not named.

matplotlib, numba and ezdxf (a package of CadQuery) look there for a file of settings as they are imported, numba again
at each compilation, and Open CASCADE for its messages. A stranger's file could have numba overwrite files and
matplotlib start LaTeX with commands of its own. Settings in the environment and in the user's own configuration folders
are the user's, and hold. So does all that a library has read if it was imported before tol3d.
"""

import builtins
import errno
import os
import os.path
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from types import ModuleType
from typing import Any, Final

NUMBAS: Final = "numba.core.config"
SETTINGS: Final = {"matplotlib": "matplotlibrc", NUMBAS: ".numba_config.yaml", "ezdxf._options": "ezdxf.ini"}
"""File of the current folder that a module reads as it is imported."""
OPEN_CASCADE: Final = "OCP"
MESSAGES: Final = ("CSF_XSMessage", "CSF_SHMessage")
"""Folders of Open CASCADE's messages; without them it looks in the current folder, and then has texts of its own."""


def leave_settings_unread() -> None:
    """Have libraries that are imported from now on find no settings in the current folder."""
    sys.meta_path.insert(0, _Finder())


class _Finder:
    """Finds modules as before; those that read settings run where these are hidden."""

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> Any:
        """See importlib.abc.MetaPathFinder."""
        if name == OPEN_CASCADE:
            for variable in MESSAGES:
                os.environ.setdefault(variable, os.devnull)
        if name not in SETTINGS:
            return None
        others = (finder for finder in sys.meta_path if finder is not self)
        spec: Any = next(filter(None, (finder.find_spec(name, path, target) for finder in others)), None)
        if spec is not None and spec.loader is not None:
            spec.loader.exec_module = partial(_execute, spec.loader.exec_module)
        return spec


def _execute(as_before: Any, module: Any) -> None:
    with _hidden_settings():
        as_before(module)
    if module.__name__ == NUMBAS:
        module._config_fname = os.devnull  # numba looks for it again at each compilation


_hiding = 0  # modules that are being imported
_counting = threading.Lock()
_exists: Any = os.path.exists
_open: Any = builtins.open


@contextmanager
def _hidden_settings() -> Iterator[None]:
    """Within it a file of settings in the current folder is not found; any other file is, by other threads too."""
    global _hiding, _exists, _open
    with _counting:
        if not _hiding:
            _exists, _open = os.path.exists, builtins.open
            os.path.exists, builtins.open = _found, _opened
        _hiding += 1
    try:
        yield
    finally:
        with _counting:
            _hiding -= 1
            if not _hiding:
                os.path.exists, builtins.open = _exists, _open


def _found(path: Any) -> bool:
    return not _is_hidden(path) and bool(_exists(path))


def _opened(file: Any, *arguments: Any, **keywords: Any) -> Any:
    if _is_hidden(file):
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), file)
    return _open(file, *arguments, **keywords)


def _is_hidden(path: Any) -> bool:
    return isinstance(path, str | os.PathLike) and os.fspath(path) in SETTINGS.values()
