"""Sources of modules and of all modules of this package that they import, which decide their results."""

import ast
import importlib.util
import re
from collections.abc import Iterator, Mapping
from functools import cache

PACKAGE = __name__.partition(".")[0]
WORD = re.compile(r"\bimport\b")
STATEMENT = re.compile(
    r"^[ \t]*((?:from[ \t]+[\w.]+[ \t]+import[ \t]+(?:\((?:[^)#]|#.*)*\)|[\w., \t*]+)|import[ \t]+[\w., \t]+))"
    r"[ \t]*(?:#.*)?$",
    re.MULTILINE,
)
"""An import statement that stands alone in its lines."""


def sources_of(*modules: str) -> Mapping[str, str]:
    """Texts of some modules and of those of this package or their own that they import, directly or not, by name.

    Import statements count wherever they stand; what is imported by a name made up while running is not seen. Packages
    count where they are imported from: not as parents of a module.

    Raises:
        OSError: one has no source.
    """
    found: dict[str, str] = {}
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = source(name)
            waiting += _imports(name, found[name])
    return dict(sorted(found.items()))


@cache
def source(module: str) -> str:
    """Text of a module."""
    spec = importlib.util.find_spec(module)
    text = getattr(spec.loader, "get_source", lambda name: None)(module) if spec else None
    if text is None:
        raise OSError(f"{module}: no source")
    return str(text)


@cache
def _imports(module: str, text: str) -> tuple[str, ...]:
    """Modules of this package, or of the module's own, that a module names in its imports."""
    own = {PACKAGE, module.partition(".")[0]}
    try:
        statements = ast.parse(_import_statements(text))
    except SyntaxError:  # words between quotes
        statements = ast.parse(text)
    named = _named(module, statements)
    return tuple(name for name in named if name.partition(".")[0] in own)


def _import_statements(text: str) -> str:
    r"""The import statements of a module alone, which take a tenth of the time to parse; all of it where one may hide.

    A line between quotes that reads as an import counts as one.

    >>> _import_statements("from a import (\n    b,\n)\nif b:\n    import c  # late\n")
    'from a import (\n    b,\n)\nimport c\n'
    """
    found = list(STATEMENT.finditer(text))
    hidden = len(WORD.findall(text)) - sum(len(WORD.findall(match[0])) for match in found)
    return text if hidden else "".join(f"{match[1].rstrip()}\n" for match in found)


def _named(module: str, tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            origin = _origin(module, node)
            yield origin
            if origin.partition(".")[0] in (PACKAGE, module.partition(".")[0]) and _is_package(origin):
                yield from (name for alias in node.names if _is_module(name := f"{origin}.{alias.name}"))


def _origin(module: str, node: ast.ImportFrom) -> str:
    """Module of an import, without leading dots."""
    stated = "." * node.level + (node.module or "")
    return importlib.util.resolve_name(stated, module if _is_package(module) else module.rpartition(".")[0])


@cache
def _is_package(module: str) -> bool:
    spec = importlib.util.find_spec(module)
    return spec is not None and spec.submodule_search_locations is not None


@cache
def _is_module(name: str) -> bool:
    return importlib.util.find_spec(name) is not None
