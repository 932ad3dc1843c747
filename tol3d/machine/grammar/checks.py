"""What must hold across the entries of a scene of gears in a housing, and what is most likely a slip."""

from collections.abc import Iterator

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.moves import PlacingSpec
from tol3d.assembly.model.shape import nominal_size
from tol3d.gearing.grammar.checks import too_thick
from tol3d.gearing.grammar.parts import ShaftSpec
from tol3d.machine.grammar.shaft_in_bores import ShaftInBoresSpec
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]


def laid_twice(scene: Scene) -> Iterator[Problem]:
    """Shafts that lie in two places, bores with two shafts, and one bore named for both ends."""
    shafts: dict[str, str] = {}
    bores: dict[str, str] = {}
    for name, move in scene.of(ShaftInBoresSpec).items():
        if before := shafts.get(move.shaft):
            words = f"expected a shaft that lies in no bores yet, got {move.shaft!r}, which {before!r} lays"
            yield ("moves", name, "shaft"), words
        shafts.setdefault(move.shaft, name)
        for k, bore in enumerate(move.in_):
            if bore in move.in_[:k]:
                yield ("moves", name, "in", k), f"expected another bore than the first, got {bore!r} twice"
            elif other := bores.get(bore):
                words = f"expected a bore without a shaft, got {bore!r}, in which {other!r} lays one"
                yield ("moves", name, "in", k), words
            bores.setdefault(bore, name)


def laid_too_early(scene: Scene) -> Iterator[Problem]:
    """Shafts in bores of parts that a later move places; each part is said once."""
    order = list(scene.moves)
    placing = {move.part: name for name, move in reversed(list(scene.moves.items())) if isinstance(move, PlacingSpec)}
    for name, move in scene.of(ShaftInBoresSpec).items():
        for k, bore in enumerate(move.in_):
            by = placing.get(part_of(bore), name)
            if order.index(by) > order.index(name):
                del placing[part_of(bore)]
                words = f"expected a bore of a part that is placed already, got {bore!r}"
                yield ("moves", name, "in", k), f"{words}; put the move {by!r}, which places it, before this one"


def shafts_thicker_than_bores(scene: Scene) -> Iterator[Problem]:
    """Shafts that do not go into a bore that holds them."""
    drawing = Drawing(scene)
    for move in scene.of(ShaftInBoresSpec).values():
        shaft = scene.parts[move.shaft]
        if not isinstance(shaft, ShaftSpec):
            continue
        for bore in move.in_:
            if sentence := too_thick(shaft, nominal_size(drawing.kind(bore).shape), repr(bore)):
                yield ("parts", move.shaft, "diameter"), sentence
