"""Versions of packages and the kind of processor, on which the last bits of results depend."""

import importlib.metadata
from collections.abc import Sequence
from functools import cache

from tol3d.errors import RunError
from tol3d.numerics.processor import processor, unlike

VERSIONS_OF = ("tol3d", "numpy", "scipy", "numba", "llvmlite")

Versions = tuple[tuple[str, str], ...]
"""Names with their versions."""


@cache
def installed_versions(requires: Sequence[str] = ()) -> Versions:
    """Versions of tol3d's packages and of those that a system requires besides, and the kind of processor."""
    packages = {name: importlib.metadata.version(name) for name in (*VERSIONS_OF, *requires)}
    return tuple({**packages, **processor()}.items())


@cache
def refuse_other_versions(versions: Versions, requires: Sequence[str] = ()) -> None:
    """Refuse to work on a run whose results might differ in the last bit here.

    Args:
        versions: those of the run.
        requires: packages that its system requires besides.

    Raises:
        RunError: a package has another version here, or the processor is of another kind.
    """
    of_run, installed = dict(versions), dict(installed_versions(requires))
    pairs = {
        name: unlike(installed.get(name), of_run.get(name))
        for name in {**of_run, **installed}
        if installed.get(name) != of_run.get(name)
    }
    if pairs:
        other = "; ".join(f"{name} {present} instead of {wanted}" for name, (present, wanted) in pairs.items())
        raise RunError(
            f"a worker has {other}: results could differ in the last bit; install the same packages there, and start "
            "the run on a machine with the workers' kind of processor"
        )
