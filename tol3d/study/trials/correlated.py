"""Correlated contributors of a study: from the scene to a copula, and its effect on sums of effects.

Correlations are of the standard normals of the laws. Those of the deviations themselves follow by Hermite polynomials:
of x = Σ a_k H_k(z) and y = Σ b_k H_k(z'), H_k normalised, the covariance is Σ a_k b_k ρ^k (Mehler). It is ρ sigma sigma
of normal laws, and 6/π asin(ρ/2) is the correlation of two uniform ones.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import combinations
from typing import Final

import numpy as np
from scipy.special import ndtr

from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import Itself
from tol3d.scene import Scene
from tol3d.scene.correlation import CORRELATIONS, LEAST_EIGENVALUE, CorrelationSpec, eigenvalue, least_eigenvalue
from tol3d.scene.nearest import hint
from tol3d.statistics.estimates.shapley import linear_shapley
from tol3d.study.system.closed_form import ClosedForm
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import INDEPENDENT, Block, Copula
from tol3d.study.system.dependent import Dependent
from tol3d.study.system.draw import Draw
from tol3d.study.system.measure import Measure
from tol3d.study.system.normals import LEAST, MOST, groups_of
from tol3d.study.system.system import System
from tol3d.study.trials.simulation import Simulation

ORDERS: Final = 200
"""Number of orders of the polynomials."""
REACH: Final = 9.0
"""Range of the normals, in which laws are integrated."""
STEPS: Final = 8_001
ALIKE: Final = 1e-6
"""Fraction of a variance; a contributor whose part in a sum differs more from its slope's is not linear in it."""


# from the scene -----------------------------------------------------------------------------------------


def copula_of(scene: Scene, system: System) -> Copula:
    """Correlations that a scene states between the contributors of its system.

    Raises:
        SceneError: a name is unknown, or of a contributor that cannot be correlated; a pair is stated twice; or the
            correlations are inconsistent.
    """
    if not scene.correlations:
        return INDEPENDENT
    known = {contributor.name: contributor for contributor in system.contributors}
    said: dict[frozenset[str], float] = {}
    linked: dict[str, set[str]] = {}
    for k, own in enumerate(scene.correlations):
        for i, name in enumerate(own.between):
            if why := _unfit(name, known):
                raise scene.refuse((CORRELATIONS, k, "between", i), why)
        for pair, rho in _pairs(own):
            if pair in said:
                names = " and ".join(map(repr, sorted(pair)))
                raise scene.refuse((CORRELATIONS, k), f"expected one correlation of {names}, got a second one")
            said[pair] = rho
        joined = set(own.between).union(*(linked.get(name, ()) for name in own.between))
        linked |= dict.fromkeys(joined, joined)
    order = [contributor.name for contributor in system.contributors if contributor.name in linked]
    groups = dict.fromkeys(tuple(name for name in order if name in linked[each]) for each in order)
    return Copula(tuple(_block(scene, names, said) for names in groups))


def _unfit(name: str, known: Mapping[str, Contributor]) -> str:
    """Reason why a contributor cannot be correlated, or nothing."""
    if name not in known:
        return f"expected the name of a contributor, got {name!r}{hint(name, known)}"
    draw, expected = known[name].draw, "expected a contributor of one number that varies by itself, got"
    if draw.sigma == 0.0:
        return f"{expected} {name!r}, a constant; take it out"
    if isinstance(draw, Dependent):
        return f"{expected} {name!r}, which depends on {', '.join(draw.reads)}; take it out"
    groups = groups_of(draw)
    if len(draw.components) != 1 or groups is None or [group.kind for group in groups] != ["scalar"]:
        what = "a length with its direction" if draw.components[:2] == ("x", "y") else "of several numbers"
        return f"{expected} {name!r}, {what}; take it out"
    return ""


def _pairs(correlation: CorrelationSpec) -> Iterator[tuple[frozenset[str], float]]:
    matrix = correlation.correlation
    for i, j in combinations(range(len(correlation.between)), 2):
        yield frozenset((correlation.between[i], correlation.between[j])), float(matrix[i, j])


def _block(scene: Scene, names: tuple[str, ...], said: Mapping[frozenset[str], float]) -> Block:
    matrix = np.eye(len(names))
    unsaid = []
    for i, j in combinations(range(len(names)), 2):
        pair = frozenset((names[i], names[j]))
        matrix[i, j] = matrix[j, i] = said.get(pair, 0.0)
        unsaid += [] if pair in said else [f"{names[i]!r} and {names[j]!r}"]
    if (least := least_eigenvalue(matrix)) < LEAST_EIGENVALUE:
        open_ones = f"; that of {unsaid[0]} is not stated, so 0" if unsaid else ""
        words = f"expected correlations of {', '.join(map(repr, names))} that are consistent, a positive definite"
        raise scene.refuse((CORRELATIONS,), f"{words} matrix, got {eigenvalue(least)}{open_ones}")
    return Block(names, tuple(tuple(row) for row in matrix.tolist()))


