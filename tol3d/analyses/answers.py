"""Analyses as functions, named like their commands; results as tables, frames of pandas and objects.

A function analyses a scene or a run, and keeps the answer in the run, as its command does.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import starmap
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Generic, Literal, TypeVar

from tol3d.analyses.allocation import allocation
from tol3d.analyses.allocation_section import Allocation, allocated_scene, groups_of
from tol3d.analyses.asked_allocation import bounds_of, named_bounds, stays_of, targets_of
from tol3d.analyses.before_after import WhatIf
from tol3d.analyses.before_after import what_if as found_before_after
from tol3d.analyses.changes_of_run import not_ok
from tol3d.analyses.costs import Costs, costs_from
from tol3d.analyses.kept_changes import in_numbers, scene_with
from tol3d.analyses.kept_pages import charts_of, page_of
from tol3d.analyses.methods_section import Methods
from tol3d.analyses.rare_events import Method, RareEvent, limits_left
from tol3d.analyses.rare_section import RareEvents, rare_section
from tol3d.analyses.response import Response
from tol3d.analyses.shown_changes import contributions_table
from tol3d.analyses.shown_effects import whole_table as effects_table
from tol3d.analyses.shown_methods import intervals_table
from tol3d.analyses.shown_what_if import what_if_table
from tol3d.analyses.side_by_side import methods as found_side_by_side
from tol3d.analyses.side_by_side import trials_of
from tol3d.analyses.stated_changes import change_of, changed, factor_of, slips
from tol3d.analyses.stated_classes import sizes_of
from tol3d.analyses.stated_limits import limits_of_text
from tol3d.analyses.stated_sizes import nominals_of
from tol3d.analyses.subject import Subject, subject_of
from tol3d.analyses.sweep_table import whole_table
from tol3d.analyses.tolerance_effects import Effects
from tol3d.analyses.tolerance_effects import effects as found_effects
from tol3d.analyses.tolerance_search import Question
from tol3d.analyses.variant_sweep import Order, Sweep, SweepQuestion
from tol3d.analyses.variant_sweep import sweep as swept
from tol3d.analyses.variants import variable, variable_of
from tol3d.analyses.what_to_change import AIM, Changes, ChangesQuestion, changes_of, contributions_of
from tol3d.errors import InputError
from tol3d.import_path import named
from tol3d.report.chart import Charts
from tol3d.report.page import Page, Table
from tol3d.report.printed import Picture, Report, stacked
from tol3d.scene import Scene
from tol3d.simulate import load
from tol3d.study.execution.watch import Watch
from tol3d.study.runs.run import Run
from tol3d.study.runs.summary.judged import ACCEPTED_PPM, Accepted, AcceptedPpk
from tol3d.study.runs.summary.values import Section
from tol3d.study.system.faults import faults_of
from tol3d.study.trials.overrides import AS_WRITTEN, Overrides

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tol3d.study.runs.frame import DataFrame

Found = TypeVar("Found", bound=Section)
Asked = Scene | Run | Path | str
Texts = Mapping[str, str | float] | Sequence[str]
"""Values by name, or texts NAME=VALUE."""
Activity = Callable[[str], None]


def silent(text: str) -> None:
    """Show no progress."""


@dataclass(frozen=True, repr=False)
class Answer(Report, Generic[Found]):
    """Result of an analysis.

    Args:
        found: its numbers as an object, in the units of the measures.
        numbers: makes the tables of its frame, by measure, or by "" one table of all.
        charts: makes its charts.
        kept: file in the run; None if a scene was analysed.
        warnings: remarks for the user.
        whole: True if the tables of the frame are not printed; --csv then writes them instead of the printed ones.
    """

    found: Found
    numbers: Callable[[], Mapping[str, Table]]
    charts: Callable[[], Charts]
    kept: Path | None = None
    warnings: tuple[str, ...] = ()
    whole: bool = False

    def csv(self) -> str:
        """Numbers as its command writes them by --csv."""
        return "\n".join(table.csv() for table in self.numbers().values()) if self.whole else super().csv()

    def frame(self) -> "DataFrame":
        """Its main table as a DataFrame of pandas, with all digits; tables of several measures have a column for them.

        Raises:
            MissingPackageError: pandas is not installed.
        """
        return stacked(self.numbers())

    def figure(self) -> "Figure":
        """Its charts as a figure of matplotlib, as its command draws them by --picture."""
        figure: Figure = named("tol3d.report.chart_figure:figure_of")(self.charts())
        return figure


@dataclass(frozen=True, repr=False)
class RareAnswer(Answer[RareEvents]):
    """Result of an analysis of rare events.

    Args:
        events: one per measure and limit, with all design points.
    """

    events: tuple[RareEvent, ...] = ()


@dataclass(frozen=True, repr=False)
class OtherTolerances(Answer[Found]):
    """Findings on other tolerances.

    Args:
        before: the scene with its own tolerances.
        write: makes the scene with the other ones.
    """

    before: Callable[[], Scene] | None = None
    write: Callable[[], Scene] | None = None

    @cached_property
    def scene(self) -> Scene:
        """The scene with the other tolerances.

        Raises:
            InputError: the scene does not state the width of a tolerance by numbers.
        """
        assert self.write is not None
        return self.write()

    @property
    def in_numbers(self) -> Mapping[str, str]:
        """Words on limits of a standard that are numbers in `scene`, by tolerance."""
        assert self.before is not None
        return in_numbers(self.before(), self.scene)


@dataclass(frozen=True, repr=False)
class Variants(Answer[Sweep]):
    """Result of a sweep over variants of a scene; its frame has a row per variant, with all numbers of all measures.

    Args:
        picture: of them; None if not requested.
    """

    picture: Picture | None = None


@dataclass
class _Progress:
    """A progress callback that is also called between the pieces of an evaluation."""

    tell: Activity
    text: str = ""

    def __call__(self, text: str) -> None:
        self.text = text
        self.tell(text)

    def between(self, done: int, builds: int) -> None:
        """Tell how many of the builds being evaluated are done."""
        self.tell(f"{self.text}, {done} of {builds} builds")


@dataclass
class _Variants:
    """A progress callback of a sweep."""

    tell: Activity
    text: str = ""
    trials: int = 0

    def done(self, number: int, of: int, words: str) -> None:
        """Tell how many variants are done."""
        del words
        self.text, self.trials = f"{number} of {of} variants", 0
        self.tell(self.text)

    def progress(self, trials: int) -> None:
        """Tell how many trials of the next one are done."""
        self.trials += trials
        self.tell(f"{self.text}, {self.trials} trials of the next")


@contextmanager
def _analysed(
    subject: Asked | Subject, tell: Activity, *, trust_parts: bool, run_builders: bool
) -> Iterator[tuple[Subject, Response, Activity]]:
    """The subject of an analysis, its response and progress callback; batches are kept only until it ends.

    An exception raised by `tell` stops the analysis; with the same Subject again it goes on from the batches it kept.
    """
    if not isinstance(subject, Subject):
        subject = subject_of(subject, trust_parts=trust_parts, run_builders=run_builders)
    progress = _Progress(tell)
    with faults_of(subject.simulation.mechanism):
        yield subject, replace(subject.response, between=progress.between), progress
    subject.batches.clear()


def _kept(
    subject: Subject, name: str, result: Found, numbers: Callable[[Page], Mapping[str, Table]]
) -> tuple[Page, Found, Callable[[], Mapping[str, Table]], Callable[[], Charts], Path | None]:
    """Arguments of every answer: page, numbers, functions that make tables and charts, and the run's file."""
    page = page_of(name, result, subject.name)
    charts = partial(charts_of, name, result, subject.name)
    return page, result, lambda: numbers(page), charts, subject.keep(name, result)


