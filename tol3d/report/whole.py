"""Bodies in one picture: seen from a corner, their names beside them.

Labels are placed here because pyvista's point labels leave out those that collide, and matplotlib has no placement of
its own: adjustText overlaps dense labels, and both it and textalloc put them over the parts.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from scipy import ndimage
from scipy.optimize import isotonic_regression, linear_sum_assignment
from vtkmodules.vtkRenderingCore import vtkWorldPointPicker

from tol3d.numerics.arrays import Array
from tol3d.report.body import World
from tol3d.report.drawn_solids import (
    CONTACT_COLOUR,
    EDGE_COLOUR,
    GAP_COLOUR,
    add_arrow,
    add_body,
    add_label,
    look,
    poly_data,
    set_background,
)
from tol3d.report.heading import legible

ISOMETRIC: Final = math.asin(1 / math.sqrt(3))  # rad above the horizon: three edges of a cube look alike
PARTS_WIDE, PARTS_HIGH = 0.56, 0.84  # of the picture; the labels stand on either side
NO_MARKS: Final[Mapping[str, Array]] = {}
LABEL_ROW: Final = 1 / 26  # of the picture's height, from label to label at least
MOST_ROWS: Final = 24  # labels in a column; of more the letters are smaller
LABEL_GAP: Final = 0.02  # of the picture's width, between parts and labels
LABEL_SIZE: Final = 11
ARROW_SHARE: Final = 0.16  # of the picture's height
DOT_SHARE: Final = 1 / 250  # of the picture's height, the radius of the dot at the end of a label's line
MARK_SHARE: Final = 1 / 120  # the same at what is no part: a tip, a contact
PROBE_HEIGHT: Final = 480  # pixels of the pictures used only to test visibility
LARGE_COUNTS: Final = 1 / 4  # power; of two corners with equal visibility, the one with the larger picture
ALIKE: Final = 0.98  # of the best corner's score: near enough to it, so that trials of a run are seen from one corner
HIDDEN: Final = " (hidden)"  # behind the name of what others hide
FLARE: Final = 0.05  # relative luminance that is added to both colours of a contrast (WCAG 2.2)
PEELS: Final = 12  # transparent faces in a row
INSIDE_SHARE: Final = 0.6  # of the largest distance to the edge of a body's visible area: a label may point there


@dataclass(frozen=True, eq=False)
class Eye:
    """View directions: unit vectors to the right, up and towards the eye, as rows (3, 3)."""

    axes: Array

    def seen(self, points: Array) -> Array:
        """Points in the axes of the picture, (n, 3): right, up, towards the eye [mm]."""
        return np.asarray(points @ self.axes.T)

    def world(self, seen: Array) -> Array:
        """Points in the world, from those in the axes of the picture."""
        return np.asarray(seen @ self.axes)


@dataclass(frozen=True, eq=False)
class Frame:
    """Content of the picture, in the axes of the eye [mm]: its middle and size, the box of the parts, the front."""

    middle: Array
    width: float
    height: float
    low: Array
    high: Array
    front: float

    @classmethod
    def around(cls, seen: Array, width_by_height: float) -> "Frame":
        """The frame about points (n, 3) [mm] in the camera's own directions."""
        low, high = seen.min(axis=0), seen.max(axis=0)
        wide, tall = (high - low)[:2]
        height = max(tall / PARTS_HIGH, wide / PARTS_WIDE / width_by_height)
        middle = (low + high) / 2
        return cls(middle, height * width_by_height, height, low, high, float(high[2]) + height)


