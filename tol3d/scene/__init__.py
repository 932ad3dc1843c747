"""Scene file of the user, read strictly, with the place of everything in it.

`text.py` reads YAML, `load.py` makes a checked `Scene` of it, `schema.py` has its sections, `grammar.py` the kinds that
mechanisms add, `bases.py` what every part, tolerance, move and measure has, `problems.py` the sentences of errors.
`splice.py` writes a value back and leaves the rest as it was. No mechanism is known here. Names are loaded when they
are first used: summaries read the classes of published figures alone. Read `schema.py` first.
"""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.scene.bases import Length, MeasureEntry, MoveSpec, PartSpec, ToleranceSpec
    from tol3d.scene.edit import (
        tolerance_lines,
        with_tolerances,
        write_scene,
    )
    from tol3d.scene.entry import Reference
    from tol3d.scene.grammar import (
        Grammar,
        Kinds,
        Vocabulary,
    )
    from tol3d.scene.load import (
        read_scene,
        scene_from_python,
    )
    from tol3d.scene.name import Name
    from tol3d.scene.nearest import hint
    from tol3d.scene.schema import Scene

_HOMES = {
    "Grammar": "tol3d.scene.grammar",
    "Kinds": "tol3d.scene.grammar",
    "Length": "tol3d.scene.bases",
    "MeasureEntry": "tol3d.scene.bases",
    "MoveSpec": "tol3d.scene.bases",
    "Name": "tol3d.scene.name",
    "PartSpec": "tol3d.scene.bases",
    "Reference": "tol3d.scene.entry",
    "Scene": "tol3d.scene.schema",
    "ToleranceSpec": "tol3d.scene.bases",
    "Vocabulary": "tol3d.scene.grammar",
    "hint": "tol3d.scene.nearest",
    "read_scene": "tol3d.scene.load",
    "scene_from_python": "tol3d.scene.load",
    "tolerance_lines": "tol3d.scene.edit",
    "with_tolerances": "tol3d.scene.edit",
    "write_scene": "tol3d.scene.edit",
}

__all__ = [
    "Grammar",
    "Kinds",
    "Length",
    "MeasureEntry",
    "MoveSpec",
    "Name",
    "PartSpec",
    "Reference",
    "Scene",
    "ToleranceSpec",
    "Vocabulary",
    "hint",
    "read_scene",
    "scene_from_python",
    "tolerance_lines",
    "with_tolerances",
    "write_scene",
]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
