"""Problem 12: a door on two hinges and a striker; gap and flush by the coefficients of its contacts."""

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from places import SCENES
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation
from scipy.stats import norm

from tol3d.simulate import Overrides, load, simulation_of

Array = NDArray[np.float64]

UPPER, LOWER, STRIKER = np.array([0.0, 0, 700]), np.array([0.0, 0, 300]), np.array([950.0, 0, 500])
POINTS = np.array([UPPER, UPPER, UPPER, LOWER, LOWER, STRIKER])
NORMALS = np.eye(3)[[0, 1, 2, 0, 1, 1]]
CONTACTS = ("secondary 1", "primary 1", "tertiary 1", "secondary 2", "primary 2", "primary 3")
SIGMAS = np.array([0.25, 0.20, 0.30, 0.25, 0.20, 0.15])  # of both parts together
EDGES = {"upper": np.array([1000.0, 0, 800]), "lower": np.array([1000.0, 0, 200]), "roof": np.array([600.0, 0, 1000])}
BODY = np.array([0.30, 0.25, 0.30])
ONE_SHOT = np.array([4.0, -3.0, 2.0, -5.0, 2.5, 6.0])


def coefficients(at: Array) -> Array:
    """Displacement of a point of the door by each contact (3, 6), by hand: shift and turn that meet all six."""
    rows = np.hstack([NORMALS, np.cross(POINTS, NORMALS)])
    twists = np.linalg.inv(rows)
    return np.asarray(twists[:3] + np.cross(twists[3:].T, at).T)


def expected() -> Mapping[str, tuple[Array, float]]:
    """Coefficients of the contacts for each measure, and variance of the body's own edges."""
    rows = {name: coefficients(at) for name, at in EDGES.items()}
    found = {
        "upper gap": (-rows["upper"][0], BODY[0] ** 2),
        "lower gap": (-rows["lower"][0], BODY[0] ** 2),
        "roof gap": (-rows["roof"][2], BODY[2] ** 2),
        "upper flush": (rows["upper"][1], BODY[1] ** 2),
        "lower flush": (rows["lower"][1], BODY[1] ** 2),
    }
    for name, kind in (("taper", "gap"), ("flush taper", "flush")):
        upper, lower = found[f"upper {kind}"], found[f"lower {kind}"]
        found[name] = (upper[0] - lower[0], upper[1] + lower[1])
    return found


def sigma(name: str) -> float:
    row, own = expected()[name]
    return float(np.sqrt(row**2 @ SIGMAS**2 + own))


@pytest.fixture(scope="module")
def door() -> Assembled:
    return Assembled(simulation_of(load(SCENES / "door.yaml"), Overrides()))


def test_the_coefficients_that_are_printed() -> None:
    upper, lower, roof = (coefficients(at) for at in EDGES.values())
    assert upper[0] == pytest.approx((1.25, 0, 0, -0.25, 0, 0))
    assert lower[0] == pytest.approx((-0.25, 0, 0, 1.25, 0, 0))
    assert upper[1] == pytest.approx((0, 0.723684211, 0, 0, -0.776315789, 1.052631579))
    assert lower[1] == pytest.approx((0, -0.776315789, 0, 0, 0.723684211, 1.052631579))
    assert roof[2] == pytest.approx((-1.5, 0, 1, 1.5, 0, 0))
    printed = {"upper gap": 0.437679, "upper flush": 0.363986, "roof gap": 0.679154, "flush taper": 0.552268}
    assert {name: sigma(name) for name in printed} == pytest.approx(printed, abs=5e-7)
    assert 2 * norm.cdf(-1 / sigma("taper")) == pytest.approx(0.140907, abs=1e-6)


def test_closed_forms(door: Assembled) -> None:
    for measure in door.system.measures:
        form = door.system.closed_form(measure)
        assert form is not None
        assert form.sigma == pytest.approx(sigma(measure.name), rel=1e-9)
        assert form.mean == pytest.approx(0.0 if "flush" in measure.name or measure.name == "taper" else 4.0, abs=1e-9)
    acting = {measure.name: {own.name for own in door.system.acting(measure)} for measure in door.system.measures}
    hinges = {f"{part} {hinge} hinge x" for part in ("body", "door") for hinge in ("upper", "lower")}
    assert acting["upper gap"] == hinges | {"upper edge x"}


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_samples(door: Assembled, method: str) -> None:
    count = 200_000
    found = door.drawn(count, method)
    for name, values in found.items():
        assert values.std() == pytest.approx(sigma(name), rel=4 / math.sqrt(2 * count))
    share = 2 * norm.cdf(-1 / sigma("taper"))
    assert (np.abs(found["taper"]) > 1).mean() == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / count))
    alone = math.hypot(sigma("upper gap"), sigma("lower gap"))
    assert abs(found["taper"].std() - alone) > 10 * alone / math.sqrt(2 * count)  # they share the hinges


def test_one_shot(tmp_path: Path) -> None:
    text = (SCENES / "door.yaml").read_text("utf-8")
    head, tail = text[: text.index("\ntolerances:")], text[text.index("\nmoves:") :]
    off = "".join(
        f"  off {k}: {{kind: locator, of: hanging, pair: {pair}, distribution: {{kind: constant, value: {d} mm}}}}\n"
        for k, (pair, d) in enumerate(zip(CONTACTS, ONE_SHOT.tolist(), strict=True))
    )
    found = assembled(f"{head}\ntolerances:\n{off}{tail}", tmp_path).drawn(1)

    def gaps(q: Array) -> Array:
        turn = Rotation.from_rotvec(q[:3]).as_matrix()
        return np.asarray((NORMALS * (POINTS @ turn.T + q[3:] - POINTS)).sum(axis=1) - ONE_SHOT)

    pose = least_squares(gaps, np.zeros(6), xtol=1e-15, ftol=1e-15, gtol=1e-15, x_scale=[1e-2] * 3 + [1.0] * 3).x
    turn = Rotation.from_rotvec(pose[:3]).as_matrix()
    moved = {name: turn @ at + pose[3:] - at for name, at in EDGES.items()}
    assert moved["upper"] == pytest.approx((5.977190705, 2.203947368, -20.445965681), abs=1e-8)
    assert moved["roof"] == pytest.approx((10.586314423, -3.177631579, -11.551031418), abs=1e-8)
    assert found["upper gap"][0] == pytest.approx(4 - moved["upper"][0], abs=1e-9)
    assert found["lower gap"][0] == pytest.approx(4 - moved["lower"][0], abs=1e-9)
    assert found["roof gap"][0] == pytest.approx(4 - moved["roof"][2], abs=1e-9)
    assert found["upper flush"][0] == pytest.approx(moved["upper"][1], abs=1e-9)
    assert found["lower flush"][0] == pytest.approx(moved["lower"][1], abs=1e-9)
