"""Data read off the solid of a cylindrical gear, external or internal: flanks swept along z, one end with its rims.

The flanks of a helical gear are ruled by the tangents of its base helix, on which w = t + sigma kappa z is constant, t
the roll; of an internal one it is t - sigma kappa z. Its strips lie between such generators, each as long as the flank
is there: the normal is constant along it.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids.lazy import Arrays
from tol3d.cad.solids.swept_cad import Rim, RuledFace, swept_mesh
from tol3d.cad.solids.triangulation import largest_sagitta
from tol3d.gears import LEFT, RIGHT, Flank, InternalGear, SpurGear
from tol3d.numerics.arrays import Array
from tol3d.parts import internal_gear, spur_gear
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.tooth_edges import SIDES, flank_name, roll_span

LOOKED_AT: Final = 4096  # steps across a flank in which its generators are shared out
CORNER: Final = 1e-5  # of the face; length of the generators at a flank's corners, which would have no direction
MOST_TEETH = 500  # of a gear that is built whole for its strips: 15 s; each further one 0.03 s and 0.2 MB


# measuring strips -----------------------------------------------------------------------------------


def sample_flanks(gear: SpurGear | InternalGear, steps: int) -> Arrays:
    """See cad.sample_flanks."""
    part = build(gear) if gear.teeth <= MOST_TEETH else _build_tooth(gear)
    if gear.helix_angle:
        return _sample_screws(gear, part, steps)
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


def _sample_screws(gear: SpurGear | InternalGear, part: NamedSolid, steps: int) -> Arrays:
    """The same of a helical gear; the parameter is w, which is of one range on both flanks."""
    first, last = roll_span(gear)
    leaning = abs(gear.twist) * gear.face_width / 2
    w = _evenly_bent(first, last, leaning, steps)
    longest = np.minimum(last, w + leaning)
    middle = (w[1:] + w[:-1]) / 2
    bent = gear.base_radius * np.minimum(last, middle + leaning) * np.diff(w) ** 2 / 8
    found: dict[str, list[Array]] = {"inner": [], "outer": [], "normals": []}
    flank_error = 0.0
    for flank in (RIGHT, LEFT):
        face, fall = RuledFace(part.faces[flank_name(0, flank)]), gear.iso_sign * flank * gear.twist
        rolls = np.clip([w + fall * gear.face_width / 2, w - fall * gear.face_width / 2], first, last)
        for name, roll in zip(("inner", "outer"), rolls, strict=True):
            place = face.places(roll, (w - roll) / fall)
            found[name].append(place)
            flank_error = max(
                flank_error, float(np.abs(place - _screw_points(gear, roll, (w - roll) / fall, flank)).max())
            )
        found["normals"].append(face.place_normals(longest, (w - longest) / fall))
    return {name: np.stack(own) for name, own in found.items()} | {
        "parameter": w,
        "chord_error": np.array(bent.max() * gear.base_helix_cosine),
        "flank_error": np.array(flank_error),
    }


def _evenly_bent(first: float, last: float, leaning: float, steps: int) -> Array:
    """Generators w (steps + 1,) [rad] whose steps leave the flank by about as much: the roll times the step's square.

    The first and the last generator are the flank's corners; they are as long as CORNER of the face there.
    """
    corner = CORNER * 2 * leaning
    w = np.linspace(first - leaning + corner, last + leaning - corner, LOOKED_AT + 1)
    share = np.sqrt(np.minimum(last, (w[1:] + w[:-1]) / 2 + leaning))
    passed = np.concatenate([[0.0], np.cumsum(share)])
    return np.asarray(np.interp(np.linspace(0.0, passed[-1], steps + 1), passed, w))


def _screw_points(gear: SpurGear | InternalGear, roll: Array, z: Array, flank: Flank) -> Array:
    """Points (n, 3) [mm] of a flank of tooth 0 at rolls [rad] and heights [mm]."""
    x, y = gear.flank_points(roll, flank).T
    cos, sin = np.cos(gear.twist * z), np.sin(gear.twist * z)
    return np.stack([cos * x - sin * y, sin * x + cos * y, z], axis=-1)


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
    kind = internal_gear if isinstance(gear, InternalGear) else spur_gear
    straight = kind.build_straight(gear)
    mesh = swept_mesh(straight, gear.face_width, deflection, gear.twist)
    return mesh.arrays(np.tile(_sides(mesh.rims, mesh.count), mesh.layers))


def _sides(rims: Sequence[Rim], count: int) -> NDArray[np.int8]:
    """RIGHT, LEFT or 0 for each node; where a full round joins two teeth its lowest point turns with neither."""
    touched = {flank: np.zeros(count, dtype=np.int8) for flank in (RIGHT, LEFT)}
    for rim in rims:
        words = rim.face.split()
        for flank, side in SIDES.items():
            if side in words:
                touched[flank][rim.nodes] = 1
    return touched[RIGHT] - touched[LEFT]
