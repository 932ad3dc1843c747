"""First contact by FCL on strips of CAD faces against the exact one: within the strips' chord error."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from tol3d.cad.solids.distance import NearestPoints, cylinder, mesh_surface, put, sphere
from tol3d.gearing.cycloid.exact.contact import ContactStage, leaning
from tol3d.gearing.cycloid.model.profile import DiscProfile, Modification
from tol3d.gearing.cycloid.model.shapes import CycloidDisc, DiscHoles, lobe_strips
from tol3d.gearing.cycloid.model.stage import Deviated
from tol3d.gearing.cycloid.reducer.witness import StripContact

PROFILE = DiscProfile(40, 114.5, 5.0, 2.2, Modification(-0.02, -0.0128, 2e-5))
STAGE = ContactStage(PROFILE, 2, 3, 63.0, 1.5, 0.7)
HOLES = DiscHoles(3, 63.0, 50.0)
LAST_STEP = 1.5e-5 / 0.7  # mm; FCL's cylinders, over the least lever


def drawn(trials: int, seed: int) -> Deviated:
    rng = np.random.default_rng(seed)
    nothing = Deviated.nothing(trials, 40, 2, 3)
    sizes = {field.name: 2e-5 if field.name == "crank_phases" else 0.003 for field in fields(nothing)}
    drawn_ones = {name: size * rng.standard_normal(getattr(nothing, name).shape) for name, size in sizes.items()}
    return replace(nothing, **drawn_ones)


def differences(trials: int, steps: int, seed: int, tilt: float) -> tuple[float, float, float]:
    """Largest difference of both methods at the pitch radius [mm], the chord error, and the share of like pins."""
    strips = lobe_strips(CycloidDisc(20.0, PROFILE, HOLES), steps)
    deviated = drawn(trials, seed)
    phis = np.random.default_rng(seed + 1).uniform(0.0, 2 * math.pi * 39, (trials, 1))
    tilts = tilt * np.random.default_rng(seed + 2).standard_normal((trials, 2, 2))
    exact = STAGE.touches(deviated, phis, leans=leaning(tilts, 20.0))
    fcl = StripContact(STAGE, strips).touches(deviated, phis, tilts=tilts)
    off = float(np.abs(exact.turns - fcl.turns).max()) * PROFILE.pitch_radius
    return off, strips.chord_error, float((exact.places == fcl.places).mean())


@pytest.mark.slow
@pytest.mark.parametrize("tilt", [0.0, 1e-3])  # rad; 20 um at the pitch radius
@pytest.mark.parametrize("steps", [64, 256])
def test_turns_differ_by_the_chord_error_over_the_least_lever_at_most(steps: int, tilt: float) -> None:
    off, chord_error, alike = differences(12, steps, 41, tilt)
    shifted = 1 + 30 * tilt  # by 20 um along a flank whose bend is half a millimetre the lever is another one
    assert off <= shifted * chord_error / 0.7 + LAST_STEP
    assert alike > 0.8  # of 24; pins that touch within a chord error of each other may change places
    assert chord_error == pytest.approx({64: 6.0e-4, 256: 3.8e-5}[steps], rel=0.03)


def test_a_disc_that_clears_its_pins_turns_by_the_clearance_over_the_lever() -> None:
    """With an offset alone the pin with the longest lever is first: at most 85.8 mm, and little less at 40 pins."""
    stage = replace(STAGE, profile=replace(PROFILE, modification=Modification(offset=0.01)), discs=1, rolling=0.0)
    strips = lobe_strips(CycloidDisc(20.0, stage.profile, HOLES), 128)
    phi = -stage.profile.best_phase  # pin 0 has it
    found = StripContact(stage, strips).touches(Deviated.nothing(1, 40, 1, 3), np.array([[phi]]), (1.0,))
    # of second order: (0.01 mm over 85.8 mm) squared times the pin's distance along the normal's foot
    assert found.turns[0, 0, 0] * 85.8 == pytest.approx(0.01, abs=strips.chord_error + 1.5e-5)
    assert found.places[0, 0, 0] == 0


@pytest.mark.slow
def test_a_ball_at_mid_height_is_as_far_from_a_strip_as_the_pin_itself() -> None:
    """FCL iterates distances of cylinders to some 1e-5 mm."""
    strip = lobe_strips(CycloidDisc(20.0, PROFILE, HOLES), 128).right
    flank, pin, ball = mesh_surface(*strip.mesh(0.05)), cylinder(5.0, 24.0), sphere(5.0)
    nearest = NearestPoints()
    for phase in np.linspace(0.3, 2.2, 9):
        centre = PROFILE.pin_centres(phase / 39) + 0.003 * PROFILE.normals(phase / 39)
        for surface in (pin, ball):
            put(surface, np.eye(3), np.array([*centre, 0.0]))
        assert nearest.of(flank, ball).distance == pytest.approx(nearest.of(flank, pin).distance, abs=2e-5)
