"""Arrays of solids kept on disk, under the hash of all inputs: uncompressed .npz in the cache's folder."""

import hashlib
import io
import json
import warnings
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from typing import Final

import numpy as np
from pydantic import TypeAdapter

from tol3d.cad.solids.built_shape import BuiltShape
from tol3d.cad.solids.lazy import CAD, Arrays, cad
from tol3d.cad.solids.pick import Pick, PickedFace
from tol3d.cad.solids.posed_gear import Body
from tol3d.gears import Gear
from tol3d.numerics.cache_folder import FOLDER_VARIABLE, cache_folder, read_entry, write_entry
from tol3d.numerics.sources import sources_of

PACKAGES: Final = ("cadquery", "cadquery-ocp", "numpy", "scipy")
"""Packages whose versions decide the arrays."""
FACES: Final = TypeAdapter(tuple[PickedFace, ...])
"""Faces as they are kept."""


class CacheWarning(UserWarning):
    """The cache cannot be written; results are the same, only slower."""


def cached(
    kind: str, shape: Gear | Body | BuiltShape, settings: Mapping[str, float], build: Callable[[], Arrays]
) -> Arrays:
    """The arrays of `build`, from the disk if they have been built before.

    Those of a builder without source, as of a program that is typed in, are built anew each time.

    Args:
        kind: of the arrays; part of the key and the start of the file's name.
        shape, settings: inputs of `build` besides the program itself.
        build: makes them.

    Warns:
        CacheWarning: the folder cannot be written; the arrays are returned all the same.
    """
    try:
        name = f"{kind}-{_key(kind, shape, settings)}.npz"
    except (OSError, ValueError):  # a builder without source
        return build()
    kept = _read(name)
    if kept is not None:
        return kept
    arrays = build()
    try:
        _write(name, arrays)
    except OSError as error:
        advice = f"set {FOLDER_VARIABLE} to a folder that can be written"
        warnings.warn(f"{cache_folder()}: cannot keep built geometry ({error.strerror}); {advice}", CacheWarning, 3)
    return arrays


def picked(shape: BuiltShape, picks: Sequence[Pick]) -> tuple[PickedFace, ...]:
    """The faces that picks mean, in their order.

    Raises:
        PickError: a pick means no face, or several.
        GeometryError: the solid cannot be built.
    """
    picks_text = json.dumps([asdict(pick) for pick in picks], sort_keys=True)
    kind = f"faces-{hashlib.sha256(picks_text.encode()).hexdigest()[:16]}"

    def build() -> Arrays:
        return {"faces": np.frombuffer(FACES.dump_json(tuple(cad().pick_faces(shape, picks))), dtype=np.uint8)}

    return FACES.validate_json(cached(kind, shape, {}, build)["faces"].tobytes())


def _key(kind: str, shape: Gear | Body | BuiltShape, settings: Mapping[str, float]) -> str:
    inputs = {
        "kind": kind,
        "shape": repr(shape),
        "settings": dict(settings),
        "versions": {name: _version(name) for name in PACKAGES},
        "sources": sources_of(CAD, *_builder_modules(shape)),
    }
    if isinstance(shape, BuiltShape):
        inputs["builder"] = shape.builder
    # repr and json write the shortest text that gives back the same double, so no two shapes share a key
    return hashlib.sha256(json.dumps(inputs, sort_keys=True).encode()).hexdigest()


def _builder_modules(shape: Gear | Body | BuiltShape) -> tuple[str, ...]:
    """Module of a shape's builder; none of gears and bodies, which CAD itself builds."""
    return (shape.builder.partition(":")[0],) if isinstance(shape, BuiltShape) else ()


@lru_cache
def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # conda installs OCP without naming it so
        return ""


def _read(name: str) -> Arrays | None:
    content = read_entry(name)
    if content is None:
        return None
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as entries:
            return {array: entries[array] for array in entries.files}
    except (ValueError, EOFError, zipfile.BadZipFile):  # a whole file, but not one of arrays
        return None


def _write(name: str, arrays: Arrays) -> None:
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    write_entry(name, buffer.getvalue())
