"""Lists in scenes: their numbers of items, in words."""

from typing import Any

from pydantic import BeforeValidator

from tol3d.strict import refused
from tol3d.units import shown


def listed(items: str, least: int = 1, most: int | None = None) -> BeforeValidator:
    """Mark of a field that is a list, each item checked by itself afterwards.

    Args:
        items: their name in the plural, such as "pairs".
        least, most: allowed numbers; any number above `least` if `most` is not given.
    """
    many = f"{least}" if least == most else f"{least} or more" if most is None else f"{least} to {most}"

    def checked(value: Any) -> tuple[Any, ...]:
        if isinstance(value, list | tuple) and len(value) >= least and (most is None or len(value) <= most):
            return tuple(value)
        got = f"a list of {len(value)}" if isinstance(value, list | tuple) and value else shown(value)
        raise refused("", f"a list of {many} {items}", got)

    return BeforeValidator(checked)
