"""Gears in mesh: pairs and trains, planetary sets, RV reducers, and gears in housings.

Pairs and trains, from low to high: `shafts`, `effects`, `links`, `draws`; `grammar` (words of scenes); `model` (what
they mean); `builds` (deviations to poses); `engines` (gaps of flanks); `meshing` (seated meshes); `stack_up` (the
analytic method; sees no build); `play` (backlashes together); `methods`, `slopes`, `system`, `shown`, `presenting`.
On top of them `reducers`, what `planetary` and `cycloid` share, and `machine`, which joins gears with parts of
assemblies. Tooth geometry is not here but in `tol3d.gears`. Public names are loaded when they are first used. Read
`model/model.py` first, then `methods/geometric.py`.
"""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.gearing.grammar.measures import NormalBacklashSpec
    from tol3d.gearing.grammar.moves import BevelMeshSpec
    from tol3d.gearing.grammar.tolerances.gears import ShimSpec
    from tol3d.gearing.mesh_builds import (
        MeshBuild,
        MeshBuilds,
        Rests,
        meshes_of,
    )
    from tol3d.gearing.model.measure import AnyStage
    from tol3d.gearing.shafts import (
        Mesh,
        Train,
    )
    from tol3d.gearing.summary.types import Ends
    from tol3d.gearing.train_play import (
        CLOSED_FORM,
        Played,
        TrainPlay,
        TrainSwing,
        gears_alone,
        shafts_in_bores,
        trains_of,
    )

_HOMES = {
    "CLOSED_FORM": "tol3d.gearing.train_play",
    "AnyStage": "tol3d.gearing.model.measure",
    "BevelMeshSpec": "tol3d.gearing.grammar.moves",
    "Ends": "tol3d.gearing.summary.types",
    "Mesh": "tol3d.gearing.shafts",
    "MeshBuild": "tol3d.gearing.mesh_builds",
    "MeshBuilds": "tol3d.gearing.mesh_builds",
    "NormalBacklashSpec": "tol3d.gearing.grammar.measures",
    "Played": "tol3d.gearing.train_play",
    "Rests": "tol3d.gearing.mesh_builds",
    "ShimSpec": "tol3d.gearing.grammar.tolerances.gears",
    "Train": "tol3d.gearing.shafts",
    "TrainPlay": "tol3d.gearing.train_play",
    "TrainSwing": "tol3d.gearing.train_play",
    "gears_alone": "tol3d.gearing.train_play",
    "meshes_of": "tol3d.gearing.mesh_builds",
    "shafts_in_bores": "tol3d.gearing.train_play",
    "trains_of": "tol3d.gearing.train_play",
}

__all__ = [
    "CLOSED_FORM",
    "AnyStage",
    "BevelMeshSpec",
    "Ends",
    "Mesh",
    "MeshBuild",
    "MeshBuilds",
    "NormalBacklashSpec",
    "Played",
    "Rests",
    "ShimSpec",
    "Train",
    "TrainPlay",
    "TrainSwing",
    "gears_alone",
    "meshes_of",
    "shafts_in_bores",
    "trains_of",
]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
