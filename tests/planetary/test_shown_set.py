"""Shown sets: teeth stand in spaces, touch, and nowhere overlap; what is said of builds that cannot be shown."""

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from places import SCENES

from tol3d import Overrides, run_scene
from tol3d.errors import InputError
from tol3d.gearing.planetary.exact.shown import ShownSet
from tol3d.gearing.planetary.presenting import PRESENTER
from tol3d.gearing.planetary.presenting.shown_gears import PlanetaryDisplay
from tol3d.gearing.shown.placed import PlacedGear
from tol3d.gears import LEFT, RIGHT, InternalGear, SpurGear
from tol3d.report.motion import motion_of
from tol3d.study.runs.run import Run

Array = NDArray[np.float64]


@pytest.fixture(scope="module", params=["reducer_3k", "reducer_3k_flexible", "every_planetary_field"])
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Run:
    scene = SCENES / f"{request.param}.yaml"
    return run_scene(scene, overrides=Overrides(trials=12), out=tmp_path_factory.mktemp("runs") / request.param)


def shown(run: Run, trial: int | str) -> PlanetaryDisplay:
    display = PRESENTER.display(run, trial, magnify=1.0)
    assert isinstance(display, PlanetaryDisplay)
    return display


def rooms(central: PlacedGear, planet: PlacedGear) -> Array:
    """Distance of every point of the planet's flanks from the flank of the central gear next to it [mm].

    Both by their own involutes: in the central gear's frame a tooth takes up eta -+ inv alpha_y to both sides.
    """
    gear, own = central.perturbed, planet.perturbed
    assert isinstance(own, SpurGear)
    assert isinstance(gear, SpurGear | InternalGear)
    rolls = np.linspace(own.form_roll, own.tip_roll, 400)
    flanks = np.concatenate([own.flank_points(rolls, flank) for flank in (RIGHT, LEFT)])
    turns = 2 * np.pi * np.arange(own.teeth) / own.teeth
    x = np.cos(turns)[:, None] * flanks[:, 0] - np.sin(turns)[:, None] * flanks[:, 1]
    y = np.sin(turns)[:, None] * flanks[:, 0] + np.cos(turns)[:, None] * flanks[:, 1]
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size), np.ones(x.size)])
    seen = np.linalg.inv(central.world_from_gear) @ planet.world_from_gear @ points
    radius, azimuth = np.hypot(seen[0], seen[1]), np.arctan2(seen[1], seen[0])
    tip, base = gear.tip_radius, gear.base_radius
    within = radius > tip if isinstance(gear, InternalGear) else (radius < tip) & (radius > base)
    angle = np.arccos(base / radius[within])
    sense = 1.0 if isinstance(gear, InternalGear) else -1.0
    half = gear.base_half_angle + sense * (np.tan(angle) - angle)
    pitch = 2 * np.pi / gear.teeth
    off = np.abs(azimuth[within] - pitch * np.round(azimuth[within] / pitch))
    return np.asarray(base * (off - half))


@pytest.mark.slow
@pytest.mark.parametrize("trial", [0, 7])
def test_teeth_stand_in_spaces_and_touch_and_nowhere_overlap(run: Run, trial: int) -> None:
    build: ShownSet = shown(run, trial).shown
    own, count = build.own, len(build.own.meshes)
    centrals, planets = build.gears[:count], build.gears[count:]
    least = []
    for k in range(own.planets):
        for m, mesh in enumerate(own.meshes):
            found = rooms(centrals[m], planets[k * len(own.gears) + own.gear_of(mesh)])
            assert found.min() > -1e-6  # mm; points lie on involutes, and contacts were found to 1e-9
            least.append(found.min())
    # 400 points over 6 mm of flank: 15 um apart, whose square over a radius of curvature of some mm is 0.03 um
    assert sum(room < 2e-4 for room in least) >= own.planets
    assert max(least) < 0.15  # of each mesh some flank is nearer than the backlash


