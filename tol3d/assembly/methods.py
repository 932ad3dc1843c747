"""Both methods of assemblies, as used by studies."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

from tol3d.assembly.model import Assembly
from tol3d.assembly.placing import method as placing
from tol3d.assembly.placing.plan import PlacingPlan, planned
from tol3d.assembly.placing.world import SolidReader
from tol3d.assembly.torsors import method as torsors
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Answers
from tol3d.study.system.trials import Trials


@dataclass(frozen=True)
class TorsorMethod:
    """The analytic method: small displacements."""

    assembly: Assembly

    chord_error: ClassVar[float] = 0.0

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Method; every trial is built."""
        found = torsors.values(self.assembly, trials.deviations, [measure.name for measure in measures])
        return Answers({name: own[:, None] for name, own in found.items()})


@dataclass(frozen=True)
class PlacingMethod:
    """The exact method: parts are placed, move by move.

    Args:
        assembly: the model.
        solids: reads clearances of whole parts; None where there are none.
        chord_error: see Method.
    """

    assembly: Assembly
    solids: SolidReader | None = None
    chord_error: float = 0.0

    @cached_property
    def plan(self) -> PlacingPlan:
        """Plan by nominal geometry; an assembly in several poses has one for each."""
        return planned(self.assembly, self.solids)

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Method."""
        return self.answers_in_pose(trials, measures, {})

    def answers_in_pose(self, trials: Trials, measures: Sequence[Measure], kept: dict[int, dict[str, Any]]) -> Answers:
        """Answers in one of many poses; `kept` goes from pose to pose, see World."""
        names = [measure.name for measure in measures]
        found, decided = placing.planned_answers(self.plan, trials.deviations, names, kept)
        return Answers(
            {name: own[:, None] for name, (own, _) in found.items()},
            details=decided,
            status={name: codes for name, (_, codes) in found.items()},
        )
