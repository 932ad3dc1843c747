"""A build of gears as it is shown and exported: single pairs each in its own world, trains in one."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from typing import Final

from tol3d.errors import InputError
from tol3d.gearing.display import SeatedBuild
from tol3d.gearing.placed import SeatedMesh
from tol3d.gearing.presenting.moved_gears import motion, motions
from tol3d.gearing.presenting.whole_trains import WholeTrain, gear_body, whole_trains
from tol3d.report.body import World
from tol3d.report.motion import Motion
from tol3d.report.presenter import Panel, View
from tol3d.scene.name import LONGEST_NAME
from tol3d.scene.nearest import hint

DRIVER_COLOUR, DRIVEN_COLOUR = "#4682B4", "#E69F00"
PANELS: Final = "tol3d.gearing.presenting.panels"  # it loads pyvista, which files do not need


@dataclass(frozen=True, eq=False)
class GearDisplay:
    """A build of gears; see `tol3d.report.presenter.Display`."""

    build: SeatedBuild

    @property
    def label(self) -> str:
        """What it is, such as "trial-17" or "nominal"."""
        return self.build.label

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know."""
        return self.build.notes

    @cached_property
    def trains(self) -> tuple[WholeTrain, ...]:
        """The trees of its shafts; none of a build of single pairs."""
        return whole_trains(self.build)

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """A world a tree of shafts, or where there are only single pairs a world a mesh."""
        return tuple(train.world for train in self.trains) or tuple(_pair(mesh) for mesh in self.build.meshes)

    @property
    def motions(self) -> tuple[str, ...]:
        """See `tol3d.report.motion.Movable`."""
        return motions(self.build)

    def motion(self, name: str, frames: int | None) -> Motion:
        """See `tol3d.report.motion.Movable`."""
        return motion(self.build, name, frames)

    def view(self, close_up: str | None) -> View:
        """The teeth of one mesh, the whole pair, a close-up of the gap; of a train, the train before the teeth.

        Args:
            close_up: the mesh that is shown close up, and with it the train of the same first shaft; None: the
                first.
        """
        asked = self._asked(close_up)
        trains = sorted(self.trains, key=lambda train: asked is not None and asked.mesh.driver not in train.shaft_of)
        shown = trains[0] if trains else None
        close = asked or self._first(shown)
        panels: tuple[Panel, ...] = import_module(PANELS).panels_of(self.build, shown, close)
        return View(panels, tuple(self._left_out(trains, close)))

    def _asked(self, mesh: str | None) -> SeatedMesh | None:
        """The mesh of that name; None where none was asked for.

        Raises:
            InputError: the build shows no such mesh.
        """
        if mesh is None:
            return None
        by_name = {seated.mesh.name: seated for seated in self.build.meshes}
        if mesh not in by_name:
            raise InputError(f"--mesh: no mesh {mesh[:LONGEST_NAME]!r} is shown of this run{hint(mesh, by_name)}")
        return by_name[mesh]

    def _first(self, train: WholeTrain | None) -> SeatedMesh | None:
        """The first mesh, of a train its first; None for a train without any."""
        meshes = self.build.meshes
        return next((seated for seated in meshes if train is None or seated.mesh.driver in train.shaft_of), None)

    def _left_out(self, trains: list[WholeTrain], close: SeatedMesh | None) -> Iterator[str]:
        """What the window does not show."""
        others = [seated.mesh.name for seated in self.build.meshes if seated is not close]
        if close and others:
            what = "close up" if trains else "shown"
            yield f"{what} is {close.mesh.name}, not {', '.join(others)} (choose with --mesh)"
        if len(trains) > 1:
            others = [train.root for train in trains[1:]]
            yield f"shown are the shafts downstream of {trains[0].root}, not those of {', '.join(others)}"


def _pair(seated: SeatedMesh) -> World:
    parts = ((seated.driver, DRIVER_COLOUR), (seated.driven, DRIVEN_COLOUR))
    return World(seated.mesh.name, tuple(gear_body(part, colour) for part, colour in parts), one_file=False)
