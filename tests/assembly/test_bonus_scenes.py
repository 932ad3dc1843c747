"""Bonus in scenes: zones that sizes widen, processes that they judge, and what a gauge accepts (problem 5a)."""

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled
from fixtures import Command
from numpy.typing import NDArray
from scene_texts import refusal, written
from scipy import integrate
from scipy.stats import norm

from tol3d.assembly.zones import Bonus, SizedBy, Widened, catalogue, uniform_in
from tol3d.assembly.zones.zone_draw import Process
from tol3d.simulate import Execution, Overrides, replay, run_scene
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.normal import Normal
from tol3d.statistics.distributions.uniform import Uniform
from tol3d.study.effects.extremes import ends_together
from tol3d.study.effects.first_order import first_orders
from tol3d.study.runs.run import open_run
from tol3d.study.system.draw import JointDraw, Scalar
from tol3d.study.system.each_planar import EachPlanar
from tol3d.study.system.plain import PlainContributor
from tol3d.study.system.stated import stated

Array = NDArray[np.float64]

T0, SIGMA, LOW, HIGH = 0.14, 0.05, 0.0, 0.2  # mm; sizes from nominal 10 mm
COUNT = 100_000
PLACES = {"one": (0, 0), "two": (60, 0), "three": (60, 40), "four": (0, 40)}

# what a gauge accepts ----------------------------------------------------------------------------------------


def pattern(modifier: str) -> str:
    """Four holes whose centres are off by their process, each inspected to the part's frame."""
    said = f", modifier: {modifier}" if modifier else ""
    normal = f"{{kind: normal, mean: 0 mm, sigma: {SIGMA} mm}}"
    holes, tolerances, measures = "", "", ""
    for name, (x, y) in PLACES.items():
        at = f"at: [{x} mm, {y} mm, 5 mm], axis: [0, 0, 1], length: 10 mm"
        holes += f"      {name}: {{kind: cylinder, {at}, diameter: 10 mm, hole: true}}\n"
        law = f"{{kind: uniform, lower: {LOW} mm, upper: {HIGH} mm}}"
        tolerances += f"  {name} size: {{kind: size, of: plate.{name}, distribution: {law}}}\n"
        for axis, along in (("x", "[1, 0, 0]"), ("y", "[0, 1, 0]")):
            own = f"{{kind: plus_minus, of: plate.{name}, along: {along}, distribution: {normal}}}"
            tolerances += f"  {name} {axis}: {own}\n"
        measures += f"  hole {name}: {{kind: inspected_position, of: plate.{name}, upper_limit: {T0} mm{said}}}\n"
    return (
        f"scene: pattern\nparts:\n  plate:\n    kind: solid\n    features:\n{holes}"
        f"tolerances:\n{tolerances}moves:\n  machine: {{kind: fix, part: plate}}\nmeasures:\n{measures}"
    )


@cache
def accepted(modifier: str) -> float:
    """Probability that one hole is accepted: the error's length is Rayleigh, the room uniform in the size."""
    if not modifier:
        return 1.0 - math.exp(-((T0 / 2) ** 2) / (2 * SIGMA**2))
    origin = LOW if modifier == "mmc" else HIGH

    def at(size: float) -> float:
        room = (T0 + abs(size - origin)) / 2
        return (1.0 - math.exp(-(room**2) / (2 * SIGMA**2))) / (HIGH - LOW)

    return float(integrate.quad(at, LOW, HIGH)[0])


def test_the_reference_probabilities() -> None:
    a, b = T0 / 2, (T0 + HIGH) / 2
    closed = 1 - SIGMA * math.sqrt(2 * math.pi) * (norm.cdf(b / SIGMA) - norm.cdf(a / SIGMA)) / (b - a)
    assert accepted("mmc") == pytest.approx(closed, rel=1e-9)
    assert accepted("mmc") == pytest.approx(0.8992088, abs=1e-7)
    assert accepted("lmc") == pytest.approx(accepted("mmc"), rel=1e-12)
    assert accepted("") == pytest.approx(0.6246889, abs=1e-7)
    assert accepted("mmc") ** 4 == pytest.approx(0.6537959, abs=1e-6)


