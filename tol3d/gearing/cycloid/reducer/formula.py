"""Transmission error of an RV reducer by first principles, and by the published formula as reconstructed.

The formula is shown where a scene publishes its figures, to compare with.

Source: Li, Li, Ye, "The calculation of RV reducer's transmission error based on probability theory", Machine Tool &
Hydraulics 2004(1), 122-123. The print at hand is garbled and no reading of its variance gives all its digits; this one
follows its legend and comes within 0.01" of its 31.14". The paper scales tolerances to standard deviations by 1/3,
run-outs (twice an eccentricity) by 1/6.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from scipy.optimize import brentq
from scipy.special import erf

from tol3d.gearing.cycloid.model.profile import DiscProfile
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.cycloid.summary_types import CycloidStageSummary, FormulaTotals, SourceByFormula, StageTotals
from tol3d.gearing.reducers.deviations import Acts
from tol3d.numerics.arrays import Array
from tol3d.study.runs.summary.values import made
from tol3d.study.system.contributor import Contributor

PHASES: Final = 2048  # of a quarter circle; the half-range then is within 1e-4 of itself, 1e-12 where normals are in it
QUANTILE_XTOL: Final = 1e-12  # of the standard deviation
SIX_SIGMA_SHARE: Final = 0.9973  # that +-3 sigma of a normal covers


@dataclass(frozen=True)
class SineSum:
    """G + L sin(phase), phase uniform: not normal, though a Rayleigh length times that sine is.

    Given the phase the sum is normal with variance G^2 + L^2 sin^2(phase): its law is a mean of normals over a quarter
    of the circle, where the midpoint rule converges beyond all powers.

    Args:
        normal: standard deviation of the normal part.
        length: standard deviation of the normal length that the sine multiplies.

    >>> round(SineSum(0.0, 1.0).sigma, 6)
    0.707107
    """

    normal: float
    length: float

    @property
    def sigma(self) -> float:
        """Standard deviation."""
        return float(np.hypot(self.normal, self.length / np.sqrt(2.0)))

    def coverage(self, half_range: float) -> float:
        """Probability of -half_range to half_range."""
        return float(np.mean(erf(half_range / (np.sqrt(2.0) * self._spreads))))

    def half_range(self, share: float = SIX_SIGMA_SHARE) -> float:
        """Half-range, even about 0, that covers a share of all.

        Raises:
            ValueError: the share is not between 0 and 1.
        """
        if not 0.0 < share < 1.0:
            raise ValueError(f"share: expected a number between 0 and 1, got {share:g}")
        if self.sigma == 0.0:
            return 0.0
        unit = SineSum(self.normal / self.sigma, self.length / self.sigma)
        reach = 1.0
        while unit.coverage(reach) < share:
            reach *= 2.0
        return self.sigma * float(brentq(lambda x: unit.coverage(x) - share, 0.0, reach, xtol=QUANTILE_XTOL))

    @property
    def _spreads(self) -> Array:
        phases = (np.arange(PHASES) + 0.5) * (np.pi / 2 / PHASES)
        return np.asarray(np.hypot(self.normal, self.length * np.sin(phases)))


Source = Literal[
    "disc run-out",
    "crank run-out",
    "pin circle radius",
    "pin pitch",
    "disc pitch",
    "disc profile",
    "carrier hole centre",
    "main bearing run-out",
]
CARRIER: Final[tuple[Source, ...]] = ("carrier hole centre", "main bearing run-out")
RUN_OUTS: Final[tuple[Source, ...]] = ("disc run-out", "crank run-out", *CARRIER)
TOLERANCE_SIGMAS: Final = 3.0  # a tolerance in standard deviations, see the source
RUN_OUT_SIGMAS: Final = 6.0  # a run-out in standard deviations of one component of the eccentricity


@dataclass(frozen=True)
class Term:
    """Effect of one source on the output's angle.

    Args:
        source: of the deviation.
        tolerance: its tolerance or run-out [mm].
        paper: standard deviation by the paper's formula (reconstructed) [rad].
        first_principles: standard deviation of the turn of the disc while its best pin alone touches [rad].
        lever: that turn per deviation [rad/mm].
    """

    source: Source
    tolerance: float
    paper: float
    first_principles: float
    lever: float


@dataclass(frozen=True)
class PaperTotals:
    """The paper's formula (reconstructed), added up in each way.

    Args:
        cycloid, carrier: standard deviations of both stages [rad].
        cycloid_law: of the first; the paper has its pin circle displaced, by a normal length in a random direction.
    """

    cycloid: float
    carrier: float
    cycloid_law: SineSum

    @property
    def arithmetic(self) -> float:
        """Both 3 sigma added, as the paper does [rad]."""
        return 3.0 * (self.cycloid + self.carrier)

    @property
    def root_sum_square(self) -> float:
        """3 sigma of the sum of two that are independent [rad]."""
        return 3.0 * math.hypot(self.cycloid, self.carrier)


def sigma_of(source: Source, tolerance: float) -> float:
    """Standard deviation [mm] that a tolerance or run-out stands for: of a run-out that of one component."""
    return tolerance / (RUN_OUT_SIGMAS if source in RUN_OUTS else TOLERANCE_SIGMAS)


def best_pin_lever(source: Source, profile: DiscProfile) -> float:
    """Turn of the disc per deviation [rad/mm] while the pin of the largest lever alone touches; first principles.

    All contact normals pass the pitch point, rc' off the disc's axis. At that pin they stand at right angles to the
    radius of the pitch point: an eccentricity acts through rc' alone, a pin's displacement by the share of it along
    the normal, sqrt(1 - K^2) of a radial and K of a tangential one.

    >>> rv = DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=5.0, eccentricity=2.2)
    >>> [round(math.degrees(best_pin_lever(own, rv)) * 3.6, 4) for own in ("disc run-out", "disc pitch")]  # "/um
    [2.404, 1.8476]
    """
    k = profile.shortening
    along: dict[Source, float] = {"pin circle radius": math.sqrt(1.0 - k * k), "pin pitch": k, "disc pitch": k}
    return along.get(source, 1.0) / profile.pitch_radius


def terms(profile: DiscProfile, tolerances: Mapping[Source, float]) -> tuple[Term, ...]:
    """Each source's part, by both.

    Args:
        tolerances: tolerance or run-out of each source [mm].
    """
    found = []
    for own, size in tolerances.items():
        lever = best_pin_lever(own, profile)
        paper = math.sqrt(_paper_variance(own, size, profile))
        found.append(Term(own, size, paper, sigma_of(own, size) * lever, lever))
    return tuple(found)


def paper_totals(own: tuple[Term, ...]) -> PaperTotals:
    """The paper's formula (reconstructed), added up."""
    cycloid = [term for term in own if term.source not in CARRIER]
    circle = math.hypot(*(term.paper for term in cycloid if term.source == "pin circle radius"))
    others = math.hypot(*(term.paper for term in cycloid if term.source != "pin circle radius"))
    carrier = math.hypot(*(term.paper for term in own if term.source in CARRIER))
    return PaperTotals(math.hypot(circle, others), carrier, SineSum(others, math.sqrt(2.0) * circle))


