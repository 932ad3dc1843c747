"""Costs of tolerances by their width over that in the scene."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, Protocol, runtime_checkable

import numpy as np

from tol3d.errors import InputError
from tol3d.scene.nearest import hint
from tol3d.scene.text import core_value, values_in

NUMBERS: Final = ("a", "b", "k")
FIELDS: Final[Mapping[str, tuple[str, ...]]] = {"reciprocal": NUMBERS, "exponential": NUMBERS, "grades": ("grades",)}


class Cost(Protocol):
    """Cost of a tolerance at a factor."""

    def of(self, factor: float) -> float:
        """The cost, in the user's own money."""
        ...

    def slope(self, factor: float) -> float:
        """Its change with the logarithm of the factor."""
        ...


@dataclass(frozen=True)
class Reciprocal:
    """a + b / t^k."""

    a: float = 0.0
    b: float = 1.0
    k: float = 1.0

    def of(self, factor: float) -> float:
        """See Cost."""
        return float(self.a + self.b / factor**self.k)

    def slope(self, factor: float) -> float:
        """See Cost."""
        return float(-self.k * self.b / factor**self.k)


@dataclass(frozen=True)
class Exponential:
    """a + b exp(-k t)."""

    a: float = 0.0
    b: float = 1.0
    k: float = 1.0

    def of(self, factor: float) -> float:
        """See Cost."""
        return self.a + self.b * math.exp(-self.k * factor)

    def slope(self, factor: float) -> float:
        """See Cost."""
        return -self.k * factor * self.b * math.exp(-self.k * factor)


@dataclass(frozen=True)
class Grades:
    """A table: factors that can be had, rising, and the cost of each, falling; on the way it goes by the logarithm."""

    factors: tuple[float, ...]
    costs: tuple[float, ...]

    def of(self, factor: float) -> float:
        """See Cost."""
        return float(np.interp(math.log(factor), np.log(self.factors), self.costs))

    def slope(self, factor: float) -> float:
        """See Cost."""
        logs = np.log(self.factors)
        place = int(np.clip(np.searchsorted(logs, math.log(factor)), 1, len(logs) - 1))
        return float((self.costs[place] - self.costs[place - 1]) / (logs[place] - logs[place - 1]))


@runtime_checkable
class Discrete(Protocol):
    """A cost of some factors alone."""

    @property
    def factors(self) -> tuple[float, ...]:
        """They, rising."""
        ...


@dataclass(frozen=True)
class Costs:
    """Costs by contributor.

    Args:
        own: of some.
        other: of the others.
    """

    own: Mapping[str, Cost] = field(default_factory=dict)
    other: Cost = field(default_factory=Reciprocal)

    def of(self, name: str) -> Cost:
        """Cost of a contributor."""
        return self.own.get(name, self.other)


def costs_from(path: Path, known: Iterable[str]) -> Costs:
    """Costs of a YAML file: `default`, and `contributors` by their names.

    Each is `{kind: reciprocal, a: 0, b: 1, k: 1}`, `{kind: exponential, a: 0, b: 10, k: 2}`, or a table of costs by
    factor, `{kind: grades, grades: {0.63: 4, 1: 2, 1.6: 1}}`.

    Raises:
        InputError: it cannot be read, or makes no sense; the text says where.
    """
    try:
        content = values_in(path, path.read_bytes())
    except OSError as error:
        raise InputError(f"{path}: expected a file of costs that can be read, got: {error.strerror}") from None
    if not isinstance(content, dict) or not content.keys() <= {"default", "contributors"}:
        raise InputError(f"{path}: expected the keys default and contributors, got {_shown(content)}")
    each, names = content.get("contributors") or {}, list(known)
    if not isinstance(each, dict):
        raise InputError(f"{path}: contributors: expected costs by name, got {_shown(each)}")
    own = {}
    for name, given in each.items():
        if name not in names:
            raise InputError(f"{path}: contributors: expected a contributor, got {name!r}{hint(str(name), names)}")
        own[str(name)] = _cost(f"{path}: contributors.{name}", given)
    other = _cost(f"{path}: default", content["default"]) if "default" in content else Reciprocal()
    return Costs(own, other)


def _cost(place: str, given: Any) -> Cost:
    kind = str(given.get("kind")) if isinstance(given, dict) else ""
    if kind not in FIELDS:
        raise InputError(f"{place}: expected kind: {', '.join(FIELDS)}, got {_shown(given)}")
    for key in given:
        if key not in ("kind", *FIELDS[kind]):
            raise InputError(f"{place}: expected of {kind} {', '.join(FIELDS[kind])}, got {key!r}")
    if kind == "grades":
        return _grades(place, given.get("grades"))
    numbers = {key: _number(f"{place}.{key}", value) for key, value in given.items() if key != "kind"}
    for key in ("b", "k"):
        if numbers.get(key, 1.0) <= 0.0:
            raise InputError(f"{place}.{key}: expected a number above 0, for tighter costs more, got {numbers[key]:g}")
    return Reciprocal(**numbers) if kind == "reciprocal" else Exponential(**numbers)


def _grades(place: str, given: Any) -> Grades:
    if not isinstance(given, dict) or len(given) < 2:
        raise InputError(
            f"{place}.grades: expected two or more costs by factor, such as {{0.63: 4, 1: 2}}, got {_shown(given)}"
        )
    rows = sorted(
        (_number(f"{place}.grades", core_value(key)), _number(f"{place}.grades", value)) for key, value in given.items()
    )
    factors, costs = zip(*rows, strict=True)
    if not factors[0] > 0.0:
        raise InputError(f"{place}.grades: expected factors above 0, got {factors[0]:g}")
    if not all(one > other for one, other in pairwise(costs)):
        raise InputError(f"{place}.grades: expected costs that fall as factors rise, got {', '.join(map(str, costs))}")
    return Grades(factors, costs)


def _number(place: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{place}: expected a number, got {_shown(value)}")
    return float(value)


def _shown(value: Any) -> str:
    text = "nothing" if value is None else repr(value)
    return text if len(text) <= 60 else text[:57] + "…"
