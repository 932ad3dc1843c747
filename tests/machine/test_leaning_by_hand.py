"""Mean loss by leaning shafts, by characteristic functions: exact, without draws and without the program.

Both flank sides lose half a face times |a ± b|, where a and b are what the slope of one shaft against the other takes
in the plane of the axes and across it. Each a ± b is a sum of independent vectors seen along one direction: see
mean_lean.py.
"""

import math

import numpy as np
import pytest
from machine.box_by_hand import ALPHA, ALUMINIUM, COS, FIRST, SECOND, SIN, STEEL, Box, Stage, apart
from machine.mean_lean import mean_size
from numpy.typing import NDArray
from places import SCENES

from tol3d.simulate import Overrides, load, simulation_of

Array = NDArray[np.float64]
Disc = tuple[Array, float]
"""Effect on the slope (2, 2), and radius [mm] of a disc."""

SCENE = SCENES / "gearbox_in_housing.yaml"
BOX = Box.read(SCENE)


def diameter(tolerance: str) -> float:
    return float(BOX.said["tolerances"][tolerance]["zone"]["diameter"].split()[0]) * 1e-3


def by_datums(stage: Stage) -> list[Disc]:
    """Ends of the second dowel's hole, of both dowels: they turn the cover on the housing about the first dowel.

    Its hole is 14 mm deep, its dowel is seen 6 mm above the rim: 13 mm over the middle of the hole.
    """
    along, way = apart(BOX, stage)
    across = np.array([-way[1], way[0]]) * along / 224.0
    turn = np.outer(across, [0.0, 1.0])  # of y of dowel 2
    hole, seat = diameter("dowel hole 2 position") / 2, diameter("dowel 1 seat") / 2
    lever = 13.0 / 14.0
    found = [(turn * lever, hole), (-turn * lever, hole)]
    return found + [(sign * turn / 2, seat) for sign in (1.0, 1.0, -1.0, -1.0)]


def by_bores(stage: Stage) -> list[Disc]:
    """Both ends of the bores in housing and cover, each with half of what it lies off."""
    names = [f"{part}{shaft} bore position" for shaft in stage.shafts for part in ("", "cover ")]
    return [(np.eye(2) / 2, diameter(name) / 2) for name in names for _ in range(2)]


def bearings(stage: Stage) -> list[tuple[float, float]]:
    return [BOX.limits(f"{far}{shaft} bearing clearance") for shaft in stage.shafts for far in ("", "far ")]


def taken(stage: Stage) -> float:
    """Mean normal backlash of a stage lost by leaning [mm]."""
    _, way = apart(BOX, stage)
    across = np.array([-way[1], way[0]])
    face = min(BOX.gear(name).face for name in (stage.driver, stage.driven))
    total = 0.0
    for sign in (1.0, -1.0):
        seen = (SIN * way + sign * COS * across) / 68.0  # from bore to bore
        discs = [(float(np.linalg.norm(own.T @ seen)), radius) for own, radius in by_datums(stage) + by_bores(stage)]
        size = float(np.linalg.norm(seen)) / 2
        total += mean_size(discs, [(size, low, high) for low, high in bearings(stage)])
    return face / 2 * total


@pytest.mark.parametrize(
    ("stage", "expected"), [(FIRST, 1.55724), pytest.param(SECOND, 2.35746, marks=pytest.mark.slow)]
)
def test_the_closed_form_has_the_exact_mean_within_a_thousandth_of_sigma(stage: Stage, expected: float) -> None:
    lost = 1000 * taken(stage)
    assert lost == pytest.approx(expected, abs=1e-4)
    distance, _ = apart(BOX, stage)
    thick = sum(sum(BOX.limits(f"{gear} tooth thickness")) / 2 for gear in (stage.driver, stage.driven))
    straight = 1000 * (2 * math.sin(ALPHA) * distance * (ALUMINIUM * 15 - STEEL * 25) - COS * thick)
    system = simulation_of(load(SCENE), Overrides()).system
    measure = next(own for own in system.measures if own.name == f"{stage.name.split()[0]} normal backlash")
    form = system.closed_form(measure)
    assert form is not None
    assert 1000 * form.mean == pytest.approx(straight - lost, abs=1e-3 * 1000 * form.sigma)
