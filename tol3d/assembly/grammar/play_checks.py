"""What must hold of moves with play: which features engage, and that their sizes are toleranced."""

from collections.abc import Iterator

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.features import CylinderSpec, FeatureUnion, SlotSpec
from tol3d.assembly.grammar.measures.assembly_measure import OverPlaySpec
from tol3d.assembly.grammar.moves import PinAndHoleSpec, PlaySpec
from tol3d.assembly.grammar.moves.play import BoltSpec, EngagementSpec, PatternPairSpec
from tol3d.assembly.grammar.tolerances import SizeSpec
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]

NO_SIZE = "a size that does not vary is {kind: size, ..., distribution: {kind: constant, value: 0 mm}}"


def idle_over_play(scene: Scene) -> Iterator[Problem]:
    """Values over the play of parts where none has any."""
    if not any(isinstance(move, PlaySpec) for move in scene.moves.values()):
        for name, spec in scene.measures.items():
            if isinstance(spec, OverPlaySpec) and spec.over_play is not None:
                words = "expected a move of kind pin_and_hole or pattern, which leaves play, got none; leave it out"
                yield ("measures", name, "over_play"), words


def unfit_engagements(scene: Scene) -> Iterator[Problem]:
    """Pairs of a move with play that do not engage, or whose sizes have no tolerance."""
    drawing = Drawing(scene)
    for name, move in scene.moves.items():
        if not isinstance(move, PlaySpec):
            continue
        for k, pair in enumerate(move.engaged):
            here: KeyPath = ("moves", name, "pairs", k)
            if not all(own in drawing.names for own in (pair.from_, pair.to)):
                continue  # unknown, said already
            problem = _unfit(pair, drawing) or _unfit_first(move, k, drawing.kind(pair.from_), drawing.kind(pair.to))
            if problem:
                yield here, problem
                continue
            bolt = _bolt_of(pair)
            sized = [("from", pair.from_), ("to", pair.to)]
            sized += [("bolt", bolt.of)] if bolt is not None and bolt.of is not None else []
            for end, own in sized:
                if not drawing.of(own, SizeSpec):
                    words = f"expected a size tolerance of {own!r}, for its play follows from its size, got none"
                    yield (*here, end), f"{words}; {NO_SIZE}"


def _unfit(pair: EngagementSpec, drawing: Drawing) -> str:
    one, other = drawing.kind(pair.from_), drawing.kind(pair.to)
    for name, own in ((pair.from_, one), (pair.to, other)):
        if not isinstance(own, CylinderSpec | SlotSpec):
            return f"expected a pin or tab and a hole or slot, got {name!r}, which is {own.words}"
    bolt = _bolt_of(pair)
    if bolt is not None:
        if not all(isinstance(own, CylinderSpec) and own.hole for own in (one, other)):
            return f"expected two holes that the bolt goes through, got {pair.from_!r} and {pair.to!r}"
        shank = None if bolt.of is None or bolt.of not in drawing.names else drawing.kind(bolt.of)
        if isinstance(shank, CylinderSpec) and shank.hole:
            return f"expected a bolt that is a pin, got {bolt.of!r}, which is a hole"
        return ""
    if is_inner(one) == is_inner(other):
        both = "two holes or slots" if is_inner(one) else "two pins or tabs"
        holes = is_inner(one) and isinstance(one, CylinderSpec) and isinstance(other, CylinderSpec)
        advice = "; a bolt that is loose in both is `bolt` of a pattern's pair" if holes else ""
        return f"expected a pin or tab and a hole or slot, got {both}, {pair.from_!r} and {pair.to!r}{advice}"
    inner, outer = (one, other) if is_inner(one) else (other, one)
    if isinstance(inner, CylinderSpec) and isinstance(outer, SlotSpec):
        return "expected a pin in a hole, a pin in a slot or a tab in a slot, got a tab in a hole"
    return ""


def _bolt_of(pair: EngagementSpec) -> BoltSpec | None:
    return pair.bolt if isinstance(pair, PatternPairSpec) else None


def is_inner(feature: FeatureUnion) -> bool:
    """Whether it is a hole or a slot."""
    return (isinstance(feature, CylinderSpec) and feature.hole) or (isinstance(feature, SlotSpec) and not feature.tab)


def _unfit_first(move: PlaySpec, k: int, one: FeatureUnion, other: FeatureUnion) -> str:
    """Of a pin-and-hole move the first holds both shifts."""
    if isinstance(move, PinAndHoleSpec) and k == 0 and (one.kind, other.kind) != ("cylinder", "cylinder"):
        return "expected a pin in a hole first, which holds both shifts, got a slot; put it second, or take a pattern"
    return ""
