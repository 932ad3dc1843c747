"""Parts on a part that rocks: welded parts, parts that rest on parts, measures before and after."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from assembly.placing.built_by_numbers import Columns, assembly, feature, frame, pair, part
from numpy.typing import NDArray

from tol3d.assembly.grammar.measures.gap import DistanceSpec, GapSpec
from tol3d.assembly.model import Assembly, Fix, Measured, Move, Point, Rest, Weld
from tol3d.assembly.model.measures import Rocking
from tol3d.assembly.model.statuses import NOT_UNIQUE, OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.placing.placer import Fixing
from tol3d.assembly.placing.rest_move import Resting
from tol3d.assembly.torsors import method as torsors

Array = NDArray[np.float64]

Z = np.eye(3)[2]
SQUARE = np.array([[-100.0, -60.0, 0.0], [100.0, -60.0, 0.0], [100.0, 60.0, 0.0], [-100.0, 60.0, 0.0]])
SMALL = 0.4 * SQUARE + np.array([20.0, 10.0, 0.0])
ORIGIN = np.zeros(3)


def stacked(rocking: Rocking | None, *, welded: bool = False) -> Assembly:
    """A plate on four pads, a block on four points of the plate; both with their weight in the middle.

    Columns: heights of the pads, then of the points. Or the block is welded to the plate before both are laid down.
    """
    columns = Columns()
    base = [feature(f"base.{k}", Point(), frame(at), [columns(Z[:, None])]) for k, at in enumerate(SQUARE)]
    top = [feature(f"plate.top {k}", Point(), frame(at), [columns(Z[:, None])]) for k, at in enumerate(SMALL)]
    base += [feature("base.seen", Point(), frame((60.0, 25.0, 0.0)))]
    plate = [feature(f"plate.{k}", Point(), frame(at)) for k, at in enumerate(SQUARE)] + top
    block = [feature(f"block.{k}", Point(), frame(at)) for k, at in enumerate(SMALL)]
    block += [feature("block.seen", Point(), frame((60.0, 25.0, 0.0)))]
    block += [feature("block.middle", Point(), frame((20.0, 10.0, 0.0)))]
    on_pads = tuple(pair(f"plate.{k}", f"base.{k}", Z) for k in range(4))
    on_plate = tuple(pair(f"block.{k}", f"plate.top {k}", Z) for k in range(4))
    laid = Rest("laid", "plate", on_pads, -Z, ORIGIN)
    put = Rest("put", "block", on_plate, -Z, np.array([20.0, 10.0, 0.0]))
    moves: Sequence[Move] = [Fix("base put", "base"), laid, put]
    if welded:
        moves = [Fix("base put", "base"), Fix("block put", "block"), Weld("one", "plate", ("block",)), laid]
        moves = [moves[0], Fix("plate put", "plate"), *moves[1:]]
    measures = {
        "seen": Measured(GapSpec.reads, ("base.seen", "block.seen"), Z, rocking=rocking),
        "over the plate": Measured(GapSpec.reads, ("plate.top 0", "block.middle"), Z, rocking=rocking),
        "before": Measured(GapSpec.reads, ("base.seen", "plate.top 0"), Z, after=len(moves) - (1 if welded else 2)),
    }
    parts = [part("base", base), part("plate", plate), part("block", block)]
    return assembly(columns, parts, moves, measures)


def heights_over(places: Array, heights: Array, at: Array) -> Array:
    """Least and largest height (2,) at a place of planes over four pads of a rectangle, as low in its middle as can be.

    Two pads across carry; the plane tips about their line until it lies on a third one.
    """
    ends = []
    across = (0, 2) if heights[0] + heights[2] > heights[1] + heights[3] else (1, 3)
    for third in set(range(4)) - set(across):
        own = [*across, third]
        plane = np.linalg.solve(np.column_stack([np.ones(3), places[own, :2]]), heights[own])
        ends.append(plane @ [1.0, *at])
    return np.sort(ends)


def test_a_block_on_a_plate_that_rocks_rocks_by_both() -> None:
    """Small displacements: the point's height is that over the plate, and the plate's there."""
    trials = np.random.default_rng(8).normal(0, 0.03, (60, 8))
    at = np.array([60.0, 25.0])
    plate = np.array([heights_over(SQUARE, row[:4], at) for row in trials])
    own = np.array([heights_over(SMALL, row[4:], at) for row in trials])
    expected: dict[Rocking, Array] = {
        "least": plate[:, 0] + own[:, 0],
        "largest": plate[:, 1] + own[:, 1],
        "middle": (plate + own).mean(axis=1),
    }
    for rocking, values in expected.items():
        model = stacked(rocking)
        found, codes = placing.values(model, trials, ["seen"])["seen"]
        assert (codes == OK).all()
        assert np.abs(found - values).max() < 2e-4  # tilts of 3e-3, squared, over 60 mm
        assert np.abs(torsors.values(model, trials, ["seen"])["seen"] - values).max() < 1e-12
    found, codes = placing.values(stacked(None), trials, ["seen"])["seen"]
    assert (codes == NOT_UNIQUE).all()


def test_what_does_not_see_the_rocking_has_its_value() -> None:
    """The block's middle over the plate: 0.5 (h1 + h3) or 0.5 (h2 + h4) of its points, however the plate lies."""
    trials = np.random.default_rng(9).normal(0, 0.03, (60, 8))
    found, codes = placing.values(stacked(None), trials, ["over the plate"])["over the plate"]
    middle = np.maximum(trials[:, 4] + trials[:, 6], trials[:, 5] + trials[:, 7]) / 2
    assert (codes == OK).all()
    assert np.abs(found - (middle - trials[:, 4])).max() < 1e-4
    assert (placing.values(stacked(None), trials, ["before"])["before"][1] == NOT_UNIQUE).all()


