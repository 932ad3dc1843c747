"""Gears in mesh as a study sees them."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids import FlankStrips, measuring_strips
from tol3d.errors import InputError
from tol3d.gearing.engines import Engine
from tol3d.gearing.engines.gaps import STATUSES, exact_engine, exact_is_compiled, fcl_engine
from tol3d.gearing.meshing.seats import Seats, all_seat_keys, seated
from tol3d.gearing.methods.analytic import AnalyticMethod
from tol3d.gearing.methods.geometric import FLANKS_OF_A_BACKLASH, FclMethod, GeometricMethod
from tol3d.gearing.methods.interference import interferences
from tol3d.gearing.methods.neglected import neglected, of_gaps
from tol3d.gearing.methods.regressors import acting, position_column, regress, regressor_key
from tol3d.gearing.model import Contributor, Measure, Model, model_from_scene
from tol3d.gearing.model.measure import gear_measure, gear_measures
from tol3d.gearing.model.model import gear_contributor
from tol3d.gearing.play.linked import link_contributors
from tol3d.gearing.play.play import breakdowns_of
from tol3d.gearing.stack_up import closed_form, reference_form
from tol3d.gearing.summary.backlash_stages import backlash_stages
from tol3d.gearing.summary.train_sections import description, train_sections
from tol3d.gearing.summary.types import BacklashLimits
from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import kept
from tol3d.scene import Scene
from tol3d.study.system import contributor as system_contributor
from tol3d.study.system import measure as system_measure
from tol3d.study.system.breakdown import Breakdown
from tol3d.study.system.closed_form import ClosedForm
from tol3d.study.system.copula import INDEPENDENT, Copula
from tol3d.study.system.method import ANALYTIC_METHOD, Codes, Method, MethodKind
from tol3d.study.system.outcome import GEOMETRIC, Statuses
from tol3d.study.system.pooled import PooledTerms
from tol3d.study.system.positions import Positions
from tol3d.study.system.system import Columns, KeyPath, Published, StreamKey, System
from tol3d.study.system.trials import Trials

Strips = Mapping[str, FlankStrips]

EXACT: Final = "exact"
FCL: Final = "fcl"
METHODS: Final[Mapping[str, MethodKind]] = {
    EXACT: MethodKind("kernels", compiled=True),
    FCL: MethodKind("gears: solids and measuring strips", threads=False, witness=True, contacts_per_minute=180_000),
    ANALYTIC_METHOD: MethodKind("model"),
}
"""The engines of gears; FCL holds Python's lock and takes half a minute for a block."""


