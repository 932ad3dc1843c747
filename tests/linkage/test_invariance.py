"""Measures of loops do not depend on where all stands, on coordinates of parts, or on the order of what is said."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkage.linked_bodies import (
    Feature,
    Linkage,
    Part,
    drawn_elsewhere,
    moved_rigidly,
    random_deviations,
    random_pose,
    study_of,
)
from linkage.mechanisms import ALL
from linkage.plays import with_plays
from linkage.random_loops import open_chain, random_loop

from tol3d.study.system.stated import component_slices

LIMIT = 1e-9  # mm
MAKERS: dict[str, Callable[[], Linkage]] = {
    **{name: ALL[name] for name in ("slider crank", "swash on swing", "planet")},
    "open chain": open_chain,
    "random": lambda: random_loop(11, two=True),
}


def reversed_joints(linkage: Linkage) -> Linkage:
    """Joints from their other ends; inputs have the other sign, and those of universal joints change places.

    A swing joint does not spin about z of its first feature, and a gear rolls on the first: those stay as they are.
    """
    turned = {name for name, own in linkage.joints.items() if own.kind not in ("swing", "rolling")}
    joints = {
        name: replace(own, on=own.of, of=own.on) if name in turned else own for name, own in linkage.joints.items()
    }
    other = {"first": "second", "second": "first"}
    inputs = {name: (joint, other.get(motion, motion)) for name, (joint, motion) in linkage.inputs.items()}
    senses = {name: -1.0 if joint in turned else 1.0 for name, (joint, _) in linkage.inputs.items()}
    poses = {key: {name: senses[name] * value for name, value in own.items()} for key, own in linkage.poses.items()}
    return replace(linkage, joints=joints, inputs=inputs, poses=poses)


def shuffled(linkage: Linkage) -> Linkage:
    rng = np.random.default_rng(0)
    joints = {name: linkage.joints[name] for name in rng.permutation(list(linkage.joints)).tolist()}
    inputs = {name: linkage.inputs[name] for name in rng.permutation(list(linkage.inputs)).tolist()}
    return replace(linkage, joints=joints, inputs=inputs, bodies=rng.permutation(list(linkage.placed_bodies)).tolist())


def shifted(linkage: Linkage) -> Linkage:
    """Coordinates of every body but for those that fix what an input of a swing joint or a play counts from."""
    rng = np.random.default_rng(1)
    for name in linkage.placed_bodies:
        by = np.eye(4)
        by[:3, 3] = 50 * rng.normal(size=3)
        linkage = drawn_elsewhere(linkage, name, by)
    return linkage


CHANGES: dict[str, Callable[[Linkage], Linkage]] = {
    "moved": lambda own: moved_rigidly(own, random_pose(np.random.default_rng(3), 200.0)),
    "shifted": shifted,
    "reversed": reversed_joints,
    "shuffled": shuffled,
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize(
    "name", [own if own in ("random", "planet") else pytest.param(own, marks=pytest.mark.slow) for own in MAKERS]
)
def test_measures_do_not_change(name: str, change: str, tmp_path: Path) -> None:
    """All features of joints and all inputs deviate; on both methods."""
    linkage = MAKERS[name]()
    changed = CHANGES[change](linkage)
    rng = np.random.default_rng(2)
    deviations, zeros = random_deviations(linkage, rng, 0.02, 2e-4)
    before, after = study_of(linkage, tmp_path), study_of(changed, tmp_path)
    far = list(linkage.poses)[1]
    senses = {name: np.sign(changed.poses[far][name] * value) for name, value in linkage.poses[far].items()}
    rows = (
        before.columns(deviations, zeros)[None],
        after.columns(deviations, {name: senses[name] * value for name, value in zeros.items()})[None],
    )
    for where in linkage.poses:
        for method in ("exact", "analytic"):
            assert np.abs(before.seen(rows[0], where, method) - after.seen(rows[1], where, method)).max() < LIMIT


@pytest.mark.parametrize(
    "change", ["shuffled", *(pytest.param(own, marks=pytest.mark.slow) for own in ("moved", "shifted"))]
)
def test_plays_do_not_change_either(change: str, tmp_path: Path) -> None:
    linkage = with_plays(random_loop(11, two=True))[0]
    before, after = study_of(linkage, tmp_path, []), study_of(CHANGES[change](linkage), tmp_path, [])
    rng = np.random.default_rng(2)
    zero = before.columns({}, {})
    row = rng.uniform(-0.5, 0.5, size=zero.shape)
    other = np.zeros_like(row)
    slices, there = component_slices(before.system), component_slices(after.system)
    for own in before.system.contributors:
        if own.unit != "1":
            row[slices[own.name]] *= 1e-3
        other[there[own.name]] = row[slices[own.name]]
    for where in linkage.poses:
        for method in ("exact", "analytic"):
            assert np.abs(before.seen(row[None], where, method) - after.seen(other[None], where, method)).max() < LIMIT


def test_parts_drawn_turned_have_their_loops_where_they_were(tmp_path: Path) -> None:
    """A body's coordinates turned any way; without deviations, whose directions would turn too."""
    linkage = random_loop(13, ["revolute", "universal", "screw", "swing", "revolute"], given=0, two=True)
    rng = np.random.default_rng(5)
    turned = linkage
    for name in linkage.placed_bodies:
        own, by = turned.parts[name], random_pose(rng, 30.0)
        features = {key: Feature(each.kind, by @ each.frame, each.size) for key, each in own.features.items()}
        turned = replace(turned, parts={**turned.parts, name: Part(own.placed @ np.linalg.inv(by), features)})
    both = [study_of(own, tmp_path, []) for own in (linkage, turned)]
    for where in linkage.poses:
        found = [own.seen(own.columns({}, {})[None], where) for own in both]
        assert np.abs(found[0] - found[1]).max() < LIMIT
