"""A contributor: one toleranced deviation, as every study sees it."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from tol3d.statistics.distributions import DeviationLaw
from tol3d.study.system.draw import Draw
from tol3d.study.system.remembered import Remembered


class Contributor(Protocol):
    """A tolerance of a system. What its deviation does is the system's own business."""

    @property
    def name(self) -> str:
        """Name in the scene."""
        ...

    @property
    def kind(self) -> str:
        """The tolerance's kind, the scene's word."""
        ...

    @property
    def draw(self) -> Draw:
        """Draw of its components from uniforms."""
        ...

    @property
    def unit(self) -> str:
        """Unit of its columns in results: "um", "mrad", "arcmin" or "K"."""
        ...

    @property
    def per_unit(self) -> float:
        """One of that unit in mm, rad or K."""
        ...

    @property
    def description(self) -> str:
        """The scene's own words."""
        ...

    @property
    def least(self) -> float | None:
        """Smallest physical deviation [mm, rad or K], such as 0 for a clearance; draws below it are counted."""
        ...

    @property
    def columns(self) -> tuple[str, ...]:
        """Its columns in results, one a component."""
        ...

    @property
    def distribution(self) -> DeviationLaw:
        """The law of the deviation, or of its length if it has a direction."""
        ...


@runtime_checkable
class WithNominal(Protocol, metaclass=Remembered):
    """A Contributor that knows the word of a drawing for what moves its mean."""

    @property
    def nominal(self) -> str:
        """Such as "E_sns and E_sni", "position", or "nominal"; "" where a drawing has nothing to be moved."""
        ...


def column_names(name: str, components: Sequence[str], unit: str) -> tuple[str, ...]:
    """Columns of a contributor in results.

    >>> column_names("run-out", ("x", "y"), "um")
    ('run-out.x [um]', 'run-out.y [um]')
    """
    return tuple(f"{name}{'.' + component if component else ''} [{unit}]" for component in components)
