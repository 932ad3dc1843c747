"""Composite tolerances of different faces as one rigid set: both segments held, by the drawing's geometry alone."""

from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from scipy.optimize import linprog

from tol3d.errors import SceneError
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

UPPER, LOWER = 0.4, 0.1
FACES = {  # middle, normal, x, extent
    "seat": ((10, 0, 12), (0, 0, 1), (1, 0, 0), (30, 20)),
    "stop": ((25, 0, 16), (-1, 0, 0), (0, 1, 0), (20, 8)),
}
NEST = (5.0, 0.0, 6.0)


def plate(at: Array | None = None, law: str = "uniform", datums: str = ", datums: [A]", more: str = "") -> str:
    x, y, z = (0.0, 0.0, 0.0) if at is None else at.tolist()

    def place(*point: float) -> str:
        return f"[{x + point[0]!r} mm, {y + point[1]!r} mm, {z + point[2]!r} mm]"

    faces = "".join(
        f"      {name}: {{kind: plane, at: {place(*own)}, normal: {list(normal)}, extent: [{a} mm, {b} mm], "
        f"along: {list(along)}}}\n"
        for name, (own, normal, along, (a, b)) in FACES.items()
    )
    return f"""scene: plate with a set of faces
parts:
  plate:
    kind: solid
    features:
      A: {{kind: plane, at: {place(0, 0, 0)}, normal: [0, 0, -1], extent: [100 mm, 60 mm]}}
      B: {{kind: plane, at: {place(0, -30, 5)}, normal: [0, -1, 0], extent: [100 mm, 10 mm]}}
      C: {{kind: plane, at: {place(-50, 0, 5)}, normal: [-1, 0, 0], extent: [60 mm, 10 mm], along: [0, 1, 0]}}
{faces}      nest: {{kind: cylinder, at: {place(*NEST)}, axis: [0, 0, 1], length: 10 mm, diameter: 8 mm, hole: true}}
tolerances:
  nest:
    kind: profile
    of: plate.seat
    rigid_with: [plate.stop, plate.nest]
    zone: {{width: 0.4 mm}}
    datums: [A, B, C]
    lower_segment: {{zone: {{width: 0.1 mm}}{datums}}}
    law: {{kind: {law}}}
{more}moves:
  bench: {{kind: fix, part: plate}}
measures:
  seat: {{kind: inspected_position, of: plate.seat, datums: [A, B, C]}}
  faces: {{kind: inspected_set, of: [plate.seat, plate.stop], free: oriented, datums: [A]}}
  set: {{kind: inspected_set, of: [plate.seat, plate.stop, plate.nest], surfaces: true, free: oriented, datums: [A]}}
  between: {{kind: gap, from: plate.nest, to: plate.stop, along: [1, 0, 0]}}
"""


def outward(feature: str, components: Array) -> Array:
    """Heights of the corners of a face (trials, 4)."""
    offset, x, y = components.T
    return np.stack([offset + a * x + b * y for a in (-1, 1) for b in (-1, 1)], axis=1)


def parts(made: Assembled, deviations: Array) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Components (trials, n) of each feature by the motion of the set, and by its own zone; the nest's own radius."""
    motion, own = dict[str, Array](), dict[str, Array]()
    for name in (*FACES, "nest"):
        for each in made.system.assembly.features[f"plate.{name}"].moved_by:
            found = deviations[:, each.columns] @ each.matrix.T
            (motion if "shift" in each.contributor else own)[name] = found
    size = made.system.assembly.features["plate.nest"].size_by[0]
    return motion, own, -0.5 * deviations[:, size.columns] @ size.matrix[0]


def rigid(name: str) -> Array:
    """(components, 6): a face's or the nest's components by a shift and small turns about the part's origin."""
    if name == "nest":
        ends = [np.add(NEST, (0, 0, z)) for z in (-5, 5)]
        return np.vstack([np.hstack([np.eye(3), -cross(end)])[:2] for end in ends])
    at, normal, along, (a, b) = (np.array(own, dtype=float) for own in FACES[name])
    other = np.cross(normal, along)
    rows = [normal @ np.hstack([np.eye(3), -cross(at + arm)]) for arm in (0 * along, a / 2 * along, b / 2 * other)]
    return np.stack([rows[0], rows[1] - rows[0], rows[2] - rows[0]])


def cross(v: Array) -> Array:
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