@pytest.mark.parametrize("modifier", ["mmc", "lmc", ""])
def test_a_gauge_accepts_as_many_as_the_quadrature(tmp_path: Path, modifier: str) -> None:
    path = tmp_path / "pattern.yaml"
    path.write_text(pattern(modifier), "utf-8")
    summary = run_scene(path, overrides=Overrides(trials=COUNT, seed=3), out=tmp_path / "run").summary
    one, every = accepted(modifier), accepted(modifier) ** 4

    def error(share: float) -> float:
        return 4 * math.sqrt(share * (1 - share) / COUNT)

    for name in PLACES:
        for method in ("geometric", "analytic"):
            out = summary["measures"][f"hole {name}"][method]["out_ppm"] / 1e6
            assert 1 - out == pytest.approx(one, abs=error(one))
    assert summary["joint"]["yields"]["geometric"]["yield_ppm"] / 1e6 == pytest.approx(every, abs=error(every))


def test_the_value_is_the_position_less_the_bonus_of_the_same_trial(tmp_path: Path) -> None:
    made = assembled(pattern("mmc"), tmp_path)
    rows = np.zeros((5, 12))
    rows[:, 0] = (-0.01, 0.0, 0.05, 0.2, 0.3)  # under the limits, in them, over them
    rows[:, 1], rows[:, 2] = 0.03, 0.04
    for method in ("exact", "analytic"):
        found = made.values(stated(made.system, rows), method)["hole one"]
        assert found == pytest.approx(np.array([0.1, 0.1, 0.05, -0.1, -0.1]), abs=1e-12)


# zones that a size widens ------------------------------------------------------------------------------------

ZONED = """
scene: a bore in its zone
parts:
  plate:
    kind: solid
    features:
      floor: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}}
      bore: {{kind: cylinder, hole: true, at: [30 mm, 0 mm, 20 mm], axis: [0, 0, 1], length: 40 mm, diameter: 10 mm}}
tolerances:
  bore position: {{kind: position, of: plate.bore, zone: {{diameter: 0.14 mm}}, datums: [floor], {law}{position}}}
{square}
  bore size: {{kind: size, of: plate.bore, {limits}distribution: {{kind: uniform, lower: 0 mm, upper: 0.2 mm}}}}
moves:
  machine: {{kind: fix, part: plate}}
measures:
  along x: {{kind: gap, from: plate.floor, to: plate.bore, along: [1, 0, 0]}}
  judged: {{kind: inspected_position, of: plate.bore, modifier: mmc, upper_limit: 0.14 mm}}
  position: {{kind: inspected_position, of: plate.bore}}
  tilt: {{kind: inspected_orientation, of: plate.bore, datums: [floor]}}
  diameter: {{kind: inspected_size, of: plate.bore}}
"""
SQUARE = "  bore square: {{kind: perpendicularity, of: plate.bore, zone: {{diameter: 0.04 mm}}, datums: [floor]{own}}}"


def zoned(law: str = "uniform", position: str = "mmc", square: str | None = None, limits: str = "") -> str:
    """`square`: the modifier of a perpendicularity that refines the position; "" for none of its own."""
    said = {name: f", modifier: {own}" if own else "" for name, own in (("p", position), ("s", square))}
    refined = "" if square is None else SQUARE.format(own=said["s"])
    law = law if "{" in law else f"{{kind: {law}}}"
    return ZONED.format(law=f"law: {law}", position=said["p"], square=refined, limits=limits)


