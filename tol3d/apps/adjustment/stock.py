"""Available thicknesses: a step, or pieces that are stacked."""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement
from typing import Final, Protocol

from tol3d.errors import InputError
from tol3d.units import Quantity, expectation

MOST_IN_A_STACK: Final = 3  # pieces; every further face between them adds its own error
MOST_PIECES: Final = 50  # different thicknesses; 23 425 stacks of them
SAME_THICKNESS: Final = 1e-9  # mm; sums of decimals are off by 1e-17, and no shim is ground to a picometre
NO_SHIM: Final = 0.0  # mm


class Stock(Protocol):
    """Thicknesses [mm] that can be had, from none at all on."""

    def __hash__(self) -> int: ...

    def below(self, thickness: float) -> float:
        """The largest that is not above a thickness >= 0 [mm]."""
        ...

    def above(self, thickness: float) -> float | None:
        """The smallest that is above it [mm]; None where there is none."""
        ...

    def words(self, thickness: float) -> str:
        """Pieces that make up one thickness, in words."""
        ...


@dataclass(frozen=True)
class Step:
    """Every multiple of a step [mm], as a grinder or a set of foils gives.

    >>> Step(0.002).below(0.04796), Step(0.002).above(0.04796)
    (0.046, 0.048)
    """

    step: float

    def below(self, thickness: float) -> float:
        """See Stock."""
        return self._times(self._steps(thickness))

    def above(self, thickness: float) -> float:
        """See Stock."""
        return self._times(self._steps(thickness) + 1)

    def words(self, thickness: float) -> str:
        """See Stock."""
        return f"a multiple of {thickness_text(self.step)}"

    def _steps(self, thickness: float) -> int:
        return math.floor((thickness + SAME_THICKNESS) / self.step)

    def _times(self, steps: int) -> float:
        return tidy(steps * self.step)


@dataclass(frozen=True)
class Pieces:
    """Pieces of given thicknesses [mm], up to MOST_IN_A_STACK of them on each other, any of them twice or more.

    >>> Pieces((0.05, 0.1, 0.2)).below(0.33), Pieces((0.05, 0.1, 0.2)).words(0.3)
    (0.3, '0.1 mm + 0.2 mm')
    """

    thicknesses: tuple[float, ...]

    @cached_property
    def _stacks(self) -> dict[float, tuple[float, ...]]:
        """Pieces by the thickness of their stack, thinnest first, each of as few pieces as will do."""
        stacks: dict[float, tuple[float, ...]] = {}
        for count in range(MOST_IN_A_STACK + 1):
            for pieces in combinations_with_replacement(self.thicknesses, count):
                stacks.setdefault(tidy(sum(pieces)), pieces)
        return dict(sorted(stacks.items()))

    def below(self, thickness: float) -> float:
        """See Stock."""
        return max(stack for stack in self._stacks if stack <= thickness + SAME_THICKNESS)

    def above(self, thickness: float) -> float | None:
        """See Stock."""
        return min((stack for stack in self._stacks if stack > thickness + SAME_THICKNESS), default=None)

    def words(self, thickness: float) -> str:
        """See Stock."""
        return " + ".join(map(thickness_text, self._stacks[thickness])) or "none at all"


def nearest(stock: Stock, thickness: float) -> float:
    """The thickness of a stock that is nearest to a wanted one [mm], the thinner of two as near.

    >>> nearest(Step(0.001), 0.04755)
    0.048
    """
    below, above = stock.below(thickness), stock.above(thickness)
    return below if above is None or thickness - below <= above - thickness else above


def stock_of(text: str) -> Stock:
    """A stock as a user writes it: a step (`0.01 mm`), or thicknesses with commas between them.

    Raises:
        InputError: a thickness that is none, or too many of them.
    """
    thicknesses = tuple(length_of("--stock", part) for part in text.split(",") if part.strip() or "," not in text)
    for thickness in thicknesses:
        if not thickness > SAME_THICKNESS:
            raise InputError(f"--stock: expected thicknesses of more than zero, got {thickness_text(thickness)}")
    if not 0 < len(thicknesses) <= MOST_PIECES:
        raise InputError(f"--stock: expected 1 to {MOST_PIECES} thicknesses, got {len(thicknesses)}")
    return Pieces(tuple(sorted(set(thicknesses)))) if "," in text else Step(thicknesses[0])


def length_of(option: str, text: str) -> float:
    """A length [mm] that an option states with its unit.

    Raises:
        InputError: it is something else.
    """
    try:
        quantity = Quantity.parse(text)
    except ValueError as error:
        raise InputError(f"{option}: expected {expectation('length')}, {error}") from None
    if quantity.dimension != "length":
        raise InputError(f"{option}: expected {expectation('length')}, got {text!r}")
    return quantity.internal


def thickness_text(thickness: float) -> str:
    """A thickness [mm] with its unit, as a scene may hold it.

    >>> thickness_text(0.047), thickness_text(0.1 + 0.2)
    ('0.047 mm', '0.3 mm')
    """
    return str(Quantity(tidy(thickness), "mm"))


def tidy(length: float) -> float:
    """A length [mm] without the last digits of sums of decimals."""
    return round(length, 9) + 0.0
