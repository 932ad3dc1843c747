"""The solids of a scene's parts: of builders that tol3d brings along, or of a program of the user."""

from pathlib import Path

from tol3d.assembly.grammar.builders.own_file import OwnFileSpec
from tol3d.assembly.grammar.parts import SolidSpec, likes
from tol3d.assembly.picking.kept_picks import kept_in
from tol3d.errors import GeometryError
from tol3d.files import FileContent
from tol3d.scene import Scene
from tol3d.solids.built_shape import BuiltShape
from tol3d.solids.kept_shape import KeptShape, run_program


def shapes_of(scene: Scene) -> dict[str, BuiltShape]:
    """The solids of parts, by their names, of a scene that is settled; parts without one are left out."""
    solids = scene.of(SolidSpec)
    found: dict[str, BuiltShape] = {}
    for name in solids:
        part = likes(name, solids)[-1]
        builder = solids[part].builder
        if isinstance(builder, OwnFileSpec):
            content = scene.files[solid_file(part)].content
            found[name] = KeptShape.of(content, kept_in(scene.files, scene.source).faces.get(part, ()))
        elif builder is not None:
            found[name] = builder.shape
    return found


def built_shape(scene: Scene, part: str, *, run_builders: bool) -> BuiltShape:
    """The solid of a part with a builder; a program of the user is run.

    Raises:
        GeometryError: it must not run, or makes no solid.
    """
    builder = scene.of(SolidSpec)[part].builder
    assert builder is not None
    if not isinstance(builder, OwnFileSpec):
        return builder.shape
    if not run_builders:
        words = f"expected leave to run {builder.file}, which is a program, and got none"
        raise GeometryError(f"{words}; read it, and say --run-builders if you trust it")
    dimensions = {name: own.internal for name, own in builder.dimensions.items()}
    return run_program(scene.files[builder.file], builder.function, {**dimensions, **builder.counts})


def solid_file(part: str) -> str:
    """The name under which a run keeps what a program of the user built."""
    return f"{part}.brep"


def kept_solid(part: str, shape: KeptShape) -> FileContent:
    """What a program of the user built, as a file."""
    return FileContent(Path(solid_file(part)), shape.brep)
