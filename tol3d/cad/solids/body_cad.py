"""Data read off the solid of a shaft or an arm: the triangulations of all its faces."""

import cadquery as cq
import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
from OCP.gp import gp_Pnt

from tol3d.cad.solids.lazy import Arrays
from tol3d.cad.solids.triangulation import SAGITTA_MARGIN, edge_sagittas, triangulated
from tol3d.numerics.arrays import Array
from tol3d.parts.named_solid import NamedSolid

LOOKED_AT = np.array([(1, 1, 0), (0, 1, 1), (1, 0, 1), (1, 1, 1)])
"""Weights of a triangle's corners where its distance to the face is taken: middles of edges, and its own."""

SAME_PLACE = 1e-6  # mm; far below what a display mesh is off


def tessellate(part: NamedSolid, deflection: float) -> Arrays:
    """OCC's triangulations of all faces, joined along the edges that they share."""
    whole = triangulated(part, deflection)
    distances = (
        _distance(part.faces[name], whole.vertices[whole.triangles[numbers]]) for name, numbers in whole.of_face.items()
    )
    return {
        "vertices": whole.vertices,
        "triangles": whole.triangles,
        "side": np.zeros(len(whole.vertices), dtype=np.int8),
        "chord_error": np.array(max(*distances, 0.0, *edge_sagittas(part))),
    }


def _in_one_section(face: cq.Face, places: Array) -> Array:
    """Places (n, 3) turned about the axis of a turned face into one half-plane, where many of them are one.

    Each is as far from the face as before; of a spline that was turned, OCC takes a millisecond for each distance.
    """
    axis = BRepAdaptor_Surface(face.wrapped).AxeOfRevolution()
    z = np.array([axis.Direction().X(), axis.Direction().Y(), axis.Direction().Z()])
    origin = np.array([axis.Location().X(), axis.Location().Y(), axis.Location().Z()])
    x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
    along = (places - origin) @ z
    around = np.linalg.norm(places - origin - along[:, None] * z, axis=1)
    kept = np.unique(np.round(np.stack([along, around], axis=1) / SAME_PLACE), axis=0) * SAME_PLACE
    return np.asarray(origin + kept[:, :1] * z + kept[:, 1:] * x / np.linalg.norm(x))


def _distance(face: cq.Face, corners: Array) -> float:
    """Largest distance [mm] between triangles (n, 3, 3) and their face, at the middles of triangles and edges."""
    if face.geomType() == "PLANE":
        return 0.0
    weights = LOOKED_AT / LOOKED_AT.sum(axis=1, keepdims=True)
    places = np.unique(np.einsum("wc,tcx->twx", weights, corners).reshape(-1, 3), axis=0)
    if face.geomType() == "REVOLUTION":
        places = _in_one_section(face, places)
    found = GeomAPI_ProjectPointOnSurf(gp_Pnt(*places[0]), BRep_Tool.Surface_s(face.wrapped))
    distances = []
    for place in places.tolist():
        found.Perform(gp_Pnt(*place))
        distances.append(found.LowerDistance())
    return float(max(distances)) * SAGITTA_MARGIN
