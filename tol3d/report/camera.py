"""From where a 3D picture is seen."""

from typing import Final

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

Array = NDArray[np.float64]

FRONT: Final = np.array([0.0, 0.0, 1.0])
UP: Final = np.array([0.0, 1.0, 0.0])
VIEW_ANGLE: Final = 12.0  # deg; enough perspective to show depth, little enough to look through a gap
FAR: Final = 4.0  # diagonals of all that is drawn, from what is seen to the eye; along parallels any distance does


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
