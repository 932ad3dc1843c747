"""Interface of every distribution of a deviation, and the checks of every spec of one in a scene."""

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, Protocol, Self

import numpy as np
from pydantic import PrivateAttr, SerializerFunctionWrapHandler, model_serializer, model_validator

from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.numerics.arrays import Array
from tol3d.strict import Strict, refused
from tol3d.units import Quantity

LOW_PROBABILITY = 0.00135  # the 0.135 % percentile, where a normal has mean - 3 sigma; ISO 22514-2
HIGH_PROBABILITY = 1 - LOW_PROBABILITY
CIRCLE_PROBABILITY = HIGH_PROBABILITY - LOW_PROBABILITY
RADIUS_HALVINGS = 60  # down to the last bits of a double
LARGEST_DEVIATION = 1e9  # mm, rad or K; keeps squares and differences of what a user writes finite

Stays = Literal["middle", "low", "high"]
"""Fixed point of a law that is scaled: its mean, or one of its limits."""

Place = Callable[[float], float]
"""Map from a deviation to another one [mm, rad or K]."""


class DeviationLaw(Protocol):
    """Moments of the law of a deviation [mm, rad or K], and its ends for worst cases; every Distribution has them."""

    @property
    def mean(self) -> float:
        """The expected deviation."""
        ...

    @property
    def variance(self) -> float:
        """The variance [mm^2, rad^2 or K^2]."""
        ...

    @property
    def sigma(self) -> float:
        """The standard deviation."""
        ...

    @property
    def low(self) -> float:
        """The lower end."""
        ...

    @property
    def high(self) -> float:
        """The upper end."""
        ...


@dataclass(frozen=True, eq=False)
class Distribution(ABC):
    """The law of one deviation [mm, rad or K]; frozen.

    Everything here is elementwise: the bits of `ppf(u)[i]` depend on `u[i]` alone, so that one
    trial can be replayed without the others.
    """

    @abstractmethod
    def ppf(self, u: Array) -> Array:
        """The inverse transform: probabilities (n,) in (0, 1) to deviations (n,)."""

    @abstractmethod
    def cdf(self, x: Array) -> Array:
        """The probability of a deviation of at most x; (n,) to (n,)."""

    @property
    @abstractmethod
    def mean(self) -> float:
        """The expected deviation, in closed form."""

    @property
    @abstractmethod
    def variance(self) -> float:
        """The variance [mm^2, rad^2 or K^2], in closed form."""

    @property
    def words(self) -> str:
        """Kind of the law, such as "truncated normal"."""
        return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(self).__name__).lower()

    @property
    def limits(self) -> tuple[float, float] | None:
        """Limits of the law itself (bounds, or stated ones that draws may exceed)."""
        return None

    @property
    def low(self) -> float:
        """The lower end for worst cases: its limit, or else the 0.135 % percentile."""
        return self.limits[0] if self.limits else float(self.ppf(np.array([LOW_PROBABILITY]))[0])

    @property
    def high(self) -> float:
        """The upper end for worst cases: its limit, or else the 99.865 % percentile."""
        return self.limits[1] if self.limits else float(self.ppf(np.array([HIGH_PROBABILITY]))[0])

    @property
    def extremes(self) -> tuple[float, float]:
        """The least and the largest deviation by which its size is judged: `low` and `high`, or what draws exceed."""
        return self.low, self.high

    @cached_property
    def radius(self) -> float:
        """The end for worst cases of a length in a direction: its larger limit, or the range of 99.73 %."""
        if self.limits:
            return max(abs(limit) for limit in self.limits)
        inside, outside = 0.0, max(abs(float(self.ppf(np.array([p]))[0])) for p in (1e-9, 1 - 1e-9))
        for _ in range(RADIUS_HALVINGS):
            middle = (inside + outside) / 2
            below, above = self.cdf(np.array([-middle, middle]))
            inside, outside = (middle, outside) if above - below < CIRCLE_PROBABILITY else (inside, middle)
        return outside

    @property
    def sigma(self) -> float:
        """The standard deviation."""
        return float(np.sqrt(self.variance))

    def mapped(self, place: Place, factor: float) -> Self:
        """The law of place(deviation), which is linear; of a kind of law that has no other widths this refuses it.

        Args:
            place: of a deviation [mm, rad or K].
            factor: its slope, above 0.

        Raises:
            InputError: a kind of law that cannot be scaled, or not so.
        """
        raise InputError(f"expected a law that can be scaled, got {type(self).__name__}, which defines no scaling")

    def scaled(self, factor: float, about: float | None = None) -> Self:
        """A law as many times as wide.

        Args:
            factor: above 0.
            about: the deviation that stays [mm, rad or K]; default: `pivot`.

        Raises:
            InputError: see `mapped`; a factor that is none.
        """
        if not 0.0 < factor < math.inf:
            raise InputError(f"expected a factor above 0, got {factor:g}")
        middle = self.pivot if about is None else about
        return self.mapped(lambda own: middle if own == middle else middle + factor * (own - middle), factor)

    def shifted(self, by: float) -> Self:
        """A law of the same shape, farther along [mm, rad or K].

        Raises:
            InputError: see `mapped`.
        """
        return self.mapped(lambda own: own + by, 1.0)

    def of_size(self, size: float) -> Self:
        """A law that one number states, by another one [mm, rad or K].

        Raises:
            InputError: a law that limits state.
        """
        raise InputError(f"expected limits of a law that is {type(self).__name__.lower()}, such as ±10 um")

    def scaled_at(self, factor: float, stays: Stays) -> Self:
        """A law of a multiple of the width, about its middle or a limit.

        Raises:
            InputError: see `scaled`; a law that has no such limit.
        """
        if stays == "middle":
            return self.scaled(factor)
        if self.limits is None:
            raise InputError(f"expected a law with limits, of which the {stays} one stays, got {type(self).__name__}")
        return self.scaled(factor, self.limits[0 if stays == "low" else 1])

    @property
    def pivot(self) -> float:
        """The deviation that stays where a law is scaled: its mean; 0 of a length that has no other shape."""
        return self.mean

    def within(self, low: float, high: float) -> Self:
        """A law of the same shape between other limits [mm, rad or K].

        Raises:
            InputError: see `mapped`; a law without limits, or limits in no order.
        """
        if self.limits is None or not self.limits[0] < self.limits[1]:
            raise InputError(f"expected a law with limits, got {type(self).__name__}; state one number, such as 5 um")
        if not -math.inf < low < high < math.inf:
            raise InputError(f"expected a lower limit below the upper one, got {low:g} to {high:g}")
        first, last = self.limits
        factor = (high - low) / (last - first)
        ends = {first: low, last: high}
        return self.mapped(lambda own: ends[own] if own in ends else low + factor * (own - first), factor)


