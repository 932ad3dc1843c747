"""What must hold of measures between surfaces."""

from collections.abc import Iterator

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.measures import ContactAngleSpec, SurfaceGapSpec
from tol3d.assembly.model.touch import unfit_surfaces
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]


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
