"""What must hold of parts at rest: what is said of rocking is said where something may rock."""

from collections.abc import Iterator

from tol3d.assembly.grammar.measures import AssemblyMeasureSpec
from tol3d.assembly.grammar.moves import RestSpec
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]


def idle_rocking(scene: Scene) -> Iterator[Problem]:
    """Measures that say how they are read where a part rocks, of a scene in which none rests."""
    if any(isinstance(move, RestSpec) for move in scene.moves.values()):
        return
    for name, spec in scene.measures.items():
        if isinstance(spec, AssemblyMeasureSpec) and spec.rocking is not None:
            words = f"expected none, for no part of this scene rests on one-sided contacts, got {spec.rocking!r}"
            yield ("measures", name, "rocking"), f"{words}; leave it out, or add a move of kind rest"
