"""General assemblies: features of parts, datum frames, tolerance zones, moves and measures, in one world.

    model        an assembly, nominal and by its drawings: input of both methods
    grammar      words of scenes: parts, features, tolerances, moves, measures, and their checks
    picking      numbers of features from solids, before all else
    zones        draws of displacements within tolerance zones
    from_scene   scene to model: drawings, effects, frames, features, moves
    placing      the exact method: finite poses, trial by trial
    torsors      the analytic method: small displacements of the nominal geometry; sees no pose
    clearances   least distances of whole parts by FCL
    linkage      closed loops of bodies, placed at once
    presenting   tables, builds and pictures of an assembly

Gears are not known here. Read `model/assembly.py` and `model/moves.py` first, then `placing/plan.py`.
"""

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
