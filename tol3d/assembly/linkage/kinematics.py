"""A loop without deviations: its closure as drawn, its freedoms, and its position in a pose."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tol3d.assembly.linkage.closing import loops_closed
from tol3d.assembly.linkage.frames import joint_frames, stacked
from tol3d.assembly.linkage.joint_equations import equations, forward, rows_of
from tol3d.assembly.linkage.joint_motions import BALL, ON_AXES_KINDS, ROLLING, SCREW, SWING
from tol3d.assembly.linkage.structure import FREEDOMS, ROOT, Structure
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing.poses import IDENTITY, Pose
from tol3d.errors import InputError
from tol3d.numerics.values import Valued

Array = NDArray[np.float64]

DEPENDENT: Final = 1e-7
"""Singular value of the equations, lengths as shares of the loop's, under which they ask twice for the same."""
CLOSED: Final = 1e-9
"""Largest gap of a loop as drawn, as a fraction of its length."""
STRIDE: Final = 0.1
"""Step of inputs and outputs [rad, or of the loop's length] on the way to a pose."""
LEAST: Final = 2.0**-20
"""Share of the way under which no step is tried."""
FLAT: Final = 1e-6
"""The same where a pose is singular, as in trials."""
ROUNDS: Final = 60
"""Largest number of iterations that close a loop as drawn."""


@dataclass(frozen=True, eq=False)
class Position(Valued):
    """Position of a loop without deviations.

    Args:
        coordinates: of its joints, see Structure; all that are given among them.
        turns: rotations of balls (frames, 3, 3).
        held: motions of the free coordinates that move nothing that counts, (motions, free), orthonormal.
        sign: of the determinant of the equations with the held motions.
        base, child: frames of joints (frames, 3, 4).
        singular: singular values of the equations, largest first, lengths as shares of the loop's.
        poses: of its bodies in the world (bodies, 4, 4).
    """

    coordinates: Array
    turns: Array
    held: Array
    sign: float
    base: Array
    child: Array
    singular: Array
    poses: Array

    @property
    def condition(self) -> float:
        """The largest by the least singular value of the equations."""
        return float(self.singular[0] / self.singular[-1]) if self.singular.size and self.singular[-1] > 0 else np.inf


class UnreachedError(Exception):
    """A pose that a loop does not reach.

    Args:
        share: of the way to it that it does.
        position: there.
    """

    def __init__(self, share: float, position: Position) -> None:
        super().__init__()
        self.share = share
        self.position = position


