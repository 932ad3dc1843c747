"""Named solids cut and joined: every face that is left keeps its name, by the operation's own history."""

from collections.abc import Iterator, Sequence

import cadquery as cq
from OCP.BRepAlgoAPI import BRepAlgoAPI_BooleanOperation, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.TopTools import TopTools_ListOfShape

from tol3d.errors import GeometryError
from tol3d.parts.named_solid import NamedSolid


def cut(base: NamedSolid, tools: Sequence[NamedSolid], words: str) -> NamedSolid:
    """The base without the tools.

    Args:
        base, tools: whose faces keep their names.
        words: what is made, for the message.

    Raises:
        GeometryError: no one valid solid is left, or two faces have one name.
    """
    return _combined(BRepAlgoAPI_Cut(), base, tools, words) if tools else base


def fused(base: NamedSolid, others: Sequence[NamedSolid], words: str) -> NamedSolid:
    """The base and the others as one; a face that two of them share is the first's. Arguments and errors as `cut`."""
    return _combined(BRepAlgoAPI_Fuse(), base, others, words) if others else base


def _combined(
    operation: BRepAlgoAPI_BooleanOperation, base: NamedSolid, tools: Sequence[NamedSolid], words: str
) -> NamedSolid:
    operation.SetArguments(_shapes([base]))
    operation.SetTools(_shapes(tools))
    operation.Build()
    solids = cq.Shape.cast(operation.Shape()).Solids()
    if len(solids) != 1 or not solids[0].isValid():
        raise GeometryError(f"{words} is not one valid solid")
    faces: dict[str, cq.Face] = {}
    for name, face in _left_faces(operation, (base, *tools), solids[0]):
        if name in faces:
            raise GeometryError(f"two faces of {words} are called {name!r}; give one another name")
        faces[name] = face
    return NamedSolid(solids[0], faces)


def _shapes(pieces: Sequence[NamedSolid]) -> TopTools_ListOfShape:
    listed = TopTools_ListOfShape()
    for piece in pieces:
        listed.Append(piece.solid.wrapped)
    return listed


def _left_faces(
    operation: BRepAlgoAPI_BooleanOperation, pieces: Sequence[NamedSolid], solid: cq.Solid
) -> Iterator[tuple[str, cq.Face]]:
    """Faces that are left by name; those of one that fell into pieces are "NAME", "NAME piece 2" and so on."""
    outward = {face: face for face in solid.Faces()}
    for piece in pieces:
        for name, face in piece.faces.items():
            images = [cq.Face(image) for image in operation.Modified(face.wrapped)] or [face]
            left = [outward.pop(image) for image in images if image in outward]
            for number, image in enumerate(left, start=1):
                yield (name if number == 1 else f"{name} piece {number}"), image
