"""The solid of a product of a foreign STEP file as mechanisms show and export it."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids.built_shape import MeshedShape
from tol3d.cad.step.face_mesh import FaceMesh
from tol3d.cad.step.reading import StepPart, read_step
from tol3d.files import FileContent


@dataclass(frozen=True)
class StepShape(MeshedShape):
    """A product by its file.

    Args:
        sha256: of the file.
        product: its name; None if the file has one only, or if a use states it.
        use: a part as it stands in the file.
        file: the file.
    """

    builder: ClassVar[str] = "tol3d.cad.step.step_cad:solid_of"

    sha256: str
    product: str | None
    use: str | None
    file: FileContent = field(repr=False, compare=False)

    @classmethod
    def of(cls, file: FileContent, product: str | None, use: str | None) -> "StepShape":
        """A product of a file."""
        return cls(file.sha256, product, use, file)

    def mesh(self, deflection: float) -> Mapping[str, NDArray[np.generic]]:
        """See MeshedShape; the solids without the loose faces beside them."""
        mesh = self._shown(deflection)[1]
        return {
            "vertices": mesh.vertices,
            "triangles": mesh.triangles,
            "side": np.zeros(len(mesh.vertices), dtype=np.int8),
            "chord_error": np.array(mesh.chord_error),
        }

    def colours(self, deflection: float) -> Sequence[str]:
        """See MeshedShape; most faces of a part have one colour in its file, which is that of the part."""
        part, mesh = self._shown(deflection)
        counted = Counter(part.colours.get(face, "") for face in sorted(part.body.faces))
        ((usual, _),) = counted.most_common(1) or (("", 0),)
        own = {face: colour for face, colour in part.colours.items() if colour != usual}
        return [own.get(face, "") for face in mesh.faces.tolist()]

    def open_faces(self) -> Sequence[str]:
        """See BuiltShape."""
        part = read_step(self.file).part(self.product, self.use)
        return [f"#{face}" for face in sorted({*part.unread, *part.bare} & part.body.faces)]

    def _shown(self, deflection: float) -> tuple[StepPart, FaceMesh]:
        """The part, and the triangles of its solids without the loose faces beside them."""
        part = read_step(self.file).part(self.product, self.use)
        mesh = part.mesh(deflection)
        return part, mesh.of_faces(part.body.faces) if part.body.faces else mesh
