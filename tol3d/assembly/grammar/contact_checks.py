"""Checks of moves by the features that they lay on each other, and of measures that ask for play or rocking."""

from collections.abc import Iterator

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec, OverPlaySpec
from tol3d.assembly.grammar.measures.gap import ContactAngleSpec, SurfaceGapSpec
from tol3d.assembly.grammar.moves import AssemblyMoveSpec
from tol3d.assembly.model.moves import unfit_surfaces
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]


def idle_rocking(scene: Scene) -> Iterator[Problem]:
    """Measures with `rocking` in a scene in which no part rests."""
    if any(move.acts.rocks for move in scene.of(AssemblyMoveSpec).values()):
        return
    for name, spec in scene.measures.items():
        if isinstance(spec, AssemblyMeasureSpec) and spec.rocking is not None:
            words = f"expected none, for no part of this scene rests on one-sided contacts, got {spec.rocking!r}"
            yield ("measures", name, "rocking"), f"{words}; leave it out, or add a move of kind rest"


def idle_over_play(scene: Scene) -> Iterator[Problem]:
    """Measures over the play of parts in a scene without play."""
    if not any(move.acts.has_room for move in scene.of(AssemblyMoveSpec).values()):
        for name, spec in scene.measures.items():
            if isinstance(spec, OverPlaySpec) and spec.over_play is not None:
                words = "expected a move of kind pin_and_hole or pattern, which leaves play, got none; leave it out"
                yield ("measures", name, "over_play"), words


def unfit_moves(scene: Scene) -> Iterator[Problem]:
    """Features that do not fit the moves that name them."""
    drawing = Drawing(scene)
    for name, move in scene.of(AssemblyMoveSpec).items():
        yield from ((("moves", name, *path), words) for path, words in move.problems(drawing))


def unfit_pairs(scene: Scene) -> Iterator[Problem]:
    """Surfaces that have no common normal, of kinds that each may be of."""
    drawing = Drawing(scene)
    for name, spec in scene.measures.items():
        if isinstance(spec, SurfaceGapSpec | ContactAngleSpec):
            uses = list(spec.uses())[:2]
            if all(use.name in drawing.names and drawing.kind(use.name).kind in use.kinds for use in uses):
                shapes = [drawing.kind(use.name).shape for use in uses]
                if words := unfit_surfaces(shapes[0], shapes[1]):
                    yield ("measures", name), words
