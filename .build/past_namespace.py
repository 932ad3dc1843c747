"""Where `import tol3d` would find a folder without code, such as that of the clone, it finds the installed package.

Written into the environment by an editable install of tol3d. A tol3d with code that lies earlier on the path is left
where it is.
"""

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType

NAME = "tol3d"
INSTALLED = "__editable___tol3d_"  # how setuptools begins the name of the module with an editable install's finder


class PastNamespace:
    """A finder that answers only where the path holds nothing but folders without code."""

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The installed package, or None: whoever is asked next knows better."""
        if fullname != NAME:
            return None
        found = PathFinder.find_spec(fullname, path, target)
        if found is None or found.origin is not None:
            return None
        own = (finder for finder in sys.meta_path if getattr(finder, "__module__", "").startswith(INSTALLED))
        return next((spec for finder in own if (spec := finder.find_spec(fullname, path, target))), None)


sys.meta_path.insert(0, PastNamespace)
