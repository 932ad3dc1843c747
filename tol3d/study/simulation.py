"""Simulation: a system, its study, and published figures of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from tol3d.scene import Scene
from tol3d.study.lines import Line
from tol3d.study.study import Study, Until
from tol3d.system.copula import INDEPENDENT, Copula
from tol3d.system.faults import Origin
from tol3d.system.itself import Itself
from tol3d.system.method import ANALYTIC_METHOD, MethodKind
from tol3d.system.system import Published, System
from tol3d.units import Quantity


@dataclass(frozen=True)
class Seen:
    """Contributors without a slope that were redrawn in builds of a measure.

    Args:
        builds: their number; 0 where every contributor has a slope.
        names: of those that moved the measure; the others were not seen to act.
    """

    builds: int = 0
    names: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Simulation:
    """Everything that a trial and its statistics need; it pickles.

    Args:
        system: that is built and measured.
        study: settings for it.
        published: columns of others.
        requires: packages, besides those of every study, whose versions decide its results.
        presenter: import path of the system's presenter, see `tol3d.report.presenter`; "" for nothing.
        mechanism: the one that understood the scene; None of a system made without.
        implausible: warnings of its vocabularies on the scene.
        copula: which contributors are correlated.
        lines: of the scene, which state the tolerances; none of a system made without.
        seen: by system, what its measures were seen to depend on; filled at the first question, see acting.py.
    """

    system: System
    study: Study
    published: Published = field(default_factory=dict)
    requires: tuple[str, ...] = ()
    presenter: str = ""
    mechanism: Origin | None = None
    implausible: tuple[str, ...] = ()
    copula: Copula = INDEPENDENT
    lines: tuple[Line, ...] = ()
    seen: dict[Itself, Mapping[str, Seen]] = field(default_factory=dict, compare=False, repr=False)

    @property
    def method(self) -> MethodKind:
        """The method that the study's engine names."""
        return self.system.methods[self.study.engine]

    @property
    def has_geometry(self) -> bool:
        """True if there is a 3D simulation beside the analytic method."""
        return self.study.engine != ANALYTIC_METHOD

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of conditions that may spoil the numbers of this study."""
        return (*self.implausible, *self.system.warnings, *self.study.warnings)


def study_of(scene: Scene) -> Study:
    """The study of a scene; an automatic one is its trials at most, and when it may stop before."""
    spec = scene.study
    return Study(
        trials=spec.at_most if spec.trials == "auto" else spec.trials,
        seed=spec.seed,
        sampler=spec.sampler,
        replicates=spec.parts,
        until=tuple(
            Until(name, _internal(errors.mean), _internal(errors.sigma)) for name, errors in spec.until.items()
        ),
        engine=spec.engine,
        witness=spec.witness,
        ppk_by=spec.ppk_by,
        accept_ppk=None if spec.accept is None else spec.accept.ppk,
        options=scene.grammar.options_of(scene),
    )


def _internal(quantity: Quantity | None) -> float | None:
    return None if quantity is None else quantity.internal
