"""Moves place parts: solvers on the gaps an engine tells."""

from tol3d.gearing.meshing.mesh import Meshing, MeshSeat

__all__ = ["MeshSeat", "Meshing"]
