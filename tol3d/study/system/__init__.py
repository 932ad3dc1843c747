"""The seam between a study and the studied system."""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.study.system.draw import Each, Planar, Scalar
    from tol3d.study.system.mechanism import Mechanism, starter_lines, starter_named, starters_of
    from tol3d.study.system.plain import LengthSpec, PlainSystem, contributors_of, measures_of
    from tol3d.study.system.posable import Posable
    from tol3d.study.system.stated import mean_build, nominal_build
    from tol3d.study.system.system import System
    from tol3d.study.system.trials import Trials

_HOMES = {
    "Each": "tol3d.study.system.draw",
    "LengthSpec": "tol3d.study.system.plain",
    "Mechanism": "tol3d.study.system.mechanism",
    "PlainSystem": "tol3d.study.system.plain",
    "Planar": "tol3d.study.system.draw",
    "Posable": "tol3d.study.system.posable",
    "Scalar": "tol3d.study.system.draw",
    "System": "tol3d.study.system.system",
    "Trials": "tol3d.study.system.trials",
    "contributors_of": "tol3d.study.system.plain",
    "mean_build": "tol3d.study.system.stated",
    "measures_of": "tol3d.study.system.plain",
    "nominal_build": "tol3d.study.system.stated",
    "starter_lines": "tol3d.study.system.mechanism",
    "starter_named": "tol3d.study.system.mechanism",
    "starters_of": "tol3d.study.system.mechanism",
}

__all__ = [
    "Each",
    "LengthSpec",
    "Mechanism",
    "PlainSystem",
    "Planar",
    "Posable",
    "Scalar",
    "System",
    "Trials",
    "contributors_of",
    "mean_build",
    "measures_of",
    "nominal_build",
    "starter_lines",
    "starter_named",
    "starters_of",
]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
