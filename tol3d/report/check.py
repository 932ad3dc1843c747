"""What a scene means, before any trial: what its system shows of it, its study, and what should be known of it."""

from tol3d.report.page import Page, line, page, warning
from tol3d.report.presenter import presenter_at
from tol3d.study.simulation import Simulation
from tol3d.system.faults import faults_of


def check_report(simulation: Simulation) -> Page:
    """Everything that a scene says, with what follows from it; nothing is drawn at random.

    Raises:
        MechanismError: a mechanism of another package is at fault.
    """
    with faults_of(simulation.mechanism):
        shown = presenter_at(simulation.presenter).check(simulation)
    study = simulation.study
    words = [f"{study.trials} trials", f"seed {study.seed}", study.sampler, f"engine {study.engine}"]
    words += [f"{value} {name.replace('_', ' ')}" for name, value in study.options.items()]
    return page(
        line(simulation.system.name, "bold"),
        *shown,
        line(f"\nstudy: {', '.join(words)}"),
        *map(warning, simulation.warnings),
    )
