"""Scenes of RV reducers: what they mean, what is refused and with which number, and how they compare with others."""

import math
import re
from pathlib import Path

import pytest
from places import SCENES
from scene_texts import Edit, refusal, scene_of, written

from tol3d import Overrides, Run, run_scene
from tol3d.gearing.cycloid.from_scene import rv_system
from tol3d.study.system.stated import mean_build

TEXT = (SCENES / "rv_250aii.yaml").read_text("utf-8")


def changed(*changes: Edit) -> str:
    """The scene with some words replaced wherever they match."""
    text = TEXT
    for old, new in changes:
        assert re.search(old, text), old
        text = re.sub(old, new, text)
    return text


REFUSED = {
    "too many lobes": (
        "lobes: 39",
        "lobes: 40",
        "parts.disc.lobes: expected 39 lobes, one fewer than the 40 pins, got 40",
    ),
    "large pins": ("pin_radius: 5 mm", "pin_radius: 9.1 mm", "parts.pin ring.pin_radius: expected less than 8.98"),
    "undercut by the offset": ("offset: -12.795 um", "offset: 4.2 mm", "parts.disc.offset: expected less than"),
    "no clearance": (
        "offset: -12.795 um",
        "offset: -15 um",
        "parts.disc.offset: lobes and pins interfere by 2.206 um: expected an offset of at least -12.794 um with this "
        "shift and rotation, got -15 um",
    ),
    "cusps": (
        "eccentricity: 2.2 mm",
        "eccentricity: 2.9 mm",
        "parts.crankshaft.eccentricity: expected less than 2.8625 mm, the pin circle's radius over the 40 pins",
    ),
    "gears that do not mesh": (
        "crank_carrier, radius: 63 mm",
        "crank_carrier, radius: 58 mm",
        "parts.carrier.radius: sun and planet do not mesh there: ",
    ),
    "planets that overlap": (  # tips of 88 mm; on 63 mm four are 89.1 mm apart, five 74.1 mm
        "cranks: 3",
        "cranks: 5",
        "moves.reducer.cranks: expected at most 4 planets of 88.0000 mm beside each other on this circle, got 5, which "
        "are 74.0609 mm apart",
    ),
    "cranks outside the discs": (  # roots at 114.5 - 0.02 - 2.2 - 5 + 0.0128 mm, less 1 and 2.2 mm
        "crank_carrier, radius: 63 mm",
        "crank_carrier, radius: 105 mm",
        "parts.carrier.radius: expected less than 104.0927 mm, or holes of 4.4 mm for 3 cranks'",
    ),
    "cranks on each other": (  # (4.4 + 1) / (2 sin 60 deg)
        "crank_carrier, radius: 63 mm",
        "crank_carrier, radius: 3 mm",
        "parts.carrier.radius: expected more than 3.1177 mm, or holes of 4.4 mm for 3 cranks'",
    ),
    "holes that no eccentric fills": (
        "lobes: 39,",
        "lobes: 39, hole: 1 mm,",
        "parts.disc.hole: expected more than 4.4 mm, twice the eccentricity: an eccentric reaches "
        "round its crank's axis, got 1 mm",
    ),
    "holes through the lobes": (  # 2 (107.2928 - 1 - 63) mm
        "lobes: 39,",
        "lobes: 39, hole: 90 mm,",
        "parts.disc.hole: expected at most 86.585 mm, which leave a wall of 1 mm to the lobes' roots, got 90 mm",
    ),
    "a window that leaves no pin": (
        "window: 0.7",
        "window: 0.9995",
        "moves.reducer.window: expected less than 0.9969, from where positions have no working pin among 40 pins",
    ),
    "unlike gears": (
        "teeth: 42, module: 2 mm",
        "teeth: 42, module: 1.5 mm",
        "parts.planet.module: expected 2 mm as of 'sun', its mate, got 1.5 mm",
    ),
    "half a first stage": (
        "    planet: planet\n",
        "",
        "moves.reducer.planet: expected a spur gear beside the sun, or neither of them, got none",
    ),
    "a window of more than every lever": (
        "window: 0.7",
        "window: 1.4",
        "moves.reducer.window: expected a number of less than 1, got 1.4",
    ),
    "a fixed direction": (
        "of: sun, distribution: {kind: rayleigh",
        "of: sun, direction: {at: 30 deg}, distribution: {kind: rayleigh",
        "tolerances.sun run-out.direction: expected random",
    ),
    "a tolerance of other things": (
        "tooth_thickness, of: sun, measured: normal, distribution: {kind: normal, lower: -40 um, upper: -20 um}",
        "clocking, of: sun, distribution: {kind: normal, lower: -1 mrad, upper: 1 mrad}",
        "tolerances.sun thinning.kind: expected of an RV reducer one of pin_circle",
    ),
    "a value over a turn": (
        "take: range, positions: 200",
        "take: value, positions: 200",
        "measures.over a turn.take: expected min, max, range, harmonic or curve over a turn, got value",
    ),
    "a range at one position": (
        "flank: drive, over: random",
        "flank: drive, over: random, take: range",
        "measures.transmission error.take: expected value at one position, got range",
    ),
    "an order of no harmonic": (
        "take: range, positions: 200",
        "take: range, order: 3, positions: 200",
        "measures.over a turn.order: expected none beside take: range; only a harmonic has an order, got 3",
    ),
    "an order that is not resolved": (
        "take: range, positions: 200",
        "take: harmonic, order: 100, positions: 200",
        "measures.over a turn.order: expected at most 99, which 200 positions resolve, got 100",
    ),
    "orders of no curve": (
        "take: range, positions: 200",
        r"take: range, orders: [3], positions: 200",
        "measures.over a turn.orders: expected none beside take: range; only a curve has orders",
    ),
}


