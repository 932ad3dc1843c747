"""Datum frames of a scene: each set of datums once, in the order in which it is named."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from tol3d.assembly.grammar.boundary_checks import shifts_alone
from tol3d.assembly.grammar.datums import DatumSpec
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.measures.assembly_measure import FeatureMeasureSpec
from tol3d.assembly.grammar.measures.pose_errors import DifferenceSpec
from tol3d.assembly.grammar.moves import AssemblyMoveSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.assembly.model import Datum, DatumFrame
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath
from tol3d.scene.temperature import TemperatureSpec


@dataclass(frozen=True, eq=False)
class DatumFrames:
    """Datum frames of a scene, each once.

    Args:
        made: by their names, those by which moves take parts last.
        specs: the datums of each that features, measures or tolerances name.
    """

    made: Mapping[str, DatumFrame]
    specs: Mapping[str, tuple[DatumSpec, ...]]


def frame_name(part: str, datums: Sequence[DatumSpec]) -> str:
    """The name of a part's frame on some datums; "" for none, which is the part's own frame."""
    return "|".join((part, *(_letter(datum) for datum in datums))) if datums else ""


def frame_on(drawing: Drawing, part: str, datums: Sequence[DatumSpec]) -> DatumFrame:
    """A part's frame on some datums, regardless of their sizes."""
    return DatumFrame(
        frame_name(part, datums), part, tuple(_datum(drawing.features[part], part, datum) for datum in datums)
    )


def frames_of(drawing: Drawing) -> DatumFrames:
    """Datum frames that a scene names, regardless of sizes."""
    made, specs = dict[str, DatumFrame](), dict[str, tuple[DatumSpec, ...]]()
    for part, datums in _named(drawing):
        if datums and (name := frame_name(part, datums)) not in made:
            made[name], specs[name] = frame_on(drawing, part, datums), tuple(datums)
    for move in drawing.scene.of(AssemblyMoveSpec).values():
        for part, datums in move.seats:
            made.setdefault(frame_name(part, datums), frame_on(drawing, part, datums))
    return DatumFrames(MappingProxyType(made), MappingProxyType(specs))


def _named(drawing: Drawing) -> Iterator[tuple[str, Sequence[DatumSpec]]]:
    """Parts and datums as a scene names them: of features that grow, of all features, of measures and tolerances."""
    scene, parents = drawing.scene, [(part_of(name), datums) for name, datums in drawing.parents()]
    solids = scene.of(SolidSpec)
    for spec in scene.of(TemperatureSpec).values():
        grown = {part for part in spec.of if part in solids and (own := solids[part].expansion) and own.internal}
        yield from ((part, datums) for part, datums in parents if part in grown)
    yield from parents
    for entry in scene.measures.values():
        inner = [scene.measures[name] for name in (entry.of, entry.minus)] if isinstance(entry, DifferenceSpec) else []
        for measure in inner or [entry]:
            if isinstance(measure, FeatureMeasureSpec):
                yield part_of(measure.named()[0][1]), measure.named_datums
    toleranced = list(of_tolerances(drawing))
    yield from (own for own in toleranced if shifts_alone(drawing, *own))
    yield from toleranced


def of_tolerances(drawing: Drawing) -> Iterator[tuple[str, tuple[DatumSpec, ...]]]:
    """Part and datums of each tolerance that names some, in the scene's order."""
    for own in drawing.stated:
        if not isinstance(own, str) and own.spec.named_datums:
            yield part_of(own.feature), own.spec.named_datums


def _datum(features: Mapping[str, FeatureUnion], part: str, spec: DatumSpec) -> Datum:
    names = tuple(f"{part}.{feature}" for feature in spec.features)
    if not spec.targets:
        flat = any(features[feature].kind in ("plane", "slot") for feature in spec.features)
        pattern = spec.is_several and (flat or spec.gauge is not None)
        return Datum(names, "pattern" if pattern else spec.simulator)
    into = np.linalg.inv(features[spec.features[0]].frame)
    points = np.array([[*(own.internal for own in target), 1.0] for target in spec.targets])
    return Datum(names, spec.simulator, (points @ into.T)[:, :3])


def _letter(spec: DatumSpec) -> str:
    own = "-".join(spec.features)
    if spec.targets:
        return f"{own} at " + "; ".join(" ".join(f"{x.internal:.9g}" for x in target) for target in spec.targets)
    if spec.gauge is not None:
        return f"{own} {spec.key} {spec.gauge}"
    return own if spec.simulator == "contact" else f"{own} {spec.simulator}"


def place_of(scene: Scene, frame: str) -> KeyPath:
    """Key of a datum frame's first mention in a scene, by a tolerance or a measure; () if there is none."""
    for (section, name), entry in scene.entries().items():
        match entry:
            case FeatureTolerance():
                part, datums = part_of(entry.of), entry.named_datums
            case FeatureMeasureSpec():
                part, datums = part_of(entry.named()[0][1]), entry.named_datums
            case _:
                continue
        if datums and frame_name(part, datums) == frame:
            return section, name, "datums"
    return ()


def in_order(
    parents: Mapping[str, str], frames: Mapping[str, DatumFrame]
) -> tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]]:
    """Features and frames so that each comes after what it is made of; and a ring of names where that cannot be.

    Args:
        parents: the datum frame of each feature, "" for the part's own.
        frames: by their names.
    """
    features: list[str] = []
    ordered: list[str] = []
    done, known = {""}, set[str]()
    waiting = list(parents)
    while waiting:
        ready = [name for name in waiting if parents[name] in done]
        if not ready:
            return tuple(features), tuple(ordered), tuple(waiting)
        features += ready
        known |= set(ready)
        waiting = [name for name in waiting if name not in known]
        for name, frame in frames.items():
            if name not in done and all(feature in known for feature in _features(frame)):
                ordered.append(name)
                done.add(name)
    return tuple(features), tuple(ordered), ()


def _features(frame: DatumFrame) -> Iterator[str]:
    return (name for datum in frame.datums for name in datum.features)
