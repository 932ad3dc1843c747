"""Composite tolerances: the motion of a pattern as a whole, which the lower segment leaves within the upper one.

Each feature lies in the lower segment's zone about a place that shifts and turns with the pattern. The pattern moves by
the excess of the upper zone over the lower one, so both segments are kept in every trial.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.assembly.from_scene.datums import frame_on
from tol3d.assembly.from_scene.zones import drawn_by, limited_along
from tol3d.assembly.grammar.datums import DatumSpec
from tol3d.assembly.grammar.drawing import Drawing, Stated
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.tolerances.location import Composite
from tol3d.assembly.model import Assembly, Feature, Part
from tol3d.assembly.placing.nominal_constraints import held_by_datums
from tol3d.assembly.zones import ZoneDraw, catalogue
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene

SEEN = 1e-9
"""Fraction of the largest motion that affects features, below which there is no effect: directions have some digits."""


BENT: Final = 0.005
"""Share of the lower zone that a turn's second order takes at most: a tilt of short holes shortens their pattern."""


@dataclass(frozen=True, eq=False)
class Member:
    """A feature of a pattern, in its part's frame.

    Args:
        name: with its part.
        feature: nominally.
        along: directions in which its zone limits it (directions, 3), in its own frame.
        reach: of its zone beyond its end along +z [mm]; None where the zone holds the feature itself.
    """

    name: str
    feature: Feature
    along: Array
    reach: float | None = None

    @property
    def place(self) -> Array:
        """Its middle (3,)."""
        return np.asarray(self.feature.frame[:3, 3])

    @property
    def directions(self) -> Array:
        """`along`, in the part's frame."""
        return np.asarray(self.along @ self.feature.frame[:3, :3].T)

    @cached_property
    def judged(self) -> Array:
        """Points where its zone holds it (points, 3), from its middle [mm]; of a disc a square about its rim's ends."""
        ends = self.feature.shape.ends
        if self.reach is not None:
            ends = ends[-1] + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, self.reach]])
        return np.asarray(ends @ self.feature.frame[:3, :3].T)

    def levers(self, centre: Array) -> Array:
        """Displacement (points, directions, 3) of what is judged along its directions, per turn about a centre."""
        arms = self.place - centre + self.judged
        return np.cross(arms[:, None, :], self.directions[None])

    def largest_displacement(self, centre: Array, turns: Array) -> float:
        """The largest displacement by a turn of length 1 among turns (3, turns); of a disc a bound."""
        if radius := self.feature.shape.rim_radius:
            middle = np.cross(self.place - centre, self.directions[0]) @ turns
            rim = np.cross(self.feature.frame[:3, :2].T, self.directions[0]) @ turns
            return float(np.linalg.norm(middle) + radius * np.linalg.norm(rim, 2))
        return max(float(np.linalg.norm(lever @ turns, 2)) for lever in self.levers(centre))

    def moved(self, centre: Array, shifts: Array, turns: Array) -> Array:
        """Its components (components, motions) by shifts (3, shifts) and turns (3, turns) about a centre."""
        frame = self.feature.frame
        seen = self.along.T @ self.along @ frame[:3, :3].T  # of a displacement, in its own frame

        def displaced(point: Array) -> Array:
            arm = self.place - centre + frame[:3, :3] @ point
            turned = np.cross(turns, arm, axisa=0, axisb=0, axisc=0) if turns.size else turns
            return np.asarray(seen @ np.hstack([shifts, turned]))

        return self.feature.shape.moved(displaced)


def motion_of(scene: Scene, drawing: Drawing, pattern: Sequence[Stated]) -> tuple[ZoneDraw, dict[str, Array], str]:
    """The motion of a pattern as a whole: its draw, its effect on each feature, and its word.

    Args:
        scene: the scene.
        drawing: its tolerances.
        pattern: a composite tolerance of each of its features.
    """
    spec = pattern[0].spec
    assert isinstance(spec, Composite)
    assert spec.lower_segment is not None
    members = [_member(drawing, own, spec) for own in pattern]
    centre = np.mean([member.place for member in members], axis=0)
    first = members[0].feature.frame[:3, :3]
    seen = sum(member.directions.T @ member.directions for member in members)
    shifts = _basis(np.asarray(seen), first)
    room = spec.zone.size - spec.lower_segment.zone.size
    free = _free_turns(drawing, part_of(pattern[0].feature), spec.lower_segment.datums or ())
    square = sum((row.T @ row for member in members for row in member.levers(centre)), np.zeros((3, 3)))
    turns = _basis(free @ square @ free, first)
    if turns.size:
        sizes, axes = np.linalg.eigh(turns.T @ square @ turns)
        alike = 1.0 / np.sqrt(sizes)  # such that all of them move features alike
        farthest = max(
            member.largest_displacement(centre, turns @ axes @ np.diag(alike) @ axes.T) for member in members
        )
        reach = max(float(np.linalg.norm(member.place - centre + member.judged, axis=1).max()) for member in members)
        most = math.sqrt(BENT * spec.lower_segment.zone.size / reach) / (0.5 * room)
        turns = turns @ axes @ np.diag(np.minimum(alike / farthest, most)) @ axes.T
    zone = catalogue.pattern_motion(room, shifts.shape[1], turns.shape[1])
    moved = {member.name: member.moved(centre, shifts, turns) for member in members}
    return drawn_by(spec.law, zone, scene.files), moved, "shift and turn" if turns.size else "shift"


def _member(drawing: Drawing, own: Stated, spec: Composite) -> Member:
    kind = drawing.kind(own.feature)
    feature = Feature(own.feature, part_of(own.feature), kind.shape, kind.frame)
    reach = None if spec.zone.projected is None else spec.zone.projected.internal
    return Member(own.feature, feature, limited_along(spec, kind), reach)


def _free_turns(drawing: Drawing, part: str, datums: Sequence[DatumSpec]) -> Array:
    """The projection (3, 3) on directions about which datums let their frame turn: a lower segment shifts anyway."""
    if not datums:
        return np.eye(3)
    features = tuple(
        Feature(f"{part}.{own}", part, spec.shape, spec.frame) for own, spec in drawing.features[part].items()
    )
    nominal = Assembly((Part(part, np.eye(4), features, ()),), (), {}, 0)
    left = held_by_datums(nominal, frame_on(drawing, part, datums)).left.turns
    return np.asarray(left.T @ left)


def _basis(square: Array, first: Array) -> Array:
    """Orthonormal directions (3, n) that a symmetric form (3, 3) sees, by the axes of a frame (3, 3) if they can."""
    sizes, axes = np.linalg.eigh(square)
    kept = axes[:, sizes > SEEN * max(float(sizes[-1]), SEEN)]
    found = np.zeros((3, 0))
    for _ in range(kept.shape[1]):
        left = kept @ (kept.T @ first) - found @ (found.T @ first)
        lengths = np.linalg.norm(left, axis=0)
        best = int(np.argmax(lengths > lengths.max() - 1e-6))
        found = np.column_stack([found, left[:, best] / lengths[best]])
    return found
