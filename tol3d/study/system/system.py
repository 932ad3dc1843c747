"""The seam: requests of a study to a system, and all its knowledge of one."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.scene.published import PublishedColumn
from tol3d.study.system.breakdown import Breakdown
from tol3d.study.system.closed_form import ClosedForm
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import INDEPENDENT, Copula
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Method, MethodKind
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.pooled import PooledTerms
from tol3d.study.system.positions import Positions
from tol3d.study.system.trials import Trials

Columns = Mapping[str, NDArray[Any]]
Published = Mapping[str, PublishedColumn]
"""Published columns: figures of each measure, and of the whole."""

KeyPath = tuple[str | int, ...]
StreamKey = tuple[str, str]


class Described(Protocol):
    """Description of a system: its contributors, measures and statuses."""

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
        """Statuses of a trial."""
        ...

    @property
    def breakdowns(self) -> Sequence[Breakdown]:
        """The measures whose terms are kept beside them."""
        ...

    @property
    def warnings(self) -> Sequence[str]:
        """Warnings of conditions that may spoil its numbers."""
        ...

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        """Reasons why it cannot be studied, such as overlaps at the mean build: place in the scene, sentence."""
        ...

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        """Description of a measure, by keys of summary.json: its kind, its subject, its reading."""
        ...


class Positioned(Protocol):
    """Positions of the shafts of a system in its trials."""

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
        """True if a deviation's direction turns through all angles from trial to trial, read at these positions."""
        ...


class Methods(Protocol):
    """Methods by which a system answers, and their cost."""

    @property
    def methods(self) -> Mapping[str, MethodKind]:
        """Its methods by the words of the scene's study.engine; "analytic" is always one of them."""
        ...

    def is_compiled(self, method: str) -> bool:
        """True if this machine has compiled the kernels of a method, so that it starts at once."""
        ...

    def materials(self, method: str) -> Any:
        """Materials of a method that take long to make or need CAD; None where it needs nothing.

        Made once, in the parent process, for the study's engine; it pickles, and `method` gets it in every worker.
        """
        ...

    def method(self, name: str, materials: Any) -> Method:
        """A method, made in the worker.

        Args:
            name: one of `methods`.
            materials: those of `materials(name)`; always None for the analytic method, which must do without.
        """
        ...

    def cost(self, measures: Sequence[Measure]) -> int:
        """Number of contacts per trial, for the size of the pieces that workers get."""
        ...

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """Bound on the effect of chord errors [mm] on a measure, in its unit."""
        ...


class Theory(Protocol):
    """Effects on the measures of a system, and their properties that are known without trials."""

    def acting(self, measure: Measure) -> Sequence[Contributor]:
        """The contributors that act on a measure by theory; `acting_contributors` tries the others."""
        ...

    def regressor_key(self, measure: Measure) -> Hashable:
        """Measures of one key have the same regressors of each contributor that acts on them."""
        ...

    def regress(
        self, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
    ) -> None:
        """Write a measure's regressors of contributors into their rows (regressors, trials), see `regressor_count`."""
        ...

    def closed_form(self, measure: Measure) -> ClosedForm | None:
        """Moments of a measure by the analytic method; None if there is no closed form."""
        ...

    def reference_form(self, measure: Measure) -> ClosedForm | None:
        """The same of its value at one position, of a measure that takes an extreme or a curve."""
        ...

    def neglected(self, measure: Measure, trials: Trials) -> Mapping[str, Array]:
        """Part that the analytic method leaves out on purpose: its size, or a bound (trials,) in the measure's unit."""
        ...


class Shown(Protocol):
    """Presentation of a system's results."""

    def sections(
        self, terms: Mapping[str, Mapping[str, PooledTerms]], published: Published, copula: Copula = INDEPENDENT
    ) -> Mapping[str, Any]:
        """Further sections of summary.json, from the pooled terms of each breakdown by measure and method.

        Args:
            terms: of the breakdowns.
            published: columns of others.
            copula: which contributors are correlated.
        """
        ...

    def display(self, trials: Trials, method: Method) -> Any:
        """A build with its contacts, to be drawn or exported; its type is known to the system's presenters."""
        ...


class System(Described, Positioned, Methods, Theory, Shown, Protocol):
    """Parts that are built and measured: frozen, and it pickles. Lengths are mm, angles rad, temperatures K."""
