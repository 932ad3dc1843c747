"""Versions of packages, and the kind of processor, which decide a result's last bit."""

import importlib.metadata
from collections.abc import Sequence
from functools import cache

from tol3d.errors import RunError
from tol3d.numerics.processor import processor, unlike

VERSIONS_OF = ("tol3d", "numpy", "scipy", "numba", "llvmlite")

Versions = tuple[tuple[str, str], ...]


@cache
def installed_versions(requires: Sequence[str] = ()) -> Versions:
    """Versions of this machine, of tol3d's own packages and of those that a system requires besides."""
    packages = {name: importlib.metadata.version(name) for name in (*VERSIONS_OF, *requires)}
    return tuple({**packages, **processor()}.items())


@cache
def refuse_other_versions(versions: Versions, requires: Sequence[str] = ()) -> None:
    """Refuse to work for a run whose results might differ in the last bit.

    Raises:
        RunError: a package has another version here, or the processor is of another kind.
    """
    asked, own = dict(versions), dict(installed_versions(requires))
    pairs = {
        name: unlike(own.get(name), asked.get(name)) for name in {**asked, **own} if own.get(name) != asked.get(name)
    }
    if pairs:
        other = "; ".join(f"{name} {here} instead of {there}" for name, (here, there) in pairs.items())
        raise RunError(
            f"a worker has {other}: results could differ in the last bit; install the same packages there, and start "
            "the run on a machine with the workers' kind of processor"
        )
