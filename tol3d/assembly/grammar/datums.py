"""Datums as tolerances name them: features of the toleranced part, in order."""

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from tol3d.assembly.grammar.feature_name import OwnName
from tol3d.assembly.model.datum_frame import Modifier, Simulator
from tol3d.scene.listed import listed
from tol3d.scene.vector import Vector
from tol3d.strict import Strict, refused
from tol3d.units import shown

Lying = Literal["random", "centred", "least"]
"""Position of a gauge in its room; least, of a measure, where that is best."""


def _joined(value: Any) -> Any:
    """Names from `floor` or `bore 1-bore 2`; each item of a list is one."""
    names = [name.strip() for name in value.split("-")] if isinstance(value, str) else value
    if isinstance(names, list) and any(isinstance(name, str) and "." in name for name in names):
        own = "-".join(str(name).rpartition(".")[2] for name in names)
        got = shown(value if isinstance(value, str) else "-".join(map(str, names)))
        raise refused("", f"{own}, without its part, for datums are of the same part as the feature", got)
    return names


class DatumSpec(Strict):
    """A datum: a feature of the part, or several as a common datum or pattern, and its contact with the simulator."""

    words: ClassVar[str] = "a datum"

    features: Annotated[
        tuple[OwnName, ...],
        listed("features", 1, 10),
        BeforeValidator(_joined, json_schema_input_type=str | tuple[OwnName, ...]),
    ] = Field(alias="feature", description="its name; of a common datum all, such as bore 1-bore 2")
    simulator: Simulator = Field(
        default="contact",
        description="how a later plane lies in the orientation left to it; pattern: several features as one datum, by "
        "least squares of their places",
    )
    targets: Annotated[tuple[Vector, ...], listed("points", 1, 3)] = Field(
        default=(), description="points of the part that touch, for simulator: targets"
    )

    mmb: Lying | None = Field(
        default=None,
        description="at its maximum material boundary: how the gauge lies in the room that it has there, of several "
        "features a gauge of as many pins; least, of a measure, where it is best; default: regardless of size",
    )

    lmb: Lying | None = Field(
        default=None,
        description="the same at its least material boundary: the gauge lies inside the material of the feature",
    )

    @property
    def gauge(self) -> Lying | None:
        """Position of its gauge, at either boundary; None regardless of size."""
        return self.lmb if self.mmb is None else self.mmb

    @property
    def boundary(self) -> Modifier:
        """Condition of the size from which its gauge is counted."""
        return "mmc" if self.lmb is None else "lmc"

    @property
    def key(self) -> Literal["mmb", "lmb"]:
        """The key of its boundary."""
        return "mmb" if self.lmb is None else "lmb"

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of feature that it may be of."""
        if self.gauge is not None:
            return ("cylinder", "slot")
        return ("plane",) if self.targets else ()

    @property
    def is_several(self) -> bool:
        """True of several features that lie as one."""
        return len(self.features) > 1

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if self.targets and self.simulator != "targets":
            raise refused("targets", "simulator: targets beside them", f"simulator: {self.simulator}")
        if not self.targets and self.simulator == "targets":
            raise refused("targets", "the points that touch, such as [[10 mm, 0 mm, 5 mm]]", "none")
        if self.simulator == "pattern" and not self.is_several:
            expected = "two to ten features as one datum, such as hole 1-hole 2"
            raise refused("feature", expected, f"one, {self.features[0]!r}; name it alone, without simulator")
        if len(set(self.features)) < len(self.features):
            raise refused("feature", "each feature once", "-".join(self.features))
        if self.mmb is not None and self.lmb is not None:
            raise refused("lmb", "one boundary: mmb or lmb", "both")
        if self.gauge is not None and self.simulator not in ("contact", "pattern"):
            raise refused(self.key, "it at holes, pins, slots or tabs", f"simulator: {self.simulator}, of planes")
        if self.targets and self.is_several:
            raise refused("targets", "them on one plane", "-".join(self.features))
        return self


def _datum(value: Any) -> Any:
    """`floor` as a DatumSpec's fields."""
    if isinstance(value, str):
        return {"feature": value}
    if isinstance(value, DatumSpec | dict):
        return value
    raise refused("", "a feature such as floor, a common datum such as bore 1-bore 2, or {feature: ..}", shown(value))


Datums = Annotated[
    tuple[Annotated[DatumSpec, BeforeValidator(_datum, json_schema_input_type=str | DatumSpec)], ...],
    listed("datums", 1, 3),
    Field(description="primary, secondary, tertiary; features of the same part"),
]