@dataclass(frozen=True, eq=False)
class Label:
    """A text, the colour behind it, and the point (3,) [mm] that it names.

    Args:
        text: of a user.
        colour: "#RRGGBB".
        point: what it names.
        hidden: others hide all of that in a picture.
        part: it names a part, no point or arrow.
    """

    text: str
    colour: str
    point: Array
    hidden: bool = False
    part: bool = False

    @property
    def ink(self) -> str:
        """The colour of the letters: dark for a part, unless white has more contrast to its colour."""
        behind = _luminance(self.colour)
        dark = (behind + FLARE) / (_luminance(EDGE_COLOUR) + FLARE)
        return EDGE_COLOUR if self.part and dark >= (1.0 + FLARE) / (behind + FLARE) else "white"


class Named(NamedTuple):
    """A point of a body (3,) [mm] that is seen, or its middle where it is hidden."""

    point: Array
    hidden: bool


@dataclass(frozen=True, eq=False)
class Whole:
    """Bodies as they are drawn: from where one looks, what the picture shows, and what is named in it."""

    eye: Eye
    frame: Frame
    labels: tuple[Label, ...]


def draw_whole(
    plotter: pv.Plotter, world: World, width_by_height: float, marks: Mapping[str, Array] = NO_MARKS
) -> None:
    """Draw all bodies of a world with their names: beside them in a picture, at them in a window.

    Args:
        plotter: at its current renderer.
        world: the world.
        width_by_height: of the picture.
        marks: points that are named besides those of the world, (3,) [mm].
    """
    set_background(plotter)
    for body in world.drawn:
        add_body(plotter, body)
    if any(body.opacity < 1.0 for body in world.bodies):  # else faces hide each other in the order of drawing
        plotter.renderer.SetUseDepthPeeling(True)
        plotter.renderer.SetMaximumNumberOfPeels(PEELS)
    eye, named = _best_eye(world, width_by_height)
    frame = _frame(world, eye, width_by_height)
    labels = [Label(own.name, own.colour, *named[own.name], part=True) for own in world.bodies]
    for name, bodies in world.within.items():
        corners = np.concatenate([body.mesh[0] for body in bodies])
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        labels.append(Label(name, bodies[0].colour, middle, part=True))
    labels += [Label(name, CONTACT_COLOUR, point) for name, point in {**world.points, **marks}.items()]
    for name, shown in world.arrows.items():
        length = ARROW_SHARE * frame.height if shown.length is None else shown.length
        add_arrow(plotter, shown.place, shown.direction, length)
        labels.append(Label(name, GAP_COLOUR, shown.place + length * shown.direction))
    _look(plotter, eye, frame)
    (_label_beside if plotter.off_screen else _label_in_place)(plotter, Whole(eye, frame, tuple(labels)))


def _label_in_place(plotter: pv.Plotter, picture: Whole) -> None:
    """Name the parts where they are, for a window in which they can be turned."""
    for label in picture.labels:
        add_label(plotter, label.point, label.text, EDGE_COLOUR if label.part else label.colour)


def _label_beside(plotter: pv.Plotter, picture: Whole) -> None:
    """Name the parts in two columns beside them, with lines to what is named, for a picture."""
    eye, frame = picture.eye, picture.frame
    for side, column in zip((-1.0, 1.0), _columns(picture), strict=True):
        points = np.array([eye.seen(label.point) for label in column]).reshape(-1, 3)
        edge = (frame.low if side < 0.0 else frame.high)[0] + side * LABEL_GAP * frame.width
        size = int(LABEL_SIZE * _row(len(column)) / LABEL_ROW)
        for label, place in zip(column, _places(points, edge, frame), strict=True):
            _add_line(plotter, picture, label, place)
            _add_text(plotter, label, frame, place, size)
    plotter.reset_camera_clipping_range()


# what is seen -------------------------------------------------------------------------------------


def _frame(world: World, eye: Eye, width_by_height: float) -> Frame:
    return Frame.around(eye.seen(np.concatenate([body.mesh[0] for body in world.bodies])), width_by_height)


