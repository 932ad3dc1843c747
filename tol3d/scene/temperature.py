"""Uniform temperature of some parts, a tolerance of every mechanism whose parts grow."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema

from tol3d.scene.bases import GrowingSpec, MoveSpec, PartSpec, ToleranceSpec
from tol3d.scene.entry import Contradiction, Reference
from tol3d.scene.name import LONGEST_NAME, Name
from tol3d.strict import refused
from tol3d.units import ABSOLUTE_ZERO, Dimension, shown

NAME_SCHEMA = {"type": "string", "minLength": 1, "maxLength": LONGEST_NAME}


def _names(value: Any) -> Any:
    names = (value,) if isinstance(value, str) else tuple(value) if isinstance(value, list | tuple) else ()
    if not names or not all(isinstance(name, str) for name in names):
        raise refused("", "the name of a part, or a list of such names", shown(value))
    repeated = next((name for index, name in enumerate(names) if name in names[:index]), None)
    if repeated is not None:
        raise refused("", "each part once", f"{shown(repeated)} twice")
    return names


Parts = Annotated[
    tuple[Name, ...],
    BeforeValidator(_names),
    WithJsonSchema({"anyOf": [NAME_SCHEMA, {"type": "array", "items": NAME_SCHEMA, "minItems": 1}]}),
]


class TemperatureSpec(ToleranceSpec):
    """A temperature difference from 20 degC, the same throughout the parts; each grows by its own coefficient.

    Positive is warmer. Sizes and the places of features grow about the origin of their part, which is the fixed point
    of a fixed part. Parts of kinds with an expansion grow; other parts do not.
    """

    shared: ClassVar[bool] = True
    dimensions: ClassVar[tuple[Dimension, ...]] = ("temperature",)

    kind: Literal["temperature"]
    of: Parts = Field(description="the parts that are warmer: one name or a list")

    @property
    def nominal(self) -> str:
        """See ToleranceSpec: no drawing says how warm parts are."""
        return ""

    def references(self) -> tuple[Reference, ...]:
        """Every part."""
        return tuple(Reference(("of", index), name, (GrowingSpec,)) for index, name in enumerate(self.of))

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """A part without a coefficient of expansion would take no notice; nothing is colder than absolute zero."""
        for index, name in enumerate(self.of):
            if parts[name].expansion is None:
                yield Contradiction(
                    ("of", index), "a part with its coefficient of expansion", f"{name!r} without expansion:"
                )
        if not any(self.distribution.file_names()):  # those judge themselves when they are read
            lowest = self.distribution.resolve({}).extremes[0]
            if lowest < ABSOLUTE_ZERO:
                least = f"at least {ABSOLUTE_ZERO} K, which is absolute zero"
                yield Contradiction(("distribution",), least, f"{lowest:.6g} K; check the unit")
