"""The marginal law of the first component of a zone, by quadrature of its density."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tol3d.assembly.zones.domain import Array, UnitLaw
from tol3d.distributions import Distribution

PANELS = 512
PANEL_NODES, PANEL_WEIGHTS = np.polynomial.legendre.leggauss(6)
HALVINGS = 52  # down to the last bits of a double


@dataclass(frozen=True, eq=False)
class Marginal(Distribution):
    """Of the first component of a law confined to a zone [mm]; good to 1e-6 of the probability.

    Args:
        law: in half widths.
        ratio: t_o / t.
        half: t / 2.
        centre: middle of the zone.
    """

    law: UnitLaw
    ratio: float
    half: float
    centre: float

    def ppf(self, u: Array) -> Array:
        """See Distribution: by bisection of the distribution function."""
        low, high = np.full(np.shape(u), -0.5 * np.pi), np.full(np.shape(u), 0.5 * np.pi)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            is_below = self._below(middle) < u
            low, high = np.where(is_below, middle, low), np.where(is_below, high, middle)
        return np.asarray(self.centre + self.half * np.sin(0.5 * (low + high)))

    def cdf(self, x: Array) -> Array:
        """See Distribution."""
        if self.half == 0.0:
            return np.where(np.asarray(x) < self.centre, 0.0, 1.0)
        place = (np.asarray(x) - self.centre) / self.half
        return self._below(np.arcsin(np.clip(place, -1.0, 1.0)))

    @property
    def mean(self) -> float:
        """The middle of the zone."""
        return self.centre

    @cached_property
    def variance(self) -> float:
        """See UnitLaw.covariance."""
        return float(self.law.covariance(self.ratio)[0, 0]) * self.half**2

    @property
    def limits(self) -> tuple[float, float]:
        """The ends of the zone."""
        return self.centre - self.half, self.centre + self.half

    def _below(self, turn: Array) -> Array:
        """Probability of a coordinate below sin(turn), turn in ±pi/2, which smooths the density at its ends.

        Cubic in each panel, by the probabilities and the densities at its ends.
        """
        below, rise = self._edges
        scaled = (turn / np.pi + 0.5) * PANELS
        panel = np.clip(scaled.astype(np.intp), 0, PANELS - 1)
        z = scaled - panel
        step = below[panel + 1] - below[panel]
        bend = z * (1.0 - z) * ((1.0 - z) * (rise[panel] - step) - z * (rise[panel + 1] - step))
        return np.clip(below[panel] + z * step + bend, 0.0, 1.0)

    @cached_property
    def _edges(self) -> tuple[Array, Array]:
        """At the edges of the panels: the probability below each, and its rise per panel there."""
        edges = np.linspace(-0.5 * np.pi, 0.5 * np.pi, PANELS + 1)
        half = 0.5 * np.pi / PANELS
        middles = 0.5 * (edges[:-1] + edges[1:])
        mass = half * (self._density(middles[:, None] + half * PANEL_NODES) * PANEL_WEIGHTS).sum(axis=1)
        below = np.concatenate([[0.0], np.cumsum(mass)])
        return below / below[-1], 2.0 * half * self._density(edges) / below[-1]

    def _density(self, turn: Array) -> Array:
        return self.law.density(self.ratio, np.sin(turn)) * np.cos(turn)
