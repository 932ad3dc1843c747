"""A block that is made in pieces, so that its progress is told, has the bits of one that is made at once."""

import math
from pathlib import Path

import numpy as np
import pytest

from tol3d import Overrides, run_scene
from tol3d.simulate import Watch
from tol3d.study.execution import folding
from tol3d.study.execution.pace import Pace
from tol3d.study.results.task import TOGETHER, Task
from tol3d.study.runs.run import Run

PIECE = 70  # trials; not a multiple of those that stand together


class _Fixed(Pace):
    """Pieces that stay as they are."""

    def took(self, builds: int, seconds: float) -> None:
        """See Pace."""


def run_of(name: str, trials: int, piece: int, place: Path, patch: pytest.MonkeyPatch) -> tuple[Run, list[int]]:
    """A run whose blocks are made in pieces, and what it told of its progress."""
    told = list[int]()
    patch.setattr(folding, "TOLD_EVERY", -1.0)
    patch.setattr(Task, "pace", property(lambda task: _Fixed(piece), lambda task, value: None), raising=False)
    run = run_scene(name, overrides=Overrides(trials=trials, witness=0), out=place, watch=Watch(progress=told.append))
    return run, told


@pytest.mark.parametrize(
    ("name", "trials"),
    [
        ("spur_pair", 333),
        ("door", 333),
        *(pytest.param(*own, marks=pytest.mark.slow) for own in (("rv_250aii", 333), ("robot_arm", 150))),
    ],
)
def test_a_block_in_pieces_has_the_same_bits_and_tells_of_each(
    name: str, trials: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, once = run_of(name, trials, 10**6, tmp_path / "whole", monkeypatch)
    pieces, told = run_of(name, trials, PIECE, tmp_path / "pieces", monkeypatch)
    assert (sum(once), sum(told)) == (trials, trials)
    assert [own for own in told if own] == [TOGETHER] * (trials // TOGETHER) + [trials % TOGETHER]
    assert len(told) >= math.ceil(trials / TOGETHER)
    one, other = whole.columns(), pieces.columns()
    assert one.keys() == other.keys()
    for column, values in one.items():
        assert np.array_equal(values, other[column], equal_nan=values.dtype.kind == "f"), column
    assert whole.summary["measures"] == pieces.summary["measures"]
