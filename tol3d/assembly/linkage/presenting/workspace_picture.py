"""The workspace of a loop as a picture: the tilts that its output reaches, and the condition numbers on the way."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.linkage.grammar.close_loop import CloseLoopSpec
from tol3d.assembly.linkage.grammar.inputs import TiltPoseSpec
from tol3d.assembly.linkage.loop import ClosedLoop
from tol3d.assembly.linkage.workspace import InputGrid, Workspace, input_grid_of, workspace_of
from tol3d.assembly.posed import PosedSystem, system_of
from tol3d.assembly.system import AssemblySystem
from tol3d.errors import InputError
from tol3d.report.canvas import save_figure
from tol3d.report.chart import Axis, Chart, Field, Line, Panel
from tol3d.report.chart_figure import charts_figure
from tol3d.report.measure_charts import spanned
from tol3d.report.polar_map import polar_map
from tol3d.scene.nearest import hint
from tol3d.study.runs.csv_text import csv_text
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.stated import component_slices, stated
from tol3d.study.trials.simulation import Simulation
from tol3d.units import Quantity

Array = NDArray[np.float64]

RAYS: Final = 72
PLACES: Final = 24
VALUES: Final = 41
"""Number of values of each input, where the output does not tilt."""
COARSE_RAYS: Final = 24
COARSE_PLACES: Final = 10
"""Places per ray in a picture of a measure's sigma, for which the assembly is computed anew in each pose."""
DRAWS: Final = 2000
WIDTH: Final = 7.2  # inch
CONDITION: Final = "condition number"


@dataclass(frozen=True, eq=False)
class WorkspaceMap:
    """Data of a picture of a workspace.

    Args:
        move: the loop's name.
        words: quantity shown, with its unit.
        workspace: its rays and places.
        values: of the quantity, by ray and place.
    """

    move: str
    words: str
    workspace: Workspace
    values: Array

    def draw(self, path: Path) -> None:
        """Draw it.

        Raises:
            InputError: the picture cannot be written there.
        """
        save_figure(self.figure(), path)

    def figure(self) -> Any:
        """Tilts outwards, azimuths around, values as colours, the singular curve; not yet written."""
        own = self.workspace
        least, reach = int(np.argmin(own.reach)), np.degrees(own.reach)
        words = (
            "outwards: tilt [deg], around: azimuth [deg]; red: where it is singular or ends, first at "
            f"{reach[least]:.2f} deg towards {np.degrees(own.azimuths[least]):.4g} deg"
        )
        return polar_map(f"{self.move}: {self.words}", own.azimuths, np.degrees(own.tilts), self.values, reach, [words])

    def csv(self) -> str:
        """Azimuth, tilt, inputs and value of each place."""
        places = (
            (azimuth, tilt, value)
            for k, azimuth in enumerate(np.degrees(self.workspace.azimuths))
            for tilt, value in zip(np.degrees(self.workspace.tilts[k]), self.values[k], strict=True)
        )
        rows = ([f"{number:.10g}" for number in place] for place in places)
        return csv_text([["azimuth [deg]", "tilt [deg]", self.words], *rows])


@dataclass(frozen=True, eq=False)
class InputMap:
    """Data of a picture of condition numbers over inputs.

    Args:
        move: the loop.
        grid: of its inputs.
    """

    move: ClosedLoop
    grid: InputGrid

    @property
    def _places(self) -> list[tuple[str, Array]]:
        """Words and values of the inputs, as the scene counts."""
        found = []
        for name, values in zip(self.grid.names, self.grid.values, strict=True):
            own = self.move.inputs[name]
            whole = own.as_placed + values
            found.append((f"{name} [mm]", whole) if own.is_slide else (f"{name} [deg]", np.degrees(whole)))
        return found

    def draw(self, path: Path) -> None:
        """Draw it.

        Raises:
            InputError: the picture cannot be written there.
        """
        save_figure(charts_figure([[self.chart()]], width=WIDTH), path)

    def chart(self) -> Chart:
        """Condition numbers over one input as a curve, over two as a field."""
        others = [name for name in self.move.inputs if name not in self.grid.names]
        held = f"{', '.join(others)}: as parts are placed; " if others else ""
        below = f"{held}blank: not reached, or beyond a singular pose"
        title, (first, *second), found = f"{self.move.name}: {CONDITION}", self._places, self.grid.conditions
        x = Axis(first[0], float(first[1].min()), float(first[1].max()))
        if not second:
            panel = Panel(spanned(CONDITION, found), [Line(first[1], found, "series-0")])
            return Chart(f"{title} over {first[0]}", x, [panel], title, below)
        ((words, places),) = second
        y = Axis(words, float(places.min()), float(places.max()))
        field = Field(first[1], places, found.T, CONDITION, log=True)
        return Chart(f"{title} over {first[0]} and {words}", x, [Panel(y, [field], height=1.5)], title, below)

    def csv(self) -> str:
        """Inputs and condition number of each place."""
        rows = [[*(words for words, _ in self._places), "condition number"]]
        places = [values for _, values in self._places]
        for place, value in np.ndenumerate(self.grid.conditions):
            own = [f"{values[k]:.10g}" for values, k in zip(places, place, strict=True)]
            rows.append([*own, "" if np.isnan(value) else f"{value:.10g}"])
        return csv_text(rows)


