"""A presenter of boxes, as a mechanism outside of the package would bring along: it knows no gear."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import trimesh
from matplotlib.figure import Figure

from tol3d.cad.solids import PosedBody, ShaftBody
from tol3d.errors import InputError
from tol3d.report.body import Arrow, Body, Surface, World
from tol3d.report.presenter import Draw, View, Which

if TYPE_CHECKING:
    from tol3d.study.runs.run import Run
    from tol3d.study.runs.summary.run import RunSummary

SIDES = {"small": 10.0, "large": 20.0}  # mm
COLOURS = {"small": "#7FB2D9", "large": "#F0C36D"}
PLACES = {"small": (0.0, 0.0, 0.0), "large": (60.0, 0.0, 0.0)}
GROWTH = 1.5


def box(name: str, scale: float = 1.0) -> Body:
    """A cube, its own frame in its middle; for STEP a round bar."""
    solid = trimesh.creation.box((SIDES[name],) * 3)
    pose = np.eye(4)
    pose[:3, 3] = PLACES[name]

    def surface() -> Surface:
        return np.asarray(solid.vertices), np.asarray(solid.faces)

    bar = PosedBody(name, ShaftBody(SIDES[name], 0.0, SIDES[name]), pose)
    return Body(name, pose, surface, lambda: bar, COLOURS[name], scale)


@dataclass(frozen=True)
class BoxDisplay:
    """Two boxes, in one world or in two."""

    label: str
    notes: tuple[str, ...]
    worlds: tuple[World, ...]

    def view(self, close_up: str | None) -> View:
        """All there is of the first world."""
        if close_up is not None:
            raise InputError(f"no {close_up}")
        return View(notes=("all is shown",))


class BoxPresenter:
    """See `tol3d.report.presenter.Presenter`."""

    def pictures(self, summary: "RunSummary") -> Mapping[str, Draw]:
        """One picture."""
        return {"boxes: all": partial(_draw, summary.trials)}

    def sections(self, summary: "RunSummary") -> Sequence[Any]:
        """None."""
        return ()

    def display(self, run: "Run", which: Which, *, magnify: float) -> BoxDisplay:
        """The boxes of any build; of the mean one each in a world of its own."""
        if which == "mean":
            return BoxDisplay("mean", (), tuple(World(name, (box(name),), one_file=False) for name in SIDES))
        down = Arrow(np.array([0.0, 0.0, -1.0]), np.zeros(3))
        bodies = (box("small", GROWTH), box("large"))
        points = {"corner": np.array([70.0, 10.0, 10.0])}
        return BoxDisplay(f"trial-{which}", ("a note",), (World("all", bodies, True, points, {"down": down}),))


def _draw(trials: int, path: Path) -> None:
    figure = Figure(figsize=(2, 1), dpi=trials)
    figure.savefig(path)


PRESENTER = BoxPresenter()
