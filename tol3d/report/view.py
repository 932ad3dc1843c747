"""One build in 3D: the teeth in mesh, contact and gap marked, the whole assembly beside. The door to pyvista."""

import ctypes.util
import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from tol3d.errors import InputError, unwritable
from tol3d.gearing.display import Assembly, PlacedGear, SeatedMesh, Which, assemble
from tol3d.gearing.engines import OK, STATUS_TEXT
from tol3d.gearing.meshing.mesh import ROOT_FINDING_NOISE
from tol3d.gearing.presenting.gap_section import gap_section
from tol3d.gearing.presenting.whole_trains import WholeTrain, whole_trains
from tol3d.report.drawn_solids import (
    CONTACT_COLOUR,
    EDGE_COLOUR,
    GAP_COLOUR,
    add_label,
    add_section,
    add_solid,
    add_title,
    arrow,
    poly_data,
    set_background,
)
from tol3d.report.number import measured_text
from tol3d.report.whole import draw_train, label_beside, label_in_place
from tol3d.runs.run import Run
from tol3d.scene.name import LONGEST_NAME
from tol3d.scene.nearest import hint

Array = NDArray[np.float64]

WINDOW_SIZE: Final = (1800, 1050)  # pixels
LEFT_SHARE: Final = 0.66  # of the window's width, the larger picture
DRIVER_COLOUR, DRIVEN_COLOUR = "#7FB2D9", "#F0C36D"
TEETH_HIGH: Final = 2.9  # modules from the middle of the teeth in mesh to the upper edge of the picture
GAPS_HIGH: Final = 3.0  # gaps from the middle of the gap to the upper edge of the close-up
LEAST_HIGH: Final = 0.03  # mm; a close-up of no gap at all still shows something
LEAST_GAP: Final = 1e-4  # mm; VTK keeps coordinates in single precision, in which nearer ends may be one point
VIEW_ANGLE: Final = 12.0  # deg; enough perspective to show flanks, little enough to look through the gap
FRONT: Final = np.array([0.0, 0.0, 1.0])
FROM_ABOVE: Final = np.array([0.0, np.sin(np.radians(22.0)), np.cos(np.radians(22.0))])  # the front, for the whole
LETTER: Final = 0.14  # modules; a letter of a label, which begins so much further left where it would be cut
ROOMY_NAME: Final = 15  # letters that have room
PICTURES: Final = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp")


def view_run(
    run: Run,
    which: Which,
    *,
    screenshot: Path | None = None,
    magnify: float = 1.0,
    mesh: str | None = None,
) -> tuple[str, ...]:
    """Show a build of a run in a window, or write a picture of it.

    Args:
        run, which, magnify: see `assemble`.
        screenshot: the picture to write; needs no display.
        mesh: which is shown close up, and with it the train behind the same first shaft; None: the first.

    Returns:
        what the user should know, such as the magnification in use.

    Raises:
        InputError: no such build or mesh, no display to open a window on, or the picture cannot be written.
    """
    if screenshot is not None and screenshot.suffix.lower() not in PICTURES:
        raise InputError(f"{screenshot}: expected a picture ending in {', '.join(PICTURES)}")
    assembly = assemble(run, which, magnify=magnify)
    asked = _asked(assembly, mesh)
    choose_window(needs_display=screenshot is None)
    trains = _with_the_shown_first(whole_trains(assembly), asked)
    close = asked or _first(assembly, trains)
    plotter = plot(assembly, trains, close, off_screen=screenshot is not None)
    try:
        if screenshot is None:
            plotter.show(title=f"tol3d · {assembly.label}")
        else:
            plotter.screenshot(screenshot)
    except OSError as error:
        raise unwritable(screenshot or Path("the window"), error, "choose another file") from None
    finally:
        plotter.close()
    return (*assembly.notes, *_left_out(assembly, trains, close))


def _asked(assembly: Assembly, mesh: str | None) -> SeatedMesh | None:
    """The mesh of that name; None where none was asked for.

    Raises:
        InputError: the build shows no such mesh.
    """
    if mesh is None:
        return None
    by_name = {seated.mesh.name: seated for seated in assembly.meshes}
    if mesh not in by_name:
        raise InputError(f"--mesh: no mesh {mesh[:LONGEST_NAME]!r} is shown of this run{hint(mesh, by_name)}")
    return by_name[mesh]


def _with_the_shown_first(trains: Sequence[WholeTrain], close: SeatedMesh | None) -> list[WholeTrain]:
    """The trains in their order, before them the one that a mesh is of."""
    return sorted(trains, key=lambda train: close is not None and close.mesh.driver not in train.shaft_of)


def _first(assembly: Assembly, trains: Sequence[WholeTrain]) -> SeatedMesh | None:
    """The first mesh, of a train its first; None for a train without any."""
    return next((seated for seated in assembly.meshes if not trains or seated.mesh.driver in trains[0].shaft_of), None)


