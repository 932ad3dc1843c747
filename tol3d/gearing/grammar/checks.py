"""What must hold across the entries of a scene of gears."""

from collections.abc import Iterator

from tol3d.gearing.grammar.parts import carried
from tol3d.gearing.grammar.tolerances.profile_form import ProfileFormSpec
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath


def carried_again(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Gears that a shaft above carries too."""
    first: dict[str, str] = {}
    for shaft, gear in carried(scene.parts):
        if (other := first.setdefault(gear, shaft)) != shaft:
            path: KeyPath = ("parts", shaft, "carries", gear)
            yield path, f"expected a gear that no other shaft carries, got {gear!r}, which {other!r} carries"


def forms_of_two_shapes(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """Gears whose profile forms have two shapes."""
    first: dict[str, tuple[str, ProfileFormSpec]] = {}
    for name, spec in scene.tolerances.items():
        if not isinstance(spec, ProfileFormSpec):
            continue
        other, known = first.setdefault(spec.of, (str(name), spec))
        if spec.waves != known.waves:
            yield ("tolerances", str(name), "shape"), f"expected the shape of {other!r}, the form of {spec.of!r} too"
