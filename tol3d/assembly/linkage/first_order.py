"""Loops to first order: the linear equations of their joints, at the nominal pose, solved for all bodies at once.

Each body is displaced by a torsor. A joint keeps some of the displacements of its one feature relative to the other, at
where they meet nominally; all joints and inputs together leave the bodies no choice. Nothing here knows a tree of
joints, coordinates or Newton.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.linkage.joint_motions import (
    BALL,
    CYLINDRICAL,
    PRISMATIC,
    REVOLUTE,
    ROLLING,
    SCREW,
    SWING,
    UNIVERSAL,
)
from tol3d.assembly.linkage.structure import FREEDOMS, Joint, Structure
from tol3d.assembly.torsors.torsor import perpendicular, shift_at, torsor_of, turn_about
from tol3d.assembly.torsors.world import World

Array = NDArray[np.float64]

LOST: Final = 1e-9
"""Singular value of the equations, lengths as shares of the loop's, under which they leave a motion free."""
NO_TILT: Final = 1e-9
"""Sine of a tilt that has no azimuth."""


@dataclass(frozen=True, eq=False)
class Displaced:
    """A loop's bodies to first order.

    Args:
        structure: the loop.
        plays: by joint, the torsor (6, columns) by which its play displaces the frame before, in that frame.
        inputs: by name, deviation of an input (columns,) [mm or rad].
    """

    structure: Structure
    plays: Mapping[str, Array]
    inputs: Mapping[str, Array]

    def torsors(self, world: World) -> Array:
        """Torsors of the bodies (bodies, 6, columns), in the world."""
        own, length = self.structure, self.structure.length
        count = len(own.bodies)
        rows, right = list[Array](), list[Array]()
        for step in own.steps:
            for matrix, amount in self._equations(step.joint, world):
                sizes = np.where(np.abs(matrix[:, :, :3]).max(axis=(1, 2)) > 0.0, 1.0, length)
                rows.append((matrix * sizes[:, None, None]).reshape(len(matrix), -1))
                right.append(amount * sizes[:, None])
        scale = np.tile([1.0, 1.0, 1.0, 1 / length, 1 / length, 1 / length], count)
        centre = np.mean([world.origin(step.joint.on) for step in own.steps], axis=0)
        moved = np.vstack(rows).reshape(-1, count, 6) @ _about(centre)
        found = np.linalg.lstsq(moved.reshape(len(moved), -1) * scale, np.vstack(right), rcond=LOST)[0]
        shaped = (found * scale[:, None]).reshape(count, 6, -1)
        return np.asarray(np.einsum("ij,bjc->bic", _about(centre), shaped))

    def _equations(self, joint: Joint, world: World) -> Sequence[tuple[Array, Array]]:
        """Rows (rows, bodies, 6) on the torsors of the bodies, and their values (rows, columns)."""
        kept = _rolling(joint, world, self.structure) if joint.kind == ROLLING else [(None, _kept(joint, world, self))]
        given = [
            (own, self.inputs[name])
            for name, (of, k) in self.structure.inputs.items()
            if of == joint.name
            for own in [_coordinate(joint, FREEDOMS[joint.kind][k], world, self.structure)]
        ]
        found = []
        for weights, rows in kept:
            found.append(self._row(joint, world, rows, weights))
        for rows, amount in given:
            matrix, right = self._row(joint, world, rows, None)
            found.append((matrix, right + amount))
        return found

    def _row(self, joint: Joint, world: World, rows: Array, weights: Mapping[str, Array] | None) -> tuple[Array, Array]:
        """Rows of the displacement of the feature after, relative to that before, in terms of bodies."""
        own = self.structure
        by_feature = weights or {joint.of: np.eye(6), joint.on: -np.eye(6)}
        matrix = np.zeros((len(rows), len(own.bodies), 6))
        right = np.zeros((len(rows), world.columns.count))
        for feature, weight in by_feature.items():
            part = feature.partition(".")[0]
            seen = rows @ weight
            if part in own.body_of:
                matrix[:, own.body_of[part]] += seen
                known = world.on_body(feature, part) if "." in feature else None
            else:
                known = world.placed(feature) if "." in feature else world.parts[part]
            if known is not None:
                right -= seen @ known
        if joint.name in self.plays:
            right += rows @ _into_world(world.frame(joint.on)) @ self.plays[joint.name]
        return matrix, right


def _about(centre: Array) -> Array:
    """(6, 6): torsors seen at a point -> the same at the world's origin."""
    found = np.eye(6)
    x, y, z = centre
    found[:3, 3:] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
    return found


def _into_world(frame: Array) -> Array:
    """(6, 6): torsors in a frame (4, 4) -> in the world."""
    found = np.zeros((6, 6))
    found[:3, :3] = found[3:, 3:] = frame[:3, :3]
    return np.asarray(_about(frame[:3, 3]) @ found)


