"""Check of a scene before any trial: tables of its system, its study, and warnings."""

from collections.abc import Sequence
from typing import Final, Protocol, runtime_checkable

from tol3d.report.page import Page, PageItem, Table, line, note, page, some, warning
from tol3d.report.presenter import Presenter, presenter_at
from tol3d.study.correlated import correlation_warnings
from tol3d.study.simulation import Simulation
from tol3d.system.faults import faults_of

MOST_ROWS: Final = 60  # of a table of the scene's own entries
LEFT_OUT: Final = "rows that are left out: check --out FILE.csv writes all of it"


@runtime_checkable
class ShowsParts(Protocol):
    """A presenter that can say which part lies on which."""

    def parts(self, simulation: Simulation) -> Sequence[PageItem]:
        """The tree of who locates whom."""
        ...


def check_report(simulation: Simulation, drawn: Sequence[PageItem] = ()) -> Page:
    """All entries of a scene, with their consequences; nothing is drawn at random.

    Args:
        simulation: of the scene.
        drawn: its limits as a drawing writes them, see drawn_limits.

    Raises:
        MechanismError: a mechanism of another package is at fault.
    """
    with faults_of(simulation.mechanism):
        shown = _presenter(simulation).check(simulation)
    study = simulation.study
    words = [f"{study.trials} trials", f"seed {study.seed}", study.sampler, f"engine {study.engine}"]
    words += [f"{value} {name.replace('_', ' ')}" for name, value in study.options.items()]
    whole = page(
        line(simulation.system.name, "bold"),
        *(block.shortened(MOST_ROWS) if isinstance(block, Table) else block for block in [*shown, *drawn]),
        line(f"\nstudy: {', '.join(words)}"),
        *map(warning, some([*simulation.warnings, *correlation_warnings(simulation)])),
    )
    return whole if whole.is_whole else page(*whole.blocks, note(LEFT_OUT))


def parts_report(simulation: Simulation) -> Page:
    """Tree of parts with the moves that place them; a line if parts are not placed one by one.

    Raises:
        MechanismError: a mechanism of another package is at fault.
    """
    presenter = _presenter(simulation)
    head = line(simulation.system.name, "bold")
    if not isinstance(presenter, ShowsParts):
        return page(head, line("no part is placed on another by a move of its own here; check shows what there is"))
    with faults_of(simulation.mechanism):
        return page(head, *presenter.parts(simulation))


def _presenter(simulation: Simulation) -> Presenter:
    with faults_of(simulation.mechanism):
        return presenter_at(simulation.presenter)
