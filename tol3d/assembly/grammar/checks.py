"""Checks across the entries of a scene of an assembly.

Sizes of features without a tolerance of their own, which take the general one of their scene.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import Use, UsesFeatures, part_of
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.measures.assembly_measure import TimedSpec
from tol3d.assembly.grammar.measures.pose_errors import DifferenceSpec
from tol3d.assembly.grammar.moves import AssemblyMoveSpec
from tol3d.assembly.grammar.moves.assembly_move import how_to_place
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.assembly.grammar.tolerances.location import ProfileSpec
from tol3d.assembly.grammar.tolerances.plus_minus import SizeSpec
from tol3d.scene import Scene
from tol3d.scene.nearest import hint
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]


def unknown_features(scene: Scene) -> Iterator[Problem]:
    """Features that do not exist, or are of an unsuitable kind."""
    drawing = Drawing(scene)
    for (section, name), entry in scene.entries().items():
        if isinstance(entry, UsesFeatures):
            whole = entry.of if isinstance(entry, FeatureTolerance) else ""
            for use in entry.uses():
                if sentence := _unfit(use, drawing.toleranced if use.name == whole else drawing.features):
                    yield (section, name, *use.path), sentence


def _unfit(use: Use, parts: Mapping[str, Mapping[str, FeatureUnion]]) -> str:
    part, _, feature = use.name.partition(".")
    features = parts[part]
    if feature not in features:
        near = hint(use.name, [f"{part}.{own}" for own in features])
        return f"expected a feature of {part!r}, got {use.name!r}, which it does not have{near}"
    if use.kinds and features[feature].kind not in use.kinds:
        fitting = [f"{part}.{name}" for name, own in features.items() if own.kind in use.kinds]
        wanted = " or ".join(use.kinds)
        article = "an" if wanted[0] in "aeiou" else "a"
        got = f"got {use.name!r}, which is {features[feature].words}"
        return f"expected {article} {wanted}, {got}{hint(use.name, fitting)}"
    return ""


def unplaced_bodies(scene: Scene) -> Iterator[Problem]:
    """Bodies that are placed twice or never, moves against parts not yet placed, and measures read too early."""
    if scene.of(SolidSpec):
        bodies = Bodies(scene)
        yield from bodies.problems()
        yield from _read_too_early(scene, bodies)


@dataclass
class Bodies:
    """Parts and what is welded to them, move by move.

    Args:
        scene: its parts and moves.
    """

    scene: Scene
    placed: dict[str, str] = field(default_factory=dict)
    """Bodies, and the move that places each; none for parts welded since."""
    body: dict[str, str] = field(default_factory=dict)
    """Body of each part."""
    by: dict[str, set[str]] = field(default_factory=dict)
    """Parts that are placed after each move."""

    def problems(self) -> Iterator[Problem]:
        """Problems, move by move; then parts that no move places."""
        self.body = {name: name for name in self.scene.of(SolidSpec)}
        moves = self.scene.of(AssemblyMoveSpec)
        moving = {part for move in moves.values() for _, part in move.parts_placed}
        for name, move in moves.items():
            here: KeyPath = ("moves", name)
            yield from self._placed(here, move, moving)
            yield from self._joined(here, move, moving)
            self.by[name] = {part for part, own in self.body.items() if own in self.placed}
        for part, own in self.body.items():
            if own not in self.placed:
                words = f"expected a move that places {part!r}, got none"
                yield ("parts", part), f"{words}; {how_to_place(part, self.scene.moves)}"

    def _joined(self, here: KeyPath, move: AssemblyMoveSpec, moving: set[str]) -> Iterator[Problem]:
        if not move.joined:
            return
        (_, leader), *others = move.joined
        joined = {self.body[leader]}
        for path, part in others:
            if self.body[part] in joined:
                yield (*here, *path), f"expected a part of another body, got {part!r}, which is of this one already"
            joined.add(self.body[part])
        for _, part in move.joined:
            if self.body[part] not in self.placed and part in moving:
                words = f"expected parts that are placed already, got {part!r}"
                yield here, f"{words}; put the move that places it before this one"
        for part, own in self.body.items():
            if own in joined:
                self.body[part] = leader
        if joined <= self.placed.keys():
            self.placed[leader] = ""  # it may be moved again, and stays where it is if it is not

    def _placed(self, here: KeyPath, move: AssemblyMoveSpec, moving: set[str]) -> Iterator[Problem]:
        its: set[str] = set()
        for path, part in move.parts_placed:
            if (own := self.body[part]) in its:
                yield (*here, *path), f"expected a part of another body, got {part!r}, which this move places already"
            elif before := self.placed.get(own):
                words = f"expected a part that is not placed yet, got {part!r}, which {before!r} places"
                yield (*here, *path), words
            its.add(own)
        for path, pair in move.paired():
            if self.body[part_of(pair.from_)] not in its:
                yield (*here, *path, "from"), f"expected a feature of the part that is placed, got {pair.from_!r}"
            if self.body[part_of(pair.to)] in its:
                words = f"expected a feature of another part, got {pair.to!r}, which is placed by this move"
                yield (*here, *path, "to"), words
        early: set[str] = set()  # each is reported once
        for path, feature in move.targets():
            part = part_of(feature)
            if self.body[part] not in its | self.placed.keys() and part in moving - early:
                early.add(part)
                words = f"expected a feature of a part that is placed already, got {feature!r}"
                yield (*here, *path), f"{words}; put the move that places {part!r} before this one"
        self.placed |= dict.fromkeys(its, str(here[1]))


def pose_names(scene: Scene) -> tuple[str, ...]:
    """The poses of a scene's moves, in order."""
    moves = scene.of(AssemblyMoveSpec).values()
    return tuple(dict.fromkeys(pose for move in moves for pose in move.pose_names))