def _first_table(page: Page) -> Mapping[str, Table]:
    return {"": page.tables[0]}


def _one_of(option: str, word: str, known: Sequence[str]) -> str:
    """The word; refused if it is not a known one."""
    if word not in known:
        raise InputError(f"{option}: expected {', '.join(known[:-1])} or {known[-1]}, got {word!r}")
    return word


def _texts(given: Texts) -> list[str]:
    return [f"{name}={value}" for name, value in given.items()] if isinstance(given, Mapping) else [*given]


def what_if(
    subject: Asked | Subject,
    *,
    set: Texts = (),
    factor: Texts = (),
    limits: Texts = (),
    measure: str | None = None,
    trials: int | None = None,
    draws: int = 4800,
    quick: bool = False,
    seed: int = 1,
    activity: Activity = silent,
    warn: Activity = silent,
    trust_parts: bool = False,
    run_builders: bool = False,
) -> OtherTolerances[WhatIf]:
    """Effect of other tolerances, as `tol3d what-if` finds it.

    Args:
        subject: a scene or a run, its path, or the name of a bundled scene.
        set: other tolerances by name, such as {"centre distance": "±10 um"}.
        factor: factors on the widths of other tolerances, by name.
        limits: other limits of measures by name, such as {"normal backlash": "10 um..40 um"}.
        measure: its name; default: all that depend on the changed tolerances, and those with other limits.
        trials: of the simulation; default: the study's.
        draws: of importance sampling, for each limit.
        quick: True for rates and first order alone, without a simulation.
        seed: of importance sampling.
        activity: progress callback, called about every 0.1 s of evaluations; an exception in it stops the analysis.
        warn: callback for warnings, before anything is simulated.
        trust_parts, run_builders: see run_scene.

    Raises:
        InputError: no such tolerance, measure or value, or none on which a measure depends.
    """
    with _analysed(subject, activity, trust_parts=trust_parts, run_builders=run_builders) as (analysed, response, tell):
        sizes = sizes_of(analysed.scene, analysed.simulation.lines)
        nominals = nominals_of(analysed.scene, analysed.simulation.lines)
        changes = [change_of(response, text, sizes, nominals) for text in _texts(set)]
        changes += [factor_of(response, text) for text in _texts(factor)]
        others = [limits_of_text(response, text) for text in _texts(limits)]
        warnings = tuple(slips(response, changed(response, changes)))
        for words in warnings:
            warn(words)
        trials, draws = (0, 0) if quick else (trials, draws)
        result = found_before_after(
            response, changes, measure, limits=others, trials=trials, draws=draws, seed=seed, activity=tell
        )
    numbers = {name: what_if_table(each) for name, each in result.measures.items()}

    def write() -> Scene:
        return scene_with(response, analysed.scene, changes, others)

    kept = _kept(analysed, "what-if", result, lambda page: numbers)
    return OtherTolerances(*kept, warnings, before=lambda: analysed.scene, write=write)


