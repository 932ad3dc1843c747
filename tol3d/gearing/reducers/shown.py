"""Builds, sizes and looks of reducers that tables and pictures of all models share."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Final

import numpy as np

from tol3d.errors import InputError
from tol3d.gearing.presenting.drawing_sizes import Thickness, sizes_table
from tol3d.gearing.reducers.deviations import Acts
from tol3d.gearing.reducers.link import ReducerLink
from tol3d.gears import Gear
from tol3d.numerics.arrays import Array
from tol3d.report.body import Body, World
from tol3d.report.motion import FRONT, Frame, Look, Motion, Shot, around
from tol3d.report.page import PageItem
from tol3d.report.presenter import View
from tol3d.study.system.contributor import Contributor

UP = np.array([0.0, 1.0, 0.0])
TURN: Final = "turn"
SWING: Final = "swing"
Moves = Mapping[str, tuple[Callable[[Any, int], Sequence[Any]], int]]
"""By name of a motion: its states from what is shown and their number, and the usual number."""


@dataclass(frozen=True, eq=False)
class ReducerDisplay(ABC):
    """A build of a reducer; see `tol3d.report.presenter.Display` and `tol3d.report.motion.Movable`.

    Args:
        shown: where its parts stand.
    """

    words: ClassVar[str]
    """Its kind, such as "an RV reducer"."""

    colours: ClassVar[Mapping[str, str]]
    """Of marks, by what they are."""

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
        """Its motions; all but TURN go back again."""

    @abstractmethod
    def frames(self, states: Sequence[Any], name: str) -> Iterable[Frame]:
        """Frames of a motion."""

    @abstractmethod
    def shots(self, states: Sequence[Any], name: str) -> Iterable[Shot]:
        """Pictures that its frames are made of."""

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """One world with every part."""
        return (World(self.shown.own.name, self.bodies),)

    @property
    def seen(self) -> World:
        """The same for pictures."""
        return self.worlds[0]

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of its motions."""
        return tuple(self.moves)

    def motion(self, name: str, frames: int | None) -> Motion:
        """One of them.

        Raises:
            InputError: its parts jam, or do not touch.
        """
        moved, usual = self.moves[name]
        states = moved(self.shown, frames or usual)
        made, shots = tuple(self.frames(states, name)), tuple(self.shots(states, name))
        return Motion(self.seen, made, shots, self.colours, back=name != TURN)

    def view(self, close_up: str | None) -> View:
        """All parts.

        Raises:
            InputError: a close-up was asked for.
        """
        if close_up is not None:
            raise InputError(f"--mesh: nothing of {self.words} is shown close up, not {close_up[:80]!r}")
        return View(world=self.seen)


def gear_sizes(
    gears: Mapping[str, Gear], acts: Mapping[str, Acts], contributors: Sequence[Contributor]
) -> Sequence[PageItem]:
    """Sizes of teeth that shops measure, of gears by their names, with the tolerances of their thickness."""
    stated = (
        (act.gear, Thickness(contributor.draw.distribution, act.factor, act.over))
        for contributor in contributors
        if (act := acts.get(contributor.name)) is not None and act.effect.endswith("thickness")
    )
    return sizes_table(gears, stated)


def from_front(world: World) -> Look:
    """All parts along the common axis."""
    return around(np.concatenate([body.mesh[0] for body in world.bodies]), np.zeros(3), FRONT, UP)


def world_from_middle(link: ReducerLink, world_from_driver: Array) -> Array:
    """Pose (4, 4) of the middle of a reducer in the world of its train."""
    above = np.eye(4)
    above[2, 3] = link.height
    return np.asarray(world_from_driver @ above)
