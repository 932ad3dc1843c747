"""What must hold across the entries of a scene of gears in a housing."""

from collections.abc import Iterator

from tol3d.gearbox.grammar.shaft_in_bores import ShaftInBoresSpec
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
