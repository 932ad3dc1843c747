"""Faults of a mechanism of another package: reported under its name, not as the user's or as tol3d's."""

import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Protocol

from tol3d.errors import MechanismError, Tol3dError
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.measure import Measure
from tol3d.study.system.system import System

OWN_PACKAGE = "tol3d"


@dataclass(frozen=True)
class Origin:
    """Mechanism that a system is of.

    Args:
        name: of the mechanism.
        module: the Python module that has the function of its system.
        beside: names of other mechanisms that add to it.
    """

    name: str
    module: str
    beside: tuple[str, ...] = ()

    @property
    def package(self) -> str:
        """The outermost package of that module."""
        return self.module.partition(".")[0]

    def __str__(self) -> str:
        """Names for messages."""
        return f"mechanism {self.name!r} (Python module {self.module!r})"


class UnfitError(Exception):
    """A system is not as `tol3d.study.system` demands; `faults_of` adds whose it is."""


@contextmanager
def faults_of(origin: Origin | None) -> Iterator[None]:
    """Report errors of a mechanism of another package under its name.

    What passes: errors of tol3d's own kinds, a SceneError of the mechanism among them; what a disk refuses, and
    warnings that a program takes for errors; everything of tol3d's own mechanisms, and of a system made without one.

    Args:
        origin: the mechanism that is at work.

    Raises:
        MechanismError: anything else was raised; that is its `__cause__`.
    """
    try:
        yield
    except (Tol3dError, Warning):
        raise
    except Exception as error:
        if origin is None or origin.package == OWN_PACKAGE:
            raise
        surely = _is_of(origin.package, error)
        if isinstance(error, OSError) and not surely:
            raise
        what = str(error) if isinstance(error, UnfitError) else f"{type(error).__name__}: {error}"
        perhaps = "" if surely else " or in tol3d"
        raise MechanismError(f"a fault in the {origin}{perhaps}, not in your scene: {what}") from error


def _is_of(package: str, error: Exception) -> bool:
    """True if an error was surely raised by a package's code, or by what it made or failed to make."""
    if isinstance(error, UnfitError):
        return True
    concerned = [frame.f_globals.get("__name__", "") for frame, _ in traceback.walk_tb(error.__traceback__)]
    if isinstance(error, ImportError):
        concerned.append(error.name or "")
    if isinstance(error, AttributeError):
        concerned.append(error.obj.__name__ if isinstance(error.obj, ModuleType) else type(error.obj).__module__)
    return any(name.partition(".")[0] == package for name in concerned)


def require_whole(system: Any) -> None:
    """Refuse a system that lacks attributes, or whose contributors or measures do.

    Raises:
        UnfitError: with all that the first of them lacks.
    """
    _require(system, System)
    for contributor in system.contributors:
        _require(contributor, Contributor)
    for measure in system.measures:
        _require(measure, Measure)


def _require(found: object, protocol: type) -> None:
    bases = [own for own in protocol.__mro__ if getattr(own, "_is_protocol", False) and own is not Protocol]
    names = dict.fromkeys(name for basis in bases for name in vars(basis) if not name.startswith("_"))
    lacking = [name for name in names if not hasattr(found, name)]
    if lacking:
        wanted, got = f"{protocol.__module__}.{protocol.__name__}", type(found).__name__
        raise UnfitError(f"expected a {wanted}, got {got} without {', '.join(lacking)}")
