"""Response of a scene, the basis of every analysis: values of its measures for batches of deviations or normals.

A response is a simulation, one of its methods and some of its measures. It knows no mechanism; deviations are columns
of the contributors, positions those of the system's streams.
"""

import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, is_dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Final, Literal, NoReturn, TypeVar

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.kept_batches import KeptBatches
from tol3d.analyses.scope import Scope, scope_of
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.scene.nearest import hint
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.base import Stays
from tol3d.study.effects.acting_contributors import acting, nothing_acts
from tol3d.study.effects.high_low_mean import ranges
from tol3d.study.execution.pace import Pace
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.runs.frame import frame_of
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import Copula
from tol3d.study.system.dependent import Dependent, DrawnAs, in_draw_order
from tol3d.study.system.draw import Draw
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import ANALYTIC_METHOD, Method
from tol3d.study.system.normals import groups_of, normal_count, uniforms_of
from tol3d.study.system.other_laws import Following, Zoned, refuse_held, refuse_impossible, with_law
from tol3d.study.system.other_laws import scaled as scaled_draw
from tol3d.study.system.other_laws import shifted as shifted_draw
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC, OK, status_column, value_column
from tol3d.study.system.stated import component_count, component_slices, mean_deviations, stated
from tol3d.study.system.trials import Trials
from tol3d.study.tallies.curve_tally import ENDS, HIGHEST, LOWEST
from tol3d.study.trials.columns import drawn_columns
from tol3d.study.trials.draws import KeptDraws, fill, kept_draws
from tol3d.study.trials.evaluation import BATCH, Evaluation
from tol3d.study.trials.simulation import Simulation

if TYPE_CHECKING:
    from tol3d.study.runs.frame import DataFrame

T = TypeVar("T")
Codes = NDArray[np.int8]
Standing = Literal["rest", "averaged", "drawn"]
"""Positions of rows: at rest, the same drawn ones in all rows that are compared, or each row's own."""

NOTHING_STAYS: Final[Mapping[str, Stays]] = {}

NUDGE: Final[Mapping[str, float]] = {"um": 1e-3, "arcmin": 1e-5, "K": 0.1, "1": 1e-3}
"""Steps of central differences [mm, rad, K or shares], by the unit of a contributor's columns."""

SHOWN: Final = 5
"""Measures that a response names where it shows itself."""


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
    def statuses(self) -> NDArray[np.str_]:
        """Status of each in words (n, measures)."""
        return np.asarray(np.array(self.texts)[self.codes])

    @property
    def seated(self) -> NDArray[np.bool_]:
        """True where a value is assembled and measured (n, measures)."""
        return np.asarray(self.codes == OK)


@dataclass
class Count:
    """Count of evaluated builds; shared by all responses made from one."""

    evaluations: int = 0


class _Known(dict[str, T]):
    """By name; an unknown one is refused as a user's mistake.

    Args:
        what: a name stands for, with its article.
        named: the content.
    """

    def __init__(self, what: str, named: Mapping[str, T]) -> None:
        super().__init__(named)
        self.what = what

    def __missing__(self, name: str) -> NoReturn:
        raise InputError(f"expected {self.what}, got {name!r}{hint(str(name), self)}")


