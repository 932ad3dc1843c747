"""Displays, tooth sizes and views of reducers, common to all kinds of reducers."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Final

import numpy as np

from tol3d.errors import InputError
from tol3d.gearing.presenting.drawing_sizes import Thickness, sizes_table
from tol3d.gearing.presenting.gear_tables import gear_blocks, pair_blocks
from tol3d.gearing.reducers.deviations import Acts
from tol3d.gearing.reducers.link import ReducerLink
from tol3d.gearing.shafts import Mesh
from tol3d.gears import Gear
from tol3d.numerics.arrays import Array
from tol3d.report.body import Body, World
from tol3d.report.motion import FRONT, Frame, Look, Motion, Shot, around
from tol3d.report.page import PageItem
from tol3d.report.presenter import View
from tol3d.study.system.contributor import Contributor

UP = np.array([0.0, 1.0, 0.0])
TURN: Final = "turn"  # a motion of whole turns, which goes on
SWING: Final = "swing"
Moves = Mapping[str, tuple[Callable[[Any, int], Sequence[Any]], int]]
"""By name of a motion: a function of the display's `shown` and a number of states that makes these, and the usual
number."""


@dataclass(frozen=True, eq=False)
class ReducerDisplay(ABC):
    """A build of a reducer; see `tol3d.report.presenter.Display` and `tol3d.report.motion.Movable`.

    Args:
        label: of the build.
        shown: poses of its parts, by the reducer's own class.
        notes: remarks for the user.
    """

    words: ClassVar[str]
    """Kind of reducer, such as "an RV reducer"."""

    colours: ClassVar[Mapping[str, str]]
    """Colours of marks by their kind."""

    label: str
    shown: Any
    notes: tuple[str, ...] = ()

    @property
    @abstractmethod
    def bodies(self) -> tuple[Body, ...]:
        """All parts."""

    @property
    @abstractmethod
    def moves(self) -> Moves:
        """Its motions; all but TURN go to and fro."""

    @abstractmethod
    def frames(self, states: Sequence[Any], name: str) -> Iterable[Frame]:
        """Frames of a motion, one per state."""

    @abstractmethod
    def shots(self, states: Sequence[Any], name: str) -> Iterable[Shot]:
        """Views of a motion, of which its frames are composed."""

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """One world with every part."""
        return (World(self.shown.own.name, self.bodies),)

    @property
    def seen(self) -> World:
        """The world that pictures show."""
        return self.worlds[0]

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of its motions."""
        return tuple(self.moves)

    def motion(self, name: str, frames: int | None) -> Motion:
        """A motion by its name, in a number of frames; None for the usual one.

        Raises:
            InputError: its parts jam, or do not touch.
        """
        states_of, usual = self.moves[name]
        states = states_of(self.shown, frames or usual)
        pictures, shots = tuple(self.frames(states, name)), tuple(self.shots(states, name))
        return Motion(self.seen, pictures, shots, self.colours, back=name != TURN)

    def view(self, close_up: str | None) -> View:
        """View of all parts.

        Raises:
            InputError: a close-up is requested; reducers have none.
        """
        if close_up is not None:
            raise InputError(f"--mesh: nothing of {self.words} is shown close up, not {close_up[:80]!r}")
        return View(world=self.seen)


def gear_data(
    gears: Mapping[str, Gear], meshes: Iterable[Mesh], acts: Mapping[str, Acts], contributors: Sequence[Contributor]
) -> Sequence[PageItem]:
    """Gears of a reducer, their tooth sizes as shops measure them with the tolerances of thickness, and their meshes.

    Args:
        gears: by name; none of a reducer without.
        meshes: of one planet.
        acts: effects of contributors, by name.
        contributors: of the system.
    """
    stated = (
        (effect.gear, Thickness(contributor.draw.distribution, effect.factor, effect.over))
        for contributor in contributors
        if (effect := acts.get(contributor.name)) is not None and effect.effect.endswith("thickness")
    )
    return [*gear_blocks(gears), *sizes_table(gears, stated), *pair_blocks(meshes)] if gears else []


def from_front(world: World) -> Look:
    """View of all parts along the common axis."""
    return around(np.concatenate([body.mesh[0] for body in world.bodies]), np.zeros(3), FRONT, UP)


def world_from_middle(link: ReducerLink, world_from_driver: Array) -> Array:
    """Pose (4, 4) of the middle of a reducer in the world of its train."""
    driver_from_middle = np.eye(4)
    driver_from_middle[2, 3] = link.height
    return np.asarray(world_from_driver @ driver_from_middle)
