"""The ratio of two shafts that a scene states."""

from typing import Annotated

from pydantic import AfterValidator, Field

from tol3d.strict import refused


def _turning(ratio: float) -> float:
    if ratio == 0.0:
        raise refused("", "a ratio other than 0", ratio)
    return ratio


Ratio = Annotated[float, AfterValidator(_turning), Field(json_schema_extra={"not": {"const": 0}})]
"""Turns of the first shaft for one turn of the other; negative where they turn opposite ways."""
