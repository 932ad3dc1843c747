"""What effects do to the gears in their meshes, one effect a file: read by builds, their rates and compiled builds.

Each file of this folder is imported and registers its effect; so does one from elsewhere, by the same decorator.
"""

from importlib import import_module
from pkgutil import iter_modules

from tol3d.gearing.displacements.displacement import (
    AnyDisplacement,
    Displacement,
    FlankOffsets,
    Growth,
    PivotShift,
    displacements,
)

for _file in iter_modules(__path__):
    import_module(f"{__name__}.{_file.name}")

__all__ = ["AnyDisplacement", "Displacement", "FlankOffsets", "Growth", "PivotShift", "displacements"]
