"""Arrays kept on disk under the hash of all that made them.

A file is an uncompressed .npz followed by the SHA-256 of its bytes: a torn or damaged one is seen
before it is parsed, and built anew. It is written aside and renamed, so two runs that build the same
thing at once both end with a whole file. The folder may be deleted at any time.
"""

import contextlib
import hashlib
import io
import json
import os
import pkgutil
import tempfile
import warnings
from collections.abc import Callable, Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np
import platformdirs

from tol3d.gears import Gear
from tol3d.solids.bodies import Body
from tol3d.solids.door import Arrays

FOLDER_VARIABLE = "TOL3D_CACHE"
SOURCES = (
    ("tol3d.gears", "involute.py"),
    ("tol3d.gears", "spherical_involute.py"),
    ("tol3d.gears", "bevel_gear.py"),
    ("tol3d.gears", "spur_gear.py"),
    ("tol3d.parts", "named_solid.py"),
    ("tol3d.parts", "spur_gear.py"),
    ("tol3d.parts", "bevel_cones.py"),
    ("tol3d.parts", "bevel_flank.py"),
    ("tol3d.parts", "bevel_gear.py"),
    ("tol3d.parts", "shaft.py"),
    ("tol3d.parts", "arm.py"),
    ("tol3d.solids", "spur_cad.py"),
    ("tol3d.solids", "bevel_cad.py"),
    ("tol3d.solids", "body_cad.py"),
    ("tol3d.solids", "triangulation.py"),
)
"""What decides the arrays: a change in any of these makes old entries unreachable."""

PACKAGES = ("cadquery", "cadquery-ocp", "numpy", "scipy")
DIGEST_BYTES = 32


class CacheWarning(UserWarning):
    """The cache cannot be used; results are the same, only slower."""


def cached(kind: str, shape: Gear | Body, settings: Mapping[str, float], build: Callable[[], Arrays]) -> Arrays:
    """The arrays of `build`, from the disk where they have been built before.

    Args:
        kind: what they are; part of the key and the start of the file's name.
        shape, settings: what `build` depends on besides the program itself.
        build: makes them.

    Warns:
        CacheWarning: the folder cannot be written; the arrays are returned all the same.
    """
    path = folder() / f"{kind}-{_key(kind, shape, settings)}.npz"
    kept = _read(path)
    if kept is not None:
        return kept
    arrays = build()
    try:
        _write(path, arrays)
    except OSError as error:
        advice = f"set {FOLDER_VARIABLE} to a folder that can be written"
        warnings.warn(f"{path.parent}: cannot keep built geometry ({error.strerror}); {advice}", CacheWarning, 3)
    return arrays


def folder() -> Path:
    """Where arrays are kept: TOL3D_CACHE, or the user's cache folder."""
    stated = os.environ.get(FOLDER_VARIABLE)
    return Path(stated) if stated else platformdirs.user_cache_path("tol3d")


def _key(kind: str, shape: Gear | Body, settings: Mapping[str, float]) -> str:
    sources = {f"{package}/{name}": pkgutil.get_data(package, name) or b"" for package, name in SOURCES}
    told = {
        "kind": kind,
        "shape": repr(shape),
        "settings": dict(settings),
        "versions": {name: _version(name) for name in PACKAGES},
        "sources": {name: hashlib.sha256(text).hexdigest() for name, text in sources.items()},
    }
    # repr and json write the shortest text that gives back the same double, so no two shapes share a key
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # conda installs OCP without naming it so
        return ""


def _read(path: Path) -> Arrays | None:
    try:
        content = path.read_bytes()
    except OSError:
        return None
    payload, digest = content[:-DIGEST_BYTES], content[-DIGEST_BYTES:]
    if hashlib.sha256(payload).digest() != digest:
        return None
    with np.load(io.BytesIO(payload), allow_pickle=False) as entries:
        return {name: entries[name] for name in entries.files}


def _write(path: Path, arrays: Arrays) -> None:
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    payload = buffer.getvalue()
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, unfinished = tempfile.mkstemp(dir=path.parent, prefix=path.stem, suffix=".partial")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(payload + hashlib.sha256(payload).digest())
        os.replace(unfinished, path)
    except OSError:
        with contextlib.suppress(OSError):
            os.unlink(unfinished)
        raise
