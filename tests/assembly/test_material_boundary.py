"""Datums at their maximum material boundary: one shift of the gauge a frame and trial, common to all in it."""

import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled
from numpy.typing import NDArray
from scene_texts import refusal, written
from scipy import integrate

from tol3d.assembly.model.statuses import NO_BUILD, OK
from tol3d.assembly.zones.float_draw import GaugeShift
from tol3d.contact.openings import least_in_rooms
from tol3d.simulate import Execution, Overrides, replay, run_scene
from tol3d.study.effects.first_order import first_orders
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

COUNT = 60_000
SHIFT = "shift of plate.bore to floor"
UPRIGHT = "{kind: process, distribution: {kind: constant, value: 0 mm}}"  # of a bore that does not lean
SCENE = """
scene: holes about a bore
parts:
  plate:
    kind: solid
    features:
      floor: {{kind: plane, at: [30 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}}
      bore: {{kind: cylinder, at: [0 mm, 0 mm, 10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 10 mm, hole: {hole}}}
      one: {{kind: axis, at: [60 mm, 0 mm, 10 mm], axis: [0, 0, 1], length: 20 mm}}
      two: {{kind: axis, at: [60 mm, 30 mm, 10 mm], axis: [0, 0, 1], length: 20 mm}}
tolerances:
  one position: {{kind: position, of: plate.one, zone: {{diameter: 0.04 mm}}, law: {{kind: uniform}}, datums: {datums}}}
  two position: {{kind: position, of: plate.two, zone: {{diameter: 0.04 mm}}, law: {{kind: uniform}}, datums: {datums}}}
  bore square: {{kind: perpendicularity, of: plate.bore, zone: {{diameter: 0.05 mm}}, law: {law}, datums: [floor]}}
  bore size: {{kind: size, of: plate.bore, distribution: {{kind: uniform, lower: 0 mm, upper: 0.2 mm}}}}
moves:
  machine: {{kind: fix, part: plate}}
measures:
  one along x: {{kind: gap, from: plate.bore, to: plate.one, along: [1, 0, 0]}}
  one along y: {{kind: gap, from: plate.bore, to: plate.one, along: [0, 1, 0]}}
  two from one: {{kind: gap, from: plate.one, to: plate.two, along: [0, 1, 0]}}
  inspected: {{kind: inspected_position, of: plate.one, datums: [floor, bore]}}
"""


def scene(law: str = UPRIGHT, mmb: str = "random", hole: str = "true") -> str:
    datums = f"[floor, {{feature: bore, mmb: {mmb}}}]" if mmb else "[floor, bore]"
    return SCENE.format(law=law, datums=datums, hole=hole)


def clearance(size: Array, hole: str) -> Array:
    """c from the diameter's deviation: the gauge is 9.95 mm in the hole, 10.25 mm over the pin."""
    return (size + 0.05) / 2 if hole == "true" else (0.25 - size) / 2


MIDDLE = 0.02**2 / 8  # mm^2 along x, of the middle of two ends uniform in discs of 0.02 mm


@pytest.mark.parametrize(("hole", "key"), [("true", "mmb"), ("false", "mmb"), ("true", "lmb"), ("false", "lmb")])
def test_the_shift_is_uniform_in_the_room_of_the_gauge(tmp_path: Path, hole: str, key: str) -> None:
    """At the least material boundary the gauge is 10.25 mm about the hole, 9.95 mm in the pin."""
    made = assembled(scene(hole=hole).replace("mmb", key), tmp_path)
    hole = hole if key == "mmb" else {"true": "false", "false": "true"}[hole]
    square = integrate.quad(lambda own: float(clearance(np.asarray(own), hole)) ** 2 / 0.2, 0.0, 0.2)[0]
    sigma = math.sqrt(square / 4 + MIDDLE)
    for method in ("exact", "analytic"):
        found = made.drawn(COUNT, method)
        for name, nominal in (("one along x", 60.0), ("one along y", 0.0)):
            assert found[name].mean() == pytest.approx(nominal, abs=4 * sigma / math.sqrt(COUNT))
            assert found[name].std() == pytest.approx(sigma, rel=4 / math.sqrt(2 * COUNT))
        # what both holes have in common cancels
        assert found["two from one"].std() == pytest.approx(math.sqrt(2 * MIDDLE), rel=4 / math.sqrt(2 * COUNT))
    trials = drawn(made.simulation, 0, COUNT).deviations
    shift, room = np.hypot(*trials[:, -2:].T), clearance(trials[:, -3], hole)
    assert (shift <= room * (1 + 1e-12)).all()
    inside = (shift <= room / 2).mean()
    assert inside == pytest.approx(1 / 4, abs=4 * math.sqrt(3 / 16 / COUNT))


