"""A scene completed by numbers from the solids of its parts."""

from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.grammar.builders.builder_spec import place_of
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.features.feature_spec import FeatureSpec, Found
from tol3d.assembly.grammar.features.nominal_frame import unit
from tol3d.assembly.grammar.features.point import PointSpec
from tol3d.assembly.grammar.features.selector import SelectorSpec
from tol3d.assembly.grammar.parts import SolidSpec, StepSpec
from tol3d.assembly.picking.kept_picks import FEATURES, Kept, built_shape, file_of, kept_in, kept_solid, solid_file
from tol3d.assembly.picking.step_picks import looked_up, place_in_file, placed, with_numbers
from tol3d.cad.solids.built_shape import BuiltShape
from tol3d.cad.solids.cache import picked
from tol3d.cad.solids.kept_shape import KeptShape
from tol3d.cad.solids.pick import Pick, PickedFace, PickError, Triple
from tol3d.errors import GeometryError
from tol3d.files import Files
from tol3d.parts.details import DetailError
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath
from tol3d.scene.references import Refusal, refuse
from tol3d.units import Quantity

AGREED: Final = 1e-4
"""mm; a number that differs by more is a different one: drawings are written to a thousandth of a millimetre."""
AGREED_SLOPE: Final = 1e-6
"""Sine between directions that are the same."""


def disagreements(spec: FeatureSpec, found: Mapping[str, Found]) -> Iterator[tuple[str, str]]:
    """Fields stated in a scene that contradict the face, each with a sentence.

    Args:
        spec: the feature as the scene has it.
        found: its fields as the face has them.
    """
    for field, own in found.items():
        stated = getattr(spec, field)
        if stated is not None and field in spec.model_fields_set and not _agree(stated, own):
            yield field, f"expected what the face of the solid has, {_shown(own)}, got {_shown(stated)}"


def _agree(stated: Found, found: Found) -> bool:
    if isinstance(stated, bool):
        return stated is found
    if isinstance(stated, Quantity):
        assert isinstance(found, Quantity)
        return abs(stated.internal - found.internal) <= AGREED
    assert isinstance(found, tuple)
    if isinstance(stated[0], Quantity):
        return float(np.linalg.norm(_plain(stated) - _plain(found))) <= AGREED
    return float(np.linalg.norm(_unit(stated) - _unit(found))) <= AGREED_SLOPE


def _plain(values: tuple[Quantity | float, ...]) -> NDArray[np.float64]:
    """Lengths in mm."""
    return np.array([value.internal if isinstance(value, Quantity) else value for value in values])


def _unit(values: tuple[Quantity | float, ...]) -> NDArray[np.float64]:
    x, y, z = _plain(values).tolist()
    return unit((x, y, z))


def _shown(value: Found) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Quantity):
        return f"{round(value.internal, 6):.9g} mm"
    return f"[{', '.join(_shown(own) if isinstance(own, Quantity) else f'{round(own, 9):.9g}' for own in value)}]"


SHAPES: Final = 256
"""Shapes whose faces are kept."""
NO_FILES: Final[Files] = {}


def settle(scene: Scene, *, run_builders: bool, known: Files | None) -> tuple[Scene, Files]:
    """See tol3d.scene.load.Settle."""
    solids = {name: own for name, own in scene.of(SolidSpec).items() if own.has_solid}
    if not solids:
        return scene, {}
    if known is not None:
        kept, files = kept_in(known, scene.source), NO_FILES
    else:
        kept, files = _looked_up(scene, solids, run_builders=run_builders)
    problems: list[Refusal] = []
    parts = dict(scene.parts)
    for name, own in solids.items():
        features = {}
        for feature, spec in own.features.items():
            path = ("parts", name, "features", feature)
            if isinstance(spec, SelectorSpec):
                features[feature] = with_numbers(spec, kept.selected(name, feature, own))
                continue
            faces = kept.faces_of(name, feature, spec)
            features[feature] = spec if not spec.faces_picked else _with_numbers(spec, faces, path, problems)
        place = {"placed": placed(kept.placed[name])} if name in kept.placed else {}
        parts[name] = own.model_copy(update={"features": features, **place})
    refuse(scene, problems)
    return scene.model_copy(update={"parts": parts}).read_from(scene.origin), files


