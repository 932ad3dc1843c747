"""The section `include` of a scene: other files, each by the name that goes in front of all of theirs."""

from collections.abc import Mapping
from typing import Annotated, Any, Final

from pydantic import AfterValidator, BeforeValidator, Field, GetJsonSchemaHandler, TypeAdapter
from pydantic.json_schema import JsonSchemaValue

from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.vector import Vector
from tol3d.strict import Strict, refused
from tol3d.units import shown

INCLUDE: Final = "include"


def _undotted(name: str) -> str:
    if "." in name:
        raise refused("", "a name without dots (features are written part.feature)", shown(name))
    return name


class IncludeSpec(Strict):
    """A file that is included."""

    file: str = Field(description="a scene, or parts of one, in the folder of the scene or below it")
    at: Vector | None = Field(default=None, description="where its origin lies; default: at that of the scene")
    without: Annotated[tuple[Name, ...], listed("names")] = Field(
        default=(), description="entries of it that are left out, by the names that they have in the file"
    )


def _spelt_out(given: Any) -> Any:
    return {"file": given} if isinstance(given, str) else given


class Including(Strict):
    """The section `include` of a scene."""

    include: Mapping[
        Annotated[Name, AfterValidator(_undotted)],
        Annotated[IncludeSpec, BeforeValidator(_spelt_out, json_schema_input_type=str | IncludeSpec)],
    ] = Field(description="other files, each by the name that goes in front of all of theirs")


def with_include(scene: JsonSchemaValue, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
    """The JSON Schema of scenes with this section, which may bring all others but the scene's name."""
    own = handler.resolve_ref_schema(scene)
    section = handler.resolve_ref_schema(handler(TypeAdapter(Including).core_schema))["properties"][INCLUDE]
    sections = [name for name in own["required"] if name != "scene"]
    own["properties"] = {**own["properties"], INCLUDE: section}
    own["required"] = ["scene"]
    own["anyOf"] = [{"required": sections}, {"required": [INCLUDE]}]
    return scene
