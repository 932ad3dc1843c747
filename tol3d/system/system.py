"""The seam: what a study asks of a system, and all that it knows of one."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.scene.published import PublishedColumn
from tol3d.system.breakdown import Breakdown
from tol3d.system.closed_form import ClosedForm
from tol3d.system.contributor import Contributor
from tol3d.system.measure import Measure
from tol3d.system.method import Method, MethodKind
from tol3d.system.pooled import PooledTerms
from tol3d.system.positions import Positions
from tol3d.system.statuses import Statuses
from tol3d.system.trials import Trials

Columns = Mapping[str, NDArray[Any]]
Published = Mapping[str, PublishedColumn]
"""Columns of others: what they found of each measure, and of the whole."""

KeyPath = tuple[str | int, ...]
StreamKey = tuple[str, str]


class Described(Protocol):
    """What a system is: its contributors, measures and statuses."""

    @property
    def name(self) -> str:
        """The scene's name."""
        ...

    @property
    def contributors(self) -> Sequence[Contributor]:
        """All tolerances, in the scene's order."""
        ...

    @property
    def measures(self) -> Sequence[Measure]:
        """All measures, in the scene's order."""
        ...

    @property
    def statuses(self) -> Statuses:
        """What may become of a trial."""
        ...

    @property
    def breakdowns(self) -> Sequence[Breakdown]:
        """The measures whose terms are kept beside them."""
        ...

    @property
    def warnings(self) -> Sequence[str]:
        """What may spoil its numbers."""
        ...

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        """Why it cannot be studied, such as parts that overlap at the mean build: place in the scene, sentence."""
        ...

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        """What a measure is, by keys of summary.json: its kind, of what it is, how it is read."""
        ...


class Positioned(Protocol):
    """Where the shafts of a system stand in its trials."""

    @property
    def streams(self) -> Sequence[StreamKey]:
        """Streams of uniforms that decide a trial's positions, besides those of the contributors."""
        ...

    def positions(self, uniforms: Mapping[StreamKey, Array]) -> Mapping[str, Array]:
        """Positions of trials, from a uniform (trials,) of each stream; all at rest where uniforms are 0."""
        ...

    def columns(self, trials: Trials) -> Mapping[str, NDArray[np.generic]]:
        """Columns of trials' positions, by name with unit."""
        ...

    def turns_at_random(self, contributor: Contributor, positions: Positions) -> bool:
        """Whether a deviation's direction turns through all angles from trial to trial, read at these positions."""
        ...


class Methods(Protocol):
    """By which methods a system answers, and what they take."""

    @property
    def methods(self) -> Mapping[str, MethodKind]:
        """Its methods by the words of the scene's study.engine; "analytic" is always one of them."""
        ...

    def is_compiled(self, method: str) -> bool:
        """Whether this machine has compiled what a method needs, so that it starts at once."""
        ...

    def materials(self, method: str) -> Any:
        """What a method is made of that takes long to make or needs CAD; None where it needs nothing.

        Made once, in the parent process, for the study's engine; it pickles, and `method` gets it in every worker.
        """
        ...

    def method(self, name: str, materials: Any) -> Method:
        """A method, made in the worker.

        Args:
            name: one of `methods`.
            materials: what `materials(name)` has made; always None for the analytic method, which must do without.
        """
        ...

    def cost(self, measures: Sequence[Measure]) -> int:
        """How many contacts a trial takes, for the size of what is handed out."""
        ...

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """What chord errors [mm] may make of a measure, in its unit."""
        ...


class Theory(Protocol):
    """What acts on the measures of a system, and what is known of them without trials."""

    def acting(self, measure: Measure) -> Sequence[Contributor]:
        """The contributors that act on a measure."""
        ...

    def regressor_key(self, measure: Measure) -> Hashable:
        """Measures of one key have the same regressors of each contributor that acts on them."""
        ...

    def regress(
        self, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
    ) -> None:
        """Write what a measure sees of contributors into their rows (regressors, trials), see `regressor_count`."""
        ...

    def closed_form(self, measure: Measure) -> ClosedForm | None:
        """Moments of a measure by the analytic method; None where there is no closed form."""
        ...

    def reference_form(self, measure: Measure) -> ClosedForm | None:
        """The same of its value at one position, of a measure that takes an extreme or a curve."""
        ...

    def neglected(self, measure: Measure, trials: Trials) -> Mapping[str, Array]:
        """What the analytic method leaves out on purpose: its size, or a bound (trials,) in the measure's unit."""
        ...


class Shown(Protocol):
    """What a system shows of its results."""

    def sections(self, terms: Mapping[str, Mapping[str, PooledTerms]], published: Published) -> Mapping[str, Any]:
        """Further sections of summary.json, from what was pooled of each breakdown by measure and method."""
        ...

    def display(self, trials: Trials, method: Method) -> Any:
        """A build with its contacts, for whoever draws or exports it; the system's presenters know what it is."""
        ...


class System(Described, Positioned, Methods, Theory, Shown, Protocol):
    """Parts that are built and measured: frozen, and it pickles. Lengths are mm, angles rad, temperatures K."""