@lru_cache(maxsize=SHAPES)
def _picked(shape: BuiltShape, picks: tuple[Pick, ...]) -> tuple[PickedFace, ...]:
    """Faces that picks mean, as they were found before; see tol3d.cad.solids.cache.picked."""
    return picked(shape, picks)


def _looked_up(scene: Scene, solids: Mapping[str, SolidSpec], *, run_builders: bool) -> tuple[Kept, Files]:
    """Faces of solids from which features are picked.

    Raises:
        SceneError: a solid cannot be built, or a pick matches no face or several.
    """
    picks: dict[str, Mapping[str, tuple[PickedFace, ...]]] = {}
    names: dict[str, tuple[str, ...]] = {}
    places: dict[str, tuple[Triple, Triple, Triple]] = {}
    files = {}
    problems: list[Refusal] = []
    for name, own in solids.items():
        if isinstance(own, StepSpec):
            picks[name], unfound = looked_up(name, own, scene.files[own.file])
            problems += unfound
            if not unfound and (place := place_in_file(own, scene.files[own.file])) is not None:
                places[name] = place
            continue
        here: KeyPath = ("parts", name, "builder")
        try:
            shape = built_shape(scene, name, run_builders=run_builders)
            if isinstance(shape, KeptShape):
                files[solid_file(name)] = kept_solid(name, shape)
                names[name] = shape.faces
            asked = [(path, pick) for path, pick in _picks(name, own)]
            found = _picked(shape, tuple(pick for _, pick in asked))
        except PickError as error:
            path, _ = asked[error.number]
            problems.append(((*path, error.by), str(error)))
            continue
        except DetailError as error:
            assert own.builder is not None
            problems.append(((*here, *place_of(own.builder, error.name)), str(error)))
            continue
        except GeometryError as error:
            problems.append((here, str(error)))
            continue
        by_feature: dict[str, tuple[PickedFace, ...]] = {}
        for (path, _), face in zip(asked, found, strict=True):
            feature = str(path[3])
            by_feature[feature] = (*by_feature.get(feature, ()), face)
        picks[name] = by_feature
    refuse(scene, problems)
    kept = Kept(picks, names, places)
    return kept, {**files, FEATURES: file_of(kept)}


def _picks(part: str, solid: SolidSpec) -> Iterator[tuple[KeyPath, Pick]]:
    """Picks of a part's features, each with its key in the scene."""
    for feature, spec in solid.features.items():
        for field, face in spec.faces_picked.items():
            keys = (int(key) if key.isdecimal() else key for key in field.split("."))
            near = None if face.near is None else _triple(face.near)
            if isinstance(spec, PointSpec) and spec.at is not None:
                near = _triple(spec.at)  # the point of a named face
            kinds = spec.face_kinds if face.kind is None else (face.kind,)
            yield ("parts", part, "features", feature, *keys), Pick(face.name or "", near, kinds, spec.x_picked)


def _triple(vector: tuple[Quantity, Quantity, Quantity]) -> Triple:
    x, y, z = (own.internal for own in vector)
    return x, y, z


def _with_numbers(
    spec: FeatureUnion, faces: tuple[PickedFace, ...], path: KeyPath, problems: list[Refusal]
) -> FeatureUnion:
    """A feature with the numbers of its faces; contradicting numbers are problems."""
    try:
        found = spec.found(faces)
    except GeometryError as error:
        problems.append((path, str(error)))
        return spec
    problems += [((*path, field), sentence) for field, sentence in disagreements(spec, found)]
    return spec.model_copy(update=dict(found))
