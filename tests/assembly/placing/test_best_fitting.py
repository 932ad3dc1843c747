"""Parts that are fitted to points."""

from typing import Literal

import numpy as np
import pytest
from assembly.placing.built_by_numbers import Columns, assembly, feature, frame, part, posed, seeds
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from tol3d.assembly.grammar.measures.gap import DistanceSpec
from tol3d.assembly.model import Assembly, BestFit, Fit, Fix, Measured, Move, Point
from tol3d.assembly.model.statuses import OK, SINGULAR
from tol3d.assembly.placing.method import placed, values
from tol3d.errors import InputError

Array = NDArray[np.float64]
Criterion = Literal["squares", "minimax"]

PLATE = np.array([[0, 0, 0], [120, 0, 0], [120, 80, 0], [0, 80, 0]], dtype=float)
ACTUAL = np.array([[0.13, -0.04], [120.09, 0.11], [119.86, 80.15], [-0.05, 79.92]])


def fitted(
    points: Array, criterion: Criterion, directions: Array, weights: Array | None = None, pose: Array | None = None
) -> Assembly:
    """A part whose points are fitted to those of a base, which deviate in x, y and z; distances are measured."""
    columns = Columns()
    base = [feature(f"base.{k}", Point(), frame(at), [columns(count=3)]) for k, at in enumerate(points)]
    pose = np.eye(4) if pose is None else pose
    own = points @ pose[:3, :3] - pose[:3, 3] @ pose[:3, :3]
    plate = [feature(f"plate.{k}", Point(), frame(at)) for k, at in enumerate(own)]
    weights = np.ones(len(points)) if weights is None else weights
    fits = tuple(Fit(f"plate.{k}", f"base.{k}", float(weight), directions) for k, weight in enumerate(weights))
    moves: list[Move] = [Fix("base", "base"), BestFit("fit", "plate", fits, criterion)]
    measures = {str(k): Measured(DistanceSpec.reads, (f"base.{k}", f"plate.{k}")) for k in range(len(points))}
    return assembly(columns, [part("base", base), part("plate", plate, pose=pose)], moves, measures)


def of_holes(offsets: Array) -> Array:
    """Deviations in x, y and z of holes that deviate in x and y (trials, holes, 2)."""
    return np.concatenate([offsets, np.zeros((*offsets.shape[:2], 1))], axis=2).reshape(len(offsets), -1)


@pytest.mark.parametrize("directions", [np.eye(3), np.eye(3)[:2]])
def test_least_squares_of_a_hole_pattern(directions: Array) -> None:
    made, row = fitted(PLATE, "squares", directions), of_holes((ACTUAL - PLATE[:, :2])[None])
    pose = placed(made, row)["plate"][0]
    residuals = [values(made, row, [str(k)])[str(k)][0][0] for k in range(4)]
    # half of the last digit that is printed
    assert np.arctan2(pose[1, 0], pose[0, 0]) == pytest.approx(1.8853201467e-3, abs=6e-14)
    np.testing.assert_allclose(pose[:3, 3], (0.0830193941, -0.0780480532, 0), atol=6e-11)
    np.testing.assert_allclose(residuals, (0.0604552, 0.0388619, 0.0720071, 0.0178979), atol=6e-8)
    np.testing.assert_allclose(pose[2], (0, 0, 1, 0), atol=1e-13)


@pytest.mark.slow
def test_least_largest_residual_of_a_hole_pattern() -> None:
    made, row = fitted(PLATE, "minimax", np.eye(3)[:2]), of_holes((ACTUAL - PLATE[:, :2])[None])
    pose = placed(made, row)["plate"][0]
    residuals = np.array([values(made, row, [str(k)])[str(k)][0][0] for k in range(4)])
    assert residuals.max() == pytest.approx(0.0604992, abs=6e-8)
    np.testing.assert_allclose(residuals[:3], residuals.max(), atol=1e-9)
    assert np.arctan2(pose[1, 0], pose[0, 0]) == pytest.approx(2.0386e-3, abs=6e-8)


def kabsch(points: Array, targets: Array, weights: Array) -> Array:
    """The pose (4, 4) of least weighted squares by the singular values of a covariance."""
    share = weights / weights.sum()
    own, its = share @ points, share @ targets
    left, _, right = np.linalg.svd((points - own).T * share @ (targets - its))
    sign = np.diag([1, 1, np.linalg.det(right.T @ left.T)])
    pose = np.eye(4)
    pose[:3, :3] = right.T @ sign @ left.T
    pose[:3, 3] = its - pose[:3, :3] @ own
    return pose


def random_points(random: np.random.Generator) -> tuple[Array, Array]:
    """Points in the world about a pose, not in a plane."""
    pose = posed(random.normal(size=3), random.normal(0, 50, 3))
    return random.uniform(-80, 80, (int(random.integers(4, 8)), 3)), pose


