"""RV reducers whose sun, pin ring and carrier lie in bores of parts with drawings."""

from pathlib import Path

import numpy as np
import pytest
from machine.housed import gearbox_of, system_of, values
from numpy.typing import NDArray
from oracles.drawn_columns import DrawnColumns
from oracles.whole_reducer import Numbers, WholeReducer

from tol3d import SceneError
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.regressors import regressor_count
from tol3d.study.system.trials import Trials
from tol3d.study.trials.columns import columns_of

Array = NDArray[np.float64]

CENTRAL = ("sun", "pin ring", "carrier")
PART = {"sun": "input gear"}
OWN = Numbers(
    pins=12, circle=30.0, pin_radius=3.0, eccentricity=1.2, shift=-0.06, offset=-0.04, rotation=0.0, width=8.0,
    discs=2, cranks=3, window=0.5, cranks_circle=15.0, teeth=(20, 40), module=0.5,
)  # fmt: skip
RATIO = 1 + 2 * 12
LAW = "distribution: {kind: uniform, lower: -20 um, upper: 20 um}"
RANDOM = "distribution: {kind: rayleigh, scale: 2 um}"
BORES = "".join(
    f"\n      {name} bore: {{kind: cylinder, at: [0 mm, 0 mm, {z} mm], axis: [0, 0, 1], length: 10 mm, diameter: 9 mm}}"
    for name, z in (("sun", -40), ("pin ring", 0), ("carrier", 40))
)
MOVED = "".join(
    f"\n  {name} bore {axis}: {{kind: plus_minus, of: housing.{name} bore, along: {along}, {LAW}}}"
    for name in CENTRAL
    for axis, along in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
)
OF_REDUCER = f"""
  sun teeth: {{kind: tooth_thickness, of: input gear, {LAW}}}
  sun: {{kind: eccentricity, of: input gear, distribution: {{kind: rayleigh, scale: 3 um}}}}
  run-out: {{kind: disc_eccentricity, of: disc, each: disc, distribution: {{kind: rayleigh, scale: 2 um}}}}
  bearing: {{kind: carrier_bearing, of: carrier, distribution: {{kind: rayleigh, scale: 2 um}}}}
  circle: {{kind: pin_circle, of: pin ring, {LAW}}}"""
PLAYS = """
  play: {kind: bearing_play, of: carrier, each: hole, distribution: {kind: uniform, lower: 0 um, upper: 10 um}}"""


MODIFIED = "shift: -60 um, offset: -40 um"


def scene(
    *, tolerances: str = OF_REDUCER + MOVED, laid: tuple[str, ...] = CENTRAL, modified: str = MODIFIED, over: str = ""
) -> str:
    """A reducer of ratio 25 whose sun drives."""
    moves = "".join(
        f"\n  {own} laid: {{kind: shaft_in_bores, shaft: {PART.get(own, own)}, in: [housing.{own} bore]}}"
        for own in laid
    )
    return f"""scene: a reducer in a housing
parts:
  housing:
    kind: solid
    features:{BORES}
  input gear: {{kind: spur_gear, teeth: 20, module: 0.5 mm, face_width: 5 mm}}
  planet gear: {{kind: spur_gear, teeth: 40, module: 0.5 mm, face_width: 4 mm}}
  crankshaft: {{kind: crankshaft, eccentricity: 1.2 mm}}
  disc: {{kind: cycloid_disc, lobes: 11, {modified}, width: 8 mm}}
  pin ring: {{kind: pin_ring, pins: 12, radius: 30 mm, pin_radius: 3 mm}}
  carrier: {{kind: crank_carrier, radius: 15 mm}}
tolerances:{tolerances}
moves:
  base: {{kind: fix, part: housing}}{moves}
  rv: {{kind: rv_reducer, sun: input gear, planet: planet gear, crankshaft: crankshaft, disc: disc, pin_ring: pin ring,
    carrier: carrier, window: 0.5}}
  train: {{kind: train, driven: input gear, output: carrier}}
measures:
  lost motion: {{kind: lost_motion, of: train{over}}}
"""


def drawn_at_random(rng: np.random.Generator, count: int, size: float = 1.0) -> dict[str, Array]:
    """By column without its unit [mm]."""
    named = {f"{name} bore {axis}": 0.02 for name in CENTRAL for axis in "xy"}
    named |= {f"{name}.{axis}": 0.005 for name in ("sun", "bearing") for axis in "xy"}
    named |= {f"run-out.disc {k} {axis}": 0.004 for k in (1, 2) for axis in "xy"}
    found = {name: size * rng.uniform(-most, most, count) for name, most in named.items()}
    return found | {"sun teeth": size * rng.uniform(-0.08, -0.04, count), "circle": size * rng.uniform(0, 0.01, count)}


def test_bores_move_a_reducer_as_a_search_finds(tmp_path: Path) -> None:
    """Within a nanometre at the pitch radius; the bores move it by a thousand times that."""
    system, rng, count = gearbox_of(scene(), tmp_path), np.random.default_rng(5), 6
    of, turns = drawn_at_random(rng, count), rng.random(count)
    still = {name: own * 0 if " bore " in name else own for name, own in of.items()}
    found, unmoved = (values(system, "exact", own, turns)["lost motion"] for own in (of, still))
    at = np.asarray(system.positions(dict.fromkeys(system.streams, turns))["rv"]) / RATIO
    named = {f"{name} [um]": 1e3 * own for name, own in of.items()}
    radius = OWN.eccentricity * OWN.lobes
    assert np.abs(found - unmoved).min() * radius > 1e-3
    for trial in range(count):
        reducer = WholeReducer(OWN, DrawnColumns(named, trial))
        on, back = (reducer.output(float(at[trial]), sense)[0] for sense in (1, -1))
        assert abs(found[trial] - (on - back)) * radius < 1e-6


