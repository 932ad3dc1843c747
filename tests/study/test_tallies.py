"""Tallies of blocks add up to what numpy counts in all of the columns, wherever the extremes lie."""

from itertools import pairwise

import numpy as np
import pytest
from gear_trials import drawn_trials, gear_columns, simulated

from tol3d.gearing.model import Model
from tol3d.study.system.outcome import Columns
from tol3d.study.tallies.tally import Tally, grids_of

NAME = "normal backlash"
CUTS = (0, 150, 400, 450, 600)  # where blocks begin, and their end
DEEPEST, LARGEST = -900.0, 700.0  # um; far beyond all other trials


def columns_of(model: Model, deepest_at: int, largest_at: int) -> dict[str, np.ndarray]:
    """The stack-up's columns of 600 trials, and made-up ones of a geometric method of which a part is jammed."""
    columns = dict(gear_columns(model, None, drawn_trials(model, 1, 0, CUTS[-1])))
    rng = np.random.default_rng(1)
    columns["status"] = rng.choice(["ok", "interferes", "no contact"], CUTS[-1], p=[0.7, 0.2, 0.1])
    columns["status"][[deepest_at, largest_at]] = "interferes", "ok"
    for measure in model.measures:
        own = columns[f"analytic:{measure.name}"] + rng.normal(0.0, 0.1, CUTS[-1])
        own[deepest_at], own[largest_at] = DEEPEST, own[largest_at] + LARGEST
        jammed = columns["status"] == "interferes"
        own[jammed] = -np.abs(own[jammed])
        own[columns["status"] == "no contact"] = np.nan
        columns[f"geometric:{measure.name}"] = own
        columns[f"status:{measure.name}"] = columns["status"]
    return columns


@pytest.mark.parametrize(("deepest_at", "largest_at"), [(3, 599), (599, 3), (420, 410)])
def test_blocks_add_up_to_what_is_counted_in_all_columns(paper_model: Model, deepest_at: int, largest_at: int) -> None:
    model = simulated(paper_model, engine="fcl")  # whose sums are numpy's
    columns = columns_of(paper_model, deepest_at, largest_at)

    def block(first: int, end: int) -> Columns:
        return {name: column[first:end] for name, column in columns.items()}

    grids = grids_of(model.system, block(0, CUTS[1]))
    blocks = [Tally.of(model, grids, block(a, b), a) for a, b in pairwise(CUTS)]
    whole = blocks[0].merge(blocks[1]).merge(blocks[2]).merge(blocks[3])

    seated = columns["status"] == "ok"
    difference = columns[f"geometric:{NAME}"] - columns[f"analytic:{NAME}"]
    counts = {name: np.count_nonzero(columns["status"] == name) for name in ("ok", "interferes", "no contact")}
    own = whole.measures[NAME]
    assert whole.trials == len(seated) == sum(counts.values())
    for status in (whole.status, own.status):
        assert {name: count for name, count in status.items() if count} == counts
    assert own.geometric is not None
    assert own.disagreement is not None
    assert own.agreement is not None
    assert own.geometric.deepest == DEEPEST
    assert own.geometric.moments.count == counts["ok"] == own.agreement.count
    assert own.geometric.moments.maximum == columns[f"geometric:{NAME}"][seated].max()
    assert own.analytic.moments.minimum == columns[f"analytic:{NAME}"].min()
    assert own.disagreement.trial == largest_at
    assert own.disagreement.largest == own.agreement.max_abs == np.abs(difference[seated]).max()
    assert own.disagreement.largest == pytest.approx(LARGEST, abs=1.0)  # ten sigma of what is added to each
