"""Builds of trains as they are shown: seated gears, shafts, and links of other mechanisms.

A link names the module whose PRESENTER shows it: that of the mechanism that brought it, which implements ShowsLinks.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np

from tol3d.gearing.links import LinkTrials, StatedLink
from tol3d.gearing.model import Model
from tol3d.gearing.play.linked import link_contributors
from tol3d.gearing.presenting.gear_display import TURN, GearDisplay, whole_train
from tol3d.gearing.shown.display import SeatedBuild
from tol3d.numerics.arrays import Array
from tol3d.report.body import Body, World
from tol3d.report.motion import Motion
from tol3d.report.page import PageItem
from tol3d.report.presenter import View, presenter_at
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.trials import Trials


@dataclass(frozen=True, eq=False)
class ShownLink:
    """A link of one trial.

    Args:
        bodies: what is in it, in the world of its train; names differ from those of other parts of the scene.
        note: for the user, such as "reducer jams"; "" for none.
        seen: the same for pictures, where many like parts are one body; None: as they are.
    """

    bodies: tuple[Body, ...]
    note: str = ""
    seen: tuple[Body, ...] | None = None


@runtime_checkable
class ShowsLinks(Protocol):
    """Interface of a presenter whose mechanism adds links to trains."""

    def link_blocks(self, link: StatedLink, contributors: Sequence[Contributor]) -> Sequence[PageItem]:
        """Description of a link of a scene and of its contributors, before any trial."""

    def link_sections(self, summary: RunSummary) -> Sequence[PageItem]:
        """Further tables of a run of a train; none where its summary has nothing of such links."""

    def shown_link(self, link: StatedLink, seen: LinkTrials, world_from_driver: Array) -> ShownLink:
        """A link in the first of some trials.

        Args:
            link: of this presenter's own kind.
            seen: its deviations, and its driver's position.
            world_from_driver: pose of the driver's shaft at 0, (4, 4).
        """


def shows(link: StatedLink) -> ShowsLinks | None:
    """Presenter of a link; None if pictures have a housing or a symbol for it."""
    found = presenter_at(link.presenter)
    return found if isinstance(found, ShowsLinks) else None


def link_blocks(model: Model) -> list[PageItem]:
    """Blocks of those links of a scene that have a presenter."""
    found: list[PageItem] = []
    for link in model.links:
        if shown := shows(link):
            found += shown.link_blocks(link, link_contributors(model, link.name))
    return found


def link_sections(summary: RunSummary) -> list[PageItem]:
    """Further tables of a train's run, of whatever mechanism brought links into it."""
    beside = (summary.mechanism.beside or ()) if summary.mechanism else ()
    presenters = (presenter_at(summary.presenters.get(name, "")) for name in beside)
    return [
        block
        for presenter in presenters
        if isinstance(presenter, ShowsLinks)
        for block in presenter.link_sections(summary)
    ]


@dataclass(frozen=True, eq=False)
class ShownTrain:
    """Implements Display.

    Args:
        gears: in meshes, at rest, and their shafts.
        model: whose build it is.
        trials: one, with its deviations as they are shown.
    """

    gears: GearDisplay
    model: Model
    trials: Trials

    @property
    def label(self) -> str:
        """See Display."""
        return self.gears.label

    @property
    def notes(self) -> tuple[str, ...]:
        """See Display."""
        return (*self.gears.notes, *(f"{self.label}: {own.note}" for own in self._shown.values() if own.note))

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """The worlds of the gears, each with the links that its shafts drive."""
        return self._worlds({name: own.bodies for name, own in self._shown.items()})

    @cached_property
    def _seen(self) -> tuple[World, ...]:
        """The same for pictures."""
        return self._worlds({name: _in_pictures(own) for name, own in self._shown.items()})

    def _worlds(self, inside: Mapping[str, Sequence[Body]]) -> tuple[World, ...]:
        def bodies(root: str) -> Iterator[Body]:
            return (body for name, own in inside.items() if self._root_of(self._links[name]) == root for body in own)

        return tuple(
            replace(world, bodies=(*world.bodies, *bodies(world.name)), one_file=True) for world in self.gears.worlds
        )

    @cached_property
    def _links(self) -> dict[str, StatedLink]:
        return {link.name: link for link in self.model.links if shows(link)}

    def _root_of(self, link: StatedLink) -> str:
        """The first shaft of the train that drives it."""
        return self.model.layout.root_of[link.driver]

    @cached_property
    def _shown(self) -> dict[str, ShownLink]:
        return {name: self._at(link) for name, link in self._links.items()}

    def _at(self, link: StatedLink, beyond: float = 0.0) -> ShownLink:
        """A link, the first shaft turned by so much [rad] beyond the trial's position."""
        own = link_contributors(self.model, link.name)
        deviations = {each.name: self.trials.deviations[:, self.model.component_slices[each.name]] for each in own}
        angles = np.zeros((len(self.trials), 1))
        if link.name in self.trials.positions:
            further = beyond * float(self.model.layout.mesh_turn[link.name].rate)
            angles = self.trials.positions[link.name][:, None] + further
        shown, pose = shows(link), self.model.layout.world_from_shaft[link.driver]
        assert shown is not None
        return shown.shown_link(link, LinkTrials(own, deviations, angles), pose)

    @property
    def motions(self) -> tuple[str, ...]:
        """See `tol3d.report.motion.Movable`."""
        return self.gears.motions

    def motion(self, name: str, frames: int | None) -> Motion:
        """The first shaft turns once, links with it; swinging they stand still. See `tol3d.report.motion.Movable`."""
        found = self.gears.motion(name, frames)
        if name != TURN:
            return replace(found, notes=(*found.notes, f"{', '.join(self._shown)}: stands still here"))
        world = next(own for own in self._seen if own.name == found.world.name)
        driven = [link for link in self._links.values() if self._root_of(link) == world.name]
        turned = (
            replace(frame, poses={**frame.poses, **self._poses(driven, 2 * math.pi * place / len(found.frames))})
            for place, frame in enumerate(found.frames)
        )
        return replace(found, world=world, frames=tuple(turned), shots=(whole_train(world), *found.shots[1:]))

    def _poses(self, links: list[StatedLink], beyond: float) -> dict[str, Array]:
        """Poses of the bodies in some links, by name; see _at."""
        shown = (self._at(link, beyond) for link in links)
        return {body.name: body.world_from_part for own in shown for body in _in_pictures(own)}

    def view(self, close_up: str | None) -> View:
        """The whole train with its links; with a mesh named, that mesh close up as in any train."""
        return View(world=self._seen[0]) if close_up is None else self.gears.view(close_up)


def _in_pictures(link: ShownLink) -> tuple[Body, ...]:
    return link.bodies if link.seen is None else link.seen


def shown_build(build: SeatedBuild) -> GearDisplay | ShownTrain:
    """A build with the parts in its links, if they have a presenter."""
    gears = GearDisplay(build)
    return ShownTrain(gears, build.model, build.seen.trials) if any(map(shows, build.model.links)) else gears
