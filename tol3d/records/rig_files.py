"""Files of a synthetic rig, as `tol3d identify` reads them."""

import os
from pathlib import Path

import numpy as np

from tol3d.errors import InputError, unwritable
from tol3d.records.exact_play import Side, Unit
from tol3d.records.folder import begins_with, made_folder, whole
from tol3d.records.pair import TURN, Specimen
from tol3d.records.rig import Readings, Rig, measured

MOST_ROWS = 3 * 10**7  # a side; they are made in memory, 100 bytes a row
MARK = "# synthetic: written by tol3d rig"  # first line of its files, which readers pass over
DIGITS = 9  # of degrees: 4e-6 arc seconds


def write_both(unit: Specimen | Unit, rig: Rig, folder: Path, *, wrapped: bool = False) -> tuple[Path, ...]:
    """Write drive.csv and back.csv of a unit on a rig into a folder.

    Raises:
        InputError: more torques than passes, more rows than a file may have, files of these names that no rig wrote,
            the unit cannot be turned, or they cannot be written.
    """
    refuse_measured(folder)
    if len(rig.torques) > rig.repeats:
        raise InputError(
            f"--repeats: expected at least {len(rig.torques)}, one pass for each --torque, got {rig.repeats}"
        )
    rows = rig.turns * rig.samples * rig.repeats
    if rows > MOST_ROWS:
        raise InputError(f"--samples: expected at most {MOST_ROWS:.0e} rows a side, got {rows:.3g}")
    sides: tuple[Side, ...] = ("drive", "back")
    for side in sides:
        readings = measured(unit, rig, side)
        made_folder(folder)
        write_readings(readings, folder / f"{side}.csv", wrapped=wrapped, mark=f"{MARK}, seed {rig.seed}\n")
    return tuple(folder / f"{side}.csv" for side in sides)


def refuse_measured(folder: Path) -> None:
    """Refuse a folder whose drive.csv or back.csv no rig of ours wrote: they are measured, and not to be replaced.

    Raises:
        InputError: it names the file.
    """
    for side in ("drive", "back"):
        path = folder / f"{side}.csv"
        if os.path.lexists(path) and not begins_with(path, MARK):
            raise InputError(
                f"{path}: is there and not written by `tol3d rig`, which replaces files of its own only; choose "
                "another folder: --out"
            )


def write_readings(readings: Readings, path: Path, *, wrapped: bool = False, mark: str = "") -> None:
    """Write one side as CSV, angles in degrees.

    Args:
        readings: of the side.
        path: the file; one that is there is replaced, once all is written.
        wrapped: angles within one turn, as single-turn encoders give them.
        mark: comment lines above the header.

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
        with whole(path) as beside:
            header = mark + ",".join(columns)
            np.savetxt(beside, table, fmt=formats, delimiter=",", header=header, comments="", encoding="utf-8")
    except OSError as error:
        raise unwritable(path, error, "choose another folder") from None
