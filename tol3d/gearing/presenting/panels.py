"""The 3D window of a build of gears: the teeth in mesh, contact and gap marked, the whole build, the gap close up."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np
import pyvista as pv

from tol3d.gearing.engines import OK, STATUS_TEXT
from tol3d.gearing.presenting.whole_trains import WholeTrain
from tol3d.gearing.shown.display import SeatedBuild
from tol3d.gearing.shown.placed import SeatedMesh
from tol3d.gears import BevelPair
from tol3d.numerics.arrays import Array
from tol3d.report.drawn_solids import (
    CONTACT_COLOUR,
    FRONT,
    GAP_COLOUR,
    add_label,
    add_names_below,
    add_section,
    add_solid,
    add_title,
    arrow,
    look,
    look_from_near,
    poly_data,
    set_background,
)
from tol3d.report.heading import legible
from tol3d.report.presenter import Panel
from tol3d.report.whole import draw_whole

INSIDE: Final = 0.02  # of the common face; a cut at its very end would miss a tilted gear


@dataclass(frozen=True, eq=False)
class GapSection:
    """Both gears in the plane across which their gap lies.

    Args:
        towards: the plane's normal, a unit vector (3,) along the flanks at the gap, to where bevel gears grow.
        ends: the gap's ends on the driver and on the driven gear, (2, 3) [mm].
        outlines: where the plane cuts the gears, driver and driven, as lines.
    """

    towards: Array
    ends: Array
    outlines: tuple[pv.PolyData, pv.PolyData]

    @property
    def middle(self) -> Array:
        """Middle of the gap, (3,) [mm]."""
        return np.asarray(self.ends.mean(axis=0))


def gap_section(seated: SeatedMesh, meshes: Sequence[pv.PolyData]) -> GapSection:
    """Cut a mesh that stands upright (see `view_from_world`) where its gap was measured.

    The flanks of a bevel gear lead to its apex: a cut at any other place than the gap's shows another gap, and who
    looks along the common pitch line instead of along the flanks sees one of them in the gap.

    Args:
        seated: in the coordinates of the picture, z to the front.
        meshes: of driver and driven, closed, in the same coordinates.
    """
    middle = seated.gap.mean(axis=0)
    pair = seated.mesh.pair
    if isinstance(pair, BevelPair):
        along = float(np.linalg.norm(middle))
        towards = middle / along
        ends = seated.gap * (_inside(along, *pair.face) / along)
    else:
        towards = np.array([0.0, 0.0, 1.0])
        low, high = max(mesh.bounds[4] for mesh in meshes), min(mesh.bounds[5] for mesh in meshes)
        ends = seated.gap + (_inside(float(middle[2]), low, high) - middle[2]) * towards
    driver, driven = (mesh.slice(normal=tuple(towards), origin=tuple(ends.mean(axis=0))) for mesh in meshes)
    return GapSection(towards, ends, (driver, driven))


def _inside(place: float, low: float, high: float) -> float:
    margin = INSIDE * (high - low)
    return min(max(place, low + margin), high - margin)


DRIVER_COLOUR, DRIVEN_COLOUR = "#7FB2D9", "#F0C36D"
TEETH_HIGH: Final = 2.9  # modules from the middle of the teeth in mesh to the upper edge of the picture
GAPS_HIGH: Final = 3.0  # gaps from the middle of the gap to the upper edge of the close-up
LEAST_HIGH: Final = 0.03  # mm; a close-up of no gap at all still shows something
LEAST_GAP: Final = 1e-4  # mm; VTK keeps coordinates in single precision, in which nearer ends may be one point
FROM_ABOVE: Final = np.array([0.0, np.sin(np.radians(22.0)), np.cos(np.radians(22.0))])  # the front, for the whole
MAIN_TITLE, SIDE_TITLE = 13, 10  # sizes of titles


def panels_of(build: SeatedBuild, train: WholeTrain | None, close: SeatedMesh | None) -> tuple[Panel, ...]:
    """Panels of the window: teeth, the whole pair and the gap; of a train, the train, teeth and gap.

    Args:
        build: the build shown.
        train: the train that is shown whole; None of a build of single pairs.
        close: the mesh that is shown close up; None of a train without any.
    """
    if train is None:
        pair = None if close is None else _close_up(close, _title(build, close, "driver"), MAIN_TITLE)
        return () if pair is None else (pair.teeth, pair.pair, pair.gap)
    whole = partial(_train_panel, build, train, close)
    if close is None:
        return (whole,)
    shown = _close_up(close, close.mesh.name, SIDE_TITLE)
    return whole, shown.teeth, shown.gap


def _train_panel(
    build: SeatedBuild, train: WholeTrain, close: SeatedMesh | None, plotter: pv.Plotter, width_by_height: float
) -> None:
    marks, title = {}, _build_text(build)
    if close:
        place = build.model.layout.world_from_mesh[close.mesh.name]
        marks = {f"{close.mesh.name}, close up": place[:3, :3] @ close.contact + place[:3, 3]}
        title = _title(build, close, close.mesh.driver)
    draw_whole(plotter, train.world, width_by_height, marks)
    add_title(plotter, title, MAIN_TITLE)


@dataclass(frozen=True, eq=False)
class CloseUp:
    """A mesh that is shown close up, in the coordinates of the picture: x to the right, y up, z towards the eye.

    Args:
        seated: the mesh.
        solids: its gears, driver and driven.
        title, title_size: of the picture of its teeth.
    """

    seated: SeatedMesh
    solids: tuple[pv.PolyData, pv.PolyData]
    title: str
    title_size: int

    def teeth(self, plotter: pv.Plotter, width_by_height: float) -> None:
        """The teeth in mesh from the front, contact and gap marked."""
        seated = self.seated
        self._add_gears(plotter)
        module = seated.driver.gear.module
        mark = 0.055 * module
        contact = self._in_front(seated.contact)
        plotter.add_mesh(pv.Sphere(radius=1.4 * mark, center=contact), color=CONTACT_COLOUR)
        plotter.add_mesh(arrow(contact, seated.normal, 0.85 * module), color=CONTACT_COLOUR)
        beside_contact = contact - module * (0.35 * seated.normal + np.array([0.5, 0.0, 0.0]))
        add_label(plotter, beside_contact, "contact", CONTACT_COLOUR)
        middle = contact
        if np.isfinite(seated.gap).all():
            ends = [self._in_front(point) for point in seated.gap]
            if seated.gap_value > LEAST_GAP:
                plotter.add_mesh(pv.Tube(pointa=ends[0], pointb=ends[1], radius=0.6 * mark), color=GAP_COLOUR)
            for end in ends:
                plotter.add_mesh(pv.Sphere(radius=mark, center=end), color=GAP_COLOUR)
            beside = np.array([0.5 * module, 0.0, 0.0])
            add_label(plotter, (ends[0] + ends[1]) / 2 + beside, seated.gap_words, GAP_COLOUR)
            middle = (contact + (ends[0] + ends[1]) / 2) / 2
        add_names_below(plotter, f"{legible(seated.driver.name)} (driver)", f"{legible(seated.driven.name)} (driven)")
        add_title(plotter, self.title, self.title_size)
        look_from_near(plotter, middle, TEETH_HIGH * module)

    def pair(self, plotter: pv.Plotter, width_by_height: float) -> None:
        """Both gears whole, a ring about the contact."""
        seated = self.seated
        self._add_gears(plotter)
        module = seated.driver.gear.module
        contact = self._in_front(seated.contact, beyond=module)
        ring = pv.Disc(center=contact, inner=3.2 * module, outer=3.8 * module, normal=(0, 0, 1), c_res=60)
        plotter.add_mesh(ring, color=CONTACT_COLOUR, lighting=False)
        bounds = np.array([solid.bounds for solid in self.solids])
        low, high = bounds[:, 0::2].min(axis=0), bounds[:, 1::2].max(axis=0)
        add_title(plotter, f"{seated.mesh.name}, whole", SIDE_TITLE)
        look(plotter, (low + high) / 2, 0.6 * max(high[1] - low[1], (high[0] - low[0]) * 0.86), FROM_ABOVE)

    def gap(self, plotter: pv.Plotter, width_by_height: float) -> None:
        """Both gears cut across the gap."""
        seated = self.seated
        set_background(plotter)
        if not np.isfinite(seated.gap).all():
            self._add_gears(plotter)
            add_title(plotter, "non-working flanks overlap", SIDE_TITLE)
            look(plotter, self._in_front(seated.contact), 0.5 * seated.driver.gear.module, FRONT)
            return
        section = gap_section(seated, self.solids)
        for outline, colour in zip(section.outlines, (DRIVER_COLOUR, DRIVEN_COLOUR), strict=True):
            add_section(plotter, outline, colour)
        high = max(GAPS_HIGH * seated.gap_value, LEAST_HIGH)
        ends = section.ends + 0.01 * high * section.towards  # before the sections
        if seated.gap_value > LEAST_GAP:
            plotter.add_mesh(pv.Line(*ends), color=GAP_COLOUR, line_width=4, lighting=False)
        plotter.add_points(ends, color=GAP_COLOUR, point_size=12, render_points_as_spheres=True)
        right = np.cross([0.0, 1.0, 0.0], section.towards)
        add_label(plotter, section.middle + 0.3 * high * right, seated.gap_words, GAP_COLOUR)
        add_title(plotter, f"cut across the gap, {2000 * high:.0f} µm high", SIDE_TITLE)
        look(plotter, section.middle, high, section.towards)

    def _add_gears(self, plotter: pv.Plotter) -> None:
        set_background(plotter)
        for solid, colour in zip(self.solids, (DRIVER_COLOUR, DRIVEN_COLOUR), strict=True):
            add_solid(plotter, solid, colour)

    def _in_front(self, point: Array, beyond: float = 0.0) -> Array:
        """A point of a flank moved along its generator to the front ends of the teeth, where it is visible."""
        front = max(float(solid.bounds[5]) for solid in self.solids) + beyond
        if self.seated.mesh.pair.arm_spread:
            return np.asarray(point * (front / point[2]))
        return np.array([point[0], point[1], front])


def _close_up(close: SeatedMesh, title: str, title_size: int) -> CloseUp:
    seen = _as_seen(close)
    driver, driven = (poly_data(*part.mesh()) for part in (seen.driver, seen.driven))
    return CloseUp(seen, (driver, driven), title, title_size)


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


def _title(build: SeatedBuild, seated: SeatedMesh, driver: str) -> str:
    turn = np.degrees(np.arctan2(seated.driver.world_from_gear[1, 0], seated.driver.world_from_gear[0, 0])) % 360
    status = "" if seated.status == OK else f", {STATUS_TEXT[seated.status]}"
    return f"{_build_text(build, status)}   {driver} at {turn:.2f}°"


def _build_text(build: SeatedBuild, status: str = "") -> str:
    magnified = f", deviations x {build.magnify:g}" if build.magnify != 1.0 else ""
    return f"{build.label}{status}{magnified}"