@dataclass(frozen=True, eq=False)
class Kinematics(Valued):
    """A loop whose other parts lie at some poses.

    Args:
        structure: the loop.
        placed: poses of the parts that are placed before, in the world (4, 4).
        plays: by joint, offset of the frame before by its play.
    """

    structure: Structure
    placed: Mapping[str, Array]
    plays: Mapping[str, Pose] = field(default_factory=dict)

    def frame(self, feature: str) -> Array:
        """Nominal: in the world where its part is placed, else in its body (4, 4)."""
        part = feature.partition(".")[0]
        own = self.structure.frames[feature]
        return own if part in self.structure.body_of else self.placed[part] @ own

    @cached_property
    def _frames(self) -> tuple[Array, Array]:
        base, child = joint_frames(self.structure, lambda name: Pose.of(self.frame(name)), self.plays)
        return stacked(base)[0], stacked(child)[0]

    def _with_output(self, target: Array | None) -> tuple[Array, Array]:
        base, child = self._frames
        if target is None or self.structure.output is None:
            return base, child
        base, child = base.copy(), child.copy()
        base[-1], child[-1] = target[:3], self.structure.frames[self.structure.output.of][:3]
        return base, child

    # what it lacks and what is free -----------------------------------------------------------------

    def _linear(self, coordinates: Array, turns: Array) -> tuple[Array, Array, Array, Array]:
        """Residuals of the equations (rows,), Jacobian (rows, free), twists (bodies, 6, free), poses of bodies."""
        own, free = self.structure, self.structure.free(inputs=False)
        count = int(free.max(initial=-1)) + 1
        base, child = self._frames
        poses, twists = np.zeros((len(own.bodies), 3, 4)), np.zeros((len(own.bodies), 6, count))
        model = (own.tree_array, own.shut_array(output=False), own.numbers, free, np.zeros((0, count)))
        state = (coordinates, turns, base, child, poses, twists)
        vectors = (np.empty(3), np.empty(3), np.empty(3))
        room: Any = tuple(np.empty((3, 4)) for _ in range(3))
        room = (*room, vectors, np.zeros((6, count)), np.empty(6), np.empty(6))
        forward(model, state, room)
        matrix, right = np.zeros((own.rows, count)), np.zeros(own.rows)
        equations(model, state, room, own.length, matrix, right)
        return right, matrix, twists, poses

    @cached_property
    def drawn(self) -> Position:
        """Close the loop as near as possible to the drawn parts.

        Raises:
            InputError: it does not close, asks twice for the same or leaves a part free; the text begins with the
                place in the scene.
        """
        own = self.structure
        free = own.free(inputs=False)
        scale = own.scale(free)
        coordinates, turns = np.zeros(own.width), own.drawn_turns()
        right, matrix, twists, poses = self._linear(coordinates, turns)
        first = right
        for _ in range(ROUNDS):
            if not right.size or np.abs(right).max() <= CLOSED * own.length:
                break
            step = np.linalg.lstsq(matrix * scale / own.length, -right / own.length, rcond=DEPENDENT)[0]
            step *= min(1.0, 0.2 / max(np.abs(step).max(), 1e-12))
            coordinates, turns = self._stepped(coordinates, turns, free, step * scale)
            right, matrix, twists, poses = self._linear(coordinates, turns)
        else:
            raise InputError(self._open(first, self._least_open(coordinates, turns, free, scale)))
        away = self._linear(*self._stepped(coordinates, turns, free, self._away(len(scale)) * scale))[1]
        self._refuse_unfit(matrix * scale / own.length, twists * scale, poses, away * scale / own.length)
        held, singular, sign = self._held(matrix * scale / own.length, None)
        base, child = self._frames
        found = self._solved(Position(coordinates, turns, held, sign, base, child, singular, np.empty(0)), {}, None)
        assert found is not None
        return found

    @staticmethod
    def _away(count: int) -> Array:
        """A step (count,) [rad, or of the loop's length] that no loop is made for."""
        return np.asarray(0.1 * np.sin(1.0 + np.sqrt(2.0) * np.arange(count)))

    def _stepped(self, coordinates: Array, turns: Array, free: NDArray[np.int64], step: Array) -> tuple[Array, Array]:
        coordinates, turns = coordinates.copy(), turns.copy()
        for place, column in enumerate(free):
            if column >= 0:
                coordinates[place] += step[column]
        for own in self.structure.tree:
            if own.joint.kind == BALL and free[own.first] >= 0:
                turns[own.frame] = rotation(step[free[own.first] : free[own.first] + 3]) @ turns[own.frame]
        return coordinates, turns

    def _least_open(self, coordinates: Array, turns: Array, free: NDArray[np.int64], scale: Array) -> Array:
        """Smallest residuals of the equations near some coordinates (rows,)."""

        def lacks(step: Array) -> Array:
            return self._linear(*self._stepped(coordinates, turns, free, step * scale))[0]

        found: Array = least_squares(lacks, np.zeros(len(scale))).fun
        return found

    def _open(self, first: Array, right: Array) -> str:
        """Joint that stays open, and its gap."""
        worst, size, start = "", -1.0, 0
        for own in self.structure.shut:
            rows = slice(start, start + rows_of(own.joint.kind))
            start = rows.stop
            gap = float(np.linalg.norm(right[rows]))
            if gap > size:
                worst, size, drawn = own.joint.name, gap, float(np.linalg.norm(first[rows]))
        words = f"expected parts that go together without deviations, got a gap of {size:.4g} mm"
        return (
            f"moves.{self.structure.name}.joints.{worst}: {words} at {worst!r} at the least, {drawn:.4g} mm as they "
            "are `placed`"
        )

    def _refuse_singular(self, elsewhere: Array, rows: int) -> None:
        """Refuse parts `placed` where equations (rows, free) depend on each other that do not elsewhere."""
        sizes = np.linalg.svd(elsewhere, compute_uv=False)
        if (sizes > FLAT * max(sizes.max(), 1.0)).sum() == rows:
            words = (
                "expected parts `placed` in a pose that is not singular, got one in which inputs do not move the loop"
            )
            raise InputError(f"moves.{self.structure.name}: {words}, or leave it free; place them in another one")

    def _refuse_unfit(self, matrix: Array, twists: Array, poses: Array, elsewhere: Array) -> None:
        """Refuse redundant equations, and freedoms that move features held by joints.

        Args:
            matrix: of the equations (rows, free).
            twists, poses: of bodies.
            elsewhere: the equations in a pose near by, in which nothing closes.
        """
        own = self.structure
        if matrix.size:
            left, sizes, _ = np.linalg.svd(matrix)
            rank = int((sizes > FLAT * max(sizes.max(), 1.0)).sum())
            if rank < len(matrix):
                self._refuse_singular(elsewhere, len(matrix))
                excess = len(matrix) - rank
                joints = self._in_loops(left[:, rank:])
                words = "expected joints that do not ask twice for the same, got"
                some = f"freedom{'s' if excess > 1 else ''} held twice in the loop of {', '.join(joints)}"
                advice = "give one of them more freedom, such as a ball, a cylindrical or a universal one"
                raise InputError(f"moves.{own.name}.joints: {words} {excess} {some}; {advice}")
        for motion in self._idle(matrix):
            moved = np.einsum("bij,j->bi", twists, motion)
            if self._moves_joints(moved, poses):
                raise InputError(
                    f"moves.{own.name}: expected joints and inputs that leave nothing free, got a freedom: "
                    f"{self._in_words(moved)}; give an input or another joint"
                )

    def _in_loops(self, left: Array) -> list[str]:
        """Joints of the loops whose equations depend on each other."""
        own, start, found = self.structure, 0, dict[str, None]()
        for step in own.shut:
            rows = slice(start, start + rows_of(step.joint.kind))
            start = rows.stop
            if np.abs(left[rows]).max() > 1e-6:
                for each in self._loop(step.on, step.body):
                    found[each] = None
                found[step.joint.name] = None
        return [name for name in (each.joint.name for each in own.steps) if name in found]

    def _loop(self, first: int, last: int) -> Iterator[str]:
        """Joints of the tree between two bodies."""
        by_body = {own.body: own for own in self.structure.tree}
        paths = []
        for body in (first, last):
            path = []
            while body != ROOT:
                path.append(by_body[body].joint.name)
                body = by_body[body].on
            paths.append(path)
        yield from (name for name in paths[0] if name not in paths[1])
        yield from (name for name in paths[1] if name not in paths[0])

    @staticmethod
    def _idle(matrix: Array) -> Array:
        """Motions of the free coordinates that the equations leave (motions, free), orthonormal."""
        if not matrix.size:
            return np.eye(matrix.shape[1])
        _, sizes, right = np.linalg.svd(matrix)
        rank = int((sizes > DEPENDENT * max(sizes.max(), 1.0)).sum())
        return np.asarray(right[rank:])

    def _moves_joints(self, moved: Array, poses: Array) -> bool:
        """True if motions of the bodies (bodies, 6) move features by which joints hold them, as displaced by play."""
        own, tiny = self.structure, 1e-6
        size = max(np.abs(moved[:, :3]).max() * own.length, np.abs(moved[:, 3:]).max(), 1e-300)
        for step in own.steps:
            play = np.vstack([stacked([self.plays.get(step.joint.name, IDENTITY)])[0, 0], np.eye(4)[3:]])
            for feature in step.joint.features:
                part = feature.partition(".")[0]
                if part not in own.body_of:
                    continue
                twist = moved[own.body_of[part]]
                frame = poses[own.body_of[part]] @ own.frames[feature]
                frame = frame @ play if feature == step.joint.on else frame
                shift, z = twist[3:] + np.cross(twist[:3], frame[:3, 3]), frame[:3, 2]
                if step.joint.kind in ON_AXES_KINDS:
                    shift = shift - z * (z @ shift)
                turned = np.zeros(3) if step.joint.kind == BALL else np.cross(twist[:3], z) * own.length
                if step.joint.kind in (SWING, ROLLING):
                    turned = twist[:3] * own.length
                if max(np.abs(shift).max(), np.abs(turned).max()) > tiny * size:
                    return True
        return False

    def _in_words(self, moved: Array) -> str:
        """The largest motion of a body."""
        own = self.structure
        sizes = [np.abs(each[:3]).max() * own.length + np.abs(each[3:]).max() for each in moved]
        body = int(np.argmax(sizes))
        return motion_in_words(own.bodies[body], moved[body], own.length)

    @cached_property
    def idle_freedoms(self) -> Sequence[tuple[str, Array]]:
        """Freedoms that move no joint: in words, and the motions of all bodies (bodies, 6)."""
        free = self.structure.free(inputs=False)
        _, matrix, twists, _ = self._linear(self.drawn.coordinates, self.drawn.turns)
        scale = self.structure.scale(free)
        motions = self._idle(matrix * scale / self.structure.length)
        alone = _each_by_itself([np.einsum("bij,j->bi", twists * scale, motion) for motion in motions])
        return [(self._in_words(moved), moved) for moved in alone]

    # where it stands --------------------------------------------------------------------------------

    @staticmethod
    def _held(matrix: Array, before: Array | None) -> tuple[Array, Array, float]:
        """Held motions near those held before, singular values and the determinant's sign."""
        count = matrix.shape[1]
        rows = matrix.shape[0]
        if rows:
            _, sizes, right = np.linalg.svd(matrix)
        else:
            sizes, right = np.ones(0), np.eye(count)
        held = right[rows:]
        if before is not None and len(held):
            u, _, v = np.linalg.svd(before @ held.T)
            held = u @ v @ held
        sign = float(np.linalg.slogdet(np.vstack([matrix, held]))[0]) if count else 1.0
        return np.ascontiguousarray(held), sizes, sign

    def _solved(self, start: Position, inputs: Mapping[str, float], target: Array | None) -> Position | None:
        """Close the loop from a position near by; None if that fails on the same branch."""
        own = self.structure
        solved = self._run(start, inputs, target)
        if solved is None:
            return None
        coordinates, turns, matrix, poses = solved
        if target is not None:  # its inputs are found; how it moves by them are the other columns
            narrow, wide = own.free(inputs=False), own.free(inputs=True)
            matrix = matrix[:, wide[narrow >= 0]]
        held, singular, sign = self._held(matrix[: own.rows], start.held)
        if sign != start.sign:
            return None
        base, child = self._with_output(target)
        coordinates = self._wound(coordinates, poses, base, child)
        return Position(coordinates, turns, held, sign, base, child, singular, poses)

    def _wound(self, coordinates: Array, poses: Array, base: Array, child: Array) -> Array:
        """Coordinates with the turns of screws that close loops, possibly several: the next ones count from there."""
        found = coordinates.copy()
        for own in self.structure.shut:
            if own.joint.kind == SCREW:
                turns = [np.eye(3) if body == ROOT else poses[body, :3, :3] for body in (own.on, own.body)]
                seen = (turns[0] @ base[own.frame, :, :3]).T @ turns[1] @ child[own.frame, :, :3]
                turn, before = float(np.arctan2(seen[1, 0], seen[0, 0])), coordinates[own.first]
                found[own.first] = turn + 2 * np.pi * np.round((before - turn) / (2 * np.pi))
        return found

    def _run(
        self, start: Position, inputs: Mapping[str, float], target: Array | None
    ) -> tuple[Array, Array, Array, Array] | None:
        """Coordinates, turns of balls, the equations' matrix (free, free) and poses of bodies; None if not found."""
        own, wide = self.structure, target is not None
        free, shut = own.free(inputs=wide), own.shut_array(output=wide)
        scale = own.scale(free)
        base, child = self._with_output(target)
        held, sign = start.held, start.sign
        if wide:
            held, sign = self._wide(start, free, scale), 0.0
        rows = sum(rows_of(kind) for kind in shut[:, 0].tolist())
        if rows + len(held) != len(scale):
            return None
        given = start.coordinates.copy()
        for name, value in inputs.items():
            place, sense = own.given[name]
            given[place] = sense * value
        poses, coordinates = np.empty((1, len(own.bodies), 3, 4)), np.empty((1, own.width))
        turned, codes = np.empty((1, own.slots, 3, 3)), np.empty(1, dtype=np.int8)
        found, matrix = np.empty((1, 3)), np.empty((len(scale), len(scale)))
        loops_closed(
            own.tree_array,
            shut,
            own.numbers,
            free,
            held,
            start.coordinates,
            start.turns,
            base[None],
            child[None],
            start.base,
            start.child,
            given[None],
            scale,
            np.array([own.length, sign]),
            poses,
            coordinates,
            turned,
            codes,
            found,
            matrix,
        )
        if codes[0] != OK:
            return None
        whole = np.tile(np.eye(4), (len(own.bodies), 1, 1))
        whole[:, :3] = poses[0]
        return coordinates[0], turned[0], matrix, whole

    def _wide(self, start: Position, free: NDArray[np.int64], scale: Array) -> Array:
        """Held motions with the inputs free too: the same motions, of the other coordinates alone."""
        narrow = self.structure.free(inputs=False)
        found = np.zeros((len(start.held), len(scale)))
        for place, column in enumerate(narrow):
            if column >= 0:
                found[:, free[place]] = start.held[:, column]
        return found

    def inputs_at(self, position: Position) -> Mapping[str, float]:
        """Values of the inputs [mm or rad]."""
        return {
            name: sense * float(position.coordinates[place]) for name, (place, sense) in self.structure.given.items()
        }

    def at_inputs(self, inputs: Mapping[str, float], start: Position | None = None) -> Position:
        """Position at some inputs, on the branch that is drawn.

        Raises:
            UnreachedError: the loop does not reach it.
        """
        start = start or self.drawn
        before = self.inputs_at(start)
        changes = {name: value - before[name] for name, value in inputs.items()}
        slides = {name: self._is_slide(name) for name in inputs}
        sizes = [abs(own) / (self.structure.length if slides[name] else 1.0) for name, own in changes.items()]
        return self._walked(
            start,
            max(sizes, default=0.0),
            lambda at, share: self._solved(
                at, {name: before[name] + share * own for name, own in changes.items()}, None
            ),
        )

    def _is_slide(self, name: str) -> bool:
        joint, k = self.structure.inputs[name]
        return FREEDOMS[self.structure.step[joint].joint.kind][k] == "slide"

    def at_output(self, along: Sequence[float] | Array, start: Position | None = None) -> Position:
        """Position at which its output tilts by a rotation vector (x, y) [rad] in the frame from which it is read.

        Raises:
            UnreachedError: the loop does not reach it.
        """
        start = start or self.drawn
        before = self.tilt_at(start)
        change = np.asarray(along, dtype=np.float64) - before
        return self._walked(
            start,
            float(np.linalg.norm(change)),
            lambda at, share: self._solved(at, {}, self._target(before + share * change)),
        )

    def at_place(self, pose: Array, start: Position | None = None) -> Position:
        """Position at which its output has a pose (4, 4) in the frame from which it is read, on the drawn branch.

        Raises:
            UnreachedError: the loop does not reach it.
        """
        output, start = self.structure.output, start or self.drawn
        assert output is not None
        there = self.frame(output.on)
        body = self.structure.body_of[output.of.partition(".")[0]]
        at = np.linalg.inv(there) @ start.poses[body] @ self.structure.frames[output.of]
        turn = Rotation.from_matrix(at[:3, :3].T @ pose[:3, :3]).as_rotvec()
        shift = pose[:3, 3] - at[:3, 3]

        def moved(place: Position, share: float) -> Position | None:
            own = at.copy()
            own[:3, :3] = at[:3, :3] @ rotation(share * turn)
            own[:3, 3] = at[:3, 3] + share * shift
            return self._solved(place, {}, there @ own)

        size = max(float(np.linalg.norm(turn)), float(np.linalg.norm(shift)) / self.structure.length)
        return self._walked(start, size, moved)

    def tilt_at(self, position: Position) -> Array:
        """Rotation vector (x, y) [rad] of the output's direction in the frame from which it is read."""
        output = self.structure.output
        assert output is not None
        body = self.structure.body_of[output.of.partition(".")[0]]
        axis = (position.poses[body] @ self.structure.frames[output.of])[:3, 2]
        x, y, z = self.frame(output.on)[:3, :3].T @ axis
        sine = float(np.hypot(x, y))
        share = np.arctan2(sine, z) / sine if sine > 1e-12 else 1.0
        return np.array([-share * y, share * x])

    def _target(self, tilt: Array) -> Array:
        """The frame whose z is the output's direction (4, 4)."""
        assert self.structure.output is not None
        found = self.frame(self.structure.output.on).copy()
        found[:3, :3] = found[:3, :3] @ rotation(np.array([tilt[0], tilt[1], 0.0]))
        return found

    def _walked(self, start: Position, size: float, there: Any) -> Position:
        """Step by step along a way of some size; `there` closes the loop at a share of it, from a position near by."""
        done, stride, at = 0.0, min(1.0, STRIDE / max(size, STRIDE)), start
        while done < 1.0:
            share = min(1.0, done + stride)
            found = there(at, share)
            if found is not None:
                done, at = share, found
            else:
                stride /= 2
                if stride < LEAST:
                    raise UnreachedError(done, at)
        return at


