"""A system whose trials are made of deviations alone: the common part of most mechanisms, to be overridden.

A mechanism of its own gives its kinds of part, tolerance, move and measure, and a PlainSystem with two functions from
deviations to values: the analytic one, and that of the placed parts. docs/add_a_mechanism.md shows one whole.
"""

import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.scene.bases import LengthLimit, MeasureEntry, MeasureSpec, ToleranceSpec
from tol3d.scene.direction import At
from tol3d.statistics.distributions import DeviationLaw, Distribution
from tol3d.study.system.breakdown import Breakdown
from tol3d.study.system.closed_form import ClosedForm
from tol3d.study.system.contributor import Contributor, column_names
from tol3d.study.system.copula import INDEPENDENT, Copula
from tol3d.study.system.draw import Draw, Scalar
from tol3d.study.system.faults import UnfitError
from tol3d.study.system.measure import Measure, Worse
from tol3d.study.system.method import ANALYTIC_METHOD, Answers, Method, MethodKind
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.pooled import PooledTerms
from tol3d.study.system.pooled_statistic import PooledStatistic
from tol3d.study.system.positions import AT_RANDOM, Positions, Take
from tol3d.study.system.regressors import is_group, regress_plainly, regress_term
from tol3d.study.system.spectrum import Spectrum
from tol3d.study.system.stated import component_slices, mean_deviations, stated
from tol3d.study.system.system import Columns, KeyPath, Published, StreamKey
from tol3d.study.system.trials import Trials
from tol3d.units import Dimension

Drawn = Callable[[Distribution, Any], Draw]
"""Draw of components, from a tolerance's law and the tolerance itself."""

UNITS: Mapping[Dimension, tuple[str, float]] = {
    "length": ("um", 1e-3),
    "angle": ("arcmin", math.radians(1 / 60)),
    "temperature": ("K", 1.0),
    "count": ("pins", 1.0),
}
"""Units of columns, and one of each in mm, rad or K, or in counted items."""


@dataclass(frozen=True)
class PlainContributor:
    """A deviation; see Contributor.

    Args:
        name, kind, description: of the tolerance, as in the scene.
        draw: of its components from uniforms.
        unit: of its columns in results.
        per_unit: one of that unit in mm, rad or K.
        least: smallest physical deviation [mm, rad or K].
        held: other holder of its tolerance, such as the gauge that inspects; "" for none.
        line: name of the scene's line that makes it among others, see study/trials/simulation.py; "" for its own name.
        nominal: see `WithNominal`.
    """

    name: str
    kind: str
    draw: Draw
    unit: str = "um"
    per_unit: float = 1e-3
    description: str = ""
    least: float | None = None
    held: str = ""
    line: str = ""
    nominal: str = "nominal"

    @property
    def columns(self) -> tuple[str, ...]:
        """Its columns in results, one a component."""
        return column_names(self.name, self.draw.components, self.unit)

    @property
    def distribution(self) -> DeviationLaw:
        """The law of the deviation."""
        return self.draw.distribution


@dataclass(frozen=True)
class PlainMeasure:
    """One number a trial; see Measure.

    Args:
        name: as in the scene.
        kind: the measure's kind, the scene's word.
        lower_limit, upper_limit: [mm or rad].
        unit: of its columns and of summary.json.
        per_internal: one mm or rad in that unit.
        worse: the worse end if there is no limit.
        adds_up: whether it is a sum of effects; False where load paths or contacts are compared.
        keeps_overlap: whether a trial whose parts overlap has the depth of the overlap as its value, a negative number
            that continues the gap smoothly through 0; False where its value is on another scale or means nothing.
        pooled_statistics: of all trials together, besides those that every sample has.
        positions, take, spectrum: see Measure; a mechanism whose methods know positions states others.
        inspects: see `Inspecting`.
    """

    name: str
    kind: str
    lower_limit: float | None = None
    upper_limit: float | None = None
    unit: str = "um"
    per_internal: float = 1e3
    worse: Worse = "low"
    adds_up: bool = True
    keeps_overlap: bool = False
    pooled_statistics: tuple[PooledStatistic, ...] = ()
    positions: Positions = AT_RANDOM
    take: Take = "value"
    spectrum: Spectrum | None = None
    inspects: bool = False