def test_the_closed_form_and_the_worst_case_have_the_shift(tmp_path: Path) -> None:
    made = assembled(scene(), tmp_path)
    square = integrate.quad(lambda own: (own + 0.05) ** 2 / 4 / 0.2, 0.0, 0.2)[0]
    measure = next(own for own in made.system.measures if own.name == "one along x")
    form = made.system.closed_form(measure)
    assert form is not None
    assert form.sigma == pytest.approx(math.sqrt(square / 4 + MIDDLE), rel=1e-5)
    variances = {share.name: share.variance for share in form.shares}
    assert variances[SHIFT] == pytest.approx(square / 4, rel=1e-5)
    ends = first_orders(made.simulation, None, [measure])[measure.name]["analytic"].ends
    assert ends == pytest.approx((60_000 - 145, 60_000 + 145), abs=1e-6)  # 0.125 of the gauge, 0.02 of the zone


def test_a_bore_that_leans_leaves_the_gauge_a_lens(tmp_path: Path) -> None:
    made = assembled(scene(law="{kind: uniform}"), tmp_path)
    trials = drawn(made.simulation, 0, COUNT).deviations
    half, size, shift = trials[:, -5:-3], trials[:, -3], trials[:, -2:]  # the end of a half difference: x, y
    room = clearance(size, "true")

    def are_in(places: Array) -> NDArray[np.bool_]:
        return np.asarray(
            np.maximum(np.hypot(*(places + half).T), np.hypot(*(places - half).T)) <= room * (1 + 1e-12) + 1e-15
        )

    assert are_in(shift).all()
    # a lens half as large in both directions has a quarter of its points
    assert are_in(2 * shift).mean() == pytest.approx(1 / 4, abs=4 * math.sqrt(3 / 16 / COUNT))
    exact, linear = made.drawn(3_000), made.drawn(3_000, "analytic")
    for name in exact:
        assert exact[name] == pytest.approx(linear[name], abs=1e-5), name


def test_the_lens_has_the_moments_of_points_drawn_by_rejection(tmp_path: Path) -> None:
    system = assembled(scene(law="{kind: uniform}"), tmp_path).system
    draw = system.contributors[-1].draw
    assert isinstance(draw, GaugeShift)
    rng = np.random.default_rng(1)
    half, size = np.array([0.012, 0.016]), 0.01  # c = 0.03, |h| = 0.02
    given = {"bore size": np.full((1, COUNT), size), "bore square": np.repeat(half[:, None], COUNT, axis=1)}
    shifts = np.stack(draw.deviations_given(given, *rng.random((2, COUNT))))
    tried = rng.uniform(-0.03, 0.03, (2, 4 * COUNT))
    kept = tried[:, np.maximum(np.hypot(*(tried.T + half).T), np.hypot(*(tried.T - half).T)) <= 0.03]
    for a, b in ((0, 0), (0, 1), (1, 1)):
        own, other = shifts[a] * shifts[b], kept[a] * kept[b]
        error = math.hypot(own.std() / math.sqrt(COUNT), other.std() / math.sqrt(kept.shape[1]))
        assert own.mean() == pytest.approx(other.mean(), abs=4 * error)
    for slopes in rng.standard_normal((20, 2)):
        reach = float(draw.furthest_given({name: own[:, :1] for name, own in given.items()}, slopes) @ slopes)
        assert (slopes @ kept).max() <= reach + 1e-12
        assert (slopes @ kept).max() == pytest.approx(reach, rel=0.05)


