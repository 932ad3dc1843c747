"""Poses of a Build against compositions by scipy's rotations; bits that do not depend on the batch."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import poses
from scipy.spatial.transform import Rotation

from tol3d.gearing.builds.build import Build, build
from tol3d.gearing.model import AxisOffset, AxisTilt, Contributor, Effect, Model, Planar, Scalar, TurningOffset
from tol3d.numerics import frames
from tol3d.statistics.distributions import Uniform

POSE_BOUND = 1e-12  # relative to 1 in rotations; in mm a thousand times the spacing of doubles at 172 mm
LAW = Uniform(-1.0, 1.0)  # deviations are given below, none is drawn

vectors = st.tuples(*3 * [st.floats(-4.0, 4.0)])


def with_effects(model: Model, *effects: Effect, planar: tuple[bool, ...] = ()) -> Model:
    draws = [Planar(LAW, None) if two else Scalar(LAW) for two in (*planar, *[False] * len(effects))]
    contributors = [
        Contributor(f"c{k}", "test", effect, draw, "um")
        for k, (effect, draw) in enumerate(zip(effects, draws, strict=False))
    ]
    return replace(model, contributors=tuple(contributors))


@pytest.fixture(scope="module")
def posed(paper_model: Model) -> tuple[Model, np.ndarray, Build]:
    """Both gears eccentric, the wheel's axis tilted about x and y and shifted along x, y, z; the pinion's shifted."""
    model = with_effects(
        paper_model,
        TurningOffset("pinion"),
        TurningOffset("wheel"),
        AxisOffset("pinion"),
        AxisTilt("wheel", (0.0, 1.0, 0.0), per_length=1 / 20),
        AxisTilt("wheel", (1.0, 0.0, 0.0)),
        AxisOffset("wheel", (1.0, 0.0, 0.0), 0.5),
        AxisOffset("wheel", (0.0, 0.0, 1.0)),
        planar=(True, True, True),
    )
    deviations = np.random.default_rng(4).uniform(-0.5, 0.5, (25, model.component_count))
    return model, deviations, build(model, deviations)


def shaft_poses(deviations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """World from shaft of pinion and wheel, step by step from the effects above."""
    pinion = [poses.pose(np.zeros(3), [row[4], row[5], 0.0]) for row in deviations]
    wheel = [poses.pose([row[7], row[6] / 20, 0.0], [172.5 + row[8] / 2, 0.0, row[9]]) for row in deviations]
    return np.stack(pinion), np.stack(wheel)


@pytest.mark.parametrize("gear", [0, 1], ids=["pinion", "wheel"])
def test_world_from_gear_is_shaft_then_turn_then_offset_of_the_centre(
    gear: int, posed: tuple[Model, np.ndarray, Build]
) -> None:
    _, deviations, made = posed
    angle = np.random.default_rng(1).uniform(-400.0, 400.0, len(deviations))
    expected = poses.world_from_gears(shaft_poses(deviations)[gear], angle, deviations[:, 2 * gear : 2 * gear + 2])
    assert np.abs(made.world_from_gear(gear, angle) - expected).max() <= POSE_BOUND
    assert np.abs(made.centre_of(gear, angle) - expected[:, :3, 3]).max() <= POSE_BOUND


@pytest.mark.parametrize("gear", [0, 1], ids=["pinion", "wheel"])
def test_teeth_are_the_gear_turned_about_its_own_centre(gear: int, posed: tuple[Model, np.ndarray, Build]) -> None:
    _, deviations, made = posed
    rng = np.random.default_rng(2)
    angle, turn = rng.uniform(-50.0, 50.0, len(deviations)), rng.uniform(-3.0, 3.0, (len(deviations), 4))
    gears = poses.world_from_gears(shaft_poses(deviations)[gear], angle, deviations[:, 2 * gear : 2 * gear + 2])
    rotation, origin = made.tooth_pose(gear, angle, turn)
    for row in range(len(deviations)):
        for k in range(4):
            expected = gears[row] @ poses.pose([0.0, 0.0, turn[row, k]], np.zeros(3))
            assert np.abs(rotation[row, k] - expected[:3, :3]).max() <= POSE_BOUND
            assert np.abs(origin[row] - expected[:3, 3]).max() <= POSE_BOUND


def test_an_axis_is_where_the_gear_s_turns_leave_it(posed: tuple[Model, np.ndarray, Build]) -> None:
    _, deviations, made = posed
    for gear, shafts in enumerate(shaft_poses(deviations)):
        point, direction = made.axis(gear)
        turn = poses.world_from_gears(shafts, np.full(len(shafts), 1.0), np.zeros((len(shafts), 2)))
        rest = poses.world_from_gears(shafts, np.zeros(len(shafts)), np.zeros((len(shafts), 2)))
        move = turn @ np.linalg.inv(rest)  # a point of the axis stays, the direction too
        kept = (move[:, :3, :3] @ point[..., None])[..., 0] + move[:, :3, 3]
        assert np.abs(kept - point).max() <= POSE_BOUND
        assert np.abs((move[:, :3, :3] @ direction[..., None])[..., 0] - direction).max() <= POSE_BOUND
        assert np.abs(direction - shafts[:, :3, 2]).max() <= POSE_BOUND


def test_positive_deviations_of_the_axes_go_where_iso_tr_10064_3_draws_them(paper_model: Model) -> None:
    """In plane about +y: the +z end moves away along +x. Out of plane about +x: the +z end moves to -y."""
    for axis, moved in (((0.0, 1.0, 0.0), (10.0, 0.0, 0.0)), ((1.0, 0.0, 0.0), (0.0, -10.0, 0.0))):
        model = with_effects(paper_model, AxisTilt("wheel", axis))
        made = build(model, np.array([[1e-6]]))
        end = made.world_from_gear(1, np.zeros(1))[0] @ [0.0, 0.0, 10.0, 1.0]
        # 10 mm times 1 urad, to first order
        assert end[:3] - [172.5, 0.0, 10.0] == pytest.approx(np.array(moved) * 1e-6, abs=1e-10)


@given(vectors)
def test_rotations_by_vectors_are_scipy_s(vector: tuple[float, float, float]) -> None:
    ours = frames.about_vector(np.array([vector]))[0]
    assert np.abs(ours - Rotation.from_rotvec(vector).as_matrix()).max() <= POSE_BOUND


@pytest.mark.parametrize("size", [0.0, 1e-300, 1e-12, 0.99e-8, 1.01e-8, 1e-4, np.pi, 6.0])
def test_rotations_by_short_vectors_keep_their_first_order(size: float) -> None:
    vector = size * np.array([0.6, -0.48, 0.64])
    ours = frames.about_vector(vector[None])[0]
    skew = ours[[2, 0, 1], [1, 2, 0]] - ours[[1, 2, 0], [2, 0, 1]]
    assert skew == pytest.approx(2 * vector * np.sinc(size / np.pi), rel=1e-12, abs=1e-15 * (size > 1))


@settings(max_examples=20)
@given(st.integers(0, 2**31))
def test_products_have_the_same_bits_for_one_row_and_for_many(seed: int) -> None:
    rng = np.random.default_rng(seed)
    left, right = rng.normal(size=(2, 300, 3, 4, 4))
    vector = rng.normal(size=(300, 3, 3))
    many, applied = frames.matmul(left, right), frames.apply(left[..., :3, :3], vector)
    assert many == pytest.approx(left @ right, abs=1e-13)
    for row in (0, 17, 299):
        assert np.array_equal(frames.matmul(left[row : row + 1], right[row : row + 1])[0], many[row])
        assert np.array_equal(frames.matmul(left[row, 1], right[row, 1]), many[row, 1])
        assert np.array_equal(frames.apply(left[row, 2, :3, :3], vector[row, 2]), applied[row, 2])


def test_builds_have_the_same_bits_alone_and_among_many(posed: tuple[Model, np.ndarray, Build]) -> None:
    model, deviations, made = posed
    angle = np.linspace(-7.0, 7.0, len(deviations))
    for row in (0, 13, 24):
        one = slice(row, row + 1)
        alone = build(model, deviations[one])
        for gear in (0, 1):
            assert np.array_equal(alone.world_from_gear(gear, angle[one])[0], made.world_from_gear(gear, angle)[row])