def effects(
    subject: Asked | Subject,
    *,
    measure: str | None = None,
    base: int | None = None,
    seed: int = 1,
    position: Literal["averaged", "as-input"] = "averaged",
    shapley: bool = False,
    activity: Activity = silent,
    trust_parts: bool = False,
    run_builders: bool = False,
) -> Answer[Effects]:
    """Effect of each contributor on each measure, as `tol3d effects` finds it.

    Args:
        subject: a scene or a run, its path, or the name of a bundled scene.
        measure: its name; default: all that are one number per trial.
        base: pairs of builds, a power of two; default: as time allows.
        seed: of their points.
        position: indices at a position, averaged; or the position as an input as well.
        shapley: True for Shapley effects, too, also if nothing is correlated.
        activity, trust_parts, run_builders: see what_if.

    Raises:
        InputError: no such measure or position, or a base that is no power of two.
    """
    with _analysed(subject, activity, trust_parts=trust_parts, run_builders=run_builders) as (analysed, response, tell):
        response = response if measure is None else response.of(measure)
        as_input = _one_of("position", position, ("averaged", "as-input")) == "as-input"
        result = found_effects(response, base=base, seed=seed, position=as_input, shapley=shapley, activity=tell)
    return Answer(*_kept(analysed, "effects", result, lambda page: {"": effects_table(result)}), whole=True)