@dataclass(frozen=True, eq=False, repr=False)
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
        between: called between the pieces of an evaluation, with how many builds are done and how many there are; what
            it raises stops the evaluation.
        paces: of the pieces of evaluations by the method and the measures.
    """

    simulation: Simulation
    measures: tuple[Measure, ...]
    method: Method | None
    draws: Mapping[str, Draw]
    curves: Mapping[str, Measure] = field(default_factory=dict)
    count: Count = field(default_factory=Count)
    batches: KeptBatches | None = None
    between: Callable[[int, int], None] | None = None
    paces: dict[tuple[bool, tuple[str, ...]], Pace] = field(default_factory=dict)

    def __repr__(self) -> str:
        shown = ", ".join(self.names[:SHOWN]) + (", …" if len(self.names) > SHOWN else "")
        how = ANALYTIC if self.method is None else self.simulation.study.engine
        return f"<Response of {self.simulation.system.name}, {how}: {shown}; {len(self.draws)} contributors>"

    @property
    def evaluations(self) -> int:
        """Number of builds evaluated."""
        return self.count.evaluations

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the measures."""
        return tuple(measure.name for measure in self.measures)

    @property
    def contributors(self) -> Sequence[Contributor]:
        """All of the system's."""
        return self.simulation.system.contributors

    @cached_property
    def lines(self) -> Mapping[str, tuple[str, ...]]:
        """Contributors by the line of the scene that states their tolerance, and is changed for all of them at once."""
        found = {line.name: line.contributors for line in self.simulation.lines}
        stated = {name for own in found.values() for name in own}
        found |= {
            contributor.name: (contributor.name,) for contributor in self.contributors if contributor.name not in stated
        }
        return _Known("a line of the scene that states a tolerance", found)

    def source(self, measure: Measure) -> Measure:
        """The system's own measure: of an end of a curve the curve."""
        return self.curves.get(measure.name, measure)

    def acting(self, measure: Measure) -> Sequence[Contributor]:
        """Contributors that act on one of the measures; see study/effects/acting_contributors.py."""
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
        return _Known("a contributor", component_slices(self.simulation.system))

    def of(self, *names: str) -> "Response":
        """The same of some measures.

        Raises:
            InputError: one is not among them, or is a curve.
        """
        known = {measure.name: measure for measure in self.measures}
        curves = {curve.name for curve in self.curves.values()}
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

        Raises:
            InputError: other columns than the components, or positions that are not those of the system.
        """
        system, trials = self.simulation.system, self._trials(deviations, positions)
        if self.batches is None:
            values, codes = self._in_pieces(trials)
        else:
            asked = repr((None if self.method is None else self.simulation.study.engine, self.names))
            builds = {"": trials.deviations, **{f"position {name}": own for name, own in trials.positions.items()}}
            values, codes = self.batches.evaluated(asked, builds, lambda: self._in_pieces(trials))
        kept = np.array([measure.keeps_overlap for measure in self.measures])
        values[(codes != OK) & ~kept] = np.nan
        self.count.evaluations += len(trials)
        return Values(values, codes, system.statuses.texts)

    def _trials(self, deviations: Array, positions: Mapping[str, Array] | None) -> Trials:
        system, deviations = self.simulation.system, np.atleast_2d(np.asarray(deviations, dtype=np.float64))
        if deviations.ndim != 2 or deviations.shape[1] != self.components:
            raise InputError(f"expected deviations (n, {self.components}), got {deviations.shape}")
        if positions is None:
            return stated(system, deviations)
        trials = Trials(deviations, positions)
        wanted = dict.fromkeys(self._positions, (len(trials),))
        if (got := {name: np.shape(own) for name, own in positions.items()}) != wanted:
            raise InputError(f"expected positions {wanted}, by name, got {got}")
        return trials

    @cached_property
    def _positions(self) -> tuple[str, ...]:
        """Names of the positions."""
        return tuple(self.positions(1, "rest"))

    def frame(self, deviations: Array, positions: Mapping[str, Array] | None = None) -> "DataFrame":
        """Builds and their measures as a DataFrame of pandas, a row a build, under the names of a run's columns.

        Args:
            deviations, positions: as of `values`.

        Raises:
            InputError: as `values`. MissingPackageError: pandas is not installed.
        """
        system, found = self.simulation.system, self.values(deviations, positions)
        columns = drawn_columns(system, self._trials(deviations, positions))
        for name, values, codes in zip(self.names, found.values.T, found.codes.T, strict=True):
            columns[value_column(ANALYTIC if self.method is None else GEOMETRIC, name)] = values
            if self.method is not None:
                columns[status_column(name)] = system.statuses.by_code[codes]
        return frame_of(columns, {})

    def _in_pieces(self, trials: Trials) -> tuple[Array, Codes]:
        """As `_evaluated`, piece by piece where somebody wants to know how far it is."""
        if self.between is None:
            return self._evaluated(trials)
        found, first = list[tuple[Array, Codes]](), 0
        pace = self.paces.setdefault((self.method is None, self.names), Pace.of(60.0 * self.minutes))
        while first < len(trials):
            last, begun = min(first + pace.count, len(trials)), time.perf_counter()
            found.append(self._evaluated(trials.part(first, last)))
            pace.took(last - first, time.perf_counter() - begun)
            first = last
            self.between(first, len(trials))
        if not found:
            return self._evaluated(trials)
        return np.concatenate([values for values, _ in found]), np.concatenate([codes for _, codes in found])

    def _evaluated(self, trials: Trials) -> tuple[Array, Codes]:
        """Values and codes (n, measures) of builds."""
        values = np.empty((len(trials), len(self.measures)))
        codes = np.zeros(values.shape, dtype=np.int8)
        first = 0
        sources = [self.source(measure) for measure in self.measures]
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

    def pieces(self, deviations: Array, positions: Mapping[str, Array] | None = None) -> Iterator[tuple[slice, Values]]:
        """Measures of builds piece by piece, with the rows of each: the same bits as `values` gives all at once.

        Between two pieces the caller shows what there is, or stops. The first has 64 builds, or fewer where they are
        dear; the others last some 0.1 s each, or up to 0.5 s where much of that does not grow with builds.

        Args:
            deviations, positions: as of `values`.
        """
        builds = np.atleast_2d(np.asarray(deviations, dtype=np.float64))
        whole, pace, first = replace(self, between=None), Pace.of(60.0 * self.minutes), 0
        while first < len(builds):
            rows = slice(first, min(first + pace.count, len(builds)))
            begun = time.perf_counter()
            values = whole.values(builds[rows], _at(positions, rows))
            pace.took(rows.stop - rows.start, time.perf_counter() - begun)
            yield rows, values
            first = rows.stop

    def gradient(
        self,
        deviations: Array,
        positions: Mapping[str, Array] | None = None,
        names: Sequence[str] | None = None,
    ) -> Array:
        """Change of each measure with each component (n, measures, components), in its unit a mm, rad or K.

        By central differences, in batches that fit the memory: within their square of the step.

        Args:
            deviations, positions: as of `values`.
            names: contributors whose components alone are moved, and returned in this order; default: all, of which
                those that act on no measure are not moved.

        Raises:
            InputError: no such contributor.
        """
        rows = np.atleast_2d(np.asarray(deviations, dtype=np.float64))
        if names is None:
            found = np.zeros((len(rows), len(self.measures), self.components))
            found[:, :, self.acting_columns] = self._slopes(rows, positions, self.acting_columns)
            return found
        own = [self.slices[name] for name in names]
        columns = [k for one in own for k in range(one.start, one.stop)]
        return self._slopes(rows, positions, np.array(columns, dtype=np.int64))

    def _slopes(self, rows: Array, positions: Mapping[str, Array] | None, columns: NDArray[np.int64]) -> Array:
        """Slopes by some components (n, measures, columns)."""
        steps, pairs = self._steps[columns], np.arange(len(columns))
        shifts = np.zeros((2 * len(columns), self.components))
        shifts[pairs, columns], shifts[len(columns) + pairs, columns] = steps, -steps
        many = max(1, BATCH // max(shifts.size, 1))
        found = np.empty((len(rows), len(self.measures), len(columns)))
        for first in range(0, len(rows), many):
            some = slice(first, first + many)
            builds = (rows[some, None] + shifts).reshape(len(rows[some]) * len(shifts), self.components)
            places = {name: np.repeat(own, len(shifts), axis=0) for name, own in (_at(positions, some) or {}).items()}
            values = self.values(builds, None if positions is None else places).values
            either = values.reshape(len(rows[some]), 2, len(columns), len(self.measures))
            found[some] = np.moveaxis((either[:, 0] - either[:, 1]) / (2 * steps[:, None]), 1, 2)
        return found

    @cached_property
    def _steps(self) -> Array:
        found = np.empty(self.components)
        for contributor in self.contributors:
            found[self.slices[contributor.name]] = NUDGE.get(contributor.unit, 1e-3)
        return found

    @cached_property
    def acting_columns(self) -> NDArray[np.int64]:
        """Columns of contributors that act on some of the measures."""
        names = {own.name for measure in self.measures for own in self.acting(measure)}
        columns = [k for name, own in self.slices.items() if name in names for k in range(own.start, own.stop)]
        return np.array(columns, dtype=np.int64)

    def ranges(self, positions: Mapping[str, Array] | None = None) -> Array:
        """Range of each measure over the whole tolerance of each contributor (measures, contributors).

        The others are at their means; NaN where a build cannot be assembled. See study/effects/high_low_mean.py.

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
        return np.array([found.get(measure.name, unknown) for measure in self.measures])

    # what is drawn ----------------------------------------------------------------------------------

    @cached_property
    def normals(self) -> Mapping[str, slice]:
        """Which standard normals are whose."""
        found, first = {}, 0
        for contributor in self.contributors:
            count = normal_count(self.draws[contributor.name])
            found[contributor.name] = slice(first, first + count)
            first += count
        return _Known("a contributor", found)

    @property
    def dimension(self) -> int:
        """Number of standard normals."""
        return max((normal.stop for normal in self.normals.values()), default=0)

    @property
    def rough(self) -> tuple[str, ...]:
        """Contributors without a smooth map from normals: methods that need one refuse them by name."""
        return tuple(
            contributor.name for contributor in self.contributors if groups_of(self.draws[contributor.name]) is None
        )

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
        if not isinstance(count, int | np.integer) or count < 0:
            raise InputError(f"expected a number of builds, got {count!r}")
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
        return replace(self, draws=_Known("a contributor", {**self.draws, **draws}))

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
        for name in stays:
            self.drawn_by(name)
        changes = {name: partial(scaled_draw, factor=factor, stays=stays.get(name)) for name, factor in factors.items()}
        return self._made_again(changes, physical=physical)

    def scope(self, name: str) -> Scope:
        """Factors that `scaled` accepts for a contributor, or for all of a line of the scene, and why no others.

        Raises:
            InputError: no such contributor or line.
        """
        names = self.lines.get(name, (name,))
        for own in names:
            self.drawn_by(own)
        return scope_of(lambda factor: self.scaled(dict.fromkeys(names, factor)))

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
        known = {contributor.name: contributor for contributor in self.contributors}
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


