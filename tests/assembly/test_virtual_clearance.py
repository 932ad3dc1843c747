"""Virtual clearance: the largest straight bolt through several holes (problem 14)."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled, normal, point
from numpy.typing import NDArray
from scene_texts import refusal
from scipy import integrate
from scipy.optimize import minimize
from scipy.stats import halfnorm, norm, rayleigh

from tol3d.assembly.placing.method import features_placed
from tol3d.assembly.torsors.gauged_positions import CommonOpening
from tol3d.contact.certify import certificate
from tol3d.contact.openings import opening
from tol3d.simulate import Overrides, run_scene
from tol3d.study.system.stated import stated
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

SIZE, CENTRE, LIMIT = 0.02, 0.05, 8.2
COUNT = 200_000
FOUR = np.array([(0.06, -0.03, 8.40), (-0.05, 0.04, 8.44), (0.01, 0.09, 8.37), (0.0, -0.06, 8.52)])
HOLE = "{{kind: cylinder, at: [0 mm, 0 mm, {z} mm], axis: [0, 0, 1], length: 10 mm, diameter: 8.4 mm, hole: true}}"


def sheets(holes: int) -> str:
    """Sheets on each other, each with a hole whose centre and size deviate."""
    parts, tolerances, moves = "", "", ""
    for k in range(holes):
        parts += f"  s{k}:\n    kind: solid\n    features:\n      hole: {HOLE.format(z=20 * k)}\n"
        tolerances += f"  s{k} size: {{kind: size, of: s{k}.hole, distribution: {normal(SIZE)}}}\n"
        for axis, along in (("x", "[1, 0, 0]"), ("y", "[0, 1, 0]")):
            own = f"{{kind: plus_minus, of: s{k}.hole, along: {along}, distribution: {normal(CENTRE)}}}"
            tolerances += f"  s{k} {axis}: {own}\n"
        moves += f"  lay s{k}: {{kind: fix, part: s{k}}}\n"
    named = ", ".join(f"s{k}.hole" for k in range(holes))
    measure = f"  bolt: {{kind: virtual_clearance, holes: [{named}], lower_limit: {LIMIT} mm}}\n"
    return f"scene: sheets\nparts:\n{parts}tolerances:\n{tolerances}moves:\n{moves}measures:\n{measure}"


def of_two() -> tuple[float, float, float]:
    """Mean, sigma, P(V < 8.2) by quadrature: V = m - max(|D1 - D2| / 2, d), m = (D1 + D2) / 2 independent of both."""
    half, far = halfnorm(scale=SIZE / math.sqrt(2)), rayleigh(scale=CENTRE * math.sqrt(2))
    middle = norm(8.4, SIZE / math.sqrt(2))

    def cdf(x: float) -> float:
        return float(half.cdf(x) * far.cdf(x))

    first = integrate.quad(lambda x: 1 - cdf(x), 0, 1, points=[0.05, 0.2])[0]
    second = integrate.quad(lambda x: 2 * x * (1 - cdf(x)), 0, 1, points=[0.05, 0.2])[0]
    below = integrate.quad(lambda m: middle.pdf(m) * (1 - cdf(m - LIMIT)), 8.3, 8.5, epsabs=1e-12)[0]
    return 8.4 - first, math.sqrt(second - first**2 + SIZE**2 / 2), float(below)


def test_the_reference_numbers() -> None:
    """The digest's sigma is 0.04824, by a sample: 3e-4 more than the quadrature."""
    assert of_two() == pytest.approx((8.311230, 0.048226, 0.0209469), abs=1e-6)


