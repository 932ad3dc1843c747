"""The base of everything a user writes: unknown keys are refused, nothing changes after reading."""

from typing import Any

from pydantic import BaseModel, ConfigDict, model_validator
from pydantic_core import PydanticCustomError

from tol3d.units import Quantity


class Strict(BaseModel):
    """A frozen pydantic model that names its keys where it meets an unknown one, or a value without keys."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        strict=True,
        allow_inf_nan=False,
        defer_build=True,  # a model inside another is built once, with it; building each at import costs 0.1 s
    )

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_keys(cls, data: Any) -> Any:
        known = [str(field.validation_alias or name) for name, field in cls.model_fields.items()]
        if not isinstance(data, dict | BaseModel):
            needed = [name for name, field in zip(known, cls.model_fields.values(), strict=True) if field.is_required()]
            raise PydanticCustomError("keys_expected", "no keys", {"keys": needed or known[:3]})
        for key in data if isinstance(data, dict) else ():
            if key not in known:
                raise PydanticCustomError("unknown_key", "unknown key", {"key": str(key), "known": known})
        return data


def refused(field: str, expected: str, got: object) -> PydanticCustomError:
    """The error with which a validator refuses a value, in the user's words.

    Args:
        field: dotted name of the field below the validated value; "" is that itself.
        expected: allowed value, such as "more than 0".
        got: given value; a quantity is shown in quotes, as it was written.
    """
    came = repr(str(got)) if isinstance(got, Quantity) else str(got)
    return PydanticCustomError(
        "value_refused", "expected {expected}, got {got}", {"field": field, "expected": expected, "got": came}
    )
