"""Files of a synthetic rig, as `tol3d identify` reads them."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError, unwritable
from tol3d.records.exact_play import Side
from tol3d.records.folder import made_folder
from tol3d.records.pair import TURN, Specimen
from tol3d.records.rig import Readings, Rig, measured

Array = NDArray[np.float64]

MOST_ROWS = 3 * 10**7  # a side; they are made in memory, 100 bytes a row
DIGITS = 9  # of degrees: 4e-6 arc seconds


def write_both(specimen: Specimen, rig: Rig, folder: Path, *, wrapped: bool = False) -> tuple[Path, ...]:
    """Write drive.csv and back.csv of a specimen on a rig into a folder.

    Raises:
        InputError: more rows than a file may have, or they cannot be written.
    """
    rows = rig.turns * rig.samples * rig.repeats
    if rows > MOST_ROWS:
        raise InputError(f"--samples: expected at most {MOST_ROWS:.0e} rows a side, got {rows:.3g}")
    place = made_folder(folder)
    sides: tuple[Side, ...] = ("drive", "back")
    for side in sides:
        write_readings(measured(specimen, rig, side), place / f"{side}.csv", wrapped=wrapped)
    return tuple(place / f"{side}.csv" for side in sides)


def write_readings(readings: Readings, path: Path, *, wrapped: bool = False) -> None:
    """Write one side as CSV, angles in degrees.

    Args:
        readings: of the side.
        path: the file; one that is there is replaced.
        wrapped: angles within one turn, as single-turn encoders give them.

    Raises:
        InputError: it cannot be written.
    """
    angles = [np.mod(own, TURN) if wrapped else own for own in (readings.phi1, readings.phi2)]
    columns = {"phi1 [deg]": np.degrees(angles[0]), "phi2 [deg]": np.degrees(angles[1])}
    formats = [f"%.{DIGITS}f"] * 2
    if readings.torque is not None:
        columns["torque [N m]"] = readings.torque
        formats.append("%.6g")
    if readings.repeat is not None:
        columns["repeat"] = readings.repeat
        formats.append("%d")
    try:
        table = np.stack(list(columns.values()), axis=1)
        np.savetxt(path, table, fmt=formats, delimiter=",", header=",".join(columns), comments="", encoding="utf-8")
    except OSError as error:
        raise unwritable(path, error, "choose another folder") from None
