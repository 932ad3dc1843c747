"""A measure: one number a trial, or a curve, as every study sees it."""

from collections.abc import Sequence
from typing import Literal, Protocol, runtime_checkable

from tol3d.study.system.pooled_statistic import PooledStatistic
from tol3d.study.system.positions import Positions, Take
from tol3d.study.system.remembered import Remembered
from tol3d.study.system.spectrum import Spectrum

Worse = Literal["low", "high"]


class Measure(Protocol):
    """Quantity read from each trial; values inside are mm, rad or counts, outside in `unit`."""

    @property
    def name(self) -> str:
        """Name in the scene."""
        ...

    @property
    def positions(self) -> Positions:
        """Positions at which it is read."""
        ...

    @property
    def take(self) -> Take:
        """Value taken over several positions."""
        ...

    @property
    def lower_limit(self) -> float | None:
        """[mm or rad]."""
        ...

    @property
    def upper_limit(self) -> float | None:
        """[mm or rad]."""
        ...

    @property
    def unit(self) -> str:
        """Unit of its columns and of summary.json: "um", "mm", "arcmin", or "pins" of a count."""
        ...

    @property
    def per_internal(self) -> float:
        """One mm or rad in that unit."""
        ...

    @property
    def worse(self) -> Worse:
        """Worse end if there is no limit."""
        ...

    @property
    def adds_up(self) -> bool:
        """True if it is a sum of effects at each position; False where load paths or contacts are compared."""
        ...

    @property
    def pooled_statistics(self) -> Sequence[PooledStatistic]:
        """Statistics of all trials together, besides those that every sample has."""
        ...

    @property
    def spectrum(self) -> Spectrum | None:
        """Harmonics of its curves whose amplitudes are pooled; None for none, and if it is no curve."""
        ...

    @property
    def keeps_overlap(self) -> bool:
        """True if a trial whose parts overlap has the depth of the overlap as its value.

        Such a value is negative and continues the gap smoothly through 0, so both methods may be compared there too.
        """
        ...


@runtime_checkable
class Inspecting(Protocol, metaclass=Remembered):
    """A Measure that may judge a feature against the place where its drawing has it."""

    @property
    def inspects(self) -> bool:
        """True if so: a nominal that is moved moves that place too."""
        ...
