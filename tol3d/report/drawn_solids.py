"""Elements of 3D pictures: solids with their edges, labels and titles."""

from collections.abc import Sequence
from typing import Final

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.vtkFiltersGeneral import vtkContourTriangulator

from tol3d.numerics.arrays import Array
from tol3d.report.body import Body
from tol3d.report.heading import LONGEST, legible

EDGE_COLOUR: Final = "#30373F"
CONTACT_COLOUR, GAP_COLOUR = "#00714F", "#C03A00"  # green and vermillion: Okabe and Ito, darkened
NAME_SIZE: Final = 12
PAINT: Final = "colours"
EDGE_ANGLE: Final = 25.0  # deg; sharper edges are drawn as lines: tips, ends, not the facets of a curved face


def poly_data(vertices: Array, triangles: NDArray[np.int64]) -> pv.PolyData:
    """A triangle mesh for pyvista."""
    faces = np.hstack([np.full((len(triangles), 1), 3), triangles])
    return pv.PolyData(vertices, faces.ravel())


def set_background(plotter: pv.Plotter) -> None:
    """The background of every picture."""
    plotter.renderer.set_background("white", top="#E9EEF3")


def add_body(plotter: pv.Plotter, body: Body) -> None:
    """A body where it stands, with what is shown on it or within it."""
    mesh = poly_data(*body.mesh)
    if body.paint:
        add_painted_solid(plotter, mesh, body.paint, body.opacity)
    elif body.opacity < 1.0:
        add_translucent_solid(plotter, mesh, body.colour, body.opacity)
    else:
        (add_round_solid if body.smooth else add_solid)(plotter, mesh, body.colour)
    if body.detail_mesh is not None:
        add_solid(plotter, poly_data(*body.detail_mesh), body.colour)


def add_solid(plotter: pv.Plotter, mesh: pv.PolyData, colour: str) -> None:
    """A solid and its sharp edges."""
    plotter.add_mesh(mesh, color=colour, smooth_shading=False, specular=0.25, specular_power=15, ambient=0.15)
    _add_edges(plotter, mesh)


def add_translucent_solid(plotter: pv.Plotter, mesh: pv.PolyData, colour: str, opacity: float) -> None:
    """A solid through which one sees, and its sharp edges."""
    plotter.add_mesh(mesh, color=colour, opacity=opacity, smooth_shading=False, specular=0.1, ambient=0.3)
    _add_edges(plotter, mesh)


def add_painted_solid(plotter: pv.Plotter, mesh: pv.PolyData, paint: Sequence[str], opacity: float) -> None:
    """A solid whose triangles have colours "#RRGGBB" of their own, and its sharp edges."""
    mesh.cell_data[PAINT] = np.array([[*bytes.fromhex(own.removeprefix("#"))] for own in paint], dtype=np.uint8)
    specular, ambient = (0.1, 0.3) if opacity < 1.0 else (0.25, 0.15)
    plotter.add_mesh(
        mesh, scalars=PAINT, rgb=True, opacity=opacity, smooth_shading=False, specular=specular, ambient=ambient
    )
    _add_edges(plotter, mesh)


def add_section(plotter: pv.Plotter, outline: pv.PolyData, colour: str) -> None:
    """Add a plane section of a solid, filled, with its outline."""
    filler = vtkContourTriangulator()
    filler.SetInputData(outline)
    filler.Update()
    plotter.add_mesh(pv.wrap(filler.GetOutput()), color=colour, lighting=False)
    plotter.add_mesh(outline, color=EDGE_COLOUR, line_width=1.2, lighting=False)


def add_round_solid(plotter: pv.Plotter, mesh: pv.PolyData, colour: str) -> None:
    """A solid of cylinders and balls, its facets smoothed, and its sharp edges."""
    smooth = mesh.compute_normals(feature_angle=EDGE_ANGLE, split_vertices=True, consistent_normals=False)
    plotter.add_mesh(smooth, color=colour, smooth_shading=True, specular=0.25, specular_power=15, ambient=0.15)
    _add_edges(plotter, mesh)


