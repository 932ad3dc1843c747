"""Solids of foreign STEP files as CadQuery has them, for the process that exports them: see written_apart."""

from pathlib import Path
from tempfile import TemporaryDirectory

import cadquery as cq

from tol3d.cad.step.part21 import read_part21
from tol3d.cad.step.reading import read_step
from tol3d.cad.step.step_shape import StepShape
from tol3d.cad.step.worker import Transferred, UnreadError
from tol3d.errors import GeometryError
from tol3d.parts.named_solid import NamedSolid


def solid_of(shape: StepShape) -> NamedSolid:
    """The solid of a product; of several, all of them as one.

    Raises:
        GeometryError: it cannot be read, or is none.
    """
    text = read_part21(shape.file.content, shape.file.path.name)
    body = read_step(shape.file).part(shape.product, shape.use).body
    with TemporaryDirectory(prefix="tol3d-step-") as name:
        path = Path(name) / "file.stp"
        path.write_bytes(shape.file.content)
        try:
            found = Transferred(path, list(text.spans), list(body.solids.items())).solids(set(body.solids))
        except UnreadError as error:
            raise GeometryError(f"{text.name}: {error}") from None
    solids = [cq.Shape.cast(own) for own in found]
    if not solids:
        raise GeometryError(f"{text.name}: {body.name!r} has no solid")
    whole = solids[0] if len(solids) == 1 else cq.Compound.makeCompound(solids)
    return NamedSolid(whole, {f"face {k}": face for k, face in enumerate(whole.Faces(), 1)})
