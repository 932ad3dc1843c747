"""Range of one coordinate between straight and round gaps: a second-order cone programme per trial, compiled.

The first unknown of y is the coordinate, the last a widening of all gaps, at a price. Found is the balance of forces of
weight / gap for a weight that is next to nothing. Newton's method leads gaps and forces to it together: a step without
weight tells how far their products may shrink, and what a step makes of itself. Sources: S. Mehrotra, On the
Implementation of a Primal-Dual Interior Point Method, SIAM J. Optim. 2 (1992) 575; S. Boyd, L. Vandenberghe, Convex
Optimization, Cambridge 2004, chapter 11. A trial's result does not depend on the others.
"""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import fill

Array = NDArray[np.float64]

PRICE: Final = 1000.0  # of widening all gaps, per length of the coordinate; forces should add up to far less
SHARE: Final = 1e-8  # mm; weight of each logarithm in the end
BEGUN: Final = 0.1  # mm; the same to begin with
NEARLY: Final = 2.0  # times SHARE; from there on the weight is the last one
THERE: Final = 1e-4  # Newton decrement at which forces are those of the last weight
BALANCED: Final = 1e-3  # of SHARE, by which forces times gaps are off it then
INSIDE: Final = 0.9  # of the way to where the first gap closes, or the first force ends
PATIENT: Final = 40  # steps, of which some 15 are needed, before it begins again
CAREFUL: Final = 0.5  # of that way then, for forces ran away
WIDER: Final = 0.01  # mm, to begin with, than the deepest overlap
MOST_STEPS: Final = 150


@dataclass(frozen=True)
class ConeProgramme:
    """Gaps of trials (trials, ...) by unknowns; lengths in mm.

    Args:
        rows: slopes of straight gaps (trials, rows, unknowns).
        gaps: their sizes where y = 0 (trials, rows).
        planes: slopes of displacements in round gaps (trials, cones, 2, unknowns).
        off: displacements where y = 0 (trials, cones, 2).
        radii: (trials, cones), above 0.
    """

    rows: Array
    gaps: Array
    planes: Array
    off: Array
    radii: Array


@dataclass(frozen=True)
class Solved:
    """The farthest points, and forces per unit of the coordinate.

    Attributes:
        y: unknowns (trials, unknowns); NaN, as all of a trial, where no balance is found.
        gaps: straight ones there (trials, rows).
        straight: forces of straight gaps (trials, rows).
        round: forces of round gaps, along their displacements (trials, cones, 2).
    """

    y: Array
    gaps: Array
    straight: Array
    round: Array


def solve_cone_programme(given: ConeProgramme, sense: float) -> Solved:
    """Make the first coordinate as large as gaps let it (1), or as small (-1)."""
    (trials, count, unknowns), cones = given.rows.shape, given.radii.shape[1]
    number = count + cones + 1
    found = Solved(
        *(np.empty(size) for size in ((trials, unknowns), (trials, count), (trials, count), given.off.shape))
    )
    cone_programmes(
        *map(np.ascontiguousarray, (given.rows, given.gaps, given.planes, given.off, given.radii)),
        float(sense),
        found.y,
        found.gaps,
        found.straight,
        found.round,
        *(np.empty(size, np.int64) for size in (number, (number, unknowns))),
        *(np.empty(size) for size in ((number, unknowns), (cones, 2, unknowns), number, (cones, 2))),
        *(np.empty(size) for size in (number, unknowns, unknowns, number, number, number)),
        *(np.empty(size) for size in (number, (unknowns, unknowns))),
    )
    return found


@nested
def supported(slopes: Any, places: Any, values: Any) -> int:
    """Write the columns of slopes (some, unknowns) that are not all 0, and the last one; their number."""
    found, unknowns = 0, slopes.shape[1]
    for j in range(unknowns):
        here = j == unknowns - 1
        for k in range(slopes.shape[0]):
            here = here or slopes[k, j] != 0.0
        if here:
            places[found] = j
            for k in range(slopes.shape[0]):
                values[k, found] = slopes[k, j]
            found += 1
    return found


@nested
def left_at(given: Any, y: Any, left: Any) -> None:
    """Write the gaps at y, slopes of round ones, and displacements in these; the last gap is the widening.

    A round gap is radius^2 - displacement^2.
    """
    gaps, off, radii, sizes, places, planes = given
    slack, sloped, moved = left
    count, last = gaps.shape[0], y[y.shape[0] - 1]
    for r in range(count):
        slack[r] = gaps[r]
        for k in range(sizes[r]):
            slack[r] += sloped[r, k] * y[places[r, k]]
    for c in range(radii.shape[0]):
        r = count + c
        for axis in range(2):
            moved[c, axis] = off[c, axis]
            for k in range(sizes[r]):
                moved[c, axis] += planes[c, axis, k] * y[places[r, k]]
        reach = radii[c] + last
        slack[r] = reach * reach - (moved[c, 0] * moved[c, 0] + moved[c, 1] * moved[c, 1])
        for k in range(sizes[r]):
            sloped[r, k] = -2.0 * (moved[c, 0] * planes[c, 0, k] + moved[c, 1] * planes[c, 1, k])
        sloped[r, sizes[r] - 1] += 2.0 * reach
    slack[slack.shape[0] - 1] = last


