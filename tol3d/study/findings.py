"""What a study found, and what its witness found of it."""

from typing import Any

from threadpoolctl import threadpool_limits

from tol3d.execution.watch import Activity
from tol3d.runs.summary.run import Findings
from tol3d.runs.summary.values import as_json
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
    with threadpool_limits(1, user_api="blas"):  # threads make these small matrices three to ten times as slow
        found = study_summary(simulation, road, tally)
    wanted, witness = simulation.study.witness, witness_of(simulation.system)
    if road is not None and wanted and witness is not None:
        activity(f"witness: {witness.upper()} measures {min(wanted, tally.trials)} trials again")
        own = witness_summary(simulation, road, tally.trials)
        warnings = [*found.warnings, *witness_warnings(simulation, own)]
        found = found.model_copy(update={"witness": own, "warnings": warnings})
    summary: dict[str, Any] = as_json(described(simulation, tally, found))
    return summary


def described(simulation: Simulation, tally: Tally, found: Findings) -> dict[str, Any]:
    """Findings with what their system adds: what each measure is, and sections of its own behind the measures."""
    system, options = simulation.system, simulation.study.options
    measures = {own.name: {**system.describe(own), **dict(found.measures[own.name].items())} for own in system.measures}
    whole = dict(found.items()) | {"measures": measures}
    whole |= {key: {**dict(whole[key].items()), **options} for key in ("study", "witness") if key in whole}
    behind = [*whole].index("measures") + 1
    sections = system.sections(tally.terms, simulation.published)
    return {**dict([*whole.items()][:behind]), **sections, **dict([*whole.items()][behind:])}
