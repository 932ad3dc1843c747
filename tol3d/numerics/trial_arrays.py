"""Arrays of trials that belong together, such as all deviations of a mechanism."""

from dataclasses import fields
from typing import Any, Self


class TrialArrays:
    """A frozen dataclass of arrays, or of others such, with the trials on axis 0: trials are taken and put in all."""

    def __getitem__(self, trials: Any) -> Self:
        """Values of some trials."""
        return type(self)(*(getattr(self, own.name)[trials] for own in fields(self)))  # type: ignore[arg-type]

    def __setitem__(self, trials: Any, part: Self) -> None:
        """Write those of some trials."""
        for own in fields(self):  # type: ignore[arg-type]
            getattr(self, own.name)[trials] = getattr(part, own.name)

    def plus(self, other: Self) -> Self:
        """Both added up."""
        return type(self)(*(getattr(self, own.name) + getattr(other, own.name) for own in fields(self)))  # type: ignore[arg-type]
