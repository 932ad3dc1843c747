"""Data read off the solid of a spur gear, external or internal: flanks swept along z, one end with its rims."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids.lazy import Arrays
from tol3d.cad.solids.swept_cad import Rim, RuledFace, swept_mesh
from tol3d.cad.solids.triangulation import largest_sagitta
from tol3d.gears import LEFT, RIGHT, InternalGear, SpurGear
from tol3d.numerics.arrays import Array
from tol3d.parts import internal_gear, spur_gear
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.tooth_edges import SIDES, flank_name, roll_span

MOST_TEETH = 500  # of a gear that is built whole for its strips: 15 s; each further one 0.03 s and 0.2 MB


# measuring strips -----------------------------------------------------------------------------------


def sample_flanks(gear: SpurGear | InternalGear, steps: int) -> Arrays:
    """See cad.sample_flanks."""
    part = build(gear) if gear.teeth <= MOST_TEETH else _build_tooth(gear)
    first, last = roll_span(gear)
    roll = np.linspace(first**1.5, last**1.5, steps + 1) ** (2 / 3)
    roll[[0, -1]] = first, last
    faces = {flank: RuledFace(part.faces[flank_name(0, flank)]) for flank in (RIGHT, LEFT)}
    profile = np.stack([face.profile(roll) for face in faces.values()])
    involute = np.stack([gear.flank_points(roll, flank) for flank in faces])
    normals = np.stack([face.normals(roll) for face in faces.values()])
    return {
        "parameter": roll,
        "inner": _at_height(profile, -gear.face_width / 2),
        "outer": _at_height(profile, gear.face_width / 2),
        "normals": _at_height(normals, 0.0),
        "chord_error": np.array(max(largest_sagitta(face.profile, roll) for face in faces.values())),
        "flank_error": np.array(np.hypot(*(profile - involute).T).max()),
    }


def build(gear: SpurGear | InternalGear) -> NamedSolid:
    """The whole gear."""
    return internal_gear.build(gear) if isinstance(gear, InternalGear) else spur_gear.build(gear)


def _build_tooth(gear: SpurGear | InternalGear) -> NamedSolid:
    return internal_gear.build_tooth(gear) if isinstance(gear, InternalGear) else spur_gear.build_tooth(gear)


def _at_height(plane: Array, z: float) -> Array:
    return np.concatenate([plane, np.full((*plane.shape[:-1], 1), z)], axis=-1)


# display mesh ---------------------------------------------------------------------------------------


def tessellate(gear: SpurGear | InternalGear, deflection: float) -> Arrays:
    """See tol3d.cad.solids.swept_cad.swept_mesh; vertices know the side of their tooth."""
    mesh = swept_mesh(build(gear), gear.face_width, deflection)
    return mesh.arrays(np.tile(_sides(mesh.rims, mesh.count), 2))


def _sides(rims: Sequence[Rim], count: int) -> NDArray[np.int8]:
    """RIGHT, LEFT or 0 for each node; where a full round joins two teeth its lowest point turns with neither."""
    touched = {flank: np.zeros(count, dtype=np.int8) for flank in (RIGHT, LEFT)}
    for rim in rims:
        words = rim.face.split()
        for flank, side in SIDES.items():
            if side in words:
                touched[flank][rim.nodes] = 1
    return touched[RIGHT] - touched[LEFT]