@pytest.mark.parametrize("seed", seeds(10))
def test_least_squares_in_space_agree_with_kabsch(seed: int) -> None:
    random = np.random.default_rng(seed)
    points, pose = random_points(random)
    weights, offsets = random.uniform(0.5, 2.0, len(points)), random.normal(0, 0.5, (5, len(points), 3))
    made = fitted(points, "squares", np.eye(3), weights, pose)
    own = (points - pose[:3, 3]) @ pose[:3, :3]
    expected = [kabsch(own, points + each, weights) for each in offsets]
    np.testing.assert_allclose(placed(made, offsets.reshape(5, -1))["plate"], expected, atol=2e-11, rtol=0)


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds(10))
def test_least_largest_residuals_in_space_agree_with_a_general_optimiser(seed: int) -> None:
    """Scipy's SLSQP from the pose of least squares: T least, T^2 >= each residual squared."""
    random = np.random.default_rng(seed)
    points, pose = random_points(random)
    offsets = random.normal(0, 0.3, (1, len(points), 3))
    made = fitted(points, "minimax", np.eye(3), None, pose)
    found = placed(made, offsets.reshape(1, -1))["plate"][0]
    own, targets = (points - pose[:3, 3]) @ pose[:3, :3], points + offsets[0]

    near = kabsch(own, targets, np.ones(len(points)))

    def lengths(unknowns: Array) -> Array:
        turn = Rotation.from_rotvec(unknowns[:3] / 50).as_matrix() @ near[:3, :3]
        return np.asarray(np.linalg.norm(own @ turn.T + near[:3, 3] + unknowns[3:6] - targets, axis=1))

    searched = minimize(
        lambda u: u[6],
        [*np.zeros(6), lengths(np.zeros(6)).max()],
        constraints={"type": "ineq", "fun": lambda u: u[6] ** 2 - lengths(u) ** 2},
        options={"ftol": 1e-15, "maxiter": 400},
        method="SLSQP",
    )
    largest = np.linalg.norm(own @ found[:3, :3].T + found[:3, 3] - targets, axis=1).max()
    assert largest == pytest.approx(lengths(searched.x).max(), abs=1e-8)
    np.testing.assert_allclose(found[:3, :3].T @ found[:3, :3], np.eye(3), atol=1e-13)


def test_residual_squares_are_chi_squared_with_2n_less_3_degrees() -> None:
    n, sigma = 20_000, 0.05
    made = fitted(PLATE, "squares", np.eye(3)[:2])
    rows = of_holes(np.random.default_rng(8).normal(0, sigma, (n, 4, 2)))
    read = values(made, rows, [str(k) for k in range(4)])
    squares = np.sum([distances**2 for distances, _ in read.values()], axis=0)
    assert squares.mean() == pytest.approx(5 * sigma**2, abs=4 * sigma**2 * np.sqrt(10 / n))
    assert np.mean(squares > chi2.ppf(0.95, 5) * sigma**2) == pytest.approx(0.05, abs=4 * np.sqrt(0.05 * 0.95 / n))
    turn = np.arctan2(*placed(made, rows)["plate"][:, (1, 0), 0].T)
    radii = np.sum((PLATE - PLATE.mean(axis=0)) ** 2)
    assert turn.std() == pytest.approx(sigma / np.sqrt(radii), rel=4 / np.sqrt(2 * n))


@pytest.mark.parametrize("criterion", ["squares", "minimax"])
def test_a_trial_has_the_same_bits_alone_and_its_failure_disturbs_no_other(criterion: Criterion) -> None:
    made = fitted(PLATE, criterion, np.eye(3)[:2])
    rows = of_holes(np.random.default_rng(9).normal(0, 0.1, (60, 4, 2)))
    rows[17] *= 1e5  # tens of metres: no turn is found
    found, codes = values(made, rows, ["1"])["1"]
    np.testing.assert_array_equal(codes, np.where(np.arange(60) == 17, SINGULAR, OK))
    for row in (0, 16, 18, 59):
        assert values(made, rows[row : row + 1], ["1"])["1"][0][0] == found[row]


@pytest.mark.parametrize("criterion", ["squares", "minimax"])
def test_without_deviations_nothing_moves(criterion: Criterion) -> None:
    pose = placed(fitted(PLATE, criterion, np.eye(3)), np.zeros((1, 12)))["plate"][0]
    # minimax ends within eight residuals' share of the barrier
    np.testing.assert_allclose(pose, np.eye(4), atol=1e-15 if criterion == "squares" else 1e-10)


def test_weights_are_positive() -> None:
    with pytest.raises(InputError, match=r"positive weight of plate\.2"):
        placed(fitted(PLATE, "squares", np.eye(3), np.array([1, 1, 0, 1.0])), np.zeros((1, 12)))
