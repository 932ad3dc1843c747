"""Linked bodies among other moves: drawings with datum frames, parts laid on them, loops in series, gaps after all."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from linkage.linked_bodies import Array, Linkage, Study, Trial, random_deviations, triple
from linkage.mechanisms import four_bar, rssr, slider_crank
from linkage.split import split
from oracles.closed_loops import closed, displaced, followed, pose
from scipy.optimize import root

from tol3d.study.system.stated import component_count, component_slices, stated

SERIES = {
    "slider crank": (slider_crank, [["crank"], ["rod", "slider"]], np.linspace(0.0, 6.0, 4)),
    "four-bar": (four_bar, [["crank"], ["coupler", "rocker"]], np.linspace(0.0, 6.0, 4)),
    "rssr": (rssr, [["crank"], ["rod", "rocker"]], np.linspace(-0.5, 0.8, 3)),
}


@pytest.mark.parametrize("name", SERIES)
def test_loops_in_series_lie_as_one_loop(name: str, tmp_path: Path) -> None:
    """The crank by a move of its own, then a loop on it: as the oracle has both, and as one move has them."""
    make, groups, angles = SERIES[name]
    linkage: Linkage = replace(make(), poses={f"pose {k}": {"angle": float(own)} for k, own in enumerate(angles)})
    study = Study(linkage, assembled(split(linkage, groups), tmp_path))
    whole = Study(linkage, assembled(linkage.text(), tmp_path))
    trials: list[Trial] = [({}, {}), random_deviations(linkage, np.random.default_rng(1), 0.05, 5e-4)]
    rows = [np.stack([own.columns(*trial) for trial in trials]) for own in (study, whole)]
    for k, where in enumerate(linkage.poses):
        found = study.seen(rows[0], where)
        assert np.abs(found - whole.seen(rows[1], where)).max() < 1e-9
        if k % 3 == 1:
            assert np.abs(found - linkage.expected(where, trials)).max() < 1e-9


# a slider with a drawing, and a cover on it ---------------------------------------------------------

HALF = np.array([30.0, 20.0])
PLANES = {
    # of the slider: middle, normal, x; deviations of the middle along the normal
    "floor": (np.array([30.0, 20.0, 10.0]), np.array([0.0, 0.0, 1.0])),
    "back": (np.array([30.0, 0.0, 25.0]), np.array([0.0, 1.0, 0.0])),
    "left": (np.array([0.0, 20.0, 25.0]), np.array([1.0, 0.0, 0.0])),
}
TOUCHES = {
    "floor": ([5.0, 5.0, 10.0], [50.0, 5.0, 10.0], [25.0, 35.0, 10.0]),
    "back": ([10.0, 0.0, 13.0], [45.0, 0.0, 13.0]),
    "left": ([0.0, 20.0, 13.0],),
}
DRAWN = {"floor form": 3, "back place": 1, "left place": 1, "sleeve place": 4}
"""Components of the deviations."""
PAIRS = ("primary", "secondary", "tertiary")


def drawn_slider() -> str:
    """The slider-crank; its slider's sleeve is toleranced to datums that deviate, and a cover lies on it."""
    linkage = slider_crank()
    head, _, tail = linkage.text(["crank.pin"]).partition("tolerances:\n")
    moves, _, _ = tail.partition("measures:")
    features = "".join(
        f"\n      {name}: {{kind: plane, at: {triple(at)}, normal: {triple(normal, '')}, extent: [60 mm, 40 mm]}}"
        for name, (at, normal) in PLANES.items()
    )
    head = head.rstrip("\n") + features + "\n"
    end = linkage.parts["slider"].placed[:3, 3]
    points = "".join(
        f"\n      {name} {k}: {{kind: point, at: {triple(at)}, normal: {triple(-PLANES[name][1], '')}}}"
        for name, own in TOUCHES.items()
        for k, at in enumerate(own)
    )
    law = "{kind: normal, mean: 0 mm, sigma: 10 um}"
    pairs = "".join(
        f"\n    {group}: [{', '.join(f'{{from: cover.{name} {k}, to: slider.{name}}}' for k in range(len(own)))}]"
        for group, (name, own) in zip(PAIRS, TOUCHES.items(), strict=True)
    )
    return f"""{head}  cover:
    kind: solid
    placed: {{at: {triple(end)}}}
    features:{points}
      top: {{kind: point, at: [40 mm, 30 mm, 22 mm], normal: [0, 0, 1]}}
tolerances:
  floor form: {{kind: profile, of: slider.floor, zone: {{width: 0.2 mm}}, law: {{kind: process, distribution: {law}}}}}
  back place: {{kind: plus_minus, of: slider.back, distribution: {law}}}
  left place: {{kind: plus_minus, of: slider.left, distribution: {law}}}
  sleeve place:
    kind: position
    of: slider.sleeve
    zone: {{diameter: 0.2 mm}}
    law: {{kind: process, distribution: {law}}}
    datums: [floor, back, left]
{moves.rstrip()}
  lay:
    kind: three_two_one
    part: cover{pairs}
measures:
""" + "".join(
        f"  {name} {axis} at {where}: {{kind: gap, from: frame.zero, to: {of}, "
        f"along: {triple(np.eye(3)[k], '')}, at: {where}}}\n"
        for where in linkage.poses
        for name, of in (("slider", "slider.probe"), ("cover", "cover.top"))
        for k, axis in enumerate("xyz")
    )


