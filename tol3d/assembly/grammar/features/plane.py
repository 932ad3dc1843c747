"""A flat face."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from tol3d.assembly.grammar.features.face import FaceKind
from tol3d.assembly.grammar.features.feature_spec import Found, OneFaceSpec, known, lengths
from tol3d.assembly.grammar.features.nominal_frame import frame, is_across
from tol3d.assembly.model import Plane, RoundPlane
from tol3d.scene.listed import listed
from tol3d.scene.part import Length
from tol3d.scene.vector import Direction
from tol3d.strict import refused

if TYPE_CHECKING:
    from tol3d.solids.pick import PickedFace


class PlaneSpec(OneFaceSpec):
    """A flat face, rectangular or round."""

    words: ClassVar[str] = "a plane"
    face_kinds: ClassVar[tuple[FaceKind, ...]] = ("plane",)
    numbers: ClassVar[tuple[str, ...]] = ("at", "normal")

    kind: Literal["plane"]
    normal: Direction | None = Field(default=None, description="out of the material")
    extent: Annotated[tuple[Length, Length], listed("lengths", 2, 2)] | None = Field(
        default=None, description="along x and y of the face"
    )
    radius: Length | None = Field(default=None, description="of a round face")
    along: Direction | None = Field(default=None, description="x of the face; the part's x (or y) if not given")

    @property
    def shape(self) -> Plane | RoundPlane:
        """See FeatureSpec."""
        if self.extent is not None:
            return Plane((self.extent[0].internal, self.extent[1].internal))
        if self.radius is None:
            raise ValueError("a plane has an extent or a radius")
        return RoundPlane(self.radius.internal)

    @property
    def frame(self) -> NDArray[np.float64]:
        """See FeatureSpec."""
        return frame(self.origin, known(self.normal, "normal"), self.along)

    @property
    def x_picked(self) -> Direction | None:
        """See FeatureSpec."""
        return self.along

    def found(self, faces: "Sequence[PickedFace]") -> Mapping[str, Found]:
        """See FeatureSpec; the rectangle around the face, or its circle."""
        (face,) = faces
        own: dict[str, Found] = {"at": lengths(*face.at), "normal": face.direction}
        if face.radius and self.extent is None:
            return {**own, "radius": lengths(face.radius)[0]}
        return {**own, "extent": lengths(*face.extent)}

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        several = self.extent is not None and self.radius is not None
        if several or (self.extent is None and self.radius is None and self.face is None):
            got = "both" if several else "neither"
            raise refused("extent", "either an extent such as [100 mm, 60 mm] or a radius", got)
        if self.along is not None and self.normal is not None and not is_across(self.along, self.normal):
            raise refused("along", "a direction across the normal", list(self.along))
        return self
