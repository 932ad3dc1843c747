"""Motions that contacts leave free, in words."""

import numpy as np

from tol3d.numerics.arrays import Array

FREE = 1e-9
"""Largest change of a contact, as a share of how far a motion moves what the contacts are about, that is none."""


def free_motions(rows: Array, middle: Array, reach: float) -> Array:
    """Motions (motions, 6) that change none of some contacts; shift of the world's origin [mm], then turn [rad].

    Args:
        rows: of each contact how it changes with the shift at a middle and the turn (contacts, 6).
        middle: of what the contacts are about (3,), in the world [mm].
        reach: of that about it [mm].
    """
    scale = np.array([1.0, 1.0, 1.0, 1 / reach, 1 / reach, 1 / reach])
    _, sizes, right = np.linalg.svd(rows * scale)
    sizes = np.concatenate([sizes, np.zeros(6 - len(sizes))])
    motions = right[sizes <= FREE * max(float(sizes[0]), 1.0)] * scale
    motions[:, :3] -= np.cross(motions[:, 3:], middle)
    return np.asarray(motions)


def seen_steps(free: Array, reach: float) -> Array:
    """Steps (6, steps), turn times reach and shift, without free motions: least turn, then least shift of the origin.

    Args:
        free: motions (motions, 6) that nothing sees, shift of the origin [mm] and turn [rad].
        reach: [mm].
    """
    turns, sizes, _ = np.linalg.svd(free[:, 3:] * reach, full_matrices=True)
    rank = int(np.sum(sizes > 1e-9))
    not_asked = [np.concatenate([row[3:] * reach, np.zeros(3)]) for row in turns.T[:rank] @ free]
    not_asked += [np.concatenate([np.zeros(3), row[:3]]) for row in turns.T[rank:] @ free]
    _, _, right = np.linalg.svd(np.array([*not_asked, np.zeros(6)]))
    return np.ascontiguousarray(right[len(not_asked) :].T)


def in_words(motions: Array) -> str:
    """The simplest of some motions, such as "it shifts along x" or "it turns about z through (0, 40, 0)"."""
    length = max(float(np.abs(motions).max()), 1.0)
    left, sizes, _ = np.linalg.svd(motions[:, 3:] * length)
    if len(motions) > np.sum(sizes > FREE * length):
        shift = left[:, -1] @ motions[:, :3]
        return f"it shifts along {direction_in_words(shift)}"
    shift, turn = np.split(motions[0] / np.linalg.norm(motions[0, 3:]), 2)
    words = f"it turns about {direction_in_words(turn)} through {_numbers(np.cross(turn, shift))}"
    return words if abs(turn @ shift) < FREE * length else f"{words} and shifts along it"


def direction_in_words(vector: Array) -> str:
    """x, y, z, or three numbers."""
    vector = vector / np.linalg.norm(vector)
    largest = int(np.argmax(np.abs(vector)))
    if abs(vector[largest]) > 1.0 - FREE:
        return "xyz"[largest]
    return _numbers(vector * np.sign(vector[largest]))


def _numbers(vector: Array) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in vector.round(6) + 0.0) + ")"
