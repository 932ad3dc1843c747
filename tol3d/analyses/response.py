"""Response of a scene, the basis of every analysis: values of its measures for batches of deviations or normals.

A response is a simulation, one of its methods and some of its measures. It knows no mechanism; deviations are columns
of the contributors, positions those of the system's streams.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, is_dataclass, replace
from functools import cached_property, partial
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.kept_batches import KeptBatches
from tol3d.distributions import Distribution
from tol3d.distributions.base import Stays
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.scene.nearest import hint
from tol3d.study.acting import acting, nothing_acts
from tol3d.study.curve_tally import ENDS, HIGHEST, LOWEST
from tol3d.study.draws import KeptDraws, fill, kept_draws
from tol3d.study.evaluation import Evaluation
from tol3d.study.high_low_mean import ranges
from tol3d.study.simulation import Simulation
from tol3d.study.task import materials_of, method_of
from tol3d.system.contributor import Contributor
from tol3d.system.copula import Copula
from tol3d.system.dependent import Dependent, DrawnAs, in_draw_order
from tol3d.system.draw import Draw
from tol3d.system.measure import Measure
from tol3d.system.method import ANALYTIC_METHOD, Method
from tol3d.system.normals import groups_of, normal_count, uniforms_of
from tol3d.system.other_laws import Following, Zoned, refuse_held, refuse_impossible, with_law
from tol3d.system.other_laws import scaled as scaled_draw
from tol3d.system.other_laws import shifted as shifted_draw
from tol3d.system.stated import component_count, component_slices, mean_deviations, stated
from tol3d.system.statuses import OK
from tol3d.system.trials import Trials

Codes = NDArray[np.int8]
Standing = Literal["rest", "averaged", "drawn"]
"""Positions of rows: at rest, the same drawn ones in all rows that are compared, or each row's own."""

NOTHING_STAYS: Final[Mapping[str, Stays]] = {}

NUDGE: Final[Mapping[str, float]] = {"um": 1e-3, "arcmin": 1e-5, "K": 0.1, "1": 1e-3}
"""Steps of central differences [mm, rad, K or shares], by the unit of a contributor's columns."""


@dataclass(frozen=True, eq=False)
class Values:
    """Values of some rows.

    Args:
        values: of each measure in its unit (n, measures), NaN where a build cannot be assembled, unless the measure
            keeps the depth of overlap.
        codes: status of each (n, measures), an index of `texts`.
        texts: of the statuses.
    """

    values: Array
    codes: Codes
    texts: tuple[str, ...]

    @property
    def seated(self) -> NDArray[np.bool_]:
        """True where a value is assembled and measured (n, measures)."""
        return np.asarray(self.codes == OK)


@dataclass
class Count:
    """Count of evaluated builds; shared by all responses made from one."""

    evaluations: int = 0


