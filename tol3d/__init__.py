"""tol3d: an open 3D tolerance simulator for gears and robots.

    import tol3d
    run = tol3d.run_scene("scenes/spur_pair.yaml")
    run.columns("geometric:normal backlash")

Names are loaded when they are first used, so that `tol3d --help` stays quick.
"""

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tol3d.errors import InputError, RunError, SceneError, Tol3dError
    from tol3d.gears import SpurGear, SpurPair
    from tol3d.result import Run, open_run
    from tol3d.scene import Scene, load_scene
    from tol3d.simulate import Overrides, Replay, replay, run_scene

_HOMES = {
    "InputError": "tol3d.errors",
    "Overrides": "tol3d.simulate",
    "Replay": "tol3d.simulate",
    "Run": "tol3d.result",
    "RunError": "tol3d.errors",
    "Scene": "tol3d.scene",
    "SceneError": "tol3d.errors",
    "SpurGear": "tol3d.gears",
    "SpurPair": "tol3d.gears",
    "Tol3dError": "tol3d.errors",
    "load_scene": "tol3d.scene",
    "open_run": "tol3d.result",
    "replay": "tol3d.simulate",
    "run_scene": "tol3d.simulate",
}

__all__ = [
    "InputError",
    "Overrides",
    "Replay",
    "Run",
    "RunError",
    "Scene",
    "SceneError",
    "SpurGear",
    "SpurPair",
    "Tol3dError",
    "load_scene",
    "open_run",
    "replay",
    "run_scene",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return version("tol3d")
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'tol3d' has no attribute {name!r}")
