"""Batches evaluated by an analysis: after an interruption the same analysis resumes from them.

An analysis draws from stated seeds and so asks for the same batches each time. Those that took long are kept in the
cache as they are evaluated, by the digest of all that decides them, and read instead. They go when the analysis ends.
"""

import contextlib
import hashlib
import importlib.util
import io
import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.numerics.cache_folder import cache_folder, read_entry, write_entry
from tol3d.study.runs.manifest import Fingerprint

LONG: Final = 0.2
"""Seconds of an evaluation from which it is kept."""
OLD: Final = 14 * 86_400
"""Seconds after which batches of an analysis that was not resumed are deleted."""
PREFIX: Final = "analysis-"
SUFFIX: Final = ".batch"

Batch = tuple[Array, "np.ndarray[tuple[int, ...], np.dtype[np.int8]]"]
"""Values and codes (n, measures)."""


@dataclass(eq=False)
class KeptBatches:
    """Those of one scene's analyses.

    Args:
        owner: digest of what decides values beside the builds.
        written: True if any was kept since this began.
    """

    owner: str
    written: bool = False

    @classmethod
    def of(cls, fingerprint: Fingerprint, *packages: str) -> "KeptBatches":
        """Those that belong to a fingerprint; what others left long ago goes.

        Args:
            fingerprint: of the scene.
            packages: whose modules decide values, as they stand on the disk.
        """
        _delete(PREFIX, older_than=OLD)
        programs = [_program(package) for package in sorted(set(packages))]
        return cls(_digest(json.dumps([fingerprint, programs], sort_keys=True).encode()))

    def evaluated(self, asked: str, builds: Mapping[str, Array], evaluate: Callable[[], Batch]) -> Batch:
        """A batch as it is kept, else as it is evaluated, and kept if that took long.

        Args:
            asked: the method and the measures that are read.
            builds: deviations and positions.
            evaluate: makes it.
        """
        content = [asked.encode()]
        for name, own in sorted(builds.items()):
            content += [f"{name} {own.shape} {own.dtype}".encode(), np.ascontiguousarray(own).tobytes()]
        name = f"{PREFIX}{self.owner}-{_digest(*content)}{SUFFIX}"
        if (kept := _read(name)) is not None:
            return kept
        begun = time.monotonic()
        values, codes = evaluate()
        if time.monotonic() - begun >= LONG:
            file = io.BytesIO()
            np.savez(file, values=values, codes=codes)
            with contextlib.suppress(OSError, InputError):
                write_entry(name, file.getvalue())
                self.written = True
        return values, codes

    def clear(self) -> None:
        """Delete them."""
        _delete(f"{PREFIX}{self.owner}-")
        self.written = False


def _program(package: str) -> list[tuple[str, int, int]]:
    """Names, sizes and times of the modules of a package."""
    spec = importlib.util.find_spec(package)
    if spec is None or spec.origin is None:
        return []
    folder = Path(spec.origin).parent
    files = sorted(folder.rglob("*.py")) if spec.submodule_search_locations is not None else [Path(spec.origin)]
    stated = [(str(file), file.stat()) for file in files]
    return [(name, own.st_size, own.st_mtime_ns) for name, own in stated]


def _digest(*content: bytes) -> str:
    found = hashlib.blake2b(digest_size=16)
    for own in content:
        found.update(len(own).to_bytes(8, "little"))
        found.update(own)
    return found.hexdigest()


def _read(name: str) -> Batch | None:
    try:
        content = read_entry(name)
    except InputError:
        return None
    if content is None:
        return None
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        return file["values"], file["codes"]


def _delete(prefix: str, older_than: float = 0.0) -> None:
    with contextlib.suppress(OSError, InputError):
        for path in cache_folder().glob(f"{prefix}*{SUFFIX}"):
            with contextlib.suppress(OSError):
                if time.time() - path.stat().st_mtime >= older_than:
                    path.unlink()
