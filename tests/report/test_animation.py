"""Moving pictures: as many frames as were asked for, bodies where poses put them, one whole file or none."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence
from rendering import renders
from report.box_presenter import BoxDisplay, box

from tol3d.errors import InputError
from tol3d.report import animation
from tol3d.report.animation import animate_run, encoded, pictures
from tol3d.report.body import World
from tol3d.report.motion import Frame, Look, Mark, Motion, Shot, around, motion_of
from tol3d.report.presenter import Display
from tol3d.study.runs.atomic_write import write_whole

FRONT, UP = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
MARK = "#B0127B"
WIDE, HIGH = animation.FRAME_SIZE


@dataclass(frozen=True)
class MovedBoxes(BoxDisplay):
    """The small box goes along x past the large one."""

    motions: Sequence[str] = ("passing",)

    def motion(self, name: str, frames: int | None) -> Motion:
        return passing(frames or 3)


def at(x: float) -> np.ndarray:
    pose = np.eye(4)
    pose[0, 3] = x
    return pose


def passing(frames: int, back: bool = False) -> Motion:
    """Along x from -40 to 40 mm, the large box 30 mm above, its edge 20 mm; 60 mm to the picture's upper edge."""
    world = World("boxes", (box("small"), box("large")))
    places = np.linspace(-40.0, 40.0, frames).tolist()
    high = at(0.0)
    high[1, 3] = 30.0
    made = tuple(
        Frame(f"at {x:g}", {"small": at(x), "large": high}, (Mark("middle", np.array([x, 0.0, 0.0]), ("small",)),))
        for x in places
    )
    look = Look(np.zeros(3), 60.0, FRONT, UP)
    return Motion(world, made, (Shot("front", (look,)),), {"middle": MARK}, back=back)


def boxes() -> MovedBoxes:
    return MovedBoxes("trial-1", (), (World("all", (box("small"), box("large"))),))


def middle_of(picture: Image.Image, colour: str) -> tuple[float, float]:
    """Middle of the pixels of about a colour, without the legend's: column, row."""
    rgb = np.asarray(picture.convert("RGB"), dtype=int)[HIGH // 6 : 9 * HIGH // 10]
    found = np.abs(rgb - np.array([*bytes.fromhex(colour[1:])])).max(axis=2) < 6
    rows, columns = np.nonzero(found)
    return float(columns.mean()), float(rows.mean()) + HIGH // 6


@renders
def test_marked_bodies_stand_in_the_pictures_where_their_poses_put_them() -> None:
    drawn = list(pictures(passing(3), boxes()))
    assert len(drawn) == 3
    pixels = HIGH / 120.0  # a mm
    for picture, x in zip(drawn, (-40.0, 0.0, 40.0), strict=True):
        column, row = middle_of(picture, MARK)
        assert column == pytest.approx(WIDE / 2 + x * pixels, abs=1.5)
        assert row == pytest.approx(HIGH / 2, abs=1.5)


@pytest.mark.parametrize("suffix", [".gif", ".png", ".webp"])
def test_a_file_of_each_format_opens_with_its_frames_there_and_back(suffix: str, tmp_path: Path) -> None:
    colours = [(255, 0, 0), (0, 255, 0), (0, 0, 255)]
    drawn = [Image.new("RGB", (40, 30), colour) for colour in colours]
    path = tmp_path / f"boxes{suffix}"
    write_whole(path, encoded(passing(3, back=True), iter(drawn), suffix))
    with Image.open(path) as found:
        assert len(list(ImageSequence.Iterator(found))) == 4  # 0, 1, 2, 1
        for place, colour in enumerate([colours[k] for k in (0, 1, 2, 1)]):
            found.seek(place)
            assert np.abs(np.array(found.convert("RGB").getpixel((20, 15))) - colour).max() < 12  # webp rounds
        assert path.stat().st_size < 5000


def test_frames_are_played_there_and_back() -> None:
    assert passing(4).played == (0, 1, 2, 3)
    assert passing(4, back=True).played == (0, 1, 2, 3, 2, 1)
    assert passing(2, back=True).played == (0, 1)


def test_a_look_at_all_has_all_in_the_picture() -> None:
    corners = np.array([[x, y, z] for x in (0.0, 4.0) for y in (0.0, 2.0) for z in (0.0, 9.0)])
    found = around(corners, np.array([2.0, 1.0, 4.5]), FRONT, UP)
    assert (found.high, found.wide) == pytest.approx((1.08, 2.16))
    turned = around(corners, np.array([2.0, 1.0, 4.5]), np.array([1.0, 0.0, 0.0]), UP)
    assert (turned.high, turned.wide) == pytest.approx((1.08, 4.86))


def test_what_cannot_be_moved_or_is_not_known_is_refused_in_a_line() -> None:
    still = BoxDisplay("trial-1", (), ())
    with pytest.raises(InputError, match="trial-1: nothing of it can be moved"):
        motion_of(still, None, None)
    with pytest.raises(InputError, match="nothing of it can be moved"):
        motion_of(MovedBoxes("trial-1", (), (), motions=()), None, None)
    moved: Display = boxes()
    with pytest.raises(InputError, match="--motion: trial-1 has no motion 'pasing'; did you mean \"passing\""):
        motion_of(moved, "pasing", None)
    for frames in (0, 1, 361):
        with pytest.raises(InputError, match=f"--frames: expected 2 to 360, got {frames}"):
            motion_of(moved, None, frames)
    assert len(motion_of(moved, "passing", 7).frames) == 7


def test_a_wrong_file_is_refused_before_anything_is_drawn(tmp_path: Path) -> None:
    run = None  # is not asked for anything
    with pytest.raises(InputError, match=r"expected moving pictures ending in \.gif, \.png, \.webp"):
        animate_run(run, 0, tmp_path / "moved.mp4")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="there is no folder"):
        animate_run(run, 0, tmp_path / "nowhere" / "moved.gif")  # type: ignore[arg-type]
