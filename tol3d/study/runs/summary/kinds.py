"""Additions of mechanisms to a summary: classes of their measures, by kind, and sections of their own."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from importlib import import_module
from operator import or_
from typing import Annotated, Any, Literal, get_args

from pydantic import Field, create_model

from tol3d.import_path import REGISTRY
from tol3d.scene.published import PublishedFigures
from tol3d.scene.published.whole import PublishedWhole
from tol3d.study.runs.summary.agreement import WitnessSummary
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.published import in_summary
from tol3d.study.runs.summary.run import RunSummary, StudySummary
from tol3d.study.runs.summary.values import LEFT_OUT, MOST_ENTRIES, Label, Section


@dataclass(frozen=True)
class SummaryKinds:
    """Contents that summaries may have besides those of every summary.

    Args:
        measures: classes of measures; `kind` of each is a Literal of the kinds that it is for.
        runs: classes that add sections to the whole, as keys that may be missing.
        plain: kinds of measures that add no key, each with the import path of its system's presenter, or "".
        options: classes of the vocabularies' study options, also for a witness, as keys that may be missing.
        presenters: names of mechanisms, each with the import path of its presenter.
        published: classes of published figures beside measures, as scenes have them; besides those of any run.
        common: classes that are for all kinds of measures of the mechanism that names them here; see `stating`.
        stated: the same with these kinds.
    """

    measures: tuple[type[MeasureSummary], ...] = ()
    runs: tuple[type[RunSummary], ...] = ()
    plain: tuple[tuple[str, str], ...] = ()
    options: tuple[type[Section], ...] = ()
    presenters: tuple[tuple[str, str], ...] = ()
    published: tuple[type[PublishedFigures], ...] = ()
    common: tuple[type[MeasureSummary], ...] = ()
    stated: tuple[tuple[type[MeasureSummary], tuple[str, ...]], ...] = ()

    def stating(self, words: tuple[str, ...]) -> "SummaryKinds":
        """The same, with the kinds of measures that a mechanism has."""
        return replace(self, common=(), stated=(*self.stated, *((each, words) for each in self.common if words)))

    def __or__(self, other: "SummaryKinds") -> "SummaryKinds":
        """Both together."""
        return SummaryKinds(
            measures=(*self.measures, *other.measures),
            runs=(*self.runs, *other.runs),
            plain=(*self.plain, *other.plain),
            options=(*self.options, *other.options),
            presenters=(*self.presenters, *other.presenters),
            published=(*self.published, *other.published),
            common=(*self.common, *other.common),
            stated=(*self.stated, *other.stated),
        )

    @cached_property
    def every_measure(self) -> tuple[type[MeasureSummary], ...]:
        """The classes of measures, those of plain ones last."""
        presenters = dict.fromkeys(presenter for _, presenter in self.plain)
        return *self.measures, *(_of_kinds(each, words) for each, words in self.stated), *map(self._plain, presenters)

    def _plain(self, presenter: str) -> type[MeasureSummary]:
        """The class of the plain measures that something shows."""
        kinds = tuple(kind for kind, its in self.plain if its == presenter)
        kind: Any = (Literal[kinds], ...)
        made = create_model("PlainMeasure", __base__=MeasureSummary, __doc__="A measure.", kind=kind)
        made.presenter = presenter
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled by its parts: classes made from it are made anew."""
        own = (self.measures, self.runs, self.plain, self.options, self.presenters, self.published)
        return SummaryKinds, (*own, self.common, self.stated)

    @cached_property
    def run(self) -> type[RunSummary]:
        """The class of a whole summary."""
        measure: Any = reduce(or_, self.every_measure) if self.every_measure else MeasureSummary
        if len(self.every_measure) > 1:
            measure = Annotated[measure, Field(discriminator="kind")]
        measures = Annotated[Mapping[Label, measure], Field(min_length=1, max_length=MOST_ENTRIES)]
        base: Any = self.runs or RunSummary
        found: type[RunSummary] = create_model(
            RunSummary.__name__,
            __base__=base,
            __doc__=RunSummary.__doc__,
            measures=(measures, ...),
            study=(self._with_options(StudySummary), ...),
            witness=(self._with_options(WitnessSummary), LEFT_OUT),
            published=(self._columns, RunSummary.model_fields["published"]),
        )
        found.presenters = dict(self.presenters)
        return found

    @property
    def _columns(self) -> Any:
        """Published figures beside measures, by column."""
        bases: Any = tuple(in_summary(each) for each in (*self.published, PublishedWhole))
        column: Any = create_model("PublishedOfTheWhole", __base__=bases, __doc__="Published figures of the whole.")
        return Annotated[Mapping[Label, column], Field(max_length=MOST_ENTRIES)]

    def _with_options(self, section: type[Section]) -> Any:
        if not self.options:
            return section
        bases: Any = (*self.options, section)
        return create_model(section.__name__, __base__=bases, __doc__=section.__doc__)

    @cached_property
    def words(self) -> frozenset[str]:
        """The kinds of measures."""
        kinds = (get_args(measure.model_fields["kind"].annotation) for measure in self.every_measure)
        return frozenset(kind for each in kinds for kind in each)

    @cached_property
    def tags(self) -> frozenset[str]:
        """Kinds of measures that pydantic names in the places of errors, where the file has no such key."""
        return self.words if len(self.every_measure) > 1 else frozenset()

    def unknown_in(self, summary: Mapping[str, Any]) -> tuple[str, ...]:
        """Kinds of a summary's measures that are none of these, in its order."""
        measures = summary.get("measures")
        entries = measures.values() if isinstance(measures, Mapping) else ()
        words = (entry.get("kind") for entry in entries if isinstance(entry, Mapping))
        return tuple(dict.fromkeys(word for word in words if isinstance(word, str) and word not in self.words))


def _of_kinds(measure: type[MeasureSummary], words: tuple[str, ...]) -> type[MeasureSummary]:
    """A class of measures for some kinds."""
    kind: Any = (Literal[words], ...)
    return create_model(measure.__name__, __base__=measure, __doc__=measure.__doc__, kind=kind)


def default_kinds(summary: Mapping[str, Any] | None = None) -> SummaryKinds:
    """Additions of all mechanisms, or of those of a summary."""
    found: SummaryKinds = import_module(REGISTRY).summary_kinds(summary)
    return found