def test_the_closed_form_of_a_bore_that_leans_is_that_of_trials(tmp_path: Path) -> None:
    made = assembled(scene(law="{kind: uniform}"), tmp_path)
    measure = next(own for own in made.system.measures if own.name == "one along x")
    form = made.system.closed_form(measure)
    assert form is not None
    found = made.drawn(COUNT)["one along x"].std()
    assert form.sigma == pytest.approx(found, rel=4 / math.sqrt(2 * COUNT) + 2e-3)


def test_gauges_at_both_boundaries_shift_by_themselves(tmp_path: Path) -> None:
    text = scene()
    place = text.rindex("mmb: random")
    made = assembled(text[:place] + "lmb: random" + text[place + 11 :], tmp_path)
    found = [own.name for own in made.system.contributors if own.kind == "datum_shift"]
    assert found == [SHIFT, SHIFT.replace(" to", " lmb to")]
    drawn_ones = made.drawn(2_000)
    correlation = np.corrcoef(drawn_ones["one along y"], drawn_ones["two from one"])[0, 1]
    assert -0.9 < correlation < -0.4  # two less one, of like spreads: -0.7


def test_a_centred_gauge_is_as_regardless_of_size(tmp_path: Path) -> None:
    centred, plain = (assembled(scene(mmb=own), tmp_path) for own in ("centred", ""))
    assert [own.name for own in centred.system.contributors] == [own.name for own in plain.system.contributors]
    trials = drawn(plain.simulation, 0, 500)
    found, expected = centred.values(trials), plain.values(trials)
    assert all(np.array_equal(own, expected[name]) for name, own in found.items())


def test_parts_alike_have_gauges_of_their_own(tmp_path: Path) -> None:
    text = scene().replace("tolerances:\n", "  other: {kind: solid, like: plate}\ntolerances:\n", 1)
    text = text.replace("moves:\n", "moves:\n  second machine: {kind: fix, part: other}\n")
    system = assembled(text.replace(UPRIGHT, "{kind: uniform}"), tmp_path).system
    assert [own.name for own in system.contributors][-2:] == [SHIFT, "shift of other.bore to floor"]
    reads = [own.draw.reads for own in system.contributors[-2:] if isinstance(own.draw, GaugeShift)]
    assert reads == [("bore size", "bore square"), ("bore size of other", "bore square of other")]


def test_workers_and_replays_change_no_bit(tmp_path: Path) -> None:
    path = written(scene(law="{kind: uniform}"), tmp_path)
    names = (f"{SHIFT}.x [um]", "geometric:inspected", "analytic:one along y")
    runs = [
        run_scene(path, overrides=Overrides(trials=2_000), out=tmp_path / f"{k}", execution=Execution(workers=k))
        for k in (1, 2)
    ]
    for name in names:
        assert np.array_equal(runs[0].columns(name)[name], runs[1].columns(name)[name])
    for trial in (0, 1999):
        assert replay(runs[0], trial).geometric["inspected"] == runs[0].columns(names[1])[names[1]][trial]


RANDOM = "{feature: bore, mmb: random}"
# the least over the shift ------------------------------------------------------------------------------------

