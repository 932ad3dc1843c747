"""General assemblies: features of parts, datum frames, tolerance zones, moves and measures, in one world."""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.assembly.model.cone_seat import (
        cone_seat,
        unfit_cones,
    )
    from tol3d.assembly.model.feature import Cone

_HOMES = {
    "Cone": "tol3d.assembly.model.feature",
    "cone_seat": "tol3d.assembly.model.cone_seat",
    "unfit_cones": "tol3d.assembly.model.cone_seat",
}

__all__ = [
    "Cone",
    "cone_seat",
    "unfit_cones",
]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
