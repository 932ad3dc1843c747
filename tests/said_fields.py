"""Fields that a grammar knows, and those that scenes say."""

from collections.abc import Iterable, Iterator
from typing import Any, get_args

from pydantic import BaseModel

from tol3d.statistics.distributions import DistributionSpec
from tol3d.statistics.distributions.stated import SHIPPED
from tol3d.strict import Strict

Field = tuple[type[BaseModel], str]


def models_within(annotation: Any) -> Iterator[type[BaseModel]]:
    """Every model that a field of this type may hold, those in its fields too."""
    if annotation is DistributionSpec:  # stands for the laws that a scene may state
        for law in SHIPPED:
            yield from models_within(law)
    elif isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
        for field in annotation.model_fields.values():
            yield from models_within(field.annotation)
            yield from (found for mark in field.metadata for found in models_within(mark))
    for argument in get_args(annotation):
        yield from models_within(argument)


def fields_within(annotation: Any) -> set[Field]:
    """Every field of these models."""
    return {(model, field) for model in set(models_within(annotation)) for field in model.model_fields}


def fields_said(value: Any) -> Iterator[Field]:
    """The fields that a value was given, and those within them."""
    if isinstance(value, BaseModel):
        for field in value.model_fields_set:
            yield type(value), field
            yield from fields_said(getattr(value, field))
    elif isinstance(value, dict):
        for entry in value.values():
            yield from fields_said(entry)
    elif isinstance(value, tuple):
        for entry in value:
            yield from fields_said(entry)


def unsaid(known: Iterable[Field], said: Iterable[Field]) -> set[Field]:
    """Fields that nothing says; one that kinds have from a common class is said by any of them."""
    found = set(said)
    return {own for own in set(known) - found if not any(_shares(own, other) for other in found)}


def _shares(own: Field, other: Field) -> bool:
    (model, field), (sayer, said) = own, other
    parent = model.__mro__[1]
    if field != said:
        return False
    return (parent is not Strict and issubclass(sayer, parent)) or _definer(model, field) is _definer(sayer, field)


def _definer(model: type[BaseModel], field: str) -> type:
    """The class that a model has a field from."""
    return next(each for each in model.__mro__ if field in getattr(each, "__annotations__", {}))