@pytest.mark.parametrize("tolerances", [OF_REDUCER + MOVED, OF_REDUCER + MOVED + PLAYS])
def test_first_order_and_exact_differ_by_squares(tolerances: str, tmp_path: Path) -> None:
    """Halve all deviations, and the difference is a quarter; discs that are not modified, for that is no deviation."""
    system = gearbox_of(scene(tolerances=tolerances, modified="shift: 0 um, offset: 0 um"), tmp_path)
    rng, count = np.random.default_rng(3), 60
    of, turns = drawn_at_random(rng, count), rng.random(count)
    if PLAYS in tolerances:  # pins further out, for bearings that rest need room
        of["circle"] = of["circle"] + 0.06
        of |= {f"play.hole {k}": np.full(count, 0.005) for k in (1, 2, 3)}
    off = []
    for size in (1.0, 0.5):
        sized = {name: size * own for name, own in of.items()}
        exact, analytic = (values(system, method, sized, turns)["lost motion"] for method in ("exact", "analytic"))
        off.append(float(np.sqrt(np.mean((exact - analytic) ** 2))))
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.3)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_reducer_in_a_true_housing_is_the_reducer_by_itself(method: str, tmp_path: Path) -> None:
    """Read where the sun stands at 500 degrees, and the carrier so at 20."""
    rng, count = np.random.default_rng(8), 20
    of, turns = drawn_at_random(rng, count), rng.random(count)
    of = {name: own for name, own in of.items() if " bore " not in name}
    text = scene(tolerances=OF_REDUCER, over=", over: {at: 500 deg}")
    start, end = text.index("  housing:"), text.index("  input gear:")
    alone = text[:start] + text[end:]
    alone = "\n".join(
        row for row in alone.splitlines() if " laid:" not in row and "base:" not in row and "train:" not in row
    )
    alone = alone.replace("lost_motion, of: train, over: {at: 500", "cycloid_lost_motion, of: rv, over: {at: 20")
    found = values(gearbox_of(text, tmp_path), method, of, turns)["lost motion"]
    wanted = values(system_of(alone, tmp_path), method, of, turns)["lost motion"]
    assert np.ptp(wanted) > 1e-4
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12)


@pytest.mark.parametrize("tolerances", [OF_REDUCER + MOVED, OF_REDUCER + MOVED + PLAYS])
def test_each_bore_has_the_share_that_differences_of_the_lost_motion_give_it(tolerances: str, tmp_path: Path) -> None:
    """Its part in a trial is what the lost motion changes by per deviation there, times the deviation."""
    system = gearbox_of(scene(tolerances=tolerances), tmp_path)
    rng, count = np.random.default_rng(9), 60
    of, turns = drawn_at_random(rng, count), rng.random(count)
    of |= {f"play.hole {k}": np.full(count, 0.005) for k in (1, 2, 3)} if PLAYS in tolerances else {}
    names = [column.rpartition(" ")[0] for own in system.contributors for column in own.columns]
    rows = np.stack([of[name] for name in names], axis=1)
    trials = Trials(rows, system.positions(dict.fromkeys(system.streams, turns)))
    (measure,) = system.measures

    def read(deviations: Array) -> Array:
        own = system.method(ANALYTIC_METHOD, None).answers(Trials(deviations, trials.positions), [measure])
        return np.asarray(own.values["lost motion"][:, 0] * measure.per_internal)

    found = {own.name: np.full((regressor_count(own), count), np.nan) for own in system.contributors}
    system.regress(measure, system.contributors, columns_of(system, None, trials, (measure,)), found)
    spread = np.std(read(rows))
    for name in (f"{name} bore {axis}" for name in CENTRAL for axis in "xy"):
        step = np.where(np.array(names) == name, 1e-6, 0.0)  # mm
        part = (read(rows + step) - read(rows - step)) / 2e-6 * of[name]
        near = np.abs(found[name][0] - part) < 5e-3 * spread  # bearings that rest lead their cranks, to second order
        assert near.mean() > 0.85, name  # of the others another pin or tooth is met within the step
        assert np.std(part) > 0.02 * spread


def test_its_sun_is_where_its_shaft_passes_its_teeth(tmp_path: Path) -> None:
    """Half of the discs, and what lies between, off the middle of the discs, where ring and carrier count."""
    link = gearbox_of(scene(), tmp_path).gears.model.link("rv")
    levels = link.levels
    assert levels["input gear"] == 0.0  # its origin is the driver's
    assert levels["pin ring"] == levels["carrier"]
    assert abs(levels["carrier"]) > 8.0  # mm, the width of a disc


def test_a_pin_ring_beside_the_line_of_the_sun_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError) as caught:
        gearbox_of(scene().replace("[0 mm, 0 mm, 0 mm]", "[0.2 mm, 0 mm, 0 mm]"), tmp_path)
    words = (
        "moves.pin ring laid.in: expected bores on the axis on which its train puts 'pin ring', got 'housing.pin ring "
    )
    assert f"{words}bore', 0.2 mm beside it" in str(caught.value)