def test_two_holes_in_a_run(tmp_path: Path) -> None:
    mean, sigma, below = of_two()
    path = tmp_path / "sheets.yaml"
    path.write_text(sheets(2), "utf-8")
    summary = run_scene(path, overrides=Overrides(trials=COUNT, seed=2), out=tmp_path / "run").summary
    for method in ("geometric", "analytic"):
        found = summary["measures"]["bolt"][method]
        assert found["mean"] == pytest.approx(1e3 * mean, abs=4e3 * sigma / math.sqrt(COUNT))
        assert found["sigma"] == pytest.approx(1e3 * sigma, rel=4 * 1.2 / math.sqrt(2 * COUNT))  # its kurtosis is 3.6
        assert found["out_ppm"] / 1e6 == pytest.approx(below, abs=4 * math.sqrt(below / COUNT))


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_four_holes_of_which_three_decide(tmp_path: Path, method: str) -> None:
    made = assembled(sheets(4), tmp_path)
    row = np.array([[value for x, y, size in FOUR for value in (size - 8.4, x, y)]])
    assert made.values(stated(made.system, row), method)["bolt"] == pytest.approx(8.2550000, abs=1e-9)


def test_the_circle_of_four_holes_lies_where_it_is_known_to() -> None:
    x, y, sizes = FOUR.T[:, :, None]
    assert opening(x, y, sizes / 2).centres[:, 0] == pytest.approx((0.0321154, 0.0369231), abs=1e-7)


# random sets of discs ----------------------------------------------------------------------------------------


def random_discs(count: int, seed: int) -> list[Array]:
    """Sets (3, discs): spread as holes are, far apart, within each other, on a line, and the same ones twice."""
    rng = np.random.default_rng(seed)
    found = []
    for k in range(count):
        size = int(rng.integers(2, 9))
        x, y = rng.normal(0.0, rng.choice([0.001, 0.05, 2.0]), (2, size))
        radii = 4.0 + rng.normal(0.0, rng.choice([0.0, 0.02, 0.5]), size)
        if k % 5 == 0:
            y = 0.5 * x
        if k % 7 == 0 and size > 3:
            x[2], y[2], radii[2] = x[0], y[0], radii[0]
        found.append(np.array([x, y, radii]))
    return found


def by_programme(discs: Array) -> float:
    """The same by a general solver, of the epigraph."""
    x, y, radii = discs
    start = np.array([x.mean(), y.mean(), float(np.max(np.hypot(x - x.mean(), y - y.mean()) - radii))])

    def room(z: Array) -> Array:
        return np.asarray(z[2] + radii - np.hypot(x - z[0], y - z[1]))

    def slope(z: Array) -> Array:
        far = np.maximum(np.hypot(x - z[0], y - z[1]), 1e-12)
        return np.stack([(x - z[0]) / far, (y - z[1]) / far, np.ones_like(far)], axis=1)

    best = math.inf
    for shift in ((0.0, 0.0), (0.03, -0.02), (-0.05, 0.01)):
        begin = start + np.array([*shift, math.hypot(*shift)])
        found = minimize(
            lambda z: z[2], begin, jac=lambda z: np.array([0.0, 0.0, 1.0]), method="SLSQP",
            constraints={"type": "ineq", "fun": room, "jac": slope}, options={"ftol": 1e-14, "maxiter": 500},
        )  # fmt: skip
        best = min(best, float(np.max(np.hypot(x - found.x[0], y - found.x[1]) - radii)))
    return -2.0 * best


def by_methods(discs: Array) -> tuple[float, float]:
    found, (x, y, radii) = opening(*discs[:, :, None]), discs
    off = np.hypot(x - found.centres[0], y - found.centres[1]) - radii
    assert found.outside[0] == pytest.approx(off.max(), abs=1e-12)
    term = CommonOpening(np.zeros((3 * len(x), 1)))
    return -2.0 * float(found.outside[0]), float(term.values(discs.T.reshape(-1, 1))[0, 0])


def assert_alike(sets: list[Array]) -> None:
    for discs in sets:
        exact, analytic = by_methods(discs)
        programme = by_programme(discs)  # a feasible circle, so never larger than the largest
        assert exact == pytest.approx(analytic, abs=1e-10)
        assert programme - 1e-12 <= exact <= programme + 1e-6


def test_random_discs() -> None:
    assert_alike(random_discs(40, 1))


@pytest.mark.slow
def test_three_hundred_random_discs() -> None:
    assert_alike(random_discs(300, 2))