class DistributionSpec(Strict, ABC):
    """A distribution as a scene writes it; the tolerance that holds it fixes the dimension. `kind` is a literal."""

    kind: str

    _drawn: Any = PrivateAttr(default=None)
    _between: Any = PrivateAttr(default=None)

    @property
    def drawn(self) -> Any:
        """The limits as a drawing writes them, of which the law was made: text, a list or keys; None of others."""
        return self._drawn

    @property
    def between(self) -> Any:
        """The LimitLaw that made it of limits on a drawing; None of others."""
        return self._between

    @property
    def by_default_law(self) -> bool:
        """True if the default law of the scene decided the kind of law."""
        return self._drawn is not None and not (isinstance(self._drawn, dict) and "law" in self._drawn)

    def as_drawn(self, written: Any, between: Any) -> Self:
        """The law that is dumped as limits on a drawing; another law made of it is dumped as it is.

        Args:
            written: the limits, as text, a list or keys.
            between: the LimitLaw that made it of them.
        """
        law = self.model_copy()
        law._drawn, law._between = written, between
        return law

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy; one with other values is no longer as it was drawn."""
        copied = super().model_copy(update=update, deep=deep)
        if update:
            copied._drawn = copied._between = None
        return copied

    @model_serializer(mode="wrap")
    def _as_written(self, handler: SerializerFunctionWrapHandler) -> Any:
        return handler(self) if self._drawn is None else self._drawn

    def quantities(self) -> dict[str, Quantity]:
        """Every dimensioned number that was given, by its field, for the tolerance to check."""
        values = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: value for name, value in values.items() if isinstance(value, Quantity)}

    def file_names(self) -> Iterator[tuple[str, str]]:
        """Every file that the law reads, with the field that names it; most read none."""
        return iter(())

    @abstractmethod
    def resolve(self, files: Files) -> Distribution:
        """Distribution in mm, rad or K; `files` holds the content of those that the spec names.

        Raises:
            SceneError: a named file is invalid; the message gives file and line.
        """

    def stating(self, law: Distribution) -> Self:
        """Spec of another law of the kind as a scene writes it, in the same units; to ten digits.

        Raises:
            InputError: the law cannot be stated by numbers.
        """
        told = self.numbers(law)
        given = {name: quantity.like(told[name]) for name, quantity in self.quantities().items() if name in told}
        if not given:
            raise InputError(f"expected a law that numbers state, got {self.kind}")
        return self.model_copy(update=given)

    def numbers(self, law: Distribution) -> Mapping[str, float]:
        """Values of the spec's quantities in a law [mm, rad or K], by field."""
        return {name: getattr(law, name) for name in self.quantities() if hasattr(law, name)}

    @model_validator(mode="after")
    def _refuse_mixed_or_huge(self) -> Self:
        quantities = self.quantities()
        each = {quantity.dimension: f"{field} {str(quantity)!r}" for field, quantity in quantities.items()}
        if len(each) > 1:
            got = " and ".join(f"{written} ({dimension})" for dimension, written in each.items())
            raise refused("", "quantities of one dimension", got)
        for field, quantity in quantities.items():
            if not abs(quantity.internal) <= LARGEST_DEVIATION:
                raise refused(field, "a deviation of less than 1e9 mm, rad or K", quantity)
        return self

    def _refuse_unless_ordered(self, below: str, above: str) -> None:
        """Refuse unless the quantity `below` is less than the quantity `above`."""
        quantities = self.quantities()
        if not quantities[below].internal < quantities[above].internal:
            raise refused(below, f"less than {above} ({quantities[above]})", quantities[below])

    def _refuse_unless_positive(self, field: str) -> None:
        quantity = self.quantities()[field]
        if not quantity.internal > 0.0:
            raise refused(field, "more than 0 (for no spread at all write kind: constant)", quantity)
