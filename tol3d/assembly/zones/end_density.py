"""The marginal density of one end of an axis in a round zone, along one direction.

Given the start at a radius s, the end lies where its own disc of radius 1 meets the disc of radius 2 ratio about the
start; the density of the start at s is its own times the mass of the end there.
"""

import math
from collections.abc import Callable

import numpy as np

from tol3d.assembly.zones.cross_section import SIGMAS
from tol3d.assembly.zones.domain import Array

EndLaw = Callable[[Array], Array]
"""Density of an end at a radius, per area, up to a factor."""

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)
TURNS = 0.5 * math.pi * NODES  # rad; radii at their sine meet the square roots at the ends of an arc


def uniform_end(radius: Array) -> Array:
    """Of an end uniform in its disc."""
    return np.ones_like(radius)


def normal_end(radius: Array) -> Array:
    """Of an end whose coordinates are normals of sigma 1/3."""
    return np.exp(-0.5 * (SIGMAS * radius) ** 2)


def start_density(law: EndLaw, ratio: float, first: Array) -> Array:
    """Density of the start's first coordinate, up to a factor.

    Args:
        law: of either end, without the limit of their difference.
        ratio: largest half difference.
        first: coordinates in [-1, 1], any shape.
    """
    chord = np.sqrt(np.maximum(1.0 - first * first, 0.0))[..., None]
    across = 0.5 * chord * (1.0 + NODES)
    start = np.hypot(first[..., None], across)
    found: Array = (law(start) * _mass_near(law, 2.0 * ratio, start) * WEIGHTS).sum(axis=-1) * chord[..., 0]
    return found


def _mass_near(law: EndLaw, reach: float, start: Array) -> Array:
    """Mass of an end in its disc, within `reach` of a start at radii of any shape: circles wholly near, and arcs."""
    whole = np.clip(reach - start, 0.0, 1.0)[..., None]
    radius = 0.5 * whole * (1.0 + NODES)
    circles = math.pi * whole[..., 0] * (law(radius) * radius * WEIGHTS).sum(axis=-1)
    low = np.minimum(np.abs(start - reach), 1.0)[..., None]
    high = np.minimum(start + reach, 1.0)[..., None]
    radius = 0.5 * (low + high) + 0.5 * (high - low) * np.sin(TURNS)
    start = np.maximum(start, np.finfo(float).tiny)[..., None]
    radius = np.maximum(radius, np.finfo(float).tiny)
    cosine = (radius**2 + start**2 - reach**2) / (2.0 * radius * start)
    arc = np.arccos(np.clip(cosine, -1.0, 1.0))
    steps = 0.25 * math.pi * (high - low) * np.cos(TURNS) * WEIGHTS
    return np.asarray(circles + (2.0 * arc * law(radius) * radius * steps).sum(axis=-1))
