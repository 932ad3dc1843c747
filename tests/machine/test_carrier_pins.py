"""Pins of carriers that are features of parts, against tolerances of the pins themselves."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from machine import test_reducer_in_housing as rv
from machine import test_set_in_housing as planetary
from machine.housed import gearbox_of, system_of, values
from numpy.typing import NDArray
from scene_texts import refusal

from tol3d import SceneError
from tol3d.gearing.machine.nominal import Bore, HousedShaft
from tol3d.gearing.machine.pins import Pins, displacement_name
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.regressors import regressor_count
from tol3d.study.system.trials import Trials
from tol3d.study.trials.columns import columns_of

Array = NDArray[np.float64]

LAW = planetary.LAW
START = 20.0
"""deg; where the first pin lies in the plate as it is drawn."""
ALONE = planetary.scene(moves="", tolerances=planetary.OF_SET)
ALONE = ALONE[: ALONE.index("  housing:")] + ALONE[ALONE.index("\n  sun: {") + 1 :].replace(
    "\n  base: {kind: fix, part: housing}", ""
)
OF_RV = rv.scene(laid=(), tolerances=rv.OF_REDUCER)
OF_RV = OF_RV[: OF_RV.index("  housing:")] + OF_RV[OF_RV.index("  input gear: {") :].replace(
    "\n  base: {kind: fix, part: housing}", ""
)


def placed(radius: float, k: int) -> tuple[float, float, float]:
    angle = math.radians(START + 120 * k)
    return angle, 100 + radius * math.cos(angle), 7 + radius * math.sin(angle)


def plate(radius: float) -> str:
    """A plate whose axis lies at (100, 7) mm, and three pins of 10 mm about it."""
    pins = "".join(
        f"\n      pin {k + 1}: {{kind: axis, at: [{x!r} mm, {y!r} mm, 8 mm], axis: [0, 0, 1], length: 10 mm}}"
        for k in range(3)
        for _, x, y in [placed(radius, k)]
    )
    return f"""
  plate:
    kind: solid
    features:
      bearing: {{kind: axis, at: [100 mm, 7 mm, -30 mm], axis: [0, 0, 1], length: 20 mm}}{pins}"""


def moved(radius: float) -> str:
    """Tolerances of each pin outwards and along the circle, and of the bearing along x and y."""
    found = ""
    for k in range(3):
        angle, _, _ = placed(radius, k)
        for word, turn in (("out", 0.0), ("along", math.pi / 2)):
            direction = f"[{math.cos(angle + turn)!r}, {math.sin(angle + turn)!r}, 0]"
            found += f"\n  {word} {k + 1}: {{kind: plus_minus, of: plate.pin {k + 1}, along: {direction}, {LAW}}}"
    for word, direction in (("bearing x", "[1, 0, 0]"), ("bearing y", "[0, 1, 0]")):
        found += f"\n  {word}: {{kind: plus_minus, of: plate.bearing, along: {direction}, {LAW}}}"
    return found


def drawn(text: str, radius: float, *, pins: str = "plate.pin 1, plate.pin 2, plate.pin 3") -> str:
    """A scene without a housing whose carrier has the pins of a plate."""
    own = f"carrier: carrier, axis: plate.bearing, pins: [{pins}]"
    move = f"\n  base: {{kind: fix, part: plate}}\n  pins: {{kind: carrier_pins, {own}}}"
    text = text.replace("\ntolerances:", f"{plate(radius)}\ntolerances:")
    return text.replace("\nmoves:", f"{moved(radius)}\nmoves:{move}")


RADIUS = sum(planetary.TEETH[:2]) / 2
COUNT = 20


def offsets(rng: np.random.Generator) -> tuple[Array, Array, Array, Array]:
    """Offsets of three pins outwards and along, and of the bearing x and y [mm]."""
    out, along = rng.uniform(-0.01, 0.01, (2, 3, COUNT))
    x, y = rng.uniform(-0.004, 0.004, (2, COUNT))
    return out, along, x, y


def seen(out: Array, along: Array, x: Array, y: Array) -> tuple[Array, Array]:
    """Pins off their places about the bearing, outwards and along (3, trials)."""
    angles = np.array([[placed(1.0, k)[0]] for k in range(3)])
    return out - np.cos(angles) * x - np.sin(angles) * y, along + np.sin(angles) * x - np.cos(angles) * y


def of_plate(out: Array, along: Array, x: Array, y: Array) -> dict[str, Array]:
    found = {"bearing x": x, "bearing y": y}
    return found | {f"{word} {k + 1}": own[k] for word, own in (("out", out), ("along", along)) for k in range(3)}


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_pins_of_a_plate_are_pins_of_planets(method: str, tmp_path: Path) -> None:
    """Pins off their places in the plate, and off its bearing, are `planet_pin` deviations trial by trial."""
    rng = np.random.default_rng(1)
    of, turns, own = planetary.drawn_at_random(rng, COUNT, 3), rng.random(COUNT), offsets(rng)
    of = {name: each for name, each in of.items() if not name.endswith((" x", " y"))}
    radial, tangential = seen(*own)
    pins = {f"outwards.planet {k + 1}": of[f"outwards.planet {k + 1}"] + radial[k] for k in range(3)}
    pins |= {f"round.planet {k + 1}": of[f"round.planet {k + 1}"] + tangential[k] for k in range(3)}
    found = values(gearbox_of(drawn(ALONE, RADIUS), tmp_path), method, of | of_plate(*own), turns)
    alone = system_of(ALONE, tmp_path)
    wanted, without = values(alone, method, of | pins, turns), values(alone, method, of, turns)
    assert np.ptp(wanted["lost motion"] - without["lost motion"]) > 1e-5
    np.testing.assert_allclose(found["lost motion"], wanted["lost motion"], rtol=0, atol=1e-12)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_holes_of_a_plate_are_holes_of_an_rv_reducer_s_carrier(method: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    of, turns, own = rv.drawn_at_random(rng, COUNT), rng.random(COUNT), offsets(rng)
    of = {name: each for name, each in of.items() if " bore " not in name}
    radial, tangential = seen(*own)
    text = OF_RV.replace("\nmoves:", f"\n  holes: {{kind: carrier_hole, of: carrier, each: hole, {rv.RANDOM}}}\nmoves:")
    around = np.exp(2j * np.pi * np.arange(3) / 3)[:, None] * (radial + 1j * tangential)
    holes = {f"holes.hole {k + 1} x": around[k].real for k in range(3)}
    holes |= {f"holes.hole {k + 1} y": around[k].imag for k in range(3)}
    found = values(gearbox_of(drawn(OF_RV, 15.0), tmp_path), method, of | of_plate(*own), turns)
    alone = system_of(text, tmp_path)
    wanted, without = values(alone, method, of | holes, turns), values(alone, method, of, turns)
    assert np.ptp(wanted["lost motion"] - without["lost motion"]) > 1e-5
    np.testing.assert_allclose(found["lost motion"], wanted["lost motion"], rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", ["planetary", "rv"])
def test_each_pin_has_the_share_that_differences_of_the_lost_motion_give_it(kind: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    text = drawn(ALONE, RADIUS) if kind == "planetary" else drawn(OF_RV, 15.0)
    system, own = gearbox_of(text, tmp_path), of_plate(*offsets(rng))
    of = planetary.drawn_at_random(rng, COUNT, 3) if kind == "planetary" else rv.drawn_at_random(rng, COUNT)
    of |= own
    names = [column.rpartition(" ")[0] for each in system.contributors for column in each.columns]
    rows, turns = np.stack([of[name] for name in names], axis=1), rng.random(COUNT)
    trials = Trials(rows, system.positions(dict.fromkeys(system.streams, turns)))
    (measure,) = system.measures

    def read(deviations: Array) -> Array:
        found = system.method(ANALYTIC_METHOD, None).answers(Trials(deviations, trials.positions), [measure])
        return np.asarray(found.values["lost motion"][:, 0] * measure.per_internal)

    regressed = {each.name: np.full((regressor_count(each), COUNT), np.nan) for each in system.contributors}
    system.regress(measure, system.contributors, columns_of(system, None, trials, (measure,)), regressed)
    spread, acting = np.std(read(rows)), {each.name for each in system.acting(measure)}
    for name in own:
        step = np.where(np.array(names) == name, 1e-6, 0.0)  # mm
        part = (read(rows + step) - read(rows - step)) / 2e-6 * of[name]
        assert (np.abs(regressed[name][0] - part) < 1e-3 * spread).mean() > 0.9, name
        assert name in acting


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "a circle of another radius": (
        {"radius": RADIUS + 0.1},
        "moves.pins.pins[0]: expected a pin 25.5 mm off the axis, got 'plate.pin 1' at 25.6 mm",
    ),
    "another order": (
        {"pins": "plate.pin 1, plate.pin 3, plate.pin 2"},
        "moves.pins.pins[1]: expected 120 deg from the first pin to 'plate.pin 3', counter-clockwise about the axis, "
        "got 240 deg",
    ),
    "too few": ({"pins": "plate.pin 1, plate.pin 2"}, "moves.pins.pins: expected 3 pins, as 'set' has, got 2"),
}


@pytest.mark.parametrize(("wrong", "words"), WRONG.values(), ids=WRONG)
def test_it_is_refused_with_one_message(wrong: dict[str, Any], words: str, tmp_path: Path) -> None:
    said = refusal(drawn(ALONE, **{"radius": RADIUS, **wrong}), tmp_path)
    assert words in said
    assert "\n" not in said


def test_another_part_than_a_carrier_has_no_pins(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"pins.carrier: expected the carrier of a planetary set or an RV reducer"):
        gearbox_of(drawn(ALONE, RADIUS).replace("carrier_pins, carrier: carrier", "carrier_pins, carrier: P"), tmp_path)


def test_a_pin_off_the_middle_takes_the_larger_share_of_the_nearer_end() -> None:
    """The axis from z = -40 to 10 mm, the pin's middle at 2 mm: 0.84 of the upper end, 0.16 of the lower one.

    The pin itself is read by its ends at -3 and 7 mm, half of each; its x is that of the carrier turned by 120 deg.
    """
    turn = math.radians(120)
    outwards = np.array([math.cos(turn), math.sin(turn), 0.0])
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 3] = (
        outwards,
        np.cross([0, 0, 1], outwards),
        [30 * outwards[0], 30 * outwards[1], 2],
    )
    frame = np.eye(4)
    frame[2, 3] = -5.0
    first, second = (Bore("p.axis", k, np.array([0, 0, z])) for k, z in enumerate((-40.0, 10.0)))
    axis = HousedShaft("m", "axis", (first, second), frame, "p")
    low, high = (Bore("p.pin", k, np.array([*(30 * outwards[:2]), z])) for k, z in enumerate((-3.0, 7.0)))
    pins = Pins("set", axis, (HousedShaft("m", "pin", (low, high), pose, "p"),))
    found = {own.contributor: np.array(own.matrix) for own in pins.moved()}
    turned = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    for k, share in enumerate((0.16, 0.84)):
        np.testing.assert_allclose(found[displacement_name(axis, k)], -share * turned, atol=1e-12)
        np.testing.assert_allclose(found[displacement_name(pins.pins[0], k)], 0.5 * np.eye(2), atol=1e-12)