def _add_edges(plotter: pv.Plotter, mesh: pv.PolyData) -> None:
    edges = mesh.extract_feature_edges(EDGE_ANGLE, boundary_edges=False, manifold_edges=False)
    if edges.n_points:  # a ball has none
        plotter.add_mesh(edges, color=EDGE_COLOUR, line_width=1.2)


def arrow(tip_from: Array, direction: Array, length: float) -> pv.PolyData:
    """An arrow of that length [mm] from a point."""
    return pv.Arrow(start=tip_from, direction=direction, scale=length, tip_radius=0.09, shaft_radius=0.035)


def add_arrow(plotter: pv.Plotter, tip_from: Array, direction: Array, length: float) -> pv.Actor:
    """An arrow of that length [mm] from a point, lit from everywhere; what is drawn."""
    solid = arrow(tip_from, direction, length)
    actor: pv.Actor = plotter.add_mesh(solid, color=GAP_COLOUR, ambient=0.6, reset_camera=False, render=False)
    return actor


def add_dots(plotter: pv.Plotter, name: str, places: Sequence[Array], radius: float, colour: str) -> None:
    """Flat dots of a radius [mm] at points (3,) [mm], in the place of those of that name in the current renderer."""
    plotter.renderer.remove_actor(name, render=False)
    if places:
        dots = pv.merge([pv.Sphere(radius=radius, center=place) for place in places])
        plotter.add_mesh(dots, color=colour, lighting=False, name=name, reset_camera=False, render=False)


def add_label(plotter: pv.Plotter, place: Array, text: str, colour: str, longest: int = LONGEST) -> pv.Actor:
    """A label at a point, of so many letters at most, whatever is in front of it; what is drawn."""
    actor: pv.Actor = plotter.add_point_labels(
        np.asarray(place)[None],
        [legible(text, longest)],
        text_color="white",
        shape_color=colour,
        shape_opacity=0.9,
        font_size=20,
        bold=True,
        show_points=False,
        always_visible=True,
        margin=5,
        reset_camera=False,
        render=False,
    )
    return actor


def add_names_below(plotter: pv.Plotter, left: str, right: str) -> None:
    """Add texts in the lower left and right corners, in letters as large as both have room for."""
    names = plotter.add_text(f" {left} ", position="lower_left", font_size=NAME_SIZE, color="white")
    names.set_text("lower_right", f" {right} ")
    names.prop.bold, names.prop.background_color, names.prop.background_opacity = True, EDGE_COLOUR, 0.9


def add_title(plotter: pv.Plotter, text: str, size: int) -> None:
    """A title in the upper left corner."""
    actor = plotter.add_text(f" {legible(text, len(text))} ", position="upper_left", font_size=size, color=EDGE_COLOUR)
    actor.prop.background_color = "white"
    actor.prop.background_opacity = 0.75


FRONT: Final = np.array([0.0, 0.0, 1.0])
UP: Final = np.array([0.0, 1.0, 0.0])
VIEW_ANGLE: Final = 12.0  # deg; enough perspective to show depth, little enough to look through a gap
FAR: Final = 4.0  # diagonals of all that is drawn, from the scene to the eye; in parallel projection any distance does


def look(plotter: pv.Plotter, middle: Array, high: float, towards: Array, up: Array = UP) -> None:
    """Look along parallels.

    Args:
        plotter: at its current renderer.
        middle: the point (3,) in the middle of the picture [mm].
        high: from there to the picture's upper edge [mm].
        towards: unit vector (3,) to the eye.
        up: unit vector (3,) to the upper edge.
    """
    plotter.camera.focal_point = tuple(middle)
    plotter.camera.position = tuple(middle + FAR * plotter.renderer.length * towards)
    plotter.camera.up = tuple(up)
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = high
    plotter.reset_camera_clipping_range()


def look_from_near(plotter: pv.Plotter, middle: Array, high: float) -> None:
    """Look from the front, from so near that what lies further away looks smaller; see `look`."""
    look(plotter, middle, high, FRONT)
    plotter.camera.parallel_projection = False
    distance = high / np.tan(np.radians(VIEW_ANGLE / 2))
    plotter.camera.view_angle = VIEW_ANGLE
    plotter.camera.position = tuple(middle + distance * FRONT)
    plotter.reset_camera_clipping_range()
