"""A stack of blocks in a cavity, and a door on its hinges: closed forms, and single builds."""

from collections.abc import Mapping

import numpy as np
import pytest
from assembly.placing.built_by_numbers import Columns, assembly, feature, frame, pair, part, posed
from numpy.typing import NDArray

from tol3d.assembly.grammar.measures.gap import GapSpec
from tol3d.assembly.model import Assembly, Fix, Locate, Mate, Measured, Move, Plane, Point, Relation
from tol3d.assembly.placing.method import placed, values

Array = NDArray[np.float64]

FACE = Plane((40.0, 40.0))
X, Y, Z = np.eye(3)


def stack() -> Assembly:
    """Four blocks of 10 in a cavity of 40.3, one on the other; the gap above the last."""
    columns = Columns()
    height = np.array([[1.0], [0.0], [0.0]])
    cavity = [feature("cavity.floor", FACE, frame((0, 0, 0))), feature("cavity.lid", FACE, frame((0, 0, 40.3), -Z))]
    cavity[1] = feature("cavity.lid", FACE, cavity[1].frame, [columns(-height)])
    parts, moves = [part("cavity", cavity)], list[Move]([Fix("cavity", "cavity")])
    below = "cavity.floor"
    for k in range(4):
        faces = [
            feature(f"block {k}.under", FACE, frame((0, 0, 0), -Z)),
            feature(f"block {k}.top", FACE, frame((0, 0, 10)), [columns(height)]),
        ]
        parts.append(part(f"block {k}", faces, pose=posed((0, 0, 0), (0, 0, 10.0 * k))))
        moves.append(Mate(f"lay {k}", f"block {k}", (Relation("coincident", f"block {k}.under", below),)))
        below = f"block {k}.top"
    return assembly(columns, parts, moves, {"gap": Measured(GapSpec.reads, (below, "cavity.lid"), Z)})


def test_a_stack_closes_as_often_as_irwin_and_hall_say() -> None:
    """Five uniform parts: P(gap < 0) = 1 / 5!, P(gap < 0.05) as digested; each +-0.1 about a gap of 0.3."""
    n = 200_000
    gap, codes = values(stack(), np.random.default_rng(0).uniform(-0.1, 0.1, (n, 5)), ["gap"])["gap"]
    assert not codes.any()
    assert gap.mean() == pytest.approx(0.3, abs=4 * 0.1291 / np.sqrt(n))
    assert gap.std() == pytest.approx(
        0.2 * np.sqrt(5 / 12), rel=4 * np.sqrt((2.76 - 1) / 4 / n)
    )  # kurtosis 3 - 1.2 / 5
    for limit, share in ((0.0, 1 / 120), (0.05, 0.02539063)):
        assert np.mean(gap < limit) == pytest.approx(share, abs=4 * np.sqrt(share / n))


def test_a_stack_adds_up() -> None:
    gap, _ = values(stack(), np.array([[0.1, -0.1, -0.1, -0.1, -0.1], [-0.1, 0.1, 0.1, 0.1, 0.1]]), ["gap"])["gap"]
    np.testing.assert_allclose(gap, [0.8, -0.2], atol=2e-14)


CONSTRAINED: tuple[tuple[tuple[float, float, float], Array], ...] = (
    ((0, 0, 700), X),
    ((0, 0, 700), Y),
    ((0, 0, 700), Z),
    ((0, 0, 300), X),
    ((0, 0, 300), Y),
    ((950, 0, 500), Y),
)
"""Two hinges and a striker, and what each holds."""

EDGE: Mapping[str, tuple[float, float, float]] = {"R1": (1000, 0, 800), "R2": (1000, 0, 200), "T": (600, 0, 1000)}


def door() -> Assembly:
    """A door on a body whose hinges and edge deviate; gaps, flush, and how they taper along the edge."""
    columns = Columns()
    body, leaf, pairs = [], [], []
    for k, (at, normal) in enumerate(CONSTRAINED):
        body.append(feature(f"body.{k}", Point(), frame(at), [columns(normal[:, None])]))
        leaf.append(feature(f"door.{k}", Point(), frame(at)))
        pairs.append(pair(f"door.{k}", f"body.{k}", normal))
    for name, at in EDGE.items():
        body.append(feature(f"body.{name}", Point(), frame(at), [columns(count=3)]))
        leaf.append(feature(f"door.{name}", Point(), frame(at)))
    gaps = {
        f"{name} {axis}": Measured(GapSpec.reads, (f"body.{name}", f"door.{name}"), along)
        for name in EDGE
        for axis, along in zip("xyz", (X, Y, Z), strict=True)
    }
    tapers = {
        f"taper {axis}": Measured(GapSpec.reads, ("body.R1", "door.R1"), along, minus=gaps[f"R2 {axis}"])
        for axis, along in (("x", X), ("y", Y))
    }
    moves: list[Move] = [Fix("body", "body"), Locate("hang", "door", tuple(pairs))]
    return assembly(columns, [part("body", body), part("door", leaf)], moves, {**gaps, **tapers})


def test_one_door() -> None:
    row = np.zeros((1, 15))
    row[0, :6] = (4, -3, 2, -5, 2.5, 6)
    pose = placed(door(), row)["door"][0]
    expected = {
        "R1": (5.977190705, 2.203947368, -20.445965681),
        "R2": (-7.522809295, 10.453947368, -20.237335659),
        "T": (10.586314423, -3.177631579, -11.551031418),
    }
    for name, at in EDGE.items():
        # half of the last digit that is printed
        np.testing.assert_allclose(pose[:3, :3] @ at + pose[:3, 3] - at, expected[name], atol=6e-10)


def test_gap_flush_and_taper_of_doors() -> None:
    """Taper is less than two gaps together: they share their hinges."""
    n = 100_000
    sigma = np.array([0.25, 0.20, 0.30, 0.25, 0.20, 0.15, *((0.30, 0.25, 0.30) * 3)])
    rows = np.random.default_rng(1).normal(0, 1, (n, 15)) * sigma
    expected = {
        "R1 x": 0.437679,
        "R2 x": 0.437679,
        "R1 y": 0.363986,
        "R2 y": 0.363986,
        "T z": 0.679154,
        "taper x": 0.679154,
        "taper y": 0.552268,
    }
    made = door()
    found = values(made, rows, list(expected))
    for name, each in expected.items():
        # second order, 1 mm over 400 mm, is far below four standard errors
        assert found[name][0].std() == pytest.approx(each, rel=4 / np.sqrt(2 * n))
    assert np.mean(np.abs(found["taper x"][0]) > 1.0) == pytest.approx(0.140907, abs=4 * np.sqrt(0.14 * 0.86 / n))


def test_coefficients_of_a_door() -> None:
    by_hand = {
        "R1 x": (1.25, 0, 0, -0.25, 0, 0),
        "R2 x": (-0.25, 0, 0, 1.25, 0, 0),
        "R1 y": (0, 0.723684211, 0, 0, -0.776315789, 1.052631579),
        "R2 y": (0, -0.776315789, 0, 0, 0.723684211, 1.052631579),
        "T z": (-1.5, 0, 1, 1.5, 0, 0),
    }
    rows = 1e-4 * np.eye(6, 15)
    made = door()
    up, down = (values(made, each, list(by_hand)) for each in (rows, -rows))
    for name, expected in by_hand.items():
        slope = (up[name][0] - down[name][0]) / 2e-4
        np.testing.assert_allclose(slope, expected, atol=1e-9)  # printed to half of 1e-9; differences err by 1e-10