def workspace_map(
    simulation: Simulation, name: str, measure: str | None, activity: Callable[[str], None]
) -> WorkspaceMap | InputMap:
    """The workspace of a loop.

    Args:
        simulation: of the scene.
        name: of the move.
        measure: whose sigma is shown, by first order; default: the condition number.
        activity: progress callback.

    Raises:
        InputError: its output does not tilt, or no such measure.
    """
    system = simulation.system
    assert isinstance(system, AssemblySystem)
    move = next(own for own in system.assembly.moves if own.name == name)
    assert isinstance(move, ClosedLoop)
    output = move.kinematics.structure.output
    if measure is None and (output is None or output.whole):
        return InputMap(move, input_grid_of(move, VALUES, lambda done: activity(f"{done} of {VALUES}")))
    if measure is None:
        found = workspace_of(move, RAYS, PLACES, lambda done: activity(f"ray {done} of {RAYS}"))
        return WorkspaceMap(move.name, "condition number", found, found.conditions)
    names = [own.name for own in system.measures]
    if measure not in names:
        raise InputError(f"--of: no measure {measure!r}{hint(measure, names)}")
    found = workspace_of(move, COARSE_RAYS, COARSE_PLACES, lambda done: activity(f"ray {done} of {COARSE_RAYS}"))
    assert isinstance(system, PosedSystem)
    unit = next(own.unit for own in system.measures if own.name == measure)
    return WorkspaceMap(
        move.name, f"sigma of {measure} [{unit}], first order", found, _sigmas(system, move, found, measure)
    )


def _sigmas(system: PosedSystem, move: ClosedLoop, workspace: Workspace, measure: str) -> Array:
    """Sigma of a measure in all poses of a workspace (rays, places), in its unit."""
    scene = system.scene
    assert scene is not None
    spec = scene.moves[move.name]
    assert isinstance(spec, CloseLoopSpec)
    names, poses = {}, dict[str, TiltPoseSpec]()
    for (ray, place), tilt in np.ndenumerate(workspace.tilts):
        name = names[ray, place] = f"{ray} {place}"
        azimuth = float(np.degrees(workspace.azimuths[ray]))
        poses[name] = TiltPoseSpec(
            tilt=Quantity.parse(f"{np.degrees(tilt):.15g} deg"), azimuth=Quantity.parse(f"{azimuth:.15g} deg")
        )
    own = scene.measures[measure]
    read = {name: own.model_copy(update={"at": name, "over": None, "take": "value"}) for name in poses}
    loop = spec.model_copy(update={"poses": poses})
    there = system_of(scene.model_copy(update={"moves": {**scene.moves, move.name: loop}, "measures": read}))
    uniforms = np.random.default_rng(1)
    rows = np.empty((DRAWS, there.assembly.width))
    for contributor, columns in component_slices(there).items():
        draw = next(each.draw for each in there.contributors if each.name == contributor)
        drawn = draw.deviations(*uniforms.random((draw.uniforms, DRAWS)))
        rows[:, columns] = np.array(drawn).T
    method = there.method(ANALYTIC_METHOD, None)
    values = method.answers(stated(there, rows), there.measures).values
    per = next(each.per_internal for each in there.measures)
    found = np.empty(workspace.tilts.shape)
    for place, name in names.items():
        found[place] = per * float(values[name].std())
    return found