def first_principles_totals(own: tuple[Term, ...]) -> tuple[float, float]:
    """Standard deviations of the cycloid stage and of the carrier by first principles at the best pin [rad]."""
    cycloid = math.hypot(*(term.first_principles for term in own if term.source not in CARRIER))
    return cycloid, math.hypot(*(term.first_principles for term in own if term.source in CARRIER))


def sun_held_factor(lobes: int, sun_teeth: int, planet_teeth: int) -> float:
    """Turn of the output while the sun stands, per turn of the discs against the cranks as they stood.

    A turn of the carrier takes the planets along over the sun, so the cranks turn by 1 + zs/zp and the discs give way
    by that over their lobes: 1 / (1 + (1 + zs/zp)/Zc).

    >>> round(sun_held_factor(39, 21, 42), 5) == round(80 / 81 * 39 / 40, 5) == 0.96296
    True
    """
    return 1.0 / (1.0 + (1.0 + sun_teeth / planet_teeth) / lobes)


def _paper_variance(source: Source, size: float, profile: DiscProfile) -> float:
    """Variance of one source by the paper's formula (reconstructed) [rad^2].

    D = (dr^2 + du^2 + 2 dk^2 + 4 dt^2) / (36 rp^2) + (K^2 dw^2 + df^2) / (9 rc'^2), with the run-outs of disc r and
    crank u, pin circle radius k, pin pitch t, disc pitch w and profile f; of the carrier (d/6)^2 + (d/18)^2 over rc'^2.
    The print explains neither the third nor which of the carrier's two, both 5 um, it belongs to; here the bearing.
    """
    pins, rolling = 36.0 * profile.pin_circle_radius**2, profile.pitch_radius**2
    per_square: dict[Source, float] = {
        "disc run-out": 1.0 / pins,
        "crank run-out": 1.0 / pins,
        "pin circle radius": 2.0 / pins,
        "pin pitch": 4.0 / pins,
        "disc pitch": profile.shortening**2 / (9.0 * rolling),
        "disc profile": 1.0 / (9.0 * rolling),
        "carrier hole centre": 1.0 / (36.0 * rolling),
        "main bearing run-out": 1.0 / (324.0 * rolling),
    }
    return size**2 * per_square[source]


