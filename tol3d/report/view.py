"""One build in 3D: the teeth in mesh, contact and gap marked, the whole assembly beside. The door to pyvista."""

import ctypes.util
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from tol3d.engines import OK, STATUS_TEXT
from tol3d.errors import InputError
from tol3d.report.assembly import Assembly, PlacedGear, SeatedMesh, Which, assemble
from tol3d.report.number import measured_text
from tol3d.result import Run

Array = NDArray[np.float64]

WINDOW_SIZE: Final = (1800, 1050)  # pixels
DRIVER_COLOUR, DRIVEN_COLOUR, EDGE_COLOUR = "#7FB2D9", "#F0C36D", "#30373F"
CONTACT_COLOUR, GAP_COLOUR = "#00714F", "#C03A00"  # green and vermillion: Okabe and Ito, darkened
EDGE_ANGLE: Final = 25.0  # deg; sharper edges are drawn as lines: tips, ends, not the facets of a flank
TEETH_HIGH: Final = 2.9  # modules from the middle of the teeth in mesh to the upper edge of the picture
GAPS_HIGH: Final = 3.0  # gaps from the middle of the gap to the upper edge of the close-up
LEAST_HIGH: Final = 0.03  # mm; a close-up of no gap at all still shows something
VIEW_ANGLE: Final = 12.0  # deg; enough perspective to show flanks, little enough to look through the gap
WHOLE_ELEVATION: Final = 22.0  # deg; the whole assembly is seen from above the front
PICTURES: Final = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp")


def view_run(
    run: Run,
    which: Which,
    *,
    screenshot: Path | None = None,
    magnify: float = 1.0,
) -> tuple[str, ...]:
    """Show a build of a run in a window, or write a picture of it.

    Args:
        run, which, magnify: see `assemble`.
        screenshot: the picture to write; needs no display.

    Returns:
        what the user should know, such as the magnification in use.

    Raises:
        InputError: no such build, no display to open a window on, or the picture cannot be written.
    """
    if screenshot is not None and screenshot.suffix.lower() not in PICTURES:
        raise InputError(f"{screenshot}: expected a picture ending in {', '.join(PICTURES)}")
    choose_window(needs_display=screenshot is None)
    assembly = assemble(run, which, magnify=magnify)
    plotter = plot(assembly, off_screen=screenshot is not None)
    try:
        if screenshot is None:
            plotter.show(title=f"tol3d · {assembly.label}")
        else:
            plotter.screenshot(screenshot)
    except OSError as error:
        raise InputError(f"{screenshot}: cannot be written ({error.strerror or error}); choose another file") from None
    finally:
        plotter.close()
    shown, *others = (mesh.mesh.name for mesh in assembly.meshes)
    only = (f"shown is {shown}, not {', '.join(others)}",) if others else ()
    return (*assembly.notes, *only)


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


def plot(assembly: Assembly, *, off_screen: bool) -> pv.Plotter:
    """The scene: the teeth in mesh, the whole assembly, a close-up of the gap."""
    seated = _as_seen(assembly.meshes[0])
    parts = [(part, _poly_data(part)) for part in (seated.driver, seated.driven)]
    front = max(float(mesh.bounds[5]) for _, mesh in parts)
    plotter = pv.Plotter(shape="1|2", splitting_position=0.66, off_screen=off_screen, window_size=list(WINDOW_SIZE))
    plotter.enable_anti_aliasing("ssaa", all_renderers=True)
    plotter.subplot(0)
    _draw_teeth(plotter, seated, parts, front)
    _add_title(plotter, _title(assembly), 13)
    plotter.subplot(1)
    _draw_whole(plotter, seated, parts, front)
    plotter.subplot(2)
    _draw_gap(plotter, seated, parts, front)
    return plotter


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


def _poly_data(part: PlacedGear) -> pv.PolyData:
    vertices, triangles = part.mesh()
    faces = np.hstack([np.full((len(triangles), 1), 3), triangles])
    return pv.PolyData(vertices, faces.ravel())


Parts = Sequence[tuple[PlacedGear, pv.PolyData]]


def _add_parts(plotter: pv.Plotter, parts: Parts) -> None:
    plotter.renderer.set_background("white", top="#E9EEF3")
    for (_, mesh), colour in zip(parts, (DRIVER_COLOUR, DRIVEN_COLOUR), strict=True):
        plotter.add_mesh(mesh, color=colour, smooth_shading=False, specular=0.25, specular_power=15, ambient=0.15)
        edges = mesh.extract_feature_edges(EDGE_ANGLE, boundary_edges=False, manifold_edges=False)
        plotter.add_mesh(edges, color=EDGE_COLOUR, line_width=1.2)