def test_discs_widened_by_sizes_have_the_sigma_of_the_mean_square_diameter(tmp_path: Path) -> None:
    """Middle of both ends: each has sigma sqrt(E t^2) / 4 = 0.061712 mm, both share the width alone."""
    made = assembled(zoned(), tmp_path)
    expected = math.sqrt(integrate.quad(lambda own: (T0 + own) ** 2 / HIGH, 0, HIGH)[0]) / 4
    assert expected == pytest.approx(0.061712, abs=1e-6)
    for method in ("exact", "analytic"):
        found = made.drawn(COUNT, method)
        assert found["along x"].std() == pytest.approx(expected / math.sqrt(2), rel=5 / math.sqrt(2 * COUNT))
        assert found["judged"].max() <= T0 + 1e-9  # nothing leaves its widened zone
        assert found["judged"].max() > 0.99 * T0
        assert found["position"].max() > 0.97 * (T0 + HIGH)
    measure = next(own for own in made.system.measures if own.name == "along x")
    form = made.system.closed_form(measure)
    assert form is not None
    assert form.sigma == pytest.approx(expected / math.sqrt(2), rel=1e-5)
    assert {share.name for share in form.shares} == {"bore position"}


@pytest.mark.parametrize(
    ("position", "square", "of_zone", "of_orientation"),
    [("mmc", "", 1, 0), ("mmc", "mmc", 1, 1), ("", "mmc", 0, 1), ("lmc", "", -1, 0), ("lmc", "lmc", -1, -1)],
)
@pytest.mark.parametrize("law", ["uniform", "normal"])
def test_each_zone_has_the_bonus_of_its_own_modifier(
    tmp_path: Path, law: str, position: str, square: str, of_zone: int, of_orientation: int
) -> None:
    made = assembled(zoned(law, position, square), tmp_path)
    found = made.drawn(40_000)
    departure = {1: found["diameter"] - 10, 0: np.zeros(40_000), -1: 10.2 - found["diameter"]}
    width = T0 + departure[of_zone]
    tilt = np.minimum(0.04 + departure[of_orientation], width)
    assert (found["position"] <= width + 1e-9).all()
    assert (found["tilt"] <= tilt + 1e-9).all()
    least = 0.97 if law == "uniform" else 0.75
    assert (found["position"] / width).max() > least
    assert (found["tilt"] / tilt).max() > least


def test_the_drawing_s_limits_of_size_count_not_those_of_the_process(tmp_path: Path) -> None:
    """Holes from 10.05 mm on: MMC is there, and sizes below have no bonus."""
    found = assembled(zoned(limits="limits: [0.05 mm, 0.15 mm], "), tmp_path).drawn(20_000)
    room = T0 + np.clip(found["diameter"] - 10.05, 0, 0.1)
    assert (found["position"] <= room + 1e-9).all()
    for part in (found["diameter"] < 10.05, found["diameter"] > 10.15):
        assert (found["position"] / room)[part].max() > 0.97


def test_a_process_is_judged_with_the_bonus_and_not_changed_by_it(tmp_path: Path) -> None:
    law = "{kind: process, distribution: {kind: normal, mean: 0 mm, sigma: 0.05 mm}}"
    columns = [f"bore position.{end} {axis} [um]" for end in ("start", "end") for axis in "xy"]
    runs = {}
    for modifier in ("mmc", ""):
        path = tmp_path / f"judged {modifier}.yaml"
        path.write_text(zoned(law, modifier), "utf-8")
        runs[modifier] = run_scene(path, overrides=Overrides(trials=20_000), out=tmp_path / f"run {modifier}")
    drawn, plain = (np.array([run.columns(name)[name] for name in columns]) for run in runs.values())
    assert np.array_equal(drawn, plain)
    size = runs["mmc"].columns("bore size [um]")["bore size [um]"]
    aside = 2 * np.maximum(np.hypot(*drawn[:2]), np.hypot(*drawn[2:]))
    for modifier, room in (("mmc", 140 + size), ("", np.full(20_000, 140.0))):
        beyond = int((aside > room).sum())
        words = f"bore position: {beyond} of 20000 draws are out of drawing; kept as drawn"
        assert words in runs[modifier].summary["warnings"]


