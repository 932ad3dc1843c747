"""Plays of joints as scenes say them, and what they make of the frame before, by the ends of a pin."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from linkage.linked_bodies import LAW, Array, Linkage
from oracles.closed_loops import pose

AXIAL = ("revolute", "prismatic", "cylindrical", "screw")


@dataclass(frozen=True)
class Play:
    """Play of a joint: diameter and length [mm], how it floats."""

    diameter: float
    floating: str
    length: float = 0.0
    along: tuple[float, float, float] = (0.0, 0.0, 1.0)

    @property
    def text(self) -> str:
        along = f", along: {list(self.along)}" if self.floating == "toward" else ""
        length = f", length: {self.length} mm" if self.length else ""
        law = f", distribution: {LAW}"
        key = "play" if self.length else "clearance"
        return f", {key}: {{diameter: {self.diameter} mm{length}{law}, float: {{kind: {self.floating}{along}}}}}"

    def offset(self, shares: Array, wider: float) -> Array:
        """Offset of the frame before (4, 4); shares of the radius, and a deviation of the diameter [mm]."""
        radius = (self.diameter + wider) / 2
        if self.floating == "toward":
            return pose(np.zeros(3), radius * np.array(self.along) / np.linalg.norm(self.along))
        if self.floating == "centred":
            return np.eye(4)
        if not self.length:
            return pose(np.zeros(3), radius * shares)
        start = np.array([*radius * shares[:2], -self.length / 2])
        end = np.array([*radius * shares[2:], self.length / 2])
        z = (end - start) / np.linalg.norm(end - start)
        across = np.cross([0.0, 0.0, 1.0], z)
        sine = np.linalg.norm(across)
        return pose(across / max(float(sine), 1e-300) * np.arctan2(sine, z[2]), (start + end) / 2)


def with_plays(linkage: Linkage) -> tuple[Linkage, Mapping[str, Play]]:
    """Balls random, toward and centred in turn; every other axial joint random at both ends."""
    plays, kinds = dict[str, Play](), ("random", "toward", "centred")
    for name, own in linkage.joints.items():
        count = len(plays)
        if own.kind == "ball":
            plays[name] = Play(0.05 + 0.01 * count, kinds[count % 3], along=(0.3, -0.5 - count, 0.8))
        elif own.kind in AXIAL:
            plays[name] = Play(0.04, "centred" if count % 4 == 3 else "random", 14.0)
    joints = {
        name: replace(own, more=plays[name].text if name in plays else "") for name, own in linkage.joints.items()
    }
    return replace(linkage, joints=joints), plays
