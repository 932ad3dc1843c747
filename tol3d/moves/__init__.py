"""Moves place parts: solvers on the gaps an engine tells."""

from tol3d.moves.mesh import Meshing, MeshSeat

__all__ = ["MeshSeat", "Meshing"]
