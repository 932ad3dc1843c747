"""Faces of solids that features are picked from.

Picking needs the CAD kernel; what was found is kept in the cache, so that the same scene opens without it.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict

import numpy as np

from tol3d.solids.built_shape import BuiltShape
from tol3d.solids.cache import cached
from tol3d.solids.lazy import Arrays, cad
from tol3d.solids.pick import Pick, PickedFace


def picked(shape: BuiltShape, picks: Sequence[Pick]) -> tuple[PickedFace, ...]:
    """The faces that picks mean, in their order.

    Raises:
        PickError: a pick means no face, or several.
        GeometryError: the solid cannot be built.
    """
    asked = json.dumps([asdict(pick) for pick in picks], sort_keys=True)
    kind = f"faces-{hashlib.sha256(asked.encode()).hexdigest()[:16]}"

    def build() -> Arrays:
        found = json.dumps([asdict(face) for face in cad().pick_faces(shape, picks)])
        return {"faces": np.frombuffer(found.encode(), dtype=np.uint8)}

    kept = json.loads(cached(kind, shape, {}, build)["faces"].tobytes())
    return tuple(face_from(values) for values in kept)


def face_from(values: Mapping[str, object]) -> PickedFace:
    """A face from its values as JSON has them, lists for tuples."""
    return PickedFace(**{name: tuple(own) if isinstance(own, list) else own for name, own in values.items()})  # type: ignore[arg-type]