def _kept(joint: Joint, world: World, displaced: Displaced) -> Array:
    """Rows (rows, 6) of relative displacements that a joint keeps at 0."""
    point, z = world.origin(joint.of), world.axis(joint.on)
    shift, across = shift_at(point), perpendicular(z)
    match joint.kind:
        case k if k == BALL:
            return shift
        case k if k == REVOLUTE:
            return np.vstack([shift, turn_about(across)])
        case k if k == CYLINDRICAL:
            return np.vstack([across @ shift, turn_about(across)])
        case k if k == PRISMATIC:
            return np.vstack([across @ shift, turn_about(np.eye(3))])
        case k if k == SCREW:
            climbs = z @ shift - joint.lead * turn_about(z[None])[0]
            return np.vstack([across @ shift, turn_about(across), climbs[None]])
        case k if k == UNIVERSAL:
            other = world.axis(joint.of)
            return np.vstack([shift, turn_about(np.cross(other, z)[None])])
        case k if k == SWING:
            # no spin: the antisymmetric part of the rotation has no component along the rest axis
            frame = world.frame(joint.on)[:3, :3]
            r = frame.T @ world.frame(joint.of)[:3, :3] @ displaced.structure.rest(joint)[:3, :3].T
            spin = np.array([-r[2, 0], -r[2, 1], r[0, 0] + r[1, 1]])
            return np.vstack([shift, turn_about((frame @ spin)[None])])
        case _:
            raise NotImplementedError(joint.kind)


def _coordinate(joint: Joint, word: str, world: World, structure: Structure) -> Array:
    """A row (1, 6) of relative displacements that gives the travel of a joint's coordinate."""
    z = world.axis(joint.on)
    match word:
        case "slide":
            return z[None] @ shift_at(world.origin(joint.of))
        case "turn":
            return turn_about(z[None])
        case "first" | "second":
            axes = np.stack([z, world.axis(joint.of)])
            across = np.cross(axes[0], axes[1])
            dual = np.linalg.inv(np.stack([*axes, across]).T)
            return turn_about(dual[("first", "second").index(word)][None])
        case "x" | "y":
            frame = world.frame(joint.on)[:3, :3]
            axis = world.frame(joint.of)[:3, :3] @ structure.rest(joint)[:3, :3].T[:, 2]
            theta, sine, e, towards = _tilt(z, axis)
            own = frame[:, ("x", "y").index(word)]
            share = theta / sine if sine > NO_TILT else 1.0
            return turn_about(((own @ e) * e - share * (own @ towards) * np.cross(axis, e))[None])
        case _:
            raise NotImplementedError(word)


def _tilt(rest: Array, axis: Array) -> tuple[float, float, Array, Array]:
    """Tilt of an axis from rest: the angle, its sine, and the directions (3,) about and towards which it tilts."""
    across = np.cross(rest, axis)
    sine = float(np.linalg.norm(across))
    about = across / sine if sine > NO_TILT else perpendicular(rest)[0]
    return float(np.arctan2(sine, rest @ axis)), sine, about, np.cross(about, rest)


def _rolling(joint: Joint, world: World, structure: Structure) -> list[tuple[Mapping[str, Array], Array]]:
    """Constraints of a rolling gear: its centre follows the carrier; it tilts `ratio` times as far, without spin."""
    carrier, frame = joint.carrier, world.frame(joint.on)
    part = carrier.partition(".")[0]
    rest = frame[:3, 2]
    drawn = structure.drawn[part][:3, :3].T @ structure.carried(joint)[:3, 2]
    axis = world.assembly.part[part].pose[:3, :3] @ drawn
    theta, sine, e, towards = _tilt(rest, axis)
    swings = np.cross(axis, e)  # times a turn: the rate of the azimuth, times the sine of the tilt
    k = joint.ratio
    by_azimuth = (
        np.array([k, 0.0]) if sine <= NO_TILT else np.array([np.sin(k * theta), 1.0 - np.cos(k * theta)]) / sine
    )
    follows = k * np.outer(e, e) + np.outer(-by_azimuth[0] * towards + by_azimuth[1] * rest, swings)
    turn = np.zeros((6, 6))
    turn[3:, 3:] = follows
    alone = np.zeros((6, 6))
    alone[3:, 3:] = np.eye(3)
    centre = shift_at(world.origin(joint.of))
    return [
        ({joint.of: np.eye(6), carrier: -np.eye(6)}, centre),
        ({joint.of: alone, joint.on: turn - alone, carrier: -turn}, turn_about(np.eye(3))),
    ]


def play_torsors(shifts: Array, turns: Array) -> Array:
    """The torsor (6, columns) of a play that shifts a frame (3, columns) and turns it (3, columns), in that frame."""
    return torsor_of(np.zeros(3), shifts, turns)