def _left_out(assembly: Assembly, trains: Sequence[WholeTrain], close: SeatedMesh | None) -> Iterator[str]:
    """What the picture does not show."""
    others = [seated.mesh.name for seated in assembly.meshes if seated is not close]
    if close and others:
        what = "close up" if trains else "shown"
        yield f"{what} is {close.mesh.name}, not {', '.join(others)} (choose with --mesh)"
    if len(trains) > 1:
        yield f"shown are the shafts behind {trains[0].root}, not those behind {', '.join(t.root for t in trains[1:])}"


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


def plot(assembly: Assembly, trains: Sequence[WholeTrain], close: SeatedMesh | None, *, off_screen: bool) -> pv.Plotter:
    """The scene: the teeth in mesh, the whole pair, a close-up of the gap; of a train, the train before the teeth."""
    if close is None:
        plotter = pv.Plotter(off_screen=off_screen, window_size=list(WINDOW_SIZE))
        plotter.enable_anti_aliasing("ssaa")
        _draw_train(plotter, assembly, trains[0], close)
        return plotter
    plotter = pv.Plotter(
        shape="1|2", splitting_position=LEFT_SHARE, off_screen=off_screen, window_size=list(WINDOW_SIZE)
    )
    plotter.enable_anti_aliasing("ssaa", all_renderers=True)
    seated = _as_seen(close)
    parts = [(part, poly_data(*part.mesh())) for part in (seated.driver, seated.driven)]
    front = max(float(mesh.bounds[5]) for _, mesh in parts)
    plotter.subplot(1 if trains else 0)
    _draw_teeth(plotter, seated, parts, front)
    add_title(plotter, *((close.mesh.name, 10) if trains else (_title(assembly, close, "driver"), 13)))
    plotter.subplot(0 if trains else 1)
    if trains:
        _draw_train(plotter, assembly, trains[0], close)
    else:
        _draw_whole(plotter, seated, parts, front)
    plotter.subplot(2)
    _draw_gap(plotter, seated, parts, front)
    return plotter


def _draw_train(plotter: pv.Plotter, assembly: Assembly, train: WholeTrain, close: SeatedMesh | None) -> None:
    marks, share, title = {}, 1.0, _build_text(assembly)
    if close:
        place = assembly.model.layout.world_from_mesh[close.mesh.name]
        marks = {f"{close.mesh.name}, close up": place[:3, :3] @ close.contact + place[:3, 3]}
        share, title = LEFT_SHARE, _title(assembly, close, close.mesh.driver)
    picture = draw_train(plotter, train, marks, share * WINDOW_SIZE[0] / WINDOW_SIZE[1])
    (label_beside if plotter.off_screen else label_in_place)(plotter, picture)
    add_title(plotter, title, 13)


def _as_seen(seated: SeatedMesh) -> SeatedMesh:
    """The mesh in the coordinates of the picture: x to the right, y up, z towards the eye."""
    turn = seated.mesh.pair.view_from_world
    pose = np.eye(4)
    pose[:3, :3] = turn
    driver, driven = (
        replace(part, world_from_gear=pose @ part.world_from_gear) for part in (seated.driver, seated.driven)
    )
    return replace(
        seated,
        driver=driver,
        driven=driven,
        contact=turn @ seated.contact,
        normal=turn @ seated.normal,
        gap=seated.gap @ turn.T,
    )


Parts = Sequence[tuple[PlacedGear, pv.PolyData]]


def _add_parts(plotter: pv.Plotter, parts: Parts) -> None:
    set_background(plotter)
    for (_, mesh), colour in zip(parts, (DRIVER_COLOUR, DRIVEN_COLOUR), strict=True):
        add_solid(plotter, mesh, colour)


def _draw_teeth(plotter: pv.Plotter, seated: SeatedMesh, parts: Parts, front: float) -> None:
    _add_parts(plotter, parts)
    module = seated.driver.gear.module
    size = 0.055 * module
    contact = _in_front(seated, seated.contact, front)
    plotter.add_mesh(pv.Sphere(radius=1.4 * size, center=contact), color=CONTACT_COLOUR)
    plotter.add_mesh(arrow(contact, seated.normal, 0.85 * module), color=CONTACT_COLOUR)
    behind = contact - module * (0.35 * seated.normal + np.array([0.5, 0.0, 0.0]))
    add_label(plotter, behind, "contact", CONTACT_COLOUR)
    middle = contact
    if np.isfinite(seated.gap).all():
        ends = [_in_front(seated, point, front) for point in seated.gap]
        if seated.gap_value > LEAST_GAP:
            plotter.add_mesh(pv.Tube(pointa=ends[0], pointb=ends[1], radius=0.6 * size), color=GAP_COLOUR)
        for end in ends:
            plotter.add_mesh(pv.Sphere(radius=size, center=end), color=GAP_COLOUR)
        beside = np.array([0.5 * module, 0.0, 0.0])
        add_label(plotter, (ends[0] + ends[1]) / 2 + beside, _gap_text(seated), GAP_COLOUR)
        middle = (contact + (ends[0] + ends[1]) / 2) / 2
    for part, role, aside in zip((seated.driver, seated.driven), ("driver", "driven"), (-1.0, 1.0), strict=True):
        text = f"{part.name} ({role})"
        over = LETTER * max(0, len(text) - ROOMY_NAME) if aside > 0.0 else 0.0
        place = middle + module * np.array([2.1 * aside - 0.8 - over, -2.65, 0.0])
        add_label(plotter, place, text, EDGE_COLOUR)
    _look(plotter, middle, TEETH_HIGH * module, FRONT)
    _with_perspective(plotter)