def test_every_gear_is_a_body_of_one_world(run: Run) -> None:
    display = shown(run, "mean")
    ((world),) = display.worlds
    own = display.shown.own
    arms = [body for body in world.bodies if body.name.startswith(f"{own.carrier} at planet ")]
    assert len(world.bodies) == len(own.meshes) + own.planets * len(own.gears) + len(arms)
    assert len({body.name for body in world.bodies}) == len(world.bodies)
    heights = {body.name: body.world_from_part[2, 3] for body in world.bodies}
    for mesh in own.meshes:
        assert heights[mesh.central.name] == heights[f"{mesh.planet.name} of planet 1"]


def test_teeth_of_central_gears_lie_off_the_axis_as_the_trial_has_it_in_their_own_frames(run: Run) -> None:
    """In a frame whose x goes through the middle of tooth 0."""
    for trial in (0, 7):
        build: ShownSet = shown(run, trial).shown
        for gear, mesh in zip(build.gears, build.own.meshes, strict=False):
            columns = [f"{mesh.central.name} eccentricity.{axis} [um]" for axis in "xy"]
            wanted = [run.columns()[name][trial] * 1e-3 if name in run.columns() else 0.0 for name in columns]
            off = gear.world_from_gear[:2, :2].T @ gear.world_from_gear[:2, 3]
            np.testing.assert_allclose(off, wanted, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_arms_of_the_carrier_hold_the_planets(tmp_path: Path) -> None:
    """Each pin goes through its planet, from below all gears to the topmost face, and ends there in a ball."""
    run = run_scene(SCENES / "reducer_3k_flexible.yaml", overrides=Overrides(trials=4), out=tmp_path / "run")
    display = shown(run, 1)
    arms = [body for body in display.worlds[0].bodies if body.name.startswith("carrier at planet ")]
    assert len(arms) == 4
    for number, arm in enumerate(arms, 1):
        gear = next(gear for gear in display.shown.gears if gear.name == f"P1 of planet {number}")
        vertices = arm.mesh[0]
        pin = vertices[vertices[:, 2] > 0.0]  # above the middle of the lowest face
        off = np.hypot(*(pin - gear.world_from_gear[:3, 3])[:, :2].T)
        # 0.7 of the bore of 8 mm, the ball 1.2 times as much; deviations of pins, and facets
        assert off.max() == pytest.approx(1.2 * 0.7 * 4.0, abs=0.03)
        assert vertices[:, 2].min() < -6.0
        assert vertices[:, 2].max() > 14.4 + 6.0 - 0.01
    opened = motion_of(display, "opening", 3)
    turned = [np.arctan2(frame.poses[arms[0].name][1, 0], frame.poses[arms[0].name][0, 0]) for frame in opened.frames]
    apart = [np.arctan2(frame.poses[arms[1].name][1, 0], frame.poses[arms[1].name][0, 0]) for frame in opened.frames]
    neared = np.diff(np.array(apart) - np.array(turned))  # the first of a pair goes ahead, the second back
    assert (neared < -0.01 / 26.0).all()


def test_the_held_ring_stands_whatever_turns(tmp_path: Path) -> None:
    run = run_scene(SCENES / "reducer_3k.yaml", overrides=Overrides(trials=4), out=tmp_path / "run")
    for trial in range(4):
        ring = shown(run, trial).shown.gears[1]
        assert ring.name == "ring 1"
        turn = math.atan2(ring.world_from_gear[1, 0], ring.world_from_gear[0, 0])
        assert turn == pytest.approx(math.pi / 79, abs=1e-9)  # a space of it takes up a tooth of planet 1


def test_what_cannot_be_shown_is_said_in_a_line(run: Run) -> None:
    with pytest.raises(InputError, match="nothing of a planetary set is shown close up"):
        shown(run, 0).view("sun")
    with pytest.raises(InputError, match="expected a number of at least 0"):
        PRESENTER.display(run, 0, magnify=-1.0)
