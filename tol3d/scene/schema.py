"""A scene as its user wrote it, checked field by field."""

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, PrivateAttr, model_validator

from tol3d.distributions.empirical import EmpiricalSpec
from tol3d.errors import SceneError
from tol3d.files import Files
from tol3d.scene.measures import MeasureUnion
from tol3d.scene.moves import MoveUnion
from tol3d.scene.name import Name
from tol3d.scene.parts import PartUnion
from tol3d.scene.place import KeyPath, Origin, Place
from tol3d.scene.tolerances import ToleranceUnion
from tol3d.strict import Strict, refused
from tol3d.units import Quantity

MOST_TRIALS = 10**10
MOST_SEED = 2**63 - 1  # a signed 64-bit integer, which every file format keeps
FEWEST_PROFILE_STEPS = 8
MOST_PROFILE_STEPS = 2000

Percent = Annotated[float, Field(ge=0.0, le=100.0)]


class Study(Strict):
    """How many trials, from which seed, by which sampler and engine, how finely measured."""

    trials: int = Field(default=2000, ge=1, le=MOST_TRIALS, description="number of virtual builds")
    seed: int = Field(default=1, ge=0, le=MOST_SEED, description="the same seed gives the same trials")
    sampler: Literal["monte_carlo"] = Field(default="monte_carlo", description="how deviations are drawn")
    engine: Literal["exact", "fcl", "analytic"] = Field(
        default="fcl",
        description="what the 3D simulation measures with: the mathematical flanks, or strips of the CAD solids; "
        "analytic: no 3D simulation",
    )
    witness: int = Field(default=0, ge=0, description="trials of an exact study that FCL measures again")
    profile_steps: int = Field(
        default=120, ge=FEWEST_PROFILE_STEPS, le=MOST_PROFILE_STEPS, description="flat strips along a measuring flank"
    )


class PublishedMeasure(Strict):
    """What somebody else found for a measure, in its dimension; contributors in percent of the variance."""

    low_3sigma: Quantity | None = Field(default=None, description="mean - 3 sigma, or the lower end at 99.7 %")
    mean: Quantity | None = None
    high_3sigma: Quantity | None = Field(default=None, description="mean + 3 sigma, or the upper end at 99.7 %")
    sigma: Quantity | None = Field(default=None, description="standard deviation")
    contributors: Mapping[Name, Percent] = Field(
        default_factory=dict, description="share of each tolerance [% of the variance]"
    )

    def quantities(self) -> dict[str, Quantity]:
        """Every dimensioned number that was given, by its field."""
        values = {name: getattr(self, name) for name in ("low_3sigma", "mean", "high_3sigma", "sigma")}
        return {name: value for name, value in values.items() if value is not None}

    @model_validator(mode="after")
    def _refuse_disorder(self) -> Self:
        given = self.quantities()
        sigma = given.pop("sigma", None)
        if sigma is not None and not sigma.internal > 0.0:
            raise refused("sigma", "more than 0", sigma)
        ordered = list(given.items())
        for (low, below), (high, above) in pairwise(ordered):
            if below.dimension == above.dimension and not below.internal <= above.internal:
                raise refused(low, f"at most {high} ({above})", below)
        return self


class Scene(Strict):
    """A scene: parts, their tolerances, how they are assembled, what is measured, and the study.

    `tol3d.scene.load_scene` makes one from a file, and checks the names that entries use of each
    other. Entries keep the order of the file.
    """

    scene: Name = Field(description="the scene's name")
    description: str = Field(default="", description="the user's own words, shown in reports")
    parts: Mapping[Name, PartUnion] = Field(min_length=1)
    tolerances: Mapping[Name, ToleranceUnion] = Field(default_factory=dict)
    moves: Mapping[Name, MoveUnion] = Field(min_length=1)
    measures: Mapping[Name, MeasureUnion] = Field(min_length=1)
    study: Study = Field(default_factory=Study)
    published: Mapping[Name, Mapping[Name, PublishedMeasure]] = Field(
        default_factory=dict, description="columns of others, shown beside ours: column, measure, values"
    )

    _origin: Origin = PrivateAttr(default_factory=Origin)

    def model_post_init(self, context: Any) -> None:
        """Keep the origin that validation was given as its context."""
        if isinstance(context, Origin):
            self._origin = context

    @property
    def source(self) -> Path:
        """The file it was read from."""
        return self._origin.source

    @property
    def text(self) -> str:
        """That file's content."""
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
        """Where relative file names start."""
        return self.source.parent

    @property
    def file_names(self) -> tuple[str, ...]:
        """Every file that the scene names, as written there."""
        laws = (tolerance.distribution for tolerance in self.tolerances.values())
        return tuple(dict.fromkeys(law.file for law in laws if isinstance(law, EmpiricalSpec)))

    @property
    def files(self) -> Files:
        """Their contents, as they were when the scene was read."""
        return self._origin.files

    def read_from(self, origin: Origin) -> Self:
        """This scene with another origin."""
        scene = self.model_copy()
        scene._origin = origin
        return scene

    def meshes_of(self, gear: str) -> tuple[str, ...]:
        """Names of the moves in which a gear takes part."""
        return tuple(name for name, move in self.moves.items() if gear in move.gears)

    def refuse(self, path: KeyPath, sentence: str) -> SceneError:
        """The error to raise with a finished sentence, such as that of a GeometryError."""
        return self._origin.error(path, sentence)