def paths_of(scene: Scene) -> Mapping[str, Sequence[str]]:
    """The paths of a scene's moves: by name the poses on them."""
    moves = scene.of(AssemblyMoveSpec).values()
    return {name: poses for move in moves for name, poses in move.path_names.items()}


def pose_of(scene: Scene, name: str) -> str:
    """The pose in which a measure is read, or a path; a difference as its first measure; "" where no move has poses."""
    spec = scene.measures[name]
    if isinstance(spec, DifferenceSpec):
        return pose_of(scene, spec.of)
    return getattr(spec, "over", None) or getattr(spec, "at", None) or next(iter(pose_names(scene)), "")


def read_at(scene: Scene, name: str) -> tuple[str, ...]:
    """The poses in which a measure is read: those of a path, or one."""
    pose = pose_of(scene, name)
    return tuple(paths_of(scene).get(pose, (pose,)))


def read_in(scene: Scene, pose: str) -> Mapping[str, Any]:
    """The measures of a scene, all read in one pose."""
    there = {"at": pose, "over": None, "take": "value"}
    return {
        name: spec.model_copy(update=there) if isinstance(spec, TimedSpec) else spec
        for name, spec in scene.measures.items()
    }


def differences_of_two_poses(scene: Scene) -> Iterator[Problem]:
    """Differences of measures that are read in two poses, of which a trial has one at a time."""
    for name, spec in scene.of(DifferenceSpec).items():
        own, other = (pose_of(scene, each) for each in (spec.of, spec.minus))
        if own != other:
            words = f"expected a measure that is read at {own!r}, as {spec.of!r} is, got {spec.minus!r}"
            yield ("measures", name, "minus"), f"{words}, which is read at {other!r}"


def unknown_poses(scene: Scene) -> Iterator[Problem]:
    """Poses named by measures that no move has."""
    known = {"at": ("poses", pose_names(scene)), "over": ("paths", tuple(paths_of(scene)))}
    for name, measure in scene.measures.items():
        for field_name, (words, names) in known.items() if isinstance(measure, TimedSpec) else ():
            own = getattr(measure, field_name)
            if own is not None and own not in names:
                path = ("measures", name, field_name)
                if not names:
                    yield path, f"expected none, for no move has {words}, got {own!r}"
                else:
                    yield path, f"expected one of the {words} {', '.join(names)}, got {own!r}{hint(own, names)}"


def _read_too_early(scene: Scene, bodies: Bodies) -> Iterator[Problem]:
    for name, measure in scene.measures.items():
        if isinstance(measure, TimedSpec) and measure.after is not None:
            for part in measure.parts_read:
                if part not in bodies.by[measure.after]:
                    words = f"expected a move by which {part!r} is placed, got {measure.after!r}"
                    yield ("measures", name, "after"), f"{words}; name a later one"
                    break


def general_sizes(scene: Scene) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """A tolerance for each diameter or width stated in numbers, as general tolerance of its nominal size.

    Sizes with a tolerance or a profile of their own keep it; sizes read from a solid are left out.
    """
    drawing = Drawing(scene)
    for part, solid in scene.of(SolidSpec).items():
        for name, spec in solid.features.items():
            nominal = getattr(spec, "width" if spec.kind == "slot" else "diameter", None)
            if spec.kind not in SizeSpec.applies_to or nominal is None:
                continue
            own = [f"{part}.{member}" for member in spec.members(name)]
            if not any(drawing.of(feature, kind) for feature in own for kind in (SizeSpec, ProfileSpec)):
                law = {"general": scene.general_sizes, "of": str(nominal)}
                yield f"size of {part} {name}", {"kind": "size", "of": f"{part}.{name}", "distribution": law}
