"""Spheres: balls and sockets."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tol3d.assembly.grammar.features.face import FaceKind
from tol3d.assembly.grammar.features.feature_spec import Found, OneFaceSpec, known, lengths
from tol3d.assembly.grammar.features.nominal_frame import frame
from tol3d.assembly.model import Point
from tol3d.scene.part import Length

if TYPE_CHECKING:
    from tol3d.solids.pick import PickedFace


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
        """See FeatureSpec."""
        return Point(known(self.diameter, "diameter").internal, self.hole)

    @property
    def frame(self) -> NDArray[np.float64]:
        """See FeatureSpec; z is that of the part."""
        return frame(self.origin, (0.0, 0.0, 1.0))

    def found(self, faces: "Sequence[PickedFace]") -> Mapping[str, Found]:
        """See FeatureSpec."""
        (face,) = faces
        return {"at": lengths(*face.at), "diameter": lengths(2 * face.radius)[0], "hole": face.hole}
