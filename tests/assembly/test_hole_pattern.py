"""Problem 8: a perfect pattern of four holes fitted onto a real one, by squares and by the least largest residual."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled, constant, normal, point
from numpy.typing import NDArray
from scipy.optimize import minimize, nnls

Array = NDArray[np.float64]

NOMINAL = np.array([[0.0, 0], [120, 0], [120, 80], [0, 80]])
ACTUAL = np.array([[0.13, -0.04], [120.09, 0.11], [119.86, 80.15], [-0.05, 79.92]])
HOLES = range(1, 5)


def pattern(criterion: str, laws: list[str]) -> str:
    """A gauge with the nominal pattern on a plate whose holes lie off by laws, x then y of each."""
    features = "".join(f"      h{k}: {point((*at, 0.0))}\n" for k, at in zip(HOLES, NOMINAL, strict=True))
    axes = "      x: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [1, 0, 0], length: 10 mm}\n"
    off = "".join(
        f"  off {k}{axis}: {{kind: plus_minus, of: plate.h{k}, along: {along}, distribution: {laws[2 * k - 2 + i]}}}\n"
        for k in HOLES
        for i, (axis, along) in enumerate((("x", [1, 0, 0]), ("y", [0, 1, 0])))
    )
    residuals = "".join(f"  r{k}: {{kind: distance, from: plate.h{k}, to: gauge.h{k}}}\n" for k in HOLES)
    parts = "".join(
        f"  r{k}{axis}: {{kind: gap, from: plate.h{k}, to: gauge.h{k}, along: {along}}}\n"
        for k in HOLES
        for axis, along in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
    )
    pairs = ", ".join(f"{{from: gauge.h{k}, to: plate.h{k}}}" for k in HOLES)
    return f"""
scene: a gauge on a hole pattern
parts:
  plate:
    kind: solid
    features:
{features}{axes}
  gauge:
    kind: solid
    features:
{features}{axes}
tolerances:
{off}
moves:
  machine: {{kind: fix, part: plate}}
  fit: {{kind: best_fit, part: gauge, criterion: {criterion}, pairs: [{pairs}]}}
measures:
  turn: {{kind: angle, from: plate.x, to: gauge.x, about: [0, 0, 1]}}
{residuals}{parts}
"""


def of_actual(criterion: str, folder: Path) -> Assembled:
    return assembled(pattern(criterion, [constant(float(own)) for own in (ACTUAL - NOMINAL).ravel()]), folder)


def residuals_of(pose: Array) -> Array:
    """Lengths (4,) for a turn [rad] and a shift [mm]."""
    turn, shift = pose[0], pose[1:]
    matrix = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    return np.asarray(np.linalg.norm(NOMINAL @ matrix.T + shift - ACTUAL, axis=1))


def test_least_squares(tmp_path: Path) -> None:
    off, own = NOMINAL - NOMINAL.mean(axis=0), ACTUAL - ACTUAL.mean(axis=0)
    turn = math.atan2((off[:, 0] * own[:, 1] - off[:, 1] * own[:, 0]).sum(), (off * own).sum())
    assert 1e3 * turn == pytest.approx(1.8853201467, abs=1e-9)
    matrix = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    shift = ACTUAL.mean(axis=0) - matrix @ NOMINAL.mean(axis=0)
    residuals = residuals_of(np.array([turn, *shift]))
    assert residuals == pytest.approx((0.0604552, 0.0388619, 0.0720071, 0.0178979), abs=5e-8)
    found = of_actual("squares", tmp_path).drawn(1)
    assert found["turn"][0] == pytest.approx(turn, abs=1e-12)
    assert [found[f"r{k}"][0] for k in HOLES] == pytest.approx(residuals, abs=1e-9)


def test_least_largest_residual(tmp_path: Path) -> None:
    start = minimize(lambda q: residuals_of(q).max(), [0.002, 0.08, -0.08], method="Nelder-Mead",
                     options={"xatol": 1e-12, "fatol": 1e-14, "maxiter": 4000}).x  # fmt: skip
    assert residuals_of(start).max() == pytest.approx(0.0604992, abs=1e-6)
    found = of_actual("minimax", tmp_path).drawn(1)
    residuals = np.array([found[f"r{k}"][0] for k in HOLES])
    assert residuals.max() <= residuals_of(start).max() + 1e-8
    assert residuals.max() == pytest.approx(0.0604992, abs=5e-8)
    assert 1e3 * found["turn"][0] == pytest.approx(2.0386, abs=1e-3)
    # the optimum: weights of the largest ones, at least 0, with which their slopes vanish
    touching = residuals > residuals.max() - 1e-7
    assert touching.tolist() == [True, True, True, False]
    off = np.array([[found[f"r{k}x"][0], found[f"r{k}y"][0]] for k in HOLES]) / residuals[:, None]
    arms = ACTUAL + off * residuals[:, None]  # where the gauge's holes are
    slopes = np.hstack([off, (off[:, 1] * arms[:, 0] - off[:, 0] * arms[:, 1])[:, None] / 100])[touching]
    _, unbalanced = nnls(np.vstack([slopes.T, np.ones(3)]), np.array([0.0, 0, 0, 1]))
    assert unbalanced < 1e-6


def test_statistics_of_residuals(tmp_path: Path) -> None:
    sigma, count = 0.05, 40_000
    found = assembled(pattern("squares", [normal(sigma)] * 8), tmp_path).drawn(count)
    squares = sum(found[f"r{k}"] ** 2 for k in HOLES)
    freedoms = 2 * 4 - 3
    mean, spread = sigma**2 * freedoms, sigma**2 * math.sqrt(2 * freedoms)
    assert np.mean(squares) == pytest.approx(mean, abs=4 * spread / math.sqrt(count))
    share = 0.05
    assert np.mean(squares > 0.0276762) == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / count))
    radii = ((NOMINAL - NOMINAL.mean(axis=0)) ** 2).sum()
    turn = sigma / math.sqrt(radii)
    assert 1e3 * turn == pytest.approx(0.346688, abs=1e-6)
    assert found["turn"].std() == pytest.approx(turn, rel=4 / math.sqrt(2 * count))
