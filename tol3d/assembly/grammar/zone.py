"""Tolerance zones and the laws of deviations in them, as a scene names them."""

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Final, Literal, Protocol, Self, TypeVar, get_args

from pydantic import BeforeValidator, Field, model_validator

from tol3d.assembly.grammar.features.nominal_frame import is_across
from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.import_path import is_named
from tol3d.scene.bases import Length, ToleranceEntry, scaled_law
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction
from tol3d.statistics.distributions import StatedDistribution
from tol3d.statistics.distributions.base import Stays
from tol3d.strict import Strict, refused
from tol3d.units import Of, Quantity, shown


class ZoneSpec(Strict):
    """Tolerance zone of a drawing: a diameter for an axis or a point, else a width."""

    diameter: Length | None = Field(default=None, description="of the zone of an axis or a point")
    width: Length | None = Field(
        default=None, description="of the zone of a surface, or of an axis or a point in one direction"
    )
    along: Direction | None = Field(
        default=None, description="of a width for an axis or a point: the one direction in which it limits"
    )
    projected: Length | None = Field(
        default=None,
        description="of an axis: the zone holds it over such a length beyond its end along +z, "
        "where what is screwed in stands out, instead of over the axis itself",
    )
    outward: Annotated[Quantity, Of("length")] | None = Field(
        default=None, description="how much of a profile's width lies outside the material; default: half"
    )

    @property
    def size(self) -> float:
        """Diameter or width [mm]."""
        given = self.diameter or self.width
        return 0.0 if given is None else given.internal

    @property
    def stated(self) -> str:
        """Diameter or width, as it is written."""
        return str(self.diameter or self.width)

    def scaled(self, factor: float) -> Self:
        """As many times as wide, about its middle."""
        given = {name: getattr(self, name) for name in ("diameter", "width")}
        sizes = {name: own.like(factor * own.internal) for name, own in given.items() if own is not None}
        if self.outward is not None:
            sizes["outward"] = self.outward.like(self.outward.internal + 0.5 * (factor - 1.0) * self.size)
        return self.model_copy(update=sizes)

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if (self.diameter is None) == (self.width is None):
            raise refused("diameter", "either a diameter or a width", "neither" if self.width is None else "both")
        if self.along is not None and self.width is None:
            raise refused("along", "a width with it", "a diameter")
        return self


def are_alike(zone: ZoneSpec, other: ZoneSpec) -> bool:
    """True if both zones of a feature are round, or flat along one direction; of a plane all are."""
    if zone.along is None or other.along is None:
        return zone.along is other.along
    return not is_across(zone.along, other.along)


DRAWS: Final = "tol3d.assembly.from_scene.laws"


class Resizable(Protocol):
    """A zone."""

    def scaled(self, factor: float) -> Self:
        """As many times as wide."""
        ...


Scaled = TypeVar("Scaled", bound=Resizable)


class LawSpec(Strict):
    """A law of deviations in a zone, and by import paths `package.module:function` how they are drawn.

    `draws` makes the draw of a feature's displacement (Confined or Process) from the law, a zone without bonus and
    files; `touching` makes the distribution of a point that touches from the law, half of a form's zone [mm] and files;
    "" if forms cannot have it: `lies` says why. `fitting` makes that of the form that a fit sees from the law, the
    form's tolerance [mm] and files, likewise.
    """

    draws: ClassVar[str]
    touching: ClassVar[str] = ""
    fitting: ClassVar[str] = ""
    lies: ClassVar[str] = "that is no law of a form"

    kind: str

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Files that it reads, each with its field."""
        return iter(())

    def scaled(self, zone: Scaled, factor: float, files: Files) -> tuple[Self, Scaled]:
        """The law and its zone, scaled by a factor; by default the zone is."""
        return self, zone.scaled(factor)

    @classmethod
    def lacking(cls) -> Iterator[str]:
        """Import paths named by the law that cannot be imported."""
        for what in ("draws", "touching", "fitting"):
            path = getattr(cls, what, "")
            if path or what == "draws":
                yield from () if is_named(path) else (f"`{what}` of the law {cls.__name__}, got {path!r}",)


class UniformLawSpec(LawSpec):
    """Every point of the zone is as likely as any other."""

    draws: ClassVar[str] = f"{DRAWS}:uniform"
    touching: ClassVar[str] = f"{DRAWS}:uniform_form"
    fitting: ClassVar[str] = f"{DRAWS}:uniform_fit"

    kind: Literal["uniform"]


class NormalLawSpec(LawSpec):
    """The middle of the feature is normal, 3 sigma at half of the zone and cut off there; tilts in what it leaves."""

    draws: ClassVar[str] = f"{DRAWS}:normal"
    touching: ClassVar[str] = f"{DRAWS}:normal_form"
    fitting: ClassVar[str] = f"{DRAWS}:normal_fit"

    kind: Literal["normal"]


class RingLawSpec(LawSpec):
    """The middle of an axis lies on the edge of its zone, at any phase, without lean: an eccentricity of one size."""

    draws: ClassVar[str] = f"{DRAWS}:ring"
    lies: ClassVar[str] = "a ring is of where an axis lies"

    kind: Literal["ring"]


class ProcessLawSpec(LawSpec):
    """A stated law of each coordinate; the zone judges only, and what lies outside stays in the trial."""

    draws: ClassVar[str] = f"{DRAWS}:process"
    touching: ClassVar[str] = f"{DRAWS}:process_form"

    kind: Literal["process"]
    distribution: StatedDistribution = Field(description="of each coordinate, a length at the end of the feature")

    def scaled(self, zone: Scaled, factor: float, files: Files) -> tuple[Self, Scaled]:
        law = scaled_law(self.distribution, factor, "middle", files)
        return self.model_copy(update={"distribution": law}), zone

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        return ((("distribution", field), name) for field, name in self.distribution.file_names())


def _no_word(value: Any) -> Any:
    if isinstance(value, str):
        raise refused("", "a law such as {kind: uniform}", shown(value))
    return value


LawUnion = Annotated[
    UniformLawSpec | NormalLawSpec | RingLawSpec | ProcessLawSpec,
    Field(discriminator="kind", description="the law of deviations in the zone: uniform, normal, ring or process"),
    BeforeValidator(_no_word),
]


def laws_lacking(annotation: Any) -> Iterator[str]:
    """Import paths named by the possible laws of a field that cannot be imported."""
    if isinstance(annotation, type) and issubclass(annotation, LawSpec):
        yield from annotation.lacking()
    else:
        for own in get_args(annotation):
            yield from laws_lacking(own)


Zoned = TypeVar("Zoned", bound=ToleranceEntry)


def scaled_in_zone(spec: Zoned, factor: float, stays: Stays, files: Files) -> Zoned:
    """A tolerance with a zone and a law, its deviations scaled by a factor.

    Raises:
        InputError: a limit is to stay, or the law cannot be scaled.
    """
    own: Any = spec
    if stays != "middle":
        raise InputError(f"expected the middle of a zone to stay, got {stays}")
    if own.law is None:
        return spec.model_copy(update={"zone": own.zone.scaled(factor)})
    law, zone = own.law.scaled(own.zone, factor, files)
    return spec.model_copy(update={"zone": zone, "law": law})
