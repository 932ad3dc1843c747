"""How planetary sets are shown: every gear where it stands, and what a scene's set is."""

from collections.abc import Mapping, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from tol3d.gearing.presenting import GearPresenter
from tol3d.planetary.summary_types import PlanetaryOfRun, SpringSummary
from tol3d.runs.summary.run import RunSummary

if TYPE_CHECKING:
    from tol3d.report.page import PageItem
    from tol3d.report.presenter import Display, Draw, Which
    from tol3d.runs.run import Run
    from tol3d.simulate import Replay
    from tol3d.study.simulation import Simulation


class PlanetaryPresenter(GearPresenter):
    """The presenter of planetary sets, and of trains with such sets; see `tol3d.report.presenter.Presenter`."""

    def pictures(self, summary: RunSummary) -> "Mapping[str, Draw]":
        """Chains of trains, and the torque curve of a set whose carrier has a spring: "torque-curve"."""
        sets = (summary.planetary_sets or {}) if isinstance(summary, PlanetaryOfRun) else {}
        springs = [own.spring for own in sets.values() if own.spring is not None][:1]
        curves = {"torque-curve": partial(_draw_curve, spring) for spring in springs}  # noqa: B035 - one set at most
        return {**super().pictures(summary), **curves}

    def sections(self, summary: RunSummary) -> "Sequence[PageItem]":
        """Tables of every train, efficiencies of sets whose friction is given, torques of springs that are."""
        return (*super().sections(summary), *_lazily("efficiencies").section_blocks(summary))

    def check(self, simulation: "Simulation") -> "Sequence[PageItem]":
        """Meshes of the sets, gears and shafts of a train around them, then what any system shows."""
        return _lazily("tables").check_blocks(simulation)  # type: ignore[no-any-return]

    def display(self, run: "Run", which: "Which", *, magnify: float) -> "Display":
        """A build with its gears placed again."""
        return _lazily("shown_train").display(run, which, magnify=magnify)  # type: ignore[no-any-return]

    def replayed(self, replay: "Replay", label: str) -> "Display":
        """A trial that was replayed."""
        return _lazily("shown_train").replayed(replay, label)  # type: ignore[no-any-return]


def _draw_curve(spring: SpringSummary, path: Path) -> None:
    _lazily("torque_curve").draw_curve(spring.curve, path)


def _lazily(module: str) -> Any:
    """A module of this folder, imported when it is needed."""
    return import_module(f"{__name__}.{module}")


PRESENTER: Final = PlanetaryPresenter()
