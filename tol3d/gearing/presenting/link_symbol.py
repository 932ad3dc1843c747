"""Signs for the links of a train, of shapes that matplotlib has: gears, a ring, cones, a reducer; lengths in inches."""

import math
from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyBboxPatch, Patch, Polygon

from tol3d.gearing.presenting.shown_stage import ShownStage
from tol3d.report.canvas import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, wrapped

OTHER_COLOUR: Final = SKY
LINK_COLOURS: Final[Mapping[str, str]] = {
    "reducer": ORANGE,
    "mesh": BLUE,
    "internal_mesh": BLUE,
    "bevel_mesh": GREEN,
    "parallel": PURPLE,
}
SHAFT_LINE: Final = 3.5  # points
TOOTH_PITCH: Final = 0.15  # inch; as many teeth as the eye distinguishes, not as many as there are
TOOTH_HEIGHT: Final = 0.055
LEAST_SHARE, MOST_SHARE = 0.4, 0.6  # of the two gears' width; the smaller one has room for its number
MOST_WIDTH: Final = 1.3
SMALL: Final = 9.0  # points
PLANETS: Final = 3
RING_HALF: Final = 0.44  # inch; radius of a ring
LEAST_INSIDE: Final = 0.5  # of a ring; the gear in it has room for its number
RIM: Final = 0.13  # of that, from its teeth to its outside
CONES_HALF: Final = 0.42  # inch; half the side of the square that the cones of a pair of equal gears fill
LEAST_LINE: Final = 0.06  # inch; of a shaft's line before the cones, and between them and the line to the driven shaft
LINE_AFTER: Final = 0.12  # inch; from the line that comes down from the driven cone's top to its shaft


def link_colour(kind: str) -> str:
    """The colour of a kind of link."""
    return LINK_COLOURS.get(kind, OTHER_COLOUR)


def draw_link(axes: Axes, stage: ShownStage, ends: tuple[float, float]) -> None:
    """Draw a link between the ends of its two shafts, which lie at height 0."""
    SYMBOLS.get(stage.kind, _other)(axes, stage, sum(ends) / 2, min(ends[1] - ends[0] - 0.08, MOST_WIDTH), ends)


def _line(axes: Axes, *points: tuple[float, float]) -> None:
    x, y = zip(*points, strict=True)
    axes.plot(x, y, color=GREY, linewidth=SHAFT_LINE, solid_capstyle="butt", solid_joinstyle="round", zorder=1)


def _fill(axes: Axes, patch: Patch, colour: str) -> None:
    """A shape in a light shade of its colour with an outline in it; white below, so that no line shines through."""
    light = 0.75 * np.ones(3) + 0.25 * np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
    patch.set(facecolor=light, edgecolor=colour, linewidth=1.3, zorder=2)
    axes.add_patch(patch)


def draw_text(axes: Axes, x: float, y: float, text: str, size: float = SMALL, weight: str = "normal") -> None:
    """A text with its middle at a point."""
    axes.text(x, y, text, ha="center", va="center", fontsize=size, fontweight=weight, color=BLACK, zorder=4)


def _gears(axes: Axes, stage: ShownStage, x: float, width: float, ends: tuple[float, float]) -> None:
    driver, driven = stage.teeth or (1, 1)
    share = min(max(driver / (driver + driven), LEAST_SHARE), MOST_SHARE)
    pitch_width = width - TOOTH_HEIGHT
    radii = (share * pitch_width / 2, (1 - share) * pitch_width / 2)
    centres = (x - pitch_width / 2 + radii[0], x + pitch_width / 2 - radii[1])
    _line(axes, (ends[0], 0), (ends[1], 0))
    for k, (radius, centre, teeth) in enumerate(zip(radii, centres, (driver, driven), strict=True)):
        _fill(axes, Polygon(_gear_outline(centre, 0, radius, meshing=k)), link_colour(stage.kind))
        draw_text(axes, centre, 0, str(teeth))