OFF, T0 = 0.06, 0.1  # mm: sigma of the hole's centre along each axis, and its zone at MMC
INSPECTED = """
scene: an inspected hole
parts:
  plate:
    kind: solid
    features:
      floor: {{kind: plane, at: [30 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}}
      bore: {{kind: cylinder, at: [0 mm, 0 mm, 10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 10 mm, hole: true}}
      one: {{kind: cylinder, at: [60 mm, 0 mm, 10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 8 mm, hole: true}}
tolerances:
  one x: {{kind: plus_minus, of: plate.one, along: [1, 0, 0], datums: [floor, bore], distribution: {off}}}
  one y: {{kind: plus_minus, of: plate.one, along: [0, 1, 0], datums: [floor, bore], distribution: {off}}}
  one size: {{kind: size, of: plate.one, distribution: {{kind: uniform, lower: 0 mm, upper: 0.1 mm}}}}
  bore square: {{kind: perpendicularity, of: plate.bore, zone: {{diameter: 0.05 mm}}, law: {law}, datums: [floor]}}
  bore size: {{kind: size, of: plate.bore, distribution: {{kind: uniform, lower: 0 mm, upper: 0.2 mm}}}}
moves:
  machine: {{kind: fix, part: plate}}
measures:
  least: {{kind: inspected_position, of: plate.one, modifier: mmc, datums: {datums}, upper_limit: 0.1 mm}}
  plain: {{kind: inspected_position, of: plate.one, modifier: mmc, datums: [floor, bore], upper_limit: 0.1 mm}}
"""


def inspected(law: str = UPRIGHT) -> str:
    off = f"{{kind: normal, mean: 0 mm, sigma: {OFF} mm}}"
    return INSPECTED.format(law=law, off=off, datums="[floor, {feature: bore, mmb: least}]")


