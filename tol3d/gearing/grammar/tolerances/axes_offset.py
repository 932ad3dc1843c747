"""Offset of the axes of a bevel mesh."""

from typing import ClassVar, Literal

from tol3d.gearing.grammar.moves import BevelMeshSpec
from tol3d.gearing.grammar.tolerances.mesh_tolerance import MeshToleranceSpec
from tol3d.scene.entry import Entry


class AxesOffsetSpec(MeshToleranceSpec):
    """f_a, a length: the axes pass each other by it; the driven one lies at +y of the mesh's world."""

    applies_to: ClassVar[tuple[type[Entry], ...]] = (BevelMeshSpec,)

    kind: Literal["axes_offset"]
