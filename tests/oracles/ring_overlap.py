"""By how much the outlines of a ring and a gear in it overlap over a pitch of turning: dense points in polar form.

Fillets are found by searching for the circle that touches flank and root circle. A point of one gear overlaps the other
by the arc that it lies within a tooth, taken at its own radius.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

FLANK_POINTS = 1500
FILLET_POINTS = 600
LAND_POINTS = 15


@dataclass(frozen=True)
class Outline:
    """One side of a gear's tooth as (radius, half a tooth's azimuth), and what it is made of."""

    teeth: int
    module: float
    alpha: float
    thickness: float
    tip: float
    root: float
    fillet: float
    inside: bool

    def involute_half_angle(self, radius: np.ndarray) -> np.ndarray:
        base = self.module * self.teeth / 2 * math.cos(self.alpha)
        working = np.arccos(np.minimum(base / radius, 1.0))
        grown = np.tan(working) - working - (math.tan(self.alpha) - self.alpha)
        return self.thickness / (self.module * self.teeth) + (grown if self.inside else -grown)

    @cached_property
    def side(self) -> tuple[np.ndarray, np.ndarray]:
        """Radii rising from the smaller to the larger end, and half a tooth's azimuth there."""
        centre_radius = self.root + (-self.fillet if self.inside else self.fillet)
        near = np.linspace(min(self.tip, self.root), max(self.tip, self.root), 20_001)
        azimuth = self.involute_half_angle(near)
        flank = near[:, None] * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)

        def apart(at: float) -> float:
            centre = centre_radius * np.array([math.cos(at), math.sin(at)])
            place = int(np.argmin(np.hypot(*(flank - centre).T)))
            first, last = flank[max(place - 1, 0)], flank[min(place + 1, len(flank) - 1)]
            along = (last - first) / np.hypot(*(last - first))
            off = centre - flank[place]  # curvature over a step is 1e-9 mm
            return abs(float(along[0] * off[1] - along[1] * off[0])) - self.fillet

        on_flank = float(self.involute_half_angle(np.array([centre_radius]))[0])
        at = brentq(apart, on_flank, on_flank + 4 * self.fillet / centre_radius, xtol=1e-12)
        centre = centre_radius * np.array([math.cos(at), math.sin(at)])
        place = int(np.argmin(np.hypot(*(flank - centre).T)))
        touch, bottom = flank[place], self.root * centre / centre_radius
        begin, end = (math.atan2(*(point - centre)[::-1]) for point in (touch, bottom))
        turn = np.linspace(begin, begin + math.remainder(end - begin, 2 * math.pi), FILLET_POINTS)
        arc = centre[:, None] + self.fillet * np.stack([np.cos(turn), np.sin(turn)])
        radii = np.linspace(self.tip, near[place], FLANK_POINTS)
        radius = np.concatenate([radii, np.hypot(*arc)[1:]])
        half = np.concatenate([self.involute_half_angle(radii), np.arctan2(arc[1], arc[0])[1:]])
        order = np.argsort(radius)
        return radius[order], half[order]

    def depth(self, radius: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
        """By which arc [mm] points lie within the gear; negative outside of it, -inf beyond its tip circle."""
        radii, half = self.side
        pitch = 2 * math.pi / self.teeth
        off = np.abs(azimuth - pitch * np.floor(azimuth / pitch + 0.5))
        arc = radius * (np.interp(radius, radii, half) - off)
        beyond = radius < self.tip if self.inside else radius > self.tip
        below = radius - self.root if self.inside else self.root - radius
        return np.where(beyond, -np.inf, np.where(below > 0.0, below, arc))

    def tooth(self) -> tuple[np.ndarray, np.ndarray]:
        """Both sides of tooth 0 and its land, as radii and azimuths; corners first."""
        radii, half = self.side
        corner = float(np.interp(self.tip, radii, half))
        land = np.linspace(-corner, corner, LAND_POINTS)
        return (
            np.concatenate([[self.tip, self.tip], radii, radii, np.full(LAND_POINTS, self.tip)]),
            np.concatenate([[-corner, corner], -half, half, land]),
        )


def overlap(ring: Outline, inner: Outline, distance: float, turns: np.ndarray, corners_only: bool) -> float:
    """Largest depth [mm] of points of either gear in the other; negative: they clear each other.

    Args:
        ring, inner: the ring's axis is the origin, the inner gear's at (distance, 0).
        turns: (n, 2) [rad], of ring and inner gear.
        corners_only: tip corners, or every point of the outlines.
    """
    worst = -math.inf
    for own, mate, own_at, mate_at, column in ((inner, ring, distance, 0.0, 1), (ring, inner, 0.0, distance, 0)):
        radius, azimuth = (points[: 2 if corners_only else None] for points in own.tooth())
        for tooth in range(own.teeth):
            at = turns[:, column, None] + azimuth + 2 * math.pi * tooth / own.teeth
            x, y = radius * np.cos(at) + own_at - mate_at, radius * np.sin(at)
            deep = mate.depth(np.hypot(x, y), np.arctan2(y, x) - turns[:, 1 - column, None])
            worst = max(worst, float(deep.max()))
    return worst
