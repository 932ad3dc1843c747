"""Features that a scene selects on parts from STEP files: what their faces are, and the features by numbers."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Final

from tol3d.assembly.grammar.features import AxisSpec, ConeSpec, CylinderSpec, FeatureUnion, PlaneSpec, SphereSpec
from tol3d.assembly.grammar.features.feature_spec import FaceKind, lengths
from tol3d.assembly.grammar.features.pattern import Scattered
from tol3d.assembly.grammar.features.selector import SelectorSpec
from tol3d.assembly.grammar.parts import StepSpec
from tol3d.assembly.grammar.parts.solid import Placement
from tol3d.cad.solids.pick import PickedFace, Triple
from tol3d.cad.step.found_features import FoundFeature
from tol3d.cad.step.reading import StepFile, read_step
from tol3d.cad.step.refused import StepError
from tol3d.cad.step.selectors import SelectionError, Selector, numbers, selected
from tol3d.errors import Problem, SceneError
from tol3d.files import FileContent
from tol3d.scene.place import KeyPath
from tol3d.scene.references import Refusal

FILES: Final = 8
"""STEP files that are kept as they were read, each some MB."""

FACE_KINDS: Final[dict[str, FaceKind]] = {
    "plane": "plane",
    "hole": "cylinder",
    "pin": "cylinder",
    "fillet": "cylinder",
    "round": "cylinder",
    "cone": "cone",
    "ball": "sphere",
    "socket": "sphere",
}
"""Kind of face in a scene for each kind of feature."""


def looked_up(
    part: str, spec: StepSpec, file: FileContent
) -> tuple[Mapping[str, tuple[PickedFace, ...]], Sequence[Refusal]]:
    """Faces that a part's features select, by feature, and problems where they select none."""
    try:
        read = _read(file)
    except StepError as error:
        return {}, [(("parts", part, "file"), str(error))]
    try:
        found = read.part(spec.product, spec.use)
    except StepError as error:
        field = "use" if spec.use is not None else "file" if spec.product is None else "product"
        return {}, [(("parts", part, field), str(error))]
    faces, problems = dict[str, tuple[PickedFace, ...]](), list[Refusal]()
    for name, own in spec.selectors.items():
        path: KeyPath = ("parts", part, "features", name)
        try:
            faces[name] = tuple(face_of(each) for each in selected(found, selector_of(own)))
        except SelectionError as error:
            problems.append(((*path, *([error.field] if error.field else [])), str(error)))
        except StepError as error:
            problems.append((path, str(error)))
    return faces, problems


@lru_cache(maxsize=FILES)
def _read(file: FileContent) -> StepFile:
    """A file as it was read before, by its content."""
    return read_step(file)


def selector_of(spec: SelectorSpec) -> Selector:
    """Selector of an entry of a scene."""
    near = None if spec.near is None else tuple(own.internal for own in spec.near)
    return Selector(
        face=spec.number,
        name=spec.face if spec.number is None else None,
        faces=spec.numbers,
        datum=spec.datum,
        pmi=spec.pmi,
        tolerance=spec.tolerance,
        value=None if spec.value is None else spec.value.internal,
        datums=spec.datums,
        kind=spec.kind,
        diameter=None if spec.diameter is None else spec.diameter.internal,
        near=None if near is None else (near[0], near[1], near[2]),
        within=None if spec.within is None else spec.within.internal,
        count=spec.count,
        along=spec.along,
    )


def face_of(feature: FoundFeature) -> PickedFace:
    """A feature as runs keep it.

    Raises:
        StepError: a scene cannot use it.
    """
    if feature.kind not in FACE_KINDS:
        raise StepError(f"expected a {', '.join(FACE_KINDS)}, got a {feature.kind} ({numbers(feature)})")
    radius = 0.0 if feature.kind == "cone" else feature.radius
    normal = feature.direction
    return PickedFace(
        numbers(feature), FACE_KINDS[feature.kind], feature.at, feature.direction, feature.x, feature.extent, radius,
        feature.hollow, feature.on, normal, feature.radii,
    )  # fmt: skip


def place_in_file(spec: StepSpec, file: FileContent) -> tuple[Triple, Triple, Triple] | None:
    """Origin, z and x of a part as its file has them; None where its scene says where it stands."""
    if spec.use is None or "placed" in spec.model_fields_set:
        return None
    return _read(file).use(spec.use).frame


def placed(place: tuple[Triple, Triple, Triple]) -> Placement:
    """Pose of a part from origin, z and x."""
    at, z, x = place
    return Placement.model_validate({"at": lengths(*at), "z": z, "x": x})


def with_numbers(spec: SelectorSpec, faces: Sequence[PickedFace]) -> FeatureUnion:
    """A feature by numbers; of several, an entry that stands for all of them."""
    made = [_by_numbers(spec, face) for face in faces]
    if spec.count is None:
        return made[0]
    return made[0].model_copy(update={"pattern": Scattered(tuple(made))})


def _by_numbers(spec: SelectorSpec, face: PickedFace) -> FeatureUnion:
    at = lengths(*face.at)
    if face.kind == "plane":
        size = {"radius": lengths(face.radius)[0]} if face.radius else {"extent": lengths(*face.extent)}
        along = {} if spec.along is None else {"along": spec.along}
        return PlaneSpec.model_validate({"kind": "plane", "at": at, "normal": face.direction, **size, **along})
    diameter = {"diameter": lengths(2 * face.radius)[0], "hole": face.hole}
    if face.kind == "sphere":
        return SphereSpec.model_validate({"kind": "sphere", "at": at, **diameter})
    numbers = {"at": at, "axis": face.direction, "length": lengths(face.extent[0])[0]}
    if face.kind == "cone" and face.radii == (0.0, 0.0):  # kept by a run of before cones were features
        return AxisSpec.model_validate({"kind": "axis", **numbers})
    if face.kind == "cone":
        diameters = lengths(*(2 * radius for radius in face.radii))
        return ConeSpec.model_validate({"kind": "cone", **numbers, "diameters": diameters, "hole": face.hole})
    return CylinderSpec.model_validate({"kind": "cylinder", **numbers, **diameter})


def checked(part: str, spec: StepSpec, name: str, faces: Sequence[PickedFace], file: str) -> None:
    """Refuse kept faces that are not those selected by the run's scene.

    Raises:
        SceneError: it is damaged.
    """
    own = spec.selectors[name]
    wanted = {FACE_KINDS[own.kind]} if own.kind is not None else set(FACE_KINDS.values())
    if len(faces) != (own.count or 1) or not all(face.kind in wanted for face in faces):
        words = f"expected the faces of {part}.{name}, found others; the run is damaged"
        raise SceneError(Problem.at(file, words))
