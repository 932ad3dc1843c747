"""Identifying from large files: time, and peak memory, which must not grow with the rows.

    python benchmarks/rig_records.py [--rows 1000000 100000000] [--disk /data]

Each size is read by a process of its own, its files written by another one before and deleted after: 52 bytes a row of
both sides, so 5.2 GB at 10^8 rows a side, the most that a file may have. Rows are of the reference pair of
docs/records.md over its long period of 16 turns. The fit is timed by itself: what is left once rows are gathered by
position.
"""

import argparse
import json
import math
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pc

from tol3d.apps.records.findings import Settings
from tol3d.apps.records.identification import identified, identify
from tol3d.apps.records.pair import ARCSEC, RigPair, Side, Specimen
from tol3d.apps.records.reading import read_side, senses_of
from tol3d.apps.records.rig import Rig, measured

COS = math.cos(math.radians(20))
PAIR = RigPair(27, 48, 27 * COS, 48 * COS, 75.0)
SPECIMEN = Specimen(PAIR, 0.018, math.radians(40), 0.027, math.radians(-65), 0.060)
TURNS = 16
MOST_AT_ONCE = 2**20  # rows; a long file is made piece by piece
SIDES: tuple[Side, ...] = ("drive", "back")


@dataclass(frozen=True)
class Timed:
    """One size.

    Args:
        seconds: of reading and fitting, by the clock.
        processor: the same by processor time.
        fit: of that, for the fit, its checks and figures.
        peak_mb: largest resident size of the process.
        least: least backlash [arcsec], so that what is timed is right.
    """

    seconds: float
    processor: float
    fit: float
    peak_mb: float
    least: float


def write(folder: Path, rows: int) -> None:
    """Files of both sides."""
    chunks = TURNS * 2 ** max(0, math.ceil(math.log2(rows / TURNS / MOST_AT_ONCE)))
    for side in SIDES:
        with (folder / f"{side}.csv").open("wb") as file:
            file.write(b"phi1 [deg],phi2 [deg]\n")
            for chunk in range(chunks):
                start = 2 * math.pi * chunk * TURNS / chunks
                rig = Rig(turns=TURNS / chunks, samples=rows // TURNS, noise=0.5 * ARCSEC, start=start, seed=chunk)
                made = measured(SPECIMEN, rig, side)
                columns = [np.round(np.degrees(own), 8) for own in (made.phi1, made.phi2)]
                table = pa.table(dict(zip("ab", map(pa.array, columns), strict=True)))
                pc.write_csv(table, file, pc.WriteOptions(include_header=False))


def timed(folder: Path) -> Timed:
    """Identify from the files of a folder, in this process."""
    drive, back = ([folder / f"{side}.csv"] for side in SIDES)
    start, busy = time.perf_counter(), time.process_time()
    found = identify(PAIR, drive, back, Settings())
    least = found.figures["jmin eccentric"].value / ARCSEC
    seconds, processor = time.perf_counter() - start, time.process_time() - busy
    senses = senses_of(drive[0], None)
    read = {
        side: tuple(read_side(PAIR, own, None, senses, lambda rows: None))
        for side, own in zip(SIDES, (drive, back), strict=True)
    }
    busy = time.process_time()
    _ = identified(PAIR, read, senses, Settings()).figures
    fit = time.process_time() - busy
    return Timed(seconds, processor, fit, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, least)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", type=int, nargs="+", default=[10**5, 10**6, 10**7])
    parser.add_argument("--disk", type=Path, help="folder with room for the files; the system's temporary one")
    parser.add_argument("--write", type=Path, help=argparse.SUPPRESS)  # files of the first size there
    parser.add_argument("--time", type=Path, help=argparse.SUPPRESS)  # the files there
    given = parser.parse_args(arguments)
    if given.write:
        write(given.write, given.rows[0])
    elif given.time:
        print(json.dumps(asdict(timed(given.time))))
    else:
        for rows in given.rows:
            with tempfile.TemporaryDirectory(dir=given.disk) as folder:
                _by_another_process("--write", folder, "--rows", str(rows))
                own = Timed(**json.loads(_by_another_process("--time", folder)))
            _show(rows, own)


def _by_another_process(*arguments: str) -> str:
    """Output of another process; a process begins with its parent's peak memory, so this one stays small."""
    words = [sys.executable, str(Path(__file__).resolve()), *arguments]
    return subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True).stdout


def _show(rows: int, own: Timed) -> None:
    time_words = f"{own.seconds:6.2f} s, {own.processor:6.2f} s of a processor, the fit {own.fit:5.2f} s of it"
    found = f"{own.peak_mb:5.0f} MB at the peak; least backlash {own.least:.3f} arcsec"
    print(f"{rows:>10} rows a side: {time_words}; {found}")


if __name__ == "__main__":
    main()
