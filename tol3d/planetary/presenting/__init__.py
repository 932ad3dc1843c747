"""Presentation of planetary sets: every gear in its place, and the data of a scene's set."""

from collections.abc import Mapping, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from tol3d.gearing.presenting import GearPresenter
from tol3d.planetary.summary_types import PlanetaryOfRun, SpringSummary
from tol3d.runs.summary.run import RunSummary

if TYPE_CHECKING:
    from tol3d.gearing.links import LinkTrials, StatedLink
    from tol3d.gearing.presenting.shown_train import ShownLink
    from tol3d.numerics.arrays import Array
    from tol3d.report.page import PageItem
    from tol3d.report.presenter import Display, Draw, Which
    from tol3d.runs.run import Run
    from tol3d.study.replaying import Replay
    from tol3d.study.simulation import Simulation
    from tol3d.system.contributor import Contributor


class PlanetaryPresenter(GearPresenter):
    """The presenter of planetary sets; see `tol3d.report.presenter.Presenter`."""

    def pictures(self, summary: RunSummary) -> "Mapping[str, Draw]":
        """Chains of trains, and the torque curve of a set whose carrier has a spring: "torque-curve"."""
        sets = (summary.planetary_sets or {}) if isinstance(summary, PlanetaryOfRun) else {}
        springs = [own.spring for own in sets.values() if own.spring is not None][:1]
        curves = {"torque-curve": partial(_draw_curve, spring) for spring in springs}  # noqa: B035 - one set at most
        return {**super().pictures(summary), **curves}

    def sections(self, summary: RunSummary) -> "Sequence[PageItem]":
        """Efficiencies and torques of the set; of former versions also tables of a train around it."""
        return (*super().sections(summary), *self.link_sections(summary))

    def check(self, simulation: "Simulation") -> "Sequence[PageItem]":
        """Meshes of the set, then the items of any system."""
        return _lazily("tables").check_blocks(simulation)  # type: ignore[no-any-return]

    def display(self, run: "Run", which: "Which", *, magnify: float) -> "Display":
        """A build with its gears placed again; of former versions a train around the set too."""
        if getattr(run.found, "trains", None):
            return super().display(run, which, magnify=magnify)
        return _lazily("shown_gears").display(run, which, magnify=magnify)  # type: ignore[no-any-return]

    def replayed(self, replay: "Replay", label: str) -> "Display":
        """A trial that was replayed."""
        return _lazily("shown_gears").replayed_display(replay, label)  # type: ignore[no-any-return]

    # sets in trains ---------------------------------------------------------------------------------

    def link_blocks(self, link: "StatedLink", contributors: "Sequence[Contributor]") -> "Sequence[PageItem]":
        """Ratio, meshes and efficiencies of a set; see ShowsLinks."""
        return _lazily("tables").link_blocks(link, contributors)  # type: ignore[no-any-return]

    def link_sections(self, summary: RunSummary) -> "Sequence[PageItem]":
        """Efficiencies of sets whose friction is given, torques of springs that are; see ShowsLinks."""
        return _lazily("efficiencies").section_blocks(summary)  # type: ignore[no-any-return]

    def shown_link(self, link: "StatedLink", seen: "LinkTrials", world_from_driver: "Array") -> "ShownLink":
        """All gears of a set; see ShowsLinks."""
        return _lazily("shown_gears").shown_link(link, seen, world_from_driver)  # type: ignore[no-any-return]


def _draw_curve(spring: SpringSummary, path: Path) -> None:
    import_module("tol3d.planetary.hysteresis_picture").draw_curve(spring.curve, path)


def _lazily(module: str) -> Any:
    """A module of this folder, imported when it is needed."""
    return import_module(f"{__name__}.{module}")


PRESENTER: Final = PlanetaryPresenter()
