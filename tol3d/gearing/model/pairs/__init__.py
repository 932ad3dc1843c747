"""Moves to pairs of gears: the geometry of each kind of mesh, or why it cannot be made; one kind of pair a file.

Each file of this folder is imported and registers its kinds; so does one from elsewhere, by `pair_of`.
"""

from importlib import import_module
from pkgutil import iter_modules

from tol3d.gearing.model.pairs.pair import assembly_warning, internal, pair_of, undercut_warning

for _file in iter_modules(__path__):
    import_module(f"{__name__}.{_file.name}")

__all__ = ["assembly_warning", "internal", "pair_of", "undercut_warning"]
