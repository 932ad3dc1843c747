"""What must hold across the entries of a scene of gears."""

from collections.abc import Iterator

from tol3d.gearing.grammar.parts import carried
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath


def carried_again(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Gears that a shaft above carries too."""
    first: dict[str, str] = {}
    for shaft, gear in carried(scene.parts):
        if (other := first.setdefault(gear, shaft)) != shaft:
            path: KeyPath = ("parts", shaft, "carries", gear)
            yield path, f"expected a gear that no other shaft carries, got {gear!r}, which {other!r} carries"