def contributors_of(scene: Scene, draws: Mapping[type[ToleranceSpec], Drawn]) -> tuple[PlainContributor, ...]:
    """The tolerances of a scene as contributors.

    Args:
        scene: the scene.
        draws: by kind of tolerance, the draw of its components, from its law and itself; default: one component from
            its law.

    Raises:
        SceneError: a file of measured values that a law reads makes no sense.
    """
    return tuple(
        PlainContributor(
            name,
            spec.kind,
            draws.get(type(spec), _scalar)(spec.distribution.resolve(scene.files), spec),
            *UNITS[spec.dimensions[0]],
            spec.description,
            nominal=spec.nominal,
        )
        for name, spec in scene.distributed.items()
    )


def _scalar(law: Distribution, _: Any) -> Draw:
    return Scalar(law)


def measures_of(scene: Scene, *, worse: Worse = "low", adds_up: bool = True) -> tuple[PlainMeasure, ...]:
    """The measures of a scene, each one number a trial; for the arguments see PlainMeasure."""
    return tuple(PlainMeasure(*stated_of(name, spec), worse, adds_up) for name, spec in scene.measures.items())


def stated_of(name: str, spec: MeasureEntry) -> tuple[str, str, float | None, float | None, str, float]:
    """Properties of a measure that a scene states: the first fields of PlainMeasure."""
    lower, upper = (None if limit is None else limit.internal for limit in (spec.lower_limit, spec.upper_limit))
    unit, per_unit = UNITS[spec.dimension]
    return name, spec.kind, lower, upper, unit, 1.0 / per_unit


def one_position(over: object) -> Positions:
    """The position of a measure that is read at one: an angle that the scene states, or a random one a trial."""
    return Positions("at", 1, 1, over.at.internal) if isinstance(over, At) else AT_RANDOM


class LengthSpec(MeasureSpec):
    """A measure of one length a trial as a scene writes it; a kind adds its word and its subject."""

    dimension: ClassVar[Dimension] = "length"
    gives_curve: ClassVar[bool] = False
    several_positions: ClassVar[bool] = False

    lower_limit: LengthLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: LengthLimit | None = Field(default=None, description="more than this is out of limits")