@pytest.mark.slow
def test_workers_replays_and_the_order_of_entries_change_no_bit(tmp_path: Path) -> None:
    """The position is written before the size that it reads; where it is written after, its draws are the same."""
    text = zoned(square="mmc")
    size = next(line for line in text.splitlines(keepends=True) if line.startswith("  bore size"))
    first = text.replace(size, "").replace("tolerances:\n", f"tolerances:\n{size}")
    names = ("bore position.end y [um]", "bore size [um]", "geometric:judged", "analytic:along x")
    runs = []
    for k, (own, workers) in enumerate(((text, 1), (text, 2), (first, 1))):
        path = tmp_path / f"{k}.yaml"
        path.write_text(own, "utf-8")
        asked = Overrides(trials=3_000)
        runs.append(run_scene(path, overrides=asked, out=tmp_path / f"run {k}", execution=Execution(workers=workers)))
    for name in names:
        assert np.array_equal(runs[0].columns(name)[name], runs[1].columns(name)[name])
        assert np.array_equal(runs[0].columns(name)[name], runs[2].columns(name)[name])
    for trial in (0, 1234, 2999):
        assert replay(runs[0], trial).geometric["judged"] == runs[0].columns(names[2])[names[2]][trial]


def test_nets_know_the_sigma_of_a_widened_zone_sooner(tmp_path: Path) -> None:
    """Four times closer than as many random trials would, by four of their standard errors."""
    path = tmp_path / "zoned.yaml"
    path.write_text(zoned(), "utf-8")
    run = run_scene(path, overrides=Overrides(trials=16_384, sampler="sobol"), out=tmp_path / "run")
    sigma = math.sqrt((0.34**3 - 0.14**3) / 0.6) / 4 / math.sqrt(2)
    assert run.summary["measures"]["along x"]["geometric"]["sigma"] == pytest.approx(1e3 * sigma, rel=2e-3)


def test_check_says_which_model_it_is(tmp_path: Path) -> None:
    process = "{kind: process, distribution: {kind: normal, mean: 0 mm, sigma: 0.05 mm}}"
    expected = {
        "uniform": "uniform in its zone, widened by the bonus of bore size",
        "normal": "normal in its zone, widened by the bonus of bore size",
        process: "its own process, judged with the bonus of bore size",
    }
    for law, words in expected.items():
        draw = assembled(zoned(law), tmp_path).system.contributors[0].draw
        assert isinstance(draw, JointDraw)
        assert draw.words == words


@pytest.mark.parametrize(("tab", "grows"), [("false", 1), ("true", -1)])
def test_the_width_of_a_slot_widens_its_zone_too(tmp_path: Path, tab: str, grows: int) -> None:
    slot = "{kind: slot, at: [30 mm, 0 mm, 20 mm], normal: [0, 1, 0], extent: [40 mm, 10 mm], width: 6 mm, tab: " + tab
    lines = [line for line in zoned().splitlines(keepends=True) if not line.startswith(("  along x", "  tilt"))]
    text = "".join(lines).replace("{diameter: 0.14 mm}", "{width: 0.14 mm}")
    start = text.index("{kind: cylinder")
    text = text[:start] + slot + text[text.index("}", start) :]
    found = assembled(text, tmp_path).drawn(20_000)
    width = found["diameter"] - 6
    room = T0 + (width if grows > 0 else HIGH - width)
    assert (found["position"] <= room + 1e-9).all()
    assert (found["position"] / room).max() > 0.97
    assert found["judged"] == pytest.approx(found["position"] - room + T0, abs=1e-12)


