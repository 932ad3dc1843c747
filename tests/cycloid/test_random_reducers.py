"""Random reducers with every kind of error at once, from their scenes to their columns, against a search."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.drawn_columns import DrawnColumns
from oracles.whole_reducer import Numbers, WholeReducer

from tol3d import load_scene
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

ARCMIN = np.degrees(1.0) * 60
TRIALS = 3
RAYLEIGH, NORMAL = "{{kind: rayleigh, scale: {}}}", "{{kind: normal, lower: {}, upper: {}}}"
TOLERANCES = {
    "circle": ("kind: pin_circle, of: a ring", NORMAL.format("-3 um", "3 um")),
    "ring": ("kind: pin_ring_offset, of: a ring", RAYLEIGH.format("1.5 um")),
    "outwards": ("kind: pin_position, of: a ring, each: pin, direction: radial", NORMAL.format("-3 um", "3 um")),
    "round": ("kind: pin_position, of: a ring, each: pin, direction: tangential", NORMAL.format("-3 um", "3 um")),
    "anywhere": ("kind: pin_position, of: a ring, each: pin, direction: random", RAYLEIGH.format("1 um")),
    "radii": ("kind: pin_radius, of: a ring, each: pin", NORMAL.format("-2 um", "2 um")),
    "pitch": ("kind: lobe_pitch, of: a disc, each: lobe", NORMAL.format("-8 um", "8 um")),
    "profile": ("kind: lobe_profile, of: a disc, each: lobe", NORMAL.format("-3 um", "3 um")),
    "run-out": ("kind: disc_eccentricity, of: a disc, each: disc", RAYLEIGH.format("2 um")),
    "disc holes": ("kind: disc_hole, of: a disc, each: hole", RAYLEIGH.format("2 um")),
    "tilts": ("kind: disc_tilt, of: a disc, each: disc", RAYLEIGH.format("0.5 arcmin")),
    "throws": ("kind: crank_eccentricity, of: a crank, each: crank", RAYLEIGH.format("2 um")),
    "throws alike": ("kind: crank_eccentricity, of: a crank, each: disc", RAYLEIGH.format("1 um")),
    "phases": ("kind: crank_phase, of: a crank, each: crank", NORMAL.format("-2 arcmin", "2 arcmin")),
    "holes": ("kind: carrier_hole, of: a carrier, each: hole", RAYLEIGH.format("2 um")),
    "circle of holes": ("kind: carrier_hole, of: a carrier, each: circle", RAYLEIGH.format("1 um")),
    "bearing": ("kind: carrier_bearing, of: a carrier", RAYLEIGH.format("2 um")),
}
OF_GEARS = {
    "sun": ("kind: eccentricity, of: a sun", RAYLEIGH.format("4 um")),
    "planets": ("kind: eccentricity, of: a planet", RAYLEIGH.format("5 um")),
    "sun teeth": ("kind: tooth_thickness, of: a sun", NORMAL.format("-60 um", "-30 um")),
    "planet teeth": ("kind: tooth_thickness, of: a planet, measured: normal", NORMAL.format("-60 um", "-30 um")),
}


def random_numbers(seed: int) -> Numbers:
    """Numbers of a reducer that can be made, with a first stage if its number is even."""
    rng = np.random.default_rng(seed)
    pins, circle = int(rng.integers(6, 62)), float(rng.choice([30.0, 50.0, 80.0, 114.5]))
    eccentricity = round(float(rng.uniform(0.5, 0.85)) * circle / pins, 3)
    k = eccentricity * pins / circle
    largest = circle * min(np.sqrt(27 * (pins - 1) * (1 - k * k) / (pins + 1) ** 3), np.sin(np.pi / pins))
    shift = -rng.uniform(0, 0.03)
    own = Numbers(
        pins,
        circle,
        pin_radius=round(float(rng.uniform(0.4, 0.8) * largest), 3),
        eccentricity=eccentricity,
        shift=round(float(shift), 6),
        offset=round(float(shift * np.sqrt(1 - k * k) + rng.uniform(0.003, 0.025)), 6),
        rotation=round(float(rng.uniform(0, 2e-4)), 9),
        width=10.0,
        discs=int(rng.integers(1, 5)),
        cranks=int(rng.integers(2, 7)),
        window=round(float(rng.uniform(0.3, 0.8)), 2),
        cranks_circle=round(0.55 * circle, 4),
        teeth=None,
        module=1.0,
    )
    if seed % 2:
        return own
    both = round(2 * own.cranks_circle)
    sun = max(12, int(both * rng.uniform(0.45 if own.cranks > 3 else 0.3, 0.65)))
    while both * np.sin(np.pi / own.cranks) <= both - sun + 3:
        sun += 1
    return replace(own, teeth=(sun, both - sun), cranks_circle=round(both / 2 + float(rng.uniform(0, 0.05)), 4))


def scene_of(own: Numbers, at: float) -> str:
    """Its scene; measures at random places and at one [rad]."""
    gears = zip(("a sun", "a planet"), own.teeth or (), strict=False)
    parts = [
        f"{name}: {{kind: spur_gear, teeth: {teeth}, module: {own.module} mm, face_width: 8 mm}}"
        for name, teeth in gears
    ]
    tolerances = TOLERANCES | (OF_GEARS if parts else {})
    given = [f"{name}: {{{kind}, distribution: {law}}}" for name, (kind, law) in tolerances.items()]
    lines = "\n  ".join
    first_stage = ", sun: a sun, planet: a planet" if parts else ""
    place = f"{{at: {at!r} rad}}"
    return f"""
