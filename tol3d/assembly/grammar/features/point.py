"""A point."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from tol3d.assembly.grammar.features.feature_spec import FaceKind, Found, OneFaceSpec, known, lengths
from tol3d.assembly.grammar.features.nominal_frame import frame
from tol3d.assembly.model import Point
from tol3d.scene.bases import Length
from tol3d.scene.vector import Direction
from tol3d.strict import refused

if TYPE_CHECKING:
    from tol3d.cad.solids.pick import PickedFace


class PointSpec(OneFaceSpec):
    """A point of a surface, or the centre of something."""

    words: ClassVar[str] = "a point"
    face_kinds: ClassVar[tuple[FaceKind, ...]] = ()

    kind: Literal["point"]
    normal: Direction | None = Field(default=None, description="out of the material, of a point of a surface")

    @property
    def shape(self) -> Point:
        return Point()

    @property
    def frame(self) -> NDArray[np.float64]:
        """See FeatureSpec; z along the normal, or the part's z."""
        return frame(self.origin, self.normal or (0.0, 0.0, 1.0))

    @property
    def has_direction(self) -> bool:
        return self.normal is not None

    def found(self, faces: "Sequence[PickedFace]") -> Mapping[str, Found]:
        """See FeatureSpec; the point of the face that is nearest to where the scene has it, and the normal there."""
        (face,) = faces
        return {"at": lengths(*face.nearest), "normal": face.normal}

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if self.face is not None and self.face.name is not None and self.at is None:
            raise refused("at", f"which point of the face {self.face.name!r} is meant", "none")
        return self


class SphereSpec(OneFaceSpec):
    """A ball, or a socket: a point with a size."""

    words: ClassVar[str] = "a sphere"
    face_kinds: ClassVar[tuple[FaceKind, ...]] = ("sphere",)
    numbers: ClassVar[tuple[str, ...]] = ("at", "diameter")

    kind: Literal["sphere"]
    diameter: Length | None = Field(default=None, description="nominal")
    hole: bool = Field(default=False, description="whether it is a socket, not a ball")

    @property
    def shape(self) -> Point:
        return Point(known(self.diameter, "diameter").internal, self.hole)

    @property
    def frame(self) -> NDArray[np.float64]:
        """See FeatureSpec; z is that of the part."""
        return frame(self.origin, (0.0, 0.0, 1.0))

    @property
    def has_direction(self) -> bool:
        return False

    def found(self, faces: "Sequence[PickedFace]") -> Mapping[str, Found]:
        (face,) = faces
        return {"at": lengths(*face.at), "diameter": lengths(2 * face.radius)[0], "hole": face.hole}
