"""Problem 7: a plate on four pads by its weight, its numbers by quadrature and by hand."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from places import SCENES
from scipy.integrate import quad
from scipy.stats import norm

from tol3d.assembly.model.statuses import NOT_UNIQUE, OK
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Codes = NDArray[np.int8]

PADS = np.array([[-100.0, -60.0], [100.0, -60.0], [100.0, 60.0], [-100.0, 60.0]])
SIGMA = 0.05
COUNT = 40_000
TEXT = (SCENES / "four_pads.yaml").read_text("utf-8")
MEASURES = "".join(
    f"  over {k}{asked}: {{kind: point_plane, from: plate.above {k}, to: table.pad {k}{rocking}}}\n"
    for k in (1, 2, 3, 4)
    for asked, rocking in (("", ""), *((f" {own}", f", rocking: {own}") for own in ("least", "middle", "largest")))
)
MEASURES += """  height: {kind: gap, from: table.ground, to: plate.weight, along: [0, 0, 1]}
  slope x: {kind: angle, from: table.ground, to: plate.top, about: [0, -1, 0]}
  slope y: {kind: angle, from: table.ground, to: plate.top, about: [1, 0, 0]}
  flatness: {kind: inspected_flatness, points: [table.pad 1, table.pad 2, table.pad 3, table.pad 4], normal: [0, 0, 1]}
