"""Measures of a scene: what is read, over which positions; one sort of measure a file.

Each file of this folder is imported and registers its kinds; so does one from elsewhere, by `measured`.
"""

from importlib import import_module
from pkgutil import iter_modules

from tol3d.gearing.model.measures.lost_motion import lost_motion
from tol3d.gearing.model.measures.measured import measure_of, measured
from tol3d.gearing.model.measures.tip_error import load_changes, over_swing

for _file in iter_modules(__path__):
    import_module(f"{__name__}.{_file.name}")

__all__ = ["load_changes", "lost_motion", "measure_of", "measured", "over_swing"]
