"""Several datums at their maximum material boundary, a third one, a slot: gauges of one piece in their room."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled
from scene_texts import edited, refusal
from scipy import sparse
from scipy.optimize import linprog

from tol3d.assembly.model.statuses import NO_BUILD, OK
from tol3d.study.trials.draws import drawn

COUNT = 10_000

# by hand -----------------------------------------------------------------------------------------------------

PLATE = """
scene: a plate on its gauge
parts:
  plate:
    kind: solid
    features:
      floor: {{kind: plane, at: [50 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [120 mm, 60 mm]}}
      bore: {{kind: cylinder, at: [0 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 10 mm, hole: true}}
      slot: {{kind: slot, at: [80 mm, 0 mm, 5 mm], normal: [0, 1, 0], extent: [16 mm, 10 mm], width: 8 mm}}
      near: {{kind: axis, at: [44 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm}}
      far: {{kind: axis, at: [110 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm}}
tolerances:
  bore square: {{kind: perpendicularity, of: plate.bore, zone: {{diameter: 0.02 mm}}, law: {still}, datums: [floor]}}
  bore size: {{kind: size, of: plate.bore, distribution: {{kind: constant, value: 0.06 mm}}, limits: [0 mm, 0.1 mm]}}
  slot place: {{kind: position, of: plate.slot, zone: {{width: 0.03 mm}}, law: {still}, datums: [floor, bore]}}
  slot size: {{kind: size, of: plate.slot, distribution: {{kind: constant, value: 0.05 mm}}, limits: [0 mm, 0.1 mm]}}
  near off: {{kind: plus_minus, of: plate.near, along: [0, 1, 0], datums: {datums}, distribution: {near}}}
  far off: {{kind: plus_minus, of: plate.far, along: [0, 1, 0], datums: {datums}, distribution: {far}}}
moves:
  machine: {{kind: fix, part: plate}}
measures:
  near y: {{kind: gap, from: plate.bore, to: plate.near, along: [0, 1, 0]}}
  far y: {{kind: gap, from: plate.bore, to: plate.far, along: [0, 1, 0]}}
  least: {{kind: inspected_position, of: plate.far, datums: {read}}}
"""
STILL = "{kind: process, distribution: {kind: constant, value: 0 mm}}"
CLEAR_BORE, CLEAR_SLOT = (0.06 + 0.02) / 2, (0.05 + 0.03) / 2  # over the gauges of 9.98 and 7.97 mm
BOTH = "[floor, {{feature: bore, mmb: {0}}}, {{feature: slot, mmb: {0}}}]"
THIRD = "[floor, bore, {{feature: slot, mmb: {0}}}]"


def constant(value: float) -> str:
    return f"{{kind: constant, value: {value} mm}}"


def plate(datums: str, read: str = "[floor, bore]", far: float = 0.0) -> str:
    return PLATE.format(still=STILL, datums=datums, read=read, near=constant(0.0), far=constant(far))


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_slot_as_third_datum_lets_the_frame_turn_in_its_room(tmp_path: Path, method: str) -> None:
    """Its blade meets the end that is farthest from the bore: uniform within 0.04 on 88 mm, common to both holes."""
    made = assembled(plate(THIRD.format("random")), tmp_path)
    names = [own.name for own in made.system.contributors]
    assert "shift of plate.slot to floor, bore" in names
    found = made.values(drawn(made.simulation, 0, COUNT), method)
    most = CLEAR_SLOT / 88.0
    turn = found["far y"] / 110.0
    assert np.abs(turn).max() <= most * (1 + 1e-6)
    np.testing.assert_allclose(found["near y"], 44.0 * turn, atol=1e-9)
    assert turn.mean() == pytest.approx(0.0, abs=4 * most / math.sqrt(3 * COUNT))
    # of a uniform law the square has the mean 1/3 and the variance 4/45
    assert (turn**2).mean() == pytest.approx(most**2 / 3, abs=4 * most**2 * math.sqrt(4 / 45 / COUNT))


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_bore_and_slot_share_one_room(tmp_path: Path, method: str) -> None:
    """Every trial lies in it: |shift| <= 0.04 and, at both ends of the slot, |y shift + turn x| <= 0.04."""
    made = assembled(plate(BOTH.format("random")), tmp_path)
    found = made.values(drawn(made.simulation, 0, 4_000), method)
    turn = (found["far y"] - found["near y"]) / 66.0
    shift = found["near y"] - 44.0 * turn
    edge = np.abs([shift / CLEAR_BORE, *((shift + x * turn) / CLEAR_SLOT for x in (72.0, 88.0))]).max(axis=0)
    assert edge.max() <= 1.0 + 1e-5
    assert edge.max() > 0.97
    assert np.abs(shift).max() > 0.9 * CLEAR_BORE
    assert abs(np.corrcoef(shift, turn)[0, 1]) > 0.5  # a shift to one side leaves turns to the other


@pytest.mark.parametrize("method", ["exact", "analytic"])
@pytest.mark.parametrize("far", [0.03, 0.08, 0.3])
def test_an_inspected_position_takes_its_least_over_the_room(tmp_path: Path, method: str, far: float) -> None:
    """Motion of the gauges after a hole that lies aside: a linear programme over shift along y and turn."""
    made = assembled(plate("[floor, bore, slot]", BOTH.format("least"), far), tmp_path)
    found = made.values(drawn(made.simulation, 0, 3), method)["least"]
    rows = np.array([[1.0, 0.0], [1.0, 72.0], [1.0, 88.0]])
    most = linprog(
        [-1.0, -110.0],
        np.concatenate([rows, -rows]),
        [CLEAR_BORE, CLEAR_SLOT, CLEAR_SLOT] * 2,
        bounds=[(None, None)] * 2,
    )
    expected = 2 * max(far + most.fun, 0.0)
    assert -most.fun == pytest.approx(CLEAR_SLOT + 22 * (CLEAR_BORE + CLEAR_SLOT) / 88, abs=1e-9)  # 0.06
    # the hole is toleranced to datums in place: the exact turn of 0.9 mrad is off by 4e-7 of 110 mm
    np.testing.assert_allclose(found, expected, atol=1e-8 if method == "analytic" else 1e-4)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_slot_regardless_of_size_takes_its_motions_from_the_room_of_the_bore(tmp_path: Path, method: str) -> None:
    """It lies true: across it nothing floats, in a frame that is drawn and in one that is inspected."""
    drawn_to = "[floor, {feature: bore, mmb: random}, slot]"
    made = assembled(plate(drawn_to, drawn_to.replace("random", "least"), 0.03), tmp_path)
    assert "shift of plate.bore to floor, then slot" in [own.name for own in made.system.contributors]
    found = made.values(drawn(made.simulation, 0, 20), method)
    np.testing.assert_allclose(found["near y"], 0.0, atol=1e-7)
    np.testing.assert_allclose(found["far y"], 0.03, atol=1e-7)
    np.testing.assert_allclose(found["least"], 0.06, atol=1e-7)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_slot_that_is_placed_to_a_gauge_is_a_datum_after_it(tmp_path: Path, method: str) -> None:
    """Two frames, with a shift each: the slot floats with the first, and holds the second where it lies itself."""
    first = "[floor, {feature: bore, mmb: random}]"
    text = plate(f"{first[:-1]}, slot]", "[floor, bore, slot]").replace(
        "law: " + STILL + ", datums: [floor, bore]}", f"law: {STILL}, datums: {first}}}"
    )
    text = text.replace(
        "measures:\n", "measures:\n  slot y: {kind: gap, from: plate.bore, to: plate.slot, along: [0, 1, 0]}\n"
    )
    made = assembled(text, tmp_path)
    names = [own.name for own in made.system.contributors if own.kind == "datum_shift"]
    assert sorted(names) == ["shift of plate.bore to floor", "shift of plate.bore to floor, then slot"]
    found = made.values(drawn(made.simulation, 0, 200), method)
    assert np.abs(found["slot y"]).max() > 0.9 * CLEAR_BORE
    for name in ("near y", "far y"):  # the slot lies true, off by less than the bore lets its gauge go
        np.testing.assert_allclose(found[name], found["slot y"], atol=1e-7)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_first_datum_at_its_boundary_shifts_by_its_size_alone(tmp_path: Path, method: str) -> None:
    """Its gauge is the MMC of 10 mm, whatever its squareness: 0.03 all around in a bore of 10.06 mm."""
    made = assembled(plate("[bore]", "[{feature: bore, mmb: least}]", 0.05), tmp_path)
    found = made.values(drawn(made.simulation, 0, 3), method)["least"]
    np.testing.assert_allclose(found, 2 * (0.05 - 0.03), atol=1e-9)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_position_takes_its_least_over_the_shift_in_a_bore_alone(tmp_path: Path, method: str) -> None:
    """The bore leaves its gauge 0.04 all around: of a hole 0.05 off 0.01 is left, of one 0.03 off nothing."""
    for far, left in ((0.05, 0.05 - CLEAR_BORE), (0.03, 0.0)):
        made = assembled(plate("[floor, bore, slot]", "[floor, {feature: bore, mmb: least}]", far), tmp_path)
        found = made.values(drawn(made.simulation, 0, 3), method)["least"]
        np.testing.assert_allclose(found, 2 * left, atol=1e-9)


SIZES = {"bore": "{kind: constant, value: 0.06 mm}, limits: [0 mm, 0.1 mm]", "slot": "{kind: constant, value: 0.05 mm}"}
UNIFORM = "{kind: uniform, lower: 0 mm, upper: 0.1 mm}"


@pytest.mark.parametrize("inner", [True, False])
@pytest.mark.parametrize("key", ["mmb", "lmb"])
def test_a_thousand_builds_on_gauges_at_both_boundaries_are_a_linear_programme(
    tmp_path: Path, inner: bool, key: str
) -> None:
    """Four times 250 builds, in one programme: |y| <= c, |y + 72 turn|, |y + 88 turn| <= c', |y + 110 turn - f| <= t.

    A hole of radius R holds the gauge of radius r off by e if e + r <= R, at its maximum material boundary. At the
    least one a circle in the material about it holds the hole: e + R <= r. Of pins each is the other way round.
    """
    count = 250
    text = plate("[floor, bore, slot]", BOTH.format("least").replace("mmb", key))
    text = text.replace("near off", "near on").replace(SIZES["bore"], UNIFORM)
    text = text.replace(f"{SIZES['slot']}, limits: [0 mm, 0.1 mm]", UNIFORM)
    far = "far off: {kind: plus_minus, of: plate.far, along: [0, 1, 0], datums: [floor, bore, slot], distribution: "
    text = text.replace(far + constant(0.0), far + "{kind: uniform, lower: -0.4 mm, upper: 0.4 mm}")
    if not inner:
        text = text.replace("hole: true", "hole: false").replace("width: 8 mm", "width: 8 mm, tab: true")
    made = assembled(text, tmp_path)
    trials = drawn(made.simulation, 0, count)
    named = {own.name: trials.deviations[:, where][:, 0] for own, where in made.slices}
    bore, slot = named["bore size"], named["slot size"]
    holds = inner == (key == "mmb")  # larger features leave more room
    rooms = [(s + t) / 2 if holds else (0.1 - s + t) / 2 for s, t in ((bore, 0.02), (slot, 0.03), (slot, 0.03))]
    rows = np.array([[1.0, 0.0, 0.0], [1.0, 72.0, 0.0], [1.0, 88.0, 0.0], [1.0, 110.0, -1.0]])
    limits = np.stack([*rooms, named["far off"]])
    both = [rows, -rows * np.array([1.0, 1.0, -1.0])]  # t counts on both sides
    sides = [limits, np.stack([*rooms, -named["far off"]])]
    most = linprog(
        np.tile([0.0, 0.0, 1.0], count),
        sparse.vstack([sparse.kron(sparse.eye(count), own) for own in both]),
        np.concatenate([own.T.ravel() for own in sides]),
        bounds=[(None, None), (None, None), (0.0, None)] * count,
    )
    expected = 2 * most.x[2::3]
    assert (expected > 1e-3).mean() > 0.3
    assert (expected < 1e-9).any()
    for method, within in (("analytic", 1e-6), ("exact", 1e-4)):
        np.testing.assert_allclose(made.values(trials, method)["least"], expected, atol=within, rtol=0)


def test_centred_gauges_read_as_datums_regardless_of_size_where_these_lie_true(tmp_path: Path) -> None:
    centred, plain = (
        assembled(plate(own, far=0.02), tmp_path) for own in (BOTH.format("centred"), "[floor, bore, slot]")
    )
    for method in ("exact", "analytic"):
        one, other = (own.values(drawn(own.simulation, 0, 4), method) for own in (centred, plain))
        for name in one:
            np.testing.assert_allclose(one[name], other[name], atol=1e-9)
    assert not [own for own in centred.system.contributors if own.name.startswith("shift")]


# what is refused, and what does not go together --------------------------------------------------------------


def test_a_datum_that_does_not_take_its_gauge_is_no_build(tmp_path: Path) -> None:
    """A bore below its gauge of 9.98 mm; one of 9.99 mm takes it."""
    text = plate(BOTH.format("random"))
    for off, expected in ((-0.01, OK), (-0.03, NO_BUILD)):
        made = assembled(text.replace("kind: constant, value: 0.06 mm", f"kind: constant, value: {off} mm"), tmp_path)
        answers = made.system.method("exact", None).answers(drawn(made.simulation, 0, 5), made.system.measures)
        assert set(answers.status["far y"].tolist()) == {expected}


WRONG: dict[str, tuple[str, str, str, str]] = {
    "regardless of size between them": (
        "[floor, {feature: bore, mmb: random}, {feature: slot, mmb: random}]",
        "[{feature: bore, mmb: random}, floor, {feature: slot, mmb: random}]",
        "tolerances.near off.datums",
        "expected datums at their boundary next to each other, got 'floor' after 'plate.bore'; "
        "give it mmb as well, or name it first or last",
    ),
    "several after it": (
        "[floor, {feature: bore, mmb: random}, {feature: slot, mmb: random}]",
        "[floor, {feature: bore, mmb: random}, far-slot]",
        "tolerances.near off.datums",
        "expected one face, hole, pin, axis or slot after 'plate.bore' at its boundary, got 'far'; "
        "give it mmb as well, or name it first",
    ),
    "two ways to lie": (
        "{feature: slot, mmb: random}",
        "{feature: slot, mmb: centred}",
        "tolerances.near off.datums",
        "expected one mmb (or lmb) for all datums of a frame, for their gauges are of one piece",
    ),
    "both boundaries": (
        "{feature: slot, mmb: random}",
        "{feature: slot, mmb: random, lmb: random}",
        "tolerances.near off.datums[2].lmb",
        "expected one boundary: mmb or lmb, got both",
    ),
    "without a size": (
        "  slot size: {kind: size, of: plate.slot, distribution: {kind: constant, value: 0.05 mm}, "
        "limits: [0 mm, 0.1 mm]}\n",
        "",
        "tolerances.near off.datums",
        "expected a tolerance of the size of 'plate.slot', which makes the gauge's room; add one of kind size",
    ),
    "without a zone at its place": (
        "datums: [floor, bore]}\n  slot size",
        "datums: [floor]}\n  slot size",
        "tolerances.near off.datums",
        "expected a zone of 'plate.slot' to floor, bore, which makes its virtual condition there; "
        "add a position to these datums, or an orientation",
    ),
}


@pytest.mark.parametrize(("old", "new", "place", "said"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_said(old: str, new: str, place: str, said: str, tmp_path: Path) -> None:
    first = refusal(edited(plate(BOTH.format("random")), (old, new)), tmp_path).splitlines()[0]
    assert first == f"{place}: {said}"