@dataclass(frozen=True, eq=False)
class Response:
    """The response of a scene to deviations.

    Args:
        simulation: of the scene.
        measures: which are read, one number a trial each; of a curve its lowest and its highest value.
        method: that builds; None for the analytic one.
        draws: by contributor, how it is drawn: the scene's, or other tolerances.
        curves: by the name of an end of a curve, the curve.
        count: of evaluations.
        batches: where those that took long are kept, so that an interrupted analysis can go on; None: nowhere.
    """

    simulation: Simulation
    measures: tuple[Measure, ...]
    method: Method | None
    draws: Mapping[str, Draw]
    curves: Mapping[str, Measure] = field(default_factory=dict)
    count: Count = field(default_factory=Count)
    batches: KeptBatches | None = None

    @property
    def evaluations(self) -> int:
        """Number of builds evaluated."""
        return self.count.evaluations

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the measures."""
        return tuple(own.name for own in self.measures)

    @property
    def contributors(self) -> Sequence[Contributor]:
        """All of the system's."""
        return self.simulation.system.contributors

    @cached_property
    def lines(self) -> Mapping[str, tuple[str, ...]]:
        """Contributors by the line of the scene that states their tolerance, and is changed for all of them at once."""
        found = {own.name: own.contributors for own in self.simulation.lines}
        stated = {name for own in found.values() for name in own}
        return found | {own.name: (own.name,) for own in self.contributors if own.name not in stated}

    def source(self, measure: Measure) -> Measure:
        """The system's own measure: of an end of a curve the curve."""
        return self.curves.get(measure.name, measure)

    def acting(self, measure: Measure) -> Sequence[Contributor]:
        """Contributors that act on one of the measures; see study/acting.py."""
        return acting(self.simulation, self.source(measure))

    def nothing_acts(self, measure: Measure) -> str:
        """A sentence where no contributor acts on one of the measures, as far as was seen; "" where one does."""
        return nothing_acts(self.simulation, self.source(measure))

    @property
    def minutes(self) -> float:
        """Processor time of an evaluation [min], by the contacts that its method makes in a minute."""
        asked = list({own.name: own for own in map(self.source, self.measures)}.values())
        return self.simulation.system.cost(asked) / self.simulation.method.contacts_per_minute

    @cached_property
    def components(self) -> int:
        """Columns of the deviations."""
        return component_count(self.simulation.system)

    def refuse_no_contributors(self) -> None:
        """Refuse a scene in which nothing varies.

        Raises:
            InputError: it has no contributor.
        """
        if not self.components:
            raise InputError("expected a scene with tolerances, got none: all its builds are the nominal one")

    @cached_property
    def slices(self) -> Mapping[str, slice]:
        """Columns of each contributor."""
        return component_slices(self.simulation.system)

    def of(self, *names: str) -> "Response":
        """The same of some measures.

        Raises:
            InputError: one is not among them, or is a curve.
        """
        known = {own.name: own for own in self.measures}
        curves = {own.name for own in self.curves.values()}
        for name in names:
            if name in curves and name not in known:
                ends = " or ".join(repr(end) for end, own in self.curves.items() if own.name == name)
                raise InputError(f"expected a measure of one number a trial, got {name!r}, a curve; ask for {ends}")
            if name not in known:
                raise InputError(f"expected a measure, got {name!r}{hint(name, known)}")
        return replace(self, measures=tuple(known[name] for name in names))

    @property
    def copula(self) -> Copula:
        """Correlated contributors; of the normals of each block the first mixes into the others."""
        return self.simulation.copula

    # what is built ----------------------------------------------------------------------------------

    @property
    def mean(self) -> Array:
        """Every contributor at its mean (components,) [mm, rad, K]."""
        row = mean_deviations(self.simulation.system, self.measures[0].positions)[0].copy()
        for name, own in self.slices.items():
            row[own] = self.draws[name].mean(turning=False)
        return np.asarray(row, dtype=np.float64)

    def positions(self, count: int, how: Standing, seed: int = 1) -> Mapping[str, Array]:
        """Positions of rows; see Standing.

        Args:
            count: of rows.
            how: they stand.
            seed: of drawn ones.
        """
        system = self.simulation.system
        many = count if how == "drawn" else 1
        generator = np.random.default_rng(seed)
        uniforms = {key: np.zeros(many) if how == "rest" else generator.random(many) for key in system.streams}
        found = system.positions(uniforms)
        return {name: np.repeat(own, count // many, axis=0) for name, own in found.items()}

    def values(self, deviations: Array, positions: Mapping[str, Array] | None = None) -> Values:
        """Measures of builds.

        Args:
            deviations: (n, components) [mm, rad, K].
            positions: of the system's streams, (n,) each; default: at rest.
        """
        system, deviations = self.simulation.system, np.atleast_2d(np.asarray(deviations, dtype=np.float64))
        if deviations.shape[1] != self.components:
            raise InputError(f"expected deviations (n, {self.components}), got {deviations.shape}")
        trials = stated(system, deviations) if positions is None else Trials(deviations, positions)
        if self.batches is None:
            values, codes = self._evaluated(trials)
        else:
            asked = repr((None if self.method is None else self.simulation.study.engine, self.names))
            builds = {"": trials.deviations, **{f"position {name}": own for name, own in trials.positions.items()}}
            values, codes = self.batches.evaluated(asked, builds, lambda: self._evaluated(trials))
        kept = np.array([own.keeps_overlap for own in self.measures])
        values[(codes != OK) & ~kept] = np.nan
        self.count.evaluations += len(trials)
        return Values(values, codes, system.statuses.texts)

    def _evaluated(self, trials: Trials) -> tuple[Array, Codes]:
        """Values and codes (n, measures) of builds."""
        values = np.empty((len(trials), len(self.measures)))
        codes = np.zeros(values.shape, dtype=np.int8)
        first = 0
        sources = [self.source(own) for own in self.measures]
        evaluation = Evaluation(self.simulation.system, self.method)
        for asked in evaluation.asked(trials, [*{own.name: own for own in sources}.values()]):
            rows = slice(first, first + len(asked.trials))
            first = rows.stop
            for k, (own, source) in enumerate(zip(self.measures, sources, strict=True)):
                found = asked.values[source.name]
                values[rows, k] = found if source is own else ENDS[_end_of(own)](found)
                if self.method is not None and (status := asked.answers.status.get(source.name)) is not None:
                    codes[rows, k] = status
        return values, codes

    def gradient(self, deviations: Array, positions: Mapping[str, Array] | None = None) -> Array:
        """Change of each measure with each component (n, measures, components), in its unit a mm, rad or K.

        By central differences, all in one batch: within their square of the step.

        Args:
            deviations, positions: as of `values`.
        """
        rows = np.atleast_2d(np.asarray(deviations, dtype=np.float64))
        steps, acting = self._steps, self.acting_columns
        shifts = np.zeros((2 * len(acting), self.components))
        shifts[np.arange(len(acting)), acting] = steps[acting]
        shifts[len(acting) + np.arange(len(acting)), acting] = -steps[acting]
        builds = (rows[:, None] + shifts).reshape(-1, self.components)
        places = None if positions is None else {k: np.repeat(own, len(shifts), axis=0) for k, own in positions.items()}
        found = self.values(builds, places).values.reshape(len(rows), 2, len(acting), len(self.measures))
        gradient = np.zeros((len(rows), len(self.measures), self.components))
        gradient[:, :, acting] = np.moveaxis((found[:, 0] - found[:, 1]) / (2 * steps[acting][:, None]), 1, 2)
        return gradient

    @cached_property
    def _steps(self) -> Array:
        found = np.empty(self.components)
        for own in self.contributors:
            found[self.slices[own.name]] = NUDGE.get(own.unit, 1e-3)
        return found

    @cached_property
    def acting_columns(self) -> NDArray[np.int64]:
        """Columns of contributors that act on some of the measures."""
        names = {own.name for measure in self.measures for own in self.acting(measure)}
        columns = [k for name, own in self.slices.items() if name in names for k in range(own.start, own.stop)]
        return np.array(columns, dtype=np.int64)

    def ranges(self, positions: Mapping[str, Array] | None = None) -> Array:
        """Range of each measure over the whole tolerance of each contributor (measures, contributors).

        The others are at their means; NaN where a build cannot be assembled. See study/high_low_mean.py.

        Args:
            positions: one of each stream (1,); default at rest.
        """

        def values(rows: Array, measures: Sequence[Measure]) -> Mapping[str, Array]:
            places = (
                None if positions is None else {k: np.repeat(own, len(rows), axis=0) for k, own in positions.items()}
            )
            found = replace(self, measures=tuple(measures)).values(rows, places)
            numbers = np.where(found.seated, found.values, np.nan).T
            return {own.name: each for own, each in zip(measures, numbers, strict=True)}

        redrawn = [DrawnAs(*own) for own in self.draws.items()]
        found = ranges(redrawn, self.slices, self.mean[None], self.measures, values, self.simulation.system.cost)
        unknown = np.full(len(redrawn), np.nan)
        return np.array([found.get(own.name, unknown) for own in self.measures])

    # what is drawn ----------------------------------------------------------------------------------

    @cached_property
    def normals(self) -> Mapping[str, slice]:
        """Which standard normals are whose."""
        found, first = {}, 0
        for own in self.contributors:
            count = normal_count(self.draws[own.name])
            found[own.name] = slice(first, first + count)
            first += count
        return found

    @property
    def dimension(self) -> int:
        """Number of standard normals."""
        return max((own.stop for own in self.normals.values()), default=0)

    @property
    def rough(self) -> tuple[str, ...]:
        """Contributors without a smooth map from normals: methods that need one refuse them by name."""
        return tuple(own.name for own in self.contributors if groups_of(self.draws[own.name]) is None)

    def read_by(self, names: Collection[str]) -> frozenset[str]:
        """Contributors, those that their draws read, and so on."""
        found, waiting = set(names), list(names)
        while waiting:
            draw = self.draws[waiting.pop()]
            more = set(draw.reads) - found if isinstance(draw, Dependent) else set()
            found |= more
            waiting += more
        return frozenset(found)

    def deviations(self, normals: Array, names: Collection[str] | None = None) -> Array:
        """Deviations (n, components) [mm, rad, K] of standard normals (n, dimension), by the laws of the draws.

        The normals are independent; those of correlated contributors are mixed here.

        Args:
            normals: the rows.
            names: contributors that are wanted, whose columns alone are filled; default: all.
        """
        wanted = self.draws.keys() if names is None else self.read_by(names)
        normals = np.atleast_2d(np.asarray(normals, dtype=np.float64))
        for block in self.copula.blocks:
            places = [self.normals[name].start for name in block.names]
            mixed = block.mixed([normals[:, place] for place in places])
            normals = normals.copy()
            normals[:, places] = np.array(mixed).T
        found = np.zeros((self.components, len(normals)))
        asked = [DrawnAs(name, self.draws[name]) for name in self.slices if name in wanted]

        def uniforms(name: str, count: int) -> Sequence[Array]:
            return uniforms_of(self.draws[name], list(normals[:, self.normals[name]].T))

        fill(found, self.slices, in_draw_order(asked), uniforms)
        return np.ascontiguousarray(found.T)

    def kept(self, count: int, seed: int | None = None) -> KeptDraws:
        """Builds as the study draws them, kept so that other tolerances of a few contributors are drawn at once.

        `kept.redrawn(response.scaled({name: 0.5}).draws)` are the builds of the other response, to the bit.

        Args:
            count: of builds.
            seed: another one than the study's.
        """
        study = self.simulation.study if seed is None else replace(self.simulation.study, seed=seed)
        return kept_draws(replace(self.simulation, study=study), count, self.draws)

    def drawn(self, count: int, seed: int | None = None) -> tuple[Array, Mapping[str, Array]]:
        """Deviations and positions as the study draws them, with its own seed or another one."""
        kept = self.kept(count, seed)
        return kept.deviations, kept.positions

    def drawn_by(self, name: str) -> Draw:
        """Draw of a contributor.

        Raises:
            InputError: no such contributor.
        """
        if name not in self.draws:
            raise InputError(f"expected a contributor, got {name!r}{hint(name, self.draws)}")
        return self.draws[name]

    def with_draws(self, draws: Mapping[str, Draw]) -> "Response":
        """The same system with other tolerances, by contributor; what has been counted goes on.

        Raises:
            InputError: no such contributor, or a draw of other components.
        """
        for name, draw in draws.items():
            own, other = self.drawn_by(name).components, draw.components
            if len(own) != len(other):
                raise InputError(f"{name}: expected a draw of {len(own)} components, got one of {len(other)}")
        return replace(self, draws={**self.draws, **draws})

    def with_laws(self, laws: Mapping[str, Distribution]) -> "Response":
        """The same system with other tolerances, by contributor: deviations as drawn by a scene with these tolerances.

        Raises:
            InputError: no such contributor, one that is not drawn by a law, or deviations that cannot be.
        """
        return self._made_again({name: partial(with_law, law=law) for name, law in laws.items()})

    def scaled(
        self, factors: Mapping[str, float], stays: Mapping[str, Stays] = NOTHING_STAYS, *, physical: bool = True
    ) -> "Response":
        """The same system with tolerances that are so many times as wide, by contributor.

        Args:
            factors: above 0; the others' tolerances are as they are.
            stays: of some of them, which limit does; default: see `naturally_stays`.
            physical: whether deviations below the least physical one are refused; else they are drawn.

        Raises:
            InputError: no such contributor, one whose law cannot be scaled, or deviations that cannot be.
        """
        changes = {name: partial(scaled_draw, factor=factor, stays=stays.get(name)) for name, factor in factors.items()}
        return self._made_again(changes, physical=physical)

    def shifted(self, changes: Mapping[str, float]) -> "Response":
        """The same system with other means of tolerances, by contributor; their widths stay.

        Args:
            changes: of the means [mm, rad or K].

        Raises:
            InputError: no such contributor, one whose law cannot be shifted, or deviations that cannot be.
        """
        return self._made_again({name: partial(shifted_draw, by=by) for name, by in changes.items()})

    def sized(self, widths: Mapping[str, float]) -> "Response":
        """The same system with zones of other widths [mm], by contributor.

        Raises:
            InputError: no such contributor, one that lies in no zone, or no width.
        """
        return self._made_again({name: partial(_sized, width=width) for name, width in widths.items()})

    def _made_again(self, changes: Mapping[str, Callable[[Draw], Draw]], *, physical: bool = True) -> "Response":
        """With other draws, and those that follow them."""
        known = {own.name: own for own in self.contributors}
        made: dict[str, Draw] = {}
        for name, change in changes.items():
            before = self.drawn_by(name)
            try:
                made[name] = change(before)
            except InputError as error:
                raise InputError(f"{name}: {error}") from None
            refuse_held(known[name])
            if physical:
                refuse_impossible(known[name], made[name])
        draws = {**self.draws, **made}
        for name, own in made.items():
            for other, draw in draws.items():
                if other != name and isinstance(draw, Following):
                    draws[other] = draw.following(name, own)
        return self.with_draws({name: draw for name, draw in draws.items() if draw is not self.draws[name]})


def _sized(draw: Draw, width: float) -> Draw:
    if not isinstance(draw, Zoned):
        raise InputError(f"expected a contributor that lies in a zone, got a {type(draw).__name__}")
    return draw.sized(width)


def response_of(simulation: Simulation, *, analytic: bool = False) -> Response:
    """The response of a simulation by its engine's method, or by the analytic one."""
    exact = not analytic and simulation.study.engine != ANALYTIC_METHOD
    method = method_of(simulation, materials_of(simulation)) if exact else None
    measures, curves = list[Measure](), dict[str, Measure]()
    for own in simulation.system.measures:
        ends = _ends(own) if own.take == "curve" else (own,)
        measures += ends
        curves |= {end.name: own for end in ends if end is not own}
    return Response(
        simulation, tuple(measures), method, {own.name: own.draw for own in simulation.system.contributors}, curves
    )


def _ends(curve: Measure) -> tuple[Measure, ...]:
    """The lowest and the highest value of a curve, as measures, with the limits that judge them."""
    if not is_dataclass(curve) or isinstance(curve, type):
        raise InputError(f"{curve.name}: expected a measure of one number a trial, got a curve; read it at a position")
    low: Any = replace(curve, name=f"{curve.name}, {LOWEST}", take="min", upper_limit=None)
    high: Any = replace(curve, name=f"{curve.name}, {HIGHEST}", take="max", lower_limit=None)
    return low, high


def _end_of(measure: Measure) -> str:
    return LOWEST if measure.take == "min" else HIGHEST