def planes(floor: Array, back: float, left: float) -> tuple[Array, Array]:
    """Normals (3, 3) and distances (3,) of the slider's planes with their deviations.

    The floor's are at its middle, then at the end of x and of y of its frame, which are those of the part.
    """
    up = np.cross([HALF[0], 0.0, floor[1]], [0.0, HALF[1], floor[2]])
    normals = np.array([up / np.linalg.norm(up), PLANES["back"][1], PLANES["left"][1]])
    middles = np.array([own[0] for own in PLANES.values()])
    middles[0] += [0.0, 0.0, floor[0]]
    middles[1] += [0.0, back, 0.0]
    middles[2] += [left, 0.0, 0.0]
    return normals, np.asarray(np.einsum("ij,ij->i", normals, middles))


def corners(name: str, off: float) -> Array:
    """Corners of the back or the left plane (4, 3), 60 mm long along the world's x, or y, and 40 mm across."""
    at, normal = PLANES[name]
    long = np.eye(3)[0 if name == "back" else 1]
    ends = [a * 30.0 * long + b * 20.0 * np.cross(normal, long) for a in (-1, 1) for b in (-1, 1)]
    return np.asarray(np.array(ends) + at + off * normal)


def datum_frame(normals: Array, distances: Array, back: float, left: float) -> Array:
    """Part's frame from its planes (4, 4): each of the second and third is square to those before.

    It touches them where they reach furthest out.
    """
    z = normals[0]
    y = normals[1] - z * (z @ normals[1])
    y /= np.linalg.norm(y)
    found = np.eye(4)
    found[:3, :3] = np.stack([np.cross(y, z), y, z], axis=1)  # nominally x, y and z
    reaches = [(corners("left", left) @ found[:3, 0]).max(), (corners("back", back) @ y).max(), distances[0]]
    corner = found[:3, :3] @ np.array(reaches)
    found[:3, 3] = corner - found[:3, :3] @ np.array([0.0, 0.0, 10.0])
    return found


def laid(normals: Array, distances: Array) -> Array:
    """The cover's pose on the slider (4, 4) by its six points."""
    points = np.array([at for own in TOUCHES.values() for at in own])
    which = [k for k, own in enumerate(TOUCHES.values()) for _ in own]

    def off(q: Array) -> Array:
        at = points @ pose(q[:3] / 100, [0, 0, 0])[:3, :3].T + q[3:]
        return np.asarray(np.einsum("ij,ij->i", normals[which], at) - distances[which])

    q = root(off, np.zeros(6), tol=1e-15).x
    assert np.abs(off(q)).max() < 1e-11
    return pose(q[:3] / 100, q[3:])


@pytest.fixture(scope="module")
def covered(tmp_path_factory: pytest.TempPathFactory) -> Assembled:
    return assembled(drawn_slider(), tmp_path_factory.mktemp("covered"))


def test_a_linked_part_is_held_by_a_feature_toleranced_to_datums_that_deviate(covered: Assembled) -> None:
    """And a cover laid on its planes after the loop goes with it."""
    linkage, rng = slider_crank(), np.random.default_rng(4)
    slices, where = component_slices(covered.system), "far"
    rows, expected = [], []
    start = followed(linkage.loops, linkage.loops, linkage.poses[where])
    assert start is not None
    for k in range(4):
        own = {name: 0.03 * rng.normal(size=count) * (k > 0) for name, count in DRAWN.items()}
        row = np.zeros(component_count(covered.system))
        for name, values in own.items():
            row[slices[name]] = values
        rows.append(row)
        sides = float(own["back place"][0]), float(own["left place"][0])
        normals, distances = planes(own["floor form"], *sides)
        feature = linkage.feature("slider.sleeve")
        frame = datum_frame(normals, distances, *sides) @ feature.displaced(own["sleeve place"])
        standing = closed(
            linkage.loops, displaced(linkage.loops, {"slide": (None, frame)}), start, linkage.poses[where]
        )
        assert standing is not None
        cover = standing["slider"] @ laid(normals, distances)
        expected.append([(standing["slider"] @ [10.0, 4.0, -3.0, 1.0])[:3], (cover @ [40.0, 30.0, 22.0, 1.0])[:3]])
    made = covered.system.method("exact", covered.system.materials("exact"))
    read = made.answers(stated(covered.system, np.array(rows)), covered.system.measures).values
    found = np.array(
        [
            [[read[f"{name} {axis} at {where}"][k, 0] for axis in "xyz"] for name in ("slider", "cover")]
            for k in range(4)
        ]
    )
    assert np.abs(found - np.array(expected)).max() < 1e-9


def test_its_methods_differ_by_second_order(covered: Assembled) -> None:
    rng = np.random.default_rng(6)
    rows = 0.02 * rng.normal(size=(20, component_count(covered.system)))
    rows[:, component_slices(covered.system)["zero of angle"]] *= 0.01
    wholes = []
    for factor in (1.0, 0.5):
        both = [
            covered.system.method(method, covered.system.materials(method)).answers(
                stated(covered.system, factor * rows), covered.system.measures
            )
            for method in ("exact", "analytic")
        ]
        off = [both[0].values[own.name] - both[1].values[own.name] for own in covered.system.measures]
        wholes.append(float(np.sqrt(np.mean(np.square(off)))))
    assert wholes[1] / wholes[0] == pytest.approx(0.25, abs=0.01)
