"""Data read off the solid of a bevel gear: rays of its flanks, and the triangulations of all its faces."""

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids.lazy import Arrays
from tol3d.cad.solids.triangulation import Curve, Triangulation, edge_sagittas, largest_sagitta, triangulated
from tol3d.gears import LEFT, RIGHT, BevelGear, Flank
from tol3d.parts.bevel_flank import sample_flank
from tol3d.parts.bevel_gear import build
from tol3d.parts.tooth_edges import SIDES


def sample_flanks(gear: BevelGear, steps: int) -> Arrays:
    """Rays of the flanks, cut to spheres at inner and outer cone distance; a step's sagitta is that at the heel."""
    part = build(gear)
    q = np.linspace(gear.form_q**1.5, gear.tip_q**1.5, steps + 1) ** (2 / 3)
    q[[0, -1]] = gear.form_q, gear.tip_q
    rays = {flank: sample_flank(part, 0, flank, q) for flank in (RIGHT, LEFT)}
    directions = np.stack([sample.directions for sample in rays.values()])
    involute = np.stack([gear.flank_directions(q, flank) for flank in rays])
    outer = gear.outer_cone_distance

    def heel(flank: Flank) -> Curve:
        return lambda places: outer * sample_flank(part, 0, flank, places).directions

    return {
        "parameter": q,
        "inner": gear.inner_cone_distance * directions,
        "outer": outer * directions,
        "normals": np.stack([sample.normals for sample in rays.values()]),
        "chord_error": np.array(max(largest_sagitta(heel(flank), q) for flank in rays)),
        "flank_error": np.array(outer * np.linalg.norm(directions - involute, axis=-1).max()),
    }


def tessellate(gear: BevelGear, deflection: float) -> Arrays:
    """OCC's triangulations of all faces, joined along the edges that they share."""
    part = build(gear)
    whole = triangulated(part, deflection)
    return {
        "vertices": whole.vertices,
        "triangles": whole.triangles,
        "side": _named_sides(whole),
        "chord_error": np.array(max(edge_sagittas(part))),
    }


def _named_sides(whole: Triangulation) -> NDArray[np.int8]:
    """RIGHT, LEFT or 0 for each vertex: the flank or radial face that it lies on."""
    side = np.zeros(len(whole.vertices), dtype=np.int8)
    for name, numbers in whole.on_face.items():
        words = name.split()
        for flank, word in SIDES.items():
            if word in words:
                side[numbers] = flank
    return side
