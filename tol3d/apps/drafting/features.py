"""The features of a drafted part: each is selected once, under one name, even if several callouts name its faces."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from tol3d.apps.drafting.words import UNNAMEABLE_FEATURE, Names, direction, length, place, scalar
from tol3d.cad.step import (
    FoundFeature,
    HolePattern,
    Selector,
    StepError,
    StepPart,
    Triple,
    by_place,
    line_of,
    selected,
    shown,
)
from tol3d.numerics.arrays import Array

USABLE: Final = frozenset(("plane", "hole", "pin", "fillet", "round", "cone", "ball", "socket"))
LONGEST_PMI_NAME: Final = 40  # characters of a PMI name by which a feature is selected; longer ones are data
AXES: Final = frozenset(("hole", "pin", "fillet", "round"))
"""Kinds that a scene has as cylinders."""
OPPOSED: Final = -1.0 + 1e-9


@dataclass(frozen=True)
class Group:
    """One feature, or several of one kind that the drawing names alike.

    Args:
        name: in the scene.
        members: the features, in the order of their numbers.
        line: their selection, as YAML.
        slot: both walls of a slot or tab; empty for other features.
        comment: text after the line.
    """

    name: str
    members: tuple[FoundFeature, ...]
    line: str
    slot: tuple[FoundFeature, ...] = ()
    comment: str = ""

    @property
    def names(self) -> list[str]:
        """Names of the members."""
        if len(self.members) == 1:
            return [self.name]
        return [f"{self.name} {k}" for k in range(1, len(self.members) + 1)]

    @property
    def kind(self) -> str:
        """Kind of the members in a scene."""
        if self.slot:
            return "slot"
        first = self.members[0]
        return "cylinder" if first.kind in AXES else "sphere" if first.kind in ("ball", "socket") else first.kind

    @property
    def size(self) -> float | None:
        """Nominal diameter or width [mm]; None for features without one."""
        if self.slot:
            first, second = self.slot
            return abs(float(np.dot(np.subtract(second.at, first.at), first.direction)))
        return 2 * self.members[0].radius if self.kind in ("cylinder", "sphere") else None


@dataclass
class Features:
    """The features of one part that a scene uses.

    Args:
        part: the part as it was read.
        names: those that are given.
        groups: selected features; grows.
        play: least play [mm] of the pairs in which each group is, by its name; grows.
    """

    part: StepPart
    names: Names = field(default_factory=lambda: Names(UNNAMEABLE_FEATURE))
    groups: list[Group] = field(default_factory=list)
    play: dict[str, float] = field(default_factory=dict)

    def plays(self, members: Sequence[FoundFeature], play: float) -> None:
        """Note the play of a pair in which a feature, or the slot of two walls, is."""
        for group in self.groups:
            own = group.slot or group.members
            if {each.faces for each in own} & {each.faces for each in members}:
                self.play[group.name] = min(play, self.play.get(group.name, play))

    def of_faces(self, faces: Sequence[int], skipped: frozenset[str] = frozenset()) -> list[FoundFeature]:
        """The features of the part to which faces belong.

        Some faces of a plane are a plane of their own, or the whole of one that is selected already.

        Args:
            faces: their numbers.
            skipped: kinds of features that are passed over.

        Raises:
            StepError: a feature cannot be used in a scene, or there is none.
        """
        features: list[FoundFeature] = []
        for feature in self.part.features:
            common = [face for face in faces if face in feature.faces]
            if not common and not set(faces) & {*feature.repeated}:
                continue
            if feature.kind in skipped:
                continue
            if feature.kind not in USABLE:
                raise StepError(f"a {feature.kind} is not simulated")
            if feature.kind == "plane" and 0 < len(common) < len(feature.faces):
                known = next((plane for plane in self.planes() if {*plane.faces} & {*common}), None)
                features.append(known or replace(self.part.shell.made_of(common), on=feature.on))
            else:
                features.append(feature)
        if not features:
            raise StepError("it has no face that a scene can use")
        return features

    def planes(self) -> Iterator[FoundFeature]:
        """Planes that are selected already."""
        for group in self.groups:
            if group.kind == "plane":
                yield from group.members

    def largest(self) -> list[FoundFeature]:
        """The two usable features of largest area, or the only one.

        Raises:
            StepError: there is no usable feature.
        """
        usable = [feature for feature in self.part.features if feature.kind in USABLE and not feature.loose]
        if not usable:
            raise StepError(f"{shown(self.part.name)}: expected a flat or round face, found free forms alone")
        return sorted(usable, key=lambda feature: -feature.area)[:2]

    def named(self, member: FoundFeature) -> tuple[Group, str] | None:
        """The group that holds a feature, and the feature's name; None if it is not selected."""
        for group in self.groups:
            for selected_member, name in zip(group.members, group.names, strict=True):
                if not group.slot and selected_member.faces == member.faces:
                    return group, name
        return None

    def name_of(self, member: FoundFeature) -> str:
        """Name of a feature, or of the slot that it is a wall of; "" if neither is selected."""
        slot = next((own.name for own in self.groups if member.faces in {wall.faces for wall in own.slot}), "")
        known = self.named(member)
        return slot or (known[1] if known else "")

    def name(self, member: FoundFeature, wish: str = "") -> str:
        """Name of a feature, which is selected if it is not yet.

        Args:
            member: the feature.
            wish: a name for it.
        """
        known = self.named(member)
        return known[1] if known else self.add([member], wish).name

    def slot(self, walls: Sequence[FoundFeature], wish: str = "") -> Group:
        """The slot or tab between two walls, stated by its dimensions; a tab if the first wall faces away."""
        for group in self.groups:
            if group.slot and {wall.faces for wall in group.slot} == {wall.faces for wall in walls}:
                return group
        first, second = walls
        between = np.subtract(second.at, first.at)
        across = np.array(first.direction)
        width = float(across @ between)
        middle = np.array(first.at) + between / 2
        tab = width < 0.0
        name = self.names.new(wish, "tab" if tab else "slot")
        sides = ", ".join(length(min(pair)) for pair in zip(first.extent, second.extent, strict=True))
        line = (
            f"{{kind: slot, at: {place(middle)}, normal: {direction(first.direction)}, extent: [{sides}], "
            f"width: {length(abs(width))}{', tab: true' if tab else ''}, along: {direction(first.x)}}}"
        )
        faces = ", ".join(f"#{face}" for wall in walls for face in wall.faces)
        middle_plane = replace(first, at=(float(middle[0]), float(middle[1]), float(middle[2])))
        made = Group(name, (middle_plane,), line, (first, second), f"between {faces}")
        self.groups.append(made)
        return made

    def projected(self, member: FoundFeature, along: Triple, wish: str) -> Group:
        """A hole stated by its dimensions, with its axis along a direction, beyond whose end a zone is projected."""
        name = self.names.new(wish, member.kind)
        line = (
            f"{{kind: cylinder, at: {place(member.at)}, axis: {direction(along)}, length: {length(member.length)}, "
            f"diameter: {length(2 * member.radius)}{', hole: true' if member.hollow else ''}}}"
        )
        made = Group(name, (member,), line, comment=f"{faces_of(member)}, by numbers: its axis leads out")
        self.groups.append(made)
        return made

    def disc(self, member: FoundFeature, middle: Array, normal: Array, radius: float) -> Group:
        """A face of a part that turns about an axis, as a disc stated by its dimensions."""
        line = f"{{kind: plane, at: {place(middle)}, normal: {direction(normal)}, radius: {length(radius)}}}"
        made = Group(
            self.names.new("", self.kind_name(member.kind)), (member,), line,
            comment=f"{faces_of(member)}, by numbers: to its farthest edge from the axis",
        )  # fmt: skip
        self.groups.append(made)
        return made

    def add(self, members: Sequence[FoundFeature], wish: str = "", letter: str = "", pmi: Sequence[str] = ()) -> Group:
        """Select features under one name.

        Args:
            members: of one kind and size, none selected yet.
            wish: a name for them.
            letter: of the datum that they are, if they are one.
            pmi: names of their tolerances and dimensions in the drawing.

        Raises:
            StepError: no single line selects several.
        """
        ordered = tuple(by_place(members))
        line = self.selector(ordered, letter, pmi)
        if line is None and len(ordered) > 1:
            raise StepError("no one line selects them")
        first = ordered[0]
        name = self.names.new(wish, self.kind_name(first.kind), len(ordered))
        made = Group(name, ordered, line or self.by_faces(first), comment="; ".join(self.told(ordered)))
        self.groups.append(made)
        return made

    def told(self, members: Sequence[FoundFeature]) -> Iterator[str]:
        """Features in words, and what they are part of: a counterbore, a tab, a pattern of holes."""
        yield described(members)
        faces = {own.faces for own in members}
        for several in self.part.machined.all:
            whole = {own.faces for own in several.members}
            if faces & whole:
                yield several.words if faces >= whole or not isinstance(several, HolePattern) else f"of {several.words}"

    def kind_name(self, kind: str) -> str:
        """A name for the next feature of a kind: "hole 3"."""
        count = 1
        while self.names.clashes(f"{kind} {count}", 1) or any(
            f"{kind} {count} 1" in group.names for group in self.groups
        ):
            count += 1
        return f"{kind} {count}"

    def selector(self, members: Sequence[FoundFeature], letter: str, pmi: Sequence[str]) -> str | None:
        """A line that selects just these features, by datum, PMI name, size or place; None if none does."""
        count = len(members) if len(members) > 1 else None
        counted = f", count: {count}" if count else ""
        tries: list[tuple[str, Selector]] = []
        if letter:
            tries.append((f"{{datum: {scalar(letter)}{counted}}}", Selector(datum=letter, count=count)))
        for pmi_name in pmi:
            if pmi_name and len(pmi_name) <= LONGEST_PMI_NAME and pmi_name.isprintable():
                tries.append((f"{{pmi: {scalar(pmi_name)}{counted}}}", Selector(pmi=pmi_name, count=count)))
        first = members[0]
        round_one = first.kind in ("hole", "pin", "ball", "socket")
        size = round(2 * first.radius, 6)
        if count:
            words = f"{{kind: {first.kind}, diameter: {length(size)}{counted}}}"
            tries.append((words, Selector(kind=first.kind, diameter=size, count=count)))
        else:
            at = first.at if round_one else first.on
            near = (round(at[0], 4) + 0.0, round(at[1], 4) + 0.0, round(at[2], 4) + 0.0)
            tries.append((line_of(first), Selector(kind=first.kind, diameter=size if round_one else None, near=near)))
        wanted = [member.faces for member in members]
        for line, selector in tries:
            try:
                if [each.faces for each in selected(self.part, selector)] == wanted:
                    return line
            except StepError:
                continue
        return None

    def by_faces(self, member: FoundFeature) -> str:
        """A line that selects a feature by its faces."""
        whole = any(feature.faces == member.faces for feature in self.part.features)
        if whole:
            return f'{{face: "#{member.faces[0]}"}}'
        return "{faces: [" + ", ".join(f'"#{face}"' for face in member.faces) + "]}"


def faces_of(member: FoundFeature) -> str:
    """Numbers of the feature's first four faces."""
    more = ", …" if len(member.faces) > 4 else ""
    return ", ".join(f"#{face}" for face in member.faces[:4]) + more


def described(members: Sequence[FoundFeature]) -> str:
    """Number, kind, size [mm] and faces of features, for a comment."""
    first = members[0]
    if first.kind == "plane" and not first.radius:
        size = f"{first.extent[0]:.6g} × {first.extent[1]:.6g}"
    elif first.kind in AXES:
        size = f"⌀{2 * first.radius:.6g} × {first.length:.6g}"
    else:
        size = f"⌀{2 * first.radius:.6g}"
    count = f"{len(members)} × " if len(members) > 1 else ""
    where = faces_of(first) if len(members) == 1 else f"from {faces_of(first)} on"
    return f"{count}{first.kind} {size}, {where}"
