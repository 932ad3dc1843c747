"""An arm that moves: from pose to pose as its joints do, through their play in each, errors of its tool as arrows."""

import base64
import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from browser import Page, browser
from machine.arm_by_hand import AXES, POSES, TOOL, arm_scene, errors, plays, tool_by_hand
from machine.housed import Array
from scene_texts import scene_of

from tol3d import Overrides, run_scene
from tol3d.errors import InputError
from tol3d.gearing.machine.presenting.arm_motion import SWINGING, TRAVELLING
from tol3d.gearing.machine.system import MachineSystem
from tol3d.report.animation import animate_run
from tol3d.report.error_arrows import values_of, with_errors
from tol3d.report.html.view_model import ViewModel
from tol3d.report.motion import Motion, motion_of
from tol3d.report.number import measured_text
from tol3d.report.presenter import Display, presenter_of
from tol3d.study.results.replaying import build_of
from tol3d.study.runs.run import Run

TRIAL = 2
SIZES = (
    "".join(f"\n  off {pose}: {{kind: position_error, of: link 3.tool, from: base, at: {pose}}}" for pose in POSES)
    + "\n  worst: {kind: worst_position_error, of: link 3.tool, from: base}"
)
NEAR = 1e-9
"""mm, and rad times a mm; places are made of a dozen products of numbers of a thousand."""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("arm")
    scene = scene_of(arm_scene(measures=errors() + SIZES), folder)
    return run_scene(scene, overrides=Overrides(trials=4, witness=0), out=folder / "run")


@pytest.fixture(scope="module")
def display(run: Run) -> Display:
    return presenter_of(run.found).display(run, TRIAL, magnify=1.0)


@pytest.fixture(scope="module")
def motion(display: Display) -> Motion:
    return motion_of(display, None, None)


def told(run: Run, pose: str) -> Array:
    """Place of the tool by the arrays of the trial (3,) [mm]."""
    nominal = tool_by_hand(AXES, TOOL, [math.radians(own) for own in POSES[pose]])
    columns = [f"geometric:{component} {pose}" for component in "xyz"]
    return nominal + 1e-3 * np.array([run.columns(own)[own][TRIAL] for own in columns])


def carried(display: Display, motion: Motion, frame: int) -> Array:
    """Place of the tool in a frame (3,) [mm]."""
    world = display.worlds[0]
    body = next(own for own in world.bodies if own.name == "link 3")
    moved = motion.frames[frame].poses["link 3"] @ np.linalg.inv(body.world_from_part)
    return np.asarray((moved @ world.features["link 3.tool"].frame)[:3, 3])


