"""Faces of solids that features are picked from.

Picking needs the CAD kernel; what was found is kept in the cache, so that the same scene opens without it.
"""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Final

import numpy as np
from pydantic import TypeAdapter

from tol3d.solids.built_shape import BuiltShape
from tol3d.solids.cache import cached
from tol3d.solids.lazy import Arrays, cad
from tol3d.solids.pick import Pick, PickedFace

FACES: Final = TypeAdapter(tuple[PickedFace, ...])
"""As they are kept."""


def picked(shape: BuiltShape, picks: Sequence[Pick]) -> tuple[PickedFace, ...]:
    """The faces that picks mean, in their order.

    Raises:
        PickError: a pick means no face, or several.
        GeometryError: the solid cannot be built.
    """
    asked = json.dumps([asdict(pick) for pick in picks], sort_keys=True)
    kind = f"faces-{hashlib.sha256(asked.encode()).hexdigest()[:16]}"

    def build() -> Arrays:
        return {"faces": np.frombuffer(FACES.dump_json(tuple(cad().pick_faces(shape, picks))), dtype=np.uint8)}

    return FACES.validate_json(cached(kind, shape, {}, build)["faces"].tobytes())
