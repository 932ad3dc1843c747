"""Analyses for decisions of an engineer: questions about any scene, answered by its responses alone.

    tol3d.analyses.what_if("spur_pair", factor={"centre distance": 0.5}).frame()

The functions have the words of their commands; names are loaded when they are first used. A module that computes an
answer stands beside those that show it (`shown_…`) and that a run keeps (`…_section`). No mechanism, solid or command
line is known here: a `Response` gives values of measures for rows of deviations. Read `response.py` first, then
`answers.py`.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tol3d.analyses.answers import allocate, changes, effects, methods, rare, sweep, what_if

__all__ = ["allocate", "changes", "effects", "methods", "rare", "sweep", "what_if"]


def __getattr__(name: str) -> Any:
    if name in __all__:
        return getattr(import_module("tol3d.analyses.answers"), name)
    raise AttributeError(f"module 'tol3d.analyses' has no attribute {name!r}")


def __dir__() -> list[str]:
    """Names that a notebook completes."""
    return [*__all__]