def _at(positions: Mapping[str, Array] | None, rows: slice) -> Mapping[str, Array] | None:
    return None if positions is None else {name: own[rows] for name, own in positions.items()}


def response_of(simulation: Simulation, *, analytic: bool = False) -> Response:
    """The response of a simulation by its engine's method, or by the analytic one."""
    exact = not analytic and simulation.study.engine != ANALYTIC_METHOD
    method = method_of(simulation, materials_of(simulation)) if exact else None
    measures, curves = list[Measure](), dict[str, Measure]()
    for measure in simulation.system.measures:
        ends = _ends(measure) if measure.take == "curve" else (measure,)
        measures += ends
        curves |= {end.name: measure for end in ends if end is not measure}
    draws = _Known(
        "a contributor", {contributor.name: contributor.draw for contributor in simulation.system.contributors}
    )
    return Response(simulation, tuple(measures), method, draws, curves)


def _ends(curve: Measure) -> tuple[Measure, ...]:
    """The lowest and the highest value of a curve, as measures, with the limits that judge them."""
    if not is_dataclass(curve) or isinstance(curve, type):
        raise InputError(f"{curve.name}: expected a measure of one number a trial, got a curve; read it at a position")
    low: Any = replace(curve, name=f"{curve.name}, {LOWEST}", take="min", upper_limit=None)
    high: Any = replace(curve, name=f"{curve.name}, {HIGHEST}", take="max", lower_limit=None)
    return low, high


def _end_of(measure: Measure) -> str:
    return LOWEST if measure.take == "min" else HIGHEST
