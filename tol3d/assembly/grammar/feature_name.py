"""A feature named with its part, such as `housing.bore 1`, as tolerances, moves and measures name it."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Protocol, runtime_checkable

from pydantic import AfterValidator

from tol3d.scene.place import KeyPath
from tol3d.strict import refused
from tol3d.units import shown


def _checked(name: str) -> str:
    part, dot, feature = name.partition(".")
    if not (part and dot and feature) or "." in feature or name != name.strip():
        raise refused("", "a feature with its part, such as housing.bore 1", shown(name))
    return name


FeatureName = Annotated[str, AfterValidator(_checked)]


def _undotted(name: str) -> str:
    if not name or name != name.strip() or set(name) & set(".|-"):
        raise refused("", "a name without . | - (features are written part.feature, common datums A-B)", shown(name))
    return name


OwnName = Annotated[str, AfterValidator(_undotted)]
"""Name of a feature or a datum frame, within its part."""


@dataclass(frozen=True)
class Use:
    """A feature that an entry uses.

    Args:
        path: the field, from the entry on.
        name: with its part.
        kinds: words of the kinds of feature that it may be, such as "plane"; all where it is empty.
        why: what it is used for, for a message: "that lies on a plane".
    """

    path: KeyPath
    name: str
    kinds: tuple[str, ...] = ()


@runtime_checkable
class UsesFeatures(Protocol):
    """An entry that names features."""

    def uses(self) -> Iterator[Use]:
        """Every feature that it names."""
        ...


def part_of(name: str) -> str:
    """The part of a feature's name."""
    return name.partition(".")[0]
