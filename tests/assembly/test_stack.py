"""Problem 1: four blocks in a cavity, all uniform. The gap is a sum of five uniforms, of Irwin and Hall."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled, uniform

BLOCKS, HEIGHT, HALF, GAP = 4, 10.0, 0.1, 0.3
TRIALS = 400_000


def irwin_hall(x: float, n: int) -> float:
    """P(sum of n uniforms in (0, 1) < x)."""
    terms = ((-1) ** k * math.comb(n, k) * (x - k) ** n for k in range(int(x) + 1))
    return math.fsum(terms) / math.factorial(n)


def stack() -> str:
    """Blocks on each other, each mated to the one below."""
    ceiling = BLOCKS * HEIGHT + GAP
    alike = "".join(f"  block {k}: {{kind: solid, like: block 1}}\n" for k in range(2, BLOCKS + 1))
    below = ["cavity.floor", *(f"block {k}.top" for k in range(1, BLOCKS))]
    laid = "".join(
        f"  lay {k}: {{kind: mate, part: block {k}, "
        f"relations: [{{kind: coincident, from: block {k}.bottom, to: {target}}}]}}\n"
        for k, target in enumerate(below, 1)
    )
    return f"""
scene: blocks in a cavity
parts:
  cavity:
    kind: solid
    features:
      floor: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [20 mm, 20 mm]}}
      ceiling: {{kind: plane, at: [0 mm, 0 mm, {ceiling} mm], normal: [0, 0, -1], extent: [20 mm, 20 mm]}}
  block 1:
    kind: solid
    features:
      bottom: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [20 mm, 20 mm]}}
      top: {{kind: plane, at: [0 mm, 0 mm, {HEIGHT} mm], normal: [0, 0, 1], extent: [20 mm, 20 mm]}}
{alike}
tolerances:
  height: {{kind: plus_minus, of: block 1.top, distribution: {uniform(HALF)}}}
  depth: {{kind: plus_minus, of: cavity.ceiling, distribution: {uniform(HALF)}}}
moves:
  machine: {{kind: fix, part: cavity}}
{laid}
measures:
  gap: {{kind: gap, from: block {BLOCKS}.top, to: cavity.ceiling, along: [0, 0, 1], lower_limit: 0 mm}}
"""


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_blocks_that_are_uniform_leave_the_gap_of_irwin_and_hall(tmp_path: Path, method: str) -> None:
    made = assembled(stack(), tmp_path)
    assert made.nominal["gap"] == pytest.approx(GAP, abs=1e-12)
    gap = made.drawn(TRIALS, method)["gap"]
    count = BLOCKS + 1
    assert irwin_hall(1.0, count) == pytest.approx(1 / 120)
    for limit in (0.0, 0.05):
        expected = irwin_hall((limit - GAP + count * HALF) / (2 * HALF), count)
        error = math.sqrt(expected * (1 - expected) / TRIALS)
        assert (gap < limit).mean() == pytest.approx(expected, abs=4 * error)
    sigma = 2 * HALF * math.sqrt(count / 12)
    assert gap.std() == pytest.approx(sigma, abs=4 * sigma / math.sqrt(2 * TRIALS))
    assert gap.mean() == pytest.approx(GAP, abs=4 * sigma / math.sqrt(TRIALS))
    assert gap.min() >= GAP - count * HALF - 1e-12


def test_each_block_has_a_height_of_its_own(tmp_path: Path) -> None:
    system = assembled(stack(), tmp_path).system
    names = [own.name for own in system.contributors]
    assert names == ["height", "height of block 2", "height of block 3", "height of block 4", "depth"]
    (measure,) = system.measures
    form = system.closed_form(measure)
    assert form is not None
    assert [share.coefficient for share in form.shares] == pytest.approx([-1, -1, -1, -1, -1])  # both remove room
    assert np.array([share.variance for share in form.shares]) == pytest.approx((2 * HALF) ** 2 / 12)
