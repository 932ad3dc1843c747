"""A picture of a foreign part with its features numbered, from two opposite corners."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

from tol3d.cad.step.found_features import FeatureKind, FoundFeature
from tol3d.cad.step.reading import StepFile, StepPart
from tol3d.cad.step.refused import shown
from tol3d.cad.step.selectors import names
from tol3d.numerics.arrays import Array
from tol3d.report.canvas import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    new_figure,
    save_figure,
    wrapped,
)

WIDTH, HEIGHT = 12.0, 6.5  # inch; of a part
NUMBER_SIZE, NAME_SIZE = 5.5, 11.0  # points
CORNERS: Final = ((25.0, -60.0), (25.0, 120.0))  # deg; elevation and azimuth
LIGHT: Final = np.array((0.3, 0.5, 0.8)) / np.linalg.norm((0.3, 0.5, 0.8))
SHADE: Final = 0.45  # of a colour that is left on the side away from the light
NUMBERED: Final = ("plane", "hole", "pin", "ball", "socket", "cone")
COLOURS: Final[dict[FeatureKind, str]] = {
    "plane": "#C9D3DC", "hole": ORANGE, "pin": BLUE, "fillet": "#E4E4E4", "round": "#E4E4E4", "cone": GREEN,
    "ball": PURPLE, "socket": VERMILLION, "torus": "#E4E4E4", "free form": SKY,
}  # fmt: skip


def draw_features(file: StepFile, path: Path) -> None:
    """Draw every part of a file, its planes, holes, pins, cones and balls named as in the table.

    Raises:
        InputError: the picture cannot be written there.
        StepError: the triangles cannot be made.
    """
    save_figure(features_figure(file), path)


def features_figure(file: StepFile) -> Figure:
    """A row a part, seen from two corners; not yet written."""
    figure = new_figure(WIDTH, HEIGHT * len(file.parts))
    for row, part in enumerate(file.parts):
        for column, corner in enumerate(CORNERS):
            axes: Any = figure.add_subplot(len(file.parts), 2, 2 * row + column + 1, projection="3d")
            _drawn(axes, part, corner)
            if column == 0:
                words = f"{shown(part.name)}   ·   {len(part.features)} features, [mm]"
                axes.set_title(wrapped(words, 5.0, NAME_SIZE, 2), fontsize=NAME_SIZE, color=BLACK, loc="left")
    return figure


def _drawn(axes: Any, part: StepPart, corner: tuple[float, float]) -> None:
    mesh = part.mesh()
    kinds = {number: feature.kind for feature in part.features if not feature.loose for number in feature.faces}
    kept = np.array([number in kinds for number in mesh.faces.tolist()])
    corners = mesh.vertices[mesh.triangles[kept]]
    colours = np.array([to_rgb(COLOURS[kinds[number]]) for number in mesh.faces[kept].tolist()])
    axes.add_collection3d(Poly3DCollection(corners, facecolors=_lit(colours, corners), linewidths=0))
    low, high = corners.reshape(-1, 3).min(axis=0), corners.reshape(-1, 3).max(axis=0)
    for setter, start, end in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), low, high, strict=True):
        setter(float(start), float(max(end, start + 1e-6)))
    axes.set_box_aspect(np.maximum(high - low, (high - low).max() / 50))
    axes.view_init(*corner)
    axes.tick_params(labelsize=6, colors=GREY)
    for name, place in _labels(part.features, corner):
        axes.text(*place, name, fontsize=NUMBER_SIZE, color=BLACK, ha="center", va="center", zorder=1000)


def _lit(colours: Array, corners: Array) -> Array:
    """Colours (m, 3) of triangles (m, 3, 3), darker away from the light."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    light = SHADE + (1 - SHADE) * (1 + (normals / sizes) @ LIGHT) / 2
    return np.asarray(colours * light[:, None])


def _labels(features: Sequence[FoundFeature], corner: tuple[float, float]) -> Sequence[tuple[str, tuple[float, ...]]]:
    """Names of the features that look towards a corner, and where they stand."""
    elevation, azimuth = np.radians(corner)
    towards = np.array((np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)))
    found = []
    for name, own in zip(names(features), features, strict=True):
        faces_away = own.kind == "plane" and float(np.array(own.direction) @ towards) <= 0.0
        if own.kind in NUMBERED and not own.loose and not faces_away:
            found.append((name, own.on if own.kind == "plane" else own.at))
    return found
