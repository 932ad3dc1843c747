"""Presentation of gears in a housing: the trains, and the features and moves of the parts around them, in one world."""

from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from tol3d.assembly.presenting import PRESENTER as ASSEMBLIES
from tol3d.gearing.presenting import GearPresenter

if TYPE_CHECKING:
    from tol3d.report.page import PageItem
    from tol3d.report.presenter import Display
    from tol3d.study.results.replaying import Replay
    from tol3d.study.runs.summary.run import RunSummary
    from tol3d.study.trials.simulation import Simulation


class MachinePresenter(GearPresenter):
    """The presenter of machines; see `tol3d.report.presenter.Presenter`."""

    def sections(self, summary: "RunSummary") -> "Sequence[PageItem]":
        """Tables of every train, and the laws of the zones of bores and other features."""
        return (*super().sections(summary), *ASSEMBLIES.sections(summary))

    def check(self, simulation: "Simulation") -> "Sequence[PageItem]":
        """Features and moves of the parts, gears, meshes, trains, and the items of any system."""
        return _lazily("tables").check_blocks(simulation)  # type: ignore[no-any-return]

    def parts(self, simulation: "Simulation") -> "Sequence[PageItem]":
        """Each part below the one that its move lays it on, each shaft below the part with its first bore."""
        return _lazily("tables").parts_blocks(simulation)  # type: ignore[no-any-return]

    def shown(self, build: "Replay", label: str, *, magnify: float) -> "Display":
        """A build with its parts placed and its gears seated again, magnified as far as the teeth allow."""
        return _lazily("shown_machine").shown(build, label, magnify=magnify)  # type: ignore[no-any-return]


def _lazily(module: str) -> Any:
    """A module of this folder, imported when it is needed."""
    return import_module(f"{__name__}.{module}")


PRESENTER: Final = MachinePresenter()