SOURCES: Final[Mapping[str, Source]] = {
    "disc offset": "disc run-out",
    "crank throw of a disc": "crank run-out",
    "pin circle": "pin circle radius",
    "pin round": "pin pitch",
    "lobe pitch": "disc pitch",
    "lobe profile": "disc profile",
    "carrier circle": "carrier hole centre",
    "carrier offset": "main bearing run-out",
}
"""Source of a contributor in the formula, by its effect."""


@dataclass(frozen=True)
class PaperSources:
    """Input of the formula from a scene.

    Args:
        tolerances: of each source [mm], so large that it scales back to the scene's standard deviations; the root sum
            square of several contributors to one source.
        left_out: names of contributors that the formula has no place for.
    """

    tolerances: Mapping[Source, float]
    left_out: tuple[str, ...]

    @classmethod
    def of(cls, contributors: Iterable[tuple[str, str, float]]) -> "PaperSources":
        """Sources from each contributor's name, its effect, and the standard deviation of one component [mm]."""
        found: dict[Source, float] = {}
        left_out = []
        for name, effect, sigma in contributors:
            if effect not in SOURCES:
                left_out.append(name)
                continue
            source = SOURCES[effect]
            scale = RUN_OUT_SIGMAS if source in RUN_OUTS else TOLERANCE_SIGMAS
            found[source] = math.hypot(found.get(source, 0.0), scale * sigma)
        return cls({source: found[source] for source in SOURCES.values() if source in found}, tuple(left_out))


THREE_SIGMA: Final = 3.0 * math.degrees(1.0) * 3600.0  # arc seconds a radian of standard deviation


def stages_by_formula(
    rv_set: RVSet, acts: Mapping[str, Acts], contributors: Sequence[Contributor]
) -> Mapping[str, CycloidStageSummary]:
    """Summary of a reducer's stage by its name; nothing if the formula knows none of its contributors."""
    first = rv_set.first
    drawn = ((contributor.name, acts[contributor.name].effect, contributor.draw.sigma) for contributor in contributors)
    sources = PaperSources.of(drawn)
    if not sources.tolerances:
        return {}
    held = None if first is None else sun_held_factor(rv_set.profile.lobes, *first.teeth)
    return {rv_set.name: stage_by_formula(rv_set.profile, sources, held, by_formula=rv_set.by_formula)}


def stage_by_formula(
    profile: DiscProfile, sources: PaperSources, sun_held: float | None, *, by_formula: bool
) -> CycloidStageSummary:
    """Each source by first principles and, where that is published, by the paper's formula; and totals.

    Args:
        sources: of the scene, see PaperSources.
        sun_held: see sun_held_factor; None where the cranks are the input.
        by_formula: whether the paper's formula is shown.
    """
    own = terms(profile, sources.tolerances)
    cycloid, carrier = first_principles_totals(own)
    return made(
        CycloidStageSummary,
        sources={term.source: _source(term, by_formula=by_formula) for term in own},
        by_formula=_formula_totals(own) if by_formula else None,
        first_principles=made(
            StageTotals,
            cycloid_arcsec=THREE_SIGMA * cycloid,
            carrier_arcsec=THREE_SIGMA * carrier,
            added_arcsec=THREE_SIGMA * (cycloid + carrier),
            root_sum_square_arcsec=THREE_SIGMA * math.hypot(cycloid, carrier),
        ),
        sun_held=sun_held,
        left_out=list(sources.left_out),
    )


def _source(term: Term, *, by_formula: bool) -> SourceByFormula:
    return made(
        SourceByFormula,
        tolerance_um=1e3 * term.tolerance,
        by_formula_arcsec=THREE_SIGMA * term.paper if by_formula else None,
        first_principles_arcsec=THREE_SIGMA * term.first_principles,
        arcsec_per_um=THREE_SIGMA / 3.0 * term.lever / 1e3,
    )


def _formula_totals(own: tuple[Term, ...]) -> FormulaTotals:
    found = paper_totals(own)
    law = found.cycloid_law
    return made(
        FormulaTotals,
        cycloid_arcsec=THREE_SIGMA * found.cycloid,
        carrier_arcsec=THREE_SIGMA * found.carrier,
        added_arcsec=THREE_SIGMA / 3.0 * found.arithmetic,
        root_sum_square_arcsec=THREE_SIGMA / 3.0 * found.root_sum_square,
        cycloid_half_range_arcsec=THREE_SIGMA / 3.0 * law.half_range(),
        cycloid_coverage_percent=100.0 * law.coverage(3.0 * found.cycloid) if found.cycloid > 0.0 else 100.0,
    )
