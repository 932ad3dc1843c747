"""Effects of contributors on measures: per unit, over the whole tolerance, on the variance and on failures.

The change over the whole tolerance is what 3DCS calls the GeoFactor analysis: one contributor from end to end, the
others at their means. It ignores interactions and laws. Sobol' indices include both: the first index is a contributor's
own share of the variance, the total one includes its interactions. Where contributors are correlated their indices are
those of them all together, and Shapley effects divide what they share.

Everything is at the same positions, and averaged over them; see pick_freeze.py.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Final, Literal

import numpy as np
from pydantic import Field

from tol3d.analyses.blame import Blame, BlameBy, blame_of
from tol3d.analyses.pick_freeze import NORMAL_95, POSITION, Pairs, PickFreeze, acting_names, inputs_of, pick_freeze
from tol3d.analyses.response import Response
from tol3d.analyses.shapley import ShapleyEffects, shapley_effects
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.runs.summary.values import Count, Known, Label, MethodSection, Ppm, Section, Sentence, made
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import ANALYTIC_METHOD

PLACES: Final = 16
"""Positions at which changes are averaged."""
FEWEST_PLACES: Final = 2
"""Positions where builds take long."""
MOST_EVALUATIONS: Final = 150_000
"""Pairs and their mixtures at most, for measures that are evaluated together."""
MOST_MINUTES: Final = 0.1
"""Processor minutes for these at most, by the contacts a minute of the method."""
LEAST_MINUTES: Final = 1e-9
LEAST_BASE: Final = 128
MOST_BASE: Final = 2**14

PositionIs = Literal["averaged", "input", "none"]


class Index(Section):
    """A share of a variance, with 1.96 standard errors of the bootstrap to either side."""

    share: float
    low: float
    high: float


class ContributorEffects(Section):
    """Effect of a contributor on a measure."""

    unit: Annotated[Label, Shows("unit", "unit sign")] = Field(description="of its deviation")
    slope: Annotated[Known, Shows("per unit [{unit}]", "digits")] = Field(
        description="change of the measure per unit at the mean build, averaged over positions; of several components "
        "the size of their gradient"
    )
    change: Annotated[Known, Shows("over all [{unit}]", "digits")] = Field(
        description="largest less smallest value over its whole tolerance, the others at their means"
    )
    together: list[Label] = Field(description="whose indices these are: its own, and of all it is correlated with")
    first: Annotated[Index | None, Shows("first [%]", "index")] = Field(description="first Sobol' index")
    total: Annotated[Index | None, Shows("total [%]", "index")] = Field(description="total Sobol' index")
    shapley: Annotated[Index | None, Shows("Shapley [%]", "index", seldom=True)] = Field(
        description="Shapley effect, where contributors are correlated or it was asked for"
    )
    failures: Annotated[Index | None, Shows("failures [%]", "index", seldom=True)] = Field(
        description="share of the failures; see failures_by"
    )
    failures_total: Annotated[Index | None, Shows("with others [%]", "index", seldom=True)] = Field(
        description="with interactions; of a simulation alone"
    )


class MeasureEffects(Section):
    """Effects on a measure, in its unit."""

    unit: Label
    mean: Known
    sigma: Known = Field(description="at a position: the root of the variance there, averaged over positions")
    base: Count = Field(description="pairs of builds")
    pairs: Count = Field(description="of them with a value each")
    builds: Count = Field(description="that the pairs have")
    not_seated: Count = Field(
        description="builds that could not be assembled; left out of indices of the value, failures otherwise"
    )
    sum_of_first: Index | None
    sum_of_total: Index | None
    position: ContributorEffects | None = Field(description="where the position is an input")
    failing_ppm: Ppm | None = Field(description="of the builds of pairs; null without a limit")
    failures_by: BlameBy | None = Field(
        description="simulation: Sobol' indices of failing; design points: squared direction cosines, averaged"
    )
    failures_words: Sentence = Field(description="on the failures; where nothing acts, that")
    contributors: Mapping[Label, ContributorEffects]


class Effects(MethodSection):
    """Effects of contributors on measures."""

    scene: Label
    seed: Count
    positions: PositionIs
    evaluations: Count
    measures: Mapping[Label, MeasureEffects]


def effects(
    response: Response,
    *,
    base: int | None = None,
    seed: int = 1,
    position: bool = False,
    shapley: bool = False,
    activity: Callable[[str], None] = lambda text: None,
) -> Effects:
    """Effects of all contributors on the measures of a response.

    Args:
        response: of one or several measures.
        base: pairs of builds, a power of two; default: as many as 150 000 evaluations allow, or six seconds
            of a processor, 128 at least and 16 384 at most.
        seed: of their points.
        position: whether the position is an input as well, in place of being averaged over.
        shapley: whether Shapley effects are wanted also where no contributors are correlated.
        activity: progress callback.

    Raises:
        InputError: the scene has no contributors, the position is to be an input and there is none, or a base is no
            power of two.
    """
    system = response.simulation.system
    response.refuse_no_contributors()
    if base is not None and (base < 2 or base & (base - 1)):
        raise InputError(f"expected a power of two pairs of builds, such as 4096, got {base}")
    if position and not system.streams:
        raise InputError("expected measures that are read at random positions, got none; leave out the position")
    before = response.evaluations
    found: dict[str, MeasureEffects] = {}
    for group in _alike(response):
        asked = response.of(*(own.name for own in group))
        names = ", ".join(asked.names)
        activity(f"changes of {names}")
        slopes, changes = _averaged(asked, seed)
        inputs = inputs_of(asked, position=position)
        pairs = Pairs(asked, base or default_base(asked, len(inputs)), seed, position)
        activity(f"{pairs.count} pairs of {names}")
        sampled = pick_freeze(pairs, inputs)
        divided = None
        if shapley or any(len(own.names) > 1 for own in inputs):
            activity(f"Shapley effects on {names}")
            divided = shapley_effects(pairs, [name for own in inputs for name in own.names])
        for k, own in enumerate(group):
            activity(f"failures of {own.name}")
            blame = blame_of(asked.of(own.name), sampled, divided, k, seed)
            found[own.name] = _of_measure(asked, k, slopes[k], changes[k], pairs, sampled, divided, blame)
    return made(
        Effects,
        scene=system.name,
        method=ANALYTIC_METHOD if response.method is None else response.simulation.study.engine,
        seed=seed,
        positions=("input" if position else "averaged") if system.streams else "none",
        evaluations=response.evaluations - before,
        measures={measure.name: found[measure.name] for measure in response.measures},
    )


def _alike(response: Response) -> Sequence[Sequence[Measure]]:
    """Measures by the positions of a trial: sweeps take longer, and get fewer pairs."""
    groups: dict[int, list[Measure]] = {}
    for measure in response.measures:
        groups.setdefault(measure.positions.in_a_trial, []).append(measure)
    return list(groups.values())


def default_base(response: Response, inputs: int) -> int:
    """Affordable number of pairs of builds."""
    most = min(MOST_EVALUATIONS, MOST_MINUTES / response.minutes if response.minutes > 0.0 else math.inf)
    size = 1 << int(math.log2(max(most / (inputs + 2), 1.0)))
    return min(max(size, LEAST_BASE), MOST_BASE)


def _averaged(response: Response, seed: int) -> tuple[Array, Array]:
    """Slopes per unit and changes over the tolerance (measures, contributors), averaged over positions."""
    most = MOST_MINUTES / max(response.minutes * 2 * len(response.acting_columns), LEAST_MINUTES)
    places = min(max(int(most), FEWEST_PLACES), PLACES) if response.simulation.system.streams else 1
    positions = response.positions(places, "drawn" if places > 1 else "rest", seed)
    slopes, changes = [], []
    for k in range(places):
        here = {name: own[k : k + 1] for name, own in positions.items()}
        slopes.append(_slopes(response, response.gradient(response.mean, here)[0]))
        changes.append(response.ranges(here))
    return np.mean(slopes, axis=0), np.mean(changes, axis=0)


def _slopes(response: Response, gradient: Array) -> Array:
    """Change per unit (measures, contributors) of a gradient (measures, components)."""
    found = []
    for contributor in response.contributors:
        part = gradient[:, response.slices[contributor.name]] * contributor.per_unit
        found.append(part[:, 0] if part.shape[1] == 1 else np.sqrt((part * part).sum(axis=1)))
    return np.array(found).reshape(len(found), len(gradient)).T


def _of_measure(
    response: Response,
    k: int,
    slopes: Array,
    changes: Array,
    pairs: Pairs,
    sampled: PickFreeze,
    divided: ShapleyEffects | None,
    blame: Blame,
) -> MeasureEffects:
    measure, values = response.measures[k], sampled.values
    acting = acting_names(response.of(measure.name))
    place = {name: i for i, own in enumerate(sampled.inputs) for name in own.names if acting.intersection(own.names)}
    shares: dict[str, tuple[float, float]] = {}
    if divided is not None:
        numbers = zip(divided.values[:, k].tolist(), divided.value_errors[:, k].tolist(), strict=True)
        shares = dict(zip(divided.names, numbers, strict=True))
    contributors = {}
    for j, own in enumerate(response.contributors):
        i = place.get(own.name)
        if own.name not in acting and i is None:
            continue
        contributors[own.name] = made(
            ContributorEffects,
            unit=own.unit,
            slope=_known(slopes[j]),
            change=_known(changes[j]),
            together=list(sampled.inputs[i].names) if i is not None else [own.name],
            first=None if i is None else _index(values.first[i, k], values.first_errors[i, k]),
            total=None if i is None else _index(values.total[i, k], values.total_errors[i, k]),
            shapley=None if own.name not in shares else _index(*shares[own.name]),
            failures=_index(*blame.first[own.name]) if own.name in blame.first else None,
            failures_total=_index(*blame.total[own.name]) if own.name in blame.total else None,
        )
    count, seated = len(sampled.seated), int(np.count_nonzero(sampled.seated[:, k]))
    limited = measure.lower_limit is not None or measure.upper_limit is not None
    return made(
        MeasureEffects,
        unit=measure.unit,
        mean=_known(sampled.mean[k]),
        sigma=_known(math.sqrt(values.variance[k])),
        base=pairs.count,
        pairs=int(sampled.rows[k]),
        builds=count,
        not_seated=count - seated,
        sum_of_first=_index(values.sums[0, k], values.sum_errors[0, k]),
        sum_of_total=_index(values.sums[1, k], values.sum_errors[1, k]),
        position=_position(sampled, k),
        failing_ppm=1e6 * float(sampled.failing[:, k].mean()) if limited or seated < count else None,
        failures_by=blame.by,
        failures_words=response.nothing_acts(measure) or blame.words,
        contributors=contributors,
    )


def _position(sampled: PickFreeze, k: int) -> ContributorEffects | None:
    if not sampled.inputs or sampled.inputs[-1].names:
        return None
    values = sampled.values
    return made(
        ContributorEffects,
        unit="1",
        slope=None,
        change=None,
        together=[POSITION],
        first=_index(values.first[-1, k], values.first_errors[-1, k]),
        total=_index(values.total[-1, k], values.total_errors[-1, k]),
        shapley=None,
        failures=None,
        failures_total=None,
    )


def _index(value: float, error: float) -> Index | None:
    if not math.isfinite(value):
        return None
    reach = NORMAL_95 * error if math.isfinite(error) else 0.0
    return made(Index, share=float(value), low=float(value - reach), high=float(value + reach))


def _known(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
