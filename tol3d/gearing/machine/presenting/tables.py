"""Tables of a scene of gears in a housing."""

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np

from tol3d.assembly.presenting.parts_tree import Laid, parts_tree
from tol3d.assembly.presenting.tables import drawing_blocks
from tol3d.gearing.machine.bores import Bores
from tol3d.gearing.machine.nominal import HousedShaft
from tol3d.gearing.machine.system import MachineSystem
from tol3d.gearing.presenting.drawing_sizes import backlash_table
from tol3d.gearing.presenting.scene_check import mechanics_blocks
from tol3d.report.declared import declared_table
from tol3d.report.page import PageItem, note, titled
from tol3d.report.system_check import system_blocks
from tol3d.study.runs.summary.shows import Computed, RowOf, Shows
from tol3d.study.trials.simulation import Simulation

HELD: Final = "bores hold a shaft across its axis and against tilts; along it and about it its train decides"


def check_blocks(simulation: Simulation) -> Sequence[PageItem]:
    """Features and moves of the parts, shafts in their bores, gears and trains, and the items of any system."""
    system = simulation.system
    assert isinstance(system, MachineSystem)
    shafts, gears = shafts_table(system.bores), mechanics_blocks(system.gears.model)
    parts = {measure.name for measure in system.drawn.measures}
    backlash = backlash_table(system.backlash_limits(simulation.copula))
    return (*drawing_blocks(system.drawn), *shafts, *gears, *backlash, *system_blocks(simulation, parts))


def parts_blocks(simulation: Simulation) -> Sequence[PageItem]:
    """Parts as their moves lay them, and shafts in their bores."""
    system = simulation.system
    assert isinstance(system, MachineSystem)
    assembly = system.drawn.assembly
    shafts = []
    for shaft in system.bores.shafts:
        parts = dict.fromkeys(assembly.features[bore.feature].part for bore in shaft.bores)
        shafts.append(Laid(shaft.shaft, shaft.lies, shaft.move, tuple(parts)))
    return parts_tree(assembly, shafts)


class ShaftRow(RowOf[HousedShaft]):
    """A shaft in its bores."""

    bores = Computed(Shows("in", "words"), lambda own: ", ".join(bore.words for bore in own.of.bores))
    at = Computed(Shows("at its z [mm]", "words"), lambda own: _listed(map(own.of.along, own.of.bores)))
    origin = Computed(Shows("origin at [mm]", "words"), lambda own: _listed(np.round(own.of.frame[:3, 3], 6) + 0.0))
    z_axis = Computed(Shows("z along", "words"), lambda own: _listed(np.round(own.of.frame[:3, 2], 6) + 0.0))


def shafts_table(bores: Bores) -> Sequence[PageItem]:
    """Table of the positions of shafts: their bores, and the bores' places along the shaft."""
    table = declared_table("", [(shaft.shaft, ShaftRow(shaft)) for shaft in bores.shafts])
    return (*titled("shafts in bores", table), note(HELD))


def _listed(numbers: Iterable[float]) -> str:
    return ", ".join(f"{number:g}" for number in numbers)
