"""Tables of a scene of gears in a housing."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from tol3d.assembly.presenting.parts_tree import Laid, parts_tree
from tol3d.assembly.presenting.tables import drawing_blocks
from tol3d.gearing.presenting.scene_check import mechanics_blocks
from tol3d.machine.bores import Bores
from tol3d.machine.system import MachineSystem
from tol3d.report.page import Heading, PageItem, Row, Table, note, titled
from tol3d.report.system_check import system_blocks
from tol3d.study.simulation import Simulation

HELD: Final = "bores hold a shaft across its axis and against tilts; along it and about it its train decides"


def check_blocks(simulation: Simulation) -> Sequence[PageItem]:
    """Features and moves of the parts, shafts in their bores, gears and trains, and the items of any system."""
    system = simulation.system
    assert isinstance(system, MachineSystem)
    shafts, gears = shafts_table(system.bores), mechanics_blocks(system.gears.model)
    parts = {own.name for own in system.drawn.measures}
    return (*drawing_blocks(system.drawn), *shafts, *gears, *system_blocks(simulation, parts))


def parts_blocks(simulation: Simulation) -> Sequence[PageItem]:
    """Parts as their moves lay them, and shafts in their bores."""
    system = simulation.system
    assert isinstance(system, MachineSystem)
    assembly = system.drawn.assembly
    shafts = []
    for own in system.bores.shafts:
        parts = dict.fromkeys(assembly.features[bore.feature].part for bore in own.bores)
        shafts.append(Laid(own.shaft, own.lies, own.move, tuple(parts)))
    return parts_tree(assembly, shafts)


def shafts_table(bores: Bores) -> Sequence[PageItem]:
    """Table of the positions of shafts: their bores, and the bores' places along the shaft."""
    rows = [
        Row(
            own.shaft,
            (
                ", ".join(bore.words for bore in own.bores),
                ", ".join(f"{own.along(bore):g}" for bore in own.bores),
                ", ".join(f"{number:g}" for number in np.round(own.frame[:3, 3], 6) + 0.0),
                ", ".join(f"{number:g}" for number in np.round(own.frame[:3, 2], 6) + 0.0),
            ),
        )
        for own in bores.shafts
    ]
    words = ("in", "at its z [mm]", "origin at [mm]", "z along")
    table = Table("", [Heading(word, words=True) for word in words], rows)
    return (*titled("shafts in bores", table), note(HELD))