@pytest.mark.parametrize(
    ("law", "count"),
    [("uniform", 50_000), *(pytest.param(own, 1_000_000, marks=pytest.mark.slow) for own in ("uniform", "normal"))],
)
def test_all_builds_hold_both_segments(law: str, count: int, tmp_path: Path) -> None:
    """Every corner and end, straight from the draws; the set moves rigidly and turns about the normal of A alone."""
    made = assembled(plate(law=law), tmp_path)
    jacobian = np.vstack([rigid(name) for name in (*FACES, "nest")])
    most, least, block = 0.0, 0.0, 50_000
    for first in range(0, count, block):
        motion, own, size = parts(made, drawn(made.simulation, first, block).deviations)
        for kept, share in ((own, False), ({name: own[name] + motion[name] for name in own}, True)):
            reach = [np.abs(outward(name, kept[name])).max(axis=1) for name in FACES]
            ends = kept["nest"].reshape(-1, 2, 2)
            reach.append(np.abs(size) + np.hypot(ends[..., 0], ends[..., 1]).max(axis=1))
            worst = float(np.max(reach))
            most, least = (max(most, worst), least) if share else (most, max(least, worst))
        together = np.hstack([motion[name] for name in (*FACES, "nest")])[:1000].T
        solved = np.linalg.lstsq(jacobian, together, rcond=None)[0]
        assert jacobian @ solved == pytest.approx(together, abs=1e-12)
        assert np.abs(solved[3:5]).max() < 1e-12
        assert np.abs(solved[5]).max() > 1e-3
    assert (0.85 if law == "uniform" else 0.5) * UPPER / 2 < most <= UPPER / 2 * (1 + 1e-12)
    assert 0.9 * LOWER / 2 < least <= LOWER / 2 * (1 + 1e-12)


def test_the_lower_segment_is_read_as_a_linear_programme_has_it(tmp_path: Path) -> None:
    """Over shifts and the turn about A's normal; both methods, which differ by second order."""
    made = assembled(plate(), tmp_path)
    trials = drawn(made.simulation, 0, 40)
    motion, own, _ = parts(made, trials.deviations)
    signs = np.array([[1, a, b] for a in (-1, 1) for b in (-1, 1)])
    free = np.vstack([signs @ rigid(name)[:, [0, 1, 2, 5]] for name in FACES])
    apart = []
    for scale in (1.0, 0.25):
        exact, linear = (made.values(trials.scaled(scale), method) for method in ("exact", "analytic"))
        apart.append({name: float(np.abs(exact[name] - linear[name]).max()) for name in exact})
        assert exact["set"].max() <= scale * LOWER * (1 + 1e-4)
        for trial in range(8):
            heights = scale * np.concatenate([outward(n, (own[n] + motion[n])[trial : trial + 1])[0] for n in FACES])
            one = np.ones((8, 1))
            rows = np.vstack([np.hstack([free, -one]), np.hstack([-free, -one])])
            best = linprog([0, 0, 0, 0, 1], rows, np.concatenate([heights, -heights]), bounds=[(None, None)] * 5).x[4]
            assert linear["faces"][trial] == pytest.approx(2 * best, abs=1e-6)
    assert all(apart[1][name] < max(apart[0][name] / 10, 1e-9) for name in apart[0])


def test_places_of_the_part_and_copies_of_it_change_nothing(tmp_path: Path) -> None:
    here, there = (assembled(plate(at), tmp_path).drawn(30) for at in (None, np.array([300.0, -200.0, 50.0])))
    for name, values in here.items():
        assert there[name] == pytest.approx(values, abs=1e-9), name
    copied = plate().replace("tolerances:\n", "  other: {kind: solid, like: plate}\ntolerances:\n", 1)
    copied = copied.replace("part: plate}\n", "part: plate}\n  second: {kind: fix, part: other}\n", 1)
    names = [own.name for own, _ in assembled(copied, tmp_path).slices]
    assert names[:4] == ["nest 1", "nest 2", "nest 3", "nest shift and turn"]
    assert names[4:] == [f"{own} of other" for own in names[:4]]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[plate.stop, plate.nest]", "[plate.stop, other.nest]", "expected features of 'plate', as `of` is"),
        ("[plate.stop, plate.nest]", "[plate.stop, plate.seat]", "each feature once"),
        ("[plate.stop, plate.nest]", "[plate.stop, plate.rest]", "rest"),
        ("    lower_segment: {zone: {width: 0.1 mm}, datums: [A]}\n", "", "a lower_segment beside it"),
        ("kind: profile", "kind: position", "nest.zone: expected the direction `along`"),
        (
            "moves:\n",
            "  other: {kind: profile, of: plate.stop, zone: {width: 0.2 mm}, law: {kind: uniform}}\nmoves:\n",
            "expected one tolerance of 'plate.stop' for where it lies",
        ),
        (
            "moves:\n",
            "  flat: {kind: flatness, of: plate.stop, zone: {width: 0.1 mm}}\nmoves:\n",
            "expected more than the 100 um of 'flat'",
        ),
    ],
)
def test_a_set_that_makes_no_sense_is_refused(old: str, new: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=words):
        assembled(plate().replace(old, new, 1), tmp_path)
