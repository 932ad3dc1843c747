"""The housing that holds the axes of a mesh apart."""

from typing import ClassVar, Literal

from tol3d.scene.part import GrowingSpec


class HousingSpec(GrowingSpec):
    """A housing: its expansion changes the centre distance of the meshes that name it."""

    words: ClassVar[str] = "a housing"

    kind: Literal["housing"]
