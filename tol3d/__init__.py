"""tol3d: an open 3D tolerance simulator for gears and robots.

    import tol3d
    run = tol3d.run_scene("spur_pair")
    run.frame()

Names are loaded at their first use, so that `import tol3d` and `tol3d --help` stay quick. docs/python.md shows each of
them in use.
"""

import sys

# `python -m tol3d.…` puts the current folder first on the path, where anybody's numpy.py may lie; it is removed here,
# before tol3d imports anything.
if sys.argv[:1] == ["-m"] and not sys.flags.safe_path:  # argv is so while Python searches for the module to run
    word = sys.orig_argv[-len(sys.argv)]  # the module, or "-mtol3d.cli" in one word
    if (word.partition("m")[2] if word.startswith("-") else word).partition(".")[0] == __name__:
        del sys.path[0]

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from tol3d.current_folder import leave_settings_unread

if TYPE_CHECKING:
    from tol3d.analyses.answers import sweep
    from tol3d.apps.adjustment.answers import find_shims
    from tol3d.errors import InputError as InputError
    from tol3d.errors import RunError as RunError
    from tol3d.errors import SceneError as SceneError
    from tol3d.errors import Tol3dError
    from tol3d.gears import SpurGear as SpurGear
    from tol3d.gears import SpurPair as SpurPair
    from tol3d.kinds import load_scene
    from tol3d.kinds import register as register
    from tol3d.notebook import Replay as Replay
    from tol3d.notebook import (
        check_scene,
        compare_runs,
        export_trial,
        replay,
        response,
        view_trial,
        write_report,
    )
    from tol3d.report.displayed_run import DisplayedRun, open_run
    from tol3d.scene import Scene
    from tol3d.simulate import Overrides, run_scene

    Run = DisplayedRun

leave_settings_unread()

_HOMES = {
    "InputError": "tol3d.errors",
    "Overrides": "tol3d.simulate",
    "Replay": "tol3d.notebook",
    "Run": "tol3d.report.displayed_run:DisplayedRun",
    "RunError": "tol3d.errors",
    "SceneError": "tol3d.errors",
    "SpurGear": "tol3d.gears",
    "SpurPair": "tol3d.gears",
    "Tol3dError": "tol3d.errors",
    "check_scene": "tol3d.notebook",
    "compare_runs": "tol3d.notebook",
    "export_trial": "tol3d.notebook",
    "find_shims": "tol3d.apps.adjustment.answers",
    "load_scene": "tol3d.kinds",
    "open_run": "tol3d.report.displayed_run",
    "register": "tol3d.kinds",
    "replay": "tol3d.notebook",
    "response": "tol3d.notebook",
    "run_scene": "tol3d.simulate",
    "sweep": "tol3d.analyses.answers",
    "view_trial": "tol3d.notebook",
    "write_report": "tol3d.notebook",
}
"""Module of each public name, and after a colon its name there if that differs. Classes that functions return or raise
are for annotations and `except`."""

__all__ = [
    "Overrides",
    "Scene",
    "Tol3dError",
    "check_scene",
    "compare_runs",
    "export_trial",
    "find_shims",
    "load_scene",
    "open_run",
    "replay",
    "response",
    "run_scene",
    "sweep",
    "view_trial",
    "write_report",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return version("tol3d")
    if name == "Scene":  # of all kinds registered so far
        return import_module("tol3d.kinds").all_kinds().scene
    if name in _HOMES:
        module, _, name_there = _HOMES[name].partition(":")
        return getattr(import_module(module), name_there or name)
    raise AttributeError(f"module 'tol3d' has no attribute {name!r}")


def __dir__() -> list[str]:
    """Names that a notebook completes."""
    return sorted({*__all__, "__version__"})
