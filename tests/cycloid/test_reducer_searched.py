"""The shipped reducer, from its scene to its columns, against a search that has the drawn deviations alone."""

import math
import re
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from oracles.searched_reducer import output_turn
from places import SCENES

from tol3d import Overrides, run_scene

ARC_MINUTE = math.pi / 10_800


@pytest.mark.slow
def test_transmission_error_and_lost_motion_are_those_of_a_search(tmp_path: Path) -> None:
    """Discs to 1e-9 mm; planets to first order: of 10 um over 40 mm the square is 1e-3 arc seconds at the planet."""
    run_scene(SCENES / "rv_250aii.yaml", out=tmp_path / "run", overrides=Overrides(trials=6))
    (block,) = sorted((tmp_path / "run" / "trials").glob("*.parquet"))
    table = pq.read_table(block).to_pydict()
    for trial in range(6):
        position = math.radians(table["position:reducer [deg]"][trial])

        def of(name: str, trial: int = trial) -> float:
            return float(table[f"{name} [um]"][trial]) * 1e-3

        back, disc, pin = output_turn(of, position, -1)
        forth, _, _ = output_turn(of, position, 1)
        assert table["geometric:transmission error"][trial] * ARC_MINUTE == pytest.approx(back, abs=5e-9)
        assert table["geometric:lost motion"][trial] * ARC_MINUTE == pytest.approx(forth - back, abs=1e-8)
        assert (table["transmission error: disc"][trial], table["transmission error: pin"][trial]) == (disc, pin)


@pytest.mark.slow
def test_over_a_turn_the_pins_of_the_highest_and_the_lowest_position_are_columns(tmp_path: Path) -> None:
    positions, scene = 24, tmp_path / "scene.yaml"
    text = (SCENES / "rv_250aii.yaml").read_text("utf-8")
    scene.write_text(re.sub(r"positions: \d+", f"positions: {positions}", text), "utf-8")
    run_scene(scene, out=tmp_path / "run", overrides=Overrides(trials=2))
    (block,) = sorted((tmp_path / "run" / "trials").glob("*.parquet"))
    table = pq.read_table(block).to_pydict()
    for trial in range(2):

        def of(name: str, trial: int = trial) -> float:
            return float(table[f"{name} [um]"][trial]) * 1e-3

        curve = [output_turn(of, 2 * math.pi * k / positions, -1) for k in range(positions)]
        (high, *highest), (low, *lowest) = max(curve), min(curve)
        assert table["geometric:over a turn"][trial] * ARC_MINUTE == pytest.approx(high - low, abs=1e-8)
        for where, touching in (("highest", highest), ("lowest", lowest)):
            assert [table[f"over a turn: {own} at {where}"][trial] for own in ("disc", "pin")] == touching