def _gear_outline(
    x: float, y: float, radius: float, *, meshing: int
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Corners of a gear whose tooth 0 looks to the right, or, meshing with such a one, whose gap looks to the left."""
    count = max(8, round(2 * math.pi * radius / TOOTH_PITCH))
    places = np.array([-0.30, -0.14, 0.14, 0.30])  # of a pitch: foot, tip, tip, foot
    heights = np.array([-1.0, 1.0, 1.0, -1.0]) * TOOTH_HEIGHT / 2
    tooth = np.arange(count)[:, None]
    angle = 2 * math.pi * (tooth + places + 0.5 * meshing) / count + math.pi * meshing
    reach = np.broadcast_to(radius + heights, angle.shape)
    return np.column_stack([(x + reach * np.cos(angle)).ravel(), (y + reach * np.sin(angle)).ravel()])


def _ring(axes: Axes, stage: ShownStage, x: float, width: float, ends: tuple[float, float]) -> None:
    """A ring with the other gear inside, on the side of the driven shaft."""
    inner, ring = sorted(stage.teeth or (1, 2))
    outside = min(RING_HALF, width / 2)
    pitch = (1 - RIM) * outside - TOOTH_HEIGHT / 2
    radius = min(max(inner / ring, LEAST_INSIDE), MOST_SHARE) * pitch
    centre = x + pitch - radius
    _line(axes, (ends[0], 0), (ends[1], 0))
    _fill(axes, Circle((x, 0), outside), link_colour(stage.kind))
    space = Polygon(_gear_outline(x, 0, pitch, meshing=0))
    space.set(facecolor="white", edgecolor=link_colour(stage.kind), linewidth=1.3, zorder=2)
    axes.add_patch(space)
    _fill(axes, Polygon(_gear_outline(centre, 0, radius, meshing=0)), link_colour(stage.kind))
    draw_text(axes, centre, 0, str(inner))
    draw_text(axes, (x - pitch + centre - radius) / 2, 0, str(ring))


def _cones(axes: Axes, stage: ShownStage, x: float, width: float, ends: tuple[float, float]) -> None:
    """Two frusta with one apex: the driver's lies on the axis of its shaft, the driven stands on it."""
    driver, driven = stage.teeth or (1, 1)
    angle = min(max(math.atan2(driver, driven), 0.5), math.pi / 2 - 0.5)  # pitch angle of the driver
    room = (ends[1] - ends[0] - LINE_AFTER) / 2 - LEAST_LINE
    long = min(CONES_HALF * math.cos(angle) * math.sqrt(2), room)
    tall = long * math.tan(angle)
    apex = x - LINE_AFTER / 2
    cut = 0.42  # of the cones is left out near the apex
    lying = [(-long, -tall), (-long, tall), (-cut * long, cut * tall), (-cut * long, -cut * tall)]
    standing = [(-long, tall), (long, tall), (cut * long, cut * tall), (-cut * long, cut * tall)]
    top, bend = tall + 0.1, ends[1] - LINE_AFTER
    _line(axes, (ends[0], 0), (apex - long, 0))
    _line(axes, (apex, tall), (apex, top), (bend, top), (bend, 0), (ends[1], 0))
    for corners in (lying, standing):
        _fill(axes, Polygon([(apex + u, v) for u, v in corners]), link_colour(stage.kind))
    draw_text(axes, apex - 0.72 * long, 0, str(driver))
    draw_text(axes, apex, 0.72 * tall, str(driven))


def _reducer(axes: Axes, stage: ShownStage, x: float, width: float, ends: tuple[float, float]) -> None:
    """A box with a sun, planets and a ring."""
    half = min(width / 2, 0.44)
    _box(axes, stage, x, half, half, ends)
    ring = 0.82 * half
    sun, planet = 0.3 * ring, 0.35 * ring
    turns = [math.pi / 2 + 2 * math.pi * k / PLANETS for k in range(PLANETS)]
    centres = [(x + (sun + planet) * math.cos(turn), (sun + planet) * math.sin(turn)) for turn in turns]
    for circle in (Circle((x, 0), ring), Circle((x, 0), sun), *(Circle(centre, planet) for centre in centres)):
        circle.set(facecolor="white", edgecolor=link_colour(stage.kind), linewidth=1.3, zorder=3)
        axes.add_patch(circle)


def _other(axes: Axes, stage: ShownStage, x: float, width: float, ends: tuple[float, float]) -> None:
    """A box with the word of the kind."""
    half = min(width / 2, 0.5)
    _box(axes, stage, x, half, 0.2, ends)
    draw_text(axes, x, 0, wrapped(stage.kind.replace("_", " "), 2 * half - 0.1, SMALL, 2))


def _box(axes: Axes, stage: ShownStage, x: float, half: float, height: float, ends: tuple[float, float]) -> None:
    """A box with round corners on the line between the shafts; half of its width, half of its height."""
    _line(axes, (ends[0], 0), (ends[1], 0))
    rounded = f"round,pad=0,rounding_size={0.2 * height}"
    box = FancyBboxPatch((x - half, -height), 2 * half, 2 * height, boxstyle=rounded)
    _fill(axes, box, link_colour(stage.kind))


def _parallel(axes: Axes, stage: ShownStage, x: float, width: float, ends: tuple[float, float]) -> None:
    """Two load paths in parallel, a gear pair on each."""
    (left, right), half, rise = ends, 0.42 * width, 0.26
    for side in (-1.0, 1.0):
        across = side * rise
        _line(axes, (left, 0), (x - half, 0), (x - half, across), (x + half, across), (x + half, 0), (right, 0))
        for centre, radius in ((x - 0.15 * width, 0.11), (x + 0.13 * width, 0.17)):
            outline = _gear_outline(centre, across, radius, meshing=int(centre > x))
            _fill(axes, Polygon(outline), link_colour(stage.kind))


Symbol = Callable[[Axes, ShownStage, float, float, tuple[float, float]], None]
SYMBOLS: Final[Mapping[str, Symbol]] = {
    "reducer": _reducer,
    "mesh": _gears,
    "internal_mesh": _ring,
    "bevel_mesh": _cones,
    "parallel": _parallel,
}
