"""Free turns whose two ends are read in two builds: shafts cross their clearances where the load changes sides.

The driven gear rests on the working flanks while these carry the load, the shafts where it pushes them. It ends on the
other flanks in the build in which those carry it.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from tol3d.gearing.builds.build import Build
from tol3d.gearing.engines import INTERFERES, MeshReading, ReadingEngine
from tol3d.gearing.model import Mesh, Reading
from tol3d.numerics.arrays import Array

DRIVER_STEPS: Final = 20  # each leaves the share by which the ratio differs from that of the teeth: two or three do
LAST_STEP: Final = 1e-9  # mm


def to_reversal(
    engine: ReadingEngine, build: Build, mesh: Mesh, reading: Reading, drive: MeshReading, turning: frozenset[str]
) -> MeshReading:
    """A mesh with the free turns from its rest to that on its other flanks under the load on those.

    Args:
        engine: reads meshes.
        build: virtual builds with the load on the other flanks, one per row.
        mesh, reading: which gears, and where on them.
        drive: the mesh read under the load on its working flanks.
        turning: names of the gears whose free turn is wanted.
    """
    other = replace(reading, flank="back")
    if mesh.driven in turning:
        turn = _known(engine.read(build, mesh, other, drive.driver_angle)) - _known(drive)
        drive = replace(drive, driven_turn=mesh.driven_flank * turn)
    if mesh.driver in turning:
        turn = _driver_turn(engine, build, mesh, other, drive)
        drive = replace(drive, driver_turn=mesh.working_flank * turn)
    return drive


def _known(reading: MeshReading) -> Array:
    """Turn of the driven gear in contact [rad], (rows,); NaN where it found none."""
    return np.where(reading.status <= INTERFERES, reading.driven_angle, np.nan)


def _driver_turn(engine: ReadingEngine, build: Build, mesh: Mesh, other: Reading, drive: MeshReading) -> Array:
    """Turn of the driver [rad], (rows,), until its other flanks touch those of the driven gear, held at its rest."""
    held, turn = _known(drive), np.zeros(len(drive.driver_angle))
    for _ in range(DRIVER_STEPS):
        step = (held - _known(engine.read(build, mesh, other, drive.driver_angle + turn))) / float(mesh.rate)
        turn += np.nan_to_num(step)
        if not np.any(np.abs(step) * mesh.pair.pinion.base_radius > LAST_STEP):
            break
    return np.where(np.isnan(step), np.nan, turn)
