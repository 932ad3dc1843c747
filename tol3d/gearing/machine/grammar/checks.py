"""Checks across the entries of a scene of gears in a housing, and warnings of probable slips."""

from collections.abc import Iterator
from typing import Final

from tol3d.assembly.grammar.checks import pose_names
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.measures.assembly_measure import TimedSpec
from tol3d.assembly.grammar.moves import AssemblyMoveSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.gearing.grammar.checks import too_thick
from tol3d.gearing.grammar.parts import ShaftSpec
from tol3d.gearing.machine.grammar.bores import ShaftInBoresSpec
from tol3d.gearing.machine.grammar.open_chain import OpenChainSpec, WorstPositionErrorSpec
from tol3d.scene import Scene
from tol3d.scene.nearest import hint
from tol3d.scene.place import KeyPath

Problem = tuple[KeyPath, str]

MOST_JOINTS: Final = 12
"""Largest number of joints of which a worst error tries both flanks: 4096 builds per trial and pose."""


def laid_twice(scene: Scene) -> Iterator[Problem]:
    """Shafts that lie in two places, bores with two shafts, and one bore named for both ends."""
    shafts: dict[str, str] = {}
    bores: dict[str, str] = {}
    for name, move in scene.of(ShaftInBoresSpec).items():
        if before := shafts.get(move.shaft):
            words = f"expected a shaft that lies in no bores yet, got {move.shaft!r}, which {before!r} lays"
            yield ("moves", name, "shaft"), words
        shafts.setdefault(move.shaft, name)
        for k, bore in enumerate(move.in_):
            if bore in move.in_[:k]:
                yield ("moves", name, "in", k), f"expected another bore than the first, got {bore!r} twice"
            elif other := bores.get(bore):
                words = f"expected a bore without a shaft, got {bore!r}, in which {other!r} lays one"
                yield ("moves", name, "in", k), words
            bores.setdefault(bore, name)


def read_over_paths(scene: Scene) -> Iterator[Problem]:
    """Measures over paths, which scenes with gears do not have; one without is looked at by other words, too."""
    if all(isinstance(part, SolidSpec) for part in scene.parts.values()):
        return
    for name, spec in scene.measures.items():
        if isinstance(spec, TimedSpec) and spec.over is not None:
            words = f"expected `at` a pose, for in a scene with gears no path is read, got {spec.over!r}"
            yield ("measures", name, "over"), words


def laid_too_early(scene: Scene) -> Iterator[Problem]:
    """Shafts in bores of parts that a later move places; each part is reported once."""
    order = list(scene.moves)
    placing: dict[str, str] = {}
    for name, placed in reversed(list(scene.of(AssemblyMoveSpec).items())):
        placing |= {part: name for _, part in placed.parts_placed}
    for name, move in scene.of(ShaftInBoresSpec).items():
        for k, bore in enumerate(move.in_):
            by = placing.get(part_of(bore), name)
            if order.index(by) > order.index(name):
                del placing[part_of(bore)]
                words = f"expected a bore of a part that is placed already, got {bore!r}"
                yield ("moves", name, "in", k), f"{words}; put the move {by!r}, which places it, before this one"


def shafts_thicker_than_bores(scene: Scene) -> Iterator[Problem]:
    """Shafts that do not go into a bore that holds them."""
    drawing = Drawing(scene)
    for move in scene.of(ShaftInBoresSpec).values():
        shaft = scene.parts[move.shaft]
        if not isinstance(shaft, ShaftSpec):
            continue
        for bore in move.in_:
            if sentence := too_thick(shaft, drawing.kind(bore).shape.nominal_size, repr(bore)):
                yield ("parts", move.shaft, "diameter"), sentence


def joints_named_twice(scene: Scene) -> Iterator[Problem]:
    """Joints of two chains that have one name, by which flanks and reasons are told."""
    known: dict[str, str] = {}
    for name, spec in scene.of(OpenChainSpec).items():
        for joint in spec.joints:
            if other := known.get(joint):
                words = f"expected a name of its own, got {joint!r}, which is a joint of {other!r} too"
                yield ("moves", name, "joints", joint), words
            known[joint] = name


def unfit_worst_errors(scene: Scene) -> Iterator[Problem]:
    """Worst errors over poses that no move has, or over the flanks of too many joints."""
    poses = pose_names(scene)
    driven = [joint for spec in scene.of(OpenChainSpec).values() for joint in spec.joints.values() if joint.train]
    for name, spec in scene.of(WorstPositionErrorSpec).items():
        if not poses:
            yield ("measures", name, "kind"), "expected a move with poses beside it, such as an open_chain, got none"
        for k, pose in enumerate(spec.poses or ()):
            if poses and pose not in poses:
                words = f"expected one of the poses {', '.join(poses)}, got {pose!r}"
                yield ("measures", name, "poses", k), f"{words}{hint(pose, poses)}"
        if spec.flanks == "any" and len(driven) > MOST_JOINTS:
            words = f"expected loaded, got any with {len(driven)} joints that trains turn"
            yield ("measures", name, "flanks"), f"{words}; both flanks of {MOST_JOINTS} are asked at most"