def _best_eye(world: World, width_by_height: float) -> tuple[Eye, Mapping[str, Named]]:
    """The one of four corners that shows most of the bodies, and the named places of each body from there."""
    plotter = pv.Plotter(off_screen=True, window_size=[round(PROBE_HEIGHT * width_by_height), PROBE_HEIGHT])
    plotter.renderer.set_background("black")
    plotter.disable_anti_aliasing()  # a pixel between two bodies would have the number of a third
    try:
        actors = [
            plotter.add_mesh(poly_data(*body.mesh), color=f"#{number:06X}", lighting=False)
            for number, body in enumerate(world.bodies, 1)
        ]
        clear = {number: actor for number, actor in enumerate(actors, 1) if world.bodies[number - 1].opacity < 1.0}
        found = []
        for eye in _corners(np.array(world.up)):
            _look(plotter, eye, _frame(world, eye, width_by_height))
            found.append((eye, *_seen(plotter, world, clear)))
    finally:
        plotter.close()
    best = max(score for _, score, _ in found)
    return next((eye, named) for eye, score, named in found if score >= ALIKE * best)


def _corners(up: Array) -> Iterator[Eye]:
    axis = np.array([0.0, 0.0, 1.0])
    front = axis - (axis @ up) * up
    if np.linalg.norm(front) < 1e-6:  # up is along z
        front = np.array([1.0, 0.0, 0.0])
    front = front / np.linalg.norm(front)
    side = np.cross(up, front)
    for turn in np.radians([45.0, -45.0, 135.0, -135.0]):
        level = math.cos(turn) * front + math.sin(turn) * side
        eye = math.cos(ISOMETRIC) * level + math.sin(ISOMETRIC) * up
        right = np.cross(up, level)
        yield Eye(np.stack([right, np.cross(eye, right), eye]))


def _seen(plotter: pv.Plotter, world: World, clear: Mapping[int, pv.Actor]) -> tuple[float, Mapping[str, Named]]:
    """Visible amount of the bodies, each counting, and the named places of each.

    Args:
        plotter: as it looks at the bodies, each in a colour that is its number in the world, from 1 on.
        world: its bodies.
        clear: those that hide nothing, by their numbers.
    """
    pixel = 2 * plotter.camera.parallel_scale / PROBE_HEIGHT  # mm
    score, named = 0.0, {}
    for are_clear in (False, True) if clear else (False,):
        for actor in clear.values():
            actor.visibility = are_clear
        plotter.render()
        red, green, blue = np.moveaxis(np.asarray(plotter.screenshot(return_img=True), dtype=int), 2, 0)
        numbers = (65536 * red + 256 * green + blue)[::-1]  # rows from the lower edge up, as VTK counts them
        picker = vtkWorldPointPicker()
        for number, body in enumerate(world.bodies, 1):
            if (number in clear) != are_clear:
                continue
            shown = numbers == number
            if not shown.any():
                named[body.name] = Named(body.mesh[0].mean(axis=0), hidden=True)
                continue
            score += math.sqrt(shown.sum() * pixel**2 / poly_data(*body.mesh).area)
            x, y = _clear_place(shown)
            picker.Pick(x, y, 0.0, plotter.renderer)
            named[body.name] = Named(np.array(picker.GetPickPosition()), hidden=False)
    return score / pixel**LARGE_COUNTS, named


def _clear_place(shown: NDArray[np.bool_]) -> tuple[int, int]:
    """Column and row of a pixel near to the middle of the largest piece that is shown of a body, well inside of it."""
    pieces, _ = ndimage.label(shown)
    piece = pieces == 1 + np.argmax(np.bincount(pieces.ravel())[1:])
    inside = ndimage.distance_transform_edt(np.pad(piece, 1))[1:-1, 1:-1]
    middle = np.median(np.argwhere(piece), axis=0)
    places = np.argwhere(inside >= INSIDE_SHARE * inside.max())
    row, column = places[np.argmin(np.linalg.norm(places - middle, axis=1))].tolist()
    return column, row


# the picture --------------------------------------------------------------------------------------


