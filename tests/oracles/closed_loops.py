"""Loops of rigid bodies closed by Gauss-Newton on the six freedoms of every body.

No tree of joints: each body has a rotation vector and a shift, each joint says what two frames keep, each input is one
more equation. Rates are differences. A motion that no joint notices stays where the least change of all leaves it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

STEP = 1e-6  # of differences [rad, or of 100 mm]; central ones are off by its square
MET = 1e-13  # last step [rad, or of 100 mm]; what it leaves is far less
LENGTH = 100.0  # mm; makes angles and lengths alike


def pose(turn: Sequence[float] | Array, at: Sequence[float] | Array) -> Array:
    """A pose (4, 4) of a rotation vector [rad] and a shift [mm]."""
    found = np.eye(4)
    found[:3, :3] = Rotation.from_rotvec(np.asarray(turn, dtype=float)).as_matrix()
    found[:3, 3] = at
    return found


def facing(z: Sequence[float] | Array, at: Sequence[float] | Array) -> Array:
    """A frame (4, 4) at a place whose z looks along a direction; x is near the world's x, or y."""
    axis = np.asarray(z, dtype=float) / np.linalg.norm(z)
    wish = np.eye(3)[0 if abs(axis[0]) < 0.9 else 1]
    x = wish - axis * (axis @ wish)
    x /= np.linalg.norm(x)
    found = np.eye(4)
    found[:3, :3] = np.stack([x, np.cross(axis, x), axis], axis=1)
    found[:3, 3] = at
    return found


def inverse(poses: Array) -> Array:
    """Inverse of poses (..., 4, 4)."""
    found = np.zeros_like(poses)
    turned = np.swapaxes(poses[..., :3, :3], -1, -2)
    found[..., :3, :3] = turned
    found[..., :3, 3] = -(turned @ poses[..., :3, 3:])[..., 0]
    found[..., 3, 3] = 1.0
    return found


@dataclass(frozen=True, eq=False)
class Pair:
    """Two frames that a joint keeps together.

    Args:
        kind: of the joint.
        on, of: the bodies, None for the world.
        base, own: the frames, on the bodies (4, 4).
        lead: of a screw [mm a turn].
        ratio: of spherical gears.
        carrier: of spherical gears, the body that carries the second.
    """

    kind: str
    on: str | None
    of: str | None
    base: Array
    own: Array
    lead: float = 0.0
    ratio: float = 0.0
    carrier: str | None = None


@dataclass(frozen=True, eq=False)
class Loops:
    """Bodies and what holds them.

    Args:
        bodies: poses as drawn (4, 4).
        pairs: by name.
        inputs: by name, the pair and which of its motions: turn, slide, first, second, x or y.
    """

    bodies: Mapping[str, Array]
    pairs: Mapping[str, Pair]
    inputs: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    def drawn(self, body: str | None) -> Array:
        """Drawn pose of a body, or of the world (4, 4)."""
        return np.eye(4) if body is None else self.bodies[body]

    @cached_property
    def rests(self) -> Mapping[str, Array]:
        """Drawn pose of the second frame in the first (4, 4), for all pairs."""
        return {
            name: inverse(self.drawn(own.on) @ own.base) @ self.drawn(own.of) @ own.own
            for name, own in self.pairs.items()
        }

    def rest(self, name: str) -> Array:
        """Drawn pose of the second frame in the first (4, 4), for one of them."""
        return self.rests[name]


Poses = Mapping[str, Array]
"""Poses of bodies (..., 4, 4)."""


def _rotvec(turn: Array) -> Array:
    return Rotation.from_matrix(turn.reshape(-1, 3, 3)).as_rotvec().reshape(*turn.shape[:-2], 3)


