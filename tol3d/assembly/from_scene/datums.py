"""Datum frames of a scene: each set of datums once, in the order in which they are made."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from tol3d.assembly.grammar.datums import DatumSpec
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.measures.assembly_measure import FeatureMeasureSpec
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.assembly.model import Datum, DatumFrame
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath


@dataclass
class DatumFrames:
    """Datum frames as they are asked for.

    Args:
        features: specs by part and name.
        made: by their names.
        specs: the datums of each.
    """

    features: Mapping[str, Mapping[str, FeatureUnion]]
    made: dict[str, DatumFrame] = field(default_factory=dict)
    specs: dict[str, tuple[DatumSpec, ...]] = field(default_factory=dict)

    def named(self, part: str, datums: Sequence[DatumSpec]) -> str:
        """The name of a part's frame on some datums; "" for none, which is the part's own frame."""
        if not datums:
            return ""
        name = "|".join((part, *(_letter(datum) for datum in datums)))
        if name not in self.made:
            self.specs[name] = tuple(datums)
            self.made[name] = DatumFrame(name, part, tuple(self._datum(part, own) for own in datums))
        return name

    def _datum(self, part: str, spec: DatumSpec) -> Datum:
        names = tuple(f"{part}.{feature}" for feature in spec.features)
        if not spec.targets:
            flat = any(self.features[part][own].kind in ("plane", "slot") for own in spec.features)
            pattern = spec.is_several and (flat or spec.gauge is not None)
            return Datum(names, "pattern" if pattern else spec.simulator)
        into = np.linalg.inv(self.features[part][spec.features[0]].frame)
        points = np.array([[*(own.internal for own in target), 1.0] for target in spec.targets])
        return Datum(names, spec.simulator, (points @ into.T)[:, :3])

    def of(self, part: str) -> tuple[DatumFrame, ...]:
        """The frames of a part."""
        return tuple(frame for frame in self.made.values() if frame.part == part)


def _letter(spec: DatumSpec) -> str:
    own = "-".join(spec.features)
    if spec.targets:
        return f"{own} at " + "; ".join(" ".join(f"{x.internal:.9g}" for x in target) for target in spec.targets)
    if spec.gauge is not None:
        return f"{own} {spec.key} {spec.gauge}"
    return own if spec.simulator == "contact" else f"{own} {spec.simulator}"


def place_of(scene: Scene, frame: str) -> KeyPath:
    """Key of a datum frame's first mention in a scene, by a tolerance or a measure; () if there is none."""
    frames = DatumFrames(Drawing(scene).features)
    for (section, name), entry in scene.entries().items():
        match entry:
            case FeatureTolerance():
                part, datums = part_of(entry.of), entry.named_datums
            case FeatureMeasureSpec():
                part, datums = part_of(entry.named()[0][1]), entry.named_datums
            case _:
                continue
        if datums and frames.named(part, datums) == frame:
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
            if name not in done and all(own in known for own in _features(frame)):
                ordered.append(name)
                done.add(name)
    return tuple(features), tuple(ordered), ()


def _features(frame: DatumFrame) -> Iterator[str]:
    return (name for datum in frame.datums for name in datum.features)
