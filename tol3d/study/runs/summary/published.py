"""Published figures as a summary holds them: the classes of scenes with numbers in place of quantities."""

from collections.abc import Mapping
from functools import cache, reduce
from operator import or_
from types import NoneType, UnionType
from typing import Annotated, Any, Final, Union, get_args, get_origin, get_type_hints

from pydantic import Field, create_model
from pydantic.config import JsonDict

from tol3d.strict import Strict
from tol3d.study.runs.summary.values import LEFT_OUT, Number, Section, made
from tol3d.units import ARCMIN, Dimension, Of, Quantity

PER_INTERNAL: Final[Mapping[Dimension, float]] = {
    "length": 1e3,
    "angle": ARCMIN,
    "temperature": 1.0,
    "expansion": 1.0,
    "count": 1.0,
}
"""One mm, rad, K or 1/K in the units of summaries, where no measure has one of its own."""
UNITS: Final[Mapping[Dimension, str]] = {
    "length": "um",
    "angle": "arcmin",
    "temperature": "K",
    "expansion": "1/K",
    "count": "pins",
}


@cache
def in_summary(kind: type[Strict], base: type[Section] = Section) -> type[Section]:
    """The class that a summary has for published figures: a number for each quantity, and nothing required.

    Args:
        kind: their class in scenes.
        base: its base class, with keys of its own.
    """
    hints = get_type_hints(kind, include_extras=True)
    fields: dict[str, Any] = {}
    for name, field in kind.model_fields.items():
        if name not in base.model_fields:
            unit: JsonDict | None = {"unit": own} if (own := _unit_of(hints[name])) else None
            more = Field(
                default=LEFT_OUT,
                validation_alias=field.alias,
                description=field.description,
                json_schema_extra=unit,
            )
            fields[name] = (_converted(hints[name]), more)
    found: type[Section] = create_model(kind.__name__, __base__=base, __doc__=kind.__doc__, **fields)
    return found


def converted(value: Any, per_internal: Mapping[Dimension, float], base: type[Section] = Section) -> Any:
    """Published figures as a summary has them; missing ones are left out.

    Args:
        value: as a scene has it.
        per_internal: one mm, rad, K or 1/K in the summary's units.
        base: see `in_summary`.
    """
    if isinstance(value, Quantity):
        return value.internal * per_internal[value.dimension]
    if isinstance(value, Strict):
        given = {name: getattr(value, name) for name in type(value).model_fields}
        known = {name: converted(own, per_internal) for name, own in given.items() if own not in (None, "", {})}
        return made(in_summary(type(value), base), **known)
    if isinstance(value, Mapping):
        return {key: converted(own, per_internal) for key, own in value.items()}
    if isinstance(value, list):
        return [converted(own, per_internal) for own in value]
    return value


def _converted(annotation: Any) -> Any:
    """The annotation of a summary's key."""
    origin, args = get_origin(annotation), get_args(annotation)
    if annotation in (Quantity, float):
        return Number
    if origin is Annotated and args[0] is float:
        return annotation
    if origin is Annotated:
        if args[0] is Quantity:
            return Number
        own: Any = (_converted(args[0]), *args[1:])
        return Annotated[own]
    if origin in (Union, UnionType):
        return reduce(or_, (_converted(each) for each in args if each is not NoneType))
    if origin is not None and args:
        return origin[tuple(_converted(each) for each in args)]
    if isinstance(annotation, type) and issubclass(annotation, Strict):
        return in_summary(annotation)
    return annotation


def _unit_of(annotation: Any) -> str:
    """The unit of a key whose quantities have one dimension, as a summary has them; "" of any other."""
    if get_origin(annotation) is Annotated:
        known = [own for own in get_args(annotation)[1:] if isinstance(own, Of)]
        if known and len(known[0].dimensions) == 1:
            return UNITS[known[0].dimensions[0]]
    return next((unit for each in get_args(annotation) if (unit := _unit_of(each))), "")