def rare(
    subject: Asked | Subject,
    *,
    measure: str | None = None,
    method: Method | Literal["auto"] = "auto",
    draws: int | None = None,
    seed: int = 1,
    activity: Activity = silent,
    trust_parts: bool = False,
    run_builders: bool = False,
) -> RareAnswer:
    """Fraction of builds beyond each limit, also if too rare for plain trials, as `tol3d rare` finds it.

    Args:
        subject: a scene or a run, its path, or the name of a bundled scene.
        measure: whose limits are analysed; default: those of all measures.
        method: importance, subset, form or sorm; default: by the contributors.
        draws: of importance sampling (default 4800), or per level of subset simulation (default 14000).
        seed: of the draws.
        activity, trust_parts, run_builders: see what_if.

    Raises:
        InputError: no such measure or method, or no limit.
    """
    with _analysed(subject, activity, trust_parts=trust_parts, run_builders=run_builders) as (analysed, response, tell):
        _one_of("method", method, ("auto", "importance", "subset", "form", "sorm"))
        events = limits_left(response, measure, method=method, draws=draws, seed=seed, activity=tell)
        result = rare_section(analysed.name, seed, response, events)
    return RareAnswer(*_kept(analysed, "rare", result, _first_table), events=tuple(events))


def changes(
    subject: Asked | Subject,
    *,
    measure: str | None = None,
    accept: float | None = None,
    accept_ppk: float | None = None,
    builds: int | None = None,
    activity: Activity = silent,
    trust_parts: bool = False,
    run_builders: bool = False,
) -> Answer[Changes]:
    """Changes to a scene whose measures leave their limits, as `tol3d changes` finds them.

    Args:
        subject: a scene or a run, its path, or the name of a bundled scene.
        measure: its name; default: all that are NOT OK.
        accept: accepted builds out of limits [ppm]; default: as the study states.
        accept_ppk: required Ppk, instead.
        builds: number by which each change is judged; default: 5000, or fewer if slow.
        activity, trust_parts, run_builders: see what_if.

    Raises:
        InputError: no such measure, none with limits, or both `accept` and `accept_ppk`.
    """
    if accept is not None and accept_ppk is not None:
        raise InputError("expected accept or accept_ppk, got both")
    with _analysed(subject, activity, trust_parts=trust_parts, run_builders=run_builders) as (analysed, response, tell):
        ppk = analysed.simulation.study.accept_ppk if accept is None and accept_ppk is None else accept_ppk
        accepted: Accepted = (ACCEPTED_PPM if accept is None else accept) if ppk is None else AcceptedPpk(ppk)
        ppm, aim = (accepted.beyond_one_ppm, accepted.ppk) if isinstance(accepted, AcceptedPpk) else (accepted, AIM)
        bad = None if analysed.run is None else not_ok(analysed.run, accepted)
        result = changes_of(response, ChangesQuestion(measure, ppm, builds, aim), bad=bad, activity=tell)

    def numbers(page: Page) -> Mapping[str, Table]:
        return {"": contributions_table(contributions_of(response, measure))}

    return Answer(*_kept(analysed, "changes", result, numbers), whole=True)


def methods(
    subject: Asked | Subject,
    *,
    measure: str | None = None,
    trials: int | None = None,
    activity: Activity = silent,
    trust_parts: bool = False,
    run_builders: bool = False,
) -> Answer[Methods]:
    """Worst case, RSS, modified RSS and simulation side by side, as by `tol3d methods`.

    Args:
        subject: a scene or a run, its path, or the name of a bundled scene.
        measure: its name; default: all.
        trials: of the simulation; default: the study's, 20 000 at most, or those of the run.
        activity, trust_parts, run_builders: see what_if.

    Raises:
        InputError: no such measure.
    """
    with _analysed(subject, activity, trust_parts=trust_parts, run_builders=run_builders) as (analysed, response, tell):
        response = response if measure is None else response.of(measure)
        result = found_side_by_side(response, trials_of(analysed, response, trials), tell)
    numbers = {name: intervals_table(each) for name, each in result.measures.items()}
    return Answer(*_kept(analysed, "methods", result, lambda page: numbers))


