"""A part from a STEP file."""

from collections.abc import Iterator, Mapping
from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.feature_name import OwnName
from tol3d.assembly.grammar.features.selector import SelectedUnion, SelectorSpec
from tol3d.assembly.grammar.parts.solid import SolidSpec
from tol3d.scene.place import KeyPath
from tol3d.strict import refused


class StepSpec(SolidSpec):
    """A rigid part whose solid is that of a STEP file, with features selected on it."""

    words: ClassVar[str] = "a part from a STEP file"

    kind: Literal["step"]  # type: ignore[assignment]
    file: str = Field(description="the STEP file, in the scene's folder")
    product: str | None = Field(default=None, description="which of its products; default: the only one")
    use: str | None = Field(
        default=None,
        description="a part as it stands in the file's assembly, such as lower/bolt_2, in place of `product`; "
        "placed as there if `placed` is not given",
    )
    features: Mapping[OwnName, SelectedUnion] = Field(  # type: ignore[assignment]
        default_factory=dict, description="what its drawing names: selected on its faces, or by numbers"
    )

    @property
    def has_solid(self) -> bool:
        """See PartSpec."""
        return True

    @property
    def selectors(self) -> Mapping[str, SelectorSpec]:
        """The features that are selected on its faces, by their names."""
        return {name: own for name, own in self.features.items() if isinstance(own, SelectorSpec)}

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """The STEP file."""
        yield ("file",), self.file

    @model_validator(mode="after")
    def _refuse_other_solids(self) -> Self:
        if self.builder is not None:
            raise refused("builder", "none of a part from a STEP file, which has its solid", "one")
        if self.product is not None and self.use is not None:
            raise refused("product", "none beside `use`, which says it", "both")
        return self