@pytest.mark.parametrize("rocking", ["least", "largest"])
def test_a_welded_block_rocks_with_its_plate(rocking: Rocking) -> None:
    trials = np.random.default_rng(10).normal(0, 0.05, (40, 8))
    model = stacked(rocking, welded=True)
    ends = np.array([heights_over(SQUARE, row[:4], np.array([60.0, 25.0])) for row in trials])
    values = ends[:, 0 if rocking == "least" else 1]
    assert np.abs(placing.values(model, trials, ["seen"])["seen"][0] - values).max() < 2e-4
    assert np.abs(torsors.values(model, trials, ["seen"])["seen"] - values).max() < 1e-12
    assert (placing.values(stacked(None, welded=True), trials, ["seen"])["seen"][1] == NOT_UNIQUE).all()
    alone, codes = placing.values(model, trials, ["over the plate"])["over the plate"]
    assert (codes == OK).all()
    assert alone == pytest.approx(-trials[:, 4], abs=1e-4)


@pytest.mark.parametrize("rocking", ["least", "largest"])
def test_of_a_distance_the_ends_of_the_rocking_are_read(rocking: Rocking) -> None:
    """Nominally 0, so that it is no linear measure: its amount at both ends."""
    trials = np.random.default_rng(12).normal(0, 0.05, (60, 8))
    welded = stacked(rocking, welded=True)
    model = replace(
        welded, measures={"seen": replace(welded.measures["seen"], reads=DistanceSpec.reads, direction=None)}
    )
    ends = np.abs([heights_over(SQUARE, row[:4], np.array([60.0, 25.0])) for row in trials])
    values = ends.min(axis=1) if rocking == "least" else ends.max(axis=1)
    found, codes = placing.values(model, trials, ["seen"])["seen"]
    assert (codes == OK).all()
    assert np.abs(found - values).max() < 5e-4
    assert np.abs(torsors.values(model, trials, ["seen"])["seen"] - values).max() < 1e-12


def test_the_ends_of_a_rocking_are_placed_from_the_first_rest_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three moves for all measures, then for each end the two rests; each trial as if it were by itself."""
    model, trials = stacked("least"), np.random.default_rng(8).normal(0, 0.03, (20, 8))
    one_by_one = [placing.values(model, row[None], ["seen"])["seen"][0][0] for row in trials]
    laid = []

    def counted(placed: Any) -> Any:
        def told(own: Any, world: Any) -> Any:
            laid.append(own)
            return placed(own, world)

        return told

    for kind in (Fixing, Resting):
        monkeypatch.setattr(kind, "placed", counted(kind.placed))
    found, codes = placing.values(model, trials, ["seen"])["seen"]
    assert np.array_equal(found, one_by_one)
    assert not codes.any()
    assert len(laid) == 3 + 2 * 2
