"""Selectors of features of a part from a STEP file, in place of their numbers."""

import re
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Final, Literal, Self

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.features.feature_spec import FaceSpec
from tol3d.scene.bases import Length
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.vector import Direction, Vector
from tol3d.strict import Strict, refused

NUMBER: Final = re.compile(r"#([0-9]{1,15})")

DRAWN: Final = ("datum", "pmi", "tolerance", "value", "datums")

Selected = Literal["plane", "hole", "pin", "fillet", "round", "cone", "ball", "socket"]


def _hashed(given: Any) -> Any:
    """A face by its number, with or without #."""
    return f"#{given}" if isinstance(given, int) and not isinstance(given, bool) and given > 0 else given


FaceName = Annotated[Name, BeforeValidator(_hashed, json_schema_input_type=str | int)]


class SelectorSpec(Strict):
    """A feature of a part from a STEP file, by its face, or by kind and place; `tol3d features` lists them."""

    words: ClassVar[str] = "a feature of a STEP file"

    face: FaceName | None = Field(
        default=None, description='a face of it: its number in the file, such as "#764", or its name there'
    )
    faces: Annotated[tuple[FaceName, ...], listed("numbers of faces", 1, 1000)] | None = Field(
        default=None, description="the numbers of all of its faces; others on the same surface are then none of it"
    )
    datum: str | None = Field(default=None, description="the letter of the datum that it is")
    pmi: str | None = Field(default=None, description="the name that the file gives a tolerance or dimension of it")
    tolerance: str | None = Field(
        default=None, description="the kind of a tolerance of it in the file, such as position"
    )
    value: Length | None = Field(default=None, description="of that tolerance")
    datums: str | None = Field(default=None, description="the letters of that tolerance's datums, such as A | B-C")
    kind: Selected | None = Field(default=None, description="what it is")
    diameter: Length | None = Field(default=None, description="of a round one")
    near: Vector | None = Field(
        default=None, description="a point in the frame of the part; the next such feature is twice as far or more"
    )
    within: Length | None = Field(default=None, description="how far it may be from that point")
    count: Annotated[int, Field(ge=2, le=1000)] | None = Field(
        default=None, description="how many there are; default: one"
    )
    along: Direction | None = Field(default=None, description="x of a plane; default: the part's x (or y)")

    pattern: ClassVar[None] = None

    @property
    def faces_picked(self) -> Mapping[str, FaceSpec]:
        """None that a builder makes."""
        return {}

    def members(self, name: str) -> Mapping[str, "SelectorSpec"]:
        """The features that it stands for."""
        return {name: self} if self.count is None else {f"{name} {k}": self for k in range(1, self.count + 1)}

    @property
    def number(self) -> int | None:
        """The number of its face; None where it has none, or a name."""
        found = NUMBER.fullmatch(self.face or "")
        return int(found[1]) if found else None

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers of its faces."""
        return tuple(int(own.removeprefix("#")) for own in self.faces or ())

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if not self.model_fields_set - {"along", "within", "count", "value", "datums"}:
            expected = "a face, or a kind with a diameter or a point near it: tol3d features FILE lists lines to paste"
            raise refused("", expected, "neither")
        if self.faces is not None:
            if wrong := next((face for face in self.faces if not NUMBER.fullmatch(face)), None):
                raise refused("faces", 'numbers of faces, such as "#764"', repr(wrong))
            if beside := self.model_fields_set & {"face", "near", "within", "count", "diameter", *DRAWN}:
                raise refused(min(beside), "none beside `faces`, which say it all", "both")
        if sum(own is not None for own in (self.datum, self.pmi, self.tolerance)) > 1:
            raise refused("", "one of `datum`, `pmi` and `tolerance`", "several")
        for field in ("value", "datums"):
            if getattr(self, field) is not None and self.tolerance is None:
                raise refused(field, "the kind of `tolerance` as well", "none")
        if self.within is not None and self.near is None:
            raise refused("within", "the point `near` it as well", "none")
        return self


def _which(given: Any) -> str:
    """Tag of a feature: "selected" from a solid or "stated" by numbers."""
    if isinstance(given, Mapping):
        return (
            "stated"
            if "at" in given or given.get("kind") in ("point", "sphere", "slot", "cylinder", "axis")
            else "selected"
        )
    return "selected" if isinstance(given, SelectorSpec) else "stated"


SelectedUnion = Annotated[
    Annotated[SelectorSpec, Tag("selected")] | Annotated[FeatureUnion, Tag("stated")], Discriminator(_which)
]
"""A feature of a part from a STEP file: selected, or by numbers."""
