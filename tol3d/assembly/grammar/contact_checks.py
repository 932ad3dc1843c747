"""What must hold of contacts of points on planes: a round feature is no point."""

from collections.abc import Iterator

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.features import CylinderSpec, FeatureUnion, PlaneSpec, SphereSpec
from tol3d.assembly.grammar.moves import LocatingSpec, RestSpec
from tol3d.assembly.grammar.moves.locating import ContactSpec
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]


def round_contacts(scene: Scene) -> Iterator[Problem]:
    """Round features on planes, of which 3-2-1, six planes and a rest would lay the middle, not the surface."""
    drawing = Drawing(scene)
    for name, move in scene.moves.items():
        if isinstance(move, LocatingSpec):
            for path, pair in move.pairs_by_name.values():
                if words := _round(pair, drawing, rests=isinstance(move, RestSpec)):
                    yield ("moves", name, *path, words[0]), words[1]


def _round(pair: ContactSpec, drawing: Drawing, *, rests: bool) -> tuple[str, str] | None:
    """The key of a round feature that does not fit, and what is said of it."""
    if not {pair.from_, pair.to} <= set(drawing.names):
        return None
    sides = {"from": (pair.from_, pair.to), "to": (pair.to, pair.from_)}
    for key, (own, other) in sides.items():
        feature = drawing.kind(own)
        if isinstance(feature, SphereSpec | CylinderSpec) and (rests or _is_face(drawing.kind(other))):
            words = f"expected a point or a plane, got {own!r}, which is {feature.words}: its middle would lie there"
            touched = "name the point of its surface that touches"
            remedy = (
                f"{touched}, for a rest has no round contacts" if rests else f"take a move of kind touch, or {touched}"
            )
            return key, f"{words}; {remedy}"
    return None


def _is_face(feature: FeatureUnion) -> bool:
    return isinstance(feature, PlaneSpec)
