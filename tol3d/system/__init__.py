"""The seam between a study and the studied system."""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.system.draw import (
        Each,
        Planar,
        Scalar,
    )
    from tol3d.system.mechanism import Mechanism
    from tol3d.system.plain import (
        LengthSpec,
        PlainSystem,
        contributors_of,
        measures_of,
    )
    from tol3d.system.starter import (
        starter_lines,
        starter_named,
        starters_of,
    )
    from tol3d.system.system import System
    from tol3d.system.trials import Trials

_HOMES = {
    "Each": "tol3d.system.draw",
    "LengthSpec": "tol3d.system.plain",
    "Mechanism": "tol3d.system.mechanism",
    "PlainSystem": "tol3d.system.plain",
    "Planar": "tol3d.system.draw",
    "Scalar": "tol3d.system.draw",
    "System": "tol3d.system.system",
    "Trials": "tol3d.system.trials",
    "contributors_of": "tol3d.system.plain",
    "measures_of": "tol3d.system.plain",
    "starter_lines": "tol3d.system.starter",
    "starter_named": "tol3d.system.starter",
    "starters_of": "tol3d.system.starter",
}

__all__ = [
    "Each",
    "LengthSpec",
    "Mechanism",
    "PlainSystem",
    "Planar",
    "Scalar",
    "System",
    "Trials",
    "contributors_of",
    "measures_of",
    "starter_lines",
    "starter_named",
    "starters_of",
]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