def test_a_run_says_which_model_it_is(tol3d: Command, tmp_path: Path) -> None:
    path = written(zoned(), tmp_path)
    code, out, _ = tol3d("run", str(path), "-v", "--trials", "500", "--no-picture", "--out", str(tmp_path / "run"))
    assert code == 0
    words = "uniform in its zone, widened by the bonus of bore size"
    table = " ".join(out.partition("laws of zones")[2].split())
    assert "bore position uniform in its zone, widened by the bonus of bore" in table
    assert open_run(tmp_path / "run").summary["measures"]["along x"]["laws"] == {"bore position": words}
    assert "laws" not in open_run(tmp_path / "run").summary["measures"]["diameter"]


# extremes ----------------------------------------------------------------------------------------------------


def test_the_worst_case_of_a_gap_is_that_of_the_size_with_most_bonus(tmp_path: Path) -> None:
    made = assembled(zoned(), tmp_path)
    measure = next(own for own in made.system.measures if own.name == "along x")
    found = first_orders(made.simulation, None, [measure])[measure.name]["analytic"]
    assert found.ends == pytest.approx((30_000 - 170, 30_000 + 170), abs=1e-6)
    sigma = 1e3 * math.sqrt((0.34**3 - 0.14**3) / 0.6) / 4 / math.sqrt(2)
    assert found.sigma == pytest.approx(sigma, rel=1e-5)
    assert [(own.name, round(own.reach, 6)) for own in found.effects] == [("bore position", 340.0)]


@pytest.mark.slow
@pytest.mark.parametrize("grows", [True, False])
@pytest.mark.parametrize("law", [Uniform(-0.05, 0.3), Uniform(0.05, 0.1), Normal(0.1, 0.1)])
def test_ends_together_are_the_worst_of_all_sizes(grows: bool, law: Distribution) -> None:
    """Against every size of a fine grid, zone and size acting together; two zones that read one size among them."""
    zones = [catalogue.axis(0.1, 0.04), catalogue.axis(0.14)]
    size = SizedBy("size", law, Bonus(0.0, 0.2, grows))
    draws = [Widened(zone, uniform_in(zone), size) for zone in zones]
    contributors = [
        *(PlainContributor(f"zone {k}", "position", draw) for k, draw in enumerate(draws)),
        PlainContributor("size", "size", Scalar(law)),
    ]
    grid = np.linspace(law.low, law.high, 401)
    room = np.clip(grid if grows else 0.2 - grid, 0.0, 0.2)
    rng = np.random.default_rng(4)
    for _ in range(6):
        slopes = {own.name: rng.standard_normal(len(own.draw.components)) for own in contributors}
        slopes["size"] *= 3.0
        ends = ends_together(contributors, slopes, dict.fromkeys(slopes, False))
        low, high = (sum(float(slopes[name] @ own[k]) for name, own in ends.items()) for k in (0, 1))
        reach = sum(
            np.array([zone.support(slopes[f"zone {k}"], zone.width + own) for own in room])
            for k, zone in enumerate(zones)
        )
        step = (grid[1] - grid[0]) * (abs(slopes["size"][0]) + sum(np.abs(own).sum() for own in slopes.values()))
        tops = reach + slopes["size"][0] * grid, reach - slopes["size"][0] * grid
        assert tops[0].max() - 1e-9 <= high <= tops[0].max() + step
        assert tops[1].max() - 1e-9 <= -low <= tops[1].max() + step


def test_features_and_components_with_laws_of_their_own_are_all_at_their_worst() -> None:
    """A sum over what is drawn independently is worst where each is; their joint ellipse reaches less far."""
    zone = catalogue.axis(0.1)
    laws = tuple(Uniform(-1.0 - k, 2.0 + k) for k in range(4))
    contributors = [
        PlainContributor("pins", "position", EachPlanar(Uniform(0.0, 3.0), ("1", "2", "3"), None)),
        PlainContributor("zone", "position", Process(zone, laws)),
    ]
    slopes = {"pins": np.array([3.0, 4.0, -5.0, 12.0, 0.0, 0.0]), "zone": np.array([1.0, -2.0, 0.0, 4.0])}
    ends = ends_together(contributors, slopes, dict.fromkeys(slopes, False))
    reached = {name: (own @ slopes[name]).tolist() for name, own in ends.items()}
    assert reached["pins"] == pytest.approx([-3.0 * (5 + 13), 3.0 * (5 + 13)], rel=1e-12)
    assert reached["zone"] == [-1.0 - 2.0 * 3.0 - 4.0 * 4.0, 2.0 + 2.0 * 2.0 + 4.0 * 5.0]


