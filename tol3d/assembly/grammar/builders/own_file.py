"""A Python file of the user that builds a solid."""

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, Field

from tol3d.strict import Strict, refused
from tol3d.units import Of, Quantity, shown


def _argument(name: str) -> str:
    if not name.isidentifier():
        raise refused("", "a name that Python takes as an argument, such as wall_thickness", shown(name))
    return name


Argument = Annotated[str, AfterValidator(_argument)]
Size = Annotated[Quantity, Of("length", "angle")]


class OwnFileSpec(Strict):
    """A program that makes the solid; it runs only where the user says so, and never from a run that was kept."""

    words: ClassVar[str] = "a Python file"

    kind: Literal["file"]
    file: str = Field(description="the Python file, in the scene's folder")
    function: Argument = Field(default="build", description="of the file, which returns the solid")
    dimensions: Mapping[Argument, Size] = Field(
        default_factory=dict, description="its arguments that are lengths or angles; it gets them in mm and rad"
    )
    counts: Mapping[Argument, int] = Field(default_factory=dict, description="its arguments that are whole numbers")