def _draw_teeth(plotter: pv.Plotter, seated: SeatedMesh, parts: Parts, front: float) -> None:
    _add_parts(plotter, parts)
    module = seated.driver.gear.module
    size = 0.055 * module
    contact = _in_front(seated, seated.contact, front)
    plotter.add_mesh(pv.Sphere(radius=1.4 * size, center=contact), color=CONTACT_COLOUR)
    plotter.add_mesh(_arrow(contact, seated.normal, 0.85 * module), color=CONTACT_COLOUR)
    behind = contact - module * (0.35 * seated.normal + np.array([0.5, 0.0, 0.0]))
    _add_label(plotter, behind, "contact", CONTACT_COLOUR)
    middle = contact
    if np.isfinite(seated.gap).all():
        ends = [_in_front(seated, point, front) for point in seated.gap]
        plotter.add_mesh(pv.Tube(pointa=ends[0], pointb=ends[1], radius=0.6 * size), color=GAP_COLOUR)
        for end in ends:
            plotter.add_mesh(pv.Sphere(radius=size, center=end), color=GAP_COLOUR)
        beside = np.array([0.5 * module, 0.0, 0.0])
        _add_label(plotter, (ends[0] + ends[1]) / 2 + beside, _gap_text(seated), GAP_COLOUR)
        middle = (contact + (ends[0] + ends[1]) / 2) / 2
    for part, role, aside in zip((seated.driver, seated.driven), ("driver", "driven"), (-1.0, 1.0), strict=True):
        place = middle + module * np.array([2.1 * aside - 0.8, -2.65, 0.0])
        _add_label(plotter, place, f"{part.name} ({role})", EDGE_COLOUR)
    _look(plotter, middle, TEETH_HIGH * module, 0.0)
    _with_perspective(plotter)


def _draw_whole(plotter: pv.Plotter, seated: SeatedMesh, parts: Parts, front: float) -> None:
    _add_parts(plotter, parts)
    module = seated.driver.gear.module
    contact = _in_front(seated, seated.contact, front + module)
    ring = pv.Disc(center=contact, inner=3.2 * module, outer=3.8 * module, normal=(0, 0, 1), c_res=60)
    plotter.add_mesh(ring, color=CONTACT_COLOUR, lighting=False)
    bounds = np.array([mesh.bounds for _, mesh in parts])
    low, high = bounds[:, 0::2].min(axis=0), bounds[:, 1::2].max(axis=0)
    _add_title(plotter, f"{seated.mesh.name}, whole", 10)
    _look(plotter, (low + high) / 2, 0.6 * max(high[1] - low[1], (high[0] - low[0]) * 0.86), WHOLE_ELEVATION)


def _draw_gap(plotter: pv.Plotter, seated: SeatedMesh, parts: Parts, front: float) -> None:
    _add_parts(plotter, parts)
    if not np.isfinite(seated.gap).all():
        _add_title(plotter, "non-working flanks overlap", 10)
        _look(plotter, _in_front(seated, seated.contact, front), 0.5 * seated.driver.gear.module, 0.0)
        return
    ends = np.stack([_in_front(seated, point, front) for point in seated.gap])
    high = max(GAPS_HIGH * seated.gap_value, LEAST_HIGH)
    if seated.gap_value > 0.0:
        plotter.add_mesh(pv.Line(*ends), color=GAP_COLOUR, line_width=4, lighting=False)
    plotter.add_points(ends, color=GAP_COLOUR, point_size=12, render_points_as_spheres=True)
    beside = np.array([0.3 * high, 0.0, 0.0])
    _add_label(plotter, ends.mean(axis=0) + beside, _gap_text(seated), GAP_COLOUR)
    _add_title(plotter, f"close-up, {2000 * high:.0f} µm high", 10)
    _look(plotter, ends.mean(axis=0), high, 0.0)


def _title(assembly: Assembly) -> str:
    seated = assembly.meshes[0]
    turn = np.degrees(np.arctan2(seated.driver.world_from_gear[1, 0], seated.driver.world_from_gear[0, 0])) % 360
    magnified = f", deviations x {assembly.magnify:g}" if assembly.magnify != 1.0 else ""
    status = "" if seated.status == OK else f", {STATUS_TEXT[seated.status]}"
    return f"{assembly.label}{status}{magnified}   driver at {turn:.2f}°"


def _gap_text(seated: SeatedMesh) -> str:
    word = "gap" if seated.gap_value >= 0.0 else "overlap"
    return f"{word} {measured_text(1000 * abs(seated.gap_value), 'um')}"


def _in_front(seated: SeatedMesh, point: Array, front: float) -> Array:
    """A point of a flank at the front ends of the teeth, where it can be seen: along its generator."""
    if seated.mesh.pair.arm_spread:
        return np.asarray(point * (front / point[2]))
    return np.array([point[0], point[1], front])


def _arrow(tip_from: Array, direction: Array, length: float) -> pv.PolyData:
    """An arrow of that length [mm] from a point."""
    return pv.Arrow(start=tip_from, direction=direction, scale=length, tip_radius=0.09, shaft_radius=0.035)


def _add_label(plotter: pv.Plotter, place: Array, text: str, colour: str) -> None:
    plotter.add_point_labels(
        np.asarray(place)[None],
        [text],
        text_color="white",
        shape_color=colour,
        shape_opacity=0.9,
        font_size=20,
        bold=True,
        show_points=False,
        always_visible=True,
        margin=5,
    )


def _add_title(plotter: pv.Plotter, text: str, size: int) -> None:
    actor = plotter.add_text(f" {text} ", position="upper_left", font_size=size, color=EDGE_COLOUR)
    actor.prop.background_color = "white"
    actor.prop.background_opacity = 0.75


def _look(plotter: pv.Plotter, middle: Array, high: float, elevation: float) -> None:
    """Look at a point from the front, `high` mm from it to the upper edge, from some degrees above."""
    angle = np.radians(elevation)
    away = 1000.0 * np.array([0.0, np.sin(angle), np.cos(angle)])
    plotter.camera.focal_point = tuple(middle)
    plotter.camera.position = tuple(middle + away)
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
