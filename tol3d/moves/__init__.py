"""Moves place parts: solvers on the gaps an engine tells."""

from tol3d.moves.mesh import INTERFERES, NO_CONTACT, OK, STATUS_TEXT, Meshing, MeshSeat

__all__ = ["INTERFERES", "NO_CONTACT", "OK", "STATUS_TEXT", "MeshSeat", "Meshing"]
