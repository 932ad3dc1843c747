"""Problem 6: a block in six locators, by hand, by scipy, and the coefficients of its points."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled, constant, normal, point
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tol3d.errors import SceneError

Array = NDArray[np.float64]

LOCATORS = np.array([[20, 15, 0], [180, 15, 0], [100, 90, 0], [30, 0, 25], [170, 0, 25], [0, 50, 20]], dtype=float)
NORMALS = np.eye(3)[[2, 2, 2, 1, 1, 0]]
NAMES = ("primary 1", "primary 2", "primary 3", "secondary 1", "secondary 2", "tertiary 1")
SEEN = np.array([[200.0, 100.0, 40.0], [100.0, 50.0, 60.0]])
ONE_SHOT = np.array([2.0, -1.5, 3.0, 1.2, -2.0, 0.8])
SIGMAS = (0.05, 0.05, 0.05, 0.03, 0.03, 0.02)


def nest(laws: Sequence[str], points_on: str, *, welded: bool = False) -> str:
    """A block on six locators whose heights have laws; or welded to a part whose frame is another, and moved by it."""
    own = [1, 2, 0] if welded else [0, 1, 2]  # the block's x, y, z in the world's
    turned = "    placed: {z: [1, 0, 0], x: [0, 1, 0]}\n" if welded else ""
    joined = "  put: {kind: fix, part: block}\n  joined: {kind: weld, part: carrier, to: [block]}\n" if welded else ""
    locators, normals, places = LOCATORS[:, own], NORMALS[:, own], SEEN[:, own]
    block = "".join(
        f"      l{k}: {point(at, -n)}\n" for k, (at, n) in enumerate(zip(locators, normals, strict=True), 1)
    )
    block += "".join(f"      s{k}: {point(at)}\n" for k, at in enumerate(places, 1))
    base = "".join(f"      l{k}: {point(at, n)}\n" for k, (at, n) in enumerate(zip(LOCATORS, NORMALS, strict=True), 1))
    seen = "".join(f"      s{k}: {point(at)}\n" for k, at in enumerate(SEEN, 1))
    out = -1 if points_on == "fixture" else 1
    along = normals if points_on == "fixture" else NORMALS  # of the part that the plane stays with
    pairs = [f"{{from: block.l{k}, to: base.l{k}, along: {(out * n).tolist()}}}" for k, n in enumerate(along, 1)]
    heights = "".join(
        f"  height {k}: {{kind: locator, of: nest, pair: {name}, distribution: {law}}}\n"
        for k, (name, law) in enumerate(zip(NAMES, laws, strict=True), 1)
    )
    measures = "".join(
        f"  s{k} {axis}: {{kind: gap, from: base.s{k}, to: block.s{k}, along: {direction}}}\n"
        for k in (1, 2)
        for axis, direction in (("x", [1, 0, 0]), ("y", [0, 1, 0]), ("z", [0, 0, 1]))
    )
    return f"""
scene: a block in a nest
parts:
  base:
    kind: solid
    features:
{base}{seen}
  block:
    kind: solid
{turned}    features:
{block}
  carrier: {{kind: solid, features: {{middle: {point((0, 0, 0))}}}}}
tolerances:
{heights}
moves:
  machine: {{kind: fix, part: base}}
  carried: {{kind: fix, part: carrier}}
{joined}  nest:
    kind: three_two_one
    part: {"carrier" if welded else "block"}
    points_on: {points_on}
    primary: [{", ".join(pairs[:3])}]
    secondary: [{", ".join(pairs[3:5])}]
    tertiary: [{pairs[5]}]
measures:
{measures}
"""


def displaced(heights: Array, points_on: str) -> Array:
    """Displacement of the points that are seen (2, 3) [mm], by scipy's least squares on the six contacts."""

    def gaps(q: Array) -> Array:
        turn, shift = Rotation.from_rotvec(q[:3]).as_matrix(), q[3:]
        lifted = LOCATORS + heights[:, None] * NORMALS
        if points_on == "fixture":  # points in the world, planes on the block
            return np.asarray((NORMALS * ((lifted - shift) @ turn - LOCATORS)).sum(axis=1))
        return np.asarray((NORMALS * (LOCATORS @ turn.T + shift - lifted)).sum(axis=1))

    found = least_squares(gaps, np.zeros(6), xtol=1e-15, ftol=1e-15, gtol=1e-15, x_scale=[1e-2] * 3 + [1.0] * 3)
    assert np.abs(found.fun).max() < 1e-12
    return np.asarray(SEEN @ Rotation.from_rotvec(found.x[:3]).as_matrix().T + found.x[3:] - SEEN)