@pytest.mark.slow
@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_gauge_that_may_shift_accepts_more(tmp_path: Path, method: str) -> None:
    """|e| <= t0 / 2 + bonus / 2 + clearance, both sizes uniform; value by value 2 max(|e| - c, 0) - bonus."""
    made = assembled(inspected(), tmp_path)
    trials = drawn(made.simulation, 0, COUNT // 3)
    found = made.values(trials, method)
    x, y, bonus, *_, size = trials.deviations.T
    expected = 2 * np.maximum(np.hypot(x, y) - (size + 0.05) / 2, 0) - bonus
    assert found["least"] == pytest.approx(expected, abs=1e-9)
    assert found["plain"] == pytest.approx(2 * np.hypot(x, y) - bonus, abs=1e-9)

    def accepted(own: float, datum: float) -> float:
        room = (T0 + own + datum + 0.05) / 2
        return (1 - math.exp(-(room**2) / (2 * OFF**2))) / (0.1 * 0.2)

    share = integrate.dblquad(accepted, 0, 0.2, 0, 0.1)[0]
    assert (found["least"] <= T0).mean() == pytest.approx(share, abs=4 * math.sqrt(3 * share * (1 - share) / COUNT))


def distance_to_lens(point: Array, half: Array, room: float) -> float:
    """From a point to what two discs about ±half have in common: to one of them where that is in the other, or to a
    corner."""
    if max(np.hypot(*(point - half)), np.hypot(*(point + half))) <= room:
        return 0.0
    found = []
    for centre in (half, -half):
        foot = centre + room * (point - centre) / np.hypot(*(point - centre))
        if np.hypot(*(foot + centre)) <= room:
            found.append(foot)
    length = float(np.hypot(*half))
    corner = math.sqrt(room**2 - length**2) / length * np.array([-half[1], half[0]])
    return min(float(np.hypot(*(point - own))) for own in (*found, corner, -corner))


@pytest.mark.slow
def test_a_datum_that_leans_limits_the_shift_at_both_ends(tmp_path: Path) -> None:
    made = assembled(inspected(law="{kind: uniform}"), tmp_path)
    trials = drawn(made.simulation, 0, 2_000)
    found = {method: made.values(trials, method)["least"] for method in ("exact", "analytic")}
    expected = [
        2 * distance_to_lens(np.array([x, y]), np.array(half), (size + 0.05) / 2) - bonus
        for x, y, bonus, *half, size in trials.deviations
    ]
    assert found["analytic"] == pytest.approx(np.array(expected), abs=1e-9)
    assert found["exact"] == pytest.approx(np.array(expected), abs=1e-6)  # of order 2: turns of 2e-3 over 20 mm
    assert (np.array(expected) > -trials.deviations[:, 2] + 1e-6).mean() > 0.3


def test_circles_that_no_shift_reaches_have_no_value() -> None:
    """Places and a room by numbers: reached, reached where the room ends, and a room that is empty."""
    x = np.array([[1.0, 1.0, 1.0], [0.0, 0.0, 0.3], [0.0, 0.0, -0.3]])
    radii = np.array([[0.0, 0.1, 0.0], [2.0, 0.5, 0.2], [2.0, 0.5, 0.2]])
    least = least_in_rooms(x, np.zeros((3, 3)), radii, 1)
    assert least[:2] == pytest.approx([0.0, 0.4], abs=1e-11)
    assert np.isnan(least[2])


def test_a_datum_that_does_not_take_its_gauge_is_no_build(tmp_path: Path) -> None:
    law = "{kind: process, distribution: {kind: normal, mean: 0 mm, sigma: 0.05 mm}}"
    made = assembled(inspected(law=law), tmp_path)
    trials = drawn(made.simulation, 0, 4_000)
    answers = made.system.method("exact", None).answers(trials, made.system.measures)
    half, size = np.hypot(*trials.deviations[:, 3:5].T), trials.deviations[:, 5]
    fits = half <= (size + 0.05) / 2
    assert 0.2 < fits.mean() < 0.95
    clear = np.abs(half - (size + 0.05) / 2) > 1e-6
    assert np.array_equal((answers.status["least"] == OK)[clear], fits[clear])
    assert set(answers.status["least"].tolist()) == {OK, NO_BUILD}
    assert (answers.status["plain"] == OK).all()


# what is refused ---------------------------------------------------------------------------------------------

ASIDE = "{kind: plus_minus, of: plate.bore, along: [1, 0, 0], distribution: {kind: uniform, lower: 0 mm, upper: 1 mm}}"
WRONG: dict[str, tuple[Callable[[str], str], str, str]] = {
    "without a size": (
        lambda text: "".join(line for line in text.splitlines(True) if not line.startswith("  bore size")),
        "tolerances.one position.datums",
        "expected a tolerance of the size of 'plate.bore', which makes the gauge's room; add one of kind size",
    ),
    "no plane before it": (
        lambda text: text.replace("datums: [floor, {feature", "datums: [two, {feature", 1),
        "tolerances.one position.datums",
        "expected a zone of 'plate.bore' to two, which makes its virtual condition there; add a position to these "
        "datums, or an orientation",
    ),
    "a bore that nothing orients": (
        lambda text: re.sub(r"\n  bore square: .*", f"\n  bore x: {ASIDE}", text),
        "tolerances.one position.datums",
        "expected a zone of 'plate.bore' to 'floor' first, for that orients the gauge; add a position or "
        "perpendicularity to it",
    ),
    "in a measure": (
        lambda text: text.replace("datums: [floor, bore]", "datums: [floor, {feature: bore, mmb: random}]"),
        "measures.inspected.datums",
        "expected datums without mmb, or mmb: least of what is inspected",
    ),
    "least of a tolerance": (
        lambda text: text.replace("mmb: random", "mmb: least", 1),
        "tolerances.one position.datums",
        "expected mmb: random or mmb: centred, for least is of what is inspected",
    ),
    "of a plane": (
        lambda text: text.replace("datums: [floor, {feature: bore", "datums: [floor, {feature: floor", 1),
        "tolerances.one position.datums[1]",
        "expected a cylinder or slot, got 'plate.floor', which is a plane; did you mean \"plate.bore\"?",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("change", "place", "said"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_said(change: Callable[[str], str], place: str, said: str, tmp_path: Path) -> None:
    assert refusal(change(scene()), tmp_path).splitlines()[0] == f"{place}: {said}"
