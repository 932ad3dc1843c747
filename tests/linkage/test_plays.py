"""Positions of joints in their plays, against the oracle."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from linkage.linked_bodies import Array, Linkage, study_of
from linkage.mechanisms import ALL
from linkage.plays import with_plays
from linkage.random_loops import open_chain, random_loop
from oracles.closed_loops import closed, displaced, followed

from tol3d.study.system.stated import component_slices

MAKERS: dict[str, Callable[[], Linkage]] = {
    **{name: ALL[name] for name in ("slider crank", "rssr", "swash on swing")},
    "open chain": open_chain,
    "random": lambda: random_loop(3, two=True),
}


@pytest.mark.parametrize("name", MAKERS)
def test_plays_move_bodies_as_the_oracle_moves_them(name: str, tmp_path: Path) -> None:
    """Nominally a joint that lies toward one side already does."""
    linkage, plays = with_plays(MAKERS[name]())
    study = study_of(linkage, tmp_path, [])
    slices = component_slices(study.system)
    rng = np.random.default_rng(8)
    where = list(linkage.poses)[1]
    rows, offsets = [], list[dict[str, Array]]()
    for k in range(3):
        row, found = study.columns({}, {}), {}
        for joint, own in plays.items():
            shares = np.zeros(4 if own.length else 3)
            if own.floating == "random" and k:
                shares = rng.uniform(-0.7, 0.7, len(shares))
                row[slices[f"float of {joint}"]] = shares
            wider = 0.01 * rng.normal() if k else 0.0
            row[slices[f"clearance of {joint}"]] = wider
            found[joint] = own.offset(shares, wider)
        rows.append(row)
        offsets.append(found)
    bases = {joint: linkage.loops.pairs[joint].base for joint in plays}
    loops = [displaced(linkage.loops, {j: (bases[j] @ off, None) for j, off in found.items()}) for found in offsets]
    # inputs count from where parts are placed, plays or not
    start = followed(linkage.loops, linkage.loops, linkage.poses[where])
    assert start is not None
    expected = []
    for each in loops:
        poses = closed(linkage.loops, each, start, linkage.poses[where])
        assert poses is not None
        expected.append(linkage.seen(poses))
    assert np.abs(study.seen(np.stack(rows), where) - np.stack(expected)).max() < 1e-9
