"""Import paths `package.module:name`, by which light modules name code that is loaded on demand."""

import re
import sys
from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

DEFINED: Final = re.compile(r"^(?:def|class) (\w+)|^([A-Z_]+)\b.*=", re.MULTILINE)


REGISTRY: Final = "tol3d.kinds"
"""The registry of mechanisms: the one room above that those below load by its name, so that they import none."""
GROUP: Final = "tol3d.mechanisms"
"""Entry points by which packages offer mechanisms."""


def named(path: str) -> Any:
    """Object that an import path names.

    >>> named("math:hypot")(3.0, 4.0)
    5.0
    """
    module, _, name = path.partition(":")
    return getattr(import_module(module), name)


def lazy_names(package: str, homes: Mapping[str, str]) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` of a package whose public names are loaded when they are first used.

    Args:
        package: its name.
        homes: module of each name.
    """

    def loaded(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(homes[name]), name)

    def names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *homes})

    return loaded, names


def is_named(path: str) -> bool:
    """True if an import path names something; where the module's source tells, it is not loaded.

    >>> is_named("tol3d.errors:InputError"), is_named("tol3d.errors:Forgotten"), is_named("forgotten:it"), is_named("")
    (True, False, False, False)
    """
    module, _, name = path.partition(":")
    if not module or not name:
        return False
    try:
        return (module not in sys.modules and name in _defined(module)) or hasattr(import_module(module), name)
    except ModuleNotFoundError:
        return False


@cache
def _defined(module: str) -> frozenset[str]:
    """Names that the source of a module defines at its top; without it, none."""
    source = _source(module)
    return frozenset(name for names in DEFINED.findall(source) for name in names if name)


def _source(module: str) -> str:
    """The source of a module: only its outermost package is loaded, as packages in between may load much."""
    outermost, *inner = module.split(".")
    spec = find_spec(outermost)
    if spec is None or not inner:
        source: str | None = getattr(spec and spec.loader, "get_source", lambda _: None)(module)
        return source or ""
    for folder in spec.submodule_search_locations or ():
        own = Path(folder, *inner)
        for file in (own.with_suffix(".py"), own / "__init__.py"):
            if file.is_file():
                return file.read_text("utf-8")
    return ""
