"""Deviation of a mesh's centre distance."""

from typing import Literal

from tol3d.gearing.grammar.tolerances.mesh_tolerance import MeshToleranceSpec


class CentreDistanceSpec(MeshToleranceSpec):
    """f_a, a length: added to the centre distance, positive opens."""

    kind: Literal["centre_distance"]
