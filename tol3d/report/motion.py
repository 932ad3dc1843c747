"""A build in motion: poses of its bodies in each frame, marks, and view directions."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Protocol, runtime_checkable

import numpy as np

from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.report.body import World
from tol3d.report.presenter import Display
from tol3d.scene.name import LONGEST_NAME
from tol3d.scene.nearest import hint

FRONT: Final = np.array([0.0, 0.0, 1.0])
ISOMETRIC: Final = math.asin(1 / math.sqrt(3))  # rad above the horizon
MARGIN: Final = 1.08  # of what is shown, to the edge of the picture
FEWEST_FRAMES: Final = 2
MOST_FRAMES: Final = 360  # pictures of 2 MB, held until they are written


@dataclass(frozen=True, eq=False)
class Look:
    """From where one looks, along parallels.

    Args:
        middle: the point (3,) in the middle of the picture [mm].
        high: from there to the picture's upper edge [mm].
        towards: unit vector (3,) to the eye.
        up: unit vector (3,) to the upper edge.
        wide: from the middle to the right edge at least [mm]; narrow pictures show more above and below for it.
    """

    middle: Array
    high: float
    towards: Array
    up: Array
    wide: float = 0.0


def around(points: Array, middle: Array, towards: Array, up: Array) -> Look:
    """A look at all of some points (n, 3) [mm]."""
    off = points - middle
    high, wide = (MARGIN * float(np.abs(off @ along).max()) for along in (up, np.cross(up, towards)))
    return Look(middle, high, towards, up, wide)


def corner(up: Array) -> tuple[Array, Array]:
    """From where three edges of a cube look alike: to the eye, and to the picture's upper edge; unit vectors (3,)."""
    axis = FRONT if abs(FRONT @ up) < 1.0 else np.array([1.0, 0.0, 0.0])
    front = axis - (axis @ up) * up
    front = front / np.linalg.norm(front)
    level = (front + np.cross(up, front)) / math.sqrt(2)
    towards = math.cos(ISOMETRIC) * level + math.sin(ISOMETRIC) * up
    return towards, np.cross(towards, np.cross(up, level))


@dataclass(frozen=True, eq=False)
class Shot:
    """One of the pictures that a frame is made of.

    Args:
        title: what it shows.
        looks: one a frame, or one for all.
        bodies: names of what is seen in it; all where none is named.
    """

    title: str
    looks: tuple[Look, ...]
    bodies: tuple[str, ...] = ()

    def look(self, frame: int) -> Look:
        """That of a frame."""
        return self.looks[frame if len(self.looks) > 1 else 0]

    def shows(self, names: Sequence[str]) -> bool:
        """True if all these bodies are visible."""
        return not self.bodies or all(name in self.bodies for name in names)


@dataclass(frozen=True, eq=False)
class Mark:
    """A point that is marked, seen through whatever hides it.

    Args:
        what: it is; one of the motion's colours.
        point: (3,) [mm].
        of: names of the bodies that it belongs to; it is left out of shots in which one of them is not seen.
    """

    what: str
    point: Array
    of: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Frame:
    """A build at one moment.

    Args:
        caption: what it is, with its numbers.
        poses: world_from_part (4, 4), rotation and translation [mm], of the bodies that have moved, by name.
        marks: what is marked.
        stop: name of the display's world whose parts stand so, in which measures are read; "" for none.
    """

    caption: str
    poses: Mapping[str, Array]
    marks: tuple[Mark, ...] = ()
    stop: str = ""


@dataclass(frozen=True, eq=False)
class Motion:
    """Frames of one world.

    Args:
        world: its bodies; where they stand where a frame does not say.
        frames: in their order.
        shots: the first one large, at the left, the others below each other at its right; one alone fills the picture.
        colours: of the marks, "#RRGGBB" by what they are.
        back: whether it goes back the way it came, so that it ends as it began.
        notes: what the user should know.
    """

    world: World
    frames: tuple[Frame, ...]
    shots: tuple[Shot, ...]
    colours: Mapping[str, str] = field(default_factory=dict)
    back: bool = False
    notes: tuple[str, ...] = ()

    @property
    def played(self) -> tuple[int, ...]:
        """Numbers of the frames in the order in which they are played."""
        there = range(len(self.frames))
        return (*there, *reversed(there[1:-1])) if self.back else tuple(there)


@runtime_checkable
class Movable(Protocol):
    """A display whose build can be moved."""

    @property
    def motions(self) -> Sequence[str]:
        """Names of its motions, the first one being that which is shown where none is asked for; it may be empty."""
        ...

    def motion(self, name: str, frames: int | None) -> Motion:
        """One of them.

        Args:
            name: one of `motions`.
            frames: how many, from FEWEST_FRAMES on; None: as many as suit it.

        Raises:
            InputError: the build cannot be moved so.
        """
        ...


@runtime_checkable
class Travelling(Movable, Protocol):
    """A display whose parts move as they stand in its first world, so that a page can show it there."""

    @property
    def travels(self) -> Sequence[str]:
        """Names of such motions, some of its `motions`; it may be empty."""
        ...


def travels_of(display: Display) -> Sequence[str]:
    """Names of the motions of a build that a page can show."""
    return display.travels if isinstance(display, Travelling) else ()


def motion_of(display: Display, name: str | None, frames: int | None) -> Motion:
    """A motion of a build.

    Args:
        display: the build.
        name: of the motion; None: the first there is.
        frames: how many; None: as many as suit it.

    Raises:
        InputError: it cannot be moved, there is no such motion, or too few or too many frames.
    """
    known = display.motions if isinstance(display, Movable) else ()
    if not isinstance(display, Movable) or not known:
        raise InputError(f"{display.label}: nothing of it can be moved, so there is nothing to animate")
    if name is not None and name not in known:
        raise InputError(f"--motion: {display.label} has no motion {name[:LONGEST_NAME]!r}{hint(name, known)}")
    if frames is not None and not FEWEST_FRAMES <= frames <= MOST_FRAMES:
        raise InputError(f"--frames: expected {FEWEST_FRAMES} to {MOST_FRAMES}, got {frames}")
    return display.motion(name or known[0], frames)