def _lacks(drawn: Loops, loops: Loops, name: str, poses: Poses) -> list[Array]:
    """Residuals of a pair, each [mm]."""
    own, rest = loops.pairs[name], drawn.rest(name)
    first = own.base if own.on is None else poses[own.on] @ own.base
    last = own.own if own.of is None else poses[own.of] @ own.own
    seen = inverse(first) @ last
    at, z = [seen[..., k, 3] for k in range(3)], [LENGTH * seen[..., k, 2] for k in range(3)]
    left = seen[..., :3, :3] @ rest[:3, :3].T
    match own.kind:
        case "ball":
            return at
        case "revolute":
            return [at[0], at[1], at[2] - rest[2, 3], z[0], z[1]]
        case "cylindrical":
            return [at[0], at[1], z[0], z[1]]
        case "prismatic":
            # what a flat joint's frames are turned against each other as drawn, but for a lean, stays
            spun = _rotvec(left)
            return [at[0], at[1], *(LENGTH * spun[..., k] for k in range(3))]
        case "universal":
            return [*at, z[2]]
        case "swing":
            return [*at, LENGTH * _rotvec(left)[..., 2]]
        case "screw":
            turn = _turn(drawn, loops, name, poses)
            return [at[0], at[1], z[0], z[1], at[2] - rest[2, 3] - own.lead * turn / (2 * np.pi)]
        case "rolling":
            return _rolls(drawn, loops, name, poses, first, last)
    raise ValueError(own.kind)


def _rolls(drawn: Loops, loops: Loops, name: str, poses: Poses, first: Array, last: Array) -> list[Array]:
    own = loops.pairs[name]
    carried = inverse(drawn.drawn(own.carrier))
    centre = (carried @ drawn.drawn(own.of) @ drawn.pairs[name].own)[:3, 3]
    rest = (carried @ drawn.drawn(own.on) @ drawn.pairs[name].base)[:3, 2]
    carrier = np.eye(4) if own.carrier is None else poses[own.carrier]
    axis = np.einsum("...kr,...k->...r", first[..., :3, :3], carrier[..., :3, :3] @ rest)
    across = np.cross([0.0, 0.0, 1.0], axis)
    sine = np.linalg.norm(across, axis=-1, keepdims=True)
    tilt = across * np.where(sine > 1e-9, np.arctan2(sine, axis[..., 2:]) / np.maximum(sine, 1e-9), 1.0)
    follows = Rotation.from_rotvec(own.ratio * tilt.reshape(-1, 3)).as_matrix().reshape(*tilt.shape[:-1], 3, 3)
    want = first[..., :3, :3] @ follows @ drawn.rest(name)[:3, :3]
    off = _rotvec(np.swapaxes(want, -1, -2) @ last[..., :3, :3])
    place = last[..., :3, 3] - (carrier[..., :3, :3] @ centre + carrier[..., :3, 3])
    return [*(place[..., k] for k in range(3)), *(LENGTH * off[..., k] for k in range(3))]


def _seen(loops: Loops, name: str, poses: Poses) -> Array:
    own = loops.pairs[name]
    first = own.base if own.on is None else poses[own.on] @ own.base
    last = own.own if own.of is None else poses[own.of] @ own.own
    return np.asarray(inverse(first) @ last)


def _turn(drawn: Loops, loops: Loops, name: str, poses: Poses) -> Array:
    left = _seen(loops, name, poses)[..., :3, :3] @ drawn.rest(name)[:3, :3].T
    return np.arctan2(left[..., 1, 0] - left[..., 0, 1], left[..., 0, 0] + left[..., 1, 1])


def value(drawn: Loops, loops: Loops, name: str, poses: Poses) -> Array:
    """Travel of an input since all was drawn (...,) [mm or rad within half a turn]."""
    pair, motion = loops.inputs[name]
    seen, rest = _seen(loops, pair, poses), drawn.rest(pair)
    match motion:
        case "turn":
            return _turn(drawn, loops, pair, poses)
        case "slide":
            return np.asarray(seen[..., 2, 3] - rest[2, 3])
        case "first":
            now, was = np.arctan2(seen[..., 1, 2], seen[..., 0, 2]), np.arctan2(rest[1, 2], rest[0, 2])
        case "second":
            now, was = -np.arctan2(seen[..., 2, 1], seen[..., 2, 0]), -np.arctan2(rest[2, 1], rest[2, 0])
        case _:
            return _rotvec(seen[..., :3, :3] @ rest[:3, :3].T)[..., ("x", "y").index(motion)]
    return np.asarray((now - was + np.pi) % (2 * np.pi) - np.pi)


