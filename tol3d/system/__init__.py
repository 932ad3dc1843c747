"""The seam between a study and the studied system."""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.system.mechanism import Mechanism
    from tol3d.system.starter import (
        starter_lines,
        starter_named,
        starters_of,
    )
    from tol3d.system.system import System
    from tol3d.system.trials import Trials

_HOMES = {
    "Mechanism": "tol3d.system.mechanism",
    "System": "tol3d.system.system",
    "Trials": "tol3d.system.trials",
    "starter_lines": "tol3d.system.starter",
    "starter_named": "tol3d.system.starter",
    "starters_of": "tol3d.system.starter",
}

__all__ = [
    "Mechanism",
    "System",
    "Trials",
    "starter_lines",
    "starter_named",
    "starters_of",
]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
