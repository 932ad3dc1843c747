"""A law as a scene states it: one of the kinds that tol3d ships and of those that its scene's vocabularies add."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache, reduce
from operator import or_
from typing import Annotated, Any, Final, get_args

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from tol3d.statistics.distributions.arcsine import ArcsineSpec
from tol3d.statistics.distributions.base import DistributionSpec
from tol3d.statistics.distributions.constant import ConstantSpec
from tol3d.statistics.distributions.drawn import DRAWN, drawn_law, is_drawn
from tol3d.statistics.distributions.empirical import EmpiricalSpec
from tol3d.statistics.distributions.normal import NormalSpec
from tol3d.statistics.distributions.rayleigh import RayleighSpec
from tol3d.statistics.distributions.triangular import TriangularSpec
from tol3d.statistics.distributions.truncated_normal import TruncatedNormalSpec
from tol3d.statistics.distributions.uniform import UniformSpec

Laws = tuple[type[DistributionSpec], ...]

SHIPPED: Final[Laws] = (
    NormalSpec,
    TruncatedNormalSpec,
    UniformSpec,
    TriangularSpec,
    RayleighSpec,
    ArcsineSpec,
    ConstantSpec,
    EmpiricalSpec,
)

_laws: ContextVar[Laws] = ContextVar("laws", default=SHIPPED)


@contextmanager
def stating(laws: Laws) -> Iterator[None]:
    """Within it these are the kinds of law: of a scene that is validated, or of a JSON Schema that is written."""
    token = _laws.set(laws)
    try:
        yield
    finally:
        _laws.reset(token)


def word_of(law: type[DistributionSpec]) -> str | None:
    """The word of a kind of law in scenes; None for a class that several have in common."""
    words = get_args(law.model_fields["kind"].annotation)
    return words[0] if words else None


@lru_cache
def _one_of(laws: Laws) -> TypeAdapter[DistributionSpec]:
    """Union of some kinds, discriminated by the word."""
    for law in laws:
        law.model_rebuild()  # each is serialized by itself; older pydantic does not build that when it is needed
    union: Any = reduce(or_, laws)
    return TypeAdapter(Annotated[union, Field(discriminator="kind")])


def _read(value: Any) -> DistributionSpec:
    if isinstance(value, DistributionSpec):
        return value
    return drawn_law(value) if is_drawn(value) else _one_of(_laws.get()).validate_python(value)


class _OfTheScene:
    """Validates by the kinds that are known when a scene is read, not when its class was made."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(_read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        laws = handler(_one_of(_laws.get()).core_schema)
        return {**laws, "oneOf": [*laws["oneOf"], *handler(DRAWN.core_schema)["anyOf"]]}


StatedDistribution = Annotated[DistributionSpec, _OfTheScene()]