def _equations(drawn: Loops, loops: Loops, poses: Poses, wanted: Mapping[str, float]) -> Array:
    """All that is lacking (..., equations) [mm]."""
    found = [row for name in loops.pairs for row in _lacks(drawn, loops, name, poses)]
    for name, target in wanted.items():
        off = value(drawn, loops, name, poses) - target
        if loops.inputs[name][1] != "slide":
            off = LENGTH * ((off + np.pi) % (2 * np.pi) - np.pi)
        found.append(off)
    return np.stack(np.broadcast_arrays(*found), axis=-1)


def _moved(poses: Poses, change: Array) -> Poses:
    """Bodies turned about their own origins and shifted (..., 6 bodies)."""
    found = {}
    for k, (name, own) in enumerate(poses.items()):
        turn = Rotation.from_rotvec(change[..., 6 * k : 6 * k + 3].reshape(-1, 3)).as_matrix()
        now = np.broadcast_to(own, (*change.shape[:-1], 4, 4)).copy()
        now[..., :3, :3] = turn.reshape(*change.shape[:-1], 3, 3) @ own[:3, :3]
        now[..., :3, 3] += LENGTH * change[..., 6 * k + 3 : 6 * k + 6]
        found[name] = now
    return found


def closed(drawn: Loops, loops: Loops, start: Poses, wanted: Mapping[str, float]) -> Poses | None:
    """Bodies near a start where all pairs hold and inputs have gone so far; None if there is no such pose.

    Args:
        drawn: without deviations, where inputs are 0.
        loops: with deviations.
        start: where to begin.
        wanted: of each input how far it has gone.
    """
    count, poses = 6 * len(start), start
    ends = np.asarray(STEP * np.concatenate([np.eye(count), -np.eye(count)]), dtype=np.float64)
    for _ in range(60):
        lacks = _equations(drawn, loops, poses, wanted)
        each = _equations(drawn, loops, _moved(poses, ends), wanted)
        rates = (each[:count] - each[count:]).T / (2 * STEP)
        found = np.linalg.lstsq(rates, -lacks, rcond=1e-8)[0]
        step = np.asarray(found * min(1.0, 0.3 / max(float(np.abs(found).max()), 1e-300)), dtype=np.float64)
        poses = _moved(poses, step)
        if np.abs(step).max() < MET:
            return poses if np.abs(_equations(drawn, loops, poses, wanted)).max() < 1e-9 else None
    # rounding may keep steps above the limit; what is lacking decides
    return poses if np.abs(_equations(drawn, loops, poses, wanted)).max() < 1e-10 else None


def followed(drawn: Loops, loops: Loops, wanted: Mapping[str, float], steps: int = 4) -> Poses | None:
    """Bodies where inputs have gone so far, step by step from where they are drawn."""
    poses: Poses | None = drawn.bodies
    for share in np.linspace(0.0, 1.0, steps + 1)[1:]:
        if poses is None:
            return None
        poses = closed(drawn, loops, poses, {name: share * target for name, target in wanted.items()})
    return poses


def displaced(loops: Loops, frames: Mapping[str, tuple[Array | None, Array | None]]) -> Loops:
    """The same loops with other frames of some pairs."""
    pairs = dict(loops.pairs)
    for name, (base, own) in frames.items():
        pair = pairs[name]
        pairs[name] = replace(pair, base=pair.base if base is None else base, own=pair.own if own is None else own)
    return replace(loops, pairs=pairs)


def conditioned(loops: Loops, poses: Poses) -> float:
    """The condition number of all equations; infinite where something is free."""
    count = 6 * len(loops.bodies)
    ends = np.asarray(STEP * np.concatenate([np.eye(count), -np.eye(count)]), dtype=np.float64)
    each = _equations(loops, loops, _moved(poses, ends), dict.fromkeys(loops.inputs, 0.0))
    sizes = np.linalg.svd((each[:count] - each[count:]) / (2 * STEP), compute_uv=False)
    return float(sizes[0] / max(sizes[-1], 1e-300))