@dataclass(frozen=True)
class PlainMethod:
    """A method that is a function; every trial seats.

    Args:
        values: of some trials and a measure, (trials,) [mm or rad].
    """

    values: Callable[[Trials, Measure], Array]

    chord_error: ClassVar[float] = 0.0

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Method."""
        return Answers({measure.name: self._column(trials, measure) for measure in measures})

    def _column(self, trials: Trials, measure: Measure) -> Array:
        values = np.asarray(self.values(trials, measure))
        if values.shape != (len(trials),):
            raise UnfitError(
                f"{self.values.__qualname__} of {measure.name!r}: expected values (trials,) of {len(trials)} trials, "
                f"got an array of shape {values.shape}"
            )
        return values[:, None]


@dataclass(frozen=True)
class PlainSystem:
    """A system read at one position, at rest, without sums or sections of its own; see System.

    A subclass adds `analytic` and `exact`, its methods as functions, and overrides what it knows better, such as
    `closed_form`, `acting` or `problems`.

    Args:
        name: of the scene.
        contributors: all tolerances, in the scene's order.
        measures: all measures, in the scene's order.
    """

    name: str
    contributors: tuple[PlainContributor, ...]
    measures: tuple[PlainMeasure, ...]

    methods: ClassVar[Mapping[str, MethodKind]] = {ANALYTIC_METHOD: MethodKind("model"), "exact": MethodKind("model")}
    statuses: ClassVar[Statuses] = Statuses(("ok",))
    breakdowns: ClassVar[Sequence[Breakdown]] = ()
    warnings: ClassVar[Sequence[str]] = ()

    def analytic(self, trials: Trials, measure: Measure) -> Array:
        """Values (trials,) [mm or rad] by theory."""
        raise UnfitError(f"{type(self).__name__} lacks analytic(trials, measure), its values by theory")

    def exact(self, trials: Trials, measure: Measure) -> Array:
        """Values (trials,) [mm or rad] of the parts as they are placed."""
        raise UnfitError(f"{type(self).__name__} lacks exact(trials, measure), its values of placed parts")

    def method(self, name: str, materials: Any) -> Method:
        """One of the two functions."""
        return PlainMethod(self.analytic if name == ANALYTIC_METHOD else self.exact)

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        """None."""
        return iter(())

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        """Its kind."""
        return {"kind": next(own.kind for own in self.measures if own.name == measure.name)}

    @property
    def streams(self) -> Sequence[StreamKey]:
        """None."""
        return ()

    def positions(self, uniforms: Mapping[StreamKey, Array]) -> Mapping[str, Array]:
        """None."""
        return {}

    def columns(self, trials: Trials) -> Mapping[str, NDArray[np.generic]]:
        """None."""
        return {}

    def turns_at_random(self, contributor: Contributor, positions: Positions) -> bool:
        """Nothing turns."""
        return False

    def is_compiled(self, method: str) -> bool:
        """Nothing is to be compiled."""
        return True

    def materials(self, method: str) -> Any:
        """None."""
        return None

    def cost(self, measures: Sequence[Measure]) -> int:
        """One contact per measure."""
        return len(measures)

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """No method has facets."""
        return 0.0

    def acting(self, measure: Measure) -> Sequence[Contributor]:
        """All of them."""
        return self.contributors

    def regressor_key(self, measure: Measure) -> Hashable:
        """The same for all, but of a large group what each of its components does to the measure decides."""
        return measure.name if any(is_group(contributor) for contributor in self.acting(measure)) else ""

    def regress(
        self, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
    ) -> None:
        """Each component of a contributor; of a large group its first-order term."""
        for contributor in contributors:
            values = [
                np.asarray(columns[name], dtype=np.float64) * contributor.per_unit for name in contributor.columns
            ]
            if is_group(contributor):
                slopes = self._slopes(measure, contributor)
                off = (
                    slope * (value - contributor.distribution.mean) for slope, value in zip(slopes, values, strict=True)
                )
                sigma = contributor.draw.sigma * float(np.sqrt((slopes * slopes).sum()))
                regress_term(rows[contributor.name], sum(off, np.zeros(1)), sigma)
            else:
                regress_plainly(rows[contributor.name], contributor, values)

    def _slopes(self, measure: Measure, contributor: Contributor) -> Array:
        """Change of a measure by each component of a contributor, over two sigma about the means, by theory."""
        own, step = component_slices(self)[contributor.name], contributor.draw.sigma
        count = own.stop - own.start
        builds = np.repeat(mean_deviations(self, measure.positions), 2 * count, axis=0)
        builds[:, own] += step * np.concatenate([np.eye(count), -np.eye(count)])
        theory = self.method(ANALYTIC_METHOD, self.materials(ANALYTIC_METHOD))
        values = theory.answers(stated(self, builds), (measure,)).values[measure.name][:, 0]
        return np.asarray((values[:count] - values[count:]) / (2 * step or 1.0))

    def closed_form(self, measure: Measure) -> ClosedForm | None:
        """None."""
        return None

    def reference_form(self, measure: Measure) -> ClosedForm | None:
        """The closed form: there is one position."""
        return self.closed_form(measure)

    def neglected(self, measure: Measure, trials: Trials) -> Mapping[str, Array]:
        """Nothing of first order."""
        return {}

    def sections(
        self, terms: Mapping[str, Mapping[str, PooledTerms]], published: Published, copula: Copula = INDEPENDENT
    ) -> Mapping[str, Any]:
        """None."""
        return {}

    def display(self, trials: Trials, method: Method) -> Any:
        """Nothing to draw."""
        return None

    def deviations(self, trials: Trials, kind: str, measure: Measure | None = None, components: int = 1) -> Array:
        """Components (trials, components) [mm, rad, K] of a kind's contributors, added up.

        Args:
            trials: whose deviations.
            kind: of tolerance, the scene's word.
            measure: only contributors that act on it; default: all of the kind.
            components: number of zeros per trial if there is no such contributor.
        """
        slices = component_slices(self)
        acting = self.contributors if measure is None else self.acting(measure)
        own = [trials.deviations[:, slices[each.name]] for each in acting if each.kind == kind]
        return np.asarray(sum(own, np.zeros((len(trials), components))))