# what they do to sums -----------------------------------------------------------------------------------


@lru_cache(maxsize=256)
def _polynomials(draw: Itself) -> Array:
    """Coefficients (ORDERS + 1,) of a contributor of one number in normalised Hermite polynomials of its normal."""
    z, step = np.linspace(-REACH, REACH, STEPS, retstep=True)
    weight = np.exp(-z * z / 2) * step / math.sqrt(2 * math.pi)
    (value,) = draw.thing.deviations(np.clip(ndtr(z), LEAST, MOST))
    weighted = weight * value
    before, own = np.zeros_like(z), np.ones_like(z)
    found = [float(np.sum(weighted * own))]
    for k in range(1, ORDERS + 1):  # √k H_k = z H_(k-1) - √(k-1) H_(k-2)
        before, own = own, (z * own - math.sqrt(k - 1) * before) / math.sqrt(k)
        found.append(float(np.sum(weighted * own)))
    return np.array(found)


def value_correlations(block: Block, draws: Mapping[str, Draw]) -> Array:
    """Correlations (names, names) of the deviations of a block, not of their normals."""
    parts = [_polynomials(Itself(draws[name]))[1:] for name in block.names]
    powers = np.arange(1, ORDERS + 1)
    size = len(parts)
    found = np.eye(size)
    for i, j in combinations(range(size), 2):
        covariance = float((parts[i] * parts[j]) @ block.correlation[i, j] ** powers)
        own = covariance / (draws[block.names[i]].sigma * draws[block.names[j]].sigma)
        found[i, j] = found[j, i] = own
    return found


def divided_variances(effects: Mapping[str, float], copula: Copula, draws: Mapping[str, Draw]) -> dict[str, float]:
    """Parts in the variance of a sum: of contributors that are correlated with others in it their Shapley effects.

    Args:
        effects: by contributor its slope times its sigma.
        copula: which are correlated.
        draws: of the contributors.
    """
    found = {name: own * own for name, own in effects.items()}
    for block in copula.blocks:
        places = [k for k, name in enumerate(block.names) if name in effects]
        if len(places) > 1:
            names = [block.names[k] for k in places]
            matrix = value_correlations(block, draws)[np.ix_(places, places)]
            parts = linear_shapley(np.array([effects[name] for name in names]), matrix)
            found |= dict(zip(names, parts.tolist(), strict=True))
    return found


def closed_form_of(simulation: Simulation, measure: Measure) -> ClosedForm | None:
    """Moments of a measure by the analytic method, with covariances; None if there is no closed form.

    There is none either where a contributor that is correlated with another one acts otherwise than by a slope.
    """
    form = simulation.system.closed_form(measure)
    acting = _acting_together(simulation.copula, [] if form is None else [share.name for share in form.shares])
    if form is None or not acting:
        return form
    draws = {contributor.name: contributor.draw for contributor in simulation.system.contributors}
    if any(not _by_slope(form, name, draws[name]) for name in acting):
        return None
    effects = {share.name: share.coefficient * draws[share.name].sigma for share in form.shares if share.name in acting}
    parts = divided_variances(effects, simulation.copula, draws)
    more = sum(parts.values()) - sum(share.variance for share in form.shares if share.name in acting)
    shares = tuple(
        replace(share, variance=parts[share.name]) if share.name in parts else share for share in form.shares
    )
    return replace(form, sigma=math.sqrt(max(form.sigma**2 + more, 0.0)), shares=shares)


def _acting_together(copula: Copula, names: Sequence[str]) -> frozenset[str]:
    """Contributors of some that are correlated with others of them."""
    blocks = ([name for name in block.names if name in names] for block in copula.blocks)
    return frozenset(name for block in blocks if len(block) > 1 for name in block)


def _by_slope(form: ClosedForm, name: str, draw: Draw) -> bool:
    """True if a contributor acts on a measure in proportion to its deviation."""
    (first, *others) = [share for share in form.shares if share.name == name]
    linear = (first.coefficient * draw.sigma) ** 2
    return not others and name not in form.leaning and abs(first.variance - linear) <= ALIKE * max(linear, 1e-300)


def correlation_warnings(simulation: Simulation) -> Iterator[str]:
    """Warnings of the effect of correlations on the numbers of a study."""
    for block in simulation.copula.blocks:
        names = ", ".join(block.names)
        yield (
            f"correlated: {names}; their shares of the variance are Shapley effects, of which none is negative; "
            "high–low–mean and the ends of the tolerances take each of them by itself"
        )
    lost = [
        measure.name
        for measure in simulation.system.measures
        if measure.take != "curve"
        and simulation.copula.blocks
        and simulation.system.closed_form(measure) is not None
        and closed_form_of(simulation, measure) is None
    ]
    if lost:
        yield f"no closed form of {', '.join(lost)}: a correlated contributor acts otherwise than by a slope"