def _columns(picture: Whole) -> tuple[Sequence[Label], Sequence[Label]]:
    """The labels at the left and at the right: each on its own side, as long as there is room."""
    across = np.array([picture.eye.seen(label.point)[0] for label in picture.labels])
    most = max(MOST_ROWS, -(-len(across) // 2))
    left = min(max(int(np.sum(across < picture.frame.middle[0])), len(across) - most), most)
    order = [picture.labels[k] for k in np.argsort(across, kind="stable")]
    return order[:left], order[left:]


def _row(count: int) -> float:
    """From label to label in a column of so many, as a share of the picture's height."""
    return LABEL_ROW * min(1.0, (MOST_ROWS - 1) / max(count - 1, 1))


def _places(points: Array, edge: float, frame: Frame) -> Array:
    """Places of labels along an edge, (n, 2), with the shortest lines to these points, so that none cross."""
    heights = _spread(-np.sort(-points[:, 1]), frame)
    distances = np.hypot(points[:, 0, None] - edge, points[:, 1, None] - heights)
    _, chosen = linear_sum_assignment(distances)
    return np.stack([np.full(len(points), edge), heights[chosen]], axis=-1)


def _add_line(plotter: pv.Plotter, picture: Whole, label: Label, place: Array) -> None:
    """A line from label to what it names, in front of everything (one looks along parallels); a dot on what is seen."""
    eye, frame = picture.eye, picture.frame
    ends = (place, eye.seen(label.point)[:2])
    begin, end = (eye.world(np.array([*point, frame.front])) for point in ends)
    colour, radius = (EDGE_COLOUR, DOT_SHARE) if label.part else (label.colour, MARK_SHARE)
    plotter.add_mesh(pv.Line(begin, end), color=colour, line_width=1.5, lighting=False)
    if not label.hidden:
        plotter.add_mesh(pv.Sphere(radius=radius * frame.height, center=end), color=colour, lighting=False)


def _add_text(plotter: pv.Plotter, label: Label, frame: Frame, place: Array, size: int) -> None:
    """A label between a place and the nearer border of the picture, cut where it would leave it."""
    x, y = 0.5 + (place - frame.middle[:2]) / (frame.width, frame.height)
    room = plotter.renderer.GetSize()[0] * min(x, 1.0 - x)  # pixels
    actor = plotter.add_text("", position=(x, y), viewport=True, font_size=size, color=label.ink)
    actor.prop.justification_horizontal, actor.prop.justification_vertical = "right" if x < 0.5 else "left", "center"
    actor.prop.background_color, actor.prop.background_opacity = label.colour, 1.0
    for letters in range(len(label.text), 0, -1):
        actor.input = f" {legible(label.text, letters)}{HIDDEN if label.hidden else ''} "
        actor.GetSize(plotter.renderer, extent := [0.0, 0.0])
        if extent[0] <= room:
            break


def _luminance(colour: str) -> float:
    """The relative luminance of a colour, 0 to 1 (WCAG 2.2)."""
    share = np.array(pv.Color(colour).float_rgb)
    return float(np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4) @ (0.2126, 0.7152, 0.0722))


def _spread(wanted: Array, frame: Frame) -> Array:
    """Heights from above down, as near to the wanted ones as rows that do not overlap can be, inside the picture."""
    rows = _row(len(wanted)) * frame.height * np.arange(len(wanted))
    if not len(wanted):
        return wanted
    heights = isotonic_regression(wanted + rows, increasing=False).x - rows
    reach = (1 / 2 - 1.5 * LABEL_ROW) * frame.height
    heights += max(0.0, frame.middle[1] - reach - heights[-1])
    heights -= max(0.0, heights[0] - frame.middle[1] - reach)
    return np.asarray(heights)


def _look(plotter: pv.Plotter, eye: Eye, frame: Frame) -> None:
    look(plotter, eye.world(frame.middle), frame.height / 2, eye.axes[2], eye.axes[1])
