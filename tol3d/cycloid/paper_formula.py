"""The published formula of an RV reducer's transmission error as reconstructed, and first principles beside it.

Source: Li, Li, Ye, "The calculation of RV reducer's transmission error based on probability theory", Machine Tool &
Hydraulics 2004(1), 122-123. The print at hand is garbled and no reading of its variance gives all its digits; this one
follows its legend and comes within 0.01" of its 31.14". The paper scales tolerances to standard deviations by 1/3,
run-outs (twice an eccentricity) by 1/6.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

from tol3d.cycloid.profile import DiscProfile
from tol3d.cycloid.sine_sum import SineSum

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
    """What one source does to the output's angle.

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
        profile: of the discs.
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
    """Of one source by the paper's formula (reconstructed) [rad^2].

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