@nested
def squared(size: int, places: Any, slope: Any, scale: float, bent: Any) -> None:
    """Add a slope times itself to the lower half of a matrix."""
    for k in range(size):
        scaled = scale * slope[k]
        for other in range(k + 1):
            bent[places[k], places[other]] += scaled * slope[other]


@nested
def factored(given: Any, left: Any, forces: Any, bent: Any) -> None:
    """Write Cholesky's factor of the bend of gaps under forces, and 1 over its diagonal.

    A pivot that rounding took is left out: nothing moves along it.
    """
    _, _, _, sizes, places, planes = given
    slack, sloped, _ = left
    unknowns, cones = bent.shape[0], planes.shape[0]
    for i in range(unknowns):
        fill(bent[i], 0.0)
    for r in range(slack.shape[0]):
        squared(sizes[r], places[r], sloped[r], forces[r] / slack[r], bent)
    for c in range(cones):
        r = slack.shape[0] - 1 - cones + c
        for axis in range(2):
            squared(sizes[r], places[r], planes[c, axis], 2.0 * forces[r], bent)
        bent[unknowns - 1, unknowns - 1] -= 2.0 * forces[r]
    for j in range(unknowns):
        total = bent[j, j]
        for k in range(j):
            total -= bent[j, k] * bent[j, k]
        bent[j, j] = 1.0 / np.sqrt(total) if total > 0.0 else 0.0
        for i in range(j + 1, unknowns):
            value = bent[i, j]
            for k in range(j):
                value -= bent[i, k] * bent[j, k]
            bent[i, j] = value * bent[j, j]


@nested
def stepped(sense: float, weight: float, given: Any, left: Any, forces: Any, bent: Any, moves: Any) -> float:
    """Write the step to where force times gap is a weight, less what a step makes of itself; how far down it leads.

    Args:
        given, left, forces, bent: see left_at and factored.
        moves: what force times gap becomes more by a step (gaps,); written are the slope of the objective and the step
            (unknowns,), the change of gaps, also with the square of the step, and of forces (gaps,).
    """
    _, _, _, sizes, places, planes = given
    slack, sloped, _ = left
    more, slope, step, opened, bowed, loaded = moves
    unknowns, cones = step.shape[0], planes.shape[0]
    fill(slope, 0.0)
    slope[0], slope[unknowns - 1] = -sense, PRICE
    for r in range(slack.shape[0]):
        share = (more[r] - weight) / slack[r]
        for k in range(sizes[r]):
            slope[places[r, k]] += share * sloped[r, k]
    for i in range(unknowns):
        total = -slope[i]
        for k in range(i):
            total -= bent[i, k] * step[k]
        step[i] = total * bent[i, i]
    down = 0.0
    for i in range(unknowns - 1, -1, -1):
        total = step[i]
        for k in range(i + 1, unknowns):
            total -= bent[k, i] * step[k]
        step[i] = total * bent[i, i]
        down -= slope[i] * step[i]
    for r in range(slack.shape[0]):
        opened[r], bowed[r] = 0.0, 0.0
        for k in range(sizes[r]):
            opened[r] += sloped[r, k] * step[places[r, k]]
        loaded[r] = (weight - more[r] - forces[r] * opened[r]) / slack[r] - forces[r]
        c = r - (slack.shape[0] - 1 - cones)
        if 0 <= c < cones:
            bowed[r] = step[unknowns - 1] * step[unknowns - 1]
            for axis in range(2):
                by = 0.0
                for k in range(sizes[r]):
                    by += planes[c, axis, k] * step[places[r, k]]
                bowed[r] -= by * by
    return down


@nested
def lengths(slack: Any, forces: Any, moves: Any) -> tuple[float, float]:
    """Largest fractions of a step that leave gaps open, and forces."""
    _, _, _, opened, bowed, loaded = moves
    open_, held = np.inf, np.inf
    for r in range(slack.shape[0]):
        if loaded[r] < 0.0:
            held = min(held, -forces[r] / loaded[r])
        root = opened[r] * opened[r] - 4.0 * bowed[r] * slack[r]
        if root >= 0.0 and np.sqrt(root) > opened[r]:
            open_ = min(open_, 2.0 * slack[r] / (np.sqrt(root) - opened[r]))
    return open_, held


