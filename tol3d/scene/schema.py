"""A scene as its user wrote it, checked field by field."""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, ClassVar, Final, Literal, Self, TypeVar

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    GetJsonSchemaHandler,
    PrivateAttr,
    Tag,
    ValidationError,
    ValidationInfo,
    create_model,
    model_validator,
)
from pydantic.functional_validators import ModelWrapValidatorHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from tol3d.errors import InputError, SceneError
from tol3d.files import Files
from tol3d.import_path import named
from tol3d.scene.bases import MeasureEntry, MoveSpec, PartSpec, ToleranceEntry, ToleranceSpec
from tol3d.scene.correlation import CorrelationSpec
from tol3d.scene.entry import Entry
from tol3d.scene.including import with_include
from tol3d.scene.listed import listed
from tol3d.scene.name import Name, Title
from tol3d.scene.nearest import nearest
from tol3d.scene.options import THEORY, Engines, StudyOptions
from tol3d.scene.place import KeyPath, Origin, Place
from tol3d.scene.published import PublishedColumn
from tol3d.statistics.distributions.default_law import StatedLimitLaw
from tol3d.statistics.distributions.drawn import DEFAULT_LAW, default_law
from tol3d.statistics.distributions.stated import SHIPPED, Laws, stating
from tol3d.statistics.estimates.limits import MOST_PPK
from tol3d.statistics.samplers.replicates import REPLICATES, SamplerKind, uneven
from tol3d.statistics.standards import iso_2768
from tol3d.strict import Strict, refused
from tol3d.units import Positive, Quantity, shown

PUBLISHED_MEANS: Final = "columns of others, shown beside ours: column, measure or key of the whole run, values"
SECTIONS: Final = ("parts", "tolerances", "moves", "measures")

VARIED: Final = "tol3d.scene.vary:varied"  # above this file, for it reads scenes
DUMPED: Final = "tol3d.scene.vary:dumped"

MOST_TRIALS = 10**10
MOST_SEED = 2**63 - 1  # a signed 64-bit integer, which every file format keeps
FEWEST_REPLICATES = 2  # that have a spread at all
MOST_REPLICATES = 1000
MOST_WITNESSED = 1_000_000  # trials; minutes of a slow engine, and all of them are held at once

E = TypeVar("E", bound=Entry)
Options = TypeVar("Options", bound=StudyOptions)


class StandardErrors(Strict):
    """Required standard errors of a measure's mean and sigma, one each, in its dimension."""

    mean: Annotated[Quantity, Positive()] | None = Field(default=None, description="standard error of the mean")
    sigma: Annotated[Quantity, Positive()] | None = Field(default=None, description="standard error of sigma")

    def quantities(self) -> dict[str, Quantity]:
        """Every one that was given, by its field."""
        values = {name: getattr(self, name) for name in ("mean", "sigma")}
        return {name: value for name, value in values.items() if value is not None}

    @model_validator(mode="after")
    def _refuse_emptiness(self) -> Self:
        if not self.quantities():
            raise refused("", "mean, sigma or both", "neither")
        return self


def _trials_shape(value: Any) -> str:
    """The tag of a number of trials, for pydantic's Discriminator."""
    return "auto" if value == "auto" else "number"


def _number_or_auto(value: Any) -> Any:
    """Number as on the command line: `1e6` is a whole number, which YAML reads as a float."""
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if isinstance(value, str | float) and value != "auto":
        near = nearest(value, ["auto"]) if isinstance(value, str) else ""
        raise refused("", "a whole number or auto", shown(value) + near)
    return value


Trials = Annotated[
    Annotated[int, Field(ge=1, le=MOST_TRIALS), Tag("number")] | Annotated[Literal["auto"], Tag("auto")],
    Discriminator(_trials_shape),
    BeforeValidator(_number_or_auto),
]


class AcceptSpec(Strict):
    """Demands on measures with limits."""

    ppk: float = Field(
        gt=0.0, lt=MOST_PPK, description="least Ppk, by the method that the verdict states, such as 1.33"
    )


