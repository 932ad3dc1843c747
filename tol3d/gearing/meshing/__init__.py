"""Moves place parts: solvers on the gaps that an engine measures."""

from tol3d.gearing.meshing.mesh import Meshing, MeshSeat

__all__ = ["MeshSeat", "Meshing"]
