"""First-order terms of effects, one effect a file, worked out without the geometric road.

Each file of this folder is imported and registers its effect; so does one from elsewhere, by `contributes`.
"""

from importlib import import_module
from pkgutil import iter_modules

from tol3d.gearing.stack_up.terms.contribution import NOTHING, Contribution, contributes, contribution

for _file in iter_modules(__path__):
    import_module(f"{__name__}.{_file.name}")

__all__ = ["NOTHING", "Contribution", "contributes", "contribution"]
