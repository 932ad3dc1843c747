"""A motion as moving pictures: drawn off screen frame by frame, written as one file."""

import io
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyvista as pv
from PIL import Image, ImageColor

from tol3d.errors import InputError, unwritable
from tol3d.report.body import Arrow
from tol3d.report.drawn_solids import (
    EDGE_COLOUR,
    GAP_COLOUR,
    add_arrow,
    add_body,
    add_dots,
    add_label,
    add_title,
    look,
    set_background,
)
from tol3d.report.error_arrows import NO_VALUES, values_of, with_errors
from tol3d.report.html.document import moving_page
from tol3d.report.motion import Look, Motion, Shot, motion_of
from tol3d.report.presenter import Display, Which, presenter_of, require_bodies
from tol3d.report.view import choose_window
from tol3d.study.runs.atomic_write import write_whole
from tol3d.study.runs.run import Run

Pictures = Sequence[Image.Image]

PAGE: Final = ".html"
ANIMATIONS: Final = (".gif", ".png", ".webp", PAGE)
FRAME_SIZE: Final = (960, 640)  # pixels
LEFT_SHARE: Final = 2 / 3  # of the width, the larger picture
SECONDS: Final = 0.08  # a frame
HELD: Final = 8  # frames for which one in which measures are read is held, and the last one of a returning motion
COLOURS: Final = 64  # of a GIF; few enough for small files, enough for shaded solids
SHADES: Final = (1.0, 0.8, 0.6)  # of a part's colour, that a GIF has
SAMPLED: Final = 5  # frames from which they are chosen
TITLE_SIZE, CAPTION_SIZE = 8, 11
NEAREST: Final = 0.1  # of the distance from the eye to the scene: nothing drawn is nearer
BESIDE: Final = 0.1  # of half the picture's height, from the tip of an arrow to the middle of its name
MARK_RADIUS: Final = 5.5  # pixels


def animate_run(
    run: Run,
    which: Which,
    path: Path,
    *,
    motion: str | None = None,
    frames: int | None = None,
    magnify: float = 1.0,
    presenter: str | None = None,
) -> tuple[str, ...]:
    """Write moving pictures of a build of a run; needs no display.

    Args:
        run: a finished run.
        which: a trial, or "worst", "nominal", "mean".
        path: the file, with the ending of its format: .gif, .png (animated), .webp, or .html for a page in which the
            parts can be turned, of an assembly in its poses or on its paths.
        motion: what moves; None: the first motion there is.
        frames: their number; None: as many as suit the motion.
        magnify: scales the deviations and simulates again.
        presenter: import path of the system's presenter; by default that of the run's measures.

    Returns:
        what the user should know, such as the magnification in use.

    Raises:
        InputError: no such build or motion, nothing that moves, or the file cannot be written.
    """
    if path.suffix.lower() not in ANIMATIONS:
        raise InputError(f"{path}: expected moving pictures ending in {', '.join(ANIMATIONS)}")
    if not path.parent.is_dir():
        raise InputError(f"{path}: there is no folder {path.parent}")
    display = presenter_of(run.found, presenter).display(run, which, magnify=magnify)
    require_bodies(display)
    choose_window(needs_display=False)
    notes = display.notes
    if path.suffix.lower() == PAGE:
        content = moving_page(run, display, which, motion=motion, frames=frames).encode()
    else:
        shown = motion_of(display, motion, frames)
        notes += shown.notes
        values = values_of(run, which, display.label, run.found.measures)
        content = encoded(shown, pictures(shown, display, values), path.suffix.lower())
    try:
        write_whole(path, content)
    except OSError as error:
        raise unwritable(path, error, "choose another file") from None
    return notes


def encoded(motion: Motion, drawn: Iterator[Image.Image], suffix: str) -> bytes:
    """Moving pictures as the content of a file.

    Args:
        motion: whose frames are drawn.
        drawn: each frame once, in their order.
        suffix: one of ANIMATIONS, not that of a page.
    """
    kept = list(drawn)
    if suffix == ".gif":
        marks = [*motion.colours.values(), EDGE_COLOUR, "#FFFFFF"]
        if not motion.colours:  # else parts fill the picture
            marks += [GAP_COLOUR, *(shade for own in motion.world.drawn for shade in _shades(own.colour))]
        kept = list(_few_colours(kept, dict.fromkeys(marks)))
    played = motion.played
    ends = (0, len(kept) - 1) if motion.back else ()
    lasts = [1000 * SECONDS * (HELD if k in ends or motion.frames[k].stop else 1) for k in played]
    first, *others = [kept[k] for k in played]
    options: dict[str, Any] = {
        ".gif": {"format": "GIF", "optimize": False, "disposal": 1},
        ".png": {"format": "PNG", "default_image": False},
        ".webp": {"format": "WEBP", "quality": 80, "method": 4},
    }[suffix]
    stream = io.BytesIO()
    first.save(stream, save_all=True, append_images=others, duration=[round(last) for last in lasts], loop=0, **options)
    return stream.getvalue()


def _shades(colour: str) -> Iterator[str]:
    """A colour "#RRGGBB" as lit faces have it, and others less."""
    for light in SHADES:
        yield "#" + "".join(f"{round(light * part):02X}" for part in ImageColor.getrgb(colour)[:3])