def _draw_whole(plotter: pv.Plotter, seated: SeatedMesh, parts: Parts, front: float) -> None:
    _add_parts(plotter, parts)
    module = seated.driver.gear.module
    contact = _in_front(seated, seated.contact, front + module)
    ring = pv.Disc(center=contact, inner=3.2 * module, outer=3.8 * module, normal=(0, 0, 1), c_res=60)
    plotter.add_mesh(ring, color=CONTACT_COLOUR, lighting=False)
    bounds = np.array([mesh.bounds for _, mesh in parts])
    low, high = bounds[:, 0::2].min(axis=0), bounds[:, 1::2].max(axis=0)
    add_title(plotter, f"{seated.mesh.name}, whole", 10)
    _look(plotter, (low + high) / 2, 0.6 * max(high[1] - low[1], (high[0] - low[0]) * 0.86), FROM_ABOVE)


def _draw_gap(plotter: pv.Plotter, seated: SeatedMesh, parts: Parts, front: float) -> None:
    set_background(plotter)
    if not np.isfinite(seated.gap).all():
        _add_parts(plotter, parts)
        add_title(plotter, "non-working flanks overlap", 10)
        _look(plotter, _in_front(seated, seated.contact, front), 0.5 * seated.driver.gear.module, FRONT)
        return
    section = gap_section(seated, [mesh for _, mesh in parts])
    for outline, colour in zip(section.outlines, (DRIVER_COLOUR, DRIVEN_COLOUR), strict=True):
        add_section(plotter, outline, colour)
    high = max(GAPS_HIGH * seated.gap_value, LEAST_HIGH)
    ends = section.ends + 0.01 * high * section.towards  # before the sections
    if seated.gap_value > LEAST_GAP:
        plotter.add_mesh(pv.Line(*ends), color=GAP_COLOUR, line_width=4, lighting=False)
    plotter.add_points(ends, color=GAP_COLOUR, point_size=12, render_points_as_spheres=True)
    right = np.cross([0.0, 1.0, 0.0], section.towards)
    add_label(plotter, section.middle + 0.3 * high * right, _gap_text(seated), GAP_COLOUR)
    add_title(plotter, f"cut across the gap, {2000 * high:.0f} µm high", 10)
    _look(plotter, section.middle, high, section.towards)


def _title(assembly: Assembly, seated: SeatedMesh, driver: str) -> str:
    turn = np.degrees(np.arctan2(seated.driver.world_from_gear[1, 0], seated.driver.world_from_gear[0, 0])) % 360
    status = "" if seated.status == OK else f", {STATUS_TEXT[seated.status]}"
    return f"{_build_text(assembly, status)}   {driver} at {turn:.2f}°"


def _build_text(assembly: Assembly, status: str = "") -> str:
    magnified = f", deviations x {assembly.magnify:g}" if assembly.magnify != 1.0 else ""
    return f"{assembly.label}{status}{magnified}"


def _gap_text(seated: SeatedMesh) -> str:
    word = "gap" if seated.gap_value > -ROOT_FINDING_NOISE else "overlap"
    return f"{word} {measured_text(1000 * abs(seated.gap_value), 'um')}"


def _in_front(seated: SeatedMesh, point: Array, front: float) -> Array:
    """A point of a flank at the front ends of the teeth, where it can be seen: along its generator."""
    if seated.mesh.pair.arm_spread:
        return np.asarray(point * (front / point[2]))
    return np.array([point[0], point[1], front])


def _look(plotter: pv.Plotter, middle: Array, high: float, towards: Array) -> None:
    """Look at a point from the side to which a unit vector shows, `high` mm from it to the picture's upper edge."""
    plotter.camera.focal_point = tuple(middle)
    plotter.camera.position = tuple(middle + 1000.0 * towards)
    plotter.camera.up = (0.0, 1.0, 0.0)
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = high
    plotter.reset_camera_clipping_range()


def _with_perspective(plotter: pv.Plotter) -> None:
    """The same view from near by, so that what lies behind looks smaller."""
    plotter.camera.parallel_projection = False
    middle = np.array(plotter.camera.focal_point)
    distance = plotter.camera.parallel_scale / np.tan(np.radians(VIEW_ANGLE / 2))
    plotter.camera.view_angle = VIEW_ANGLE
    plotter.camera.position = tuple(middle + np.array([0.0, 0.0, distance]))
    plotter.reset_camera_clipping_range()
