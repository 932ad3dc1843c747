"""What must hold across the entries of a scene of an assembly."""

from collections.abc import Iterator, Mapping

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import Use, UsesFeatures
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.moves import PlacingSpec, WeldSpec
from tol3d.assembly.grammar.moves.placing_move import PairSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.scene import Scene
from tol3d.scene.nearest import hint
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]


def unknown_features(scene: Scene) -> Iterator[Problem]:
    """Features that are not there, or of a kind that will not do."""
    parts = Drawing(scene).features
    for (section, name), entry in scene.entries().items():
        if isinstance(entry, UsesFeatures):
            for use in entry.uses():
                if sentence := _unfit(use, parts):
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
        return f"expected a {wanted}, got {use.name!r}, which is {features[feature].words}{hint(use.name, fitting)}"
    return ""


def unplaced_bodies(scene: Scene) -> Iterator[Problem]:
    """Bodies that are placed twice or never, and moves against what is not placed yet."""
    if not scene.of(SolidSpec):
        return
    placed: dict[str, str] = {}  # bodies, and the move that places each; none of what was welded since
    body = {name: name for name in scene.of(SolidSpec)}
    for name, move in scene.moves.items():
        here: KeyPath = ("moves", name)
        if isinstance(move, WeldSpec):
            yield from _welded(here, move, placed, body)
        elif isinstance(move, PlacingSpec):
            yield from _placed(here, move, placed, body)
    for part in body:
        if body[part] not in placed:
            words = f"expected a move that places {part!r}, got none; add one, such as {{kind: fix, part: {part}}}"
            yield ("parts", part), words


def _welded(here: KeyPath, move: WeldSpec, placed: dict[str, str], body: dict[str, str]) -> Iterator[Problem]:
    for part in (move.part, *move.to):
        if body[part] not in placed:
            yield here, f"expected parts that are placed already, got {part!r}, which no move before this one places"
    joined = {body[part] for part in (move.part, *move.to)}
    for part, own in body.items():
        if own in joined:
            body[part] = move.part
    placed[move.part] = ""  # it may be moved again, and stays where it is if it is not


def _placed(here: KeyPath, move: PlacingSpec, placed: dict[str, str], body: dict[str, str]) -> Iterator[Problem]:
    own = body[move.part]
    before = placed.get(own)
    if before:
        yield (*here, "part"), f"expected a part that is not placed yet, got {move.part!r}, which {before!r} places"
    for path, pair in move.paired():
        yield from _pair_problems((*here, *path), pair, own, placed, body)
    placed[own] = str(here[1])


def _pair_problems(
    path: KeyPath, pair: PairSpec, own: str, placed: dict[str, str], body: dict[str, str]
) -> Iterator[Problem]:
    moving, target = pair.from_.partition(".")[0], pair.to.partition(".")[0]
    if body[moving] != own:
        yield (*path, "from"), f"expected a feature of the part that is placed, got {pair.from_!r}"
    if body[target] == own:
        yield (*path, "to"), f"expected a feature of another part, got {pair.to!r}, which is placed by this move"
    elif body[target] not in placed:
        yield (*path, "to"), f"expected a feature of a part that is placed already, got {pair.to!r}; move it before"
