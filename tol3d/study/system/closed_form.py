"""Moments of a measure without trials, and each contributor's part in them."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True)
class Share:
    """A contributor's part in a measure.

    Args:
        name: the contributor's.
        coefficient: change of the measure per deviation, internal units (mm, rad, K).
        mean, variance: its part of the measure's mean [mm or rad] and variance.
    """

    name: str
    coefficient: float
    mean: float
    variance: float


@dataclass(frozen=True)
class ClosedForm:
    """Moments of a measure by the analytic method [mm or rad].

    Args:
        nominal, mean, sigma: of the measure.
        shares: of the contributors that act on it.
        leaning: names of those whose coefficients are mean slopes, for their effect is not linear.
    """

    nominal: float
    mean: float
    sigma: float
    shares: tuple[Share, ...]
    leaning: frozenset[str] = frozenset()

    def percent(self, name: str) -> float:
        """Share of the variance [%] of a contributor; 0 when nothing varies."""
        return self._percents.get(name, 0.0)

    @cached_property
    def _percents(self) -> Mapping[str, float]:
        variances: dict[str, float] = {}
        for share in self.shares:
            variances[share.name] = variances.get(share.name, 0.0) + share.variance
        total = sum(share.variance for share in self.shares)
        return {name: 100.0 * own / total if total > 0.0 else 0.0 for name, own in variances.items()}
