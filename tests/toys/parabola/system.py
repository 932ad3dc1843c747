"""All that a study asks of springs."""

import os
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.scene import Scene
from tol3d.study.system.breakdown import Breakdown, SumTerm
from tol3d.study.system.closed_form import ClosedForm, Share
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import INDEPENDENT, Copula
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Method, MethodKind
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.pooled import PooledTerms
from tol3d.study.system.positions import Positions
from tol3d.study.system.regressors import regress_plainly, regress_term
from tol3d.study.system.system import KeyPath, Published, StreamKey
from tol3d.study.system.trials import Trials
from toys.contributor import ToyContributor
from toys.measure import ToyMeasure
from toys.parabola.methods import POSITION, TERMS, Deviations, Exact, Theory, angles_of, chords_method
from toys.parabola.springs import LOST_LEVER, Springs, coil_weights, own_measure, springs_of, toy

Array = NDArray[np.float64]

METHODS = {
    "exact": MethodKind("the parabola"),
    "chords": MethodKind("knots of chords", threads=False, witness=True),
    "analytic": MethodKind("a line"),
}
STATUSES = Statuses(("ok", "too long", "lost"), frozenset(("too long",)), {"too long": "do not fit"})
COLUMN = "position:spring [deg]"
KNOTS_TO = 1.0  # mm; no x lies beyond