@pytest.mark.parametrize(("old", "new", "said"), REFUSED.values(), ids=REFUSED.keys())
def test_what_cannot_be_built_or_read_is_refused_with_what_would_do(
    old: str, new: str, said: str, tmp_path: Path
) -> None:
    assert said in refusal(changed((old, new)), tmp_path)


def test_gears_are_alike_whatever_the_units_of_their_angles(tmp_path: Path) -> None:
    """24 deg and 1440 arcmin differ by the last digit of a double."""
    sun = ("teeth: 21, module: 2 mm", "teeth: 21, module: 2 mm, pressure_angle: 24 deg")
    planet = ("teeth: 42, module: 2 mm", "teeth: 42, module: 2 mm, pressure_angle: 1440 arcmin")
    first = rv_system(scene_of(changed(sun, planet), tmp_path)).own.first
    assert first is not None
    assert first.pair.pinion.pressure_angle != first.pair.wheel.pressure_angle


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("lower: -17.5 um, upper: 17.5 um", "lower: -27.5 um, upper: 7.5 um", "interfere at the mean build by"),
        (
            "lower: -40 um, upper: -20 um",
            "lower: 20 um, upper: 40 um",
            "the teeth of sun and planet interfere at the mean",
        ),
    ],
)
def test_interference_at_the_mean_is_refused_with_what_would_do(old: str, new: str, said: str, tmp_path: Path) -> None:
    assert said in refusal(changed((old, new)), tmp_path)


@pytest.fixture(scope="module")
def run_of_rv(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("rv")
    text = "".join(line for line in TEXT.splitlines(keepends=True) if not re.search("over a turn|take: ", line))
    (folder / "scene.yaml").write_text(text, "utf-8")
    return run_scene(folder / "scene.yaml", overrides=Overrides(trials=1000), out=folder / "run")


def bare(tmp_path: Path, discs: int, carrier: bool) -> Path:
    """Cranks held, as the plain Monte Carlo of the oracles has them."""
    text = TEXT[: TEXT.index("\npublished:")]
    text = "".join(
        line
        for line in text.splitlines(keepends=True)
        if not re.search("sun|planet|over a turn|take: |lost motion", line)
    )
    if not carrier:
        text = text.replace("scale: 0.83333333 um", "scale: 0.00000001 um")
    return written(text.replace("discs: 2", f"discs: {discs}"), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("discs", "carrier", "half", "mean"),
    [(1, False, 37.24, 7.30), (1, True, 38.42, 7.30), (2, False, 35.76, 10.94), (2, True, 36.45, None)],
)
def test_half_ranges_are_those_of_a_plain_monte_carlo(
    discs: int, carrier: bool, half: float, mean: float | None, tmp_path: Path
) -> None:
    # of 2 000 000 units, 0.05" standard error (digest: 37.2, 38.4, 35.8, 36.8"; the carrier added to the first contact
    # there gives 38.20 and 36.72", moving the discs as here 38.42 and 36.45"); of 40 000 here 0.33"
    run = run_scene(bare(tmp_path, discs, carrier), overrides=Overrides(trials=40_000), out=tmp_path / "run")
    for method in ("analytic", "geometric"):
        found = run.summary["measures"]["transmission error"][method]
        assert 60 * found["pooled"]["half_span"] == pytest.approx(half, abs=4 * 0.33 + 0.1)
        assert mean is None or 60 * found["mean"] == pytest.approx(mean, abs=0.35)
        assert 60 * found["sigma"] == pytest.approx({1: 12.1, 2: 11.6}[discs], abs=0.4)


@pytest.mark.slow
def test_a_group_of_lobes_is_one_contributor_and_pins_that_touch_are_columns(run_of_rv: Run) -> None:
    shares = run_of_rv.summary["measures"]["transmission error"]["contributors"]
    assert [own["name"] for own in shares].count("disc pitch") == 1
    names = ("transmission error: pin", "transmission error: disc")
    pin, disc = (run_of_rv.columns(*names)[name] for name in names)
    assert set(disc) == {1, 2}
    assert set(pin) == set(range(1, 41))


def test_a_thickness_along_the_normal_counts_as_its_arc(tmp_path: Path) -> None:
    """s_n of a tooth is s cos(alpha): 1/cos 20 deg of it on the reference circle; planets likewise."""
    law = r"distribution: \{kind: normal, lower: -40 um, upper: -20 um\}"
    system = rv_system(scene_of(changed((law, "distribution: {kind: constant, value: -20 um}")), tmp_path))
    deviated = system.deviated(mean_build(system, system.measures[0]))
    arc = -0.020 / math.cos(math.radians(20.0))
    assert deviated.sun_thickness == pytest.approx(arc)
    assert deviated.planet_thickness == pytest.approx(arc)