"""


def plate(folder: Path, x: float, y: float, laws: str = "normal, mean: 0 mm, sigma: 0.05 mm") -> Assembled:
    """The shipped scene with the centre of gravity elsewhere, and a law of its own of each height."""
    points = "".join(
        f"      above {k}: {{kind: point, at: [{a} mm, {b} mm, 0 mm]}}\n" for k, (a, b) in enumerate(PADS, 1)
    )
    points += f"      weight: {{kind: point, at: [{x} mm, {y} mm, 0 mm]}}\n"
    text = TEXT[: TEXT.index("measures:\n")] + "measures:\n" + MEASURES + "study: {trials: 100, seed: 7}\n"
    text = text.replace("      above pad 1: {kind: point, at: [-100 mm, -60 mm, 0 mm]}\n", points)
    text = text.replace("at: [0 mm, 0 mm, 5 mm]   ", f"at: [{x} mm, {y} mm, 0 mm]   ")
    for k, law in enumerate(laws.split(";") if ";" in laws else [laws] * 4, 1):
        old = f"of: table.pad {k}, distribution: {{kind: normal, lower: -0.15 mm, upper: 0.15 mm}}"
        assert old in text
        text = text.replace(old, f"of: table.pad {k}, distribution: {{kind: {law}}}")
    return assembled(text, folder)


def found(own: Assembled, count: int = COUNT) -> tuple[dict[str, Array], dict[str, Array], dict[str, Codes], Array]:
    """Values of the exact and of the analytic method, codes, and heights of the pads (count, 4)."""
    trials = drawn(own.simulation, 0, count)
    asked = (own.system.method(name, None) for name in ("exact", "analytic"))
    exact, linear = (method.answers(trials, own.system.measures) for method in asked)
    return (
        {name: values[:, 0] for name, values in exact.values.items()},
        {name: values[:, 0] for name, values in linear.values.items()},
        dict(exact.status),
        trials.deviations,
    )


def is_mean(values: Array, mean: float) -> None:
    assert abs(values.mean() - mean) < 4 * values.std() / math.sqrt(len(values))


def is_sigma(values: Array, sigma: float) -> None:
    off = values - values.mean()
    error = math.sqrt((np.mean(off**4) - np.var(values) ** 2) / len(values)) / (2 * sigma)
    assert abs(values.std() - sigma) < 4 * error


def is_share(events: Mask, share: float) -> None:
    assert abs(events.mean() - share) < 4 * math.sqrt(share * (1 - share) / len(events))


def test_with_the_weight_in_the_middle_the_height_is_unique_and_the_tilt_is_not(tmp_path: Path) -> None:
    """z = max((h1 + h3) / 2, (h2 + h4) / 2), two independent normals of s / sqrt 2; two pads carry."""
    exact, linear, codes, h = found(plate(tmp_path, 0.0, 0.0))
    middle = np.maximum((h[:, 0] + h[:, 2]) / 2, (h[:, 1] + h[:, 3]) / 2)
    for method in (exact, linear):
        assert np.abs(method["height"] - middle).max() < 2e-6
    own = SIGMA / math.sqrt(2)

    def density(z: float) -> float:
        return float(2 * norm.pdf(z / own) / own * norm.cdf(z / own))

    mean = quad(lambda z: z * density(z), -1, 1)[0]
    variance = quad(lambda z: (z - mean) ** 2 * density(z), -1, 1)[0]
    assert (mean, math.sqrt(variance)) == pytest.approx((0.0199471, 0.0291910), abs=1e-7)  # the problem's
    is_mean(exact["height"], mean)
    is_sigma(exact["height"], math.sqrt(variance))
    assert (codes["height"] == OK).all()
    for name in ("slope x", "slope y", "over 1"):
        assert (codes[name] == NOT_UNIQUE).mean() > (0.99 if name.startswith("slope") else 0.45)
        assert np.isnan(exact[name][codes[name] != OK]).all()


@pytest.mark.slow
def test_rocking_asks_for_either_end_or_the_middle_of_both(tmp_path: Path) -> None:
    """One of the two pads that do not carry has all of the gap |D|, or the other one, or each a half."""
    exact, linear, codes, h = found(plate(tmp_path, 0.0, 0.0))
    d = h @ (1, -1, 1, -1)
    for method in (exact, linear):
        for k in range(4):
            gap = np.where((d > 0) == (k % 2 == 1), np.abs(d), 0.0)
            for asked, expected in (("least", 0 * gap), ("middle", gap / 2), ("largest", gap)):
                assert np.abs(method[f"over {k + 1} {asked}"] - expected).max() < 5e-6
    left = exact["over 1 largest"] + exact["over 2 largest"]
    is_mean(left, 2 * SIGMA * math.sqrt(2 / math.pi))
    is_share(left > 0.2, 2 * norm.cdf(-2))
    is_mean(exact["flatness"], SIGMA * math.sqrt(2 / math.pi))
    is_share(exact["flatness"] > 0.1, 2 * norm.cdf(-2))
    assert all((codes[f"over {k} {asked}"] == OK).all() for k in (1, 2, 3, 4) for asked in ("least", "largest"))


def test_with_the_weight_aside_three_pads_carry_and_all_is_unique(tmp_path: Path) -> None:
    """At (30, 12): pads 2 and 3 carry always, 1 or 4 with even odds."""
    x, y = 30.0, 12.0
    exact, linear, codes, h = found(plate(tmp_path, x, y))
    assert all((own == OK).all() for own in codes.values())
    heights, slopes_x, slopes_y, carry = of_three(h, np.array([x, y]))
    assert carry[:, [1, 2]].all()
    assert not (carry[:, 0] & carry[:, 3]).any()
    is_share(carry[:, 0], 0.5)
    for method in (exact, linear):
        assert np.abs(method["height"] - heights).max() < 1e-5
        assert np.abs(method["slope x"] - slopes_x).max() < 1e-7
        assert np.abs(method["slope y"] - slopes_y).max() < 1e-7
    for k in range(4):
        assert np.abs(exact[f"over {k + 1}"][carry[:, k]]).max() < 1e-5  # its point is aside of the pad by the tilt
    mean_d = 2 * SIGMA * math.sqrt(2 / math.pi)
    is_mean(exact["height"], 0.35 * mean_d / 2)
    is_sigma(exact["height"], math.sqrt(_variance_of_height(x, y)))
    is_sigma(exact["slope y"], math.sqrt(2) * SIGMA / 120)
    is_mean(exact["slope x"], -mean_d / 400)
    is_mean(exact["over 1"] + exact["over 4"], mean_d)
    is_share(exact["over 1"] + exact["over 4"] > 0.2, 2 * norm.cdf(-2))


def of_three(h: Array, at: Array) -> tuple[Array, Array, Array, Mask]:
    """Height there, slopes (trials,), and which pads carry (trials, 4): pads 1, 2, 3 or 2, 3, 4, which one is above."""
    found = []
    for chosen in ([0, 1, 2], [1, 2, 3]):
        rows = np.linalg.inv(np.column_stack([np.ones(3), PADS[chosen]]))
        planes = h[:, chosen] @ rows.T
        above = np.asarray(planes[:, :1] + planes[:, 1:] @ PADS.T - h)
        carry = np.zeros(h.shape, dtype=bool)
        carry[:, chosen] = np.all(above > -1e-12, axis=1, keepdims=True)
        found.append((planes, carry))
    first = np.asarray(found[0][1]).any(axis=1, keepdims=True)
    plane = np.where(first, found[0][0], found[1][0])
    return plane[:, 0] + plane[:, 1:] @ at, plane[:, 1], plane[:, 2], np.where(first, found[0][1], found[1][1])


def _variance_of_height(x: float, y: float) -> float:
    """By quadrature over D and the best fit of the height, which is normal apart from D."""
    signs = np.array([1.0, -1.0, 1.0, -1.0])
    planes = np.linalg.pinv(np.column_stack([np.ones(4), PADS]))
    smooth = float(np.square(np.array([1.0, x, y]) @ planes).sum()) * SIGMA**2
    own = 2 * SIGMA

    def rest(d: float) -> float:
        """Height over the fitted plane where pads rest on what D leaves of them."""
        return float(of_three((signs * d / 4)[None], np.array([x, y]))[0][0])

    def weight(d: float) -> float:
        return float(norm.pdf(d / own) / own)

    mean = quad(lambda d: rest(d) * weight(d), -0.8, 0.8, points=[0.0])[0]
    return float(smooth + quad(lambda d: (rest(d) - mean) ** 2 * weight(d), -0.8, 0.8, points=[0.0])[0])


def test_the_problem_s_sigma_of_the_height_at_the_weight() -> None:
    assert math.sqrt(_variance_of_height(30.0, 12.0)) == pytest.approx(0.0290265, abs=1e-7)


def test_the_column_of_carrying_contacts_says_which(tmp_path: Path) -> None:
    own = plate(tmp_path, 0.0, -20.0, ";".join(f"constant, value: {h} mm" for h in (0.10, -0.04, 0.06, 0.02)))
    trials = drawn(own.simulation, 0, 3)
    answers = own.system.method("exact", None).answers(trials, own.system.measures)
    assert answers.details["carries:plate on the pads"].tolist() == ["1 2 3"] * 3
    value = {name: own[0, 0] for name, own in answers.values.items()}
    assert value["height"] == pytest.approx(0.19 / 3, abs=1e-6)
    assert value["over 4"] == pytest.approx(0.18, abs=1e-5)
    assert (value["slope x"], value["slope y"]) == pytest.approx((-0.0007, 0.05 / 60), abs=1e-8)