def seen(made: Assembled, method: str) -> Array:
    """Measures of one build (2, 3) [mm]."""
    found = made.drawn(1, method)
    return np.array([[found[f"s{k} {axis}"][0] for axis in "xyz"] for k in (1, 2)])


def matrix() -> Array:
    """Displacements of the points that are seen by the six heights (6 measures, 6), of first order by hand."""
    rows = np.hstack([NORMALS, np.cross(LOCATORS, NORMALS)])
    twists = np.linalg.inv(rows)  # (shift, turn) by height
    return np.concatenate([twists[:3] + np.array([np.cross(t, at) for t in twists[3:].T]).T for at in SEEN])


@pytest.mark.parametrize("points_on", ["fixture", "part"])
def test_a_block_lies_where_scipy_lays_it(tmp_path: Path, points_on: str) -> None:
    made = assembled(nest([constant(own) for own in ONE_SHOT.tolist()], points_on), tmp_path)
    assert seen(made, "exact") == pytest.approx(displaced(ONE_SHOT, points_on), abs=1e-9)


@pytest.mark.parametrize("method", ["exact", "analytic"])
@pytest.mark.parametrize("points_on", ["fixture", "part"])
def test_a_welded_part_may_have_any_frame(tmp_path: Path, points_on: str, method: str) -> None:
    laws = [constant(own) for own in (ONE_SHOT / 50).tolist()]
    alone, joined = (assembled(nest(laws, points_on, welded=welded), tmp_path) for welded in (False, True))
    assert seen(joined, method) == pytest.approx(seen(alone, method), abs=1e-9)


def test_the_printed_one_shots(tmp_path: Path) -> None:
    laws = [constant(own) for own in ONE_SHOT.tolist()]
    fixture = seen(assembled(nest(laws, "fixture"), tmp_path), "exact")
    assert fixture[0] == pytest.approx((2.408011807, -3.229549268, 1.044517202), abs=1e-8)
    assert fixture[1] == pytest.approx((1.753270438, -1.713939689, 1.486799988), abs=1e-8)
    part = seen(assembled(nest(laws, "part"), tmp_path), "exact")
    assert part[0] == pytest.approx((2.302665, -3.338431, 1.142691), abs=1e-6)


@pytest.mark.parametrize("points_on", ["fixture", "part"])
def test_both_readings_are_one_to_first_order(tmp_path: Path, points_on: str) -> None:
    made = assembled(nest([constant(own) for own in ONE_SHOT.tolist()], points_on), tmp_path)
    assert seen(made, "analytic").ravel() == pytest.approx(matrix() @ ONE_SHOT, abs=1e-9)
    small = assembled(nest([constant(own / 50) for own in ONE_SHOT.tolist()], points_on), tmp_path)
    assert np.abs(seen(small, "exact") - seen(small, "analytic"))[0].max() < 0.07e-3  # it falls with the square


def test_the_covariance_of_a_point(tmp_path: Path) -> None:
    made = assembled(nest([normal(sigma) for sigma in SIGMAS], "fixture"), tmp_path)
    covariance = matrix()[:3] @ np.diag(np.square(SIGMAS)) @ matrix()[:3].T
    sigmas = np.sqrt(np.diagonal(covariance))
    assert sigmas == pytest.approx((0.02660295, 0.03896623, 0.07201707), abs=1e-8)
    for measure, sigma in zip(made.system.measures, sigmas, strict=False):
        form = made.system.closed_form(measure)
        assert form is not None
        assert form.sigma == pytest.approx(sigma, rel=1e-9)
    count = 100_000
    found = made.drawn(count)
    sample = np.array([found[f"s1 {axis}"] for axis in "xyz"])
    assert sample.std(axis=1) == pytest.approx(sigmas, rel=4 / math.sqrt(2 * count))
    r = covariance[0, 1] / sigmas[0] / sigmas[1]
    assert r == pytest.approx(-0.44296, abs=1e-5)
    assert np.corrcoef(sample)[0, 1] == pytest.approx(r, abs=4 * (1 - r * r) / math.sqrt(count))


def test_locators_that_leave_a_freedom_are_refused(tmp_path: Path) -> None:
    text = nest([constant(0.0)] * 6, "part").replace(
        "to: base.l6, along: [1.0, 0.0, 0.0]", "to: base.l6, along: [0, 1, 0]"
    )
    with pytest.raises(SceneError, match="nest"):
        assembled(text, tmp_path)
