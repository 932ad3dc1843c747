"""A rope between two drums, parts of its own: a mechanism that brings links, with a presenter of what is in them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, ClassVar, Final, Literal

import numpy as np

from tol3d.gearing.grammar.parts import TurningSpec
from tol3d.gearing.links import FreeTurn, LinkTrials, StatedLink
from tol3d.gearing.model.brought import Brought, BroughtLink, acting_in, shaft_of, tolerances_of
from tol3d.gearing.presenting import GearPresenter
from tol3d.gearing.presenting.shown_train import ShownLink
from tol3d.report.body import Body, Surface
from tol3d.report.page import PageItem, line
from tol3d.scene import Scene
from tol3d.scene.bases import Length, MoveSpec, ToleranceSpec
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.draw import Scalar
from tol3d.study.system.mechanism import Mechanism

Array = np.ndarray


class DrumSpec(TurningSpec):
    """A drum."""

    words: ClassVar[str] = "a drum"

    kind: Literal["drum"]
    radius: Length


class StretchSpec(ToleranceSpec):
    """Give of the rope of a drum."""

    kind: Literal["rope_stretch"]
    of: Name

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("of",), self.of, (DrumSpec,)),)


class RopeSpec(MoveSpec):
    """A rope from one drum to another beside it."""

    words: ClassVar[str] = "a rope drive"

    kind: Literal["rope_drive"]
    first: Name
    second: Name

    def references(self) -> tuple[Reference, ...]:
        return tuple(Reference((own,), getattr(self, own), (DrumSpec,)) for own in ("first", "second"))


@dataclass(frozen=True, kw_only=True)
class Rope(StatedLink):
    """Stretch s, and the driver's drum off by (x, y): (s + x cos a - y sin a) / r of the second drum are free."""

    kind: ClassVar[str] = "rope_drive"
    compares: ClassVar[bool] = True
    presenter: ClassVar[str] = "toys.drives.rope"

    radius: float
    off: tuple[str, ...] = ()

    @property
    def turns(self) -> Fraction:
        return Fraction(1)

    def exact(self, seen: LinkTrials) -> FreeTurn:
        return FreeTurn(sum(self._parts(seen, seen.deviations).values(), np.zeros(seen.angles.shape)))

    def _parts(self, seen: LinkTrials, deviations: Mapping[str, Array]) -> dict[str, Array]:
        found = {}
        for name, own in deviations.items():
            x, y = own[:, :1], own[:, -1:]
            lengthened = x * np.cos(seen.angles) - y * np.sin(seen.angles) if name in self.off else x
            found[name] = np.broadcast_to(lengthened / self.radius, seen.angles.shape)
        return found

    def parts(self, seen: LinkTrials, means: Mapping[str, Array]) -> Mapping[str, Array]:
        off = {name: own - means[name] for name, own in seen.deviations.items()}
        return {name: own[:, 0] for name, own in self._parts(seen, off).items()}

    def offset_by(self, contributor: str, part: str) -> "Rope | None":
        return replace(self, off=(*self.off, contributor)) if part == "drum" else None


def ropes_as_links(scene: Scene) -> Brought:
    links, contributors = [], {}
    for name, own in scene.of(RopeSpec).items():
        (driver, _), (driven, _) = (shaft_of(scene, part) for part in (own.first, own.second))
        drums = scene.of(DrumSpec)
        first, second = (drums[part].radius.internal for part in (own.first, own.second))
        rate = Fraction(first).limit_denominator(1000) / Fraction(second).limit_denominator(1000)
        link = Rope(name=str(name), driver=driver, driven=driven, rate=rate, radius=second)
        links.append(BroughtLink(link, frozenset((own.first, own.second)), (own.first, own.second)))
        for tolerance, _ in tolerances_of(scene, {own.first: own}):
            spec: Any = scene.tolerances[tolerance]
            draw = Scalar(spec.distribution.resolve(scene.files))
            contributors[tolerance] = acting_in(scene, tolerance, link.name, draw)
    return Brought(tuple(links), contributors)


class RopePresenter(GearPresenter):
    """Shows a rope as a block beside its driver."""

    def link_blocks(self, link: StatedLink, contributors: Sequence[Contributor]) -> Sequence[PageItem]:
        return (line(f"{link.name}: a rope, {', '.join(each.name for each in contributors)}"),)

    def link_sections(self, summary: Any) -> Sequence[PageItem]:
        stages = (stage for train in (summary.trains or {}).values() for stage in train.stages)
        return tuple(line(f"{stage.link} is a rope") for stage in stages if stage.kind == Rope.kind)

    def shown_link(self, link: StatedLink, seen: LinkTrials, world_from_driver: Array) -> ShownLink:
        return ShownLink(tuple(_blocks(link, world_from_driver)), f"{link.name} is a block")


def _blocks(link: StatedLink, pose: Array) -> Iterator[Body]:
    def surface() -> Surface:
        return np.vstack([np.zeros(3), np.eye(3)]), np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])

    yield Body(link.name, pose, surface, None, "#808080")


PRESENTER: Final = RopePresenter()

ROPES: Final = Mechanism(
    name="ropes",
    parts=(DrumSpec,),
    tolerances=(StretchSpec,),
    moves=(RopeSpec,),
    extends=("gearing",),
    links="toys.drives.rope:ropes_as_links",
    presenter="toys.drives.rope",
    requires=("jsonschema",),
)
