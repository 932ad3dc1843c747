"""A column of others: what they found of measures, by name, and of the whole, by the keys of summary.json."""

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, ClassVar, Final

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

from tol3d.scene.name import Name, checked_name
from tol3d.scene.nearest import nearest
from tol3d.scene.published.measure import PublishedMeasure
from tol3d.scene.published.whole import PublishedFigures, PublishedWhole
from tol3d.strict import Strict, refused
from tol3d.units import shown

MEASURES: Final = "/measures"  # where measures stand once they are read; no name has such a sign, so no user writes it


class PublishedColumn(Strict):
    """Columns of others: a measure's name, or a key of the whole run, and what they found of it.

    A measure of the name of such a key is meant where all that stands under it may be said of a measure.
    """

    sections: ClassVar[tuple[type[PublishedFigures], ...]] = ()  # of the subclass that a grammar makes

    measures: Mapping[Name, PublishedMeasure] = Field(default_factory=dict, alias="/measures")

    @property
    def figures(self) -> dict[str, Any]:
        """What was given of the whole, by key."""
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
        """Measures and what was found of each."""
        return [*self.measures.items()]

    # reading and writing --------------------------------------------------------------------------

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_keys(cls, data: Any) -> Any:
        """Measures apart from the whole; a key near to one of the whole, with what no measure has, is a mistake."""
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
        """Whether all keys of a value are such as a section has."""
        own = _model_in(cls.model_fields[key].annotation)
        return own is not None and isinstance(value, dict) and value.keys() <= _keys(own)

    @model_serializer(mode="wrap")
    def _flat(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        written: dict[str, Any] = handler(self)
        measures = written.pop(MEASURES, None) or written.pop("measures", None) or {}
        return {**written, **measures}

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """As it is written: measures beside keys of the whole."""
        found = handler.resolve_ref_schema(handler(schema))
        measures = found["properties"].pop(MEASURES)
        measure = measures["additionalProperties"]
        for key, own in found["properties"].items():
            kept = {name: own.pop(name) for name in ("title", "description", "default") if name in own}
            found["properties"][key] = {**kept, "anyOf": [*own.get("anyOf", [own]), measure]}
        names = {key: measures[key] for key in ("propertyNames",) if key in measures}  # pydantic 2.9 does not say them
        return {**found, "additionalProperties": measure, **names}

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled by its sections: the class is made anew where it is read."""
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
