"""One build in a 3D window, or as a picture of it. The only module that opens VTK's windows."""

import ctypes.util
import os
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Final

import pyvista as pv

from tol3d.errors import InputError, unwritable
from tol3d.report.body import World
from tol3d.report.drawn_solids import add_title
from tol3d.report.error_arrows import NO_VALUES, values_of, with_errors
from tol3d.report.presenter import Display, Panel, Which, presenter_of, require_bodies
from tol3d.report.whole import draw_whole
from tol3d.study.runs.run import Run

WINDOW_SIZE: Final = (1800, 1050)  # pixels
TITLE_SIZE: Final = 13
LEFT_SHARE: Final = 0.66  # of the window's width, the larger picture
PICTURES: Final = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp")


def view_run(
    run: Run,
    which: Which,
    *,
    screenshot: Path | None = None,
    magnify: float = 1.0,
    close_up: str | None = None,
    presenter: str | None = None,
) -> tuple[str, ...]:
    """Show a build of a run in a window, or write a picture of it.

    Args:
        run: a finished run.
        which: a trial, or "worst", "nominal", "mean".
        screenshot: the picture to write; needs no display.
        magnify: scales the deviations and simulates again.
        close_up: what is shown close up; None: the first there is.
        presenter: import path of what shows the system; by default that of the run's measures.

    Returns:
        what the user should know, such as the magnification in use.

    Raises:
        InputError: no such build or close-up, nothing to show, no display to open a window on, or the picture cannot
            be written.
    """
    _refuse_other(screenshot)
    display = presenter_of(run.found, presenter).display(run, which, magnify=magnify)
    values = values_of(run, which, display.label, run.found.measures)
    return view_build(display, values, screenshot=screenshot, close_up=close_up)


def view_build(
    display: Display,
    values: Mapping[str, str] = NO_VALUES,
    *,
    screenshot: Path | None = None,
    close_up: str | None = None,
) -> tuple[str, ...]:
    """Show a build in a window, or write a picture of it.

    Args:
        display: the build.
        values: of measures, in words; errors that have one are drawn.
        screenshot, close_up: see view_run.

    Returns:
        what the user should know.

    Raises:
        InputError: see view_run.
    """
    _refuse_other(screenshot)
    view = display.view(close_up)
    if not view.panels:
        require_bodies(display)
    choose_window(needs_display=screenshot is None)
    plotter = plot(
        view.panels or (partial(_whole, display.label, with_errors(view.world or display.worlds[0], values)),),
        off_screen=screenshot is not None,
    )
    try:
        if screenshot is None:
            plotter.show(title=f"tol3d · {display.label}")
        else:
            plotter.screenshot(screenshot)
    except OSError as error:
        raise unwritable(screenshot or Path("the window"), error, "choose another file") from None
    finally:
        plotter.close()
    return (*display.notes, *view.notes)


def _refuse_other(screenshot: Path | None) -> None:
    if screenshot is not None and screenshot.suffix.lower() not in PICTURES:
        raise InputError(f"{screenshot}: expected a picture ending in {', '.join(PICTURES)}")


def _whole(label: str, world: World, plotter: pv.Plotter, width_by_height: float) -> None:
    draw_whole(plotter, world, width_by_height)
    add_title(plotter, label, TITLE_SIZE)


def choose_window(*, needs_display: bool) -> None:
    """Without a display let VTK render by EGL or OSMesa at once: it would try X first, and complain.

    Raises:
        InputError: a window is wanted and there is no display, or neither library is there.
    """
    if sys.platform != "linux" or os.environ.get("DISPLAY"):
        return
    if needs_display:
        raise InputError("there is no display to open a window on: write a picture with --screenshot FILE")
    for library, window in (("EGL", "vtkEGLRenderWindow"), ("OSMesa", "vtkOSOpenGLRenderWindow")):
        if ctypes.util.find_library(library):
            os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", window)
            return
    raise InputError("without a display a picture needs libEGL or libOSMesa: install one (Debian: libegl1, libosmesa6)")


def plot(panels: Sequence[Panel], *, off_screen: bool) -> pv.Plotter:
    """The window: the first panel at the left, the others below each other at its right; one alone fills it."""
    several = len(panels) > 1
    plotter = pv.Plotter(
        off_screen=off_screen,
        window_size=list(WINDOW_SIZE),
        shape=f"1|{len(panels) - 1}" if several else (1, 1),
        splitting_position=LEFT_SHARE if several else None,
    )
    plotter.enable_anti_aliasing("ssaa", all_renderers=several)
    for index, draw in enumerate(panels):
        if several:
            plotter.subplot(index)
        left, low, right, high = plotter.renderer.GetViewport()
        draw(plotter, (right - left) * WINDOW_SIZE[0] / ((high - low) * WINDOW_SIZE[1]))
    return plotter