@dataclass(frozen=True)
class GearSystem:
    """Implements System for a model of gears."""

    model: Model

    methods = METHODS
    statuses: Statuses = STATUSES

    # what it is -------------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """See System."""
        return self.model.name

    @property
    def contributors(self) -> tuple[Contributor, ...]:
        """See System."""
        return self.model.contributors

    @property
    def measures(self) -> tuple[Measure, ...]:
        """See System."""
        return self.model.measures

    @cached_property
    def breakdowns(self) -> tuple[Breakdown, ...]:
        """See System."""
        return breakdowns_of(self.model)

    @property
    def warnings(self) -> tuple[str, ...]:
        """See System."""
        return self.model.warnings

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        """See System."""
        return interferences(self.model)

    def describe(self, measure: system_measure.Measure) -> Mapping[str, Any]:
        """See System."""
        return description(self.model, gear_measure(measure))

    # its trials -------------------------------------------------------------------------------------

    @property
    def streams(self) -> tuple[StreamKey, ...]:
        """See System."""
        return self.model.streams

    def positions(self, uniforms: Mapping[StreamKey, Array]) -> Mapping[str, Array]:
        """See System: the driver's angle [rad] by mesh."""
        return self.model.positions(uniforms)

    def columns(self, trials: Trials) -> Mapping[str, NDArray[np.generic]]:
        """See System."""
        names = [mesh.name for mesh in self.model.meshes]
        names += [link.name for link in self.model.links if link.name in trials.positions]
        return {position_column(name): np.degrees(trials.positions[name]) for name in names}

    def turns_at_random(self, contributor: system_contributor.Contributor, positions: Positions) -> bool:
        """See System."""
        return self.model.turns_at_random(contributor, positions)

    def seen_by_gears(self, trials: Trials) -> tuple[Trials, Mapping[str, Codes]]:
        """Trials as seen by the gears, and status codes by shaft; here unchanged, without codes."""
        return trials, {}

    # its methods --------------------------------------------------------------------------------------

    def is_compiled(self, method: str) -> bool:
        """See System."""
        links = all(link.is_compiled() for link in self.model.links)
        return links and (method != EXACT or exact_is_compiled(self.model))

    def materials(self, method: str) -> Any:
        """See System: the strips of every gear's solid, for FCL."""
        return strips_of(self.model) if method == FCL else {}

    def method(self, name: str, materials: Any) -> Method:
        """See System."""
        if name == ANALYTIC_METHOD:
            return AnalyticMethod(self.model)
        if name == FCL:
            return FclMethod(self.model, fcl_engine(self.model, materials), materials)
        return GeometricMethod(self.model, exact_engine(self.model))

    def cost(self, measures: Sequence[system_measure.Measure]) -> int:
        """See System: positions of every different way of reading a mesh, and contacts in other links."""
        own = gear_measures(measures)
        links = ((self.model.link(name).contacts, each.positions) for each in own for _, name in each.kind.links)
        inside = sum(contacts * positions.in_a_trial for contacts, positions in links)
        return inside + sum(1 if key[1] is None else len(key[1]) for key in all_seat_keys(self.model, own))

    def chord_bound(self, measure: system_measure.Measure, chord_error: float) -> float:
        """See System."""
        return of_gaps(self.model, gear_measure(measure), FLANKS_OF_A_BACKLASH * chord_error)

    # what acts on a measure -------------------------------------------------------------------------

    @kept
    def acting(self, measure: system_measure.Measure) -> tuple[Contributor, ...]:
        """See System."""
        return acting(self.model, gear_measure(measure))

    def regressor_key(self, measure: system_measure.Measure) -> Hashable:
        """See System."""
        return regressor_key(gear_measure(measure))

    def regress(
        self,
        measure: system_measure.Measure,
        contributors: Sequence[system_contributor.Contributor],
        columns: Columns,
        rows: Mapping[str, Array],
    ) -> None:
        """See System."""
        own = tuple(map(gear_contributor, contributors))
        regress(self.model, gear_measure(measure), own, columns, rows)

    def closed_form(self, measure: system_measure.Measure) -> ClosedForm | None:
        """See System."""
        return closed_form(self.model, gear_measure(measure))

    def reference_form(self, measure: system_measure.Measure) -> ClosedForm | None:
        """See System."""
        return reference_form(self.model, gear_measure(measure))

    def neglected(self, measure: system_measure.Measure, trials: Trials) -> Mapping[str, Array]:
        """See System."""
        return neglected(self.model, gear_measure(measure), trials)

    # what it shows ----------------------------------------------------------------------------------

    def sections(
        self, terms: Mapping[str, Mapping[str, PooledTerms]], published: Published, copula: Copula = INDEPENDENT
    ) -> Mapping[str, Any]:
        """See System: limits of backlash, the trains with their stages, and what their links say of themselves."""
        exact = any(GEOMETRIC in own for own in terms.values())
        limits = self.backlash_limits(EXACT if exact else ANALYTIC_METHOD, copula)
        found: dict[str, Any] = {"backlash": limits} if limits else {}
        return found | self.train_sections(terms, published)

    def backlash_limits(self, engine: str, copula: Copula = INDEPENDENT) -> Sequence[BacklashLimits]:
        """Limits of the backlash of its meshes, those of planetary sets too, the worst by an engine."""
        return [*backlash_stages(self.model, GearSystem, engine, copula), *self.backlash_limits_of_links(copula)]

    def backlash_limits_of_links(self, copula: Copula) -> Sequence[BacklashLimits]:
        """Limits of the backlash of the meshes of its links."""
        links = self.model.links
        return [own for link in links for own in link.backlash_limits(link_contributors(self.model, link.name), copula)]

    def train_sections(self, terms: Mapping[str, Mapping[str, PooledTerms]], published: Published) -> dict[str, Any]:
        """The same without limits of backlash."""
        found: dict[str, Any] = {"trains": train_sections(self.model, terms, published)}
        for link in self.model.links:
            for section, own in link.sections(link_contributors(self.model, link.name)).items():
                found[section] = {**found.get(section, {}), link.name: own}
        return found

    def display(self, trials: Trials, method: Method) -> Seats:
        """See System: builds with their seated meshes."""
        return seated(self.model, engine_of(method), trials)


def engine_of(method: Method) -> Engine:
    """The engine of a geometric method."""
    if not isinstance(method, GeometricMethod):
        raise TypeError(f"{type(method).__name__} has no engine")
    return method.engine


def strips_of(model: Model) -> Strips:
    """Measuring strips of every gear, from its CAD solid (cached on disk)."""
    return {part.name: measuring_strips(part.gear, model.profile_steps) for part in model.gears}


def gear_model(system: System) -> Model:
    """The model of a system of gears.

    Raises:
        InputError: it is another one.
    """
    if not isinstance(system, GearSystem):
        raise InputError(f"{system.name}: expected moves that are meshes or trains of gears; the scene has none")
    return system.model


def gears_in(system: System) -> GearSystem:
    """The gears of a system that is of gears, or holds some as its `gears`, as one in a housing does.

    Raises:
        InputError: there are none.
    """
    found = getattr(system, "gears", system)
    if not isinstance(found, GearSystem):
        raise InputError(f"{system.name}: there are no gears in its moves")
    return found


def gear_system(scene: Scene) -> GearSystem:
    """System of a scene of gears, with links added by other mechanisms.

    Raises:
        SceneError: gears that cannot be made or run together, with their numbers and key.
    """
    return GearSystem(model_from_scene(scene))
