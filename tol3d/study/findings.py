"""What a study found, and what its witness found of it."""

from typing import Any

from tol3d.execution.watch import Activity
from tol3d.study.simulation import Simulation
from tol3d.study.summary import study_summary
from tol3d.study.tally import Tally
from tol3d.study.witness import witness_of, witness_summary, witness_warnings
from tol3d.system.road import Road


def findings(simulation: Simulation, road: Road | None, tally: Tally, activity: Activity) -> dict[str, Any]:
    """Everything of summary.json but files, timing and versions.

    Args:
        simulation: what was simulated.
        road: of the 3D simulation; None for an analytic study.
        tally: of all trials.
        activity: gets what goes on, in words.
    """
    found = study_summary(simulation, road, tally)
    wanted, witness = simulation.study.witness, witness_of(simulation.system)
    if road is None or not wanted or witness is None:
        return found
    activity(f"witness: {witness.upper()} measures {min(wanted, tally.trials)} trials again")
    own = witness_summary(simulation, road, tally.trials)
    return found | {"witness": own, "warnings": [*found["warnings"], *witness_warnings(simulation, own)]}
