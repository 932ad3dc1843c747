"""Check of a scene before any trial: tables of its system, its study, and warnings.

Limits written in a scene as on a drawing, and their meaning.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Final, Protocol, runtime_checkable

from tol3d.report.declared import declared_table
from tol3d.report.number import signed_units
from tol3d.report.page import Page, PageItem, Table, line, note, page, some, titled, warning
from tol3d.report.presenter import Presenter, presenter_at
from tol3d.report.system_check import law_name
from tol3d.scene.bases import laws_in
from tol3d.scene.schema import Scene
from tol3d.statistics.distributions.base import DistributionSpec
from tol3d.statistics.distributions.drawn import typed_sizes
from tol3d.statistics.distributions.unsized import STANDARDS
from tol3d.statistics.standards import iso_2768
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.system.faults import faults_of
from tol3d.study.trials.correlated import correlation_warnings
from tol3d.study.trials.simulation import Simulation
from tol3d.units import Quantity

MOST_ROWS: Final = 60  # of a table of the scene's own entries
DIGITS: Final = 3  # of deviations in um that follow from sizes
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


NOMINAL_NOTE = (
    "a number in front of limits, such as 40.1 mm +0.12/0, is not compared with the part: its size is the part's"
)


@dataclass(frozen=True)
class DrawnRow:
    """A limit as drawn, and its numbers."""

    drawn: Annotated[str, Shows("as drawn", "words")]
    lower: Annotated[str, Shows("lower")]
    upper: Annotated[str, Shows("upper")]
    law: Annotated[str, Shows("law", "words")]


def drawn_limits(scene: Scene) -> list[PageItem]:
    """Every limit that stands as on a drawing, with its numbers; nothing where there are none."""
    rows = [(name, _row(law, law_name(law.resolve(scene.files)))) for name, law in _drawn(scene)]
    if not rows:
        return []
    return [*titled("limits as drawn", declared_table("", rows)), note(NOMINAL_NOTE), *_general(scene)]


def _general(scene: Scene) -> Iterator[PageItem]:
    """Which dimensions took the general tolerance, and what it says that is not drawn."""
    if scene.general is None:
        return
    sizes, forms = iso_2768.classes(scene.general)
    taken = ", ".join(scene.origin.general) or "none"
    yield note(f"general tolerance ISO 2768-{sizes}, taken by dimensions without one of their own: {taken}")
    if forms:
        yield note(
            f"class {forms} of ISO 2768-2 (form, orientation, run-out) is not applied: state zones where they matter"
        )


def _drawn(scene: Scene) -> Iterator[tuple[str, DistributionSpec]]:
    for (_, name), entry in scene.entries().items():
        for law in laws_in(entry):
            if law.drawn is not None:
                yield str(name), law


def _row(law: DistributionSpec, name: str) -> DrawnRow:
    """Its limits as drawn, and as numbers, with the signs of their units."""
    given = law.quantities()
    if typed_sizes(law.drawn) is not None:  # their deviations have the digits of the nominal size
        given = {name: Quantity(round(own.number, DIGITS), own.unit) for name, own in given.items()}
    drawn, lower, upper = (signed_units(str(text)) for text in (_told(law.drawn), given["lower"], given["upper"]))
    return DrawnRow(drawn, lower, upper, name)


def _told(written: Any) -> str:
    """As a drawing has it: H7 of 32 mm, ISO 2768-m of 60 mm, ±0.1 mm."""
    if isinstance(written, dict):
        if "limits" in written:
            return _told(written["limits"])
        for key in STANDARDS:
            if key in written:
                return f"{key.upper().replace('_', ' ')} {written[key]}"
        if "iso_1328_2" in written:
            return f"ISO 1328-2 {written['iso_1328_2']} of m {written['module']}, d {written['of']}"
        word = written["fit"] if "fit" in written else f"ISO 2768-{written['general']}"
        return f"{word} of {written['of']}" if "of" in written else f"{word}, leg of {written['leg']}"
    return " to ".join(str(own) for own in written) if isinstance(written, list) else str(written)