class StudySpec(Strict):
    """Number of trials, seed, sampler and engine; with the options of its scene's vocabularies."""

    trials: Trials = Field(
        default=2000, description="number of virtual builds; auto: until the stated standard errors are reached"
    )
    until: Mapping[Name, StandardErrors] = Field(
        default_factory=dict, description="standard errors at which automatic trials stop, by measure"
    )
    at_most: int = Field(default=10_000_000, ge=1, le=MOST_TRIALS, description="largest number of automatic trials")
    seed: int = Field(default=1, ge=0, le=MOST_SEED, description="the same seed gives the same trials")
    sampler: SamplerKind = Field(default="monte_carlo", description="sampling of deviations")
    replicates: int | None = Field(
        default=None,
        ge=FEWEST_REPLICATES,
        le=MOST_REPLICATES,
        description="parts of equal size, each randomised anew, whose spread gives the errors of sobol and "
        f"latin_hypercube; default: {REPLICATES}",
    )
    engine: str = Field(default="exact", description="engine of the 3D simulation; analytic: no 3D simulation")
    witness: int = Field(
        default=0, ge=0, le=MOST_WITNESSED, description="trials, at random, that another engine measures again"
    )
    ppk_by: Literal["quantiles", "sigma"] | None = Field(
        default=None,
        description="Ppk of measures of which all builds are assembled: by quantiles, or mean and sigma; default: as "
        "the values are distributed",
    )
    accept: AcceptSpec | None = Field(
        default=None, description="what the verdict asks of measures; default: at most 0.27 % out of limits"
    )

    engines: ClassVar[Engines]  # of the subclass that validates: a grammar makes one that knows them
    options: ClassVar[tuple[type[StudyOptions], ...]] = ()  # its further bases

    @property
    def parts(self) -> int:
        """Number of replicates, stated or not."""
        if self.sampler == "monte_carlo":
            return 1
        return REPLICATES if self.replicates is None else self.replicates

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        if self.sampler == "monte_carlo" and self.replicates is not None:
            raise refused(
                "replicates", "none for monte_carlo, whose trials tell their error themselves", self.replicates
            )
        if self.witness and (why := self.engines.without_witness(self.engine)):
            raise refused("witness", why, self.witness)
        if self.trials == "auto":
            self._refuse_endless()
        elif self.until:
            raise refused("trials", "auto, for until is given", self.trials)
        elif "at_most" in self.model_fields_set:
            raise refused("trials", "auto, for at_most is given", self.trials)
        elif problem := uneven(self.sampler, self.trials, self.parts):
            raise refused("trials", problem, self.trials)
        return self

    def _refuse_endless(self) -> None:
        if self.sampler != "monte_carlo":
            raise refused(
                "sampler",
                "monte_carlo where trials are auto, for replicates need their size beforehand",
                shown(self.sampler),
            )
        if not self.until:
            raise refused(
                "until",
                'the standard errors to stop at where trials are auto, such as "until: {gap: {mean: 0.05 um}}"',
                "none",
            )

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled by its engines and options: the class is made anew on reading."""
        return _blank_study_spec, (self.engines, self.options), self.__getstate__()


@lru_cache
def study_spec_class(engines: Engines, options: tuple[type[StudyOptions], ...] = ()) -> type[StudySpec]:
    """The class of studies by some engines, with the options of vocabularies."""
    field = StudySpec.model_fields["engine"]
    words = Literal[(*engines.names, THEORY)]  # type: ignore[valid-type]  # made at run time
    engine = (words, Field(default=engines.names[0], description=field.description))
    fixed: Any = {"__module__": StudySpec.__module__, "__doc__": StudySpec.__doc__, "__base__": (*options, StudySpec)}
    # the name under which the JSON Schema defines it, and which editors show
    made: type[StudySpec] = create_model("Study", **fixed, engine=engine)
    made.engines, made.options = engines, options
    return made


def _blank_study_spec(engines: Engines, options: tuple[type[StudyOptions], ...]) -> StudySpec:
    """A study without anything in it yet, for pickle."""
    made = study_spec_class(engines, options)
    return made.__new__(made)


def _general(value: str) -> str:
    try:
        iso_2768.classes(value)
    except InputError as error:
        expected, _, got = str(error).removeprefix("expected ").partition(", got ")
        raise refused("", expected, got) from None
    return value


GeneralClass = Annotated[str, AfterValidator(_general)]


class Scene(Strict):
    """A scene: parts, their tolerances, their assembly, the measures, and the study.

    `tol3d.load_scene` makes one from a file, and checks the names that entries use of each other. Entries keep the
    order of the file.
    """

    grammar: ClassVar[Any]  # the Grammar of the subclass that validates: a grammar makes one that knows its kinds
    laws: ClassVar[Laws] = SHIPPED  # likewise

    scene: Title = Field(description="the scene's name")
    description: str = Field(default="", description="the user's own words, shown in reports")
    default_law: StatedLimitLaw | None = Field(
        default=None, description="of deviations of which limits alone are stated, as a drawing writes them"
    )
    general: GeneralClass | None = Field(
        default=None,
        description="general tolerances of ISO 2768-1 for dimensions without one of their own, such as m or mK",
    )
    standard: Literal["iso", "asme"] = Field(
        default="iso",
        description="iso: limits of size bound the form where `envelope` says so (ISO 8015, ISO 14405-1); asme: always "
        "but of a feature whose axis or median plane has a straightness or flatness (Y14.5, Rule #1)",
    )
    envelope: bool | None = Field(
        default=None,
        description="whether limits of size bound the form of what they are of, unless the size says else; default: "
        "they do not (iso), they do (asme)",
    )
    parts: Mapping[Name, PartSpec] = Field(min_length=1)
    tolerances: Mapping[Name, ToleranceEntry] = Field(default_factory=dict)
    correlations: Annotated[tuple[CorrelationSpec, ...], listed("correlations", 0)] = Field(
        default=(), description="contributors that do not vary independently"
    )
    moves: Mapping[Name, MoveSpec] = Field(min_length=1)
    measures: Mapping[Name, MeasureEntry] = Field(min_length=1)
    study: StudySpec = Field(default_factory=StudySpec)
    published: Mapping[Name, PublishedColumn] = Field(default_factory=dict, description=PUBLISHED_MEANS)

    _origin: Origin = PrivateAttr(default_factory=Origin)

    @model_validator(mode="wrap")
    @classmethod
    def _in_its_words(cls, data: Any, handler: ModelWrapValidatorHandler[Self], info: ValidationInfo) -> Self:
        """Scene with the laws that its tolerances may have; errors are stated in the user's words, also from Python."""
        origin = info.context if isinstance(info.context, Origin) else Origin()
        try:
            with stating(cls.laws), default_law(data.get(DEFAULT_LAW) if isinstance(data, Mapping) else None):
                return handler(data)
        except ValidationError as error:
            raise SceneError(*cls.grammar.messages(error, data, origin)) from None

    @model_validator(mode="after")
    def _with_sizes(self) -> Self:
        """Classes have the limits of what they are of."""
        sized = {name: entry.sized(self.parts, self.moves) for name, entry in self.tolerances.items()}
        object.__setattr__(self, "tolerances", sized)  # nobody has seen the scene yet
        return self

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Schema with the laws that its tolerances may have, and files that it may include."""
        with stating(cls.laws):
            return with_include(handler(schema), handler)

    def model_post_init(self, context: Any) -> None:
        """Keep the origin that validation was given as its context."""
        if isinstance(context, Origin):
            self._origin = context

    @property
    def general_sizes(self) -> str:
        """The class of ISO 2768-1 of its general tolerances; "" without any."""
        return "" if self.general is None else iso_2768.classes(self.general)[0]

    @property
    def origin(self) -> Origin:
        """The file it was read from, with its text and places, and the files that it names."""
        return self._origin

    @property
    def source(self) -> Path:
        """The file it was read from."""
        return self._origin.source

    @property
    def text(self) -> str:
        """Content of that file."""
        return self._origin.text

    @property
    def places(self) -> Mapping[KeyPath, Place]:
        """Line and column of every key path."""
        return self._origin.places

    def place(self, path: KeyPath) -> Place:
        """Line and column of a key path, or of the nearest key above it."""
        return self._origin.place(path)

    @property
    def folder(self) -> Path:
        """Folder from which relative file names start."""
        return self.source.parent

    @property
    def file_names(self) -> tuple[str, ...]:
        """Every file that the scene names, as written there, and those that it includes by names from its folder."""
        named = (name for entry in self.entries().values() for _, name in entry.file_names())
        return tuple(dict.fromkeys((*self._origin.included, *named)))

    @property
    def files(self) -> Files:
        """Their contents, as they were when the scene was read."""
        return self._origin.files

    def read_from(self, origin: Origin) -> Self:
        """This scene with another origin."""
        scene = self.model_copy()
        scene._origin = origin
        return scene

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy; one that differs from its file, apart from the study, has no text any more."""
        if update and DEFAULT_LAW in update:
            raise InputError(f"expected {DEFAULT_LAW} to be changed by scene.with_, which reads the limits anew")
        copied = super().model_copy(update=update, deep=deep)
        if update and update.keys() - {"study"}:
            copied._origin = replace(self._origin, text="")
        return copied

    def with_(self, changes: Mapping[str, Any], *, trust_parts: bool = False, run_builders: bool = False) -> "Scene":
        """The scene with some values changed, checked anew: `scene.with_({"study.seed": 3})`.

        Args:
            changes: new values by the names of their fields, as messages show them.
            trust_parts, run_builders: see `tol3d.run_scene`; needed again if they were needed.

        Raises:
            InputError: no such entry. SceneError: a value that the scene may not have, or a part that cannot be built.
        """
        made: Scene = named(VARIED)(self, changes, trust_parts=trust_parts, run_builders=run_builders)
        return made

    def dump(self) -> str:
        """A text that loads as this scene again: that of its file, or of the values given in Python."""
        text: str = named(DUMPED)(self)
        return text

    def section(self, name: str) -> Mapping[str, Entry]:
        """The entries of one of SECTIONS, by their names."""
        entries: Mapping[str, Entry] = getattr(self, name)
        return entries

    def entries(self) -> dict[KeyPath, Entry]:
        """The entries of all sections, by section and name."""
        return {(section, name): entry for section in SECTIONS for name, entry in self.section(section).items()}

    def of(self, spec: type[E]) -> dict[str, E]:
        """The entries of a kind, or of several that have a class in common, by their names."""
        bases = (PartSpec, ToleranceEntry, MoveSpec, MeasureEntry)
        holding = [s for s, base in zip(SECTIONS, bases, strict=True) if issubclass(spec, base)] or SECTIONS
        entries = (entry for section in holding for entry in self.section(section).items())
        return {str(name): entry for name, entry in entries if isinstance(entry, spec)}

    @property
    def distributed(self) -> dict[str, ToleranceSpec]:
        """The tolerances that are one deviation with its distribution, by their names."""
        return {str(name): entry for name, entry in self.tolerances.items() if isinstance(entry, ToleranceSpec)}

    def options(self, kind: type[Options]) -> Options:
        """Study's options of a vocabulary: their defaults where the scene's grammar has them not."""
        return self.study if isinstance(self.study, kind) else kind()

    def refuse(self, path: KeyPath, sentence: str) -> SceneError:
        """The error to raise with a finished sentence, such as that of a GeometryError."""
        return self._origin.error(path, sentence)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled by its grammar: the class is made anew on reading."""
        return _blank, (self.grammar,), self.__getstate__()


def _blank(grammar: Any) -> Scene:
    """A scene without anything in it yet, for pickle."""
    made: Scene = grammar.scene.__new__(grammar.scene)
    return made