def _few_colours(drawn: Pictures, exact: Collection[str]) -> Iterator[Image.Image]:
    """Pictures in the colours of some of them and some exact ones, "#RRGGBB": static pixels stay unchanged.

    They are not dithered: noise that changes from frame to frame would triple the file.
    """
    some = [np.asarray(drawn[k]) for k in np.unique(np.linspace(0, len(drawn) - 1, SAMPLED).astype(int))]
    common = Image.fromarray(np.concatenate(some)).quantize(COLOURS, method=Image.Quantize.MEDIANCUT)
    palette = Image.new("P", (1, 1))
    own = (common.getpalette() or [])[: 3 * COLOURS]
    palette.putpalette([*own, *(part for colour in exact for part in ImageColor.getrgb(colour))])
    for picture in drawn:
        yield picture.quantize(palette=palette, dither=Image.Dither.NONE)


def pictures(motion: Motion, display: Display, values: Mapping[str, str] = NO_VALUES) -> Iterator[Image.Image]:
    """Each frame of a motion, drawn.

    Args:
        motion: the motion.
        display: of the build that moves.
        values: of measures, in words; errors that have one are drawn where they are read.
    """
    arrows = {world.name: with_errors(world, values).arrows for world in display.worlds}
    several = len(motion.shots) > 1
    plotter = pv.Plotter(
        off_screen=True,
        window_size=list(FRAME_SIZE),
        shape=f"1|{len(motion.shots) - 1}" if several else (1, 1),
        splitting_position=LEFT_SHARE if several else None,
        border=several,
    )
    plotter.enable_anti_aliasing("ssaa", all_renderers=several)
    try:
        actors = [_begun(plotter, motion, place, display.label) for place in range(len(motion.shots))]
        for number in range(len(motion.frames)):
            for place, own in enumerate(actors):
                _move(plotter, motion, place, number, own)
            shot = _chosen(plotter, motion, 0)
            read = [*_read(plotter, arrows.get(motion.frames[number].stop, {}), shot.look(number))]
            plotter.render()
            yield Image.fromarray(np.asarray(plotter.screenshot(return_img=True)))
            for actor in read:
                plotter.remove_actor(actor, render=False)
    finally:
        plotter.close()


def _read(plotter: pv.Plotter, arrows: Mapping[str, Arrow], seen: Look) -> Iterator[pv.Actor]:
    """Draw arrows with their names above or below their tips, where these leave them free; what is drawn."""
    for name, own in arrows.items():
        assert own.length is not None
        yield add_arrow(plotter, own.place, own.direction, own.length)
        beside = math.copysign(BESIDE * seen.high, own.direction @ seen.up) * seen.up
        yield add_label(plotter, own.place + own.length * own.direction + beside, name, GAP_COLOUR, len(name))


def _chosen(plotter: pv.Plotter, motion: Motion, place: int) -> Shot:
    if len(motion.shots) > 1:
        plotter.subplot(place)
    return motion.shots[place]


def _begun(plotter: pv.Plotter, motion: Motion, place: int, label: str) -> Mapping[str, Sequence[pv.Actor]]:
    """Draw the bodies of a shot where they stand in the world; what is drawn of each, by its name."""
    shot = _chosen(plotter, motion, place)
    set_background(plotter)
    found = {}
    for body in motion.world.drawn:
        if shot.shows([body.name]):
            before = set(plotter.renderer.actors)
            add_body(plotter, body)
            found[body.name] = [actor for name, actor in plotter.renderer.actors.items() if name not in before]
    add_title(plotter, f"{label}   {shot.title}" if place == 0 else shot.title, TITLE_SIZE)
    if place == 0:
        _add_legend(plotter, motion.colours)
    return found


def _add_legend(plotter: pv.Plotter, colours: Mapping[str, str]) -> None:
    """Add the legend of marks in the upper right corner, one below the other."""
    for row, (text, colour) in enumerate(colours.items()):
        actor = plotter.add_text(
            f" {text} ", position=(0.99, 0.975 - 0.045 * row), viewport=True, font_size=TITLE_SIZE, color="white"
        )
        actor.prop.justification_horizontal, actor.prop.justification_vertical = "right", "top"
        actor.prop.background_color, actor.prop.background_opacity = colour, 1.0


def _move(
    plotter: pv.Plotter, motion: Motion, place: int, number: int, actors: Mapping[str, Sequence[pv.Actor]]
) -> None:
    """Put the bodies of a shot where they stand in a frame, and what is marked there."""
    shot, frame = _chosen(plotter, motion, place), motion.frames[number]
    for body in motion.world.drawn:
        if body.name in actors and body.name in frame.poses:
            moved = frame.poses[body.name] @ np.linalg.inv(body.world_from_part)
            for actor in actors[body.name]:
                actor.user_matrix = moved
    own = shot.look(number)
    wide, tall = plotter.renderer.GetSize()
    high = max(own.high, own.wide * tall / wide)
    look(plotter, own.middle, high, own.towards, own.up)
    radius = MARK_RADIUS * 2 * high / tall
    for what, colour in motion.colours.items():
        points = [mark.point for mark in frame.marks if mark.what == what and shot.shows(mark.of)]
        # in front of everything: in parallel projection they keep their places
        places = [point + plotter.renderer.length * own.towards for point in points]
        add_dots(plotter, f"{what}, {place}", places, radius, colour)  # pyvista has one namespace for all renderers
    if place == 0:
        caption = plotter.add_text(
            f" {frame.caption} ", position="lower_left", font_size=CAPTION_SIZE, name="caption", render=False
        )
        caption.prop.color, caption.prop.background_color = "white", EDGE_COLOUR
        caption.prop.background_opacity = 0.9
    distance = float(np.linalg.norm(np.array(plotter.camera.position) - own.middle))
    plotter.camera.clipping_range = (NEAREST * distance, 2 * distance)  # marks lie far before the bodies