def turned(display: Display, motion: Motion, one: int, other: int) -> Array:
    """Angles (joints,) by which each link turns against the one before from a frame to another [rad], unsigned."""
    links, world = ["base", "link 1", "link 2", "link 3"], {own.name: own for own in display.worlds[0].bodies}
    found = []
    for before, after in pairwise(links):
        relative = []
        for frame in (one, other):
            poses = motion.frames[frame].poses
            first, last = (poses[name] @ np.linalg.inv(world[name].world_from_part) for name in (before, after))
            relative.append(np.linalg.inv(first) @ last)
        turn = (relative[1] @ np.linalg.inv(relative[0]))[:3, :3]
        axis = [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
        found.append(math.atan2(float(np.linalg.norm(axis)), float(np.trace(turn)) - 1.0))
    return np.array(found)


def test_it_goes_through_the_poses_of_the_scene_and_swings_in_each(motion: Motion) -> None:
    stops = [(k, frame.stop) for k, frame in enumerate(motion.frames) if frame.stop]
    last = 2 * SWINGING + TRAVELLING
    assert stops == [(0, "home"), (SWINGING, "home"), (SWINGING + TRAVELLING, "up"), (last, "up")]
    assert [motion.frames[k].caption for k, _ in stops] == ["home", "home", "up", "up"]
    assert motion.frames[SWINGING + 1].caption == "home to up"
    assert motion.back


def test_in_a_pose_of_the_scene_the_tool_stands_where_the_trial_has_it(
    run: Run, display: Display, motion: Motion
) -> None:
    for frame, own in enumerate(motion.frames):
        if own.stop:
            np.testing.assert_allclose(carried(display, motion, frame), told(run, own.stop), rtol=0, atol=NEAR)


def test_the_page_has_the_same_places(run: Run, display: Display, motion: Motion) -> None:
    model = ViewModel(motion="poses")
    model.add("trial", [(1.0, display, "")])
    shown = model.builds[0].states[0].motion
    assert shown is not None
    numbers = np.frombuffer(base64.b64decode(shown.frames), dtype="<f8").reshape(len(motion.frames), -1, 3, 4)
    place = [model.parts[k].part for k in shown.moved].index("link 3")
    tool = display.worlds[0].features["link 3.tool"].frame[:, 3]
    for pose, stop in shown.stops.items():
        for frame in stop.frames:
            np.testing.assert_allclose(numbers[frame, place] @ tool, told(run, pose), rtol=0, atol=NEAR)
    assert "base" not in [model.parts[k].part for k in shown.moved]


def test_the_ends_of_a_swing_are_those_of_the_play_as_often_as_it_is_told(
    run: Run, display: Display, motion: Motion
) -> None:
    seen, _ = build_of(run, TRIAL)
    system = seen.simulation.system
    assert isinstance(system, MachineSystem)
    factor = float(motion.notes[0].partition("× ")[2].partition(",")[0])
    assert factor > 1.0
    for pose, start in (("home", 0), ("up", SWINGING + TRAVELLING)):
        play = plays(system, seen.trials, pose)[0]
        ends = start + SWINGING // 4, start + 3 * SWINGING // 4
        np.testing.assert_allclose(turned(display, motion, *ends), factor * play, rtol=0, atol=1e-9)
        off = (factor - 1.0) * play / 2  # joints lie at that end which is the first
        np.testing.assert_allclose(turned(display, motion, start, ends[0]), off, rtol=0, atol=1e-9)
        for frame in range(*ends):
            assert (turned(display, motion, ends[0], frame) <= factor * play + 1e-9).all()


def test_links_stay_rigid_and_joints_turn_evenly_on_the_way(display: Display, motion: Motion) -> None:
    """Half the way has half the turn of each joint; matrices that are blended would shrink links."""
    start, middle, end = (SWINGING + own * TRAVELLING // 2 for own in (0, 1, 2))
    whole, half = turned(display, motion, start, end), turned(display, motion, start, middle)
    np.testing.assert_allclose(half, whole / 2, rtol=0, atol=1e-9)
    asked = np.radians(np.abs(np.subtract(POSES["up"], POSES["home"])))
    np.testing.assert_allclose(whole, asked, rtol=0, atol=2e-3)  # and half of two plays
    for frame in motion.frames:
        for pose in frame.poses.values():
            np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), rtol=0, atol=1e-12)


@pytest.mark.parametrize("frames", [2, 7, 20, 100])
def test_it_has_as_many_frames_as_are_asked_for(run: Run, display: Display, frames: int) -> None:
    found = motion_of(display, "poses", frames)
    assert len(found.frames) == frames
    assert found.frames[-1].stop == "up"
    for frame in (0, frames - 1):
        pose = found.frames[frame].stop
        np.testing.assert_allclose(carried(display, found, frame), told(run, pose), rtol=0, atol=NEAR)


def test_nominal_parts_without_play_do_not_swing(run: Run) -> None:
    nominal = presenter_of(run.found).display(run, "nominal", magnify=1.0)
    found = motion_of(nominal, None, None)
    assert found.notes == ("its joints have no play",) or len(found.frames) == 2 * SWINGING + TRAVELLING + 1


@pytest.mark.parametrize("magnify", [1.0, 10.0])
def test_an_error_is_an_arrow_with_the_number_of_the_trial(run: Run, magnify: float) -> None:
    display = presenter_of(run.found).display(run, TRIAL, magnify=magnify)
    values = values_of(run, TRIAL, display.label, run.found.measures)
    for pose in POSES:
        world = next(own for own in display.worlds if own.name == pose)
        ((words, arrow),) = with_errors(world, values).arrows.items()
        value = float(run.columns(f"geometric:off {pose}")[f"geometric:off {pose}"][TRIAL])
        assert words.startswith(f"off {pose} {measured_text(value, 'um')}, arrow × ")
        factor = float(words.partition("× ")[2])
        assert arrow.length is not None
        near = 1e-9 if magnify == 1.0 else 0.05  # links turn by more, and their arcs are no lines
        assert arrow.length == pytest.approx(1e-3 * factor * value, rel=near)
        nominal = tool_by_hand(AXES, TOOL, [math.radians(own) for own in POSES[pose]])
        np.testing.assert_allclose(arrow.place, nominal, rtol=0, atol=1e-6)


def test_components_are_drawn_where_no_measure_is_the_whole_error(display: Display) -> None:
    world = display.worlds[0]
    arrows = with_errors(world, {"x home": "1 µm", "z home": "2 µm"}).arrows
    assert sorted(words.partition(",")[0] for words in arrows) == ["x home 1 µm", "z home 2 µm"]
    for arrow, along in zip(arrows.values(), np.eye(3)[[0, 2]], strict=True):
        np.testing.assert_allclose(np.abs(arrow.direction), along, rtol=0, atol=1e-6)
    assert with_errors(world, {}).arrows == {}
    (words,) = with_errors(replace(world, enlarged=1000.0), {"z home": "2 µm"}).arrows
    assert words == "z home 2 µm, arrow × 1000"


