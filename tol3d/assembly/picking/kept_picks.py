"""Picked faces in features.json, the file that a run keeps: it repeats the run without the CAD kernel."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from tol3d.assembly.grammar.builders.builder_spec import OwnFileSpec
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.features.feature_spec import FaceKind
from tol3d.assembly.grammar.parts import SolidSpec, StepSpec, likes
from tol3d.assembly.picking.step_picks import checked
from tol3d.cad.solids.built_shape import BuiltShape
from tol3d.cad.solids.kept_shape import KeptShape, run_program
from tol3d.cad.solids.pick import PickedFace, Triple
from tol3d.cad.step.step_shape import StepShape
from tol3d.errors import GeometryError, Problem, SceneError
from tol3d.files import FileContent, Files
from tol3d.scene import Scene
from tol3d.units import LARGEST

FEATURES: Final = "features.json"
"""The name under which a run keeps it."""

ROUNDING: Final = 1e-9

READ: Final = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)

Coordinate = Annotated[float, Field(ge=-LARGEST["length"], le=LARGEST["length"])]
Size = Annotated[float, Field(ge=0.0, le=LARGEST["length"])]
Cosine = Annotated[float, Field(ge=-1.0 - ROUNDING, le=1.0 + ROUNDING)]
Place = tuple[Coordinate, Coordinate, Coordinate]


def _unit(direction: Triple) -> Triple:
    if abs(math.hypot(*direction) - 1.0) > ROUNDING:
        raise ValueError("Input should be a direction of length 1")
    return direction


Unit = Annotated[tuple[Cosine, Cosine, Cosine], AfterValidator(_unit)]


class KeptFace(BaseModel):
    """A face as the file has it; see PickedFace."""

    model_config = READ

    name: str
    kind: FaceKind
    at: Place
    direction: Unit
    x: Unit
    extent: tuple[Size, Size]
    radius: Size
    hole: bool
    nearest: Place
    normal: Unit
    radii: tuple[Size, Size] = (0.0, 0.0)


class KeptPlace(BaseModel):
    """Pose of a part as stated in its file: origin, z and x."""

    model_config = READ

    at: Place
    z: Unit
    x: Unit


class KeptPicks(BaseModel):
    """The file: lengths in mm, in the frames of the parts."""

    model_config = READ

    picks: Mapping[str, Mapping[str, tuple[KeptFace, ...]]]
    faces: Mapping[str, tuple[str, ...]]
    placed: Mapping[str, KeptPlace] = Field(default_factory=dict)


@dataclass(frozen=True)
class Kept:
    """Faces of solids from which features are picked.

    Args:
        picks: the faces, by part and feature.
        faces: of parts that a program of the user built, the names of all faces in the order of the solid's.
        placed: of parts that stand where their file says: origin, z and x.
    """

    picks: Mapping[str, Mapping[str, tuple[PickedFace, ...]]]
    faces: Mapping[str, tuple[str, ...]]
    placed: Mapping[str, tuple[Triple, Triple, Triple]]

    def faces_of(self, part: str, feature: str, spec: FeatureUnion) -> tuple[PickedFace, ...]:
        """The faces of a feature.

        Raises:
            SceneError: a run that is made again has not kept them.
        """
        found = self.picks.get(part, {}).get(feature, ())
        fits = all(face.kind in spec.face_kinds for face in found) if spec.face_kinds else True
        if len(found) != len(spec.faces_picked) or not fits or not all(map(_has_size, found)):
            words = f"expected the faces of {part}.{feature}, found others; the run is damaged"
            raise SceneError(Problem.at(FEATURES, words))
        return found

    def selected(self, part: str, feature: str, spec: StepSpec) -> tuple[PickedFace, ...]:
        """Faces that a part from a STEP file selects as a feature.

        Raises:
            SceneError: a run that is made again has not kept it.
        """
        found = self.picks.get(part, {}).get(feature, ())
        checked(part, spec, feature, found if all(map(_has_size, found)) else (), FEATURES)
        return found


def _has_size(face: PickedFace) -> bool:
    """True if a face has a size, as its kind requires."""
    match face.kind:
        case "plane":
            return min(face.extent) > 0.0
        case "cylinder":
            return face.extent[0] > 0.0 and face.radius > 0.0
        case "cone":
            return face.extent[0] > 0.0
    return face.radius > 0.0


def file_of(kept: Kept) -> FileContent:
    """Picked faces as a file."""
    plain: dict[str, Any] = {
        "picks": {
            part: {feature: [asdict(face) for face in faces] for feature, faces in own.items()}
            for part, own in kept.picks.items()
        },
        "faces": {part: list(names) for part, names in kept.faces.items()},
    }
    if kept.placed:
        plain["placed"] = {part: {"at": at, "z": z, "x": x} for part, (at, z, x) in kept.placed.items()}
    return FileContent(Path(FEATURES), (json.dumps(plain, indent=1) + "\n").encode())


def kept_in(files: Files, source: Path) -> Kept:
    """Picked faces kept by a run; the file is not trusted.

    Raises:
        SceneError: there is no such file, or it is invalid.
    """
    if FEATURES not in files:
        raise SceneError(Problem.at(source, f"expected {FEATURES} beside it, found none; run the scene again"))
    try:
        found = KeptPicks.model_validate_json(files[FEATURES].content)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(map(str, first["loc"]))
        words = f"{first['msg']}; the run is damaged"
        raise SceneError(Problem.at(files[FEATURES].path, words, path=place)) from None
    picks = {
        part: {feature: tuple(PickedFace(**dict(face)) for face in faces) for feature, faces in own.items()}
        for part, own in found.picks.items()
    }
    placed = {part: (own.at, own.z, own.x) for part, own in found.placed.items()}
    return Kept(picks, found.faces, placed)


def face_names(scene: Scene) -> dict[str, str]:
    """The faces that features are picked from, by the features' names with their parts; those by numbers are left out.

    Raises:
        SceneError: the run's kept faces are damaged.
    """
    solids = scene.of(SolidSpec)
    if not any(feature.faces_picked for solid in solids.values() for feature in solid.features.values()):
        return {}
    kept = kept_in(scene.files, scene.source)
    return {
        f"{name}.{feature}": " and ".join(face.name for face in faces)
        for name in solids
        for first in likes(name, solids)[-1:]
        for feature, faces in kept.picks.get(first, {}).items()
        if not any(feature in solids[like].features for like in likes(name, solids)[:-1])
    }


def shapes_of(scene: Scene) -> dict[str, BuiltShape]:
    """The solids of parts, by their names, of a scene that is settled; parts without one are left out."""
    solids = scene.of(SolidSpec)
    found: dict[str, BuiltShape] = {}
    for name in solids:
        part = likes(name, solids)[-1]
        own = solids[part]
        builder = own.builder
        if isinstance(own, StepSpec):
            found[name] = StepShape.of(scene.files[own.file], own.product, own.use)
        elif isinstance(builder, OwnFileSpec):
            content = scene.files[solid_file(part)].content
            found[name] = KeptShape.of(content, kept_in(scene.files, scene.source).faces.get(part, ()))
        elif builder is not None:
            found[name] = builder.shape
    return found


def built_shape(scene: Scene, part: str, *, run_builders: bool) -> BuiltShape:
    """The solid of a part with a builder; a program of the user is run.

    Raises:
        GeometryError: it must not run, or makes no solid.
    """
    builder = scene.of(SolidSpec)[part].builder
    assert builder is not None
    if not isinstance(builder, OwnFileSpec):
        return builder.shape
    if not run_builders:
        words = f"expected permission to run {builder.file}, which is a program, got none"
        raise GeometryError(f"{words}; read it, and use --run-builders if you trust it")
    dimensions = {name: own.internal for name, own in builder.dimensions.items()}
    return run_program(scene.files[builder.file], builder.function, {**dimensions, **builder.counts})


def solid_file(part: str) -> str:
    """The name under which a run keeps the solid built by a user's program."""
    return f"{part}.brep"


def kept_solid(part: str, shape: KeptShape) -> FileContent:
    """Solid built by a user's program, as a file."""
    return FileContent(Path(solid_file(part)), shape.brep)
