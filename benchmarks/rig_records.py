"""Identifying from large files: time, and peak memory, which must not grow with the rows.

    python benchmarks/rig_records.py [--rows 1000000 10000000]

Each size is a process of its own; its files are written before and not counted. Rows are of the reference pair of
docs/records.md over its long period of 16 turns, so many on each side. The fit is timed by itself: what is left once
rows are gathered by position.
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

from tol3d.records.exact_play import Side
from tol3d.records.identify import Settings, identified, identify
from tol3d.records.pair import ARCSEC, RigPair, Specimen
from tol3d.records.reading import read_side, senses_of
from tol3d.records.rig import Rig, measured

COS = math.cos(math.radians(20))
PAIR = RigPair(27, 48, 27 * COS, 48 * COS, 75.0)
SPECIMEN = Specimen(PAIR, 0.018, math.radians(40), 0.027, math.radians(-65), 0.060)
TURNS = 16
CHUNKS = 16  # a long file is made turn by turn
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
    for side in SIDES:
        with (folder / f"{side}.csv").open("wb") as file:
            file.write(b"phi1 [deg],phi2 [deg]\n")
            for chunk in range(CHUNKS):
                start = 2 * math.pi * chunk * TURNS / CHUNKS
                rig = Rig(turns=TURNS / CHUNKS, samples=rows // TURNS, noise=0.5 * ARCSEC, start=start, seed=chunk)
                made = measured(SPECIMEN, rig, side)
                columns = [np.round(np.degrees(own), 8) for own in (made.phi1, made.phi2)]
                table = pa.table(dict(zip("ab", map(pa.array, columns), strict=True)))
                pc.write_csv(table, file, pc.WriteOptions(include_header=False))


def timed(folder: Path) -> Timed:
    """Identify from the files of a folder, in this process."""
    drive, back = ([folder / f"{side}.csv"] for side in SIDES)
    start, busy = time.perf_counter(), time.process_time()
    found = identify(PAIR, drive, back, Settings())
    least = found.figures["jmin"].value / ARCSEC
    seconds, processor = time.perf_counter() - start, time.process_time() - busy
    senses = senses_of(drive[0], None)
    read = {
        side: read_side(PAIR, own, None, senses, lambda rows: None)
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
    parser.add_argument("--folder", type=Path, help=argparse.SUPPRESS)  # time the files there
    given = parser.parse_args(arguments)
    if given.folder:
        print(json.dumps(asdict(timed(given.folder))))
        return
    for rows in given.rows:
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder), rows)
            words = [sys.executable, str(Path(__file__).resolve()), "--folder", folder]
            done = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True)
            own = Timed(**json.loads(done.stdout))
        time_words = f"{own.seconds:6.2f} s, {own.processor:6.2f} s of a processor, the fit {own.fit:5.2f} s of it"
        found = f"{own.peak_mb:5.0f} MB at the peak; least backlash {own.least:.3f} arcsec"
        print(f"{rows:>10} rows a side: {time_words}; {found}")


if __name__ == "__main__":
    main()