def test_a_page_is_refused_of_what_has_no_poses(tmp_path: Path) -> None:
    pair = run_scene("spur_pair", overrides=Overrides(trials=4, witness=0), out=tmp_path / "pair")
    with pytest.raises(InputError, match="a page cannot show it in motion: it has no poses and no path"):
        animate_run(pair, 0, tmp_path / "pair.html")
    assert not (tmp_path / "pair.html").exists()


# in the browser -----------------------------------------------------------------------------------

VIEW = "document.querySelector('figure.view').view"
PLACE = f"""(() => {{ const part = {VIEW}.parts.find((own) => own.userData.part === 'link 3'), m = part.matrix.elements;
  const state = {VIEW}.told.builds[0].states[0], first = state.poses[{VIEW}.parts.indexOf(part)];
  const [x, y, z] = state.features['link 3.tool'], p = [x - first[12], y - first[13], z - first[14]];
  const local = [0, 1, 2].map((k) => first[4 * k] * p[0] + first[4 * k + 1] * p[1] + first[4 * k + 2] * p[2]);
  return [0, 1, 2].map((k) => m[k] * local[0] + m[4 + k] * local[1] + m[8 + k] * local[2] + m[12 + k]); }})()"""
MOMENT = "document.querySelector('[name=moment]')"
CAPTION = "document.querySelector('.caption').textContent"
BUTTON = "document.querySelector('[name=play]')"
SEEN = 2e-3
"""mm; as of the sliders of joints."""


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    with browser() as own:
        yield own


def _set(page: Page, name: str, value: object) -> None:
    event = "input" if name == "moment" else "change"
    page.ask(
        f"(own => {{ own.value = {value!r}; own.dispatchEvent(new Event({event!r}, {{bubbles: true}})); }})"
        f"(document.querySelector('[name={name}]'))"
    )


@pytest.mark.slow
def test_a_page_plays_and_pauses_and_its_tool_stands_where_the_trial_has_it(
    run: Run, page: Page, tmp_path: Path
) -> None:
    animate_run(run, TRIAL, tmp_path / "arm.html")
    page.told.clear()
    page.open(tmp_path / "arm.html")
    page.wait(f"!!{VIEW}")
    assert page.ask(f"{BUTTON}.textContent") == "pause", "it plays"
    page.wait(f"{CAPTION} === 'home to up'")
    page.ask(f"{BUTTON}.click()")
    assert page.ask(f"{BUTTON}.textContent") == "play"
    here = page.ask(f"{MOMENT}.value")
    assert page.ask(f"new Promise((done) => setTimeout(() => done({MOMENT}.value), 300))") == here
    assert "play of the joints × " in page.ask("document.querySelector('.swing').textContent")
    for frame, pose in ((0, "home"), (SWINGING, "home"), (SWINGING + TRAVELLING, "up")):
        _set(page, "moment", frame)
        np.testing.assert_allclose(page.ask(PLACE), told(run, pose), rtol=0, atol=SEEN)
        value = float(run.columns(f"geometric:off {pose}")[f"geometric:off {pose}"][TRIAL])
        number = page.ask("document.querySelector('.names .number').innerText")
        assert number.startswith(f"off {pose} {measured_text(value, 'um')}\narrow × ")
        assert page.ask("document.querySelector('.measured .error').getTotalLength()") > 20.0
    _set(page, "moment", 1)
    assert page.ask("document.querySelectorAll('.names .number').length") == 0, "no number where none was computed"
    _set(page, "measured", "z up")
    assert page.ask(CAPTION) == "up", "it is read there"
    assert page.told == []


@pytest.mark.slow
def test_a_reader_who_wants_no_motion_has_a_page_that_stands_still(run: Run, page: Page, tmp_path: Path) -> None:
    animate_run(run, TRIAL, tmp_path / "arm.html", frames=20)
    page.open(tmp_path / "arm.html")
    page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    page.call("Page.reload")
    page.wait(f"document.readyState === 'complete' && !!{VIEW}")
    still = f"new Promise((done) => setTimeout(() => done({MOMENT}.value), 2500))"
    assert page.ask(still) == "0"
    assert page.ask(f"{BUTTON}.textContent") == "play"
    page.ask(f"{BUTTON}.click()")
    page.wait(f"{MOMENT}.value !== '0'")
