"""A reducer shown and moved: the output by its ratio, the swing its lost motion, contacts where disc and pin meet."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from places import SCENES

from tol3d import Overrides, load_scene, run_scene
from tol3d.errors import InputError
from tol3d.gearing.cycloid.from_scene import rv_system
from tol3d.gearing.cycloid.presenting import PRESENTER
from tol3d.gearing.cycloid.presenting.shown_reducer import RVDisplay, touching_words
from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.shown import ShownReducer, carrier_angles, swung, turned
from tol3d.gearing.cycloid.system import RVSystem
from tol3d.report.body import World
from tol3d.report.motion import motion_of
from tol3d.simulate import replay
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

SCENE = SCENES / "rv_250aii.yaml"


@pytest.fixture(scope="module")
def system() -> RVSystem:
    return rv_system(load_scene(SCENE))


@pytest.fixture(scope="module")
def trial() -> ShownReducer:
    simulation = simulation_of(load_scene(SCENE), Overrides(trials=10))
    system = simulation.system
    assert isinstance(system, RVSystem)
    trials = drawn(simulation, 4, 1)
    return ShownReducer(system.own, system.deviated(trials), float(trials.positions["reducer"][0]))


def test_a_turn_of_the_cranks_turns_the_output_back_by_one_lobe(system: RVSystem) -> None:
    """The error of nominal parts is the same at every crank angle that differs by a turn: one lobe of 39 further."""
    states = turned(ShownReducer(system.own, RVDeviated.nothing(system.own, 1), 0.1), 5)
    assert len(states) == 5
    assert carrier_angles(states)[-1] == pytest.approx(-360 / 39, abs=1e-9)
    assert math.degrees(states[-1].places.phi - states[0].places.phi) == pytest.approx(360.0, abs=1e-9)
    for one, other in zip(states[0].places.discs, states[-1].places.discs, strict=True):
        assert other.at == pytest.approx(one.at, abs=1e-9)  # their centres have gone round once
        assert math.degrees(other.turned - one.turned) == pytest.approx(-360 / 39, abs=1e-9)


def test_the_swing_is_the_lost_motion_of_the_trial(trial: ShownReducer, system: RVSystem) -> None:
    """As the exact method reads it: the turn between the measure's first contacts, the first stage's backlash in it."""
    simulation = simulation_of(load_scene(SCENE), Overrides(trials=10))
    trials = drawn(simulation, 4, 1)
    measure = next(own for own in system.measures if own.name == "lost motion")
    lost = system.method("exact", None).answers(trials, (measure,)).values["lost motion"][0, 0]
    angles = carrier_angles(swung(trial, 5))
    assert math.radians(angles[-1]) == pytest.approx(lost, abs=1e-12)
    assert angles == pytest.approx([share * angles[-1] for share in (0, 0.25, 0.5, 0.75, 1)], abs=1e-12)
    assert [state.touching is None for state in swung(trial, 5)] == [False, True, True, True, False]


def test_between_its_ends_a_tight_swing_has_lobes_and_pins_overlap_and_a_free_one_touches_nothing(
    trial: ShownReducer,
) -> None:
    """Less than no lost motion: pins on both sides would have to give way."""
    between = swung(trial, 3)[1]
    assert touching_words(between, -1e-3) == "lobes and pins overlap"
    assert touching_words(between, 1e-3) == "no pin touches"
    ends = {touching_words(swung(trial, 2)[k], -1e-3) for k in (0, 1)}
    assert all(re.fullmatch(r"disc [12] touches pin \d+", end) for end in ends)


def test_the_contact_lies_on_the_profile_of_the_disc_that_touches(trial: ShownReducer) -> None:
    """By the nearest point of a fine polygon of the disc's profile; lobes' own errors, some um, are not in it."""
    for state in turned(trial, 4):
        assert state.touching is not None
        assert state.contact is not None
        disc, pin = state.touching
        place, profile = state.places.discs[disc], trial.own.profile
        clocking = trial.shapes.discs[disc].clocking
        azimuths = np.linspace(0, 2 * np.pi, 200_001)
        points = profile.points(azimuths)
        seen = (points[..., 0] + 1j * points[..., 1]) * np.exp(1j * (place.turned + clocking)) + place.at
        contact = complex(*state.contact)
        assert np.abs(seen - contact).min() < 0.02  # mm: errors of lobes of 10 um, and chords of 0.004
        assert abs(abs(contact - state.places.pins[pin].at) - profile.pin_radius) < 1e-9


def test_no_motion_of_that_name_and_no_close_up() -> None:
    empty = RVDisplay("trial-1", None)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="--motion: trial-1 has no motion 'roll'; known here: turn, swing"):
        motion_of(empty, "roll", None)
    with pytest.raises(InputError, match="nothing of an RV reducer is shown close up"):
        empty.view("disc")


@pytest.mark.slow
def test_a_run_is_shown_exported_and_moved_with_the_pins_as_one_body(tmp_path: Path) -> None:
    run = run_scene(SCENE, overrides=Overrides(trials=6), out=tmp_path / "run")
    display = PRESENTER.display(run, 2, magnify=1.0)
    names = [body.name for body in display.worlds[0].bodies]
    assert names.count("pin 17") == 1
    assert len(names) == 1 + 40 + 2 + 1 + 3 + 1 + 3  # ring, pins, discs, carrier, cranks, sun, planets
    found = motion_of(display, None, 3)
    assert "pins" in {body.name for body in found.world.bodies}
    assert [frame.marks[0].what for frame in found.frames] == ["first contact"] * 3
    assert [shot.title for shot in found.shots] == ["disc 1", "disc 2", "first contact"]
    assert isinstance(display.worlds[0], World)
    again = replay(run, 2).build
    assert isinstance(again, ShownReducer)
    assert isinstance(display, RVDisplay)
    assert display.shown.seated.output == again.seated.output
