"""Published figures of a measure: any number that a run's summary has of one."""

from collections.abc import Iterator, Mapping
from functools import cache
from itertools import pairwise
from typing import Any, ClassVar, Final, Self

from pydantic import (
    Field,
    GetJsonSchemaHandler,
    SerializerFunctionWrapHandler,
    create_model,
    model_serializer,
    model_validator,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError

from tol3d.scene.name import Name, Remark, checked_name
from tol3d.scene.nearest import nearest
from tol3d.scene.published.figures import (
    Count,
    Figure,
    FigureRange,
    Figures,
    Ppm,
    PpmRange,
    PublishedAgreement,
    PublishedCurve,
    PublishedHistogram,
    PublishedShare,
    Range,
    Share,
    refuse_uneven,
)
from tol3d.scene.published.whole import PublishedFigures, PublishedWhole
from tol3d.strict import Strict, refused
from tol3d.units import Quantity, shown

ORDERED: Final = (("low_3sigma", "mean", "high_3sigma"), ("sample_min", "p0.135", "p50", "p99.865", "sample_max"))
"""Keys in ascending order of their values."""
POSITIVE: Final = ("sigma", "mean_se", "sigma_se")


class PublishedMeasure(Strict):
    """Published figures of a measure, in its dimension; contributors in percent of the variance."""

    low_3sigma: Quantity | None = Field(default=None, description="mean - 3 sigma, or the lower end at 99.7 %")
    mean: Quantity | None = Field(default=None, description="mean")
    high_3sigma: Quantity | None = Field(default=None, description="mean + 3 sigma, or the upper end at 99.7 %")
    sigma: Quantity | None = Field(default=None, description="standard deviation")
    sample_min: Quantity | None = Field(default=None, description="smallest of the trials")
    sample_max: Quantity | None = Field(default=None, description="largest of the trials")
    p0_135: Quantity | None = Field(default=None, alias="p0.135", description="0.135 % quantile")
    p50: Quantity | None = Field(default=None, description="median")
    p99_865: Quantity | None = Field(default=None, alias="p99.865", description="99.865 % quantile")
    mean_se: Quantity | None = Field(default=None, description="standard error of the mean")
    sigma_se: Quantity | None = Field(default=None, description="standard error of sigma")
    mean_95: Range | None = Field(default=None, description="bounds of the true mean, 95 % confidence")
    sigma_95: Range | None = Field(default=None, description="bounds of the true sigma, 95 % confidence")
    p0_135_95: Range | None = Field(
        default=None, alias="p0.135_95", description="bounds of the true 0.135 % quantile, 95 % confidence"
    )
    p99_865_95: Range | None = Field(
        default=None, alias="p99.865_95", description="bounds of the true 99.865 % quantile, 95 % confidence"
    )
    contributors: Mapping[Name, Share] = Field(
        default_factory=dict, description="share of each tolerance [% of the variance]"
    )
    description: Remark = Field(default="", description="remark on these numbers, shown below the table")
    skewness: Figure | None = Field(default=None, description="skewness")
    kurtosis: Figure | None = Field(default=None, description="excess kurtosis")
    pp: Figure | None = Field(default=None, description="Pp")
    ppk: Figure | None = Field(default=None, description="Ppk")
    ppk_95: FigureRange | None = Field(default=None, description="bounds of the true Ppk, 95 % confidence")
    below_limit_ppm: Ppm | None = Field(default=None, description="share below the lower limit [ppm]")
    above_limit_ppm: Ppm | None = Field(default=None, description="share above the upper limit [ppm]")
    failed_ppm: Ppm | None = Field(default=None, description="share that could not be assembled [ppm]")
    out_ppm: Ppm | None = Field(default=None, description="share that failed or is out of limits [ppm]")

    count: Count | None = Field(default=None, description="trials with a value")
    trials: Count | None = Field(default=None, description="all of them, failed ones too")
    status: Mapping[Name, Count] = Field(default_factory=dict, description="number of trials by status")
    nominal: Quantity | None = Field(default=None, description="of the build without deviations")
    mean_build: Quantity | None = Field(default=None, description="of the build with all deviations at their means")
    below_limit_ppm_95: PpmRange | None = Field(default=None, description="bounds of the true share, 95 % confidence")
    above_limit_ppm_95: PpmRange | None = Field(default=None, description="bounds of the true share, 95 % confidence")
    out_ppm_95: PpmRange | None = Field(default=None, description="bounds of the true share, 95 % confidence")
    quantile_error: Quantity | None = Field(default=None, description="how finely quantiles were read")
    outside_grid: Count | None = Field(default=None, description="trials beyond the ends of the histogram")
    deepest_overlap: Quantity | None = Field(default=None, description="of builds that interfere, by the normal")
    pooled: Mapping[Name, Quantity] = Field(
        default_factory=dict, description="statistics that the measure names besides"
    )
    histogram: PublishedHistogram | None = Field(default=None, description="counts of trials")
    agreement: PublishedAgreement | None = Field(default=None, description="difference of both methods, trial by trial")
    position_deg: Figures | None = Field(default=None, description="where the curve was read [deg]")
    curve: PublishedCurve | None = Field(default=None, description="statistics at each position")

    @property
    def internal(self) -> dict[str, float]:
        """The dimensioned numbers of its sample by their keys [mm or rad]."""
        return {key: quantity.internal for key, quantity in self.quantities().items()}

    def quantities(self) -> dict[str, Quantity]:
        """The dimensioned numbers of its sample, by their keys."""
        given = ((field.alias or name, getattr(self, name)) for name, field in type(self).model_fields.items())
        return {key: value for key, value in given if isinstance(value, Quantity)}

    @property
    def percents(self) -> dict[str, float]:
        """Shares of the variance [%], by contributor."""
        shares = {
            str(name): own.percent if isinstance(own, PublishedShare) else own
            for name, own in self.contributors.items()
        }
        return {name: share for name, share in shares.items() if share is not None}

    @model_validator(mode="after")
    def _refuse_disorder(self) -> Self:
        given = self.quantities()
        for key in POSITIVE:
            if key in given and not given[key].internal > 0.0:
                raise refused(key, "more than 0", given[key])
        for keys in ORDERED:
            known = [(key, given[key]) for key in keys if key in given]
            for (low, below), (high, above) in pairwise(known):
                if below.dimension == above.dimension and not below.internal <= above.internal:
                    raise refused(low, f"at most {high} ({above})", below)
        return self

    @model_validator(mode="after")
    def _refuse_uneven_curves(self) -> Self:
        if self.curve and self.curve.is_listed:
            if self.position_deg is None:
                raise refused("position_deg", "the positions of the curve, such as [0, 90, 180, 270]", "none")
            refuse_uneven(self.curve, "position_deg", len(self.position_deg), "curve.")
        return self


MEASURES: Final = "/measures"  # where measures stand once they are read; no name has such a sign, so no user writes it


class PublishedColumn(Strict):
    """Columns of others: a measure's name, or a key of the whole run, and their figures for it.

    A measure of the name of such a key is meant where all that stands under it may be said of a measure.
    """

    sections: ClassVar[tuple[type[PublishedFigures], ...]] = ()  # of the subclass that a grammar makes

    measures: Mapping[Name, PublishedMeasure] = Field(default_factory=dict, alias="/measures")

    @property
    def figures(self) -> dict[str, Any]:
        """Stated figures of the whole, by key."""
        own = {name: getattr(self, name) for name in self.keys_of_the_whole()}
        return {name: value for name, value in own.items() if value is not None and value != {}}

    @classmethod
    def keys_of_the_whole(cls) -> tuple[str, ...]:
        """The keys that may stand beside measures."""
        return tuple(name for name in cls.model_fields if name != "measures")

    # Reading by the names of measures, as of a mapping.

    def __getitem__(self, name: str) -> PublishedMeasure:
        return self.measures[name]

    def __contains__(self, name: object) -> bool:
        return name in self.measures

    def items(self) -> list[tuple[str, PublishedMeasure]]:
        """Measures and the published figures of each."""
        return [*self.measures.items()]

    # reading and writing --------------------------------------------------------------------------

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_keys(cls, data: Any) -> Any:
        """Measures apart from the whole; a key near to one of the whole, with keys of no measure, is a mistake."""
        if not isinstance(data, dict) or MEASURES in data:
            return data
        whole, measures = dict[str, Any](), dict[str, Any]()
        for key, value in data.items():
            if not isinstance(key, str):
                raise refused("", "text as a name", shown(key))
            of_measure = _may_be_of_measure(value)
            known = cls.keys_of_the_whole()
            if key in known and not (of_measure and not cls._may_be_of(key, value)):
                whole[key] = value
            elif not of_measure and nearest(key, known):
                raise PydanticCustomError("unknown_key", "unknown key", {"key": key, "known": [*known]})
            else:
                measures[checked_name(key)] = value
        return {**whole, MEASURES: measures}

    @classmethod
    def _may_be_of(cls, key: str, value: Any) -> bool:
        """True if all keys of a value may belong to a section."""
        own = _model_in(cls.model_fields[key].annotation)
        return own is not None and isinstance(value, dict) and value.keys() <= _keys(own)

    @model_serializer(mode="wrap")
    def _flat(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        written: dict[str, Any] = handler(self)
        measures = written.pop(MEASURES, None) or written.pop("measures", None) or {}
        return {**written, **measures}

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Schema as it is written: measures beside keys of the whole."""
        found = handler.resolve_ref_schema(handler(schema))
        measures = found["properties"].pop(MEASURES)
        measure = measures["additionalProperties"]
        for key, own in found["properties"].items():
            kept = {name: own.pop(name) for name in ("title", "description", "default") if name in own}
            found["properties"][key] = {**kept, "anyOf": [*own.get("anyOf", [own]), measure]}
        names = {key: measures[key] for key in ("propertyNames",) if key in measures}  # pydantic 2.9 does not say them
        return {**found, "additionalProperties": measure, **names}

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled by its sections: the class is made anew on reading."""
        return _blank, (self.sections,), self.__getstate__()


def _may_be_of_measure(value: Any) -> bool:
    return isinstance(value, PublishedMeasure) or (isinstance(value, dict) and value.keys() <= _keys(PublishedMeasure))


def _keys(kind: type[Strict]) -> frozenset[str]:
    return frozenset(field.alias or name for name, field in kind.model_fields.items())


def _model_in(annotation: Any) -> type[Strict] | None:
    """The class of a section that may be missing; None of a number or a mapping."""
    kinds: Iterator[Any] = iter(getattr(annotation, "__args__", (annotation,)))
    return next((kind for kind in kinds if isinstance(kind, type) and issubclass(kind, Strict)), None)


@cache
def published_column_class(sections: tuple[type[PublishedFigures], ...] = ()) -> type[PublishedColumn]:
    """The class of columns with the sections of any run and those that mechanisms add."""
    bases: Any = (PublishedColumn, *sections, PublishedWhole)
    made: type[PublishedColumn] = create_model(
        PublishedColumn.__name__, __base__=bases, __module__=PublishedColumn.__module__, __doc__=PublishedColumn.__doc__
    )
    made.sections = sections
    return made


def _blank(sections: tuple[type[PublishedFigures], ...]) -> PublishedColumn:
    """A column without anything in it yet, for pickle."""
    made = published_column_class(sections)
    return made.__new__(made)