def motion_in_words(part: str, twist: Array, length: float) -> str:
    """A motion of a part (turn, shift at the world's origin) as people say it."""
    turn, shift = twist[:3], twist[3:]
    size = float(np.linalg.norm(turn))
    if size * length < 1e-6 * max(float(np.linalg.norm(shift)), 1e-300):
        return f"{part!r} slides along {_triple(shift / np.linalg.norm(shift))}"
    axis = turn / size
    point = np.cross(turn, shift) / (size * size)
    pitch = float(axis @ shift) / size
    slides = f", and slides along it by {abs(pitch):.3g} mm a radian" if abs(pitch) > 1e-6 * length else ""
    return f"{part!r} turns about {_triple(axis)} through {_triple(point)} mm{slides}"


def _triple(vector: Array) -> str:
    return f"[{', '.join(f'{own + 0.0:.4g}' for own in np.round(vector, 9))}]"


def _each_by_itself(moved: list[Array]) -> list[Array]:
    """The same motions (bodies, 6), of as few bodies each as may be."""
    if len(moved) < 2:
        return moved
    rows = np.array([own.ravel() for own in moved])
    count, bodies = len(rows), moved[0].shape[0]
    found: list[Array] = []
    for body in range(bodies):  # motions of this body alone: those in the span that move no other one
        others = np.delete(rows.reshape(count, bodies, 6), body, axis=1).reshape(count, -1)
        _, sizes, right = np.linalg.svd(others.T)
        sizes = np.concatenate([sizes, np.zeros(count - len(sizes))])
        for k in np.flatnonzero(sizes < 1e-7 * max(float(np.abs(rows).max()), 1e-300)):
            found.append((right[k] @ rows).reshape(bodies, 6))
    return found if len(found) == count else moved


def rotation(vector: Array) -> Array:
    """The rotation (3, 3) of a rotation vector."""
    return np.asarray(Rotation.from_rotvec(vector).as_matrix())