@nested
def led(sense: float, given: Any, y: Any, left: Any, forces: Any, bent: Any, moves: Any) -> None:
    """Move y, from where all gaps are open, to the balance of the last weight; NaN if it is not found."""
    slack, _, _ = left
    more, _, step, opened, bowed, loaded = moves
    gaps, unknowns = slack.shape[0], y.shape[0]
    done, wider = False, y[unknowns - 1]
    for passed in range(MOST_STEPS + 1):
        if passed in (PATIENT, MOST_STEPS):
            fill(y, 0.0 if passed == PATIENT else np.nan)
            y[unknowns - 1] += wider
        left_at(given, y, left)
        if done or passed == MOST_STEPS:
            break
        weight, unlike = 0.0, 0.0
        for r in range(gaps):
            if passed in (0, PATIENT):
                forces[r] = BEGUN / slack[r] if r < gaps - 1 else PRICE
            weight += slack[r] * forces[r] / gaps
            unlike = max(unlike, abs(slack[r] * forces[r] - SHARE))
        factored(given, left, forces, bent)
        fill(more, 0.0)
        last = weight <= NEARLY * SHARE
        target, down, open_, held = SHARE if last else 0.0, 0.0, 1.0, 1.0
        for corrected in range(1 if last else 2):
            if corrected:  # by what a step without weight would leave, and what it makes of itself
                ahead = 0.0
                for r in range(gaps):
                    reached = slack[r] + open_ * (opened[r] + open_ * bowed[r])
                    ahead += reached * (forces[r] + held * loaded[r]) / gaps
                    more[r] = opened[r] * loaded[r] + forces[r] * bowed[r]
                target = max(min((ahead / weight) ** 3, 1.0) * weight, SHARE)
            down = stepped(sense, target, given, left, forces, bent, moves)
            open_, held = lengths(slack, forces, moves)
            share = 1.0 if not (corrected or last) else INSIDE if passed < PATIENT else CAREFUL
            open_, held = min(1.0, share * open_), min(1.0, share * held)
        for r in range(gaps):
            forces[r] += held * loaded[r]
        for j in range(unknowns):
            y[j] += open_ * step[j]
        done = target == SHARE and unlike < BALANCED * SHARE and down < THERE * THERE * SHARE


@kernel(
    arrays="f8[:,:,::1], f8[:,::1], f8[:,:,:,::1], f8[:,:,::1], f8[:,::1], f8, f8[:,::1], f8[:,::1], f8[:,::1], "
    "f8[:,:,::1], i8[::1], i8[:,::1], f8[:,::1], f8[:,:,::1], f8[::1], f8[:,::1], f8[::1], f8[::1], f8[::1], f8[::1], "
    "f8[::1], f8[::1], f8[::1], f8[:,::1]"
)
def cone_programmes(
    rows: Any, gaps: Any, planes: Any, off: Any, radii: Any, sense: float,
    y: Any, closed: Any, straight: Any, turned: Any,
    sizes: Any, places: Any, sloped: Any, flat: Any, slack: Any, moved: Any,
    more: Any, slope: Any, step: Any, opened: Any, bowed: Any, loaded: Any, forces: Any, bent: Any,
) -> None:  # fmt: skip
    """The programmes of trials, one by one; for the arguments see ConeProgramme, and Solved for what is written.

    Args:
        sizes, places, sloped: of slopes of all gaps that are not 0, their number, columns and values; to write in.
        flat, slack, moved, more, slope, step, opened, bowed, loaded, forces, bent: see left_at, factored, stepped.
    """
    count, cones, unknowns = gaps.shape[1], radii.shape[1], rows.shape[2]
    number = count + cones + 1
    left, moves = (slack, sloped, moved), (more, slope, step, opened, bowed, loaded)
    sizes[number - 1], places[number - 1, 0], sloped[number - 1, 0] = 1, unknowns - 1, 1.0
    for i in range(gaps.shape[0]):
        deepest = 0.0
        for r in range(count):
            sizes[r] = supported(rows[i, r : r + 1], places[r], sloped[r : r + 1])
            sloped[r, sizes[r] - 1] += 1.0
            deepest = max(deepest, -gaps[i, r])
        for c in range(cones):
            sizes[count + c] = supported(planes[i, c], places[count + c], flat[c])
            x, z = off[i, c, 0], off[i, c, 1]
            deepest = max(deepest, np.sqrt(x * x + z * z) - radii[i, c])
        fill(y[i], 0.0)
        y[i, unknowns - 1] = 2.0 * deepest + WIDER
        led(sense, (gaps[i], off[i], radii[i], sizes, places, flat), y[i], left, forces, bent, moves)
        for r in range(count):
            closed[i, r], straight[i, r] = slack[r], SHARE / slack[r]
        for c in range(cones):
            for axis in range(2):
                turned[i, c, axis] = 2.0 * SHARE / slack[count + c] * moved[c, axis]
