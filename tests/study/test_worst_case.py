"""Worst builds lie in the regions of their draws: each kind of dependent draw, held to the drawing by hand."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest
from assembly_trials import assembled
from numpy.typing import NDArray

from tol3d.statistics.distributions import Uniform
from tol3d.study.effects.regions import Codes, Drawing, Rows, Space, Standing, builds_in, random_ends, settled
from tol3d.study.effects.worst_case import Starts, first_starts, joined, worst_case
from tol3d.study.system.draw import Planar
from tol3d.study.system.region import region_of
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]
Build = Mapping[str, Array]

SCENE = """scene: a plate with each dependent draw
parts:
  plate:
    kind: solid
    features:
      A: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [90 mm, 60 mm]}
      widened: &hole
        {kind: cylinder, at: [-30 mm, 5 mm, -10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 10 mm, hole: true}
      least: {kind: cylinder, at: [-10 mm, 5 mm, -10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 10 mm}
      refined: {at: [10 mm, 5 mm, -10 mm], <<: *hole}
      flat: {at: [30 mm, 5 mm, -10 mm], <<: *hole}
      bent: {at: [-30 mm, -15 mm, -10 mm], <<: *hole}
      turned: {at: [-10 mm, -15 mm, -10 mm], <<: *hole}
      datum: {at: [10 mm, -15 mm, -10 mm], <<: *hole}
      beside: {at: [30 mm, -15 mm, -10 mm], <<: *hole}
      groove: {kind: slot, at: [0 mm, 25 mm, -5 mm], normal: [0, 1, 0], width: 8 mm, extent: [60 mm, 10 mm]}
      bore: {at: [40 mm, 25 mm, -10 mm], <<: *hole}
      holes:
        kind: cylinder
        at: [-40 mm, -25 mm, -10 mm]
        axis: [0, 0, 1]
        length: 20 mm
        diameter: 5 mm
        hole: true
        pattern: {rows: 1, columns: 2, pitch: [70 mm, 9 mm]}
  shaft:
    kind: solid
    features:
      face: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [60 mm, 60 mm]}
      pin: {kind: cylinder, at: [0 mm, 0 mm, -10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 9.9 mm}
tolerances:
  widened:
    {kind: position, of: plate.widened, zone: {diameter: 100 um}, modifier: mmc, law: &law {kind: uniform}, datums: [A]}
  widened size: {kind: size, of: plate.widened, distribution: &size {kind: uniform, lower: 10 um, upper: 70 um}}
  least: {kind: position, of: plate.least, zone: {diameter: 100 um}, modifier: lmc, law: {kind: normal}, datums: [A]}
  least size:
    {kind: size, of: plate.least, limits: [-40 um, 30 um], distribution: {kind: uniform, lower: -50 um, upper: 20 um}}
  refined: {kind: position, of: plate.refined, zone: {diameter: 100 um}, modifier: mmc, law: *law, datums: [A]}
  refined upright: {kind: perpendicularity, of: plate.refined, zone: {diameter: 20 um}, modifier: mmc, datums: [A]}
  refined size: {kind: size, of: plate.refined, distribution: *size}
  flat: {kind: position, of: plate.flat, zone: {diameter: 100 um}, modifier: mmc, law: *law, datums: [A]}
  flat upright: {kind: perpendicularity, of: plate.flat, zone: {width: 20 um, along: [1, 0, 0]}, datums: [A]}
  flat size: {kind: size, of: plate.flat, distribution: *size}
  bent: {kind: position, of: plate.bent, zone: {diameter: 100 um}, law: *law, datums: [A]}
  bent straight: {kind: straightness, of: plate.bent, zone: {diameter: 30 um}}
  bent size: {kind: size, of: plate.bent, envelope: true, distribution: *size}
  turned: {kind: position, of: plate.turned, zone: {diameter: 100 um}, modifier: mmc, law: {kind: ring}, datums: [A]}
  turned size: {kind: size, of: plate.turned, distribution: *size}
  datum: {kind: perpendicularity, of: plate.datum, zone: {diameter: 40 um}, modifier: mmc, law: *law, datums: [A]}
  datum size: {kind: size, of: plate.datum, distribution: *size}
  beside:
    kind: position
    of: plate.beside
    zone: {diameter: 100 um}
    law: {kind: uniform}
    datums: [A, {feature: datum, mmb: random}]
  groove: {kind: position, of: plate.groove, zone: {width: 100 um}, modifier: mmc, law: {kind: normal}, datums: [A]}
  groove flat: {kind: flatness, of: plate.groove, zone: {width: 30 um}}
  groove width: {kind: size, of: plate.groove, envelope: true, distribution: *size}
  holes:
    kind: position
    of: plate.holes
    zone: {diameter: 300 um}
    modifier: mmc
    law: {kind: uniform}
    datums: [A]
    lower_segment: {zone: {diameter: 50 um}, datums: [A]}
  holes size: {kind: size, of: plate.holes, distribution: *size}
  bore size: {kind: size, of: plate.bore, distribution: *size}
  pin straight: {kind: straightness, of: shaft.pin, zone: {diameter: 20 um}, law: {kind: normal}}
  pin size: {kind: size, of: shaft.pin, envelope: true, distribution: {kind: uniform, lower: -50 um, upper: 10 um}}
moves:
  bench: {kind: fix, part: plate}
  insert:
    kind: pin_and_hole
    part: shaft
    relations: [{kind: coincident, from: shaft.face, to: plate.A}]
    pairs: [{from: shaft.pin, to: plate.bore}]
    float: {kind: random}
measures:
  clearance: {kind: slack, of: insert}
study: {trials: 10, seed: 1}
"""


def ends(build: Build, name: str) -> float:
    """How far the farther end of an axis lies from its true one [um]."""
    return float(np.linalg.norm(build[name].reshape(2, 2), axis=1).max())


def lean(build: Build, name: str) -> Array:
    """Half the difference of the ends of an axis (2,) [um]."""
    return np.asarray(0.5 * (build[name][2:] - build[name][:2]))


def room_of_the_gauge(build: Build) -> float:
    """How far the ends of the datum's axis lie from the gauge's, beyond their clearance [um].

    The virtual condition of the hole is 10 um (MMC) - 40 um.
    """
    clearance = (build["datum size"][0] + 30.0) / 2
    apart = [np.linalg.norm(build["shift of plate.datum to A"] + sign * build["datum"]) for sign in (-1.0, 1.0)]
    return max(map(float, apart)) - float(clearance)


SIZES = (
    *(f"{word} size" for word in ("widened", "refined", "flat", "bent", "turned", "datum", "bore")),
    "groove width",
    "holes size 1",
    "holes size 2",
)
EXCESS: Mapping[str, Callable[[Build], float]] = {
    "widened": lambda own: ends(own, "widened") - (100 + own["widened size"][0] - 10) / 2,
    "least": lambda own: ends(own, "least") - (100 + max(own["least size"][0] + 40, 0.0)) / 2,
    "least size": lambda own: abs(own["least size"][0] + 15) - 35,
    "refined": lambda own: ends(own, "refined") - (90 + own["refined size"][0]) / 2,
    "refined upright": lambda own: float(np.hypot(*lean(own, "refined"))) - (10 + own["refined size"][0]) / 2,
    "flat": lambda own: ends(own, "flat") - (90 + own["flat size"][0]) / 2,
    "flat upright": lambda own: abs(lean(own, "flat")[0]) - 10,
    "bent": lambda own: ends(own, "bent") - (100 - min(own["bent size"][0] - 10, 30)) / 2,
    "turned": lambda own: abs(float(np.hypot(*own["turned"])) - (90 + own["turned size"][0]) / 2),  # on the edge
    "datum": lambda own: float(np.hypot(*own["datum"])) - (30 + own["datum size"][0]) / 2,
    "shift": room_of_the_gauge,
    "beside": lambda own: ends(own, "beside") - 50,
    "groove": lambda own: (
        float(np.abs(own["groove"]).sum()) - (90 + own["groove width"][0] - min(own["groove width"][0] - 10, 30)) / 2
    ),
    "holes 1": lambda own: ends(own, "holes 1") - (40 + own["holes size 1"][0]) / 2,
    "holes 2": lambda own: ends(own, "holes 2") - (40 + own["holes size 2"][0]) / 2,
    "holes": lambda own: (
        float(np.hypot(*own["holes shift and turn"][:2])) + abs(own["holes shift and turn"][2]) - (300 - 50) / 2
    ),
    "pin straight": lambda own: max(own["pin straight"][0] - min(20, 10 - own["pin size"][0]), -own["pin straight"][0]),
    "pin size": lambda own: abs(own["pin size"][0] + 20) - 30,
    "float": lambda own: float(np.hypot(*own["float of insert"])) / 1e3 - 1,
    "sizes": lambda own: max(abs(own[name][0] - 40) - 30 for name in SIZES),
}
"""How far a build lies beyond each limit of the drawing [um]; <= 0 within."""
ROUNDING = 1e-6  # um


@pytest.fixture(scope="module")
def plate(tmp_path_factory: pytest.TempPathFactory) -> tuple[Space, Array]:
    """The regions of all contributors, and trials to begin from."""
    made = assembled(SCENE, tmp_path_factory.mktemp("plate"))
    space = Space([Drawing(own.name, own.draw, columns) for own, columns in made.slices])
    return space, drawn(made.simulation, 0, 20).deviations


def excess(space: Space, deviations: Array) -> Mapping[str, float]:
    build = {own.name: 1e3 * deviations[own.columns] for own in space.drawings}
    return {name: beyond(build) for name, beyond in EXCESS.items()}


def within(space: Space, deviations: Array) -> list[str]:
    return [f"{name}: {own:.4f}" for name, own in excess(space, deviations).items() if not own <= ROUNDING]


def test_trials_lie_in_the_regions(plate: tuple[Space, Array]) -> None:
    """The check itself: what is drawn lies within, and all ends of a few builds together reach each limit to 1 nm."""
    space, trials = plate
    assert [found for own in trials if (found := within(space, own))] == []
    edge = {name: max(excess(space, own)[name] for own in random_ends(space, 15, seed=2).deviations) for name in EXCESS}
    assert all(own >= -1e-3 for own in edge.values()), edge


def test_builds_between_the_ends_lie_in_the_regions(plate: tuple[Space, Array]) -> None:
    """At any reach, from the middle of what is left, whatever sizes leave it."""
    space, trials = plate
    rng, rows = np.random.default_rng(5), random_ends(space, 30, seed=3)
    reach = np.empty_like(rows.reach)
    for drawing in space.drawings:  # one of each contributor
        reach[:, drawing.columns] = rng.choice([0.0, 0.3, 1.0], size=(len(reach), 1))
    towards = rng.standard_normal(rows.towards.shape) * rng.choice([0.0, 1.0], size=(len(reach), 1))
    for own in (settled(space, Rows(rows.deviations, towards, reach)), builds_in(space, trials)):
        assert [found for build in own.deviations if (found := within(space, build))] == []


@pytest.mark.parametrize("seed", range(2))
def test_the_worst_build_of_random_starts_lies_in_its_region(seed: int, plate: tuple[Space, Array]) -> None:
    """Of a sum of slopes, squares and bends of all deviations: found lower and higher than any start."""
    space, trials = plate
    rng = np.random.default_rng(seed)
    count, scale = len(space.mean), np.where(space.sigmas > 0.0, space.sigmas, 1.0)
    slopes, bends, squares = rng.standard_normal((3, count)) * rng.choice([0.0, 1.0], size=(3, count))
    crossed = rng.permutation(count)

    def built(deviations: Array, positions: Standing) -> tuple[Array, Codes]:
        x = deviations / scale
        found = x @ slopes + np.abs(x) @ bends + (x * x[:, crossed]) @ squares
        return found, np.zeros(len(x), dtype=np.int8)

    several = Rows.joined([builds_in(space, trials[seed::10]), random_ends(space, 2, seed)])
    starts = joined([first_starts(space, built, {}, 2), Starts.both_ways(several, {})])
    found = worst_case(space, built, starts, most=20_000, rounds=3)
    assert found.low is not None
    assert found.high is not None
    begun, _ = built(starts.rows.deviations, {})
    assert found.low.value < begun.min()
    assert found.high.value > begun.max()
    assert within(space, found.low.deviations) == []
    assert within(space, found.high.deviations) == []


@pytest.mark.parametrize(("low", "high", "shortest"), [(2.0, 10.0, 2.0), (-10.0, -2.0, 2.0), (-4.0, 10.0, 0.0)])
def test_lengths_of_a_law_lie_between_its_least_and_its_largest_in_any_direction(
    low: float, high: float, shortest: float
) -> None:
    """A negative length points the other way; what lies between is left where it is."""
    region = region_of(Planar(Uniform(low, high), None), turning=False)
    points = np.array([[3.0, 4.0], [0.6, 0.8], [30.0, -40.0]])
    expected = np.array([[3.0, 4.0], max(shortest, 1.0) * np.array([0.6, 0.8]), [6.0, -8.0]])
    assert region.confined(points) == pytest.approx(expected)
    assert region.furthest(points)[0] == pytest.approx([6.0, 8.0])