def test_ends_are_not_where_a_slope_is_not_nor_of_what_is_read_with_it() -> None:
    """A build beside the mean that fails leaves no slope: no end of its zone, nor of the size that widens it."""
    law = Uniform(-0.05, 0.3)
    zone = catalogue.axis(0.1)
    contributors = [
        PlainContributor(
            "zone", "position", Widened(zone, uniform_in(zone), SizedBy("size", law, Bonus(0.0, 0.2, True)))
        ),
        PlainContributor("size", "size", Scalar(law)),
        PlainContributor("other", "size", Scalar(law)),
    ]
    slopes = {"zone": np.array([0.13, np.nan, 0.13, 0.0]), "size": np.ones(1), "other": np.ones(1)}
    ends = ends_together(contributors, slopes, dict.fromkeys(slopes, False))
    assert np.isnan(ends["zone"]).all()
    assert np.isnan(ends["size"]).all()
    assert ends["other"][:, 0].tolist() == [-0.05, 0.3]


# what is refused ---------------------------------------------------------------------------------------------

SIZE = next(line for line in zoned().splitlines(keepends=True) if line.startswith("  bore size"))
SIZED = "kind: cylinder, hole: true"
NO_LIMITS = SIZE.replace("kind: uniform, lower: 0 mm, upper: 0.2 mm", "kind: rayleigh, scale: 5 um")


def without(*measures: str) -> str:
    lines = zoned().splitlines(keepends=True)
    return "".join(own for own in lines if not own.startswith(tuple(f"  {name}:" for name in measures)))


WRONG = {
    "no size": (
        without("judged").replace(SIZE, ""),
        "tolerances.bore position.modifier",
        "expected a tolerance of the size of 'plate.bore', from which the bonus counts, got none; add one of kind size",
    ),
    "no size of a measure": (
        zoned(position="").replace(SIZE, ""),
        "measures.judged.modifier",
        "expected a tolerance of the size of 'plate.bore', from which the bonus counts, got none; add one of kind size",
    ),
    "no cylinder": (
        without("judged", "diameter").replace(SIZE, "").replace(SIZED, "kind: axis").replace(", diameter: 10 mm", ""),
        "tolerances.bore position.modifier",
        "expected none, for 'plate.bore' is an axis, whose zone is not widened by a size, got mmc",
    ),
    "two conditions": (
        zoned(square="lmc"),
        "tolerances.bore square.modifier",
        "expected that of 'bore position', mmc, or none, got lmc",
    ),
    "no material condition": (
        zoned().replace(SIZE, NO_LIMITS),
        "tolerances.bore size",
        "expected the drawing's limits of size, such as [0 um, 15 um], from which the bonus counts; got none, and its "
        "distribution has none",
    ),
    "limits out of order": (
        zoned(limits="limits: [0.2 mm, 0 mm], "),
        "tolerances.bore size.limits",
        "expected the lower one before the upper one, got ['0.2 mm', '0 mm']",
    ),
    "another word": (
        zoned(position="mmb"),
        "tolerances.bore position.modifier",
        "expected mmc or lmc, got 'mmb'; did you mean \"mmc\"?",
    ),
}


@pytest.mark.parametrize(("text", "place", "said"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_said_once(text: str, place: str, said: str, tmp_path: Path) -> None:
    assert refusal(text, tmp_path) == f"{place}: {said}"