@dataclass(frozen=True)
class ParabolaSystem:
    """Implements System."""

    springs: Springs

    methods = METHODS
    statuses = STATUSES
    warnings = ()

    @property
    def name(self) -> str:
        return self.springs.name

    @property
    def contributors(self) -> tuple[ToyContributor, ...]:
        return self.springs.contributors

    @property
    def measures(self) -> tuple[ToyMeasure, ...]:
        return self.springs.measures

    @cached_property
    def breakdowns(self) -> tuple[Breakdown, ...]:
        terms = tuple(SumTerm(term, 1.0) for term in TERMS)
        own = (m for m in self.measures if (m.kind, m.take) == ("height", "value"))
        return tuple(Breakdown(measure.name, terms, "um", 1e3) for measure in own)

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        if self.springs.spring.a == 0.0:
            yield ("parts", self.springs.spring.name), "a spring of a = 0 does not lift"

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        own = own_measure(measure)
        room = self.springs.room(own)
        return {"kind": own.kind, "of": own.of} | ({} if room is None else {"room_um": 1e3 * room.room})

    # its trials -------------------------------------------------------------------------------------

    @property
    def streams(self) -> tuple[StreamKey, ...]:
        return ((self.springs.spring.name, "turn"),)

    def positions(self, uniforms: Mapping[StreamKey, Array]) -> Mapping[str, Array]:
        return {POSITION: 2 * np.pi * uniforms[self.streams[0]]}

    def columns(self, trials: Trials) -> Mapping[str, NDArray[np.generic]]:
        return {COLUMN: np.degrees(trials.positions[POSITION])}

    def turns_at_random(self, contributor: Contributor, positions: Positions) -> bool:
        return False

    # its methods --------------------------------------------------------------------------------------

    def is_compiled(self, method: str) -> bool:
        return True

    def materials(self, method: str) -> Any:
        """Materials of the chords: where they meet, and the process that made that."""
        if method != "chords":
            return None
        knots = np.linspace(-KNOTS_TO, KNOTS_TO, self.springs.chords + 1)
        return {"knots": knots, "squares": knots**2, "made by": np.array(os.getpid())}

    def method(self, name: str, materials: Any) -> Method:
        if name == "analytic":
            return Theory(self.springs, self)
        return Exact(self.springs, self) if name == "exact" else chords_method(self.springs, self, materials)

    def cost(self, measures: Sequence[Measure]) -> int:
        return sum(measure.positions.in_a_trial for measure in measures)

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        return 1e3 * chord_error

    # what acts on a measure -------------------------------------------------------------------------

    def acting(self, measure: Measure) -> tuple[ToyContributor, ...]:
        at_rest = measure.positions.over == "at"
        return tuple(own for own in self.contributors if not (at_rest and own.kind == "wave"))

    def regressor_key(self, measure: Measure) -> Hashable:
        return measure.positions

    def regress(
        self,
        measure: Measure,
        contributors: Sequence[Contributor],
        columns: Mapping[str, NDArray[Any]],
        rows: Mapping[str, Array],
    ) -> None:
        for own in map(toy, contributors):
            values = [np.asarray(columns[name], dtype=np.float64) * own.per_unit for name in own.columns]
            if own.kind == "ripple":
                weights = coil_weights(len(values))
                term = sum((weight * value for weight, value in zip(weights, values, strict=True)), np.zeros(1))
                regress_term(rows[own.name], term, float(own.draw.sigma * np.sqrt(np.sum(weights**2))))
            elif own.kind == "wave" and measure.positions.over == "random":
                regress_term(rows[own.name], values[0] * np.sin(np.radians(columns[COLUMN])), own.draw.sigma)
            else:
                regress_plainly(rows[own.name], own, values)

    def closed_form(self, measure: Measure) -> ClosedForm | None:
        return self.reference_form(measure) if measure.take == "value" else None

    def reference_form(self, measure: Measure) -> ClosedForm | None:
        """Closed form of its value at one position: at rest, or at a random one."""
        sign = -1.0 if (room := self.springs.room(own_measure(measure))) else 1.0
        nominal = room.room if room else 0.0
        shares = tuple(self._share(own, sign) for own in self.acting(measure))
        mean = nominal + sum(share.mean for share in shares)
        return ClosedForm(nominal, mean, float(np.sqrt(sum(share.variance for share in shares))), shares)

    def _share(self, own: ToyContributor, sign: float) -> Share:
        law, coefficient = own.distribution, sign * {"abscissa": self.springs.spring.a}.get(own.kind, 1.0)
        if own.kind == "wave":  # at a random position
            return Share(own.name, coefficient, 0.0, (law.variance + law.mean**2) / 2)
        weights = coil_weights(len(own.draw.components)) if own.kind == "ripple" else np.ones(1)
        mean = coefficient * float(np.sum(weights)) * law.mean
        return Share(own.name, coefficient, mean, coefficient**2 * float(np.sum(weights**2)) * law.variance)

    def neglected(self, measure: Measure, trials: Trials) -> Mapping[str, Array]:
        return {"the lever of the offset": 1e3 * LOST_LEVER * np.abs(Deviations.of(self, trials).offset)}

    # what it shows ----------------------------------------------------------------------------------

    def sections(
        self, terms: Mapping[str, Mapping[str, PooledTerms]], published: Published, copula: Copula = INDEPENDENT
    ) -> Mapping[str, Any]:
        """Each measure's terms, by method."""
        return {"terms": {name: {key: _terms(own) for key, own in found.items()} for name, found in terms.items()}}

    def display(self, trials: Trials, method: Method) -> "Lifted":
        found = method.answers(trials, self.measures)
        first = self.measures[0]
        height = float(found.values[first.name][0, 0]) if first.kind == "height" else 0.0
        return Lifted(self.springs, height, float(angles_of(first, trials)[0, 0]))


@dataclass(frozen=True)
class Lifted:
    """A spring as it lifts in one trial: height [mm], position [rad]."""

    springs: Springs
    height: float
    angle: float


def _terms(own: PooledTerms) -> dict[str, Any]:
    shares = own.shares(np.ones(len(TERMS)))
    return {
        term: {"mean": moments.mean, "sigma": moments.sigma, "share_percent": 100 * float(share)}
        for term, moments, share in zip(TERMS, own.moments, shares, strict=True)
    }


def parabola_system(scene: Scene) -> ParabolaSystem:
    """System of a scene of springs."""
    return ParabolaSystem(springs_of(scene))