scene: random
parts:
  a crank: {{kind: crankshaft, eccentricity: {own.eccentricity} mm}}
  a disc: {{kind: cycloid_disc, lobes: {own.lobes}, shift: {own.shift!r} mm, offset: {own.offset!r} mm,
           rotation: {own.rotation!r} rad, width: {own.width} mm}}
  a ring: {{kind: pin_ring, pins: {own.pins}, radius: {own.circle} mm, pin_radius: {own.pin_radius} mm}}
  a carrier: {{kind: crank_carrier, radius: {own.cranks_circle} mm}}
  {lines(parts)}
tolerances:
  {lines(given)}
moves:
  move: {{kind: rv_reducer, crankshaft: a crank, disc: a disc, pin_ring: a ring, carrier: a carrier,
         cranks: {own.cranks}, discs: {own.discs}, window: {own.window}{first_stage}}}
measures:
  drive: {{kind: cycloid_transmission_error, of: move}}
  back: {{kind: cycloid_transmission_error, of: move, flank: back}}
  drive there: {{kind: cycloid_transmission_error, of: move, over: {place}}}
  lost there: {{kind: cycloid_lost_motion, of: move, over: {place}}}
study: {{trials: {TRIALS}, seed: 1}}
"""


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_every_kind_of_error_at_once_moves_a_random_reducer_as_a_search_finds(seed: int, tmp_path: Path) -> None:
    """Within a nanometre at the pitch radius, as the search measures pins from their axes: they lean in discs' frames.

    A radius of 19 mm is half a nanometre shorter across a pin that leans by 0.8 minutes of arc.
    """
    own, path = random_numbers(seed), tmp_path / "scene.yaml"
    at = float(np.random.default_rng(seed).uniform(-7.0, 7.0))
    path.write_text(scene_of(own, at), "utf-8")
    simulation = simulation_of(load_scene(path))
    trials = drawn(simulation, 0, TRIALS)
    columns = columns_of(simulation.system, simulation.system.method("exact", None), trials)
    for trial in range(TRIALS):
        one = DrawnColumns(columns, trial)
        reducer, position = WholeReducer(own, one), one.at("move")
        readings = {
            "drive": reducer.output(position, -1),
            "back": reducer.output(position, 1),
            "drive there": reducer.output(at, -1),
        }
        found = {name: columns[f"geometric:{name}"][trial] / ARCMIN for name in (*readings, "lost there")}
        turns = {name: reading[0] for name, reading in readings.items()}
        turns["lost there"] = reducer.output(at, 1)[0] - turns["drive there"]
        for name, turn in turns.items():
            readings_in_it = 2 if name == "lost there" else 1
            assert abs(found[name] - turn) * own.eccentricity * own.lobes < readings_in_it * 1e-6, name
        for name, (_, disc, pin) in readings.items():
            assert (columns[f"{name}: disc"][trial], columns[f"{name}: pin"][trial]) == (disc, pin)