def test_many_more_are_certified() -> None:
    """By weights and pulls as duals: of each circle no other place is better."""
    rng = np.random.default_rng(3)
    for size, spread in ((2, 0.05), (3, 0.05), (4, 0.5), (6, 0.02)):
        x, y = rng.normal(0.0, spread, (2, size, 5_000))
        radii = 4.2 + rng.normal(0.0, 0.02, (size, 5_000))
        found = opening(x, y, radii)
        h, duals, rows = np.zeros((size, 4, 5_000)), np.zeros((size, 4, 5_000)), np.zeros((size, 4, 2, 1))
        h[:, 0], h[:, 1], h[:, 2], rows[:, (1, 2), (0, 1)] = radii, x, y, -1.0
        every = np.arange(5_000)
        for weight, disc, pull in zip(found.weights, found.deciding, found.pulls.transpose(1, 0, 2), strict=True):
            duals[disc, :3, every] += (weight * [np.ones(5_000), *pull]).T
        dims, lifted = np.full(size, 3), np.ones(size, dtype=bool)
        slack, none = -found.outside, np.zeros((2, 1))
        own = certificate(h, rows, dims, lifted, none, found.centres, slack, duals)
        assert own.max() < 1e-11
        beside = certificate(h, rows, dims, lifted, none, found.centres + 1e-6, slack, duals)
        assert np.median(beside.max(axis=0)) > 1e-7


def test_a_trial_s_bits_are_its_own() -> None:
    rng = np.random.default_rng(4)
    rows = [*rng.normal(0.0, 0.05, (2, 5, 300)), 4.2 + rng.normal(0.0, 0.02, (5, 300))]
    together = opening(*rows)
    for k in (0, 17, 299):
        alone = opening(*(own[:, k : k + 1] for own in rows))
        assert alone.outside[0] == together.outside[k]
        np.testing.assert_array_equal(alone.weights[:, 0], together.weights[:, k])


# holes that lean, on parts that turn -------------------------------------------------------------------------

LEANING = f"""
scene: a lid on a box
parts:
  box:
    kind: solid
    features:
      top: {{kind: plane, at: [30 mm, 20 mm, 0 mm], normal: [0, 0, 1], extent: [60 mm, 40 mm]}}
      back: {{kind: plane, at: [30 mm, 0 mm, 5 mm], normal: [0, 1, 0], extent: [60 mm, 10 mm], along: [1, 0, 0]}}
      left: {{kind: plane, at: [0 mm, 20 mm, 5 mm], normal: [1, 0, 0], radius: 4 mm}}
      hole: {{kind: cylinder, at: [40 mm, 10 mm, -10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 9 mm, hole: true}}
  lid:
    kind: solid
    features:
      a: {point((5, 5, 0), (0, 0, -1))}
      b: {point((55, 5, 0), (0, 0, -1))}
      c: {point((30, 35, 0), (0, 0, -1))}
      d: {point((5, 0, 5), (0, -1, 0))}
      e: {point((55, 0, 5), (0, -1, 0))}
      f: {point((0, 20, 5), (-1, 0, 0))}
      hole: {{kind: cylinder, at: [40 mm, 10 mm, 6 mm], axis: [0, 0, 1], length: 12 mm, diameter: 9 mm, hole: true}}
tolerances:
  top: {{kind: profile, of: box.top, zone: {{width: 0.06 mm}}, law: {{kind: uniform}}}}
  back: {{kind: profile, of: box.back, zone: {{width: 0.06 mm}}, law: {{kind: uniform}}}}
  box hole: {{kind: position, of: box.hole, zone: {{diameter: 0.08 mm}}, law: {{kind: uniform}}, datums: [top]}}
  lid hole: {{kind: position, of: lid.hole, zone: {{diameter: 0.08 mm}}, law: {{kind: uniform}}}}
  box size: {{kind: size, of: box.hole, distribution: {normal(0.01)}}}
  lid size: {{kind: size, of: lid.hole, distribution: {normal(0.01)}}}
moves:
  on the table: {{kind: fix, part: box}}
  lid on the box:
    kind: three_two_one
    part: lid
    primary:
      - {{from: lid.a, to: box.top}}
      - {{from: lid.b, to: box.top}}
      - {{from: lid.c, to: box.top}}
    secondary:
      - {{from: lid.d, to: box.back}}
      - {{from: lid.e, to: box.back}}
    tertiary:
      - {{from: lid.f, to: box.left}}
measures:
  bolt: {{kind: virtual_clearance, holes: [lid.hole, box.hole]}}
  bolt square to the top: {{kind: virtual_clearance, holes: [box.hole, lid.hole], datums: [top]}}
  bolt in the box: {{kind: virtual_clearance, holes: [box.hole, lid.hole]}}
"""


