"""Stacks of blocks, each on six points of the one below: slopes and sigmas against small motions added up by hand."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scale import SIGMA, stack
from scene_texts import scene_of

from tol3d import Overrides, run_scene
from tol3d.study.effects.first_order import first_orders
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.trials.overrides import simulation_of

Array = NDArray[np.float64]

LOCATORS = (  # as scale.POINTS: place and normal of the face below, from a block's own height on
    ((10, 10, 0), (0, 0, 1)),
    ((90, 10, 0), (0, 0, 1)),
    ((50, 90, 0), (0, 0, 1)),
    ((10, 0, 5), (0, 1, 0)),
    ((90, 0, 5), (0, 1, 0)),
    ((0, 50, 5), (1, 0, 0)),
)
DIRECTIONS = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
"""Directions of measures 0, 1 and 2."""


def slopes(top: int, reader: int) -> Array:
    """Motion of a corner of block `top` along the direction of a measure by each locator of blocks 1 ... top, (top, 6).

    A point that stands out by d lifts its block: N . (t + r x p) = d, r and t the small motion of the block and of all
    that stands on it, N the normal of the face below at p.
    """
    found = []
    corner = np.array([100.0, 100.0, 10.0 * (top + 1)])
    for k in range(1, top + 1):
        places = np.add([place for place, _ in LOCATORS], [0.0, 0.0, 10.0 * k])
        normals = np.array([normal for _, normal in LOCATORS], dtype=float)
        motions = np.linalg.inv(np.hstack([np.cross(places, normals), normals]))  # r, t of each locator alone
        found.append(DIRECTIONS[reader % 3] @ (np.cross(motions[:3].T, corner) + motions[3:].T).T)
    return np.array(found)


def test_the_corner_of_the_first_block_rises_by_eleven_and_nine_sixteenths_and_nine_eighths() -> None:
    assert slopes(1, 0)[0] == pytest.approx([-11 / 16, 9 / 16, 9 / 8, 0.0, 0.0, 0.0])


def test_both_methods_have_the_slopes_of_every_locator_of_a_stack(tmp_path: Path) -> None:
    simulation = simulation_of(scene_of(stack(6, 3), tmp_path), Overrides())
    found = first_orders(simulation, method_of(simulation, materials_of(simulation)), simulation.system.measures)
    for reader in range(3):
        expected = slopes(5 - reader, reader)
        for method in ("analytic", "geometric"):
            own = {effect.name: effect.slope for effect in found[f"m{reader}"][method].effects}
            for k, row in enumerate(expected, 1):
                mine = [own.get(f"{k} {name}", 0.0) for name in ("A1", "A2", "A3", "B1", "B2", "C1")]
                assert mine == pytest.approx(row.tolist(), abs=2e-6), (reader, method, k)  # per um: third order


@pytest.mark.slow
def test_sigmas_of_a_hundred_blocks_are_those_of_the_chain(tmp_path: Path) -> None:
    path = tmp_path / "stack.yaml"
    path.write_text(stack(100, 3), "utf-8")
    trials = 1000
    run = run_scene(path, overrides=Overrides(trials=trials), out=tmp_path / "run")
    for reader in range(3):
        measure = run.summary["measures"][f"m{reader}"]
        expected = 1000 * SIGMA * np.sqrt((slopes(99 - reader, reader) ** 2).sum())
        assert measure["analytic_closed_form"]["sigma"] == pytest.approx(expected, rel=1e-9)
        assert measure["geometric"]["sigma"] == pytest.approx(expected, rel=5 / np.sqrt(2 * trials))
        known = [own for own in measure["contributors"] if own["geometric_percent"] is not None]
        assert len(known) == len(measure["contributors"]) > 128
