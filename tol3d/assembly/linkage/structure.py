"""A loop as its joints make it: a tree of joints that place its bodies, and those that shut loops, as arrays.

A joint lies between two frames: z and origin of a feature of the part before, and of one of the part after. As its
parts are drawn all its coordinates are 0; the frame after is the one before, moved by the coordinates.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.linkage.joint_equations import rows_of
from tol3d.assembly.linkage.joint_motions import (
    ALONG,
    BALL,
    CYLINDRICAL,
    FIXED,
    ON_AXES_KINDS,
    PRISMATIC,
    REVOLUTE,
    ROLLING,
    SCREW,
    SWING,
    UNIVERSAL,
)
from tol3d.errors import InputError
from tol3d.numerics.kept import kept
from tol3d.numerics.values import Valued

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

KINDS: Final[Mapping[str, int]] = {
    "ball": BALL,
    "revolute": REVOLUTE,
    "prismatic": PRISMATIC,
    "cylindrical": CYLINDRICAL,
    "universal": UNIVERSAL,
    "swing": SWING,
    "screw": SCREW,
    "rolling": ROLLING,
}
FREEDOMS: Final[Mapping[int, tuple[str, ...]]] = {
    BALL: ("x", "y", "z"),
    REVOLUTE: ("turn",),
    PRISMATIC: ("slide",),
    CYLINDRICAL: ("turn", "slide"),
    UNIVERSAL: ("first", "second"),
    SWING: ("x", "y"),
    SCREW: ("turn",),
    ROLLING: (),
}
"""Coordinates of a joint, by words; slides are mm, all others rad."""

SQUARE: Final = 1e-6
"""Cosine between the axes of a universal joint, no more."""
ROOT: Final = -1
"""The body of all parts that are placed before."""


@dataclass(frozen=True, eq=False)
class Joint:
    """Two features that a joint keeps together.

    Args:
        name: the scene's.
        kind: of KINDS.
        on, of: the features, of the part before and of the part after.
        lead: travel of a screw per radian [mm].
        ratio: of rolling, the tilt of the gear by that of its carrier.
        carrier: of rolling, the part on which the gear after sits, or a feature of it.
    """

    name: str
    kind: int
    on: str
    of: str
    lead: float = 0.0
    ratio: float = 0.0
    carrier: str = ""

    @property
    def features(self) -> tuple[str, ...]:
        """All that it names."""
        return (self.on, self.of, self.carrier) if "." in self.carrier else (self.on, self.of)


@dataclass(frozen=True, eq=False)
class Step:
    """A joint of the tree, or one that shuts a loop.

    Args:
        joint: which.
        on, body: the bodies before and after, ROOT for placed parts.
        reverse: whether the tree goes against the joint, from its part after to its part before.
        first: of its coordinates.
        frame: of its frames.
        carrier: the body that carries a rolling gear.
    """

    joint: Joint
    on: int
    body: int
    reverse: bool
    first: int
    frame: int
    carrier: int = ROOT

    @property
    def sense(self) -> float:
        """1, or -1 where its coordinates in the tree are those of the joint with another sign."""
        return -1.0 if self.reverse else 1.0


@dataclass(frozen=True, eq=False)
class Output:
    """Output that a pose may name instead of inputs.

    Args:
        of: a feature of a body of the loop.
        on: one of a part that is placed.
        whole: True if its place and its turn are named, False for the direction of its z.
    """

    of: str
    on: str
    whole: bool


@dataclass(frozen=True, eq=False)
class Structure(Valued):
    """A loop.

    Args:
        name: of the move.
        bodies: its parts, each placed by the tree after those that carry it.
        tree, shut: its joints.
        inputs: by name, the joint and which of its coordinates is given.
        output: that poses name instead; None for none.
        drawn: poses of all parts as they are drawn, in the world (4, 4).
        frames: of all features, in their parts (4, 4).
        length: that turns angles into lengths [mm].
    """

    name: str
    bodies: tuple[str, ...]
    tree: tuple[Step, ...]
    shut: tuple[Step, ...]
    inputs: Mapping[str, tuple[str, int]]
    output: Output | None
    drawn: Mapping[str, Array]
    frames: Mapping[str, Array]
    length: float
    body_of: Mapping[str, int] = field(default_factory=dict)

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """Steps of the tree, then the others."""
        return self.tree + self.shut

    @cached_property
    def step(self) -> Mapping[str, Step]:
        """Steps by the joint's name."""
        return {step.joint.name: step for step in self.steps}

    @cached_property
    def joined(self) -> frozenset[str]:
        """Features of bodies and of placed parts that its joints join."""
        found = {name for step in self.steps for name in (step.joint.on, step.joint.of, step.joint.carrier)}
        return frozenset(name for name in found if "." in name)

    @cached_property
    def slots(self) -> int:
        """Number of frames; the last one is the output's."""
        return sum(2 if step.joint.kind == ROLLING else 1 for step in self.steps) + 1

    @cached_property
    def width(self) -> int:
        """Number of coordinates."""
        return sum(max(len(FREEDOMS[step.joint.kind]), 1) for step in self.steps)

    @cached_property
    def rows(self) -> int:
        """Number of equations of the joints that close loops."""
        return sum(rows_of(own.joint.kind) for own in self.shut)

    @cached_property
    def given(self) -> Mapping[str, tuple[int, float]]:
        """Coordinate of each input, and its sense."""
        found = {}
        for name, (joint, k) in self.inputs.items():
            own = self.step[joint]
            place = 1 - k if own.reverse and own.joint.kind == UNIVERSAL else k
            found[name] = own.first + place, own.sense
        return found

    def free(self, *, inputs: bool) -> Integers:
        """The column of each coordinate; -1 of those that are given.

        Args:
            inputs: whether the inputs are free too.
        """
        found, count = np.full(self.width, -1, dtype=np.int64), 0
        fixed = set() if inputs else {place for place, _ in self.given.values()}
        for own in self.tree:
            for k in range(len(FREEDOMS[own.joint.kind])):
                if own.first + k not in fixed:
                    found[own.first + k], count = count, count + 1
        return found

    def scale(self, free: Integers) -> Array:
        """Factors that make one of a free coordinate a fraction of the loop's length (free,)."""
        found = np.ones(int(free.max(initial=-1)) + 1)
        for own in self.tree:
            for k, word in enumerate(FREEDOMS[own.joint.kind]):
                if word == "slide" and free[own.first + k] >= 0:
                    found[free[own.first + k]] = self.length
        return found

    @cached_property
    def tree_array(self) -> Integers:
        """See `loops_closed`."""
        own = [(s.joint.kind, s.on, s.body, s.first, s.frame, s.carrier) for s in self.tree]
        return np.array(own, dtype=np.int64).reshape(-1, 6)

    def shut_array(self, *, output: bool) -> Integers:
        """See `loops_closed`; with the output as one more joint, if that is asked."""
        own = [(s.joint.kind, s.on, s.body, s.first, s.frame) for s in self.shut]
        if output and self.output is not None:
            kind = FIXED if self.output.whole else ALONG
            own.append((kind, ROOT, self.body_of[self.output.of.partition(".")[0]], 0, self.slots - 1))
        return np.array(own, dtype=np.int64).reshape(-1, 5)

    @cached_property
    def numbers(self) -> Array:
        """See `loops_closed`."""
        found = np.zeros((self.slots, 10))
        for step in self.steps:
            found[step.frame, 0] = step.joint.ratio if step.joint.kind == ROLLING else step.joint.lead
            if step.joint.kind == UNIVERSAL:
                between = self.apart(step.joint)[:3, :3]
                found[step.frame, 1:] = (between.T if step.reverse else between).ravel()
        return found

    def world(self, feature: str) -> Array:
        """A feature's frame as its part is drawn (4, 4)."""
        return self.drawn[feature.partition(".")[0]] @ self.frames[feature]

    def apart(self, joint: Joint) -> Array:
        """The frame after in that before, as parts are drawn (4, 4)."""
        return np.asarray(np.linalg.inv(self.world(joint.on)) @ self.world(joint.of))

    @kept
    def rest(self, joint: Joint) -> Array:
        """Transform left of a joint that holds, with all coordinates 0 (4, 4)."""
        apart, found = self.apart(joint), np.eye(4)
        if joint.kind in ON_AXES_KINDS:
            flip = np.diag([1.0, np.sign(apart[2, 2]) or 1.0, np.sign(apart[2, 2]) or 1.0])
            seen = apart[:3, :3] @ flip
            spin = np.arctan2(seen[1, 0], seen[0, 0])
            turned = np.array([[np.cos(spin), -np.sin(spin), 0.0], [np.sin(spin), np.cos(spin), 0.0], [0.0, 0.0, 1.0]])
            found[:3, :3], found[2, 3] = turned @ flip, apart[2, 3]
        elif joint.kind in (SWING, ROLLING):
            found[:3, :3] = apart[:3, :3]
        return found

    def carried(self, joint: Joint) -> Array:
        """The frame that carries a rolling gear, as drawn in the world (4, 4): at its centre, as the fixed one's."""
        found = self.world(joint.on).copy()
        found[:3, 3] = self.world(joint.of)[:3, 3]
        return found

    def drawn_turns(self) -> Array:
        """Rotations of balls as parts are drawn (frames, 3, 3)."""
        found = np.tile(np.eye(3), (self.slots, 1, 1))
        for own in self.tree:
            if own.joint.kind == BALL:
                between = self.apart(own.joint)[:3, :3]
                found[own.frame] = between.T if own.reverse else between
        return found