def test_holes_that_lean_count_at_both_ends(tmp_path: Path) -> None:
    """From the frames of the holes as they are placed, by another solver; their lengths are cosines longer: 2e-7 mm."""
    made = assembled(LEANING, tmp_path)
    count = 12
    trials = drawn(made.simulation, 0, count)
    found = made.values(trials)
    frames = features_placed(made.system.assembly, trials.deviations)
    sizes = {"box": trials.deviations[:, -2], "lid": trials.deviations[:, -1]}
    part = {"bolt": "lid.a", "bolt square to the top": "box.top", "bolt in the box": "box.left"}
    for k in range(count):
        for name, carrier in part.items():
            turn = frames[carrier][k, :3, :3]
            nominal = made.system.assembly.features[carrier].frame[:3, :3]
            into = turn @ nominal.T  # columns: x, y and z of the carrier's part
            rows = []
            for hole, length in (("box", 20.0), ("lid", 12.0)):
                own = frames[f"{hole}.hole"][k]
                for sign in (-0.5, 0.5):
                    end = own[:3, 3] + sign * length * own[:3, 2]
                    rows.append((*(into[:, :2].T @ end), (9 + sizes[hole][k]) / 2))
            discs = np.array(rows).T
            discs[:2] -= discs[:2].mean(axis=1, keepdims=True)
            assert found[name][k] == pytest.approx(by_programme(discs), abs=2e-6), name


def test_the_methods_differ_by_second_order(tmp_path: Path) -> None:
    made = assembled(LEANING, tmp_path)
    trials = drawn(made.simulation, 0, 2_000)
    far = []
    for share in (1.0, 0.5):
        own = trials.scaled(share)
        exact, linear = made.values(own), made.values(own, "analytic")
        far.append(max(float(np.abs(exact[name] - linear[name]).max()) for name in exact))
    assert far[0] < 1.2e-4  # half the square of 4.4e-3, the largest turn of the hole in the box, over 12 mm
    assert far[1] == pytest.approx(far[0] / 4, rel=0.2)


# what is refused ---------------------------------------------------------------------------------------------

BOTH = "holes: [s0.hole, s1.hole]"
WRONG = {
    "one hole": ("holes: [s0.hole]", "measures.bolt.holes", "expected a list of 2 to 8 holes, got a list of 1"),
    "a hole twice": ("holes: [s0.hole, s0.hole]", "measures.bolt.holes", "expected each hole once, got 's0.hole'"),
    "no hole": (
        "holes: [s0.hole, s1.pin]",
        "measures.bolt.holes[1]",
        "expected a hole, got 's1.pin', which is a pin; a bolt passes through holes",
    ),
    "across": (
        "holes: [s0.hole, s1.side]",
        "measures.bolt.holes[1]",
        "expected a hole along 's0.hole', got 's1.side' at 90 deg to it",
    ),
}


@pytest.mark.parametrize(("named", "place", "said"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_said_once(named: str, place: str, said: str, tmp_path: Path) -> None:
    size = "length: 10 mm, diameter: 8.4 mm"
    others = (
        f"      pin: {{kind: cylinder, at: [9 mm, 0 mm, 0 mm], axis: [0, 0, 1], {size}}}\n"
        f"      side: {{kind: cylinder, at: [0 mm, 0 mm, 0 mm], axis: [1, 0, 0], {size}, hole: true}}\n"
    )
    text = sheets(2).replace(BOTH, named)
    at = text.index("      hole:", text.index("  s1:\n"))
    assert refusal(text[:at] + others + text[at:], tmp_path) == f"{place}: {said}"
