"""A synthetic rig: encoder readings of a specimen, with the errors that rigs have."""

import os
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from tol3d.apps.records.pair import ARCSEC, TURN, ClosedForm, Side, Specimen, Unit
from tol3d.errors import InputError, unwritable
from tol3d.numerics.arrays import Array
from tol3d.study.runs import made_folder, write_by


@dataclass(frozen=True)
class Rig:
    """Rig: its measurement and its errors; angles of encoders in rad, amplitudes of sinusoids.

    Args:
        turns: of the driver on each side.
        samples: per turn of the driver.
        repeats: passes of each side.
        noise: standard deviation of each encoder.
        resolution: step of each encoder; 0 for none.
        encoder1, encoder2: errors once per turn, each encoder's own.
        tooth_mesh: amplitude of the tooth-mesh order of the transmission error, other phases on either side.
        drift: of the driven encoder over one side.
        torques: [N m] of the passes in turn; () if none is measured and none acts.
        winding: 1/k [rad/(N m)] of the backlash under load, B = j + T/k.
        start: driver's angle at which each side begins.
        hidden_turns: whole turns of the driver by which the back side lies further on, of which the encoders know
            nothing.
        zeroed: True if each side's encoders were set to zero at its start.
        seed: of all random numbers.
    """

    turns: float = 16.0
    samples: int = 720
    repeats: int = 1
    noise: float = 0.5 * ARCSEC
    resolution: float = 0.0
    encoder1: float = 0.0
    encoder2: float = 0.0
    tooth_mesh: float = 0.0
    drift: float = 0.0
    torques: tuple[float, ...] = ()
    winding: float = 0.0
    start: float = 0.0
    hidden_turns: int = 0
    zeroed: bool = False
    seed: int = 1


@dataclass(frozen=True, eq=False)
class Readings:
    """Rows of one side: encoder angles [rad], torque [N m] and repeat, each (rows,); None if there is none."""

    phi1: Array
    phi2: Array
    torque: Array | None
    repeat: Array | None


def measured(unit: Specimen | Unit, rig: Rig, side: Side) -> Readings:
    """One side's rows. Sides differ in where between two steps they are sampled, and in their noise.

    Args:
        unit: under test; flanks of a specimen touch by closed form.
        rig: how.
        side: which flanks touch.

    Raises:
        InputError: the unit cannot be turned.
    """
    own = ClosedForm(unit) if isinstance(unit, Specimen) else unit
    random = np.random.Generator(np.random.Philox(key=[rig.seed, 0 if side == "drive" else 1]))
    phases = np.random.Generator(np.random.Philox(key=[rig.seed, 2])).uniform(0.0, TURN, 6)
    passes = [_pass(own, rig, side, repeat, random, phases) for repeat in range(rig.repeats)]
    phi1, phi2 = (np.concatenate([each[k] for each in passes]) for k in (0, 1))
    rows = len(passes[0][0])
    torque = np.repeat([_torque(rig, repeat) for repeat in range(rig.repeats)], rows) if rig.torques else None
    return Readings(phi1, phi2, torque, np.repeat(np.arange(1.0, rig.repeats + 1), rows) if rig.repeats > 1 else None)


def _torque(rig: Rig, repeat: int) -> float:
    return rig.torques[repeat % len(rig.torques)] if rig.torques else 0.0


def _pass(
    unit: Unit, rig: Rig, side: Side, repeat: int, random: np.random.Generator, phases: Array
) -> tuple[Array, Array]:
    rows = round(rig.turns * rig.samples)
    along = np.arange(rows) / rig.samples * TURN
    start = rig.start + (0.0 if side == "drive" or rig.zeroed else random.uniform(0.0, TURN / rig.samples))
    phi1 = start + along
    hidden = rig.hidden_turns if side == "back" else 0
    pair, sense = unit.pair, -1.0 if side == "drive" else 1.0
    phi2 = unit.driven_angle(phi1 + TURN * hidden, side) - pair.rate * TURN * hidden
    phi2 = phi2 + sense * _torque(rig, repeat) * rig.winding / 2
    phi2 = phi2 + rig.tooth_mesh * np.sin(pair.driver_teeth * phi1 + phases[4 if side == "drive" else 5])
    phi2 = phi2 + rig.drift * (along / max(along[-1], 1e-12) + repeat)
    turned = phi2 + pair.rate * TURN * hidden
    read1 = phi1 + rig.encoder1 * np.sin(phi1 + phases[0])
    read2 = phi2 + rig.encoder2 * np.sin(turned + phases[1])
    read1, read2 = (_read(angle, rig, random) for angle in (read1, read2))
    if rig.zeroed:
        read1, read2 = read1 - read1[0], read2 - read2[0]
    return read1, read2


def _read(angle: Array, rig: Rig, random: np.random.Generator) -> Array:
    """An encoder's angles: noise, then its steps."""
    noisy = angle + random.normal(0.0, rig.noise, len(angle)) if rig.noise > 0.0 else angle
    return np.asarray(np.round(noisy / rig.resolution) * rig.resolution if rig.resolution > 0.0 else noisy)


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
        header = mark + ",".join(columns)
        form = partial(np.savetxt, fmt=formats, delimiter=",", header=header, comments="", encoding="utf-8")
        write_by(path, lambda stream: form(stream, table))
    except OSError as error:
        raise unwritable(path, error, "choose another folder") from None


def begins_with(path: Path, text: str) -> bool:
    """True if a file begins with a text."""
    try:
        with path.open("rb") as file:
            return path.is_file() and file.read(len(text.encode())) == text.encode()
    except OSError:
        return False