def structured(
    name: str,
    bodies: Sequence[str],
    joints: Sequence[Joint],
    inputs: Mapping[str, tuple[str, int]],
    output: Output | None,
    drawn: Mapping[str, Array],
    frames: Mapping[str, Array],
    length: float | None,
) -> Structure:
    """A loop from its joints.

    Args:
        name: of the move.
        bodies: its parts.
        joints: all, in the scene's order.
        inputs, output, drawn, frames: see Structure.
        length: see Structure; default: the largest distance of a joint from the middle of all.

    Raises:
        InputError: bodies that no joint reaches, or a gear that another joint than its rolling one would place; the
            text begins with the place in the scene.
    """
    tree: list[tuple[Joint, bool]] = []
    reached, left = dict[str, int](), list(joints)
    given = {(joint, k) for joint, k in inputs.values()}
    rolled = {joint.of.partition(".")[0] for joint in joints if joint.kind == ROLLING}

    def is_reached(part: str) -> bool:
        return part not in bodies or part in reached

    while len(reached) < len(bodies):
        best: tuple[bool, int, int, Joint, bool] | None = None
        for place, own in enumerate(left):
            before, after = own.on.partition(".")[0], own.of.partition(".")[0]
            if is_reached(before) == is_reached(after):
                continue
            if own.kind == ROLLING and not (is_reached(before) and is_reached(own.carrier.partition(".")[0])):
                continue
            ahead = after if is_reached(before) else before
            if own.kind != ROLLING and ahead in rolled:
                continue
            freedoms = [(own.name, k) in given for k in range(len(FREEDOMS[own.kind]))]
            # a freedom that is given is one of the tree's: a joint that shuts a loop has none
            key = not any(freedoms), freedoms.count(False), place
            if best is None or key < best[:3]:
                best = (*key, own, is_reached(after))
        if best is None:
            lost = next(body for body in bodies if body not in reached)
            words = f"expected a joint that holds {lost!r}, got none that leads to it from a part that is placed"
            raise InputError(f"moves.{name}: {words}")
        own, reverse = best[3], best[4]
        left.remove(own)
        reached[(own.on if reverse else own.of).partition(".")[0]] = len(reached)
        tree.append((own, reverse))
    for own in left:
        if any(own.name == joint for joint, _ in given):
            words = "expected a loop with a joint without an input, got an input of each of its joints"
            raise InputError(f"moves.{name}.joints.{own.name}: {words}")
        if own.kind == ROLLING:
            words = f"expected no other joint that leads to {own.of.partition('.')[0]!r} than this one"
            raise InputError(f"moves.{name}.joints.{own.name}: {words}, got one; let its driven parts follow it")

    def body(feature: str) -> int:
        return reached.get(feature.partition(".")[0], ROOT)

    steps, first, frame = list[Step](), 0, 0
    for own, reverse in [*tree, *((each, False) for each in left)]:
        ends = (body(own.of), body(own.on)) if reverse else (body(own.on), body(own.of))
        steps.append(Step(own, *ends, reverse, first, frame, body(own.carrier) if own.kind == ROLLING else ROOT))
        first += max(len(FREEDOMS[own.kind]), 1)
        frame += 2 if own.kind == ROLLING else 1
    made = Structure(
        name,
        tuple(reached),
        tuple(steps[: len(tree)]),
        tuple(steps[len(tree) :]),
        inputs,
        output,
        drawn,
        frames,
        1.0,
        reached,
    )
    for own in joints:
        if own.kind == UNIVERSAL and abs(made.apart(own)[2, 2]) > SQUARE:
            lean = float(np.degrees(np.arccos(np.clip(made.apart(own)[2, 2], -1.0, 1.0))))
            words = f"expected axes at right angles where both parts are `placed`, got {lean:.4g} deg"
            raise InputError(f"moves.{name}.joints.{own.name}: {words}")
    places = np.array([made.world(feature)[:3, 3] for joint in joints for feature in (joint.on, joint.of)])
    spread = float(np.linalg.norm(places - places.mean(axis=0), axis=1).max())
    return replace(made, length=length or spread or 1.0)
