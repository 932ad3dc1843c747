"""Efficiency of the 3K set in closed form, as published; ring 1 held, the carrier free.

Source: Wang, Yang, Du, Chen: Design of 3K planetary gear reducers with no backlash, China Mechanical Engineering
2024(1), doi 10.3969/j.issn.1004-132X.2024.01.003, by the power in the meshes seen from the carrier. Which gear drives
each mesh is taken as it is in a set that does not lock itself: where the backward one is 0 or less, its size has no
meaning.
"""

from typing import NamedTuple

from tol3d.planetary.tooth_set import ToothSet


class Efficiencies(NamedTuple):
    """Of a set, driven at the sun and driven at ring 2."""

    forward: float
    backward: float


class MeshEfficiencies(NamedTuple):
    """Of the meshes a (sun), b (ring 1), c (ring 2)."""

    a: float
    b: float
    c: float


def inner_ratios(teeth: ToothSet) -> tuple[float, float]:
    """I1 = z_R1/z_S and I2 = z_R1 z_P2/(z_R2 z_P1) of a 3K set."""
    sun, ring_1, ring_2 = teeth.meshes
    return ring_1.teeth / sun.teeth, ring_1.teeth * ring_2.planet_teeth / (ring_2.teeth * ring_1.planet_teeth)


def published_efficiencies(teeth: ToothSet, meshes: MeshEfficiencies) -> Efficiencies:
    """Forward and backward.

    >>> from tol3d.planetary.tooth_set import wolfrom
    >>> own = published_efficiencies(wolfrom(25, 27, 79, 24, 76), MeshEfficiencies(0.99, 0.995, 0.993))
    >>> round(own.forward, 7), round(own.backward, 7)
    (0.8631271, 0.8430985)
    """
    i1, i2 = inner_ratios(teeth)
    a, b, c = meshes
    if i2 < 1:
        forward = (1 + a * b * i1) * (1 - i2) / ((1 + i1) * (1 - b * c * i2))
        backward = (1 + i1) * a * (b * c - i2) / (c * (a * b + i1) * (1 - i2))
    else:
        forward = (i2 - 1) * (i1 * a * c + b * c) / ((i2 - b * c) * (1 + i1))
        backward = (i2 * c - 1 / b) * (1 + i1) / ((i1 / a + 1 / b) * (i2 - 1))
    return Efficiencies(forward, backward)
