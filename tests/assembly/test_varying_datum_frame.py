"""Problem 15: a hole's position in the datum frame of the same trial, whose datums deviate themselves."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly.datum_plate import SIGMAS, covariance, plate
from assembly_trials import assembled, constant, normal
from scipy.integrate import dblquad

from tol3d.errors import SceneError


def share_beyond(radius: float) -> float:
    """P(hypot(dx, dy) > radius), of both correlated normals, by quadrature over the disc."""
    precision, scale = np.linalg.inv(covariance()), 2 * math.pi * math.sqrt(np.linalg.det(covariance()))

    def density(angle: float, r: float) -> float:
        v = np.array([r * math.cos(angle), r * math.sin(angle)])
        return float(math.exp(-0.5 * v @ precision @ v) * r / scale)

    inside, _ = dblquad(density, 0.0, radius, 0.0, 2 * math.pi, epsabs=1e-10)
    return float(1 - inside)


def test_each_datum_alone(tmp_path: Path) -> None:
    """Finite turns: by the line through both points, then the tertiary point, in coordinates of that frame."""
    for b1, b2, c in ((0.3, -0.2, 0.0), (0.0, 0.0, 0.25), (0.4, 0.1, -0.3)):
        laws = {"b1": constant(b1), "b2": constant(b2), "c": constant(c), "ex": constant(0.05), "ey": constant(-0.1)}
        found = assembled(plate(laws), tmp_path).drawn(1)["position"][0]
        along = np.array([160.0, b2 - b1]) / math.hypot(160.0, b2 - b1)
        across = np.array([-along[1], along[0]])
        hole = np.array([150.05, 59.9])
        y = (hole - (20.0, b1)) @ across  # over the line through both points, nominally 60
        x = (hole - (c, 50.0)) @ along  # beyond the third point, nominally 150
        assert found == pytest.approx(2 * math.hypot(x - 150, y - 60), abs=1e-9)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_statistics(tmp_path: Path, method: str) -> None:
    count = 200_000
    assert np.sqrt(np.diagonal(covariance())) == pytest.approx((0.0447999, 0.0471782), abs=5e-8)
    share = share_beyond(0.15)
    assert share == pytest.approx(0.0049780, abs=5e-8)
    found = assembled(plate({name: normal(own) for name, own in SIGMAS.items()}), tmp_path).drawn(count, method)
    assert (found["position"] > 0.3).mean() == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / count))
    machine = math.exp(-(0.15**2) / (2 * 0.04**2))
    assert machine == pytest.approx(0.000884, abs=1e-6)
    assert (found["in the machine"] > 0.3).mean() == pytest.approx(machine, abs=4 * math.sqrt(machine / count))
    assert abs((found["position"] > 0.3).mean() - machine) > 10 * math.sqrt(machine / count)


def test_a_datum_that_takes_nothing_is_refused_where_it_stands(tmp_path: Path) -> None:
    text = plate({name: normal(own) for name, own in SIGMAS.items()})
    with pytest.raises(SceneError, match=r"yaml:21: measures\.position\.datums: plate\.floor takes no freedom"):
        assembled(text.replace("datums: [floor, b1-b2, c]", "datums: [floor, floor]"), tmp_path)