def allocate(
    subject: Asked | Subject,
    *,
    ppm: float | None = None,
    ppk: float | None = None,
    measure: Sequence[str] = (),
    cost: Path | str | None = None,
    bounds: str = "0.5..3",
    bound: Texts = (),
    freeze: Sequence[str] = (),
    stays: Texts = (),
    beyond_least: bool = False,
    draws: int = 12_000,
    seed: int = 1,
    activity: Activity = silent,
    trust_parts: bool = False,
    run_builders: bool = False,
) -> OtherTolerances[Allocation]:
    """Tolerances of least cost for a fraction out of limits, as `tol3d allocate` finds them.

    Args:
        subject: a scene or a run, its path, or the name of a bundled scene.
        ppm: accepted builds out of the limits of each measure [ppm].
        ppk: required Ppk at each limit, instead; default: 1.33.
        measure: NAME or NAME:low, NAME:high; default: all that have limits.
        cost: YAML file of costs by contributor; default: 1 over the factor.
        bounds: of all factors.
        bound: bounds of single contributors' factors, by name, such as {"runout": "0.8..1.2"}.
        freeze: names of tolerances that are not changed.
        stays: limit that stays, "low" or "high", instead of the middle, by name.
        beyond_least: True to draw below the physical minimum, such as clearances below 0.
        draws: of each importance sampling, for each limit.
        seed: of the draws.
        activity, trust_parts, run_builders: see what_if.

    Raises:
        InputError: no such measure or tolerance, wrong bounds, or targets out of reach within the bounds.
    """
    with _analysed(subject, activity, trust_parts=trust_parts, run_builders=run_builders) as (analysed, response, tell):
        groups = groups_of(response)
        question = Question(
            costs=Costs() if cost is None else costs_from(Path(cost), groups),
            bounds=bounds_of("--bounds", bounds),
            own_bounds=named_bounds(_texts(bound)),
            frozen=frozenset(freeze),
            stays=stays_of(_texts(stays), groups),
            groups=groups,
            beyond_least=beyond_least,
        )
        targets = targets_of(response, [measure] if isinstance(measure, str) else measure, ppm, ppk)
        result = allocation(response, targets, question, draws=draws, seed=seed, activity=tell)

    def write() -> Scene:
        return allocated_scene(analysed.scene, response, result, question.stays)

    return OtherTolerances(
        *_kept(analysed, "allocation", result, _first_table), before=lambda: analysed.scene, write=write
    )


def sweep(
    scene: Scene | Path | str,
    vary: Mapping[str, str | Sequence[str | float]] | Sequence[str],
    *,
    latin_hypercube: int | None = None,
    hypercube_seed: int = 1,
    out: Path | str | None = None,
    picture: Path | str | None = None,
    overrides: Overrides = AS_WRITTEN,
    workers: int = 1,
    activity: Activity = silent,
    trust_parts: bool = False,
    run_builders: bool = False,
) -> Variants:
    """Variants of a scene, each simulated with the same draws, as by `tol3d sweep`.

    Args:
        scene: a scene, its path, or the name of a bundled one.
        vary: values of fields, as a list or as text: "10um,20um", "17..25:2", "10um..30um"; or texts FIELD=VALUES.
        latin_hypercube: number of variants drawn from ranges; None for a grid.
        hypercube_seed: of that draw.
        out: folder that keeps the variants, from which a sweep goes on; None keeps none.
        picture: file for a picture of them.
        overrides: values that replace those of the scene's study, for all variants.
        workers: number of processes for the trials of a variant.
        activity: progress callback, called before the first variant too; an exception in it stops the sweep.
        trust_parts, run_builders: see run_scene.

    Raises:
        InputError: no such field, or values that it cannot have.
    """
    variables = starmap(variable, vary.items()) if isinstance(vary, Mapping) else map(variable_of, vary)
    question, told = SweepQuestion(tuple(variables), latin_hypercube, hypercube_seed), _Variants(activity)
    loaded = load(scene, trust_parts=trust_parts, run_builders=run_builders)
    with TemporaryDirectory(prefix="tol3d-") as temporary:
        folder = Path(temporary) if out is None else Path(out)
        how = Order(
            folder,
            overrides,
            workers,
            trust_parts=trust_parts,
            run_builders=run_builders,
            watch=Watch(progress=told.progress),
            done=told.done,
        )
        result = swept(loaded, question, how)
    shown = page_of("sweep", result, loaded.scene), result, lambda: {"": whole_table(result)}
    charts = partial(charts_of, "sweep", result, loaded.scene)
    if picture is not None:
        named("tol3d.report.chart_figure:save_charts")(charts(), Path(picture))
    return Variants(*shown, charts, whole=True, picture=None if picture is None else Picture(Path(picture)))
