"""Checks of parts at rest: rocking is stated only where something can rock."""

from collections.abc import Iterator

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.features import ConeSpec, CylinderSpec, FeatureUnion, PlaneSpec, SlotSpec, SphereSpec
from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec, OverPlaySpec
from tol3d.assembly.grammar.measures.contact import ContactAngleSpec, SurfaceGapSpec
from tol3d.assembly.grammar.moves import LocatingSpec, PinAndHoleSpec, PlaySpec, RestSpec
from tol3d.assembly.grammar.moves.locating import ContactSpec
from tol3d.assembly.grammar.moves.play import BoltSpec, EngagementSpec, PatternPairSpec
from tol3d.assembly.model.moves import unfit_surfaces
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]


def idle_rocking(scene: Scene) -> Iterator[Problem]:
    """Measures with `rocking` in a scene in which no part rests."""
    if any(isinstance(move, RestSpec) for move in scene.moves.values()):
        return
    for name, spec in scene.measures.items():
        if isinstance(spec, AssemblyMeasureSpec) and spec.rocking is not None:
            words = f"expected none, for no part of this scene rests on one-sided contacts, got {spec.rocking!r}"
            yield ("measures", name, "rocking"), f"{words}; leave it out, or add a move of kind rest"


NO_SIZE = "a size that does not vary is {kind: size, ..., distribution: {kind: constant, value: 0 mm}}"


def idle_over_play(scene: Scene) -> Iterator[Problem]:
    """Measures over the play of parts in a scene without play."""
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
                continue  # unknown, reported already
            problem = _unfit(pair, drawing) or _unfit_first(move, k, drawing.kind(pair.from_), drawing.kind(pair.to))
            if problem:
                yield here, problem
                continue
            bolt = _bolt_of(pair)
            sized = [("from", pair.from_), ("to", pair.to)]
            sized += [("bolt", bolt.of)] if bolt is not None and bolt.of is not None else []
            for end, own in sized:
                if not drawing.is_sized(own):
                    words = f"expected a size tolerance of {own!r}, because the play depends on it, got none"
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
    """True for a hole or a slot."""
    return (isinstance(feature, CylinderSpec) and feature.hole) or (isinstance(feature, SlotSpec) and not feature.tab)


def _unfit_first(move: PlaySpec, k: int, one: FeatureUnion, other: FeatureUnion) -> str:
    """Error text if a pin-and-hole move does not begin with the pin that holds both shifts; else ""."""
    if isinstance(move, PinAndHoleSpec) and k == 0 and (one.kind, other.kind) != ("cylinder", "cylinder"):
        return "expected a pin in a hole first, which holds both shifts, got a slot; put it second, or take a pattern"
    return ""


def round_contacts(scene: Scene) -> Iterator[Problem]:
    """Round features on planes, of which 3-2-1, six planes and a rest would lay the middle, not the surface."""
    drawing = Drawing(scene)
    for name, move in scene.moves.items():
        if isinstance(move, LocatingSpec):
            for path, pair in move.pairs_by_name.values():
                if words := _round(pair, drawing, rests=isinstance(move, RestSpec)):
                    yield ("moves", name, *path, words[0]), words[1]


def _round(pair: ContactSpec, drawing: Drawing, *, rests: bool) -> tuple[str, str] | None:
    """The key of a round feature that does not fit, and the error text."""
    if not {pair.from_, pair.to} <= set(drawing.names):
        return None
    sides = {"from": (pair.from_, pair.to), "to": (pair.to, pair.from_)}
    for key, (own, other) in sides.items():
        feature = drawing.kind(own)
        if isinstance(feature, SphereSpec | CylinderSpec | ConeSpec) and (rests or _is_face(drawing.kind(other))):
            words = f"expected a point or a plane, got {own!r}, which is {feature.words}: its middle would lie there"
            touched = "name the point of its surface that touches"
            remedy = (
                f"{touched}, for a rest has no round contacts"
                if rests
                else touched
                if isinstance(feature, ConeSpec)
                else f"take a move of kind touch, or {touched}"
            )
            return key, f"{words}; {remedy}"
    return None


def _is_face(feature: FeatureUnion) -> bool:
    return isinstance(feature, PlaneSpec)


def unfit_pairs(scene: Scene) -> Iterator[Problem]:
    """Surfaces that have no common normal, of kinds that each may be of."""
    drawing = Drawing(scene)
    for name, spec in scene.measures.items():
        if isinstance(spec, SurfaceGapSpec | ContactAngleSpec):
            uses = list(spec.uses())[:2]
            if all(use.name in drawing.names and drawing.kind(use.name).kind in use.kinds for use in uses):
                shapes = [drawing.kind(use.name).shape for use in uses]
                if words := unfit_surfaces(shapes[0], shapes[1]):
                    yield ("measures", name), words
