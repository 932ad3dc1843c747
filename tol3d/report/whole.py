"""A whole train in one picture: seen from a corner, its parts named beside it."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression, linear_sum_assignment

from tol3d.gearing.presenting.whole_trains import WholeTrain
from tol3d.report.drawn_solids import (
    CONTACT_COLOUR,
    EDGE_COLOUR,
    GAP_COLOUR,
    add_label,
    add_round_solid,
    add_solid,
    arrow,
    poly_data,
    set_background,
)

Array = NDArray[np.float64]

ISOMETRIC: Final = math.asin(1 / math.sqrt(3))  # rad above the horizon: three edges of a cube look alike
PARTS_WIDE, PARTS_HIGH = 0.56, 0.84  # of the picture; the labels stand on either side
LABEL_ROW: Final = 1 / 26  # of the picture's height, from label to label at least
LABEL_GAP: Final = 0.02  # of the picture's width, between parts and labels
LABEL_SIZE: Final = 11
ARROW_SHARE: Final = 0.16  # of the picture's height
DOT_SHARE: Final = 1 / 250  # of the picture's height, the radius of the dot at the end of a label's line
MARK_SHARE: Final = 1 / 120  # the same at what is no part: a tip, a contact
SAMPLES: Final = 6000  # points on each part's surface, to tell what is seen of it
CELLS: Final = 120  # of the picture's width, in which the nearest points are seen


@dataclass(frozen=True, eq=False)
class Eye:
    """Where one looks from: unit vectors to the right, up and towards the eye, as rows (3, 3)."""

    axes: Array

    def seen(self, points: Array) -> Array:
        """Points in the axes of the picture, (n, 3): right, up, towards the eye [mm]."""
        return np.asarray(points @ self.axes.T)

    def world(self, seen: Array) -> Array:
        """The way back."""
        return np.asarray(seen @ self.axes)


@dataclass(frozen=True, eq=False)
class Frame:
    """What the picture shows, in the axes of the eye [mm]: its middle and size, the box of the parts, the front."""

    middle: Array
    width: float
    height: float
    low: Array
    high: Array
    front: float

    @classmethod
    def around(cls, seen: Array, width_by_height: float) -> "Frame":
        low, high = seen.min(axis=0), seen.max(axis=0)
        wide, tall = (high - low)[:2]
        height = max(tall / PARTS_HIGH, wide / PARTS_WIDE / width_by_height)
        middle = (low + high) / 2
        return cls(middle, height * width_by_height, height, low, high, float(high[2]) + height)


@dataclass(frozen=True, eq=False)
class Label:
    """A text, its colours, and the point (3,) [mm] that it names."""

    text: str
    colour: str
    ink: str
    point: Array


@dataclass(frozen=True, eq=False)
class TrainPicture:
    """A train as it is drawn: from where one looks, what the picture shows, and what is named in it."""

    eye: Eye
    frame: Frame
    labels: tuple[Label, ...]


def draw_train(
    plotter: pv.Plotter, train: WholeTrain, marks: Mapping[str, Array], width_by_height: float
) -> TrainPicture:
    """Draw a train into the plotter's current picture, without its labels.

    Args:
        plotter: where.
        train: what.
        marks: points that are named besides parts and tips, (3,) [mm].
        width_by_height: of the picture.
    """
    set_background(plotter)
    for part in train.gears:
        add_solid(plotter, poly_data(*train.meshes[part.name]), train.colours[part.name])
    for body in train.bodies:
        add_round_solid(plotter, poly_data(*train.meshes[body.name]), train.colours[body.name])
    eye, anchors = _best_eye(train, {name: _sampled(*mesh) for name, mesh in train.meshes.items()})
    frame = Frame.around(eye.seen(np.concatenate([points for points, _ in train.meshes.values()])), width_by_height)
    labels = [Label(name, train.colours[name], EDGE_COLOUR, point) for name, point in anchors.items()]
    for name, point in {**train.points, **marks}.items():
        labels.append(Label(name, CONTACT_COLOUR, "white", point))
    if train.gravity:
        direction, begin = train.gravity
        plotter.add_mesh(arrow(begin, direction, ARROW_SHARE * frame.height), color=GAP_COLOUR, ambient=0.6)
        labels.append(Label("gravity", GAP_COLOUR, "white", begin + ARROW_SHARE * frame.height * direction))
    _look(plotter, eye, frame)
    return TrainPicture(eye, frame, tuple(labels))


def label_in_place(plotter: pv.Plotter, picture: TrainPicture) -> None:
    """Name the parts where they are, for a window in which the train can be turned."""
    for label in picture.labels:
        add_label(plotter, label.point, label.text, EDGE_COLOUR if label.ink == EDGE_COLOUR else label.colour)


def label_beside(plotter: pv.Plotter, picture: TrainPicture) -> None:
    """Name the parts in two columns beside them, with lines to what is named, for a picture."""
    eye, frame = picture.eye, picture.frame
    for side in (-1.0, 1.0):
        column = [label for label in picture.labels if side * (eye.seen(label.point)[0] - frame.middle[0]) > 0.0]
        points = np.array([eye.seen(label.point) for label in column]).reshape(-1, 3)
        edge = (frame.low if side < 0.0 else frame.high)[0] + side * LABEL_GAP * frame.width
        places = _places(points, edge, frame)
        for label, place in zip(column, places, strict=True):
            _add_line(plotter, picture, label, place)
            _add_text(plotter, label, frame, place, "right" if side < 0.0 else "left")
    plotter.reset_camera_clipping_range()


# what is seen -------------------------------------------------------------------------------------


def _sampled(vertices: Array, triangles: NDArray[np.int64]) -> Array:
    """Points spread evenly over a surface, (SAMPLES, 3) [mm]; the same ones each time."""
    rng = np.random.default_rng(0)
    corners = vertices[triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = np.searchsorted(np.cumsum(areas), rng.random(SAMPLES) * areas.sum())
    first, second = rng.random((2, SAMPLES, 1))
    turned = first + second > 1.0
    first, second = np.where(turned, 1.0 - first, first), np.where(turned, 1.0 - second, second)
    begin, one, other = (corners[chosen.clip(max=len(corners) - 1), k] for k in range(3))
    return np.asarray(begin + first * (one - begin) + second * (other - begin))


def _best_eye(train: WholeTrain, samples: Mapping[str, Array]) -> tuple[Eye, Mapping[str, Array]]:
    """Of the four corners the one from which most is seen of the parts, and a point to be seen of each part."""
    up = np.array([0.0, 1.0, 0.0]) if train.gravity is None else -train.gravity[0]
    best = max((_seen_of(eye, samples) for eye in _corners(up)), key=lambda found: found[0])
    return best[1], best[2]


def _corners(up: Array) -> Iterator[Eye]:
    axis = np.array([0.0, 0.0, 1.0])
    front = axis - (axis @ up) * up
    if np.linalg.norm(front) < 1e-6:  # gravity pulls along the first shaft
        front = np.array([1.0, 0.0, 0.0])
    front = front / np.linalg.norm(front)
    side = np.cross(up, front)
    for turn in np.radians([45.0, -45.0, 135.0, -135.0]):
        level = math.cos(turn) * front + math.sin(turn) * side
        eye = math.cos(ISOMETRIC) * level + math.sin(ISOMETRIC) * up
        right = np.cross(up, level)
        yield Eye(np.stack([right, np.cross(eye, right), eye]))


def _seen_of(eye: Eye, samples: Mapping[str, Array]) -> tuple[float, Eye, Mapping[str, Array]]:
    """How much is seen, summed over parts so that each one counts, and a point to be seen of each."""
    seen = {name: eye.seen(points) for name, points in samples.items()}
    everything = np.concatenate(list(seen.values()))
    cell = np.ptp(everything[:, :2], axis=0).max() / CELLS
    nearest: dict[tuple[int, int], float] = {}
    cells = {name: np.floor(points[:, :2] / cell).astype(int) for name, points in seen.items()}
    for name, points in seen.items():
        for place, depth in zip(map(tuple, cells[name].tolist()), points[:, 2].tolist(), strict=True):
            nearest[place] = max(depth, nearest.get(place, -math.inf))
    score, anchors = 0.0, {}
    for name, points in seen.items():
        front = np.array([nearest[place] for place in map(tuple, cells[name].tolist())])
        visible = points[:, 2] > front - cell
        score += math.sqrt(visible.mean())
        shown = points[visible] if visible.any() else points
        middle = np.median(shown, axis=0)
        anchors[name] = eye.world(shown[np.argmin(np.linalg.norm(shown - middle, axis=1))])
    return score, eye, anchors


# the picture --------------------------------------------------------------------------------------


def _places(points: Array, edge: float, frame: Frame) -> Array:
    """Where labels of these points stand along an edge, (n, 2): the lines to them are shortest, so none cross."""
    heights = _spread(-np.sort(-points[:, 1]), frame)
    distances = np.hypot(points[:, 0, None] - edge, points[:, 1, None] - heights)
    _, chosen = linear_sum_assignment(distances)
    return np.stack([np.full(len(points), edge), heights[chosen]], axis=-1)


def _add_line(plotter: pv.Plotter, picture: TrainPicture, label: Label, place: Array) -> None:
    """A line from a label to what it names, in front of everything: one looks along parallels."""
    eye, frame = picture.eye, picture.frame
    ends = (place, eye.seen(label.point)[:2])
    begin, end = (eye.world(np.array([*point, frame.front])) for point in ends)
    part = label.ink == EDGE_COLOUR
    colour, radius = (EDGE_COLOUR, DOT_SHARE) if part else (label.colour, MARK_SHARE)
    plotter.add_mesh(pv.Line(begin, end), color=colour, line_width=1.5, lighting=False)
    plotter.add_mesh(pv.Sphere(radius=radius * frame.height, center=end), color=colour, lighting=False)


def _add_text(plotter: pv.Plotter, label: Label, frame: Frame, place: Array, side: str) -> None:
    x, y = 0.5 + (place - frame.middle[:2]) / (frame.width, frame.height)
    actor = plotter.add_text(f" {label.text} ", position=(x, y), viewport=True, font_size=LABEL_SIZE, color=label.ink)
    actor.prop.justification_horizontal, actor.prop.justification_vertical = side, "center"
    actor.prop.background_color, actor.prop.background_opacity = label.colour, 1.0


def _spread(wanted: Array, frame: Frame) -> Array:
    """Heights from above down, as near to the wanted ones as rows that do not overlap can be, inside the picture."""
    rows = LABEL_ROW * frame.height * np.arange(len(wanted))
    if not len(wanted):
        return wanted
    heights = isotonic_regression(wanted + rows, increasing=False).x - rows
    reach = (1 / 2 - 1.5 * LABEL_ROW) * frame.height
    heights += max(0.0, frame.middle[1] - reach - heights[-1])
    heights -= max(0.0, heights[0] - frame.middle[1] - reach)
    return np.asarray(heights)


def _look(plotter: pv.Plotter, eye: Eye, frame: Frame) -> None:
    middle = eye.world(frame.middle)
    plotter.camera.focal_point = tuple(middle)
    plotter.camera.position = tuple(middle + 4 * frame.height * eye.axes[2])
    plotter.camera.up = tuple(eye.axes[1])
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = frame.height / 2
    plotter.reset_camera_clipping_range()
