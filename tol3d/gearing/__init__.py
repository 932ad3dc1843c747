"""Gears in mesh and their trains: builds, contact, measures, and the stack-up.

Public names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.gearing.mesh_builds import MeshBuild, MeshBuilds, Rests, meshes_of
    from tol3d.gearing.shafts import Mesh

_HOMES = {
    "Mesh": "tol3d.gearing.shafts",
    "MeshBuild": "tol3d.gearing.mesh_builds",
    "MeshBuilds": "tol3d.gearing.mesh_builds",
    "Rests": "tol3d.gearing.mesh_builds",
    "meshes_of": "tol3d.gearing.mesh_builds",
}

__all__ = ["Mesh", "MeshBuild", "MeshBuilds", "Rests", "meshes_of"]

__getattr__ = lazy_names(__name__, _HOMES)
